"""Twin of rtl/specular_power_squaring.v: cos(s)**n for whole n by repeated squaring."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.twin.core.specular_cosine import specular_cosine


def whole(n, config: Config):
    """Stage 1: n (`exponent`) rounded to a whole number, half up, in its integer bits."""
    fraction = config.exponent.fraction
    return fixed.round_shift(n, fraction) & ((1 << config.exponent.integer) - 1)


def square(base, config: Config):
    """Of every stage: the square of `base` (`power`), rounded."""
    return fixed.saturate(fixed.round_shift(base * base, config.power.bits), config.power)


def times(result, base, some, bit, config: Config):
    """Of every stage: `result` times `base` where n has this bit, else `result`.

    some: whether n has a bit below; the first one found takes `base` itself.
    """
    product = fixed.saturate(fixed.round_shift(result * base, config.power.bits), config.power)
    return np.where(bit, np.where(some, product, base), result)


def specular_power_squaring(v, n, config: Config, trace: dict | None = None):
    """cos(s)**n, int64[n] in `power`, from v (`versine`) and n (`exponent`, 1 to 128).

    Beyond 128 only bit 7 of n counts; n = 0 gives the largest code.
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
