# SPDX-License-Identifier: MIT
"""cocotb tests of phong_pipeline, cycle by cycle: streams, stalls, resets, illegal spans.

tests/test_modules.py runs them for every shading technique. The twin gives the expected pixels.
"""

from __future__ import annotations

import os

import cocotb
import numpy as np

from phong75.model.config import DEFAULT, TECHNIQUES
from phong75.model.frame import SPAN_DTYPE
from phong75.model.registers import writes
from phong75.model.spans import illegal_spans, pack, record_bits, span_fields
from phong75.model.studies.random_frames import random_frame
from phong75.model.twin import render, zero_normals
from phong75.scripts.docs import timing
from phong75.sim import environment
from phong75.sim.module.stream_tb import REGIMES, PipelineTB, pauses

C = TECHNIQUES.get(os.environ[environment.MODULE], DEFAULT)
SEED = int(os.environ.get(environment.SEED, "75"))
SPAN_BITS = span_fields(C)[-1].lsb
LOW, HIGH = C.normal.min, C.normal.max


def _words(spans):
    """(tdata, tlast) of every span."""
    size, body = record_bits(C) // 8, pack(spans, C)
    for k in range(len(spans)):
        record = int.from_bytes(body[k * size : (k + 1) * size], "big")
        yield record & ((1 << SPAN_BITS) - 1), record >> SPAN_BITS


def _pixels(frame):
    """(tdata, tlast) of every pixel of the twin."""
    p = render(frame, C)
    for y, x, rgb, last in zip(p.y, p.x, p.rgb, p.last, strict=True):
        data = int(y) << C.coordinate_bits | int(x)
        for code in rgb:
            data = data << C.colour_bits | int(code)
        yield data, int(last)


def _queue(tb, frame):
    """Offer all spans of `frame` and expect its pixels."""
    tb.source.queue.extend(_words(frame.spans))
    tb.sink.expected.extend(_pixels(frame))


@cocotb.test()
@cocotb.parametrize(
    idle=[cocotb.Param(regime, regime) for regime in REGIMES],
    stall=[cocotb.Param(regime, regime) for regime in REGIMES],
)
async def frame_in_all_regimes(dut, idle, stall):
    """Under all pauses at both ends every pixel leaves once, in order and unchanged."""
    seed = f"{SEED} {idle} {stall}"
    tb = PipelineTB(dut)
    tb.sink.note = f"idle {idle}, stall {stall}, seed {seed}"
    await tb.reset()
    for two_sided in (False, True):
        seeds = [SEED, two_sided, *idle.encode(), *stall.encode()]
        frame = random_frame(seeds, 40, 9, two_sided, C)
        await tb.write(writes(frame, C))
        tb.source.idle, tb.sink.stall = pauses(idle, seed), pauses(stall, f"{seed} out")
        _queue(tb, frame)
        await tb.drain()
    assert not tb.illegal_at, f"legal spans flagged in cycles {tb.illegal_at}; {tb.sink.note}"


@cocotb.test()
async def one_pixel_per_cycle(dut):
    """Spans of one pixel, back to back, take as many cycles as there are pixels."""
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_frame(SEED, 500, 1, config=C)
    tb.sink.note = f"seed {SEED}"
    await tb.write(writes(frame, C))
    await tb.settle()
    latency = tb.read("pixel_latency") + 3  # accepted, slot written, slot read
    _queue(tb, frame)
    await tb.drain()
    taken, came = tb.source.taken_at, tb.sink.taken_at
    assert taken == list(range(taken[0], taken[0] + 500)), "a bubble between the spans"
    assert came == [t + latency for t in taken], (
        f"latency {came[0] - taken[0]}, expected {latency}; {came[-1] - came[0] + 1} cycles"
    )


@cocotb.test()
async def long_stall(dut):
    """A long stall loses no pixel; after the stall one pixel per cycle leaves."""
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_frame(SEED, 400, 1, config=C)
    tb.sink.note = f"seed {SEED}"
    await tb.write(writes(frame, C))
    _queue(tb, frame)
    tb.sink.stall = iter([True] * 300 + [False] * 10_000)
    await tb.drain()
    came = tb.sink.taken_at
    assert came == list(range(came[0], came[0] + 400)), "the pixels after the stall have gaps"


