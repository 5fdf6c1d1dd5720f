# SPDX-License-Identifier: MIT
"""The picture that a scene would have if its shapes were the smooth surfaces they stand for.

A scene file names its shapes. Each shape is made anew from fine triangles, which decide what each
pixel shows. The normal at a pixel is the exact normal of the surface where `surfaces` knows the
surface (sphere, torus) and one white light at infinity shines on it, and else the normal of the
fine mesh. A mesh file holds triangles and not the surface that they stand for, and a crease is
meant as it is: a scene with one of them has no true picture.
"""

from __future__ import annotations

import inspect
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from phong75.model.analysis import reference
from phong75.model.arrays import Ints, Reals
from phong75.model.config import DEFAULT
from phong75.model.frame import fitted
from phong75.model.front.camera import Camera
from phong75.model.front.mesh import Mesh, normalize, rotation_matrix
from phong75.model.front.scene import SHAPES, Scene, SceneObject, bundled_path
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import tessellation
from phong75.model.studies.surfaces import Solid, Sphere, Torus
from phong75.model.twin.core.span_walker import pixel_count, span_walker

#: Steps of the fine meshes, by the name of a shape's parameter. Parameters that are not here do not
#: make the mesh finer.
FINEST = {"segments": 512, "sides": 256, "rings": 128, "divisions": 64}

#: Keys of an object that do not change which surface it stands for.
_PLACING = {"shape", "name", "material", "scale", "rotate", "translate"}


class NoTrueSurfaceError(Exception):
    """The scene has no true surface; the message says why."""


@dataclass(frozen=True)
class TrueObject:
    """The surface behind an object of a scene.

    how: what stands for the surface, in words. mesh: fine triangles, scene coordinates. surface:
    None if the mesh itself is all that is known. matrix, shift: float64[3, 3] and float64[3]; a
    point P of `surface` is at matrix P + shift in scene coordinates.
    """

    how: str
    mesh: Mesh
    surface: Solid | None
    matrix: Reals
    shift: Reals

    def as_fine_triangles(self) -> TrueObject:
        """The same without exact normals."""
        return self if self.surface is None else replace(
            self, how=f"{self.how.partition(':')[0]}: fine triangles", surface=None
        )  # fmt: skip

    def normals(self, origin: Reals, back: Reals, farthest: float) -> Reals:
        """Normals where rays meet `surface`, scene axes, float64[n, 3], NaN where they miss it.

        origin, back, farthest: as for `Solid.see`, in scene coordinates.
        """
        assert self.surface is not None
        inverse = np.linalg.inv(self.matrix)
        back = normalize(np.broadcast_to(back, origin.shape) @ inverse.T)
        hit, normal = self.surface.see((origin - self.shift) @ inverse.T, back, farthest)
        return np.where(hit[:, None], normal @ inverse, np.nan)


@dataclass(frozen=True)
class TruePicture:
    """The true picture of a scene; arrays have one row per pixel, n = width * height.

    value: float64[n, 3], 255 S; NaN where no surface is seen. item: int64[n], number of the object
    that the pixel shows, -1 for none. one_white_light: whether one white light at infinity, and no
    other kind of light or highlight, makes the picture: only then are normals exact.
    """

    value: Reals
    item: Ints
    one_white_light: bool = True


def true_objects(name_or_path: str | Path) -> list[TrueObject]:
    """The surfaces behind the objects of a scene that `load_scene` has accepted.

    Raises NoTrueSurfaceError.
    """
    name = str(name_or_path)
    path = bundled_path(name) or Path(name)
    if path.suffix.lower() != ".toml":
        raise NoTrueSurfaceError(f"{path.name} is a mesh")
    tables = tomllib.loads(path.read_text(encoding="utf-8"))["objects"]
    return [_true_object(table, f"objects[{k}]") for k, table in enumerate(tables)]


