# SPDX-License-Identifier: MIT
"""Coverage counts that simulations leave behind (`Bench(coverage=folder)`)."""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path

from phong75.sim import design

_POINT = re.compile(r"^C '(.*)' (\d+)$")

#: A coverage point: (kind, file name, line, what), kind "line", "branch" or "toggle".
Point = tuple[str, str, int, str]


def points(folder: Path) -> dict[Point, int]:
    """{point: count} of all coverage points of the design, added over all runs in `folder`."""
    names = {file.name for file in design.sources()}
    counts: dict[Point, int] = defaultdict(int)
    for file in sorted(folder.glob("*.dat")):
        for line in file.read_text().splitlines():
            if not (match := _POINT.match(line)):
                continue
            keys = dict(part.split("\2", 1) for part in match[1].split("\1") if "\2" in part)
            name = Path(keys["f"]).name
            if name in names:
                kind = keys["page"].split("/")[0].removeprefix("v_")
                counts[kind, name, int(keys["l"]), keys["n"] + keys["o"]] += int(match[2])
    return counts
