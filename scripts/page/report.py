# SPDX-License-Identifier: MIT
"""One page of all results, build/report/index.html: `phong75 report`.

The page shows pictures, shadings side by side, techniques, cycles, error over run time, stability,
the error budget and the records of the long runs, from the JSON and CSV files of the other targets.
Scenes without a current result are run first. The page is one file that needs no network: pictures
are WebP, those of the scenes without loss, and plotly.js is packed with gzip. Together that is less
than LIMIT_BYTES. A part whose data is missing names the command that makes it. Exit code: 0; 2 if
the page could not be made.
"""

from __future__ import annotations

import base64
import csv
import gzip
import itertools
import json
import re
import subprocess
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path

import jinja2
import numpy as np
import plotly.graph_objects as go
from markupsafe import Markup, escape
from PIL import Image
from plotly.offline import get_plotlyjs

from phong75.model.analysis import error_budget
from phong75.model.analysis.pruning import FeatureRow, prune
from phong75.model.analysis.run_report import SCHEMA, failures
from phong75.model.config import DEFAULT as C
from phong75.model.config import TECHNIQUES
from phong75.model.frame import InputError
from phong75.model.front.scene import bundled_scenes, load_scene
from phong75.model.spans import read_spans
from phong75.model.studies import methods, pareto, tessellation
from phong75.model.studies.charts import TECHNIQUE_NAMES
from phong75.scripts import compare, console, recorded
from phong75.scripts import run as run_scene
from phong75.scripts.console import Steps
from phong75.scripts.docs.tables import (
    TECHNIQUE_WORDS,
    HardwareRow,
    comparison_rows,
    hardware_rows,
)
from phong75.scripts.scene_results import SCHEMA as RESULTS
from phong75.scripts.scene_results import picture_path
from phong75.scripts.stability import SCHEMA as STABILITY
from phong75.scripts.studies import artifact_runs
from phong75.sim.design import BUILD, PACKAGE
from phong75.sim.frame import run_frame

#: The page weighs less than this.
LIMIT_BYTES = 5_000_000

#: Colours of the error maps, which are noise: fewer colours, fewer bytes.
MAP_COLOURS = 64

#: Markers of the curves, one a method.
SHAPES = ("circle", "square", "diamond", "triangle-up", "x", "cross", "star", "pentagon")
#: Colours that can be told apart with any kind of colour vision, on white and on black.
COLOURS = (
    "#0a84c6", "#d98200", "#109a6c", "#c3639b", "#d3552b", "#7a6ff0", "#8a8a8a", "#b09b00",
)  # fmt: skip

#: Columns of the sweep's tables that can be axes, and their names.
COSTS = {
    "frame_us": "run time of all frames, µs", "cycles": "cycles of all frames",
    "dsp": "multipliers", "lut_cells": "LUT cells (Yosys)", "ff": "flip-flops",
    "simulate_s": "host: seconds of RTL simulation", "model_s": "host: seconds of the model",
}  # fmt: skip
ERRORS = {
    "rms_lsb": "RMS error, LSB", "max_lsb": "largest error, LSB", "p999_lsb": "99.9 % error, LSB",
    "mean_lsb": "mean error, LSB", "wrong": "share not correctly rounded",
}  # fmt: skip
#: Errors in the study of tessellation: of the techniques themselves in float64, and of the RTL's
#: codes. The cubic interpolant has no RTL and no codes.
UNROUNDED_ERRORS = {
    "method_rms_lsb": "not rounded: RMS error, LSB",
    "highlight_rms_lsb": "not rounded: RMS error in highlights, LSB",
    "facing_rms_lsb": "not rounded: RMS error facing the eye, LSB",
    "method_max_lsb": "not rounded: largest error, LSB",
}  # fmt: skip
CODE_ERRORS = {
    "rms_lsb": "codes of the RTL: RMS error, LSB",
    "max_lsb": "codes of the RTL: largest error, LSB",
    "p999_lsb": "codes of the RTL: 99.9 % error, LSB",
    "mean_lsb": "codes of the RTL: mean error, LSB",
}  # fmt: skip
SURFACE_ERRORS = UNROUNDED_ERRORS | CODE_ERRORS
SIZES = {"triangles": "triangles", "cycles": "cycles a frame", "spans": "spans"}

