# SPDX-License-Identifier: MIT
"""cocotb tests of the modules of rtl/lights/.

tests/test_modules.py runs them, one module per simulation, in the benches of sim/module/units.py.
"""

from __future__ import annotations

import dataclasses
import os

import cocotb
import numpy as np

from phong75.model.studies.random_frames import random_lights
from phong75.model.twin.lights import lights_unit
from phong75.model.twin.lights.context_interpolator import context_interpolator
from phong75.model.twin.lights.held_root import held_root
from phong75.model.twin.lights.light_attenuation import light_attenuation
from phong75.model.twin.lights.light_sum import light_sum
from phong75.sim import environment
from phong75.sim.module.lights import factor_words, packed, vectors, write_codes
from phong75.sim.module.unit_tb import UnitTB
from tests.modules.benches import BUILDS
from tests.modules.datapath import _edges, _normals

C = BUILDS[os.environ.get(environment.CONFIG, "default")]
SEED = int(os.environ.get(environment.SEED, "75"))
RANDOM = 40_000
MODULE = os.environ[environment.MODULE]
NOTE = f"configuration {C.name}, seed {SEED}"


def _only(*modules: str):
    """Decorator: a test only in the simulation of one of `modules`, else a plain function."""
    return cocotb.test() if MODULE in modules else lambda test: test


def _random(two_sided: bool):
    """(normals, material, frame): three lights that see one vector, and some that do not."""
    rng = np.random.default_rng([SEED, two_sided])
    frame = random_lights([SEED, two_sided], 2000, 20, 3, two_sided, C.highlight_colour)
    length = frame.spans["length"]
    span = np.repeat(np.arange(len(length)), length)
    k = np.arange(len(span)) - np.repeat(np.cumsum(length) - length, length)
    normals = lights_unit.interpolate(frame, span, k, C)
    normals[1:, :, ::7] = (
        np.stack(_normals(rng, normals[1:, 0, ::7].size)).reshape(3, 2, -1).swapaxes(0, 1)
    )
    normals[0, :, ::11] = 0
    # No bit of 0 and of -1 differs from its sign: the zero vector is told from these by the sign.
    normals[:, :, 1:9] = -((np.arange(8) >> np.arange(3)[:, None]) & 1)
    return normals, frame.spans["material"][span].astype(np.int64), frame


@_only("light_align", "light_scale", "light_highlight", "light_terms")
async def light_random(dut):
    """Normals of all directions and lengths, for the first light and another."""
    tb = UnitTB(dut, MODULE)
    for two_sided in (False, True):
        normals, material, frame = _random(two_sided)
        for light in (0, 2):
            for found in vectors(normals, material, frame, C, light):
                if found.module != MODULE:
                    continue
                await tb.hold(**found.held)
                await write_codes(tb, found.codes)
                if MODULE == "light_highlight":
                    await tb.write_table(dataclasses.replace(frame, further=[]), C)
                await tb.check(found.inputs, found.expected, f"{NOTE}, light {light}")


