# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/inverse_sqrt_iterated.v: 1/sqrt(x) from an estimate by Newton's iteration."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.tables import inverse_sqrt_start
from phong75.model.twin.methods.newton_step import newton_step
from phong75.model.twin.primitives.rom import rom

#: Fraction bits of a float32.
_FRACTION = 23

#: The constant of the fast inverse square root (Quake III, 1999), less the exponent biases of x
#: (half of 127) and of the result (125), which the hardware does not carry.
_CONSTANT = 0x5F3759DF - 127 * 2 ** (_FRACTION - 1) - 125 * 2**_FRACTION


def start_table(operand: Ints, config: Config) -> Ints:
    """Stage 1 by the method `table`: the constant of the operand's segment, in `root` (u0.18)."""
    top = config.root_operand.bits - 1
    high = operand >> top
    aligned = operand << (1 - high)
    segment = aligned >> (top - config.start_index_bits) & ((1 << config.start_index_bits) - 1)
    table = inverse_sqrt_start(config)
    return rom((high << config.start_index_bits) | segment, table.value)


def start_fast_inverse(operand: Ints, config: Config) -> Ints:
    """Stage 1 by the method `fast_inverse`: 0x5f3759df - (float32 bits of x >> 1), read as a
    float32, cut to `root` (u0.18)."""
    top = config.root_operand.bits - 1
    high = operand >> top
    fraction = (operand << (1 - high)) & ((1 << top) - 1)
    log = (high << _FRACTION) | (fraction << (_FRACTION - top))
    half = _CONSTANT - (log >> 1)
    one = 1 << _FRACTION
    significand = one | (half & (one - 1))
    drop = _FRACTION + 1 - config.root.fraction
    return np.where(half >= one, significand >> drop, significand >> (drop + 1))


def inverse_sqrt_iterated(operand: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """1/sqrt(x), int64[n] in `root` (u0.18), of `operand` x, int64[n] in `root_operand` (u2.20).

    `root_newton_steps` steps follow the first estimate. The leading bit is implied: an operand in
    [0, 1) stands for 1 + x.
    """
    fast = config.root_method == "fast_inverse"
    y = start = (start_fast_inverse if fast else start_table)(operand, config)
    implied = np.where(operand >> (config.root_operand.bits - 1), 0, config.root_operand.one)
    x = (operand | implied) >> (config.root_operand.bits - config.root.bits)
    for _ in range(config.root_newton_steps):
        y = newton_step(x, y, config)
    if trace is not None:
        trace["inverse_sqrt_iterated.start"] = (start,)
        trace["inverse_sqrt_iterated.steps"] = (y,)
    return y
