# SPDX-License-Identifier: MIT
"""Every table and every figure that a marker can name, and what makes it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from phong75.model.analysis import certificate
from phong75.model.config import DEFAULT, TECHNIQUES
from phong75.model.front import mesh_normals
from phong75.model.front.mesh_files import materials
from phong75.model.studies import corner_cases
from phong75.model.studies.methods import CONFIGS
from phong75.model.studies.shadings import FARTHEST_FACTOR
from phong75.scripts import prove, recorded
from phong75.scripts.configurations import BUILDS
from phong75.scripts.docs import commands, facts, tables
from phong75.sim import design

#: Tables that change with date and commit alone: filled, and not compared.
UNCOMPARED = ("provenance",)


def _record(name: str) -> dict[str, Any]:
    figures = recorded.figures(name)
    if not figures:
        raise FileNotFoundError(f"results/{name}.json is missing")
    return figures


def _sweep() -> dict[str, dict[str, Any]]:
    return _record("sweep")["configurations"]


def _clocks() -> dict[str, dict[str, Any]]:
    return _record("clocks")["configurations"]


def _certified(limit: int, steep: bool) -> float:
    """The certified bound in LSB for n up to `limit`; steep: for any W(i), not for a constant W."""
    rows = _record("prove")["families"]
    return next(
        row["certified_lsb"] for row in rows if (row["limit"], row["steep"]) == (limit, steep)
    )


def _certified_ratio() -> float:
    """The largest ratio of a certified bound to the worst input found."""
    return max(row["certified_lsb"] / row["reached_lsb"] for row in _record("prove")["families"])


def _power_error(n: float) -> float:
    return next(row["max_error"] for row in _record("stability")["powers"] if row["n"] == n)


def _synthesis(*path: str) -> Any:
    found: Any = _record("synth-grade6")
    for key in path:
        found = found[key]
    return found


def _builds() -> dict[str, Any]:
    """What is recorded of BUILDS; of a build that is not, its multipliers as elaborated."""
    found = _record("synth-more")["configurations"]
    for name in BUILDS.keys() - found.keys():
        resources = {"dsp": facts.modules(BUILDS[name])["multiplier"]}
        found[name] = {"resources": resources, "clock_mhz": None}
    return found


def _rules() -> dict[str, Any]:
    """The builds of `tables.RULE_BUILDS`, from the records that have them."""
    older = {
        of["name"]: {"resources": of["pruned"], "clock_mhz": {"median": of["pruned"]["clock_mhz"]}}
        for of in _record("prune")["builds"] if of["name"] in TECHNIQUES
    }  # fmt: skip
    return _builds() | older | {DEFAULT.name: _record("synth-grade6")}


def _mutants(what: str) -> int:
    files = _record("mutate")["files"]
    return sum(tables.mutant_totals(files, kind)[what] for kind in ("operator", "constant"))


def _shared_clocks() -> list[float]:
    """Clocks whose longest path starts in a module that all configurations share."""
    return [
        of["clock_mhz"] for of in _clocks().values()
        if of["longest_path"].split()[0] in tables.SHARED
    ]  # fmt: skip


def _quadratic_clocks() -> list[float]:
    return [of["clock_mhz"] for name, of in _clocks().items() if name.startswith("quadratic_spans")]


def _inferred() -> str:
    """Configurations whose longest path starts in a table, and their clocks."""
    slow = [
        (of["clock_mhz"], name)
        for name, of in _clocks().items()
        if of["longest_path"].startswith("rom ")
    ]
    return ", ".join(f"`{name}` {clock:.0f} MHz" for clock, name in sorted(slow))


def _front() -> str:
    return ", ".join(
        f"`{name}` ({of['frame_us']:.0f} µs, {of['rms_lsb']:.3f} LSB)"
        for name, of in tables.front(_sweep())
    )


def _unrouted() -> str:
    """How many configurations of the sweep have a stated clock, in words."""
    stated = sum(of["clock_source"] == "stated" for of in _sweep().values())
    return f"{stated} of {len(_sweep())}" if stated else "none"


def summary() -> str:
    """The README's table of results: what, figure, and where to read on."""
    scenes, synthesis = _record("scenes"), _record("synth-grade6")
    formal, coverage = _record("formal"), _record("coverage")
    used, clock = synthesis["resources"], synthesis["clock_mhz"]
    runs = [run for of in scenes["scenes"].values() for run in of]
    slowest = min(scenes["clock_hz"] / of[-1]["cycles"] for of in scenes["scenes"].values())
    rows = [
        ("pixels in which RTL and model differ",
         f"{sum(run['mismatches'] for run in runs)} of "
         f"{tables.grouped(sum(run['pixels'] for run in runs))} ({len(scenes['scenes'])} scenes, "
         f"{len(runs) // len(scenes['scenes'])} sizes)", "[results](docs/results.md)"),
        ("largest error against float64 at the same ports, and its derived bound",
         f"{tables.worst_scene(scenes, 'max_lsb'):.3f} LSB, "
         f"{tables.above(tables.worst_scene(scenes, 'bound_lsb'), 3)} LSB (perfect rounding: 0.5)",
         "[error budget](docs/architecture.md#error-budget)"),
        ("throughput, latency",
         f"one pixel per cycle, {facts.latency('first_pixel')} cycles from a span to its first "
         "pixel", "[architecture](docs/architecture.md)"),
        ("frame rate at 1920×1080 and 200 MHz, slowest scene", f"{slowest:.0f} frames/s",
         "[results](docs/results.md)"),
        (f"Lattice ECP5 {synthesis['device']}, speed grade 6",
         f"{clock['median']:.0f} MHz (median of {synthesis['seeds']} placements), {used['dsp']} "
         f"multipliers 18×18, {used['ebr']} block RAMs, {used['lut_sites']} LUT sites, "
         f"{used['ff']} flip-flops", "[hardware](docs/studies/hardware.md)"),
        ("proofs", f"{formal['hold']} of {formal['proofs']} hold; "
         f"{formal['broken_designs_failing']} of {formal['broken_designs']} broken designs fail",
         "[verification](docs/verification.md#proofs)"),
        ("corner cases", f"{len(_record('stability')['rows'])}, "
         f"{sum(row['verdict'] != 'ok' for row in _record('stability')['rows'])} fail",
         "[stability](docs/studies/stability.md)"),
        (f"mutants, of {len(_record('mutate')['files'])} of "
         f"{len(design.sources()) + len(design.headers())} files of `rtl/`",
         f"{_mutants('mutants')}, {_mutants('survived')} survive",
         "[verification](docs/verification.md#mutants)"),
        ("coverage of `rtl/`", f"lines {coverage['percent']['line']:g} %, branches "
         f"{coverage['percent']['branch']:g} %", "[verification](docs/verification.md#coverage)"),
    ]  # fmt: skip
    return tables.markdown(("what", "figure", "more"), rows, left=3)


