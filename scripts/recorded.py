# SPDX-License-Identifier: MIT
"""Records of the long runs: numbers and names in results/<name>.json.

A long run writes its record only where it is asked to (`--record`, `RECORD=1`), with the date, the
commit and the versions of its tools. A lesser run never replaces a better record: not one that
failed, nor a part of the whole, nor one with less effort (fewer seeds, say). The files are kept in
git, so that docs/ and the report page show the figures without hours of computing. Sentences and
tables are made from the figures elsewhere (scripts/docs/tables.py).
"""

from __future__ import annotations

import datetime
import importlib.metadata
import json
import subprocess
from pathlib import Path
from typing import Any

from phong75.model.frame import InputError
from phong75.scripts import console
from phong75.sim.design import IN_CHECKOUT, PACKAGE

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
    name: str, command: str, packages: tuple[str, ...], figures: dict[str, Any],
    effort: dict[str, int] | None = None, failed: bool = False, part: str = "",
) -> bool:  # fmt: skip
    """Write `figures`, found by `command` with `packages`, as record `name`, unless the run is a
    lesser one; a line on stderr says which. Returns whether it was written.

    effort: how much was computed, such as {"seeds": 3}, kept in the record for later runs. failed:
    a pixel differed, or a bound was missed. part: what makes the run a part of the whole, or "".
    """
    effort = effort or {}
    if reason := refusal(name, effort, failed, part):
        console.note(f"not recorded in results/{name}.json: {reason}")
        return False
    save(name, command, packages, figures, effort)
    console.note(f"recorded in results/{name}.json")
    return True


def save(
    name: str, command: str, packages: tuple[str, ...], figures: dict[str, Any],
    effort: dict[str, int] | None = None,
) -> Path:  # fmt: skip
    """Write record `name` without a question; returns its path. Arguments as for `record`."""
    contents = {
        "command": command,
        "date": datetime.date.today().isoformat(),
        "commit": commit(),
        "tools": {package: importlib.metadata.version(package) for package in packages},
        "effort": effort or {},
        "figures": figures,
    }
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / f"{name}.json"
    part = path.with_suffix(".part")
    part.write_text(json.dumps(contents, indent=1, ensure_ascii=False) + "\n")
    part.replace(path)
    return path


def load(name: str) -> dict[str, Any] | None:
    """Record `name`; None if it was never made."""
    path = FOLDER / f"{name}.json"
    return json.loads(path.read_text()) if path.is_file() else None


def figures(name: str) -> dict[str, Any]:
    """The figures of record `name`; empty if it was never made."""
    return (load(name) or {}).get("figures", {})
