# SPDX-License-Identifier: MIT
"""Records of the long runs: numbers and names in results/<name>.json.

Every long target can leave its figures there, with the date, the commit and the versions of its
tools. The files are kept in git, so that docs/ and the report page show the figures without hours
of computing. Sentences and tables are made from the figures elsewhere (scripts/docs/tables.py).
"""

from __future__ import annotations

import datetime
import importlib.metadata
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from phong75.sim.design import PACKAGE

FOLDER = PACKAGE / "results"


def commit() -> str:
    """The commit at work, short, with a + if files differ from it; "unknown" outside git."""

    def git(*arguments: str) -> str:
        return subprocess.run(
            ["git", *arguments], cwd=PACKAGE, check=True, text=True, capture_output=True
        ).stdout.strip()

    try:
        changed = git("status", "--porcelain", "--", ".", ":!results", ":!docs", ":!*.md")
        return git("rev-parse", "--short", "HEAD") + ("+" if changed else "")
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def save(
    name: str, command: str, packages: tuple[str, ...], figures: dict[str, Any],
    effort: dict[str, int] | None = None,
) -> Path | None:  # fmt: skip
    """Write `figures`, found by `command` with `packages`, as record `name`; returns its path.

    effort: how much was computed, such as {"seeds": 3}. A record of more effort is kept: a line
    on stderr then names the file, and None is returned.
    """
    effort, path = effort or {}, FOLDER / f"{name}.json"
    kept = (load(name) or {}).get("effort", {})
    if any(effort.get(what, 0) < amount for what, amount in kept.items()):
        print(
            f"results/{path.name} stays as it is: its run computed more ({_words(kept)}; now "
            f"{_words(effort)}). Remove the file to record this run.",
            file=sys.stderr,
        )
        return None
    record = {
        "command": command,
        "date": datetime.date.today().isoformat(),
        "commit": commit(),
        "tools": {package: importlib.metadata.version(package) for package in packages},
        "effort": effort,
        "figures": figures,
    }
    FOLDER.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    part.replace(path)
    return path


def load(name: str) -> dict[str, Any] | None:
    """Record `name`; None if it was never made."""
    path = FOLDER / f"{name}.json"
    return json.loads(path.read_text()) if path.is_file() else None


def figures(name: str) -> dict[str, Any]:
    """The figures of record `name`; empty if it was never made."""
    return (load(name) or {}).get("figures", {})


def _words(effort: dict[str, int]) -> str:
    return ", ".join(f"{what} {amount}" for what, amount in effort.items()) or "nothing counted"
