# SPDX-License-Identifier: MIT
"""Scenes: reads and checks TOML scene files, bundled scenes (by name) and bare mesh files.

A mistake in a scene file raises an `InputError` of one line that names the file, the key and the
value. model/scenes/*.toml are examples. Only `shape` or `mesh` is required. All keys:

    size = [640, 480]               # pixels
    background = [0.0, 0.0, 0.0]    # red, green, blue, 0 to 1
    two_sided = false               # show both sides of surfaces: normals turn to the eye
    toward_light = false            # "the normal will always point toward the light source"
    lit_faces_only = false          # keep faces dark that turn away from the light
    interpolation = "linear"        # as in the paper; or "normalized_edges", or "quadratic",
                                    # "quadratic_vlachos", "quadratic_exact" (`mid_edge_normals`)
    shading = "smooth"              # of objects that do not say; "flat": one normal per face
    flat_point = "centre"           # flat technique: of a triangle; or "vertex", its first one

    ambient = [1.0, 1.0, 1.0]       # Ia, light without a direction
    exposure = 1.0                  # factor of all intensities; or "Imax": no channel saturates

    [light]                         # or [[lights]], up to 8
    direction = [-0.5, 0.6, 1.0]    # towards the light, any length
    relative_to = "camera"          # x right, y up, z to the eye; or "scene" (default)
    color = [1.0, 1.0, 1.0]         # of its diffuse and its specular light; or one by one:
    ambient = [0.0, 0.0, 0.0]       # La
    diffuse = [1.0, 1.0, 1.0]       # Ld
    specular = [1.0, 1.0, 1.0]      # Ls
    name = "key light"
    position = [1.0, 2.0, 3.0]      # in place of direction: a light at a place, in scene axes, or
                                    # in camera axes from the camera's target; or "eye"
    place = "half"                  # the hardware's approximation: half, light, middle or face
    attenuation = { distance = [1, 9], values = [1.0, 0.2] }  # falls with the distance; or
    attenuation = { constant = 1.0, linear = 0.1, quadratic = 0.0 }  # as in OpenGL

    [camera]                        # omitted keys are chosen so that all objects are visible
    projection = "orthographic"     # or "perspective"
    direction = [0.35, -1.0, 0.45]  # from the target towards the eye; or
    eye = [1, -3, 2]                #   a point
    target = [0, 0, 0]              # the point in the middle of the picture
    up = [0, 0, 1]
    height = 4.0                    # orthographic: scene units from top to bottom
    fov = 30                        # perspective: degrees from top to bottom; or
    screen_distance = 800           #   pixels from the eye to the screen
    near = 0.01                     # perspective: distance of the near plane

    [materials.NAME]                # eq. (3) of the paper; up to 16
    color = [0.7, 0.6, 0.5]         # Cp
    d = 0.15                        # environmental diffuse reflection coefficient, 0 to 1
    n = 10                          # 0 to 128, whole or not; below 1 a curve's table takes it
    curve = { cos = [0, 0.9, 0.9], values = [0, 0, 1] }  # in place of n: any curve of cos(s)
    W = 0.4                         # or values at equally spaced Zn = cos(i) from 0 to 1, or
    W = { degrees = [0, 60, 90], values = [0.2, 0.3, 0.8] }  # at incident angles i
    ambient = [0.1, 0.1, 0.1]       # ka; default: color times d
    diffuse = [0.6, 0.5, 0.4]       # kd; default: color times (1 - d)
    specular = [0.9, 0.7, 0.3]      # ks; default: 1 each; with this key W is 1 by default
    emission = [0.0, 0.0, 0.0]      # e
    two_sided = true                # of all objects of this material

    [[objects]]
    shape = "teapot"                # or sphere, torus, cone, pyramid
    divisions = 10                  # the parameters of a shape's function (`shapes`) are keys
    mesh = "bunny.obj"              # instead of `shape`: a mesh file, relative to the scene file
    crease = 60                     # edges that bend more (degrees) are sharp; recomputes normals
    shading = "flat"                # or "smooth"
    scale = 1.0                     # or [x, y, z]; applied first
    rotate = [0, 0, 0]              # degrees about x, y, z; applied after the scale
    translate = [0, 0, 0]           # applied last
    material = "NAME"               # or { color = ..., n = ... }; default: those of the mesh file
    two_sided = true                # of this object
    name = "my teapot"

W is piecewise linear in Zn between the given points and constant beyond them; so is a curve in
cos(s). Two equal angles or cosines in a row are a jump; at the jump the value of the larger cosine
counts. The intensity is

    I = e + ka Ia + sum over lights of (ka La + kd Ld cos(i) + ks Ls W(i) cos(s)**n).
"""

from __future__ import annotations

import difflib
import inspect
import math
import tomllib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from phong75.model.arrays import ArrayLike, Flags, Ints, Reals
from phong75.model.config import DEFAULT, MAX_EXPONENT, MAX_LIGHTS, Config
from phong75.model.frame import InputError
from phong75.model.front import mid_edge_normals, notes, shapes
from phong75.model.front.camera import (
    DEFAULT_DIRECTION,
    DEFAULT_FOV,
    DEFAULT_LIGHT,
    DEFAULT_UP,
    NEAR,
    Camera,
    fit_orthographic,
    fit_perspective,
    view_axes,
)
from phong75.model.front.mesh import Mesh
from phong75.model.front.mesh_files.checks import TESTED_SUFFIXES
from phong75.model.front.mesh_files.load import MESH_SUFFIXES, load_mesh_file
from phong75.model.front.mesh_files.materials import Materials, reduce_materials
from phong75.model.front.mesh_files.report import MeshReport
from phong75.model.front.mesh_normals import normals_and_areas
from phong75.model.places import RULES as PLACE_RULES
from phong75.model.places import Falloff, Place
from phong75.model.reflectance import Curve, Polyline, Power

