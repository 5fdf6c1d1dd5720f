"""Line, branch and toggle coverage of rtl/ by module and frame tests and trials: `make coverage`.

Lines and branches have to be covered, all of them, but for WAIVERS; toggles are reported. The
numbers go to build/coverage.json. Exit code: 1 if something is not covered, or a test fails.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

from rich.console import Console
from rich.table import Table

from phong75.scripts import recorded
from phong75.scripts.recorded import Row
from phong75.sim import design, environment
from phong75.sim.design import BUILD

TESTS = ("tests/test_modules.py", "tests/test_frames.py", "tests/test_trials.py")

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

_POINT = re.compile(r"^C '(.*)' (\d+)$")


def points(folder: Path) -> dict[tuple, int]:
    """{(kind, file, line, what): count} of all coverage points in rtl/, over all runs."""
    counts: dict[tuple, int] = defaultdict(int)
    for file in sorted(folder.glob("*.dat")):
        for line in file.read_text().splitlines():
            if not (match := _POINT.match(line)):
                continue
            keys = dict(part.split("\2", 1) for part in match[1].split("\1") if "\2" in part)
            if Path(keys["f"]).parent.name == "rtl":
                kind = keys["page"].split("/")[0].removeprefix("v_")
                name = Path(keys["f"]).name
                counts[kind, name, int(keys["l"]), keys["n"] + keys["o"]] += int(match[2])
    return counts


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
        command, cwd=design.PACKAGE, env=os.environ | {environment.COVERAGE: str(folder)}
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
    share = {k: f"{100 * s['covered'] / s['points']:.4g} %" for k, s in summary.items()}
    recorded.save(
        "coverage", "make coverage", ("verilator",),
        [Row("line and branch coverage of `rtl/`", f"{share['line']} and {share['branch']}; "
             f"toggles {share['toggle']}", f"by module and frame tests and trials; {len(WAIVERS)} "
             "lines waived, of a function that runs when the design is elaborated")],
    )  # fmt: skip
    for kind, name, line, what in sorted(missing):
        print(f"not covered: rtl/{name}:{line} ({kind} {what})", file=sys.stderr)
    (BUILD / "coverage.json").write_text(json.dumps(summary, indent=2) + "\n")
    return 1 if missing or done.returncode else 0


if __name__ == "__main__":
    sys.exit(main())
