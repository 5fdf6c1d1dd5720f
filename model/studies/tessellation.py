# SPDX-License-Identifier: MIT
"""Tessellation study: error of a shaded mesh against the true surface, by technique and mesh size.

The true picture is eq. (3) of the paper with the exact normal of the surface point that is visible
at the centre of each pixel. Mesh and surface cover different pixels along their outlines; only
pixels that both cover are compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np

from phong75.model.analysis import reference
from phong75.model.arrays import Flags, Reals
from phong75.model.config import DEFAULT, TECHNIQUES
from phong75.model.frame import Frame
from phong75.model.front import scene_to_spans, visibility
from phong75.model.front.camera import Camera, light_frame, view_axes
from phong75.model.front.mesh import Mesh, apply_matrix, normalize
from phong75.model.front.mid_edge_normals import RULES
from phong75.model.front.scene import Material, Scene, SceneObject
from phong75.model.front.visibility import GRID
from phong75.model.scene_to_frame import front_end
from phong75.model.studies.surfaces import SURFACES, Patch, Surface
from phong75.model.twin import Pixels, render

SIZE = (640, 480)
#: The default material. No channel saturates, because a clamp would hide errors.
MATERIAL = Material((0.55, 0.45, 0.35), 0.15, 10.0, (0.0, 1.0), (0.4, 0.4))
LIGHT = (-0.5, 0.6, 1.0)  # relative to the camera
#: {surface: (direction towards the eye, height of the picture in scene units)}. In these views the
#: torus hides no part of itself, and the patch's normals are within 60 degrees of the eye.
VIEWS = {
    "sphere": ((1, -2, 1.5), 2.3),
    "torus": ((0.2, -0.4, 1.0), 2.9),
    "patch": ((0.7, -0.7, 0.3), 2.4),
}
#: Normals that are quadratic over each triangle, by the rule of their mid-edge normals.
QUADRATIC = replace(DEFAULT, name="quadratic_normals", normal_order=2)
#: What the RTL shades: {name: configuration}. A name in RULES is the interpolation of the scene.
SHADED = TECHNIQUES | dict.fromkeys(
    ("quadratic_vlachos", "quadratic", "quadratic_exact"), QUADRATIC
)
METHODS = (*SHADED, "cubic")
#: Errors below this, in LSB, are not those of a technique. Vertices are snapped to 2**-12 pixel, so
#: they move by up to 2**-13 pixel in x and y, and a picture changes by some LSB per pixel.
FLOOR = 1e-3


def scene_of(
    surface: Surface, mesh: Mesh, size: tuple[int, int] = SIZE, material: Material = MATERIAL
) -> Scene:
    """The scene that shows `mesh`. The view depends on `surface`, not on the mesh.

    size: (width, height), pixels.
    """
    back, height = VIEWS[surface.name]
    axes = view_axes(back, (0.0, 0.0, 1.0))
    assert axes is not None  # no view is along z
    middle = surface.mesh(4).vertices
    target = (middle.min(axis=0) + middle.max(axis=0)) / 2
    camera = Camera("orthographic", axes, target, target + 10 * axes[2], height)
    light = normalize(np.asarray(LIGHT) @ axes)
    objects = [SceneObject(surface.name, mesh, 0)]
    return Scene(
        surface.name,
        size[0],
        size[1],
        (0.0, 0.0, 0.0),
        camera,
        light,
        False,
        "linear",
        objects,
        [material],
    )


def shade(normal: Reals, scene: Scene, material: Material) -> Reals:
    """255 S by eq. (3) in float64: float64[n, 3].

    normal: float64[n, 3], any length, scene axes.
    """
    axes, eye = light_frame(scene.light, scene.camera.axes[2])
    cp, d = np.array(material.color), material.d
    ones = np.ones((len(normal), 1))
    return reference.shade(
        apply_matrix(axes, normal), ones * (cp * d), ones * (cp * (1 - d)),
        material.weight, material.highlight.at, eye, scene.two_sided,
    )  # fmt: skip


@dataclass(frozen=True)
class Truth:
    """The picture of a true surface; arrays have one row per pixel, n = width * height.

    width: pixels per scan line.
    covered: bool[n], whether the surface is visible in the pixel.
    value: float64[n, 3], 255 S.
    facing: float64[n], cosine of the angle between normal and eye.
    highlight: bool[n], whether the specular term is more than half of its maximum.
    """

    width: int
    covered: np.ndarray
    value: np.ndarray
    facing: np.ndarray
    highlight: np.ndarray


@lru_cache(maxsize=8)
def truth(name: str, size: tuple[int, int] = SIZE, material: Material = MATERIAL) -> Truth:
    """The picture of the true surface `name` (a key of SURFACES)."""
    surface = SURFACES[name]
    scene = scene_of(surface, surface.mesh(4), size, material)
    right, up, back = scene.camera.axes
    step = scene.camera.height / size[1]
    y, x = np.divmod(np.arange(size[0] * size[1]), size[0])
    origin = scene.camera.target + (x + 0.5 - size[0] / 2)[:, None] * step * right
    origin = origin - (y + 0.5 - size[1] / 2)[:, None] * step * up
    covered, normal = surface.see(origin, back)
    dull = replace(material, weight_values=(0.0, 0.0))
    value = shade(normal, scene, material)
    specular = (value - shade(normal, scene, dull))[:, 0]
    highlight = covered & (specular > 0.5 * np.max(specular, where=covered, initial=0))
    return Truth(size[0], covered, value, normal @ back, highlight)


@dataclass(frozen=True)
class SeenPatch:
    """A teapot patch as `Mesh.surface`, for parallel rays."""

    patch: Patch

    def see(self, origin: Reals, back: Reals, reach: Reals) -> tuple[Flags, Reals]:
        """See `front.surface.Surface`. In the view of the study no ray meets the patch twice."""
        return self.patch.see_beyond(origin, back[0])


def shaded_scene(
    surface: Surface,
    mesh: Mesh,
    technique: str,
    size: tuple[int, int] = SIZE,
    material: Material = MATERIAL,
) -> Scene:
    """The scene that shows `mesh` by `technique`, a name of SHADED."""
    if isinstance(surface, Patch):
        mesh = replace(mesh, surface=SeenPatch(surface))
    scene = scene_of(surface, mesh, size, material)
    return replace(scene, interpolation=technique) if technique in RULES else scene


@dataclass(frozen=True)
class Picture:
    """A shaded mesh.

    pixel: int64[n], covered pixels as y * width + x. value: float64[n, 3], 255 S there.
    """

    pixel: np.ndarray
    value: np.ndarray


def shaded(
    surface: Surface,
    level: int,
    technique: str,
    size: tuple[int, int] = SIZE,
    material: Material = MATERIAL,
) -> tuple[Frame, Picture]:
    """Frame (for the hardware) and Picture (before any rounding) of the mesh with `level` steps.

    technique: a name of SHADED.
    """
    scene = shaded_scene(surface, surface.mesh(level), technique, size, material)
    config = SHADED[technique]
    front = front_end(scene, config)
    pixels = render(front.frame, config)
    value = reference.render_exact(front.frame, front.exact, config)
    return front.frame, Picture(pixels.y * size[0] + pixels.x, value)


def cubic(
    surface: Surface, level: int, size: tuple[int, int] = SIZE, material: Material = MATERIAL
) -> Picture:
    """The mesh shaded by cubic interpolation of the intensity, which Phong (1975) mentions.

    Over each triangle the intensity is a cubic Bezier triangle. At the vertices it has the
    intensities of the surface and their gradients on the screen; its centre point is Farin's, which
    reproduces quadratics. Near the outline the gradients grow without bound; there the angle
    between normal and eye is limited to acos(0.1).
    """
    mesh = surface.mesh(level)
    scene = scene_of(surface, mesh, size, material)
    right, up, back = scene.camera.axes
    pixel = scene.camera.height / size[1]
    normal = mesh.normals
    corners = [shade(normal.reshape(-1, 3), scene, material)]
    for axis, sign in ((right, 1.0), (up, -1.0)):
        slope = (normal @ axis) / np.maximum(normal @ back, 0.1)
        tangent = sign * pixel * (axis - slope[..., None] * back)
        tangent -= np.sum(tangent * normal, axis=-1, keepdims=True) * normal
        change = 1e-3 * surface.turn(mesh, tangent)
        ahead, behind = (
            shade((normal + s * change).reshape(-1, 3), scene, material) for s in (1, -1)
        )
        corners.append((ahead - behind) / 2e-3)
    value = np.concatenate(corners, axis=-1).reshape(-1, 3, 9)
    screen = scene.camera.project(mesh.vertices[mesh.faces], *size)
    w = screen[..., 2]
    triangles = visibility.set_up(
        screen[..., 0], screen[..., 1], scene.camera.depth(w, screen[..., 3]), value,
        np.zeros(len(mesh.faces), np.int64), False,
    )  # fmt: skip
    pixels, values = [], []
    for segments, _ in scene_to_spans.visible(triangles, *size):
        length = segments.right - segments.left
        row = np.repeat(np.arange(len(segments)), length)
        x = np.arange(len(row)) - np.repeat(np.cumsum(length) - length, length) + segments.left[row]
        t, y = segments.triangle[row], segments.y[row]
        pixels.append(y * size[0] + x)
        corner = np.stack([triangles.x[t], triangles.y[t]], axis=-1) / GRID
        values.append(_bezier(corner, triangles.value[t], np.stack([x, y], axis=-1) + 0.5))
    return Picture(np.concatenate(pixels), np.clip(np.concatenate(values), 0.0, 255.0))


def _bezier(corner: Reals, value: Reals, point: Reals) -> Reals:
    """Evaluate cubic Bezier triangles: float64[n, 3].

    corner: float64[n, 3, 2], vertices on the screen. value: float64[n, 3, 9], at each vertex three
    intensities, their derivatives along x, and along y. point: float64[n, 2].
    """
    a, b, c = (corner[:, k] for k in range(3))

    def area(p: Reals, q: Reals, r: Reals) -> Reals:
        return (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (r[:, 0] - p[:, 0]) * (q[:, 1] - p[:, 1])

    whole = area(a, b, c)
    weight = np.stack([area(point, b, c), area(a, point, c), area(a, b, point)]) / whole
    s, gx, gy = value[..., :3], value[..., 3:6], value[..., 6:]
    total, controls = np.zeros_like(s[:, 0]), np.zeros_like(s[:, 0])
    for i in range(3):
        total += weight[i][:, None] ** 3 * s[:, i]
        for j in range(3):
            if i != j:
                edge = corner[:, j] - corner[:, i]
                control = s[:, i] + (gx[:, i] * edge[:, :1] + gy[:, i] * edge[:, 1:]) / 3
                controls += control
                total += 3 * (weight[i] ** 2 * weight[j])[:, None] * control
    centre = controls / 4 - s.sum(axis=1) / 6
    return total + 6 * np.prod(weight, axis=0)[:, None] * centre


def errors(
    picture: Picture,
    name: str,
    size: tuple[int, int] = SIZE,
    material: Material = MATERIAL,
    where: str = "all",
) -> dict[str, Any]:
    """Error of `picture` against the true surface `name`, in LSB, on the pixels that both cover.

    where: which pixels count: "all"; "facing", normals within 60 degrees of the eye; "highlight",
    see `Truth`. Returns the number of pixels, and maximum, RMS, 99.9 % quantile and mean of the
    error's magnitude.
    """
    true = truth(name, size, material)
    counted = true.covered[picture.pixel]
    if where == "facing":
        counted &= true.facing[picture.pixel] >= 0.5
    elif where == "highlight":
        counted &= true.highlight[picture.pixel]
    error = np.abs(picture.value[counted] - true.value[picture.pixel[counted]])
    return {
        "pixels": int(counted.sum()),
        "max_lsb": float(error.max()),
        "rms_lsb": float(np.sqrt(np.mean(error**2))),
        "p999_lsb": float(np.quantile(error, 0.999, method="higher")),
        "mean_lsb": float(error.mean()),
    }


@lru_cache
def perfect_rms(name: str, size: tuple[int, int] = SIZE) -> float:
    """RMS error of perfect rounding on the true surface `name`: of the nearest codes, LSB."""
    true = truth(name, size)
    value = true.value[true.covered]
    return float(np.sqrt(np.mean((np.floor(value + 0.5) - value) ** 2)))


def distance(a: Picture, b: Picture) -> float:
    """RMS difference of two pictures of the same mesh, LSB."""
    first, second = np.argsort(a.pixel), np.argsort(b.pixel)
    assert np.array_equal(a.pixel[first], b.pixel[second])
    return float(np.sqrt(np.mean((a.value[first] - b.value[second]) ** 2)))


def order(levels: Sequence[float], values: Sequence[float], last: int = 4) -> float:
    """Order of convergence: minus the slope of log `values` over log `levels`.

    The slope is a least squares fit over the `last` points at or above FLOOR.
    """
    points = [pair for pair in zip(levels, values, strict=True) if pair[1] >= FLOOR][-last:]
    x, y = np.log(np.array(points)).T
    slope = np.polyfit(x, y, 1)[0]
    return float(-slope)


def as_picture(frame: Frame, pixels: Pixels) -> Picture:
    """The Picture of the pipeline's output `pixels` (`Pixels`)."""
    return Picture(pixels.y * frame.width + pixels.x, pixels.rgb.astype(np.float64))