SCENES = Path(__file__).parent.parent / "scenes"
TECHNIQUE_SCENES = SCENES / "techniques"
DEFAULT_SIZE = (640, 480)
DEFAULT_BACKGROUND = (0.05, 0.06, 0.08)
INTERPOLATIONS = ("linear", "normalized_edges", *mid_edge_normals.RULES)
SHADINGS = ("smooth", "flat")
#: Where the flat technique takes the intensity of a triangle: at its centre or its first vertex.
FLAT_POINTS = ("centre", "vertex")

SHAPES: dict[str, Callable[..., Mesh]] = {
    "sphere": shapes.sphere,
    "torus": shapes.torus,
    "cone": shapes.cone,
    "pyramid": shapes.pyramid,
    "teapot": shapes.teapot,
}

#: Largest tessellation parameters. Finer meshes only take memory: at these values triangles are
#: far smaller than a pixel.
MAX_TESSELLATION = {"divisions": 128, "segments": 1024, "sides": 1024, "rings": 1024}

#: A colour of a light or a material: red, green, blue, 0 or more.
Colour = tuple[float, float, float]

WHITE: Colour = (1.0, 1.0, 1.0)
BLACK: Colour = (0.0, 0.0, 0.0)

#: Largest component of a light's colour, before `exposure`. The products with the coefficients of
#: materials have to fit their words.
MOST_LIGHT = 1e6

#: What a method of `_Table` returns for a missing key.
Default = TypeVar("Default")


@dataclass(frozen=True)
class Material:
    """Coefficients of one material in Phong's eq. (3).

    color: Cp of red, green and blue, 0 to 1.
    d: environmental diffuse reflection coefficient, 0 to 1.
    n: specular exponent, 0 to 128.
    weight_zn, weight_values: points of W(i): increasing Zn = cos(i) and W there, both 0 to 1. W is
    piecewise linear in Zn between the points and constant beyond them. Two equal Zn in a row are a
    jump.
    curve: the curve of cos(s) in place of cos(s)**n, values 0 to 1; None for the power.
    ambient, diffuse, specular: ka, kd, ks of OpenGL's model, 0 to 1; None for the paper's rule, by
    which they are Cp d, Cp (1 - d) and 1. emission: e, 0 to 1. two_sided: show both sides of the
    objects of this material.
    """

    color: tuple[float, float, float] = (0.65, 0.62, 0.58)
    d: float = 0.15
    n: float = 10.0
    weight_zn: tuple[float, ...] = (0.0, 1.0)
    weight_values: tuple[float, ...] = (0.4, 0.4)
    ambient: Colour | None = None
    diffuse: Colour | None = None
    specular: Colour | None = None
    emission: Colour = BLACK
    two_sided: bool = False
    curve: Polyline | None = None

    @property
    def ka(self) -> Reals:
        """Ambient reflection of red, green and blue, float64[3]."""
        return np.asarray(self.color) * self.d if self.ambient is None else np.array(self.ambient)

    @property
    def kd(self) -> Reals:
        """Diffuse reflection of red, green and blue, float64[3]."""
        if self.diffuse is None:
            return np.asarray(self.color) * (1 - self.d)
        return np.array(self.diffuse)

    @property
    def ks(self) -> Reals:
        """Specular reflection of red, green and blue, float64[3]."""
        return np.array(self.specular or WHITE)

    @property
    def weight_curve(self) -> Polyline:
        """W as a function of Zn = cos(i)."""
        return Polyline(self.weight_zn, self.weight_values)

    @property
    def highlight(self) -> Curve:
        """The curve of cos(s), or cos(s)**n, as a function of cos(s)."""
        return self.curve or Power(self.n)

    @property
    def needs_curve(self) -> bool:
        """Whether no table of powers holds the highlight."""
        return self.curve is not None or self.n < 1

    def weight(self, zn: ArrayLike) -> Reals:
        """W at `zn` (any shape), float64."""
        return self.weight_curve.at(zn)


@dataclass(frozen=True)
class Light:
    """A light.

    direction: float64[3], unit vector towards the light, scene axes; of a light at a place, from
    the middle of the scene. ambient, diffuse, specular: La, Ld, Ls of red, green and blue, 0 or
    more. place: where the light is and how it falls with the distance, scene axes.
    """

    direction: Reals
    ambient: Colour = BLACK
    diffuse: Colour = WHITE
    specular: Colour = WHITE
    name: str = "light"
    place: Place = Place()


@dataclass
class SceneObject:
    """A mesh in scene coordinates.

    material: index in `Scene.materials`, of the object or of each triangle, int64[F]. two_sided:
    whether to show both sides, of the object or of each triangle, bool[F]. report: what was decided
    about the mesh.
    """

    name: str
    mesh: Mesh
    material: int | Ints
    two_sided: bool | Flags = False
    report: MeshReport | None = None


