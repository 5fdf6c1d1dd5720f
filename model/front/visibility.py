"""From projected triangles to visible segments, scan line by scan line.

Watkins (1970) "computes which polygons intersect the scan line, and then computes the visible
segment of each polygon, where this segment is the visible strip of the polygon, one screen
resolution unit in height, that lies on the scan line"; so each screen dot is made once. Here:

- `clip` cuts off what lies behind the near plane or absurdly far off the screen;
- `set_up` snaps vertices to a grid, culls back faces and orders vertices from top to bottom;
- `cover` finds the strip of each triangle on each scan line, exactly, in integers;
- `resolve` finds what is visible of the strips. A strip that meets no other on its line is
  visible as it is; where several lie over each other the nearest at each dot wins, so that
  triangles may penetrate each other, and runs of dots of one triangle are segments again.

Top-left rule with pixel centres at +1/2: a dot whose centre is on an edge belongs to the triangle
below or to the right of it. Both neighbours compute the crossing of a common edge from the same
integers, hence no gap and no dot twice.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

#: Vertices are snapped to 2**-12 pixel: far below what can be seen, and all products of
#: coordinates within the guard band stay below 2**63.
SUBPIXEL_BITS = 12
GRID = 1 << SUBPIXEL_BITS

#: Triangles are clipped at this distance from the screen, in pixels; nearer parts off the screen
#: are left out when lines are covered, which needs no new vertices.
GUARD = 1 << 16

#: Sizes of the blocks in which lines are covered and dots resolved; they bound the memory.
BLOCK_STRIPS = 1 << 19
BLOCK_DOTS = 1 << 21


@dataclass
class Triangles:
    """Triangles ready for scanning, vertices ordered from top to bottom.

    x, y: int64[T, 3], screen coordinates in 1/GRID pixel. depth: float64[T, 3], growing away from
    the eye, linear over the screen. value: float64[T, 3, C], what is interpolated, a normal or
    intensities. material: int64[T].
    """

    x: np.ndarray
    y: np.ndarray
    depth: np.ndarray
    value: np.ndarray
    material: np.ndarray

    def __len__(self) -> int:
        return len(self.x)

    def take(self, which) -> Triangles:
        """The triangles selected by `which` (a mask or indices)."""
        return Triangles(
            self.x[which],
            self.y[which],
            self.depth[which],
            self.value[which],
            self.material[which],
        )


@dataclass
class Segments:
    """Strips of triangles, one dot high: dots left <= x < right of line y. int64[n] each."""

    triangle: np.ndarray
    y: np.ndarray
    left: np.ndarray
    right: np.ndarray

    def __len__(self) -> int:
        return len(self.y)

    def take(self, which) -> Segments:
        """The segments selected by `which` (a mask or indices)."""
        return Segments(self.triangle[which], self.y[which], self.left[which], self.right[which])


def clip(corners: np.ndarray, value: np.ndarray, material: np.ndarray, near: float):
    """Cut triangles at the near plane w = `near` and at the guard band round the screen.

    corners: float64[T, 3, 4], homogeneous screen points (X, Y, w, z) of `Camera.project`; value:
    float64[T, 3, C]; material: int[T]. Returns the same three for the triangles that remain; a
    triangle may become two (Sutherland and Hodgman 1974, one plane after the other). Neighbours
    cut a common edge from the same end with the same arithmetic, at the same point.
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
        # Turn the odd corner out (the only one inside, or the only one outside) to the front.
        odd = np.where(one, np.argmax(inside, axis=1), np.argmin(inside, axis=1))
        turn = (odd[:, None] + np.arange(3)) % 3
        row = np.arange(len(values))[:, None]
        turned, reach = values[row, turn], distance[row, turn]
        t, r = turned[one], reach[one]
        tip = np.stack([t[:, 0], _cut(t, r, 0, 1), _cut(t, r, 0, 2)], axis=1)
        t, r = turned[two], reach[two]
        p, q = _cut(t, r, 1, 0), _cut(t, r, 2, 0)
        quad = np.stack([p, t[:, 1], t[:, 2], p, t[:, 2], q], axis=1)
        quad = quad.reshape(-1, 3, values.shape[-1])
        values = np.concatenate([values[whole], tip, quad])
        material = np.concatenate([material[whole], material[one], np.repeat(material[two], 2)])
    return values[..., :4], values[..., 4:], material


def _cut(values: np.ndarray, distance: np.ndarray, inner: int, outer: int) -> np.ndarray:
    """The point on the plane between corners `inner` and `outer` of each triangle."""
    t = distance[:, inner] / (distance[:, inner] - distance[:, outer])
    return values[:, inner] + t[:, None] * (values[:, outer] - values[:, inner])


