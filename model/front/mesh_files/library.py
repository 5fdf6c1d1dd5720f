# SPDX-License-Identifier: MIT
"""Reads mesh files with Assimp, in a process of its own with limits (see `child`)."""

from __future__ import annotations

import json
import mmap
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from typing import Any

import numpy as np

from phong75.model.arrays import Ints, Reals
from phong75.model.frame import InputError
from phong75.model.front.mesh_files.checks import Prepared, diagnose_obj

#: The package whose wheel brings Assimp, and the place of the library in that wheel.
PACKAGE, LIBRARY = "cmeel-assimp", "cmeel.prefix/lib/libassimp.so"

#: The script that reads a file.
CHILD = Path(__file__).with_name("child.py")

#: Limits of the process that reads a file of `size` bytes: seconds of processor time, and bytes of
#: memory. On a slow machine Assimp reads 10 MB a second; its lists take up to 20 times the file.
CPU_S, CPU_S_PER_BYTE = 20, 1e-6
MEMORY, MEMORY_PER_BYTE = 1 << 30, 40

#: Largest number of triangles that the nodes of a file may place. More would only take memory.
MAX_TRIANGLES = 50_000_000


@dataclass
class FilePart:
    """One mesh of a file, in its own coordinates.

    vertices: float64[V, 3]. faces: int64[F, 3], indices of vertices, all in range. normals:
    float64[V, 3] or None. colours: float64[V, 3] or None. material: index in
    `FileContents.materials`.
    """

    vertices: Reals
    faces: Ints
    normals: Reals | None
    colours: Reals | None
    material: int


@dataclass
class FileContents:
    """What a mesh file holds.

    parts: its meshes. nodes: pairs of a matrix, float64[4, 4], and the index of the part that it
    places. materials: what the file says about each material, by Assimp's names. other: number of
    points and lines. missing: files that it refers to and that are not there. unused: what Assimp
    reads and Phong75 does not use.
    """

    parts: list[FilePart]
    nodes: list[tuple[Reals, int]]
    materials: list[dict[str, Any]]
    other: int
    missing: list[str]
    unused: list[str]


@cache
def library_path() -> Path:
    """Where Assimp is. Raises InputError if the package is not installed."""
    try:
        return Path(str(distribution(PACKAGE).locate_file(LIBRARY))).resolve(strict=True)
    except (PackageNotFoundError, OSError):
        raise InputError(f"the package {PACKAGE}, which reads mesh files, is missing") from None


def read_file(path: Path, prepared: Prepared) -> FileContents:
    """Read the file `path`. Raises InputError that names the file and what is wrong with it."""
    with Reading(path, prepared.size, prepared.content) as reading:
        return reading.result()


class Reading:
    """A process that reads the file `path`, or `content` in its place. size: see `Prepared`.

    At the end of the `with` block the process is ended and its files are closed.
    """

    def __init__(self, path: Path, size: int, content: bytes | None = None) -> None:
        self.path = path
        self.cpu_s = int(CPU_S + CPU_S_PER_BYTE * size)
        self.memory = int(MEMORY + MEMORY_PER_BYTE * size)
        self._arrays, self._content, self._output = (tempfile.TemporaryFile() for _ in range(3))
        arrays, given = self._arrays.fileno(), -1
        if content is not None:
            self._content.write(content)
            self._content.flush()
            given = self._content.fileno()
        command = [
            sys.executable, "-I", "-S", str(CHILD),
            str(library_path()), str(path), str(self.cpu_s), str(self.memory), str(size),
            str(arrays), str(given), str(Path(np.__file__).parent.parent),
        ]  # fmt: skip
        self._process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=self._output, stderr=subprocess.DEVNULL,
            pass_fds=(arrays, self._content.fileno()),
        )  # fmt: skip

    def __enter__(self) -> Reading:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        for file in (self._arrays, self._content, self._output):
            file.close()

    def result(self) -> FileContents:
        """What is in the file. Raises InputError that names the file and what is wrong with it."""
        answer = self._answer()
        if "error" in answer:
            raise InputError(f"{self.path}: {_reason(self.path, answer['error'])}")
        numbers: bytes | mmap.mmap = b""
        if os.fstat(self._arrays.fileno()).st_size:
            numbers = mmap.mmap(self._arrays.fileno(), 0, access=mmap.ACCESS_READ)
        return _contents(self.path, answer, numbers)

    def _answer(self) -> dict[str, Any]:
        """The answer of the process, once it has ended. Raises InputError."""
        path, code = self.path, self._process.wait()
        self._output.seek(0)
        text = self._output.read()
        if code == -signal.SIGXCPU or code == -signal.SIGKILL:
            raise InputError(f"{path}: takes more than {self.cpu_s} s of processor time to read")
        try:
            answer = json.loads(text)
        except ValueError:
            answer = None
        if code or not isinstance(answer, dict):
            how = "ends without an answer"
            if code < 0:
                how = f"crashes (signal {-code}); the file may be cut short"
            raise InputError(f"{path}: not a readable mesh: the reader {how}")
        if "bad_alloc" in answer.get("error", "") or "out of memory" in answer.get("error", ""):
            gib = self.memory / 2**30
            raise InputError(f"{path}: takes more than {gib:.1f} GiB of memory to read")
        return answer


def _reason(path: Path, error: str) -> str:
    """What is wrong with the file, on one line: the place if we find it, else Assimp's words."""
    if path.suffix.lower() == ".obj":
        place = diagnose_obj(path)
        if place:
            return place
    words = " ".join(error.split())[:200]
    if "no meshes" in words or "no data" in words:
        return "the mesh has no faces"
    if words.startswith("face "):
        return words
    return f"not a readable mesh: {words or 'no reason given'}"


def _contents(path: Path, answer: dict[str, Any], numbers: bytes | mmap.mmap) -> FileContents:
    """The contents of the file from the child's `answer` and its `numbers`. Raises InputError."""
    offset = 0

    def take(kind: str, count: int, columns: int) -> Any:
        nonlocal offset
        values = np.frombuffer(numbers, kind, count * columns, offset).reshape(count, columns)
        offset += values.nbytes
        return values

    parts = []
    for mesh in answer["meshes"]:
        count = mesh["vertices"]
        vertices = take("<f4", count, 3)
        normals = take("<f4", count, 3) if mesh["normals"] else None
        colours = take("<f4", count, 4)[:, :3] if mesh["colours"] else None
        faces = take("<u4", mesh["faces"], 3)
        parts.append(FilePart(vertices, faces, normals, colours, mesh["material"]))
    nodes = [
        (np.array(node["matrix"], np.float64).reshape(4, 4), index)
        for node in answer["nodes"]
        for index in node["meshes"]
        if parts[index].faces.size
    ]
    total = sum(len(parts[index].faces) for _, index in nodes)
    if total > MAX_TRIANGLES:
        raise InputError(f"{path}: {total} triangles, more than {MAX_TRIANGLES}")
    unused = []
    textured = sum(any(k.startswith("texture:") for k in m) for m in answer["materials"])
    if textured:
        unused.append(f"textures of {textured} material{'s' if textured > 1 else ''}")
    for key, noun in (("bones", "skins (bones)"), ("morphs", "morph targets")):
        if any(mesh[key] for mesh in answer["meshes"]):
            unused.append(noun)
    if answer["animations"]:
        unused.append("animations")
    return FileContents(
        parts,
        nodes,
        answer["materials"],
        sum(mesh["other"] for mesh in answer["meshes"]),
        answer["missing"],
        unused,
    )
