# SPDX-License-Identifier: MIT
"""What the hardware is given for one picture: registers, material table and spans, in integers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from phong75.model.arrays import ArrayLike, Flags, Ints, Reals, Spans
from phong75.model.config import MAX_EXPONENT, Config
from phong75.model.places import Falloff, Place
from phong75.model.reflectance import Curve, jump_count

#: One span: `length` pixels from (x, y) to the right.
#:
#: start: the normal x, y, z at the centre of the first pixel; step: its difference from pixel to
#: pixel; both are codes of `Config.normal` (s1.30) in the light frame, where the light is along z.
#: For Gouraud and flat shading, start and step are intensities S of red, green, blue in the same
#: format: three equal ones for grey, and a step of 0 for flat shading. material: row of the
#: material table. last: whether the span is the last one of the frame. bend: how much the step
#: grows from pixel to pixel, in codes of `Config.bend` (s1.42); 0 unless normals are quadratic.
SPAN_DTYPE = np.dtype(
    [
        ("x", np.int32),
        ("y", np.int32),
        ("length", np.int32),
        ("start", np.int64, 3),
        ("step", np.int64, 3),
        ("material", np.int32),
        ("last", np.bool_),
        ("bend", np.int64, 3),
    ]
)


def walked(spans: Spans) -> Ints:
    """How many pixels the hardware makes of each of `spans` (SPAN_DTYPE[n]), int64[n]: its length,
    and 1 of a span of length 0."""
    return np.maximum(spans["length"], 1).astype(np.int64)


class InputError(Exception):
    """The user's input is wrong; the message is one line that says where and how."""


@dataclass(repr=False)
class MaterialTable:
    """The material table in codes, one row per material (M = `Config.materials` rows).

    ambient: int64[M, 3], Cp d of red, green, blue in `coefficient` (u1.16).
    diffuse: int64[M, 3], Cp (1 - d) in `coefficient`; ambient + diffuse = Cp.
    weight: int64[M, P], W at P = `Config.weight_points` equally spaced Zn from 0 to 1, in
    `coefficient`. exponent: int64[M], n in `exponent` (u8.9).

    With lights (`Config.sums_lights`) ambient is the sum of what needs no direction, e + ka Ia and
    ka La of every light; diffuse is kd Ld of the first light, and highlight: int64[M, 3] is ks Ls
    of the first light in `coefficient`. highlight is None where it is 1 everywhere and
    ambient + diffuse is at most 1: then one light needs no more than eq. (3).

    Reflectance by table (see `phong75.model.reflectance`; None where no material has one):
    curve: int64[M, S, 2], {left, step} of each line of the curve of cos(s), in `coefficient`; the
    curve takes the place of n. curve_jumps, weight_jumps: int64[M, MAX_JUMPS, 3], the jumps of the
    curve and of W: {above, threshold, amount}. The amount, in `coefficient`, is subtracted where
    the operand is at or above the threshold (above = 1), or below (above = 0). The operand is
    1 - cos(s) in `versine` for a curve and cos(i) in `cosine` for W.
    """

    ambient: Ints
    diffuse: Ints
    weight: Ints
    exponent: Ints
    highlight: Ints | None = None
    curve: Ints | None = None
    curve_jumps: Ints | None = None
    weight_jumps: Ints | None = None

    def __repr__(self) -> str:
        terms = np.concatenate([self.ambient, self.diffuse, self.weight], axis=1)
        black = int((~terms.any(axis=1)).sum())
        return f"MaterialTable(rows: {len(terms)}, black: {black})"

    @classmethod
    def empty(cls, config: Config) -> MaterialTable:
        """A table of black materials with n = 1."""
        m = config.materials
        return cls(
            np.zeros((m, 3), np.int64),
            np.zeros((m, 3), np.int64),
            np.zeros((m, config.weight_points), np.int64),
            np.full(m, config.exponent.one, np.int64),
        )

    def set(
        self, index: int, cp: ArrayLike, d: float, weight: ArrayLike, n: float, config: Config
    ) -> None:
        """Encode the material of row `index`.

        cp: float[3], the colour Cp. d: the ambient share. weight: float[P], W at the points of the
        table. n: the exponent. Raises InputError if a value is outside [0, 1] (n: outside
        1 to MAX_EXPONENT).
        """
        cp, weight = np.asarray(cp, float), np.asarray(weight, float)
        for name, value in (("Cp", cp), ("d", np.asarray(d, float)), ("W", weight)):
            outside = np.ravel(~((value >= 0) & (value <= 1)))
            if outside.any():
                wrong = np.ravel(value)[outside][0]
                raise InputError(f"material {index}: {name} = {wrong} is outside [0, 1]")
        if not 1 <= n <= MAX_EXPONENT:
            raise InputError(f"material {index}: n = {n} is outside [1, {MAX_EXPONENT}]")
        self.ambient[index] = config.coefficient.quantize(cp * d)
        self.diffuse[index] = config.coefficient.quantize(cp) - self.ambient[index]
        self.weight[index] = config.coefficient.quantize(weight)
        self.exponent[index] = config.exponent.quantize(n)


