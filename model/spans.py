"""The `spans` file: one frame as the hardware reads it, registers and material table included.

    line 1   `phong75-spans 1`
    line 2   a JSON object on one line, padded with spaces so that the body starts at `body_offset`
    body     `spans` records, one a span, in the order of the stream

The JSON object has exactly these keys:

    width, height   the picture, in pixels
    half_vector     [hx, hz], codes: the direction halfway between light and eye
    two_sided       whether |Zn| is shaded
    background      [red, green, blue], codes of the dots that no span covers
    materials       a list of {index, ambient[3], diffuse[3], weight[P], exponent}, all in codes
    spans           the number of records
    formats         the fields of `Config` that give the codes above their meaning
    record          {bytes, fields}: the layout of a record; fields is {name: [lsb, bits]}
    body_offset     where the body starts, a multiple of the size of a record

A record is one word of the pipeline's `s_axis_tdata` with `s_axis_tlast` above it, the most
significant byte first, which is how Verilog's `$fread` fills a register. Its fields, from bit 0
upwards, are start_x, start_y, start_z, step_x, step_y, step_z (`Config.normal`), x, y
(`coordinate_bits`), length (one bit more), material (`material_bits`) and last (1 bit); zeros fill
up to the next power of two of bytes. With the default configuration that is 234 bits in 32 bytes.
For Gouraud shading x, y, z of start and step are red, green, blue (for grey there is x only); for
flat shading there is no step.

Codes, not reals, stand in the file, so that a round trip is exact and a file that once showed an
error shows it again.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import NamedTuple

import numpy as np

from phong75.model import quadratic_spans
from phong75.model.config import Config
from phong75.model.frame import SPAN_DTYPE, Frame, InputError, MaterialTable

MAGIC = "phong75-spans 1"

#: The fields of `Config` without which the codes of a file mean nothing.
FORMATS = (
    "technique",
    "coordinate_bits",
    "normal",
    "material_bits",
    "colour_bits",
    "half_vector",
    "coefficient",
    "exponent",
    "weight_index_bits",
)

#: The largest exponent n that the hardware is specified for.
MAX_EXPONENT = 128

_WORD = 64  # records are packed and unpacked through words of this many bits


class SpanField(NamedTuple):
    """A field of a record: bits [lsb + bits - 1 : lsb]."""

    name: str
    lsb: int
    bits: int


def squares_only(config: Config) -> bool:
    """Whether spans carry squares of the normal in place of its x and y (model/differences.py)."""
    return config.technique == "phong" and config.normal_method == "quadratic_spans"


def span_fields(config: Config) -> list[SpanField]:
    """The fields of a record, from bit 0 upwards, without gaps."""
    carried = ("start",) if config.technique == "flat" else ("start", "step")
    axes = "xyz"[: config.values]
    widths = [(f"{what}_{axis}", config.normal.bits) for what in carried for axis in axes]
    if squares_only(config):
        widths = [(f"{what}_z", config.normal.bits) for what in carried]
        widths += [(name, config.squared.bits) for name in quadratic_spans.NAMES]
    widths += [
        ("x", config.coordinate_bits),
        ("y", config.coordinate_bits),
        ("length", config.coordinate_bits + 1),  # a span may be as long as the largest picture
        ("material", config.material_bits),
        ("last", 1),
    ]
    fields, lsb = [], 0
    for name, bits in widths:
        fields.append(SpanField(name, lsb, bits))
        lsb += bits
    return fields


def record_bits(config: Config) -> int:
    """Bits of a record, padding included."""
    top = span_fields(config)[-1]
    bits = _WORD
    while bits < top.lsb + top.bits:
        bits *= 2
    return bits


def illegal_spans(frame: Frame, config: Config) -> np.ndarray:
    """Which spans the RTL flags, bool[n]: a normal leaves its format between first and last pixel.

    The walk is a straight line, so its two ends decide.
    """
    steps = np.maximum(frame.spans["length"].astype(np.int64), 1) - 1
    end = frame.spans["start"] + steps[:, None] * frame.spans["step"]
    return ~(config.normal.contains(frame.spans["start"]) & config.normal.contains(end)).all(axis=1)


# -- writing ---------------------------------------------------------------------------------------


def write_spans(path, frame: Frame, config: Config) -> None:
    """Write `frame` to the file `path`; the same frame always gives the same bytes.

    Spans that only the reader would reject (beyond the picture, illegal normals) are written, so
    that a test can offer them to the RTL. Raises ValueError if a value does not fit its field and
    OSError if the file cannot be written.
    """
    body = pack(frame.spans, config, frame.half_vector)
    size = record_bits(config) // 8
    header = {
        "width": int(frame.width),
        "height": int(frame.height),
        "half_vector": [int(c) for c in frame.half_vector],
        "two_sided": bool(frame.two_sided),
        "background": [int(c) for c in frame.background],
        "materials": _material_rows(frame, config),
        "spans": len(frame.spans),
        "formats": _formats(config),
        "record": _record(config),
    }
    lines = _lines(header, 0)
    # The offset is part of the line that decides it: give its digits room, then round up.
    offset = -(-(len(lines) + 20) // size) * size
    lines = _lines(header, offset)
    Path(path).write_bytes(lines[:-1].ljust(offset - 1) + b"\n" + body)


def pack(spans: np.ndarray, config: Config, half_vector=(0, 0)) -> bytes:
    """The records of `spans` (SPAN_DTYPE[n]), one after the other.

    half_vector: that of the frame; it matters where spans carry squares. Raises ValueError if a
    value does not fit its field.
    """
    words = np.zeros((len(spans), record_bits(config) // _WORD), np.uint64)
    if not np.array_equal(spans, _implied(spans, config)):
        raise ValueError("a span has a step or colours that a record has no place for")
    squares = (
        quadratic_spans.coefficients(spans, half_vector, config) if squares_only(config) else {}
    )
    for field in span_fields(config):
        square = squares.get(field.name)
        value, signed = _column(spans, field.name) if square is None else (square, True)
        low = -(1 << (field.bits - 1)) if signed else 0
        if len(value) and not (low <= value.min() and value.max() < low + (1 << field.bits)):
            raise ValueError(f"a span's {field.name} does not fit {field.bits} bits")
        code = value.astype(np.uint64) & np.uint64((1 << field.bits) - 1)
        word, shift = divmod(field.lsb, _WORD)
        words[:, word] |= code << np.uint64(shift)
        if shift + field.bits > _WORD:
            words[:, word + 1] |= code >> np.uint64(_WORD - shift)
    return words[:, ::-1].astype(">u8").tobytes()


def unpack(body: bytes, config: Config) -> np.ndarray:
    """The spans (SPAN_DTYPE[n]) of the records in `body`.

    Raises InputError if a record's padding is not zero, or if it carries squares, from which x and
    y do not come back.
    """
    if squares_only(config):
        raise InputError("spans of differences cannot be read back")
    words = np.frombuffer(body, ">u8").reshape(-1, record_bits(config) // _WORD)[:, ::-1]
    words = words.astype(np.uint64)
    fields = span_fields(config)
    _reject("padding is not zero", _bits(words, fields[-1].lsb + fields[-1].bits) != 0)
    spans = np.zeros(len(words), SPAN_DTYPE)
    for field in fields:
        value = (_bits(words, field.lsb) & np.uint64((1 << field.bits) - 1)).astype(np.int64)
        column, signed = _column(spans, field.name)
        if signed:
            value -= (value >> (field.bits - 1)) << field.bits
        column[:] = value
    return _implied(spans, config)


def _implied(spans, config):
    """`spans` with what a record leaves out: one channel is grey, flat shading has no steps."""
    spans = spans.copy()
    for what in ("start", "step"):
        spans[what][:, config.values :] = spans[what][:, :1]
    if config.technique == "flat":
        spans["step"] = 0
    return spans


def _bits(words, lsb):
    """The 64 bits from `lsb` upwards of every record, uint64[n] (zeros above the record)."""
    word, shift = divmod(lsb, _WORD)
    if word >= words.shape[1]:
        return np.zeros(len(words), np.uint64)
    value = words[:, word] >> np.uint64(shift)
    if shift and word + 1 < words.shape[1]:
        value = value | words[:, word + 1] << np.uint64(_WORD - shift)
    return value


def _column(spans, name):
    """The column of `spans` that a field holds (a view), and whether it is signed."""
    what, _, axis = name.partition("_")
    return (spans[what][:, "xyz".index(axis)], True) if axis else (spans[what], False)


def _lines(header, offset):
    text = json.dumps(header | {"body_offset": offset}, separators=(",", ":"))
    return f"{MAGIC}\n{text}\n".encode()


def _formats(config):
    values = config.as_dict()
    return {name: values[name] for name in FORMATS}


def _record(config):
    fields = {field.name: [field.lsb, field.bits] for field in span_fields(config)}
    return {"bytes": record_bits(config) // 8, "fields": fields}


def _material_rows(frame, config):
    """The entries of the table that a span names or that somebody has set."""
    table, empty = frame.materials, MaterialTable.empty(config)
    columns = ("ambient", "diffuse", "weight", "exponent")
    named = set(frame.spans["material"].tolist())
    rows = []
    for index in range(config.materials):
        row = {name: getattr(table, name)[index] for name in columns}
        if index in named or any((row[n] != getattr(empty, n)[index]).any() for n in columns):
            rows.append({"index": index} | {name: code.tolist() for name, code in row.items()})
    return rows


# -- reading ---------------------------------------------------------------------------------------


def read_spans(path, config: Config) -> Frame:
    """The frame in the file `path`, checked against `config`.

    Spans may come in any order and may overlap; their normals may be illegal (see
    `illegal_spans`). Raises InputError, with one line that names the file and what is wrong with
    it, for everything else that the hardware could not be given.
    """
    try:
        data = Path(path).read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from None
    try:
        header, body = _split(data)
        return _frame(header, body, config)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _split(data):
    """The header (a dict) and the bytes after its line."""
    magic, _, rest = data.partition(b"\n")
    if magic != MAGIC.encode():
        kind = MAGIC.rpartition(" ")[0]
        if magic.startswith(kind.encode()):
            raise InputError(f"another version of the format: this program reads `{MAGIC}`")
        raise InputError(f"not a span file: line 1 is not `{MAGIC}`")
    line, newline, _ = rest.partition(b"\n")
    if not newline:
        raise InputError("line 2 does not end: the file is cut off")
    try:
        header = json.loads(line)
    except (ValueError, RecursionError) as error:
        reason = getattr(error, "msg", None) or type(error).__name__
        raise InputError(f"line 2 is not JSON: {reason}") from None
    keys = "width height half_vector two_sided background materials spans formats record"
    _keys("line 2", header, [*keys.split(), "body_offset"])
    offset = _integer("body_offset", header["body_offset"], 0, len(data))
    if offset != len(magic) + len(line) + 2:
        raise InputError(
            f"body_offset is {offset}, but line 2 ends at {len(magic) + len(line) + 2}"
        )
    return header, data[offset:]


def _frame(header, body, config):
    for key, mine in _formats(config).items():
        theirs = header["formats"].get(key) if isinstance(header["formats"], dict) else None
        if theirs != mine:
            raise InputError(f"formats.{key} is {theirs}, but the pipeline is built for {mine}")
    if header["record"] != _record(config):
        raise InputError("record: the layout is not that of the pipeline")
    width = _integer("width", header["width"], 1, config.max_size)
    height = _integer("height", header["height"], 1, config.max_size)
    fmt = config.half_vector
    half = _integers("half_vector", header["half_vector"], 2, fmt.min, fmt.max)
    if not any(half):
        raise InputError("half_vector has length zero")
    if not isinstance(header["two_sided"], bool):
        raise InputError("two_sided is neither true nor false")
    background = _integers("background", header["background"], 3, 0, (1 << config.colour_bits) - 1)
    materials, given = _materials(header["materials"], config)

    size = record_bits(config) // 8
    count = _integer("spans", header["spans"], 0, None)
    if len(body) != count * size:
        raise InputError(
            f"{count} spans of {size} bytes are announced, but {len(body)} bytes follow line 2"
        )
    spans = unpack(body, config)
    _reject("length is zero", spans["length"] == 0)
    _reject(
        f"reaches beyond the width of {width}",
        spans["x"].astype(np.int64) + spans["length"] > width,
    )
    _reject(f"y is beyond the height of {height}", spans["y"] >= height)
    _reject("names a material that line 2 does not give", ~given[spans["material"]])
    _reject("is marked as the last, but more follow", spans["last"][:-1])
    _reject("is the last, but not marked so", ~spans["last"][-1:], len(spans) - 1)
    return Frame(
        width, height, tuple(half), header["two_sided"], tuple(background), materials, spans
    )


def _materials(rows, config):
    """The material table, and which of its entries the header gives (bool[M])."""
    if not isinstance(rows, list):
        raise InputError("materials is not a list")
    table, given = MaterialTable.empty(config), np.zeros(config.materials, bool)
    one, n_one = config.coefficient.one, config.exponent.one
    for place, row in enumerate(rows):
        _keys(f"materials[{place}]", row, ["index", "ambient", "diffuse", "weight", "exponent"])
        index = _integer(f"materials[{place}].index", row["index"], 0, config.materials - 1)
        name = f"material {index}"
        if given[index]:
            raise InputError(f"{name} is given twice")
        given[index] = True
        table.ambient[index] = _integers(f"{name}: ambient", row["ambient"], 3, 0, one)
        table.diffuse[index] = _integers(f"{name}: diffuse", row["diffuse"], 3, 0, one)
        if (table.ambient[index] + table.diffuse[index] > one).any():
            raise InputError(f"{name}: ambient + diffuse, which is Cp, is above {one}")
        table.weight[index] = _integers(
            f"{name}: weight", row["weight"], config.weight_points, 0, one
        )
        table.exponent[index] = _integer(
            f"{name}: exponent", row["exponent"], n_one, MAX_EXPONENT * n_one
        )
    return table, given


def _keys(name, value, keys):
    if not isinstance(value, dict):
        raise InputError(f"{name} is not a JSON object")
    for key in keys:
        if key not in value:
            raise InputError(f"{name} has no key `{key}`")
    for key in value:
        if key not in keys:
            raise InputError(f"{name} has an unknown key `{key}`")


def _integer(name, value, low, high):
    if type(value) is not int or value < low or (high is not None and value > high):
        limits = f"from {low} to {high}" if high is not None else f"of {low} or more"
        shown = json.dumps(value)
        raise InputError(f"{name} is {shown[:40]}, not a whole number {limits}")
    return value


def _integers(name, value, count, low, high):
    if not isinstance(value, list) or len(value) != count:
        raise InputError(f"{name} is not a list of {count} whole numbers")
    return [_integer(f"{name}[{i}]", v, low, high) for i, v in enumerate(value)]


def _reject(what, bad, first=0):
    """Raise InputError if any of `bad` (bool[n]) is set; its entry 0 is span `first`."""
    if bad.any():
        raise InputError(f"span {first + int(np.argmax(bad))}: {what}")
