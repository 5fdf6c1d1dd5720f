# SPDX-License-Identifier: MIT
"""Twin of rtl/core/colour_channel.v: eq. (3) of the paper for one colour, summed and coded.

S = Cp d + Cp (1 - d) cos(i) + W(i) cos(s)**n, code = floor(255 clamp(S, 0, 1) + 1/2)
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.primitives.round_saturate import round_half_up


def coefficient(column: Ints, constant: tuple[int, ...], material: Ints, config: Config) -> Ints:
    """Codes int64[channels, n] in `coefficient` (u1.16) of the materials int64[n].

    They come from a `column` of the material table (int64[M, 3]), or from the `constant` of the
    build if there is one.
    """
    if constant:
        codes = np.array(constant)[: config.channels, None]
        return np.repeat(codes, len(material), axis=1)
    return np.stack([np.take(channel, material) for channel in column.T[: config.channels]])


def intensity(
    ambient: Ints, diffuse: Ints, cosine: Ints, specular: Ints, lit: Flags, config: Config
) -> Ints:
    """Stage 1: S in `intensity` (u1.24), int64[channels, n]. The sum keeps all bits of the
    products, then is clamped to 1 and cut. Arguments as in `colour_channel`."""
    fraction = config.weight.fraction + config.power.fraction
    ones = lit.astype(np.int64)
    s = diffuse * (cosine * ones) if config.diffuse else np.zeros_like(ambient)
    s <<= fraction - config.coefficient.fraction - config.cosine.fraction
    if config.ambient:
        s += ambient << (fraction - config.coefficient.fraction)
    if config.specular:
        s += specular * ones
    return np.minimum(s, 1 << fraction) >> (fraction - config.intensity.fraction)


def code(s: Ints, config: Config) -> Ints:
    """Stage 2: floor(255 S + 1/2) of S in `intensity` (u1.24, any shape); linear, no gamma."""
    white = config.white
    return round_half_up(s * white, config.intensity.fraction)


def colour_channel(
    ambient: Ints, diffuse: Ints, cosine: Ints, specular: Ints, lit: Flags, config: Config,
    trace: Trace | None = None,
) -> Ints:  # fmt: skip
    """Codes int64[channels, n] of `colour_bits`, for all channels at once.

    ambient, diffuse: int64[channels, n], Cp d and Cp (1 - d) in `coefficient` (u1.16). cosine:
    int64[n], cos(i) = Zn in `cosine` (u0.18). specular: int64[n], W(i) cos(s)**n, the product of
    `weight` and `power` (u1.35). lit: bool[n]; a pixel that is not lit has the ambient term only.
    """
    s = intensity(ambient, diffuse, cosine, specular, lit, config)
    colour = code(s, config)
    if trace is not None:
        trace["colour_channel.intensity"] = tuple(s)
        trace["colour_channel.code"] = tuple(colour)
    return colour
