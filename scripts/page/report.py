# SPDX-License-Identifier: MIT
"""One page of all results, build/report/index.html: `phong75 report`.

Pictures, cycles, error over run time, stability, the error budget and the records of the long runs,
from the JSON and CSV that the other targets write; scenes without a current result are run first.
The page holds everything it shows: no network, no other file. A part whose data is missing says
which command makes it. Exit code: 0; 2 if the page could not be made.
"""

from __future__ import annotations

import base64
import csv
import itertools
import json
import subprocess
from dataclasses import dataclass, field
from pathlib import Path

import jinja2
import numpy as np
import plotly.graph_objects as go
from plotly.offline import get_plotlyjs

from phong75.model.analysis import error_budget
from phong75.model.analysis.pruning import Row, prune
from phong75.model.analysis.run_report import SCHEMA, failures
from phong75.model.config import DEFAULT as C
from phong75.model.config import TECHNIQUES
from phong75.model.frame import InputError
from phong75.model.front.scene import bundled_scenes
from phong75.model.spans import read_spans
from phong75.scripts import console, recorded
from phong75.scripts import run as run_scene
from phong75.scripts.console import Steps
from phong75.scripts.scene_results import SCHEMA as RESULTS
from phong75.scripts.stability import SCHEMA as STABILITY
from phong75.sim.design import BUILD, PACKAGE
from phong75.sim.frame import run_frame

SHAPES = ("circle", "square", "diamond", "triangle-up", "x", "cross", "star", "pentagon")
#: Colours that can be told apart with any kind of colour vision, on white and on black.
COLOURS = (
    "#0a84c6", "#d98200", "#109a6c", "#c3639b", "#d3552b", "#7a6ff0", "#8a8a8a", "#b09b00",
)  # fmt: skip

#: Columns of the sweep's tables that can be axes, and their names.
COSTS = {
    "frame_us": "run time of all frames, µs", "cycles": "cycles of all frames",
    "dsp": "multipliers", "lut": "LUT sites", "ff": "flip-flops",
    "simulate_s": "host: seconds of RTL simulation", "model_s": "host: seconds of the model",
}  # fmt: skip
ERRORS = {
    "rms_lsb": "RMS error, LSB", "max_lsb": "largest error, LSB", "p999_lsb": "99.9 % error, LSB",
    "mean_lsb": "mean error, LSB", "wrong": "share not correctly rounded",
}  # fmt: skip
#: More of them in the study of tessellation.
SURFACE_ERRORS = {
    "rms_lsb": "RMS error, LSB", "highlight_rms_lsb": "RMS error in highlights, LSB",
    "facing_rms_lsb": "RMS error facing the eye, LSB", "max_lsb": "largest error, LSB",
    "p999_lsb": "99.9 % error, LSB", "mean_lsb": "mean error, LSB",
    "method_rms_lsb": "RMS error before rounding, LSB",
    "method_max_lsb": "largest error before rounding, LSB",
}  # fmt: skip
SIZES = {"triangles": "triangles", "cycles": "cycles a frame", "spans": "spans"}

#: Errors of perfect rounding, where there is one figure for it.
PERFECT = {"rms_lsb": 12**-0.5, "max_lsb": 0.5, "mean_lsb": 0.25}

#: What must be there of the sweep's tables.
PRECISION = ("method", "label", "cycles", "frame_us", "clock_mhz", "clock_source", "max_lsb",
             "rms_lsb", "p999_lsb", "mean_lsb", "correctly_rounded", "psnr_db")  # fmt: skip
TESSELLATION = ("shape", "technique", "level", "triangles", "spans", "cycles", "max_lsb")


@dataclass
class View:
    """One picture of a scene: its key, its label, the PNG as a data URI."""

    key: str
    label: str
    picture: str


@dataclass
class SceneResult:
    """A bundled scene: the report of its run, the pictures that can be laid over each other, the
    error map, what failed, the rows of the error budget of its worst material, and what the scene
    needs of the pipeline."""

    name: str
    report: dict
    views: list[View]
    error_map: str
    failures: list[str]
    budget: list[error_budget.Row] = field(default_factory=list)
    features: dict[str, Row] = field(default_factory=dict)


