# SPDX-License-Identifier: MIT
"""Error against run time and against hardware, over methods and word widths: `phong75 sweep`.

Every configuration of `model.studies.methods` is built, simulated, compared with its twin and
measured; the results go to build/sweep/precision.csv and, as charts, beside it. What did not
change since the last run is not simulated, synthesized or routed again. A frame's time is cycles
counted in simulation times a clock of place and route: of this run for what --route names, else a
kept one (see `scripts.synthesis.clocks`), else a stated one, which table, charts and a last line
say.

Exit code: 0; 1 if the RTL of a configuration differs from its twin or misses a bound that is
derived for it; 2 if the input is wrong or a tool failed, with one line on stderr that says what.
"""

from __future__ import annotations

import csv
import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from phong75.model.config import Config
from phong75.model.studies import pareto
from phong75.model.studies.charts import cost_chart, time_chart
from phong75.model.studies.methods import CONFIGS, Point, points
from phong75.scripts import console, recorded
from phong75.scripts.configurations import unknown
from phong75.scripts.synthesis import clocks, ecp5
from phong75.sim.build import runtime, runtime_built
from phong75.sim.elaborate import instances
from phong75.sim.frame.methods import FOLDER, measure

STATED_MHZ = 200.0
COLUMNS = (
    "name", "family", "method", "label", "cycles", "clock_mhz", "clock_source", "frame_us",
    "max_lsb", "rms_lsb", "p999_lsb", "mean_lsb", "correctly_rounded", "psnr_db", "simulate_s",
    "model_s", "dsp", "lut_sites", "lut_cells", "ff", "ebr", "pareto", "multipliers",
    "latency_cycles", "pixels",
    "mismatches", "port_max_lsb", "bound_lsb", "pareto_hardware", "longest_path",
)  # fmt: skip


def names(route: str) -> set[str]:
    """The configurations that --route names, comma-separated: none for "" and "0", every one for
    "all" and "1". Raises InputError."""
    if route in ("", "0"):
        return set()
    if route in ("all", "1"):
        return set(CONFIGS)
    wanted = set(route.split(","))
    for name in sorted(wanted - set(CONFIGS)):
        raise unknown("--route", name, CONFIGS, "phong75 configs")
    return wanted


def hardware(config: Config, area: bool, route: bool) -> dict:
    """Clock of `config`, where it comes from and which modules its longest path leads from and to,
    multipliers and logic; None for what was not asked for and no record has.

    Raises SynthesisError, BuildError.
    """
    stated = {"clock_mhz": STATED_MHZ, "clock_source": "stated", "longest_path": None}
    if route:
        clock = {"clock_key": clocks.key(config), "clock_source": clocks.SOURCE}
        report = ecp5.run(config, clocks.GRADE, (clocks.SEED,))
        used = report["resources"]
        clock["clock_mhz"] = report["fmax_mhz"]["median"]
        path = report["seeds"][0]["critical_path"]
        clock["longest_path"] = f"{path['from']['module']} to {path['to']['module']}"
    elif found := clocks.kept(config):
        return found
    elif area:
        folder = ecp5.FOLDER / config.name
        folder.mkdir(parents=True, exist_ok=True)
        used, clock = ecp5.synthesize(config, folder)["resources"], stated
    else:
        return stated | dict.fromkeys(clocks.SIZES)
    used = used | {"lut_cells": ecp5.lut_cells(used)}
    return {name: used[name] for name in clocks.SIZES} | clock


def row(point: Point, area: bool, route: bool) -> dict:
    """The row of one configuration; COLUMNS but for the Pareto fronts."""
    found = measure(point) | {"multipliers": instances(point.config)["multiplier"]}
    found |= hardware(point.config, area, route)
    found["frame_us"] = found["cycles"] / found["clock_mhz"]
    return found


def failures(rows: list[dict]) -> list[str]:
    """What is wrong with `rows`, a line each."""
    lines = []
    for found in rows:
        if found["mismatches"] or not found["complete"]:
            lines.append(
                f"{found['name']}: {found['mismatches']} of {found['pixels']} pixels of RTL and "
                "twin differ"
            )
        if found["bound_lsb"] is not None and found["port_max_lsb"] > found["bound_lsb"]:
            lines.append(
                f"{found['name']}: the largest error is {found['port_max_lsb']:.4f} LSB, the "
                f"derived bound {found['bound_lsb']:.4f}"
            )
    return lines


