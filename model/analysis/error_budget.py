# SPDX-License-Identifier: MIT
"""The error budget: how far the hardware's S can be from eq. (3), derived stage by stage.

Every bound follows from the formats, the tables' segments and the integers at the ports; nothing
is measured. `tests/test_error.py` holds the twin to each stage's bound and to the whole.

Notation: an error is absolute unless called relative; |h| = 1 + eta; w = (hz Yn, hz Xn - hx Zn) is
the normal across the half vector, so that v = 1 - cos(s) = 2 |w|**2.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.config import DEFAULT, Config, Format
from phong75.model.frame import Frame
from phong75.model.quadratic_spans import MARGIN_BITS


@dataclass(frozen=True)
class Row:
    """One line of the budget: where, how much, and why."""

    stage: str
    bound: float
    why: str


def _round(fmt: Format) -> float:
    """Rounding to `fmt`, or clamping 1.0 to its largest code: half an LSB, or one at 1.0."""
    return fmt.lsb / 2


def direction(config: Config) -> float:
    """Angle (radians) between the interpolated normal and its mantissas.

    Half an LSB in each component; the longest component is at least 1/2. (A component clamped
    below 1 loses up to one LSB, but then it is twice as long.)
    """
    return np.sqrt(3) * _round(config.mantissa) / 0.5


def lines(config: Config) -> float:
    """Relative error of `inverse_sqrt_linear` against 1/sqrt of its own operand.

    Straight lines moved halfway: h**2/16 f''; f''/f = 3/(4 x**2), the worst of each octave at its
    left end, where h/x is 2**-root_index_bits. Then half a unit of the value, half a unit of the
    slope, the cut of the product (slopes are 8 times finer than values), and the final rounding
    or, at 1, the clamp by one LSB; those against the smallest root, 1/2.
    """
    h = 2.0**-config.root_index_bits
    value = 2.0**-config.root_value_bits
    line = 0.75 * h**2 / 16
    return line + (value / 2 + value / 16 + value / 8 + _round(config.root)) / 0.5


def parabolas(config: Config) -> float:
    """Relative error of `inverse_sqrt_quadratic` against 1/sqrt of its own operand.

    Through Chebyshev's points: h**3/192 f'''; |f'''|/f = 15/(8 x**3), its worst in the segment
    against the smallest f there, sqrt(1 + h/x) less. Half a unit of the value, and of slope and
    curve (8 times finer), the cuts of two products, and the final rounding.
    """
    h = 2.0**-config.quadratic_index_bits
    value = 2.0**-config.quadratic_value_bits
    curve = 15 / 8 * h**3 / 192 * np.sqrt(1 + h)
    return curve + (value / 2 + 2 * value / 16 + 2 * value / 8 + _round(config.root)) / 0.5


def start(config: Config) -> float:
    """Relative error of the first estimate of `inverse_sqrt_iterated`.

    Table: half the range of a segment against its lower end, (sqrt(1 + h/x) - 1)/2, the worst at
    the left end of an octave, and rounding. Magic: the estimate is a line a - b x in each of three
    pieces (x = 1 to 2; from 2 to where the result's exponent falls; to 4), so that its product with
    sqrt(x) is at its worst at the ends or at x = a/(3 b); and the cut to the word.
    """
    if config.root_method == "table":
        return (np.sqrt(1 + 2.0**-config.start_index_bits) - 1) / 2 + _round(config.root) / 0.5
    constant = (0x5F3759DF - 127 * 2**22 - 125 * 2**23) / 2**23  # 1.93: 2 + log2 of the result
    fall = 4 * (constant - 1)  # constant - log/2 falls below 1, log = x/2
    # Result for log (the number read from x): 2**(i - 2) (1 + constant - log/2 - i), i = 1 or 0.
    pieces = (  # x from, to; a, b
        (1.0, 2.0, (constant + 0.5) / 2, 0.25),  # log = x - 1, i = 1
        (2.0, fall, constant / 2, 0.125),  # log = x/2, i = 1
        (fall, 4.0, (1 + constant) / 4, 0.0625),  # i = 0
    )
    worst = 0.0
    for low, high, a, b in pieces:
        x = np.array([low, high, np.clip(a / (3 * b), low, high)])
        worst = max(worst, float(np.abs((a - b * x) * np.sqrt(x) - 1).max()))
    return worst + config.root.lsb / 0.48


def newton(error: float, config: Config) -> float:
    """Relative error after `newton_step` from an estimate of relative error `error`.

    y (1 + e/2), e = 1 - x y**2 = -2 d - d**2 with d the estimate's error, leaves 3/2 d**2 + d**3/2.
    Half of what is wrong with e: x cut, y**2 rounded (y is 0.48 or more), e itself cut and one
    unit too small. Then the final rounding, or the clamp at 1.
    """
    x_cut = 2.0 ** -(config.root.bits - 2)
    wrong = x_cut + _round(config.root) / 0.48**2 + 2 * 2.0 ** -(config.root.bits + 1)
    return 1.5 * error**2 + 0.5 * error**3 + wrong * (1 + error) ** 2 / 2 + config.root.lsb / 0.5


def inverse_sqrt_linear(config: Config) -> float:
    """Relative error of 1/sqrt of its own operand, by the method of `config`."""
    if config.root_method == "lines":
        return lines(config)
    if config.root_method == "quadratic":
        return parabolas(config)
    error = start(config)
    for _ in range(config.root_newton_steps):
        error = newton(error, config)
    return error


def root_operand(config: Config) -> float:
    """Relative error of the root that comes from cutting |m|**2, 1 or more, to its operand."""
    return config.root_operand.lsb / 2


def length(config: Config) -> float:
    """Relative error of the length of the unit normal, before it is rounded."""
    return inverse_sqrt_linear(config) + root_operand(config)


def squares(frame: Frame, config: Config) -> float | None:
    """`quadratic_spans`: the largest error of an interpolated square anywhere along the spans of
    `frame`, against the exact |N|**2 there. None where it is not bounded or means nothing.

    The three words are rounded by half a unit each: after k steps 1 + k + k (k - 1)/2 of it. Over
    a span, at its last pixel against its smallest |N|**2, which is where N comes nearest to 0. Not
    bounded: |N|**2 leaves its word (convex: at an end), or may be so wrong that the other square
    could pass for more than |N|**2 in spite of its margin.
    """
    spans = frame.spans[frame.spans["length"] > 0]
    start, step = (config.normal.real(spans[name]) for name in ("start", "step"))
    last = spans["length"].astype(float) - 1
    bend = (step**2).sum(axis=1)
    nearest = np.clip(-(start * step).sum(axis=1) / np.where(bend > 0, bend, 1), 0, last)

    def square(k):
        return ((start + k[:, None] * step) ** 2).sum(axis=1)

    error = (1 + last + last * (last - 1) / 2) * config.squared.lsb / 2
    if (np.maximum(square(0 * last), square(last)) + error >= 1 << config.squared.integer).any():
        return None
    worst = float(np.max(error / np.maximum(square(nearest), config.squared.lsb), initial=0.0))
    return worst if 2 * worst <= 2.0**-MARGIN_BITS else None


def root_of_square(square: float, config: Config) -> float:
    """Relative error of 1/|N| by `quadratic_spans`: the method's own, and that of |N|**2 (relative,
    `square`)."""
    return (1 + length(config)) / np.sqrt(1 - square) - 1


def cosine(config: Config, square: float = 0.0) -> float:
    """Error of cos(i) = Zn: direction, length, and rounding or, at 1, the clamp by one LSB.

    By `quadratic_spans`, Zn is aligned to a word below 2 and |N| to [1, 2): half an LSB of it by
    the largest root, 1, or, where it is clamped, a whole one, and what |N| may be too
    small by, by the smallest, 1/2. square: see `squares`.
    """
    if config.normal_method == "quadratic_spans":
        word = config.quadratic_mantissa.lsb
        stretch = 1 / np.sqrt(1 - square)
        clamped = (word + 2 * (stretch - 1)) * stretch / (2 - word / 2)
        return clamped * (1 + length(config)) + root_of_square(square, config) + config.cosine.lsb
    return direction(config) + length(config) + config.cosine.lsb


def across(half_vector, config: Config) -> tuple[float, float]:
    """Error of w: (relative, absolute) parts.

    Relative: length of the unit normal, and |h|. Absolute, by `dot_first`: the direction, the parts
    of a mantissa (1/2 or longer) rounded with one bit less, and rounded again once scaled. Else:
    the direction (the map N -> w has norm |h|), the rounded components of N (one of them may be
    clamped at 1 by a whole LSB), and the rounding of the two components of w.
    """
    h = config.half_vector.real(half_vector)
    norm = float(np.hypot(*h))
    hx, hz = np.abs(h)
    half = _round(config.unit)
    if config.normal_method == "dot_first":
        parts = np.sqrt(2) * (config.mantissa.lsb / 0.5 + half)
        return length(config) + abs(norm - 1), float(norm * direction(config) + parts)
    components = half * max(np.hypot(2 * hz, hx + hz), np.hypot(hz, hx + hz + max(hx, hz)))
    absolute = norm * direction(config) + components + np.sqrt(2) * half
    return length(config) + abs(norm - 1), float(absolute)


def quotient(v, config: Config, square: float):
    """Error of v (float array, 0 to 1) = 2 |N x h|**2/|N|**2 by `quadratic_spans`; square: see
    `squares`.

    Relative: the margin and the error of |N|**2. Absolute: the error of the other square. Then the
    reciprocal: twice the error of the root, and half a unit against 1/4 or more. The cut of the
    other square: relative where its top bit is set, absolute where it was shifted by all of 15.
    The cut of the product, and rounding or, at 1, the clamp by one LSB.
    """
    q = np.asarray(v) / 2
    wrong = ((2.0**-MARGIN_BITS + square) * q + square) / (1 - square)
    reciprocal = (1 + length(config)) ** 2 - 1 + 4 * _round(config.root)
    fraction = config.quadratic_mantissa.bits - 2
    cut = (1 + reciprocal) * (2.0 ** -(fraction + 1) * (q + wrong) + 2.0 ** -(fraction + 15))
    product = 2.0 ** -(fraction + config.root.fraction)
    return 2 * (wrong + (q + wrong) * reciprocal + cut + product) + config.versine.lsb


def versine(v, half_vector, config: Config, square: float = 0.0):
    """Error of v (float array, 0 to 1) = 2 |w|**2: twice the growth of the square, and rounding.

    square: by `quadratic_spans`, see `squares`.
    """
    if config.normal_method == "quadratic_spans":
        return quotient(v, config, square)
    relative, absolute = across(half_vector, config)
    w = np.sqrt(np.asarray(v) / 2)
    dw = relative * w + absolute
    return 2 * (2 * w * dw + dw**2) + _round(config.versine)


def squaring(n: int, config: Config) -> float:
    """Error of `specular_power_squaring` against (1 - v)**n of its own operands, n whole.

    cos(s) is rounded, or at 1 clamped by one LSB; a square doubles the error and is rounded. A
    product of two words of at most 1 has at most the sum of their errors, and is rounded.
    """
    half = _round(config.power)
    base, total, factors = config.power.lsb, 0.0, 0
    for j in range(config.exponent.integer):
        if n >> j & 1:
            total += base
            factors += 1
        base = 2 * base + half
    return total + (factors - 1) * half


def specular_power_tables(n: float, config: Config) -> float:
    """Error of cos(s)**n against (1 - v)**n of its own operands, by the method of `config`.

    By tables: with x = n * -log2(cos s), an error dx changes the power by at most 2**-x ln 2 dx.
    log: straight lines (the first is clipped at 0: no halving), half a unit of value and of slope,
    the cut of the product. Mantissa of the log: cut to `log_mantissa_bits`, relative, x 2**-x ln 2
    is at most 1/e. x: cut, but the table of 2**-f is centred on the cut. exp: straight lines, half
    a unit of value and slope, the cuts of the product and of the shift. Then rounding or, at 1,
    the clamp by one LSB.
    """
    if config.power_method == "squaring":
        return squaring(int(n), config)
    if n == 1:
        return config.power.lsb
    c = np.linspace(0.5, 1, 4097)
    h = 2.0 ** -(config.log_index_bits + 1)
    unit = config.log_value.lsb
    log_error = h**2 / 8 / np.log(2) / c[:-1] ** 2 + unit / 2 + unit / 2 + unit
    log_part = float(np.max(c[1:] ** n * n * np.log(2) * log_error))
    mantissa_part = 2.0 ** -(config.log_mantissa_bits - 1) / np.e
    cut_part = np.log(2) * config.power_log.lsb / 2
    unit, h = config.exp_value.lsb, 2.0**-config.exp_index_bits
    exp_part = np.log(2) ** 2 * h**2 / 16 + unit / 2 + unit / 2 + unit + unit
    return log_part + mantissa_part + cut_part + exp_part + config.power.lsb


def power(n: float, half_vector, config: Config, square: float = 0.0) -> float:
    """Error of cos(s)**n: that of v carried through the power, and the power's own.

    n c**(n-1) dv, with c at the end of each step of v where it is largest and dv where it is
    largest: a bound, not an estimate.
    """
    v = np.linspace(0, 1, 1025) ** 2  # dense near the highlight
    dv = versine(v[1:], half_vector, config, square)
    c = np.minimum(1 - v[:-1] + dv, 1)
    return float(np.max(n * c ** (n - 1) * dv)) + specular_power_tables(n, config)


def weight(points, config: Config, square: float = 0.0) -> float:
    """Error of W(i), codes `points` int[P]: the steepest line times the error of Zn, rounding."""
    real = config.coefficient.real(points)
    steepest = float(np.abs(np.diff(real)).max()) * (len(real) - 1)
    return steepest * cosine(config, square) + _round(config.weight)


def rows(material: int, frame: Frame, config: Config = DEFAULT) -> list[Row]:
    """The budget of one material of `frame`; the last row bounds |code - 255 S| in LSB.

    S is eq. (3) at the pixel; for Gouraud and flat shading, the interpolated intensity. By
    `quadratic_spans` only where `squares` has a bound.
    """
    white = (1 << config.colour_bits) - 1
    if config.technique != "phong":
        cut = Row("cut of S", config.intensity.lsb, "interpolation is exact, the sum is cut once")
        total = white * cut.bound + 0.5
        return [cut, Row("code", total, f"LSB: {white} times the cut, and the final rounding")]
    table = frame.materials
    n = float(config.exponent.real(table.exponent[material]))
    diffuse = float(config.coefficient.real(table.diffuse[material]).max())
    w = float(config.coefficient.real(table.weight[material]).max())
    square = 0.0
    if config.normal_method == "quadratic_spans":
        square = squares(frame, config)
        parts = [
            Row("squares", square, "interpolated, against |N|^2"),
            Row("normalizer: length", root_of_square(square, config), "1/sqrt of |N|^2, relative"),
            Row("cos(i)", cosine(config, square), "Zn aligned, length, rounding"),
            Row("1 - cos(s)", float(quotient(1.0, config, square)), "largest: at cos(s) = 0"),
        ]
    else:
        parts = [
            Row("normalizer: direction", direction(config), "mantissas of the normal, radians"),
            Row("normalizer: length", length(config), "1/sqrt and its operand, relative"),
            Row("cos(i)", cosine(config), "direction, length, rounding"),
            Row("w", across(frame.half_vector, config)[1], "direction, rounding; absolute part"),
        ]
    parts += [
        Row(
            "specular_power_tables",
            specular_power_tables(n, config),
            f"log and exp tables, n = {n:g}",
        ),
    ]
    if w > 0:
        specular = w * power(n, frame.half_vector, config, square)
        weight_error = weight(table.weight[material], config, square)
    else:
        specular = weight_error = 0.0
    parts += [
        Row("diffuse term", diffuse * cosine(config, square),
            "Cp (1 - d) times the error of cos(i)"),
        Row("specular term", specular, "W times the error of cos(s)^n"),
        Row("W(i)", weight_error, "steepest line times the error of cos(i), rounding"),
        Row("cut of S", config.intensity.lsb, "products are whole, the sum is cut once"),
    ]  # fmt: skip
    total = white * sum(row.bound for row in parts[5:]) + 0.5
    return [*parts, Row("code", total, f"LSB: {white} times the terms, and the final rounding")]


def derived(config: Config, n: float) -> bool:
    """Whether the budget covers the methods of `config` for the exponent `n`."""
    power_method = config.power_method == "tables" or (
        config.power_method == "squaring" and n == int(n)
    )
    return config.normal_method in ("normalize", "dot_first", "quadratic_spans") and power_method


def bound_lsb(frame: Frame, config: Config = DEFAULT) -> float | None:
    """Bound of |code - 255 S| in LSB over the materials that `frame` uses (1/2 if it has none).

    None where no bound is derived for a method of `config`, or none for the spans (`squares`).
    """
    used = np.unique(frame.spans["material"]).tolist()
    exponents = config.exponent.real(frame.materials.exponent[used])
    if not all(derived(config, n) for n in exponents.tolist()):
        return None
    if config.normal_method == "quadratic_spans" and squares(frame, config) is None:
        return None
    return max((rows(m, frame, config)[-1].bound for m in used), default=0.5)
