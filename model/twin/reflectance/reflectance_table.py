# SPDX-License-Identifier: MIT
"""Twin of rtl/reflectance/reflectance_table.v: any curve of cos(s), in place of cos(s)**n."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.primitives.leading_zeros import leading_zeros
from phong75.model.twin.primitives.left_shifter import left_shifter
from phong75.model.twin.reflectance.jumps import jumps as jumps_of
from phong75.model.twin.reflectance.stepped_line import stepped_line


def fold(v: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 1: the top bit of v, and the bits below, inverted where the top bit is 1."""
    half = config.versine.bits - 1
    mirrored = v >> half
    return mirrored, (v ^ -mirrored) & ((1 << half) - 1)


def octave(folded: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 2: the number of the octave, and the word shifted so that its bits below the top are
    the place in the octave.

    The zeros at the top are counted up to the last octave but one; the last octave, which begins at
    0, has no 1 at the top then.
    """
    half = config.versine.bits - 1
    most = (1 << config.curve_octave_bits) - 2
    zeros = leading_zeros(folded >> (half - most), most)
    place = left_shifter(folded, zeros, half)
    return zeros | (1 - (place >> (half - 1))), place


def offset_bits(config: Config) -> int:
    """Width of the place in a segment."""
    return config.versine.bits - 2 - config.curve_index_bits


def lookup(
    mirrored: Ints, number: Ints, place: Ints, material: Ints, curve: Ints, config: Config
) -> tuple[Ints, Ints, Ints]:
    """Stage 3: left and step of the line of the segment, and the offset in the segment."""
    bits = offset_bits(config)
    index = (place >> bits) & ((1 << config.curve_index_bits) - 1)
    address = mirrored << config.curve_octave_bits | number
    address = address << config.curve_index_bits | index
    words = curve[material, address]
    return words[:, 0], words[:, 1], place & ((1 << bits) - 1)


def reflectance_table(
    v: Ints, material: Ints, curve: Ints, jumps: Ints | None, config: Config,
    trace: Trace | None = None,
) -> Ints:  # fmt: skip
    """The curve at cos(s), int64[n] in `power` (u0.18), of v = 1 - cos(s) in `versine` (u0.22).

    material: int64[n]. curve, jumps: as `curve` and `curve_jumps` of `MaterialTable`.
    """
    mirrored, folded = fold(v, config)
    number, place = octave(folded, config)
    left, step, offset = lookup(mirrored, number, place, material, curve, config)
    inner: Trace | None = None if trace is None else {}
    fall = np.zeros_like(v)
    if config.curve_jumps:
        fall = jumps_of(v, material, jumps, config.curve_jumps)
    power = stepped_line(left, step, offset, fall, offset_bits(config), config.power, config, inner)
    if trace is not None and inner is not None:
        trace["reflectance_table.octave"] = (place,)
        trace["reflectance_table.lookup"] = (left, step, offset)
        trace["reflectance_table.level"] = inner["stepped_line.level"]
        trace["reflectance_table.result"] = (power,)
    return power
