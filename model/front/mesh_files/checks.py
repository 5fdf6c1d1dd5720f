# SPDX-License-Identifier: MIT
"""What is looked at in a mesh file before the library reads the file.

Assimp gives no place in its messages, and stumbles over some harmless habits of writers: a
byte-order mark, comments at the end of a line, bytes behind a binary STL file. It also drops the
smoothing groups of OBJ files. The functions here find the place of a mistake, rewrite what Assimp
cannot read, and list what the file has but Phong75 does not use. Each looks only at what it
needs; the numbers are the library's business.
"""

from __future__ import annotations

import json
import mmap
import re
import struct
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np

from phong75.model.frame import InputError
from phong75.model.front import notes
from phong75.model.front.mesh_files.quantized import dequantize, index_out_of_range

#: Files with these suffixes are tested, feature by feature.
TESTED_SUFFIXES = (".obj", ".ply", ".stl", ".glb", ".gltf", notes.OBJECT_SUFFIX)

#: The library opens these, too; no test of ours does.
UNTESTED_SUFFIXES = (
    ".3d .3ds .3mf .ac .ac3d .acc .amf .ase .ask .assbin .b3d .blend .bsp .bvh .cob .csm .dae .dxf "
    ".enff .fbx .hmp .ifc .ifczip .iqm .irr .irrmesh .lwo .lws .lxo .md2 .md3 .md5anim .md5camera "
    ".md5mesh .mdc .mdl .mesh .mesh.xml .mot .ms3d .ndo .nff .off .ogex .pk3 .pmx .prj .q3o .q3s "
    ".raw .scn .sib .smd .step .stp .ter .uc .vrm .vta .x .x3d .x3db "
    ".xgl .xml .zae .zgl"
).split()

#: The largest coordinate: Assimp holds coordinates in 32 bits.
LARGEST = 3.4e38

#: Separates the name of a material from its smoothing group in what Assimp reads as one name.
GROUP_MARK = "\x1fs"

#: Extensions of glTF that change no vertex and no face. A file may require them.
HARMLESS = re.compile(
    r"KHR_(materials_\w+|mesh_quantization|texture_\w+|lights_\w+|animation_\w+|xmp\w*|node_\w+)"
    r"|EXT_(texture_\w+|lights_\w+)|MSFT_(texture_dds|packing_\w+)|ADOBE_materials_\w+"
)


@dataclass
class Prepared:
    """What is known of a file before it is read.

    content: what the library reads in place of the file; None for the file itself. size: bytes of
    the file and of the buffers that it refers to. notes: what was changed, in words. unused: what
    the file has and Phong75 does not use. materials: how many materials the file defines, or None
    if that is not known; further ones are the library's defaults. smoothing: whether an OBJ file
    has smoothing groups. normals, lines: whether it has normals; points or lines.
    """

    size: int
    content: bytes | None = None
    notes: list[str] = field(default_factory=list)
    unused: list[str] = field(default_factory=list)
    materials: int | None = None
    smoothing: bool = False
    normals: bool = False
    lines: bool = False


#: Bytes of text that are searched at a time: so many stay in the processor's cache.
SCAN_BYTES = 1 << 18

Data = bytes | mmap.mmap

_NUMBER = re.compile(rb"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")


def prepare(path: Path) -> Prepared:
    """Look at the file `path`. Raises InputError."""
    try:
        with open(path, "rb") as file:
            size = file.seek(0, 2)
            if not size:
                raise InputError(f"{path}: the file is empty")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
                prepared = Prepared(size)
                check = _CHECKS.get(path.suffix.lower())
                if check:
                    check(str(path), data, prepared)
                return prepared
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from None


# -- OBJ -------------------------------------------------------------------------------------------

# All patterns begin with a line feed, which `re` finds many times faster than the start of a line.
_COMMENT = re.compile(rb"\n((?:vn|vt|vp|v|fo|f|l|p|s)[ \t][^#\n]*+)#[^\n]*")
_FEW_COORDINATES = re.compile(
    rb"\nv(?:[ \t]++[^\s#]++)?+(?:[ \t]++[^\s#]++)?+[ \t]*+(?=[\r\n#]|\Z)"
)
_VERTEX_LINE = re.compile(rb"\nv[nt]?[ \t][^\r\n]*")
_POINT_FIRST = re.compile(rb"([ \t][-+]?)\.(?=\d)")
_GROUPS = re.compile(rb"\n(s|usemtl)(?:[ \t]+([^\r\n]*))?(?=[\r\n]|\Z)")
_TEXTURE_INDEX = re.compile(rb"\nf[ \t][^\n/]*+/-?\d")
_CURVES = re.compile(rb"\n(?:cstype|curv|curv2|surf|bmat)[ \t]")


