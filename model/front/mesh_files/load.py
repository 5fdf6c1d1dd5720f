# SPDX-License-Identifier: MIT
"""From a mesh file to triangles with normals and materials, and the report of what was decided."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from contextvars import copy_context
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from phong75.model.arrays import Flags, Ints, Reals
from phong75.model.frame import InputError
from phong75.model.front import notes
from phong75.model.front.mesh import Mesh
from phong75.model.front.mesh_files.checks import (
    GROUP_MARK,
    TESTED_SUFFIXES,
    UNTESTED_SUFFIXES,
    Prepared,
    diagnose_obj,
    prepare,
)
from phong75.model.front.mesh_files.library import FileContents, Reading, read_file
from phong75.model.front.mesh_files.materials import (
    AMBIENT_SHARE,
    LEAST_N,
    MOST_N,
    FileMaterial,
    Materials,
    file_material,
)
from phong75.model.front.mesh_files.report import MeshReport
from phong75.model.front.mesh_normals import (
    DEFAULT_CREASE,
    Measures,
    corner_normals_of,
    measure,
)
from phong75.model.front.mesh_topology import Edges, bodies, weld
from phong75.model.front.vectors import apply_matrix, blocks, normalize

#: All suffixes of files that the library opens.
MESH_SUFFIXES = (*TESTED_SUFFIXES, *UNTESTED_SUFFIXES)

#: The axis that points up; "y (guess)" for other suffixes. STL is the format of 3D printing.
UP_AXES = {".stl": "z (guess)", ".glb": "y (as glTF prescribes)", ".gltf": "y (as glTF prescribes)"}

#: An OBJ file of more bytes than this is read while its text is looked at. Few such files turn out
#: to need a change, and are read once more.
LARGE_TEXT = 1_000_000

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
    """The triangles of all placed parts: vertices float[V, 3], faces int64[F, 3], normals of the
    vertices float[V, 3] or None (zero vectors where a part has none), colours of the vertices
    float[V, 3] or None (-1 where a part has none), material int64[F], of the file. Numbers stay in
    the file's 32 bits where no node moves them, which halves the memory."""

    vertices: Reals
    faces: Ints
    normals: Reals | None
    colours: Reals | None
    material: Ints


@dataclass
class _Surface:
    """Triangles with an area, and one vertex per point: vertices float64[V, 3], faces
    int64[F, 3], their measures and edges. soup: where they come from. corners: int64[F, 3], the
    vertices of `soup`, of which several may be one point, with a normal and a colour each."""

    vertices: Reals
    faces: Ints
    measures: Measures
    edges: Edges
    soup: _Soup
    corners: Ints
    material: Ints


def load_mesh(path: str | Path, crease: float | None = None) -> Mesh:
    """The triangles of a mesh file. Arguments and errors as for `load_mesh_file`."""
    return load_mesh_file(path, crease).mesh


