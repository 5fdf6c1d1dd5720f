# SPDX-License-Identifier: MIT
"""Error budget: bound of the difference between the hardware's S and eq. (3), derived by stage.

Every bound follows from the formats, the segments of the tables and the integers at the ports.
Nothing is measured. tests/test_error.py compares the twin with the bound of each stage and with the
bound of the whole.

Notation: errors are absolute unless called relative. |h| = 1 + eta. w = (hz Yn, hz Xn - hx Zn) are
the components of the cross product of the unit normal and the half vector h, so that the versine is
v = 1 - cos(s) = 2 |w|**2. With several lights, 1/|N| is that of the first light's normal N0 for all
of them; `reach` is the largest |N|/|N0| of a further light over the pixels of a frame, 1 but for
the rounding at the ports, and None for the first light.

What the derivation leaves out, and how much that is with the default words:

- products of two errors of the normalizer (direction, length, |h| - 1), below 3e-10 of a length: at
  most 2e-6 LSB of a colour code, where W is steepest;
- the change of f'' within a segment of a table of lines. Relative to the term of the lines, that of
  1/sqrt may be larger by sqrt(1 + 2**-8) - 1 = 0.2 %, that of the logarithm by 2**-10/c = 0.2 %: at
  most 1e-5 LSB each, where W is steepest and for n = 128.

`certificate` leaves out nothing: it exhausts both tables, and bounds the products. Its bounds hold
for all frames at once and are lower; those of this module are for one frame, and say which stage
costs what.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.analysis.reference import span_of_pixels
from phong75.model.arrays import ArrayLike, Ints, Reals, Spans
from phong75.model.config import DEFAULT, Config, Format
from phong75.model.frame import Frame, with_lights
from phong75.model.quadratic_spans import MARGIN_BITS
from phong75.model.reflectance import power_words, segments, weight_value
from phong75.model.twin.core.span_walker import walk
from phong75.model.twin.techniques.second_difference_interpolator import parabola


@dataclass(frozen=True)
class BudgetRow:
    """One line of the budget: the stage, the bound and its reason."""

    stage: str
    bound: float
    why: str


def _round(fmt: Format) -> float:
    """Largest error of rounding to `fmt`: half an LSB.

    The value 1.0 may be clamped to the largest code, which is an error of a whole LSB; the callers
    account for it where it matters.
    """
    return fmt.lsb / 2


def direction(config: Config, tilt: float = 0.0) -> float:
    """Angle, radians, between the interpolated normal and the vector of its mantissas.

    Each component is rounded by at most half an LSB, and the longest component is at least 1/2. A
    component that is clamped below 1 loses up to one LSB, but is then twice as long. tilt: see
    `tilt_of_words`, which comes before.
    """
    return np.sqrt(3) * _round(config.mantissa) / 0.5 + tilt


def tilt_of_words(frame: Frame, config: Config) -> float | None:
    """Largest angle, radians, between the normal of a pixel and its words at the normalizer; 0
    unless normals are quadratic.

    `second_difference_interpolator` leaves out the bits of each component that `bend` has beyond
    `normal`. This moves a component by less than one LSB, and changes neither its sign nor whether
    the normal is the zero vector. The bound is that of the shortest normal that is moved. Returns
    None if one is no longer than the largest error: its direction is lost.
    """
    if config.normal_order == 1:
        return 0.0
    spans = frame.spans[frame.spans["bend"].any(axis=1)]
    cut, shortest = (1 << config.bend_fraction_bits) - 1, np.inf
    for _, pixels in walk(spans, config):
        start, step, bend = (spans[word][pixels.span].T for word in ("start", "step", "bend"))
        normal = parabola(start, step, bend, pixels.k, config)
        moved = (normal & cut != 0).any(axis=0)
        length = np.sqrt((config.bend.real(normal[:, moved]) ** 2).sum(axis=0))
        shortest = min(shortest, float(np.min(length, initial=np.inf)))
    sine = np.sqrt(3) * config.normal.lsb / shortest
    return float(np.arcsin(sine)) if sine < 1 else None


def inverse_sqrt_linear(config: Config) -> float:
    """Relative error of `inverse_sqrt_linear` against 1/sqrt of its rounded operand.

    Lines: a chord moved by half its largest error has the error h**2/16 f'', h the length of the
    segment. f''/f = 3/(4 x**2) is largest at the left end of an octave, where
    h/x = 2**-root_index_bits. (f'' and f are taken at the same end of the segment; f at the other
    end is smaller by sqrt(1 + h/x).)
    Words, relative to the smallest root, 1/2: half a unit of the value; half a unit of the slope
    and the truncated product (slopes are 8 times finer than values); the final rounding or, at 1,
    the clamp by one LSB.
    """
    h = 2.0**-config.root_index_bits
    value = 2.0**-config.root_value_bits
    line = 0.75 * h**2 / 16
    return line + (value / 2 + value / 16 + value / 8 + _round(config.root)) / 0.5


def inverse_sqrt_quadratic(config: Config) -> float:
    """Relative error of `inverse_sqrt_quadratic` against 1/sqrt of its rounded operand.

    Parabolas through Chebyshev's points: the error is h**3/192 f'''. |f'''|/f = 15/(8 x**3); the
    largest f''' of a segment is divided by the smallest f, which is smaller by sqrt(1 + h/x).
    Words: half a unit of the value, of the slope and of the curvature (both 8 times finer), two
    truncated products, and the final rounding.
    """
    h = 2.0**-config.quadratic_index_bits
    value = 2.0**-config.quadratic_value_bits
    curve = 15 / 8 * h**3 / 192 * np.sqrt(1 + h)
    return curve + (value / 2 + 2 * value / 16 + 2 * value / 8 + _round(config.root)) / 0.5


def inverse_sqrt_start(config: Config) -> float:
    """Relative error of the first estimate of `inverse_sqrt_iterated`.

    Table of constants: half the range of f in a segment relative to its lower end,
    (sqrt(1 + h/x) - 1)/2, largest at the left end of an octave; and rounding.
    Fast inverse square root: the estimate is a line a - b x in each of three pieces: x from 1 to 2;
    from 2 to the point where the exponent of the result falls; from there to 4. Its product with
    sqrt(x) has its extremes at the ends of a piece or at x = a/(3 b). Then the truncation to the
    word.
    """
    if config.root_method == "table":
        return (np.sqrt(1 + 2.0**-config.start_index_bits) - 1) / 2 + _round(config.root) / 0.5
    # The bits of a float32 x, read as a number, are log, a piecewise linear log2(x). The constant,
    # 1.93, minus log/2 gives the result in the same form, with an offset of 2:
    # result = 2**(i - 2) (1 + constant - log/2 - i), i = 1 or 0.
    constant = (0x5F3759DF - 127 * 2**22 - 125 * 2**23) / 2**23
    fall = 4 * (constant - 1)  # x at which constant - log/2 falls below 1; log = x/2 there
    pieces = (  # x from, x to, a, b
        (1.0, 2.0, (constant + 0.5) / 2, 0.25),  # log = x - 1, i = 1
        (2.0, fall, constant / 2, 0.125),  # log = x/2, i = 1
        (fall, 4.0, (1 + constant) / 4, 0.0625),  # i = 0
    )
    worst = 0.0
    for low, high, a, b in pieces:
        x = np.array([low, high, np.clip(a / (3 * b), low, high)])
        worst = max(worst, float(np.abs((a - b * x) * np.sqrt(x) - 1).max()))
    return worst + config.root.lsb / 0.48


def newton_step(error: float, config: Config) -> float:
    """Relative error after `newton_step`, from an estimate y of relative error d = `error`.

    The step is y (1 + e/2) with e = 1 - x y**2 = -2 d - d**2. It leaves the relative error
    3/2 d**2 + d**3/2. The error of e counts half: x is truncated, y**2 is rounded (y is at least
    0.48), e itself is truncated and one unit too small. Then the final rounding, or the clamp at 1.
    """
    x_truncation = 2.0 ** -(config.root.bits - 2)
    e_error = x_truncation + _round(config.root) / 0.48**2 + 2 * 2.0 ** -(config.root.bits + 1)
    return 1.5 * error**2 + 0.5 * error**3 + e_error * (1 + error) ** 2 / 2 + config.root.lsb / 0.5


def inverse_sqrt(config: Config) -> float:
    """Relative error of 1/sqrt of the rounded operand, by the method `config.root_method`."""
    if config.root_method == "lines":
        return inverse_sqrt_linear(config)
    if config.root_method == "quadratic":
        return inverse_sqrt_quadratic(config)
    error = inverse_sqrt_start(config)
    for _ in range(config.root_newton_steps):
        error = newton_step(error, config)
    return error


def root_operand(config: Config) -> float:
    """Relative error of the root from truncating |m|**2 (at least 1) to the operand's format."""
    return config.root_operand.lsb / 2


