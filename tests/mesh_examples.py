# SPDX-License-Identifier: MIT
"""Mesh files for the tests: a cube in every format and with every feature, and broken copies."""

from __future__ import annotations

import struct
import warnings
from pathlib import Path

import numpy as np
import pytest

from phong75.model.frame import InputError
from phong75.model.front.mesh_files.load import load_mesh_file
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from tests.mesh_writers import CUBE, SQUARES, Gltf, cube_glb, obj, ply, stl, triangles

FLAT_NORMALS = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]


def with_normals(file, kind="f4"):
    """A cube with flat normals, four vertices a side, and its indices."""
    points = CUBE[np.array(SQUARES)].reshape(-1, 3)
    normals = np.repeat(np.array(FLAT_NORMALS, float), 4, axis=0)
    faces = [(4 * k, 4 * k + i, 4 * k + i + 1) for k in range(6) for i in (1, 2)]
    if kind == "f4":
        return file.mesh(points, faces, NORMAL=file.accessor(normals))
    # quantized (KHR_mesh_quantization): signed bytes, four a vertex because views are aligned
    scale = 127
    position = np.zeros((24, 4), np.int8)
    position[:, :3] = points * scale
    normal = np.zeros((24, 4), np.int8)
    normal[:, :3] = normals * scale
    file.root["extensionsUsed"] = file.root["extensionsRequired"] = ["KHR_mesh_quantization"]
    for values in (position, normal):
        file.root["bufferViews"].append({
            "buffer": 0, "byteOffset": len(file.blob), "byteLength": values.nbytes,
            "byteStride": 4,
        })  # fmt: skip
        file.blob += values.tobytes()
        file.root["accessors"].append({
            "bufferView": len(file.root["bufferViews"]) - 1, "componentType": 5120, "count": 24,
            "type": "VEC3", "normalized": True, "min": [-127] * 3, "max": [127] * 3,
        })  # fmt: skip
    count = len(file.root["accessors"])
    return file.mesh(count - 2, faces, NORMAL=count - 1)


def gltf_file(build):
    """The bytes of a GLB whose nodes `build` makes."""
    file = Gltf()
    build(file)
    return file.glb()


def strips(file):
    """Each side of a cube as a strip of two triangles."""
    for a, b, c, d in SQUARES:
        file.node(file.mesh(CUBE, (a, b, d, c), mode=5))


def fans(file):
    for square in SQUARES:
        file.node(file.mesh(CUBE, square, mode=6))


def soup(file):
    points = CUBE[np.array(triangles(SQUARES))].reshape(-1, 3)
    file.node(file.mesh(points))


def sparse(file):
    """A cube whose upper corners are a sparse change of the lower ones."""
    low = CUBE.copy()
    low[4:, 2] = -1
    base = file.accessor(low)
    entry = file.root["accessors"][base]
    entry["max"] = [1.0, 1.0, 1.0]
    entry["sparse"] = {
        "count": 4,
        "indices": {"bufferView": file.view(np.arange(4, 8, dtype="<u2").tobytes()),
                    "componentType": 5123},
        "values": {"bufferView": file.view(CUBE[4:].astype("<f4").tobytes())},
    }  # fmt: skip
    file.node(file.mesh(base, triangles(SQUARES)))


def sparse_of_nothing(file):
    """The same with no base at all: all corners are the sparse values."""
    position = file.accessor(np.zeros((8, 3)), sparse=(np.arange(8), CUBE))
    file.root["accessors"][position] |= {"min": [-1.0] * 3, "max": [1.0] * 3}
    file.node(file.mesh(position, triangles(SQUARES)))


def halves(file):
    """Half a cube, placed twice: the second time mirrored in a node below another one."""
    half = np.where(CUBE[:, :1] > 0, CUBE, CUBE * (0, 1, 1))
    mesh = file.mesh(half, triangles([s for s in SQUARES if s != SQUARES[5]]))
    file.node(mesh)
    inner = file.node(mesh, top=False, scale=[-0.5, 0.25, 2])
    file.node(children=[inner], matrix=np.diag([2.0, 4.0, 0.5, 1]).reshape(-1).tolist())


def unaligned(glb):
    """A GLB whose JSON chunk does not end at a whole word, as some writers leave it."""
    size = struct.unpack_from("<I", glb, 12)[0]
    text = glb[20 : 20 + size].rstrip()
    text += b" " * (1 + (-len(text) % 4))
    head = struct.pack("<4sIII4s", b"glTF", 2, len(glb) - size + len(text), len(text), b"JSON")
    return head + text + glb[20 + size :]


