# SPDX-License-Identifier: MIT
"""From a mesh file to triangles with normals and materials, and the report of what was decided."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from phong75.model.arrays import Flags, Ints, Reals
from phong75.model.frame import InputError
from phong75.model.front.mesh import Mesh
from phong75.model.front.mesh_files.checks import (
    GROUP_MARK,
    TESTED_SUFFIXES,
    UNTESTED_SUFFIXES,
    Prepared,
    diagnose_obj,
    prepare,
)
from phong75.model.front.mesh_files.library import FileContents, read_file
from phong75.model.front.mesh_files.materials import (
    AMBIENT_SHARE,
    FileMaterial,
    Materials,
    file_material,
)
from phong75.model.front.mesh_files.report import MeshReport
from phong75.model.front.mesh_normals import (
    DEFAULT_CREASE,
    corner_normals_of,
    normals_and_areas,
)
from phong75.model.front.mesh_topology import Edges, bodies, weld
from phong75.model.front.vectors import apply_matrix, normalize

#: All suffixes of files that the library opens.
MESH_SUFFIXES = (*TESTED_SUFFIXES, *UNTESTED_SUFFIXES)

#: The axis that points up; "y (guess)" for other suffixes. STL is the format of 3D printing.
UP_AXES = {".stl": "z (guess)", ".glb": "y (as glTF prescribes)", ".gltf": "y (as glTF prescribes)"}

#: Colours of vertices are told apart in steps of 1/255, which is what most files store.
COLOUR_STEPS = 255


@dataclass
class LoadedMesh:
    """A mesh of a file.

    mesh: its triangles. material: int64[F], index in `materials`, or -1 where the file has none.
    two_sided: bool[F], triangles to show from both sides. report: what was decided.
    """

    mesh: Mesh
    material: Ints
    materials: Materials
    two_sided: Flags
    report: MeshReport


@dataclass
class _Soup:
    """The triangles of all placed parts: vertices float64[V, 3], faces int64[F, 3], normals
    float64[F, 3, 3] or None (zero vectors where a part has none), colours float64[F, 3] or None
    (-1 where a part has none), material int64[F], of the file; parts: how many were placed."""

    vertices: Reals
    faces: Ints
    normals: Reals | None
    colours: Reals | None
    material: Ints
    parts: int


def load_mesh(path: str | Path, crease: float | None = None) -> Mesh:
    """The triangles of a mesh file. Arguments and errors as for `load_mesh_file`."""
    return load_mesh_file(path, crease).mesh


def load_mesh_file(path: str | Path, crease: float | None = None) -> LoadedMesh:
    """Read a mesh file; all parts of the file become one mesh.

    Normals of the file are kept unless `crease` (degrees) is given; the file's smoothing groups
    come second, `DEFAULT_CREASE` last. Each connected body gets one winding: that of its normals,
    else that of most of its faces; a closed body is wound so that its volume is positive. Raises
    InputError that names the file.
    """
    path = Path(path)
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise InputError(f"{path}: not a mesh file ({', '.join(TESTED_SUFFIXES)})")
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    prepared = prepare(path)
    contents = read_file(path, prepared)
    suffix = path.suffix.lower()
    if suffix == ".stl":  # its normals are those of the faces
        for part in contents.parts:
            part.normals = None
    if suffix == ".obj":
        _check_obj(path, prepared, contents)
    soup = _place(path, contents)
    report = MeshReport(
        path.name,
        0,
        soup.parts,
        up=UP_AXES.get(suffix, "y (guess)"),
        unit="metre" if suffix in (".glb", ".gltf") else "none given",
        unused=prepared.unused + [u for u in contents.unused if not _named(u, prepared.unused)],
        notes=list(prepared.notes),
    )
    if contents.other:
        report.unused.append(f"{contents.other} points and lines")
    report.notes += [f"{Path(name).name} is not there" for name in contents.missing
                     if Path(name).suffix.lower() == ".mtl"]  # fmt: skip
    if suffix != ".obj":
        report.unused_vertices = _unused_vertices(contents)
    else:
        report.unused_vertices = None

    vertices, faces = _weld(soup)
    flat, area = normals_and_areas(vertices, faces)
    good = area > 0
    if not good.any():
        raise InputError(f"{path}: all {len(faces)} triangles are degenerate (no area)")
    normals, colours, material = soup.normals, soup.colours, soup.material
    if not good.all():
        faces, flat, area, material = faces[good], flat[good], area[good], material[good]
        normals = None if normals is None else normals[good]
        colours = None if colours is None else colours[good]
    report.degenerate_triangles = int(np.count_nonzero(~good))
    report.triangles = len(faces)

    edges = Edges.of(faces)
    turned, open_mixed, twisted = _winding(vertices, faces, edges, flat, area, normals, report)
    if turned.any():
        faces = np.where(turned[:, None], faces[:, ::-1], faces)
        flat = np.where(turned[:, None], -flat, flat)
        normals = (
            None if normals is None else np.where(turned[:, None, None], normals[:, ::-1], normals)
        )
        edges = Edges.of(faces)

    files_materials, groups = _file_materials(contents, prepared, suffix)
    smoothing = groups[material] if prepared.smoothing and crease is None else None
    mesh_normals = _normals(vertices, faces, flat, area, edges, normals, crease, smoothing, report)
    two_sided = _two_sided(files_materials, material, open_mixed, twisted, report)
    index, materials = _materials(files_materials, material, colours, suffix, report)
    mesh = Mesh(vertices, faces, mesh_normals, report.degenerate_triangles)
    return LoadedMesh(mesh, index, materials, two_sided, report)


def _check_obj(path: Path, prepared: Prepared, contents: FileContents) -> None:
    """Raise InputError if Assimp dropped something of an OBJ file because of a wrong index.

    Assimp leaves out a normal that is not there, and makes a point of a face with such a texture
    vertex. The search for the place takes long; only a file with traces of this is searched.
    """
    lost = any(
        part.normals is None or not np.any(part.normals, axis=1).all() for part in contents.parts
    )
    if (contents.other and not prepared.lines) or (prepared.normals and lost):
        place = diagnose_obj(path)
        if place:
            raise InputError(f"{path}: {place}")


def _named(text: str, others: list[str]) -> bool:
    """Whether one of `others` names the same thing: the last word but for its plural."""
    words = {"textures": "texture", "skins": "skin", "morph": "morph", "animations": "animation"}
    key = words.get(text.split()[0], text)
    return any(key in other for other in others)


def _unused_vertices(contents: FileContents) -> int:
    """The number of vertices that no triangle of their part uses."""
    return sum(
        len(part.vertices) - int(np.count_nonzero(_used(part.vertices, part.faces)))
        for part in contents.parts
        if len(part.faces)
    )


def _used(vertices: Reals, faces: Ints) -> Flags:
    """Which of `vertices` (float[V, 3]) belong to one of `faces` (int64[F, 3]): bool[V]."""
    used = np.zeros(len(vertices), bool)
    used[faces.reshape(-1)] = True
    return used


def _joined(pieces: list[NDArray[Any]]) -> NDArray[Any]:
    """All of `pieces` in one array; the only piece itself if there is one."""
    return pieces[0] if len(pieces) == 1 else np.concatenate(pieces)


def _place(path: Path, contents: FileContents) -> _Soup:
    """The parts of a file where its nodes put them. Raises InputError."""
    if not contents.nodes:
        raise InputError(f"{path}: the mesh has no faces")
    with_normals = any(contents.parts[i].normals is not None for _, i in contents.nodes)
    with_colours = any(contents.parts[i].colours is not None for _, i in contents.nodes)
    all_vertices, all_faces, all_normals, all_colours, all_materials = [], [], [], [], []
    offset = 0
    for matrix, index in contents.nodes:
        part = contents.parts[index]
        vertices = part.vertices.astype(np.float64)
        _check_vertices(path, vertices, part.faces)
        faces = part.faces.astype(np.int64)
        linear = matrix[:3, :3]
        moved = not np.array_equal(matrix, np.eye(4))
        mirrored = moved and np.linalg.det(linear) < 0
        if moved:
            if not np.isfinite(matrix).all():
                raise InputError(f"{path}: the matrix of a node is not finite")
            vertices = apply_matrix(linear, vertices) + matrix[:3, 3]
        if mirrored:
            faces = faces[:, ::-1]
        all_vertices.append(vertices)
        all_faces.append(faces + offset if offset else faces)
        all_materials.append(np.full(len(faces), part.material, np.int64))
        if with_normals:
            if part.normals is None:
                all_normals.append(np.zeros((len(faces), 3, 3)))
            else:
                normals = part.normals.astype(np.float64)
                if moved:  # the cofactors are the inverse transpose times the determinant
                    rows = linear[[1, 2, 0]], linear[[2, 0, 1]]
                    cofactors = np.cross(*rows) * (-1.0 if mirrored else 1.0)
                    normals = apply_matrix(cofactors, normals)
                all_normals.append(normals[faces])
        if with_colours:
            if part.colours is None:
                all_colours.append(np.full((len(faces), 3), -1.0))
            else:
                all_colours.append(part.colours[faces].astype(np.float64).mean(axis=1))
        offset += len(vertices)
    return _Soup(
        _joined(all_vertices),
        _joined(all_faces),
        _joined(all_normals) if with_normals else None,
        _joined(all_colours) if with_colours else None,
        _joined(all_materials),
        len(contents.nodes),
    )


def _check_vertices(path: Path, vertices: Reals, faces: Ints) -> None:
    """Raise InputError if a vertex of a face is not finite."""
    if not np.isfinite(vertices).all():
        bad = ~np.isfinite(vertices).all(axis=1)
        used = _used(vertices, faces)
        if (bad & used).any():
            place = diagnose_obj(path) if path.suffix.lower() == ".obj" else None
            index = int(np.argmax(bad & used))
            text = ", ".join(f"{v:g}" for v in vertices[index])
            raise InputError(f"{path}: {place or f'vertex {index} = ({text}) is not finite'}")


def _weld(soup: _Soup) -> tuple[Reals, Ints]:
    """Vertices float64[V, 3] and faces int64[F, 3] with one vertex per point, all of them used."""
    vertices, faces = soup.vertices, soup.faces
    used = _used(vertices, faces)
    if not used.all():
        faces = (np.cumsum(used) - 1)[faces]
        vertices = vertices[used]
    label, first = weld(vertices)
    if len(first) == len(vertices):
        return vertices, faces
    return vertices[first], label[faces]


def _winding(
    vertices: Reals, faces: Ints, edges: Edges, flat: Reals, area: Reals, normals: Reals | None,
    report: MeshReport,
) -> tuple[Flags, Flags, Flags]:  # fmt: skip
    """Which faces to turn round, which are of open bodies whose faces disagreed, and which are of
    bodies without two sides: bool[F] each."""
    parts = bodies(faces, edges)
    body, turned = parts.body, parts.turned
    count = len(faces)
    sign = np.where(turned, -1.0, 1.0)
    decided = np.zeros(count, bool)  # bodies whose normals tell which side is outside
    reverse: Flags = np.zeros(count, bool)
    if normals is not None:
        agreement = area * sign * np.sum(flat[:, None, :] * normals, axis=(1, 2))
        agreement = np.where(np.isfinite(agreement), agreement, 0.0)
        decided = np.bincount(body, np.abs(agreement), count) > 0
        reverse = np.bincount(body, agreement, count) < 0
    # A body is closed if none of its edges is a border, or shared by more than two faces.
    single = np.repeat(edges.uses != 2, edges.uses)
    is_open = np.zeros(count, bool)
    is_open[body[edges.half[single] // 3]] = True
    is_open[body[parts.twisted]] = True
    closed = ~is_open & ~decided
    if closed[body].any():
        origin = vertices[faces[body, 0]]
        a, b, c = (vertices[faces[:, i]] - origin for i in range(3))
        triple = (
            a[:, 0] * (b[:, 1] * c[:, 2] - b[:, 2] * c[:, 1])
            + a[:, 1] * (b[:, 2] * c[:, 0] - b[:, 0] * c[:, 2])
            + a[:, 2] * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
        )
        volume = np.bincount(body, sign * triple, count)
        reverse = np.where(closed, volume < 0, reverse)
    turned = turned ^ reverse[body]

    members = np.bincount(body, minlength=count)
    mixed = np.bincount(body, parts.turned, count) > 0
    report.bodies = int(np.count_nonzero(members))
    report.bodies_turned = int(np.count_nonzero(reverse))
    report.faces_turned = int(np.count_nonzero(parts.turned))
    open_mixed = (mixed & is_open & ~decided)[body]
    return turned, open_mixed, parts.twisted


def _normals(
    vertices: Reals, faces: Ints, flat: Reals, area: Reals, edges: Edges, normals: Reals | None,
    crease: float | None, smoothing: Ints | None, report: MeshReport,
) -> Reals:  # fmt: skip
    """The unit normals of all corners, float64[F, 3, 3]: the file's, else made here."""
    if normals is not None and crease is None:
        usable = np.isfinite(normals).all(axis=-1) & np.any(normals != 0, axis=-1)
        missing = int(np.count_nonzero(~usable))
        if missing < usable.size:
            report.normals, report.corners_made = "of the file", missing
            normals = normalize(np.where(usable[..., None], normals, 0.0))
            if not missing:
                return normals
            made = corner_normals_of(vertices, faces, flat, area, edges, DEFAULT_CREASE, smoothing)
            report.crease = DEFAULT_CREASE
            return np.where(usable[..., None], normals, made)
    angle = DEFAULT_CREASE if crease is None else crease
    report.corners_made, report.crease = 3 * len(faces), angle
    report.normals = f"made here, crease {angle:g} degrees"
    if smoothing is not None:
        report.normals = "made here, by the smoothing groups of the file"
        report.crease = None if (smoothing >= 0).all() else angle
    return corner_normals_of(vertices, faces, flat, area, edges, angle, smoothing)