def set_up(x, y, depth, value, material, two_sided: bool) -> Triangles:
    """Snap to the grid, drop back faces (unless `two_sided`) and what has no area on the screen.

    x, y: float64[T, 3], pixels, counter-clockwise seen from outside (with y down: negative area);
    the others as in `Triangles`, vertices in the same order. |x|, |y| at most about GUARD.
    """
    x, y = (np.floor(c * GRID + 0.5).astype(np.int64) for c in (x, y))
    area = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    keep = np.flatnonzero(area != 0 if two_sided else area < 0)
    order = np.argsort(y[keep], axis=1, kind="stable")
    row = keep[:, None]
    return Triangles(
        x[row, order], y[row, order], depth[row, order], value[row, order], material[keep]
    )


def line_range(triangles: Triangles, width: int, height: int) -> tuple[np.ndarray, np.ndarray]:
    """int64[T] each: the first scan line of each triangle and the one after its last, in
    0..height: those with the line's centre y at or below the top and above the bottom vertex.
    Triangles that lie beside the screen get none."""
    first = np.clip(_first_centre(triangles.y[:, 0]), 0, height)
    end = np.clip(_first_centre(triangles.y[:, 2]), 0, height)
    beside = (triangles.x.max(axis=1) < 0) | (triangles.x.min(axis=1) > width * GRID)
    return first, np.where(beside, first, np.maximum(end, first))


def _first_centre(coordinate: np.ndarray) -> np.ndarray:
    """The first pixel whose centre is at or after a grid `coordinate`."""
    return -((GRID // 2 - coordinate) // GRID)


def cover(triangles: Triangles, first, end, width: int) -> Segments:
    """The strips of triangles on the scan lines first <= y < end (int64[T] each, within those of
    `line_range`), cut to 0 <= x < width; strips without a dot are left out.

    On the line with its centre at y, an edge from (xa, ya) to (xb, yb) is crossed at
    xa + (y - ya)(xb - xa)/(yb - ya). The first dot at or after the crossing follows by one integer
    division, exactly; the strip runs from that of the left edge to that of the right.
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


def _crossing(xa, ya, xb, yb, y) -> np.ndarray:
    """The first dot whose centre is at or right of the edge a-b (ya < yb) at height `y`."""
    rise = yb - ya
    reach = (xa - GRID // 2) * rise + (y - ya) * (xb - xa)
    return -((-reach) // (GRID * rise))


def resolve(segments: Segments, depth: np.ndarray, width: int) -> Segments:
    """The visible parts of `segments`, ordered by y, then x.

    depth: float64[n, 2], at the first and the last dot of each. Equal depths go to the segment
    that comes first, which is that of the triangle with the smaller index.
    """
    if not len(segments):
        return segments
    start = segments.y * width + segments.left
    end = segments.y * width + segments.right
    order = np.argsort(start, kind="stable")
    # Segments overlap nobody if they begin after all before them and end before the next begins.
    reach = np.maximum.accumulate(end[order])
    begins_free = np.concatenate([[True], start[order][1:] >= reach[:-1]])
    ends_free = np.concatenate([begins_free[1:], [True]])
    free = np.empty(len(order), bool)
    free[order] = begins_free & ends_free
    if free.all():
        return segments.take(order)

    alone = segments.take(free)
    rest = _nearest_runs(segments.take(~free), depth[~free], width)
    both = Segments(
        np.concatenate([alone.triangle, rest.triangle]),
        np.concatenate([alone.y, rest.y]),
        np.concatenate([alone.left, rest.left]),
        np.concatenate([alone.right, rest.right]),
    )
    return both.take(np.argsort(both.y * width + both.left, kind="stable"))


def _nearest_runs(segments: Segments, depth: np.ndarray, width: int) -> Segments:
    """Resolve dot by dot: the nearest segment owns a dot, a run of dots of one owner is visible."""
    top = int(segments.y.min())
    dots = (int(segments.y.max()) - top + 1) * width
    nearest = np.full(dots, np.inf)
    nobody = len(segments)
    owner = np.full(dots, nobody)
    length = segments.right - segments.left
    total = np.cumsum(length)
    slope = (depth[:, 1] - depth[:, 0]) / np.maximum(length - 1, 1)
    begin = 0
    while begin < len(segments):
        done = total[begin - 1] if begin else 0
        stop = max(int(np.searchsorted(total, done + BLOCK_DOTS, "right")), begin + 1)
        s = np.repeat(np.arange(begin, stop), length[begin:stop])
        along = np.arange(len(s)) - (total[s] - length[s] - done)
        dot = (segments.y[s] - top) * width + segments.left[s] + along
        here = depth[s, 0] + slope[s] * along
        before = nearest[dot]
        np.minimum.at(nearest, dot, here)
        after = nearest[dot]
        owner[dot[after < before]] = nobody
        wins = here == after
        np.minimum.at(owner, dot[wins], s[wins])
        begin = stop
    first = np.flatnonzero(np.concatenate([[True], owner[1:] != owner[:-1]]))
    last = np.concatenate([first[1:], [dots]])
    owned = owner[first] != nobody
    first, last = first[owned], last[owned]
    y = first // width
    return Segments(segments.triangle[owner[first]], y + top, first - y * width, last - y * width)