def length(config: Config) -> float:
    """Relative error of the length of the unit normal before its components are rounded."""
    return inverse_sqrt(config) + root_operand(config)


def held_length(config: Config) -> float:
    """Relative error of 1/|N0| where it scales another light's normal.

    The errors of `length`, and the mantissas of N0, whose length differs from |N0| by at most
    `direction`; N0 itself is scaled by the length of its own mantissas.
    """
    return (1 + length(config)) / (1 - direction(config)) - 1


def reaches(frame: Frame) -> list[float]:
    """`reach` of each further light of `frame`, at least 1.

    Lengths are computed in float64, whose error the margin of 2**-40 covers.
    """
    spans = frame.spans
    span, k = span_of_pixels(spans)
    k = k[:, None]

    def squared(start: Ints, step: Ints) -> Reals:
        return np.square((start[span] + k * step[span]).astype(np.float64)).sum(axis=1)

    first = squared(spans["start"], spans["step"])
    found = []
    for light in frame.further:
        ratio = squared(light.start, light.step)[first > 0] / first[first > 0]
        found.append(max(1.0, float(np.sqrt(ratio.max(initial=1.0)))) * (1 + 2.0**-40))
    return found


def squares_of_spans(spans: Spans, config: Config) -> Reals:
    """Relative error of the interpolated squares of `quadratic_spans`, float64[n], at the pixel of
    each of `spans` where it is largest; infinite where there is no bound.

    A square is computed from three words, each rounded by at most half an LSB. After k steps the
    error is at most 1 + k + k (k - 1)/2 half LSBs. The bound of a span is this error at the last
    pixel, relative to the smallest |N|**2 of the span.
    There is no bound if |N|**2 may leave its word (it is convex along the span, so its maximum is
    at an end), or the error may exceed the margin that keeps the cross square below |N|**2
    (`MARGIN_BITS`).
    """
    start, step = (config.normal.real(spans[name]) for name in ("start", "step"))
    last = np.maximum(spans["length"].astype(float) - 1, 0)
    bend = (step**2).sum(axis=1)
    nearest = np.clip(-(start * step).sum(axis=1) / np.where(bend > 0, bend, 1), 0, last)

    def square(k: Reals) -> Reals:
        return ((start + k[:, None] * step) ** 2).sum(axis=1)

    error = (1 + last + last * (last - 1) / 2) * config.squared.lsb / 2
    relative = error / np.maximum(square(nearest), config.squared.lsb)
    fits = np.maximum(square(0 * last), square(last)) + error < 1 << config.squared.integer
    bounded: Reals = np.where(fits & (2 * relative <= 2.0**-MARGIN_BITS), relative, np.inf)
    return bounded


