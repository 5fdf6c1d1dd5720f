"""Whole frames through the RTL, from outside the simulator."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame
from phong75.model.registers import writes
from phong75.model.spans import write_spans
from phong75.model.twin import Pixels
from phong75.sim import environment
from phong75.sim.build import Bench, silent
from phong75.sim.design import BUILD


class SimulationError(Exception):
    """The simulator did not come to its end; the message holds the end of its log."""


@dataclass
class SimResult:
    """What a frame did in simulation; cycles as counted there (see sim/frame_bench.v).

    pixels: as they came. cycles: clocks from the first span accepted to the last pixel taken.
    latency_cycles: to the first pixel offered. stall_cycles: of `cycles`, those after the first
    pixel in which none was taken. illegal_spans, zero_normals: how often the pipeline flagged them.
    extra_pixels: pixels after the last.
    build_s, simulate_s: seconds. unsupported: spans and register writes that need what the build
    leaves out.
    """

    pixels: Pixels
    complete: bool
    cycles: int
    latency_cycles: int
    stall_cycles: int
    illegal_spans: int
    extra_pixels: int
    build_s: float
    simulate_s: float
    zero_normals: int = 0
    unsupported: int = 0


@dataclass
class Job:
    """A frame to run, and under which conditions (see `FrameTB.run`).

    spans_path: its file if there is one already. reset_first: reset before it. writes: (address,
    word) of the register writes, if not those that the frame needs.
    """

    frame: Frame
    spans_path: Path | None = None
    idle: int = 0
    stall: int = 0
    seed: int = 1
    stop_after: int = 0
    reset_first: bool = False
    writes: list[tuple[int, int]] | None = None


def read_pixels(path: Path, config: Config) -> Pixels:
    """The pixels of a file that the bench wrote: 64-bit words {last, y, x, red, green, blue}."""
    words = np.fromfile(path, dtype="<u8")
    colour, place = config.colour_bits, config.coordinate_bits

    def field(lsb, bits):
        return ((words >> np.uint64(lsb)) & np.uint64((1 << bits) - 1)).astype(np.int64)

    rgb = np.stack([field(k * colour, colour) for k in (2, 1, 0)], axis=1)
    x, y = field(3 * colour, place), field(3 * colour + place, place)
    return Pixels(x, y, rgb, field(3 * colour + 2 * place, 1).astype(bool))


def body_offset(path: Path) -> int:
    """Where the records of a span file start: after its second line."""
    with open(path, "rb") as file:
        file.readline()
        file.readline()
        return file.tell()


def simulate_jobs(
    jobs: list[Job], config: Config = DEFAULT, bench: Bench | None = None,
    waves: Path | None = None, power_up: int | None = None,
    progress: Callable[[str], None] = silent,
):  # fmt: skip
    """Run `jobs` one after the other in one simulation. Returns a list of SimResult.

    waves: file for a VCD, if `bench` was built with a trace. power_up: seed of random contents of
    all registers at power-up, in place of zeros. progress: called with what a phase does, before
    it. Raises BuildError, SimulationError.
    """
    bench = bench or Bench("frame_bench", config)
    begin = time.perf_counter()
    bench.make(progress)
    build_s = time.perf_counter() - begin
    progress("simulating")
    (BUILD / "run").mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(dir=BUILD / "run"))
    try:
        described = []
        for k, job in enumerate(jobs):
            path = folder / f"{k}.spans"
            if job.spans_path is None:
                write_spans(path, job.frame, config)
            else:
                path.symlink_to(job.spans_path.resolve())
            described.append({
                "job": k, "skip": body_offset(path), "spans": len(job.frame.spans),
                "pixels": int(np.maximum(job.frame.spans["length"], 1).sum()),
                "idle": job.idle, "stall": job.stall, "seed": job.seed,
                "stop_after": job.stop_after, "reset_first": job.reset_first,
                "writes": writes(job.frame, config) if job.writes is None else job.writes,
            })  # fmt: skip
        (folder / "jobs.json").write_text(json.dumps(described))
        try:
            arguments = ["--trace", str(waves.resolve())] if waves else []
            if power_up is not None:
                arguments += ["+verilator+rand+reset+2", f"+verilator+seed+{power_up}"]
            bench.run(
                "phong75.sim.frame.frame_jobs", folder, test_args=arguments,
                extra_env={environment.JOBS: str(folder)},
            )  # fmt: skip
            said = json.loads((folder / "counters.json").read_text())
        except (OSError, RuntimeError, SystemExit) as error:
            log = folder / "sim.log"
            tail = log.read_text()[-3000:] if log.is_file() else ""
            raise SimulationError(f"the simulation failed ({error}):\n{tail}") from error
        results = []
        for k, c in enumerate(said):
            results.append(
                SimResult(
                    read_pixels(folder / f"{k}.pixels", config), bool(c["complete"]), c["cycles"],
                    c["latency"], c["stall_cycles"], c["illegal_spans"],
                    c.get("extra_pixels", 0), build_s, c["seconds"], c["zero_normals"],
                    c["unsupported"],
                )
            )  # fmt: skip
        return results
    finally:
        if environment.KEEP not in os.environ:
            shutil.rmtree(folder, ignore_errors=True)


def simulate(
    spans_path, frame: Frame, config: Config = DEFAULT,
    progress: Callable[[str], None] = silent,
) -> SimResult:  # fmt: skip
    """Run one frame whose span file is `spans_path`; the rest as for `simulate_jobs`."""
    return simulate_jobs([Job(frame, Path(spans_path))], config, progress=progress)[0]
