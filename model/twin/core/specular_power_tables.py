# SPDX-License-Identifier: MIT
"""Twin of rtl/core/specular_power_tables.v: cos(s)**n = 2**(n log2(1 - v)), v = 1 - cos(s).

Two tables of straight lines give -log2 and 2**-f; a product with n stands between them.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.tables import exp_table, log_table
from phong75.model.twin.core.specular_cosine import specular_cosine
from phong75.model.twin.primitives.leading_zeros import leading_zeros
from phong75.model.twin.primitives.left_shifter import left_shifter
from phong75.model.twin.primitives.rom import rom
from phong75.model.twin.primitives.round_saturate import round_saturate


def leading_ones(v: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 1: e and t of cos(s) = 2**-e (1 - t), 0 <= t < 1/2: e is the number of leading ones of
    v, t is what follows them, in `versine` (u0.22).

    Without `log_octaves` e is at most 1; where e is 1 the power vanishes whatever t is.
    """
    if not config.log_octaves:
        top = config.versine.bits - 1
        return v >> top, v & ((1 << top) - 1)
    e = leading_zeros(config.versine.max - v, config.versine.bits)
    return e, left_shifter(v, e, config.versine.bits)


def log_lookup(t: Ints, config: Config) -> tuple[Ints, Ints, Ints]:
    """Stage 2: value and slope of -log2(1 - t) in the segment of t, and the offset of t in it."""
    offset_bits = config.versine.bits - 1 - config.log_index_bits
    table = log_table(config)
    address = (t >> offset_bits) & ((1 << config.log_index_bits) - 1)
    offset = t & ((1 << offset_bits) - 1)
    return rom(address, table.value), rom(address, table.slope), offset


def log_refine(e: Ints, value: Ints, slope: Ints, offset: Ints, config: Config) -> Ints:
    """Stage 3: g = -log2(cos s) = e + value + slope * offset, in units of `log_value` (2**-22)."""
    offset_bits = config.versine.bits - 1 - config.log_index_bits
    return (e << config.log_value.fraction) + value + ((slope * offset) >> offset_bits)


def log_bits(config: Config) -> int:
    """Width of g: the fraction of `log_value`, and integer bits for the largest e + 1."""
    most = config.versine.bits if config.log_octaves else 1
    return config.log_value.fraction + most.bit_length()


def log_normalize(g: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 4: g without its leading zeros, cut to `log_mantissa_bits`, and how many zeros were
    shifted out (no more than there are bits to cut)."""
    most = log_bits(config) - config.log_mantissa_bits
    k = np.minimum(leading_zeros(g, log_bits(config)), most)
    return (g << k) >> most, k


def times_exponent(mantissa: Ints, k: Ints, n: Ints, config: Config) -> Ints:
    """Stage 5: x = n g in `power_log` (u5.16), cut; clamped to the largest code, where the power
    is 0."""
    most = log_bits(config) - config.log_mantissa_bits
    drop = config.log_value.fraction + config.exponent.fraction - config.power_log.fraction - most
    return np.minimum((mantissa * n) >> (drop + k), config.power_log.max)


def exp_lookup(x: Ints, config: Config) -> tuple[Ints, Ints, Ints, Ints]:
    """Stage 6: value and slope of 2**-f in the segment of f, the fraction of x; the offset of f in
    it; and the integer part of x."""
    offset_bits = config.power_log.fraction - config.exp_index_bits
    table = exp_table(config)
    address = (x >> offset_bits) & ((1 << config.exp_index_bits) - 1)
    offset = x & ((1 << offset_bits) - 1)
    whole = x >> config.power_log.fraction
    return rom(address, table.value), rom(address, table.slope), offset, whole


def exp_refine(value: Ints, slope: Ints, offset: Ints, config: Config) -> Ints:
    """Stage 7: 2**-f = value - slope * offset in `exp_value` (u0.20); the product is cut."""
    return value - ((slope * offset) >> (config.power_log.fraction - config.exp_index_bits))


def exp_shift(line: Ints, whole: Ints, config: Config) -> Ints:
    """Stage 8: 2**-x in `power` (u0.18): shifted by the integer part, rounded, clamped below 1."""
    drop = config.exp_value.fraction - config.power.fraction
    return round_saturate(line >> whole, drop, config.power)


def bypass(power: Ints, v: Ints, n: Ints, config: Config) -> Ints:
    """Stage 9: where n = 1, cos(s) itself in place of the power (with `power_bypass`)."""
    if not config.power_bypass:
        return power
    return np.where(n == config.exponent.one, specular_cosine(v, config), power)


def specular_power_tables(v: Ints, n: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """cos(s)**n, int64[n] in `power` (u0.18), of v = 1 - cos(s) in `versine` (u0.22) and n in
    `exponent` (u8.9), 1 to 128."""
    e, t = leading_ones(v, config)
    value, slope, offset = log_lookup(t, config)
    g = log_refine(e, value, slope, offset, config)
    mantissa, k = log_normalize(g, config)
    x = times_exponent(mantissa, k, n, config)
    exp_value, exp_slope, exp_offset, whole = exp_lookup(x, config)
    line = exp_refine(exp_value, exp_slope, exp_offset, config)
    power = exp_shift(line, whole, config)
    result = bypass(power, v, n, config)
    if trace is not None:
        trace["specular_power_tables.leading_ones"] = (t,)
        trace["specular_power_tables.log_lookup"] = (value, slope, offset)
        trace["specular_power_tables.log_refine"] = (g,)
        trace["specular_power_tables.log_normalize"] = (mantissa,)
        trace["specular_power_tables.times_exponent"] = (x,)
        trace["specular_power_tables.exp_lookup"] = (exp_value, exp_slope, exp_offset)
        trace["specular_power_tables.exp_refine"] = (line,)
        trace["specular_power_tables.exp_shift"] = (power,)
        trace["specular_power_tables.bypass"] = (result,)
    return result
