# SPDX-License-Identifier: MIT
"""cocotb tests of the modules of rtl/reflectance/.

tests/test_modules.py runs them, one module per simulation, in the benches of sim/module/units.py.
"""

from __future__ import annotations

import dataclasses
import os

import cocotb
import numpy as np

from phong75.model.config import MAX_JUMPS
from phong75.model.reflectance import segments
from phong75.model.registers import address_bits
from phong75.model.twin.reflectance.reflectance_map import reflectance_map
from phong75.model.twin.reflectance.reflectance_table import reflectance_table
from phong75.model.twin.reflectance.stepped_weight import stepped_weight
from phong75.sim import environment
from phong75.sim.module.unit_tb import UnitTB
from tests.modules.benches import BUILDS
from tests.modules.datapath import _edges

C = BUILDS[os.environ.get(environment.CONFIG, "default")]
SEED = int(os.environ.get(environment.SEED, "75"))
RANDOM = 40_000
MODULE = os.environ[environment.MODULE]
NOTE = f"configuration {C.name}, seed {SEED}"

STEP_BITS = C.coefficient.bits + 1


def _only(*modules: str):
    """Decorator: a test only in the simulation of one of `modules`, else a plain function."""
    return cocotb.test() if MODULE in modules else lambda test: test


def _words(rng, shape) -> np.ndarray:
    """Lines {left, step}, int64[*shape, 2]: between 0 and 1, flat, and every extreme of a word."""
    one, most = C.coefficient.one, C.coefficient.max
    ends = rng.integers(0, one + 1, (*shape, 2))
    words = np.stack([ends[..., 0], ends[..., 1] - ends[..., 0]], axis=-1)
    kind = rng.random(shape)
    words[kind < 0.3, 1] = 0
    extreme = kind > 0.7
    left = rng.choice([0, 1, one - 1, one, most], shape)
    step = rng.choice([-most - 1, -one, -1, 0, 1, one, most], shape)
    return np.where(extreme[..., None], np.stack([left, step], axis=-1), words)


def _jumps(rng, fmt) -> np.ndarray:
    """Jumps of every material, int64[M, MAX_JUMPS, 3], with extreme thresholds and amounts."""
    shape = (C.materials, MAX_JUMPS)
    threshold = rng.choice([0, 1, fmt.one // 2, fmt.max], shape)
    threshold = np.where(rng.random(shape) < 0.6, rng.integers(0, fmt.max + 1, shape), threshold)
    amount = rng.integers(0, C.coefficient.one // 2, shape)
    extreme = rng.choice([0, 1, C.coefficient.one, C.coefficient.max], shape)
    amount = np.where(rng.random(shape) < 0.3, extreme, amount)
    jumps = np.stack([rng.integers(0, 2, shape), threshold, amount], axis=-1)
    jumps[-1] = 1, 0, C.coefficient.max  # the largest sum: all apply everywhere
    return jumps


def _jump_writes(jumps, fmt) -> tuple[np.ndarray, ...]:
    """The strobes, materials and words that write `jumps`, int64[n] each."""
    rows = [
        (1 << (2 * k + part), material, word)
        for material in range(C.materials)
        for k in range(MAX_JUMPS)
        for part, word in enumerate((
            jumps[material, k, 0] << fmt.bits | jumps[material, k, 1], jumps[material, k, 2],
        ))
    ]  # fmt: skip
    return tuple(np.array(column) for column in zip(*rows, strict=True))


def _packed(words) -> np.ndarray:
    """The words {step, left} of lines int64[..., 2]."""
    step = words[..., 1] & ((1 << STEP_BITS) - 1)
    return step << C.coefficient.bits | words[..., 0]


@_only("reflectance_map")
async def reflectance_map_random(dut):
    """Every address, with and without write_enable."""
    rng = np.random.default_rng(SEED)
    bits = address_bits(C)
    address = np.concatenate([np.arange(1 << bits), rng.integers(0, 1 << bits, 5000)])
    enable = rng.random(len(address)) < 0.8
    to = [reflectance_map(int(a), C) for a in address]
    strobes = np.array([t.strobes for t in to]) * enable
    jumps = (1 << (2 * MAX_JUMPS)) - 1
    expected = {
        "reflectance_map.plain": (enable & np.array([t.plain for t in to]),),
        "reflectance_map.strobes": (
            strobes & 1, np.array([t.line for t in to]), strobes >> 1 & jumps,
            strobes >> (1 + 2 * MAX_JUMPS),
        ),
    }  # fmt: skip
    await UnitTB(dut, MODULE).check([enable, address], expected, NOTE)


@_only("reflectance_table")
async def reflectance_table_random(dut):
    """Both ends of every line, random versines, lines and jumps of all codes.

    In a build for two materials, writes to the others must change nothing.
    """
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    cut = segments(C)
    curve = _words(rng, (C.materials, len(cut.first)))
    jumps = _jumps(rng, C.versine)
    line = np.arange(C.materials << C.segment_bits)
    line = rng.permutation(line) if C.idle_material_bits else line
    n = len(line)
    nothing = np.zeros(n, np.int64)
    await tb.send(nothing, nothing, nothing + 1, line, nothing, nothing,
                  _packed(curve).reshape(-1)[line])  # fmt: skip
    strobes, material, words = _jump_writes(jumps, C.versine)
    nothing = np.zeros(len(words), np.int64)
    await tb.send(nothing, nothing, nothing, nothing, strobes, material, words)

    code = np.concatenate([cut.first + k for k in (0, 1)] + [cut.first + cut.length - 1])
    ends = np.where(np.tile(cut.mirrored, 3), C.versine.max - code, code)
    near = (jumps[..., 1].reshape(-1)[:, None] + [-1, 0, 1]).reshape(-1)
    v = np.concatenate([ends, near.clip(0, C.versine.max), _edges(C.versine, rng, RANDOM)])
    material = rng.integers(0, C.materials >> C.idle_material_bits, len(v))
    trace = {}
    reflectance_table(v, material, curve, jumps, C, trace)
    nothing = np.zeros(len(v), np.int64)
    await tb.check([v, material, *[nothing] * 5], trace, NOTE)


@_only("stepped_weight")
async def stepped_weight_random(dut):
    """All materials and intervals, points and jumps of all codes."""
    config = dataclasses.replace(C, weight_jumps=max(C.weight_jumps, 1))
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    points = rng.choice([0, C.coefficient.one, C.coefficient.max], (C.materials, C.weight_points))
    some = rng.random(points.shape) < 0.6
    points[some] = rng.integers(0, C.coefficient.one + 1, some.sum())
    jumps = _jumps(rng, C.cosine)
    address = np.arange(C.materials << C.weight_index_bits)
    words = np.stack([points[:, :-1], np.diff(points, axis=1)], axis=-1)
    nothing = np.zeros(len(address), np.int64)
    await tb.send(nothing, nothing, nothing + 1, nothing, address, _packed(words).reshape(-1))
    strobes, material, words = _jump_writes(jumps, C.cosine)
    nothing = np.zeros(len(words), np.int64)
    await tb.send(nothing, nothing, nothing, strobes, material << C.weight_index_bits, words)

    near = (jumps[..., 1].reshape(-1)[:, None] + [-1, 0, 1]).reshape(-1)
    cosine = np.concatenate([near.clip(0, C.cosine.max), _edges(C.cosine, rng, RANDOM)])
    material = rng.integers(0, C.materials, len(cosine))
    trace = {}
    stepped_weight(cosine, material, points, jumps, config, trace)
    nothing = np.zeros(len(cosine), np.int64)
    await tb.check([cosine, material, *[nothing] * 4], trace, NOTE)
