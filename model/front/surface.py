# SPDX-License-Identifier: MIT
"""The smooth surfaces that meshes of bundled shapes stand for, as the eye sees them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from phong75.model.arrays import Flags, Reals

#: Steps of Newton's method in `Implicit.see`. Each doubles the number of right digits, but for rays
#: that nearly touch the surface.
STEPS = 30


class Surface(Protocol):
    """A smooth surface."""

    def see(self, origin: Reals, back: Reals, reach: Reals) -> tuple[Flags, Reals]:
        """Where rays leave the surface.

        origin, back: float64[n, 3], a point of each ray near the surface, and the unit vector along
        the ray, out of the surface. reach: float64[n], how far from `origin` to look. Returns (hit,
        normal): bool[n], and the unit normals float64[n, 3] where the rays leave the surface.
        """


@dataclass(frozen=True)
class Implicit:
    """The surface on which a function of the place is 0; the function grows outward.

    of: gives the function float64[n] and its gradient float64[n, 3] at points float64[n, 3]. size:
    largest extent of the surface, scene units.
    """

    of: Callable[[Reals], tuple[Reals, Reals]]
    size: float

    def see(self, origin: Reals, back: Reals, reach: Reals) -> tuple[Flags, Reals]:
        """See `Surface`: by Newton's method along the ray, from `origin`, and where that comes to
        where the ray enters the surface, from the end of the reach."""
        hit, normal = self._solve(origin, back, reach, np.zeros(len(origin)))
        again, other = self._solve(origin, back, reach, reach)
        return hit | again, np.where(hit[:, None], normal, other)

    def _solve(self, origin: Reals, back: Reals, reach: Reals, t: Reals) -> tuple[Flags, Reals]:
        """`see` with the places `t` (float64[n]) along the rays to start from."""
        for _ in range(STEPS):
            value, gradient = self.of(origin + t[:, None] * back)
            slope = np.sum(gradient * back, axis=1)
            flat = slope == 0
            t = np.clip(t - np.where(flat, 0, value / np.where(flat, 1, slope)), -reach, reach)
        value, gradient = self.of(origin + t[:, None] * back)
        length = np.linalg.norm(gradient, axis=1)
        out = np.sum(gradient * back, axis=1) > 0
        hit = out & (np.abs(value) <= 1e-12 * self.size * length) & (np.abs(t) < reach)
        return hit, gradient / np.where(length > 0, length, 1)[:, None]


@dataclass(frozen=True)
class Transformed:
    """`surface` moved: its points P are at matrix P + shift; matrix: float64[3, 3]."""

    surface: Surface
    matrix: Reals
    shift: Reals

    def see(self, origin: Reals, back: Reals, reach: Reals) -> tuple[Flags, Reals]:
        """See `Surface`."""
        inverse = np.linalg.inv(self.matrix)
        along = back @ inverse.T
        length = np.linalg.norm(along, axis=1)
        hit, normal = self.surface.see(
            (origin - self.shift) @ inverse.T, along / length[:, None], reach * length
        )
        normal = normal @ inverse
        size = np.linalg.norm(normal, axis=1)
        return hit, normal / np.where(size > 0, size, 1)[:, None]


def sphere(radius: float) -> Implicit:
    """The sphere around the origin."""

    def of(point: Reals) -> tuple[Reals, Reals]:
        return np.sum(point * point, axis=1) - radius**2, 2 * point

    return Implicit(of, radius)


def torus(radius: float, tube: float) -> Implicit:
    """The torus around the z axis: a tube of radius `tube` at distance `radius` from the axis."""

    def of(point: Reals) -> tuple[Reals, Reals]:
        ring = np.hypot(point[:, 0], point[:, 1])
        inward = radius / np.where(ring > 0, ring, 1)
        gradient = 2 * point
        gradient[:, :2] *= (1 - inward)[:, None]
        return (ring - radius) ** 2 + point[:, 2] ** 2 - tube**2, gradient

    return Implicit(of, radius + tube)
