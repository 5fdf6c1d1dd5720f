# SPDX-License-Identifier: MIT
"""Twin of rtl/core/inverse_sqrt.v: 1/sqrt(x) by the method that the configuration names."""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
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


def inverse_sqrt(operand: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """1/sqrt(x), int64[n] in `root` (u0.18), of `operand` x, int64[n] in `root_operand` (u2.20),
    1 <= x < 4. An operand below 1 lacks its leading one and stands for 1 + x."""
    return METHODS[config.root_method](operand, config, trace)
