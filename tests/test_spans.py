"""The span file: exact round trips, the documented layout, and every way to be malformed."""

import dataclasses
import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from phong75.model.config import DEFAULT, TECHNIQUES, Format
from phong75.model.frame import SPAN_DTYPE, Frame, InputError, MaterialTable, half_vector_codes
from phong75.model.spans import (
    illegal_spans,
    pack,
    read_spans,
    record_bits,
    span_fields,
    unpack,
    write_spans,
)

#: A configuration in which no width is that of the default one, and fields straddle words.
NARROW = dataclasses.replace(
    DEFAULT,
    name="narrow",
    coordinate_bits=9,
    normal=Format(True, 1, 19),
    material_bits=3,
    weight_index_bits=3,
    coefficient=Format(False, 1, 11),
)


def frame_of(spans, config=DEFAULT, width=64, height=48):
    """A frame with `spans` (tuples in the order of SPAN_DTYPE) and one material in colour."""
    table = MaterialTable.empty(config)
    ramp = np.linspace(0, 1, config.weight_points)
    table.set(1, (0.9, 0.5, 1.0), 0.25, ramp, 10.5, config)
    array = np.array(spans, SPAN_DTYPE)
    half_vector = half_vector_codes([-0.6, 0.0, 0.8], config)
    return Frame(width, height, half_vector, True, (1, 2, 255), table, array)


def span(
    x=0, y=0, length=1, start=(0, 0, 1), step=(0, 0, 0), material=1, last=False, bend=(0, 0, 0)
):
    return (x, y, length, start, step, material, last, bend)


def assert_same(a: Frame, b: Frame):
    for name in ("width", "height", "half_vector", "two_sided", "background"):
        assert getattr(a, name) == getattr(b, name), name
    for name in ("ambient", "diffuse", "weight", "exponent"):
        np.testing.assert_array_equal(getattr(a.materials, name), getattr(b.materials, name), name)
    assert a.spans.dtype == b.spans.dtype
    np.testing.assert_array_equal(a.spans, b.spans)


@st.composite
def frames(draw):
    config = draw(st.sampled_from([DEFAULT, NARROW]))
    # Ends of the ranges are what a packing gets wrong; half of all values come from there.
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(0, 40))

    def codes(fmt, shape):
        values = rng.integers(fmt.min, fmt.max, shape, endpoint=True)
        ends = rng.choice([fmt.min, fmt.max, 0, -1 if fmt.signed else 1], shape)
        return np.where(rng.random(shape) < 0.5, values, ends)

    width = draw(st.integers(1, config.max_size))
    height = draw(st.integers(1, config.max_size))
    spans = np.zeros(count, SPAN_DTYPE)
    spans["x"] = rng.integers(0, width, count)
    spans["y"] = rng.integers(0, height, count)
    spans["length"] = rng.integers(1, width - spans["x"], count, endpoint=True)
    spans["start"] = codes(config.normal, (count, 3))
    spans["step"] = codes(config.normal, (count, 3))
    spans["material"] = rng.integers(0, config.materials, count)
    spans["last"][-1:] = True
    table = MaterialTable.empty(config)
    for index in draw(st.sets(st.integers(0, config.materials - 1))):
        weight = rng.random(config.weight_points)
        table.set(index, rng.random(3), rng.random(), weight, rng.uniform(1, 128), config)
    angle = rng.uniform(-np.pi, np.pi)
    half = half_vector_codes([np.sin(angle), 0.0, np.cos(angle)], config)
    background = tuple(int(c) for c in rng.integers(0, 255, 3, endpoint=True))
    frame = Frame(width, height, half, draw(st.booleans()), background, table, spans)
    return config, frame


@settings(max_examples=100, deadline=None, derandomize=True)
@given(frames())
def test_round_trip_is_exact(tmp_path_factory, made):
    config, frame = made
    path = tmp_path_factory.mktemp("spans", numbered=True) / "spans"
    write_spans(path, frame, config)
    first = path.read_bytes()
    assert_same(read_spans(path, config), frame)
    write_spans(path, frame, config)
    assert path.read_bytes() == first