def _with_leading_zeros(line: re.Match[bytes]) -> bytes:
    """The line of a vertex with 0.5 in place of .5."""
    return _POINT_FIRST.sub(rb"\g<1>0.", line.group())


def _obj(name: str, data: Data, prepared: Prepared) -> None:
    """Look at an OBJ file."""
    text = b"\n" + bytes(_text(name, data))
    changed = len(text) != len(data) + 1
    if b"\r" in text and b"\n" not in text[1:]:
        text, changed = text.replace(b"\r", b"\n"), True
    if b"\\" in text:
        text, changed = re.sub(rb"\\\r?\n", b" ", text), True
    begins, before_points = _scan(text)
    if any(begin[:1] in (b" ", b"\t") for begin in begins):
        text, changed = re.sub(rb"\n[ \t]+", b"\n", text), True
        begins, before_points = _scan(text)
    if text.count(b"#") > sum(begins[begin] for begin in begins if begin[:1] == b"#"):
        text, changed = _COMMENT.sub(rb"\n\1", text), True
    if before_points & set(b" \t-+"):
        # Assimp counts no number that begins with its decimal point.
        text, changed = _VERTEX_LINE.sub(_with_leading_zeros, text), True
    short = _FEW_COORDINATES.search(text)
    if short:
        number = text.count(b"\nv ", 0, short.start()) + text.count(b"\nv\t", 0, short.start()) + 1
        line = text.count(b"\n", 0, short.start()) + 1
        count = ("no coordinates", "one coordinate", "two coordinates")[
            len(short.group().split()) - 1
        ]
        raise InputError(f"{name}: line {line}: vertex {number} has {count}")
    if b"/" in text and b"vt" not in begins and _TEXTURE_INDEX.search(text):
        # Assimp makes points of faces whose texture vertices are not there.
        text = re.sub(rb"(?<=\d)/-?\d+(?=/)", b"/", text)
        text, changed = re.sub(rb"([ \t]-?\d+)/-?\d+(?=\s)", rb"\1", text), True
        prepared.notes.append("indices of texture vertices, of which the file has none, left out")
    prepared.normals = b"vn" in begins
    prepared.lines = any(begin in begins for begin in (b"l ", b"l\t", b"p ", b"p\t"))
    prepared.smoothing = any(begin in begins for begin in (b"s ", b"s\t", b"s\n", b"s\r"))
    if prepared.smoothing:
        text, changed = _GROUPS.sub(_group_marker(), text), True
    if any(begin in begins for begin in (b"cs", b"cu", b"su", b"bm")) and _CURVES.search(text):
        prepared.unused.append("curves and surfaces (cstype)")
    if changed:
        prepared.content = text


def _scan(text: bytes) -> tuple[dict[bytes, int], set[int]]:
    """How many lines of `text` begin with each pair of bytes, and the bytes before points.

    `text` begins with a line feed. A line of less than two bytes at its end does not count.
    """
    pairs, before = np.zeros(1 << 16, np.int64), np.zeros(1 << 8, np.int64)
    for first in range(0, len(text), SCAN_BYTES):
        data = np.frombuffer(text, np.uint8, min(SCAN_BYTES + 2, len(text) - first), first)
        feed = np.flatnonzero(data[:-2] == ord("\n"))
        begin = data.take(feed + 1).astype(np.int64) << 8 | data.take(feed + 2)
        pairs += np.bincount(begin, minlength=len(pairs))
        point = np.flatnonzero(data[1:] == ord("."))
        before += np.bincount(data.take(point), minlength=len(before))
    begins = {int(pair).to_bytes(2, "big"): int(pairs[pair]) for pair in np.flatnonzero(pairs)}
    return begins, set(np.flatnonzero(before).tolist())


def _group_marker() -> Callable[[re.Match[bytes]], bytes]:
    """A function that writes the smoothing group of an `s` line into the name of the material."""
    material, group = b"", b""

    def line(match: re.Match[bytes]) -> bytes:
        nonlocal material, group
        word = (match.group(2) or b"").strip()
        if match.group(1) == b"s":
            known = word.isdigit() and len(word) < 10  # "off" is no number
            group = str(int(word)).encode() if known else b"0"
        else:
            material = word
        return b"\nusemtl " + material + (GROUP_MARK.encode() + group if group else b"")

    return line


