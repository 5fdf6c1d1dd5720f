"""Twin of rtl/unnormalized.v: the interpolated vector itself in place of the unit normal."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.twin.core.normalizer import lit


def round_unit(normal, config: Config):
    """Stage 1: the components in `unit` and |Zn| in `cosine`, rounded and saturated."""
    fraction = config.normal.fraction
    unit = fixed.saturate(fixed.round_shift(normal, fraction - config.unit.fraction), config.unit)
    cosine = fixed.round_shift(np.abs(normal[2]), fraction - config.cosine.fraction)
    return unit, fixed.saturate(cosine, config.cosine)


def unnormalized(normal, two_sided: bool, config: Config, trace: dict | None = None):
    """What `normalizer` returns, for the vectors `normal` as they are (int64[3, n])."""
    unit, cosine = round_unit(normal, config)
    if trace is not None:
        trace["unnormalized.round"] = (*unit, cosine)
        trace["unnormalized.lit"] = (lit(normal, two_sided).astype(np.int64),)
    return unit, cosine, lit(normal, two_sided)
