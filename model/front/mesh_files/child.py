# SPDX-License-Identifier: MIT
"""Reads one mesh file with Assimp, in a process of its own, and writes what is in the file.

`library.py` starts this file as a script:
`python -I -S child.py LIBRARY FILE CPU_S MEMORY SIZE ARRAYS CONTENT PATH`. SIZE is that of FILE in
bytes; ARRAYS is the number of an open file for the results; CONTENT is that of a file to read in
place of FILE, or -1. A parser
in C++ may crash or never end on a hostile file. The limits end this process then, and nothing but
this process. The script imports nothing of the package, so that its start takes milliseconds; it
imports numpy, from PATH, only for many faces.

Standard output is one JSON object: {"error": text}, or the parts of the file ("meshes"), where
they are placed ("nodes"), the materials, and the files that were asked for but not found
("missing"). The numbers go to ARRAYS: for each mesh vertices float32[V, 3], normals float32[V, 3]
and colours float32[V, 4] where it has them, faces uint32[F, 3].
"""

from __future__ import annotations

import ctypes
import importlib
import json
import os
import resource
import stat
import struct
import sys
import threading
from array import array
from typing import Any, BinaryIO, NamedTuple

#: Post-processing steps: split polygons into triangles; points, lines and triangles apart.
TRIANGULATE, SORT_BY_PRIMITIVE = 0x8, 0x8000

#: More faces than this are collected with numpy, whose import costs as much as that many faces.
MANY_FACES = 100_000

#: A file of more bytes than this may have so many faces.
LARGE_FILE = 2_000_000

#: The version of Assimp whose structures are declared below.
MAJOR_VERSION = 6

_Pointer = ctypes.c_void_p
_Uint = ctypes.c_uint


class _String(ctypes.Structure):
    _fields_ = [("length", ctypes.c_uint32), ("data", ctypes.c_char * 1024)]

    @property
    def text(self) -> str:
        return self.data[: self.length].decode(errors="replace")


class _Face(ctypes.Structure):
    _fields_ = [("count", _Uint), ("indices", _Pointer)]


class _Mesh(ctypes.Structure):
    _fields_ = [
        ("primitives", _Uint), ("vertex_count", _Uint), ("face_count", _Uint),
        ("vertices", _Pointer), ("normals", _Pointer),
        ("tangents", _Pointer), ("bitangents", _Pointer),
        ("colours", _Pointer * 8), ("texture_coordinates", _Pointer * 8), ("components", _Uint * 8),
        ("faces", ctypes.POINTER(_Face)),
        ("bone_count", _Uint), ("bones", _Pointer), ("material", _Uint), ("name", _String),
        ("morph_count", _Uint), ("morphs", _Pointer),
    ]  # fmt: skip


class _Node(ctypes.Structure):
    pass


_Node._fields_ = [
    ("name", _String), ("matrix", ctypes.c_float * 16), ("parent", _Pointer),
    ("child_count", _Uint), ("children", ctypes.POINTER(ctypes.POINTER(_Node))),
    ("mesh_count", _Uint), ("meshes", ctypes.POINTER(_Uint)), ("metadata", _Pointer),
]  # fmt: skip


class _Property(ctypes.Structure):
    _fields_ = [
        ("key", _String), ("semantic", _Uint), ("index", _Uint),
        ("length", _Uint), ("type", ctypes.c_int), ("data", _Pointer),
    ]  # fmt: skip


class _Material(ctypes.Structure):
    _fields_ = [
        ("properties", ctypes.POINTER(ctypes.POINTER(_Property))),
        ("count", _Uint), ("allocated", _Uint),
    ]  # fmt: skip


class _Scene(ctypes.Structure):
    _fields_ = [
        ("flags", _Uint), ("root", ctypes.POINTER(_Node)),
        ("mesh_count", _Uint), ("meshes", ctypes.POINTER(ctypes.POINTER(_Mesh))),
        ("material_count", _Uint), ("materials", ctypes.POINTER(ctypes.POINTER(_Material))),
        ("animation_count", _Uint), ("animations", _Pointer),
    ]  # fmt: skip


class _File(ctypes.Structure):
    pass