@dataclass(repr=False)
class FurtherLight:
    """A light of a frame beside the first one, in codes.

    half_vector: (hx, hz) in `half_vector`, in the frame of this light. start, step: int64[n, 3], as
    those of the spans, in the frame of this light. diffuse: int64[M, 3], kd Ld. highlight:
    int64[M, 3], ks Ls.
    """

    half_vector: tuple[int, int]
    start: Ints
    step: Ints
    diffuse: Ints
    highlight: Ints


@dataclass(repr=False)
class Frame:
    """One picture as the hardware sees it. All arrays hold codes (integers).

    width, height: pixels. half_vector: (hx, hz) in `half_vector` (s0.17), the half vector h between
    the light k = (0, 0, 1) and the eye u in the light frame, where u_y = 0 and u = 2 (h.k) h - k.
    The length of h should be 1 but for its rounding. two_sided: shade |Zn|. background: codes of
    red, green, blue for the pixels that no span covers. spans: SPAN_DTYPE[n]; start and step are in
    the frame of the first light. further: the other lights, at most 7.

    half_vectors: int64[L, n, 2], (hx, hz) of each of L lights in each span, in place of those of
    the lights; None if no light is at a place. depths: int64[L, n, 2], start and step in `depth` of
    the distance from each light. falloff: int64[L, P], the factor in `coefficient` at P equally
    spaced depths from 0 to 1, constant beyond them. Both are None if no light falls with the
    distance.
    """

    width: int
    height: int
    half_vector: tuple[int, int]
    two_sided: bool
    background: tuple[int, int, int]
    materials: MaterialTable
    spans: Spans
    further: list[FurtherLight] = field(default_factory=list)
    half_vectors: Ints | None = None
    depths: Ints | None = None
    falloff: Ints | None = None

    def __repr__(self) -> str:
        pixels = int(walked(self.spans).sum())
        lights = f", lights: {self.lights}" if self.further else ""
        return (
            f"Frame({self.width}x{self.height}, spans: {len(self.spans)}, pixels: {pixels}{lights})"
        )

    @property
    def lights(self) -> int:
        """Number of lights."""
        return 1 + len(self.further)

    def light(self, number: int, config: Config) -> FurtherLight:
        """The light `number`, from 0, the first one in the form of the others."""
        if number:
            return self.further[number - 1]
        table, spans = self.materials, self.spans
        highlight = table.highlight
        if highlight is None:
            highlight = np.full(table.diffuse.shape, config.coefficient.one)
        return FurtherLight(
            self.half_vector, spans["start"], spans["step"], table.diffuse, highlight
        )

    def seen_by(self, light: FurtherLight) -> Frame:
        """The frame as `light` alone sees it: its half vector and its start and step; not its
        colours."""
        spans = self.spans.copy()
        spans["start"], spans["step"] = light.start, light.step
        return replace(self, half_vector=light.half_vector, spans=spans, further=[])

    def half_vector_of(self, number: int, span: Ints, config: Config) -> tuple[int, ...]:
        """(hx, hz) of the light `number` in the spans number `span` (int64[m]): two whole numbers,
        or int64[m] each if spans bring their half vectors."""
        if self.half_vectors is None:
            return self.light(number, config).half_vector
        return tuple(self.half_vectors[number, span].T)

    def take(self, rows: Ints | Flags) -> Frame:
        """The frame with the spans number `rows` (int64[m] or bool[n]) only."""
        further = [replace(r, start=r.start[rows], step=r.step[rows]) for r in self.further]
        half_vectors, depths = (
            None if a is None else a[:, rows] for a in (self.half_vectors, self.depths)
        )
        return replace(
            self, spans=self.spans[rows], further=further, half_vectors=half_vectors, depths=depths
        )