@dataclass(repr=False)
class Scene:
    """A checked scene, ready for the front end.

    width, height: pixels. background: red, green, blue, 0 to 1. light: float64[3], unit vector
    towards the first light, scene axes. two_sided: show both sides of all surfaces; the normals of
    faces that turn away from the eye are reversed. interpolation: "linear" (the paper's),
    "normalized_edges" (see `interpolation`) or one of `mid_edge_normals.RULES`. ambient: Ia of red,
    green and blue. lights: all lights, by default a white one at `light`. remarks: sentences about
    what was assumed where the file leaves it open. toward_light: light both sides of all surfaces;
    the hardware reverses normals that point away from the light ("it can be assumed that the normal
    will always point toward the light source", Phong 1975). lit_faces_only: leave faces dark that
    turn away from the light, although interpolated normals would light a part of them.
    """

    name: str
    width: int
    height: int
    background: tuple[float, float, float]
    camera: Camera
    light: Reals
    two_sided: bool
    interpolation: str
    objects: list[SceneObject]
    materials: list[Material] = field(default_factory=lambda: [Material()])
    ambient: Colour = WHITE
    lights: list[Light] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    toward_light: bool = False
    lit_faces_only: bool = False
    flat_point: str = "centre"

    def __post_init__(self) -> None:
        self.lights = self.lights or [Light(self.light)]

    def __repr__(self) -> str:
        triangles = sum(len(item.mesh.faces) for item in self.objects)
        return (
            f"Scene({self.name}, {self.width}x{self.height}, objects: {len(self.objects)}, "
            f"triangles: {triangles}, materials: {len(self.materials)})"
        )


def bundled_scenes() -> list[str]:
    """Sorted names of the scenes that come with the project."""
    return sorted(p.stem for p in SCENES.glob("*.toml"))


def technique_scenes() -> list[str]:
    """Sorted names of the bundled scenes that show one technique each."""
    return sorted(p.stem for p in TECHNIQUE_SCENES.glob("*.toml"))


def bundled_path(name: str) -> Path | None:
    """The file of a bundled scene or technique scene; None if there is none of this name."""
    folders = dict.fromkeys(bundled_scenes(), SCENES)
    folders |= dict.fromkeys(technique_scenes(), TECHNIQUE_SCENES)
    return folders[name] / f"{name}.toml" if name in folders else None


def load_scene(
    name_or_path: str | Path, size: tuple[int, int] | None = None, config: Config = DEFAULT
) -> Scene:
    """Load a bundled scene (by name), a scene file (.toml or .scn, see `notes`) or a mesh file.

    A mesh file gets the default camera, light and material. size: (width, height) in pixels,
    overrides the scene's size. config: limits of the size and of the number of materials. Raises
    InputError.
    """
    name = str(name_or_path)
    path = bundled_path(name) or Path(name)
    if not path.is_file():
        if path.exists():
            raise InputError(f"{name}: not a file")
        bundled = [*bundled_scenes(), *technique_scenes()]
        close = difflib.get_close_matches(name, bundled, 1)
        hint = f"; did you mean {close[0]}?" if close else ""
        raise InputError(f"{name}: no such file, nor a bundled scene ({', '.join(bundled)}){hint}")
    suffix = path.suffix.lower()
    if suffix == ".toml":
        return _scene(_Table(_read_toml(path), str(path)), path, size, config)
    if suffix == notes.SCENE_SUFFIX:
        table, remarks = notes.scene_table(path)
        scene = _scene(_Table(table, str(path)), path, size, config)
        scene.remarks = remarks + scene.remarks
        return scene
    if suffix in MESH_SUFFIXES:
        return _mesh_scene(path, size, config)
    raise InputError(
        f"{name}: neither a scene (.toml, {notes.SCENE_SUFFIX}) "
        f"nor a mesh ({', '.join(TESTED_SUFFIXES)})"
    )


def _mesh_scene(path: Path, size: tuple[int, int] | None, config: Config) -> Scene:
    """A scene that shows one mesh file with the default camera and light."""
    item, materials = _file_object(path.stem, path, None)
    assert item.report is not None
    # In STL files (3D printing) z usually points up; in the other formats, y.
    table: dict[str, Any] = (
        {} if (item.report.up or "").startswith("z") else {"up": [0.0, 1.0, 0.0]}
    )
    if "up" in table:
        table["direction"] = [0.35, 0.35, 1.0]
    root = _Table({"camera": table}, str(path))
    width, height = _size(root, size, config)
    camera = _camera(root.table("camera"), item.mesh.vertices, width, height, [])
    rows: list[Material] = []
    _place_materials([(item, materials)], rows, {}, config, path)
    return Scene(
        path.stem,
        width,
        height,
        DEFAULT_BACKGROUND,
        camera,
        _light(root.table("light"), camera, item.mesh.vertices).direction,
        False,
        "linear",
        [item],
        rows,
    )


def _file_object(name: str, path: Path, crease: float | None) -> tuple[SceneObject, Materials]:
    """The object of a mesh file, and its materials; `SceneObject.material` are their indices."""
    loaded = load_mesh_file(path, crease)
    item = SceneObject(name, loaded.mesh, loaded.material, loaded.two_sided, loaded.report)
    return item, loaded.materials