_Transfer = ctypes.CFUNCTYPE(
    ctypes.c_size_t, ctypes.POINTER(_File), _Pointer, ctypes.c_size_t, ctypes.c_size_t
)
_Tell = ctypes.CFUNCTYPE(ctypes.c_size_t, ctypes.POINTER(_File))
_Seek = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(_File), ctypes.c_size_t, ctypes.c_int)
_Flush = ctypes.CFUNCTYPE(None, ctypes.POINTER(_File))
_File._fields_ = [
    ("read", _Transfer), ("write", _Transfer), ("tell", _Tell), ("size", _Tell),
    ("seek", _Seek), ("flush", _Flush), ("user", _Pointer),
]  # fmt: skip


class _FileSystem(ctypes.Structure):
    pass


_Open = ctypes.CFUNCTYPE(_Pointer, ctypes.POINTER(_FileSystem), ctypes.c_char_p, ctypes.c_char_p)
_Close = ctypes.CFUNCTYPE(None, ctypes.POINTER(_FileSystem), _Pointer)
_FileSystem._fields_ = [("open", _Open), ("close", _Close), ("user", _Pointer)]


class Files:
    """The files that Assimp may see: regular files, by their name; the content of `main` may be
    given as an open file instead. `missing`: names that were asked for and do not exist."""

    def __init__(self, main: bytes, content: BinaryIO | None) -> None:
        self.main, self.content = main, content
        self.missing: list[bytes] = []
        self._open: dict[int, tuple[_File, BinaryIO, int]] = {}
        self.system = _FileSystem(_Open(self._open_file), _Close(self._close_file), None)
        self._calls = (
            _Transfer(self._read), _Transfer(lambda *_: 0), _Tell(self._tell), _Tell(self._size),
            _Seek(self._seek), _Flush(lambda *_: None),
        )  # fmt: skip

    def _open_file(self, _system: Any, name: bytes, mode: bytes) -> int | None:
        if b"w" in mode or b"a" in mode:
            return None
        try:
            if name == self.main and self.content:
                handle = os.fdopen(os.dup(self.content.fileno()), "rb")
                handle.seek(0)
            else:
                # A pipe or a device could block or never end.
                if not stat.S_ISREG(os.stat(name).st_mode):
                    raise FileNotFoundError
                handle = open(name, "rb")
            size = os.fstat(handle.fileno()).st_size
        except (OSError, ValueError):
            if name not in self.missing:
                self.missing.append(name)
            return None
        found = os.path.basename(name)  # in another folder than where it was looked for first
        self.missing = [other for other in self.missing if os.path.basename(other) != found]
        file = _File(*self._calls, None)
        address = ctypes.addressof(file)
        self._open[address] = file, handle, size
        return address

    def _close_file(self, _system: Any, address: int) -> None:
        self._open.pop(address)[1].close()

    def _handle(self, file: Any) -> tuple[_File, BinaryIO, int]:
        return self._open[ctypes.addressof(file.contents)]

    def _read(self, file: Any, buffer: int, size: int, count: int) -> int:
        if not size or not count:
            return 0
        target = (ctypes.c_char * (size * count)).from_address(buffer)
        return self._handle(file)[1].readinto(target) // size  # type: ignore[attr-defined]

    def _tell(self, file: Any) -> int:
        return self._handle(file)[1].tell()

    def _size(self, file: Any) -> int:
        return self._handle(file)[2]

    def _seek(self, file: Any, offset: int, origin: int) -> int:
        # The offset is unsigned in C; a step backwards comes as its complement.
        signed = offset - 2**64 if origin and offset >= 2**63 else offset
        try:
            self._handle(file)[1].seek(signed, origin)
        except (OSError, ValueError):
            return -1
        return 0


def limit(cpu_s: int, memory: int) -> None:
    """End this process after `cpu_s` seconds of processor time; give it `memory` bytes."""
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s))
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def load_library(path: str) -> ctypes.CDLL:
    """Assimp, with the types of the functions that are used. Raises OSError."""
    assimp = ctypes.CDLL(path)
    if assimp.aiGetVersionMajor() != MAJOR_VERSION:
        raise OSError(f"{path} is not version {MAJOR_VERSION} of Assimp")
    assimp.aiImportFileExWithProperties.restype = ctypes.POINTER(_Scene)
    assimp.aiImportFileExWithProperties.argtypes = [
        ctypes.c_char_p, _Uint, ctypes.POINTER(_FileSystem), _Pointer,
    ]  # fmt: skip
    assimp.aiApplyPostProcessing.restype = ctypes.POINTER(_Scene)
    assimp.aiApplyPostProcessing.argtypes = [ctypes.POINTER(_Scene), _Uint]
    assimp.aiGetErrorString.restype = ctypes.c_char_p
    return assimp


