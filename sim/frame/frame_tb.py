# SPDX-License-Identifier: MIT
"""cocotb testbench class of sim/frame/frame_bench.v: clock, reset, register writes and jobs."""

from __future__ import annotations

from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge

#: Outputs of the testbench that `run` reads at the end of a job.
COUNTERS = (
    "complete", "cycles", "latency", "stall_cycles", "pixel_count", "illegal_spans",
    "zero_normals", "unsupported",
)  # fmt: skip


class FrameTB:
    """Runs frames through the pipeline.

    frame_bench.v itself reads the spans from files and writes the pixels to files. Python only
    starts a job and reads its counters, so that the simulation runs at the simulator's full speed.
    """

    def __init__(self, dut):
        self.dut = dut
        self.unsupported = 0  # count of the preceding jobs
        for name in ("write_enable", "start", "stop_after", "idle_chance"):
            getattr(dut, name).value = 0
        dut.stall_chance.value = 0
        dut.seed.value = 1
        dut.reset.value = 1
        Clock(dut.clk, 10, unit="ns", impl="gpi").start()

    async def reset(self, clocks: int = 2):
        """Hold reset for `clocks` cycles."""
        await FallingEdge(self.dut.clk)
        self.dut.reset.value = 1
        await ClockCycles(self.dut.clk, clocks)
        await FallingEdge(self.dut.clk)
        self.dut.reset.value = 0

    async def write(self, writes):
        """Write (address, word) pairs through the register port, one per cycle."""
        await FallingEdge(self.dut.clk)
        self.dut.write_enable.value = 1
        for address, word in writes:
            self.dut.write_address.value = address
            self.dut.write_word.value = word
            await FallingEdge(self.dut.clk)
        self.dut.write_enable.value = 0

    async def run(
        self, job: int, skip: int, spans: int, pixels: int,
        idle: int = 0, stall: int = 0, seed: int = 1, stop_after: int = 0,
    ) -> dict:  # fmt: skip
        """Run the span file <job>.spans to its end.

        skip: offset of the first record in the file, bytes. spans, pixels: numbers of spans in the
        file and of pixels to expect. idle, stall: probabilities, in 1/256 per cycle, that no span
        is offered or that no pixel is taken. seed: of the random pauses. stop_after: stop the job
        after this many cycles; 0: run it to its end. Returns COUNTERS and, for a whole job,
        `extra_pixels`: pixels in the 300 cycles after the end.
        """
        dut = self.dut
        dut.job.value, dut.skip.value, dut.spans.value, dut.pixels.value = job, skip, spans, pixels
        dut.idle_chance.value, dut.stall_chance.value = idle, stall
        dut.seed.value, dut.stop_after.value = seed, stop_after
        dut.start.value = 1
        await FallingEdge(dut.running)
        dut.start.value = 0
        counters = {name: int(getattr(dut, name).value) for name in COUNTERS}
        counters["unsupported"] -= self.unsupported
        self.unsupported += counters["unsupported"]
        if not stop_after:
            await ClockCycles(dut.clk, 300)
            counters["extra_pixels"] = int(dut.extra_pixels.value)
        return counters
