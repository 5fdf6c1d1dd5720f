"""Twin of rtl/inverse_sqrt_method.v: 1/sqrt(x) by the method that the configuration names."""

from __future__ import annotations

from ..config import Config
from .inverse_sqrt import inverse_sqrt
from .inverse_sqrt_iterated import inverse_sqrt_iterated
from .inverse_sqrt_quadratic import inverse_sqrt_quadratic

METHODS = {
    "lines": inverse_sqrt,
    "quadratic": inverse_sqrt_quadratic,
    "table": inverse_sqrt_iterated,
    "magic": inverse_sqrt_iterated,
}


def inverse_sqrt_method(operand, config: Config, trace: dict | None = None):
    """1/sqrt of `operand` (int64[n], `root_operand`, in [1, 4)) as `root` codes."""
    return METHODS[config.root_method](operand, config, trace)