@_only("held_root")
async def held_root_holds(dut):
    """The root of the latest first turn, in random orders of first and other turns."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    mantissas = np.stack([_edges(C.mantissa, rng, RANDOM) for _ in range(3)])
    first = rng.random(RANDOM) < 0.4
    first[0] = True
    trace = {}
    held_root(mantissas, C, trace)
    latest = np.maximum.accumulate(np.where(first, np.arange(RANDOM), 0))
    trace["held_root.hold"] = tuple(word[latest] for word in trace["held_root.hold"])
    inputs = [first, packed(tuple(mantissas), C)]
    await tb.check(inputs, trace, NOTE, in_sequence=True)


@_only("light_sum")
async def light_sum_accumulates(dut):
    """Pixels of 1 to 8 turns, from black to far beyond white."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    ambient = rng.integers(0, C.coefficient.max + 1, C.materials)
    ambient[:3] = 0
    await write_codes(tb, {"write_ambient": ambient})
    # The bench is that of one light: a term below 4, and a sum that its word holds.
    turns = rng.integers(1, 4, RANDOM // 4)
    pixel = np.repeat(np.arange(len(turns)), turns)
    first = np.concatenate([[True], pixel[1:] != pixel[:-1]])
    fraction = C.weight.fraction + C.power.fraction
    terms = rng.integers(0, (4 << fraction) // 3, len(pixel)) >> rng.integers(0, 20, len(pixel))
    material = rng.integers(0, C.materials, len(turns))[pixel]
    so_far = np.cumsum(terms)
    so_far -= (so_far - terms)[first][np.cumsum(first) - 1]
    trace = {}
    light_sum(ambient[material], so_far, C, trace)
    trace = {
        name: (word,)
        for name, word in (
            ("light_sum.clamp", trace["light_sum.clamp"]),
            ("light_sum.code", trace["light_sum.code"]),
        )
    }
    await tb.check([terms, first, material], trace, NOTE, in_sequence=True)


@_only("light_attenuation")
async def light_attenuation_random(dut):
    """Distances from below 0 to the end of the word, for the tables of all turns."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    turns, one = C.turns if C.turns > 1 else 2, C.coefficient.one
    frame = random_lights(SEED, 1, 1, turns)
    frame.falloff = rng.integers(0, one + 1, (turns, C.weight_points))
    frame.falloff[0, :3] = one, one, 0
    for turn in range(turns):
        for k, word in enumerate(factor_words(frame.falloff[turn], C).tolist()):
            address = turn << C.weight_index_bits | k
            await tb.hold(write_address=address, write_word=word, write_enable=1)
    await tb.hold(write_enable=0)
    depth = _edges(C.depth, rng, RANDOM)
    cosine, highlight = _edges(C.cosine, rng, RANDOM), _edges(C.highlight, rng, RANDOM)
    turn = rng.integers(0, turns, RANDOM)
    expected: dict = {}
    for number in range(turns):
        trace: dict = {}
        light_attenuation(depth, number, cosine, highlight, frame, C, trace)
        for name, words in trace.items():
            before = expected.setdefault(name, tuple(np.zeros_like(w) for w in words))
            expected[name] = tuple(
                np.where(turn == number, w, b) for w, b in zip(words, before, strict=True)
            )
    await tb.check([depth, turn, cosine, highlight], expected, NOTE)


@_only("span_word")
async def span_word_in_turns(dut):
    """Words of spans of 1 to 30 pixels in one turn or in as many as there are, with pauses."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    for count in {1, C.turns}:
        lengths = rng.integers(1, 31, 600)
        pixels = np.repeat(np.arange(len(lengths)), lengths)
        k = np.arange(len(pixels)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        span, k = np.repeat(pixels, count), np.repeat(k, count)
        turn = np.tile(np.arange(count), len(pixels))
        words = rng.integers(0, 1 << 2 * C.half_vector.bits, (len(lengths), count))
        n = 2 * len(turn)
        advance = rng.random(n) < 0.7
        advance[0] = True
        now = np.cumsum(advance) - 1  # the turn that comes after each cycle
        advance &= now < len(turn)
        now = np.minimum(now, len(turn) - 1)
        before = np.maximum(now - advance, 0)
        load = np.where(advance, k[now] == 0, rng.random(n) < 0.5)
        inputs = [
            np.full(n, count == 1), advance, load, advance & (now > 0), turn[before], turn[now],
            np.where(load & advance, words[span[now], turn[now]], rng.integers(0, 1 << 36, n)),
        ]  # fmt: skip
        expected = {"span_word": (words[span[now], turn[now]],)}
        await tb.check(inputs, expected, f"{NOTE}, turns {count}", in_sequence=True)


@_only("context_interpolator")
async def context_interpolator_in_turns(dut):
    """Spans of 1 to 30 pixels in one turn or in as many as there are contexts, with pauses."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    for count in sorted({1, C.turns}):
        lengths = rng.integers(1, 31, 600)
        pixels = np.repeat(np.arange(len(lengths)), lengths)
        k = np.arange(len(pixels)) - np.repeat(np.cumsum(lengths) - lengths, lengths)
        span, k = np.repeat(pixels, count), np.repeat(k, count)
        turn = np.tile(np.arange(count), len(pixels))
        start = _edges(C.normal, rng, len(lengths) * count).reshape(-1, count)
        step = _edges(C.normal, rng, len(lengths) * count).reshape(-1, count) >> 4
        value, _ = context_interpolator(start[span, turn], step[span, turn], k, C)
        gone = [
            context_interpolator(start[span, turn], step[span, turn], np.maximum(k - j, 0), C)[1]
            for j in range(31)
        ]  # the value has left the word at a pixel of the span up to this one
        overflow = np.any(gone, axis=0)
        # A cycle moves to the next turn, or pauses; the current turn leaves in the cycle before.
        n = 2 * len(turn)
        advance = rng.random(n) < 0.7
        advance[0] = True
        now = np.cumsum(advance) - 1  # the turn that comes after each cycle
        advance &= now < len(turn)
        now = np.minimum(now, len(turn) - 1)
        before = np.maximum(now - advance, 0)
        load = np.where(advance, k[now] == 0, rng.random(n) < 0.5)
        leaves = advance & (now > 0)
        inputs = [
            np.full(n, count == 1), advance, load, leaves, turn[before], turn[now],
            start[span[now], turn[now]], step[span[now], turn[now]],
        ]  # fmt: skip
        expected = {"context_interpolator": (value[now], overflow[now].astype(np.int64))}
        await tb.check(inputs, expected, f"{NOTE}, turns {count}", in_sequence=True)
