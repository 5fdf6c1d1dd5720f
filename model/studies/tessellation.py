"""What a mesh loses against the surface behind it, by shading technique, as it is refined.

The measure is the shading of the true surface: eq. (3) with the exact normal of the point that the
eye sees at the centre of each dot. Mesh and surface cover different dots along their outlines;
what is compared are the dots that both cover.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from phong75.model.analysis import reference
from phong75.model.config import DEFAULT, TECHNIQUES
from phong75.model.frame import Frame
from phong75.model.front import scene_to_spans, visibility
from phong75.model.front.camera import Camera, light_frame, view_axes
from phong75.model.front.mesh import Mesh, apply_matrix, normalize
from phong75.model.front.scene import Material, Scene, SceneObject
from phong75.model.front.visibility import GRID
from phong75.model.scene_to_frame import front_end
from phong75.model.studies.surfaces import SURFACES, Surface
from phong75.model.twin import render

SIZE = (640, 480)
#: No channel saturates: a clamp would hide errors.
MATERIAL = Material((0.55, 0.45, 0.35), 0.15, 10.0, (0.0, 1.0), (0.4, 0.4))
LIGHT = (-0.5, 0.6, 1.0)  # relative to the camera
#: Directions towards the eye, and heights of the picture: the torus hides no part of itself, and
#: no part of the patch is turned away by more than 60 degrees.
VIEWS = {
    "sphere": ((1, -2, 1.5), 2.3),
    "torus": ((0.2, -0.4, 1.0), 2.9),
    "patch": ((0.7, -0.7, 0.3), 2.4),
}
METHODS = (*TECHNIQUES, "cubic")


def scene_of(surface: Surface, mesh: Mesh, size=SIZE, material: Material = MATERIAL) -> Scene:
    """A picture of `mesh`, in a view that depends on `surface` but not on the mesh."""
    back, height = VIEWS[surface.name]
    axes = view_axes(back, (0.0, 0.0, 1.0))
    middle = surface.mesh(4).vertices
    target = (middle.min(axis=0) + middle.max(axis=0)) / 2
    camera = Camera("orthographic", axes, target, target + 10 * axes[2], height)
    light = normalize(np.asarray(LIGHT) @ axes)
    objects = [SceneObject(surface.name, mesh, 0)]
    return Scene(
        surface.name, *size, (0.0, 0.0, 0.0), camera, light, False, "linear", objects, [material]
    )


def shade(normal, scene: Scene, material: Material) -> np.ndarray:
    """255 S by eq. (3) in float64 for normals in the scene's axes, float64[n, 3]."""
    axes, eye = light_frame(scene.light, scene.camera.axes[2])
    cp, d = np.array(material.color), material.d
    weight = material.weight(np.linspace(0, 1, DEFAULT.weight_points))
    ones = np.ones((len(normal), 1))
    return reference.shade(
        apply_matrix(axes, normal), ones * (cp * d), ones * (cp * (1 - d)),
        ones * weight, ones[:, 0] * material.n, eye, False,
    )  # fmt: skip


@dataclass(frozen=True)
class Truth:
    """The surface in a picture of `width` dots a line: covered bool[dots]; value float64[dots, 3],
    255 S; facing float64[dots], cosine of the angle between normal and eye; highlight bool[dots],
    where the specular term is more than half of its largest."""

    width: int
    covered: np.ndarray
    value: np.ndarray
    facing: np.ndarray
    highlight: np.ndarray


@lru_cache(maxsize=8)
def truth(name: str, size=SIZE, material: Material = MATERIAL) -> Truth:
    """The picture of the surface `name` itself."""
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
class Picture:
    """A mesh shaded: the dots it covers (y * width + x) and 255 S there, before any rounding."""

    dot: np.ndarray
    value: np.ndarray


def shaded(surface: Surface, level: int, technique: str, size=SIZE, material=MATERIAL):
    """Frame (for the hardware) and Picture of the mesh with `level` steps."""
    scene = scene_of(surface, surface.mesh(level), size, material)
    config = TECHNIQUES[technique]
    made = front_end(scene, config)
    pixels = render(made.frame, config)
    value = reference.render_exact(made.frame, made.exact, config)
    return made.frame, Picture(pixels.y * size[0] + pixels.x, value)


