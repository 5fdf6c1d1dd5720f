# SPDX-License-Identifier: MIT
"""The cocotb tests of every RTL module, and whole frames through the RTL."""

from __future__ import annotations

import contextlib

import numpy as np
import pytest

from phong75.model.config import DEFAULT as C
from phong75.model.config import TECHNIQUES
from phong75.model.spans import illegal_spans
from phong75.model.studies.random_frames import random_frame
from phong75.model.twin import render
from phong75.sim.build import Bench
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from phong75.sim.results import read_results
from tests.modules.benches import NAMES, ModuleBench, module_bench

SEED = 75


def run(module: ModuleBench, folder, bench: Bench | None = None) -> None:
    """Run the cocotb tests of `module`, in `bench` if given; fails the pytest test if one fails."""
    # The small modules are many in one program, which takes longer to optimize than it then saves.
    many = module.name == "primitives"
    bench = bench or Bench(module.top, module.config, module.sources, quick=many)
    with contextlib.suppress(SystemExit):  # inside pytest, cocotb's runner exits if a test fails
        bench.run(
            module.tests, folder, seed=SEED, test_filter=module.test_filter,
            extra_env=module.environment(folder, SEED),
        )  # fmt: skip
    if failures := read_results(folder).failures:
        pytest.fail("\n".join(failures), pytrace=False)


@pytest.mark.parametrize("name", NAMES)
def test_module(name, tmp_path):
    run(module_bench(name), tmp_path)


def same_pixels(got, frame, config) -> bool:
    want = render(frame, config)
    pairs = ((got.x, want.x), (got.y, want.y), (got.rgb, want.rgb), (got.last, want.last))
    return all(np.array_equal(a, b) for a, b in pairs)


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_whole_frames_in_all_regimes(technique):
    config = TECHNIQUES[technique]
    frame = random_frame(SEED, 1000, 40, config=config)
    pixel = random_frame(SEED, 1, 1, config=config)
    if technique != "flat":
        frame.spans["step"][::50, 1] = C.normal.max  # most of these leave the format
    illegal = int(illegal_spans(frame, config).sum())
    pixels = int(frame.spans["length"].sum())
    chances = (0, 64, 200)
    jobs = [SimJob(pixel)]
    jobs += [SimJob(frame, idle=i, stall=s, seed=SEED + i + s) for i in chances for s in chances]
    # Stopped in the middle of a frame, with and without waiting pixels; then a whole frame.
    for clocks, stall in ((700, 0), (3001, 200), (90, 255)):
        jobs += [SimJob(frame, stop_after=clocks, stall=stall), SimJob(frame, reset_first=True)]
    results = simulate_jobs(jobs, config)
    overhead = results[0].cycles - 1
    for job, result in zip(jobs, results, strict=True):
        what = f"idle {job.idle}, stall {job.stall}, {len(job.frame.spans)} spans, seed {SEED}"
        if job.stop_after:
            assert not result.complete, what
            continue
        assert result.complete and result.extra_pixels == 0, what
        if not same_pixels(result.pixels, job.frame, config):
            pytest.fail(f"module phong_pipeline, whole frame: pixels differ; {what}")
        assert result.latency_cycles == results[0].latency_cycles, what
        assert result.illegal_spans == (illegal if job.frame is frame else 0), what
        count = pixels if job.frame is frame else 1
        if job.idle == job.stall == 0:
            assert (result.cycles, result.stall_cycles) == (count + overhead, 0), what
        else:
            assert result.cycles > count + overhead and result.stall_cycles > 0, what
            assert result.cycles == count + overhead + result.stall_cycles or job.stall, what
