# SPDX-License-Identifier: MIT
"""The span file: one frame as the hardware reads it, registers and material table included.

    line 1   `phong75-spans 1`
    line 2   a JSON object on one line, padded with spaces so that the body starts at `body_offset`
    body     `spans` records, one per span, in the order of the stream

The JSON object has exactly these keys:

    width, height   the picture, in pixels
    half_vector     [hx, hz], codes of the half vector between light and eye
    two_sided       whether |Zn| is shaded
    background      [red, green, blue], codes of the pixels that no span covers
    materials       a list of {index, ambient[3], diffuse[3], weight[P], exponent}, all in codes;
                    with curves of cos(s) also curve: a list of [left, step] a line, and
                    curve_jumps; with jumps of W also weight_jumps: lists of [above, threshold,
                    amount] (see `MaterialTable`); each of the three is in all rows or in none
    spans           the number of records
    formats         the fields of `Config` that give these codes their meaning
    record          {bytes, fields}: the layout of a record; fields is {name: [lsb, bits]}
    body_offset     where the body starts, a multiple of the size of a record

A record is one word of the pipeline's `s_axis_tdata` with `s_axis_tlast` above it. The most
significant byte comes first, as Verilog's `$fread` fills a register. The fields, from bit 0 up,
are start_x, start_y, start_z, step_x, step_y, step_z (`Config.normal`), x, y (`coordinate_bits`),
length (one bit more), material (`material_bits`) and last (1 bit). Zeros fill the record up to a
power of two of bytes: 234 bits in 32 bytes with the default configuration.

With `Config.normal_order` 2, bend_x, bend_y, bend_z (`Config.bend`) follow step_z: 366 bits in 64
bytes with the other fields at their defaults.
With several lights (`Config.sums_lights`) a span is one record a turn: `units` lights each, so
ceil(lights / units) records. The fields of the further units of a record stand above those of the
first, their names end in the unit's number: start_x_1 is x of the second light of the record. Each
light's start and step are in the frame of that light; where the last record has a unit without a
light, both are 0. The other fields are the same in all records of a span, but `last`, which only
the last record of the frame has. Line 2 has one key more:

    lights          a list with an object a light: {half_vector[2], diffuse[M][3], highlight[M][3]},
                    where M counts the rows of `materials`, in their order; where lights fall with
                    the distance, `falloff` is the list of factors of each light

If spans bring their half vectors, half_x and half_z of each unit follow the starts and steps of all
units; if lights fall with the distance, start_depth and step_depth of each unit follow those. The
names of the further units end in the unit's number, as those of start and step.

For Gouraud shading, x, y and z of start and step are red, green and blue; for grey there is x only.
For flat shading there is no step. With `Config.spans_carry_squares`, six words of `squared` stand
in place of x and y of start and step (see `phong75.model.quadratic_spans`).

The file holds codes, not reals. A round trip is therefore exact, and a file that once showed an
error shows the same error again.
"""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from phong75.model import quadratic_spans
from phong75.model.arrays import Flags, Ints, Spans
from phong75.model.config import MAX_EXPONENT, MAX_JUMPS, Config
from phong75.model.frame import SPAN_DTYPE, Frame, FurtherLight, InputError, MaterialTable
from phong75.model.reflectance import power_words

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

#: The same for `Config.normal_order` 2; a file without them is of order 1.
ORDER_2_FORMATS = ("normal_order", "bend_fraction_bits")

#: The columns of `MaterialTable` that a frame without curves and jumps does not have.
REFLECTANCE = ("curve", "curve_jumps", "weight_jumps")

#: Records are packed and unpacked through words of this many bits.
_WORD = 64

Records = NDArray[np.uint64]


class SpanField(NamedTuple):
    """A field of a record: bits [lsb + bits - 1 : lsb]."""

    name: str
    lsb: int
    bits: int


