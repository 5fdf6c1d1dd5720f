# SPDX-License-Identifier: MIT
"""Twin of rtl/reflectance/jumps.v: the amounts of the jumps whose side an operand is on."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace


def select(operand: Ints, above: Ints, threshold: Ints, amount: Ints) -> Ints:
    """Stage 1: `amount` where the operand is on the jump's side, else 0: at or above the threshold
    for above = 1, below for above = 0."""
    return np.where((operand >= threshold) == (above == 1), amount, 0)


def jumps(
    operand: Ints, material: Ints, table: Ints | None, count: int, trace: Trace | None = None
) -> Ints:
    """The sum of the amounts that apply, int64[n], in units of `coefficient`.

    operand: int64[n]. material: int64[n]. table: int64[M, MAX_JUMPS, 3], {above, threshold, amount}
    of every material, of which the hardware has the first `count`; None if there are none.
    """
    total = np.zeros_like(operand)
    for k in range(count):
        row = np.zeros((len(operand), 3), np.int64) if table is None else table[material, k]
        total = total + select(operand, *row.T)
    if trace is not None:
        trace["jumps.sum"] = (total,)
    return total
