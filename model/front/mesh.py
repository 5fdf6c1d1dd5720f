# SPDX-License-Identifier: MIT
"""Triangle meshes: file input and the normal at every corner of every face.

A polygonal model knows normals "only at the vertices of polygons" (Phong 1975, "Specular
Reflection"). At a sharp edge a vertex needs one normal per adjacent surface. So this module stores
a normal per corner of a face, not per vertex.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from phong75.model.arrays import ArrayLike, Ints, Reals
from phong75.model.frame import InputError
from phong75.model.front import notes
from phong75.model.front.surface import Surface, Transformed

#: Supported mesh files, by suffix.
MESH_SUFFIXES = (".obj", ".ply", ".stl", ".glb", notes.OBJECT_SUFFIX)

#: Default crease angle, degrees: edges that bend by more than this stay sharp.
DEFAULT_CREASE = 60.0

#: A triangle is degenerate if twice its area divided by the square of its longest edge is at most
#: this. The normal of such a triangle would be rounding noise.
DEGENERATE_AREA = 1e-12

#: Largest magnitude of a coordinate. Products of larger coordinates could overflow float64.
MAX_COORDINATE = 1e60


@dataclass
class Mesh:
    """Triangles with a unit normal at every corner.

    vertices: float64[V, 3], scene units.
    faces: int64[F, 3], vertex indices, counter-clockwise seen from outside.
    normals: float64[F, 3, 3], unit length, outward, one per corner.
    degenerate: number of triangles that were dropped because they have no area.
    surface: the smooth surface with these corners and normals, where it is known.
    """

    vertices: Reals
    faces: Ints
    normals: Reals
    degenerate: int = 0
    surface: Surface | None = None

    def transformed(
        self,
        scale: ArrayLike = (1.0, 1.0, 1.0),
        rotate: ArrayLike = (0.0, 0.0, 0.0),
        translate: ArrayLike = (0, 0, 0),
    ) -> Mesh:
        """A new Mesh: this one scaled, then rotated, then translated.

        scale: a number or 3 (x, y, z). rotate: 3 angles in degrees about the fixed x, y and z
        axes, applied in this order. translate: 3 scene units. Normals are multiplied by the
        inverse transpose of the matrix. A mirroring scale also reverses the order of the vertices,
        so that faces stay counter-clockwise seen from outside.
        """
        scale = np.broadcast_to(np.asarray(scale, np.float64), 3)
        rotation = rotation_matrix(rotate)
        matrix = rotation * scale
        shift = np.asarray(translate, np.float64)
        vertices = apply_matrix(matrix, self.vertices) + shift
        normals = normalize(apply_matrix(rotation / scale, self.normals))
        faces = self.faces
        if np.prod(scale) < 0:
            faces, normals = faces[:, ::-1], normals[:, ::-1]
        surface = self.surface and Transformed(self.surface, matrix, shift)
        return Mesh(vertices, faces, normals, self.degenerate, surface)

    def faceted(self) -> Mesh:
        """A new Mesh with the normal of its face at every corner: flat shading by constant normals
        (Starkey, "Shading Techniques", section 1)."""
        normals = np.repeat(face_normals(self.vertices, self.faces)[:, None], 3, axis=1)
        return Mesh(self.vertices, self.faces, normals, self.degenerate)

    def with_crease(self, crease: float) -> Mesh:
        """A new Mesh with normals computed from the faces (see `corner_normals`)."""
        normals = corner_normals(self.vertices, self.faces, crease)
        return Mesh(self.vertices, self.faces, normals, self.degenerate)


def normalize(vectors: Reals) -> Reals:
    """`vectors` (float64[..., 3]) scaled to unit length; the zero vector stays zero."""
    # The largest component is scaled to 1 first, so that squares neither overflow nor underflow.
    largest = np.max(np.abs(vectors), axis=-1, keepdims=True)
    vectors = vectors / np.where(largest > 0, largest, 1.0)
    length = np.sqrt(np.sum(vectors * vectors, axis=-1, keepdims=True))
    return vectors / np.where(length > 0, length, 1.0)


def apply_matrix(matrix: Reals, vectors: Reals) -> Reals:
    """`matrix` (float64[3, 3]) times each of `vectors` (float64[..., 3]).

    The product is written out by component because a BLAS product may round equal vectors
    differently depending on their position in the array. Copies of a vertex must stay equal, or
    cracks open between triangles.
    """
    x, y, z = vectors[..., 0], vectors[..., 1], vectors[..., 2]
    return np.stack([row[0] * x + row[1] * y + row[2] * z for row in matrix], axis=-1)


def rotation_matrix(degrees: ArrayLike) -> Reals:
    """Rotation matrix float64[3, 3]: about the fixed x, then y, then z axis by `degrees` (3)."""
    (cx, cy, cz), (sx, sy, sz) = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    about_x = np.array([[1, 0, 0], [0, cx, -sx], [0, sx, cx]])
    about_y = np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]])
    about_z = np.array([[cz, -sz, 0], [sz, cz, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


def face_normals(vertices: Reals, faces: Ints) -> Reals:
    """Unit normals of the faces, float64[F, 3]; zero for degenerate faces.

    vertices: float64[V, 3]. faces: int64[F, 3].
    """
    a, b, c = (vertices[faces[:, i]] for i in range(3))
    longest = np.max(np.abs(np.stack([b - a, c - b, a - c])), axis=(0, 2))[:, None]
    longest = np.where(longest > 0, longest, 1.0)
    cross = np.cross((b - a) / longest, (c - a) / longest)
    area = np.sqrt(np.sum(cross * cross, axis=1, keepdims=True))
    return np.where(area > DEGENERATE_AREA, normalize(cross), 0.0)


def corner_normals(vertices: Reals, faces: Ints, crease: float) -> Reals:
    """Unit normals of all corners, float64[F, 3, 3], computed from the faces alone.

    The normal at a corner is the weighted mean of the normals of the faces around its vertex. Only
    faces that are connected to the corner's face across edges that bend by at most `crease`
    degrees count (Starkey, "Shading Techniques", section 3: average only what should appear
    smoothly connected). `crease` = 0 gives flat faces, 180 smooths every edge. The weight of a
    face is its angle at the vertex (Thuermer and Wuethrich 1998), so that the mean does not
    depend on how polygons were cut into triangles. Vertices with equal coordinates are treated as
    one vertex.
    """
    flat = face_normals(vertices, faces)
    welded = weld(vertices)[faces]
    group = _smooth_groups(welded, flat, np.cos(np.radians(crease)))
    weight = _corner_angles(vertices, faces)
    total = np.empty((group.size, 3))
    for axis in range(3):
        share = (weight * flat[:, None, axis]).reshape(-1)
        total[:, axis] = np.bincount(group, weights=share, minlength=group.size)
    mean = normalize(total[group]).reshape(-1, 3, 3)
    # Normals of opposite faces can cancel out. Such a corner takes the normal of its face.
    cancelled = np.sum(total[group] ** 2, axis=1).reshape(-1, 3) < 1e-20
    return np.where(cancelled[..., None], flat[:, None, :], mean)


def weld(vertices: Reals) -> Ints:
    """A label for each of `vertices` (float64[V, 3]), int64[V]; equal coordinates, equal label."""
    order = np.lexsort(vertices.T)
    differs = np.any(np.diff(vertices[order], axis=0) != 0, axis=1)
    label = np.empty(len(vertices), np.int64)
    label[order] = np.concatenate([[0], np.cumsum(differs)])
    return label


def _corner_angles(vertices: Reals, faces: Ints) -> Reals:
    """Angle of each face at each of its corners, float64[F, 3], radians."""
    corners = vertices[faces]
    ahead = normalize(np.roll(corners, -1, axis=1) - corners)
    behind = normalize(np.roll(corners, 1, axis=1) - corners)
    return np.arccos(np.clip(np.sum(ahead * behind, axis=-1), -1.0, 1.0))


def _smooth_groups(welded: Ints, flat: Reals, min_cosine: float) -> Ints:
    """A label for each corner, int64[3 F], equal where corners share a normal.

    welded: int64[F, 3], welded vertices of the faces. flat: float64[F, 3], normals of the faces.
    min_cosine: cosine of the crease angle. Two corners at a vertex are linked if their faces share
    an edge that is not a crease. The groups are the connected components of the links.
    """
    count = len(welded)
    start, end = welded, np.roll(welded, -1, axis=1)  # edge k of a face: from corner k to k + 1
    corner = np.arange(3 * count).reshape(count, 3)
    low = np.minimum(start, end).reshape(-1)
    high = np.maximum(start, end).reshape(-1)
    swapped = (start > end).reshape(-1)
    next_corner = np.roll(corner, -1, axis=1).reshape(-1)
    at_low = np.where(swapped, next_corner, corner.reshape(-1))
    at_high = np.where(swapped, corner.reshape(-1), next_corner)

    order = np.lexsort((high, low))
    first, second = order[:-1], order[1:]
    same_edge = (low[first] == low[second]) & (high[first] == high[second])
    first, second = first[same_edge], second[same_edge]
    cosine = np.sum(flat[first // 3] * flat[second // 3], axis=1)
    smooth = cosine >= min_cosine - 1e-12
    first, second = first[smooth], second[smooth]
    a = np.concatenate([at_low[first], at_high[first]])
    b = np.concatenate([at_low[second], at_high[second]])

    label = np.arange(3 * count)
    while True:  # spread the smaller label over each link, then follow labels to their root
        least = np.minimum(label[a], label[b])
        spread = label.copy()
        np.minimum.at(spread, label[a], least)
        np.minimum.at(spread, label[b], least)
        while np.any(spread[spread] != spread):
            spread = spread[spread]
        if np.array_equal(spread, label):
            return label
        label = spread


def make_mesh(
    where: str,
    vertices: ArrayLike,
    faces: ArrayLike,
    normals: ArrayLike | None = None,
    crease: float | None = None,
) -> Mesh:
    """Check raw arrays and make a Mesh of them.

    where: name of the mesh in error messages. vertices: [V, 3]. faces: [F, 3]. normals: [F, 3, 3]
    of any length, or None. crease: if given (degrees), all normals are computed from the faces;
    else given normals are kept and missing ones are computed with `DEFAULT_CREASE`. Degenerate
    triangles are dropped and counted. Raises InputError if the arrays are not a mesh.
    """
    vertices = np.asarray(vertices, np.float64).reshape(-1, 3)
    faces = np.asarray(faces, np.int64).reshape(-1, 3)
    if len(faces) == 0:
        raise InputError(f"{where}: the mesh has no faces")
    outside = (faces < 0) | (faces >= len(vertices))
    if outside.any():
        face, corner = np.argwhere(outside)[0]
        raise InputError(
            f"{where}: face {face} refers to vertex {faces[face, corner]}, "
            f"but there are {len(vertices)} vertices"
        )
    bad = ~np.isfinite(vertices).all(axis=1)
    if bad.any():
        index = int(np.argmax(bad))
        text = ", ".join(f"{v:g}" for v in vertices[index])
        raise InputError(f"{where}: vertex {index} = ({text}) is not finite")
    if np.max(np.abs(vertices)) > MAX_COORDINATE:
        raise InputError(f"{where}: vertex coordinates exceed {MAX_COORDINATE:g}")

    flat = face_normals(vertices, faces)
    good = np.any(flat != 0, axis=1)
    if not good.any():
        raise InputError(f"{where}: all {len(faces)} triangles are degenerate (no area)")
    faces, flat = faces[good], flat[good]
    if normals is not None:
        normals = np.asarray(normals, np.float64)[good]
    if normals is None or crease is not None:
        normals = corner_normals(vertices, faces, DEFAULT_CREASE if crease is None else crease)
    else:
        usable = np.isfinite(normals).all(axis=-1) & np.any(normals != 0, axis=-1)
        normals = normalize(np.where(usable[..., None], normals, flat[:, None, :]))
    return Mesh(vertices, faces, normals, int(np.count_nonzero(~good)))


def load_mesh(path: str | Path, crease: float | None = None) -> Mesh:
    """Read an OBJ, PLY, STL or GLB file through trimesh; all parts of the file become one Mesh.

    Normals of the file are kept unless `crease` (degrees) is given. Files without corner normals
    (every STL file) get normals from `corner_normals`. A mesh whose faces are clockwise is
    reversed: clockwise by the file's normals or, without normals, by a negative volume of a closed
    mesh. Raises InputError that names the file.
    """
    path = Path(path)
    if path.suffix.lower() not in MESH_SUFFIXES:
        raise InputError(f"{path}: not a mesh file ({', '.join(MESH_SUFFIXES)})")
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    vertices, faces, normals = _read_parts(path)
    keep_normals = crease is None and normals is not None
    mesh = make_mesh(str(path), vertices, faces, normals, crease)
    flat = face_normals(mesh.vertices, mesh.faces)
    if keep_normals:
        agreement = np.sum(flat[:, None, :] * mesh.normals)
        if agreement < 0:
            mesh = Mesh(mesh.vertices, mesh.faces[:, ::-1], mesh.normals[:, ::-1], mesh.degenerate)
    elif is_closed(mesh) and _volume(mesh) < 0:
        mesh = Mesh(mesh.vertices, mesh.faces[:, ::-1], -mesh.normals[:, ::-1], mesh.degenerate)
    return mesh


def is_closed(mesh: Mesh) -> bool:
    """Whether `mesh` is a closed surface: each edge belongs to two faces, once per direction.

    Such a surface has one winding everywhere, so that no back face is visible from outside.
    """
    return _directed_edges(mesh)[1]


def is_consistent(mesh: Mesh) -> bool:
    """Whether the faces of `mesh` have one winding: no directed edge occurs twice."""
    return _directed_edges(mesh)[0]


def _directed_edges(mesh: Mesh) -> tuple[bool, bool]:
    """(is_consistent, is_closed) of `mesh`."""
    welded = weld(mesh.vertices)[mesh.faces]
    start, end = welded.reshape(-1), np.roll(welded, -1, axis=1).reshape(-1)
    size = int(welded.max()) + 1
    forward = np.sort(start * size + end)
    consistent = bool(np.all(np.diff(forward) != 0))
    return consistent, consistent and np.array_equal(forward, np.sort(end * size + start))


def _volume(mesh: Mesh) -> float:
    """Signed volume of a closed `mesh`, scene units cubed; negative if its faces are clockwise."""
    centre = np.mean(mesh.vertices, axis=0)
    a, b, c = (mesh.vertices[mesh.faces[:, i]] - centre for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def _read_parts(path: Path) -> tuple[Reals, Ints, Reals | None]:
    """Vertices [V, 3], faces [F, 3] and corner normals [F, 3, 3] (or None) of a file.

    The parts of the file are transformed to scene coordinates and joined. Raises InputError.
    """
    if path.suffix.lower() == notes.OBJECT_SUFFIX:
        return *notes.triangles(notes.read_object(path)), None
    import trimesh  # here because the import takes a third of a second; scenes of shapes skip it

    try:
        if path.suffix.lower() == ".obj":
            _check_obj_indices(path)
        scene = trimesh.load_scene(
            str(path), process=False, maintain_order=True, skip_materials=True
        )
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None
    except IndexError as error:
        raise InputError(f"{path}: index out of range, or cut short: {_line(error)}") from None
    except Exception as error:  # trimesh's readers pass on any exception of their libraries
        raise InputError(f"{path}: not a readable mesh: {_line(error)}") from None

    all_vertices, all_faces, all_normals, offset = [], [], [], 0
    for node in sorted(scene.graph.nodes_geometry):
        matrix, name = scene.graph.get(node)
        part = scene.geometry[name]
        if not isinstance(part, trimesh.Trimesh):
            continue  # points or lines
        vertices, faces = np.asarray(part.vertices), np.asarray(part.faces)
        linear, shift = matrix[:3, :3], matrix[:3, 3]
        in_range = len(faces) and faces.min() >= 0 and faces.max() < len(vertices)
        if not in_range:
            return vertices, faces, None  # `make_mesh` raises the error
        # Without normals in the file, trimesh would compute some. Only the file's are wanted.
        from_file = "vertex_normals" in part._cache
        normals = np.asarray(part.vertex_normals)[faces] if from_file else None
        if not np.array_equal(matrix, np.eye(4)):
            vertices = apply_matrix(linear, vertices) + shift
            if normals is not None:
                inverse = np.asarray(np.linalg.inv(linear), np.float64)
                normals = normalize(apply_matrix(inverse.T, normals))
            if np.linalg.det(linear) < 0:
                faces = faces[:, ::-1]
                normals = None if normals is None else normals[:, ::-1]
        all_vertices.append(vertices)
        all_faces.append(faces + offset)
        all_normals.append(normals)
        offset += len(vertices)
    if not all_faces:
        raise InputError(f"{path}: the mesh has no faces")
    vertices, faces = np.concatenate(all_vertices), np.concatenate(all_faces)
    given = [n for n in all_normals if n is not None]
    if not given:
        return vertices, faces, None
    if len(given) < len(all_normals):  # some parts have no normals: compute theirs
        computed = corner_normals(vertices, faces, DEFAULT_CREASE)
        pieces = np.split(computed, np.cumsum([len(f) for f in all_faces])[:-1])
        given = [c if n is None else n for c, n in zip(pieces, all_normals, strict=True)]
    return vertices, faces, np.concatenate(given)


def _check_obj_indices(path: Path) -> None:
    """Raise InputError for an index 0 in an OBJ file, which trimesh reads as the last vertex.

    Indices of OBJ start at 1, or count backwards from -1.
    """
    zero = re.search(rb"^f[ \t](?:[^\n]*[ \t])?[-+]?0+(?![\d.])[^\n]*", path.read_bytes(), re.M)
    if zero:
        text = zero.group().decode(errors="replace").strip()
        raise InputError(f"{path}: index out of range: '{text}' (the first vertex of OBJ is 1)")


def _line(error: Exception) -> str:
    """The message of `error` on one line."""
    return " ".join(str(error).split()) or type(error).__name__
