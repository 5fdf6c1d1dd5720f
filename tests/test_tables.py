"""Every entry of every table against an independent computation with mpmath."""

import mpmath
import numpy as np
import pytest

from phong75.model.config import DEFAULT as C
from phong75.model.studies.methods import CONFIGS
from phong75.model.tables import (
    exp_table,
    inverse_sqrt_linear_table,
    inverse_sqrt_parabolas,
    inverse_sqrt_start,
    log_table,
    reciprocal_table,
)

mpmath.mp.prec = 120


def best_line(curve, slope_at, a, b):
    """Value at `a` and rise over [a, b] of the best straight line: equioscillation, by hand.

    slope_at(m): where the curve's derivative is m.
    """
    rise = curve(b) - curve(a)
    touch = slope_at(rise / (b - a))
    gap = curve(a) + rise * (touch - a) / (b - a) - curve(touch)
    return curve(a) - gap / 2, rise


def inverse_sqrt_lines():
    segments = 1 << C.root_index_bits
    for octave in (1, 2):
        for k in range(segments):
            a = mpmath.mpf(octave) * (segments + k) / segments
            b = a + mpmath.mpf(octave) / segments
            line = best_line(
                lambda x: 1 / mpmath.sqrt(x), lambda m: (-2 * m) ** (-2 / mpmath.mpf(3)), a, b
            )
            yield *line, 1 << C.root_value_bits, 8 << C.root_value_bits


def log_lines():
    segments = 1 << C.log_index_bits
    for k in range(segments):
        a, b = mpmath.mpf(k) / segments / 2, mpmath.mpf(k + 1) / segments / 2
        line = best_line(
            lambda x: -mpmath.log(1 - x, 2), lambda m: 1 - 1 / (m * mpmath.ln(2)), a, b
        )
        yield *line, C.log_value.one, C.log_value.one


def exp_lines():
    segments = 1 << C.exp_index_bits
    cut = mpmath.mpf(1) / (2 << C.power_log.fraction)
    for k in range(segments):
        a, b = mpmath.mpf(k) / segments + cut, mpmath.mpf(k + 1) / segments + cut
        line = best_line(
            lambda x: mpmath.power(2, -x), lambda m: -mpmath.log(-m / mpmath.ln(2), 2), a, b
        )
        yield *line, C.exp_value.one, C.exp_value.one


def reciprocal_lines():
    segments = 1 << C.reciprocal_index_bits
    for k in range(segments):
        a, b = mpmath.mpf(segments + k) / segments, mpmath.mpf(segments + k + 1) / segments
        line = best_line(lambda x: 1 / x, lambda m: 1 / mpmath.sqrt(-m), a, b)
        yield *line, 1 << C.reciprocal_value_bits, 1 << C.reciprocal_value_bits


@pytest.mark.parametrize(
    "table, lines",
    [
        (inverse_sqrt_linear_table(C), inverse_sqrt_lines),
        (log_table(C), log_lines),
        (exp_table(C), exp_lines),
        (reciprocal_table(C), reciprocal_lines),
    ],
    ids=["inverse_sqrt_linear", "log", "exp", "reciprocal"],
)
def test_every_entry(table, lines):
    expected = list(lines())
    assert len(expected) == len(table.value) == len(table.slope)
    for k, (value, rise, value_scale, slope_scale) in enumerate(expected):
        code = min(
            max(int(mpmath.floor(value * value_scale + mpmath.mpf(1) / 2)), 0),
            (1 << table.value_bits) - 1,
        )
        slope = int(mpmath.floor(abs(rise) * slope_scale + mpmath.mpf(1) / 2))
        assert (code, slope) == (table.value[k], table.slope[k]), f"{table.name} entry {k}"


def test_words_hold_value_and_slope():
    lines = inverse_sqrt_linear_table(C), log_table(C), exp_table(C), reciprocal_table(C)
    for table in lines:
        assert np.array_equal(table.words >> table.slope_bits, table.value)
        assert np.array_equal(table.words & ((1 << table.slope_bits) - 1), table.slope)
        assert table.words.max() < 1 << (table.value_bits + table.slope_bits)


def test_the_logarithm_of_one_is_zero():
    assert log_table(C).value[0] == 0


def _segments(index_bits):
    for octave in (1, 2):
        for k in range(1 << index_bits):
            a = mpmath.mpf(octave) * ((1 << index_bits) + k) / (1 << index_bits)
            yield a, a + mpmath.mpf(octave) / (1 << index_bits)


@pytest.mark.parametrize("name", ["default", "parabolas_4", "width_10"])
def test_every_parabola(name):
    """Through the curve at the roots of Chebyshev's polynomial, by solving for it."""
    config = CONFIGS[name]
    table = inverse_sqrt_parabolas(config)
    scale = mpmath.mpf(2) ** config.quadratic_value_bits
    points = [(1 + mpmath.cos(mpmath.pi * k / 6)) / 2 for k in (1, 3, 5)]
    matrix = mpmath.matrix([[1, t, t * t] for t in points])
    for k, (a, b) in enumerate(_segments(config.quadratic_index_bits)):
        curve = mpmath.matrix([1 / mpmath.sqrt(a + (b - a) * t) for t in points])
        value, slope, bend = mpmath.lu_solve(matrix, curve)
        want = [int(mpmath.floor(c + mpmath.mpf(1) / 2)) for c in
                (value * scale, -slope * scale * 8, bend * scale * 8)]  # fmt: skip
        want[0] = min(want[0], (1 << table.value_bits) - 1)
        assert want == [table.value[k], table.slope[k], table.curve[k]], k
        word = want[0] << (table.slope_bits + table.curve_bits) | want[1] << table.curve_bits
        assert table.words[k] == word | want[2]


@pytest.mark.parametrize("name", ["default", "table_8", "table_2048"])
def test_every_constant(name):
    config = CONFIGS[name]
    for k, (a, b) in enumerate(_segments(config.start_index_bits)):
        middle = (1 / mpmath.sqrt(a) + 1 / mpmath.sqrt(b)) / 2
        code = int(mpmath.floor(middle * config.root.one + mpmath.mpf(1) / 2))
        assert inverse_sqrt_start(config).words[k] == code, k
