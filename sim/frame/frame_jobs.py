"""The cocotb test of whole-frame runs: does the jobs that `sim.run_frame` left in a file."""

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
    """Every job of jobs.json in turn; what the counters said goes to counters.json."""
    folder = Path(os.environ[environment.JOBS])
    tb = FrameTB(dut)
    await tb.reset()
    said = []
    for job in json.loads((folder / "jobs.json").read_text()):
        if job.pop("reset_first"):
            await tb.reset()
        await tb.write(job.pop("writes"))
        begin = time.perf_counter()
        counters = await tb.run(**job)
        said.append(counters | {"seconds": time.perf_counter() - begin})
    (folder / "counters.json").write_text(json.dumps(said))
