# SPDX-License-Identifier: MIT
"""Float64 reference: eq. (3) of Phong (1975), implemented from the paper, not from the hardware.

The reference shares no arithmetic with the twin: it has no tables and no rounding, and it computes
cos(s) in the form of the paper. With several lights it sums OpenGL's model over them (see
`shade_lights`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from phong75.model import places
from phong75.model.arrays import ArrayLike, Ints, Reals, Spans
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import ExactFrame, Frame, walked
from phong75.model.reflectance import Curve, curve_value, power_words, weight_value

#: W of cos(i), or what stands in place of cos(s)**n as a function of cos(s), at pixels: float64[n]
#: to float64[n].
Function = Callable[[Reals], Reals]


def _weight(weight: Reals | Function, cos_i: Reals) -> Reals:
    """W at `cos_i` (float64[n]) of a function or of points float64[n, P], equally spaced."""
    if callable(weight):
        return weight(cos_i)
    points = weight.shape[1]
    position = np.clip(cos_i, 0, 1) * (points - 1)
    left = np.minimum(position.astype(np.int64), points - 2)
    row = np.arange(len(cos_i))
    return weight[row, left] + (weight[row, left + 1] - weight[row, left]) * (position - left)


def _highlight(curve: Reals | Function, cos_s: Reals) -> Reals:
    """The curve of cos(s), or its power for exponents float64[n], at max(`cos_s`, 0)."""
    cos_s = np.maximum(cos_s, 0)
    return curve(cos_s) if callable(curve) else cos_s**curve


def shade(
    normal: Reals,
    cp_d: Reals,
    cp_rest: Reals,
    weight: Reals | Function,
    exponent: Reals | Function,
    eye: Reals,
    two_sided: bool,
    white: int = DEFAULT.white,
) -> Reals:
    """The code white clamp(S, 0, 1) by the paper's eq. (3), float64[n, 3].

    normal: float64[n, 3], any length, light frame.
    cp_d, cp_rest: float64[n, 3], Cp d and Cp (1 - d), 0 to 1.
    weight: float64[n, P], W at P equally spaced Zn from 0 to 1; or a function of cos(i).
    exponent: float64[n], n of eq. (3); or a function of cos(s) in place of cos(s)**n.
    eye: float64[3] or [n, 3], unit vector u, light frame.
    two_sided: shade |Zn|. white: the code of S = 1.

    A zero normal, or one that points away from the light, gives Cp d.
    """
    if two_sided:
        normal = np.where(normal[:, 2:] < 0, -normal, normal)
    lit = normal[:, 2] > 0
    length = np.sqrt((normal**2).sum(axis=1))
    n = normal / np.where(length > 0, length, 1)[:, None]
    cos_i = n[:, 2]
    cos_s = 2 * cos_i * (n * eye).sum(axis=1) - eye[..., 2]
    w = _weight(weight, cos_i)
    s = cp_d + np.where(lit, cos_i, 0)[:, None] * cp_rest
    s = s + np.where(lit, w * _highlight(exponent, cos_s), 0)[:, None]
    return white * np.clip(s, 0, 1)


def shade_lights(
    vectors: Reals,
    material: Ints,
    ambient: Reals,
    diffuse: Reals,
    highlight: Reals,
    weight: Reals | Function,
    exponent: Reals | Function,
    eyes: Sequence[Reals],
    two_sided: bool,
    white: int = DEFAULT.white,
    factors: Sequence[Reals | float] | None = None,
) -> Reals:
    """The code white clamp(I, 0, 1), float64[n, 3], of the illumination model with several lights:

    I = e + ka Ia + sum over lights of (ka La + f (kd Ld (N.L) + ks Ls W(i) (R.V)**n)).

    vectors: float64[L, n, 3], the normal in the frame of each of L lights, divided by the length of
    the first one: unit vectors, but for the rounding of the ports. Components beyond 1 count as 1.
    material: int64[n]. ambient: float64[M, 3], the part without a direction. diffuse, highlight:
    float64[L, M, 3], kd Ld and ks Ls. weight: float64[M, P], exponent: float64[M], as in `shade`;
    or functions of the pixels.
    eyes: unit vectors in the frame of each light, float64[3] or [n, 3]. two_sided: shade |N.L| of
    each light. factors: f of each light, float64[n] or a number; by default 1.

    R.V is 2 (N.L) (N.V) - L.V for a unit vector N. For another length it is continued as
    2 (N.L) (N.V) + 1 - (1 + L.V) |N|**2, which is 1 - 2 (x**2 + y**2) with x and y of N x H.
    """
    total = ambient[material]
    weight = weight if callable(weight) else weight[material]
    exponent = exponent if callable(exponent) else exponent[material]
    factors = factors if factors is not None else [1.0] * len(vectors)
    for n, kd, ks, eye, factor in zip(
        np.clip(vectors, -1, 1), diffuse, highlight, eyes, factors, strict=True
    ):
        cos_i = np.abs(n[:, 2]) if two_sided else n[:, 2]
        lit = (cos_i > 0)[:, None]
        along = (n * eye).sum(axis=1)
        cos_s = 2 * n[:, 2] * along + 1 - (1 + eye[..., 2]) * (n**2).sum(axis=1)
        specular = _weight(weight, cos_i) * _highlight(exponent, cos_s)
        terms = kd[material] * cos_i[:, None] + ks[material] * specular[:, None]
        total = total + np.where(lit, terms, 0) * np.broadcast_to(factor, len(cos_i))[:, None]
    return white * np.clip(total, 0, 1)


def _pixels(spans: Spans, start: Reals, step: Reals, bend: Reals) -> tuple[Reals, Ints]:
    """Interpolated vectors float64[n, 3] and material indices int[n] of all pixels of `spans`.

    start, step, bend: float64[spans, 3], value at the first pixel, change to the second, and growth
    of that change per pixel: Newton's forward differences of a parabola.
    """
    span, k = span_of_pixels(spans)
    value = start[span] + k[:, None] * step[span]
    if bend.any():
        # Whole numbers and fractions apart: both sums are then exact for the codes of legal spans.
        growth, whole = (k * (k - 1) / 2)[:, None], np.trunc(bend)
        value = value + growth * whole[span] + growth * (bend - whole)[span]
    return value, spans["material"][span]


def span_of_pixels(spans: Spans) -> tuple[Ints, Ints]:
    """The span of each pixel of `spans`, and the number of the pixel in it, int64[n] each."""
    length = walked(spans)
    span = np.repeat(np.arange(len(spans)), length)
    return span, np.arange(len(span)) - np.repeat(np.cumsum(length) - length, length)


def _differences(spans: Spans, config: Config) -> list[Reals]:
    """Start, step and bend of `spans`, float64[spans, 3] each, in units of the LSB of `normal`."""
    bend = np.ldexp(spans["bend"].astype(float), -config.bend_fraction_bits)
    return [spans["start"].astype(float), spans["step"].astype(float), bend]


def _factors(frame: Frame, config: Config) -> list[Reals] | None:
    """The factor of each light at each pixel, float64[n] each, from the depths at the ports and the
    points of the table, straight between them; None if no light falls with the distance."""
    if frame.falloff is None or frame.depths is None:
        return None
    span, k = span_of_pixels(frame.spans)
    at = np.linspace(0, 1, frame.falloff.shape[1])
    factors = []
    for its, points in zip(frame.depths, frame.falloff, strict=True):
        depth = config.depth.real(its[span, 0] + k * its[span, 1])
        factors.append(np.interp(depth, at, config.coefficient.real(points)))
    return factors


def eye_of(half_vector: ArrayLike) -> Reals:
    """The unit eye vector u, float64[..., 3], light frame: u = 2 (h.k) h - k, k = (0, 0, 1).

    half_vector: (hx, hz), numbers or arrays[...], of any scale; h is the unit vector along
    (hx, 0, hz).
    """
    hx, hz = np.asarray(half_vector, np.float64)
    h = np.stack([hx, np.zeros_like(hx), hz], axis=-1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    return 2 * h[..., 2:] * h - np.array([0, 0, 1.0])


def zero_normals(frame: Frame, config: Config = DEFAULT) -> int:
    """Number of pixels of `frame` whose interpolated normal is the zero vector."""
    normal, _ = _pixels(frame.spans, *_differences(frame.spans, config))
    return int((normal == 0).all(axis=1).sum())


@dataclass(frozen=True)
class Sides:
    """Where jumps are looked for: `weight` is added to cos(i), and `versine` of 1 - cos(s) to that,
    where the side of a jump is chosen."""

    weight: float
    versine: Function


def _functions(
    frame: Frame, material: Ints, config: Config, sides: Sides | None
) -> tuple[Reals | Function, Reals | Function]:
    """W and the highlight's curve of the tables of `frame`, as `shade` takes them."""
    table = frame.materials
    weight: Reals | Function = config.coefficient.real(table.weight)[material]
    power: Reals | Function = config.exponent.real(table.exponent)[material]
    if table.weight_jumps is not None:
        jumps, points = table.weight_jumps[material], table.weight[material]
        side = sides.weight if sides else 0.0
        weight = lambda cos_i: weight_value(points, jumps, cos_i, config, side)  # noqa: E731
    curve = table.curve
    if curve is None and config.has_curves:
        curve = power_words(table.exponent, config)
    if curve is not None:
        lines = curve[material]
        steps = None if table.curve_jumps is None else table.curve_jumps[material]

        def power(cos_s: Reals) -> Reals:
            v = np.clip(1 - cos_s, 0, 1)
            return curve_value(lines, steps, v, config, sides.versine(v) if sides else 0.0)

    return weight, power


