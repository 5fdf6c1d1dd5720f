# SPDX-License-Identifier: MIT
"""Searches for the input with the largest error: `phong75 adversarial`.

Each family is searched from random starts (model/studies/adversarial.py), and around the place
where the certified bound is largest (model/studies/aligned.py), if `phong75 prove` has a record.

Exit code: 0; 1 if an input is beyond its bound; 2. An input worse than the kept one (see
model/studies/adversarial.py) is shown, and kept with `--record`; `phong75 stability` replays what
is kept.
"""

from __future__ import annotations

import json

from rich.table import Table

from phong75.model.analysis import error_budget
from phong75.model.studies import adversarial, aligned
from phong75.scripts import console, recorded
from phong75.scripts.console import Steps
from phong75.scripts.docs.tables import above
from phong75.sim.design import BUILD


def main(record: bool) -> int:
    """Search all families, and keep worse inputs if `record`; returns the exit code."""
    recorded.check(record)
    old = {(r["limit"], r["steep"]): r for r in adversarial.kept()} if _kept() else {}
    steps, rows, shown, beyond, better = Steps(), [], [], [], []
    table = Table(title="largest error found, LSB", title_style="bold")
    for title in ("inputs", "found", "kept", "bound of the input", "bound of all such inputs"):
        table.add_column(title, justify="left" if title == "inputs" else "right")
    bounds = {(row["limit"], row["steep"]): row for row in recorded.figures("prove")["families"]}
    for family in adversarial.FAMILIES:
        of = bounds[family.limit, family.steep]
        with steps.step(family.name) as step:
            found = adversarial.search(family, progress=step.done)
        with steps.step(f"{family.name}, aligned") as step:
            beside = aligned.search(family, aligned.place(of["search"]["at"]), progress=step.done)
        found = max(found, beside, key=lambda row: row["error_lsb"])
        before = old.get((family.limit, family.steep))
        if before is None or found["error_lsb"] > before["error_lsb"]:
            better.append(family.name)
            rows.append(found)
        else:
            rows.append(before)
        bound = float(error_budget.bound_lsb(adversarial.frame(found)))
        least = min(bound, of["certified_lsb"])
        if found["error_lsb"] > least:
            beyond.append(f"{family.name}: {found['error_lsb']:.4f} LSB is beyond {least:.4f}")
        shown.append(found | {"family": family.name, "bound_lsb": bound})
        table.add_row(
            family.name, f"{found['error_lsb']:.4f}",
            f"{before['error_lsb']:.4f}" if before else "–", above(bound, 4),
            above(of["certified_lsb"], 4),
        )  # fmt: skip
    folder = BUILD / "stability"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "adversarial.json").write_text(json.dumps(shown, indent=1) + "\n")
    console.show(table)
    if better and record and not beyond:
        adversarial.keep(rows)
        console.say(f"kept in {adversarial.KEPT.name}: {', '.join(better)}")
    elif better and record:
        console.note(f"not kept in {adversarial.KEPT.name}: the run failed")
    elif better:
        console.say(f"worse than what is kept: {', '.join(better)}; --record keeps them")
    for line in beyond:
        console.failure(line)
    return console.FAILED if beyond else console.GOOD


def _kept() -> bool:
    return adversarial.KEPT.is_file()
