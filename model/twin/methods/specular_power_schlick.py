# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/specular_power_schlick.v: x / (n - n x + x), x = cos(s), in place of x**n
(Schlick 1994). The curve differs from the power: the picture visibly changes."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.tables import reciprocal_table
from phong75.model.twin.core.specular_cosine import specular_cosine
from phong75.model.twin.primitives.leading_zeros import leading_zeros
from phong75.model.twin.primitives.rom import rom
from phong75.model.twin.primitives.round_saturate import round_saturate


def denominator(v: Ints, n: Ints, config: Config) -> Ints:
    """Stage 1: 1 + (n - 1) v, cut to the fraction of `power` (2**-18); n below 1 counts as 1."""
    less = np.where(n < config.exponent.one, 0, n - config.exponent.one)
    v = round_saturate(v, config.versine.bits - config.power.bits, config.power)
    return config.power.one + ((less * v) >> config.exponent.fraction)


def normalize(d: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 2: m and e of d = 2**e m, 1 <= m < 2: m has its leading one in the top bit."""
    k = leading_zeros(d, config.exponent.integer + config.power.bits)
    return d << k, config.exponent.integer - 1 - k


def reciprocal(m: Ints, config: Config) -> Ints:
    """Stage 3: 1/m in `power` (u0.18), by a table of straight lines."""
    bits = config.exponent.integer + config.power.bits
    offset_bits = bits - 1 - config.reciprocal_index_bits
    table = reciprocal_table(config)
    address = (m >> offset_bits) & ((1 << config.reciprocal_index_bits) - 1)
    offset = m & ((1 << offset_bits) - 1)
    line = rom(address, table.value) - ((rom(address, table.slope) * offset) >> offset_bits)
    return round_saturate(line, config.reciprocal_value_bits - config.power.bits, config.power)


def quotient(x: Ints, r: Ints, e: Ints, config: Config) -> Ints:
    """Stage 4: x r / 2**e in `power` (u0.18): cut by the shift, then rounded."""
    return round_saturate((x * r) >> e, config.power.bits, config.power)


def specular_power_schlick(v: Ints, n: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """Schlick's curve, int64[n] in `power` (u0.18), of v = 1 - cos(s) in `versine` (u0.22) and n in
    `exponent` (u8.9)."""
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
