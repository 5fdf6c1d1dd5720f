# SPDX-License-Identifier: MIT
"""Every bundled scene through RTL, twin and reference: `phong75 scenes`.

Every bundled scene at every promised size through RTL, twin and reference; one row a scene. All
numbers also go to build/results.json.
"""

from __future__ import annotations

import json
from dataclasses import dataclass

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, reference
from phong75.model.config import DEFAULT as CONFIG
from phong75.model.front.scene import bundled_scenes, load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, recorded
from phong75.scripts.docs import tables
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import SimJob, SimResult, simulate_jobs

#: Version of the layout of build/results.json.
SCHEMA = 1
FPS = 30
SIZES = ((512, 512), (640, 480), (1920, 1080))
CLOCK_HZ = 200e6


@dataclass
class Result:
    """One scene at one size: what the RTL did, compared with twin, reference and budget."""

    simulation: SimResult
    spans: int
    mismatches: int
    first: metrics.Mismatch | None
    error: dict
    bound_lsb: float

    @property
    def max_fps(self) -> float:
        """Frames a second at CLOCK_HZ."""
        return CLOCK_HZ / self.simulation.cycles


def measure(scene: str) -> list[Result]:
    """Run `scene` at SIZES, in one simulation."""
    frames = [front_end(load_scene(scene, size)).frame for size in SIZES]
    results = []
    for frame, simulation in zip(frames, simulate_jobs([SimJob(f) for f in frames]), strict=True):
        compared = metrics.compare(twin.render(frame), simulation.pixels)
        error = metrics.error_metrics(simulation.pixels.rgb, reference.render(frame))
        results.append(
            Result(
                simulation, len(frame.spans), compared.mismatches + simulation.extra_pixels,
                compared.first, error, error_budget.bound_lsb(frame, CONFIG),
            )
        )  # fmt: skip
    return results


def as_dict(scene: str, size: tuple[int, int], result: Result) -> dict:
    """One scene at one size, for JSON."""
    cycles = result.simulation.cycles
    return {
        "scene": scene, "size": f"{size[0]}×{size[1]}", "pixels": len(result.simulation.pixels.x),
        "spans": result.spans, "cycles": cycles, "fps": result.max_fps,
        "mismatches": result.mismatches, "max_lsb": result.error["max_lsb"],
        "bound_lsb": float(result.bound_lsb),
        "correctly_rounded": result.error["correctly_rounded"],
    }  # fmt: skip


def figures(measured: dict[str, list[Result]]) -> dict:
    """What is recorded: {"clock_hz", "fps", "scenes": {scene: one `as_dict` a size}}."""
    found = {
        scene: [as_dict(scene, *pair) for pair in zip(SIZES, results, strict=True)]
        for scene, results in measured.items()
    }
    return {"clock_hz": CLOCK_HZ, "fps": FPS, "scenes": found}


def failures(found: list[dict]) -> list[str]:
    """What is wrong with the rows of `as_dict`, a line each."""
    return [
        f"{row['scene']}, {row['size']}: {row['mismatches']} pixels differ, largest error "
        f"{row['max_lsb']:.4f} LSB, bound {row['bound_lsb']:.4f}"
        for row in found
        if row["mismatches"] or row["max_lsb"] > row["bound_lsb"]
    ]


def main(record: bool) -> int:
    """Print the table of docs/results.md; returns the exit code. Raises BuildError,
    SimulationError."""
    recorded.check(record)
    measured = {}
    for scene in bundled_scenes():
        console.phase(scene)
        measured[scene] = measure(scene)
    found = figures(measured)
    rows = [run for runs in found["scenes"].values() for run in runs]
    about = {
        "schema": SCHEMA,
        "fps": FPS,
        "clock_hz": CLOCK_HZ,
        "cycles_available": int(CLOCK_HZ // FPS),
    }
    BUILD.mkdir(parents=True, exist_ok=True)
    (BUILD / "results.json").write_text(json.dumps(about | {"rows": rows}, indent=1) + "\n")
    console.say(tables.scenes(found))
    wrong = failures(rows)
    if record:
        recorded.record(
            "scenes", "make scenes", ("verilator", "numpy"), found, {"frames": len(rows)},
            failed=bool(wrong),
        )  # fmt: skip
    for line in wrong:
        console.failure(line)
    return console.FAILED if wrong else console.GOOD
