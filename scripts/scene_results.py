# SPDX-License-Identifier: MIT
"""The README's table of scenes, measured anew: `phong75 scenes`.

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
from phong75.model.front.scene_to_spans import front_end
from phong75.scripts import console, recorded
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import Job, SimResult, simulate_jobs

#: Version of the layout of build/results.json.
SCHEMA = 1
FPS = 30
SIZES = ((512, 512), (640, 480), (1920, 1080))
CLOCK_HZ = 200e6
HEADER = """\
| scene | pixels | spans | RTL ≠ model | largest error | bound | rounded right | cycles a pixel | \
frames/s |
|---|--:|--:|--:|--:|--:|--:|--:|--:|"""


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
    for frame, simulation in zip(frames, simulate_jobs([Job(f) for f in frames]), strict=True):
        compared = metrics.compare(twin.render(frame), simulation.pixels)
        error = metrics.error_metrics(simulation.pixels.rgb, reference.render(frame))
        results.append(
            Result(
                simulation, len(frame.spans), compared.mismatches + simulation.extra_pixels,
                compared.first, error, error_budget.bound_lsb(frame, CONFIG),
            )
        )  # fmt: skip
    return results


def row(scene: str, results: list[Result]) -> str:
    """The README's row of a scene: the largest size's numbers, the worst of all sizes' errors."""
    big = results[-1]
    pixels = len(big.simulation.pixels.x)
    fps = ", ".join(f"{result.max_fps:.0f}" for result in results)
    return (
        f"| {scene} | {pixels} | {big.spans} | {sum(r.mismatches for r in results)} "
        f"| {max(r.error['max_lsb'] for r in results):.3f} "
        f"| {max(r.bound_lsb for r in results):.3f} "
        f"| {100 * min(r.error['correctly_rounded'] for r in results):.2f} % "
        f"| {big.simulation.cycles / pixels:.4f} | {fps} |"
    )


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


def failures(found: list[dict]) -> list[str]:
    """What is wrong with the rows of `as_dict`, a line each."""
    return [
        f"{row['scene']}, {row['size']}: {row['mismatches']} pixels differ, largest error "
        f"{row['max_lsb']:.4f} LSB, bound {row['bound_lsb']:.4f}"
        for row in found
        if row["mismatches"] or row["max_lsb"] > row["bound_lsb"]
    ]


def main(record: bool) -> int:
    """Print the table; returns the exit code. Raises BuildError, SimulationError."""
    recorded.check(record)
    rows, found = [], []
    for scene in bundled_scenes():
        console.phase(scene)
        measured = measure(scene)
        rows.append(row(scene, measured))
        found += [as_dict(scene, *pair) for pair in zip(SIZES, measured, strict=True)]
    about = {
        "schema": SCHEMA,
        "fps": FPS,
        "clock_hz": CLOCK_HZ,
        "cycles_available": int(CLOCK_HZ // FPS),
    }
    BUILD.mkdir(parents=True, exist_ok=True)
    (BUILD / "results.json").write_text(json.dumps(about | {"rows": found}, indent=1) + "\n")
    console.say("\n".join([HEADER, *rows]))
    wrong = failures(found)
    if record:
        recorded.record(
            "scenes", "make scenes", ("verilator", "numpy"), [], {"frames": len(found)},
            failed=bool(wrong), readme="\n".join([HEADER, *rows]), frames=found, **about,
        )  # fmt: skip
    for line in wrong:
        console.failure(line)
    return console.FAILED if wrong else console.GOOD
