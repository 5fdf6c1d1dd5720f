# SPDX-License-Identifier: MIT
"""What the documentation says of the design itself: latencies, formats, bounds, counts.

Nothing is measured here: all of it follows from the configuration, the elaborated design and the
derived error budget.
"""

from __future__ import annotations

import dataclasses
import functools
import inspect
import math
import re
from pathlib import Path

import numpy as np

from phong75.model import config as config_module
from phong75.model import registers, spans
from phong75.model.analysis import error_budget
from phong75.model.analysis.pruning import prune
from phong75.model.config import DEFAULT as C
from phong75.model.config import MAX_EXPONENT, TECHNIQUES, Config, Format
from phong75.model.frame import SPAN_DTYPE, Frame, MaterialTable, half_vector_codes
from phong75.model.front.mesh_files import library
from phong75.model.front.scene import SHAPES, load_scene
from phong75.model.front.vectors import normalize
from phong75.model.reflectance import SAMPLES, Power, curve_distance, curve_words
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import corner_cases, light_places
from phong75.model.studies.methods import FRAMES, points
from phong75.model.twin.core.span_walker import pixel_count, span_walker
from phong75.scripts.docs.tables import above, above_digits, markdown
from phong75.scripts.export import documents
from phong75.sim.elaborate import instances
from phong75.sim.formal.proofs import PROOFS
from phong75.sim.latency import latencies

#: Registers between the walker's input and the pixel's output around `latencies()["pixel"]`: the
#: span accepted, the slot written, the slot read.
AROUND = 3


@functools.cache
def modules(config: Config = C) -> dict[str, int]:
    """{module: instances} of the elaborated `config`."""
    return dict(instances(config))


def latency(block: str, config: Config = C) -> int:
    """Cycles of `block`; "first_pixel" is from an accepted span to its first pixel."""
    if block == "first_pixel":
        return latencies(config)["pixel"] + AROUND
    return latencies(config)[block]


def diagram() -> str:
    """The blocks in the order of the data, with their latencies in cycles."""
    cycles = latencies()
    head = (
        (" spans ─► ", " cycles:"), ("span_walker, interpolators ×3", "1"), (" ─► ", ""),
        ("normalizer", f"{cycles['normalizer']}"), (" ─► ", ""),
        ("shading_unit", f"{cycles['shading_unit']}"), (" ─► ", ""), ("pixel_fifo", "2"),
        (" ─► pixels", ""),
    )  # fmt: skip
    names = "".join(name for name, _ in head)
    below = "".join(number.center(len(name)) for name, number in head).rstrip()
    rest = cycles["normalizer"] - cycles["align"] - cycles["inverse_sqrt_linear"]
    lines = [
        names, below, "",
        f" normalizer     align to the largest component ({cycles['align']}) · "
        f"inverse_sqrt_linear ({cycles['inverse_sqrt_linear']}) ·",
        f"                squares, sum, scale, round ({rest})",
        f" shading_unit   reflection ({cycles['reflection']}): 1 − cos(s) · "
        f"specular_power_tables ({cycles['specular_power_tables']}): cos(s)^n ·",
        f"                colour_channel ×3 ({cycles['colour_channel']}): eq. (3), clamp, code;",
        f"                in parallel: specular_weight ({cycles['specular_weight']}): W(i)",
    ]  # fmt: skip
    return "```text\n" + "\n".join(lines) + "\n```"


def latency_table() -> str:
    """Every block with a latency of its own in the default configuration."""
    used = modules()
    rows = [(f"`{block}`", str(n)) for block, n in latencies().items() if block in used]
    pixel = latencies()["pixel"]
    rows.append(("`PHONG_PIXEL_LATENCY`: from an interpolated normal to its colour", str(pixel)))
    rows.append(("from an accepted span to its first pixel", str(latency("first_pixel"))))
    return markdown(("block", "latency, cycles"), rows)


# -- formats ---------------------------------------------------------------------------------------


