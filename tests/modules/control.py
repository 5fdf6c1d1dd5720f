# SPDX-License-Identifier: MIT
"""cocotb tests of span_walker and pixel_fifo in sim/module/control_bench.v.

tests/test_modules.py runs them.
"""

from __future__ import annotations

import os
import random
from collections import deque
from dataclasses import dataclass

import cocotb

from phong75.sim import environment
from phong75.sim.module.stream_tb import REGIMES, Clocked, pauses

SEED = int(os.environ.get(environment.SEED, "75"))
COORDINATE_BITS, MATERIAL_BITS, COLOUR_BITS = 4, 2, 3  # parameters of the bench
SIZE = 1 << COORDINATE_BITS
NAMED = [cocotb.Param(regime, regime) for regime in REGIMES]


# -- span_walker ----------------------------------------------------------------------------------


@dataclass
class Span:
    """A span. overflow_from: first pixel in which the interpolators report an overflow."""

    x: int
    y: int
    length: int
    material: int
    last: bool
    overflow_from: int = 1000

    @property
    def walked(self) -> int:
        """Number of pixels of the span; an empty span has one."""
        return max(self.length, 1)

    @property
    def illegal(self) -> bool:
        """Whether the span must be flagged as illegal."""
        return (
            self.length == 0
            or self.x + self.length > SIZE
            or self.overflow_from < self.walked
        )  # fmt: skip


class WalkerTB(Clocked):
    """span_walker with a source of spans, a source of credit, and a model of the interpolators.

    at: (span, pixel) that the interpolators hold, None if they hold no pixel. expected: (span,
    pixel) to come. flag: whether illegal_span must be 1 in the present cycle. shown_at: cycles in
    which a pixel was shown.
    """

    def __init__(self, dut, note: str):
        super().__init__(dut)
        self.note = note
        self.drive(span_valid=0, credit=0, overflow=0)
        self.spans: deque[Span] = deque()
        self.offered = False
        self.idle, self.stall = pauses("never", 0), pauses("never", 0)
        self.at: tuple[Span, int] | None = None
        self.expected: deque[tuple[Span, int]] = deque()
        self.flag = False
        self.shown_at: list[int] = []

    def send(self, spans):
        """Offer `spans` and expect their pixels."""
        self.spans.extend(spans)
        self.expected.extend((span, k) for span in spans for k in range(span.walked))

    def forget(self):
        """Drop all spans and expectations, because the design is reset."""
        self.spans.clear()
        self.expected.clear()
        self.offered, self.at, self.flag = False, None, False
        self.drive(span_valid=0)

    async def step(self):
        """Run one cycle."""
        await self.edge()
        if not self.offered and self.spans and not next(self.idle):
            self.offered = True
            s = self.spans[0]
            self.drive(
                span_x=s.x, span_y=s.y, span_length=s.length, span_material=s.material,
                span_last=s.last,
            )  # fmt: skip
        credit = not next(self.stall)
        over = self.at is not None and self.at[1] >= self.at[0].overflow_from
        self.drive(span_valid=self.offered, credit=credit, overflow=over)
        await self.settle()
        self._observe(credit)

    def _observe(self, credit):
        where = f"module span_walker, clock {self.clock}, {self.note}"
        read = self.read
        assert read("illegal_span") == self.flag, (
            f"{where}: illegal_span expected {self.flag}, got {read('illegal_span')}"
        )
        self.flag = False
        accepted = self.offered and read("span_ready")
        moves, loads = read("advance"), read("load")
        assert not accepted or (moves and loads), f"{where}: a span accepted but not loaded"
        shown = read("pixel_valid")
        assert credit or not shown, f"{where}: a pixel without credit"
        if shown:
            assert self.expected, f"{where}: a pixel too many"
            span, k = want = self.expected.popleft()
            assert self.at == want, f"{where}: normal of {self.at}, expected {want}"
            got = tuple(read(f"pixel_{n}") for n in ("x", "y", "material", "last"))
            at_end = k == span.walked - 1
            pixel = ((span.x + k) % SIZE, span.y, span.material, int(span.last and at_end))
            assert got == pixel, f"{where}: pixel {k} of {span}: expected {pixel}, got {got}"
            self.shown_at.append(self.clock)
            self.flag = at_end and span.illegal
        if accepted:
            self.at = self.spans.popleft(), 0
            self.offered = False
        elif moves and loads:  # loads without a valid span: no pixel may follow
            self.at = None
        elif moves and self.at:
            self.at = self.at[0], self.at[1] + 1

    async def drain(self):
        """Run until all expected pixels came, and some more cycles."""
        quiet = 0
        while self.expected or self.spans:
            before = len(self.shown_at)
            await self.step()
            quiet = 0 if len(self.shown_at) > before else quiet + 1
            assert quiet < 500, f"module span_walker, {self.note}: {quiet} cycles without a pixel"
        for _ in range(5):
            await self.step()


