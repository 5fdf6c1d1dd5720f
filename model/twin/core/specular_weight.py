# SPDX-License-Identifier: MIT
"""Twin of rtl/core/specular_weight.v: W(i), straight lines between equally spaced points in Zn."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.primitives.round_saturate import round_half_up


def lookup(cosine: Ints, material: Ints, weight: Ints, config: Config) -> tuple[Ints, Ints, Ints]:
    """Stage 1: the point at or left of Zn, the step to the next point, the offset between them."""
    offset_bits = config.cosine.bits - config.weight_index_bits
    k = cosine >> offset_bits
    place = material * weight.shape[1] + k
    left = np.take(weight, place)
    return left, np.take(weight, place + 1) - left, cosine & ((1 << offset_bits) - 1)


def interpolate(left: Ints, step: Ints, offset: Ints, config: Config) -> Ints:
    """Stage 2: left + step * offset in `weight` (u1.17): the product keeps all bits, the sum is
    rounded once."""
    offset_bits = config.cosine.bits - config.weight_index_bits
    drop = offset_bits + config.coefficient.fraction - config.weight.fraction
    return round_half_up((left << offset_bits) + step * offset, drop)


def specular_weight(
    cosine: Ints, material: Ints, weight: Ints, config: Config, trace: Trace | None = None
) -> Ints:
    """W(i), int64[n] in `weight` (u1.17).

    cosine: int64[n], Zn in `cosine` (u0.18). material: int64[n]. weight: int64[M, P], the points
    W of every material in `coefficient` (u1.16), `weight_points` each.
    """
    left, step, offset = lookup(cosine, material, weight, config)
    w = interpolate(left, step, offset, config)
    if trace is not None:
        trace["specular_weight.lookup"] = (left, step, offset)
        trace["specular_weight.interpolate"] = (w,)
    return w


def constant_weight(left: Ints, config: Config) -> Ints:
    """W in `weight` (u1.17) where W does not depend on i: the first point, in `coefficient`
    (u1.16), exact."""
    return left << (config.weight.fraction - config.coefficient.fraction)