def render(frame: Frame, config: Config = DEFAULT, sides: Sides | None = None) -> np.ndarray:
    """The code white clamp(S, 0, 1) of the integers at the ports and in the tables, float64[n, 3].

    Rows are in the order of the stream. The comparison with the pipeline's codes shows the error of
    the pipeline alone. sides: see `undecided`.
    """
    differences = _differences(frame.spans, config)
    if config.technique != "phong":
        intensity, _ = _pixels(frame.spans, *differences)
        return config.white * np.clip(intensity / config.normal.one, 0, 1)
    normal, material = _pixels(frame.spans, *differences)
    table, real = frame.materials, config.coefficient.real
    weight, power = _functions(frame, material, config, sides)
    placed = frame.half_vectors is not None or frame.falloff is not None
    if config.sums_lights or frame.further or table.highlight is not None or placed:
        lights = [frame.light(number, config) for number in range(frame.lights)]
        span = span_of_pixels(frame.spans)[0]
        eyes = [
            eye_of(np.stack(frame.half_vector_of(number, span, config)))
            for number in range(frame.lights)
        ]
        return shade_lights(
            shared_length(frame), material, real(table.ambient),
            np.stack([real(light.diffuse) for light in lights]),
            np.stack([real(light.highlight) for light in lights]),
            weight if callable(weight) else real(table.weight),
            power if callable(power) else config.exponent.real(table.exponent),
            eyes, frame.two_sided, config.white, _factors(frame, config),
        )  # fmt: skip
    return shade(
        normal, real(table.ambient)[material], real(table.diffuse)[material], weight, power,
        eye_of(frame.half_vector), frame.two_sided, config.white,
    )  # fmt: skip


