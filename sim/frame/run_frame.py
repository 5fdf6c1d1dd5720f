# SPDX-License-Identifier: MIT
"""Runs whole frames through the RTL: builds the testbench, starts the simulator, reads results."""

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
from phong75.model.frame import Frame, with_lights
from phong75.model.registers import writes
from phong75.model.spans import turns, write_spans
from phong75.model.twin import Pixels
from phong75.model.twin.core.span_walker import pixel_count
from phong75.sim import environment
from phong75.sim.build import Bench, silent
from phong75.sim.design import BUILD


class SimulationError(Exception):
    """The simulation failed; the message contains the end of its log."""


@dataclass(repr=False)
class SimResult:
    """Result of one simulated frame; sim/frame/frame_bench.v counts the cycles.

    pixels: the pixels, in the order of the stream.
    complete: whether all expected pixels were taken.
    cycles: clock cycles from the first accepted span to the last pixel taken.
    latency_cycles: clock cycles from the first accepted span to the first pixel offered.
    stall_cycles: cycles after the first pixel in which no pixel was taken, beyond those that the
        turns of each pixel's lights take.
    illegal_spans, zero_normals: how often the pipeline raised these flags.
    extra_pixels: number of pixels after the last expected one.
    build_s, simulate_s: wall-clock time, seconds.
    unsupported: number of spans and register writes that need a feature that this build leaves out.
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

    def __repr__(self) -> str:
        return f"SimResult({self.pixels}, cycles: {self.cycles}, complete: {self.complete})"


@dataclass
class SimJob:
    """A frame to simulate, and the conditions (see `FrameTB.run`).

    spans_path: the frame's span file, None to write one. reset_first: reset before the frame.
    writes: register writes (address, word), None for those that the frame needs.
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
    """Read a pixel file of the testbench: 64-bit words {last, y, x, red, green, blue}."""
    words = np.fromfile(path, dtype="<u8")
    colour, place = config.colour_bits, config.coordinate_bits

    def field(lsb, bits):
        return ((words >> np.uint64(lsb)) & np.uint64((1 << bits) - 1)).astype(np.int64)

    rgb = np.stack([field(k * colour, colour) for k in (2, 1, 0)], axis=1)
    x, y = field(3 * colour, place), field(3 * colour + place, place)
    return Pixels(x, y, rgb, field(3 * colour + 2 * place, 1).astype(bool))


def body_offset(path: Path) -> int:
    """Offset in bytes of the records of a span file, which start after its second line."""
    with open(path, "rb") as file:
        file.readline()
        file.readline()
        return file.tell()


def simulate_jobs(
    jobs: list[SimJob], config: Config = DEFAULT, bench: Bench | None = None,
    waves: Path | None = None, power_up: int | None = None,
    progress: Callable[[str], None] = silent,
):  # fmt: skip
    """Simulate `jobs` one after the other. Returns a list of SimResult.

    bench: the testbench, by default frame_bench in `config`, with the lights of each job's frame
    (see `with_lights`): a process for each configuration. waves: VCD file to write; `bench` must be
    built with a trace. power_up: seed of random register contents at power-up, None for zeros.
    progress: called with what a phase does, before it. Raises BuildError, SimulationError,
    InputError.
    """
    if bench:
        return _simulate(jobs, config, bench, waves, power_up, progress)
    groups: dict[Config, list[int]] = {}
    for k, job in enumerate(jobs):
        groups.setdefault(with_lights(config, job.frame), []).append(k)
    results = {}
    for built, members in groups.items():
        some = [jobs[k] for k in members]
        done = _simulate(some, built, Bench("frame_bench", built), waves, power_up, progress)
        results |= dict(zip(members, done, strict=True))
    return [results[k] for k in range(len(jobs))]


def _simulate(
    jobs: list[SimJob], config: Config, bench: Bench, waves: Path | None, power_up: int | None,
    progress: Callable[[str], None],
) -> list[SimResult]:  # fmt: skip
    """Simulate `jobs` in one process, in `bench`, which is built for `config`."""
    begin = time.perf_counter()
    bench.make(progress)
    build_s = time.perf_counter() - begin
    progress("simulating")
    (BUILD / "run").mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(dir=BUILD / "run"))
    try:
        descriptions = []
        for k, job in enumerate(jobs):
            path = folder / f"{k}.spans"
            if job.spans_path is None:
                write_spans(path, job.frame, config)
            else:
                path.symlink_to(job.spans_path.resolve())
            descriptions.append({
                "job": k, "skip": body_offset(path),
                "spans": len(job.frame.spans) * turns(job.frame, config),
                "pixels": pixel_count(job.frame.spans),
                "idle": job.idle, "stall": job.stall, "seed": job.seed,
                "stop_after": job.stop_after, "reset_first": job.reset_first,
                "writes": writes(job.frame, config) if job.writes is None else job.writes,
            })  # fmt: skip
        (folder / "jobs.json").write_text(json.dumps(descriptions))
        try:
            arguments = ["--trace", str(waves.resolve())] if waves else []
            if power_up is not None:
                arguments += ["+verilator+rand+reset+2", f"+verilator+seed+{power_up}"]
            bench.run(
                "phong75.sim.frame.frame_jobs", folder, test_args=arguments,
                extra_env={environment.JOBS: str(folder)},
            )  # fmt: skip
            counters = json.loads((folder / "counters.json").read_text())
        except (OSError, RuntimeError, SystemExit) as error:
            log = folder / "sim.log"
            tail = log.read_text()[-3000:] if log.is_file() else ""
            raise SimulationError(f"the simulation failed ({error}):\n{tail}") from error
        results = []
        for k, c in enumerate(counters):
            pixels = read_pixels(folder / f"{k}.pixels", config)
            waits = (turns(jobs[k].frame, config) - 1) * max(len(pixels) - 1, 0)
            results.append(
                SimResult(
                    pixels, bool(c["complete"]), c["cycles"],
                    c["latency"], c["stall_cycles"] - waits, c["illegal_spans"],
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
    """Simulate one frame whose span file is `spans_path`. Raises BuildError, SimulationError."""
    return simulate_jobs([SimJob(frame, Path(spans_path))], config, progress=progress)[0]
