"""Twin of rtl/inverse_sqrt_quadratic.v: 1/sqrt(x) by a table of parabolas."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.tables import inverse_sqrt_parabolas


def lookup(operand, config: Config):
    """Stage 1: table entry and offset t in the segment, from the octave of the operand."""
    top = config.root_operand.bits - 1
    high = operand >> top  # 1 if x >= 2
    aligned = operand << (1 - high)  # the leading one in the top bit
    offset_bits = top - config.quadratic_index_bits
    segment = (aligned >> offset_bits) & ((1 << config.quadratic_index_bits) - 1)
    address = (high << config.quadratic_index_bits) | segment
    table = inverse_sqrt_parabolas(config)
    columns = (np.take(column, address) for column in (table.value, table.slope, table.curve))
    return *columns, aligned & ((1 << offset_bits) - 1)


def bend(slope, curve, offset, config: Config):
    """Stage 2: slope - curve * t."""
    return slope - (
        (curve * offset) >> (config.root_operand.bits - 1 - config.quadratic_index_bits)
    )


def refine(value, slope, offset, config: Config):
    """Stage 3: value - slope * t, in units of 2**-(quadratic_value_bits + 3)."""
    offset_bits = config.root_operand.bits - 1 - config.quadratic_index_bits
    return (value << 3) - ((slope * offset) >> offset_bits)


def inverse_sqrt_quadratic(operand, config: Config, trace: dict | None = None):
    """1/sqrt of `operand` (int64[n], `root_operand`, in [1, 4)) as `root` codes.

    Below 1 the leading one is missing and is taken as there.
    """
    value, slope, curve, offset = lookup(operand, config)
    bent = bend(slope, curve, offset, config)
    line = refine(value, bent, offset, config)
    drop = config.quadratic_value_bits + 3 - config.root.fraction
    root = fixed.saturate(fixed.round_shift(line, drop), config.root)
    if trace is not None:
        trace["inverse_sqrt_quadratic.lookup"] = (value, slope, curve, offset)
        trace["inverse_sqrt_quadratic.bend"] = (bent,)
        trace["inverse_sqrt_quadratic.refine"] = (line,)
        trace["inverse_sqrt_quadratic.round"] = (root,)
    return root
