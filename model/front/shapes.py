# SPDX-License-Identifier: MIT
"""Bundled shapes with exact normals: sphere, torus, cone, pyramid and the Utah teapot.

All shapes are at the origin with z up. Faces are counter-clockwise seen from outside. Lengths are
in scene units.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from phong75.model.arrays import Flags, Ints, Reals
from phong75.model.front import surface
from phong75.model.front.mesh import Mesh, corner_normals, normalize

TEAPOT_FILE = Path(__file__).parent.parent / "data" / "newell_teapot_patches.txt"


def sphere(radius: float = 1.0, segments: int = 64, rings: int = 32) -> Mesh:
    """A sphere around the origin: `segments` around the z axis, `rings` from pole to pole."""
    polar = np.linspace(0.0, np.pi, rings + 1)[:, None]
    azimuth = _full_turn(segments)[None, :]
    unit = np.stack(
        np.broadcast_arrays(
            np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)
        ),
        axis=-1,
    )
    unit[0], unit[-1] = (0, 0, 1), (0, 0, -1)  # exact poles: sin(pi) is not exactly 0
    unit[:, -1] = unit[:, 0]  # exact seam
    return _grid_mesh(radius * unit, unit, surface.sphere(radius))


def torus(radius: float = 1.0, tube: float = 0.4, segments: int = 64, sides: int = 32) -> Mesh:
    """A torus around the z axis: a tube of radius `tube` at distance `radius` from the axis.

    segments: steps around the z axis. sides: steps around the tube.
    """
    azimuth, tube_angle = _full_turn(segments)[None, :], -_full_turn(sides)[:, None]
    unit = np.stack(
        np.broadcast_arrays(
            np.cos(tube_angle) * np.cos(azimuth),
            np.cos(tube_angle) * np.sin(azimuth),
            np.sin(tube_angle),
        ),
        axis=-1,
    )
    unit[-1], unit[:, -1] = unit[0], unit[:, 0]
    centre = np.stack(
        np.broadcast_arrays(np.cos(azimuth), np.sin(azimuth), np.zeros_like(azimuth)), axis=-1
    )
    centre[:, -1] = centre[:, 0]
    return _grid_mesh(radius * centre + tube * unit, unit, surface.torus(radius, tube))


def cone(radius: float = 1.0, height: float = 2.0, segments: int = 16, rings: int = 8) -> Mesh:
    """A cone on the plane z = 0 with its apex at z = `height` (Phong 1975, Fig. 1).

    Normals are those of the true cone. The true cone has no normal at the apex; there each facet
    takes the normal of its middle. `rings` subdivides the facets, more finely towards the apex, so
    that the wrong normals affect only a small area. The base is a flat disc with a sharp rim.
    """
    azimuth = _full_turn(segments)
    level = np.linspace(0.0, 1.0, rings + 1)[:, None] ** 2  # 0 at the apex, 1 at the rim
    circle = np.stack([np.cos(azimuth), np.sin(azimuth)], axis=-1)
    circle[-1] = circle[0]
    points = np.empty((rings + 1, segments + 1, 3))
    points[..., :2] = radius * level[..., None] * circle
    points[..., 2] = height * (1.0 - level)
    unit = np.empty_like(points)
    unit[..., :2], unit[..., 2] = height * circle, radius
    side = _grid_mesh(points, normalize(unit))
    middle = azimuth[:-1] + np.pi / segments
    slope = np.stack(
        [height * np.cos(middle), height * np.sin(middle), np.full(segments, radius)], axis=-1
    )
    at_apex = np.flatnonzero((side.faces < segments + 1).any(axis=1))
    corner = np.argmax(side.faces[at_apex] < segments + 1, axis=1)
    side.normals[at_apex, corner] = normalize(slope)[side.faces[at_apex, corner]]

    rim = points[-1, :-1]
    vertices = np.concatenate([side.vertices, rim, [[0.0, 0.0, 0.0]]])
    first = len(side.vertices)
    index = np.arange(segments)
    base = np.stack(
        [np.full(segments, first + segments), first + (index + 1) % segments, first + index], -1
    )
    down = np.broadcast_to([0.0, 0.0, -1.0], (segments, 3, 3))
    return Mesh(vertices, np.concatenate([side.faces, base]), np.concatenate([side.normals, down]))


def pyramid(width: float = 150.0, height: float = 150.0) -> Mesh:
    """A square pyramid with flat faces and sharp edges, from the lecture notes' `pyramid.des`.

    The vertices are those of the file: base from (0, 0, 0) to (width, width, 0), apex above the
    middle of the base.
    """
    half = width / 2.0
    vertices = np.array(
        [(0, 0, 0), (width, 0, 0), (width, width, 0), (0, width, 0), (half, half, height)], float
    )
    faces = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2), (0, 2, 1)])
    return Mesh(vertices, faces, corner_normals(vertices, faces, 0.0))


def teapot(divisions: int = 10) -> Mesh:
    """The Utah teapot (Newell 1975): 32 bicubic patches of `divisions` by `divisions` quads.

    Normals are those of the patches (`patch_surface`), including the tip of the lid and the middle
    of the bottom, where a border of a patch shrinks to a point.
    """
    points, patches = _read_patches()
    grid, normals = patch_surface(points[patches].reshape(-1, 4, 4, 3), divisions)
    grid, normals = grid.swapaxes(1, 2), normals.swapaxes(1, 2)  # u across, v down
    meshes = [_grid_mesh(g, n) for g, n in zip(grid, normals, strict=True)]
    vertices = np.concatenate([m.vertices for m in meshes])
    offsets = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    faces = np.concatenate([m.faces + o for m, o in zip(meshes, offsets, strict=True)])
    # Two patches compute the points of their common border separately, and the results may differ
    # in the last bit. One copy replaces both, or a crack may open. The offset 0.3719 keeps
    # coordinates with few decimals away from the steps of floor.
    _, first, label = np.unique(
        np.floor(vertices * 1e9 + 0.3719), axis=0, return_index=True, return_inverse=True
    )
    normals = np.concatenate([m.normals for m in meshes])
    return Mesh(vertices[first], label.reshape(-1)[faces], normals)


def teapot_patch(number: int) -> Reals:
    """Control points float64[4, 4, 3] (indices u, v) of patch `number` (0 to 31) of the teapot.

    Patches 0 to 3 are the rim, 4 to 11 the body, 12 to 15 the handle, 16 to 19 the spout, 20 to 27
    the lid and 28 to 31 the bottom.
    """
    points, patches = _read_patches()
    return points[patches[number]].reshape(4, 4, 3)


def patch_mesh(control: Reals, divisions: int = 10) -> Mesh:
    """The mesh of one bicubic patch with D = `divisions` steps in u and in v.

    control: float64[4, 4, 3], control points, indices u, v. Vertex (D + 1) j + i has u = i/D and
    v = j/D.
    """
    grid, normals = patch_surface(control[None], divisions)
    return _grid_mesh(grid[0].swapaxes(0, 1), normals[0].swapaxes(0, 1))


def patch_surface(control: Reals, divisions: int) -> tuple[Reals, Reals]:
    """Points and unit normals of bicubic Bezier patches on a regular grid of parameters.

    control: float64[P, 4, 4, 3], control points of P patches, indices u, v. Returns (points,
    normals), float64[P, D + 1, D + 1, 3] each, D = `divisions`. The normal is dS/dv x dS/du, which
    points outward for Newell's patches. Where a border shrinks to a point, one derivative
    vanishes; the normal there is the limit along the other parameter: near u = 0,
    dS/dv = u d2S/dudv.
    """
    t = np.linspace(0.0, 1.0, divisions + 1)
    value, slope = bernstein(t), bernstein_slope(t)

    def surface(in_u: Reals, in_v: Reals) -> Reals:
        return np.einsum("ui,pijc,vj->puvc", in_u, control, in_v)

    along_u, along_v = surface(slope, value), surface(value, slope)
    mixed = surface(slope, slope)
    size = np.max(np.abs(control), axis=(1, 2, 3))[:, None, None]

    def vanishes(derivative: Reals) -> Flags:
        return (np.max(np.abs(derivative), axis=-1) < 1e-9 * size)[..., None]

    # The limit is taken from inside the patch: increasing u at u = 0, decreasing u at u = 1.
    inward_u = np.where(t < 0.5, 1.0, -1.0)[None, :, None, None]
    inward_v = np.where(t < 0.5, 1.0, -1.0)[None, None, :, None]
    du = np.where(vanishes(along_u), inward_v * mixed, along_u)
    dv = np.where(vanishes(along_v), inward_u * mixed, along_v)
    return surface(value, value), normalize(np.cross(dv, du))


def _read_patches() -> tuple[Reals, Ints]:
    """Control points float64[N, 3] of the teapot, and the indices of each patch, int64[P, 16]."""
    lines = [
        line for line in TEAPOT_FILE.read_text(encoding="ascii").splitlines() if line[0] != "#"
    ]
    count, patches = map(int, lines[0].split())
    points = np.array([line.split() for line in lines[1 : 1 + count]], np.float64)
    indices = np.array([line.split() for line in lines[1 + count :]], np.int64)
    assert indices.shape == (patches, 16)
    return points, indices


def bernstein(t: Reals) -> Reals:
    """The four cubic Bernstein polynomials at `t` (float64[T]), float64[T, 4]."""
    s = 1.0 - t
    return np.stack([s**3, 3 * t * s**2, 3 * t**2 * s, t**3], axis=-1)


def bernstein_slope(t: Reals) -> Reals:
    """Derivatives of the cubic Bernstein polynomials at `t` (float64[T]), float64[T, 4]."""
    s = 1.0 - t
    return np.stack([-3 * s**2, 3 * s**2 - 6 * t * s, 6 * t * s - 3 * t**2, 3 * t**2], axis=-1)


def _full_turn(steps: int) -> Reals:
    """Angles from 0 to 2 pi in radians, both ends included, float64[steps + 1]."""
    return np.linspace(0.0, 2.0 * np.pi, steps + 1)


def _grid_mesh(points: Reals, normals: Reals, smooth: surface.Surface | None = None) -> Mesh:
    """Mesh of a grid of points, two triangles per cell; triangles without area are left out.

    points, normals: float64[R, C, 3], unit normals. Seen from outside, columns go to the right and
    rows downward. Triangles without area occur at poles. smooth: `Mesh.surface`.
    """
    rows, columns = points.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].reshape(-1), index[:-1, 1:].reshape(-1)
    c, d = index[1:, :-1].reshape(-1), index[1:, 1:].reshape(-1)
    faces = np.stack([a, c, d, a, d, b], axis=-1).reshape(-1, 3)
    vertices, unit = points.reshape(-1, 3), normals.reshape(-1, 3)
    p, q, r = (vertices[faces[:, i]] for i in range(3))
    size = np.max(np.abs(vertices)) or 1.0
    distinct = [np.max(np.abs(e), axis=1) > 1e-9 * size for e in (p - q, q - r, r - p)]
    faces = faces[np.logical_and.reduce(distinct)]
    return Mesh(vertices, faces, unit[faces], surface=smooth)
