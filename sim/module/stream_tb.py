# SPDX-License-Identifier: MIT
"""cocotb testbench classes for AXI4-Stream: clock, reset, source, sink and scoreboard.

Python runs twice per cycle: it changes inputs at the falling edge, and reads settled values, which
are those at the next rising edge. This is for short runs; sim/frame/frame_tb.py runs whole frames.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Iterator

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly

#: How often a source offers nothing, or a sink takes nothing.
REGIMES = ("never", "sometimes", "mostly", "bursts")


def pauses(regime: str, seed) -> Iterator[bool]:
    """Whether to pause, for each cycle. regime: one of REGIMES."""
    rng = random.Random(f"{regime} {seed}")
    if regime == "bursts":
        pause = False
        while True:
            yield from [pause] * rng.randrange(1, 160)
            pause = not pause
    chance = {"never": 0.0, "sometimes": 0.25, "mostly": 0.8}[regime]
    while True:
        yield rng.random() < chance


class Clocked:
    """Owns clock and reset. A subclass's `step` is one cycle: drive, settle, observe."""

    def __init__(self, dut):
        self.dut = dut
        self.clock = 0
        self._driven: dict[str, int] = {}
        self.drive(reset=1)
        Clock(dut.clk, 10, unit="ns", impl="gpi").start()

    def drive(self, **values):
        """Set input ports; ports that already have the value are skipped."""
        for name, value in values.items():
            if self._driven.get(name) != value:
                self._driven[name] = value
                getattr(self.dut, name).value = int(value)

    def read(self, name: str) -> int:
        """The value of a settled output."""
        return int(getattr(self.dut, name).value)

    async def edge(self):
        """Wait for the falling edge, after which inputs may change."""
        await FallingEdge(self.dut.clk)
        self.clock += 1

    async def settle(self):
        """Wait until all signals have settled, so that they may be read."""
        await ReadOnly()

    async def reset(self, clocks: int = 2):
        """Hold reset for `clocks` cycles."""
        await self.edge()
        self.drive(reset=1)
        for _ in range(clocks):
            await self.edge()
        self.drive(reset=0)


class Source:
    """Offers words on <prefix>_tvalid/_tready/_tdata/_tlast; an offered word stays until taken.

    queue: (tdata, tlast) of the words to offer. idle: pauses. taken_at: cycle in which each word
    was taken.
    """

    def __init__(self, tb: Clocked, prefix: str):
        self.tb, self.prefix = tb, prefix
        self.queue: deque[tuple[int, int]] = deque()
        self.idle = pauses("never", 0)
        self.offered = False
        self.taken_at: list[int] = []
        tb.drive(**{f"{prefix}_tvalid": 0})

    def drop(self):
        """Drop all words, because the design is reset."""
        self.queue.clear()
        self.offered = False
        self.taken_at.clear()

    def drive(self):
        """Offer the next word, or pause."""
        if not self.offered and self.queue and not next(self.idle):
            self.offered = True
            data, last = self.queue[0]
            self.tb.drive(**{f"{self.prefix}_tdata": data, f"{self.prefix}_tlast": last})
        self.tb.drive(**{f"{self.prefix}_tvalid": self.offered})

    def observe(self):
        """Check whether the offered word is taken."""
        if self.offered and self.tb.read(f"{self.prefix}_tready"):
            self.queue.popleft()
            self.offered = False
            self.taken_at.append(self.tb.clock)


class Sink:
    """Takes words and compares them with the expected ones; a waiting word must not change.

    expected: (tdata, tlast) of the words to come. stall: pauses. taken_at: cycle in which each word
    was taken. note: appended to the message of a failure.
    """

    def __init__(self, tb: Clocked, prefix: str, module: str):
        self.tb, self.prefix, self.module = tb, prefix, module
        self.expected: deque[tuple[int, int]] = deque()
        self.stall = pauses("never", 0)
        self.taken_at: list[int] = []
        self.waiting: tuple[int, int] | None = None
        self.note = ""

    def drop(self):
        """Drop all expected words, because the design is reset."""
        self.expected.clear()
        self.taken_at.clear()
        self.waiting = None

    def drive(self):
        """Set or clear tready."""
        self.ready = not next(self.stall)
        self.tb.drive(**{f"{self.prefix}_tready": self.ready})

    def observe(self):
        """Take a word and compare it."""
        where = f"module {self.module}, clock {self.tb.clock}, word {len(self.taken_at)}"
        valid = self.tb.read(f"{self.prefix}_tvalid")
        assert valid or not self.waiting, f"{where}: tvalid fell before tready; {self.note}"
        if not valid:
            return
        word = self.tb.read(f"{self.prefix}_tdata"), self.tb.read(f"{self.prefix}_tlast")
        assert self.waiting in (None, word), (
            f"{where}: a waiting word changed from {_show(self.waiting)} to {_show(word)}; "
            f"{self.note}"
        )
        self.waiting = word
        if self.ready:
            assert self.expected, f"{where}: unexpected word {_show(word)}; {self.note}"
            want = self.expected.popleft()
            assert word == want, f"{where}: expected {_show(want)}, got {_show(word)}; {self.note}"
            self.taken_at.append(self.tb.clock)
            self.waiting = None


def _show(word) -> str:
    return f"{word[0]:#x}{' last' if word[1] else ''}"


class PipelineTB(Clocked):
    """phong_pipeline with a source of spans and a sink of pixels.

    illegal_at, zero_at: cycles in which illegal_span and zero_normal were 1.
    """

    def __init__(self, dut):
        super().__init__(dut)
        self.drive(write_enable=0)
        self.source = Source(self, "s_axis")
        self.sink = Sink(self, "m_axis", "phong_pipeline")
        self.illegal_at: list[int] = []
        self.zero_at: list[int] = []

    async def reset(self, clocks: int = 2):
        """Hold reset for `clocks` cycles; drops all spans and expected pixels."""
        self.source.drop()
        self.sink.drop()
        self.illegal_at.clear()
        self.zero_at.clear()
        await self.edge()
        self.drive(s_axis_tvalid=0, reset=1)
        for _ in range(clocks):
            await self.edge()
        self.drive(reset=0)

    async def write(self, writes):
        """Write (address, word) pairs through the register port, one per cycle."""
        for address, word in writes:
            await self.edge()
            self.drive(write_enable=1, write_address=address, write_word=word)
        await self.edge()
        self.drive(write_enable=0)
        await self.edge()

    async def step(self):
        """Run one cycle."""
        await self.edge()
        self.source.drive()
        self.sink.drive()
        await self.settle()
        self.source.observe()
        self.sink.observe()
        if self.read("illegal_span"):
            self.illegal_at.append(self.clock)
        if self.read("zero_normal"):
            self.zero_at.append(self.clock)

    async def drain(self, patience: int = 2000, after: int = 300):
        """Run until all expected pixels came, then `after` more cycles, in which none may come.

        patience: largest number of cycles without a pixel.
        """
        quiet, last = 0, len(self.sink.taken_at)
        while self.source.queue or self.sink.expected:
            await self.step()
            quiet = 0 if len(self.sink.taken_at) > last else quiet + 1
            last = len(self.sink.taken_at)
            assert quiet < patience, (
                f"module phong_pipeline, clock {self.clock}: no pixel for {quiet} cycles, "
                f"{len(self.source.queue)} spans and {len(self.sink.expected)} pixels missing; "
                f"{self.sink.note}"
            )
        for _ in range(after):
            await self.step()
