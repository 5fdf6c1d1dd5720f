"""Twin of rtl/intensity_code.v: the code of an interpolated intensity."""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config
from phong75.model.twin.core.shading_unit import code


def clamp(value, config: Config):
    """Stage 1: S of one channel (`normal`, int64, any shape) within [0, 1], cut to `intensity`."""
    drop = config.normal.fraction - config.intensity.fraction
    return np.clip(value, 0, config.normal.one) >> drop


def intensity_code(value, config: Config, trace: dict | None = None):
    """floor(255 clamp(S, 0, 1) + 1/2) of S in `normal` (int64, any shape)."""
    s = clamp(value, config)
    colour = code(s, config)
    if trace is not None:
        trace["intensity_code.clamp"] = (s,)
        trace["intensity_code.code"] = (colour,)
    return colour
