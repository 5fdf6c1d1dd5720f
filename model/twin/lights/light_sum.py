# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/light_sum.v: one colour of a pixel: the sum over lights, clamped and coded.

I = (e + ka Ia + sum of ka La) + sum of (kd Ld (N.L) + ks Ls W(i) cos(s)**n). The first part needs
no direction and comes from the material table. The sum is whole; there is one clamp and one
rounding.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.colour_channel import code
from phong75.model.twin.lights.light_terms import fraction_bits


def intensity(ambient: Ints, terms: Ints, config: Config) -> Ints:
    """Stage 2: I in `intensity` (u1.24), clamped to 1 and cut. Arguments as of `light_sum`."""
    fraction = fraction_bits(config)
    total = terms
    if config.ambient:
        total = terms + (ambient << (fraction - config.coefficient.fraction))
    return np.minimum(total, 1 << fraction) >> (fraction - config.intensity.fraction)


def light_sum(ambient: Ints, terms: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """Codes int64[channels, n] of `colour_bits`.

    ambient: int64[channels, n] in `coefficient` (u1.16). terms: int64[channels, n], the sum of
    `light_terms` of all lights.
    """
    s = intensity(ambient, terms, config)
    colour = code(s, config)
    if trace is not None:
        trace["light_sum.clamp"] = tuple(s)
        trace["light_sum.code"] = tuple(colour)
    return colour