@pytest.mark.parametrize("config", [DEFAULT, NARROW], ids=lambda c: c.name)
def test_fields_lie_side_by_side(config):
    lsb = 0
    for field in span_fields(config):
        assert field.lsb == lsb
        lsb += field.bits
    assert lsb <= record_bits(config) < 2 * max(lsb, 64)


def test_layout_of_the_default_configuration():
    """Written down once more, by hand: the RTL and other people's programs rely on it."""
    spans = [span(0xABC, 0x123, 0x1000, (-1, 2, 0x7FFFFFFF), (3, -(2**31), 5), 9, True)]
    word = int.from_bytes(pack(np.array(spans, SPAN_DTYPE), DEFAULT), "big")
    fields = [  # lsb, bits, value
        (0, 32, 0xFFFFFFFF), (32, 32, 2), (64, 32, 0x7FFFFFFF),
        (96, 32, 3), (128, 32, 0x80000000), (160, 32, 5),
        (192, 12, 0xABC), (204, 12, 0x123), (216, 13, 0x1000), (229, 4, 9), (233, 1, 1),
    ]  # fmt: skip
    assert word == sum(value << lsb for lsb, _, value in fields)
    assert record_bits(DEFAULT) == 256


def test_layout_of_the_older_techniques():
    """Gouraud's steps, three colours and one; flat: no steps, and no room for one. What a record
    leaves out comes back."""
    start, step = (-1, 2, 0x7FFFFFFF), (3, -(2**31), 5)
    place = [(0, 12, 0xABC), (12, 12, 0x123), (24, 13, 0x1000), (37, 4, 9), (41, 1, 1)]

    def laid_out(config, *values):
        spans = np.zeros(1, SPAN_DTYPE)
        spans[0] = span(0xABC, 0x123, 0x1000, (0, 0, 0), (0, 0, 0), 9, True)
        for what, codes in zip(("start", "step"), values, strict=False):
            spans[what][0] = codes
        whole = pack(spans, config)
        assert unpack(whole, config) == spans
        codes = [code & 0xFFFFFFFF for value in values for code in value]
        want = sum(code << 32 * k for k, code in enumerate(codes))
        want += sum(value << 32 * len(codes) + lsb for lsb, _, value in place)
        assert int.from_bytes(whole, "big") == want
        return len(whole)

    gouraud, flat = TECHNIQUES["gouraud"], TECHNIQUES["flat"]
    grey = {"name": "grey", "channels": 1}
    assert laid_out(gouraud, start, step) == 32
    assert laid_out(dataclasses.replace(gouraud, **grey), start[:1], step[:1]) == 16
    assert laid_out(flat, start) == 32
    assert laid_out(dataclasses.replace(flat, **grey), start[:1]) == 16
    for config, wrong in ((flat, (0, 0, 1)), (dataclasses.replace(gouraud, **grey), step)):
        with pytest.raises(ValueError, match="no place for"):
            laid_out(config, start[:1], wrong)


def test_body_starts_where_the_header_says(tmp_path):
    path = tmp_path / "spans"
    frame = frame_of([span(), span(3, last=True)])
    write_spans(path, frame, DEFAULT)
    data = path.read_bytes()
    magic, line, _ = data.split(b"\n", 2)
    header = json.loads(line)
    assert magic == b"phong75-spans 1"
    assert header["body_offset"] % header["record"]["bytes"] == 0
    assert data[header["body_offset"] :] == pack(frame.spans, DEFAULT)
    assert [m["index"] for m in header["materials"]] == [1]


@pytest.mark.parametrize("field", ["x", "y", "length", "material", "start", "step"])
def test_values_that_do_not_fit_are_not_cut(field):
    spans = np.array([span(last=True)], SPAN_DTYPE)
    spans[field] = 1 << (31 if spans[field].dtype == np.int64 else 30)
    with pytest.raises(ValueError, match=field):
        pack(spans, DEFAULT)
    if field in ("x", "y", "length", "material"):
        spans[field] = -1
        with pytest.raises(ValueError, match=field):
            pack(spans, DEFAULT)