def data_uri(path: Path) -> str:
    """A PNG file as a data URI. Raises OSError."""
    return "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()


def load(path: Path, schema: int | None = None):
    """The JSON in `path`, or None if there is none.

    Raises InputError if it is broken, or of another layout than `schema`.
    """
    if not path.is_file():
        return None
    try:
        found = json.loads(path.read_text())
    except ValueError as error:
        raise InputError(f"{path}: not JSON: {error}") from None
    if schema is not None and found.get("schema") != schema:
        raise InputError(f"{path}: another version wrote it; remove it, or make it anew")
    return found


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


def scene_result(name: str, build: Path) -> SceneResult | None:
    """What the runs of `name` left below `build`; None if it was not run."""
    own = folder(build, name, C.technique)
    report = load(own / "report.json", SCHEMA)
    if report is None:
        return None
    views = []
    for key in TECHNIQUES:
        picture = folder(build, name, key) / "frame.png"
        if picture.is_file():
            views.append(View(key, f"{title(key)}, RTL", data_uri(picture)))
    views.append(View("reference", "reference in float64", data_uri(own / "reference.png")))
    frame = read_spans(own / "spans", C)
    used = np.unique(frame.spans["material"]).tolist()
    budget = [error_budget.rows(material, frame, C) for material in used]
    worst = max(budget, key=lambda rows: rows[-1].bound, default=[])
    return SceneResult(
        name, report, views, data_uri(own / "error.png"), failures(report), worst,
        {row.feature: row for row in prune(frame)[1]},
    )  # fmt: skip


def title(technique: str) -> str:
    """The name of a technique: some are those of people."""
    return technique.capitalize() if technique in ("phong", "gouraud") else technique


# -- plots -----------------------------------------------------------------------------------------