def squares(frame: Frame, config: Config) -> float | None:
    """The largest of `squares_of_spans` over `frame`; None if a span has no bound."""
    spans = frame.spans[frame.spans["length"] > 0]
    worst = float(np.max(squares_of_spans(spans, config), initial=0.0))
    return worst if worst < np.inf else None


def refusal(frame: Frame, config: Config) -> str:
    """Why `config` must not shade `frame`: its method has no bound for a span of it; else ""."""
    if not config.spans_carry_squares:
        return ""
    wrong = np.isinf(squares_of_spans(frame.spans, config)) & (frame.spans["length"] > 0)
    if not wrong.any():
        return ""
    return (
        f"span {int(np.argmax(wrong))} is not for quadratic_spans: its normal gets 2 or longer, or "
        f"so short that the rounding of its squares exceeds 2^-{MARGIN_BITS + 1} of |N|^2"
    )


def root_of_square(square: float, config: Config) -> float:
    """Relative error of 1/|N| by `quadratic_spans`; square: relative error of |N|**2."""
    return (1 + length(config)) / np.sqrt(1 - square) - 1


def cosine(
    config: Config, square: float = 0.0, tilt: float = 0.0, reach: float | None = None
) -> float:
    """Error of cos(i) = Zn: direction, length, and the final rounding or, at 1, the clamp.

    For a further light the mantissas are relative to N0. They are rounded by half an LSB, with one
    bit less where a component is longer than the word; both are at most `direction` times `reach`.

    `quadratic_spans` aligns Zn to a word below 2 and |N| to [1, 2). The error is then half an LSB
    of this word times the largest root, 1; or, where Zn is clamped, a whole LSB plus the possible
    shortfall of |N|, times the smallest root, 1/2. square: see `squares`. tilt: see `direction`.
    """
    if config.normal_method == "quadratic_spans":
        word = config.quadratic_mantissa.lsb
        stretch = 1 / np.sqrt(1 - square)
        clamped = (word + 2 * (stretch - 1)) * stretch / (2 - word / 2)
        return clamped * (1 + length(config)) + root_of_square(square, config) + config.cosine.lsb
    if reach is not None:
        return reach * (direction(config) + held_length(config)) + config.cosine.lsb
    return direction(config, tilt) + length(config) + config.cosine.lsb