def _true_object(table: dict[str, Any], where: str) -> TrueObject:
    shape = table.get("shape")
    if shape is None:
        raise NoTrueSurfaceError(f"{where} is a mesh")
    parameters = {
        name: table.get(name, parameter.default)
        for name, parameter in inspect.signature(SHAPES[shape]).parameters.items()
    }
    for key in table:
        if key not in _PLACING | set(parameters):
            raise NoTrueSurfaceError(f"{where} has `{key}`")
    finer = {k: max(v, FINEST[k]) for k, v in parameters.items() if k in FINEST}
    rotate, shift = table.get("rotate", (0.0, 0.0, 0.0)), table.get("translate", (0.0, 0.0, 0.0))
    scale = np.broadcast_to(np.asarray(table.get("scale", 1.0), np.float64), 3)
    mesh = SHAPES[shape](**parameters | finer).transformed(scale, rotate, shift)
    surface: Solid | None = None
    if shape == "sphere":
        surface = Sphere()
    elif shape == "torus":
        surface = Torus(tube=parameters["tube"] / parameters["radius"])
    unit = parameters["radius"] if surface else 1.0
    how = f"{shape}: exact normals"
    if surface is None:
        how = f"{shape}: {', '.join(f'{k} = {v}' for k, v in finer.items()) or 'flat faces'}"
    return TrueObject(how, mesh, surface, rotation_matrix(rotate) * scale * unit, np.asarray(shift))


def objects_seen(scene: Scene) -> Ints:
    """Number of the object that each pixel of `scene` shows, int64[width * height], -1 for none.

    Raises InputError as `front_end`.
    """
    return _rendered(scene).item


def true_picture(scene: Scene, objects: Sequence[TrueObject]) -> TruePicture:
    """The true picture of `scene`, whose objects stand for the surfaces `objects`.

    Raises InputError as `front_end`.
    """
    items = [
        SceneObject(item.name, true.mesh, item.material)
        for item, true in zip(scene.objects, objects, strict=True)
    ]
    picture = _rendered(replace(scene, objects=items))
    for k, true in enumerate(objects):
        pixel = np.flatnonzero(picture.item == k)
        if true.surface is None or not picture.one_white_light or not len(pixel):
            continue
        normal = true.normals(*_rays(scene.camera, pixel, scene.width, scene.height))
        seen = np.isfinite(normal).all(axis=1)
        material = scene.materials[scene.objects[k].material]
        picture.value[pixel[seen]] = tessellation.shade(normal[seen], scene, material)
        # The fine mesh shows a little of what is beside the surface's outline: not the surface.
        picture.value[pixel[~seen]], picture.item[pixel[~seen]] = np.nan, -1
    return picture


def _rendered(scene: Scene) -> TruePicture:
    """255 S of `scene` in float64 before any rounding, and the object that each pixel shows."""
    # With a material for each object, a span's material says which object the span belongs to.
    materials = [scene.materials[item.material] for item in scene.objects]
    items = [SceneObject(item.name, item.mesh, k) for k, item in enumerate(scene.objects)]
    bits = max(DEFAULT.material_bits, (len(items) - 1).bit_length())
    config = replace(DEFAULT, material_bits=bits)
    front = front_end(replace(scene, objects=items, materials=materials), config)
    built = fitted(config, front.frame)
    spans = front.frame.spans
    pixels = span_walker(spans, 0, pixel_count(spans), config)
    place = pixels.y * scene.width + pixels.x
    value = np.full((scene.width * scene.height, 3), np.nan)
    item = np.full(len(value), -1, np.int64)
    value[place] = reference.render_exact(front.frame, front.exact, built)
    item[place] = spans["material"][pixels.span]
    return TruePicture(value, item, built == config)


def _rays(camera: Camera, pixel: Ints, width: int, height: int) -> tuple[Reals, Reals, float]:
    """The rays through the centres of pixels: origin, back and farthest of `Solid.see`.

    pixel: int64[n], y * width + x in a picture of `width` by `height` pixels.
    """
    y, x = np.divmod(pixel, width)
    right, up, back = camera.axes
    perspective = camera.projection == "perspective"
    step = camera.height / height
    if perspective:
        step = 2 * np.tan(np.radians(camera.fov) / 2) / height
    aside = (x + 0.5 - width / 2)[:, None] * step * right
    aside = aside - (y + 0.5 - height / 2)[:, None] * step * up
    if perspective:
        return np.broadcast_to(camera.eye, aside.shape), normalize(back - aside), 0.0
    return camera.target + aside, np.broadcast_to(back, aside.shape), np.inf
