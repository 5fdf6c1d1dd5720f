"""The paper's arguments against Gouraud's shading as numbers: Mach bands, flicker, orientation.

- Mach bands: "whenever the slope of the light intensity curve changes, this effect appears"; so
  the jump of that slope across the edges of polygons is measured, and that of the intensity.
- Flicker: "the shading of a surface in motion ... has annoying frame to frame discontinuities". A
  sphere or torus that turns about its own axis should not change at all; what changes is the mesh.
- Orientation: "the shading algorithms are not invariant under rotation". That holds for polygons
  with more than three vertices; over a triangle, two linear interpolations are one.
"""

from __future__ import annotations

import numpy as np

from phong75.model.analysis import reference
from phong75.model.config import TECHNIQUES
from phong75.model.frame import ExactFrame, Frame
from phong75.model.front.camera import Camera
from phong75.model.front.interpolation import interpolate_at
from phong75.model.front.mesh import Mesh
from phong75.model.front.scene import Material, Scene, SceneObject
from phong75.model.front.scene_to_spans import FrontEnd
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import tessellation
from phong75.model.studies.surfaces import SURFACES

# -- Mach bands ------------------------------------------------------------------------------------


def _along(frame: Frame, exact: ExactFrame, span, k, technique: str) -> np.ndarray:
    """255 S of spans number `span` (int[n]) at the real place `k` ([n], in dots), float64[n, 3]."""
    value = exact.start[span] + np.asarray(k)[:, None] * exact.step[span]
    if technique != "phong":
        return 255 * np.clip(value, 0, 1)
    m, d = frame.spans["material"][span], exact.d[:, None]
    return reference.shade(
        value, (exact.cp * d)[m], (exact.cp * (1 - d))[m], exact.weight[m], exact.exponent[m],
        exact.eye, frame.two_sided,
    )  # fmt: skip


def mach_bands(made: FrontEnd, technique: str, counted: np.ndarray) -> dict:
    """Jumps across the edges that scan lines of the picture `made` cross, of the slope (LSB a dot)
    and of the intensity (LSB). Flat faces have no slope, and jumps of the intensity alone.

    Jumps are taken in the middle between the dots on both sides, which is where the edge is to
    half a dot; spans of one dot have no slope, and do not count. counted: bool[width * height],
    the dots (left of the edge) that do.
    """
    frame, exact = made.frame, made.exact
    spans = frame.spans
    end = spans["x"] + spans["length"]
    left = np.flatnonzero((spans["y"][:-1] == spans["y"][1:]) & (end[:-1] == spans["x"][1:]))
    left = left[counted[spans["y"][left] * frame.width + end[left] - 1]]
    left = left[np.minimum(spans["length"][left], spans["length"][left + 1]) > 1]
    h = 0.25  # slopes at the edge itself, from three points on one side of it
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


def profile(name: str, level: int, technique: str, size=tessellation.SIZE):
    """The middle line of a picture: x (int[n]) and 255 S of green (float64[n]).

    technique: "true" for the surface itself.
    """
    line = size[1] // 2
    if technique == "true":
        true = tessellation.truth(name, size)
        row = slice(line * size[0], (line + 1) * size[0])
        x = np.flatnonzero(true.covered[row])
        return x, true.value[row][x, 1]
    _, picture = tessellation.shaded(SURFACES[name], level, technique, size)
    here = picture.dot // size[0] == line
    order = np.argsort(picture.dot[here])
    return (picture.dot[here] % size[0])[order], picture.value[here][order, 1]


# -- flicker ---------------------------------------------------------------------------------------


def turning(name: str, level: int, technique: str, frames: int = 30, size=(320, 240)):
    """Yield the Frame of each picture while the mesh turns about the z axis, 1 degree a picture."""
    surface = SURFACES[name]
    mesh = surface.mesh(level)
    for degree in range(frames):
        turned = mesh.transformed(rotate=(0.0, 0.0, float(degree)))
        scene = tessellation.scene_of(surface, turned, size)
        yield front_end(scene, TECHNIQUES[technique]).frame