def _comments() -> dict[str, str]:
    """{field of Config: the comment behind it}."""
    source = Path(config_module.__file__).read_text()
    fields = re.findall(r"^    (\w+): [^#\n]*?(?:  # (.*))?((?:\n    #   .*)*)$", source, re.M)
    return {
        name: re.sub(r"\s*\n\s*#\s*", " ", first + more).strip() for name, first, more in fields
    }


def formats() -> str:
    """Every fixed-point format of the default configuration."""
    comments = _comments()
    rows = [
        (f"`{field.name}`", f"{value}", comments.get(field.name, "").replace("|", "\\|"))
        for field in dataclasses.fields(C)
        if isinstance(value := getattr(C, field.name), Format)
    ]
    return markdown(("field of `Config`", "format", "what"), rows, left=3)


def port_table(config: Config = C) -> str:
    """The ports of `phong_pipeline`, in the order of its declaration."""
    rows = (
        (f"`{port.name}`", port.direction, str(port.bits), port.meaning)
        for port in documents.ports(config)
    )
    return markdown(("port", "direction", "bits", "meaning"), rows, left=4)


def span_table(config: Config = C) -> str:
    """The fields of a span word, from bit 0 upwards."""
    fields = [f for f in spans.span_fields(config) if f.name != "last"]
    rows = []
    for f in fields:
        carried = f.name.startswith(("start_", "step_"))
        bent = f.name.startswith("bend_")
        squared = f.name not in ("x", "y", "length", "material") and not carried
        meaning = str(
            config.normal if carried else config.bend if bent
            else config.squared if squared else "whole number"
        )  # fmt: skip
        rows.append((f"`{f.name}`", f"{f.lsb + f.bits - 1}:{f.lsb}", meaning))
    return markdown(("field", "bits of `s_axis_tdata`", "format"), rows, left=3)


def pixel_table(config: Config = C) -> str:
    """The fields of a pixel word, from bit 0 upwards."""
    rows, lsb = [], 0
    colour, place = config.colour_bits, config.coordinate_bits
    for name, bits in (
        ("blue", colour),
        ("green", colour),
        ("red", colour),
        ("x", place),
        ("y", place),
    ):
        rows.append((f"`{name}`", f"{lsb + bits - 1}:{lsb}"))
        lsb += bits
    return markdown(("field", "bits of `m_axis_tdata`"), rows, left=2)


def register_table(config: Config = C) -> str:
    """The address map of the write port."""
    field, c = registers.FIELDS, config.coefficient
    intervals = config.weight_points - 1
    rows = [
        ("`{0, material, k}`",
         f"interval k of {intervals} of W(i), equally spaced in Zn: {{W(k+1) − W(k) "
         f"(s{c.integer}.{c.fraction}), W(k) ({c})}}"),
        (f"`{{1, material, {field['ambient']}…{field['ambient'] + 2}}}`",
         f"Cp·d of red, green, blue ({c})"),
        (f"`{{1, material, {field['diffuse']}…{field['diffuse'] + 2}}}`",
         f"Cp·(1 − d) of red, green, blue ({c})"),
        (f"`{{1, material, {field['exponent']}}}`", f"n ({config.exponent}), 1 to {MAX_EXPONENT}"),
        (f"`{{1, any, {field['half_x']}}}`, `{{1, any, {field['half_z']}}}`",
         f"hx, hz ({config.half_vector}): h = (sin ½a, 0, cos ½a) for an eye at angle a from the "
         "light"),
        (f"`{{1, any, {field['control']}}}`", "bit 0: two-sided, shade \\|Zn\\|; bits 3 to 1, "
         "builds for several lights: lights of the frame minus 1"),
        (f"`{{1, material, {field['highlight']}…{field['highlight'] + 2}}}`",
         f"builds with coloured highlights: ks·Ls of red, green, blue ({c})"),
        *(
            (f"`{{1, material, {field[name]} + 2k}}`, `{{1, material, {field[name] + 1} + 2k}}`",
             f"builds with jumps: jump k of {what}, {{above, threshold ({operand})}}; its amount "
             f"({c})")
            for name, what, operand in (
                ("weight_jump", "W(i)", config.cosine),
                ("curve_jump", "the curve of 1 − cos(s)", config.versine),
            )
        ),
        (f"`{{1, k div 16, {field['attenuation']} + k mod 16}}`",
         "builds with lights that fall with the distance: interval k of the light's factors, "
         "as for W(i)"),
    ]  # fmt: skip
    return markdown(("address", "contents"), rows, left=2)