CUBE_FACES = triangles(SQUARES)
QUANTIZED = Gltf()
QUANTIZED.node(with_normals(QUANTIZED, "i1"))
NEGATIVE = "".join(
    obj(CUBE[list(s)], []) + "f -4 -3 -2 -1\n" for s in SQUARES
)  # indices count back from each face
PER_CORNER = "".join(f"vn {x} {y} {z}\n" for x, y, z in FLAT_NORMALS) + "".join(
    "f " + " ".join(f"{i + 1}//{k + 1}" for i in s) + "\n" for k, s in enumerate(SQUARES)
)
TEXTURED = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n" + "".join(
    "f " + " ".join(f"{i + 1}/{k + 1}" for k, i in enumerate(s)) + "\n" for s in SQUARES
)
PLAIN = obj(CUBE, SQUARES)

#: name: (content, files beside it). All are a cube of edge 2, closed.
CUBES = {
    "quads.obj": PLAIN,
    "triangles.obj": obj(CUBE, CUBE_FACES),
    "negative.obj": NEGATIVE,
    "normals.obj": obj(CUBE, []) + PER_CORNER,
    "textured.obj": obj(CUBE, []) + TEXTURED,
    "texture_missing.obj": obj(CUBE, [])
    + "".join("vn {} {} {}\n".format(*n) for n in FLAT_NORMALS)
    + "".join(
        "f " + " ".join(f"{i + 1}/{i + 1}/{k + 1}" for i in s) + "\n" for k, s in enumerate(SQUARES)
    ),
    "mark.obj": b"\xef\xbb\xbf" + PLAIN.encode(),
    "windows.obj": PLAIN.replace("\n", "\r\n"),
    "mac.obj": PLAIN.replace("\n", "\r"),
    "tabs.obj": PLAIN.replace(" ", "\t\t"),
    "indented.obj": "\n\t# a cube\n" + PLAIN.replace("\n", "  \n\t "),
    "comments.obj": PLAIN.replace("\n", " # note 7 8\n"),
    "continued.obj": PLAIN.replace("f ", "f \\\n "),
    "latin1.obj": b"# W\xfcrfel\no W\xfcrfel\nusemtl \xe9\n" + PLAIN.encode(),
    "objects.obj": obj(CUBE, SQUARES[:3]) + "o two\ng upper part\n"
    + "".join("f " + " ".join(str(i + 1) for i in s) + "\n" for s in SQUARES[3:]),
    "weights.obj": PLAIN.replace("\nf", "\nf", 1).replace("v -1 -1 -1\n", "v -1 -1 -1 1.0\n"),
    "lines.obj": PLAIN + "l 1 2 3\np 4\n",
    "clockwise.obj": obj(CUBE, [s[::-1] for s in SQUARES]),
    "mixed_winding.obj": obj(CUBE, [s[::-1] if k % 2 else s for k, s in enumerate(SQUARES)]),
    "far.obj": obj(CUBE + (1000, -2000, 500), SQUARES),
    "no_end.obj": PLAIN.rstrip("\n"),
    "ascii.ply": ply(CUBE, SQUARES),
    "windows.ply": ply(CUBE, SQUARES).replace(b"\n", b"\r\n"),
    "little.ply": ply(CUBE, SQUARES, "binary_little_endian"),
    "big.ply": ply(CUBE, SQUARES, "binary_big_endian", "uint"),
    "shorts.ply": ply(CUBE, SQUARES, "binary_little_endian", "ushort"),
    "bytes.ply": ply(CUBE, SQUARES, "binary_little_endian", "uchar", "ushort"),
    "wide_counts.ply": ply(CUBE, SQUARES, "binary_big_endian", "int", "int"),
    "mix.ply": ply(CUBE, SQUARES[:3] + CUBE_FACES[6:], "binary_little_endian"),
    "mix_big.ply": ply(CUBE, CUBE_FACES[:6] + SQUARES[3:], "binary_big_endian"),
    "mark.ply": b"\xef\xbb\xbf" + ply(CUBE, SQUARES),
    "comment.ply": ply(CUBE, SQUARES).replace(b"element v", b"comment W\xfcrfel\nelement v", 1),
    "binary.stl": stl(CUBE, CUBE_FACES),
    "ascii.stl": stl(CUBE, CUBE_FACES, "ascii"),
    "solid.stl": stl(CUBE, CUBE_FACES, name=b"solid but binary"),
    "latin1.stl": stl(CUBE, CUBE_FACES, "ascii", b"W\xfcrfel"),
    "trailing.stl": stl(CUBE, CUBE_FACES) + b"made by a scanner",
    "two_solids.stl": stl(CUBE, CUBE_FACES[:6], "ascii") + stl(CUBE, CUBE_FACES[6:], "ascii"),
    "upper.STL": stl(CUBE, CUBE_FACES),
    "indexed.glb": cube_glb().glb(),
    "wide.glb": gltf_file(lambda f: f.node(f.mesh(CUBE, CUBE_FACES, index="u4"))),
    "bytes.glb": gltf_file(lambda f: f.node(f.mesh(CUBE, CUBE_FACES, index="u1"))),
    "normals.glb": gltf_file(lambda f: f.node(with_normals(f))),
    "quantized.glb": gltf_file(lambda f: f.node(with_normals(f, "i1"))),
    "soup.glb": gltf_file(soup),
    "strips.glb": gltf_file(strips),
    "fans.glb": gltf_file(fans),
    "sparse.glb": gltf_file(sparse),
    "sparse_of_nothing.glb": gltf_file(sparse_of_nothing),
    "instances.glb": gltf_file(halves),
    "quantized.gltf": (QUANTIZED.gltf("cube.bin"), {"cube_bin": QUANTIZED.blob}),
    "unaligned.glb": unaligned(cube_glb().glb()),
    "separate.gltf": (cube_glb().gltf("cube.bin"), {"cube_bin": cube_glb().blob}),
}  # fmt: skip


