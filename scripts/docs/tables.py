# SPDX-License-Identifier: MIT
"""Tables of docs/ and README.md, as Markdown, from the records in results/.

A record holds numbers and names; what a table says beside them is written here. A figure that was
not measured is a dash.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from phong75.model.config import CURVE_BUILDS, LIGHT_BUILDS, PLACE_BUILDS
from phong75.model.studies import pareto
from phong75.scripts import recorded

DASH = "–"


def markdown(header: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1) -> str:
    """A table of `rows` under `header`; the first `left` columns are text, the others numbers."""
    rules = ["---"] * left + ["--:"] * (len(header) - left)
    lines = [header, rules, *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)


def number(value: float | None, digits: int = 0) -> str:
    """`value` with `digits` decimals, or a dash."""
    return DASH if value is None else f"{value:.{digits}f}"


def above(value: float, digits: int = 2) -> str:
    """`value` rounded up: a bound stays one."""
    return f"{math.ceil(value * 10**digits) / 10**digits:.{digits}f}"


def above_digits(value: float, digits: int) -> str:
    """A positive `value` rounded up to `digits` significant digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return f"{math.ceil(value / step) * step:.{digits}g}"


def grouped(value: int) -> str:
    """A whole number with thin groups of three digits: 1 234 567."""
    return f"{value:,}".replace(",", "\u202f")


def logic(records: Iterable[dict[str, Any]]) -> tuple[str, str]:
    """(key, title) of the column that counts the logic of `records`: LUT sites, or LUT cells where
    only Yosys's count was kept of one of them. One table, one count."""
    some = any(r.get("lut_cells") is not None and r.get("lut_sites") is None for r in records)
    return ("lut_cells", "LUT cells (Yosys)") if some else ("lut_sites", "LUT sites")


# -- scenes ----------------------------------------------------------------------------------------


def scenes(record: dict[str, Any]) -> str:
    """Every bundled scene: the largest size's counts, the worst errors of all sizes."""
    rows = []
    for name, runs in record["scenes"].items():
        large = runs[-1]
        rows.append((
            name, str(large["pixels"]), str(large["spans"]),
            str(sum(run["mismatches"] for run in runs)),
            number(max(run["max_lsb"] for run in runs), 3),
            above(max(run["bound_lsb"] for run in runs), 3),
            f"{100 * min(run['correctly_rounded'] for run in runs):.2f} %",
            number(large["cycles"] / large["pixels"], 4),
            ", ".join(number(record["clock_hz"] / run["cycles"]) for run in runs),
        ))  # fmt: skip
    header = (
        "scene", "pixels", "spans", "RTL ≠ model", "largest error, LSB", "bound, LSB",
        "rounded correctly", "cycles per pixel", "frames/s",
    )  # fmt: skip
    return markdown(header, rows)


def worst_scene(record: dict[str, Any], figure: str) -> float:
    """The largest `figure` of all runs of all scenes."""
    return max(run[figure] for runs in record["scenes"].values() for run in runs)


#: What each technique's scene shows, and the source of the technique.
TECHNIQUE_WORDS = {
    "lamps": ("ambient, diffuse, specular and emitted light, in colours", "lecture notes"),
    "coloured_lights": ("eight coloured lights", "lecture notes"),
    "near_light": ("lights at a place, falling with the distance", "lecture notes; Phong 1975"),
    "warnock": ("Warnock's shading: the light at the eye", "Phong 1975"),
    "toon": ("reflectance by table: steps, Schlick's rim, n = 0.5, a W(i) with a jump",
             "Ohbuchi and Unno 2002"),
    "scaling": ("intensities divided by Imax", "lecture notes"),
    "flat_and_smooth": ("flat and smooth objects in one frame", "lecture notes"),
    "normalized_edges": ("normals of length 1 at both ends of a scan line", "Phong 1975"),
    "coarse_torus": ("quadratic normals", "van Overveld and Wyvill 1997, Vlachos et al. 2001"),
}  # fmt: skip


def techniques(rows: Iterable[dict[str, Any]]) -> str:
    """The runs of the technique scenes, of the record `scenes`."""
    cells = [
        (
            f"`{row['scene']}`" + (f", {row['technique']}" if row["technique"] != "phong" else ""),
            TECHNIQUE_WORDS[row["scene"]][0], f"`{row['configuration']}`",
            str(row["multipliers"]), str(row["pixels"]), str(row["mismatches"]),
            number(row["max_lsb"], 3), number(row["bound_lsb"], 3), str(row["cycles"]),
            number(row["cycles"] / row["pixels"], 4),
        )
        for row in rows
    ]  # fmt: skip
    header = (
        "scene", "what it shows", "configuration", "multipliers", "pixels", "RTL ≠ model",
        "largest error, LSB", "bound, LSB", "cycles", "cycles per pixel",
    )  # fmt: skip
    return markdown(header, cells, left=3)


