# SPDX-License-Identifier: MIT
"""Twin of rtl/techniques/second_difference_interpolator.v: one component of a quadratic normal.

Quadratic normals are those of van Overveld and Wyvill (1997) and of Vlachos et al. (2001). Along a
span they are parabolas, which forward differences of second order give exactly.
"""

from __future__ import annotations

from phong75.model.arrays import Ints
from phong75.model.config import Config


def parabola(start: Ints, step: Ints, bend: Ints, k: Ints, config: Config) -> Ints:
    """Stage 1: start + k step + k (k - 1)/2 bend in `bend` (s1.42), wrapped as the adders wrap.

    The products here may overflow int64, which is harmless: the lost bits are beyond the word.
    """
    linear = (start + k * step) << config.bend_fraction_bits
    return config.bend.wrap(linear + (k * (k - 1) >> 1) * bend)


def jam(value: Ints, config: Config) -> Ints:
    """Stage 2: `value` in `normal` (s1.30), cut; the last bit is 1, too, if any bit cut off is 1.

    So the word is 0, or negative, exactly if `value` is. The word is less than one LSB from
    `value`, and equal to it where the bits cut off are 0: always, if the bend is 0.
    """
    extra = config.bend_fraction_bits
    return (value >> extra) | (value & ((1 << extra) - 1) != 0)


def second_difference_interpolator(
    start: Ints, step: Ints, bend: Ints, k: Ints, config: Config
) -> Ints:
    """The component at pixel `k` (int64[n]) of spans, int64[..., n] in `normal` (s1.30).

    start, step: int64[..., n] in `normal`, the value at the first pixel and the change to the
    second. bend: int64[..., n] in `Config.bend` (s1.42), how much that change grows per pixel.
    """
    return jam(parabola(start, step, bend, k, config), config)
