# SPDX-License-Identifier: MIT
"""Line, branch and toggle coverage of rtl/ by module, frame and configuration tests.

Lines and branches have to be covered, all of them, but for WAIVERS; toggles are reported. The
numbers go to build/coverage.json. Exit code: 1 if something is not covered, or a test fails.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

from phong75.scripts import recorded
from phong75.sim import design
from phong75.sim.coverage import points
from phong75.sim.design import BUILD

TESTS = ("tests/test_modules.py", "tests/test_frames.py", "tests/test_configurations.py")

#: (file, text of the line, reason): lines that no test can reach.
_ELABORATED = "a function of constants: it runs when the design is elaborated, not in simulation"
WAIVERS: tuple[tuple[str, str, str], ...] = (
    ("constant_multiplier.v", "function integer count(input integer unused);", _ELABORATED),
    (
        "constant_multiplier.v",
        "for (p = 0; p <= CONSTANT_BITS; p = p + 1) count = count + {31'b0, DIGITS[p]};",
        _ELABORATED,
    ),
)


def waived(name: str, line: int) -> bool:
    """Whether a line of rtl/`name` is on the list."""
    text = design.module_file(Path(name).stem).read_text().splitlines()[line - 1].strip()
    return any((name, text) == waiver[:2] for waiver in WAIVERS)


def main() -> int:
    """Run the tests with counters, add up, report; returns the exit code."""
    folder = BUILD / "coverage"
    shutil.rmtree(folder, ignore_errors=True)
    command = [sys.executable, "-m", "pytest", *TESTS, *sys.argv[1:]]
    done = subprocess.run(
        command, cwd=design.PACKAGE, env=os.environ | {"PHONG_COVERAGE": str(folder)}
    )
    found = points(folder)
    if not found:
        print("no coverage was counted", file=sys.stderr)
        return 1
    table = Table(title="coverage of rtl/")
    for title in ("kind", "points", "covered", "share"):
        table.add_column(title, justify="right")
    summary, missing = {}, []
    for kind in sorted({key[0] for key in found}):
        of_kind = {key: count for key, count in found.items() if key[0] == kind}
        if kind != "toggle":
            of_kind = {k: c for k, c in of_kind.items() if c or not waived(k[1], k[2])}
            missing += [key for key, count in of_kind.items() if not count]
        covered = sum(count > 0 for count in of_kind.values())
        summary[kind] = {"points": len(of_kind), "covered": covered}
        share = f"{100 * covered / len(of_kind):.2f} %"
        table.add_row(kind, str(len(of_kind)), str(covered), share)
    Console().print(table)
    percent = {k: round(100 * s["covered"] / s["points"], 2) for k, s in summary.items()}
    recorded.save(
        "coverage", "make coverage", ("verilator",),
        {"percent": percent, "points": summary, "waived_lines": len(WAIVERS)},
    )  # fmt: skip
    for kind, name, line, what in sorted(missing):
        print(f"not covered: rtl/{name}:{line} ({kind} {what})", file=sys.stderr)
    (BUILD / "coverage.json").write_text(json.dumps(summary, indent=2) + "\n")
    return 1 if missing or done.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