class Faces(NamedTuple):
    """The faces of a mesh: the number of corners of each, and the vertices of all corners, uint32
    in an array; whether all are triangles; the largest vertex, -1 without corners."""

    corners: Any
    vertices: Any
    only_triangles: bool
    largest: int


def faces_of(mesh: _Mesh) -> Faces:
    """The faces of `mesh`."""
    if mesh.face_count > MANY_FACES:
        return _many_faces_of(mesh)
    corners, vertices = array("I"), array("I")
    for face in mesh.faces[: mesh.face_count]:
        corners.append(face.count)
        if face.count:
            vertices.extend((_Uint * face.count).from_address(face.indices))
    only_triangles = all(size == 3 for size in corners)
    return Faces(corners, vertices, only_triangles, max(vertices, default=-1))


def _many_faces_of(mesh: _Mesh) -> Faces:
    """The same with numpy."""
    import numpy as np

    class Memory:  # all of this process's memory as one array of words
        __array_interface__ = {
            "data": (4, True), "shape": ((1 << 45),), "typestr": "<u4", "version": 3,
        }  # fmt: skip

    memory = np.asarray(Memory())
    table = np.ctypeslib.as_array(ctypes.cast(mesh.faces, ctypes.POINTER(ctypes.c_uint64)),
                                  (mesh.face_count, 2))  # fmt: skip
    corners = table[:, 0].astype(np.uint32)
    # Assimp allocates the indices of each face by itself; only these words are read.
    first = (table[:, 1].astype(np.int64) - 4) >> 2
    only_triangles = bool((corners == 3).all())
    if only_triangles:
        vertices = np.stack([memory[first + corner] for corner in range(3)], axis=1).reshape(-1)
    else:
        skipped = np.cumsum(corners, dtype=np.int64) - corners
        total = int(skipped[-1]) + int(corners[-1])
        vertices = memory[np.repeat(first - skipped, corners) + np.arange(total)]
    return Faces(corners, vertices, only_triangles, int(vertices.max(initial=0)))


def out_of_range(faces: Faces, count: int) -> str | None:
    """The first face that refers to a vertex beyond the `count` of them; None if none does."""
    place = 0
    for face, size in enumerate(faces.corners if faces.largest >= count else ()):
        for vertex in faces.vertices[place : place + size]:
            if vertex >= count:
                signed = ctypes.c_int32(int(vertex)).value  # -1 is shown as the file has it
                return f"face {face} refers to vertex {signed}, but there are {count} vertices"
        place += size
    return None


def triangles(faces: Faces) -> Any:
    """The vertices of the faces with three corners."""
    if faces.only_triangles:
        return faces.vertices
    if not isinstance(faces.corners, array):
        return faces.vertices[(faces.corners == 3).repeat(faces.corners)]
    result, place = array("I"), 0
    for size in faces.corners:
        if size == 3:
            result.extend(faces.vertices[place : place + size])
        place += size
    return result


