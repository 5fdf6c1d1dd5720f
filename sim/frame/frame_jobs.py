# SPDX-License-Identifier: MIT
"""cocotb test that runs the whole-frame jobs written by `sim.frame.run_frame`."""

from __future__ import annotations

import json
import os
import time
from pathlib import Path

import cocotb

from phong75.sim import environment
from phong75.sim.frame.frame_tb import FrameTB


@cocotb.test()
async def frame_jobs(dut):
    """Run the jobs of jobs.json one after the other; write their counters to counters.json."""
    folder = Path(os.environ[environment.JOBS])
    tb = FrameTB(dut)
    await tb.reset()
    results = []
    for job in json.loads((folder / "jobs.json").read_text()):
        if job.pop("reset_first"):
            await tb.reset()
        await tb.write(job.pop("writes"))
        begin = time.perf_counter()
        counters = await tb.run(**job)
        results.append(counters | {"seconds": time.perf_counter() - begin})
    (folder / "counters.json").write_text(json.dumps(results))