# -- hardware, proofs, tests -----------------------------------------------------------------------


@dataclass(frozen=True)
class HardwareRow:
    """A line of the table of long runs: what was measured, the figure, the command that measures
    it, and what the figure does not mean. `record` is the name of its record."""

    what: str
    figure: str
    command: str
    caveat: str
    record: str


def _synthesis(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    clock, used = found["clock_mhz"], found.get("resources", {})
    chip = f"Lattice ECP5 {found['device']}, speed grade {found['grade']}"
    rows = [(
        f"clock on a {chip}",
        f"{clock['median']} MHz, median of {found['seeds']} placements; best {clock['best']} MHz",
        f"a timing estimate by nextpnr, not a measured chip; clamped to the {found['limit_by']}'s "
        f"limit of {found['limit_mhz']} MHz, which nextpnr does not check",
    )]  # fmt: skip
    if used and found["grade"] == 6:
        rows += [
            ("multipliers and block RAMs", f"{used['dsp']} MULT18X18D, {used['ebr']} DP16KD",
             "without the harness of shift registers that stands in for pins"),
            ("logic", f"{used['lut_sites']} LUT sites, {used['ff']} flip-flops",
             f"Yosys counts {used['lut']} LUT4, {used['carry']} carry cells and {used['lut_ram']} "
             "LUT RAM cells in them; the glossary defines a LUT site"),
        ]  # fmt: skip
    if gates := found.get("gate_equivalents"):
        rows.append((
            "gate equivalents (NAND2)", str(gates),
            "Oklahoma State University's 0.18 µm cells; without the three ROMs and the RAM of the "
            "tables, without clock tree and wires: not an area",
        ))  # fmt: skip
    return rows


def _netlist(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    models = "the models of MULT18X18D and DP16KD are this project's, those of other cells Yosys's"
    return [
        ("whole frames through the netlist of ECP5 cells",
         f"{found['frames']} frames, {grouped(found['pixels'])} pixels, {found['mismatches']} "
         "differ from the model", models),
        ("corner cases through the same netlist, registers zero and random at power-up",
         f"{found['cases']} cases, {found['complaints']} failures", models),
    ]  # fmt: skip


def _icarus(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    return [(
        "module tests with X in every register at power-up",
        f"{found['tests']} tests, {found['complaints']} failures",
        f"Icarus Verilog {found['icarus_version']}; one in {found['one_vector_in']} of the "
        "datapath's test vectors",
    )]  # fmt: skip


def _formal(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    return [(
        "proofs of flow control, interpolators and pruned modules",
        f"{found['hold']} of {found['proofs']} hold, {found['unbounded']} of them by unbounded "
        f"induction; {found['broken_designs_failing']} of {found['broken_designs']} broken "
        "designs fail",
        "order, loss, stalls and overflow; not colours. The pipeline as a whole is proven for the "
        "first 10 cycles",
    )]  # fmt: skip


def _coverage(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    percent = found["percent"]
    return [(
        "coverage of `rtl/`",
        f"lines {percent['line']:g} %, branches {percent['branch']:g} %, toggles "
        f"{percent['toggle']:g} %",
        f"by module tests, frame tests and configuration tests; {found['waived_lines']} lines are "
        "waived: a function that runs at elaboration only",
    )]  # fmt: skip


def mutant_totals(files: dict[str, Any], kind: str) -> dict[str, int]:
    """Sums over all `files` of the mutants of `kind` ("operator" or "constant")."""
    entries = [kinds[kind] for kinds in files.values() if kind in kinds]
    names = ("mutants", "killed", "refused", "equivalent", "survived")
    return {"files": len(entries)} | {name: sum(e[name] for e in entries) for name in names}


def _mutants(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    rows = []
    for kind, what in (
        ("operator", "mutants: each operator of `rtl/` changed"),
        ("constant", "mutants: each hand-written constant of `rtl/` changed by one"),
    ):
        of = mutant_totals(found["files"], kind)
        rows.append((
            what,
            f"{of['mutants']}: {of['killed']} fail a test, {of['refused']} fail the lint, "
            f"{of['equivalent']} are the same hardware, {of['survived']} survive",
            f"of {of['files']} files; `tests/campaigns/equivalent_mutants.txt` gives the reason "
            "why a mutant is the same hardware",
        ))  # fmt: skip
    return rows


def _random_scenes(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    return [(
        "random scenes, each on the build pruned to it, against the full model",
        f"{found['scenes']} scenes, {found['builds']} builds, {grouped(found['pixels'])} pixels, "
        f"{found['complaints']} failures",
        "random spans, not meshes",
    )]  # fmt: skip


def _more_synthesis(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    rows = []
    for name, of in found["configurations"].items():
        used, clock = of["resources"], of["clock_mhz"]
        if name in CURVE_BUILDS | LIGHT_BUILDS | PLACE_BUILDS:  # they have tables of their own
            continue
        rows.append((
            f"the same chip with `{name}`",
            f"{clock['median']:.1f} MHz, median of {of['seeds']} placements, best "
            f"{clock['best']:.1f} MHz; {used['dsp']} multipliers, {used['ebr']} block RAMs, "
            f"{used['lut_sites']} LUT sites, {used['ff']} flip-flops",
            "a timing estimate, clamped as above",
        ))  # fmt: skip
    return rows


def _mesh_fuzz(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    return [(
        "mutated mesh files, read and drawn or refused in one line",
        f"{grouped(found['files'])} files, {found['failures']} failures",
        "a few bytes changed in each; not every way to be hostile",
    )]  # fmt: skip


def _mesh_large(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    return [(
        f"a mesh of {grouped(found['triangles'])} triangles from file to spans, 1920×1080",
        f"{found['load_s']:.0f} s and {found['spans_s']:.0f} s, {found['memory_gib']:.1f} GiB",
        "one machine; the largest memory of both processes added up",
    )]  # fmt: skip


def _activity(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    def toggles(name: str) -> str:
        return ", ".join(f"{scene} {of[name]:.0f}" for scene, of in found["scenes"].items())

    return [
        ("register toggles per pixel, 640×480", toggles("toggles_per_pixel"),
         "registers only; not joules"),
        ("the same with `hold_unlit`: pixels turned away from the light hold the datapath",
         toggles("hold_unlit"), "takes one cycle and about 120 registers more; off by default"),
    ]  # fmt: skip


def _benchmark(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    rates = found.get("mesh_triangles_per_s", {})
    return [
        ("simulation speed under cocotb, as a share of a bare Verilator loop",
         number(found["cocotb_to_bare"], 2), "one machine"),
        ("the numpy model, 640×480 lit pixels",
         f"{found['model_frames_per_s']:.0f} frames/s on one core",
         "one machine; the pixel stages only"),
        *([("the compiled twin, as a multiple of the numpy twin",
            number(found["compiled_to_numpy"], 1), "one machine")]
          if "compiled_to_numpy" in found else []),
        *[(f"reading a {suffix.upper()} file of a million triangles, normals made",
           f"{grouped(rate)} triangles/s", "one machine") for suffix, rate in rates.items()],
    ]  # fmt: skip


#: Columns of a build's row, and their keys in the record.
_BUILD = {
    "multipliers": "dsp", "LUT sites": "lut_sites", "flip-flops": "ff", "block RAMs": "ebr",
}  # fmt: skip


def _build(found: dict[str, Any] | None) -> tuple[str, ...]:
    """The columns of _BUILD and the clock in MHz; dashes where nothing is recorded."""
    used = found["resources"] if found else {}
    clock = found["clock_mhz"] if found else None
    return (
        *(str(used.get(key, DASH)) for key in _BUILD.values()),
        number(clock["median"] if clock else None, 0),
    )


def lights(builds: dict[str, Any]) -> str:
    """The builds for eight lights of `builds` (configurations of synth-more): what units side by
    side cost."""
    rows = []
    for name, config in LIGHT_BUILDS.items():
        found = builds.get(name)
        clock = found and found["clock_mhz"]
        rate = f"{clock['median'] / config.turns:.0f}" if clock else DASH
        rows.append((str(config.units), str(config.turns), *_build(found), rate))
    return markdown(("units", "cycles a pixel", *_BUILD, "clock, MHz", "Mpixel/s"), rows)


#: A build for each rule of docs/shading.md that has hardware of its own.
RULE_BUILDS = (
    ("paper: one white light at infinity", "default"),
    ("flat", "flat"),
    ("Gouraud", "gouraud"),
    ("illumination model, eight lights in turns, coloured highlights", "lights_8"),
    ("light at a place", "placed_light"),
    ("Warnock, or any light that falls with the distance", "falling_light"),
    ("light at a place that falls with the distance", "placed_falling_light"),
    ("reflectance by table", "curve"),
    ("W(i) with a jump", "weight_jump"),
    ("reflectance by table, four jumps of it and of W(i)", "curve_jumps"),
    ("quadratic normals", "quadratic_normals"),
)


def rule_prices(builds: dict[str, dict[str, Any]]) -> str:
    """What the rules of docs/shading.md take of a chip. builds: {name: {"resources", "clock_mhz":
    {"median"} or None}}; a build that is not there has dashes."""
    nothing: dict[str, Any] = {"resources": {}, "clock_mhz": None}
    found = {name: builds.get(name, nothing) for _, name in RULE_BUILDS}
    key, title = logic(of["resources"] for of in found.values())
    columns = _BUILD | {"LUT sites": key}
    rows = []
    for rule, name in RULE_BUILDS:
        used, clock = found[name]["resources"], found[name]["clock_mhz"]
        cells = (number(used.get(column)) for column in columns.values())
        rows.append((rule, f"`{name}`", *cells, number(clock and clock["median"])))
    titles = (title if column == "LUT sites" else column for column in columns)
    return markdown(("rule", "configuration", *titles, "clock, MHz"), rows, left=2)


def places(builds: dict[str, Any]) -> str:
    """The builds for a light at a place, of `builds` (configurations of synth-more)."""
    words = {
        "placed_light": "at a place", "falling_light": "falling with the distance",
        "placed_falling_light": "both",
    }  # fmt: skip
    rows = [(words[name], f"`{name}`", *_build(builds.get(name))) for name in PLACE_BUILDS]
    return markdown(("light", "configuration", *_BUILD, "clock, MHz"), rows, left=2)


def reflectance(builds: dict[str, Any], default: dict[str, Any]) -> str:
    """Builds with curves and jumps of `builds` (configurations of synth-more), beside the `default`
    one."""
    names = {"default": default} | {name: builds.get(name) for name in CURVE_BUILDS}
    rows = [(f"`{name}`", *_build(found)) for name, found in names.items()]
    return markdown(("build", *_BUILD, "clock, MHz"), rows)


def _prove(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    families, pairs = found["families"], sum(row["pairs"] for row in found["power"])
    boxes = sum(of["search"]["boxes"] for of in families)
    return [(
        "bounds of the error of a colour, certified over all inputs by branch and bound",
        f"{len(families)} families of inputs, {grouped(boxes)} boxes; "
        f"{grouped(pairs)} pairs of the power exhausted",
        "the default method; the derivation behind the intervals is checked by tests, not by a "
        "proof assistant",
    )]  # fmt: skip


#: The records of the table of long runs, in its order, and what makes lines of each.
LONG_RUNS: dict[str, Callable[[dict[str, Any]], list[tuple[str, str, str]]]] = {
    "synth-grade6": _synthesis, "synth-grade8": _synthesis, "synth-more": _more_synthesis,
    "netlist": _netlist,
    "icarus": _icarus, "formal": _formal, "coverage": _coverage, "mutate": _mutants,
    "prove": _prove, "prune-random": _random_scenes, "mesh-fuzz": _mesh_fuzz, "activity": _activity,
    "bench": _benchmark, "mesh-large": _mesh_large,
}  # fmt: skip


#: Which of them docs/ shows where.
HARDWARE = ("synth-grade6", "synth-grade8", "synth-more", "activity")
TESTS = ("netlist", "icarus", "formal", "prove", "coverage", "mutate", "prune-random", "mesh-fuzz")
SPEED = ("bench", "mesh-large")


def hardware_rows(names: Iterable[str] = tuple(LONG_RUNS)) -> list[HardwareRow]:
    """The lines of the long runs `names` that have a record."""
    rows = []
    for name in names:
        lines = LONG_RUNS[name]
        if record := recorded.load(name):
            rows += [
                HardwareRow(what, figure, record["command"], caveat, name)
                for what, figure, caveat in lines(record["figures"])
            ]
    return rows


def hardware(rows: Iterable[HardwareRow]) -> str:
    """The table of long runs."""
    header = ("what", "figure", "command", "what it does not mean")
    cells = ((row.what, row.figure, f"`{row.command}`", row.caveat) for row in rows)
    return markdown(header, cells, left=len(header))


def lut_counts(resources: dict[str, int]) -> str:
    """How the two counts of logic come from the same cells."""
    lut, carry, ram = (resources[name] for name in ("lut", "carry", "lut_ram"))
    cells = lut + 2 * carry + 4 * ram
    sites = resources["lut_sites"]
    rows = [
        ("LUT4", str(lut), "1", str(lut)),
        ("carry cell (CCU2C)", str(carry), "2", str(2 * carry)),
        ("LUT RAM cell (TRELLIS_DPR16X4)", str(ram), "4", str(4 * ram)),
        ("**LUT cells (Yosys)**", "", "", f"**{cells}**"),
        ("write port of a LUT RAM cell", str(ram), "2", str(2 * ram)),
        ("carry into or out of a chain", str((sites - cells - 2 * ram) // 2), "2",
         str(sites - cells - 2 * ram)),
        ("**LUT sites**", "", "", f"**{sites}**"),
    ]  # fmt: skip
    return markdown(("what", "how many", "sites each", "sites"), rows)


# -- error against run time ------------------------------------------------------------------------

#: The configurations that the table shows: what a designer would choose between.
SHOWN = (
    "default", "quadratic_spans_18", "dot_first_18", "table_2048", "lines_32", "parabolas_8",
    "table_128_newton", "fast_inverse_1", "fast_inverse_2", "not_normalized", "power_tables_32",
    "squaring_18", "schlick_18", "interpolator_16", "interpolator_20", "width_14", "width_10",
)  # fmt: skip


def sweep(configurations: dict[str, dict[str, Any]]) -> str:
    """The configurations `SHOWN` of a sweep. Bounds are of the error against the port integers."""
    rows = []
    key, title = logic(configurations[name] for name in SHOWN)
    for name in SHOWN:
        of = configurations[name]
        stated = " (stated)" if of["clock_source"] == "stated" else ""
        rows.append((
            f"`{name}`", f"{of['method']}, {of['label']}", str(of["multipliers"]),
            number(of.get(key)), str(of["latency_cycles"]),
            f"{number(of['clock_mhz'])}{stated}", number(of["frame_us"]),
            number(of["rms_lsb"], 3), number(of["max_lsb"], 2),
            "none derived" if of["bound_lsb"] is None else above(of["bound_lsb"], 2),
            f"{100 * of['correctly_rounded']:.2f} %",
        ))  # fmt: skip
    header = (
        "configuration", "method, size", "multipliers", title, "latency, cycles", "clock, MHz",
        "frames, µs", "RMS error, LSB", "largest error, LSB", "bound, LSB",
        "rounded correctly",
    )  # fmt: skip
    return markdown(header, rows, left=2)


def front(configurations: dict[str, dict[str, Any]]) -> list[tuple[str, dict[str, Any]]]:
    """The Pareto front of RMS error and run time, the fastest first.

    Errors count to a thousandth of an LSB: a smaller difference cannot be seen.
    """
    items = list(configurations.items())
    points = [(of["frame_us"], round(of["rms_lsb"], 3)) for _, of in items]
    return sorted(
        (item for item, on in zip(items, pareto.on_front(points), strict=True) if on),
        key=lambda item: item[1]["frame_us"],
    )


#: Modules that every configuration shares: a longest path from one of them says nothing about the
#: method.
SHARED = ("span_walker", "pixel_fifo", "phong_pipeline", "phong_unit", "harness")


def clocks(configurations: dict[str, dict[str, Any]]) -> str:
    """Every routed clock that is kept, the slowest first, and where its longest path leads."""
    rows = [
        (f"`{name}`", of["longest_path"], number(of["clock_mhz"], 1))
        for name, of in sorted(configurations.items(), key=lambda item: item[1]["clock_mhz"])
    ]
    return markdown(("configuration", "longest path", "clock, MHz"), rows, left=2)


# -- true surfaces ---------------------------------------------------------------------------------


def surfaces(record: dict[str, Any]) -> str:
    """Errors against true surfaces, and the paper's claims as numbers."""
    bent = ("quadratic_vlachos", "quadratic", "quadratic_exact")
    methods = ("flat", "gouraud", "phong", *bent, "cubic")
    rows: list[tuple[str, ...]] = []

    def line(mesh: str, what: str, values: Sequence[float | str | None]) -> None:
        cells = [number(v, 2) if isinstance(v, float) else v or "" for v in values]
        rows.append((mesh, what, *cells, *[""] * (len(methods) - len(cells))))

    def jumps(shape: str, level: int) -> tuple[str, list[float | str | None]]:
        by = record["mach_bands"][shape][str(level)]
        slopes = [by[m]["slope_mean"] for m in methods[1:-1]]
        return "jump of the slope at edges, LSB per pixel", ["not smooth", *slopes]

    for shape, by in _by_shape(record["meshes"]).items():
        mesh = f"{shape}, {by['flat']['triangles']} triangles"
        line(mesh, "RMS error, LSB", [by[m]["method_rms_lsb"] for m in methods])
        line("", "RMS error in the highlight, LSB", [by[m]["highlight_rms_lsb"] for m in methods])
        orders = record["orders"][shape]
        line("", "order of convergence", [orders[m]["facing_rms"] for m in methods])
        line("", *jumps(shape, by["flat"]["level"]))
    line("torus of 16 steps, 256 triangles", *jumps("torus", 16))
    for shape, by in record["flicker"].items():
        mesh = f"{shape}, turning into itself"
        shown = [by.get(m) for m in methods]
        line(mesh, "RMS change per degree, LSB", [of and of["change_rms"] for of in shown])
        peaks = [of and "{} to {}".format(*of["peak_range"]) for of in shown]
        line("", "brightest code, over all pictures", peaks)
    for kind, name in (("quadrilateral", "square as one polygon"), ("triangles", "two triangles")):
        spread = record["orientation"][kind]["largest_spread_lsb"]
        line(name, "largest dependence on orientation, LSB", [None, spread])
    header = ("mesh", "what", "flat", "Gouraud", "Phong", "quadratic, Vlachos", "quadratic",
              "quadratic, exact", "cubic (model only)")  # fmt: skip
    return markdown(header, rows, left=2)


def quadratic_normals(record: dict[str, Any]) -> str:
    """What each rule of mid-edge normals gains on the torus, and how it converges."""
    names = {
        "gouraud": "Gouraud's shading", "phong": "linear normals",
        "quadratic_vlachos": "`quadratic_vlachos`", "quadratic": "`quadratic`",
        "quadratic_exact": "`quadratic_exact`",
    }  # fmt: skip
    torus = _by_shape(record["meshes"])["torus"]
    jumps = record["mach_bands"]["torus"]["16"]
    rows = [
        (
            name, number(torus[method]["method_rms_lsb"], 2),
            number(torus[method]["facing_rms_lsb"], 2),
            ", ".join(number(by[method]["facing_rms"], 1) for by in record["orders"].values()),
            number(jumps[method]["slope_mean"], 2),
        )
        for method, name in names.items()
    ]  # fmt: skip
    header = ("normals", f"torus of {torus['phong']['triangles']} triangles, RMS error, LSB",
              "the same within 60° of the eye",
              f"order of convergence: {', '.join(record['orders'])}",
              "torus of 16 steps: jump of the slope at edges, LSB per pixel")  # fmt: skip
    return markdown(header, rows)


def _by_shape(meshes: Iterable[dict[str, Any]]) -> dict[str, dict[str, dict[str, Any]]]:
    found: dict[str, dict[str, dict[str, Any]]] = {}
    for row in meshes:
        found.setdefault(row["shape"], {})[row["technique"]] = row
    return found


def highlight_ratios(meshes: Iterable[dict[str, Any]]) -> list[float]:
    """Gouraud's RMS error in the highlight as a multiple of Phong's, for each shape."""
    name = "highlight_rms_lsb"
    return [by["gouraud"][name] / by["phong"][name] for by in _by_shape(meshes).values()]


# -- shadings side by side -------------------------------------------------------------------------


def comparison_rows(report: dict[str, Any]) -> list[list[str]]:
    """The table of a comparison: its header, then a line a figure, with a cell for each shading."""
    rows = report["shadings"]
    hardware = [row["hardware"] for row in rows]
    logic_key, logic_title = logic(hardware)

    def line(what: str, values: Iterable[float | None], digits: int = 0) -> list[str]:
        return [what, *(number(value, digits) for value in values)]

    lines = [
        ["what", *(row["title"] for row in rows)],
        line("RTL ≠ model, pixels", (row["mismatches"] for row in rows)),
        line("cycles", (row["cycles"] for row in rows)),
        line(f"frames/s at {report['clock_hz'] / 1e6:g} MHz", (row["fps"] for row in rows)),
        line("multipliers", (of["dsp"] for of in hardware)),
        line(logic_title, (of[logic_key] for of in hardware)),
        line("flip-flops", (of["ff"] for of in hardware)),
    ]
    for what, key in (("largest", "max_lsb"), ("derived bound", "bound_lsb"), ("RMS", "rms_lsb")):
        lines.append(line(f"error at the ports, {what}, LSB", (r["error"][key] for r in rows), 3))
    basis = "the true surface"
    if not report["basis"]["true_surface"]:
        lines.append(line(f"from {basis}, LSB", (None for _ in rows)))
        basis = "Phong"
    for what, key in (("RMS", "rms_lsb"), ("99.9 %", "p999_lsb"), ("largest", "max_lsb")):
        values = (row["difference"][key] for row in rows)
        lines.append(line(f"from {basis}, {what}, LSB", values, 2))
    return lines


def comparison(report: dict[str, Any]) -> str:
    """The same as Markdown."""
    header, *rows = comparison_rows(report)
    return markdown(header, rows)


# -- stability -------------------------------------------------------------------------------------


def error_families(rows: Iterable[dict[str, Any]]) -> str:
    """The largest errors: of the bundled scenes, and of the worst input found, with its bound."""
    names = ("scenes_lsb", "adversarial_lsb")
    cells = (
        (row["family"], *(number(row[name], 3) for name in names),
         above(row["adversarial_bound_lsb"], 3))
        for row in rows
    )  # fmt: skip
    header = (
        "inputs", "bundled scenes, LSB", "worst input found, LSB", "its own derived bound, LSB"
    )  # fmt: skip
    return markdown(header, cells)


def certified(rows: Iterable[dict[str, Any]]) -> str:
    """Worst inputs found beside certified bounds, which are rounded up."""
    cells = (
        (row["family"], f"{number(row['reached_lsb'], 4)} ≤ {above(row['certified_lsb'], 4)}",
         above(row["certified_lsb"] / row["reached_lsb"], 3), grouped(row["boxes"]))
        for row in rows
    )  # fmt: skip
    header = ("inputs", "worst input found ≤ certified bound, LSB", "ratio", "boxes")
    return markdown(header, cells)


def cases(rows: Iterable[dict[str, Any]], words: dict[str, tuple[str, str]]) -> str:
    """Every corner case, and what came out of the RTL. words: {case: (extreme, expected)}."""
    cells = (
        (row["case"], *words.get(row["case"], ("", "")),
         DASH if row["pixels"] is None else grouped(row["pixels"]),
         number(row["max_lsb"], 3),
         DASH if row["bound_lsb"] is None else above(row["bound_lsb"], 3),
         DASH if row["mismatches"] is None else str(row["mismatches"]), row["verdict"])
        for row in rows
    )  # fmt: skip
    header = (
        "case", "what is extreme", "expected", "pixels", "largest error, LSB", "bound, LSB",
        "RTL ≠ model", "verdict",
    )  # fmt: skip
    return markdown(header, ([cell.replace("|", "\\|") for cell in row] for row in cells), left=3)


def method_cases(rows: Iterable[dict[str, Any]]) -> str:
    """The corner cases by every method: how many it takes, and its largest error."""
    cells = (
        (f"`{row['name']}`", str(row["cases"] - row["refused"]), str(row["refused"] or DASH),
         number(row["max_lsb"], 2) if row["bound_lsb"] else DASH,
         above(row["bound_lsb"]) if row["bound_lsb"] else DASH,
         f"{row['unbounded']}: {number(row['unbounded_lsb'], 1)}" if row["unbounded"] else DASH,
         str(row["mismatches"]))
        for row in rows
    )  # fmt: skip
    header = (
        "configuration", "cases", "refused", "largest error, LSB", "bound, LSB",
        "without a bound, LSB", "RTL ≠ model",
    )  # fmt: skip
    return markdown(header, cells)


def certified_methods(rows: Iterable[dict[str, Any]], default: dict[bool, float]) -> str:
    """Certified bounds of the methods. default: {any W: that of the default}."""
    found = [{"name": "default", "constant_lsb": default[False], "any_lsb": default[True]}, *rows]
    cells = (
        (f"`{row['name']}`", *(above(row[key], 3) if row[key] else DASH
                               for key in ("constant_lsb", "any_lsb")))
        for row in found
    )  # fmt: skip
    return markdown(("configuration", "W constant, LSB", "any W, LSB"), cells)


def powers(rows: Iterable[dict[str, Any]]) -> str:
    """The error of cos(s)^n alone."""
    cells = (
        (f"{row['n']:g}", f"{row['max_error']:.2g}", above_digits(row["bound"], 2)) for row in rows
    )
    return markdown(("n", "largest error", "derived bound"), cells, left=0)


# -- leaving out -----------------------------------------------------------------------------------

#: Columns of the table of pruned builds as keys of a record, in order. "logic" stands for the key
#: that `logic` chooses; the column of the constant multipliers is the second.
PRUNING = (
    "dsp", "logic", "ff", "ebr", "gate_equivalents", "latency", "clock_mhz",
    "simulation_clocks_per_s", "toggles_per_pixel",
)  # fmt: skip


def pruning_row(
    name: str, pruned: dict[str, Any], full: dict[str, Any], counted: str = "lut_sites"
) -> list[str]:
    """The cells of a build: each figure, and percent of the full design. counted: see `logic`."""
    cells = []
    for column in PRUNING:
        key = counted if column == "logic" else column
        value = pruned[key]
        if value is None:
            cells.append(DASH)
            continue
        percent = f"{100 * value / full[key]:.0f} %" if full[key] else DASH
        speed = key == "simulation_clocks_per_s"
        cells.append(f"{value / 1e6:.2f} M/s ({percent})" if speed else f"{value:.0f} ({percent})")
    count, trees = pruned["constant_multipliers"], pruned["constant_lut_cells"]
    return [name, cells[0], f"{count}, {trees}" if count else "0", *cells[1:]]


def pruning(builds: list[dict[str, Any]]) -> str:
    """All pruned builds; the full design, on the teapot, first."""
    full = next(build["full"] for build in builds if build["name"] == "teapot")
    key, title = logic(build[which] for build in builds for which in ("pruned", "full"))
    rows = [pruning_row("everything", full, full, key)]
    rows += [pruning_row(build["name"], build["pruned"], build["full"], key) for build in builds]
    header = (
        "scene or configuration", "multipliers", "constant multipliers, their LUT cells (Yosys)",
        title, "flip-flops", "block RAMs", "gate equivalents", "latency, cycles",
        "clock, MHz", "simulation, cycles/s", "toggles per pixel",
    )  # fmt: skip
    return markdown(header, rows)


def pruning_bars(builds: list[dict[str, Any]]) -> str:
    """What the tests hold the pruned builds to, and the figures."""
    of = {build["name"]: build for build in builds}
    dsp = {name: build["pruned"]["dsp"] for name, build in of.items()}
    full = of["teapot"]["full"]["dsp"]
    speed = "simulation_clocks_per_s"
    rate = {name: build["pruned"][speed] / build["full"][speed] for name, build in of.items()}
    slowest = min(rate, key=lambda name: rate[name])
    rows = [
        ("*diffuse*: at most 8 multipliers", f"{dsp['diffuse']}"),
        ("*diffuse grey*: at most 6 multipliers", f"{dsp['diffuse grey']}"),
        ("*gouraud* and *flat*: no multiplier", f"{dsp['gouraud']} and {dsp['flat']}"),
        ("teapot: at least a quarter fewer multipliers than the full design",
         f"{dsp['teapot']} of {full}: {100 * (1 - dsp['teapot'] / full):.0f} % fewer"),
        ("no pruned build simulates slower than the full design",
         f"the slowest, *{slowest}*, reaches {100 * rate[slowest]:.1f} % of its cycles per second"),
    ]  # fmt: skip
    return markdown(("requirement", "figure"), rows, left=2)


# -- installing, and where the figures come from ---------------------------------------------------


def install(rows: Iterable[dict[str, Any]]) -> str:
    """What a command installs and how long it takes, at the first call and later."""
    cells = (
        (f"`{row['command']}`", row["installs"], number(row["download_mb"]),
         number(row["installed_mb"]), number(row["first_minutes"], 1), number(row["minutes"], 1))
        for row in rows
    )  # fmt: skip
    header = (
        "command", "installs", "download, MB", "on disk, MB", "first call, minutes",
        "later calls, minutes",
    )  # fmt: skip
    return markdown(header, cells, left=2)


def provenance() -> str:
    """Command, tools, date and commit of every record. `+`: with changes since that commit."""
    rows = []
    for path in sorted(recorded.FOLDER.glob("*.json")):
        record = recorded.load(path.stem)
        if record is None or "figures" not in record:  # the tests' durations
            continue
        tools = ", ".join(f"{name} {version}" for name, version in record["tools"].items())
        rows.append((path.stem, f"`{record['command']}`", tools, record["date"], record["commit"]))
    return markdown(("record", "command", "tools", "date", "commit"), rows, left=5)
