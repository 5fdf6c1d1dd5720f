# SPDX-License-Identifier: MIT
"""Normals made from the faces of a mesh: one per face, or one per corner of each face."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.arrays import Flags, Ints, Reals
from phong75.model.front.mesh_topology import Edges, components, orbits, weld
from phong75.model.front.vectors import blocks, normalize

#: Default crease angle, degrees: edges that bend by more than this stay sharp. The side faces of a
#: regular prism bend by 360/n degrees: 51.4 for n = 7, 60 for n = 6. So no regular polygon is near
#: this angle, and rounded coordinates cannot make some of its edges sharp and others smooth.
DEFAULT_CREASE = 56.0

#: A triangle is degenerate if twice its area divided by the square of its longest edge is at most
#: this. The normal of such a triangle would be rounding noise.
DEGENERATE_AREA = 1e-12

#: Neighbouring faces whose normals differ by less than this angle, in radians, form one flat face.
#: Coordinates of 24 bits turn the normal of a triangle of 1/1000 of the mesh's size by about this.
FLAT = 1e-4

#: A flat face keeps its own normal at a vertex if its area is this many times that of each other
#: face there, and if it has this share of the weight by angle and area. So a chamfer up to about
#: a quarter as wide as the face beside it leaves that face flat.
LARGE = 4.0
DOMINANT = 0.75

#: Sums of normals are in integer multiples of this. 2**15 angles of at most pi fit 63 bits.
QUANTUM = 2.0**-46


def face_normals(vertices: Reals, faces: Ints) -> Reals:
    """Unit normals of the faces, float64[F, 3]; zero for degenerate faces.

    vertices: float64[V, 3]. faces: int64[F, 3].
    """
    return normals_and_areas(vertices, faces)[0]


def normals_and_areas(vertices: Reals, faces: Ints) -> tuple[Reals, Reals]:
    """Unit normals of the faces, float64[F, 3], and their areas, float64[F]; zero for degenerate
    faces. Arguments as for `face_normals`."""
    measured = measure(vertices, faces)
    return measured.normal.T.copy(), measured.area


@dataclass
class Measures:
    """Normals, areas and angles of F triangles.

    normal: float64[3, F], components of unit vectors; zero for degenerate faces. area: float64[F],
    zero for degenerate faces. angle: float64[F, 3], at the corners, radians.
    """

    normal: Reals
    area: Reals
    angle: Reals

    def take(self, which: Flags) -> Measures:
        """Those of the faces `which`."""
        return Measures(self.normal[:, which], self.area[which], self.angle[which])

    def turned(self, which: Flags) -> Measures:
        """Those of the same faces, `which` of them wound the other way."""
        return Measures(
            np.where(which, -self.normal, self.normal),
            self.area,
            np.where(which[:, None], self.angle[:, ::-1], self.angle),
        )


def measure(vertices: Reals, faces: Ints) -> Measures:
    """The measures of `faces`. Arguments as for `face_normals`.

    Sides are divided by their largest component, so that squares neither overflow nor underflow.
    """
    count = len(faces)
    result = Measures(np.empty((3, count)), np.empty(count), np.empty((count, 3)))
    columns = [np.ascontiguousarray(column) for column in vertices.T]
    for block in blocks(count):
        corners = np.ascontiguousarray(faces[block].T)
        x, y, z = (column.take(corners) for column in columns)
        (x0, x1, x2), (y0, y1, y2), (z0, z1, z2) = (
            (c[1] - c[0], c[2] - c[1], c[0] - c[2]) for c in (x, y, z)
        )
        longest = np.zeros(x.shape[1])
        for side in (x0, x1, x2, y0, y1, y2, z0, z1, z2):
            np.maximum(longest, np.abs(side), out=longest)
        divisor = np.where(longest > 0, longest, 1.0)
        for side in (x0, x1, x2, y0, y1, y2, z0, z1, z2):
            side /= divisor
        cross = z0 * y2 - y0 * z2, x0 * z2 - z0 * x2, y0 * x2 - x0 * y2
        length = np.sqrt(cross[0] ** 2 + cross[1] ** 2 + cross[2] ** 2)
        good = length > DEGENERATE_AREA
        divisor = np.where(good, length, 1.0)
        for axis in range(3):
            result.normal[axis, block] = np.where(good, cross[axis] / divisor, 0.0)
        result.area[block] = np.where(good, length * longest**2 / 2.0, 0.0)
        angle = result.angle[block]
        angle[:, 0] = np.arctan2(length, -(x0 * x2 + y0 * y2 + z0 * z2))
        angle[:, 1] = np.arctan2(length, -(x1 * x0 + y1 * y0 + z1 * z0))
        angle[:, 2] = np.arctan2(length, -(x2 * x1 + y2 * y1 + z2 * z1))
    return result


def corner_normals(
    vertices: Reals, faces: Ints, crease: float, smoothing: Ints | None = None
) -> Reals:
    """Unit normals of all corners, float64[F, 3, 3], computed from the faces alone.

    The normal at a corner is the weighted mean of the normals of the faces around its vertex. Only
    faces that are connected to the corner's face across smooth edges count (Starkey, "Shading
    Techniques", section 3: average only what should appear smoothly connected). An edge is smooth
    if it bends by at most `crease` degrees; 0 gives flat faces, 180 smooths every edge.

    smoothing: int64[F], smoothing groups of an OBJ file or None. An edge between two faces of group
    0 or more is smooth if both have the same group and the group is not 0; the angle does not
    matter. Edges of faces with group -1 follow `crease`.

    The weight of a face is its angle at the vertex (Thuermer and Wuethrich 1998), so that the mean
    does not depend on how polygons were cut into triangles. A flat face that is far larger than the
    others at a vertex keeps its own normal (see `LARGE`), so that the faces of a part stay flat
    beside its chamfers. Vertices with equal coordinates are treated as one vertex. The order
    of the faces does not change the result.
    """
    label, first = weld(vertices)
    vertices, faces = vertices[first], label[faces]
    return corner_normals_of(
        vertices, faces, measure(vertices, faces), Edges.of(faces), crease, smoothing
    )


def corner_normals_of(
    vertices: Reals, faces: Ints, measures: Measures, edges: Edges, crease: float,
    smoothing: Ints | None = None,
) -> Reals:  # fmt: skip
    """As `corner_normals`, of what is known already.

    vertices: float64[V, 3], no two of them equal. measures, edges: of the faces.
    """
    flat = measures.normal
    first, second = _links(vertices, faces, flat, edges, smoothing)
    face_a, face_b = first // 3, second // 3
    cosine = np.empty(len(first))
    for block in blocks(len(first)):
        a, b = face_a[block], face_b[block]
        x, y, z = (component.take(a) * component.take(b) for component in flat)
        cosine[block] = x + y + z
    smooth = cosine >= np.cos(np.radians(crease)) - 1e-12
    if smoothing is not None:
        a, b = smoothing[face_a], smoothing[face_b]
        smooth = np.where((a >= 0) & (b >= 0), (a == b) & (a > 0), smooth)
    coplanar = smooth & (cosine >= np.cos(FLAT))
    area = _flat_areas(measures.area, face_a[coplanar], face_b[coplanar])

    group = _groups(faces, edges, first, second, smooth)
    return _group_means(group, measures.angle.reshape(-1), area, flat)


def _groups(faces: Ints, edges: Edges, first: Ints, second: Ints, smooth: Flags) -> Ints:
    """A label for each corner, int64[3 F], equal where corners share a normal; one of the corners.

    first, second: int64[n], half-edges on both sides of an edge, from `_links`. smooth: bool[n]. A
    smooth edge links the corners of its two faces at both of its ends. Where each edge has two
    faces of one winding, the links lead from corner to corner round a vertex; the others are added
    one by one.
    """
    regular = smooth & (edges.upward[first] != edges.upward[second])
    regular[np.count_nonzero(edges.uses == 2) :] = False
    a, b = first[regular], second[regular]
    following = np.full(faces.size, -1)
    following[a], following[b] = _next(b), _next(a)
    group = orbits(following, faces.reshape(-1))
    others = smooth & ~regular
    if others.any():
        first, second = first[others], second[others]
        low_a, high_a = _ends(first, edges.upward)
        low_b, high_b = _ends(second, edges.upward)
        one, other = np.concatenate([low_a, high_a]), np.concatenate([low_b, high_b])
        group = components(faces.size, group[one], group[other])[group]
    return group


def _next(half: Ints) -> Ints:
    """The next half-edge of the same face, int64[n]."""
    return np.where(half % 3 == 2, half - 2, half + 1)


def _ends(half: Ints, upward: Flags) -> tuple[Ints, Ints]:
    """The corners of half-edges at their smaller and at their larger vertex, int64[n] each."""
    following, up = _next(half), upward[half]
    return np.where(up, half, following), np.where(up, following, half)


def _links(
    vertices: Reals, faces: Ints, flat: Reals, edges: Edges, smoothing: Ints | None
) -> tuple[Ints, Ints]:
    """Pairs of half-edges across which faces may be smooth, int64[n] each.

    An edge of two faces gives one pair. The normals of all faces at one edge lie in a plane across
    that edge. Where an edge has more faces, each is paired with the next one in the order of the
    normals' directions, round the full turn. A chain of such pairs connects two faces exactly if
    some chain of any pairs with the same largest angle does. With smoothing groups only faces of
    one group are paired at such an edge.
    """
    one, other = edges.pairs()
    many = np.flatnonzero(edges.uses > 2)
    if not len(many):
        return one, other
    uses, begin = edges.uses[many], edges.first[many]
    edge = np.repeat(np.arange(len(many)), uses)
    place = np.arange(uses.sum()) - np.repeat(np.cumsum(uses) - uses, uses)
    half = edges.half[begin[edge] + place]
    face, corner = half // 3, half % 3
    start = vertices[faces[face, corner]]
    end = vertices[faces[face, (corner + 1) % 3]]
    along = normalize(np.where(edges.upward[half, None], end - start, start - end))
    # All faces of an edge measure the direction of their normals in the axes of its first face.
    head = np.cumsum(uses) - uses
    axis = normalize(along[head][edge])
    own = flat[:, face].T
    across = own[head][edge]
    third = np.cross(axis, across)
    turn = np.arctan2(np.sum(own * third, axis=1), np.sum(own * across, axis=1))
    group = np.zeros_like(edge) if smoothing is None else smoothing[face]
    order = np.lexsort((turn, group, edge))
    half, edge, group = half[order], edge[order], group[order]
    begins = np.append(True, (edge[1:] != edge[:-1]) | (group[1:] != group[:-1]))
    following = np.arange(len(half)) + 1
    following[np.append(begins[1:], True)] = np.flatnonzero(begins)
    return np.concatenate([one, half]), np.concatenate([other, half[following]])


def _flat_areas(area: Reals, a: Ints, b: Ints) -> Reals:
    """The area of the flat face that each triangle belongs to, float64[F].

    area: float64[F], of the triangles. a, b: int64[n], triangles of one flat face.
    """
    if not len(a):
        return area
    region = components(len(area), a, b)
    total: Reals = np.bincount(region, area, len(area)).astype(np.float64, copy=False)
    members = np.flatnonzero(np.bincount(region, minlength=len(area)).take(region) > 2)
    if len(members):
        # Sorted by size within a region, so that the sum does not depend on the order of the faces.
        members = members[np.lexsort((area[members], region[members]))]
        start = np.flatnonzero(np.diff(region[members], prepend=-1))
        total[region[members[start]]] = np.add.reduceat(area[members], start)
    return total.take(region)


def _group_means(group: Ints, angle: Reals, area: Reals, flat: Reals) -> Reals:
    """The unit normal of each corner's group, float64[F, 3, 3]; that of the corner's face where the
    normals of a group cancel out.

    group: int64[3 F], the smallest corner of each corner's group. angle: float64[3 F]. area:
    float64[F], of the flat face. flat: float64[3, F].
    """
    number = np.cumsum(group == np.arange(len(group))) - 1
    group = number.take(group)
    count = int(number[-1]) + 1
    outweighed = _outweighed(group, angle, area, count)
    weight = angle if outweighed is None else np.where(outweighed, 0.0, angle)
    sums: Ints = np.zeros((3, count), np.int64)
    for block in blocks(len(area)):
        corners = slice(3 * block.start, 3 * block.stop)
        for axis in range(3):
            _add(sums[axis], group[corners], weight[corners] * np.repeat(flat[axis, block], 3))
    # Normals of opposite faces can cancel out but for the quantum.
    mean: Reals = normalize(sums.T.astype(np.float64))
    cancelled = np.max(np.abs(sums), axis=0) <= 2**12
    result: Reals = mean.take(group, axis=0)
    if cancelled.any():
        own = np.flatnonzero(cancelled.take(group))
        result[own] = flat.T[own // 3]
    return result.reshape(-1, 3, 3)


def _outweighed(group: Ints, angle: Reals, area: Reals, count: int) -> Flags | None:
    """Which corners do not count, bool[3 F], because a far larger flat face keeps its own normal;
    None if all count.

    group: int64[3 F], 0 to `count` - 1. angle: float64[3 F]. area: float64[F], of the flat face.
    """
    full = np.zeros(count)
    for block in blocks(len(area)):
        np.maximum.at(full, group[3 * block.start : 3 * block.stop], np.repeat(area[block], 3))
    small, large = np.empty(len(group), bool), np.empty(len(group), bool)
    for block in blocks(len(area)):
        corners = slice(3 * block.start, 3 * block.stop)
        own, largest = np.repeat(area[block], 3), full.take(group[corners])
        large[corners] = own == largest
        small[corners] = (own <= largest * (1.0 / LARGE)) & (own < largest)
    candidate = np.zeros(count, bool)
    candidate[group[small]] = True
    candidate[group[~small & ~large]] = False
    if not candidate.any():
        return None
    among = np.flatnonzero(candidate.take(group))
    group, large = group[among], large[among]
    share = angle[among] * (area[among // 3] / full[group])
    own_share, whole = np.zeros((2, count), np.int64)
    _add(own_share, group, share * large)
    _add(whole, group, share)
    dominant = own_share >= DOMINANT * whole
    small[:] = False
    small[among] = dominant[group] & ~large
    return small


def _add(total: Ints, group: Ints, values: Reals) -> None:
    """Add `values` (float64[n]) to `total` (int64[groups]) at `group` (int64[n]), in units of
    QUANTUM. Integers add up without rounding, so that the sum is the same in any order."""
    np.add.at(total, group, np.rint(values * (1.0 / QUANTUM)).astype(np.int64))
