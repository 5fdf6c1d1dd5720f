# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/light_attenuation.v: N.L and the highlight, times a factor of the distance.

Warnock's first effect (Phong 1975, "Warnock's shading"): "decreasing intensity of the reflected
light from the object with the distance between the light source and the object". The factor is
straight between equally spaced distances, in a table of its own for each light. The factor scales
both terms of the light's sum, the cosine law and the highlight, but not the ambient light.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.twin.core.specular_weight import specular_weight
from phong75.model.twin.primitives.round_saturate import round_saturate


def place(depth: Ints, config: Config) -> Ints:
    """Stage 1: the place in the table, int64[n] in the width of `cosine` (u0.18): the depth, cut,
    and clamped to the table."""
    cut = depth >> (config.depth.fraction - config.cosine.fraction)
    return np.clip(cut, 0, config.cosine.max)


def scale(word: Ints, factor: Ints, config: Config) -> Ints:
    """Stage 3: `word`, int64[n] (u0.18), times the `factor` in `weight` (u1.17), rounded half up in
    the format of the word."""
    return round_saturate(word * factor, config.weight.fraction, config.cosine)


def light_attenuation(
    depth: Ints, light: int, cosine: Ints, highlight: Ints, frame: Frame, config: Config,
    trace: Trace | None = None,
) -> tuple[Ints, Ints]:  # fmt: skip
    """N.L int64[n] in `cosine` and W(i) cos(s)**n int64[n] in `highlight` (u0.18 both), each times
    the factor of the distance.

    depth: int64[n] in `depth` (s1.29), the interpolated distance. light: number of the light.
    cosine, highlight: before. frame: has the table of the factors.
    """
    assert frame.falloff is not None
    at = place(depth, config)
    factor = specular_weight(at, np.full_like(at, light), frame.falloff, config)
    scaled = scale(cosine, factor, config), scale(highlight, factor, config)
    if trace is not None:
        trace["light_attenuation.factor"] = (factor,)
        trace["light_attenuation.scale"] = scaled
    return scaled
