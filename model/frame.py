# SPDX-License-Identifier: MIT
"""What the hardware is given for one picture: registers, material table and spans, in integers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from phong75.model.arrays import ArrayLike, Ints, Reals, Spans
from phong75.model.config import Config

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


class InputError(Exception):
    """The user's input is wrong; the message is one line that says where and how."""


@dataclass(repr=False)
class MaterialTable:
    """The material table in codes, one row per material (M = `Config.materials` rows).

    ambient: int64[M, 3], Cp d of red, green, blue in `coefficient` (u1.16).
    diffuse: int64[M, 3], Cp (1 - d) in `coefficient`; ambient + diffuse = Cp.
    weight: int64[M, P], W at P = `Config.weight_points` equally spaced Zn from 0 to 1, in
    `coefficient`. exponent: int64[M], n in `exponent` (u8.9).
    """

    ambient: Ints
    diffuse: Ints
    weight: Ints
    exponent: Ints

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
        [1, 128]).
        """
        cp, weight = np.asarray(cp, float), np.asarray(weight, float)
        for name, value in (("Cp", cp), ("d", np.asarray(d, float)), ("W", weight)):
            outside = np.ravel(~((value >= 0) & (value <= 1)))
            if outside.any():
                wrong = np.ravel(value)[outside][0]
                raise InputError(f"material {index}: {name} = {wrong} is outside [0, 1]")
        if not 1 <= n <= 128:
            raise InputError(f"material {index}: n = {n} is outside [1, 128]")
        self.ambient[index] = config.coefficient.quantize(cp * d)
        self.diffuse[index] = config.coefficient.quantize(cp) - self.ambient[index]
        self.weight[index] = config.coefficient.quantize(weight)
        self.exponent[index] = config.exponent.quantize(n)


@dataclass(repr=False)
class Frame:
    """One picture as the hardware sees it. All arrays hold codes (integers).

    width, height: pixels. half_vector: (hx, hz) in `half_vector` (s0.17), the half vector h between
    the light k = (0, 0, 1) and the eye u in the light frame, where u_y = 0 and u = 2 (h.k) h - k.
    The length of h should be 1 but for its rounding. two_sided: shade |Zn|. background: codes of
    red, green, blue for the pixels that no span covers. spans: SPAN_DTYPE[n].
    """

    width: int
    height: int
    half_vector: tuple[int, int]
    two_sided: bool
    background: tuple[int, int, int]
    materials: MaterialTable
    spans: Spans

    def __repr__(self) -> str:
        pixels = int(np.maximum(self.spans["length"], 1).sum())
        return f"Frame({self.width}x{self.height}, spans: {len(self.spans)}, pixels: {pixels})"


@dataclass(repr=False)
class ExactFrame:
    """A `Frame` before any rounding, in float64; row k belongs to `Frame.spans[k]`.

    start, step, bend: float64[n, 3], of the normal (unit at the vertices) or of the intensities S.
    eye: float64[3], the unit vector u to the eye in the light frame. cp: float64[M, 3]; d:
    float64[M]; weight: float64[M, P]; exponent: float64[M]: of the materials, as in
    `MaterialTable.set`.
    """

    start: Reals
    step: Reals
    bend: Reals
    eye: Reals
    cp: Reals
    d: Reals
    weight: Reals
    exponent: Reals

    def __repr__(self) -> str:
        eye = ", ".join(f"{component:.3f}" for component in self.eye)
        return f"ExactFrame(spans: {len(self.start)}, eye: ({eye}))"


def fitted(config: Config, frame: Frame) -> Config:
    """`config` with what `frame` needs beyond it: second differences, where a span has a bend."""
    if config.normal_order == 2 or not frame.spans["bend"].any():
        return config
    return replace(config, name=f"{config.name}_quadratic", normal_order=2)


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