def diagnose_obj(path: Path) -> str | None:
    """The first line of an OBJ file with a wrong number or index, as a message that begins with
    the line's number; None if there is none."""
    counts = {b"v": 0, b"vt": 0, b"vn": 0}
    number = 0
    with open(path, "rb") as file:
        for number, line in enumerate(file, 1):
            words = line.partition(b"#")[0].split()
            if not words:
                continue
            if words[0] in counts:
                counts[words[0]] += 1
                for word in words[1:4]:
                    if not _NUMBER.fullmatch(word):
                        finite = word.lower().lstrip(b"+-")[:3] not in (b"nan", b"inf")
                        kind = "a number" if finite else "finite"
                        return f"line {number}: '{_show(word)}' is not {kind}"
                    if abs(float(word)) > LARGEST:
                        return f"line {number}: {_show(word)} exceeds {LARGEST:.1e}"
            elif words[0] in (b"f", b"l", b"p"):
                for corner in words[1:]:
                    message = _corner(corner, counts)
                    if message:
                        return f"line {number}: {message}"
    return None


def _corner(corner: bytes, counts: dict[bytes, int]) -> str | None:
    """What is wrong with one corner of an OBJ face, such as 1/2/3; None if nothing is."""
    kinds = ((b"v", "vertex"), (b"vt", "texture vertex"), (b"vn", "normal"))
    for (kind, noun), word in zip(kinds, corner.split(b"/"), strict=False):
        if not word and kind != b"v":
            continue
        try:
            index = int(word)
        except ValueError:
            return f"'{_show(corner)}' is not a corner of a face"
        there = counts[kind]
        if kind == b"vt" and not there:
            continue
        if index == 0:
            return f"index out of range: {noun} 0 (the first {noun} of OBJ is 1)"
        if not -there <= index <= there:
            return f"index out of range: {noun} {index}, but there are {there}"
    return None


# -- PLY -------------------------------------------------------------------------------------------

_PLY_BYTES = {
    b"char": 1, b"uchar": 1, b"int8": 1, b"uint8": 1, b"short": 2, b"ushort": 2, b"int16": 2,
    b"uint16": 2, b"int": 4, b"uint": 4, b"int32": 4, b"uint32": 4, b"float": 4, b"float32": 4,
    b"double": 8, b"float64": 8,
}  # fmt: skip


def _ply(name: str, data: Data, prepared: Prepared) -> None:
    """Look at the header of a PLY file."""
    text = _text(name, data)
    if text is not data:
        prepared.content = bytes(text)
    end = re.search(rb"end_header[ \t]*(?:\r\n|\n|\r)", text)
    if not text[:3] == b"ply" or not end:
        reason = "no 'ply' at its start" if text[:3] != b"ply" else "its header has no end"
        raise InputError(f"{name}: not a PLY file: {reason}")
    lines = [line.split() for line in re.split(rb"[\r\n]+", text[: end.start()])]
    elements = [line for line in lines if line[:1] == [b"element"]]
    counts: dict[bytes, int] = {}
    for line in elements:
        if len(line) != 3 or not line[2].isdigit() or len(line[2]) > 18:
            raise InputError(f"{name}: header line '{_show(b' '.join(line))}' has no count")
        counts[line[1]] = int(line[2])
    if b"vertex" not in counts:
        raise InputError(f"{name}: the header declares no vertices")
    if not counts.get(b"face") and not counts.get(b"tristrips"):
        raise InputError(f"{name}: the mesh has no faces")
    owner, least = b"", 0
    binary = any(line[:1] == [b"format"] and b"ascii" not in line for line in lines)
    for line in lines:
        if line[:1] == [b"element"]:
            owner = line[1]
        if line[:1] == [b"property"] and len(line) < 3:
            raise InputError(f"{name}: header line '{_show(b' '.join(line))}' has no type or name")
        if line[:1] == [b"property"] and owner:
            if owner == b"face" and line[-1] in (b"red", b"r"):
                prepared.unused.append("colours of faces")
            # A list may be empty; a number takes two bytes of text, with its separator.
            kind = line[2] if line[1:2] == [b"list"] and len(line) > 2 else line[-2]
            least += counts[owner] * (_PLY_BYTES.get(kind, 1) if binary else 2)
    body = len(text) - end.end()
    if least > body + 1:
        raise InputError(
            f"{name}: cut short: its header declares at least {least} bytes, {body} follow"
        )
    if binary and not _lists_fit(bytes(text[end.end() :]), lines, counts):
        raise InputError(f"{name}: cut short: its last list ends behind the file")
    prepared.materials = 0