def test_illegal_spans():
    top, bottom = DEFAULT.normal.max, DEFAULT.normal.min
    frame = frame_of(
        [
            span(length=2, start=(top - 1, 0, 0), step=(1, 0, 0)),
            span(length=3, start=(top - 1, 0, 0), step=(1, 0, 0)),
            span(length=4096, start=(0, bottom + 4095, 0), step=(0, -1, 0)),
            span(length=4096, start=(0, bottom + 4094, 0), step=(0, -1, 0)),
            span(length=4096, step=(0, 0, bottom)),
            span(length=1, step=(0, 0, bottom)),
            span(length=0),
        ]
    )
    expected = [False, True, False, True, True, False, False]
    assert illegal_spans(frame, DEFAULT).tolist() == expected


def test_illegal_normals_overlaps_and_any_order_are_read(tmp_path):
    frame = frame_of(
        [
            span(9, 9, 50, (DEFAULT.normal.max,) * 3, (DEFAULT.normal.max,) * 3),
            span(0, 0, 64),
            span(0, 0, 64, last=True),
        ]
    )
    write_spans(tmp_path / "spans", frame, DEFAULT)
    assert_same(read_spans(tmp_path / "spans", DEFAULT), frame)


# -- malformed files -------------------------------------------------------------------------------


@pytest.fixture
def broken(tmp_path):
    """Returns a function that gives the error message for a good file after a change to it."""
    path = tmp_path / "spans"
    write_spans(path, frame_of([span(), span(3, 4, 5), span(8, last=True)]), DEFAULT)
    good = path.read_bytes()

    def error(change=None, body=None, raw=None):
        if raw is not None:
            path.write_bytes(raw(good))
        else:
            _, line, rest = good.split(b"\n", 2)
            header = json.loads(line)
            change(header)
            text = json.dumps(header).encode()
            # The header changed its length: say where the body is now.
            header["body_offset"] = (len(text) + 200) // 32 * 32
            text = json.dumps(header).encode()
            text = b"phong75-spans 1\n" + text.ljust(header["body_offset"] - 17) + b"\n"
            path.write_bytes(text + (rest if body is None else body))
        with pytest.raises(InputError) as caught:
            read_spans(path, DEFAULT)
        message = str(caught.value)
        assert "\n" not in message and message.startswith(f"{path}: ")
        return message

    return error


def setter(key, value):
    """A change that sets header["a"]["b"]... for `key` "a.b..." (digits index lists)."""

    def change(header):
        *path, name = [int(k) if k.isdigit() else k for k in key.split(".")]
        for k in path:
            header = header[k]
        header[name] = value

    return change


@pytest.mark.parametrize(
    ("key", "value", "says"),
    [
        ("width", 0, "width is 0, not a whole number from 1 to 4096"),
        ("width", 4097, "width is 4097"),
        ("height", -1, "height is -1"),
        ("height", 4.5, "height is 4.5"),
        ("height", True, "height is true"),
        ("height", "10", 'height is "10"'),
        ("height", 10**40, "height is 1000"),
        ("half_vector", [0, 0], "half_vector has length 0.000000, not 1"),
        ("half_vector", [1, 0], "half_vector has length 0.000008, not 1"),
        ("half_vector", [93000, 1000], "half_vector has length 0.709575, not 1"),
        ("half_vector", [131071, 1000], "half_vector has length 1.000021, not 1"),
        ("half_vector", [1], "half_vector is not a list of 2"),
        ("half_vector", [1, 1 << 17], "half_vector[1] is 131072"),
        ("half_vector", None, "half_vector is not a list"),
        ("two_sided", 1, "two_sided is neither true nor false"),
        ("background", [0, 0, 256], "background[2] is 256"),
        (
            "formats.technique",
            "flat",
            "formats.technique is flat, but the pipeline is built for ph",
        ),
        ("materials", {}, "materials is not a list"),
        ("materials", [], "span 0: names a material"),
        ("materials", [7], "materials[0] is not a JSON object"),
        ("materials.0.index", 16, "materials[0].index is 16"),
        ("materials.0.ambient", [0, 65537, 0], "material 1: ambient[1] is 65537"),
        ("materials.0.diffuse", [0, 65000, 0], "material 1: ambient + diffuse"),
        ("materials.0.weight.32", 65537, "material 1: weight[32] is 65537"),
        ("materials.0.weight", [0] * 32, "material 1: weight is not a list of 33"),
        ("materials.0.exponent", 511, "material 1: exponent is 511"),
        ("materials.0.exponent", 128 * 512 + 1, "material 1: exponent is 65537"),
        ("materials.0.gloss", 1, "materials[0] has an unknown key `gloss`"),
        ("formats.normal", "s1.16", "formats.normal is s1.16, but the pipeline is built for s1.30"),
        ("formats", 3, "formats.technique is None"),
        ("record.bytes", 64, "record"),
        ("spans", -1, "spans is -1"),
        ("spans", 2, "2 spans of 32 bytes are announced, but 96 bytes follow"),
        ("spans", 4, "4 spans of 32 bytes are announced, but 96 bytes follow"),
        ("hight", 4, "line 2 has an unknown key `hight`"),
    ],
)
def test_malformed_header(broken, key, value, says):
    assert says in broken(setter(key, value))


