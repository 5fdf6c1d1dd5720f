# SPDX-License-Identifier: MIT
"""Vectors and matrices of the front end, in float64."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from phong75.model.arrays import ArrayLike, Reals

#: Rows that are computed at a time: arrays of so many stay in the processor's cache.
BLOCK = 1 << 14


def blocks(count: int) -> Iterator[slice]:
    """Slices of at most BLOCK rows, of `count` rows in all."""
    return (slice(begin, begin + BLOCK) for begin in range(0, count, BLOCK))


def normalize(vectors: Reals) -> Reals:
    """`vectors` (float[..., 3]) scaled to unit length, float64; the zero vector stays zero."""
    rows = vectors.reshape(-1, 3)
    result = np.empty(rows.shape)
    for block in blocks(len(rows)):
        # Component by component, because numpy reduces an axis of three at a tenth of the speed.
        x, y, z = rows[block].T.astype(np.float64)
        # The largest component is scaled to 1 first: squares neither overflow nor underflow.
        largest = np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(z))
        divisor = np.where(largest > 0, largest, 1.0)
        x, y, z = x / divisor, y / divisor, z / divisor
        length = np.sqrt(x * x + y * y + z * z)
        divisor = np.where(length > 0, length, 1.0)
        for axis, component in enumerate((x, y, z)):
            result[block, axis] = component / divisor
    return result.reshape(vectors.shape)


def apply_matrix(matrix: Reals, vectors: Reals) -> Reals:
    """`matrix` (float64[3, 3]) times each of `vectors` (float64[..., 3]).

    The product is written out by component because a BLAS product may round equal vectors
    differently depending on their position in the array. Copies of a vertex must stay equal, or
    cracks open between triangles.
    """
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in matrix], axis=-1)


def rotation_matrix(degrees: ArrayLike) -> Reals:
    """Rotation matrix float64[3, 3]: about the fixed x, then y, then z axis by `degrees` (3)."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x