def shared_length(frame: Frame) -> Reals:
    """The normal of every pixel in the frame of each light, float64[L, n, 3], divided by the length
    of the first light's.

    All are zero where the first light's normal is. A normal that takes k > 1 bits more than that of
    the first light is first divided by 2**(k - 1); normals of one vector never are.
    """
    lights = [(frame.spans["start"], frame.spans["step"])]
    lights += [(light.start, light.step) for light in frame.further]
    straight = np.zeros((len(frame.spans), 3))  # no light of several has a bend
    normals = np.stack(
        [_pixels(frame.spans, a.astype(float), b.astype(float), straight)[0] for a, b in lights]
    )
    length = np.sqrt((normals[0] ** 2).sum(axis=1))
    # A word of k bits beside its sign holds -2**k to 2**k - 1.
    bits = np.frexp(np.where(normals < 0, -normals - 1, normals).max(axis=2))[1]
    beyond = np.maximum(bits - bits[0] - 1, 0)
    reached = length > 0
    scale = np.ldexp(1 / np.where(reached, length, 1), -beyond) * reached
    return normals * scale[..., None]


def render_exact(
    frame: Frame, exact: ExactFrame, config: Config = DEFAULT, sides: Sides | None = None
) -> np.ndarray:
    """The code white clamp(S, 0, 1) from the scene's values before any rounding, float64[n, 3].

    exact: the values that were rounded to `frame`. The comparison with the pipeline's codes also
    shows the error of rounding the input, and of the tables of W and of the curves. sides: see
    `undecided`.
    """
    normal, m = _pixels(frame.spans, exact.start, exact.step, exact.bend)
    if config.technique != "phong":
        return config.white * np.clip(normal, 0, 1)
    points = None
    if exact.places:
        span, k = span_of_pixels(frame.spans)
        p = exact.point[span] + k[:, None] * exact.point_step[span]
        points = p[:, :3] / p[:, 3:]
    return shade_exact(normal, m, exact, frame.two_sided, config.white, sides, points)