def _place_materials(
    objects: list[tuple[SceneObject, Materials]], materials: list[Material],
    indices: dict[str | None, int], config: Config, path: Path,
) -> None:  # fmt: skip
    """Add the materials of mesh files to `materials`, and let `objects` refer to them.

    objects: each with the materials of its file, to which its `material`, int64[F], refers; -1
    stands for the default material. All files share what the scene's own materials leave of the
    table. Raises InputError if nothing is left.
    """
    of_faces = [np.asarray(item.material) for item, _ in objects]
    if any(np.any(material == -1) for material in of_faces):
        _default_material(materials, indices)
    if not any(len(own) for _, own in objects):
        for item, _ in objects:
            item.material = indices[None]
        return
    room = config.materials - len(materials)
    if room < 1:
        raise InputError(
            f"{path}: {len(materials)} materials leave no room for those of a mesh file: "
            f"the table has {config.materials} entries"
        )
    joined = Materials.join([own for _, own in objects])
    if config.channels == 1:
        joined = joined.grey()
    area = np.zeros(len(joined))
    first = 0
    for (item, own), material in zip(objects, of_faces, strict=True):
        kept = material >= 0
        sizes = normals_and_areas(item.mesh.vertices, item.mesh.faces)[1]
        of_own = np.bincount(material[kept], sizes[kept], len(own))
        area[first : first + len(own)] = of_own / max(sizes.sum(), 1e-300)
        first += len(own)
    table, index, reduction = reduce_materials(joined, area, room)
    base, first = len(materials), 0
    for row in range(len(table)):
        red, green, blue = table.colour[row].tolist()
        w = float(table.w[row])
        materials.append(
            Material(
                (red, green, blue), float(table.d[row]), float(table.n[row]), weight_values=(w, w)
            )
        )
    for (item, own), material in zip(objects, of_faces, strict=True):
        rows = index[first : first + len(own)] + base
        missing = indices.get(None, -1)
        item.material = np.append(rows, missing)[material]  # -1 takes the last one
        first += len(own)
        if reduction.before > reduction.after and item.report:
            item.report.reduction = {
                "before": reduction.before,
                "after": reduction.after,
                "largest_change": reduction.largest,
            }


def _default_material(materials: list[Material], indices: dict[str | None, int]) -> int:
    """The index of the default material, which is added to `materials` if it is not there."""
    index = indices.setdefault(None, len(materials))
    if index == len(materials):
        materials.append(Material())
    return index


def _scene(root: _Table, path: Path, size: tuple[int, int] | None, config: Config) -> Scene:
    width, height = _size(root, size, config)
    background = root.triple("background", DEFAULT_BACKGROUND, 0.0, 1.0)
    two_sided = root.boolean("two_sided", False)
    toward_light = root.boolean("toward_light", False)
    lit_faces_only = root.boolean("lit_faces_only", False)
    interpolation = root.choice("interpolation", INTERPOLATIONS, "linear")
    shading = root.choice("shading", SHADINGS, "smooth")
    flat_point = root.choice("flat_point", FLAT_POINTS, "centre")
    materials: list[Material] = []
    indices: dict[str | None, int] = {}
    for name, table in root.tables_by_name("materials"):
        indices[name] = len(materials)
        materials.append(_material(table))
    objects, of_files = [], []
    for number, table in enumerate(root.list_of_tables("objects")):
        item, own = _object(table, number, path, materials, indices, shading)
        objects.append(item)
        if own is not None:
            of_files.append((item, own))
    if not objects:
        raise root.error("objects", "missing: a scene needs at least one [[objects]] table")
    if len(materials) > config.materials:
        raise root.error(
            "materials", f"{len(materials)} materials, but the table has {config.materials} entries"
        )
    if of_files:
        _place_materials(of_files, materials, indices, config, path)
    points = np.concatenate([o.mesh.vertices for o in objects])
    remarks: list[str] = []
    camera = _camera(root.table("camera"), points, width, height, remarks)
    lights = _lights(root, camera, points)
    ambient = root.triple("ambient", WHITE, 0.0, MOST_LIGHT)
    exposure = _exposure(root, materials, lights, ambient, remarks)
    remarks += [
        f"{light.name}: the eye of an orthographic camera has no place; distances along the line "
        "of sight are measured from the scene's nearest point"
        for light in lights if light.place.along and light.place.falloff
    ]  # fmt: skip
    root.finish()
    return Scene(
        path.stem,
        width,
        height,
        background,
        camera,
        lights[0].direction,
        two_sided,
        interpolation,
        objects,
        [replace(m, emission=_scaled(m.emission, exposure)) for m in materials],
        _scaled(ambient, exposure),
        [_exposed(light, exposure) for light in lights],
        remarks,
        toward_light,
        lit_faces_only,
        flat_point,
    )


def _exposure(
    root: _Table, materials: list[Material], lights: list[Light], ambient: Colour,
    remarks: list[str],
) -> float:  # fmt: skip
    """The factor of all intensities; a sentence is added to `remarks` if it is found here.

    "Imax" is 1/Imax, with Imax of the notes' "Intensity Computations": the formula with all
    products of vectors 1 and the largest coefficients of the scene's materials, W among them, in
    the colour in which it is largest. No channel saturates then.
    """
    if root.value("exposure", None) != "Imax":
        return root.real("exposure", 1.0, 1e-6, 1e6)
    ka, kd = (np.max([getattr(m, k) for m in materials], axis=0) for k in ("ka", "kd"))
    ks = np.max([m.ks * max(m.weight_values) for m in materials], axis=0)
    total = np.max([m.emission for m in materials], axis=0) + ka * ambient
    for light in lights:
        total = total + ka * light.ambient + kd * light.diffuse + ks * light.specular
    largest = float(max(total))
    if largest == 0:
        raise root.error("exposure", '= "Imax": no light is reflected at all, Imax is 0')
    remarks.append(f"Imax is {largest:g}: all intensities are divided by it")
    return 1 / largest