def unrouted(rows: list[dict]) -> str:
    """A line on the `rows` without a clock of place and route, and what gives them one; "" if all
    have theirs."""
    names = [found["name"] for found in rows if found["clock_source"] == "stated"]
    if not names:
        return ""
    todo = "all" if len(names) == len(rows) else ",".join(names)
    return (
        f"{len(names)} of {len(rows)} configurations have no clock of today's sources, "
        f"{STATED_MHZ:g} MHz are stated: phong75 sweep --route {todo}"
    )


#: Columns that are not recorded: the name is the key, seconds of simulation and model are those of
#: one machine, and the fronts follow from the others.
UNRECORDED = ("name", "simulate_s", "model_s", "pareto", "pareto_hardware")


def figures(rows: list[dict]) -> dict:
    """What is recorded of `rows`: {"configurations": {name: COLUMNS but UNRECORDED}}, reals with 6
    digits."""

    def short(value):
        return float(f"{value:.6g}") if isinstance(value, float) else value

    names = [name for name in COLUMNS if name not in UNRECORDED]
    kept = {found["name"]: {name: short(found[name]) for name in names} for found in rows}
    return {"configurations": kept}


def write_csv(rows: list[dict], path: Path) -> None:
    """The table of `rows`; figures with 6 digits, nothing where there is none."""

    def text(value):
        if value is None:
            return ""
        return f"{value:.6g}" if isinstance(value, float) else value

    part = path.with_name(f".{path.name}.{os.getpid()}")
    with part.open("w", newline="") as file:
        out = csv.writer(file, lineterminator="\n")
        out.writerow(COLUMNS)
        out.writerows([text(found[name]) for name in COLUMNS] for found in rows)
    part.replace(path)


def finish(rows: list[dict], folder: Path = FOLDER) -> None:
    """Mark the Pareto fronts in `rows`, and write CSV and charts into `folder`."""
    front = pareto.on_front([(found["frame_us"], found["rms_lsb"]) for found in rows])
    for found, on in zip(rows, front, strict=True):
        found["pareto"], found["pareto_hardware"] = int(on), None
    sized = [found for found in rows if found["dsp"] is not None]
    front = pareto.on_front(
        [(found["dsp"], found["lut_cells"], found["rms_lsb"]) for found in sized]
    )
    for found, on in zip(sized, front, strict=True):
        found["pareto_hardware"] = int(on)
    folder.mkdir(parents=True, exist_ok=True)
    write_csv(rows, folder / "precision.csv")
    time_chart(rows, folder / "precision_time")
    cost_chart(rows, folder / "precision_hardware")


def run(todo: list[Point], area: bool, route: set[str], record: bool) -> list[dict]:
    """The rows of `todo`, those named in `route` with the clock of place and route.

    As many at a time as there are processors; shows progress. record: keep the clocks of place and
    route in results/. Raises as `row`.
    """
    if not runtime_built():
        console.phase("compiling Verilator's runtime (once)")
    runtime()  # once, before all need it
    rows: dict[str, dict] = {}
    columns = (
        TextColumn("{task.description:<24}"), BarColumn(), MofNCompleteColumn(),
        TimeElapsedColumn(),
    )  # fmt: skip
    terminal = Console(stderr=True)
    spawn = multiprocessing.get_context("spawn")
    with (
        Progress(*columns, console=terminal, transient=True) as bar,
        ProcessPoolExecutor(os.cpu_count(), mp_context=spawn) as pool,
    ):
        task = bar.add_task("sweep", total=len(todo))
        jobs = {pool.submit(row, point, area, point.config.name in route): point for point in todo}
        try:
            for job in as_completed(jobs):
                found = rows[jobs[job].config.name] = job.result()
                if record and found["name"] in route and not failures([found]):
                    clocks.keep(found["name"], found)
                bar.update(task, advance=1, description=found["name"])
                if not terminal.is_terminal:
                    console.note(f"{len(rows)} of {len(todo)}: {found['name']}")
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    return [rows[point.config.name] for point in todo]


def main(area: bool, route: set[str], record: bool) -> int:
    """Measure every point, synthesizing all (`area`) and routing those in `route`; returns the
    exit code. Raises as `row`."""
    recorded.check(record)
    if area or route:
        ecp5.versions()
    rows = run(points(), area, route, record)
    finish(rows)
    wrong = failures(rows)
    if record:
        recorded.record(
            "sweep", "make sweep", ("verilator", "numpy"), figures(rows),
            {"configurations": len(rows)}, failed=bool(wrong),
        )  # fmt: skip
    for line in wrong:
        console.failure(line)
    if line := unrouted(rows):
        console.note(line)
    folder = console.shown(FOLDER)
    console.say(f"{len(rows)} configurations: {folder}/precision.csv, and charts beside it")
    return console.FAILED if wrong else console.GOOD