# -- the error budget ------------------------------------------------------------------------------


def _frame(angle: float, n: float, weight=1.0) -> Frame:
    """No spans that matter, one white material, the eye at `angle` (radians) from the light."""
    table = MaterialTable.empty(C)
    table.set(0, (1.0, 1.0, 1.0), 0.0, np.broadcast_to(weight, C.weight_points), n, C)
    eye = np.array([np.sin(angle), 0, np.cos(angle)])
    return Frame(1, 1, half_vector_codes(eye, C), False, (0, 0, 0), table, np.zeros(1, SPAN_DTYPE))


def intensity_bound() -> float:
    """The bound in LSB of Gouraud and flat shading against the interpolated intensity."""
    return error_budget.bound_lsb(_frame(0.5, 1), TECHNIQUES["gouraud"])


def budget() -> str:
    """The error budget of a white material with n = 10 and W = 1, stage by stage."""
    rows = error_budget.rows(0, _frame(1.0, 10.0))
    cells = ((row.stage, above_digits(row.bound, 3), row.why.replace("|", "\\|")) for row in rows)
    return markdown(("stage", "bound", "why"), ((a, b, c) for a, b, c in cells), left=3)


def place_rules() -> str:
    """The rules for lights at a place: error against the exact picture, and number of spans."""
    rows = []
    for row in light_places.measure():
        cut = "no" if row.most_turn is None else f"at {np.degrees(row.most_turn):g}°"
        rows.append(
            (f"`{row.rule}`", cut, f"{row.max_lsb:.1f}", f"{row.rms_lsb:.3f}", str(row.spans))
        )
    header = ("rule", "spans are cut", "largest error, LSB", "RMS, LSB", "spans")
    return markdown(header, rows, left=2)


# -- scenes and proofs -----------------------------------------------------------------------------


def shapes() -> str:
    """The bundled shapes and their parameters, as scene files name them."""
    rows = []
    for name, make in SHAPES.items():
        given = inspect.signature(make).parameters.values()
        rows.append((f"`{name}`", ", ".join(f"`{p.name}` ({p.default:g})" for p in given)))
    return markdown(("shape", "parameters (default)"), rows, left=2)


MODES = {
    "prove": "unbounded induction", "bmc": "bounded", "cover": "reachable",
    "structure": "netlist structure",
}  # fmt: skip


def proofs() -> str:
    """What is proven, of which size, and how many broken designs must fail."""
    rows = (
        (proof.name, proof.claim, proof.size, MODES[proof.mode], str(len(proof.broken_designs)))
        for proof in PROOFS
    )
    return markdown(("proof", "claim", "size", "kind", "broken designs"), rows, left=4)


#: The cases of `make stability` that are no frame of `corner_cases`: (what is extreme, expected).
OTHER_CASES = {
    "shared edges": ("random triangulations of rectangles", "every pixel once, no other"),
    "cos(s)ⁿ alone": ("every code of 1 − cos(s), for several n", "within the derived bounds"),
    "long run": ("random spans under random pauses and resets", "every pixel, in order"),
}


def case_words() -> dict[str, tuple[str, str]]:
    """{corner case: (what is extreme, what is expected)}."""
    words = {case.name: (case.extreme, case.expected) for case in corner_cases.cases()}
    return words | OTHER_CASES


# -- configurations --------------------------------------------------------------------------------


def configurations() -> str:
    """Every named configuration of the sweep, and the techniques."""
    rows = [(f"`{p.config.name}`", p.method, p.label) for p in points()]
    rows += [(f"`{name}`", "technique", name) for name in TECHNIQUES if name != "phong"]
    return markdown(("configuration", "method", "size"), rows, left=3)