@np.errstate(all="ignore")  # a file may hold any number; what comes of it is checked
def load_mesh_file(path: str | Path, crease: float | None = None) -> LoadedMesh:
    """Read a mesh file; all parts of the file become one mesh.

    Normals of the file are kept unless `crease` (degrees) is given; the file's smoothing groups
    come second, `DEFAULT_CREASE` last. Each connected body gets one winding: that of its normals,
    else that of most of its faces; a closed body is wound so that its volume is positive. Raises
    InputError that names the file.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in MESH_SUFFIXES:
        raise InputError(f"{path}: not a mesh file ({', '.join(TESTED_SUFFIXES)})")
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    if suffix == notes.OBJECT_SUFFIX:  # the library cuts its polygons, as it cuts those of OBJ
        content = notes.as_obj(notes.read_object(path))
        prepared = Prepared(len(content), content)
        contents = read_file(path.with_suffix(".obj"), prepared)
    elif suffix == ".obj" and path.stat().st_size > LARGE_TEXT:
        with Reading(path, path.stat().st_size) as reading:  # the other core looks at the text
            prepared = prepare(path)
            if prepared.content is None:
                contents = reading.result()
        if prepared.content is not None:
            contents = read_file(path, prepared)
    else:
        prepared = prepare(path)
        contents = read_file(path, prepared)
    if suffix == ".stl":  # its normals are those of the faces
        for part in contents.parts:
            part.normals = None
    if suffix == ".obj":
        _check_obj(path, prepared, contents)
    report = _report(path, prepared, contents)
    surface = _surface(path, _place(path, contents), report)
    files_materials, groups = _file_materials(contents, prepared, suffix)
    smoothing = groups[surface.material] if prepared.smoothing and crease is None else None
    open_mixed, twisted, normals = _wind_and_normals(surface, crease, smoothing, report)
    two_sided = _two_sided(files_materials, surface.material, open_mixed, twisted, report)
    index, materials = _materials(
        files_materials, surface.material, _face_colours(surface), suffix, report
    )
    mesh = Mesh(surface.vertices, surface.faces, normals, report.degenerate_triangles)
    return LoadedMesh(mesh, index, materials, two_sided, report)


def _report(path: Path, prepared: Prepared, contents: FileContents) -> MeshReport:
    """What can be said of a file before its triangles are looked at."""
    suffix = path.suffix.lower()
    report = MeshReport(
        path.name,
        0,
        len(contents.nodes),
        up=UP_AXES.get(suffix, "y (guess)"),
        unit="metre" if suffix in (".glb", ".gltf") else "none given",
        unused=prepared.unused + [u for u in contents.unused if not _named(u, prepared.unused)],
        notes=list(prepared.notes),
    )
    if contents.other:
        report.unused.append(
            f"{contents.other} {'points and lines' if contents.other > 1 else 'point or line'}"
        )
    names = dict.fromkeys(Path(name).name for name in contents.missing)
    missing = [name for name in names if name.lower().endswith(".mtl")]
    if len(missing) > 1:  # Assimp looks for one of the file's own name when the named one is lost
        missing = [name for name in missing if name != f"{path.stem}.mtl"]
    report.notes += [f"{name} is not there" for name in missing]
    # Assimp writes a vertex of OBJ once for each corner, so that unused ones are gone.
    report.unused_vertices = None if suffix == ".obj" else _unused_vertices(contents)
    return report


def _surface(path: Path, soup: _Soup, report: MeshReport) -> _Surface:
    """The triangles of `soup` that have an area, measured. Raises InputError if there are none."""
    vertices, faces = _weld(soup)
    with ThreadPoolExecutor(1) as other_core:
        later = other_core.submit(Edges.of, faces)
        measures = measure(vertices, faces)
        edges = later.result()
    good = measures.area > 0
    report.triangles = int(np.count_nonzero(good))
    report.degenerate_triangles = len(faces) - report.triangles
    if not report.triangles:
        which = "the only triangle is" if len(faces) == 1 else f"all {len(faces)} triangles are"
        raise InputError(f"{path}: {which} degenerate (no area)")
    if not report.degenerate_triangles:
        return _Surface(vertices, faces, measures, edges, soup, soup.faces, soup.material)
    faces = faces[good]
    return _Surface(
        vertices,
        faces,
        measures.take(good),
        Edges.of(faces),
        soup,
        soup.faces[good],
        soup.material[good],
    )


def _check_obj(path: Path, prepared: Prepared, contents: FileContents) -> None:
    """Raise InputError if Assimp dropped something of an OBJ file because of a wrong index.

    Assimp leaves out a normal that is not there, and makes a point of a face with such a texture
    vertex. The search for the place takes long; only a file with traces of this is searched.
    """
    lost = any(part.normals is None or not _not_zero(part.normals).all() for part in contents.parts)
    if (contents.other and not prepared.lines) or (prepared.normals and lost):
        place = diagnose_obj(path)
        if place:
            raise InputError(f"{path}: {place}")


def _not_zero(vectors: Reals) -> Flags:
    """Which of `vectors` (float[n, 3]) have a component that is not 0: bool[n]."""
    x, y, z = vectors.T
    return (x != 0) | (y != 0) | (z != 0)


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
        vertices = part.vertices
        _check_vertices(path, vertices, part.faces)
        faces = part.faces.astype(np.int64)
        linear = matrix[:3, :3]
        moved = not np.array_equal(matrix, np.eye(4))
        mirrored = moved and np.linalg.det(linear) < 0
        if moved:
            if not np.isfinite(matrix).all():
                raise InputError(f"{path}: the matrix of a node is not finite")
            vertices = apply_matrix(linear, vertices.astype(np.float64)) + matrix[:3, 3]
            _check_vertices(path, vertices, faces)
        if mirrored:
            faces = faces[:, ::-1]
        all_vertices.append(vertices)
        all_faces.append(faces + offset if offset else faces)
        all_materials.append(np.full(len(faces), part.material, np.int64))
        if with_normals:
            if part.normals is None:
                all_normals.append(np.zeros_like(vertices))
            else:
                normals = part.normals
                finite = np.isfinite(normals)
                if not finite.all():
                    normals = np.where(finite, normals, 0)
                if moved:  # the cofactors are the inverse transpose times the determinant
                    rows = linear[[1, 2, 0]], linear[[2, 0, 1]]
                    cofactors = np.cross(*rows) * (-1.0 if mirrored else 1.0)
                    normals = apply_matrix(cofactors, normals.astype(np.float64))
                all_normals.append(normals)
        if with_colours:
            if part.colours is None:
                all_colours.append(np.full((len(vertices), 3), -1.0))
            else:
                all_colours.append(part.colours.astype(np.float64))
        offset += len(vertices)
    return _Soup(
        _joined(all_vertices),
        _joined(all_faces),
        _joined(all_normals) if with_normals else None,
        _joined(all_colours) if with_colours else None,
        _joined(all_materials),
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
        return vertices.astype(np.float64), faces
    return vertices.take(first, axis=0).astype(np.float64), label.take(faces)


def _wind(surface: _Surface, report: MeshReport) -> tuple[Flags, Flags]:
    """Turn the faces of `surface` that are wound the wrong way.

    Returns which faces are of open bodies whose faces disagreed, and which are of bodies without
    two sides: bool[F] each.
    """
    vertices, faces, edges = surface.vertices, surface.faces, surface.edges
    parts = bodies(faces, edges)
    body, turned = parts.body, parts.turned
    count = len(faces)
    sign = np.where(turned, -1.0, 1.0)
    decided = np.zeros(count, bool)  # bodies whose normals tell which side is outside
    reverse: Flags = np.zeros(count, bool)
    if surface.soup.normals is not None:
        agreement = surface.measures.area * sign * _agreement(surface)
        decided = np.bincount(body, np.abs(agreement), count) > 0
        reverse = np.bincount(body, agreement, count) < 0
    # A body is closed if none of its edges is a border, or shared by more than two faces.
    is_open = np.zeros(count, bool)
    single = edges.uses != 2
    if single.any():
        is_open[body[edges.half[np.repeat(single, edges.uses)] // 3]] = True
    is_open[body[parts.twisted]] = True
    closed = ~is_open & ~decided
    if closed[body].any():
        corners = [np.ascontiguousarray(column) for column in faces.T]
        origin = corners[0].take(body)
        (ax, bx, cx), (ay, by, cy), (az, bz, cz) = (
            [column.take(corner) - column.take(origin) for corner in corners]
            for column in np.ascontiguousarray(vertices.T)
        )
        triple = ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        volume = np.bincount(body, sign * triple, count)
        reverse = np.where(closed, volume < 0, reverse)
    turned = turned ^ reverse[body]
    if turned.any():
        surface.faces = np.where(turned[:, None], faces[:, ::-1], faces)
        surface.measures = surface.measures.turned(turned)
        surface.edges = Edges.of(surface.faces)
        surface.corners = np.where(turned[:, None], surface.corners[:, ::-1], surface.corners)

    members = np.bincount(body, minlength=count)
    mixed = np.bincount(body, parts.turned, count) > 0
    report.bodies = int(np.count_nonzero(members))
    report.bodies_turned = int(np.count_nonzero(reverse))
    report.faces_turned = int(np.count_nonzero(parts.turned))
    return (mixed & is_open & ~decided)[body], parts.twisted


def _agreement(surface: _Surface) -> Reals:
    """The sum of the cosines between each triangle's normal and the file's normals of its corners,
    float64[F], times the length of the file's normals."""
    assert surface.soup.normals is not None
    columns = np.ascontiguousarray(surface.soup.normals.T)
    result = np.zeros(len(surface.corners))
    for block in blocks(len(result)):
        for column, flat in zip(columns, surface.measures.normal, strict=True):
            for corner in np.ascontiguousarray(surface.corners[block].T):
                result[block] += flat[block] * column.take(corner)
    return result