def half_vector_cross(
    half_vector: ArrayLike, config: Config, tilt: float = 0.0, reach: float | None = None
) -> tuple[float, float]:
    """Error of w as two parts (relative, absolute); half_vector: its codes (hx, hz), or those of
    several spans, int[n, 2], over which each part is the largest. tilt: see `direction`.

    Relative: the length of the unit normal, and |h| - 1.
    Absolute, for `dot_first`: the direction; the components of the cross product of a mantissa (1/2
    or longer), which are rounded to one bit less; and their rounding after the scale.
    Absolute, else: the direction (the map N -> w has the norm |h|); the rounded components of N,
    one of which may be clamped at 1 by a whole LSB (each of them where `reach` lets two be 1); and
    the rounding of the two components of w.
    """
    h = config.half_vector.real(half_vector)
    norm = np.hypot(h[..., 0], h[..., 1])
    hx, hz = np.abs(h[..., 0]), np.abs(h[..., 1])
    half = _round(config.unit)
    off = float(np.max(np.abs(norm - 1)))
    if config.normal_method == "dot_first":
        rounding = np.sqrt(2) * (config.mantissa.lsb / 0.5 + half)
        return length(config) + off, float(np.max(norm * direction(config, tilt) + rounding))
    components = half * np.maximum(
        np.hypot(2 * hz, hx + hz), np.hypot(hz, hx + hz + np.maximum(hx, hz))
    )
    if reach is None:
        absolute = norm * direction(config, tilt) + components + np.sqrt(2) * half
        return length(config) + off, float(np.max(absolute))
    if reach > 1.4:
        components = 2 * components
    absolute = reach * norm * direction(config) + components + np.sqrt(2) * half
    return held_length(config) + off, float(np.max(absolute))