def curve_powers() -> str:
    """How far powers by table are from cos(s)**n; see docs/reflectance.md."""
    rows = []
    for n in (0, 0.25, 0.5, 0.75, 1, 1.5, 2, 5, 10, 32, 128):
        words, jumps, _ = curve_words(Power(n), C)
        apart = C.white * curve_distance(Power(n), words, jumps, C)
        rows.append((f"{n:g}", f"{apart:.3f}"))
    return markdown(("n", "largest distance, LSB"), rows, left=1)


def _chord_distance(ends: np.ndarray, n: float) -> float:
    """How far straight lines over 1 - cos(s) are from cos(s)**n at W = 1, LSB: chords between the
    `ends` (float64[S + 1], increasing), each moved by half of its largest error, not rounded."""
    part = np.linspace(0, 1, SAMPLES)[:, None]
    value = np.power(np.clip(1 - (ends[:-1] + part * np.diff(ends)), 0, 1), n)
    bend = value - (value[0] + part * (value[-1] - value[0]))
    return C.white * float(np.ptp(bend, axis=0).max()) / 2


def one_sided_distance(n: float) -> float:
    """`_chord_distance` of as many lines as a curve has, in octaves from 1 - cos(s) = 0 alone."""
    octaves = 1 << C.curve_octave_bits
    lines = (1 << C.segment_bits) // octaves
    begins = [0.0 if k == octaves - 1 else 2.0 ** -(k + 1) for k in range(octaves)]
    parts = [np.linspace(begin, 2.0**-k, lines + 1) for k, begin in enumerate(begins)]
    return _chord_distance(np.unique(np.concatenate(parts)), n)


def equal_distance(n: float) -> float:
    """`_chord_distance` of as many lines as a curve has, all of one length."""
    return _chord_distance(np.linspace(0, 1, (1 << C.segment_bits) + 1), n)


def mantissa_error() -> str:
    """The relative rounding of a normal's mantissas, as it is read: 1.32·10⁻⁵, rounded up."""
    bound = error_budget.direction(C)
    power = math.floor(math.log10(bound))
    digits = str(-power).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{above(bound / 10**power)}·10⁻{digits}"


@functools.cache
def facets() -> tuple[int, float]:
    """Of the sweep's octahedron: pixels of its longest span, and length of its shortest normal."""
    scene, size, _ = FRAMES[-1]
    spans = front_end(load_scene(scene, size)).frame.spans
    walked = span_walker(spans, 0, pixel_count(spans), C)
    start, step = (spans[name][walked.span] for name in ("start", "step"))
    normals = C.normal.real(start + walked.k[:, None] * step)
    return int(spans["length"].max()), float(np.linalg.norm(normals, axis=1).min())


def features() -> str:
    """The fields of Config that pruning decides on, and what a build lacks without each."""
    rows = ((f"`{row.feature}`", row.saves) for row in prune(_frame(1.0, 10.0))[1])
    return markdown(("field of `Config`", "without it go"), rows, left=2)


#: The width of the chamfers in `chamfered_bend`, as a share of the distance from the middle of the
#: box to its sides.
CHAMFER = 0.05


def chamfered_bend(by_area: bool) -> float:
    """By how many degrees the side of a chamfered box would bend at its corners, if it did not keep
    its own normal: the angle between that normal and the mean of the normals at the corner.

    The side, two chamfers and the triangle at the corner of the box meet there. by_area: whether
    a face counts by its angle times its area, or by its angle alone.
    """
    normals = normalize(np.array([(0, 0, 1), (1, 0, 1), (0, 1, 1), (1, 1, 1)], np.float64))
    side, width = 2 * (1 - CHAMFER), np.sqrt(2) * CHAMFER
    weight = np.array([90.0, 90.0, 90.0, 60.0])
    if by_area:
        weight *= (side**2, side * width, side * width, np.sqrt(3) / 4 * width**2)
    return float(np.degrees(np.arccos(normalize(weight @ normals)[2])))


def mesh_memory() -> str:
    """The memory that the reader of a mesh file may use, in words."""
    return f"{library.MEMORY / 2**30:g} GiB and {library.MEMORY_PER_BYTE} times the file"


def mesh_time() -> str:
    """The processor time that the reader of a mesh file may use, in words."""
    return f"{library.CPU_S} s and {library.CPU_S_PER_BYTE * 1e6:g} s for each MB"
