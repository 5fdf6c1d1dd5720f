"""Twin of rtl/methods/specular_power_schlick.v: x / (n - n x + x), x = cos(s), for cos(s)**n."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.tables import reciprocal_table
from phong75.model.twin.core.specular_cosine import specular_cosine


def denominator(v, n, config: Config):
    """Stage 1: 1 + (n - 1) v, cut to the fraction of `power`; n below 1 is taken as 1."""
    less = np.where(n < config.exponent.one, 0, n - config.exponent.one)
    drop = config.versine.bits - config.power.bits
    v = fixed.saturate(fixed.round_shift(v, drop), config.power)
    return config.power.one + ((less * v) >> config.exponent.fraction)


def normalize(d, config: Config):
    """Stage 2: d = 2**e m, 1 <= m < 2: m with the leading one in the top bit, and e."""
    bits = config.exponent.integer + config.power.bits
    k = bits - fixed.bit_length(d)
    return d << k, config.exponent.integer - 1 - k


def reciprocal(m, config: Config):
    """Stage 3: 1/m in `power`, from a table of lines."""
    bits = config.exponent.integer + config.power.bits
    offset_bits = bits - 1 - config.reciprocal_index_bits
    table = reciprocal_table(config)
    address = (m >> offset_bits) & ((1 << config.reciprocal_index_bits) - 1)
    offset = m & ((1 << offset_bits) - 1)
    line = np.take(table.value, address) - ((np.take(table.slope, address) * offset) >> offset_bits)
    drop = config.reciprocal_value_bits - config.power.bits
    return fixed.saturate(fixed.round_shift(line, drop), config.power)


def quotient(x, r, e, config: Config):
    """Stage 4: x r / 2**e in `power`, cut by the shift, then rounded."""
    return fixed.saturate(fixed.round_shift((x * r) >> e, config.power.bits), config.power)


def specular_power_schlick(v, n, config: Config, trace: dict | None = None):
    """Schlick's stand-in for cos(s)**n, int64[n] in `power`, from v (`versine`), n (`exponent`)."""
    d = denominator(v, n, config)
    m, e = normalize(d, config)
    r = reciprocal(m, config)
    result = quotient(specular_cosine(v, config), r, e, config)
    if trace is not None:
        trace["specular_power_schlick.denominator"] = (d,)
        trace["specular_power_schlick.normalize"] = (m,)
        trace["specular_power_schlick.reciprocal"] = (r,)
        trace["specular_power_schlick.quotient"] = (result,)
    return result