TABLES: dict[str, Callable[[], str]] = {
    "summary": summary,
    "install": lambda: tables.install(_record("install")["rows"]),
    "diagram": facts.diagram,
    "latencies": facts.latency_table,
    "formats": facts.formats,
    "ports": facts.port_table,
    "span-word": facts.span_table,
    "span-word-quadratic": lambda: facts.span_table(replace(DEFAULT, normal_order=2)),
    "pixel-word": facts.pixel_table,
    "registers": facts.register_table,
    "budget": facts.budget,
    "features": facts.features,
    "configurations": facts.configurations,
    "scenes": lambda: tables.scenes(_record("scenes")),
    "techniques": lambda: tables.techniques(_record("scenes")["techniques"]),
    "hardware": lambda: tables.hardware(tables.hardware_rows(tables.HARDWARE)),
    "tests": lambda: tables.hardware(tables.hardware_rows(tables.TESTS)),
    "speed": lambda: tables.hardware(tables.hardware_rows(tables.SPEED)),
    "places": lambda: tables.places(_builds()),
    "place-rules": facts.place_rules,
    "lights": lambda: tables.lights(_builds()),
    "rule-prices": lambda: tables.rule_prices(_rules()),
    "reflectance": lambda: tables.reflectance(_builds(), _record("synth-grade6")),
    "curve-powers": facts.curve_powers,
    "shapes": facts.shapes,
    "proofs": facts.proofs,
    "lut-counts": lambda: tables.lut_counts(_synthesis("resources")),
    "sweep": lambda: tables.sweep(_sweep()),
    "clocks": lambda: tables.clocks(_clocks()),
    "comparison": lambda: tables.comparison(_record("compare")),
    "surfaces": lambda: tables.surfaces(_record("tessellation")),
    "quadratic-normals": lambda: tables.quadratic_normals(_record("tessellation")),
    "error-families": lambda: tables.error_families(_record("stability")["errors"]),
    "method-cases": lambda: tables.method_cases(_record("stability")["methods"]),
    "certified-methods": lambda: tables.certified_methods(
        _record("prove-methods")["methods"],
        {steep: _certified(128, steep) for steep in (False, True)},
    ),
    "certified": lambda: tables.certified(_record("prove")["families"]),
    "cases": lambda: tables.cases(_record("stability")["rows"], facts.case_words()),
    "powers": lambda: tables.powers(_record("stability")["powers"]),
    "pruning": lambda: tables.pruning(_record("prune")["builds"]),
    "pruning-bars": lambda: tables.pruning_bars(_record("prune")["builds"]),
    "commands": commands.commands,
    "targets": commands.targets,
    "provenance": tables.provenance,
}