def _lists_fit(body: bytes, lines: list[list[bytes]], counts: dict[bytes, int]) -> bool:
    """Whether all lists of a binary PLY file end within its `body`: Assimp reads on behind it.

    lines: of the header, as words. counts: of the rows of each element. Types that the format does
    not know are left to Assimp.
    """
    order: Literal["little", "big"] = "little"
    rows: dict[bytes, list[list[int]]] = {element: [] for element in counts}
    owner = b""
    for line in lines:
        if line[:1] == [b"format"] and b"binary_big_endian" in line:
            order = "big"
        elif line[:1] == [b"element"]:
            owner = line[1]
        elif line[:1] == [b"property"] and owner:
            kinds = line[2:4] if line[1] == b"list" else line[1:2]
            if not all(kind in _PLY_BYTES for kind in kinds):
                return True
            rows[owner].append([_PLY_BYTES[kind] for kind in kinds])
    place = 0
    for element, sizes in rows.items():
        fixed, lists = sum(size[0] for size in sizes), [s for s in sizes if len(s) == 2]
        if not lists:
            place += fixed * counts[element]
            continue
        if len(lists) == 1:  # lists of one length, as most files have them
            head = place + sum(size[0] for size in sizes[: sizes.index(lists[0])])
            width, item = lists[0]
            stride = fixed + item * int.from_bytes(body[head : head + width], order)
            end = place + stride * counts[element]
            heads = [body[k:end:stride] for k in range(head, head + width)]
            if end <= len(body) and all(h == h[:1] * len(h) for h in heads):
                place = end
                continue
        for _ in range(counts[element]):
            for size in sizes:
                if place + size[0] > len(body):
                    return False
                length = int.from_bytes(body[place : place + size[0]], order)
                place += size[0] + (length * size[1] if len(size) == 2 else 0)
    return place <= len(body)


# -- STL -------------------------------------------------------------------------------------------


def _stl(name: str, data: Data, prepared: Prepared) -> None:
    """Look at an STL file, binary or text."""
    prepared.materials = 0
    size = len(data)
    count = struct.unpack_from("<I", data, 80)[0] if size >= 84 else 0
    exact = 84 + 50 * count
    if size >= 84 and size == exact:
        if not count:
            raise InputError(f"{name}: the mesh has no faces")
        return
    text = _text(name, data)
    start = text[:5].lower() == b"solid" or text[: text.find(b"\n")].lstrip()[:5] == b"solid"
    if start and re.search(rb"\bfacet\b|\bendsolid\b", text[: 1 << 16], re.I):
        if not re.search(rb"\bvertex\b", text, re.I):
            raise InputError(f"{name}: the mesh has no faces")
        if text is not data:
            prepared.content = bytes(text)
        # Assimp wants the name of the solid in UTF-8; the name is of no use here.
        first = text[: text.find(b"\n")]
        if any(byte > 127 for byte in first):
            prepared.content = b"solid" + bytes(text)[len(first) :]
        return
    if size < 84:
        raise InputError(f"{name}: not an STL file: neither 'solid' nor a binary header")
    if size > exact and count:
        prepared.content = bytes(data[:exact])
        prepared.notes.append(f"{size - exact} bytes behind the last triangle left out")
        return
    room = (size - 84) // 50
    raise InputError(f"{name}: cut short: its header declares {count} triangles, {room} follow")


# -- glTF ------------------------------------------------------------------------------------------


def _glb(name: str, data: Data, prepared: Prepared) -> None:
    """Look at a GLB file: its header and its JSON chunk (glTF 2.0, section 4.4)."""
    if len(data) < 20 or data[:4] != b"glTF":
        raise InputError(f"{name}: not a GLB file: no 'glTF' at its start")
    version, length, chunk, kind = struct.unpack_from("<III4s", data, 4)
    if version != 2:
        raise InputError(f"{name}: version {version} of GLB; only version 2 is read")
    if length > len(data) or 20 + chunk > len(data):
        raise InputError(f"{name}: cut short: its header declares {length} bytes of {len(data)}")
    if kind != b"JSON":
        raise InputError(f"{name}: not a GLB file: the first chunk is not JSON")
    end = 20 + chunk
    root = _gltf_content(name, data[20:end], prepared)
    binary = data[end + 8 : length] if length > end + 8 else b""
    converted = _dequantized(name, root, binary)
    if converted or chunk % 4:  # Assimp wants chunks of whole words, as the format prescribes
        text = json.dumps(root).encode()
        text += b" " * (-len(text) % 4)
        prepared.content = b"".join([
            struct.pack("<4sIII4s", b"glTF", 2, length - chunk + len(text), len(text), b"JSON"),
            text, data[end:length],
        ])  # fmt: skip
        prepared.notes += ["positions or normals in integers: converted"] if converted else []


