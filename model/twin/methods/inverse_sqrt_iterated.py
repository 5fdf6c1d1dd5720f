"""Twin of rtl/inverse_sqrt_iterated.v: 1/sqrt(x) from an estimate by Newton's iteration."""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config
from phong75.model.tables import inverse_sqrt_start
from phong75.model.twin.methods.newton_step import newton_step

#: Fraction bits of a float32, and its famous constant (with x and the result biased alike).
_FRACTION = 23
_CONSTANT = 0x5F3759DF - 127 * 2 ** (_FRACTION - 1) - 125 * 2**_FRACTION


def start_table(operand, config: Config):
    """Stage 1, `table`: the constant of the operand's segment, in `root`."""
    top = config.root_operand.bits - 1
    high = operand >> top
    aligned = operand << (1 - high)
    segment = aligned >> (top - config.start_index_bits) & ((1 << config.start_index_bits) - 1)
    table = inverse_sqrt_start(config)
    return np.take(table.value, (high << config.start_index_bits) | segment)


def start_fast_inverse(operand, config: Config):
    """Stage 1, `magic`: 0x5f3759df - (float32 bits of x >> 1), read as float32, cut to `root`."""
    top = config.root_operand.bits - 1
    high = operand >> top
    fraction = (operand << (1 - high)) & ((1 << top) - 1)
    log = (high << _FRACTION) | (fraction << (_FRACTION - top))
    half = _CONSTANT - (log >> 1)
    one = 1 << _FRACTION
    significand = one | (half & (one - 1))
    drop = _FRACTION + 1 - config.root.fraction
    return np.where(half >= one, significand >> drop, significand >> (drop + 1))


def inverse_sqrt_iterated(operand, config: Config, trace: dict | None = None):
    """1/sqrt of `operand` (int64[n], `root_operand`, in [1, 4)) as `root` codes.

    Below 1 the leading one is missing and is taken as there.
    """
    magic = config.root_method == "fast_inverse"
    y = start = (start_fast_inverse if magic else start_table)(operand, config)
    one = np.where(operand >> (config.root_operand.bits - 1), 0, config.root_operand.one)
    x = (operand | one) >> (config.root_operand.bits - config.root.bits)
    for _ in range(config.root_newton_steps):
        y = newton_step(x, y, config)
    if trace is not None:
        trace["inverse_sqrt_iterated.start"] = (start,)
        trace["inverse_sqrt_iterated.steps"] = (y,)
    return y