def _file_materials(
    contents: FileContents, prepared: Prepared, suffix: str
) -> tuple[list[FileMaterial], Ints]:
    """The materials of a file, and the smoothing group of each in an OBJ file, -1 for none."""
    said_by_name = {m.get("?mat.name"): m for m in contents.materials}
    result, groups = [], []
    for index, said in enumerate(contents.materials):
        name, mark, group = str(said.get("?mat.name", "")).partition(GROUP_MARK)
        groups.append(int(group) if mark else -1)
        if mark:
            said = said_by_name.get(name, said | {"?mat.name": name})
        known = prepared.materials is None or index < prepared.materials
        defined = known and name != "DefaultMaterial"
        result.append(file_material(said, defined, suffix in (".glb", ".gltf")))
    return result, np.array(groups or [-1], np.int64)


def _two_sided(
    materials: list[FileMaterial], material: Ints, open_mixed: Flags, twisted: Flags,
    report: MeshReport,
) -> Flags:  # fmt: skip
    """Which triangles to show from both sides, bool[F], with the reasons in the report."""
    by_file = np.array([m.two_sided for m in materials] or [False])[material]
    reasons = [
        (by_file, "the file says so"),
        (open_mixed, "an open surface whose triangles are wound both ways"),
        (twisted, "a surface that has only one side"),
    ]
    report.two_sided_why = [why for which, why in reasons if which.any()]
    result = by_file | open_mixed | twisted
    report.two_sided = int(np.count_nonzero(result))
    return result