#: What must be there of the sweep's tables.
PRECISION = ("method", "label", "cycles", "frame_us", "clock_mhz", "clock_source", "max_lsb",
             "rms_lsb", "p999_lsb", "mean_lsb", "correctly_rounded", "psnr_db")  # fmt: skip
TESSELLATION = ("shape", "technique", "level", "triangles", "spans", "cycles", "max_lsb")


@dataclass
class View:
    """A picture of a scene: its key, its label, and the picture as a data URI."""

    key: str
    label: str
    picture: str


@dataclass
class SceneResult:
    """What the page shows of a bundled scene.

    report: report.json of its run. views: pictures that can be laid over each other. error_map: a
    data URI. failures: a line for each check that failed. budget: error budget of the material
    with the largest bound. features: what the scene needs of the pipeline.
    """

    name: str
    report: dict
    views: list[View]
    error_map: str
    failures: list[str]
    budget: list[error_budget.BudgetRow] = field(default_factory=list)
    features: dict[str, FeatureRow] = field(default_factory=dict)

    @property
    def size(self) -> str:
        """Width and height of the picture, in pixels."""
        return size_text(self.report["size"])


def size_text(size) -> str:
    """(width, height) as text."""
    return "{} × {}".format(*size)


def data_uri(path: Path, lossless: bool = True, colours: int = 0) -> str:
    """The picture in `path` as a data URI: WebP, `lossless` or smaller, with at most `colours`
    colours unless that is 0. Raises OSError."""
    packed = BytesIO()
    how = {"lossless": True, "quality": 75, "method": 4} if lossless else {"quality": 80}
    with Image.open(path) as picture:
        shown = picture.convert("RGB")
        if colours:
            shown = shown.quantize(colours, dither=Image.Dither.NONE).convert("RGB")
        shown.save(packed, "WEBP", **how)
    return "data:image/webp;base64," + base64.b64encode(packed.getvalue()).decode()


def pack(text: str) -> str:
    """`text` as gzip in base64, which the page unpacks."""
    return base64.b64encode(gzip.compress(text.encode(), mtime=0)).decode()


def load(path: Path, schema: int | None = None):
    """The JSON in `path`, or None if there is none.

    Raises InputError if it is broken, or of another layout than `schema`.
    """
    if not path.is_file():
        return None
    try:
        content = json.loads(path.read_text())
    except ValueError as error:
        raise InputError(f"{path}: not JSON: {error}") from None
    if schema is not None and content.get("schema") != schema:
        raise InputError(f"{path}: another version wrote it; remove it, or make it anew")
    return content


def load_csv(path: Path, needed: tuple[str, ...]) -> list[dict]:
    """The rows of `path`, numbers where they are; empty if there is no such file.

    Raises InputError if one of the columns `needed` is missing.
    """
    if not path.is_file():
        return []
    with path.open(newline="") as file:
        rows = [{k: _number(v) for k, v in row.items()} for row in csv.DictReader(file)]
    for name in needed:
        if rows and name not in rows[0]:
            raise InputError(f"{path}: no column `{name}`; remove it, or make it anew")
    return rows


def _number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return text or None


def newest_source() -> float:
    """When anything that a run depends on was last changed, seconds."""
    files = [p for folder in ("rtl", "model", "sim") for p in (PACKAGE / folder).rglob("*")]
    return max(p.stat().st_mtime for p in files if p.is_file() and "__pycache__" not in p.parts)


def folder(build: Path, name: str, technique: str) -> Path:
    """Where `make run` leaves the result of a scene by a technique."""
    return build / (name if technique == C.technique else f"{name}-{technique}")


def run_missing(names: list[str], build: Path) -> None:
    """Run each of the scenes `names`, by every technique, that has no result in `build`, or one
    older than the sources.

    Raises as `scripts.run.run` if one cannot be run; one that fails its checks says so on the page.
    """
    changed = newest_source()
    todo = []
    for name, technique in itertools.product(names, TECHNIQUES):
        path = folder(build, name, technique) / "report.json"
        if not path.is_file() or path.stat().st_mtime < changed:
            todo.append((name, technique, path.parent))
    for k, (name, technique, out) in enumerate(todo):
        console.note(f"{name}, {technique} ({k + 1} of {len(todo)})")
        request = run_scene.request(name, config=TECHNIQUES[technique], out=out)
        run_scene.run(request, run_frame.simulate, Steps())


