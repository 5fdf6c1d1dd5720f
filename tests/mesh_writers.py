# SPDX-License-Identifier: MIT
"""Writers of mesh files for the tests, by the rules of the formats and nothing else."""

from __future__ import annotations

import json
import struct

import numpy as np

#: A cube from -1 to 1: corners, and squares counter-clockwise seen from outside.
CUBE = np.array([(x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], float)
SQUARES = [(2, 3, 1, 0), (4, 5, 7, 6), (0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6)]


def triangles(polygons):
    """Convex polygons as triangles."""
    return [(p[0], p[k], p[k + 1]) for p in polygons for k in range(1, len(p) - 1)]


def number(value):
    return f"{value:.9g}"


def obj(vertices, polygons, extra="", before=""):
    """An OBJ file: `before`, vertices, `extra`, faces of the given indices from 0."""
    lines = ["v " + " ".join(map(number, v)) for v in vertices]
    faces = ["f " + " ".join(str(i + 1) for i in p) for p in polygons]
    return before + "\n".join([*lines, *extra.splitlines(), *faces]) + "\n"


def ply(vertices, polygons, form="ascii", index="int", count="uchar", colours=None, element="face"):
    """A PLY file as bytes. form: ascii, binary_little_endian or binary_big_endian."""
    types = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I"}
    head = ["ply", f"format {form} 1.0", f"element vertex {len(vertices)}"]
    head += [f"property float {axis}" for axis in "xyz"]
    if colours is not None:
        head += [f"property uchar {name}" for name in ("red", "green", "blue")]
    head += [f"element {element} {len(polygons)}", f"property list {count} {index} vertex_indices"]
    body = b""
    order = ">" if form.endswith("big_endian") else "<"
    for i, vertex in enumerate(vertices):
        rgb = () if colours is None else tuple(int(c) for c in colours[i])
        if form == "ascii":
            body += (" ".join([*map(number, vertex), *map(str, rgb)]) + "\n").encode()
        else:
            body += struct.pack(f"{order}3f{len(rgb)}B", *vertex, *rgb)
    for polygon in polygons:
        if form == "ascii":
            body += (" ".join(map(str, [len(polygon), *polygon])) + "\n").encode()
        else:
            body += struct.pack(f"{order}{types[count]}", len(polygon))
            body += struct.pack(f"{order}{len(polygon)}{types[index]}", *polygon)
    return ("\n".join([*head, "end_header"]) + "\n").encode() + body


def stl(vertices, faces, form="binary", name=b"cube"):
    """An STL file as bytes. Its normals are zero, which the format allows."""
    vertices = np.asarray(vertices, float)
    if form == "binary":
        body = b"".join(
            struct.pack("<12fH", 0, 0, 0, *vertices[list(f)].reshape(-1), 0) for f in faces
        )
        return name.ljust(80, b" ")[:80] + struct.pack("<I", len(faces)) + body
    text = b"solid " + name + b"\n"
    for face in faces:
        text += b"facet normal 0 0 0\n outer loop\n"
        for i in face:
            text += ("  vertex " + " ".join(map(number, vertices[i])) + "\n").encode()
        text += b" endloop\nendfacet\n"
    return text + b"endsolid " + name + b"\n"


class Gltf:
    """A glTF 2.0 file, part by part. `root` is its JSON; `blob` its buffer."""

    TYPES = {"f4": 5126, "u4": 5125, "u2": 5123, "u1": 5121, "i2": 5122, "i1": 5120}

    def __init__(self):
        self.blob = b""
        self.root = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
            "meshes": [], "accessors": [], "bufferViews": [],
        }  # fmt: skip

    def view(self, data):
        self.blob += b"\0" * (-len(self.blob) % 4)
        self.root["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(data)}
        )
        self.blob += data
        return len(self.root["bufferViews"]) - 1

    def accessor(self, values, kind="f4", sparse=None, normalized=False):
        """An accessor of `values`; sparse: (indices, values) that replace some of zeros."""
        values = np.asarray(values, f"<{kind}")
        columns = values.shape[1] if values.ndim == 2 else 1
        entry = {
            "componentType": self.TYPES[kind], "count": len(values),
            "type": {1: "SCALAR", 3: "VEC3", 4: "VEC4"}[columns],
        }  # fmt: skip
        if normalized:
            entry["normalized"] = True
        if columns == 3:
            entry["min"], entry["max"] = values.min(0).tolist(), values.max(0).tolist()
        if sparse is None:
            entry["bufferView"] = self.view(values.tobytes())
        else:
            indices, changed = sparse
            entry["sparse"] = {
                "count": len(indices),
                "indices": {"bufferView": self.view(np.asarray(indices, "<u2").tobytes()),
                            "componentType": 5123},
                "values": {"bufferView": self.view(np.asarray(changed, f"<{kind}").tobytes())},
            }  # fmt: skip
        self.root["accessors"].append(entry)
        return len(self.root["accessors"]) - 1

    def mesh(self, vertices, faces=None, mode=None, material=None, index="u2", **attributes):
        """A mesh of one primitive; attributes: numbers of accessors by their names."""
        position = vertices if isinstance(vertices, int) else self.accessor(vertices)
        primitive = {"attributes": {"POSITION": position} | attributes}
        if faces is not None:
            primitive["indices"] = self.accessor(np.asarray(faces).reshape(-1), index)
        if mode is not None:
            primitive["mode"] = mode
        if material is not None:
            primitive["material"] = material
        self.root["meshes"].append({"primitives": [primitive]})
        return len(self.root["meshes"]) - 1

    def material(self, **values):
        self.root.setdefault("materials", []).append(values)
        return len(self.root["materials"]) - 1

    def node(self, mesh=None, top=True, **values):
        self.root["nodes"].append(values | ({} if mesh is None else {"mesh": mesh}))
        index = len(self.root["nodes"]) - 1
        if top:
            self.root["scenes"][0]["nodes"].append(index)
        return index

    def glb(self):
        """The file as bytes, in the binary container."""
        blob = self.blob + b"\0" * (-len(self.blob) % 4)
        root = self.root | ({"buffers": [{"byteLength": len(blob)}]} if blob else {})
        text = json.dumps(root).encode()
        text += b" " * (-len(text) % 4)
        body = struct.pack("<I4s", len(text), b"JSON") + text
        if blob:
            body += struct.pack("<I4s", len(blob), b"BIN\0") + blob
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body

    def gltf(self, uri):
        """The JSON as bytes, whose buffer is the file `uri`."""
        root = self.root | {"buffers": [{"byteLength": len(self.blob), "uri": uri}]}
        return json.dumps(root).encode()


def cube_glb(**material):
    """A GLB of a cube with a material."""
    file = Gltf()
    index = file.material(**material) if material else None
    file.node(file.mesh(CUBE, triangles(SQUARES), material=index))
    return file