def flicker(frames: list[Frame], pixels: list) -> dict:
    """Change from picture to picture (codes, LSB) of `pixels` (a list of `Pixels`), on the dots
    that all of them cover; and how the highlight moves and changes.

    A surface that turns into itself does not change: 0 is perfect. highlight_path: how far the
    centre of the brightest hundredth of the dots travels, in dots, all steps added up.
    """
    width, height = frames[0].width, frames[0].height
    films = np.full((len(pixels), width * height, 3), -1, np.int16)
    for k, p in enumerate(pixels):
        films[k, p.y * width + p.x] = p.rgb
    dots = np.flatnonzero((films >= 0).all(axis=(0, 2)))
    film = films[:, dots].astype(np.float64)
    change = np.abs(np.diff(film, axis=0))
    brightness = film.sum(axis=2)
    bright = brightness >= np.quantile(brightness, 0.99, axis=1, keepdims=True)
    centre = np.stack([(bright * d).sum(axis=1) / bright.sum(axis=1)
                       for d in (dots % width, dots // width)])  # fmt: skip
    return {
        "dots": len(dots),
        "change_rms": float(np.sqrt(np.mean(change**2))),
        "change_mean": float(change.mean()),
        "change_max": float(change.max()),
        "dots_that_change_more_than_1": float((change.max(axis=(0, 2)) > 1).mean()),
        "peak_range": [int(film.max(axis=(1, 2)).min()), int(film.max(axis=(1, 2)).max())],
        "highlight_path": float(np.linalg.norm(np.diff(centre), axis=0).sum()),
    }


# -- orientation -----------------------------------------------------------------------------------

#: A square, one corner black, the others white; and its two triangles, cut from white to white.
CORNERS = np.array([(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)])
SHADES = np.array([1.0, 0.0, 1.0, 1.0])
HALVES = ((0, 1, 2), (0, 2, 3))


def _turned(points, degrees: float) -> np.ndarray:
    """`points` (float64[..., 2]) turned by `degrees`; right angles without rounding."""
    right, rest = divmod(degrees, 90.0)
    c, s = np.cos(np.radians(rest)), np.sin(np.radians(rest))
    points = points @ np.array([[c, s], [-s, c]])
    for _ in range(int(right) % 4):
        points = np.stack([-points[..., 1], points[..., 0]], axis=-1)
    return points


def polygon_shade(corners, shades, point) -> float:
    """The shade at `point` (x, y) of a convex polygon (float64[N, 2], float64[N]): along the two
    edges that the scan line crosses, then along the line."""
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
    """How the shade of the same points of the square depends on its orientation, 0 to 180 degrees.

    Largest spread over all orientations in LSB, of the square as one polygon and as two triangles;
    and the middle's shades at 0, 45 and 90 degrees.
    """
    side = np.linspace(-0.9, 0.9, per_side)
    u, v = (c.reshape(-1) for c in np.meshgrid(side, side))
    points = np.stack([(u + v) / 2, (u - v) / 2], axis=-1)  # within the square on its corner
    shades: dict[str, list] = {"quadrilateral": [], "triangles": []}
    degrees = np.arange(0.0, 180.0, step)
    for degree in degrees:
        corners, here = _turned(CORNERS, degree), _turned(points, degree)
        shades["quadrilateral"].append([polygon_shade(corners, SHADES, p) for p in here])
        half = np.where(points[:, 1] >= 0, 0, 1)
        shades["triangles"].append(
            [
                float(interpolate_at(corners[list(HALVES[h])], SHADES[list(HALVES[h]), None], p)[0])
                for h, p in zip(half, here, strict=True)
            ]
        )
    middle = len(points) // 2
    out: dict = {}
    for kind, rows in shades.items():
        table = 255 * np.array(rows)
        at = {f"{d:g}": round(float(table[list(degrees).index(d), middle]), 3)
              for d in (0.0, 45.0, 90.0)}  # fmt: skip
        out[kind] = {
            "largest_spread_lsb": float(np.ptp(table, axis=0).max()), "middle_lsb": at,
        }  # fmt: skip
    return out


def square_scene(degrees: float, size: int = 200) -> Scene:
    """The square as two triangles before the camera, for the hardware: white where the normal is
    towards the light, black where it is across."""
    flat = _turned(CORNERS, degrees)
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


def quarter_turn_difference(upright, turned, size: int = 200) -> int:
    """Largest difference in LSB of the square's codes at 0 and at 90 degrees (`Pixels`), the
    second turned back, on the dots that both cover."""
    films = np.full((2, size, size, 3), -1)
    for film, p in zip(films, (upright, turned), strict=True):
        film[p.y, p.x] = p.rgb
    back = np.rot90(films[1], -1)
    both = (films[0] >= 0) & (back >= 0)
    return int(np.abs(films[0] - back)[both].max())


def polygon_picture(degrees: float, size: int = 200) -> np.ndarray:
    """The square as one polygon, scan line by scan line: float64[size, size], 255 S, NaN
    outside; y down, in the view of `square_scene`."""
    corners = _turned(CORNERS, degrees)
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
