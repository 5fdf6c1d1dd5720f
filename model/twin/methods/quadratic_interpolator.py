# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/quadratic_interpolator.v: a quadratic along spans, by forward differences
(Duff 1979)."""

from __future__ import annotations

from phong75.model.arrays import Ints
from phong75.model.config import Config


def quadratic_interpolator(start: Ints, first: Ints, second: Ints, k: Ints, config: Config) -> Ints:
    """The value int64[n] in `squared` (s2.42) at pixel `k` of spans, wrapped to the word.

    start, first, second: int64[n] in `squared`, the value at the first pixel, the first and the
    second difference. The hardware only adds. The products here may overflow int64, which is
    harmless: the lost bits are beyond the word.
    """
    return config.squared.wrap(start + k * first + (k * (k - 1) >> 1) * second)
