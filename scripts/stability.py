# SPDX-License-Identifier: MIT
"""Stiff and extreme cases through RTL, model and reference: `phong75 stability`.

Prints a row a case and the table of errors (certified bound, worst of the bundled scenes, worst
input found), and writes both to build/stability/report.json. Exit code: 0, 1 if a row fails, 2.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable

import numpy as np
from rich.console import Console, ConsoleOptions, RenderResult
from rich.markup import escape
from rich.table import Table

from phong75.model.analysis.run_report import versions
from phong75.model.config import DEFAULT as C
from phong75.model.front.scene import bundled_scenes
from phong75.model.studies import adversarial, corner_cases
from phong75.model.studies.methods import CONFIGS, PORTS_OF_DEFAULT
from phong75.scripts import console, recorded
from phong75.scripts.console import Steps
from phong75.scripts.docs.tables import above
from phong75.sim.design import BUILD
from phong75.sim.frame import corner_cases as simulated

#: Version of the layout of report.json.
SCHEMA = 3
OUT = BUILD / "stability"
MESHES = 100_000
#: What is recorded of a case.
RECORDED = (
    "case", "pixels", "max_lsb", "bound_lsb", "mismatches", "zero_normals", "verdict",
)  # fmt: skip
LONG_RUN = 1_000_000
LARGE = ("still_life", (3840, 2160))


def adversarial_cases() -> list[corner_cases.CornerCase]:
    """The worst input of each family, as cases."""
    names = {(f.limit, f.steep): f.name for f in adversarial.FAMILIES}
    return [
        corner_cases.CornerCase(
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
        if table.curve is not None:  # no power, and so in no family
            continue
        material = np.repeat(spans["material"], spans["length"])
        n = C.exponent.real(table.exponent)[material]
        constant = (np.ptp(table.weight, axis=1) == 0)[material]
        error = corner_cases.errors(case.frame, result.pixels.rgb)
        for family in worst:
            belongs = (n <= family.limit) & (constant | family.steep)
            worst[family] = max(worst[family], float(error[belongs].max(initial=0)))
    return worst


def error_rows(
    scenes: dict[adversarial.Family, float], worst: list[simulated.CornerCaseRow]
) -> list[dict]:
    """A row a family: certified bound (of `phong75 prove`), worst of the bundled scenes, and the
    worst input found, as it came out of the RTL, with its own derived bound."""
    certified = {
        (row["limit"], row["steep"]): row["certified_lsb"]
        for row in recorded.figures("prove")["families"]
    }
    found = {(r["limit"], r["steep"]): w for r, w in zip(adversarial.kept(), worst, strict=True)}
    return [
        {
            "family": family.name,
            "limit": family.limit,
            "steep": family.steep,
            "bound_lsb": certified[family.limit, family.steep],
            "scenes_lsb": scenes[family],
            "adversarial_lsb": found[family.limit, family.steep].max_lsb,
            "adversarial_bound_lsb": found[family.limit, family.steep].bound_lsb,
        }
        for family in adversarial.FAMILIES
    ]


def method_rows(done: Callable[[float], None] | None = None) -> list[dict]:
    """A row for each of PORTS_OF_DEFAULT, see `simulated.method_row`. done: called with the part
    done. Raises BuildError, SimulationError."""
    cases, rows = simulated.plain_cases(), []
    for name in PORTS_OF_DEFAULT:
        rows.append(simulated.method_row(CONFIGS[name], cases))
        if done:
            done(len(rows) / len(PORTS_OF_DEFAULT))
    return rows


class CaseTable:
    """The rows of report.json for the terminal, a line or two each.

    The verdict stands first and is never cut. A narrow terminal shows no column `expected`: the
    report page and report.json have it.
    """

    #: Least width of a terminal, in characters, that shows what is expected of each case.
    WIDE = 120

    def __init__(self, rows: list[dict]):
        self._rows = rows

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        """Called by rich with the width of the terminal."""
        yield self.table(options.max_width)

    def table(self, width: int) -> Table:
        """The table for a terminal of `width` characters."""
        table = Table(title="stability: stiff and extreme cases", title_style="bold")
        table.add_column("verdict", no_wrap=True)
        table.add_column("case", ratio=1)
        if width >= self.WIDE:
            table.add_column("expected", ratio=2)
        for title in ("pixels", "RTL ≠\nmodel", "worst,\nLSB", "bound,\nLSB"):
            table.add_column(title, justify="right", no_wrap=True)
        for row in self._rows:
            good = row["verdict"] == "ok"
            expected = [escape(row["expected"])] if width >= self.WIDE else []
            table.add_row(
                "[green]ok[/]" if good else "[bold red]FAILED[/]", escape(row["case"]), *expected,
                count(row["pixels"]), count(row["mismatches"]), number(row["max_lsb"]),
                bound(row["bound_lsb"]),
            )  # fmt: skip
        return table


def case_table(rows: list[dict]) -> CaseTable:
    """The rows of report.json for the terminal."""
    return CaseTable(rows)


def error_table(rows: list[dict]) -> Table:
    """Certified bound, worst of the bundled scenes and worst input found, for each family."""
    table = Table(title="largest error in LSB (perfect rounding: ½)", title_style="bold")
    titles = "inputs", "certified\nbound", "bundled\nscenes", "worst\ninput found", "its own\nbound"
    for title in titles:
        table.add_column(title, justify="left" if title == "inputs" else "right", no_wrap=True)
    for row in rows:
        table.add_row(
            row["family"], bound(row["bound_lsb"]), number(row["scenes_lsb"]),
            number(row["adversarial_lsb"]), bound(row["adversarial_bound_lsb"]),
        )  # fmt: skip
    return table


def power_table(rows: list[dict]) -> Table:
    """The largest error of cos(s)**n alone, and its bound, for each exponent n."""
    table = Table(title="cos(s)ⁿ alone, every code of 1 − cos(s)", title_style="bold")
    for title in ("n", "largest error", "derived bound"):
        table.add_column(title, justify="right", no_wrap=True)
    for row in rows:
        table.add_row(f"{row['n']:g}", f"{row['max_error']:.3g}", f"{row['bound']:.3g}")
    return table


def number(value: float | None) -> str:
    """An error in LSB with four digits; a dash where there is none."""
    return "–" if value is None else f"{value:.4f}"


def bound(value: float | None) -> str:
    """A bound in LSB, rounded up to four digits; a dash where there is none."""
    return "–" if value is None else above(value, 4)


def count(value: int | None) -> str:
    """A count with spaces between thousands; a dash where nothing is counted."""
    return "–" if value is None else f"{value:,}".replace(",", " ")


def power_row(rows: list[dict]) -> simulated.CornerCaseRow:
    """cos(s)**n alone, as a row of the table.

    Each error must be within its bound, and that at n = 20 at most a tenth of the published
    figure (adversarial.AMM_2012).
    """
    failures = [
        f"n = {r['n']:g}: {r['max_error']:.3g} is beyond {r['bound']:.3g}"
        for r in rows if r["max_error"] > r["bound"]
    ]  # fmt: skip
    at_20 = next(r["max_error"] for r in rows if r["n"] == 20)
    if at_20 > adversarial.AMM_2012 / 10:
        failures.append(f"n = 20: {at_20:.3g} is more than a tenth of {adversarial.AMM_2012}")
    return simulated.CornerCaseRow(
        "cos(s)ⁿ alone", f"every code of 1 − cos(s), for {len(rows)} exponents",
        f"at n = 20 an error of {at_20:.2g}, at most a tenth of {adversarial.AMM_2012}; "
        "all within the derived bounds",
        sum(r["codes"] for r in rows), None, None, None, None, failures,
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
    with steps.step("methods") as step:
        methods = method_rows(step.done)
    with steps.step("long_run"):
        rows.append(simulated.long_run(LONG_RUN))
    with steps.step("large_frame"):
        rows += simulated.run_cases([simulated.scene_case(*LARGE)])
    return {
        "schema": SCHEMA,
        "rows": [row.as_dict() for row in rows],
        "errors": errors,
        "powers": powers,
        "methods": methods,
        "amm_2012_at_20": adversarial.AMM_2012,
        "versions": versions(),
        "wall_s": {name: round(value, 3) for name, value in steps.wall_s.items()},
    }


def figures(report: dict) -> dict:
    """What is recorded of `report`: the numbers of its rows and errors, no words, no times."""
    rows = [{name: row[name] for name in RECORDED} for row in report["rows"]]
    methods = [
        {name: value for name, value in row.items() if name != "failures"}
        for row in report["methods"]
    ]
    kept = {name: report[name] for name in ("errors", "powers", "amm_2012_at_20")}
    return {"rows": rows, "methods": methods} | kept


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
    failed += [row | {"case": row["name"]} for row in report["methods"] if row["failures"]]
    if record:
        recorded.record(
            "stability", "make stability", ("verilator", "numpy"), figures(report),
            {"cases": len(report["rows"])}, failed=bool(failed),
        )  # fmt: skip
    console.say(
        f"{len(report['rows'])} rows, {len(report['methods'])} methods, {len(failed)} failed, "
        f"{time.perf_counter() - begin:.0f} s; "
        f"{console.shown(OUT)}/report.json"
    )
    for row in failed:
        for line in row["failures"]:
            console.failure(f"{row['case']}: {line}")
    return console.FAILED if failed else console.GOOD
