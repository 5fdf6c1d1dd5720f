# SPDX-License-Identifier: MIT
"""Twin of rtl/core/inverse_sqrt_linear.v: 1/sqrt(x) by a table of straight lines."""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.tables import inverse_sqrt_linear_table
from phong75.model.twin.primitives.rom import rom
from phong75.model.twin.primitives.round_saturate import round_saturate


def lookup(operand: Ints, config: Config) -> tuple[Ints, Ints, Ints]:
    """Stage 1: value and slope of the operand's segment, and its offset in the segment.

    The table has as many segments for [1, 2) as for [2, 4).
    """
    top = config.root_operand.bits - 1
    high = operand >> top  # 1 if x >= 2
    aligned = operand << (1 - high)  # the leading one in the top bit
    offset_bits = top - config.root_index_bits
    segment = (aligned >> offset_bits) & ((1 << config.root_index_bits) - 1)
    offset = aligned & ((1 << offset_bits) - 1)
    table = inverse_sqrt_linear_table(config)
    address = (high << config.root_index_bits) | segment
    return rom(address, table.value), rom(address, table.slope), offset


def refine(value: Ints, slope: Ints, offset: Ints, config: Config) -> Ints:
    """Stage 2: value - slope * offset, in units of 2**-(root_value_bits + 3). The product is
    cut."""
    offset_bits = config.root_operand.bits - 1 - config.root_index_bits
    return (value << 3) - ((slope * offset) >> offset_bits)


def round_root(line: Ints, config: Config) -> Ints:
    """Stage 3: rounded to `root` (u0.18), clamped below 1."""
    return round_saturate(line, config.root_value_bits + 3 - config.root.fraction, config.root)


def inverse_sqrt_linear(operand: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """1/sqrt(x), int64[n] in `root` (u0.18), of `operand` x, int64[n] in `root_operand` (u2.20).

    The leading bit is implied: an operand in [0, 1) stands for 1 + x. The operand 0 therefore gives
    the largest code; a zero vector's components stay zero under any finite factor.
    """
    value, slope, offset = lookup(operand, config)
    line = refine(value, slope, offset, config)
    root = round_root(line, config)
    if trace is not None:
        trace["inverse_sqrt_linear.lookup"] = (value, slope, offset)
        trace["inverse_sqrt_linear.refine"] = (line,)
        trace["inverse_sqrt_linear.round"] = (root,)
    return root
