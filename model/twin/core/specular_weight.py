"""Twin of rtl/specular_weight.v: W(i), straight lines between equally spaced points in Zn."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config


def lookup(cosine, material, weight, config: Config):
    """Stage 1: left point, step to the next point (int64[M, P] `weight`), offset between them."""
    offset_bits = config.cosine.bits - config.weight_index_bits
    k = cosine >> offset_bits
    place = material * weight.shape[1] + k
    left = np.take(weight, place)
    return left, np.take(weight, place + 1) - left, cosine & ((1 << offset_bits) - 1)


def interpolate(left, step, offset, config: Config):
    """Stage 2: left + step * offset, one product kept whole, rounded once to `weight`."""
    offset_bits = config.cosine.bits - config.weight_index_bits
    drop = offset_bits + config.coefficient.fraction - config.weight.fraction
    return fixed.round_shift((left << offset_bits) + step * offset, drop)


def specular_weight(cosine, material, weight, config: Config, trace: dict | None = None):
    """W(i), int64[n] in `weight`, from Zn (`cosine`), material indices and the table of points."""
    left, step, offset = lookup(cosine, material, weight, config)
    w = interpolate(left, step, offset, config)
    if trace is not None:
        trace["specular_weight.lookup"] = (left, step, offset)
        trace["specular_weight.interpolate"] = (w,)
    return w


def constant_weight(left, config: Config):
    """W in `weight` where it does not depend on i: its left point (`coefficient`), exact."""
    return left << (config.weight.fraction - config.coefficient.fraction)
