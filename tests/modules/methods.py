# SPDX-License-Identifier: MIT
"""cocotb tests of the modules of the other arithmetic methods (rtl/methods/).

tests/test_modules.py runs them, one module per simulation, in the benches of sim/module/units.py.
"""

from __future__ import annotations

import os

import cocotb
import numpy as np

from phong75.model.studies.methods import CONFIGS
from phong75.model.twin.methods.inverse_sqrt_iterated import inverse_sqrt_iterated
from phong75.model.twin.methods.inverse_sqrt_quadratic import inverse_sqrt_quadratic
from phong75.model.twin.methods.newton_step import newton_step
from phong75.model.twin.methods.quadratic_interpolator import quadratic_interpolator
from phong75.model.twin.methods.quadratic_normalizer import quadratic_normalizer
from phong75.model.twin.methods.specular_power_schlick import specular_power_schlick
from phong75.model.twin.methods.specular_power_squaring import specular_power_squaring
from phong75.model.twin.methods.unnormalized import unnormalized
from phong75.sim import environment
from phong75.sim.module.unit_tb import UnitTB
from tests.modules.datapath import _edges, _normals

C = CONFIGS[os.environ.get(environment.CONFIG, "default")]
SEED = int(os.environ.get(environment.SEED, "75"))
RANDOM = 200_000
MODULE = os.environ[environment.MODULE]
NOTE = f"configuration {C.name}, seed {SEED}"


def _only(*modules: str):
    """Decorator: a test only in the simulation of one of `modules`, else a plain function."""
    return cocotb.test() if MODULE in modules else lambda test: test


# -- 1/sqrt ---------------------------------------------------------------------------------------

_ROOTS = {
    "inverse_sqrt_quadratic": (inverse_sqrt_quadratic, "inverse_sqrt_quadratic.round"),
    "inverse_sqrt_iterated": (inverse_sqrt_iterated, "inverse_sqrt_iterated.steps"),
}


@_only(*_ROOTS)
async def inverse_sqrt_exhaustive(dut):
    """Every operand, including those below 1."""
    tb = UnitTB(dut, MODULE)
    for first in range(0, 1 << C.root_operand.bits, 1 << 20):
        operand = np.arange(first, first + (1 << 20))
        trace = {}
        _ROOTS[MODULE][0](operand, C, trace)
        await tb.check([operand], trace, NOTE)


@_only(*_ROOTS)
async def inverse_sqrt_latency(dut):
    """A single operand changes the output in the cycle of the stated latency only."""
    one = C.root_operand.one
    await UnitTB(dut, MODULE).check_latency([one], [3 * one], _ROOTS[MODULE][1])


@_only("newton_step")
async def newton_step_random(dut):
    """Random operands with estimates within 11 % of the root, and at the ends of the range."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    bits = C.root.bits
    x = rng.integers(1 << (bits - 2), 1 << bits, RANDOM)
    x[:1000] = (1 << (bits - 2)) + np.arange(1000)
    x[1000:2000] = (1 << bits) - 1 - np.arange(1000)
    root = np.sqrt((1 << (bits - 2)) / x)
    y = C.root.quantize(root * rng.uniform(0.89, 1.11, RANDOM))
    y = np.where(rng.random(RANDOM) < 0.1, C.root.quantize(root), y)
    trace = {}
    newton_step(x, y, C, trace)
    await tb.check([x, y], trace, NOTE)


@_only("newton_step")
async def newton_step_latency(dut):
    """A single operand and estimate change the output in the cycle of the stated latency only."""
    one, y = 1 << (C.root.bits - 2), C.root.max
    await UnitTB(dut, MODULE).check_latency(
        [one, y], [one, C.root.quantize(0.95)], "newton_step.better"
    )


# -- normals --------------------------------------------------------------------------------------


@_only("unnormalized")
async def unnormalized_random(dut):
    """Random and extreme normals, one- and two-sided."""
    tb = UnitTB(dut, MODULE)
    for two_sided in (0, 1):
        await tb.hold(two_sided=two_sided)
        normal = _normals(np.random.default_rng(SEED + two_sided), RANDOM)
        trace = {}
        unnormalized(normal, bool(two_sided), C, trace)
        await tb.check(list(normal), trace, NOTE)


@_only("unnormalized")
async def unnormalized_latency(dut):
    """A single normal changes the outputs in the cycle of the stated latency only."""
    tb = UnitTB(dut, MODULE)
    half = C.normal.one // 2
    await tb.check_latency([half, 0, 0], [0, half, half], "unnormalized.round")
    await tb.check_latency([half, 0, 0], [half, 0, 1], "unnormalized.lit")


@_only("quadratic_interpolator")
async def quadratic_interpolator_random(dut):
    """Spans of 1 to 60 pixels of random words that wrap around; without `advance` nothing moves."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    lengths = rng.integers(1, 61, 2000)
    k = np.concatenate([np.arange(n) for n in lengths])
    span = np.repeat(np.arange(len(lengths)), lengths)
    words = [_edges(C.squared, rng, len(lengths)) >> rng.integers(0, 40, len(lengths))
             for _ in range(3)]  # fmt: skip
    pixels = quadratic_interpolator(*(w[span] for w in words), k, C)
    advance = rng.random(2 * len(k)) < 0.7
    advance[0] = True
    pixel = np.minimum(np.cumsum(advance) - 1, len(k) - 1)  # the pixel of each cycle
    advance &= np.cumsum(advance) <= len(k)
    # Without `advance` the other ports have random values, which must be ignored.
    at_ports = [np.where(advance, w[span][pixel], rng.integers(0, 99, len(pixel))) for w in words]
    load = np.where(advance, k[pixel] == 0, rng.random(len(pixel)) < 0.5)
    trace = {"quadratic_interpolator": (pixels[pixel],)}
    await tb.check([advance, load, *at_ports], trace, NOTE, in_sequence=True)


