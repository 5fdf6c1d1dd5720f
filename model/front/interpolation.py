# SPDX-License-Identifier: MIT
"""Interpolation over a triangle: linear, along two edges, then along the scan line; or quadratic.

A point between two edges gets "the linear interpolation of the normals at the intersections of
these two edges with a scan plane passing through the point" (Phong 1975, eq. (2) and after).
Gouraud's intensities are interpolated in the same way. Over a triangle the result is the affine
function through the three vertices. Lecture notes on the method (Starkey, "Shading Techniques",
section 5) normalize the vectors at the edges before the step along the line; the argument
`normalize_edges` selects this.

Quadratic normals (van Overveld and Wyvill 1997, Vlachos et al. 2001) are the quadratic polynomial
through six vectors: those at the vertices and those in the middle of the edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.arrays import ArrayLike, Flags, Ints, Reals
from phong75.model.front.mesh import normalize


@dataclass
class ScanLineWeights:
    """Interpolation weights of n points, each in a triangle of its own.

    The long edge goes from the top vertex to the bottom vertex; the other two are the short edges.
    lower: bool[n], whether the scan line crosses the lower short edge.
    along_long, along_short: float64[n], 0 to 1, where the scan line crosses the long edge and the
    short edge (0: upper end).
    across: float64[n], 0 to 1, position of the point between the long edge (0) and the short one.
    """

    lower: Flags
    along_long: Reals
    along_short: Reals
    across: Reals


def scan_line_weights(
    x: Ints | Reals, y: Ints | Reals, px: Ints | Reals, py: Ints | Reals
) -> ScanLineWeights:
    """Weights of the points (px, py) in the triangles x, y.

    px, py: [n]. x, y: [n, 3], vertices sorted by y. Each scan line must cross its triangle:
    y[:, 0] <= py < y[:, 2]. With integer coordinates of up to 30 bits the distances from the edges
    are exact before the division. So the weights of a point inside are in [0, 1] however thin the
    triangle is.
    """
    x0, x1, x2 = x[:, 0], x[:, 1], x[:, 2]
    y0, y1, y2 = y[:, 0], y[:, 1], y[:, 2]
    lower = py >= y1
    xa, ya = np.where(lower, x1, x0), np.where(lower, y1, y0)
    xb, yb = np.where(lower, x2, x1), np.where(lower, y2, y1)
    to_long = np.abs((px - x0) * (y2 - y0) - (py - y0) * (x2 - x0)) / (y2 - y0)
    to_short = np.abs((px - xa) * (yb - ya) - (py - ya) * (xb - xa)) / (yb - ya)
    between = to_long + to_short
    return ScanLineWeights(
        lower,
        (py - y0) / (y2 - y0),
        (py - ya) / (yb - ya),
        to_long / np.where(between > 0, between, 1.0),
    )


def interpolate(values: Reals, weights: ScanLineWeights, normalize_edges: bool = False) -> Reals:
    """Interpolate `values` (float64[n, 3, C], vertices sorted by y) to the points: float64[n, C].

    normalize_edges: normalize the vectors (C = 3) at both edges before the step along the line.
    """
    top, middle, bottom = values[:, 0], values[:, 1], values[:, 2]
    lower = weights.lower[:, None]
    upper_end, lower_end = np.where(lower, middle, top), np.where(lower, bottom, middle)
    on_long = _mix(top, bottom, weights.along_long)
    on_short = _mix(upper_end, lower_end, weights.along_short)
    if normalize_edges:
        on_long, on_short = normalize(on_long), normalize(on_short)
    return _mix(on_long, on_short, weights.across)


def interpolate_quadratic(values: Reals, weights: ScanLineWeights) -> Reals:
    """Quadratic interpolation of `values` to the points: float64[n, C].

    values: float64[n, 3, 2 C], vertices sorted by y: the value at each vertex, then the value in
    the middle of the opposite edge. The barycentric coordinates are products of weights in [0, 1],
    so they are in [0, 1] however thin the triangle is.
    """
    count = values.shape[2] // 2
    at_long, across = weights.along_long, weights.across
    short, none = weights.along_short, np.zeros_like(across)
    upper_end, lower_end = across * (1 - short), across * short
    shares = (
        (1 - across) * (1 - at_long) + np.where(weights.lower, none, upper_end),
        np.where(weights.lower, upper_end, lower_end),
        (1 - across) * at_long + np.where(weights.lower, lower_end, none),
    )
    return quadratic(values[..., :count], values[..., count:], np.stack(shares, axis=-1))


def quadratic(corners: Reals, middles: Reals, shares: Reals) -> Reals:
    """The quadratic polynomial through `corners` and `middles` (float64[n, 3, C] each):
    float64[n, C].

    middles: the values in the middle of the edges opposite the corners. shares: float64[n, 3],
    barycentric coordinates.
    """
    value = np.zeros_like(corners[:, 0])
    for k in range(3):
        own, next_, last = shares[:, k], shares[:, (k + 1) % 3], shares[:, (k + 2) % 3]
        value += (own * (2 * own - 1))[:, None] * corners[:, k]
        value += (4 * next_ * last)[:, None] * middles[:, k]
    return value


def _mix(a: Reals, b: Reals, t: Reals) -> Reals:
    """Linear interpolation from a (t = 0) to b (t = 1): float64[n, C]."""
    return a + (b - a) * t[:, None]


def interpolate_at(
    triangle: ArrayLike, values: ArrayLike, point: ArrayLike, normalize_edges: bool = False
) -> Reals:
    """Interpolate `values` at one point of one triangle: float64[C].

    triangle: [3, 2], x and y of the vertices in any order. values: [3, C]. point: (x, y), inside.
    """
    triangle, values = np.asarray(triangle, float), np.asarray(values, float)
    order = np.argsort(triangle[:, 1], kind="stable")
    x, y = triangle[None, order, 0], triangle[None, order, 1]
    px, py = np.asarray(point, float)[:, None]
    return interpolate(values[None, order], scan_line_weights(x, y, px, py), normalize_edges)[0]
