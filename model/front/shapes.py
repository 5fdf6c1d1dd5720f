"""The bundled shapes, with exact normals: sphere, torus, cone, pyramid, and the Utah teapot.

All stand on or around the origin with z up, and wind counter-clockwise seen from outside.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from phong75.model.front.mesh import Mesh, corner_normals, normalize

TEAPOT_FILE = Path(__file__).parent.parent / "data" / "newell_teapot_patches.txt"


def sphere(radius: float = 1.0, segments: int = 64, rings: int = 32) -> Mesh:
    """A sphere around the origin: `segments` round the z axis, `rings` from pole to pole."""
    polar = np.linspace(0.0, np.pi, rings + 1)[:, None]
    around = _turn(segments)[None, :]
    unit = np.stack(
        np.broadcast_arrays(
            np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)
        ),
        axis=-1,
    )
    unit[0], unit[-1] = (0, 0, 1), (0, 0, -1)  # exact poles: sin(pi) is not quite 0
    unit[:, -1] = unit[:, 0]  # and an exact seam
    return _grid_mesh(radius * unit, unit)


def torus(radius: float = 1.0, tube: float = 0.4, segments: int = 64, sides: int = 32) -> Mesh:
    """A torus around the z axis: a `tube` of that radius at `radius` from the axis."""
    around, across = _turn(segments)[None, :], -_turn(sides)[:, None]
    unit = np.stack(
        np.broadcast_arrays(
            np.cos(across) * np.cos(around), np.cos(across) * np.sin(around), np.sin(across)
        ),
        axis=-1,
    )
    unit[-1], unit[:, -1] = unit[0], unit[:, 0]
    centre = np.stack(
        np.broadcast_arrays(np.cos(around), np.sin(around), np.zeros_like(around)), axis=-1
    )
    centre[:, -1] = centre[:, 0]
    return _grid_mesh(radius * centre + tube * unit, unit)


def cone(radius: float = 1.0, height: float = 2.0, segments: int = 16, rings: int = 8) -> Mesh:
    """A cone on the plane z = 0 with its apex at z = `height` (Phong 1975, Fig. 1).

    Normals are those of the true cone; the apex, where it has none, takes in each facet the one
    of the facet's middle. `rings` cut the flat facets across, ever closer towards the apex, so
    that this compromise stays near it. The base is a flat disc with a sharp rim.
    """
    around = _turn(segments)
    level = np.linspace(0.0, 1.0, rings + 1)[:, None] ** 2  # 0 at the apex, 1 at the rim
    circle = np.stack([np.cos(around), np.sin(around)], axis=-1)
    circle[-1] = circle[0]
    points = np.empty((rings + 1, segments + 1, 3))
    points[..., :2] = radius * level[..., None] * circle
    points[..., 2] = height * (1.0 - level)
    unit = np.empty_like(points)
    unit[..., :2], unit[..., 2] = height * circle, radius
    side = _grid_mesh(points, normalize(unit))
    middle = around[:-1] + np.pi / segments
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
    """The square pyramid of the lecture notes' `pyramid.des`, flat faces, sharp edges.

    Vertices as listed there: base from (0, 0, 0) to (width, width, 0), apex above its middle.
    """
    half = width / 2.0
    vertices = np.array(
        [(0, 0, 0), (width, 0, 0), (width, width, 0), (0, width, 0), (half, half, height)], float
    )
    faces = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2), (0, 2, 1)])
    return Mesh(vertices, faces, corner_normals(vertices, faces, 0.0))


def teapot(divisions: int = 10) -> Mesh:
    """The Utah teapot (Newell 1975): 32 bicubic patches, `divisions` by `divisions` quads each.

    Normals are those of the patches (`patch_surface`), also where a patch closes in a point, at
    the tip of the lid and the middle of the bottom.
    """
    points, patches = _read_patches()
    grid, normals = patch_surface(points[patches].reshape(-1, 4, 4, 3), divisions)
    grid, normals = grid.swapaxes(1, 2), normals.swapaxes(1, 2)  # u across, v down
    meshes = [_grid_mesh(g, n) for g, n in zip(grid, normals, strict=True)]
    vertices = np.concatenate([m.vertices for m in meshes])
    offsets = np.cumsum([0] + [len(m.vertices) for m in meshes[:-1]])
    faces = np.concatenate([m.faces + o for m, o in zip(meshes, offsets, strict=True)])
    # Neighbouring patches compute the points of a common border each for itself, and differ in
    # the last bit: take one of them for both, or a crack may open. The odd offset keeps points
    # with few decimals away from where the rounding turns.
    _, first, place = np.unique(
        np.floor(vertices * 1e9 + 0.3719), axis=0, return_index=True, return_inverse=True
    )
    normals = np.concatenate([m.normals for m in meshes])
    return Mesh(vertices[first], place.reshape(-1)[faces], normals)


def teapot_patch(number: int) -> np.ndarray:
    """float64[4, 4, 3]: the control points of patch `number` (0 to 31) of the teapot, by u, then v.

    0 to 3 are the rim, 4 to 11 the body, 12 to 15 the handle, 16 to 19 the spout, 20 to 27 the lid
    and 28 to 31 the bottom.
    """
    points, patches = _read_patches()
    return points[patches[number]].reshape(4, 4, 3)


def patch_mesh(control: np.ndarray, divisions: int = 10) -> Mesh:
    """One bicubic patch, float64[4, 4, 3]; vertex (D + 1) j + i has u = i/D, v = j/D."""
    grid, normals = patch_surface(control[None], divisions)
    return _grid_mesh(grid[0].swapaxes(0, 1), normals[0].swapaxes(0, 1))


def patch_surface(control: np.ndarray, divisions: int) -> tuple[np.ndarray, np.ndarray]:
    """Points and unit normals of bicubic Bezier patches on a regular grid of parameters.

    control: float64[P, 4, 4, 3], by u, then v. Returns two float64[P, D + 1, D + 1, 3],
    D = `divisions`. The normal is dS/dv x dS/du (Newell's patches then face outward). Where a
    border shrinks to a point one derivative vanishes, and the normal is the limit along the
    other parameter: near u = 0, dS/dv = u d2S/dudv.
    """
    t = np.linspace(0.0, 1.0, divisions + 1)
    value, slope = bernstein(t), bernstein_slope(t)

    def surface(in_u, in_v):
        return np.einsum("ui,pijc,vj->puvc", in_u, control, in_v)

    along_u, along_v = surface(slope, value), surface(value, slope)
    mixed = surface(slope, slope)
    size = np.max(np.abs(control), axis=(1, 2, 3))[:, None, None]

    def vanishes(d):
        return (np.max(np.abs(d), axis=-1) < 1e-9 * size)[..., None]

    # The limit from inside: towards growing u at u = 0, towards falling u at u = 1.
    inward_u = np.where(t < 0.5, 1.0, -1.0)[None, :, None, None]
    inward_v = np.where(t < 0.5, 1.0, -1.0)[None, None, :, None]
    du = np.where(vanishes(along_u), inward_v * mixed, along_u)
    dv = np.where(vanishes(along_v), inward_u * mixed, along_v)
    return surface(value, value), normalize(np.cross(dv, du))


def _read_patches() -> tuple[np.ndarray, np.ndarray]:
    """Control points float64[N, 3] and patches int64[P, 16] (rows of indices) of the teapot."""
    lines = [
        line for line in TEAPOT_FILE.read_text(encoding="ascii").splitlines() if line[0] != "#"
    ]
    count, patches = map(int, lines[0].split())
    points = np.array([line.split() for line in lines[1 : 1 + count]], np.float64)
    indices = np.array([line.split() for line in lines[1 + count :]], np.int64)
    assert indices.shape == (patches, 16)
    return points, indices


def bernstein(t: np.ndarray) -> np.ndarray:
    """float64[T, 4]: the cubic Bernstein polynomials at `t` (float64[T])."""
    s = 1.0 - t
    return np.stack([s**3, 3 * t * s**2, 3 * t**2 * s, t**3], axis=-1)


def bernstein_slope(t: np.ndarray) -> np.ndarray:
    """float64[T, 4]: their derivatives."""
    s = 1.0 - t
    return np.stack([-3 * s**2, 3 * s**2 - 6 * t * s, 6 * t * s - 3 * t**2, 3 * t**2], axis=-1)


def _turn(steps: int) -> np.ndarray:
    """float64[steps + 1]: angles from 0 to a full turn, both ends included."""
    return np.linspace(0.0, 2.0 * np.pi, steps + 1)


def _grid_mesh(points: np.ndarray, normals: np.ndarray) -> Mesh:
    """Two triangles for each cell of a grid of points float64[R, C, 3] with unit normals of the
    same shape; columns run counter-clockwise and rows downward, seen from outside. Triangles
    that collapse, at a pole, are left out."""
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
    return Mesh(vertices, faces, unit[faces])
