"""The last results of the long runs, and the README's table of them: `make hardware`.

Every long target leaves its figures in results/<name>.json, with the date, the commit and
the versions of its tools. The files are kept in git, so that the table and the report page show
what was found without hours of computing; `make test` fails if the README shows anything else.
"""

from __future__ import annotations

import datetime
import importlib.metadata
import json
import subprocess
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from phong75.sim.design import PACKAGE

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
    print(table())
    missing = [name for name in NAMES if load(name) is None]
    if missing:
        print(f"not run yet: {' '.join(missing)}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
