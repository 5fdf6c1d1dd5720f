# SPDX-License-Identifier: MIT
"""Stiff and extreme cases through RTL, model and reference: `phong75 stability`.

Prints a row a case and the table of errors (derived bound, worst of the bundled scenes, worst
input found), and writes both to build/stability/report.json. Exit code: 0, 1 if a row fails, 2.
"""

from __future__ import annotations

import json
import time

import numpy as np
from rich.markup import escape
from rich.table import Table

from phong75.model.analysis.run_report import versions
from phong75.model.config import DEFAULT as C
from phong75.model.front.scene import bundled_scenes
from phong75.model.studies import adversarial, corner_cases
from phong75.scripts import console, recorded
from phong75.scripts.console import Steps
from phong75.sim.design import BUILD
from phong75.sim.frame import corner_cases as simulated

#: Version of the layout of report.json.
SCHEMA = 2
OUT = BUILD / "stability"
MESHES = 100_000
LONG_RUN = 1_000_000
LARGE = ("still_life", (3840, 2160))


def adversarial_cases() -> list[corner_cases.Case]:
    """The worst input of each family, as cases."""
    names = {(f.limit, f.steep): f.name for f in adversarial.FAMILIES}
    return [
        corner_cases.Case(
            f"worst input, {names[row['limit'], row['steep']]}",
            "the input with the largest error that the search has found",
            f"an error of {row['error_lsb']:.4f} LSB, as found, within its bound",
            adversarial.frame(row),
            lambda frame, got, row=row: _as_found(row, frame, got),
        )
        for row in adversarial.kept()
    ]


def _as_found(row, frame, got) -> list[str]:
    error = float(corner_cases.errors(frame, got.rgb).max())
    return [] if abs(error - row["error_lsb"]) < 1e-9 else [f"the error is {error:.6f} LSB"]


def scene_errors(cases, results) -> dict[adversarial.Family, float]:
    """The worst error of the bundled scenes over the materials that belong to each family."""
    worst = dict.fromkeys(adversarial.FAMILIES, 0.0)
    for case, result in zip(cases, results, strict=True):
        table, spans = case.frame.materials, case.frame.spans
        material = np.repeat(spans["material"], spans["length"])
        n = C.exponent.real(table.exponent)[material]
        constant = (np.ptp(table.weight, axis=1) == 0)[material]
        error = corner_cases.errors(case.frame, result.pixels.rgb)
        for family in worst:
            belongs = (n <= family.limit) & (constant | family.steep)
            worst[family] = max(worst[family], float(error[belongs].max(initial=0)))
    return worst


def error_rows(scenes: dict[adversarial.Family, float], worst: list[simulated.Row]) -> list[dict]:
    """A row a family: derived bound, worst of the bundled scenes, and the worst input found, as it
    came out of the RTL."""
    found = {(r["limit"], r["steep"]): w for r, w in zip(adversarial.kept(), worst, strict=True)}
    return [
        {
            "family": family.name,
            "limit": family.limit,
            "steep": family.steep,
            "bound_lsb": family.bound_lsb(),
            "scenes_lsb": scenes[family],
            "adversarial_lsb": found[family.limit, family.steep].max_lsb,
            "adversarial_bound_lsb": found[family.limit, family.steep].bound_lsb,
        }
        for family in adversarial.FAMILIES
    ]


def case_table(rows: list[dict]) -> Table:
    """The rows of report.json for the terminal."""
    table = Table(title="stability", title_style="bold")
    for title, justify in (
        ("case", "left"), ("expected", "left"), ("pixels", "right"), ("worst, LSB", "right"),
        ("bound", "right"), ("RTL ≠ model", "right"), ("", "left"),
    ):  # fmt: skip
        table.add_column(title, justify=justify)
    for row in rows:
        good = row["verdict"] == "ok"
        table.add_row(
            escape(row["case"]), escape(row["expected"]), str(row["pixels"]),
            number(row["max_lsb"]), number(row["bound_lsb"]), count(row["mismatches"]),
            "[green]ok[/]" if good else "[bold red]FAILED[/]",
        )  # fmt: skip
    return table


def error_table(rows: list[dict]) -> Table:
    """The three errors of each family side by side."""
    table = Table(title="largest error in LSB (½ is perfect rounding)", title_style="bold")
    for title in ("inputs", "derived bound", "bundled scenes", "worst input found", "its bound"):
        table.add_column(title, justify="left" if title == "inputs" else "right")
    for row in rows:
        table.add_row(
            row["family"], number(row["bound_lsb"]), number(row["scenes_lsb"]),
            number(row["adversarial_lsb"]), number(row["adversarial_bound_lsb"]),
        )  # fmt: skip
    return table