@_only("quadratic_normalizer")
async def quadratic_normalizer_random(dut):
    """Squares of normals of all lengths, some near the highlight, and random words."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    direction = rng.normal(size=(3, RANDOM))
    direction /= np.linalg.norm(direction, axis=0)
    direction[:2] *= 2.0 ** -rng.integers(0, 20, RANDOM)
    normal = direction * 2.0 ** -rng.integers(0, 24, RANDOM)
    z = C.normal.quantize(normal[2])
    square, cross = (C.squared.quantize((normal[:n] ** 2).sum(axis=0)) for n in (3, 2))
    cross -= rng.integers(0, 3, RANDOM)  # rounding may make it negative
    for column, fmt in ((z, C.normal), (square, C.squared), (cross, C.squared)):
        rows = rng.random(RANDOM) < 0.2
        column[rows] = _edges(fmt, rng, int(rows.sum()))
        column[rng.random(RANDOM) < 0.02] = 0
    for two_sided in (0, 1):
        await tb.hold(two_sided=two_sided)
        trace = {}
        quadratic_normalizer(z, square, cross, bool(two_sided), C, trace)
        await tb.check([z, square, cross], trace, NOTE)


@_only("quadratic_normalizer")
async def quadratic_normalizer_latency(dut):
    """A single pixel changes the outputs in the cycle of the stated latency only."""
    tb = UnitTB(dut, MODULE)
    one, square = C.normal.one, C.squared.one
    stage = "quadratic_normalizer.out"
    await tb.check_latency([one, square, 0], [one, square, square // 4], stage)
    await tb.check_latency(
        [one // 2, square, square // 4], [one // 2, square // 2, square // 4], stage
    )


# -- cos(s)^n -------------------------------------------------------------------------------------

_POWERS = {
    "specular_power_squaring": (specular_power_squaring, "specular_power_squaring.last"),
    "specular_power_schlick": (specular_power_schlick, "specular_power_schlick.quotient"),
}


@_only(*_POWERS)
async def power_random(dut):
    """Random operands and exponents, all versines near both ends, and random words as n."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    v = np.concatenate([
        np.arange(20000), C.versine.max - np.arange(20000), _edges(C.versine, rng, RANDOM),
    ])  # fmt: skip
    one = C.exponent.one
    special = (np.array([1, 1.5, 2, 10, 20, 32, 64, 127, 127.5, 128]) * one).astype(np.int64)
    n = rng.integers(one, 128 * one + 1, len(v))
    n = np.where(rng.random(len(v)) < 0.5, rng.choice(special, len(v)), n)
    n = np.where(rng.random(len(v)) < 0.05, rng.integers(0, C.exponent.max + 1, len(v)), n)
    trace = {}
    _POWERS[MODULE][0](v, n, C, trace)
    await tb.check([v, n], trace, NOTE)


@_only("specular_power_squaring")
async def power_halves(dut):
    """Products just below 1/2, where a wrong sign of a word would be visible."""
    tb = UnitTB(dut, MODULE)
    rng = np.random.default_rng(SEED)
    near_v, near_n = [], []
    for _ in range(8):
        v = rng.integers(0, C.versine.one, 1 << 19)
        n = rng.integers(1, 128, len(v)) * C.exponent.one
        trace = {}
        specular_power_squaring(v, n, C, trace)
        near = np.zeros(len(v), bool)
        for j in range(C.exponent.integer - 2):
            base, result = trace[f"specular_power_squaring.stage_{j}"]
            for product in (base * base, base * result):
                below = (1 << (2 * C.power.bits - 1)) - product
                near |= (below > 0) & (below <= 1 << (C.power.bits - 1))
        near_v.append(v[near])
        near_n.append(n[near])
    v, n = np.concatenate(near_v), np.concatenate(near_n)
    assert len(v) > 20, f"only {len(v)} vectors are near 1/2; {NOTE}"
    trace = {}
    specular_power_squaring(v, n, C, trace)
    await tb.check([v, n], trace, NOTE)


@_only(*_POWERS)
async def power_latency(dut):
    """A single operand or exponent changes the output in the cycle of the stated latency only."""
    tb = UnitTB(dut, MODULE)
    some, one = C.versine.one // 16, C.exponent.one
    stage = _POWERS[MODULE][1]
    await tb.check_latency([0, 2 * one], [some, 2 * one], stage)
    await tb.check_latency([some, 2 * one], [some, 5 * one], stage)
    await tb.check_latency([some, 2 * one], [some, 128 * one], stage)
