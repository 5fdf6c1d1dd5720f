# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/unnormalized.v: the interpolated vector in place of the unit normal."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.normalizer import lit
from phong75.model.twin.primitives.round_saturate import round_saturate


def round_unit(normal: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 1: the components int64[3, n] in `unit` (s0.17) and |Zn| int64[n] in `cosine` (u0.18),
    rounded and clamped. normal: int64[3, n] in `normal` (s1.30)."""
    fraction = config.normal.fraction
    unit = round_saturate(normal, fraction - config.unit.fraction, config.unit)
    cosine = round_saturate(np.abs(normal[2]), fraction - config.cosine.fraction, config.cosine)
    return unit, cosine


def unnormalized(
    normal: Ints, two_sided: bool, config: Config, trace: Trace | None = None
) -> tuple[Ints, Ints, Flags]:
    """What `normalizer` returns, for the vectors `normal` as they are (int64[3, n], s1.30)."""
    unit, cosine = round_unit(normal, config)
    is_lit = lit(normal, two_sided)
    if trace is not None:
        trace["unnormalized.round"] = (*unit, cosine)
        trace["unnormalized.lit"] = (is_lit.astype(np.int64),)
    return unit, cosine, is_lit