def test_missing_key_and_double_material(broken):
    assert "has no key `height`" in broken(lambda h: h.pop("height"))
    assert "material 1 is given twice" in broken(lambda h: h["materials"].extend(h["materials"]))


@pytest.mark.parametrize(
    ("bad", "says"),
    [
        ([span(length=0, last=True)], "span 0: length is zero"),
        ([span(), span(60, length=5, last=True)], "span 1: reaches beyond the width of 64"),
        ([span(), span(length=8191, last=True)], "span 1: reaches beyond the width of 64"),
        ([span(y=48, last=True)], "span 0: y is beyond the height of 48"),
        ([span(material=2, last=True)], "span 0: names a material that line 2 does not give"),
        ([span(last=True), span(last=True)], "span 0: is marked as the last, but more follow"),
        ([span(), span(), span()], "span 2: is the last, but not marked so"),
    ],
)
def test_malformed_spans(broken, bad, says):
    body = pack(np.array(bad, SPAN_DTYPE), DEFAULT)
    assert broken(setter("spans", len(bad)), body).endswith(says)


def test_padding_is_zero(broken):
    body = b"\x80" + pack(np.array([span(last=True)], SPAN_DTYPE), DEFAULT)[1:]
    assert broken(setter("spans", 1), body).endswith("span 0: padding is not zero")
    with pytest.raises(InputError):
        unpack(body, DEFAULT)


@pytest.mark.parametrize(
    ("raw", "says"),
    [
        (lambda good: b"", "not a span file"),
        (lambda good: b"\x89PNG\r\n\x1a\n\0\0", "not a span file"),
        (lambda good: good.replace(b"spans 1", b"spans 2", 1), "another version"),
        (lambda good: good[:15], "line 2 does not end"),
        (lambda good: good[:100], "line 2 does not end"),
        (lambda good: good[:-1], "3 spans of 32 bytes are announced, but 95 bytes follow"),
        (lambda good: good + b"\n", "3 spans of 32 bytes are announced, but 97 bytes follow"),
        (lambda good: good.replace(b"{", b"(", 1), "line 2 is not JSON"),
        (lambda good: b"phong75-spans 1\n\xff\xfe{\n", "line 2 is not JSON"),
        (lambda good: b"phong75-spans 1\n" + b"[" * 10**5 + b"\n", "line 2 is not JSON"),
        (lambda good: b"phong75-spans 1\n[]\n", "line 2 is not a JSON object"),
        (lambda good: good.replace(b" \n", b"\n", 1), "body_offset is"),
    ],
)
def test_malformed_files(broken, raw, says):
    assert says in broken(raw=raw)


def test_unreadable_files(tmp_path):
    with pytest.raises(InputError, match="cannot read .*nowhere: No such file"):
        read_spans(tmp_path / "nowhere", DEFAULT)
    with pytest.raises(InputError, match="cannot read .*: Is a directory"):
        read_spans(tmp_path, DEFAULT)
