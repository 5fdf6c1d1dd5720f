"""Twin of rtl/specular_power_tables.v: cos(s)**n = 2**(-n * -log2(1 - v)), v = 1 - cos(s)."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.tables import exp_table, log_table
from phong75.model.twin.core.specular_cosine import specular_cosine


def leading_ones(v, config: Config):
    """Stage 1: cos(s) = 2**-e (1 - t), 0 <= t < 1/2: e is the number of leading ones of v.

    Without `log_octaves` e is at most 1, and where it is 1 the power vanishes whatever t is.
    """
    if not config.log_octaves:
        top = config.versine.bits - 1
        return v >> top, v & ((1 << top) - 1)
    ones = config.versine.max - v
    e = config.versine.bits - fixed.bit_length(ones)
    return e, (v << e) & config.versine.max


def log_lookup(t, config: Config):
    """Stage 2: table line of -log2(1 - t) and offset in the segment."""
    offset_bits = config.versine.bits - 1 - config.log_index_bits
    table = log_table(config)
    address = (t >> offset_bits) & ((1 << config.log_index_bits) - 1)
    offset = t & ((1 << offset_bits) - 1)
    return np.take(table.value, address), np.take(table.slope, address), offset


def log_refine(e, value, slope, offset, config: Config):
    """Stage 3: -log2(cos s) = e + value + slope * offset, in units of `log_value`."""
    offset_bits = config.versine.bits - 1 - config.log_index_bits
    return (e << config.log_value.fraction) + value + ((slope * offset) >> offset_bits)


def log_bits(config: Config) -> int:
    """Width of -log2(cos s): up to `versine.bits` + 1 (without `log_octaves` below 2), with the
    fraction of `log_value`."""
    most = config.versine.bits if config.log_octaves else 1
    return config.log_value.fraction + most.bit_length()


def log_normalize(g, config: Config):
    """Stage 4: the top `log_mantissa_bits` of g below its leading zeros, and their number."""
    most = log_bits(config) - config.log_mantissa_bits
    k = np.minimum(log_bits(config) - fixed.bit_length(g), most)
    return (g << k) >> most, k


def times_exponent(mantissa, k, n, config: Config):
    """Stage 5: n * -log2(cos s) in `power_log`, cut; saturated where the power vanishes."""
    most = log_bits(config) - config.log_mantissa_bits
    drop = config.log_value.fraction + config.exponent.fraction - config.power_log.fraction - most
    return np.minimum((mantissa * n) >> (drop + k), config.power_log.max)


def exp_lookup(x, config: Config):
    """Stage 6: table line of 2**-f for the fraction f of x, offset, and the integer part."""
    offset_bits = config.power_log.fraction - config.exp_index_bits
    table = exp_table(config)
    address = (x >> offset_bits) & ((1 << config.exp_index_bits) - 1)
    offset = x & ((1 << offset_bits) - 1)
    whole = x >> config.power_log.fraction
    return np.take(table.value, address), np.take(table.slope, address), offset, whole


def exp_refine(value, slope, offset, config: Config):
    """Stage 7: 2**-f in `exp_value`."""
    return value - ((slope * offset) >> (config.power_log.fraction - config.exp_index_bits))


def exp_shift(line, whole, config: Config):
    """Stage 8: 2**-x in `power`: shifted by the integer part, rounded, saturated below 1."""
    drop = config.exp_value.fraction - config.power.fraction
    return fixed.saturate(fixed.round_shift(line >> whole, drop), config.power)


def bypass(power, v, n, config: Config):
    """Stage 9: for n = 1 cos(s) itself in place of the power."""
    if not config.power_bypass:
        return power
    return np.where(n == config.exponent.one, specular_cosine(v, config), power)


def specular_power_tables(v, n, config: Config, trace: dict | None = None):
    """cos(s)**n, int64[n] in `power`, from v (`versine`) and n (`exponent`, 1 to 128)."""
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
