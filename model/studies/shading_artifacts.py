# SPDX-License-Identifier: MIT
"""Shading artefacts, measured: Mach bands, flicker and dependence on orientation.

These are the arguments of Phong (1975) against Gouraud's shading.

- Mach bands: "whenever the slope of the light intensity curve changes, this effect appears". This
  module measures the jump of the slope, and of the intensity, across the edges of polygons.
- Flicker: "the shading of a surface in motion ... has annoying frame to frame discontinuities". A
  picture of a sphere or torus that rotates about its own axis should not change. All change comes
  from the mesh.
- Orientation: "the shading algorithms are not invariant under rotation". This is true of polygons
  with more than three vertices. Over a triangle the interpolation is an affine function, which
  does not depend on the orientation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from phong75.model.analysis import reference
from phong75.model.arrays import ArrayLike, Ints, Reals
from phong75.model.frame import ExactFrame, Frame
from phong75.model.front.camera import Camera
from phong75.model.front.interpolation import interpolate_at
from phong75.model.front.mesh import Mesh
from phong75.model.front.scene import Material, Scene, SceneObject
from phong75.model.front.scene_to_spans import FrontEnd
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import tessellation
from phong75.model.studies.surfaces import SURFACES
from phong75.model.twin import Pixels

# -- Mach bands ------------------------------------------------------------------------------------


def _along(frame: Frame, exact: ExactFrame, span: Ints, k: ArrayLike, technique: str) -> Reals:
    """255 S along spans, float64[n, 3], before any rounding.

    span: int[n], numbers of the spans. k: real[n], position in pixels from the centre of the span's
    first pixel.
    """
    k = np.asarray(k)[:, None]
    value = exact.start[span] + k * exact.step[span] + k * (k - 1) / 2 * exact.bend[span]
    if tessellation.SHADED[technique].technique != "phong":
        return 255 * np.clip(value, 0, 1)
    m = frame.spans["material"][span]
    return reference.shade_exact(value, m, exact, frame.two_sided)


def mach_bands(front: FrontEnd, technique: str, counted: np.ndarray) -> dict:
    """Jumps of slope (LSB per pixel) and intensity (LSB) across edges, along the scan lines.

    counted: bool[width * height], which pixels count as the pixel to the left of an edge. An edge
    is between two adjacent spans. Both jumps are evaluated halfway between the two pixels beside
    the edge; the true edge is at most half a pixel away. Edges beside spans of one pixel are left
    out, because such spans have no slope. Flat shading has slope 0 and jumps only in intensity.
    Returns the number of edges and RMS, mean and maximum of the jumps.
    """
    frame, exact = front.frame, front.exact
    spans = frame.spans
    end = spans["x"] + spans["length"]
    left = np.flatnonzero((spans["y"][:-1] == spans["y"][1:]) & (end[:-1] == spans["x"][1:]))
    left = left[counted[spans["y"][left] * frame.width + end[left] - 1]]
    left = left[np.minimum(spans["length"][left], spans["length"][left + 1]) > 1]
    h = 0.25  # one-sided difference of second order: the slope at the edge from three points
    before = [_along(frame, exact, left, spans["length"][left] - 0.5 - i * h, technique)
              for i in range(3)]  # fmt: skip
    after = [_along(frame, exact, left + 1, np.full(len(left), i * h - 0.5), technique)
             for i in range(3)]  # fmt: skip
    slope = np.abs(sum((3 * p[0] - 4 * p[1] + p[2]) for p in (before, after))) / (2 * h)
    jump = np.abs(after[0] - before[0])
    return {
        "edges": len(left),
        "slope_rms": float(np.sqrt(np.mean(slope**2))),
        "slope_mean": float(slope.mean()),
        "slope_max": float(slope.max()),
        "intensity_rms": float(np.sqrt(np.mean(jump**2))),
        "intensity_max": float(jump.max()),
    }


def profile(
    name: str, level: int, technique: str, size: tuple[int, int] = tessellation.SIZE
) -> tuple[Ints, Reals]:
    """The middle scan line of a picture: x (int[n]) and 255 S of green (float64[n]).

    name: a surface of `SURFACES`. level: number of steps of the mesh. technique: a key of
    `tessellation.SHADED`, or "true" for the surface itself. size: (width, height), pixels.
    """
    line = size[1] // 2
    if technique == "true":
        true = tessellation.truth(name, size)
        row = slice(line * size[0], (line + 1) * size[0])
        x = np.flatnonzero(true.covered[row])
        return x, true.value[row][x, 1]
    _, picture = tessellation.shaded(SURFACES[name], level, technique, size)
    on_line = picture.pixel // size[0] == line
    order = np.argsort(picture.pixel[on_line])
    return (picture.pixel[on_line] % size[0])[order], picture.value[on_line][order, 1]


# -- flicker ---------------------------------------------------------------------------------------


def turning(
    name: str, level: int, technique: str, frames: int = 30, size: tuple[int, int] = (320, 240)
) -> Iterator[Frame]:
    """Yield `frames` frames of a mesh that rotates about the z axis by 1 degree per frame."""
    surface = SURFACES[name]
    mesh = surface.mesh(level)
    for degree in range(frames):
        rotated = mesh.transformed(rotate=(0.0, 0.0, float(degree)))
        scene = tessellation.shaded_scene(surface, rotated, technique, size)
        yield front_end(scene, tessellation.SHADED[technique]).frame


def flicker(frames: list[Frame], pixels: list) -> dict:
    """Change from frame to frame, in LSB of a colour code, on the pixels that all frames cover.

    pixels: the `Pixels` of each of `frames`. The rotating surface is symmetric, so that perfect
    shading gives 0. Returns a dict:

    - pixels: number of pixels that all frames cover.
    - change_rms, change_mean, change_max: change of the codes from one frame to the next, LSB.
    - pixels_that_change_more_than_1: fraction of the pixels that ever change by more than 1 LSB.
    - peak_range: smallest and largest of the frames' brightest codes.
    - highlight_path: length of the path of the highlight, pixels. The highlight is at the centre of
      the brightest 1 % of the pixels.
    """
    width, height = frames[0].width, frames[0].height
    films = np.full((len(pixels), width * height, 3), -1, np.int16)
    for k, p in enumerate(pixels):
        films[k, p.y * width + p.x] = p.rgb
    common = np.flatnonzero((films >= 0).all(axis=(0, 2)))
    film = films[:, common].astype(np.float64)
    change = np.abs(np.diff(film, axis=0))
    brightness = film.sum(axis=2)
    bright = brightness >= np.quantile(brightness, 0.99, axis=1, keepdims=True)
    centre = np.stack([(bright * c).sum(axis=1) / bright.sum(axis=1)
                       for c in (common % width, common // width)])  # fmt: skip
    return {
        "pixels": len(common),
        "change_rms": float(np.sqrt(np.mean(change**2))),
        "change_mean": float(change.mean()),
        "change_max": float(change.max()),
        "pixels_that_change_more_than_1": float((change.max(axis=(0, 2)) > 1).mean()),
        "peak_range": [int(film.max(axis=(1, 2)).min()), int(film.max(axis=(1, 2)).max())],
        "highlight_path": float(np.linalg.norm(np.diff(centre), axis=0).sum()),
    }


# -- orientation -----------------------------------------------------------------------------------

#: A square with one black corner and three white ones, and the two triangles of the square. Their
#: common edge connects two white corners.
CORNERS = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
SHADES = np.array([1.0, 0.0, 1.0, 1.0])
HALVES = ((0, 1, 2), (0, 2, 3))


def _rotated(points: Reals, degrees: float) -> Reals:
    """`points` (float64[..., 2]) rotated by `degrees`; multiples of 90 degrees are exact."""
    quarters, remainder = divmod(degrees, 90.0)
    c, s = np.cos(np.radians(remainder)), np.sin(np.radians(remainder))
    points = points @ np.array([[c, s], [-s, c]])
    for _ in range(int(quarters) % 4):
        points = np.stack([-points[..., 1], points[..., 0]], axis=-1)
    return points


def polygon_shade(corners: Reals, shades: Reals, point: Sequence[float] | Reals) -> float:
    """Gouraud's interpolation over a convex polygon at `point` (x, y).

    corners: float64[N, 2]. shades: float64[N]. The shade is interpolated along the two edges that
    the scan line crosses, then along the scan line.
    """
    ends = []
    for (ax, ay), a, (bx, by), b in zip(
        corners, shades, np.roll(corners, -1, axis=0), np.roll(shades, -1), strict=True
    ):
        if (ay <= point[1]) != (by <= point[1]):
            t = (point[1] - ay) / (by - ay)
            ends.append((ax + t * (bx - ax), a + t * (b - a)))
    (left, a), (right, b) = sorted(ends)
    return a + (b - a) * (point[0] - left) / (right - left)


def orientation(step: float = 5.0, per_side: int = 9) -> dict:
    """How the shades of fixed points of the square depend on its orientation, 0 to 180 degrees.

    step: degrees between orientations. per_side: points per side of the grid of points. Returns,
    for the square as one polygon ("quadrilateral") and as two triangles ("triangles"):
    largest_spread_lsb, the largest difference over all orientations, and middle_lsb, the shade of
    the middle at 0, 45 and 90 degrees.
    """
    side = np.linspace(-0.9, 0.9, per_side)
    u, v = (c.reshape(-1) for c in np.meshgrid(side, side))
    points = np.stack([(u + v) / 2, (u - v) / 2], axis=-1)  # inside the square, on its corner
    shades: dict[str, list] = {"quadrilateral": [], "triangles": []}
    degrees = np.arange(0.0, 180.0, step)
    for degree in degrees:
        corners, rotated = _rotated(CORNERS, degree), _rotated(points, degree)
        shades["quadrilateral"].append([polygon_shade(corners, SHADES, p) for p in rotated])
        half = np.where(points[:, 1] >= 0, 0, 1)
        shades["triangles"].append(
            [
                float(interpolate_at(corners[list(HALVES[h])], SHADES[list(HALVES[h]), None], p)[0])
                for h, p in zip(half, rotated, strict=True)
            ]
        )
    middle = len(points) // 2
    result: dict = {}
    for kind, rows in shades.items():
        table = 255 * np.array(rows)
        middle_shades = {f"{d:g}": round(float(table[list(degrees).index(d), middle]), 3)
                         for d in (0.0, 45.0, 90.0)}  # fmt: skip
        result[kind] = {
            "largest_spread_lsb": float(np.ptp(table, axis=0).max()), "middle_lsb": middle_shades,
        }  # fmt: skip
    return result


def square_scene(degrees: float, size: int = 200) -> Scene:
    """A scene of the square as two triangles, for the hardware.

    A white corner has its normal towards the light, a black one perpendicular to the light.
    """
    flat = _rotated(CORNERS, degrees)
    vertices = np.concatenate([flat, np.zeros((4, 1))], axis=1)
    normals = np.where(SHADES[:, None] > 0, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    faces = np.array(HALVES)
    mesh = Mesh(vertices, faces, normals[faces])
    camera = Camera("orthographic", np.eye(3), np.zeros(3), np.array([0.0, 0.0, 10.0]), 2.2)
    white = Material((1.0, 1.0, 1.0), 0.0, 1.0, (0.0, 1.0), (0.0, 0.0))
    return Scene(
        "square", size, size, (0.5, 0.5, 0.5), camera, np.array([0.0, 0.0, 1.0]), False, "linear",
        [SceneObject("square", mesh, 0)], [white],
    )  # fmt: skip


def quarter_turn_difference(upright: Pixels, turned: Pixels, size: int = 200) -> int:
    """Largest difference, LSB, of the square's codes at 0 degrees and at 90 degrees.

    upright, turned: `Pixels` of the two pictures. The second is rotated back. Only pixels that both
    pictures cover count.
    """
    pictures = np.full((2, size, size, 3), -1)
    for picture, p in zip(pictures, (upright, turned), strict=True):
        picture[p.y, p.x] = p.rgb
    rotated_back = np.rot90(pictures[1], -1)
    both = (pictures[0] >= 0) & (rotated_back >= 0)
    return int(np.abs(pictures[0] - rotated_back)[both].max())


def polygon_picture(degrees: float, size: int = 200) -> np.ndarray:
    """The square as one polygon, in the view of `square_scene`, scan line by scan line.

    Returns 255 S, float64[size, size], y downward; NaN outside the square.
    """
    corners = _rotated(CORNERS, degrees)
    corners = np.stack([corners[:, 0], -corners[:, 1]], axis=-1) * size / 2.2 + size / 2
    picture = np.full((size, size), np.nan)
    for y in range(size):
        crossed = [
            ax + (y + 0.5 - ay) / (by - ay) * (bx - ax)
            for (ax, ay), (bx, by) in zip(corners, np.roll(corners, -1, axis=0), strict=True)
            if (ay <= y + 0.5) != (by <= y + 0.5)
        ]
        if crossed:
            for x in range(int(np.ceil(min(crossed) - 0.5)), int(np.ceil(max(crossed) - 0.5))):
                picture[y, x] = 255 * polygon_shade(corners, SHADES, (x + 0.5, y + 0.5))
    return picture
