# SPDX-License-Identifier: MIT
"""cocotb tests of the datapath modules: directed, exhaustive for small inputs, random.

tests/test_modules.py runs them, one module per simulation, in the benches of sim/module/units.py.
"""

from __future__ import annotations

import os

import cocotb
import numpy as np
from cocotb.triggers import FallingEdge

from phong75.model.config import DEFAULT as C
from phong75.model.frame import SPAN_DTYPE, Frame, MaterialTable
from phong75.model.twin.core.inverse_sqrt_linear import inverse_sqrt_linear
from phong75.model.twin.core.normalizer import normalizer
from phong75.model.twin.core.reflection import reflection
from phong75.model.twin.core.shading_unit import shading_unit
from phong75.model.twin.core.specular_cosine import specular_cosine
from phong75.model.twin.core.specular_power_tables import specular_power_tables
from phong75.model.twin.core.specular_weight import specular_weight
from phong75.model.twin.techniques.intensity_code import intensity_code
from phong75.sim import environment
from phong75.sim.module.unit_tb import UnitTB
from phong75.sim.module.units import lanes

SEED = int(os.environ.get(environment.SEED, "75"))
RANDOM = 200_000
MODULE = os.environ[environment.MODULE]
NOTE = f"seed {SEED}"


def _only(module: str):
    """Decorator: a test only in the simulation of `module`, else a plain function."""
    return cocotb.test() if module == MODULE else lambda test: test


def _edges(fmt, rng, n: int) -> np.ndarray:
    """Random codes of `fmt`; a third of them within 4 of an end, of 0 or of a power of two."""
    codes = rng.integers(fmt.min, fmt.max + 1, n)
    corners = [fmt.min, fmt.max, 0]
    corners += [s << k for k in range(fmt.bits) for s in ((1, -1) if fmt.signed else (1,))]
    near = rng.choice(corners, n) + rng.integers(-4, 5, n)
    return np.clip(np.where(rng.random(n) < 1 / 3, near, codes), fmt.min, fmt.max)


# -- inverse_sqrt_linear ---------------------------------------------------------------------------


@_only("inverse_sqrt_linear")
async def inverse_sqrt_exhaustive(dut):
    """Every operand, including those below 1."""
    tb = UnitTB(dut, MODULE)
    for first in range(0, 1 << C.root_operand.bits, 1 << 20):
        operand = np.arange(first, first + (1 << 20))
        trace = {}
        inverse_sqrt_linear(operand, C, trace)
        await tb.check([operand], trace)


@_only("inverse_sqrt_linear")
async def inverse_sqrt_latency(dut):
    """A single operand changes the output in the cycle of the stated latency only."""
    await UnitTB(dut, MODULE).check_latency(
        [C.root_operand.one], [3 * C.root_operand.one], "inverse_sqrt_linear.round"
    )


# -- normalizer -----------------------------------------------------------------------------------


def _normals(rng, n: int) -> np.ndarray:
    """Normals int64[3, n]: all lengths, unequal components, single components, zero vectors."""
    normal = _edges(C.normal, rng, 3 * n).reshape(3, n) >> rng.integers(0, C.normal.bits, n)
    unequal = normal >> rng.integers(0, C.normal.bits, (3, n))
    normal = np.where(rng.random(n) < 0.5, normal, unequal)
    return np.where(rng.random((3, n)) < 0.1, 0, normal)


@_only("normalizer")
async def normalizer_random(dut):
    """Random and extreme normals, one- and two-sided."""
    tb = UnitTB(dut, MODULE)
    for two_sided in (0, 1):
        await tb.hold(two_sided=two_sided, valid=1)
        normal = _normals(np.random.default_rng(SEED + two_sided), RANDOM)
        trace = {}
        normalizer(normal, bool(two_sided), C, trace)
        await tb.check(list(normal), trace, NOTE)


@_only("normalizer")
async def normalizer_small(dut):
    """Every normal with components from -5 to 5, times every power of two."""
    tb = UnitTB(dut, MODULE)
    side = np.arange(-5, 6)
    grid = np.stack(np.meshgrid(side, side, side)).reshape(3, -1)
    normal = np.concatenate([grid << k for k in range(C.normal.bits - 3)], axis=1)
    trace = {}
    normalizer(normal, False, C, trace)
    await tb.hold(valid=1)
    await tb.check(list(normal), trace)