@cocotb.test()
@cocotb.parametrize(clocks=[3, 40, 75, 110])
async def reset_in_mid_frame(dut, clocks):
    """A reset at any time drops all pixels in the pipeline; the next frame is complete."""
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_frame([SEED, clocks], 60, 5, config=C)
    tb.sink.note = f"reset after {clocks} cycles, seed {SEED}"
    await tb.write(writes(frame, C))
    for _ in range(2):  # the second time with pixels that wait at the output
        _queue(tb, frame)
        for _ in range(clocks):
            await tb.step()
        await tb.reset(1)
        for _ in range(200):
            await tb.step()
        _queue(tb, frame)
        tb.sink.stall = iter([True] * clocks + [False] * 10_000)
        await tb.drain()
        tb.sink.stall = pauses("mostly", clocks)
    assert not tb.illegal_at, f"legal spans flagged in cycles {tb.illegal_at}; {tb.sink.note}"


def _span(start, step, length, x=0):
    """SPAN_DTYPE[1]: a span at (x, 0)."""
    span = np.zeros(1, SPAN_DTYPE)
    span["start"], span["step"], span["length"], span["x"] = start, step, length, x
    return span


def _border_spans():
    """Yield (span, legal, description) of spans at the limits of what is legal, and just beyond."""
    for axis in range(C.values if C.technique != "flat" else 0):
        name = "xyz"[axis]
        for start, end, sign in ((LOW, HIGH, 1), (HIGH, LOW, -1)):
            for length in (2, 4, 16):
                begin = [0, 0, 0]
                begin[axis] = start if length > 2 else end - sign * HIGH
                step = (end - begin[axis]) // (length - 1)
                assert begin[axis] + (length - 1) * step == end
                steps = [0, 0, 0]
                steps[axis] = step
                yield _span(begin, steps, length), True, f"{name} from {begin[axis]} to {end}"
                begin[axis] += sign
                yield _span(begin, steps, length), False, f"{name} one beyond {end}"
            # Leaves the format, then wraps around into it: illegal.
            begin, steps = [0, 0, 0], [0, 0, 0]
            begin[axis], steps[axis] = sign, sign * HIGH
            yield _span(begin, steps, 4), False, f"{name} wraps around from {sign}"
            # Leaves the format only with the step after the last pixel: legal.
            begin[axis], steps[axis] = end, sign * HIGH
            yield _span(begin, steps, 1), True, f"{name} leaves after the last pixel"
    size = C.max_size
    yield _span(0, 0, 1, size - 1), True, "the last column"
    yield _span(0, 0, 2, size - 1), False, "one column beyond the counter"
    yield _span(0, 0, 5, size - 5), True, "up to the last column"
    yield _span(0, 0, 6, size - 5), False, "past the last column"
    yield _span(0, 0, 0, 7), False, "no pixel"
    yield _span(0, 0, 1, 7), True, "one pixel"


@cocotb.test()
async def illegal_spans_are_flagged_once(dut):
    """Every illegal span is flagged once, and its pixels leave nevertheless; legal spans never.

    A span is illegal if its vector leaves the format, if it leaves the x counter, or if it is
    empty.
    """
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_frame(SEED, 1, 1, config=C)
    frame.spans = _span(0, 0, 1)
    await tb.write(writes(frame, C))
    spans = []
    for span, legal, description in _border_spans():
        frame.spans = span
        inside = span["x"][0] + span["length"][0] <= C.max_size and span["length"][0] > 0
        model_legal = not illegal_spans(frame, C)[0]
        assert (legal or not inside) == (model_legal or not inside), description
        tb.sink.note = description
        tb.illegal_at.clear()
        _queue(tb, frame)
        await tb.drain(after=5)
        assert len(tb.illegal_at) == (not legal), (
            f"module phong_pipeline: span with {description} flagged {len(tb.illegal_at)} times"
        )
        spans.append((span, legal))
    # All spans back to back, in a random order.
    order = np.random.default_rng(SEED).permutation(len(spans))
    frame.spans = np.concatenate([spans[k][0] for k in order])
    frame.spans["last"][-1] = True
    tb.sink.note = f"all border spans, seed {SEED}"
    tb.illegal_at.clear()
    _queue(tb, frame)
    await tb.drain()
    illegal = sum(not legal for _, legal in spans)
    assert len(tb.illegal_at) == illegal, (
        f"module phong_pipeline: {len(tb.illegal_at)} flags for {illegal} illegal spans"
    )


