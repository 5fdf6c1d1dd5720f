# SPDX-License-Identifier: MIT
"""Twin of rtl/techniques/intensity_code.v: the code of an interpolated intensity."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.colour_channel import code


def clamp(value: Ints, config: Config) -> Ints:
    """Stage 1: S in `normal` (s1.30, any shape), clamped to [0, 1] and cut to `intensity`
    (u1.24)."""
    drop = config.normal.fraction - config.intensity.fraction
    return np.clip(value, 0, config.normal.one) >> drop


def intensity_code(value: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """floor(255 clamp(S, 0, 1) + 1/2) of S in `normal` (s1.30), int64 of any shape."""
    s = clamp(value, config)
    colour = code(s, config)
    if trace is not None:
        trace["intensity_code.clamp"] = (s,)
        trace["intensity_code.code"] = (colour,)
    return colour