def _materials(
    materials: list[FileMaterial], material: Ints, colours: Reals | None, suffix: str,
    report: MeshReport,
) -> tuple[Ints, Materials]:  # fmt: skip
    """The material of each triangle, int64[F] (-1: none), and the materials of the file."""
    defined = np.array([m.defined for m in materials] or [False])
    base = np.array([m.colour for m in materials] or [(1.0, 1.0, 1.0)])
    in_use = np.unique(material)
    undefined = {materials[i].name for i in in_use if i < len(materials) and not defined[i]}
    undefined -= {"", "DefaultMaterial"}
    report.notes += [f"material {name} is not defined" for name in sorted(undefined)]
    seen = [materials[i] for i in in_use if defined[i]]
    transparent = sum(m.opacity < 1.0 for m in seen)
    if transparent:
        report.unused.append(f"transparency of {transparent} material{'s' * (transparent > 1)}")
    if any(m.clipped for m in seen):
        clipped = sum(m.clipped for m in seen)
        report.notes.append(
            f"n of {clipped} material{'s' * (clipped > 1)} limited to the range 1 to 128"
        )

    key = np.where(defined[material], material, -1) + 1
    if colours is not None:
        coloured = colours[:, 0] >= 0
        multiply = suffix in (".glb", ".gltf")
        shade = colours * np.where(defined[material, None], base[material], 1.0) * multiply
        shade = shade + colours * (not multiply)
        shade = np.nan_to_num(np.clip(shade, 0.0, 1.0))
        code = np.rint(shade * COLOUR_STEPS).astype(np.int64) @ np.array([1 << 16, 1 << 8, 1])
        key = key | np.where(coloured, code + 1, 0) << 32
    kinds, index = np.unique(key, return_inverse=True)
    code, which = (kinds >> 32) - 1, (kinds & 0xFFFFFFFF) - 1
    own = [materials[i] if i >= 0 else None for i in which]
    colour = np.where(
        code[:, None] >= 0,
        (code[:, None] >> np.array([16, 8, 0]) & 255) / COLOUR_STEPS,
        base[np.maximum(which, 0)],
    )
    table = Materials.of(
        colour,
        np.full(len(kinds), AMBIENT_SHARE),
        [m.n if m else 10.0 for m in own],
        [m.w if m else 0.4 for m in own],
    )
    nothing = (code < 0) & (which < 0)  # the first kind, if it occurs at all
    index = index.reshape(-1) - int(nothing.any())
    table = table.take(np.flatnonzero(~nothing))
    report.materials = len(table)
    return index, table