def _gltf(name: str, data: Data, prepared: Prepared) -> None:
    """Look at a glTF file (JSON)."""
    text = _text(name, data)
    if text is not data:
        prepared.content = bytes(text)
    root = _gltf_content(name, bytes(text), prepared)
    if _dequantized(name, root, b""):
        prepared.content = json.dumps(root).encode()
        prepared.notes.append("positions or normals in integers: converted")


def _dequantized(name: str, root: dict[str, Any], binary: bytes) -> bool:
    """As `dequantize`; raises InputError if the JSON is not built as glTF prescribes, or if an
    index is out of range."""
    try:
        wrong = index_out_of_range(name, root, binary)
        if wrong:
            raise InputError(f"{name}: {wrong}")
        return dequantize(name, root, binary)
    except (AttributeError, KeyError, TypeError, ValueError, IndexError, OverflowError) as error:
        message = " ".join(f"{type(error).__name__} {error}".split())[:120]
        raise InputError(f"{name}: malformed glTF: {message}") from None


def _gltf_content(name: str, text: bytes, prepared: Prepared) -> dict[str, Any]:
    """The JSON of a glTF file, once looked at."""
    try:
        root = json.loads(text)
    except (ValueError, RecursionError) as error:
        message = " ".join(str(error).split())
        raise InputError(f"{name}: malformed JSON: {message}") from None
    if not isinstance(root, dict):
        raise InputError(f"{name}: malformed glTF: no object at the top")
    asset = root.get("asset")
    if isinstance(asset, dict) and str(asset.get("version")).startswith("1"):
        raise InputError(f"{name}: version {asset['version']} of glTF; only version 2 is read")
    for key in ("extensionsRequired", "extensionsUsed"):
        extensions = [str(e) for e in _list(root, key)]
        needed = [e for e in extensions if not HARMLESS.fullmatch(e)]
        if needed and key == "extensionsRequired":
            raise InputError(f"{name}: requires the extension {needed[0]}, which is not read")
        prepared.unused += [f"extension {e}" for e in extensions if e != "KHR_mesh_quantization"]
    names = {"textures": "texture", "skins": "skin", "animations": "animation"}
    for key, noun in names.items():
        _count(prepared, len(_list(root, key)), noun)
    primitives = [
        primitive
        for mesh in _list(root, "meshes") if isinstance(mesh, dict)
        for primitive in _list(mesh, "primitives") if isinstance(primitive, dict)
    ]  # fmt: skip
    _count(prepared, sum(bool(p.get("targets")) for p in primitives), "mesh with morph targets",
           "meshes with morph targets")  # fmt: skip
    prepared.materials = len(_list(root, "materials"))
    for buffer in _list(root, "buffers"):
        length = buffer.get("byteLength") if isinstance(buffer, dict) else None
        if isinstance(length, int) and not isinstance(length, bool) and buffer.get("uri"):
            prepared.size += max(0, min(length, 1 << 36))
    return root


def _list(table: dict[str, Any], key: str) -> list[Any]:
    """The list `key` of `table`; empty if there is none."""
    value = table.get(key)
    return value if isinstance(value, list) else []


def _count(prepared: Prepared, count: int, one: str, many: str = "") -> None:
    """Add `count` things to the unused ones, if there are any."""
    if count:
        prepared.unused.append(f"1 {one}" if count == 1 else f"{count} {many or one + 's'}")


# -- all formats -----------------------------------------------------------------------------------


def _text(name: str, data: Data) -> Data:
    """`data` without a byte-order mark of UTF-8. Raises InputError for UTF-16."""
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise InputError(f"{name}: text in UTF-16: save the file as UTF-8")
    if data[:3] == b"\xef\xbb\xbf":
        return data[3:]
    return data


def _show(text: bytes) -> str:
    """`text` for a message, at most 40 characters."""
    line = " ".join(text.decode(errors="replace").split())
    return line if len(line) <= 40 else line[:37] + "..."


_CHECKS: dict[str, Callable[[str, Data, Prepared], None]] = {
    ".obj": _obj, ".ply": _ply, ".stl": _stl, ".glb": _glb, ".gltf": _gltf,
}  # fmt: skip
