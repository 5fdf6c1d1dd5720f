# SPDX-License-Identifier: MIT
"""How the faces of a mesh hang together: equal vertices, shared edges, bodies, winding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.arrays import Flags, Ints, Reals

#: Steps that `orbits` walks along each chain.
LONG_WALK = 64


def weld(vertices: Reals) -> tuple[Ints, Ints]:
    """(label, first) of `vertices` (float64[V, 3]): equal coordinates have an equal label.

    label: int64[V], 0 to U - 1 in the order of the first occurrence. first: int64[U], the index of
    that occurrence. Vertices are sorted by a hash of their coordinates, because one sort of
    integers takes a fifth of the time of a sort by three columns.
    """
    columns = [column + 0.0 for column in vertices.T]  # + 0.0 makes 0.0 of -0.0
    mixed = columns[0].view(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    for column, factor in ((columns[1], 0xC2B2AE3D27D4EB4F), (columns[2], 0x165667B19E3779F9)):
        mixed ^= mixed >> np.uint64(29)
        mixed ^= column.view(np.uint64)
        mixed *= np.uint64(factor)
    order = np.argsort(mixed)
    differs = _steps(columns, order)
    mixed = mixed[order]
    if np.any(differs & (mixed[1:] == mixed[:-1])):  # two points with one hash
        order = np.lexsort(columns)
        differs = _steps(columns, order)
    start = np.concatenate([[0], np.flatnonzero(differs) + 1]).astype(np.int64)
    first = np.minimum.reduceat(order, start)
    rank = np.empty(len(first), np.int64)
    by_occurrence = np.argsort(first)
    rank[by_occurrence] = np.arange(len(first))
    label = np.empty(len(vertices), np.int64)
    label[order] = np.repeat(rank, np.diff(np.append(start, len(order))))
    return label, first[by_occurrence]


def _steps(columns: list[Reals], order: Ints) -> Flags:
    """Whether each point of `order` but the first differs from the one before it: bool[V - 1]."""
    result = np.zeros(max(len(order) - 1, 0), bool)
    for column in columns:
        arranged = column[order]
        result |= arranged[1:] != arranged[:-1]
    return result


def components(count: int, a: Ints, b: Ints) -> Ints:
    """A label for each of `count` nodes, int64[count]: the smallest node that links lead to.

    a, b: int64[n], the nodes at both ends of each link. Each round hooks roots to smaller roots
    and shortens all paths to their root; links within a tree drop out.
    """
    label = np.arange(count)
    root_a, root_b = a, b
    while True:
        open_ = root_a != root_b
        if not open_.any():
            return label
        a, b = a[open_], b[open_]
        low = np.minimum(root_a[open_], root_b[open_])
        high = np.maximum(root_a[open_], root_b[open_])
        label[high] = low  # any of several links will do: labels only fall
        while True:
            shorter = label[label]
            if np.array_equal(shorter, label):
                break
            label = shorter
        root_a, root_b = label[a], label[b]


def orbits(following: Ints, vertex: Ints) -> Ints:
    """A label for each of n corners, int64[n]: the same for all corners of a chain or a cycle.

    following: int64[n], the corner after each one, -1 after the last of a chain; no two corners
    have the same one. vertex: int64[n], the vertex of each corner, which does not change along a
    chain. A label is one of its corners. All chains are walked at the same time, then one cycle at
    each vertex; few vertices have more. What is longer than LONG_WALK is left to `components`.
    """
    label = np.full(len(following), -1)
    later = np.zeros(len(following), bool)
    later[following[following >= 0]] = True
    start = np.flatnonzero(~later)
    while True:
        label[start] = start
        position, name = start, start
        for _ in range(LONG_WALK):
            position = following[position]
            going = position >= 0
            going[going] = label[position[going]] < 0
            position, name = position[going], name[going]
            if not len(position):
                break
            label[position] = name
        rest = np.flatnonzero(label < 0)
        if len(position):  # some walks were cut off
            label[rest] = rest
            links = np.concatenate([rest, position])
            links = links[following[links] >= 0]
            return components(len(label), label[links], label[following[links]])[label]
        if not len(rest):
            return label
        first = np.full(int(vertex.max()) + 1, -1)
        first[vertex[rest[::-1]]] = rest[::-1]
        start = first[first >= 0]


@dataclass
class Edges:
    """The edges of triangles. Half-edge 3 f + k goes from corner k of face f to corner k + 1.

    half: int64[3 F], half-edges sorted by edge; those of one edge follow each other.
    first: int64[E], where each edge begins in `half`. uses: int64[E], its number of half-edges.
    upward: bool[3 F], whether a half-edge goes from the smaller vertex to the larger one.
    """

    half: Ints
    first: Ints
    uses: Ints
    upward: Flags

    @classmethod
    def of(cls, faces: Ints) -> Edges:
        """The edges of `faces` (int64[F, 3], welded vertices)."""
        start, end = faces.reshape(-1), np.roll(faces, -1, axis=1).reshape(-1)
        size = int(faces.max()) + 1 if len(faces) else 1
        key = np.minimum(start, end) * size + np.maximum(start, end)
        half = np.argsort(key)
        key = key[half]
        first = np.concatenate([[0], np.flatnonzero(key[1:] != key[:-1]) + 1]).astype(np.int64)
        return cls(half, first, np.diff(np.append(first, len(half))), start < end)

    def pairs(self) -> tuple[Ints, Ints]:
        """Both half-edges of each edge that belongs to exactly two faces, int64[n] each."""
        first = self.first[self.uses == 2]
        return self.half[first], self.half[first + 1]

    @property
    def consistent(self) -> bool:
        """Whether no edge is used twice in one direction: the faces have one winding."""
        ups = np.add.reduceat(self.upward[self.half].astype(np.int64), self.first)
        return bool(np.all((ups <= 1) & (self.uses - ups <= 1)))

    @property
    def closed(self) -> bool:
        """Whether each edge belongs to two faces, once per direction."""
        return bool(np.all(self.uses == 2)) and self.consistent


@dataclass
class Bodies:
    """Connected bodies of a mesh, and which faces to turn round so that each has one winding.

    body: int64[F], a label; faces across an edge of two faces are of one body. turned: bool[F].
    twisted: bool[F], faces of bodies that no winding fits (a Moebius strip).
    """

    body: Ints
    turned: Flags
    twisted: Flags


def bodies(faces: Ints, edges: Edges) -> Bodies:
    """The bodies of `faces` (int64[F, 3]).

    Within a body most faces keep their winding. Each face is represented twice, as it is and turned
    round. Neighbours that fit link like with like, neighbours that do not fit link crosswise. A
    body whose two copies are connected has no two sides.
    """
    count = len(faces)
    one, other = edges.pairs()
    a, b = one // 3, other // 3
    misfit = edges.upward[one] == edges.upward[other]
    if misfit.any():
        # A face that a file holds twice is no neighbour of itself.
        twins = misfit.copy()
        twins[misfit] = np.all(
            np.sort(faces[a[misfit]], axis=1) == np.sort(faces[b[misfit]], axis=1), axis=1
        )
        a, b, misfit = a[~twins], b[~twins], misfit[~twins]
    if not misfit.any():
        none = np.zeros(count, bool)
        return Bodies(components(count, a, b), none, none.copy())
    across = np.where(misfit, count, 0)
    label = components(
        2 * count, np.concatenate([a, a + count]), np.concatenate([b + across, b + count - across])
    )
    kept, reversed_ = label[:count], label[count:]
    twisted = kept == reversed_
    body = np.minimum(kept, reversed_) % count
    # Faces of a body whose own copy has the body's smaller label are of one side.
    side = kept > reversed_
    minority = np.bincount(body, np.where(side, 1.0, -1.0), count) > 0
    return Bodies(body, (side ^ minority[body]) & ~twisted, twisted)
