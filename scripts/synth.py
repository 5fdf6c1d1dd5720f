# SPDX-License-Identifier: MIT
"""Synthesize, place and route a configuration for an ECP5 and report: `phong75 synth`.

Exit code: 0; 2 if the input is wrong or a tool failed, with one line on stderr that says what.
"""

from __future__ import annotations

import dataclasses
import datetime
from pathlib import Path

from rich.table import Table

from phong75.model.analysis.pruning import prune
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import InputError, fitted
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, recorded
from phong75.scripts.configurations import BUILDS
from phong75.scripts.console import Steps
from phong75.scripts.synthesis import ecp5

#: The record of BUILDS, a row each.
RECORD_OF_BUILDS = "synth-more"


def pruned(config: Config, scene: str) -> Config:
    """`config` with what `scene` needs of it only; itself if `scene` is "". Raises InputError."""
    if not scene:
        return config
    frame = front_end(load_scene(scene, config=config), config).frame
    config = fitted(config, frame)
    return dataclasses.replace(prune(frame, config)[0], name=f"{config.name}-{Path(scene).stem}")


def table(report: dict) -> Table:
    """What there is to see of `report` in a terminal."""
    used, clock = report["resources"], report["fmax_mhz"]
    reported = report["fmax_reported_mhz"]
    worst = min(report["seeds"], key=lambda seed: seed["fmax_mhz"])["critical_path"]
    out = Table(title=f"{report['config']} on {report['device']}, grade {report['grade']}")
    out.add_column("what")
    out.add_column("value", justify="right")
    out.add_row("LUT4 / carry cells / LUT RAM", f"{used['lut']} / {used['carry']} / "
                f"{used['lut_ram']}")  # fmt: skip
    out.add_row("LUT sites (nextpnr)", str(used["lut_sites"]))
    out.add_row("FF", str(used["ff"]))
    out.add_row("MULT18X18D", str(used["dsp"]))
    out.add_row("EBR", str(used["ebr"]))
    out.add_row("Fmax reported, median (best)", f"{reported['median']} ({reported['best']}) MHz")
    if report["limit_mhz"] is not None:
        out.add_row(f"clamped by the {report['limit_by']}'s {report['limit_mhz']} MHz",
                    f"{clock['median']} ({clock['best']}) MHz")  # fmt: skip
    out.add_row("pixels", f"{report['pixels_per_s'] / 1e6:.1f} M/s")
    for size, rate in report["frames_per_s"].items():
        out.add_row(f"frames {size}", f"{rate}/s")
    if gates := report.get("gates"):
        out.add_row(f"gate equivalents, {gates['library']}", str(gates["equivalents"]))
    out.add_row("longest path", f"{worst['from']['module']} to {worst['to']['module']}, "
                f"{worst['delay_ns']} ns")  # fmt: skip
    return out


def figures(report: dict) -> dict:
    """What is recorded of `report`: chip, clocks in MHz, and what the pipeline takes of the chip;
    "gate_equivalents" only where they were counted."""
    found = {
        "device": report["device"], "grade": report["grade"], "seeds": len(report["seeds"]),
        "clock_mhz": report["fmax_mhz"], "clock_reported_mhz": report["fmax_reported_mhz"],
        "limit_mhz": report["limit_mhz"], "limit_by": report["limit_by"],
        "resources": report["resources"],
    }  # fmt: skip
    if gates := report.get("gates"):
        found["gate_equivalents"] = gates["equivalents"]
    return found


def effort(report: dict) -> dict[str, int]:
    """How much was computed for `report`: seeds routed, and whether gates were counted."""
    return {"seeds": len(report["seeds"]), "gates": int("gates" in report)}


def _record_build(name: str, found: dict, tools: dict) -> None:
    """Keep `found` (seeds, clock_mhz, resources, ...) of the build `name` beside the other builds,
    unless the record has more placements of it."""
    rows = recorded.figures(RECORD_OF_BUILDS).get("configurations", {})
    before = rows.get(name, {}).get("seeds", 0)
    rows[name] = found | {
        "date": datetime.date.today().isoformat(), "commit": recorded.commit(),
    }  # fmt: skip
    lesser = f"{found['seeds']} seeds, and the record has {before} of {name}"
    recorded.record(
        RECORD_OF_BUILDS, "make synth CONFIG=NAME", tuple(tools), {"configurations": rows},
        part=lesser if found["seeds"] < before else "",
    )  # fmt: skip


def count(config: Config, record: bool) -> int:
    """Synthesize `config` without routing, and show what it takes of the chip; returns the exit
    code. Raises SynthesisError."""
    folder = ecp5.FOLDER / config.name
    folder.mkdir(parents=True, exist_ok=True)
    with Steps().step("synthesis"):
        used = ecp5.synthesize(config, folder)["resources"]
    out = Table("what", "number", title=config.name)
    for name, value in used.items():
        out.add_row(name, str(value))
    console.show(out)
    if record and BUILDS.get(config.name) == config:
        found = {"seeds": 0, "clock_mhz": None, "resources": used}
        _record_build(config.name, found, ecp5.versions())
    elif record:
        console.note("not recorded: a record needs a clock, --seeds 1 or more")
    return console.GOOD


def main(config: Config, grade: int, seeds: int, count_gates: bool, record: bool) -> int:
    """Synthesize and route `config` with seeds 1 to `seeds`; returns the exit code.

    Raises InputError, SynthesisError.
    """
    recorded.check(record)
    if count_gates and not ecp5.LIBERTY.is_file():
        raise InputError("--gates needs a library of cells: apt-get install qflow-tech-osu018")
    if seeds == 0:
        return count(config, record)
    report = ecp5.run(config, grade, tuple(range(1, seeds + 1)), count_gates, Steps().step)
    console.show(table(report))
    if record and grade == 6 and BUILDS.get(config.name) == config:
        _record_build(config.name, figures(report), report["tools"])
    elif record:
        recorded.record(
            f"synth-grade{grade}",
            "make synth" + (f" GRADE={grade}" if grade != 6 else ""),
            tuple(report["tools"]),
            figures(report),
            effort=effort(report),
            part="" if config == DEFAULT else f"{config.name} is not the default configuration",
        )
    console.say(console.shown(ecp5.FOLDER / config.name / "report.json"))
    return console.GOOD
