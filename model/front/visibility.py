# SPDX-License-Identifier: MIT
"""Visible surfaces: from projected triangles to visible segments, scan line by scan line.

Watkins (1970) "computes which polygons intersect the scan line, and then computes the visible
segment of each polygon, where this segment is the visible strip of the polygon, one screen
resolution unit in height, that lies on the scan line". So each pixel is shaded exactly once. The
steps:

- `clip` removes what is behind the near plane or outside the guard band.
- `set_up` snaps vertices to a grid, culls back faces and sorts vertices from top to bottom.
- `cover` computes the strip of each triangle on each scan line, exactly, in integers.
- `resolve` finds the visible parts of the strips. A strip that overlaps no other on its line is
  visible as a whole. Where strips overlap, the nearest one wins at each pixel, so that triangles
  may penetrate each other. A run of pixels of one triangle becomes a segment.

Top-left rule with pixel centres at +1/2: a pixel whose centre is on an edge belongs to the
triangle below or to the right of the edge. Two triangles compute the crossing of their common edge
from the same integers. Hence there is no gap, and no pixel is covered twice.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from phong75.model.arrays import Flags, Ints, Reals

#: Vertices are snapped to multiples of 2**-12 pixel. The shift is invisible, and all products of
#: coordinates within the guard band stay below 2**63.
SUBPIXEL_BITS = 12
GRID = 1 << SUBPIXEL_BITS

#: Guard band: triangles are clipped at this distance from the screen, in pixels. Parts within the
#: band but off the screen need no clipping; `cover` leaves them out.
GUARD = 1 << 16

#: Strips and pixels that are processed at a time; these limits bound the memory.
BLOCK_STRIPS = 1 << 19
BLOCK_PIXELS = 1 << 21


@dataclass
class Triangles:
    """Triangles on the screen, vertices sorted from top to bottom.

    x, y: int64[T, 3], screen coordinates in units of 1/GRID pixel.
    depth: float64[T, 3], see `Camera.depth`.
    value: float64[T, 3, C], the vector to interpolate: a normal or intensities.
    material: int64[T], index of the material.
    tolerance: float64[T], how far `depth` interpolated over the snapped triangle can be from the
    depth of the triangle's plane.
    """

    x: Ints
    y: Ints
    depth: Reals
    value: Reals
    material: Ints
    tolerance: Reals

    def __len__(self) -> int:
        return len(self.x)

    def take(self, which: Ints | Flags) -> Triangles:
        """The triangles selected by `which` (a mask or indices)."""
        return Triangles(
            self.x[which],
            self.y[which],
            self.depth[which],
            self.value[which],
            self.material[which],
            self.tolerance[which],
        )


@dataclass
class Segments:
    """Strips of triangles, one pixel high: the pixels left <= x < right of scan line y.

    triangle: index of the triangle. All arrays are int64[n].
    """

    triangle: Ints
    y: Ints
    left: Ints
    right: Ints

    def __len__(self) -> int:
        return len(self.y)

    def take(self, which: Ints | Flags) -> Segments:
        """The segments selected by `which` (a mask or indices)."""
        return Segments(self.triangle[which], self.y[which], self.left[which], self.right[which])


def clip(corners: Reals, value: Reals, material: Ints, near: float) -> tuple[Reals, Reals, Ints]:
    """Clip triangles at the near plane w = `near` and at the guard band around the screen.

    corners: float64[T, 3, 4], homogeneous screen points (X, Y, w, z) of `Camera.project`. value:
    float64[T, 3, C]. material: int[T]. Returns (corners, value, material) of the triangles that
    remain. A triangle may become two (Sutherland and Hodgman 1974, one plane after the other). Two
    triangles cut their common edge from the same end with the same arithmetic, hence at the same
    point.
    """
    values = np.concatenate([corners, value], axis=-1)
    planes = [
        lambda v: v[..., 2] - near,
        lambda v: v[..., 0] + GUARD * v[..., 2],
        lambda v: GUARD * v[..., 2] - v[..., 0],
        lambda v: v[..., 1] + GUARD * v[..., 2],
        lambda v: GUARD * v[..., 2] - v[..., 1],
    ]
    for plane in planes:
        distance = plane(values)
        inside = distance >= 0
        count = np.count_nonzero(inside, axis=1)
        if np.all(count == 3):
            continue
        whole, one, two = count == 3, count == 1, count == 2
        # Rotate the corners so that the single one (inside or outside) comes first.
        single = np.where(one, np.argmax(inside, axis=1), np.argmin(inside, axis=1))
        rotation = (single[:, None] + np.arange(3)) % 3
        row = np.arange(len(values))[:, None]
        rotated, reach = values[row, rotation], distance[row, rotation]
        t, r = rotated[one], reach[one]
        tip = np.stack([t[:, 0], _cut(t, r, 0, 1), _cut(t, r, 0, 2)], axis=1)
        t, r = rotated[two], reach[two]
        p, q = _cut(t, r, 1, 0), _cut(t, r, 2, 0)
        quad = np.stack([p, t[:, 1], t[:, 2], p, t[:, 2], q], axis=1)
        quad = quad.reshape(-1, 3, values.shape[-1])
        values = np.concatenate([values[whole], tip, quad])
        material = np.concatenate([material[whole], material[one], np.repeat(material[two], 2)])
    return values[..., :4], values[..., 4:], material


def _cut(values: Reals, distance: Reals, inner: int, outer: int) -> Reals:
    """The point where the edge from corner `inner` to corner `outer` meets the plane.

    values: float64[n, 3, C]. distance: float64[n, 3], signed distances from the plane, >= 0 inside.
    Returns float64[n, C].
    """
    t = distance[:, inner] / (distance[:, inner] - distance[:, outer])
    return values[:, inner] + t[:, None] * (values[:, outer] - values[:, inner])


def set_up(
    x: Reals, y: Reals, depth: Reals, value: Reals, material: Ints, two_sided: bool | Flags
) -> Triangles:
    """Snap vertices to the grid; drop back faces (unless `two_sided`) and faces without area.

    x, y: float64[T, 3], pixels, magnitudes up to about GUARD. Front faces are counter-clockwise,
    which is a negative area with y downward. depth, value, material: see `Triangles`, vertices in
    the order of x and y. two_sided: of all triangles or of each, bool[T].
    """
    column, line = (np.floor(c * GRID + 0.5).astype(np.int64) for c in (x, y))
    x0, x1, x2 = column.T
    y0, y1, y2 = line.T
    area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
    keep = np.flatnonzero(np.where(two_sided, area != 0, area < 0))
    order = np.argsort(line[keep], axis=1, kind="stable")
    row = keep[:, None]
    return Triangles(
        column[row, order],
        line[row, order],
        depth[row, order],
        value[row, order],
        material[keep],
        _depth_tolerance(x[keep], y[keep], depth[keep]),
    )


def _depth_tolerance(x: Reals, y: Reals, depth: Reals) -> Reals:
    """How far the depth over each snapped triangle can be from that of its plane, float64[T].

    x, y, depth: float64[T, 3], before snapping. Snapping moves a vertex by at most 1/(2 GRID) pixel
    in x and in y, and leaves its depth. So the depth at the new place is that of the plane but for
    1/(2 GRID) times the sum of the gradient's components, and so are means of the vertices with
    weights of 0 to 1. The gradient of a sliver is unbounded; there the range of the depths takes
    its place. A few units in the last place of float64 cover the rounding of the interpolation.
    """
    (ax, bx), (ay, by), (ad, bd) = ((v[:, 1] - v[:, 0], v[:, 2] - v[:, 0]) for v in (x, y, depth))
    area = ax * by - bx * ay
    reach = np.abs(ad * by - bd * ay) + np.abs(bd * ax - ad * bx)
    span = np.max(depth, axis=1) - np.min(depth, axis=1)
    snapped = np.minimum(reach, 2 * GRID * span * np.abs(area)) / np.where(
        area == 0, 1.0, 2 * GRID * np.abs(area)
    )
    return snapped + 16 * np.finfo(np.float64).eps * np.max(np.abs(depth), axis=1)


def line_range(triangles: Triangles, width: int, height: int) -> tuple[Ints, Ints]:
    """First scan line of each triangle and the line after its last, int64[T] each, 0 to height.

    A triangle covers the lines whose centre is at or below its top vertex and above its bottom
    vertex. A triangle beside the screen gets no line.
    """
    first = np.clip(_first_centre(triangles.y[:, 0]), 0, height)
    end = np.clip(_first_centre(triangles.y[:, 2]), 0, height)
    off_screen = (triangles.x.max(axis=1) < 0) | (triangles.x.min(axis=1) > width * GRID)
    return first, np.where(off_screen, first, np.maximum(end, first))


def _first_centre(coordinate: Ints) -> Ints:
    """The first pixel whose centre is at or after `coordinate` (1/GRID pixel)."""
    return -((GRID // 2 - coordinate) // GRID)


def cover(triangles: Triangles, first: Ints, end: Ints, width: int) -> Segments:
    """The strips of triangles on the scan lines first <= y < end, within 0 <= x < width.

    first, end: int64[T], within the lines of `line_range`. Strips without a pixel are left out.
    A scan line with its centre at y crosses the edge from (xa, ya) to (xb, yb) at
    x = xa + (y - ya)(xb - xa)/(yb - ya). One exact integer division gives the first pixel at or
    after the crossing. A strip goes from that pixel of its left edge to the pixel before that of
    its right edge.
    """
    lines = end - first
    t = np.repeat(np.arange(len(lines)), lines)
    line = np.arange(len(t)) - np.repeat(np.cumsum(lines) - lines, lines) + first[t]
    centre = line * GRID + GRID // 2
    x0, x1, x2 = triangles.x[t].T
    y0, y1, y2 = triangles.y[t].T
    lower = centre >= y1
    on_long = _crossing(x0, y0, x2, y2, centre)
    on_short = _crossing(
        np.where(lower, x1, x0),
        np.where(lower, y1, y0),
        np.where(lower, x2, x1),
        np.where(lower, y2, y1),
        centre,
    )
    left = np.maximum(np.minimum(on_long, on_short), 0)
    right = np.minimum(np.maximum(on_long, on_short), width)
    return Segments(t, line, left, right).take(left < right)


def _crossing(xa: Ints, ya: Ints, xb: Ints, yb: Ints, y: Ints) -> Ints:
    """The first pixel whose centre is on or to the right of the edge a-b (ya < yb) at height `y`.

    All coordinates are int64[n] in 1/GRID pixel; the result is in pixels.
    """
    rise = yb - ya
    reach = (xa - GRID // 2) * rise + (y - ya) * (xb - xa)
    return -((-reach) // (GRID * rise))


def resolve(segments: Segments, depth: Reals, tolerance: Reals, width: int) -> Segments:
    """The visible parts of `segments`, sorted by y, then x.

    depth: float64[n, 2], depth at the first and at the last pixel of each segment. tolerance:
    float64[n], see `Triangles`. Where depths may be equal, the earlier segment wins, which is the
    one of the triangle with the smaller index.
    """
    if not len(segments):
        return segments
    start = segments.y * width + segments.left
    end = segments.y * width + segments.right
    order = np.argsort(start, kind="stable")
    # A segment overlaps no other if all earlier ones end before it and the next begins after it.
    reach = np.maximum.accumulate(end[order])
    free_before = np.concatenate([[True], start[order][1:] >= reach[:-1]])
    free_after = np.concatenate([free_before[1:], [True]])
    free = np.empty(len(order), bool)
    free[order] = free_before & free_after
    if free.all():
        return segments.take(order)

    alone = segments.take(free)
    overlapping = _nearest_runs(segments.take(~free), depth[~free], tolerance[~free], width)
    visible = Segments(
        np.concatenate([alone.triangle, overlapping.triangle]),
        np.concatenate([alone.y, overlapping.y]),
        np.concatenate([alone.left, overlapping.left]),
        np.concatenate([alone.right, overlapping.right]),
    )
    return visible.take(np.argsort(visible.y * width + visible.left, kind="stable"))


def _nearest_runs(segments: Segments, depth: Reals, tolerance: Reals, width: int) -> Segments:
    """Visible runs of overlapping `segments`: the nearest segment owns a pixel.

    A run is the longest sequence of pixels on a line with one owner. Arguments as for `resolve`.
    The first pass finds the depth that the nearest surface has at most; the second one finds the
    first segment that may be as near.
    """
    top = int(segments.y.min())
    pixels = (int(segments.y.max()) - top + 1) * width
    nearest = np.full(pixels, np.inf)
    none = len(segments)
    owner = np.full(pixels, none)
    for s, pixel, here in _overlaps(segments, depth, top, width):
        np.minimum.at(nearest, pixel, here + tolerance[s])
    for s, pixel, here in _overlaps(segments, depth, top, width):
        wins = here - tolerance[s] <= nearest[pixel]
        np.minimum.at(owner, pixel[wins], s[wins])
    first = np.flatnonzero(np.concatenate([[True], owner[1:] != owner[:-1]]))
    end = np.concatenate([first[1:], [pixels]])
    owned = owner[first] != none
    first, end = first[owned], end[owned]
    y = first // width
    return Segments(segments.triangle[owner[first]], y + top, first - y * width, end - y * width)


def _overlaps(
    segments: Segments, depth: Reals, top: int, width: int
) -> Iterator[tuple[Ints, Ints, Reals]]:
    """All pixels of all `segments`, at most about BLOCK_PIXELS at a time: the segment's index, the
    pixel's number from line `top` on, and the depth there, [n] each."""
    length = segments.right - segments.left
    total = np.cumsum(length)
    slope = (depth[:, 1] - depth[:, 0]) / np.maximum(length - 1, 1)
    begin = 0
    while begin < len(segments):
        done = total[begin - 1] if begin else 0
        stop = max(int(np.searchsorted(total, done + BLOCK_PIXELS, "right")), begin + 1)
        s = np.repeat(np.arange(begin, stop), length[begin:stop])
        step = np.arange(len(s)) - (total[s] - length[s] - done)
        pixel = (segments.y[s] - top) * width + segments.left[s] + step
        yield s, pixel, depth[s, 0] + slope[s] * step
        begin = stop
