"""Twin of rtl/inverse_sqrt_linear.v: 1/sqrt(x) by a table of straight lines."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.tables import inverse_sqrt_linear_table


def lookup(operand, config: Config):
    """Stage 1: table address and offset in the segment, from the octave of the operand."""
    top = config.root_operand.bits - 1
    high = operand >> top  # 1 if x >= 2
    aligned = operand << (1 - high)  # the leading one in the top bit
    offset_bits = top - config.root_index_bits
    segment = (aligned >> offset_bits) & ((1 << config.root_index_bits) - 1)
    offset = aligned & ((1 << offset_bits) - 1)
    table = inverse_sqrt_linear_table(config)
    address = (high << config.root_index_bits) | segment
    return np.take(table.value, address), np.take(table.slope, address), offset


def refine(value, slope, offset, config: Config):
    """Stage 2: value - slope * offset, in units of 2**-(root_value_bits + 3)."""
    offset_bits = config.root_operand.bits - 1 - config.root_index_bits
    return (value << 3) - ((slope * offset) >> offset_bits)


def round_root(line, config: Config):
    """Stage 3: rounded to `root`, saturated below 1."""
    drop = config.root_value_bits + 3 - config.root.fraction
    return fixed.saturate(fixed.round_shift(line, drop), config.root)


def inverse_sqrt_linear(operand, config: Config, trace: dict | None = None):
    """1/sqrt of `operand` (int64[n], `root_operand`, in [1, 4)) as `root` codes in (1/2, 1].

    Below 1 the leading one is missing and is taken as there: 0 gives the answer for 1, the
    largest code. (A zero vector's components stay zero under any finite factor.)
    """
    value, slope, offset = lookup(operand, config)
    line = refine(value, slope, offset, config)
    root = round_root(line, config)
    if trace is not None:
        trace["inverse_sqrt_linear.lookup"] = (value, slope, offset)
        trace["inverse_sqrt_linear.refine"] = (line,)
        trace["inverse_sqrt_linear.round"] = (root,)
    return root