def _scaled(colour: Colour, factor: float) -> Colour:
    red, green, blue = (factor * c for c in colour)
    return red, green, blue


def _exposed(light: Light, factor: float) -> Light:
    return replace(
        light,
        ambient=_scaled(light.ambient, factor),
        diffuse=_scaled(light.diffuse, factor),
        specular=_scaled(light.specular, factor),
    )


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"{path}: not UTF-8 text (byte {error.start})") from None
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from None
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        message = str(error).replace(
            "at end of document", f"at line {text.count(chr(10)) + 1}, end of file"
        )
        raise InputError(f"{path}: malformed TOML: {message}") from None


def _size(root: _Table, size: tuple[int, int] | None, config: Config) -> tuple[int, int]:
    """(width, height) in pixels: `size`, else the scene file's, else the default."""
    in_file = root.value("size", None)
    for where, value in ((root.where("size"), in_file), ("size", size)):
        if value is None:
            continue
        whole = isinstance(value, (list, tuple)) and all(type(v) is int for v in value)
        if not (whole and len(value) == 2):
            raise InputError(f"{where} = {_show(value)} is not [width, height] in pixels")
        if not all(1 <= v <= config.max_size for v in value):
            raise InputError(
                f"{where} = {value[0]}x{value[1]} is outside 1 to {config.max_size} pixels"
            )
    width, height = size or in_file or DEFAULT_SIZE
    return width, height


def _material(table: _Table) -> Material:
    default = Material()
    zn, values = _weight(table)
    colours = {key: table.triple(key, None, 0.0, 1.0) for key in ("ambient", "diffuse", "specular")}
    if colours["specular"] and not values:  # OpenGL's model has no W
        zn, values = (0.0, 1.0), (1.0, 1.0)
    material = Material(
        table.triple("color", default.color, 0.0, 1.0),
        table.real("d", default.d, 0.0, 1.0),
        table.real("n", default.n, 0.0, MAX_EXPONENT),
        zn or default.weight_zn,
        values or default.weight_values,
        emission=table.triple("emission", BLACK, 0.0, 1.0),
        two_sided=table.boolean("two_sided", default.two_sided),
        curve=_curve(table),
        **colours,
    )
    table.finish()
    if material.curve and "n" in table.values:
        raise table.error("n", "has no effect beside curve")
    for key in ("color", "d"):
        if key in table.values and colours["ambient"] and colours["diffuse"]:
            raise table.error(key, "has no effect beside ambient and diffuse")
    return material


def _weight(table: _Table) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """W as increasing Zn and values there; both empty if the table has no W."""
    value = table.value("W", None)
    if value is None:
        return (), ()
    if isinstance(value, dict):
        inner = table.child("W", value)
        degrees = inner.list_of_reals("degrees", 0.0, 90.0)
        values = inner.list_of_reals("values", 0.0, 1.0)
        inner.finish()
        if len(degrees) != len(values):
            raise table.error("W", f"{len(degrees)} degrees, but {len(values)} values")
        _increasing(inner, "degrees", degrees)
        # In floating point cos(90 degrees) is not exactly 0.
        zn = [0.0 if i == 90.0 else math.cos(math.radians(i)) for i in degrees]
        return tuple(zn[::-1]), tuple(values[::-1])
    if isinstance(value, list):
        values = table.list_of_reals("W", 0.0, 1.0)
        if len(values) < 2:
            raise table.error("W", f"= {_show(value)} needs at least two points, at Zn = 0 and 1")
        return tuple(np.linspace(0.0, 1.0, len(values))), tuple(values)
    constant = table.real("W", 0.0, 0.0, 1.0)
    return (0.0, 1.0), (constant, constant)


def _curve(table: _Table) -> Polyline | None:
    """The curve of cos(s) of a material; None if the table has none."""
    value = table.value("curve", None)
    if value is None:
        return None
    inner = table.child("curve", value)
    cosines = inner.list_of_reals("cos", 0.0, 1.0)
    values = inner.list_of_reals("values", 0.0, 1.0)
    inner.finish()
    if len(cosines) != len(values):
        raise table.error("curve", f"{len(cosines)} cosines, but {len(values)} values")
    _increasing(inner, "cos", cosines)
    return Polyline(tuple(cosines), tuple(values))


def _increasing(table: _Table, key: str, places: list[float]) -> None:
    """Raise InputError if `places` do not increase, but for two equal ones in a row, a jump."""
    steps = np.diff(places)
    if np.any(steps < 0):
        raise table.error(key, f"= {_show(places)} do not increase")
    if np.any((steps[:-1] == 0) & (steps[1:] == 0)):
        raise table.error(key, f"= {_show(places)} has three equal ones in a row; a jump has two")


