# SPDX-License-Identifier: MIT
"""How the faces of a mesh hang together: equal vertices, shared edges, bodies, winding."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from phong75.model.arrays import Flags, Ints, Reals

#: Steps that `orbits` walks along each chain.
LONG_WALK = 64


def weld(vertices: Reals) -> tuple[Ints, Ints]:
    """(label, first) of `vertices` (float[V, 3]): equal coordinates have an equal label.

    label: int64[V], 0 to U - 1 in the order of the first occurrence. first: int64[U], the index of
    that occurrence. One sort of integers, each a hash of the coordinates followed by the index,
    takes a tenth of the time of a sort by three columns.
    """
    count = len(vertices)
    columns = [column + 0.0 for column in vertices.T]  # + 0.0 makes 0.0 of -0.0
    bits = max(count - 1, 1).bit_length()
    key = _hash(columns)
    key <<= np.uint64(bits)
    key |= np.arange(count, dtype=np.uint64)
    key.sort()
    order = (key & np.uint64((1 << bits) - 1)).view(np.int64)
    key >>= np.uint64(bits)
    alike = key[1:] == key[:-1]
    if not alike.any():
        return np.arange(count), np.arange(count)
    differs = _steps(columns, order)
    collided = np.flatnonzero(alike & differs)
    if len(collided):  # different points of one hash: only these are sorted by their coordinates
        run = np.concatenate([[0], np.cumsum(~alike)])
        rows = np.flatnonzero(np.isin(run, run[collided]))
        among = order[rows]
        order[rows] = among[np.lexsort((*(column[among] for column in columns), run[rows]))]
        differs = _steps(columns, order)
    start = np.concatenate([[0], np.flatnonzero(differs) + 1])
    is_first = np.zeros(count, bool)
    is_first[order[start]] = True  # both sorts leave equal points in the order of their index
    rank = np.cumsum(is_first) - 1
    label = np.empty(count, np.int64)
    label[order] = np.repeat(rank[order[start]], np.diff(np.append(start, count)))
    return label, np.flatnonzero(is_first)


def _hash(columns: list[Reals]) -> NDArray[np.uint64]:
    """A hash of each row of `columns`, uint64[V]. Its lower bits count most."""
    words = [column.view(f"u{column.itemsize}") for column in columns]
    mixed = words[0].astype(np.uint64)
    mixed *= np.uint64(0x9E3779B97F4A7C15)
    for word, factor in ((words[1], 0xC2B2AE3D27D4EB4F), (words[2], 0x165667B19E3779F9)):
        mixed ^= mixed >> np.uint64(29)
        mixed ^= word
        mixed *= np.uint64(factor)
    mixed ^= mixed >> np.uint64(32)
    return mixed


def _steps(columns: list[Reals], order: Ints) -> Flags:
    """Whether each point of `order` but the first differs from the one before it: bool[V - 1]."""
    result = np.zeros(max(len(order) - 1, 0), bool)
    for column in columns:
        arranged = column.take(order)
        result |= arranged[1:] != arranged[:-1]
    return result


def components(count: int, a: Ints, b: Ints) -> Ints:
    """A label for each of `count` nodes, int64[count]: the smallest node that links lead to.

    a, b: int64[n], the nodes at both ends of each link. Each round hooks nodes to smaller ones,
    shortens all paths to their root, and leaves a smaller problem: the roots, numbered anew in
    their order, and the links between them.
    """
    rounds = []
    while len(a):
        nodes = np.arange(count)
        label = nodes.copy()
        label[np.maximum(a, b)] = np.minimum(a, b)  # any of several links will do: labels only fall
        while True:
            shorter = label.take(label)
            if np.array_equal(shorter, label):
                break
            label = shorter
        root = label == nodes
        label = (np.cumsum(root) - 1).take(label)
        rounds.append((label, np.flatnonzero(root)))
        count = len(rounds[-1][1])
        a, b = label.take(a), label.take(b)
        apart = a != b
        a, b = a[apart], b[apart]
    result = np.arange(count)
    for label, roots in reversed(rounds):
        result = roots.take(result).take(label)
    return result


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
        start, end = faces.reshape(-1), faces.take((1, 2, 0), axis=1).reshape(-1)
        upward = start < end
        size = int(faces.max()) + 1 if len(faces) else 1
        key = np.minimum(start, end)
        key *= size
        key += np.maximum(start, end, out=end)
        bits = max(len(key) - 1, 1).bit_length()
        if (size * size - 1).bit_length() + bits < 64:  # a key and its half-edge fit one word
            key <<= bits
            key |= np.arange(len(key))
            key.sort()
            half = key & (1 << bits) - 1
            key >>= bits
        else:
            half = np.argsort(key, kind="stable")
            key = key[half]
        first = np.concatenate([[0], np.flatnonzero(key[1:] != key[:-1]) + 1]).astype(np.int64)
        return cls(half, first, np.diff(np.append(first, len(half))), upward)

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
