"""What the hardware is given for one picture: registers, material table and spans, in integers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.config import Config

#: One span (see the README, "Formats"): `length` pixels from (x, y) to the right, the normal at
#: the centre of the first pixel and its step to the next (codes of `Config.normal`, in the light
#: frame), the index of the material, and whether it is the last span of the frame. Gouraud and flat
#: shading have intensities S of red, green, blue in place of the normal's x, y, z, with one channel
#: three equal ones; with flat shading the step is 0.
SPAN_DTYPE = np.dtype(
    [
        ("x", np.int32),
        ("y", np.int32),
        ("length", np.int32),
        ("start", np.int64, 3),
        ("step", np.int64, 3),
        ("material", np.int32),
        ("last", np.bool_),
    ]
)


class InputError(Exception):
    """The user's input is wrong; the message is one line that says where and how."""


@dataclass
class MaterialTable:
    """The material table in codes, one row a material (M = `Config.materials` rows).

    ambient: int64[M, 3], Cp*d of red, green, blue, format `Config.coefficient`.
    diffuse: int64[M, 3], Cp*(1-d), same format; ambient + diffuse = Cp.
    weight: int64[M, P], W at P = `Config.weight_points` equally spaced Zn from 0 to 1, same format.
    exponent: int64[M], n, format `Config.exponent`.
    """

    ambient: np.ndarray
    diffuse: np.ndarray
    weight: np.ndarray
    exponent: np.ndarray

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

    def set(self, index: int, cp, d: float, weight, n: float, config: Config) -> None:
        """Encode one material: `cp` 3 reals, `d` a real, `weight` W at the table's points, `n`.

        Raises InputError if a value is outside [0, 1] (n: outside [1, 128]).
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


@dataclass
class Frame:
    """One picture as the hardware sees it. All arrays hold codes (integers).

    width, height: pixels. half_vector: (hx, hz) in `Config.half_vector`: the direction h halfway
    between the light k = (0, 0, 1) and the eye u, in the light frame, where u = 2(h.k)h - k has
    u_y = 0; any length, but h is best held near 1. two_sided: shade |Zn|.
    background: 3 codes for the dots that no span covers. spans: SPAN_DTYPE[n].
    """

    width: int
    height: int
    half_vector: tuple[int, int]
    two_sided: bool
    background: tuple[int, int, int]
    materials: MaterialTable
    spans: np.ndarray


@dataclass
class ExactFrame:
    """The same picture before any rounding, for `input_error`; rows match `Frame.spans`.

    start, step: float64[n, 3]. eye: float64[3], the unit vector u in the light frame.
    cp: float64[M, 3]; d: float64[M]; weight: float64[M, P]; exponent: float64[M].
    """

    start: np.ndarray
    step: np.ndarray
    eye: np.ndarray
    cp: np.ndarray
    d: np.ndarray
    weight: np.ndarray
    exponent: np.ndarray


def half_vector_codes(eye, config: Config) -> tuple[int, int]:
    """Codes of h for the unit vector `eye` (float[3], light frame, eye[1] = 0).

    h = (sin(a/2), 0, cos(a/2)) with a the angle from light to eye: well defined also for an eye
    exactly opposite the light, where light + eye is the zero vector.
    """
    angle = np.arctan2(eye[0], eye[2])
    hx, hz = config.half_vector.quantize([np.sin(angle / 2), np.cos(angle / 2)])
    return int(hx), int(hz)