@cocotb.test()
@cocotb.parametrize(stall=[cocotb.Param(regime, regime) for regime in REGIMES])
async def zero_vectors_are_flagged_once(dut, stall):
    """Every pixel with a zero normal is flagged once, no other pixel is.

    A reset flags nothing. Gouraud and flat shading have no normals and flag nothing.
    """
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_frame(SEED, 60, 9, config=C)
    if C.technique != "phong":
        frame.spans["start"] = frame.spans["step"] = 0
        _queue(tb, frame)
        await tb.drain()
        assert not tb.zero_at, f"{len(tb.zero_at)} flags without normals"
        return
    one = np.array([1, -3, 1 << 20])
    crossing = [_span(-k * one, one, 9) for k in range(12)]  # through zero at pixel k
    nearly = [_span(v, 0, 2) for v in ([0, 0, -1], [-1, 0, 0], [0, 1, 0], LOW)]
    frame.spans = np.concatenate([frame.spans, _span(0, 0, 7), *crossing, *nearly])
    await tb.write(writes(frame, C))
    tb.sink.note = f"stall {stall}, seed {SEED}"
    tb.sink.stall = pauses(stall, SEED)
    _queue(tb, frame)
    await tb.drain()
    zeros = zero_normals(frame, C)
    assert zeros >= 16 and len(tb.zero_at) == zeros, f"{len(tb.zero_at)} of {zeros} flags"
    frame.spans = _span(0, 0, 100)
    _queue(tb, frame)
    while not tb.zero_at[zeros:]:
        await tb.step()
    await tb.reset(1)
    for _ in range(100):
        await tb.step()
    assert not tb.zero_at, f"flagged {len(tb.zero_at)} times after a reset"


@cocotb.test()
async def longest_spans(dut):
    """A span over the whole range of x is legal; the same span one pixel further right is not."""
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_frame(SEED, 1, 1, config=C)
    frame.spans = _span(0, 0, 1)
    await tb.write(writes(frame, C))
    for length, x, legal in ((C.max_size, 0, True), (C.max_size, 1, False)):
        step = 0 if C.technique == "flat" else (HIGH - LOW) // C.max_size
        frame.spans = _span([0, 0, LOW], [0, 0, step], length, x)
        tb.sink.note = f"length {length} from x = {x}"
        tb.illegal_at.clear()
        _queue(tb, frame)
        await tb.drain(after=5)
        assert len(tb.illegal_at) == (not legal), f"{tb.sink.note}: {len(tb.illegal_at)} flags"


@cocotb.test(skip=C.technique != "phong")
async def the_timing_diagram(dut):
    """docs/images/span_interface.json, cycle by cycle: inputs as drawn, outputs compared."""
    diagram = timing.load(timing.FOLDER / "span_interface.json")
    numbers = timing.ticks(diagram)
    drawn = {s["name"]: timing.values(s) for s in diagram["signal"] if s}
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_frame(SEED, 2, 1, config=C)
    frame.spans["length"] = [3, 2]
    frame.spans["x"] = [10, 20]
    await tb.write(writes(frame, C))
    spans = dict(zip("AB", _words(frame.spans), strict=True))
    pixels = dict(zip(("A0", "A1", "A2", "B0", "B1"), _pixels(frame), strict=True))
    shown = {int(number): column for column, number in enumerate(numbers) if number != "…"}
    assert numbers[drawn["m_axis_tvalid"].index("1")] == str(tb.read("pixel_latency") + 3)
    assert drawn["load (inside)"] == drawn["s_axis_tready"], "there is credit in every cycle"
    for cycle in range(max(shown) + 1):
        column = shown.get(cycle, numbers.index("…"))
        now = {name: value[column] for name, value in drawn.items()}
        await tb.edge()
        for name in ("s_axis_tvalid", "m_axis_tready"):
            tb.drive(**{name: int(now[name])})
        if now["s_axis_tdata"] != "x":
            data, last = spans[now["s_axis_tdata"]]
            assert last == int(now["s_axis_tlast"])
            tb.drive(s_axis_tdata=data, s_axis_tlast=last)
        await tb.settle()
        for name in ("s_axis_tready", "m_axis_tvalid"):
            assert tb.read(name) == int(now[name]), f"cycle {cycle}: {name}"
        if now["m_axis_tdata"] != "x":
            data, last = pixels[now["m_axis_tdata"]]
            assert tb.read("m_axis_tdata") == data and last == int(now["m_axis_tlast"]), cycle