def compare_missing(build: Path) -> None:
    """Compare the shadings of `compare.SHOWN` if there is no result in `build`, or one older than
    the sources.

    Raises as `scripts.compare.compare`; a check that failed is said on the page.
    """
    scene, size = compare.SHOWN
    path = build / f"{scene}-compare" / "comparison.json"
    if not path.is_file() or path.stat().st_mtime < newest_source():
        console.note(f"{scene}, all shadings")
        compare.compare(compare.request(scene, size, out=path.parent), Steps())


@dataclass
class Comparison:
    """What the page shows of `compare.SHOWN`: its report, the sheet as a data URI, the lines of its
    table, and a line for each check that failed."""

    report: dict
    sheet: str
    rows: list[list[str]]
    notes: list[str]
    failures: list[str]

    @property
    def size(self) -> str:
        """Width and height of the pictures, in pixels."""
        return size_text(self.report["size"])


def comparison(build: Path) -> Comparison | None:
    """What `compare_missing` left in `build`; None if nothing."""
    folder = build / f"{compare.SHOWN[0]}-compare"
    found = load(folder / "comparison.json", compare.SCHEMA)
    if found is None:
        return None
    return Comparison(
        found, data_uri(folder / "sheet.png", lossless=False), comparison_rows(found),
        compare.notes(found), compare.failures(found),
    )  # fmt: skip


@dataclass
class Technique:
    """What the page shows of a run of a technique's scene.

    row: its row of build/results.json. what, source: what the scene shows, and who described the
    technique. picture: a data URI, or "" if there is none.
    """

    row: dict
    what: str
    source: str
    picture: str

    @property
    def title(self) -> str:
        """The scene, with the technique where an older one shows it."""
        older = self.row["technique"] != C.technique
        return self.row["scene"] + (f", {title(self.row['technique'])}" if older else "")

    @property
    def good(self) -> bool:
        """Whether no pixel differs, and the error is within its bound."""
        return not self.row["mismatches"] and self.row["max_lsb"] <= self.row["bound_lsb"]


def techniques(results: dict | None, build: Path) -> list[Technique]:
    """The runs of the technique scenes that `make scenes` left in `build`."""
    shown = []
    for row in results["techniques"] if results else []:
        path = picture_path(build, row["scene"], row["technique"])
        picture = data_uri(path, lossless=False) if path.is_file() else ""
        shown.append(Technique(row, *TECHNIQUE_WORDS[row["scene"]], picture))
    return shown


def scene_result(name: str, build: Path) -> SceneResult | None:
    """What the runs of `name` left below `build`; None if it was not run."""
    result = folder(build, name, C.technique)
    report = load(result / "report.json", SCHEMA)
    if report is None:
        return None
    views = []
    for key in TECHNIQUES:
        picture = folder(build, name, key) / "frame.png"
        if picture.is_file():
            views.append(View(key, f"{title(key)}, RTL", data_uri(picture)))
    views.append(View("reference", "reference in float64", data_uri(result / "reference.png")))
    frame = read_spans(result / "spans", C)
    used = np.unique(frame.spans["material"]).tolist()
    budget = [error_budget.rows(material, frame, C) for material in used]
    worst = max(budget, key=lambda rows: rows[-1].bound, default=[])
    return SceneResult(
        name, report, views, data_uri(result / "error.png", colours=MAP_COLOURS),
        failures(report), worst,
        {row.feature: row for row in prune(frame)[1]},
    )  # fmt: skip


def title(technique: str) -> str:
    """The name of a technique in legends and tables."""
    return TECHNIQUE_NAMES.get(technique, technique)


# -- plots -----------------------------------------------------------------------------------------


def figure(traces, **layout) -> dict:
    """A plot as data for the page, which sets the colours of paper and text itself."""
    plot = json.loads(go.Figure(traces, go.Layout(**layout)).to_json())
    plot["layout"].pop("template", None)  # plotly's default look: 7 kB in every plot
    return plot


def _axis(title: str, log: bool = False) -> dict:
    return {"title": {"text": title}, "type": "log" if log else "linear"}