def _undecided(scene: str) -> str:
    """Pixels at a jump in the run of a technique's scene, of how many."""
    row = next(r for r in _record("scenes")["techniques"] if r["scene"] == scene)
    return f"{row['undecided']} of {tables.grouped(row['pixels'])}"


def _case(name: str, figure: str) -> float:
    return next(row[figure] for row in _record("stability")["rows"] if row["case"] == name)


def _lights_error() -> float:
    """The largest error of the corner cases with several lights, LSB."""
    names = [case.name for case in corner_cases.cases() if case.frame.lights > 1]
    return max(_case(name, "max_lsb") or 0.0 for name in names)


def _highlights() -> list[float]:
    return tables.highlight_ratios(_record("tessellation")["meshes"])


FIGURES: dict[str, Callable[[], str]] = {
    # of the design
    "latency.first-pixel": lambda: str(facts.latency("first_pixel")),
    "latency.first-pixel-gouraud": lambda: str(facts.latency("first_pixel", TECHNIQUES["gouraud"])),
    "multipliers": lambda: str(facts.modules()["multiplier"]),
    "bound.n32": lambda: tables.above(_certified(32, steep=True)),
    "bound.n128": lambda: tables.above(_certified(128, steep=True)),
    "bound.constant-n32": lambda: tables.above(_certified(32, steep=False)),
    "bound.constant-n128": lambda: tables.above(_certified(128, steep=False)),
    "prove.pairs": lambda: f"{sum(row['pairs'] for row in _record('prove')['power']) / 1e9:.0f}",
    "prove.ratio": lambda: f"{prove.RATIO:g}",
    "prove.limit": lambda: f"{0.5 + DEFAULT.white * certificate.LARGEST:.3f}",
    "bound.ratio": lambda: tables.above(_certified_ratio(), 3),
    "bound.intensity": lambda: tables.above(facts.intensity_bound(), 4),
    "bound.mantissa": facts.mantissa_error,
    "bound.eight-lights": lambda: tables.above(_case("eight lights, n = 128", "bound_lsb")),
    "lights.error": lambda: tables.above(_lights_error()),
    "span.half-vector": lambda: str(2 * DEFAULT.half_vector.bits),
    "span.distance": lambda: str(2 * DEFAULT.depth.bits),
    "curve.one-sided": lambda: f"{facts.one_sided_distance(0.5):.1f}",
    "curve.equal": lambda: f"{facts.equal_distance(128):.1f}",
    "toon.undecided": lambda: _undecided("toon"),
    "configurations": lambda: str(len(CONFIGS)),
    "facets.longest": lambda: str(facts.facets()[0]),
    "facets.shortest": lambda: f"{facts.facets()[1]:.2f}",
    "warnock.farthest": lambda: f"{100 * FARTHEST_FACTOR:g}",
    "mesh.memory": facts.mesh_memory,
    "mesh.time": facts.mesh_time,
    "mesh.crease": lambda: f"{mesh_normals.DEFAULT_CREASE:g}",
    "mesh.large": lambda: f"{mesh_normals.LARGE:g}",
    "mesh.chamfer": lambda: f"{100 * facts.CHAMFER:g}",
    "mesh.bend-area": lambda: f"{facts.chamfered_bend(by_area=True):.0f}",
    "mesh.bend-angle": lambda: f"{facts.chamfered_bend(by_area=False):.0f}",
    "mesh.d": lambda: f"{materials.AMBIENT_SHARE:g}",
    "mesh.n": lambda: f"{materials.LEAST_N:g} to {materials.MOST_N:g}",
    "mesh.entries": lambda: str(DEFAULT.materials),
    # of the records
    "cases": lambda: str(len(_record("stability")["rows"])),
    "power.n20": lambda: f"{_power_error(20):.2g}",
    "power.amm": lambda: f"{_record('stability')['amm_2012_at_20']:g}",
    "front": _front,
    "clocks.stated": _unrouted,
    "clocks.routed": lambda: str(len(_clocks())),
    "clocks.shared": lambda: str(len(_shared_clocks())),
    "clocks.shared-low": lambda: f"{min(_shared_clocks()):.0f}",
    "clocks.shared-high": lambda: f"{max(_shared_clocks()):.0f}",
    "clocks.inferred": _inferred,
    "clocks.quadratic-low": lambda: f"{min(_quadratic_clocks()):.0f}",
    "clocks.quadratic-high": lambda: f"{max(_quadratic_clocks()):.0f}",
    "highlight.low": lambda: f"{min(_highlights()):.0f}",
    "highlight.high": lambda: f"{max(_highlights()):.0f}",
}
