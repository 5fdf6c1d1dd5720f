# SPDX-License-Identifier: MIT
"""Triangle meshes with a normal at every corner of every face.

A polygonal model knows normals "only at the vertices of polygons" (Phong 1975, "Specular
Reflection"). At a sharp edge a vertex needs one normal per adjacent surface. So this module stores
a normal per corner of a face, not per vertex.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from phong75.model.arrays import ArrayLike, Ints, Reals
from phong75.model.frame import InputError
from phong75.model.front.mesh_normals import DEFAULT_CREASE, corner_normals, face_normals
from phong75.model.front.mesh_topology import Edges, weld
from phong75.model.front.surface import Surface, Transformed
from phong75.model.front.vectors import apply_matrix, normalize, rotation_matrix

__all__ = [
    "DEFAULT_CREASE",
    "Mesh",
    "apply_matrix",
    "corner_normals",
    "face_normals",
    "is_closed",
    "is_consistent",
    "make_mesh",
    "normalize",
    "rotation_matrix",
]

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
        return replace(self, vertices=vertices, faces=faces, normals=normals, surface=surface)

    def faceted(self) -> Mesh:
        """A new Mesh with the normal of its face at every corner: flat shading by constant normals
        (Starkey, "Shading Techniques", section 1)."""
        normals = np.repeat(face_normals(self.vertices, self.faces)[:, None], 3, axis=1)
        return replace(self, normals=normals, surface=None)

    def with_crease(self, crease: float) -> Mesh:
        """A new Mesh with normals computed from the faces (see `corner_normals`)."""
        normals = corner_normals(self.vertices, self.faces, crease)
        return replace(self, normals=normals, surface=None)


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


def is_closed(mesh: Mesh) -> bool:
    """Whether `mesh` is a closed surface: each edge belongs to two faces, once per direction.

    Such a surface has one winding everywhere, so that no back face is visible from outside.
    """
    return _edges(mesh).closed


def is_consistent(mesh: Mesh) -> bool:
    """Whether the faces of `mesh` have one winding: no directed edge occurs twice."""
    return _edges(mesh).consistent


def _edges(mesh: Mesh) -> Edges:
    return Edges.of(weld(mesh.vertices)[0][mesh.faces])
