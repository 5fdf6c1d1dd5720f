# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/specular_power_squaring.v: cos(s)**n for whole n by repeated squaring."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.specular_cosine import specular_cosine
from phong75.model.twin.primitives.round_saturate import round_half_up, round_saturate


def whole(n: Ints, config: Config) -> Ints:
    """First, n in `exponent` (u8.9) is rounded half up to a whole number, in its integer bits."""
    return round_half_up(n, config.exponent.fraction) & ((1 << config.exponent.integer) - 1)


def square(base: Ints, config: Config) -> Ints:
    """In every stage: the square of `base` in `power` (u0.18), rounded."""
    return round_saturate(base * base, config.power.bits, config.power)


def times(result: Ints, base: Ints, some: Flags, bit: Flags, config: Config) -> Ints:
    """In every stage: `result` times `base` (both in `power`) where n has the stage's bit, else
    `result`.

    some: whether n has a lower bit. The first bit that n has takes `base` itself.
    """
    product = round_saturate(result * base, config.power.bits, config.power)
    return np.where(bit, np.where(some, product, base), result)


def specular_power_squaring(v: Ints, n: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """cos(s)**n, int64[n] in `power` (u0.18), of v = 1 - cos(s) in `versine` (u0.22) and n in
    `exponent` (u8.9), 1 to 128.

    Above 128, the result depends on bit 7 of n only; n = 0 gives the largest code.
    """
    bits = whole(n, config)
    base = specular_cosine(v, config)
    result = np.full_like(base, config.power.max)
    some = np.zeros(base.shape, bool)
    last = config.exponent.integer - 1
    for j in range(last):
        bit = (bits >> j & 1).astype(bool)
        result = times(result, base, some, bit, config)
        some |= bit
        base = square(base, config)
        if trace is not None:
            trace[f"specular_power_squaring.stage_{j}"] = (base, result)
    result = np.where(bits >> last & 1, base, result)
    if trace is not None:
        trace["specular_power_squaring.last"] = (result,)
    return result
