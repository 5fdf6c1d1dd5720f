# SPDX-License-Identifier: MIT
"""Positions and normals of glTF that are stored as integers (KHR_mesh_quantization).

Assimp 6 copies such numbers as if they were floats. Here they become floats: c / (2^(b-1) - 1) for
normalized signed integers of b bits but not below -1, c / (2^b - 1) for unsigned ones, and c itself
where they are not normalized (glTF 2.0, section 3.11, and the extension's text). The floats go into
a further buffer, which is written into the JSON itself. Indices of vertices are checked here, too.
"""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from phong75.model.arrays import Reals

#: An accessor without a buffer may claim any number of vertices.
MOST_VERTICES = 50_000_000

_KINDS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}


def dequantize(name: str, root: dict[str, Any], binary: bytes | memoryview) -> bool:
    """Turn integer positions and normals of `root`, the JSON of a glTF file, into floats in place.

    name: of the file. binary: the binary chunk of a GLB file. Returns whether anything changed.
    Raises AttributeError, IndexError, KeyError, OverflowError, TypeError or ValueError if the JSON
    is not built as the format prescribes.
    """
    accessors = root.get("accessors") or []
    wanted = set()
    for mesh in root.get("meshes") or []:
        for primitive in mesh.get("primitives") or []:
            for attribute in ("POSITION", "NORMAL"):
                index = (primitive.get("attributes") or {}).get(attribute)
                if isinstance(index, int) and 0 <= index < len(accessors):
                    wanted.add(index)
    integers = sorted(i for i in wanted if accessors[i].get("componentType") != 5126)
    if not integers:
        return False
    blob = b""
    for index in integers:
        values = _values(name, root, binary, accessors[index])
        accessor = accessors[index]
        for key in ("byteOffset", "normalized", "sparse"):
            accessor.pop(key, None)
        accessor |= {
            "bufferView": len(root["bufferViews"]),
            "componentType": 5126,
            "min": values.min(axis=0).tolist(),
            "max": values.max(axis=0).tolist(),
        }
        data = values.astype("<f4").tobytes()
        root["bufferViews"].append(
            {"buffer": len(root["buffers"]), "byteOffset": len(blob), "byteLength": len(data)}
        )
        blob += data
    uri = "data:application/octet-stream;base64," + base64.b64encode(blob).decode()
    root["buffers"].append({"byteLength": len(blob), "uri": uri})
    return True


def index_out_of_range(name: str, root: dict[str, Any], binary: bytes | memoryview) -> str | None:
    """The first index of a mesh that refers to no vertex, in words; None if none does.

    Assimp leaves out the triangles of such indices without a word. Arguments and errors as for
    `dequantize`; what cannot be found is left to Assimp.
    """
    accessors = root.get("accessors") or []
    for number, mesh in enumerate(root.get("meshes") or []):
        for primitive in mesh.get("primitives") or []:
            indices = primitive.get("indices")
            position = (primitive.get("attributes") or {}).get("POSITION")
            if indices is None or position is None:
                continue
            accessor, count = accessors[indices], int(accessors[position]["count"])
            kind = _KINDS.get(accessor["componentType"], "")
            if "u" not in kind or "bufferView" not in accessor or "sparse" in accessor:
                continue
            try:
                view, many = root["bufferViews"][accessor["bufferView"]], int(accessor["count"])
                vertex = _numbers(name, root, binary, view, accessor, np.dtype(kind), many, 1)
            except ValueError:
                continue
            if vertex.max() >= count:
                place = int(np.argmax(vertex[:, 0] >= count))
                return (
                    f"mesh {number}: index {place} refers to vertex {vertex[place, 0]}, "
                    f"but there are {count} vertices"
                )
    return None


def _values(
    name: str, root: dict[str, Any], binary: bytes | memoryview, accessor: dict[str, Any]
) -> Reals:
    """The vectors of an accessor of integers, float64[n, 3]."""
    if accessor["type"] != "VEC3":
        raise ValueError(f"type {accessor['type']}")
    kind = np.dtype(_KINDS[accessor["componentType"]])
    count = int(accessor["count"])
    if not 0 < count <= MOST_VERTICES:
        raise ValueError(f"{count} vertices")
    numbers = np.zeros((count, 3), kind)
    if "bufferView" in accessor:
        view = root["bufferViews"][accessor["bufferView"]]
        numbers = _numbers(name, root, binary, view, accessor, kind, count, 3)
    if "sparse" in accessor:
        sparse = accessor["sparse"]
        changed = int(sparse["count"])
        place = sparse["indices"]
        row = _numbers(
            name, root, binary, root["bufferViews"][place["bufferView"]], place,
            np.dtype(_KINDS[place["componentType"]]), changed, 1,
        )  # fmt: skip
        place = sparse["values"]
        numbers = numbers.copy()
        numbers[row[:, 0].astype(np.int64)] = _numbers(
            name, root, binary, root["bufferViews"][place["bufferView"]], place, kind, changed, 3
        )
    values = numbers.astype(np.float64)
    if accessor.get("normalized"):
        values = np.maximum(values / np.iinfo(kind).max, -1.0)
    return values


def _numbers(
    name: str, root: dict[str, Any], binary: bytes | memoryview, view: dict[str, Any],
    place: dict[str, Any], kind: np.dtype[Any], count: int, columns: int,
) -> Any:  # fmt: skip
    """`count` rows of `columns` numbers in a buffer view. Raises ValueError if they do not fit."""
    buffer = _buffer(name, root["buffers"][view["buffer"]], binary)
    size = kind.itemsize * columns
    stride = int(view.get("byteStride") or size)
    begin = int(view.get("byteOffset", 0)) + int(place.get("byteOffset", 0))
    if count < 1 or stride < size or begin < 0 or begin + stride * (count - 1) + size > len(buffer):
        raise ValueError("its numbers lie outside the buffer")
    rows = np.lib.stride_tricks.as_strided(
        np.frombuffer(buffer, np.uint8, offset=begin), (count, size), (stride, 1), writeable=False
    )
    return np.ascontiguousarray(rows).view(kind)


def _buffer(name: str, buffer: dict[str, Any], binary: bytes | memoryview) -> bytes | memoryview:
    """The bytes of a buffer: the binary chunk, those in the JSON, or a file beside this one."""
    uri = buffer.get("uri")
    if uri is None:
        return binary
    if uri.startswith("data:"):
        return base64.b64decode(uri.partition(",")[2], validate=True)
    path = Path(name).parent / unquote(uri)
    if not path.is_file():
        raise ValueError(f"{uri} is not there")
    return path.read_bytes()