def cubic(surface: Surface, level: int, size=SIZE, material=MATERIAL) -> Picture:
    """The mesh shaded by a cubic interpolant of the intensity, the paper's other candidate.

    Over each triangle the Bezier cubic with intensities and their gradients on the screen at the
    vertices, which are those of the surface, and the centre point that keeps quadratics (Farin).
    Near the outline, where gradients grow without bound, they are those of a surface that is
    turned away from the eye by no more than acos(0.1).
    """
    mesh = surface.mesh(level)
    scene = scene_of(surface, mesh, size, material)
    right, up, back = scene.camera.axes
    pixel = scene.camera.height / size[1]
    normal = mesh.normals
    corners = [shade(normal.reshape(-1, 3), scene, material)]
    for across, sign in ((right, 1.0), (up, -1.0)):
        slope = (normal @ across) / np.maximum(normal @ back, 0.1)
        tangent = sign * pixel * (across - slope[..., None] * back)
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
    dots, values = [], []
    for segments, _ in scene_to_spans.visible(triangles, *size):
        length = segments.right - segments.left
        row = np.repeat(np.arange(len(segments)), length)
        x = np.arange(len(row)) - np.repeat(np.cumsum(length) - length, length) + segments.left[row]
        t, y = segments.triangle[row], segments.y[row]
        dots.append(y * size[0] + x)
        place = np.stack([triangles.x[t], triangles.y[t]], axis=-1) / GRID
        values.append(_bezier(place, triangles.value[t], np.stack([x, y], axis=-1) + 0.5))
    return Picture(np.concatenate(dots), np.clip(np.concatenate(values), 0.0, 255.0))


def _bezier(corner, value, point):
    """float64[n, 3]: the cubics through `value` (float64[n, 3, 9]: intensities, their slopes along
    x, along y) at `corner` (float64[n, 3, 2]), at `point` (float64[n, 2])."""
    a, b, c = (corner[:, k] for k in range(3))

    def area(p, q, r):
        return (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (r[:, 0] - p[:, 0]) * (q[:, 1] - p[:, 1])

    whole = area(a, b, c)
    share = np.stack([area(point, b, c), area(a, point, c), area(a, b, point)]) / whole
    s, gx, gy = value[..., :3], value[..., 3:6], value[..., 6:]
    total, beside = np.zeros_like(s[:, 0]), np.zeros_like(s[:, 0])
    for i in range(3):
        total += share[i][:, None] ** 3 * s[:, i]
        for j in range(3):
            if i != j:
                way = corner[:, j] - corner[:, i]
                control = s[:, i] + (gx[:, i] * way[:, :1] + gy[:, i] * way[:, 1:]) / 3
                beside += control
                total += 3 * (share[i] ** 2 * share[j])[:, None] * control
    centre = beside / 4 - s.sum(axis=1) / 6
    return total + 6 * np.prod(share, axis=0)[:, None] * centre


def errors(picture: Picture, name: str, size=SIZE, material=MATERIAL, where: str = "all") -> dict:
    """How far `picture` is from the surface's, in LSB, on the dots that both cover.

    where: "all"; "facing", dots whose normal is within 60 degrees of the eye; "highlight".
    """
    true = truth(name, size, material)
    kept = true.covered[picture.dot]
    if where == "facing":
        kept &= true.facing[picture.dot] >= 0.5
    elif where == "highlight":
        kept &= true.highlight[picture.dot]
    error = np.abs(picture.value[kept] - true.value[picture.dot[kept]])
    return {
        "dots": int(kept.sum()),
        "max_lsb": float(error.max()),
        "rms_lsb": float(np.sqrt(np.mean(error**2))),
        "p999_lsb": float(np.quantile(error, 0.999, method="higher")),
        "mean_lsb": float(error.mean()),
    }


def distance(a: Picture, b: Picture) -> float:
    """RMS difference of two pictures of one mesh, in LSB."""
    first, second = np.argsort(a.dot), np.argsort(b.dot)
    assert np.array_equal(a.dot[first], b.dot[second])
    return float(np.sqrt(np.mean((a.value[first] - b.value[second]) ** 2)))


def order(levels, values, last: int = 4) -> float:
    """The order of convergence: minus the slope of log `values` over log `levels`, least squares
    over the `last` of them."""
    slope = np.polyfit(np.log(levels[-last:]), np.log(values[-last:]), 1)[0]
    return float(-slope)


def as_picture(frame: Frame, pixels) -> Picture:
    """The Picture of codes that came out of the pipeline (`Pixels`)."""
    return Picture(pixels.y * frame.width + pixels.x, pixels.rgb.astype(np.float64))
