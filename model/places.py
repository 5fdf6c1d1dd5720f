# SPDX-License-Identifier: MIT
"""Lights at a place: directions, frames and distances from the points of surfaces, in float64.

A light at infinity has one direction L, one light frame and one half vector H for a whole picture.
A light at a place has others at each point of a surface. The eye stays at infinity, as everywhere
(Phong 1975). `model/front/scene_to_spans.py` takes the values at the ends of a span from here, the
float64 reference those at each pixel.

A point at the place of the light itself has no direction to the light; there the light counts as
one in the direction of the eye.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from phong75.model.arrays import Reals

#: A distance below this part of the light's coordinates counts as 0.
NOWHERE = 1e-12

#: Largest turn of the direction to a light along a span, radians, unless asked otherwise.
MOST_TURN = float(np.radians(2.0))

#: Sine of the angle between light and eye below which the two count as parallel.
PARALLEL = 1e-9


@dataclass(frozen=True, repr=False)
class Falloff:
    """How the intensity of a light falls with the distance from it: a factor from 0 to 1.

    distances, values: points of a line that is straight between them and constant beyond them. Or,
    without points, coefficients: constant, linear and quadratic term k of OpenGL's rule
    1 / (k0 + k1 r + k2 r**2) for the distance r, at most 1.
    """

    distances: tuple[float, ...] = ()
    values: tuple[float, ...] = ()
    coefficients: tuple[float, float, float] = (1.0, 0.0, 0.0)

    def factor(self, distance: Reals) -> Reals:
        """The factor at `distance` (any shape, scene units), float64."""
        if self.distances:
            return np.interp(distance, self.distances, self.values)
        constant, linear, quadratic = self.coefficients
        divisor = constant + distance * (linear + distance * quadratic)
        return 1 / np.maximum(divisor, 1.0)


@dataclass(frozen=True, repr=False)
class Place:
    """Where a light is.

    position: float64[3], the point from which the light shines; None for a light at infinity.
    source: float64[3], the point from which the distance is measured. along: whether the distance
    is measured along the direction of the eye only, as from an eye at infinity. falloff: None for a
    light that does not fall with the distance. rule: one of RULES. most_turn: the largest angle,
    radians, between the directions to the light at the two ends of a span; a longer span is cut.
    All vectors are in the axes of the points that the functions are given.
    """

    position: Reals | None = None
    source: Reals | None = None
    along: bool = False
    falloff: Falloff | None = None
    rule: str = "half"
    most_turn: float = MOST_TURN

    def turned(self, axes: Reals) -> Place:
        """The place in other axes: float64[3, 3], unit rows in those of this place."""
        position = None if self.position is None else axes @ self.position
        source = None if self.source is None else axes @ self.source
        return replace(self, position=position, source=source)

    def distance(self, points: Reals, eye: Reals) -> Reals:
        """The distances float64[n] of `points` (float64[n, 3]). eye: unit vector towards it."""
        if self.source is None:
            return np.zeros(len(points))
        away = self.source - points
        if self.along:
            return np.maximum(away @ eye, 0)
        return np.sqrt((away**2).sum(axis=1))


#: How the front end brings the normals of a span into the frame of a light at a place.
#:
#: half: the frame and the half vector are those of the span's middle; at both ends the frame is
#: turned by the least rotation that takes the middle's half vector to that of the end. light: the
#: same, but the rotation takes the light's direction. middle: the frame of the middle for the whole
#: span. face: the frame of the triangle's centre for all spans of the triangle.
RULES = ("half", "light", "middle", "face")


def toward(position: Reals, points: Reals, eye: Reals) -> Reals:
    """Unit vectors float64[n, 3] from `points` (float64[n, 3]) to the light at `position`; `eye`
    (float64[3], unit) for a point at the place of the light."""
    away = position - points
    length = np.sqrt((away**2).sum(axis=1, keepdims=True))
    here = length <= NOWHERE * np.abs(position).max(initial=NOWHERE)
    return np.where(here, eye, away / np.where(here, 1, length))


def frames(light: Reals, eye: Reals) -> tuple[Reals, Reals]:
    """Light frames of the paper at n points, as `front.camera.light_frame` gives one.

    light: float64[n, 3], unit vectors towards the light. eye: float64[3], unit vector. Returns
    axes float64[n, 3, 3], unit rows, and the angles float64[n] from light to eye, 0 to pi.
    """
    cosine = np.clip(light @ eye, -1.0, 1.0)
    across = eye - cosine[:, None] * light
    sine = np.sqrt((across**2).sum(axis=1))
    parallel = sine < PARALLEL
    far = np.eye(3)[np.argmin(np.abs(light), axis=1)]
    far = far - (far * light).sum(axis=1, keepdims=True) * light
    x = np.where(parallel[:, None], far, across)
    x /= np.sqrt((x**2).sum(axis=1, keepdims=True))
    x -= (x * light).sum(axis=1, keepdims=True) * light
    x /= np.sqrt((x**2).sum(axis=1, keepdims=True))
    angle = np.where(parallel, np.where(cosine > 0, 0.0, np.pi), np.arctan2(sine, cosine))
    return np.stack([x, np.cross(light, x), light], axis=1), angle


def half_vectors(axes: Reals, angle: Reals) -> Reals:
    """Unit half vectors float64[n, 3] of light frames (see `frames`): (sin a/2, 0, cos a/2)."""
    return np.sin(angle / 2)[:, None] * axes[:, 0] + np.cos(angle / 2)[:, None] * axes[:, 2]


def carried(axes: Reals, before: Reals, after: Reals) -> Reals:
    """`axes` (float64[n, 3, 3], unit rows) after the least rotation that takes the unit vectors
    `before` to `after` (float64[n, 3] each). No rotation is least between opposite vectors; there
    the axes stay."""
    cosine = (before * after).sum(axis=1)
    opposite = cosine < -0.999999
    across = np.cross(before, after)[:, None]
    once = np.cross(across, axes)
    twice = np.cross(across, once) / np.where(opposite, 1, 1 + cosine)[:, None, None]
    return np.where(opposite[:, None, None], axes, axes + once + twice)


def seen(axes: Reals, vectors: Reals) -> Reals:
    """`vectors` (float64[n, 3]) in the frames `axes` (float64[n, 3, 3])."""
    return np.einsum("nij,nj->ni", axes, vectors)


def of_eye(angle: Reals) -> Reals:
    """The unit eye vectors float64[n, 3] in light frames, for the angles of `frames`."""
    return np.stack([np.sin(angle), np.zeros_like(angle), np.cos(angle)], axis=-1)


def turn(position: Reals, first: Reals, last: Reals, eye: Reals) -> Reals:
    """The angle float64[n], radians, between the directions to the light from the points `first`
    and `last` (float64[n, 3] each)."""
    a, b = toward(position, first, eye), toward(position, last, eye)
    return np.arctan2(np.sqrt((np.cross(a, b) ** 2).sum(axis=1)), (a * b).sum(axis=1))


def span_ends(
    place: Place, eye: Reals, points: tuple[Reals, Reals, Reals, Reals],
    normals: tuple[Reals, Reals],
) -> tuple[Reals, Reals, Reals]:  # fmt: skip
    """The normals of spans at their first and last pixel in the frame of a light, float64[n, 3]
    each, and the angle float64[n] from light to eye that gives the half vector.

    points: at the first pixel, the middle and the last pixel, and the centre of the face,
    float64[n, 3] each. normals: at the first and the last pixel, in the axes of the points.
    """
    assert place.position is not None
    first, middle, last, centre = points
    at = centre if place.rule == "face" else middle
    axes, angle = frames(toward(place.position, at, eye), eye)
    ends = []
    for point, normal in zip((first, last), normals, strict=True):
        there = axes
        if place.rule in ("half", "light"):
            own, its_angle = frames(toward(place.position, point, eye), eye)
            if place.rule == "light":
                there = carried(axes, axes[:, 2], own[:, 2])
            else:
                there = carried(axes, half_vectors(axes, angle), half_vectors(own, its_angle))
        ends.append(seen(there, normal))
    return ends[0], ends[1], angle