def _random_spans(rng, n: int) -> list[Span]:
    return [
        Span(
            rng.randrange(SIZE), rng.randrange(SIZE), rng.choice([0, 1, 1, 2, 3, 9, 16, 17, 31]),
            rng.randrange(1 << MATERIAL_BITS), rng.random() < 0.2,
            rng.choice([1, 2, 4, 1000, 1000, 1000]),
        )
        for _ in range(n)
    ]  # fmt: skip


@cocotb.test()
async def walker_exhaustive(dut):
    """Every start and every length: one pixel per cycle, no bubble between spans."""
    tb = WalkerTB(dut, "every x and length")
    await tb.reset()
    rng = random.Random(SEED)
    spans = [Span(x, rng.randrange(SIZE), length, rng.randrange(4), False)
             for x in range(SIZE) for length in range(2 * SIZE)]  # fmt: skip
    spans[-1].last = True
    tb.send(spans)
    await tb.drain()
    n = sum(span.walked for span in spans)
    assert tb.shown_at == list(range(tb.shown_at[0], tb.shown_at[0] + n)), "a bubble"


@cocotb.test()
@cocotb.parametrize(idle=NAMED, stall=NAMED)
async def walker_in_all_regimes(dut, idle, stall):
    """Under all pauses of spans and credit every pixel is shown once, with its normal and flag."""
    tb = WalkerTB(dut, f"idle {idle}, credit withheld {stall}, seed {SEED}")
    await tb.reset()
    tb.idle, tb.stall = pauses(idle, SEED), pauses(stall, SEED + 1)
    tb.send(_random_spans(random.Random(f"{SEED} {idle} {stall}"), 20))
    await tb.drain()


@cocotb.test()
async def walker_latency(dut):
    """The first pixel of a span is shown in the cycle after the span is accepted."""
    tb = WalkerTB(dut, "one span")
    await tb.reset()
    tb.send([Span(3, 4, 2, 1, True)])
    await tb.step()
    accepted = tb.clock
    await tb.drain()
    assert tb.shown_at == [accepted + 1, accepted + 2], f"accepted {accepted}, {tb.shown_at}"


@cocotb.test()
async def walker_reset(dut):
    """A reset drops the current span without a flag; the next span is complete."""
    tb = WalkerTB(dut, f"reset, seed {SEED}")
    await tb.reset()
    rng = random.Random(SEED)
    for clocks in range(1, 12):
        tb.send([Span(0, 0, 5, 0, False, 1), Span(15, 1, 4, 1, True)])
        for _ in range(clocks):
            await tb.step()
        await tb.edge()
        tb.forget()
        tb.drive(reset=1)
        await tb.edge()
        tb.drive(reset=0)
        tb.at = None
        for _ in range(3):
            await tb.step()
        tb.send(_random_spans(rng, 3))
        await tb.drain()


# -- pixel_fifo -----------------------------------------------------------------------------------


