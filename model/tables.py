# SPDX-License-Identifier: MIT
"""The lookup tables of the pipeline, generated from the configuration.

The tables of the default configuration hold straight lines: entry k holds the `value` at the left
end of segment k and the `slope`, the change over the whole segment, as unsigned codes. Each line is
the chord of its segment, moved halfway towards the curve. That halves the chord's largest error and
is the best straight line for a curve without inflection (Chebyshev's equioscillation). Other
methods have parabolas or constants. tests/test_tables.py recomputes every entry with mpmath.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from phong75.model.arrays import Ints, Reals
from phong75.model.config import Config


@dataclass(frozen=True)
class LineTable:
    """Straight lines value + t slope (or value - t slope), t from 0 to 1 over a segment.

    value, slope: codes int64[segments], slopes as magnitudes; value_bits, slope_bits: their widths.
    """

    name: str
    value: Ints
    slope: Ints
    value_bits: int
    slope_bits: int

    @property
    def words(self) -> Ints:
        """The ROM contents {value, slope}, int64[segments]."""
        return (self.value << self.slope_bits) | self.slope

    @property
    def word_bits(self) -> int:
        """Width of a word."""
        return self.value_bits + self.slope_bits


@dataclass(frozen=True)
class ParabolaTable:
    """Parabolas value - t (slope - t curve), t from 0 to 1 over a segment.

    value, slope, curve: codes int64[segments]; value_bits, slope_bits, curve_bits: their widths.
    """

    name: str
    value: Ints
    slope: Ints
    curve: Ints
    value_bits: int
    slope_bits: int
    curve_bits: int

    @property
    def words(self) -> Ints:
        """The ROM contents {value, slope, curve}, int64[segments]."""
        return (((self.value << self.slope_bits) | self.slope) << self.curve_bits) | self.curve

    @property
    def word_bits(self) -> int:
        """Width of a word."""
        return self.value_bits + self.slope_bits + self.curve_bits


@dataclass(frozen=True)
class ConstantTable:
    """Constants, one per segment: `value`, codes int64[segments] of `word_bits` bits."""

    name: str
    value: Ints
    word_bits: int

    @property
    def words(self) -> Ints:
        """The ROM contents, int64[segments]."""
        return self.value


Table = LineTable | ParabolaTable | ConstantTable


def _lines(
    name: str, left: Reals, right: Reals, error: Reals,
    value_scale: float, value_bits: int, slope_scale: float, slope_bits: int,
) -> LineTable:  # fmt: skip
    """Quantize the chords of a curve, moved by half their error towards the curve.

    left, right: float64[segments], the curve at the ends of each segment. error: float64[segments],
    chord - curve where the two are furthest apart. value_scale, slope_scale: codes per 1.0. Slopes
    are stored as magnitudes; the reader of a table knows their sign. Raises ValueError if a slope
    does not fit its bits.
    """
    value = np.floor((left - error / 2) * value_scale + 0.5).astype(np.int64)
    slope = np.floor(np.abs(right - left) * slope_scale + 0.5).astype(np.int64)
    value = np.clip(value, 0, (1 << value_bits) - 1)
    if slope.max() >= 1 << slope_bits:
        raise ValueError(f"table {name}: a slope of {slope.max()} does not fit {slope_bits} bits")
    return LineTable(name, value, slope, value_bits, slope_bits)


@lru_cache
def inverse_sqrt_linear_table(config: Config) -> LineTable:
    """1/sqrt(x), 1 <= x < 4, in falling lines: the segments of [1, 2), then those of [2, 4).

    Value: u0.`root_value_bits` (u0.21). Slope: per segment, in units 8 times finer (2**-24).
    """
    a, b = _octaves(config.root_index_bits)
    left, right = a**-0.5, b**-0.5
    chord_slope = (right - left) / (b - a)
    touch = (-2 * chord_slope) ** (-2 / 3)  # where the curve is parallel to its chord
    error = left + chord_slope * (touch - a) - touch**-0.5
    scale = 2.0**config.root_value_bits
    return _lines(
        "inverse_sqrt_linear", left, right, error, scale, config.root_value_bits,
        scale * 8, config.root_slope_bits,
    )  # fmt: skip


def _octaves(index_bits: int) -> tuple[Reals, Reals]:
    """Left and right ends of 2**index_bits segments each of [1, 2) and [2, 4)."""
    segments = 1 << index_bits
    octave = np.repeat([1.0, 2.0], segments)
    k = np.tile(np.arange(segments), 2)
    return octave * (1 + k / segments), octave * (1 + (k + 1) / segments)


@lru_cache
def inverse_sqrt_parabolas(config: Config) -> ParabolaTable:
    """1/sqrt(x), 1 <= x < 4, in parabolas through the curve at the three Chebyshev points of each
    segment; their error is within a few percent of that of the best parabolas.

    Value: u0.`quadratic_value_bits` (u0.20). Slope and curve: per segment and segment squared, in
    units 8 times finer (2**-23). Raises ValueError if a slope or curve does not fit its bits.
    """
    a, b = _octaves(config.quadratic_index_bits)
    t = 0.5 + 0.5 * np.cos(np.pi * np.array([5, 3, 1]) / 6)
    y = (a[:, None] + (b - a)[:, None] * t) ** -0.5
    first = (y[:, 1:] - y[:, :-1]) / np.diff(t)  # divided differences
    curve = (first[:, 1] - first[:, 0]) / (t[2] - t[0])
    slope = first[:, 0] - curve * (t[0] + t[1])
    value = y[:, 0] - t[0] * (slope + curve * t[0])
    scale = 2.0**config.quadratic_value_bits
    bits = config.quadratic_value_bits, config.quadratic_slope_bits, config.quadratic_curve_bits
    values, slopes, curves = (
        np.clip(np.floor(column * factor + 0.5).astype(np.int64), 0, (1 << width) - 1)
        for column, factor, width in zip(
            (value, -slope, curve), (scale, 8 * scale, 8 * scale), bits, strict=True
        )
    )
    if (-slope * 8 * scale).max() >= 1 << bits[1] or (curve * 8 * scale).max() >= 1 << bits[2]:
        raise ValueError("table inverse_sqrt_parabolas: a slope or curve does not fit its bits")
    return ParabolaTable("inverse_sqrt_parabolas", values, slopes, curves, *bits)


@lru_cache
def inverse_sqrt_start(config: Config) -> ConstantTable:
    """1/sqrt(x), 1 <= x < 4: the middle of its range in each segment, in `root` (u0.18)."""
    a, b = _octaves(config.start_index_bits)
    middle = config.root.quantize((a**-0.5 + b**-0.5) / 2)
    return ConstantTable("inverse_sqrt_start", middle, config.root.bits)


@lru_cache
def log_table(config: Config) -> LineTable:
    """-log2(1 - v), 0 <= v < 1/2, in rising lines; v = 0 gives exactly 0.

    Value: `log_value` (u0.22). Slope: per segment, in units of `log_value`.
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
    """2**-f, 0 <= f < 1, in falling lines.

    `power_log` is cut, not rounded, to its fraction. The curve is taken half a unit to the right,
    which centres the error of the cut. Value: `exp_value` (u0.20). Slope: per segment, in units of
    `exp_value`.
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


@lru_cache
def reciprocal_table(config: Config) -> LineTable:
    """1/m, 1 <= m < 2, in falling lines.

    Value: u0.`reciprocal_value_bits` (u0.20). Slope: per segment, in the same units.
    """
    segments = 1 << config.reciprocal_index_bits
    a = 1 + np.arange(segments) / segments
    b = a + 1 / segments
    left, right = 1 / a, 1 / b
    touch = np.sqrt(a * b)  # where the curve is parallel to its chord
    error = left + (right - left) * (touch - a) * segments - 1 / touch
    scale = 2.0**config.reciprocal_value_bits
    return _lines(
        "reciprocal", left, right, error, scale, config.reciprocal_value_bits,
        scale, config.reciprocal_slope_bits,
    )  # fmt: skip


def tables(config: Config) -> list[Table]:
    """All tables of `config`, including those of methods that it does not use."""
    return [
        inverse_sqrt_linear_table(config), inverse_sqrt_parabolas(config),
        inverse_sqrt_start(config),
        log_table(config), exp_table(config), reciprocal_table(config),
    ]  # fmt: skip
