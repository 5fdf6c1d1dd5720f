"""Twin of rtl/inverse_sqrt.v: 1/sqrt(x) by the method that the configuration names."""

from __future__ import annotations

from phong75.model.config import Config
from phong75.model.twin.core.inverse_sqrt_linear import inverse_sqrt_linear
from phong75.model.twin.methods.inverse_sqrt_iterated import inverse_sqrt_iterated
from phong75.model.twin.methods.inverse_sqrt_quadratic import inverse_sqrt_quadratic

METHODS = {
    "lines": inverse_sqrt_linear,
    "quadratic": inverse_sqrt_quadratic,
    "table": inverse_sqrt_iterated,
    "fast_inverse": inverse_sqrt_iterated,
}


def inverse_sqrt(operand, config: Config, trace: dict | None = None):
    """1/sqrt of `operand` (int64[n], `root_operand`, in [1, 4)) as `root` codes."""
    return METHODS[config.root_method](operand, config, trace)
