# SPDX-License-Identifier: MIT
"""Smooth surfaces behind the meshes: visible point and normal per pixel, change of the normal.

With these a mesh can be compared with the surface itself. Rays are intersected with the sphere in
closed form, with the torus as roots of a quartic, and with the Bezier patch by Newton's method.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from phong75.model.arrays import Flags, Reals
from phong75.model.front import shapes
from phong75.model.front.mesh import Mesh, normalize
from phong75.model.front.shapes import bernstein, bernstein_slope


class Surface(Protocol):
    """A smooth surface with meshes of several resolutions."""

    @property
    def name(self) -> str:
        """The key of the surface in SURFACES."""

    @property
    def levels(self) -> tuple[int, ...]:
        """Numbers of steps of the meshes: around the axis, for the patch from border to border."""

    def mesh(self, level: int) -> Mesh:
        """The mesh with `level` steps; its corners and normals are those of the surface."""

    def see(self, origin: Reals, back: Reals) -> tuple[Flags, Reals]:
        """The first intersection of parallel rays with the surface.

        origin: float64[n, 3], a point of each ray. back: float64[3], unit vector towards the eye;
        the rays go along -back. Returns (hit, normal): bool[n], and float64[n, 3], the unit
        normals at the intersections.
        """

    def turn(self, mesh: Mesh, tangent: Reals) -> Reals:
        """Change of the unit normal at the corners of `mesh` for small steps on the surface.

        tangent: float64[F, 3, 3], a step in the tangent plane at each corner. Returns the
        derivative of the normal along the step, float64[F, 3, 3].
        """


class Solid(Surface, Protocol):
    """A surface that is met by any ray, also by the diverging rays of a perspective camera."""

    def see(self, origin: Reals, back: Reals, farthest: float = np.inf) -> tuple[Flags, Reals]:
        """See `Surface`; every ray may have a direction of its own.

        back: float64[3] or float64[n, 3], unit vectors towards the eye. farthest: only points
        origin + t back with t <= farthest count; 0 if `origin` is the eye itself.
        """


@dataclass(frozen=True)
class Sphere:
    """The unit sphere; its meshes have half as many rings as segments."""

    name: str = "sphere"
    levels: tuple[int, ...] = (8, 16, 32, 64, 128, 256)

    def mesh(self, level: int) -> Mesh:
        """See `Surface`."""
        return shapes.sphere(1.0, level, level // 2)

    def see(self, origin: Reals, back: Reals, farthest: float = np.inf) -> tuple[Flags, Reals]:
        """See `Solid`: the nearer of the two intersections that is not beyond `farthest`."""
        along = np.sum(origin * back, axis=1)
        foot = origin - along[:, None] * back
        square = 1.0 - np.sum(foot * foot, axis=1)
        half = np.sqrt(np.maximum(square, 0.0))
        half = np.where(half - along <= farthest, half, -half)
        return (square >= 0) & (half - along <= farthest), foot + half[:, None] * back

    def turn(self, mesh: Mesh, tangent: Reals) -> Reals:
        """See `Surface`: the normal of the unit sphere is the point itself."""
        return tangent


@dataclass(frozen=True)
class Torus:
    """A torus around the z axis, radii 1 and `tube`; half as many sides as segments."""

    name: str = "torus"
    levels: tuple[int, ...] = (8, 16, 32, 64, 128, 256)
    tube: float = 0.4

    def mesh(self, level: int) -> Mesh:
        """See `Surface`."""
        return shapes.torus(1.0, self.tube, level, level // 2)

    def normal(self, points: np.ndarray) -> np.ndarray:
        """Unit normals at `points` (float64[..., 3]) on or near the torus."""
        ring = points[..., :2] / np.linalg.norm(points[..., :2], axis=-1, keepdims=True)
        return normalize(points - np.concatenate([ring, np.zeros_like(ring[..., :1])], axis=-1))

    def see(self, origin: Reals, back: Reals, farthest: float = np.inf) -> tuple[Flags, Reals]:
        """See `Solid`: the largest real root, up to `farthest`, of
        (|P|^2 + 1 - r^2)^2 = 4 (x^2 + y^2)."""
        a = np.sum(origin * back, axis=1)
        b = np.sum(origin * origin, axis=1) + 1.0 - self.tube**2
        xy, direction = origin[:, :2], back[..., :2]
        one = np.ones_like(a)
        quartic = np.stack(
            [
                one, 4 * a, 4 * a * a + 2 * b - 4 * np.sum(direction * direction, axis=-1),
                4 * a * b - 8 * np.sum(xy * direction, axis=1),
                b * b - 4 * np.sum(xy * xy, axis=1),
            ], axis=1,
        )  # fmt: skip
        companion = np.zeros((len(a), 4, 4))
        companion[:, 1:, :3] = np.eye(3)
        companion[:, 0] = -quartic[:, 1:]
        roots = np.linalg.eigvals(companion)
        real = (np.abs(roots.imag) < 1e-6) & (roots.real <= farthest)
        t = np.max(np.where(real, roots.real, -np.inf), axis=1)
        hit = np.isfinite(t)
        t = np.where(hit, t, 0.0)
        for _ in range(2):  # Newton's method, except where the ray is nearly tangent
            value, slope = _polynomial(quartic, t), _polynomial(quartic * [4, 3, 2, 1, 0], t, 4)
            t = t - np.where(np.abs(slope) > 1e-6, value / np.where(slope == 0, 1, slope), 0.0)
        # Rays that miss get the normal of a point on the torus; on the axis there is none.
        return hit, self.normal(np.where(hit[:, None], origin + t[:, None] * back, (1, 0, 1)))

    def turn(self, mesh: Mesh, tangent: Reals) -> Reals:
        """See `Surface`: difference of normals off the surface, which `normal` defines as well."""
        points, step = mesh.vertices[mesh.faces], 1e-5
        return (self.normal(points + step * tangent) - self.normal(points - step * tangent)) / (
            2 * step
        )


def _polynomial(coefficients: Reals, t: Reals, terms: int = 5) -> Reals:
    """The polynomial of the first `terms` of `coefficients` (float64[n, 5]) at t (float64[n])."""
    value = np.zeros_like(t)
    for k in range(terms):
        value = value * t + coefficients[:, k]
    return value


@dataclass(frozen=True)
class Patch:
    """A patch of the teapot: one quarter of the upper body."""

    name: str = "patch"
    levels: tuple[int, ...] = (1, 2, 4, 8, 16, 32)
    number: int = 4

    @cached_property
    def control(self) -> np.ndarray:
        """The control points, float64[4, 4, 3], indices u, v."""
        return shapes.teapot_patch(self.number)

    def mesh(self, level: int) -> Mesh:
        """See `Surface`."""
        return shapes.patch_mesh(self.control, level)

    def at(self, u: Reals, v: Reals) -> list[Reals]:
        """Points, dS/du and dS/dv at the parameters `u`, `v` (float64[n]), float64[n, 3] each."""
        in_u, in_v = (bernstein(u), bernstein_slope(u)), (bernstein(v), bernstein_slope(v))
        return [
            (in_u[i][:, :, None] * in_v[j][:, None, :]).reshape(-1, 16)
            @ self.control.reshape(16, 3)
            for i, j in ((0, 0), (1, 0), (0, 1))
        ]

    def see(self, origin: Reals, back: Reals) -> tuple[Flags, Reals]:
        """See `Surface`: Newton's method from the nearest point of a grid on the patch.

        Valid only for views in which no ray meets the patch twice.
        """
        return self._see(origin, back, 0.0)

    def see_beyond(self, origin: Reals, back: Reals) -> tuple[Flags, Reals]:
        """As `see`, for the patch continued a little beyond its borders, where the straight edges
        of a mesh are."""
        return self._see(origin, back, 0.1)

    def _see(self, origin: Reals, back: Reals, beyond: float) -> tuple[Flags, Reals]:
        """`see` with the parameters u and v from -`beyond` to 1 + `beyond`."""
        axis = np.eye(3)[np.argmin(np.abs(back))]
        right = normalize(np.cross(axis, back))
        screen = np.stack([right, np.cross(back, right)])
        target, hull = origin @ screen.T, self.control.reshape(-1, 3) @ screen.T
        near = np.all((target >= hull.min(axis=0)) & (target <= hull.max(axis=0)), axis=1)
        hit, normal = np.zeros(len(target), bool), np.zeros((len(target), 3))
        hit[near], normal[near] = self._solve(target[near], screen, beyond)
        return hit, normal

    def _solve(self, target: Reals, screen: Reals, beyond: float) -> tuple[Flags, Reals]:
        """The points of the patch that are projected to `target`.

        target: float64[n, 2], screen coordinates. screen: float64[2, 3], axes of the screen.
        beyond: see `_see`. Returns (hit, normal) as `see` does.
        """
        grid = np.linspace(0, 1, 33)
        u0, v0 = (c.reshape(-1) for c in np.meshgrid(grid, grid))
        start = self.at(u0, v0)[0] @ screen.T
        nearest = np.empty(len(target), np.int64)
        for block in np.array_split(np.arange(len(target)), len(target) // 20_000 + 1):
            distance = np.sum(start * start, axis=1) - 2 * target[block] @ start.T
            nearest[block] = np.argmin(distance, axis=1)
        u, v = u0[nearest], v0[nearest]
        for _ in range(8):
            point, du, dv = self.at(u, v)
            miss, a, b = target - point @ screen.T, du @ screen.T, dv @ screen.T
            det = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
            det = np.where(np.abs(det) < 1e-12, 1e-12, det)
            u = np.clip(u + (miss[:, 0] * b[:, 1] - miss[:, 1] * b[:, 0]) / det, -0.2, 1.2)
            v = np.clip(v + (a[:, 0] * miss[:, 1] - a[:, 1] * miss[:, 0]) / det, -0.2, 1.2)
        point, du, dv = self.at(u, v)
        converged = np.linalg.norm(target - point @ screen.T, axis=1) < 1e-10
        hit = converged & (np.minimum(u, v) >= -beyond) & (np.maximum(u, v) <= 1 + beyond)
        return hit, normalize(np.cross(dv, du))

    def turn(self, mesh: Mesh, tangent: Reals) -> Reals:
        """See `Surface`: the step is converted to the parameters u and v of each corner."""
        steps = round(len(mesh.vertices) ** 0.5) - 1
        corner = mesh.faces.reshape(-1)
        u, v = (corner % (steps + 1)) / steps, (corner // (steps + 1)) / steps
        _, du, dv = self.at(u, v)
        basis = np.stack([du, dv], axis=-1)
        step = np.einsum("nij,nj->ni", np.linalg.pinv(basis), tangent.reshape(-1, 3)) * 1e-5

        def normal(u: Reals, v: Reals) -> Reals:
            _, du, dv = self.at(u, v)
            return normalize(np.cross(dv, du))

        ahead, behind = (normal(u + s * step[:, 0], v + s * step[:, 1]) for s in (1, -1))
        return ((ahead - behind) / 2e-5).reshape(tangent.shape)


SURFACES: dict[str, Surface] = {s.name: s for s in (Sphere(), Torus(), Patch())}