# -- broken copies ---------------------------------------------------------------------------------


def mutated(seed, more=()):
    """(name, content) of file `seed`: one of the cubes or of `more` (name, content), with a few
    bytes changed, left out, repeated or cut off."""
    rng = np.random.default_rng(seed)
    files = [(n, c[0] if isinstance(c, tuple) else c) for n, c in CUBES.items()] + list(more)
    name, content = files[rng.integers(0, len(files))]
    data = bytearray(content if isinstance(content, bytes) else content.encode())
    for _ in range(rng.integers(1, 6)):
        at = int(rng.integers(0, max(len(data), 1)))
        kind = rng.integers(0, 5)
        if kind == 0:
            data[at : at + 1] = bytes([rng.integers(0, 256)])
        elif kind == 1:
            del data[at : at + int(rng.integers(1, 9))]
        elif kind == 2:
            data[at:at] = data[at : at + int(rng.integers(1, 40))]
        elif kind == 3:
            data[at : at + 4] = struct.pack("<I", rng.choice([0, 1, 2**31 - 1, 2**32 - 1, 65536]))
        else:
            del data[at:]
    return f"a{Path(name).suffix}", bytes(data)


def complaint_about(folder, name, content, twice=False):
    """What goes wrong with a file of `content`: "" if it is refused in one line or drawn.

    twice: it is also read again, with other numbers in the reader's unused memory, which
    MALLOC_PERTURB_ makes the C library fill; what is read must be the same.
    """
    path = folder / name
    path.write_bytes(content)
    warnings.simplefilter("error")
    line, mesh = "", None
    try:
        scene = load_scene(path, (64, 48))
        mesh = scene.objects[0].mesh
    except InputError as error:
        line = str(error)
        fine = "\n" not in line and line.startswith(str(path)) and len(line) < len(str(path)) + 260
        if not fine:
            return f"an odd message: {line!r}"
    if twice:
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("MALLOC_PERTURB_", "165")
            if not _reads_the_same(path, mesh, line):
                return "not the same when read again"
    if mesh is None:
        return ""
    if not (len(mesh.faces) and np.isfinite(mesh.vertices).all()):
        return "vertices that are not finite"
    if np.abs(np.linalg.norm(mesh.normals, axis=-1) - 1).max() > 1e-9:
        return "normals that are not of length 1"
    made = front_end(scene)
    return "" if len(made.frame.spans) or made.empty else "no pixel and no reason"


def _reads_the_same(path, mesh, line):
    """Whether a file is `mesh`, or is refused with `line`."""
    try:
        other = load_mesh_file(path).mesh
    except InputError as error:
        return str(error) == line
    return mesh is not None and all(
        np.array_equal(getattr(mesh, name), getattr(other, name))
        for name in ("vertices", "faces", "normals")
    )