def _face_colours(surface: _Surface) -> Reals | None:
    """The mean colour of the corners of each triangle, float64[F, 3]; None without colours."""
    colours = surface.soup.colours
    return None if colours is None else colours.take(surface.corners, axis=0).mean(axis=1)


def _wind_and_normals(
    surface: _Surface, crease: float | None, smoothing: Ints | None, report: MeshReport
) -> tuple[Flags, Flags, Reals]:
    """What `_wind` returns, and the unit normals of all corners, float64[F, 3, 3]: the file's,
    else made here. The other core makes normals while this one winds the faces; they are made again
    if faces were turned."""
    angle = DEFAULT_CREASE if crease is None else crease
    given = None if crease is not None else surface.soup.normals
    usable = None if given is None else _not_zero(given)
    missing = surface.corners.size
    if usable is not None:
        missing = 0 if usable.all() else int(np.count_nonzero(~usable[surface.corners]))
    vertices, faces, measures, edges = (
        surface.vertices, surface.faces, surface.measures, surface.edges
    )  # fmt: skip

    def make() -> Reals:
        return corner_normals_of(vertices, faces, measures, edges, angle, smoothing)

    made: Reals = np.zeros((0, 3, 3))
    with ThreadPoolExecutor(1) as other_core:
        later = other_core.submit(copy_context().run, make) if missing else None
        wound = _wind(surface, report)
        if later:
            made = later.result()
    if missing and surface.faces is not faces:
        made = corner_normals_of(
            surface.vertices, surface.faces, surface.measures, surface.edges, angle, smoothing
        )
    report.corners_made = missing
    report.crease = angle if missing else None
    if given is not None and usable is not None and missing < surface.corners.size:
        report.normals = "of the file"
        normals = normalize(given).take(surface.corners, axis=0)
        if missing:
            normals = np.where(usable[surface.corners][..., None], normals, made)
        return *wound, normals
    report.normals = f"made here, crease {angle:g} degrees"
    if smoothing is not None:
        report.normals = "made here, by the smoothing groups of the file"
        report.crease = None if (smoothing >= 0).all() else angle
    return *wound, made


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


def _numbered(key: Ints) -> tuple[Ints, Ints]:
    """As `np.unique` of `key` (int64[n], 0 or more) with the inverse; small keys are not sorted."""
    if key.max() >= len(key):
        kinds, index = np.unique(key, return_inverse=True)
        return kinds, index.reshape(-1)
    there = np.bincount(key) > 0
    return np.flatnonzero(there), (np.cumsum(there) - 1).take(key)


def _materials(
    materials: list[FileMaterial], material: Ints, colours: Reals | None, suffix: str,
    report: MeshReport,
) -> tuple[Ints, Materials]:  # fmt: skip
    """The material of each triangle, int64[F] (-1: none), and the materials of the file."""
    defined = np.array([m.defined for m in materials] or [False])
    base = np.array([m.colour for m in materials] or [(1.0, 1.0, 1.0)])
    in_use = np.flatnonzero(np.bincount(material))
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
            f"n of {clipped} material{'s' * (clipped > 1)} limited to the range "
            f"{LEAST_N:g} to {MOST_N:g}"
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
    kinds, index = _numbered(key)
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
    index = index - int(nothing.any())
    table = table.take(np.flatnonzero(~nothing))
    report.materials = len(table)
    return index, table
