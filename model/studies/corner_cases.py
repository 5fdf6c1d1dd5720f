# SPDX-License-Identifier: MIT
"""Corner cases: frames of extreme input, each with the behaviour that is expected of the RTL.

In every case the pixels of the RTL must equal those of the twin bit for bit, none may be missing,
zero normals must be flagged, and the error against the float64 reference of the integers at the
ports must be within the derived bound (`error_budget`). `cases` returns all cases, `frames` only
their frames. sim/frame/corner_cases.py runs the cases and judges them. Most frames are directed
spans in integers; the frames of triangles go through the front end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from phong75.model.analysis import undecided
from phong75.model.arrays import ArrayLike, Flags, Ints, Reals, Spans
from phong75.model.config import DEFAULT as C
from phong75.model.config import MAX_JUMPS
from phong75.model.frame import (
    SPAN_DTYPE,
    Frame,
    FurtherLight,
    MaterialTable,
    half_vector_codes,
    walked,
    with_lights,
)
from phong75.model.front import visibility
from phong75.model.front.camera import Camera, light_frame
from phong75.model.front.mesh import Mesh, normalize
from phong75.model.front.scene import Light, Material, Scene, SceneObject
from phong75.model.front.scene_to_spans import encode
from phong75.model.front.visibility import GRID
from phong75.model.places import Falloff, Place
from phong75.model.reflectance import (
    Curve,
    Polyline,
    Power,
    curve_words,
    power_words,
    weight_points,
)
from phong75.model.scene_to_frame import front_end
from phong75.model.twin import Pixels, render

#: Specular exponents of the materials in the cases.
EXPONENTS = (1, 1.5, 2, 10, 64, 127, 128)

#: Default angle from light to eye, radians.
ANGLE = np.radians(40)

#: Number of pixels that `errors` processes at a time; this bounds the memory.
BLOCK = 1 << 17


def _no_check(frame: Frame, got: Pixels) -> list[str]:
    return []


@dataclass(frozen=True)
class CornerCase:
    """One corner case.

    extreme: what is extreme in the input. expected: the expected behaviour.
    check: an additional check of the RTL's pixels, check(frame, pixels); returns one message per
    failure.
    full_rate: whether one pixel per cycle must leave the pipeline.
    """

    name: str
    extreme: str
    expected: str
    frame: Frame
    check: Callable[[Frame, Pixels], list[str]] = _no_check
    full_rate: bool = False


# -- directed frames -------------------------------------------------------------------------------


def _materials(*rows: tuple[ArrayLike, float, ArrayLike, float]) -> MaterialTable:
    """The material table of `rows` (Cp, d, W, n)."""
    table = MaterialTable.empty(C)
    for index, (cp, d, weight, n) in enumerate(rows):
        table.set(index, cp, d, np.broadcast_to(weight, C.weight_points), n, C)
    return table


def _every_exponent() -> MaterialTable:
    """For each of EXPONENTS a coloured material; then for each a material with only a highlight."""
    coloured = [((0.6, 0.3, 0.05), 0.1, 0.4, n) for n in EXPONENTS]
    return _materials(*coloured, *[((0, 0, 0), 0, 1, n) for n in EXPONENTS])


def _half_vector(angle: float) -> tuple[int, int]:
    """Codes of the half vector for `angle` (radians) from light to eye."""
    return half_vector_codes(np.array([np.sin(angle), 0, np.cos(angle)]), C)


def _span(start: ArrayLike, step: ArrayLike, length: ArrayLike, material: ArrayLike = 0) -> Spans:
    """SPAN_DTYPE[n]. start, step: codes, int[n, 3] or [3]. length, material: int[n] or int."""
    start = np.asarray(start, np.int64)
    spans = np.zeros(np.broadcast_shapes(start.shape[:-1], np.shape(length), np.shape(step)[:-1],
                                         np.shape(material)) or (1,), SPAN_DTYPE)  # fmt: skip
    spans["start"], spans["step"] = start, step
    spans["length"], spans["material"] = length, material
    return spans


def _between(first: Reals, last: Reals, length: ArrayLike, material: ArrayLike = 0) -> Spans:
    """Spans from normals `first` to `last`, float64[n, 3], components within `Config.normal`."""
    length = np.broadcast_to(length, (len(first),))
    step = (last - first) / np.maximum(length - 1, 1)[:, None]
    return _span(*encode(first, step, length, C), length, material)


def _frame(
    spans: Spans,
    table: MaterialTable | None = None,
    angle: float = ANGLE,
    two_sided: bool = False,
    half_vector: tuple[int, int] | None = None,
) -> Frame:
    """A frame of `spans`; x, y and last are set so that no two spans overlap.

    angle: from light to eye, radians. half_vector: codes, override `angle`.
    """
    longest = int(spans["length"].max())
    columns = max(1, min(C.max_size // longest, -(-len(spans) // 4)))
    index = np.arange(len(spans))
    spans["x"], spans["y"] = index % columns * longest, index // columns
    spans["last"] = index == len(spans) - 1
    return Frame(
        columns * longest, int(spans["y"].max()) + 1, half_vector or _half_vector(angle),
        two_sided, (0, 0, 0), _every_exponent() if table is None else table, spans,
    )  # fmt: skip


def _directions(rng: np.random.Generator, count: int) -> Reals:
    """Unit vectors float64[count, 3], uniform on the sphere."""
    return normalize(rng.normal(size=(count, 3)))


def _normals(frame: Frame) -> np.ndarray:
    """The interpolated normal of every pixel of a legal frame, codes int64[n, 3]."""
    spans = frame.spans
    span = np.repeat(np.arange(len(spans)), spans["length"])
    k = np.arange(len(span)) - np.repeat(np.cumsum(spans["length"]) - spans["length"],
                                         spans["length"])  # fmt: skip
    return spans["start"][span] + k[:, None] * spans["step"][span]


def _material(frame: Frame) -> np.ndarray:
    """The material index of every pixel of a legal frame, int[n]."""
    return np.repeat(frame.spans["material"], frame.spans["length"])


def dark_stays_ambient(frame: Frame, got: Pixels) -> list[str]:
    """Check that every pixel that is not lit has exactly the rounded ambient term Cp d."""
    z = _normals(frame)[:, 2]
    dark = z == 0 if frame.two_sided else z <= 0
    ambient = frame.materials.ambient[_material(frame)[dark]]
    white = C.white
    want = (ambient * white + C.coefficient.one // 2) >> C.coefficient.fraction
    wrong = int((got.rgb[dark] != want).any(axis=1).sum())
    return [f"{wrong} of {int(dark.sum())} dark pixels are not Cp d"] if wrong else []


# -- directions and lengths ------------------------------------------------------------------------


def _ends_apart() -> Iterator[CornerCase]:
    rng = np.random.default_rng(1)
    for degrees in (120, 170, 179, 179.9, 179.99):
        first = _directions(rng, 56)
        axis = normalize(np.cross(first, rng.normal(size=first.shape)))
        turn = np.radians(degrees)
        last = np.cos(turn) * first + np.sin(turn) * np.cross(axis, first)
        material = np.arange(56) % (2 * len(EXPONENTS))
        yield CornerCase(
            f"ends {degrees}° apart",
            f"normals at the ends of a span {degrees}° apart; the length falls to "
            f"{np.cos(turn / 2):.2g} in the middle",
            "within the same bound: the components are shifted before they are squared",
            _frame(_between(first, last, 257, material)),
            dark_stays_ambient,
        )
    step = rng.integers(-(1 << 22), 1 << 22, (56, 3))
    yield CornerCase(
        "ends exactly opposed",
        "ends that cancel to the last bit: the normal in the middle is the zero vector",
        "Cp d there, flagged once per span; accurate one pixel beside it",
        _frame(_span(-128 * step, step, 257, np.arange(56) % 14)),
        lambda f, p: dark_stays_ambient(f, p) + _zeros(f, 56),
    )
    across, down = np.array([1 << 23, 0, 1 << 22]), np.array([1 << 20, 1 << 23, -(1 << 22)])
    line = np.arange(-64, 65)[:, None]
    yield CornerCase(
        "plane through zero",
        "normals linear in x and y that are exactly zero at one pixel",
        "Cp d at that pixel, flagged; every direction accurate around it",
        _frame(_span(line * down - 64 * across, across, 129, np.arange(129) % 7)),
        lambda f, p: dark_stays_ambient(f, p) + _zeros(f, 1),
    )
    turn = np.radians([90, 210, 330])
    normals = np.stack([np.cos(turn), np.zeros(3), np.sin(turn)], axis=1)
    corners = np.array([[[4.0, 4.0], [30.0, 300.0], [316.0, 150.0]]])
    yield CornerCase(
        "three normals at 120°",
        "the normals of a triangle's corners cancel at its centre",
        "every pixel of the triangle once; accurate from the integers at the ports",
        _picture(corners, normals[None], 320, 304),
        _once,
    )


def _zeros(frame: Frame, count: int) -> list[str]:
    """Check that `frame` has `count` pixels whose normal is the zero vector."""
    zeros = int((_normals(frame) == 0).all(axis=1).sum())
    return [] if zeros == count else [f"the case has {zeros} zero vectors, expected {count}"]


def _lengths() -> Iterator[CornerCase]:
    rng = np.random.default_rng(2)
    for two_sided in (False, True):
        yield CornerCase(
            f"zero vector{', two-sided' if two_sided else ''}",
            "spans of zero vectors only, of every material",
            "Cp d, every pixel flagged",
            _frame(_span([0, 0, 0], 0, np.arange(1, 29), np.arange(28) % 14), two_sided=two_sided),
            dark_stays_ambient,
        )
    grid = np.stack(np.meshgrid(*[np.arange(-2, 3)] * 3), axis=-1).reshape(-1, 3)
    yield CornerCase(
        "normals of a few units",
        "all normals with components of -2 to 2 LSB",
        "within the same bound as long normals",
        _frame(_span(np.tile(grid, (14, 1)), 0, 1, np.repeat(np.arange(14), len(grid)))),
        dark_stays_ambient,
    )
    short = 2.0**-20
    yield CornerCase(
        "normals of 2⁻²⁰",
        "ends of length 2⁻²⁰: 1024 LSB",
        "within the same bound as unit normals",
        _frame(_between(short * _directions(rng, 56), short * _directions(rng, 56), 65,
                        np.arange(56) % 14)),
        dark_stays_ambient,
    )  # fmt: skip
    yield CornerCase(
        "lengths 2 to 2⁻²⁰",
        "one end at the limit of the format, the other 2²¹ times shorter",
        "within the same bound as unit normals",
        _frame(_between(1.999 * _directions(rng, 56), short * _directions(rng, 56), 129,
                        np.arange(56) % 14)),
        dark_stays_ambient,
    )  # fmt: skip


# -- spans -----------------------------------------------------------------------------------------


def _spans() -> Iterator[CornerCase]:
    rng = np.random.default_rng(3)
    for length in (1, 2, 3, C.max_size):
        count = 28 if length > 3 else 280
        first, last = _directions(rng, count), _directions(rng, count)
        first[:, 2], last[:, 2] = np.abs(first[:, 2]), np.abs(last[:, 2])
        yield CornerCase(
            f"spans of {length}",
            f"spans of {length} pixel{'s' * (length > 1)}",
            "every pixel once, one pixel per cycle",
            _frame(_between(first, last, length, np.arange(count) % 14)),
            _once,
            full_rate=True,
        )
    low, high = C.normal.min, C.normal.max
    signs = np.stack(np.meshgrid(*[[0, 1]] * 3), axis=-1).reshape(-1, 3).astype(bool)
    up = _span(np.where(signs, low, high), np.where(signs, high, low), 2)
    long = _span(np.where(signs, low, 0), np.where(signs, high, 1), 3)
    down = _span(np.where(signs, high, low), np.where(signs, low, high), 2)
    yield CornerCase(
        "slope at full scale",
        "steps of ±2 per pixel, from one end of the format to the other",
        "no wrap-around; spans that end inside the format are not flagged",
        _frame(np.tile(np.concatenate([up, long, down]), 4), two_sided=True),
        dark_stays_ambient,
    )
    single = _directions(rng, 4096)
    yield CornerCase(
        "4096 spans back to back",
        "spans of one pixel, each of another material, without an idle cycle between",
        "one pixel per cycle",
        _frame(_between(single, single, 1, np.arange(4096) % 14)),
        full_rate=True,
    )


# -- light -----------------------------------------------------------------------------------------


def _light() -> Iterator[CornerCase]:
    for degrees in (0, 40, 100, 170):
        half = np.radians(degrees / 2)
        away = np.radians(30) * np.linspace(-1, 1, 9)
        ends = []
        for side in (-1, 1):
            tilt = half + side * np.radians(30)
            x, z = np.sin(tilt), np.cos(tilt)
            ends.append(np.stack([np.cos(away) * x, np.sin(away), np.cos(away) * z], axis=1))
        first, last = (np.repeat(end, 14, axis=0) for end in ends)
        same = " (Warnock's arrangement)" if degrees == 0 else ""
        yield CornerCase(
            f"highlights, eye at {degrees}°",
            f"highlights of n = 1 to 128 within one facet; eye and light {degrees}° apart{same}",
            "within the bound of the largest n",
            _frame(_between(first, last, 193, np.tile(np.arange(14), 9)), angle=2 * half),
            dark_stays_ambient,
        )
    azimuth = np.linspace(0, 2 * np.pi, 29)[:28]
    grazing = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1)
    start = np.repeat(C.normal.quantize(grazing), 14, axis=0)
    for degrees in (40, 178):
        yield CornerCase(
            f"grazing light, eye at {degrees}°",
            "cos(i) from 0 to 2⁻¹⁶ along a span, in 28 directions",
            "Cp d at exactly 0; lit from Zn = 1 LSB on",
            _frame(_span(start, [0, 0, 64], 257, np.tile(np.arange(14), 28)),
                   angle=np.radians(degrees)),
            dark_stays_ambient,
        )  # fmt: skip
    near = np.stack(np.meshgrid(*[np.arange(-1, 2)] * 3), axis=-1).reshape(-1, 3)
    for degrees in (0, 40, 100, 175):
        h = _half_vector(np.radians(degrees))
        scale = C.normal.fraction - C.half_vector.fraction
        exact = np.array([h[0], 0, h[1]]) << scale
        normals = np.concatenate([exact + (near << shift) for shift in (0, scale)])
        count = len(normals)
        yield CornerCase(
            f"mirror direction, eye at {degrees}°",
            "the normal halfway between light and eye to the last bit, and one LSB beside it",
            "cos(s)ⁿ is 1 for every n: W = 1 gives white",
            _frame(_span(np.tile(normals, (14, 1)), 0, 1, np.repeat(np.arange(14), count)),
                   angle=np.radians(degrees)),
            lambda f, p: [] if p.rgb[_material(f) >= 7].min() == 255 else ["not white"],
        )  # fmt: skip
    behind = _span([0, 0, -C.normal.one], 0, 5, np.arange(14))
    yield CornerCase(
        "light exactly behind",
        "the normal points exactly away from the light",
        "Cp d",
        _frame(behind.copy()),
        dark_stays_ambient,
    )
    yield CornerCase(
        "light exactly behind, two-sided",
        "the normal points exactly away from the light, |Zn| is shaded",
        "the same colour as for the normal towards the light",
        _frame(np.concatenate([behind, _span([0, 0, C.normal.one], 0, 5, np.arange(14))]),
               two_sided=True),
        lambda f, p: [] if np.array_equal(p.rgb[:70], p.rgb[70:]) else ["the colours differ"],
    )  # fmt: skip


def _terminator() -> Iterator[CornerCase]:
    azimuth = np.linspace(0, 2 * np.pi, 28, endpoint=False)
    rim = C.normal.quantize(np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1))
    variants = ((0, "exactly", False), (0, "exactly, two-sided", True), (16, "but for 2⁻¹⁶", False),
                (8, "but for 2⁻⁸", False))  # fmt: skip
    for bits, name, two_sided in variants:
        angle = np.pi - (2.0**-bits if bits else 0)
        across = _span(np.repeat(rim - [0, 0, 8], 14, axis=0), [0, 0, 1], 17,
                       np.tile(np.arange(14), 28))  # fmt: skip
        steep = _span(np.repeat(rim - [0, 0, 1 << 29], 14, axis=0), [0, 0, 1 << 25], 33,
                      np.tile(np.arange(14), 28))  # fmt: skip
        yield CornerCase(
            f"terminator, eye opposite {name}",
            f"Zn through 0 in steps of 1 LSB; eye opposite the light {name}: eq. (3) jumps from "
            "Cp d to Cp d + W",
            "RTL and reference jump between the same two integers, so the bound stays the same",
            _frame(np.concatenate([across, steep]), angle=angle, two_sided=two_sided),
            dark_stays_ambient,
        )


# -- coefficients ----------------------------------------------------------------------------------


def _coefficients() -> Iterator[CornerCase]:
    rng = np.random.default_rng(4)
    first, last = _directions(rng, 64), _directions(rng, 64)
    first[:, 2], last[:, 2] = np.abs(first[:, 2]), np.abs(last[:, 2])
    first[:8] = [np.sin(ANGLE / 2), 0, np.cos(ANGLE / 2)]
    last[4:8] = first[4:8]

    def crossing(materials: int) -> Spans:
        return _between(first, last, 65, np.arange(64) % materials)

    axes = [((1, 0, 0), 0, 0, 1), ((0, 1, 0), 0.5, 0, 1), ((0, 0, 1), 1, 0, 1)]
    full = [((1, 1, 1), d, 1, n) for d, n in ((0, 1), (0.5, 10), (1, 128))]
    yield CornerCase(
        "saturation",
        "sums of up to 2 in each single channel and in all three",
        "white, never a wrap-around to black",
        _frame(crossing(6), _materials(*axes, *full)),
        lambda f, p: [] if (p.rgb[_material(f) == 5] == 255).all() else ["Cp d = 1 is not white"],
    )
    yield CornerCase(
        "coefficients at 0",
        "Cp, d and W all 0, for n = 1 and 128",
        "black",
        _frame(crossing(2), _materials(((0, 0, 0), 0, 0, 1), ((0, 0, 0), 0, 0, 128))),
        lambda f, p: ["not black"] if p.rgb.any() else [],
    )
    yield CornerCase(
        "coefficients at 1",
        "Cp, d and W all 1, for n = 1 and 128",
        "white",
        _frame(crossing(2), _materials(((1, 1, 1), 1, 1, 1), ((1, 1, 1), 1, 1, 128))),
        lambda f, p: ["not white"] if (p.rgb != 255).any() else [],
    )
    sides = np.arange(C.weight_points) % 2
    one_step = np.arange(C.weight_points) > C.weight_points // 2
    rows = [((0, 0.2, 0), 0.5, w, n) for w in (sides, one_step) for n in (1, 10, 128)]
    yield CornerCase(
        "W(i) with steep steps",
        "W from 0 to 1 between neighbouring points, once and 32 times",
        "within the bound, which grows with the steepest slope of W",
        _frame(crossing(6), _materials(*rows)),
    )


# -- triangles, through the front end --------------------------------------------------------------


def _picture(
    corners: ArrayLike, normals: ArrayLike, width: int, height: int, angle: float = ANGLE
) -> Frame:
    """The frame that the front end makes of triangles on the screen.

    corners: float64[T, 3, 2], pixels, y downward. normals: float64[T, 3, 3], light frame. angle:
    from light to eye, radians. One pixel is one scene unit, so that corners map to the scene
    without rounding.
    """
    corners, normals = np.array(corners, float), np.array(normals, float)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    clockwise = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] > 0
    corners[clockwise], normals[clockwise] = corners[clockwise, ::-1], normals[clockwise, ::-1]
    points = np.zeros((len(corners) * 3, 3))
    points[:, 0] = corners[..., 0].ravel() - width / 2
    points[:, 1] = height / 2 - corners[..., 1].ravel()
    mesh = Mesh(points, np.arange(len(points)).reshape(-1, 3), normals)
    camera = Camera("orthographic", np.eye(3), np.zeros(3), np.array([0, 0, 1.0]), float(height))
    light = np.array([-np.sin(angle), 0, np.cos(angle)])
    material = Material((0.6, 0.5, 0.2), 0.1, 32.0, (0.0, 1.0), (0.4, 0.4))
    scene = Scene("stability", width, height, (0, 0, 0), camera, light, False, "linear",
                  [SceneObject("mesh", mesh, 0)], [material])  # fmt: skip
    return front_end(scene).frame


def _once(frame: Frame, got: Pixels) -> list[str]:
    """Check that no pixel is drawn twice."""
    index = got.y * frame.width + got.x
    doubles = len(index) - len(np.unique(index))
    return [f"{doubles} pixels drawn twice"] if doubles else []


def _fills(x0: float, y0: float, x1: float, y1: float) -> Callable[[Frame, Pixels], list[str]]:
    """A check that the pixels with their centre in the rectangle are drawn once, and no other."""

    def check(frame: Frame, got: Pixels) -> list[str]:
        x, y = np.arange(frame.width) + 0.5, np.arange(frame.height) + 0.5
        want = ((y >= y0) & (y < y1))[:, None] & ((x >= x0) & (x < x1))
        count = np.zeros(want.shape, np.int64)
        np.add.at(count, (got.y, got.x), 1)
        faults = ((count > 1, "drawn twice"), (want & (count == 0), "missing"),
                  (~want & (count > 0), "outside"))  # fmt: skip
        return [f"{int(bad.sum())} pixels {fault}" for bad, fault in faults if bad.any()]

    return check


def _grid(x0: float, y0: float, columns: int, rows: int, wide: float, high: float) -> Reals:
    """Corners float64[2 * columns * rows, 3, 2] of a grid of cells, two triangles per cell.

    x0, y0: upper left corner; wide, high: size of a cell; pixels.
    """
    j, i = np.mgrid[:rows, :columns].reshape(2, -1)
    left, top = x0 + i * wide, y0 + j * high
    right, bottom = x0 + (i + 1) * wide, y0 + (j + 1) * high
    a, b = np.stack([left, top], -1), np.stack([right, top], -1)
    c, d = np.stack([left, bottom], -1), np.stack([right, bottom], -1)
    return np.concatenate([np.stack([a, c, d], 1), np.stack([a, d, b], 1)])


def _upward(rng: np.random.Generator, shape: tuple[int, ...]) -> Reals:
    """Random normals with z >= 0, float64[shape]."""
    normals = rng.normal(size=shape)
    normals[..., 2] = np.abs(normals[..., 2])
    return normals


def _triangles() -> Iterator[CornerCase]:
    rng = np.random.default_rng(5)
    every = "every pixel once, none missing; accurate from the integers at the ports"

    def tiled(corners: Reals, width: int, height: int) -> Frame:
        return _picture(corners, _upward(rng, (len(corners), 3, 3)), width, height)

    yield CornerCase(
        "slivers", "2000 triangles a thousandth of a pixel wide and 300 pixels high", every,
        tiled(_grid(2.3, 2, 1000, 1, 0.001, 300), 8, 304), _fills(2.3, 2, 3.3, 302),
    )  # fmt: skip
    for side, cells in ((1.0, 12), (0.1, 120)):
        wide, high = 2 * side, side
        yield CornerCase(
            f"triangles of {side * side:g} pixel",
            f"a rectangle cut into triangles of {side * side:g} pixel area, {wide:g} wide and "
            f"{high:g} high", every,
            tiled(_grid(1.25, 1.25, cells, cells, wide, high), 32, 32),
            _fills(1.25, 1.25, 1.25 + cells * wide, 1.25 + cells * high),
        )  # fmt: skip
    corners = _grid(3, 3, 5, 5, 5, 5)
    flat = corners[np.arange(200) % 50].copy()
    flat[:100, 2] = flat[:100, 1]  # two corners coincide
    flat[100:, 2] = 0.75 * flat[100:, 0] + 0.25 * flat[100:, 1]  # three corners on a line
    yield CornerCase(
        "triangles of 0 pixels",
        "triangles without area: two corners coincide, or three are on a line",
        "these triangles draw nothing and open no gap",
        tiled(np.concatenate([flat, corners]), 32, 32), _fills(3, 3, 28, 28),
    )  # fmt: skip
    yield CornerCase(
        "edges along scan lines",
        "horizontal and vertical edges exactly through the centres of pixels",
        "a pixel on an edge belongs to the triangle below or to the right",
        tiled(_grid(2.5, 2.5, 9, 9, 3, 3), 32, 32), _fills(2.5, 2.5, 29.5, 29.5),
    )  # fmt: skip
    yield CornerCase(
        "abrupt turns", "neighbouring triangles with unrelated normals", every,
        tiled(_grid(4, 4, 14, 14, 4, 4), 64, 64), _fills(4, 4, 60, 60),
    )  # fmt: skip
    yield _t_junctions(rng)
    x, y, _, _ = random_meshes(400, np.random.default_rng(6))
    index = np.arange(400)
    origin = np.stack([index % 20 * MESH_PIXELS, index // 20 * MESH_PIXELS], axis=-1)
    corners = (np.stack([x, y], axis=-1) / GRID + origin[:, None, None]).reshape(-1, 3, 2)
    yield CornerCase(
        "random meshes",
        "400 random triangulations, some with vertices at the centres of pixels",
        "no pixel twice (the row `shared edges` covers 10⁵ more meshes)",
        tiled(corners, 20 * MESH_PIXELS, 20 * MESH_PIXELS), _once,
    )  # fmt: skip


def _t_junctions(rng: np.random.Generator) -> CornerCase:
    """A slanted edge from (15.3, 2) to (17.6, 62): one pair of triangles to the left, 13 pairs to
    the right."""
    top, bottom = np.array([15.3, 2.0]), np.array([17.6, 62.0])
    left = [[[4, 2], [4, 62], bottom], [[4, 2], bottom, top]]
    cut = top + np.linspace(0, 1, 14)[:, None] * (bottom - top)
    right = []
    for a, b in zip(cut[:-1], cut[1:], strict=True):
        c, d = [28, a[1]], [28, b[1]]
        right += [[a, b, d], [a, d, c]]
    corners = np.array(left + right, float)

    def check(frame: Frame, got: Pixels) -> list[str]:
        messages = _once(frame, got)
        covered = np.zeros((frame.height, frame.width), bool)
        covered[got.y, got.x] = True
        y, x = np.nonzero(~covered[2:62, 4:28])
        edge = top[0] + (y + 2.5 - top[1]) / (bottom[1] - top[1]) * (bottom[0] - top[0])
        far = np.abs(x + 4.5 - edge) > 2 / GRID
        if far.any():
            messages.append(f"{int(far.sum())} pixels missing that are not on the edge")
        return messages

    return CornerCase(
        "T-junctions", "13 corners of triangles along the edge of another triangle",
        "no pixel twice; gaps only where the centre of a pixel is within 2⁻¹¹ pixel of the edge",
        _picture(corners, _upward(rng, (len(corners), 3, 3)), 32, 64), check,
    )  # fmt: skip


# -- several lights --------------------------------------------------------------------------------


def _lit_from(
    directions: Reals, colours: Reals, frame: Frame, first: Reals, last: Reals
) -> Frame:  # fmt: skip
    """`frame` with the first light along z and further ones in `directions`, float64[L, 3], in the
    first light's frame.

    colours: float64[L + 1, 3], of the diffuse and specular light of each. first, last:
    float64[n, 3], the normals at the ends of the spans, of which `frame` is made.
    """
    table = frame.materials
    base = table.diffuse
    hx, hz = C.half_vector.real(frame.half_vector)
    eye = np.array([2 * hx * hz, 0.0, hz * hz - hx * hx])
    length = frame.spans["length"]
    step = (last - first) / np.maximum(length - 1, 1)[:, None]

    def coloured(colour: Reals) -> tuple[Ints, Ints]:
        products = np.round(base * colour).astype(np.int64)
        return products, np.tile(C.coefficient.quantize(colour), (len(base), 1))

    further = []
    for direction, colour in zip(directions, colours[1:], strict=True):
        axes, its_eye = light_frame(direction, eye)
        codes = encode(first @ axes.T, step @ axes.T, length, C)
        half_vector = half_vector_codes(its_eye, C)
        further.append(FurtherLight(half_vector, *codes, *coloured(colour)))
    diffuse, highlight = coloured(colours[0])
    table = replace(table, diffuse=diffuse, highlight=highlight)
    return replace(frame, materials=table, further=further)


def unlit_stays_ambient(frame: Frame, got: Pixels) -> list[str]:
    """Check that every pixel that no light reaches has exactly the rounded ambient part."""
    dark = np.ones(len(got), bool)
    for number in range(frame.lights):
        z = _normals(frame.seen_by(frame.light(number, C)))[:, 2]
        dark &= z == 0 if frame.two_sided else z <= 0
    dark |= (_normals(frame) == 0).all(axis=1)
    ambient = frame.materials.ambient[_material(frame)[dark]]
    white = C.white
    want = (np.minimum(ambient, C.coefficient.one) * white + C.coefficient.one // 2) >> (
        C.coefficient.fraction
    )
    wrong = int((got.rgb[dark] != want).any(axis=1).sum())
    return [f"{wrong} of {int(dark.sum())} unlit pixels are not ambient"] if wrong else []


def _lights() -> Iterator[CornerCase]:
    rng = np.random.default_rng(8)
    towards = np.array([0.0, 0.0, 1.0])
    first, last = _directions(rng, 112), _directions(rng, 112)

    def case(name: str, extreme: str, expected: str, directions: Reals, colours: Reals,
             ends: tuple[Reals, Reals] = (first, last), length: int = 17,
             check: Callable[[Frame, Pixels], list[str]] = unlit_stays_ambient,
             materials: MaterialTable | None = None, two_sided: bool = False,
             full_rate: bool = False) -> CornerCase:  # fmt: skip
        rows = np.arange(len(ends[0])) % (2 * len(EXPONENTS))
        spans = _between(*ends, length, rows if materials is None else 0)
        frame = _frame(spans, materials, two_sided=two_sided)
        frame = _lit_from(np.asarray(directions), np.asarray(colours, float), frame, *ends)
        return CornerCase(name, extreme, expected, frame, check, full_rate)

    yield case(
        "eight lights on one spot",
        "eight lights in one direction, each of half of white: sums up to 4 times white",
        "saturation to white, within the bound of eight lights",
        np.tile(towards, (7, 1)), np.full((8, 3), 0.49),
        ends=(np.abs(first), np.abs(last)),
        check=lambda f, p: unlit_stays_ambient(f, p)
        + ([] if (p.rgb == 255).any(axis=1).mean() > 0.2 else ["hardly any pixel saturates"]),
    )  # fmt: skip
    pairs = _directions(rng, 3)
    directions = np.concatenate([[-towards], *np.stack([pairs, -pairs], axis=1)])
    pair_colours = np.tile([[0.3, 0.05, 0.1], [0.05, 0.1, 0.3]], (4, 1))
    yield case(
        "opposite pairs of lights",
        "four pairs of lights from opposite sides, each in two colours",
        "each pixel is lit by one light of each pair", directions, pair_colours,
    )  # fmt: skip
    yield case(
        "opposite pairs, two-sided",
        "the same, |N.L| of each light is shaded",
        "each pixel is lit by all lights", directions, pair_colours, two_sided=True,
    )  # fmt: skip
    flat = np.array([[0.0, 0.0, 1.0]] * 56)
    azimuth = np.linspace(0, 2 * np.pi, 8)[:7]
    grazing = np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=1)
    tilted = normalize(flat + np.array([2.0**-16, 2.0**-17, 0]))
    yield case(
        "grazing lights",
        "seven lights in the plane of the facet to 2⁻³⁰, the normal turns by 2⁻¹⁶ towards them",
        "each light adds N.L and W(i) as the sign of its own N.L says",
        grazing, np.full((8, 3), 0.4), ends=(flat, tilted), length=65,
    )  # fmt: skip
    behind = np.concatenate([[-towards], grazing[:3]])
    yield case(
        "one light exactly behind",
        "a facet towards the first light, with one light behind it and three in its plane",
        "the others add nothing",
        behind, np.full((5, 3), 0.6), ends=(flat, flat), length=5,
        check=lambda f, p: unlit_stays_ambient(f, p) + _same_without(f, p),
    )  # fmt: skip
    sharp = _materials(((0, 0, 0), 0, 1, 128))
    spread = _directions(rng, 7)
    spread[:, 2] = np.abs(spread[:, 2])
    yield case(
        "eight lights, n = 128",
        "highlights of n = 128 and W = 1 of eight lights, each of another colour",
        "within the bound: it grows by each light's colour",
        spread, 0.85 * rng.random((8, 3)), materials=sharp, length=129,
    )  # fmt: skip
    short = 2.0**-20
    yield case(
        "lights on normals of 2⁻²⁰",
        "ends of length 2⁻²⁰: 1024 LSB, rounded for each light",
        "within a bound that follows from the lengths at the ports",
        spread, rng.random((8, 3)) / 4, ends=(short * first, short * last),
    )  # fmt: skip
    opposed = rng.integers(-(1 << 22), 1 << 22, (112, 3)) / C.normal.one * 8
    for count in (2, 5, 8):
        yield case(
            f"zero vector under {count} lights",
            "normals that cancel in the middle of a span, rounded for each light",
            "ambient where the first light's normal is zero",
            spread[: count - 1], rng.random((count, 3)) / 4,
            ends=(opposed, -opposed), length=17, check=unlit_stays_ambient,
        )  # fmt: skip
    single = _directions(rng, 2048)
    yield case(
        "2048 spans of one pixel, eight lights",
        "every pixel loads all its lights, without an idle cycle between",
        "one pixel in eight cycles",
        spread, rng.random((8, 3)) / 4, ends=(single, single), length=1, full_rate=True,
    )  # fmt: skip


# -- lights at a place -----------------------------------------------------------------------------


def _sheet(lights: list[Light]) -> Frame:
    """A sheet of 64 by 32 pixels in the plane z = 0, seen along -z and lit by `lights`; one scene
    unit is one pixel, and the middle of the picture is the origin. The normals bulge."""
    x, y = np.array([-32.0, 32, 32, -32]), np.array([-16.0, -16, 16, 16])
    points = np.stack([x, y, 0 * x], axis=-1)
    normals = normalize(points / 64 + np.array([0, 0, 1.0]))
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    mesh = Mesh(points, faces, normals[faces])
    camera = Camera("orthographic", np.eye(3), np.zeros(3), np.array([0, 0, 1.0]), 32.0)
    material = Material((0.6, 0.5, 0.2), 0.1, 32.0, (0.0, 1.0), (0.4, 0.4))
    scene = Scene("stability", 64, 32, (0, 0, 0), camera, lights[0].direction, False, "linear",
                  [SceneObject("sheet", mesh, 0)], [material], lights=lights)  # fmt: skip
    return front_end(scene).frame


def _places() -> Iterator[CornerCase]:
    """Pairs of lights at a place, all for the same build: both fall with the distance."""
    up, centre = np.array([0, 0, 1.0]), np.array([-11.5, 4.5, 0])  # the centre of a pixel
    steep = Falloff((0.0, 1.0, 30.0, 200.0), (1.0, 0.9, 0.2, 0.0))

    def pair(
        name: str, extreme: str, expected: str, *heights: float, falloff: Falloff = steep
    ) -> CornerCase:
        lights = [
            Light(up if height >= 0 else -up, place=Place(at, at, False, falloff))
            for number, height in enumerate(heights)
            for at in [centre * (1 - 2 * number) + height * up]
        ]
        return CornerCase(name, extreme, expected, _sheet(lights), unlit_stays_ambient)

    yield pair(
        "light on the surface",
        "lights in the plane of the sheet, at the centre of a pixel: distance 0, no direction",
        "the pixel at the light is lit as from the eye, others as their normals say", 0.0, 0.0,
    )  # fmt: skip
    yield pair(
        "light 2⁻²⁰ above the surface",
        "the direction turns by 90° from one pixel to the next",
        "spans of one pixel around the light, within the bound", 2.0**-20, 1.0,
    )  # fmt: skip
    yield pair(
        "light at the eye",
        "one light on the line of sight of a pixel, light and eye parallel there; one 2³⁰ away",
        "no frame turns where light and eye are parallel", 40.0, 2.0**30,
    )  # fmt: skip
    yield pair(
        "light behind the surface", "lights behind the sheet, near and far", "ambient", -3.0, -1e4
    )
    yield pair(
        "distances at the table's ends",
        "factors that fall from 1 to 0 within a pixel; distances beyond the table on both sides",
        "clamped to the table's ends", 8.0, 20.0, falloff=Falloff((20.0, 21.0), (1.0, 0.0)),
    )  # fmt: skip


def _same_without(frame: Frame, got: Pixels) -> list[str]:
    """Check that the further lights of `frame` change no pixel."""
    alone = render(replace(frame, further=[]))
    wrong = int((alone.rgb != got.rgb).any(axis=1).sum())
    return [f"{wrong} pixels show lights that do not reach them"] if wrong else []


# -- curves of cos(s) by table, and jumps ----------------------------------------------------------

#: A toon curve and a W of four steps each, as (cos, value at and above it).
TOON = ((0.1, 0.25), (0.52, 0.5), (0.83, 0.75), (0.98, 1.0))
STEPPED_W = ((0.05, 0.2), (0.3, 0.4), (0.6, 0.6), (0.9, 0.8))


def _polyline(steps: tuple[tuple[float, float], ...]) -> Polyline:
    """Steps from 0, each up to a value at a place."""
    places, levels = zip(*steps, strict=True)
    values = [v for pair in zip((0.0, *levels), levels, strict=False) for v in pair]
    return Polyline(tuple(np.repeat(places, 2).tolist()), tuple(values))


def _curves() -> MaterialTable:
    """Black materials of curves: n = 0, 1/2, 1/16; toon steps; toon steps under a stepped W; and
    lines of the extremes of a word, of random height."""
    table = MaterialTable.empty(C)
    curves: list[Curve] = [
        Power(0.0),
        Power(0.5),
        Power(0.0625),
        _polyline(TOON),
        _polyline(TOON),
        Power(128.0),
    ]
    found = [curve_words(curve, C) for curve in curves]
    none = np.zeros((C.materials, MAX_JUMPS, 3), np.int64)
    table.curve = power_words(table.exponent, C)
    table.curve_jumps, table.weight_jumps = none, none.copy()
    for index, (words, jumps, _) in enumerate(found):
        table.curve[index], table.curve_jumps[index] = words, jumps
        table.weight[index] = C.coefficient.quantize(0.25)
    table.weight[3] = C.coefficient.one
    points, steps, _ = weight_points(_polyline(STEPPED_W), C)
    table.weight[4], table.weight_jumps[4] = points, steps
    rng, most = np.random.default_rng(11), C.coefficient.max
    lines = table.curve[5]
    lines[:, 0] = rng.choice([0, 1, C.coefficient.one, most], len(lines))
    lines[:, 1] = rng.choice([0, 1], len(lines)) * np.where(lines[:, 0] > most // 2, -1, 1)
    lines[::9] = (0, 0)
    lines[3::9] = (most, 0)
    for jumps in (table.curve_jumps, table.weight_jumps):  # one build for all: below 0 is nothing
        jumps[jumps[..., 2] == 0] = (0, 0, 1)
    return table


def only_levels(levels: ArrayLike) -> Callable[[Frame, Pixels], list[str]]:
    """A check that every pixel has one of `levels` (intensities) or is black, and that the
    highest level is there."""
    codes = np.floor(255 * np.asarray(levels) + 0.5).astype(int)

    def check(frame: Frame, got: Pixels) -> list[str]:
        seen = set(np.unique(got.rgb).tolist())
        other, top = sorted(seen - {0, *codes.tolist()}), int(codes.max())
        lines = [f"codes {other} are between the steps"] if other else []
        return lines + ([] if top in seen else [f"no pixel has the code {top}"])

    return check


def _reflectance() -> Iterator[CornerCase]:
    rng = np.random.default_rng(2002)
    table = _curves()
    first, last = _directions(rng, 96), _directions(rng, 96)
    yield CornerCase(
        "n = 0 by table",
        "n = 0, cos(s) from 1 to below 0",
        "W on every lit pixel: 0⁰ is 1",
        _frame(_between(first, last, 33, 0), table), only_levels([0.25]),
    )  # fmt: skip
    # In the plane x = 0 of the eye behind the light, cos(s) crosses 0 where N is 45 degrees off.
    tilt = np.pi / 4 + rng.uniform(-1e-3, 1e-3, 96)
    grazing = np.stack([0 * tilt, np.sin(tilt), np.cos(tilt)], axis=1)
    off = 1e-3 * rng.normal(size=(96, 3))
    yield CornerCase(
        "n = 1/2 and 1/16 where cos(s) is 0",
        "cos(s)ⁿ of unbounded slope, cos(s) from −0.003 to 0.003",
        "within the bound, which is that of the steepest line",
        _frame(_between(grazing, normalize(grazing + off), 33, 1), table, angle=0.0),
    )  # fmt: skip
    yield CornerCase(
        "toon steps",
        "four jumps of a curve that is flat between them, W = 1",
        "the five levels, and no other code",
        _frame(_between(first, last, 65, 3), table), only_levels([v for _, v in TOON]),
    )  # fmt: skip
    products = [a * b for _, a in TOON for _, b in STEPPED_W]
    yield CornerCase(
        "toon steps under a W of steps",
        "four jumps of the curve times four jumps of W(i)",
        "products of two levels, and no other code",
        _frame(_between(first, last, 65, 4), table), only_levels(products),
    )  # fmt: skip
    yield CornerCase(
        "lines of extreme words",
        "lines of 0, 1 and 1.99998, side by side",
        "saturation below 1, jumps at the end of a line",
        _frame(_between(first, last, 65, 5), table),
    )  # fmt: skip


def cases() -> list[CornerCase]:
    """All cases, in the order of the table. Every call returns the same integers."""
    makers = (
        _ends_apart, _lengths, _spans, _light, _terminator, _coefficients, _triangles, _lights,
        _reflectance, _places,
    )  # fmt: skip
    return [case for maker in makers for case in maker()]


def frames() -> list[Frame]:
    """The frames of all cases, as extreme input for other checks."""
    return [case.frame for case in cases()]


# -- shared edges, over many meshes ----------------------------------------------------------------

#: Width and height of a random mesh, pixels.
MESH_PIXELS = 12


def random_meshes(count: int, rng: np.random.Generator) -> tuple[Ints, Ints, Ints, Ints]:
    """`count` random triangulations of random rectangles, 24 triangles each.

    Returns (x, y, low, high). x, y: int64[count, 24, 3], vertices in 1/GRID pixel. low, high:
    int64[count, 2], upper left and lower right corners of the rectangles. Eight points on the
    outline of the rectangle and one inside make a fan of eight triangles. A point in each triangle
    of the fan splits it in three. In a third of the meshes all points are multiples of 1/2 pixel,
    so that edges go through centres of pixels; in another third they are multiples of 1/8 pixel.
    Some triangles have no area.
    """
    grain = rng.choice([1, GRID // 8, GRID // 2], (count, 1))

    def between(low: Ints, high: Ints) -> Ints:
        fraction = rng.random(np.broadcast_shapes(low.shape, high.shape))
        return low + (np.floor(fraction * ((high - low) // grain + 1)) * grain).astype(np.int64)

    whole = MESH_PIXELS * GRID
    low = between(np.zeros((count, 2), np.int64), np.full((count, 2), whole // 3))
    high = between(np.full((count, 2), whole // 3 + GRID), np.full((count, 2), whole))
    mid = between(np.repeat(low, 2, axis=1), np.repeat(high, 2, axis=1))
    (x0, y0), (x1, y1) = low.T, high.T
    top, bottom, left, right = mid[:, 0], mid[:, 1], mid[:, 2], mid[:, 3]
    # Points of the outline, clockwise from the upper left: each corner, then a point on the side.
    outline_x = np.stack([x0, top, x1, x1, x1, bottom, x0, x0], axis=1)
    outline_y = np.stack([y0, y0, y0, right, y1, y1, y1, left], axis=1)
    centre = between(low, high)
    ax, ay = (np.repeat(centre[:, i, None], 8, axis=1) for i in (0, 1))
    bx, by = outline_x, outline_y
    cx, cy = np.roll(bx, -1, axis=1), np.roll(by, -1, axis=1)

    def inside(px: Ints, py: Ints) -> Flags:
        sides = [
            (qx - rx) * (py - ry) - (qy - ry) * (px - rx)
            for qx, qy, rx, ry in ((bx, by, ax, ay), (cx, cy, bx, by), (ax, ay, cx, cy))
        ]
        return (np.minimum.reduce(sides) >= 0) | (np.maximum.reduce(sides) <= 0)

    cuts = np.sort(rng.random((2, count, 8)), axis=0)
    weights = cuts[0], cuts[1] - cuts[0], 1 - cuts[1]
    px, py = (
        (sum(w * v for w, v in zip(weights, at, strict=True)) // grain * grain).astype(np.int64)
        for at in ((ax, bx, cx), (ay, by, cy))
    )
    valid = inside(px, py)
    px, py = np.where(valid, px, ax), np.where(valid, py, ay)
    x = [np.stack(t, axis=-1) for t in ((px, ax, bx), (px, bx, cx), (px, cx, ax))]
    y = [np.stack(t, axis=-1) for t in ((py, ay, by), (py, by, cy), (py, cy, ay))]
    return np.concatenate(x, axis=1), np.concatenate(y, axis=1), low, high


def shared_edges(
    meshes: int, seed: int = 75, progress: Callable[[float], None] | None = None
) -> dict[str, int]:
    """Count the pixels of `meshes` random triangulations that are covered wrongly.

    Returns a dict of counts. "meshes", "triangles", "pixels": what was tested. "gaps": pixels of a
    rectangle without a triangle; "doubles": pixels covered twice; "outside": pixels covered outside
    the rectangle; all three must be 0.
    """
    rng = np.random.default_rng(seed)
    counts = dict.fromkeys(("meshes", "triangles", "pixels", "gaps", "doubles", "outside"), 0)
    while counts["meshes"] < meshes:
        count = min(5000, meshes - counts["meshes"])
        x, y, low, high = random_meshes(count, rng)
        y = y + np.arange(count)[:, None, None] * MESH_PIXELS * GRID
        px, py = x.reshape(-1, 3) / GRID, y.reshape(-1, 3) / GRID
        normal = np.zeros((len(px), 3, 3))
        triangles = visibility.set_up(
            px, py, np.zeros(px.shape), normal, np.zeros(len(px), np.int64), two_sided=True
        )
        lines = count * MESH_PIXELS
        first, end = visibility.line_range(triangles, MESH_PIXELS, lines)
        strips = visibility.cover(triangles, first, end, MESH_PIXELS)
        row = strips.y * (MESH_PIXELS + 1)
        size = lines * (MESH_PIXELS + 1)
        change = np.bincount(row + strips.left, minlength=size)
        change = change - np.bincount(row + strips.right, minlength=size)
        covered = np.cumsum(change).reshape(count, MESH_PIXELS, MESH_PIXELS + 1)[..., :-1]
        centre = np.arange(MESH_PIXELS) * GRID + GRID // 2
        within = (centre >= low[..., None]) & (centre < high[..., None])
        want = within[:, 1, :, None] & within[:, 0, None, :]
        counts["meshes"] += count
        counts["triangles"] += len(triangles)
        counts["pixels"] += int(want.sum())
        counts["gaps"] += int((want & (covered == 0)).sum())
        counts["doubles"] += int((covered > 1).sum())
        counts["outside"] += int((~want & (covered > 0)).sum())
        if progress:
            progress(counts["meshes"] / meshes)
    return counts


# -- error against the reference -------------------------------------------------------------------


def errors(frame: Frame, rgb: Ints, progress: Callable[[float], None] | None = None) -> Reals:
    """The largest error of the three channels of each pixel, LSB, float64[n].

    rgb: codes int[n, 3] of the pixels of `frame`, in the order of the stream. They are compared
    with `reference.render`, at a jump with the nearer side, in blocks, so that a frame of any size
    fits the memory. progress: called with the part done, 0 to 1.
    """
    ends = np.cumsum(walked(frame.spans))
    total = int(ends[-1]) if len(ends) else 0
    cuts = np.searchsorted(ends, np.arange(BLOCK, total, BLOCK))
    parts, done = [], 0
    for rows in np.split(np.arange(len(frame.spans)), cuts):
        if len(rows):
            part = frame.take(rows)
            codes = rgb[done : done + int(walked(part.spans).sum())]
            ideal = undecided.nearest(codes, part, with_lights(C, frame)).ideal
            parts.append(np.abs(codes - ideal).max(axis=1))
            done += len(ideal)
            if progress:
                progress(done / total)
    return np.concatenate(parts or [np.zeros(0)])
