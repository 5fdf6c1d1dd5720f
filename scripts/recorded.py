# SPDX-License-Identifier: MIT
"""The results of the long runs, results/<name>.json, and the README's table of them.

A long run writes its record only where it is asked to (`--record`, `RECORD=1`), with the date, the
commit and the versions of its tools. A lesser run never replaces a better record: not one that
failed, nor a part of the whole, nor one with less effort (fewer seeds, say). The files are kept in
git, so that the table and the report page show what was found without hours of computing.
"""

from __future__ import annotations

import datetime
import importlib.metadata
import json
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from phong75.model.frame import InputError
from phong75.scripts import console
from phong75.sim.design import IN_CHECKOUT, PACKAGE

FOLDER = PACKAGE / "results"
#: The records of the table, in its order.
NAMES = (
    "synth-grade6", "synth-grade8", "netlist", "icarus", "formal", "coverage", "mutate",
    "prune-random", "activity", "bench",
)  # fmt: skip
HEADER = """\
| what | figure | command | tools | run on, at | what it does not mean |
|---|---|---|---|---|---|"""


@dataclass(frozen=True)
class Row:
    """One line of the table: what was measured, the figure, and what it does not mean."""

    what: str
    figure: str
    caveat: str


def commit() -> str:
    """The commit at work, short, with a + if files differ from it; "unknown" outside git."""

    def git(*arguments):
        return subprocess.run(
            ["git", *arguments], cwd=PACKAGE, check=True, text=True, capture_output=True
        ).stdout.strip()

    try:
        changed = git("status", "--porcelain", "--", ".", ":!results", ":!README.md")
        return git("rev-parse", "--short", "HEAD") + ("+" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def save(name: str, command: str, packages: tuple[str, ...], rows: list[Row], **more) -> Path:
    """Write record `name`: `rows` as found by `command` with `packages`. Returns its path."""
    tools = ", ".join(f"{p} {importlib.metadata.version(p)}" for p in packages)
    record = {
        "name": name, "command": command, "date": datetime.date.today().isoformat(),
        "commit": commit(), "tools": tools, "rows": [asdict(row) for row in rows], **more,
    }  # fmt: skip
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.json"
    part = path.with_suffix(".part")
    part.write_text(json.dumps(record, indent=2, ensure_ascii=False) + "\n")
    part.replace(path)
    return path


def check(wanted: bool) -> None:
    """Raise InputError, before the work, if a record is `wanted` and there is no folder for it."""
    if wanted and not IN_CHECKOUT:
        raise InputError("--record writes into results/ of a checkout, and this is none")


def refusal(name: str, effort: dict[str, int], failed: bool = False, part: str = "") -> str:
    """Why a run must not become record `name`; "" if it may. Arguments as for `record`."""
    if failed:
        return "the run failed"
    if part:
        return part
    before = (load(name) or {}).get("effort", {})
    lesser = [
        f"{effort.get(what, 0)} {what}, and the record has {count}"
        for what, count in before.items()
        if effort.get(what, 0) < count
    ]
    return ", ".join(lesser)


def record(
    name: str, command: str, packages: tuple[str, ...], rows: list[Row],
    effort: dict[str, int] | None = None, failed: bool = False, part: str = "", **more,
) -> bool:  # fmt: skip
    """Write record `name` unless the run is a lesser one; says on stderr which. Returns whether.

    effort: how much was tried ({"seeds": 5}, say), kept in the record for later runs. failed: a
    pixel differed, a bound was missed. part: what makes the run a part of the whole, or "". The
    rest as for `save`.
    """
    effort = effort or {}
    if reason := refusal(name, effort, failed, part):
        console.note(f"not recorded in results/{name}.json: {reason}")
        return False
    save(name, command, packages, rows, **({"effort": effort} if effort else {}), **more)
    console.note(f"recorded in results/{name}.json")
    return True


def load(name: str) -> dict | None:
    """Record `name`; None if it was never made."""
    path = FOLDER / f"{name}.json"
    return json.loads(path.read_text()) if path.is_file() else None


def table() -> str:
    """The README's table, in Markdown."""
    lines = [HEADER]
    for record in filter(None, map(load, NAMES)):
        for row in record["rows"]:
            cells = (
                row["what"], row["figure"], f"`{record['command']}`", record["tools"],
                f"{record['date']}, {record['commit']}", row["caveat"],
            )  # fmt: skip
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> int:
    """Print the table; returns the exit code."""
    console.say(table())
    missing = [name for name in NAMES if load(name) is None]
    if missing:
        console.note(f"not run yet: {' '.join(missing)}")
    return console.GOOD


if __name__ == "__main__":
    sys.exit(console.exit_code(main))