class FifoTB(Clocked):
    """The pixel_fifo `which` of the bench; the pipeline beside the FIFO is modelled as a queue.

    in_flight: {cycle of arrival: colour}. expected: (data, last) to come. waiting: the word that
    the FIFO offers and that has not been taken. sent_at, taken_at: cycles of the pixels.
    """

    def __init__(self, dut, which: str, note: str):
        super().__init__(dut)
        self.which, self.note = which, note
        self.drive(fit_pixel_valid=0, over_pixel_valid=0, fit_out_ready=0, over_out_ready=0)
        self.rng = random.Random(f"{SEED} {note}")
        self.latency = 0
        self.idle, self.stall = pauses("never", 0), pauses("never", 0)
        self.to_send = 0
        self.forget()

    async def start(self):
        """Reset, and read the latency."""
        await self.reset()
        await self.settle()
        self.latency = self.read(f"{self.which}_latency")

    def forget(self):
        """Drop all pixels and expectations, because the design is reset."""
        self.in_flight: dict[int, tuple] = {}
        self.expected: deque[tuple[int, int]] = deque()
        self.waiting: tuple[int, int] | None = None
        self.sent_at: list[int] = []
        self.taken_at: list[int] = []

    async def step(self):
        """Run one cycle."""
        await self.edge()
        rng, which = self.rng, self.which
        x, y, last = rng.randrange(SIZE), rng.randrange(SIZE), rng.randrange(2)
        colour = tuple(rng.randrange(1 << COLOUR_BITS) for _ in range(3))
        arriving = self.in_flight.pop(self.clock, None)
        shown = arriving or tuple(rng.randrange(1 << COLOUR_BITS) for _ in range(3))
        ready = not next(self.stall)
        # `credit` is a register: its present value is the one at the next rising edge.
        send = bool(self.to_send and not next(self.idle) and self.read(f"{which}_credit"))
        self.drive(place_x=x, place_y=y, place_last=last)
        self.drive(**{
            f"{which}_pixel_valid": send, f"{which}_out_ready": ready,
            **{f"{which}_{n}": c for n, c in zip(("red", "green", "blue"), shown, strict=True)},
        })  # fmt: skip
        if send:
            self.to_send -= 1
            self.sent_at.append(self.clock)
            self.in_flight[self.clock + self.latency] = colour
            data = y << COORDINATE_BITS | x
            for code in colour:
                data = data << COLOUR_BITS | code
            self.expected.append((data, last))
        await self.settle()
        self._observe(ready)

    def _observe(self, ready):
        where = f"module pixel_fifo ({self.which}), clock {self.clock}, {self.note}"
        valid = self.read(f"{self.which}_out_valid")
        assert valid or not self.waiting, f"{where}: a waiting pixel disappeared"
        if not valid:
            return
        word = self.read(f"{self.which}_out_data"), self.read(f"{self.which}_out_last")
        assert self.waiting in (None, word), f"{where}: {self.waiting} became {word}"
        assert self.expected, f"{where}: unexpected pixel {word}"
        assert word == self.expected[0], f"{where}: expected {self.expected[0]}, got {word}"
        self.waiting = word
        if ready:
            self.expected.popleft()
            self.waiting = None
            self.taken_at.append(self.clock)

    async def drain(self):
        """Run until all expected pixels came, and some more cycles."""
        quiet = 0
        while self.to_send or self.expected:
            before = len(self.sent_at) + len(self.taken_at)
            await self.step()
            quiet = 0 if len(self.sent_at) + len(self.taken_at) > before else quiet + 1
            assert quiet < 500, f"module pixel_fifo ({self.which}), {self.note}: stuck"
        for _ in range(40):
            await self.step()


WHICH = [cocotb.Param(which, which) for which in ("fit", "over")]


@cocotb.test()
@cocotb.parametrize(which=WHICH, idle=NAMED, stall=NAMED)
async def fifo_in_all_regimes(dut, which, idle, stall):
    """Under all pauses at both ends every pixel leaves once, in order, with its own colour."""
    tb = FifoTB(dut, which, f"idle {idle}, stall {stall}, seed {SEED}")
    await tb.start()
    tb.idle, tb.stall = pauses(idle, SEED), pauses(stall, SEED + 1)
    tb.to_send = 60
    await tb.drain()


@cocotb.test()
@cocotb.parametrize(which=WHICH)
async def fifo_throughput(dut, which):
    """One pixel per cycle passes, LATENCY + 2 cycles after it left the interpolators."""
    tb = FifoTB(dut, which, f"full speed, seed {SEED}")
    await tb.start()
    tb.to_send = 200
    await tb.drain()
    sent, taken = tb.sent_at, tb.taken_at
    assert sent == list(range(sent[0], sent[0] + 200)), f"{which}: credit is short"
    assert taken == [t + tb.latency + 2 for t in sent], f"{which}: latency {taken[0] - sent[0]}"


@cocotb.test()
@cocotb.parametrize(which=WHICH)
async def fifo_capacity(dut, which):
    """A blocked FIFO accepts as many pixels as it has slots, plus one at its output.

    The number of slots is the smallest multiple of 16 that sustains one pixel per cycle. The same
    holds after a reset with pixels in every stage.
    """
    tb = FifoTB(dut, which, f"no room, seed {SEED}")
    await tb.start()
    slots = -(-(tb.latency + 4) // 16) * 16
    for clocks in (200, 5, tb.latency + 1, tb.latency + 8, 200):
        tb.stall = pauses("never", 0) if clocks < 200 else iter([True] * 200 + [False] * 1000)
        tb.to_send = 1000
        for _ in range(clocks):
            await tb.step()
        if clocks == 200:
            assert len(tb.sent_at) == slots + 1, f"{which}: {len(tb.sent_at)} in {slots} slots"
            tb.to_send = 0
            await tb.drain()
            tb.to_send = 20
            for _ in range(tb.latency + 6):
                await tb.step()
        tb.to_send = 0
        await tb.edge()
        tb.drive(reset=1, **{f"{which}_pixel_valid": 0})
        await tb.edge()
        assert not tb.read(f"{which}_credit"), f"module pixel_fifo ({which}): credit in reset"
        tb.drive(reset=0)
        tb.forget()
        for _ in range(40):
            await tb.step()