def span_fields(config: Config) -> list[SpanField]:
    """The fields of a record, from bit 0 up, without gaps."""
    carried = ("start",) if config.technique == "flat" else ("start", "step")
    axes = "xyz"[: config.values]
    widths = [
        (f"{what}_{axis}" + (f"_{unit}" if unit else ""), config.normal.bits)
        for unit in range(config.span_units)
        for what in carried
        for axis in axes
    ]
    if config.normal_order == 2:
        widths += [(f"bend_{axis}", config.bend.bits) for axis in axes]
    if config.spans_carry_squares:
        widths = [(f"{what}_z", config.normal.bits) for what in carried]
        widths += [(name, config.squared.bits) for name in quadratic_spans.NAMES]
    for unit in range(config.span_units) if config.sums_lights else ():
        end = f"_{unit}" if unit else ""
        if config.span_half_vector:
            widths += [(f"half_{axis}{end}", config.half_vector.bits) for axis in "xz"]
    for unit in range(config.span_units) if config.sums_lights else ():
        end = f"_{unit}" if unit else ""
        if config.attenuation:
            widths += [(f"{what}_depth{end}", config.depth.bits) for what in ("start", "step")]
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
    """Width of a record in bits, padding included."""
    top = span_fields(config)[-1]
    bits = _WORD
    while bits < top.lsb + top.bits:
        bits *= 2
    return bits