def with_reflectance(config: Config, frame: Frame) -> Config:
    """`config` with the curves and the jumps that the materials of `frame` have; as it is where
    they have none, or where `config` shades vertices.

    Raises InputError if `config` leaves out the table of W(i), which a jump of W needs.
    """
    table = frame.materials
    if config.technique != "phong" or not config.specular:
        return config
    used = np.unique(frame.spans["material"]) if len(frame.spans) else np.arange(config.materials)
    changes: dict[str, Any] = {}
    steps = jump_count(None if table.weight_jumps is None else table.weight_jumps[used])
    if steps > config.weight_jumps:
        if not config.weight_function:
            raise InputError("W has jumps, but the pipeline is built without a table of W(i)")
        changes["weight_jumps"] = steps
    if table.curve is not None:
        if config.power_method != "curve" or not config.power_function:
            changes |= {"power_method": "curve", "power_function": True, "constant_exponent": ()}
        changes["curve_jumps"] = max(
            config.curve_jumps,
            jump_count(None if table.curve_jumps is None else table.curve_jumps[used]),
        )
    changes = {name: value for name, value in changes.items() if getattr(config, name) != value}
    if not changes:
        return config
    parts = {"power_method": "_curve", "curve_jumps": "_jumps", "weight_jumps": "_steps"}
    name = config.name + "".join(part for field, part in parts.items() if field in changes)
    try:
        return replace(config, name=name, **changes)
    except ValueError as error:
        raise InputError(str(error)) from None


def fitted(config: Config, frame: Frame, units: int = 1) -> Config:
    """`config` with what `frame` needs beyond it: second differences where a span has a bend, and
    the lights, the curves and the jumps of `frame`. As it is for linear normals, one light with
    white highlights and powers of cos(s).

    units: shading units side by side. Raises InputError if there are more units than lights, or if
    `config` has a method or a feature that is for one light, or see `with_reflectance`.
    """
    config = with_reflectance(config, frame)
    if config.normal_order == 1 and frame.spans["bend"].any():
        config = replace(config, name=f"{config.name}_quadratic", normal_order=2)
    first = frame.materials.highlight
    colours = [first, *(light.highlight for light in frame.further)]
    coloured = any(c is not None and (c != config.coefficient.one).any() for c in colours)
    if config.technique != "phong":
        if units > 1:
            raise InputError(f"{config.technique} shading has no units: it shades vertices")
        return config
    placed, falls = frame.half_vectors is not None, frame.falloff is not None
    sums = bool(frame.further) or placed or falls
    if first is None and units == 1 and not sums:
        return config
    if units > frame.lights:
        lights = f"{frame.lights} light{'s' if frame.further else ''}"
        raise InputError(f"{units} units for {lights}: a unit more than lights has nothing to do")
    suffix = f"_lights_{frame.lights}" + (f"_units_{units}" if units > 1 else "")
    suffix += "_placed" * placed + "_falloff" * falls
    try:
        return replace(
            config, name=config.name + suffix, lights=frame.lights, units=units,
            highlight_colour=coloured or not sums,
            span_half_vector=placed, attenuation=falls,
        )  # fmt: skip
    except ValueError as error:
        raise InputError(f"a sum over lights is needed, but {error}") from None


def with_lights(config: Config, frame: Frame) -> Config:
    """`config` with the curves and the jumps of `frame`; also with its lights (see `fitted`), if
    `config` does not sum lights.

    Raises InputError if `frame` has more lights than `config`, or `config` cannot sum lights.
    """
    if not config.sums_lights:
        return fitted(config, frame)
    if frame.lights > config.lights:
        raise InputError(f"{frame.lights} lights in a build for {config.lights}")
    if frame.falloff is not None and not config.attenuation:
        raise InputError("a light falls with the distance, which the build leaves out")
    if frame.half_vectors is not None and config.specular and not config.span_half_vector:
        raise InputError("a light is at a place, which the build leaves out")
    return with_reflectance(config, frame)


@dataclass(repr=False)
class ExactLight:
    """A `FurtherLight` before any rounding, in float64.

    turn: float64[3, 3], takes a vector in the first light's frame to this light's. eye: as in
    `ExactFrame`, in this light's frame. diffuse, highlight: float64[M, 3].
    """

    turn: Reals
    eye: Reals
    diffuse: Reals
    highlight: Reals