def _level(text: str, y: float | None, log: bool = False) -> dict:
    """A dashed line across a plot, whose axis may be logarithmic, and what it is."""
    if y is None:
        return {}
    line = {"type": "line", "xref": "paper", "x0": 0, "x1": 1, "y0": y, "y1": y,
            "line": {"color": "#d3552b", "dash": "dash"}, "layer": "below"}  # fmt: skip
    note = {"xref": "paper", "x": 0, "y": float(np.log10(y)) if log else y, "text": text,
            "showarrow": False, "yanchor": "bottom", "xanchor": "left"}  # fmt: skip
    return {"shapes": [line], "annotations": [note]}


def budget_plot(results: dict, scenes: list[str]) -> dict:
    """Cycles of every scene at the common sizes, and the cycles that 30 frames a second leave."""
    sizes = list(dict.fromkeys(row["size"] for row in results["rows"]))
    traces = []
    for k, size in enumerate(sizes):
        rows = {row["scene"]: row for row in results["rows"] if row["size"] == size}
        bars = [rows[s] for s in scenes if s in rows]
        traces.append(
            go.Bar(
                name=size, x=[r["scene"] for r in bars], y=[r["cycles"] for r in bars],
                marker_color=COLOURS[k],
                customdata=[
                    [r["fps"], r["pixels"], 100 * r["cycles"] / results["cycles_available"]]
                    for r in bars
                ],
                hovertemplate="%{x}, " + size + "<br>%{y:,} cycles a frame (%{customdata[2]:.1f} % "
                "of the budget)<br>%{customdata[1]:,} pixels<br>%{customdata[0]:.0f} frames/s"
                "<extra></extra>",
            )
        )  # fmt: skip
    limit = f"budget: {results['fps']:g} frames/s at {results['clock_hz'] / 1e6:g} MHz"
    return figure(
        traces, barmode="group", yaxis=_axis("cycles a frame"),
        **_level(limit, results["cycles_available"]),
    )  # fmt: skip


def _error(row: dict, name: str) -> float | None:
    """A positive error of a row, for a logarithmic axis: none wrong counts as a third of one."""
    if name != "wrong":
        return row.get(name) or None
    if row.get("correctly_rounded") is None:
        return None
    return max(1 - row["correctly_rounded"], 1 / (3 * (row.get("pixels") or 1e6)))


def _hover(row: dict) -> str:
    lines = [f"<b>{row['method']}: {row['label']}</b>", f"{row['cycles']:,.0f} cycles"]
    lines += [f"{row['frame_us']:.1f} µs at {row['clock_mhz']:g} MHz ({row['clock_source']})"]
    lines += [
        f"{title.replace(', LSB', '')} {row[name]:.4g} LSB"
        for name, title in ERRORS.items() if row.get(name) is not None
    ]  # fmt: skip
    if row.get("correctly_rounded") is not None:
        lines.append(f"{100 * row['correctly_rounded']:.3f} % correctly rounded")
    units = {"dsp": "multipliers", "lut_sites": "LUT sites", "ff": "FF", "ebr": "block RAMs"}
    hardware = [f"{row[n]:.0f} {unit}" for n, unit in units.items() if row.get(n)]
    if hardware:
        lines.append(", ".join(hardware))
    if row.get("longest_path"):
        lines.append(f"longest path: {row['longest_path']}")
    return "<br>".join(lines)


def clock_note(rows: list[dict]) -> str:
    """What the clocks of the precision sweep's `rows` are."""
    stated = [row for row in rows if row["clock_source"] == "stated"]
    at = f"a stated {stated[0]['clock_mhz']:g} MHz, not measured" if stated else ""
    if len(stated) == len(rows):
        return f"The clock is {at}, the same for all."
    sources = dict.fromkeys(row["clock_source"] for row in rows if row not in stated)
    clock = f"The clock is what place and route reports for each ({'; '.join(sources)})"
    if not stated:
        return f"{clock}."
    return f"{clock}, but for {len(stated)} of {len(rows)}, the open marks: {at}."