def figure(traces, **layout) -> dict:
    """A plot as data for the page; colours of paper and text are set there."""
    made = go.Figure(traces, go.Layout(**layout))
    return json.loads(made.to_json())


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
        own = [rows[s] for s in scenes if s in rows]
        traces.append(
            go.Bar(
                name=size, x=[r["scene"] for r in own], y=[r["cycles"] for r in own],
                marker_color=COLOURS[k],
                customdata=[
                    [r["fps"], r["pixels"], 100 * r["cycles"] / results["cycles_available"]]
                    for r in own
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


def pareto(points: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """The points (cost, error) that no other beats, by cost."""
    front, least = [], np.inf
    for cost, error in sorted(set(points)):
        if error < least:
            front.append((cost, error))
            least = error
    return front


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
    hardware = [f"{row[n]:.0f} {n.upper()}" for n in ("dsp", "lut", "ff", "ebr") if row.get(n)]
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
    """{"<cost>/<error>": work-precision diagram}: a curve a method, the Pareto front behind; over
    time, open marks where the clock is stated and others are not."""
    routed = any(row["clock_source"] != "stated" for row in rows)
    methods = list(dict.fromkeys(row["method"] for row in rows))
    plots = {}
    for cost, cost_title in COSTS.items():
        for error, error_title in ERRORS.items():
            at = [(row, row.get(cost), _error(row, error)) for row in rows]
            at = [(row, x, y) for row, x, y in at if x and y]
            if not at:
                continue
            front = pareto([(x, y) for _, x, y in at])
            traces = [
                go.Scatter(
                    name="Pareto front", x=[x for x, _ in front], y=[y for _, y in front],
                    mode="lines", line={"color": "#8a8a8a", "width": 6, "shape": "hv"},
                    opacity=0.45, hoverinfo="skip",
                )
            ]  # fmt: skip
            mixed = cost == "frame_us" and routed
            for k, method in enumerate(methods):
                shape = SHAPES[(k // 2 + k) % len(SHAPES)]
                own = sorted(((r, x, y) for r, x, y in at if r["method"] == method),
                             key=lambda p: -p[2])  # fmt: skip
                if own:
                    traces.append(
                        go.Scatter(
                            name=method, x=[p[1] for p in own], y=[p[2] for p in own],
                            text=[_hover(p[0]) for p in own], mode="lines+markers",
                            hovertemplate="%{text}<extra></extra>",
                            line={"color": COLOURS[k % len(COLOURS)], "width": 1.5},
                            marker={"size": 9, "symbol": [
                                f"{shape}-open" if mixed and r["clock_source"] == "stated"
                                else shape for r, _, _ in own
                            ]},
                        )
                    )  # fmt: skip
            plots[f"{cost}/{error}"] = figure(
                traces, xaxis=_axis(cost_title, True), yaxis=_axis(error_title, True),
                hovermode="closest", **_level("perfect rounding", PERFECT.get(error), log=True),
            )  # fmt: skip
    return plots


def tessellation_plots(rows: list[dict]) -> dict[str, dict]:
    """{"<shape>/<size>/<error>": error against the true surface over the size of its mesh, a
    curve a technique}."""
    plots = {}
    techniques = list(dict.fromkeys(row["technique"] for row in rows))
    shapes = dict.fromkeys(row["shape"] for row in rows)
    for shape, size, error in itertools.product(shapes, SIZES, SURFACE_ERRORS):
        traces = []
        for k, technique in enumerate(techniques):
            own = [r for r in rows if (r["shape"], r["technique"]) == (shape, technique)]
            own = [r for r in own if r.get(error) and r.get(size)]
            own.sort(key=lambda r: r["triangles"])
            if not own:
                continue
            traces.append(
                go.Scatter(
                    name=title(technique), x=[r[size] for r in own], y=[r[error] for r in own],
                    text=[_surface_hover(r) for r in own], hovertemplate="%{text}<extra></extra>",
                    mode="lines+markers", line={"color": COLOURS[k % len(COLOURS)]},
                    marker={"symbol": SHAPES[k % len(SHAPES)], "size": 9},
                )
            )  # fmt: skip
        if traces:
            plots[f"{shape}/{size}/{error}"] = figure(
                traces, xaxis=_axis(SIZES[size], True), yaxis=_axis(SURFACE_ERRORS[error], True),
            )  # fmt: skip
    return plots


def _surface_hover(row: dict) -> str:
    lines = [f"<b>{title(row['technique'])}</b>"]
    lines += [f"{row[size]:,.0f} {words}" for size, words in SIZES.items() if row.get(size)]
    lines += [
        f"{words.replace(', LSB', '')} {row[error]:.4g} LSB"
        for error, words in SURFACE_ERRORS.items() if row.get(error) is not None
    ]  # fmt: skip
    return "<br>".join(lines)


def error_plot(rows: list[dict]) -> dict:
    """Bound, worst input found and bundled scenes, each beyond ½, for each family of inputs."""
    kinds = (
        ("bound_lsb", "derived bound"), ("adversarial_lsb", "worst input found"),
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
    white = (1 << C.colour_bits) - 1
    terms = ("diffuse term", "specular term", "W(i)", "cut of S")
    traces = []
    for k, term in enumerate(terms):
        rows = [next(r for r in s.budget if r.stage == term) for s in scenes]
        traces.append(
            go.Bar(
                name=term, orientation="h", y=[s.name for s in scenes],
                x=[white * r.bound for r in rows], text=[r.why for r in rows],
                marker_color=COLOURS[k], textposition="none",
                hovertemplate="%{y}, " + term + ": %{x:.4f} LSB<br>%{text}<extra></extra>",
            )
        )  # fmt: skip
    return figure(traces, barmode="stack", xaxis=_axis("LSB beyond the final rounding of ½"))


# -- the page --------------------------------------------------------------------------------------


def recorded_results(folder: Path) -> list[dict]:
    """The records of the long runs, in the order of the README, then the others."""
    found = {path.stem: load(path) for path in sorted(folder.glob("*.json"))}
    known = [name for name in recorded.NAMES if name in found]
    return [found[name] for name in [*known, *[n for n in found if n not in known]]]


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
    """One of the paper's arguments for interpolating normals: its picture (a data URI, or empty),
    and rows of figures, (what, one figure a technique)."""

    name: str
    about: str
    picture: str
    rows: list[tuple[str, list[str]]]


def paper_arguments(sweep: Path) -> list[Argument]:
    """What the study of the paper's arguments left in `sweep`; empty if it was not run."""
    found = load(sweep / "arguments.json")
    if not found:
        return []
    bands, flicker, turned = [], [], found["orientation"]
    for shape, levels in found["mach_bands"].items():
        for level, by in levels.items():
            figures = [f"{n(by[t]['slope_rms'])}, {n(by[t]['intensity_rms'])}" for t in TECHNIQUES]
            bands.append((f"{shape} of {level} steps", figures))
    for shape, by in found["flicker"].items():
        changes = [f"{n(by[t]['change_rms'])}, {by[t]['change_max']:.0f}" for t in TECHNIQUES]
        flicker.append((f"{shape}: change a degree, LSB: RMS, largest", changes))
        peaks = ["{} to {}".format(*by[t]["peak_range"]) for t in TECHNIQUES]
        flicker.append((f"{shape}: brightest code of the highlight", peaks))
    spread = [
        (f"{kind}: largest spread over its orientations, LSB",
         ["–", n(turned[kind]["largest_spread_lsb"]), "–"])
        for kind in ("quadrilateral", "triangles")
    ]  # fmt: skip
    kinds = (
        ("mach", "Mach bands", "Jumps across the edges that scan lines cross: of the slope of the "
         "intensity (LSB a dot) and of the intensity (LSB), RMS. Flat faces have no slope.", bands),
        ("flicker", "Flicker", "An object turns by a degree a frame about its own axis through 30 "
         "frames; its picture should not change.", flicker),
        ("orientation", "Orientation", "A black and white quadrilateral as it turns: its middle "
         "changes with Gouraud's interpolation along scan lines; over triangles nothing does.",
         spread),
    )  # fmt: skip
    return [
        Argument(name, about, data_uri(path) if (path := sweep / f"{file}.png").is_file() else "",
                 rows)
        for file, name, about, rows in kinds
    ]  # fmt: skip


def n(value: float) -> str:
    """A figure of the study: three digits, and 0 where only rounding is left."""
    return "0" if abs(value) < 1e-9 else f"{value:.3g}"


def page(build: Path = BUILD, record_folder: Path = recorded.FOLDER) -> str:
    """The page from what is below `build`. Raises InputError or OSError if a file is broken."""
    scenes = [s for name in bundled_scenes() if (s := scene_result(name, build))]
    results = load(build / "results.json", RESULTS)
    stability = load(build / "stability" / "report.json", STABILITY)
    precision = load_csv(build / "sweep" / "precision.csv", PRECISION)
    tessellation = load_csv(build / "sweep" / "tessellation.csv", TESSELLATION)
    plots = {
        "precision": precision_plots(precision),
        "tessellation": tessellation_plots(tessellation),
        "budget": {"": budget_plot(results, bundled_scenes())} if results else {},
        "errors": {"": error_plot(stability["errors"])} if stability else {},
        "stages": {"": stages_plot(scenes)} if any(s.budget for s in scenes) else {},
    }
    costs = {key: title for key, title in COSTS.items() if f"{key}/max_lsb" in plots["precision"]}
    shapes = {row["shape"]: row["shape"] for row in tessellation}
    surface_errors = {
        key: words
        for key, words in SURFACE_ERRORS.items()
        if tessellation and key in tessellation[0]
    }
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(Path(__file__).parent), autoescape=True,
        undefined=jinja2.StrictUndefined, trim_blocks=True, lstrip_blocks=True,
    )  # fmt: skip
    return environment.get_template("report.html.j2").render(
        scenes=scenes, results=results, stability=stability, precision=precision,
        clock_note=clock_note(precision) if precision else "",
        tessellation=tessellation, records=recorded_results(record_folder), costs=costs,
        errors=ERRORS,
        shapes=shapes, sizes=SIZES, surface_errors=surface_errors,
        arguments=paper_arguments(build / "sweep"), technique_names=[title(t) for t in TECHNIQUES],
        orders=load_orders(build),
        title=title, plots=plots, plotly=get_plotlyjs(), commit=commit(),
    )  # fmt: skip


def main(build: Path = BUILD) -> int:
    """Make the page; returns the exit code. Raises InputError, OSError, and as `run_missing`."""
    run_missing(bundled_scenes(), build)
    text = page(build)
    path = build / "report" / "index.html"
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)
    size = path.stat().st_size / 1e6
    console.say(f"{console.shown(path)}: {size:.1f} MB, opens in any browser")
    return console.GOOD