def _by_material(curves: Sequence[Curve], material: Ints, side: Function) -> Function:
    """The function of pixels of `material` (int64[n]) that looks up `curves`; side: what is added
    where the side of a jump is chosen."""

    def value(x: Reals) -> Reals:
        out, chosen = np.empty_like(x), x + side(x)
        for m in np.unique(material).tolist():
            rows = material == m
            out[rows] = curves[m].at(x[rows])
            for place, height in curves[m].jumps:
                change = (chosen[rows] >= place).astype(int) - (x[rows] >= place)
                out[rows] += change * height
        return out

    return value


def shade_exact(
    normal: Reals,
    material: Ints,
    exact: ExactFrame,
    two_sided: bool,
    white: int = DEFAULT.white,
    sides: Sides | None = None,
    points: Reals | None = None,
) -> Reals:
    """The code white clamp(S, 0, 1) of normals before any rounding, float64[n, 3].

    normal: float64[n, 3], any length, in the first light's frame. material: int64[n]. sides: see
    `undecided`. points: float64[n, 3], those of the surface, from which a light at a place has its
    own direction and distance; needed if `exact` has places.
    """
    m, further = material, exact.further
    shift = sides or Sides(0.0, np.zeros_like)
    weight = _by_material(exact.weight, m, lambda cos_i: np.full_like(cos_i, shift.weight))
    power = _by_material(exact.curve, m, lambda cos_s: -shift.versine(np.clip(1 - cos_s, 0, 1)))
    if points is not None and exact.places:
        return _shade_places(normal, material, exact, two_sided, points, weight, power, white)
    if not further and (exact.highlight == 1).all():
        return shade(
            normal, exact.ambient[m], exact.diffuse[m], weight, power, exact.eye, two_sided, white
        )
    length = np.sqrt((normal**2).sum(axis=1))
    unit = normal / np.where(length > 0, length, 1)[:, None]
    return shade_lights(
        np.stack([unit, *(unit @ light.turn.T for light in further)]), m, exact.ambient,
        np.stack([exact.diffuse, *(light.diffuse for light in further)]),
        np.stack([exact.highlight, *(light.highlight for light in further)]), weight, power,
        [exact.eye, *(light.eye for light in further)], two_sided, white,
    )  # fmt: skip


def _shade_places(
    normal: Reals, material: Ints, exact: ExactFrame, two_sided: bool, points: Reals,
    weight: Function, power: Function, white: int,
) -> Reals:  # fmt: skip
    """`shade_exact` where a light is at a place or falls with the distance: every pixel has its own
    light frame and its own distance. weight, power: W of cos(i) and the curve of cos(s) at the
    pixels."""
    length = np.sqrt((normal**2).sum(axis=1))
    unit = normal / np.where(length > 0, length, 1)[:, None]
    turns = [np.eye(3), *(light.turn for light in exact.further)]
    vectors, eyes, factors = [], [], []
    for place, turn, fixed in zip(
        exact.places, turns, [exact.eye, *(light.eye for light in exact.further)], strict=True
    ):
        if place.position is None:
            vectors.append(unit @ turn.T)
            eyes.append(fixed)
        else:
            axes, angle = places.frames(places.toward(place.position, points, exact.eye), exact.eye)
            vectors.append(places.seen(axes, unit))
            eyes.append(places.of_eye(angle))
        falloff, distance = place.falloff, place.distance(points, exact.eye)
        factors.append(falloff.factor(distance) if falloff else np.ones_like(distance))
    return shade_lights(
        np.stack(vectors), material, exact.ambient,
        np.stack([exact.diffuse, *(light.diffuse for light in exact.further)]),
        np.stack([exact.highlight, *(light.highlight for light in exact.further)]),
        weight, power, eyes, two_sided, white, factors,
    )  # fmt: skip
