# SPDX-License-Identifier: MIT
"""Normals in the middle of a mesh's edges, for quadratic normals.

Three corner normals cannot show an inflection: where both normals of an edge lean to the same side,
linear interpolation leans to that side all along. The normal in the middle of each edge adds what
is missing (van Overveld and Wyvill 1997, Vlachos et al. 2001). `RULES` names three ways to it:

- "quadratic_vlachos": from both ends of the edge alone. The mean of the normals is reflected across
  the plane at right angles to the edge (Vlachos et al. 2001). There the result is a coefficient of
  the polynomial; here it is the value in the middle of the edge. The errors are alike.
- "quadratic": from the normals around both ends. A curvature at each end gives the change of the
  normal along the edge. The normal in the middle is that of the cubic through both ends. It is then
  taken where the eye sees the surface through the middle of the flat edge, not below it.
- "quadratic_exact": the normal that the eye sees through the middle of the edge, on the surface
  that the mesh stands for (`surface.Surface`).

The second and the third depend on the eye. An edge has the same normal in both of its triangles if
they agree in the normals of its ends.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Reals
from phong75.model.front.mesh import Mesh, normalize, weld

RULES = ("quadratic", "quadratic_vlachos", "quadratic_exact")

#: Towards the outline the seen point runs away from the edge. From this cosine between normal and
#: eye on (78 degrees), the distance stays what it is there.
OUTLINE = 0.2

#: A direction in which the edges around a vertex say less than this share of what they say in the
#: best one counts as unknown: the normal does not change along it.
KNOWN = 1e-6


def mid_edge_normals(mesh: Mesh, rule: str, back: Reals) -> Reals:
    """Unit normals float64[F, 3, 3] in the middle of the edges: k is from corner k to the next.

    rule: one of RULES. back: float64[F, 3, 3], unit vectors from the middle of each edge towards
    the eye. "quadratic_exact" needs `mesh.surface`; where the eye does not see the surface within
    the length of the edge, which happens at the outline, the normal of the curved edge fills in.
    """
    if rule == "quadratic_vlachos":
        return _reflected(mesh)
    curvature = _curvatures(mesh)
    normal = _of_curved_edge(mesh, curvature)
    if rule == "quadratic":
        normal = _seen(mesh, curvature, normal, back)
    else:
        assert mesh.surface is not None  # `scene_to_spans` refuses the scene otherwise
        start, along, _ = _edges(mesh)
        reach = np.sqrt(_dot(along, along))[..., 0].reshape(-1)
        middle = (start + along / 2).reshape(-1, 3)
        hit, exact = mesh.surface.see(middle, _outward(mesh, back).reshape(-1, 3), reach)
        normal = np.where(hit[:, None], exact, normal.reshape(-1, 3)).reshape(normal.shape)
    return normal


def _reflected(mesh: Mesh) -> Reals:
    """The mean of both normals, reflected across the plane at right angles to the edge."""
    _, along, other = _edges(mesh)
    total = mesh.normals + other
    return normalize(total - 2 * _dot(total, along) / _dot(along, along) * along)


def _of_curved_edge(mesh: Mesh, curvature: Reals) -> Reals:
    """The normal in the middle of the cubic curve through both ends of each edge.

    Across the edge, the normal is Hermite's cubic of the normals and of their changes at both ends.
    Along the edge it follows from the points: if both ends lean by s against the flat edge, the
    curve leans by -s/2 in the middle. (Vlachos' reflection leans by -s.)
    """
    _, along, other = _edges(mesh)
    total = mesh.normals + other
    change = _apply(curvature, along) - _apply(np.roll(curvature, -1, axis=1), along)
    middle = total / 2 + change / 8
    lean = -_dot(total, along) / 4  # in place of what the cubic of the normals says along the edge
    return normalize(middle + (lean - _dot(middle, along)) / _dot(along, along) * along)


def _seen(mesh: Mesh, curvature: Reals, middle: Reals, back: Reals) -> Reals:
    """The normal of the surface around each curved edge, where the eye sees that surface through
    the middle of the flat edge.

    middle: normal in the middle of the curved edge. The surface is its tangent plane there, and the
    normal changes by the mean of the curvatures at both ends.
    """
    _, along, other = _edges(mesh)
    normal, beyond = mesh.normals, np.roll(curvature, -1, axis=1)
    # From the middle of the flat edge to that of the curve, the Bezier cubic whose inner points are
    # the third points of the edge, each projected to the tangent plane of the nearer end (Vlachos
    # et al. 2001).
    offset = -(_dot(along, normal) * normal - _dot(along, other) * other) / 8
    out = _outward(mesh, back)
    facing = np.maximum(_dot(middle, out), OUTLINE)
    moved = _dot(offset, middle) / facing * out - offset
    return normalize(middle + _apply((curvature + beyond) / 2, moved))


def _curvatures(mesh: Mesh) -> Reals:
    """The change of the normal with the place at each corner, matrices float64[F, 3, 3, 3].

    Least squares over the edges around a vertex, each projected to the tangent plane, of all
    triangles that have the same normal there; so a crease separates. Each edge weighs as its
    direction alone, whatever its length.
    """
    start, along, other = _edges(mesh)
    place, normal = (weld(columns.reshape(-1, 3))[0] for columns in (start, mesh.normals))
    corner = np.unique(place * place.size + normal, return_inverse=True)[1].reshape(-1)
    count = int(corner.max()) + 1
    squares, products = np.zeros((count, 3, 3)), np.zeros((count, 3, 3))
    backward = np.roll(along, 1, axis=1), np.roll(mesh.normals - other, 1, axis=1)
    for edge, change in ((along, other - mesh.normals), (-backward[0], backward[1])):
        flat = edge - _dot(edge, mesh.normals) * mesh.normals
        size = _dot(flat, flat)
        weight = np.where(size > 0, 1 / np.where(size > 0, size, 1), 0)
        for sums, vector in ((squares, flat), (products, change)):
            for i in range(3):
                for j in range(3):
                    share = (weight[..., 0] * vector[..., i] * flat[..., j]).reshape(-1)
                    sums[:, i, j] += np.bincount(corner, share, count)
    found: Reals = products @ np.linalg.pinv(squares, rcond=KNOWN, hermitian=True)
    return found[corner].reshape(*start.shape[:2], 3, 3)


def _outward(mesh: Mesh, back: Reals) -> Reals:
    """`back` (float64[F, 3, 3]), reversed where it points to the inside of the face."""
    _, along, _ = _edges(mesh)
    face = np.cross(along[:, 0], along[:, 1])[:, None]
    return np.where(_dot(face, back) < 0, -back, back)


def _edges(mesh: Mesh) -> tuple[Reals, Reals, Reals]:
    """First point, vector to the second, and normal at the second, of the edges that leave each
    corner, float64[F, 3, 3] each."""
    start = mesh.vertices[mesh.faces]
    return start, np.roll(start, -1, axis=1) - start, np.roll(mesh.normals, -1, axis=1)


def _dot(a: Reals, b: Reals) -> Reals:
    """Products float64[..., 1] of the vectors `a` and `b` (float64[..., 3])."""
    total: Reals = np.sum(a * b, axis=-1, keepdims=True)
    return total


def _apply(matrix: Reals, vector: Reals) -> Reals:
    """`matrix` (float64[..., 3, 3]) times `vector` (float64[..., 3])."""
    return np.einsum("...ij,...j->...i", matrix, vector)