def properties(material: _Material) -> dict[str, Any]:
    """What a material says, by Assimp's names; a name of a texture as "texture:SEMANTIC"."""
    result: dict[str, Any] = {}
    for pointer in material.properties[: material.count]:
        item = pointer.contents
        key = item.key.text
        data = ctypes.string_at(item.data, item.length)
        if item.type == 3:  # a string: its length, then its bytes
            value: Any = data[4 : 4 + struct.unpack_from("<I", data)[0]].decode(errors="replace")
        elif item.type in (1, 2, 4):
            code, size = {1: ("f", 4), 2: ("d", 8), 4: ("i", 4)}[item.type]
            numbers = struct.unpack(f"<{len(data) // size}{code}", data[: len(data) // size * size])
            value = list(numbers)
        else:
            value = list(data)
        if key == "$tex.file":
            key = f"texture:{item.semantic}"
        result.setdefault(key, value)
    return result


def nodes(root: _Node) -> list[dict[str, Any]]:
    """Each node that places meshes: its name, meshes, and matrix of 16 numbers (row by row)."""
    identity = [float(i % 5 == 0) for i in range(16)]
    result, stack = [], [(root, identity)]
    while stack:
        node, outer = stack.pop()
        own = list(node.matrix)
        matrix = [
            sum(outer[4 * i + k] * own[4 * k + j] for k in range(4))
            for i in range(4)
            for j in range(4)
        ]
        if node.mesh_count:
            result.append(
                {"name": node.name.text, "matrix": matrix, "meshes": node.meshes[: node.mesh_count]}
            )
        children = [pointer.contents for pointer in node.children[: node.child_count]]
        stack += [(child, matrix) for child in reversed(children)]
    return result


def contents(scene: _Scene, faces: list[Faces], out: BinaryIO) -> dict[str, Any]:
    """What `scene` holds, without its numbers, which go to `out`. faces: those of each
    mesh, none with more than three corners."""

    def write(address: int | None, components: int, count: int) -> bool:
        if address and count:
            out.write((ctypes.c_float * (components * count)).from_address(address))
        return bool(address)

    meshes = []
    for pointer, own in zip(scene.meshes[: scene.mesh_count], faces, strict=True):
        mesh = pointer.contents
        count = mesh.vertex_count
        indices = triangles(own)
        write(mesh.vertices, 3, count)
        meshes.append({
            "name": mesh.name.text, "vertices": count, "material": mesh.material,
            "normals": write(mesh.normals, 3, count), "colours": write(mesh.colours[0], 4, count),
            "faces": len(indices) // 3, "other": mesh.face_count - len(indices) // 3,
            "bones": mesh.bone_count, "morphs": mesh.morph_count,
        })  # fmt: skip
        out.write(indices)
    return {
        "meshes": meshes,
        "nodes": nodes(scene.root.contents) if scene.root else [],
        "materials": [
            properties(pointer.contents) for pointer in scene.materials[: scene.material_count]
        ],
        "animations": scene.animation_count,
    }


def main(
    library: str,
    name: str,
    cpu_s: str,
    memory: str,
    size: str,
    arrays: str,
    content: str,
    path: str,
) -> dict[str, Any]:
    """Read the file `name`; returns what is in the file, or {"error": why not}."""
    sys.path.insert(0, path)
    limit(int(cpu_s), int(memory))
    assimp = load_library(library)
    given = os.fdopen(int(content), "rb") if int(content) >= 0 else None
    files = Files(os.fsencode(name), given)
    if int(size) > LARGE_FILE:  # numpy loads while Assimp reads
        threading.Thread(target=importlib.import_module, args=("numpy",), daemon=True).start()
    scene = assimp.aiImportFileExWithProperties(
        os.fsencode(name), 0, ctypes.byref(files.system), None
    )
    if not scene:
        return {"error": assimp.aiGetErrorString().decode(errors="replace")}
    faces = []
    for pointer in scene.contents.meshes[: scene.contents.mesh_count]:
        faces.append(faces_of(pointer.contents))
        # Assimp would read beyond its vertices when it splits the polygons.
        wrong = out_of_range(faces[-1], pointer.contents.vertex_count)
        if wrong:
            return {"error": wrong}
    if not all(own.only_triangles for own in faces):
        scene = assimp.aiApplyPostProcessing(scene, TRIANGULATE | SORT_BY_PRIMITIVE)
        if not scene:
            return {"error": assimp.aiGetErrorString().decode(errors="replace")}
        faces = [faces_of(p.contents) for p in scene.contents.meshes[: scene.contents.mesh_count]]
    missing = [os.fsdecode(file) for file in files.missing]
    with os.fdopen(int(arrays), "wb") as out:
        return contents(scene.contents, faces, out) | {"missing": missing}


if __name__ == "__main__":
    try:
        answer = main(*sys.argv[1:])
    except MemoryError:
        answer = {"error": "out of memory"}
    json.dump(answer, sys.stdout)
    sys.stdout.flush()
    os._exit(0)  # the end of the process frees everything at once
