# SPDX-License-Identifier: MIT
"""Twin of rtl/core/specular_cosine.v: cos(s) = 1 - v, which is cos(s)**n for n = 1."""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.primitives.round_saturate import round_saturate


def specular_cosine(v: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """cos(s), int64[n] in `power` (u0.18), of v = 1 - cos(s), int64[n] in `versine` (u0.22):
    rounded, clamped below 1."""
    drop = config.versine.fraction - config.power.fraction
    cosine = round_saturate(config.versine.one - v, drop, config.power)
    if trace is not None:
        trace["specular_cosine"] = (cosine,)
    return cosine
