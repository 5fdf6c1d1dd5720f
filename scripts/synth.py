"""Synthesize, place and route a configuration for an ECP5 and report: `make synth`.

Exit code: 0; 1 if a tool failed; 2 if the input is wrong, with one line on stderr that says what.
"""

from __future__ import annotations

import argparse
import dataclasses
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

from phong75.model.analysis.pruning import prune
from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.frame import InputError
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import recorded
from phong75.scripts.run import Steps
from phong75.scripts.synthesis import ecp5

CONFIGS = {config.name: config for config in TECHNIQUES.values()}


class _Parser(argparse.ArgumentParser):
    """Reports a wrong command line like any other wrong input."""

    def error(self, message):
        raise InputError(message)


def parse(argv) -> tuple[Config, int, tuple[int, ...], bool]:
    """Configuration, speed grade, seeds, and whether to count gates. Raises InputError."""
    parser = _Parser(prog="synth", description=__doc__.partition("\n")[0])
    parser.add_argument("--config", default="", help="name of a configuration")
    parser.add_argument("--scene", default="", help="build only what this scene needs")
    parser.add_argument("--grade", default="", help="speed grade of the chip")
    parser.add_argument("--seeds", default="", help="how many seeds to route")
    parser.add_argument("--gates", default="", help="1: count gate equivalents, too")
    given = parser.parse_args(argv)
    name, grade, seeds = given.config or "default", given.grade or "6", given.seeds or "3"
    if name not in CONFIGS:
        raise InputError(f"CONFIG is `{name}`; there is {', '.join(CONFIGS)}")
    if grade not in map(str, ecp5.GRADES):
        raise InputError(f"GRADE is `{grade}`; it must be 6 or 8")
    if not (seeds.isascii() and seeds.isdigit() and 1 <= int(seeds) <= 100):
        raise InputError(f"SEEDS is `{seeds}`, not a number from 1 to 100")
    if given.gates not in ("", "0", "1"):
        raise InputError(f"GATES is `{given.gates}`, not 0 or 1")
    if given.gates == "1" and not ecp5.LIBERTY.is_file():
        raise InputError("GATES=1 needs a library of cells: apt-get install qflow-tech-osu018")
    config = CONFIGS[name]
    if given.scene:
        frame = front_end(load_scene(given.scene, config=config), config).frame
        config = dataclasses.replace(
            prune(frame, config)[0], name=f"{name}-{Path(given.scene).stem}"
        )
    return config, int(grade), tuple(range(1, int(seeds) + 1)), given.gates == "1"


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


def main(argv=None) -> int:
    """Run with the command line `argv`; returns the exit code."""
    try:
        config, grade, seeds, gates = parse(argv)
    except InputError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    steps = Steps()
    try:
        report = ecp5.run(config, grade, seeds, gates, steps.step)
    except ecp5.SynthesisError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 1
    Console().print(table(report))
    if config == DEFAULT:
        packages = tuple(report["tools"])
        command = "make synth" + (f" GRADE={grade}" if grade != 6 else "")
        recorded.save(f"synth-grade{grade}", command, packages, figures(report), effort(report))
    print(f"build/synth/{config.name}/report.json")
    return 0


if __name__ == "__main__":
    sys.exit(main())
