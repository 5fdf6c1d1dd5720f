# SPDX-License-Identifier: MIT
"""Line, branch and toggle coverage of rtl/ by module, frame and configuration tests.

All lines and branches must be covered, except WAIVERS. Toggles are only reported. The numbers go to
build/coverage.json. Exit code: 0; 1 if a line or branch is not covered, or a test fails; 2 if no
coverage was counted.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from phong75.model.frame import InputError
from phong75.scripts import console, options, recorded
from phong75.scripts.main import single
from phong75.sim import design, environment
from phong75.sim.coverage import points
from phong75.sim.design import BUILD

TESTS = ("tests/test_modules.py", "tests/test_frames.py", "tests/test_configurations.py")

_ELABORATED = "a function of constants: evaluated during elaboration, not in simulation"

#: (file, text of the line, reason): lines that no test can cover.
WAIVERS: tuple[tuple[str, str, str], ...] = (
    ("constant_multiplier.v", "function integer count(input integer unused);", _ELABORATED),
    (
        "constant_multiplier.v",
        "for (p = 0; p <= CONSTANT_BITS; p = p + 1) count = count + {31'b0, DIGITS[p]};",
        _ELABORATED,
    ),
)


def waived(name: str, line: int) -> bool:
    """Whether line number `line` of the file `name` is in WAIVERS."""
    text = design.module_file(Path(name).stem).read_text().splitlines()[line - 1].strip()
    return any((name, text) == waiver[:2] for waiver in WAIVERS)


def main(
    arguments: Annotated[
        list[str] | None, typer.Argument(metavar="PYTEST", help="More arguments for pytest.")
    ] = None,
    record: options.Record = False,
) -> int:
    """Line, branch and toggle coverage of rtl/ by the tests that simulate the design."""
    recorded.check(record)
    folder = BUILD / "coverage"
    shutil.rmtree(folder, ignore_errors=True)
    tests = subprocess.run(
        [sys.executable, "-m", "pytest", *TESTS, *(arguments or [])],
        cwd=design.PACKAGE,
        env=os.environ | {environment.COVERAGE: str(folder)},
    )
    counts = points(folder)
    if not counts:
        raise InputError("no coverage was counted")
    table = Table(title="coverage of rtl/")
    for title in ("kind", "points", "covered", "share"):
        table.add_column(title, justify="right")
    summary, missing = {}, []
    for kind in sorted({key[0] for key in counts}):
        of_kind = {key: count for key, count in counts.items() if key[0] == kind}
        if kind != "toggle":
            of_kind = {k: c for k, c in of_kind.items() if c or not waived(k[1], k[2])}
            missing += [key for key, count in of_kind.items() if not count]
        covered = sum(count > 0 for count in of_kind.values())
        summary[kind] = {"points": len(of_kind), "covered": covered}
        table.add_row(
            kind, str(len(of_kind)), str(covered), f"{100 * covered / len(of_kind):.2f} %"
        )
    console.show(table)
    for kind, name, line, point in sorted(missing):
        console.failure(f"not covered: {name}:{line} ({kind} {point})")
    (BUILD / "coverage.json").write_text(json.dumps(summary, indent=2) + "\n")
    failed = bool(missing or tests.returncode)
    if record:
        percent = {k: round(100 * s["covered"] / s["points"], 2) for k, s in summary.items()}
        recorded.record(
            "coverage", "make coverage", ("verilator",),
            {"percent": percent, "points": summary, "waived_lines": len(WAIVERS)},
            failed=failed, part="pytest had arguments of its own" if arguments else "",
        )  # fmt: skip
    return console.FAILED if failed else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "coverage"))
