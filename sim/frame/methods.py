# SPDX-License-Identifier: MIT
"""Measures one point of the precision sweep: builds, simulates and compares with the twin.

The simulator's counters and pixels are cached under the hash of testbench and stimulus. Twin,
reference and errors are computed on every call, so that no comparison is skipped.
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
from phong75.sim.frame.run_frame import SimJob, simulate_jobs

FOLDER = BUILD / "sweep"


def _stimulus(frames: list[Frame], config: Config) -> str:
    """Hash of the hardware's input: packed spans and register writes."""
    sha = hashlib.sha256()
    for frame in frames:
        sha.update(pack(frame.spans, config, frame.half_vector))
        sha.update(json.dumps([[int(a), int(w)] for a, w in writes(frame, config)]).encode())
    return sha.hexdigest()[:16]


def _simulate(point: Point, frames: list[Frame], folder: Path) -> tuple[dict, list[Pixels]]:
    """Counters and pixels of `frames`, from the cache in `folder` or from the simulator.

    Raises BuildError, SimulationError.
    """
    config = point.config
    bench = Bench("frame_bench", config)
    record, pixel_file = folder / f"{config.name}.json", folder / f"{config.name}.npz"
    key = f"{bench.folder.name} {_stimulus(frames, config)}"
    try:
        counters = json.loads(record.read_text())
        if counters["key"] == key:
            with np.load(pixel_file) as file:
                columns = [[file[f"{c}{k}"] for c in "xycl"] for k in range(len(frames))]
            return counters, [Pixels(*column) for column in columns]
    except (OSError, ValueError, KeyError):
        pass
    results = simulate_jobs([SimJob(frame) for frame in frames], config, bench)
    pixels = [r.pixels for r in results]
    arrays = {}
    for k, p in enumerate(pixels):
        arrays |= {f"x{k}": p.x, f"y{k}": p.y, f"c{k}": p.rgb, f"l{k}": p.last}
    counters = {
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
    part = pixel_file.with_name(f".{os.getpid()}.npz")
    record.unlink(missing_ok=True)
    np.savez_compressed(part, **arrays)
    part.replace(pixel_file)
    return counters, pixels


def measure(point: Point, frames=FRAMES, folder: Path = FOLDER) -> dict:
    """Measure `point` on `frames` (see `model.studies.methods.FRAMES`), all pixels together.

    Returns the result as a dict, which is also written to `folder`/<name>.json:

    - mismatches: number of pixels in which RTL and twin differ.
    - the errors of `metrics.error_metrics`, LSB: the RTL's codes against the float64 shading of the
      scene before any rounding. So the rounding at the ports of a configuration counts, too.
    - port_max_lsb: the largest error against the float64 shading of the integers at the ports.
    - bound_lsb: the derived bound of port_max_lsb, None if no bound is derived.

    Raises BuildError, SimulationError, InputError.
    """
    config = point.config
    fronts = [front_end(load_scene(name, size), config) for name, size, _ in frames]
    counters, pixels = _simulate(point, [f.frame for f in fronts], folder)
    start = time.perf_counter()
    expected = [twin.render(f.frame, config) for f in fronts]
    model_s = time.perf_counter() - start
    compared = [metrics.compare(e, p) for e, p in zip(expected, pixels, strict=True)]
    mismatches = sum(c.mismatches for c in compared) + counters["extra_pixels"]
    both = [min(len(e.rgb), len(p.rgb)) for e, p in zip(expected, pixels, strict=True)]
    codes = np.concatenate([p.rgb[:n] for p, n in zip(pixels, both, strict=True)])
    pairs = list(zip(fronts, both, strict=True))
    exact = [reference.render_exact(f.frame, f.exact)[:n] for f, n in pairs]
    ports = [reference.render(f.frame, config)[:n] for f, n in pairs]
    bounds = [error_budget.bound_lsb(f.frame, config) for f in fronts]
    result = {
        **counters,
        "name": config.name,
        "family": "precision",
        "method": point.method,
        "label": point.label,
        "pixels": sum(c.pixels for c in compared),
        "mismatches": mismatches,
        **metrics.error_metrics(codes, np.concatenate(exact)),
        "port_max_lsb": metrics.error_metrics(codes, np.concatenate(ports))["max_lsb"],
        "bound_lsb": None if None in bounds else max(bounds),
        "simulate_s": round(counters["simulate_s"], 4),
        "model_s": round(model_s, 4),
        "config": config.as_dict(),
    }
    part = folder / f".{config.name}.{os.getpid()}"
    part.write_text(json.dumps(result, indent=2) + "\n")
    part.replace(folder / f"{config.name}.json")
    return result