@_only("normalizer")
async def normalizer_halves(dut):
    """|Zn| at and next to the middle between two codes of the cosine, where -z and ~z differ."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    drop = C.mantissa.fraction + C.root.fraction - C.cosine.fraction
    near = []
    for _ in range(8):
        normal = rng.integers(C.normal.min, C.normal.max + 1, (3, 1 << 19))
        normal[2] = -np.abs(normal[2])
        trace = {}
        normalizer(normal, True, C, trace)
        below = np.abs(trace["normalizer.scale"][2]) % (1 << drop)
        near.append(normal[:, np.abs(below - (1 << (drop - 1))) <= 2])
    normal = np.concatenate(near, axis=1)
    assert normal.shape[1] > 50, f"only {normal.shape[1]} vectors are near the middle; {NOTE}"
    trace = {}
    normalizer(normal, True, C, trace)
    await tb.hold(two_sided=1, valid=1)
    await tb.check(list(normal), trace, NOTE)


@_only("normalizer")
async def normalizer_reset(dut):
    """Zero normals that are in the pipeline during a reset are not flagged after the reset."""
    tb = UnitTB(dut, MODULE)
    await tb.hold(valid=1)
    zeros = [np.zeros(50, np.int64)] * 3
    assert (await tb.send(*zeros))["normalizer.zero"][0].all()
    await tb.hold(valid=0, reset=1)
    await tb.hold(reset=0)
    lane = [lane.stage for lane in lanes(MODULE)].index("normalizer.zero")
    for clock in range(20):
        flag = int(dut.signals.value) >> (64 * lane) & 1
        assert not flag, f"module normalizer: zero_normal {clock} cycles after a reset"
        await FallingEdge(dut.clk)


@_only("normalizer")
async def normalizer_latency(dut):
    """A single normal changes the outputs in the cycle of the stated latency only."""
    tb = UnitTB(dut, MODULE)
    one = C.normal.one
    await tb.check_latency([one, 0, 0], [0, one, one], "normalizer.round")
    await tb.check_latency([one, 0, 0], [one, 0, 1], "normalizer.lit")
    await tb.hold(valid=1)
    await tb.check_latency([0, 0, -1], [0, 0, 0], "normalizer.zero")


# -- reflection -----------------------------------------------------------------------------------


@_only("reflection")
async def reflection_random(dut):
    """Unit normals and arbitrary words; half vectors over the whole range, and extreme ones."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    halves = [C.half_vector.quantize([np.sin(a), np.cos(a)]) for a in np.linspace(0, 1.57, 7)]
    halves += [np.array([C.half_vector.min, C.half_vector.max])]
    halves += [np.array([C.half_vector.max, C.half_vector.min])]
    for half in halves:
        await tb.hold(**{
            name: int(code) & ((1 << C.half_vector.bits) - 1)
            for name, code in zip(("half_x", "half_z"), half, strict=True)
        })  # fmt: skip
        direction = rng.normal(size=(3, RANDOM // 8))
        unit = C.unit.quantize(direction / np.linalg.norm(direction, axis=0))
        unit = np.concatenate([unit, _edges(C.unit, rng, 3 * 5000).reshape(3, -1)], axis=1)
        trace = {}
        reflection(unit, tuple(int(h) for h in half), C, trace)
        await tb.check(list(unit), trace, f"{NOTE}, half vector {half}")


@_only("reflection")
async def reflection_latency(dut):
    """A single normal changes the outputs in the cycle of the stated latency only."""
    tb = UnitTB(dut, MODULE)
    await tb.hold(half_z=C.half_vector.max)
    await tb.check_latency([0, 0, C.unit.max], [C.unit.max // 2, 0, 0], "reflection.versine")


# -- specular_power_tables -------------------------------------------------------------------------


@_only("specular_power_tables")
async def specular_power_random(dut):
    """Random operands for random exponents, and all versines near both ends."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    v = np.concatenate([
        np.arange(20000), C.versine.max - np.arange(20000), _edges(C.versine, rng, RANDOM),
        np.arange(0, C.versine.one, 61),
    ])  # fmt: skip
    one = C.exponent.one
    special = np.array([1, 1.5, 2, 10, 20, 32, 64, 127, 128]) * one
    n = rng.integers(one, 128 * one + 1, len(v))
    n = np.where(rng.random(len(v)) < 0.5, rng.choice(special.astype(np.int64), len(v)), n)
    n = np.where(rng.random(len(v)) < 0.05, one + rng.integers(-1, 2, len(v)), n)
    trace = {}
    specular_power_tables(v, n, C, trace)
    await tb.check([v, n], trace, NOTE)


@_only("specular_power_tables")
async def specular_power_latency(dut):
    """A single operand changes the output at the stated latency only, also through the bypass."""
    tb = UnitTB(dut, MODULE)
    half, one = C.versine.one // 2, C.exponent.one
    await tb.check_latency([0, 2 * one], [half, 2 * one], "specular_power_tables.bypass")
    await tb.check_latency([0, one], [half, one], "specular_power_tables.bypass")
    await tb.check_latency([half, 2 * one], [half, one], "specular_power_tables.bypass")


@_only("specular_cosine")
async def specular_cosine_exhaustive(dut):
    """Every versine."""
    tb = UnitTB(dut, MODULE)
    for first in range(0, C.versine.max + 1, 1 << 20):
        v = np.arange(first, first + (1 << 20))
        trace = {}
        specular_cosine(v, C, trace)
        await tb.check([v], trace)


@_only("specular_cosine")
async def specular_cosine_latency(dut):
    """A single operand changes the output in the cycle of the stated latency only."""
    await UnitTB(dut, MODULE).check_latency([0], [C.versine.one // 2], "specular_cosine")


# -- specular_weight, shading_unit: with a material table -----------------------------------------


def _frame(rng) -> Frame:
    """A frame of random materials, some with coefficients of 0 and 1."""
    table = MaterialTable.empty(C)
    for m in range(C.materials):
        cp = rng.choice([0.0, 1.0], 3) if m < 4 else rng.random(3)
        weight = rng.choice([0.0, 1.0], C.weight_points) if m % 4 == 0 else None
        weight = rng.random(C.weight_points) if weight is None else weight
        d = (0.0, 1.0, 0.5)[m] if m < 3 else rng.random()
        table.set(m, cp, d, weight, float(rng.choice([1, 1.5, 10, 128])), C)
    spans = np.zeros(C.materials, SPAN_DTYPE)
    spans["material"] = np.arange(C.materials)
    hx, hz = C.half_vector.quantize([np.sin(0.6), np.cos(0.6)])
    return Frame(1, 1, (int(hx), int(hz)), False, (0, 0, 0), table, spans)


@_only("specular_weight")
async def specular_weight_random(dut):
    """All materials, all intervals of W(i), the ends of the range of Zn."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    frame = _frame(rng)
    await tb.write_table(frame, C)
    cosine = _edges(C.cosine, rng, RANDOM)
    material = rng.integers(0, C.materials, RANDOM)
    trace = {}
    specular_weight(cosine, material, frame.materials.weight, C, trace)
    await tb.check([cosine, material], trace, NOTE)


@_only("shading_unit")
async def shading_unit_random(dut):
    """Random unit normals, lit and unlit, of all materials, with three different channels."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    frame = _frame(rng)
    await tb.write_table(frame, C)
    await tb.hold(half_x=frame.half_vector[0], half_z=frame.half_vector[1])
    direction = rng.normal(size=(3, RANDOM))
    direction[0] += 0.5
    direction[2] = np.abs(direction[2]) + 0.5
    unit = C.unit.quantize(direction / np.linalg.norm(direction, axis=0))
    cosine = C.cosine.quantize(direction[2] / np.linalg.norm(direction, axis=0))
    lit = rng.random(RANDOM) < 0.8
    material = rng.integers(0, C.materials, RANDOM)
    trace = {}
    shading_unit(unit, cosine, lit, material, frame, C, trace)
    await tb.check([*unit, cosine, lit, material], trace, NOTE)


# -- intensity_code -------------------------------------------------------------------------------


@_only("intensity_code")
async def intensity_code_random(dut):
    """The limits of every code, the ends of [0, 1] and of the word, and random words."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    white = C.white
    limits = np.round((np.arange(white + 1) + 0.5) / white * C.normal.one).astype(np.int64)
    near = (limits[:, None] + np.arange(-200, 201)).reshape(-1)
    value = np.concatenate([near, _edges(C.normal, rng, RANDOM)])
    trace = {}
    intensity_code(value, C, trace)
    assert set(trace["intensity_code.code"][0]) == set(range(white + 1))
    await tb.check([value], trace, NOTE)


@_only("intensity_code")
async def intensity_code_latency(dut):
    """A single value changes the output in the cycle of the stated latency only."""
    await UnitTB(dut, MODULE).check_latency([0], [C.normal.one], "intensity_code.code")
