# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/inverse_sqrt_quadratic.v: 1/sqrt(x) by a table of parabolas."""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.tables import inverse_sqrt_parabolas
from phong75.model.twin.primitives.rom import rom
from phong75.model.twin.primitives.round_saturate import round_saturate


def lookup(operand: Ints, config: Config) -> tuple[Ints, Ints, Ints, Ints]:
    """Stage 1: value, slope and curve of the operand's segment, and its offset t in the segment.

    The table has as many segments for [1, 2) as for [2, 4).
    """
    top = config.root_operand.bits - 1
    high = operand >> top  # 1 if x >= 2
    aligned = operand << (1 - high)  # the leading one in the top bit
    offset_bits = top - config.quadratic_index_bits
    segment = (aligned >> offset_bits) & ((1 << config.quadratic_index_bits) - 1)
    address = (high << config.quadratic_index_bits) | segment
    table = inverse_sqrt_parabolas(config)
    value, slope, curve = (rom(address, c) for c in (table.value, table.slope, table.curve))
    return value, slope, curve, aligned & ((1 << offset_bits) - 1)


def bend(slope: Ints, curve: Ints, offset: Ints, config: Config) -> Ints:
    """Stage 2: slope - curve * t; the product is cut."""
    offset_bits = config.root_operand.bits - 1 - config.quadratic_index_bits
    return slope - ((curve * offset) >> offset_bits)


def refine(value: Ints, slope: Ints, offset: Ints, config: Config) -> Ints:
    """Stage 3: value - slope * t, in units of 2**-(quadratic_value_bits + 3). The product is
    cut."""
    offset_bits = config.root_operand.bits - 1 - config.quadratic_index_bits
    return (value << 3) - ((slope * offset) >> offset_bits)


def inverse_sqrt_quadratic(operand: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """1/sqrt(x), int64[n] in `root` (u0.18), of `operand` x, int64[n] in `root_operand` (u2.20).

    The leading bit is implied: an operand in [0, 1) stands for 1 + x.
    """
    value, slope, curve, offset = lookup(operand, config)
    bent = bend(slope, curve, offset, config)
    line = refine(value, bent, offset, config)
    drop = config.quadratic_value_bits + 3 - config.root.fraction
    root = round_saturate(line, drop, config.root)
    if trace is not None:
        trace["inverse_sqrt_quadratic.lookup"] = (value, slope, curve, offset)
        trace["inverse_sqrt_quadratic.bend"] = (bent,)
        trace["inverse_sqrt_quadratic.refine"] = (line,)
        trace["inverse_sqrt_quadratic.round"] = (root,)
    return root
