"""The lookup tables of the pipeline, generated from the configuration.

Every table is a set of straight lines: entry k holds the `value` at the left end of segment k and
the `slope`, the change over the whole segment, as unsigned codes. Each line is the chord of its
segment moved halfway towards the curve, which halves the chord's largest error and is the best
straight line for a curve without inflection (Chebyshev's equioscillation). `tests/test_tables.py`
recomputes every entry with mpmath.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from .config import Config


@dataclass(frozen=True)
class LineTable:
    """Straight-line segments: `value` and `slope` codes, int64[segments], and their widths."""

    name: str
    value: np.ndarray
    slope: np.ndarray
    value_bits: int
    slope_bits: int

    @property
    def words(self) -> np.ndarray:
        """The ROM contents, {value, slope}, int64[segments]."""
        return (self.value << self.slope_bits) | self.slope


def _lines(name, left, right, midpoint, value_scale, value_bits, slope_scale, slope_bits):
    """Quantize the lines through `left` and `right`, moved by half their error at `midpoint`.

    left, right: the curve at the ends of each segment. midpoint: (chord - curve) where the two
    are furthest apart. Slopes are stored as magnitudes; the user of a table knows their sign.
    """
    value = np.floor((left - midpoint / 2) * value_scale + 0.5).astype(np.int64)
    slope = np.floor(np.abs(right - left) * slope_scale + 0.5).astype(np.int64)
    value = np.clip(value, 0, (1 << value_bits) - 1)
    if slope.max() >= 1 << slope_bits:
        raise ValueError(f"table {name}: a slope of {slope.max()} does not fit {slope_bits} bits")
    return LineTable(name, value, slope, value_bits, slope_bits)


@lru_cache
def inverse_sqrt_table(config: Config) -> LineTable:
    """1/sqrt(x), x in [1, 4): the segments of [1, 2), then those of [2, 4). Falling lines.

    Value: u0.`root_value_bits`. Slope: 8 times finer, a segment.
    """
    segments = 1 << config.root_index_bits
    octave = np.repeat([1.0, 2.0], segments)
    k = np.tile(np.arange(segments), 2)
    a, b = octave * (1 + k / segments), octave * (1 + (k + 1) / segments)
    left, right = a**-0.5, b**-0.5
    chord_slope = (right - left) / (b - a)
    touch = (-2 * chord_slope) ** (-2 / 3)  # where the curve is parallel to its chord
    error = left + chord_slope * (touch - a) - touch**-0.5
    scale = 2.0**config.root_value_bits
    return _lines(
        "inverse_sqrt", left, right, error, scale, config.root_value_bits,
        scale * 8, config.root_slope_bits,
    )  # fmt: skip


@lru_cache
def log_table(config: Config) -> LineTable:
    """-log2(1 - v), v in [0, 1/2). Rising lines; v = 0 gives exactly 0.

    Value: `log_value`. Slope: units of `log_value`, a segment.
    """
    segments = 1 << config.log_index_bits
    a = np.arange(segments) / (2 * segments)
    b = a + 1 / (2 * segments)
    left, right = -np.log2(1 - a), -np.log2(1 - b)
    chord_slope = (right - left) / (b - a)
    touch = 1 - 1 / (np.log(2) * chord_slope)
    error = left + chord_slope * (touch - a) + np.log2(1 - touch)
    scale = 2.0**config.log_value.fraction
    return _lines(
        "log", left, right, error, scale, config.log_value.bits, scale, config.log_slope_bits
    )


@lru_cache
def exp_table(config: Config) -> LineTable:
    """2**-f, f in [0, 1). Falling lines.

    `power_log` is cut, not rounded, to its fraction; so the curve is taken half a unit to the
    right, which centres the error of the cut. Value: `exp_value`. Slope: its units, a segment.
    """
    segments = 1 << config.exp_index_bits
    a = np.arange(segments) / segments + config.power_log.lsb / 2
    b = a + 1 / segments
    left, right = 2.0**-a, 2.0**-b
    chord_slope = (right - left) / (b - a)
    touch = -np.log2(-chord_slope / np.log(2))
    error = left + chord_slope * (touch - a) - 2.0**-touch
    scale = 2.0**config.exp_value.fraction
    return _lines(
        "exp", left, right, error, scale, config.exp_value.bits, scale, config.exp_slope_bits
    )


def tables(config: Config) -> list[LineTable]:
    """All tables of a configuration, in the order of the data."""
    return [inverse_sqrt_table(config), log_table(config), exp_table(config)]
