# SPDX-License-Identifier: MIT
"""Twin of rtl/reflectance/stepped_line.v: a straight line, minus jumps, as a word."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config, Format
from phong75.model.twin.primitives.round_saturate import round_saturate


def line(left: Ints, step: Ints, offset: Ints, offset_bits: int) -> Ints:
    """Stage 1: left + step * offset; the product keeps all bits."""
    return (left << offset_bits) + step * offset


def level(value: Ints, fall: Ints, offset_bits: int) -> Ints:
    """Stage 2: the amounts of the jumps are subtracted."""
    return value - (fall << offset_bits)


def result(value: Ints, offset_bits: int, fmt: Format, config: Config) -> Ints:
    """Stage 3: 0 for a negative value; rounded half up and clamped to `fmt`."""
    drop = offset_bits + config.coefficient.fraction - fmt.fraction
    return round_saturate(np.maximum(value, 0), drop, fmt)


def stepped_line(
    left: Ints, step: Ints, offset: Ints, fall: Ints, offset_bits: int, fmt: Format,
    config: Config, trace: Trace | None = None,
) -> Ints:  # fmt: skip
    """The line left + step * offset - fall, int64[n] in `fmt`.

    left: int64[n] in `coefficient` (u1.16); step: signed, in units of it; fall: in units of it, 0
    or more. offset: int64[n], 0 to 1 in `offset_bits` bits.
    """
    value = level(line(left, step, offset, offset_bits), fall, offset_bits)
    word = result(value, offset_bits, fmt, config)
    if trace is not None:
        trace["stepped_line.level"] = (value,)
        trace["stepped_line.result"] = (word,)
    return word