def error_lines(rows: list[dict]) -> list[str]:
    """The same as lines of the README's table."""
    return [
        f"| {row['family']} | {row['bound_lsb']:.3f} | {row['scenes_lsb']:.3f} "
        f"| {row['adversarial_lsb']:.3f} |"
        for row in rows
    ]


def power_table(rows: list[dict]) -> Table:
    """The error of cos(s)**n alone."""
    table = Table(title="cos(s)ⁿ alone, every code of 1 − cos(s)", title_style="bold")
    for title in ("n", "largest error", "derived bound"):
        table.add_column(title, justify="right")
    for row in rows:
        table.add_row(f"{row['n']:g}", f"{row['max_error']:.3g}", f"{row['bound']:.3g}")
    return table


def number(value) -> str:
    """An error in LSB."""
    return "–" if value is None else f"{value:.4f}"


def count(value) -> str:
    """How many, or nothing to count."""
    return "–" if value is None else str(value)


def power_row(rows: list[dict]) -> simulated.Row:
    """cos(s)**n alone, as a row of the table: the error must be ten times below AMM's."""
    said = [
        f"n = {r['n']:g}: {r['max_error']:.3g} is beyond {r['bound']:.3g}"
        for r in rows if r["max_error"] > r["bound"]
    ]  # fmt: skip
    at_20 = next(r["max_error"] for r in rows if r["n"] == 20)
    if at_20 > adversarial.AMM_2012 / 10:
        said.append(f"n = 20: {at_20:.3g} is more than a tenth of {adversarial.AMM_2012}")
    return simulated.Row(
        "cos(s)ⁿ alone", f"every code of 1 − cos(s), for {len(rows)} exponents",
        f"at n = 20 an error of {at_20:.2g}, at most a tenth of {adversarial.AMM_2012}; "
        "all within the derived bounds",
        sum(r["codes"] for r in rows), None, None, None, None, said,
    )  # fmt: skip


def run(steps: Steps) -> dict:
    """All of it; returns the contents of report.json. Raises BuildError, SimulationError."""
    with steps.step("frames"):
        cases = corner_cases.cases() + adversarial_cases()
        scenes = [simulated.scene_case(name) for name in bundled_scenes()]
    with steps.step("cases"):
        rows = simulated.run_cases(cases)
    worst = rows[-len(adversarial.FAMILIES) :]
    with steps.step("scenes"):
        results = simulated.results(scenes)
        rows += [simulated.judge(c, [r]) for c, r in zip(scenes, results, strict=True)]
        errors = error_rows(scene_errors(scenes, results), worst)
    with steps.step("shared_edges") as step:
        rows.append(simulated.shared_edges(MESHES, step.done))
    with steps.step("powers") as step:
        powers = adversarial.power_errors(step.done)
        rows.append(power_row(powers))
    with steps.step("long_run"):
        rows.append(simulated.long_run(LONG_RUN))
    with steps.step("large_frame"):
        rows += simulated.run_cases([simulated.scene_case(*LARGE)])
    return {
        "schema": SCHEMA,
        "rows": [row.as_dict() for row in rows],
        "errors": errors,
        "powers": powers,
        "amm_2012_at_20": adversarial.AMM_2012,
        "versions": versions(),
        "wall_s": {name: round(value, 3) for name, value in steps.wall_s.items()},
    }


def main(record: bool) -> int:
    """Run, print, write; returns the exit code. Raises BuildError, SimulationError."""
    recorded.check(record)
    begin = time.perf_counter()
    report = run(Steps())
    OUT.mkdir(parents=True, exist_ok=True)
    part = OUT / "report.json.part"
    part.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n")
    part.replace(OUT / "report.json")
    console.show(
        case_table(report["rows"]), error_table(report["errors"]), power_table(report["powers"])
    )
    failed = [row for row in report["rows"] if row["failures"]]
    if record:
        recorded.record(
            "stability", "make stability", ("verilator", "numpy"), [],
            {"cases": len(report["rows"])}, failed=bool(failed), cases=report["rows"],
            errors=report["errors"], powers=report["powers"],
        )  # fmt: skip
    console.say(
        f"{len(report['rows'])} rows, {len(failed)} failed, {time.perf_counter() - begin:.0f} s; "
        f"{console.shown(OUT)}/report.json"
    )
    for row in failed:
        for line in row["failures"]:
            console.failure(f"{row['case']}: {line}")
    return console.FAILED if failed else console.GOOD
