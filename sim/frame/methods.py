"""One point of the precision sweep: built, simulated, compared with its twin, and measured.

What is kept is what the simulator gave, named by the hash of the bench and of the stimulus: twin,
reference and errors are computed anew each time, so that no comparison is ever skipped.
"""

from __future__ import annotations

import hashlib
import json
import os
import time
from pathlib import Path

import numpy as np

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, reference
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.front.scene import load_scene
from phong75.model.registers import writes
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import pack
from phong75.model.studies.methods import FRAMES, Point
from phong75.model.twin import Pixels
from phong75.sim.build import Bench
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import Job, simulate_jobs

FOLDER = BUILD / "sweep"


def _stimulus(frames: list[Frame], config: Config) -> str:
    """A hash of all that the hardware is given."""
    sha = hashlib.sha256()
    for frame in frames:
        sha.update(pack(frame.spans, config, frame.half_vector))
        sha.update(json.dumps([[int(a), int(w)] for a, w in writes(frame, config)]).encode())
    return sha.hexdigest()[:16]


def _simulate(point: Point, frames: list[Frame], folder: Path) -> tuple[dict, list[Pixels]]:
    """Counters and pixels of `frames`, from the simulator or from its last run on the same."""
    config = point.config
    bench = Bench("frame_bench", config)
    record, kept = folder / f"{config.name}.json", folder / f"{config.name}.npz"
    key = f"{bench.folder.name} {_stimulus(frames, config)}"
    try:
        said = json.loads(record.read_text())
        if said["key"] == key:
            with np.load(kept) as file:
                columns = [[file[f"{c}{k}"] for c in "xycl"] for k in range(len(frames))]
            return said, [Pixels(*column) for column in columns]
    except (OSError, ValueError, KeyError):
        pass
    results = simulate_jobs([Job(frame) for frame in frames], config, bench)
    pixels = [r.pixels for r in results]
    arrays = {}
    for k, p in enumerate(pixels):
        arrays |= {f"x{k}": p.x, f"y{k}": p.y, f"c{k}": p.rgb, f"l{k}": p.last}
    said = {
        "key": key,
        "complete": all(r.complete for r in results),
        "extra_pixels": sum(r.extra_pixels for r in results),
        "illegal_spans": sum(r.illegal_spans for r in results),
        "cycles": sum(r.cycles for r in results),
        "latency_cycles": results[0].latency_cycles,
        "simulate_s": sum(r.simulate_s for r in results),
        "build_s": results[0].build_s,
    }
    folder.mkdir(parents=True, exist_ok=True)
    part = kept.with_name(f".{os.getpid()}.npz")
    record.unlink(missing_ok=True)
    np.savez_compressed(part, **arrays)
    part.replace(kept)
    return said, pixels


def measure(point: Point, frames=FRAMES, folder: Path = FOLDER) -> dict:
    """Measure `point` on `frames` (see `model.sweep.FRAMES`), all their pixels together.

    `mismatches`: pixels in which RTL and twin differ. Errors are those of the RTL's codes against
    the float64 shading of the scene before any rounding, so that what a configuration rounds at its
    ports counts, too. `port_max_lsb` is against the float64 shading of the integers at the ports,
    which `bound_lsb` bounds (None: none is derived). Also kept in `folder`/<name>.json. Raises
    BuildError, SimulationError.
    """
    config = point.config
    made = [front_end(load_scene(name, size), config) for name, size, _ in frames]
    said, pixels = _simulate(point, [m.frame for m in made], folder)
    start = time.perf_counter()
    expected = [twin.render(m.frame, config) for m in made]
    model_s = time.perf_counter() - start
    compared = [metrics.compare(e, p) for e, p in zip(expected, pixels, strict=True)]
    mismatches = sum(c.mismatches for c in compared) + said["extra_pixels"]
    both = [min(len(e.rgb), len(p.rgb)) for e, p in zip(expected, pixels, strict=True)]
    codes = np.concatenate([p.rgb[:n] for p, n in zip(pixels, both, strict=True)])
    exact = [reference.render_exact(m.frame, m.exact)[:n] for m, n in zip(made, both, strict=True)]
    ports = [reference.render(m.frame, config)[:n] for m, n in zip(made, both, strict=True)]
    bounds = [error_budget.bound_lsb(m.frame, config) for m in made]
    found = {
        **said,
        "name": config.name,
        "family": "precision",
        "method": point.method,
        "label": point.label,
        "pixels": sum(c.pixels for c in compared),
        "mismatches": mismatches,
        **metrics.error_metrics(codes, np.concatenate(exact)),
        "port_max_lsb": metrics.error_metrics(codes, np.concatenate(ports))["max_lsb"],
        "bound_lsb": None if None in bounds else max(bounds),
        "simulate_s": round(said["simulate_s"], 4),
        "model_s": round(model_s, 4),
        "config": config.as_dict(),
    }
    part = folder / f".{config.name}.{os.getpid()}"
    part.write_text(json.dumps(found, indent=2) + "\n")
    part.replace(folder / f"{config.name}.json")
    return found