def _object(
    table: _Table,
    number: int,
    path: Path,
    materials: list[Material],
    indices: dict[str | None, int],
    shading: str,
) -> tuple[SceneObject, Materials | None]:
    """The object of a [[objects]] table. If it takes its materials from a mesh file, they are
    returned, too, and `SceneObject.material` are indices of them."""
    shape = table.choice("shape", tuple(SHAPES), None)
    file = table.text("mesh", None)
    label = table.text("name", shape or file or f"object {number}")
    if (shape is None) == (file is None):
        raise table.error("", "needs either shape = ... or mesh = ... (a file)")
    crease = table.real("crease", None, 0.0, 180.0)
    own: Materials | None = None
    if shape:
        mesh = _shape(table, shape)
        report = MeshReport(shape, len(mesh.faces))
        if crease is not None:
            mesh = mesh.with_crease(crease)
            report.normals = f"made here, crease {crease:g} degrees"
            report.crease, report.corners_made = crease, 3 * len(mesh.faces)
        item = SceneObject(label, mesh, 0, False, report)
    else:
        assert file is not None  # checked above
        try:
            item, own = _file_object(label, path.parent / file, crease)
        except InputError as error:
            raise InputError(f"{table.where('mesh')}: {error}") from None
    if table.choice("shading", SHADINGS, shading) == "flat":
        item.mesh = item.mesh.faceted()
        if item.report:
            item.report.normals, item.report.crease = "of the faces: flat shading", None
            item.report.corners_made = 3 * len(item.mesh.faces)
    if isinstance(table.value("scale", 1.0), list):
        scale = table.triple("scale", (1.0, 1.0, 1.0))
    else:
        scale = (table.real("scale", 1.0),) * 3
    if 0.0 in scale:
        raise table.error("scale", "= 0 would flatten the object")
    item.mesh = item.mesh.transformed(
        scale,
        table.triple("rotate", (0.0, 0.0, 0.0)),
        table.triple("translate", (0.0, 0.0, 0.0)),
    )
    two_sided = table.boolean("two_sided", False)
    reference = table.value("material", None)
    if isinstance(reference, dict):
        materials.append(_material(table.child("material", reference)))
        item.material, own = len(materials) - 1, None
    elif reference is not None:
        name = table.text("material", None)
        if name not in indices:
            known = ", ".join(k for k in indices if k) or "none"
            raise table.error("material", f"= {_show(name)} is not in [materials] (known: {known})")
        item.material, own = indices[name], None
    elif own is None:
        item.material = _default_material(materials, indices)
    table.finish()
    by_material = reference is not None and materials[int(item.material)].two_sided
    if two_sided or by_material:
        item.two_sided = True
        if item.report:
            item.report.two_sided = item.report.triangles
            item.report.two_sided_why = [f"the {'object' if two_sided else 'material'} says so"]
    if reference is not None and item.report:
        item.report.materials = 0
    return item, own


def _shape(table: _Table, shape: str) -> Mesh:
    """The mesh of a shape. The parameters of the shape's function are keys of the table."""
    arguments: dict[str, float] = {}
    for name, parameter in inspect.signature(SHAPES[shape]).parameters.items():
        if isinstance(parameter.default, int):
            least = 1 if name in ("rings", "divisions") else 3
            least = 2 if (shape, name) == ("sphere", "rings") else least
            most = MAX_TESSELLATION[name]
            arguments[name] = table.whole(name, parameter.default, least, most)
        else:
            arguments[name] = table.real(name, parameter.default)
            if not arguments[name] > 0:
                raise table.error(name, f"= {arguments[name]:g} is not greater than 0")
    return SHAPES[shape](**arguments)


def _camera(table: _Table, points: Reals, width: int, height_px: int, remarks: list[str]) -> Camera:
    """The camera of a [camera] table. Missing keys are chosen so that `points` fill the picture.

    points: float64[V, 3], all vertices of the scene. width, height_px: of the picture, pixels.
    remarks: gets a sentence if the default `up` does not fit.
    """
    aspect = width / height_px
    projection = table.choice("projection", ("orthographic", "perspective"), "orthographic")
    perspective = projection == "perspective"
    eye, direction = table.triple("eye", None), table.triple("direction", None)
    target, up = table.triple("target", None), table.triple("up", None)
    height, fov = table.real("height", None), table.real("fov", None)
    near, screen = table.real("near", None), table.real("screen_distance", None)
    if eye is not None and direction is not None:
        raise table.error("direction", "and eye cannot both be given")
    if height is not None and perspective:
        raise table.error("height", "is for orthographic cameras; perspective ones have fov")
    for key, value in (("fov", fov), ("near", near), ("screen_distance", screen)):
        if value is not None and not perspective:
            raise table.error(key, "is for perspective cameras; orthographic ones have height")
    for key, value in (("height", height), ("near", near), ("screen_distance", screen)):
        if value is not None and value <= 0:
            raise table.error(key, f"= {value:g} is not greater than 0")
    if fov is not None and not 1.0 <= fov <= 170.0:
        raise table.error("fov", f"= {fov:g} is outside [1, 170] degrees")
    if screen is not None:
        if fov is not None:
            raise table.error("screen_distance", "and fov cannot both be given")
        fov = math.degrees(2 * math.atan(height_px / 2 / screen))
        if not 1.0 <= fov <= 170.0:
            raise table.error(
                "screen_distance",
                f"= {screen:g} shows {fov:.4g} degrees from top to bottom, outside [1, 170]",
            )
    if up is not None and not any(up):
        raise table.error("up", "= [0, 0, 0] has no direction")
    table.finish()

    centre = None if target is None else np.asarray(target)
    viewpoint = None if eye is None else np.asarray(eye)
    if viewpoint is not None:
        if centre is None:
            centre = (points.min(axis=0) + points.max(axis=0)) / 2.0
        back, key = viewpoint - centre, "eye"
    else:
        back, key = np.asarray(direction or DEFAULT_DIRECTION), "direction"
    if not np.any(back):
        zero = "= target: the line of sight has" if key == "eye" else "= [0, 0, 0] has"
        raise table.error(key, f"{zero} no direction")
    axes = view_axes(back, up or DEFAULT_UP)
    if axes is None:
        if up is not None:
            raise table.error("up", f"= {_show(up)} is parallel to the line of sight")
        axes = view_axes(back, (0.0, 1.0, 0.0))
        assert axes is not None
        remarks.append("camera: looks along z, so that y points up")

    if perspective:
        fov = fov or DEFAULT_FOV
        if viewpoint is None or centre is None:
            centre, distance = fit_perspective(points, axes, centre, aspect, fov)
            viewpoint = centre + distance * axes[2]
        near = near or NEAR * float(np.linalg.norm(viewpoint - centre))
        return Camera(projection, axes, centre, viewpoint, fov=fov, near=near)
    centre, fitting = fit_orthographic(points, axes, centre, aspect)
    return Camera(projection, axes, centre, centre + axes[2], height=height or fitting)


