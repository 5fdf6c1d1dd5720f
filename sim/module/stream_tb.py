# SPDX-License-Identifier: MIT
"""cocotb testbench pieces for AXI4-Stream: clock, reset, source, sink and scoreboard.

Python is called twice a clock: inputs change at the falling edge, and everything is read when it
has settled, as the rising edge after it will see it. For short runs; whole frames go through
sim/frame_tb.py.
"""

from __future__ import annotations

import random
from collections import deque
from collections.abc import Iterator

from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly

#: When a source has nothing to offer, or a sink takes nothing.
REGIMES = ("never", "sometimes", "mostly", "bursts")


def pauses(regime: str, seed) -> Iterator[bool]:
    """Whether to pause, clock by clock."""
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
    """Owns clock and reset; `step` is one clock: drive, settle, observe."""

    def __init__(self, dut):
        self.dut = dut
        self.clock = 0
        self._driven: dict[str, int] = {}
        self.drive(reset=1)
        Clock(dut.clk, 10, unit="ns", impl="gpi").start()

    def drive(self, **values):
        """Set inputs, those that change only."""
        for name, value in values.items():
            if self._driven.get(name) != value:
                self._driven[name] = value
                getattr(self.dut, name).value = int(value)

    def read(self, name: str) -> int:
        """A settled output."""
        return int(getattr(self.dut, name).value)

    async def edge(self):
        """To where inputs may change."""
        await FallingEdge(self.dut.clk)
        self.clock += 1

    async def settle(self):
        """To where everything may be read."""
        await ReadOnly()

    async def reset(self, clocks: int = 2):
        """Hold reset for `clocks` clocks."""
        await self.edge()
        self.drive(reset=1)
        for _ in range(clocks):
            await self.edge()
        self.drive(reset=0)


class Source:
    """Offers words on <prefix>_tvalid/_tready/_tdata/_tlast; an offered word stays until taken."""

    def __init__(self, tb: Clocked, prefix: str):
        self.tb, self.prefix = tb, prefix
        self.queue: deque[tuple[int, int]] = deque()
        self.idle = pauses("never", 0)
        self.offered = False
        self.taken_at: list[int] = []  # clock of each word
        tb.drive(**{f"{prefix}_tvalid": 0})

    def drop(self):
        """Forget all words: the design is being reset."""
        self.queue.clear()
        self.offered = False
        self.taken_at.clear()

    def drive(self):
        """Before the edge: offer the next word, or pause."""
        if not self.offered and self.queue and not next(self.idle):
            self.offered = True
            data, last = self.queue[0]
            self.tb.drive(**{f"{self.prefix}_tdata": data, f"{self.prefix}_tlast": last})
        self.tb.drive(**{f"{self.prefix}_tvalid": self.offered})

    def observe(self):
        """After settling: is the word taken?"""
        if self.offered and self.tb.read(f"{self.prefix}_tready"):
            self.queue.popleft()
            self.offered = False
            self.taken_at.append(self.tb.clock)


class Sink:
    """Takes words, compares them with those expected, and watches that a waiting word is still."""

    def __init__(self, tb: Clocked, prefix: str, module: str):
        self.tb, self.prefix, self.module = tb, prefix, module
        self.expected: deque[tuple[int, int]] = deque()
        self.stall = pauses("never", 0)
        self.taken_at: list[int] = []
        self.waiting: tuple[int, int] | None = None
        self.note = ""

    def drop(self):
        """Forget what was expected: the design is being reset."""
        self.expected.clear()
        self.taken_at.clear()
        self.waiting = None

    def drive(self):
        """Before the edge: ready or not."""
        self.ready = not next(self.stall)
        self.tb.drive(**{f"{self.prefix}_tready": self.ready})

    def observe(self):
        """After settling: take a word, compare it."""
        where = f"module {self.module}, clock {self.tb.clock}, word {len(self.taken_at)}"
        valid = self.tb.read(f"{self.prefix}_tvalid")
        assert valid or not self.waiting, f"{where}: tvalid went away unanswered; {self.note}"
        if not valid:
            return
        word = self.tb.read(f"{self.prefix}_tdata"), self.tb.read(f"{self.prefix}_tlast")
        assert self.waiting in (None, word), (
            f"{where}: a waiting word changed from {_show(self.waiting)} to {_show(word)}; "
            f"{self.note}"
        )
        self.waiting = word
        if self.ready:
            assert self.expected, f"{where}: {_show(word)} is left over; {self.note}"
            want = self.expected.popleft()
            assert word == want, f"{where}: expected {_show(want)}, got {_show(word)}; {self.note}"
            self.taken_at.append(self.tb.clock)
            self.waiting = None


def _show(word) -> str:
    return f"{word[0]:#x}{' last' if word[1] else ''}"


class PipelineTB(Clocked):
    """phong_pipeline between a source of spans and a sink of pixels."""

    def __init__(self, dut):
        super().__init__(dut)
        self.drive(write_enable=0)
        self.source = Source(self, "s_axis")
        self.sink = Sink(self, "m_axis", "phong_pipeline")
        self.illegal_at: list[int] = []
        self.zero_at: list[int] = []

    async def reset(self, clocks: int = 2):
        """Hold reset; nothing is offered or expected any more."""
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
        """Write (address, word) pairs through the register port, one a clock."""
        for address, word in writes:
            await self.edge()
            self.drive(write_enable=1, write_address=address, write_word=word)
        await self.edge()
        self.drive(write_enable=0)
        await self.edge()

    async def step(self):
        """One clock."""
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
        """Run until all that is expected came, and `after` clocks more: nothing is left over."""
        quiet, last = 0, len(self.sink.taken_at)
        while self.source.queue or self.sink.expected:
            await self.step()
            quiet = 0 if len(self.sink.taken_at) > last else quiet + 1
            last = len(self.sink.taken_at)
            assert quiet < patience, (
                f"module phong_pipeline, clock {self.clock}: no pixel for {quiet} clocks, "
                f"{len(self.source.queue)} spans and {len(self.sink.expected)} pixels missing; "
                f"{self.sink.note}"
            )
        for _ in range(after):
            await self.step()
