# SPDX-License-Identifier: MIT
"""cocotb tests of phong_pipeline with several lights in turns, cycle by cycle.

tests/test_modules.py runs them. The twin gives the expected pixels.
"""

from __future__ import annotations

import os

import cocotb

from phong75.model.registers import writes
from phong75.model.spans import illegal_spans, pack_frame, record_bits, span_fields, turns
from phong75.model.studies.random_frames import random_lights
from phong75.model.twin import render, zero_normals
from phong75.sim import environment
from phong75.sim.module.stream_tb import REGIMES, PipelineTB, pauses
from tests.modules.benches import BUILDS

C = BUILDS["lights_3"]
SEED = int(os.environ.get(environment.SEED, "75"))
SPAN_BITS = span_fields(C)[-1].lsb
NAMED = [cocotb.Param(regime, regime) for regime in REGIMES]


def _queue(tb, frame):
    """Offer all records of `frame` and expect its pixels."""
    size, body = record_bits(C) // 8, pack_frame(frame, C)
    for k in range(0, len(body), size):
        record = int.from_bytes(body[k : k + size], "big")
        tb.source.queue.append((record & ((1 << SPAN_BITS) - 1), record >> SPAN_BITS))
    p = render(frame, C)
    for y, x, rgb, last in zip(p.y, p.x, p.rgb, p.last, strict=True):
        data = int(y) << C.coordinate_bits | int(x)
        for code in rgb:
            data = data << C.colour_bits | int(code)
        tb.sink.expected.append((data, int(last)))


@cocotb.test()
@cocotb.parametrize(idle=NAMED, stall=NAMED)
async def frame_in_all_regimes(dut, idle, stall):
    """Under all pauses of records and pixels every pixel leaves once, in order and unchanged."""
    tb = PipelineTB(dut)
    await tb.reset()
    for lights in (3, 1):
        frame = random_lights([SEED, lights, *idle.encode()], 25, 5, lights, coloured=False)
        await tb.write(writes(frame, C))
        tb.source.idle, tb.sink.stall = pauses(idle, SEED), pauses(stall, SEED + 1)
        _queue(tb, frame)
        await tb.drain()
    assert not tb.illegal_at, f"legal spans flagged in cycles {tb.illegal_at}"


@cocotb.test()
async def one_pixel_in_as_many_cycles_as_turns(dut):
    """Spans of one pixel, back to back: a record is taken in every cycle, no pixel is late."""
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_lights(SEED, 200, 1, 3, coloured=False)
    await tb.write(writes(frame, C))
    await tb.settle()
    latency = tb.read("pixel_latency") + 3
    _queue(tb, frame)
    await tb.drain()
    each, taken, came = turns(frame, C), tb.source.taken_at, tb.sink.taken_at
    assert taken == list(range(taken[0], taken[0] + each * 200)), "a bubble between the records"
    assert came == [t + latency for t in taken[each - 1 :: each]]


@cocotb.test()
@cocotb.parametrize(clocks=list(range(90, 98)))
async def a_reset_flags_nothing(dut, clocks):
    """A reset in a frame of zero normals and illegal spans drops all flags; nothing comes after."""
    tb = PipelineTB(dut)
    await tb.reset()
    frame = random_lights(SEED, 60, 4, 3, coloured=False)
    frame.spans["start"] = frame.spans["step"] = 0
    for light in frame.further:
        light.step[:, 0] = C.normal.max
    assert illegal_spans(frame, C).any() and zero_normals(frame, C)
    await tb.write(writes(frame, C))
    _queue(tb, frame)
    for _ in range(clocks):
        await tb.step()
    assert tb.zero_at and tb.illegal_at
    await tb.reset(1 + clocks % 3)  # also for as long as the turns of a pixel
    for _ in range(120):
        await tb.step()
    assert not tb.zero_at and not tb.illegal_at, f"{tb.zero_at}, {tb.illegal_at} after a reset"
    good = random_lights(SEED + 1, 20, 4, 3, coloured=False)
    await tb.write(writes(good, C))
    _queue(tb, good)
    await tb.drain()
    assert len(tb.zero_at) == zero_normals(good, C), tb.zero_at