def precision_plots(rows: list[dict]) -> dict[str, dict]:
    """{"<cost>/<error>": work-precision diagram}: a curve a method, the Pareto front behind.

    Over run time, open marks are configurations whose clock is stated while others are measured.
    """
    routed = any(row["clock_source"] != "stated" for row in rows)
    names = list(dict.fromkeys(row["method"] for row in rows))
    perfect = methods.perfect() if rows else {}
    plots = {}
    for cost, cost_title in COSTS.items():
        for error, error_title in ERRORS.items():
            at = [(row, row.get(cost), _error(row, error)) for row in rows]
            at = [(row, x, y) for row, x, y in at if x and y]
            if not at:
                continue
            front = pareto.front([(x, y) for _, x, y in at])
            traces = [
                go.Scatter(
                    name="Pareto front", x=[x for x, _ in front], y=[y for _, y in front],
                    mode="lines", line={"color": "#8a8a8a", "width": 6, "shape": "hv"},
                    opacity=0.45, hoverinfo="skip",
                )
            ]  # fmt: skip
            mixed = cost == "frame_us" and routed
            for k, method in enumerate(names):
                shape = SHAPES[(k // 2 + k) % len(SHAPES)]
                curve = sorted(((r, x, y) for r, x, y in at if r["method"] == method),
                               key=lambda p: -p[2])  # fmt: skip
                if curve:
                    traces.append(
                        go.Scatter(
                            name=method, x=[p[1] for p in curve], y=[p[2] for p in curve],
                            text=[_hover(p[0]) for p in curve], mode="lines+markers",
                            hovertemplate="%{text}<extra></extra>",
                            line={"color": COLOURS[k % len(COLOURS)], "width": 1.5},
                            marker={"size": 9, "symbol": [
                                f"{shape}-open" if mixed and r["clock_source"] == "stated"
                                else shape for r, _, _ in curve
                            ]},
                        )
                    )  # fmt: skip
            plots[f"{cost}/{error}"] = figure(
                traces, xaxis=_axis(cost_title, True), yaxis=_axis(error_title, True),
                hovermode="closest",
                **_level("perfect rounding", perfect.get(error), log=True),
            )  # fmt: skip
    return plots


def tessellation_plots(rows: list[dict]) -> dict[str, dict]:
    """{"<shape>/<size>/<error>": error against the true surface over the size of its mesh}.

    A curve is a technique. A plot shows either techniques before rounding or codes of the RTL, so
    the cubic interpolant, which has no RTL, is in the first kind only.
    """
    plots = {}
    techniques = list(dict.fromkeys(row["technique"] for row in rows))
    shapes = dict.fromkeys(row["shape"] for row in rows)
    for shape, size, error in itertools.product(shapes, SIZES, SURFACE_ERRORS):
        traces = []
        for k, technique in enumerate(techniques):
            curve = [
                r for r in rows
                if (r["shape"], r["technique"]) == (shape, technique)
                and r.get(error) and r.get(size) and (r.get("cycles") or error in UNROUNDED_ERRORS)
            ]  # fmt: skip
            curve.sort(key=lambda r: r["triangles"])
            if not curve:
                continue
            traces.append(
                go.Scatter(
                    name=title(technique), x=[r[size] for r in curve],
                    y=[r[error] for r in curve], text=[_surface_hover(r) for r in curve],
                    hovertemplate="%{text}<extra></extra>", mode="lines+markers",
                    line={"color": COLOURS[k % len(COLOURS)]},
                    marker={"symbol": SHAPES[k % len(SHAPES)], "size": 9},
                )
            )  # fmt: skip
        if traces:
            perfect = tessellation.perfect_rms(shape) if error == "rms_lsb" else None
            plots[f"{shape}/{size}/{error}"] = figure(
                traces, xaxis=_axis(SIZES[size], True), yaxis=_axis(SURFACE_ERRORS[error], True),
                **_level("perfect rounding", perfect, log=True),
            )  # fmt: skip
    return plots


def _surface_hover(row: dict) -> str:
    errors = SURFACE_ERRORS if row.get("cycles") else UNROUNDED_ERRORS
    lines = [f"<b>{title(row['technique'])}</b>"]
    lines += [f"{row[size]:,.0f} {words}" for size, words in SIZES.items() if row.get(size)]
    lines += [
        f"{words.replace(', LSB', '')} {row[error]:.4g} LSB"
        for error, words in errors.items() if row.get(error) is not None
    ]  # fmt: skip
    return "<br>".join(lines)


def error_plot(rows: list[dict]) -> dict:
    """Bound, worst input found and bundled scenes, each beyond ½, for each family of inputs."""
    kinds = (
        ("bound_lsb", "certified bound"), ("adversarial_lsb", "worst input found"),
        ("scenes_lsb", "bundled scenes"),
    )  # fmt: skip
    traces = [
        go.Bar(
            name=name, x=[r["family"] for r in rows], y=[r[key] - 0.5 for r in rows],
            customdata=[r[key] for r in rows], marker_color=COLOURS[k],
            hovertemplate="%{x}<br>" + name + ": %{customdata:.4f} LSB<extra></extra>",
        )
        for k, (key, name) in enumerate(kinds)
    ]  # fmt: skip
    return figure(traces, barmode="group", yaxis=_axis("LSB beyond the ½ of perfect rounding"))


def stages_plot(scenes: list[SceneResult]) -> dict:
    """The terms of the bound of each scene's worst material, on top of each other."""
    white = C.white
    terms = ("diffuse term", "specular term", "W(i)", "cut of S")
    traces = []
    for k, term in enumerate(terms):
        rows = [next(r for r in s.budget if r.stage == term) for s in scenes]
        traces.append(
            go.Bar(
                name=term, orientation="h", y=[f"{s.name}, {s.size}" for s in scenes],
                x=[white * r.bound for r in rows], text=[r.why for r in rows],
                marker_color=COLOURS[k], textposition="none",
                hovertemplate="%{y}, " + term + ": %{x:.4f} LSB<br>%{text}<extra></extra>",
            )
        )  # fmt: skip
    return figure(traces, barmode="stack", xaxis=_axis("LSB beyond the final rounding of ½"))


# -- the page --------------------------------------------------------------------------------------


def recorded_results() -> list[tuple[HardwareRow, dict]]:
    """The lines of the long runs, each with its record."""
    rows = hardware_rows()
    records = {row.record: recorded.load(row.record) for row in rows}
    return [(row, records[row.record]) for row in rows]


def commit() -> str:
    """The commit at work, or nothing."""
    done = subprocess.run(
        ["git", "rev-parse", "--short", "HEAD"], cwd=PACKAGE, text=True, capture_output=True
    )
    return done.stdout.strip()


def load_orders(build: Path) -> dict:
    """{shape: {technique: {error: order of convergence}}}; empty if there are none."""
    return (load(build / "sweep" / "tessellation.json") or {}).get("orders", {})


@dataclass
class Argument:
    """One of the paper's arguments for interpolating normals.

    shown: scenes and sizes. text: what is measured. picture: a data URI, or empty. rows: figures,
    (what, one figure a technique).
    """

    name: str
    shown: str
    text: str
    picture: str
    rows: list[tuple[str, list[str]]]


def paper_arguments(sweep: Path) -> list[Argument]:
    """What the study of the paper's arguments left in `sweep`; empty if it was not run."""
    study = load(sweep / "arguments.json")
    if not study:
        return []
    bands, flicker, turned = [], [], study["orientation"]
    for shape, levels in study["mach_bands"].items():
        for level, by in levels.items():
            figures = [f"{n(by[t]['slope_rms'])}, {n(by[t]['intensity_rms'])}" for t in TECHNIQUES]
            bands.append((f"{shape} of {level} steps", figures))
    for shape, by in study["flicker"].items():
        changes = [f"{n(by[t]['change_rms'])}, {by[t]['change_max']:.0f}" for t in TECHNIQUES]
        flicker.append((f"{shape}: change per degree, LSB: RMS, largest", changes))
        peaks = ["{} to {}".format(*by[t]["peak_range"]) for t in TECHNIQUES]
        flicker.append((f"{shape}: brightest code of the highlight", peaks))
    spread = [
        (f"{kind}: largest spread over its orientations, LSB",
         ["–", n(turned[kind]["largest_spread_lsb"]), "–"])
        for kind in ("quadrilateral", "triangles")
    ]  # fmt: skip

    def picture(name: str) -> str:
        path = sweep / f"{name}.png"
        return data_uri(path) if path.is_file() else ""

    shapes = ", ".join(study["mach_bands"])
    turning = ", ".join(study["flicker"])
    return [
        Argument(
            "Mach bands", f"{shapes}; {size_text(tessellation.SIZE)}",
            "Jumps across the edges that scan lines cross, RMS: of the slope of the intensity (LSB "
            "per pixel), and of the intensity (LSB). Flat faces have no slope.",
            picture("mach"), bands,
        ),
        Argument(
            "Flicker", f"{turning}; {artifact_runs.FRAMES} frames of "
            f"{size_text(artifact_runs.FLICKER_SIZE)}",
            "An object turns about its own axis, a degree a frame. Its picture should not change.",
            picture("flicker"), flicker,
        ),
        Argument(
            "Orientation", f"a square; {size_text([artifact_runs.SQUARE_SIZE] * 2)}",
            "A black and white quadrilateral turns. Its middle changes with Gouraud's "
            "interpolation along scan lines. Over triangles nothing changes.",
            picture("orientation"), spread,
        ),
    ]  # fmt: skip


def n(value: float) -> str:
    """A figure of the study with three digits; 0 if only rounding of float64 is left."""
    return "0" if abs(value) < 1e-9 else f"{value:.3g}"


def precision_frames() -> list[str]:
    """Scene and size of each frame that the precision sweep measures, and what is in it."""
    texts = []
    for scene, size, what in methods.FRAMES:
        if size is None:
            loaded = load_scene(scene)
            size = loaded.width, loaded.height
        texts.append(f"{Path(scene).stem} {size_text(size)} ({what})")
    return texts


def code(text: str) -> Markup:
    """`text` for the page, with what stands between backticks as code."""
    return Markup(re.sub("`([^`]*)`", r"<code>\1</code>", str(escape(text))))


def page(build: Path = BUILD) -> str:
    """The page from what is below `build`. Raises InputError or OSError if a file is broken."""
    scenes = [s for name in bundled_scenes() if (s := scene_result(name, build))]
    results = load(build / "results.json", RESULTS)
    stability = load(build / "stability" / "report.json", STABILITY)
    precision = load_csv(build / "sweep" / "precision.csv", PRECISION)
    meshes = load_csv(build / "sweep" / "tessellation.csv", TESSELLATION)
    plots = {
        "precision": precision_plots(precision),
        "tessellation": tessellation_plots(meshes),
        "budget": {"": budget_plot(results, bundled_scenes())} if results else {},
        "errors": {"": error_plot(stability["errors"])} if stability else {},
        "stages": {"": stages_plot(scenes)} if any(s.budget for s in scenes) else {},
    }
    costs = {key: title for key, title in COSTS.items() if f"{key}/max_lsb" in plots["precision"]}
    shapes = {row["shape"]: row["shape"] for row in meshes}
    surface_errors = {
        key: words for key, words in SURFACE_ERRORS.items() if meshes and key in meshes[0]
    }
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True,
        undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    environment.filters["code"] = code
    return environment.get_template("report.html.j2").render(
        scenes=scenes, comparison=comparison(build), techniques=techniques(results, build),
        results=results, stability=stability,
        precision=precision,
        clock_note=clock_note(precision) if precision else "",
        precision_frames=precision_frames() if precision else [],
        tessellation=meshes, tessellation_size=size_text(tessellation.SIZE),
        records=recorded_results(), costs=costs,
        errors=ERRORS,
        shapes=shapes, sizes=SIZES, surface_errors=surface_errors,
        arguments=paper_arguments(build / "sweep"), technique_names=[title(t) for t in TECHNIQUES],
        orders=load_orders(build),
        title=title, plots=plots, packed_plots=pack(json.dumps(plots)),
        packed_plotly=pack(get_plotlyjs()) if any(plots.values()) else "",
        commit=commit(),
    )  # fmt: skip


def main(build: Path = BUILD) -> int:
    """Make the page; returns the exit code. Raises InputError, OSError, and as `run_missing`."""
    run_missing(bundled_scenes(), build)
    compare_missing(build)
    text = page(build)
    path = build / "report" / "index.html"
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
    size = path.stat().st_size / 1e6
    console.say(f"{console.shown(path)}: {size:.1f} MB, opens in any browser")
    return console.GOOD
