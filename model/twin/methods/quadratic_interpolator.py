"""Twin of rtl/quadratic_interpolator.v: a quadratic along spans, by forward differences."""

from __future__ import annotations

from phong75.model import fixed
from phong75.model.config import Config


def quadratic_interpolator(start, first, second, k, config: Config):
    """Value (int64[n], `squared`) at pixel `k` of spans with `start`, `first` and `second`
    difference (int64[n] each): additions only, wrapped to the word.

    Products may leave int64: what is lost is beyond the word, too.
    """
    return fixed.wrap(start + k * first + (k * (k - 1) >> 1) * second, config.squared)