@dataclass(repr=False)
class ExactFrame:
    """A `Frame` before any rounding, in float64; row k belongs to `Frame.spans[k]`.

    start, step, bend: float64[n, 3], of the normal (unit at the vertices) or of the intensities S.
    eye: float64[3], the unit vector u to the eye in the light frame. ambient, diffuse, highlight:
    float64[M, 3] of the materials, as in `MaterialTable`. weight, curve: of each of the M
    materials, the scene's own W of cos(i), and the scene's own curve of cos(s) or cos(s)**n.
    further: the lights beside the first.

    places: of all lights; empty if all are at infinity and none falls with the distance. point,
    point_step: float64[n, 4], (p/w, 1/w) of the surface's point p, w as in `Camera.project`: that
    and 1/w are linear along a span also in perspective. Where the first light is at a place, start,
    step, points and places are in the frame of its direction from the middle of the scene, and so
    are the `turn` and the eye.
    """

    start: Reals
    step: Reals
    bend: Reals
    eye: Reals
    ambient: Reals
    diffuse: Reals
    highlight: Reals
    weight: Sequence[Curve]
    curve: Sequence[Curve]
    further: list[ExactLight] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    point: Reals = field(default_factory=lambda: np.zeros((0, 4)))
    point_step: Reals = field(default_factory=lambda: np.zeros((0, 4)))

    def __repr__(self) -> str:
        eye = ", ".join(f"{component:.3f}" for component in self.eye)
        return f"ExactFrame(spans: {len(self.start)}, eye: ({eye}))"


def half_angle_codes(angle: Reals, config: Config) -> Ints:
    """Codes int64[n, 2] of (hx, hz) for the angles float64[n] from light to eye, radians."""
    half = np.stack([np.sin(angle / 2), np.cos(angle / 2)], axis=-1)
    return config.half_vector.quantize(half)


def distance_range(distances: list[Reals], falloff: Falloff | None) -> tuple[float, float]:
    """The distances at which the table of `falloff` begins and ends: depths 0 and 1.

    These are the smallest and the largest of `distances`, but the first and the last point of the
    falloff where the factor is constant beyond those: the table has straight lines between equally
    spaced distances, and a corner within one of them would be cut. No distance gets a depth beyond
    -1.9 or 1.9, which the word holds.
    """
    found = np.concatenate(distances)
    low, high = (float(found.min()), float(found.max())) if len(found) else (0.0, 1.0)
    points = falloff.distances if falloff else ()
    if points and max(low, points[0]) < min(high, points[-1]):
        begin = max(low, points[0])
        return begin, max(min(high, points[-1]), begin + max(begin - low, high - begin) / 1.9)
    return low, high if high > low else low + 1.0


def depth_codes(
    first: Reals, last: Reals, steps: Ints, low: float, high: float, config: Config
) -> Ints:
    """Codes int64[n, 2] in `depth`: start and step of the distances along spans.

    first, last: float64[n], at the first and the last pixel. steps: int64[n], pixels minus 1. low,
    high: the distances that depths of 0 and of 1 stand for. Depths are in the word at both ends.
    """
    fmt = config.depth
    ends = [fmt.quantize((d - low) / (high - low)) for d in (first, last)]
    slope = np.floor((ends[1] - ends[0]) / np.maximum(steps, 1) + 0.5).astype(np.int64)
    lowest = -((ends[0] - fmt.min) // np.maximum(steps, 1))
    highest = (fmt.max - ends[0]) // np.maximum(steps, 1)
    return np.stack([ends[0], np.clip(slope, lowest, highest)], axis=-1)


def falloff_codes(falloff: Falloff | None, low: float, high: float, config: Config) -> Ints:
    """The factors int64[P] in `coefficient` at P equally spaced distances from `low` to `high`; 1
    for a light that does not fall with the distance."""
    distance = np.linspace(low, high, config.weight_points)
    factor = falloff.factor(distance) if falloff else np.ones_like(distance)
    return config.coefficient.quantize(factor)


def half_vector_codes(eye: ArrayLike, config: Config) -> tuple[int, int]:
    """Codes (hx, hz) in `half_vector` (s0.17) of the half vector for the unit vector `eye`
    (float[3] in the light frame, eye[1] = 0).

    h = (sin(a/2), 0, cos(a/2)), where a is the angle from light to eye. This also defines h for an
    eye exactly opposite the light, where light + eye is the zero vector.
    """
    eye = np.asarray(eye, np.float64)
    angle = np.arctan2(eye[0], eye[2])
    hx, hz = config.half_vector.quantize([np.sin(angle / 2), np.cos(angle / 2)])
    return int(hx), int(hz)