def _lights(root: _Table, camera: Camera, points: Reals) -> list[Light]:
    """The lights of [light] or [[lights]]; one of the default direction if there is neither.

    points: float64[V, 3], all vertices of the scene.
    """
    tables = root.list_of_tables("lights")
    single = root.table("light")
    if not tables:
        return [_light(single, camera, points)]
    if single.values:
        raise root.error("light", "and lights cannot both be given")
    if len(tables) > MAX_LIGHTS:
        raise root.error("lights", f"{len(tables)} lights, but there are at most {MAX_LIGHTS}")
    return [_light(table, camera, points) for table in tables]


def _light(table: _Table, camera: Camera, points: Reals) -> Light:
    """The light of a table; without a direction, that of the default light."""
    relative_to = table.choice("relative_to", ("scene", "camera"), "scene")
    direction, place = _place(table, camera, points, relative_to)
    name = table.text("name", "light")
    colour = table.triple("color", None, 0.0, MOST_LIGHT)
    parts = {key: table.triple(key, None, 0.0, MOST_LIGHT) for key in ("diffuse", "specular")}
    ambient = table.triple("ambient", BLACK, 0.0, MOST_LIGHT)
    table.finish()
    if colour is not None and all(parts.values()):
        raise table.error("color", "has no effect beside diffuse and specular")
    diffuse, specular = (part or colour or WHITE for part in parts.values())
    return Light(direction, ambient, diffuse, specular, name, place)


def _place(table: _Table, camera: Camera, points: Reals, relative_to: str) -> tuple[Reals, Place]:
    """The direction to a light (unit vector, scene axes) and its place.

    The direction to a light at a place is that from the middle of the scene, the middle of the
    smallest box around all `points`.
    """
    components = table.triple("direction", None)
    position = table.value("position", None)
    at_eye = position == "eye"
    falloff = _falloff(table)
    if position is None:
        if falloff:
            raise table.error("attenuation", "needs a position: a direction has no distance")
        if "place" in table.values:
            raise table.error("place", "needs a position")
    elif components is not None:
        raise table.error("direction", "and position cannot both be given")
    rule = table.choice("place", PLACE_RULES, "half")
    if at_eye:
        # The eye of the shading is at infinity, so the light has its direction everywhere. The
        # distance is measured from the eye; without one, from the point that is nearest to it.
        back, along = camera.axes[2], camera.projection == "orthographic"
        source = camera.eye if not along else back * float((points @ back).max())
        for key in ("relative_to", "place"):
            if key in table.values:
                raise table.error(key, "has no effect on a light at the eye")
        return back, Place(None, source, along, falloff)
    if position is not None:
        where = np.asarray(table.triple("position", None))
        if relative_to == "camera":
            where = camera.target + where @ camera.axes
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        away = where - middle
        length = float(np.linalg.norm(away))
        direction = away / length if length > 0 else camera.axes[2]
        return direction, Place(where, where, False, falloff, rule)
    if components is None:
        components, relative_to = DEFAULT_LIGHT, "camera"
    direction = np.asarray(components)
    if not np.any(direction):
        raise table.error("direction", "= [0, 0, 0] has no direction")
    direction = direction / np.max(np.abs(direction))
    if relative_to == "camera":
        direction = direction @ camera.axes
    return direction / np.linalg.norm(direction), Place()


def _falloff(table: _Table) -> Falloff | None:
    """The `attenuation` of a light; None without one."""
    value = table.value("attenuation", None)
    if value is None:
        return None
    inner = table.child("attenuation", value)
    if "distance" in inner.values or "values" in inner.values:
        distances = inner.list_of_reals("distance", 0.0)
        values = inner.list_of_reals("values", 0.0, 1.0)
        inner.finish()
        if len(distances) != len(values):
            raise table.error(
                "attenuation", f"{len(distances)} distances, but {len(values)} values"
            )
        if np.any(np.diff(distances) <= 0):
            raise inner.error("distance", f"= {_show(distances)} do not increase")
        return Falloff(tuple(distances), tuple(values))
    terms = [inner.real(key, default, 0.0) for key, default in
             (("constant", 1.0), ("linear", 0.0), ("quadratic", 0.0))]  # fmt: skip
    inner.finish()
    if not any(terms):
        raise table.error("attenuation", "has no term that is not 0")
    return Falloff(coefficients=(terms[0], terms[1], terms[2]))


