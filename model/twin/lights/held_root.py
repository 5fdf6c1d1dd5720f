# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/held_root.v: 1/|N0| of the first light's normal, for all lights of a pixel."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.inverse_sqrt import inverse_sqrt
from phong75.model.twin.core.normalizer import root_operand, sum_of_squares


def held_root(mantissa: Ints, config: Config, trace: Trace | None = None) -> tuple[Ints, Flags]:
    """1/|m|, int64[n] in `root` (u0.18), and whether its operand was 4 |m|**2, bool[n].

    mantissa: int64[3, n] in `mantissa` (s0.17), of the first light's normal.
    """
    square = sum_of_squares(mantissa)
    operand, below_one = root_operand(square, config)
    root = inverse_sqrt(operand, config)
    if trace is not None:
        trace["held_root.sum_of_squares"] = (square,)
        trace["held_root.root_operand"] = (operand, below_one.astype(np.int64))
        trace["held_root.hold"] = (root, below_one.astype(np.int64))
    return root, below_one