def quadratic_versine(v: ArrayLike, config: Config, square: float) -> Reals:
    """Error of the versine v = 2 C/|N|**2 (float array, 0 to 1) by `quadratic_spans`.

    C: the cross square (see `quadratic_spans`). square: see `squares`. The terms, for q = v/2:

    - the quotient of the squares: relative, the margin and the error of |N|**2; absolute, the error
      of C;
    - the reciprocal of |N|**2: twice the error of the root, and half a unit relative to 1/4;
    - the truncation of C: relative where its top bit is set, absolute where the shift is
      limited to 15;
    - the truncation of the product; and the final rounding or, at 1, the clamp by one LSB.
    """
    q = np.asarray(v) / 2
    q_error = ((2.0**-MARGIN_BITS + square) * q + square) / (1 - square)
    reciprocal = (1 + length(config)) ** 2 - 1 + 4 * _round(config.root)
    fraction = config.quadratic_mantissa.bits - 2
    truncation = 2.0 ** -(fraction + 1) * (q + q_error) + 2.0 ** -(fraction + 15)
    truncation = (1 + reciprocal) * truncation
    product = 2.0 ** -(fraction + config.root.fraction)
    total = q_error + (q + q_error) * reciprocal + truncation + product
    return 2 * total + config.versine.lsb


def versine(
    v: ArrayLike, half_vector: ArrayLike, config: Config, square: float = 0.0, tilt: float = 0.0,
    reach: float | None = None,
) -> Reals:  # fmt: skip
    """Error of the versine v = 2 |w|**2 (float array, 0 to 1).

    An error dw of |w| changes |w|**2 by 2 |w| dw + dw**2; then v is rounded. half_vector: codes
    (hx, hz). square: for `quadratic_spans`, see `squares`. tilt: see `direction`.
    """
    if config.normal_method == "quadratic_spans":
        return quadratic_versine(v, config, square)
    relative, absolute = half_vector_cross(half_vector, config, tilt, reach)
    w = np.sqrt(np.asarray(v) / 2)
    dw = relative * w + absolute
    return 2 * (2 * w * dw + dw**2) + _round(config.versine)