def _show(value: object) -> str:
    """`value` on one line of at most 60 characters."""
    text = " ".join(repr(list(value) if isinstance(value, tuple) else value).split())
    return text if len(text) <= 60 else text[:57] + "..."


class _Table:
    """A table of a scene file: returns checked values and remembers which keys were read.

    `colour` is another spelling of the key `color`; messages show it as it is written.
    Every method raises InputError that names the file and the key if a value is wrong. Methods
    with a `default` return it if the key is missing.
    """

    def __init__(self, values: dict[str, Any], file: str, prefix: str = "") -> None:
        self.values, self.file, self.prefix = values, file, prefix
        self.known: set[str] = set()
        self.british = False  # whether the file has `colour` for `color`

    def where(self, key: str) -> str:
        """The file and the full name of `key`, for messages."""
        if self.british and key.startswith("color"):
            key = key.replace("color", "colour", 1)
        return f"{self.file}: {self.prefix}{key}".removesuffix(".")

    def error(self, key: str, message: str) -> InputError:
        """An InputError about `key`."""
        return InputError(f"{self.where(key)} {message}".replace(" : ", ": "))

    def value(self, key: str, default: object) -> Any:
        """The unchecked value of `key`."""
        self.known.add(key)
        if key == "color" and "colour" in self.values:
            if "color" in self.values:
                raise self.error("colour", "and color cannot both be given")
            self.values["color"], self.british = self.values.pop("colour"), True
        return self.values.get(key, default)

    def child(self, key: str, values: object) -> _Table:
        """`values` of `key` as a table."""
        if not isinstance(values, dict):
            raise self.error(key, f"= {_show(values)} is not a table")
        return _Table(values, self.file, f"{self.prefix}{key}.")

    def table(self, key: str) -> _Table:
        """The table `key`, empty if missing."""
        return self.child(key, self.value(key, {}))

    def tables_by_name(self, key: str) -> list[tuple[str, _Table]]:
        """(name, table) of every table [key.name]."""
        outer = self.table(key)
        return [(name, outer.child(name, value)) for name, value in outer.values.items()]

    def list_of_tables(self, key: str) -> list[_Table]:
        """The tables [[key]]."""
        value = self.value(key, [])
        if not isinstance(value, list):
            raise self.error(key, "is not a list of tables: write [[objects]]")
        return [self.child(f"{key}[{i}]", v) for i, v in enumerate(value)]

    def _number(self, key: str, value: object, low: float, high: float) -> float:
        if isinstance(value, bool) or not isinstance(value, (int, float)):
            raise self.error(key, f"= {_show(value)} is not a number")
        if not math.isfinite(value):
            raise self.error(key, f"= {value} is not finite")
        if not low <= value <= high:
            raise self.error(key, f"= {value:g} is outside [{low:g}, {high:g}]")
        return float(value)

    def real(
        self, key: str, default: Default, low: float = -1e30, high: float = 1e30
    ) -> float | Default:
        """A real number from `low` to `high`."""
        value = self.value(key, None)
        return default if value is None else self._number(key, value, low, high)

    def whole(self, key: str, default: int, low: int, high: int) -> int:
        """A whole number from `low` to `high`."""
        value = self.value(key, default)
        if type(value) is not int:
            raise self.error(key, f"= {_show(value)} is not a whole number")
        return int(self._number(key, value, low, high))

    def list_of_reals(self, key: str, low: float = -1e30, high: float = 1e30) -> list[float]:
        """A list of at least one real number from `low` to `high`."""
        value = self.value(key, None)
        if not isinstance(value, list) or not value:
            raise self.error(key, f"= {_show(value)} is not a list of numbers")
        return [self._number(f"{key}[{i}]", v, low, high) for i, v in enumerate(value)]

    def triple(
        self, key: str, default: Default, low: float = -1e30, high: float = 1e30
    ) -> tuple[float, float, float] | Default:
        """Three real numbers from `low` to `high`."""
        if self.value(key, None) is None:
            return default
        values = self.list_of_reals(key, low, high)
        if len(values) != 3:
            raise self.error(key, f"= {_show(values)} does not have 3 numbers")
        return values[0], values[1], values[2]

    def boolean(self, key: str, default: bool) -> bool:
        """True or False."""
        value = self.value(key, default)
        if not isinstance(value, bool):
            raise self.error(key, f"= {_show(value)} is not true or false")
        return value

    def text(self, key: str, default: Default) -> str | Default:
        """A string."""
        value = self.value(key, None)
        if value is None:
            return default
        if not isinstance(value, str):
            raise self.error(key, f"= {_show(value)} is not a string")
        return value

    def choice(self, key: str, choices: tuple[str, ...], default: Default) -> str | Default:
        """One of the strings `choices`."""
        value = self.text(key, default)
        if value is not None and value != default and value not in choices:
            raise self.error(key, f"= {_show(value)} is not one of {', '.join(choices)}")
        return value

    def finish(self) -> None:
        """Raise InputError for the first key of the table that no method has read."""
        for key in self.values:
            if key not in self.known:
                close = difflib.get_close_matches(key, sorted(self.known), 1)
                hint = f"; did you mean {close[0]}?" if close else ""
                raise InputError(f"{self.where(key)}: unknown key{hint}")
