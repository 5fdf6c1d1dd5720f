# SPDX-License-Identifier: MIT
"""Vectors and matrices of the front end, in float64."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import ArrayLike, Reals


def normalize(vectors: Reals) -> Reals:
    """`vectors` (float64[..., 3]) scaled to unit length; the zero vector stays zero."""
    # The largest component is scaled to 1 first, so that squares neither overflow nor underflow.
    # Component by component, because numpy reduces an axis of three at a tenth of the speed.
    components = [vectors[..., axis] for axis in range(3)]
    largest = np.maximum.reduce([np.abs(c) for c in components])
    divisor = np.where(largest > 0, largest, 1.0)
    x, y, z = (c / divisor for c in components)
    length = np.sqrt(x * x + y * y + z * z)
    divisor = np.where(length > 0, length, 1.0)
    return np.stack([x / divisor, y / divisor, z / divisor], axis=-1)


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