def specular_power_squaring(n: int, config: Config) -> float:
    """Error of `specular_power_squaring` against (1 - v)**n of its operands; n must be whole.

    cos(s) is rounded or, at 1, clamped by one LSB. Squaring doubles the error and adds a rounding.
    The product of two words of at most 1 has at most the sum of their errors, and is rounded.
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
    """Error of `specular_power_tables` against (1 - v)**n of its operands.

    With x = n * -log2(cos s), an error dx changes the power by at most 2**-x ln 2 dx. The terms:

    - logarithm: chords (not moved, because the first one must not go below 0) with f'' at the
      operand, half a unit of value and of slope, the truncated product;
    - mantissa of the logarithm: truncated to `log_mantissa_bits`, a relative error of x, and
      x 2**-x ln 2 is at most 1/e;
    - x: truncated; the table of 2**-f is centred on the truncation, which halves this error;
    - exponential: moved chords, half a unit of value and of slope, the truncated product and shift;
    - the final rounding or, at 1, the clamp by one LSB.
    """
    if n == 1:
        return config.power.lsb
    c = np.linspace(0.5, 1, 4097)
    h = 2.0 ** -(config.log_index_bits + 1)
    unit = config.log_value.lsb
    log_error = h**2 / 8 / np.log(2) / c[:-1] ** 2 + unit / 2 + unit / 2 + unit
    log_term = float(np.max(c[1:] ** n * n * np.log(2) * log_error))
    mantissa_term = 2.0 ** -(config.log_mantissa_bits - 1) / np.e
    x_term = np.log(2) * config.power_log.lsb / 2
    unit, h = config.exp_value.lsb, 2.0**-config.exp_index_bits
    exp_term = np.log(2) ** 2 * h**2 / 16 + unit / 2 + unit / 2 + unit + unit
    return log_term + mantissa_term + x_term + exp_term + config.power.lsb


def specular_power(n: float, config: Config) -> float:
    """Error of cos(s)**n against (1 - v)**n of its operands, by the method `config.power_method`.

    n must be whole for "squaring".
    """
    if config.power_method == "squaring":
        return specular_power_squaring(int(n), config)
    return specular_power_tables(n, config)


def power(
    n: float, half_vector: ArrayLike, config: Config, square: float = 0.0, tilt: float = 0.0,
    reach: float | None = None,
) -> float:  # fmt: skip
    """Error of cos(s)**n: the error dv of v carried through the power, and `specular_power`.

    v is divided into steps. Each step contributes n c**(n-1) dv with the largest c = cos(s) and the
    largest dv of the step, so that the result is a bound and not an estimate. half_vector, square,
    tilt: see `versine`.
    """
    v = np.linspace(0, 1, 1025) ** 2  # dense near the highlight
    dv = versine(v[1:], half_vector, config, square, tilt, reach)
    c = np.minimum(1 - v[:-1] + dv, 1)
    return float(np.max(n * c ** (n - 1) * dv)) + specular_power(n, config)


def curve(
    words: Ints, half_vector: ArrayLike, config: Config, square: float = 0.0, tilt: float = 0.0,
    reach: float | None = None,
) -> float:  # fmt: skip
    """Error of a curve by table against its lines at the exact 1 - cos(s).

    words: int[S, 2], {left, step} of each line. The line is exact; its slope carries the largest
    error of v in its segment. Then the saturation of v below 1, the rounding, and the clamp at 1.
    It holds for the side of each jump and for the line that the hardware chooses; within the error
    of v of the end of a line that can be another one than for the exact operands (see `undecided`).
    half_vector, square, tilt, reach: see `versine`.
    """
    cut = segments(config)
    last = cut.versine([0.0, 1.0], config).max(axis=0)
    beyond = float(versine(1.0, half_vector, config, square, tilt, reach))
    dv = versine(np.minimum(last + beyond, 1), half_vector, config, square, tilt, reach)
    slope = np.abs(config.coefficient.real(words[:, 1])) / (cut.length * config.versine.lsb)
    return float(np.max(slope * (dv + _round(config.versine)))) + config.power.lsb


def highlight(
    material: int, half_vector: ArrayLike, frame: Frame, config: Config, square: float = 0.0,
    tilt: float = 0.0, reach: float | None = None,
) -> float:  # fmt: skip
    """Error of cos(s)**n or of the curve of one `material`. The other arguments: see `versine`."""
    table = frame.materials
    if config.has_curves:
        words = table.curve[material] if table.curve is not None else power_words(
            table.exponent[material : material + 1], config
        )[0]  # fmt: skip
        return curve(words, half_vector, config, square, tilt, reach)
    n = float(config.exponent.real(table.exponent[material]))
    return power(n, half_vector, config, square, tilt, reach)


def largest_weight(material: int, frame: Frame, config: Config) -> float:
    """The largest W(i) of one `material`."""
    table = frame.materials
    points = table.weight[material]
    if table.weight_jumps is None:
        return float(config.coefficient.real(points).max())
    jumps = table.weight_jumps[material]
    places = config.cosine.real(np.concatenate([jumps[:, 1], jumps[:, 1] - 1]))
    zn = np.clip(np.concatenate([np.linspace(0, 1, len(points)), places]), 0, 1)
    return float(
        weight_value(
            np.broadcast_to(points, (len(zn), len(points))),
            np.broadcast_to(jumps, (len(zn), *jumps.shape)), zn, config,
        ).max()
    ) + float(np.abs(np.diff(config.coefficient.real(points))).max()) * config.cosine.lsb * (
        len(points) - 1
    )  # fmt: skip


def weight(
    points: Ints, config: Config, square: float = 0.0, tilt: float = 0.0,
    reach: float | None = None,
) -> float:  # fmt: skip
    """Error of W(i): the steepest line of the table times the error of Zn, and the final rounding.

    points: int[P], codes of W in `Config.coefficient`. square: see `squares`. tilt: see
    `direction`.
    """
    real = config.coefficient.real(points)
    steepest = float(np.abs(np.diff(real)).max()) * (len(real) - 1)
    return steepest * cosine(config, square, tilt, reach) + _round(config.weight)


def attenuated(error: float, most: float, number: int, frame: Frame, config: Config) -> float:
    """Error of a word of the light `number` (u0.18) times the factor of the distance.

    error: of the word, which is at most `most`. The distance is cut to 18 bits, which moves the
    factor by less than the steepest line of its table times that bit; then the factor is rounded,
    and so is the product. A product of words below 1 and at most 1 is not clamped.
    """
    if not config.attenuation or frame.falloff is None:
        return error
    points = config.coefficient.real(frame.falloff[number])
    steepest = float(np.abs(np.diff(points)).max()) * (len(points) - 1)
    factor = steepest * config.cosine.lsb + _round(config.weight)
    return float(points.max()) * error + (most + error) * factor + _round(config.cosine)


def rows(
    material: int, frame: Frame, config: Config = DEFAULT, tilt: float | None = 0.0
) -> list[BudgetRow]:
    """The budget of one `material` (index) of `frame`; the last row bounds |code - 255 S| in LSB.

    S is eq. (3) at the pixel; for Gouraud and flat shading S is the interpolated intensity. For
    `quadratic_spans` ValueError is raised if `squares` has no bound. tilt: `tilt_of_words` of
    `frame`; ValueError is raised for None.
    """
    if tilt is None:
        raise ValueError("a quadratic normal is shorter than the error of its words")
    white = config.white
    if config.sums_lights:
        return light_rows(material, frame, config, reaches(frame))
    if config.technique != "phong":
        cut = BudgetRow(
            "cut of S", config.intensity.lsb, "interpolation is exact, S is truncated once"
        )
        total = white * cut.bound + 0.5
        return [
            cut,
            BudgetRow("code", total, f"LSB: {white} times the cut, and the final rounding"),
        ]
    table = frame.materials
    n = float(config.exponent.real(table.exponent[material]))
    diffuse = float(config.coefficient.real(table.diffuse[material]).max())
    w = largest_weight(material, frame, config)
    square = 0.0
    if config.normal_method == "quadratic_spans":
        bound = squares(frame, config)
        if bound is None:
            raise ValueError("the interpolated squares have no bound")
        square = bound
        parts = [
            BudgetRow("squares", square, "interpolated, against |N|^2"),
            BudgetRow(
                "normalizer: length", root_of_square(square, config), "1/sqrt of |N|^2, relative"
            ),
            BudgetRow("cos(i)", cosine(config, square), "Zn aligned, length, rounding"),
            BudgetRow(
                "1 - cos(s)",
                float(quadratic_versine(1.0, config, square)),
                "the largest, at cos(s) = 0",
            ),
        ]
    else:
        parts = [
            BudgetRow(
                "normalizer: direction", direction(config, tilt), "mantissas of the normal, radians"
            ),
            BudgetRow("normalizer: length", length(config), "1/sqrt and its operand, relative"),
            BudgetRow("cos(i)", cosine(config, tilt=tilt), "direction, length, rounding"),
            BudgetRow(
                "w",
                half_vector_cross(frame.half_vector, config, tilt)[1],
                "direction, rounding; absolute part",
            ),
        ]
    method = {"tables": "log and exp tables", "squaring": "repeated squaring"}
    parts.append(
        BudgetRow("specular power", config.power.lsb, "rounding of the curve; its lines are exact")
        if config.has_curves
        else BudgetRow(
            "specular power",
            specular_power(n, config),
            f"{method.get(config.power_method, config.power_method)}, n = {n:g}",
        )
    )
    if w > 0:
        specular = w * highlight(material, frame.half_vector, frame, config, square, tilt)
        weight_error = weight(table.weight[material], config, square, tilt)
    else:
        specular = weight_error = 0.0
    parts += [
        BudgetRow("diffuse term", diffuse * cosine(config, square, tilt),
            "Cp (1 - d) times the error of cos(i)"),
        BudgetRow("specular term", specular, "W times the error of cos(s)^n"),
        BudgetRow("W(i)", weight_error, "steepest line times the error of cos(i), rounding"),
        BudgetRow("cut of S", config.intensity.lsb,
                  "products are exact, the sum is truncated once"),
    ]  # fmt: skip
    total = white * sum(row.bound for row in parts[5:]) + 0.5
    return [
        *parts,
        BudgetRow("code", total, f"LSB: {white} times the terms, and the final rounding"),
    ]


def light_rows(material: int, frame: Frame, config: Config, reach: list[float]) -> list[BudgetRow]:
    """The budget of one `material` of a frame with lights: the errors of all lights are added for
    the colour in which their sum is largest. reach: of each further light."""
    white = config.white
    table, real = frame.materials, config.coefficient.real
    n = float(config.exponent.real(table.exponent[material]))
    points = table.weight[material]
    w = largest_weight(material, frame, config)
    diffuse, specular = np.zeros(3), np.zeros(3)
    for number, its_reach in enumerate([None, *reach]):
        light = frame.light(number, config)
        half_vectors: ArrayLike = light.half_vector
        if frame.half_vectors is not None and len(frame.spans):
            half_vectors = np.unique(frame.half_vectors[number], axis=0)
        error = cosine(config, reach=its_reach)
        diffuse += real(light.diffuse[material]) * attenuated(error, 1.0, number, frame, config)
        if w > 0:
            error = w * highlight(material, half_vectors, frame, config, reach=its_reach)
            error += weight(points, config, reach=its_reach)
            if config.rounds_highlight:
                error += _round(config.highlight)
            error = attenuated(error, w, number, frame, config)
            specular += real(light.highlight[material]) * error
    worst = int(np.argmax(diffuse + specular))
    terms = [
        BudgetRow("diffuse terms", float(diffuse[worst]), "kd Ld times the error of cos(i)"),
        BudgetRow(
            "specular terms", float(specular[worst]),
            "ks Ls times the errors of W(i), of cos(s)^n and of their product's rounding",
        ),
        BudgetRow("cut of I", config.intensity.lsb, "the sum is whole, and truncated once"),
    ]  # fmt: skip
    total = white * sum(row.bound for row in terms) + 0.5
    return [
        BudgetRow("direction", direction(config), "mantissas of a normal, radians"),
        BudgetRow("length, first light", length(config), "1/sqrt and its operand, relative"),
        BudgetRow("length, other lights", held_length(config), "and the first light's mantissas"),
        BudgetRow("specular power", config.power.lsb, "rounding of the curve; its lines are exact")
        if config.has_curves
        else BudgetRow("specular power", specular_power(n, config), f"tables, n = {n:g}"),
        *terms,
        BudgetRow("code", total, f"LSB: {white} times the terms, and the final rounding"),
    ]


def derived(config: Config, n: float) -> bool:
    """Whether a bound is derived for the methods of `config` and the exponent `n`."""
    power_method = config.power_method in ("tables", "curve") or (
        config.power_method == "squaring" and n == int(n)
    )
    return config.normal_method in ("normalize", "dot_first", "quadratic_spans") and power_method


def bound_lsb(frame: Frame, config: Config = DEFAULT) -> float | None:
    """Bound of |code - 255 S| in LSB over the materials that `frame` uses; 1/2 without spans.

    None if no bound is derived for a method of `config` (`derived`) or for the spans (`squares`,
    `tilt_of_words`).
    """
    config = with_lights(config, frame)
    used = np.unique(frame.spans["material"]).tolist()
    exponents = config.exponent.real(frame.materials.exponent[used])
    if not all(derived(config, n) for n in exponents.tolist()):
        return None
    if config.normal_method == "quadratic_spans" and squares(frame, config) is None:
        return None
    if config.sums_lights:
        reach = reaches(frame)
        lights = (light_rows(m, frame, config, reach)[-1].bound for m in used)
        return max(lights, default=0.5)
    tilt = tilt_of_words(frame, config)
    if tilt is None:
        return None
    return max((rows(m, frame, config, tilt)[-1].bound for m in used), default=0.5)
