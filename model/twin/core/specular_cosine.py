"""Twin of rtl/specular_cosine.v: cos(s) = 1 - v, which is cos(s)**n for n = 1."""

from __future__ import annotations

from phong75.model import fixed
from phong75.model.config import Config


def specular_cosine(v, config: Config, trace: dict | None = None):
    """cos(s), int64[n] in `power`, from v (`versine`): rounded, saturated below 1."""
    drop = config.versine.fraction - config.power.fraction
    cosine = fixed.saturate(fixed.round_shift(config.versine.one - v, drop), config.power)
    if trace is not None:
        trace["specular_cosine"] = (cosine,)
    return cosine