def turns(frame: Frame, config: Config) -> int:
    """How many records a span of `frame` has: the turns of its lights."""
    return -(-frame.lights // config.span_units) if config.sums_lights else 1


def illegal_spans(frame: Frame, config: Config) -> Flags:
    """Which spans the RTL flags as illegal, bool[n]: a component of the normal or a depth leaves
    its format between the first and the last pixel, for any light. With `normal_order` 2 also those
    in which the change from one of these pixels to the next leaves the format (see `bent_beyond`).
    """
    if config.normal_order == 2:
        return bent_beyond(frame.spans, config)
    # Components and depths are linear, so both ends decide.
    steps = np.maximum(frame.spans["length"].astype(np.int64), 1) - 1
    illegal = np.zeros(len(frame.spans), bool)
    for number in range(frame.lights):
        light = frame.light(number, config)
        end = light.start + steps[:, None] * light.step
        legal = config.normal.contains(light.start) & config.normal.contains(end)
        illegal |= np.any(~legal, axis=1)
        if frame.depths is not None:
            start, step = frame.depths[number].T
            illegal |= ~(config.depth.contains(start) & config.depth.contains(start + steps * step))
    return illegal


def bent_beyond(spans: Spans, config: Config) -> Flags:
    """Which of `spans` (SPAN_DTYPE[n]) leave their formats with `normal_order` 2, bool[n].

    The change from pixel k to the next is step + k bend, in `Config.bend`. The change is linear in
    k, so the first and the last one decide. Where they are in the format, a component is a parabola
    without overflow in int64: the first pixel, the last one, and those around the vertex decide.
    """
    extra = config.bend_fraction_bits
    last = np.maximum(spans["length"].astype(np.int64), 1)[:, None] - 1
    start, step = spans["start"] << extra, spans["step"] << extra
    bend = np.where(last > 1, spans["bend"], 0)
    final = step + np.maximum(last - 1, 0) * bend  # the change that leads to the last pixel
    steep = (last > 0) & ~config.bend.contains(final)
    bend = np.where(steep, 0, bend)
    step = np.where(steep | (last == 0), 0, step)
    vertex = np.where(bend != 0, -step // np.where(bend != 0, bend, 1), 0)
    beyond = steep
    for k in (0 * last, last, *(np.clip(vertex + near, 0, last) for near in (0, 1))):
        value = start + k * step + (k * (k - 1) >> 1) * bend
        beyond = beyond | ~config.bend.contains(value)
    return np.any(beyond, axis=1)


# -- writing ---------------------------------------------------------------------------------------


def write_spans(path: str | Path, frame: Frame, config: Config) -> None:
    """Write `frame` to the file `path`; the same frame always gives the same bytes.

    Spans beyond the picture and spans with illegal normals are written, so that a test can offer
    them to the RTL. Raises ValueError if a value does not fit its field and OSError if the file
    cannot be written.
    """
    body = pack_frame(frame, config)
    size = record_bits(config) // 8
    header: dict[str, Any] = {
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
    if config.sums_lights:
        header["lights"] = _light_rows(frame, config, header["materials"])
    lines = _lines(header, 0)
    # The line holds the offset, which depends on the line's length: leave room for its digits.
    offset = -(-(len(lines) + 20) // size) * size
    lines = _lines(header, offset)
    Path(path).write_bytes(lines[:-1].ljust(offset - 1) + b"\n" + body)


def pack_frame(frame: Frame, config: Config) -> bytes:
    """The records of all spans of `frame`, one after the other: as many a span as the frame's
    lights take turns.

    Raises ValueError if a value does not fit its field or the frame has more lights than the build.
    """
    if frame.lights > config.lights and config.technique == "phong":
        raise ValueError(f"{frame.lights} lights in a build for {config.lights}")
    if not config.sums_lights:
        return pack(frame.spans, config, frame.half_vector)
    units, count = config.units, turns(frame, config)
    nothing = np.zeros((len(frame.spans), 3), np.int64)
    every = np.arange(len(frame.spans))
    records = np.zeros((len(frame.spans), count, record_bits(config) // 8), np.uint8)
    for turn in range(count):
        lights = [
            frame.light(number, config) if number < frame.lights else None
            for number in range(turn * units, (turn + 1) * units)
        ]
        values = [(v.start, v.step) if v else (nothing, nothing) for v in lights]
        further = {}
        for unit, number in enumerate(range(turn * units, (turn + 1) * units)):
            end, there = f"_{unit}" if unit else "", number < frame.lights
            if config.span_half_vector:
                half = frame.half_vector_of(number, every, config) if there else (0, 0)
                for axis, code in zip("xz", half, strict=True):
                    further[f"half_{axis}{end}"] = np.broadcast_to(code, len(every))
            if config.attenuation:
                depths = nothing[:, :2]
                if there and frame.depths is not None:
                    depths = frame.depths[number]
                further[f"start_depth{end}"], further[f"step_depth{end}"] = depths.T
        spans = frame.spans.copy()
        spans["start"], spans["step"] = values[0]
        if turn < count - 1:
            spans["last"] = False
        body = _pack(spans, config, values, further)
        records[:, turn] = np.frombuffer(body, np.uint8).reshape(len(spans), -1)
    return records.tobytes()


def pack(spans: Spans, config: Config, half_vector: tuple[int, ...] = (0, 0)) -> bytes:
    """The records of `spans` (SPAN_DTYPE[n]), one after the other.

    half_vector: (hx, hz) of the frame, needed if spans carry squares. Raises ValueError if a value
    does not fit its field.
    """
    if not np.array_equal(spans, _implied(spans, config)):
        raise ValueError("a span has a step, bend or colours that a record has no place for")
    squares = {}
    if config.spans_carry_squares:
        squares = quadratic_spans.coefficients(spans, half_vector, config)
    return _pack(spans, config, [(spans["start"], spans["step"])], squares)


def _pack(
    spans: Spans,
    config: Config,
    values: list[tuple[Ints, Ints]],
    signed_fields: dict[str, Ints] | None = None,
) -> bytes:
    """The records of `spans`. values: start and step of each unit, int64[n, 3]. signed_fields:
    {field: codes} of what neither `spans` nor `values` have, such as those of `quadratic_spans`."""
    words = np.zeros((len(spans), record_bits(config) // _WORD), np.uint64)
    for field in span_fields(config):
        given = (signed_fields or {}).get(field.name)
        value, signed = _column(spans, field.name, values) if given is None else (given, True)
        low = -(1 << (field.bits - 1)) if signed else 0
        if len(value) and not (low <= value.min() and value.max() < low + (1 << field.bits)):
            raise ValueError(f"a span's {field.name} does not fit {field.bits} bits")
        code = value.astype(np.uint64) & np.uint64((1 << field.bits) - 1)
        word, shift = divmod(field.lsb, _WORD)
        words[:, word] |= code << np.uint64(shift)
        if shift + field.bits > _WORD:
            words[:, word + 1] |= code >> np.uint64(_WORD - shift)
    return words[:, ::-1].astype(">u8").tobytes()


def unpack(body: bytes, config: Config) -> Spans:
    """The spans (SPAN_DTYPE[n]) of the records in `body`, with the values of the first unit.

    Raises InputError if the padding of a record is not zero, or if records carry squares, from
    which the normal's x and y cannot be recovered.
    """
    return _unpack(body, config)[0]


def _unpack(body: bytes, config: Config) -> tuple[Spans, list[tuple[Ints, Ints]], dict[str, Ints]]:
    """The spans of the records in `body`, start and step of each unit, and the further fields of
    lights at a place or that fall with the distance, {name: int64[n]}. Raises InputError."""
    if config.spans_carry_squares:
        raise InputError("spans of squares cannot be read back")
    words = np.frombuffer(body, ">u8").reshape(-1, record_bits(config) // _WORD)[:, ::-1]
    words = words.astype(np.uint64)
    fields = span_fields(config)
    _reject("padding is not zero", _bits(words, fields[-1].lsb + fields[-1].bits) != 0)
    spans = np.zeros(len(words), SPAN_DTYPE)
    values = [(spans["start"], spans["step"])]
    for _ in range(1, config.span_units):
        values.append((np.zeros((len(words), 3), np.int64), np.zeros((len(words), 3), np.int64)))
    further: dict[str, Ints] = {}
    for field in fields:
        value = (_bits(words, field.lsb) & np.uint64((1 << field.bits) - 1)).astype(np.int64)
        if field.name.startswith("half_") or "_depth" in field.name:
            column, signed = further.setdefault(field.name, np.zeros_like(value)), True
        else:
            column, signed = _column(spans, field.name, values)
        if signed:
            value -= (value >> (field.bits - 1)) << field.bits
        column[:] = value
    return _implied(spans, config), values, further


def _implied(spans: Spans, config: Config) -> Spans:
    """A copy of `spans` in which the values that a record leaves out are what they must be: equal
    channels for grey, no step for flat shading."""
    spans = spans.copy()
    for what in ("start", "step"):
        spans[what][:, config.values :] = spans[what][:, :1]
    if config.technique == "flat":
        spans["step"] = 0
    if config.normal_order == 1:
        spans["bend"] = 0
    return spans


def _bits(words: Records, lsb: int) -> Records:
    """The 64 bits from `lsb` up of every record, uint64[n]; zeros above the record.

    words: uint64[n, words of a record], the least significant word first.
    """
    word, shift = divmod(lsb, _WORD)
    if word >= words.shape[1]:
        return np.zeros(len(words), np.uint64)
    value = words[:, word] >> np.uint64(shift)
    if shift and word + 1 < words.shape[1]:
        value = value | words[:, word + 1] << np.uint64(_WORD - shift)
    return value


def _column(spans: Spans, name: str, values: list[tuple[Ints, Ints]]) -> tuple[Any, bool]:
    """The column that the field `name` holds (a view), and whether it is signed.

    values: start and step of each unit, int64[n, 3].
    """
    what, _, rest = name.partition("_")
    axis, _, unit = rest.partition("_")
    if not axis:
        return spans[what], False
    if what == "bend":
        return spans[what][:, "xyz".index(axis)], True
    return values[int(unit or 0)][what == "step"][:, "xyz".index(axis)], True


def _lines(header: dict[str, Any], offset: int) -> bytes:
    """Lines 1 and 2 of the file, without padding."""
    text = json.dumps(header | {"body_offset": offset}, separators=(",", ":"))
    return f"{MAGIC}\n{text}\n".encode()


def _formats(config: Config) -> dict[str, Any]:
    """The `formats` of line 2."""
    values = config.as_dict()
    names = FORMATS if config.normal_order == 1 else FORMATS + ORDER_2_FORMATS
    return {name: values[name] for name in names}


def _record(config: Config) -> dict[str, Any]:
    """The `record` of line 2."""
    fields = {field.name: [field.lsb, field.bits] for field in span_fields(config)}
    return {"bytes": record_bits(config) // 8, "fields": fields}


def _material_rows(frame: Frame, config: Config) -> list[dict[str, Any]]:
    """The `materials` of line 2: the rows that a span names or that differ from an empty row."""
    table, empty = frame.materials, MaterialTable.empty(config)
    columns = ("ambient", "diffuse", "weight", "exponent")
    named = set(frame.spans["material"].tolist())
    rows = []
    for index in range(config.materials):
        row = {name: getattr(table, name)[index] for name in columns}
        if index in named or any((row[n] != getattr(empty, n)[index]).any() for n in columns):
            row |= {n: c[index] for n in REFLECTANCE if (c := getattr(table, n)) is not None}
            rows.append({"index": index} | {name: code.tolist() for name, code in row.items()})
    return rows


def _light_rows(frame: Frame, config: Config, rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The `lights` of line 2. rows: its `materials`."""
    used = [row["index"] for row in rows]
    lights = []
    for number in range(frame.lights):
        light = frame.light(number, config)
        lights.append(
            {
                "half_vector": [int(c) for c in light.half_vector],
                "diffuse": light.diffuse[used].tolist(),
                "highlight": light.highlight[used].tolist(),
            }
        )
        if config.attenuation:
            one = np.full(config.weight_points, config.coefficient.one)
            points = one if frame.falloff is None else frame.falloff[number]
            lights[-1]["falloff"] = points.tolist()
    return lights


# -- reading ---------------------------------------------------------------------------------------


def read_spans(path: str | Path, config: Config) -> Frame:
    """The frame in the file `path`, checked against `config`.

    Spans may come in any order and may overlap, and their normals may be illegal (see
    `illegal_spans`). For anything else that the hardware cannot be given, this raises InputError
    with one line that names the file and the fault.
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


def written_for(path: str | Path, config: Config) -> Config:
    """`config` with the bends, or the lights, units and places, of the build that the span file
    `path` is for.

    A file that cannot be read, or that has neither, gives `config`; `read_spans` says what is wrong
    with it.
    """
    try:
        header, _ = _split(Path(path).read_bytes())
        if header["formats"].get("normal_order") == 2:
            return replace(config, name=f"{config.name}_quadratic", normal_order=2)
        lights, fields = header["lights"], header["record"]["fields"]
        one = config.coefficient.one
        coloured = any(c != one for light in lights for row in light["highlight"] for c in row)
        placed, falls = "half_x" in fields, "start_depth" in fields
        return replace(
            config, name=f"{config.name}_lights_{len(lights)}", lights=len(lights),
            units=sum(name.startswith("start_x") for name in fields),
            highlight_colour=coloured or not (len(lights) > 1 or placed or falls),
            span_half_vector=placed, attenuation=falls,
        )  # fmt: skip
    except (OSError, InputError, AttributeError, KeyError, TypeError, ValueError):
        return config


def _split(data: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON object of line 2, and the bytes after that line."""
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
    lights = ["lights"] if isinstance(header, dict) and "lights" in header else []
    _keys("line 2", header, [*keys.split(), *lights, "body_offset"])
    offset = _integer("body_offset", header["body_offset"], 0, len(data))
    if offset != len(magic) + len(line) + 2:
        raise InputError(
            f"body_offset is {offset}, but line 2 ends at {len(magic) + len(line) + 2}"
        )
    return header, data[offset:]


def _frame(header: dict[str, Any], body: bytes, config: Config) -> Frame:
    """The frame of the JSON object `header` and the records `body`."""
    formats = header["formats"] if isinstance(header["formats"], dict) else {}
    for key, expected in _formats(config).items():
        given = formats.get(key)
        if given != expected:
            raise InputError(f"formats.{key} is {given}, but the pipeline is built for {expected}")
    if config.normal_order == 1 and formats.get("normal_order", 1) != 1:
        raise InputError("the spans have bends, but the pipeline is built without normal_order 2")
    if header["record"] != _record(config):
        raise InputError("record: the layout is not that of the pipeline")
    width = _integer("width", header["width"], 1, config.max_size)
    height = _integer("height", header["height"], 1, config.max_size)
    hx, hz = _half_vector("half_vector", header["half_vector"], config)
    if not isinstance(header["two_sided"], bool):
        raise InputError("two_sided is neither true nor false")
    white = config.white
    red, green, blue = _integers("background", header["background"], 3, 0, white)
    materials, named = _materials(header["materials"], config)
    further = _lights(header, materials, config)

    each = -(-(1 + len(further)) // config.span_units)  # records a span
    size = each * record_bits(config) // 8
    count = _integer("spans", header["spans"], 0, None)
    if len(body) != count * size:
        raise InputError(
            f"{count} spans of {size} bytes are announced, but {len(body)} bytes follow line 2"
        )
    records, values, fields = _unpack(body, config)
    spans = records[each - 1 :: each].copy()  # the last record has `last`
    if config.sums_lights:
        _read_turns(spans, records, values, further, each)
    _reject("length is zero", spans["length"] == 0)
    _reject(
        f"reaches beyond the width of {width}",
        spans["x"].astype(np.int64) + spans["length"] > width,
    )
    _reject(f"y is beyond the height of {height}", spans["y"] >= height)
    _reject("names a material that line 2 does not give", ~named[spans["material"]])
    _reject("is marked as the last, but more follow", spans["last"][:-1])
    _reject("is the last, but not marked so", ~spans["last"][-1:], len(spans) - 1)
    frame = Frame(
        width, height, (hx, hz), header["two_sided"], (red, green, blue), materials, spans, further
    )
    if config.span_half_vector:
        frame.half_vectors = _of_lights(fields, ("half_x", "half_z"), frame, each, config)
        zero = (frame.half_vectors == 0).all(axis=2)
        _reject("a half vector has length zero", np.any(zero, axis=0))
    if config.attenuation:
        frame.depths = _of_lights(fields, ("start_depth", "step_depth"), frame, each, config)
        frame.falloff = np.array([light["falloff"] for light in header["lights"]], np.int64)
    return frame


def _of_lights(
    fields: dict[str, Ints], names: tuple[str, str], frame: Frame, each: int, config: Config
) -> Ints:
    """Two fields of the records for each light, int64[L, n, 2]. each: records of a span."""
    found = np.zeros((frame.lights, len(frame.spans), 2), np.int64)
    for number in range(frame.lights):
        turn, unit = divmod(number, config.units)
        for k, name in enumerate(names):
            found[number, :, k] = fields[name + (f"_{unit}" if unit else "")][turn::each]
    return found


def _lights(header: dict[str, Any], table: MaterialTable, config: Config) -> list[FurtherLight]:
    """The further lights of line 2, without start and step; the first light's highlights go to
    `table`."""
    if ("lights" in header) != config.sums_lights:
        need = "needs" if "lights" in header else "has no"
        raise InputError(f"line 2 {need} lights, which is not what the pipeline is built for")
    if not config.sums_lights:
        return []
    lights = header["lights"]
    if not isinstance(lights, list) or not 1 <= len(lights) <= config.lights:
        raise InputError(f"lights is not a list of 1 to {config.lights} lights")
    used = [row["index"] for row in header["materials"]]
    most = config.coefficient.max
    found = []
    for number, light in enumerate(lights):
        name = f"lights[{number}]"
        falloff = ["falloff"] if config.attenuation else []
        _keys(name, light, ["half_vector", "diffuse", "highlight", *falloff])
        if falloff:
            points, one = light["falloff"], config.coefficient.one
            _integers(f"{name}.falloff", points, config.weight_points, 0, one)
        hx, hz = _half_vector(f"{name}.half_vector", light["half_vector"], config)
        columns = {}
        for key in ("diffuse", "highlight"):
            rows = light[key]
            if not isinstance(rows, list) or len(rows) != len(used):
                raise InputError(f"{name}.{key} is not a list of {len(used)} rows")
            column = np.zeros_like(table.diffuse)
            for index, row in zip(used, rows, strict=True):
                column[index] = _integers(f"{name}.{key}", row, 3, 0, most)
            columns[key] = column
        nothing = np.zeros((0, 3), np.int64)
        found.append(FurtherLight((hx, hz), nothing, nothing, **columns))
    if (found[0].diffuse != table.diffuse).any() or list(found[0].half_vector) != header[
        "half_vector"
    ]:
        raise InputError("lights[0] differs from half_vector or the materials' diffuse")
    table.highlight = found[0].highlight
    return found[1:]


def _read_turns(
    spans: Spans,
    records: Spans,
    values: list[tuple[Ints, Ints]],
    further: list[FurtherLight],
    each: int,
) -> None:
    """Give `spans` (SPAN_DTYPE[n]) and the `further` lights their start and step, from the
    `records`, `each` a span. values: start and step of each unit in all records."""
    for name in ("x", "y", "length", "material"):
        same = records[name].reshape(-1, each) == spans[name][:, None]
        _reject(f"its records differ in {name}", np.any(~same, axis=1))
    early = records["last"].reshape(-1, each)[:, :-1]
    _reject("a record before its last one is marked as the last", np.any(early, axis=1))
    units = len(values)
    for number in range(each * units):
        turn, unit = divmod(number, units)
        start, step = (v[turn::each].copy() for v in values[unit])
        if number == 0:
            spans["start"], spans["step"] = start, step
        elif number <= len(further):
            further[number - 1].start, further[number - 1].step = start, step
        else:
            _reject("a unit without a light has a normal", np.any((start | step) != 0, axis=1))


def _materials(rows: Any, config: Config) -> tuple[MaterialTable, Flags]:
    """The material table, and which of its rows the list `rows` gives (bool[M])."""
    if not isinstance(rows, list):
        raise InputError("materials is not a list")
    table, given = MaterialTable.empty(config), np.zeros(config.materials, bool)
    one, n_one = config.coefficient.one, config.exponent.one
    most = config.coefficient.max if config.sums_lights else one
    first = rows[0] if rows and isinstance(rows[0], dict) else {}
    more = [name for name in REFLECTANCE if name in first]
    if "curve" in more:
        table.curve = power_words(table.exponent, config)
    for name in more:
        if name != "curve":
            setattr(table, name, np.zeros((config.materials, MAX_JUMPS, 3), np.int64))
    for place, row in enumerate(rows):
        keys = ["index", "ambient", "diffuse", "weight", "exponent", *more]
        _keys(f"materials[{place}]", row, keys)
        index = _integer(f"materials[{place}].index", row["index"], 0, config.materials - 1)
        name = f"material {index}"
        if given[index]:
            raise InputError(f"{name} is given twice")
        given[index] = True
        table.ambient[index] = _integers(f"{name}: ambient", row["ambient"], 3, 0, most)
        table.diffuse[index] = _integers(f"{name}: diffuse", row["diffuse"], 3, 0, most)
        if not config.sums_lights and (table.ambient[index] + table.diffuse[index] > one).any():
            raise InputError(f"{name}: ambient + diffuse, which is Cp, is above {one}")
        top = config.coefficient.max if "weight_jumps" in more else one
        table.weight[index] = _integers(
            f"{name}: weight", row["weight"], config.weight_points, 0, top
        )
        least = 0 if "curve" in more else n_one
        table.exponent[index] = _integer(
            f"{name}: exponent", row["exponent"], least, MAX_EXPONENT * n_one
        )
        _read_reflectance(table, index, row, more, config)
    return table, given


def _read_reflectance(
    table: MaterialTable, index: int, row: dict[str, Any], more: list[str], config: Config
) -> None:
    """The curve and the jumps of a row of line 2. more: those of REFLECTANCE that it has."""
    name = f"material {index}"
    if "curve" in more and table.curve is not None:
        lines, most = row["curve"], config.coefficient.max
        if not isinstance(lines, list) or len(lines) != table.curve.shape[1]:
            raise InputError(f"{name}: curve is not a list of {table.curve.shape[1]} lines")
        for k, line in enumerate(lines):
            left, step = _integers(f"{name}: curve[{k}]", line, 2, -most, most)
            if not (0 <= left and 0 <= left + step <= most):
                raise InputError(f"{name}: curve[{k}] leaves the range from 0 to {most}")
            table.curve[index, k] = left, step
    for key, operand in (("curve_jumps", config.versine), ("weight_jumps", config.cosine)):
        if key not in more:
            continue
        jumps = row[key]
        if not isinstance(jumps, list) or len(jumps) != MAX_JUMPS:
            raise InputError(f"{name}: {key} is not a list of {MAX_JUMPS} jumps")
        for k, jump in enumerate(jumps):
            above, threshold, amount = _integers(f"{name}: {key}[{k}]", jump, 3, 0, operand.max)
            if above > 1 or amount > config.coefficient.max:
                raise InputError(f"{name}: {key}[{k}] is not [0 or 1, threshold, amount]")
            getattr(table, key)[index, k] = above, threshold, amount


def _keys(name: str, value: Any, keys: list[str]) -> None:
    """Raise InputError if `value` is not an object with exactly these `keys`."""
    if not isinstance(value, dict):
        raise InputError(f"{name} is not a JSON object")
    for key in keys:
        if key not in value:
            raise InputError(f"{name} has no key `{key}`")
    for key in value:
        if key not in keys:
            raise InputError(f"{name} has an unknown key `{key}`")


def _integer(name: str, value: Any, low: int, high: int | None) -> int:
    """`value`, if it is an integer from `low` to `high`; else InputError is raised."""
    if type(value) is not int or value < low or (high is not None and value > high):
        limits = f"from {low} to {high}" if high is not None else f"of {low} or more"
        shown = json.dumps(value)
        raise InputError(f"{name} is {shown[:40]}, not a whole number {limits}")
    return value


def _half_vector(name: str, value: Any, config: Config) -> tuple[int, int]:
    """`value` as (hx, hz) in `Config.half_vector`, if its length is 1.

    Rounding moves one component by at most 1/2 LSB, and the clamp below 1 the other one by at most
    1 LSB, so the length by at most sqrt(5)/2 LSB. Raises InputError.
    """
    fmt = config.half_vector
    hx, hz = _integers(name, value, 2, fmt.min, fmt.max)
    if not abs(math.hypot(hx, hz) - fmt.one) <= math.sqrt(5) / 2:
        raise InputError(f"{name} has length {math.hypot(hx, hz) / fmt.one:.6f}, not 1")
    return hx, hz


def _integers(name: str, value: Any, count: int, low: int, high: int) -> list[int]:
    """`value`, if it is a list of `count` integers from `low` to `high`; else InputError is
    raised."""
    if not isinstance(value, list) or len(value) != count:
        raise InputError(f"{name} is not a list of {count} whole numbers")
    return [_integer(f"{name}[{i}]", v, low, high) for i, v in enumerate(value)]


def _reject(fault: str, bad: Flags, first: int = 0) -> None:
    """Raise InputError that names the first span of `bad` (bool[n]); `bad[0]` is span `first`."""
    if bad.any():
        raise InputError(f"span {first + int(np.argmax(bad))}: {fault}")
