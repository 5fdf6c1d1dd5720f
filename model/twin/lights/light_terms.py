# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/light_terms.v: what one light adds to one colour of a pixel.

kd Ld (N.L) + ks Ls W(i) cos(s)**n: diffuse and specular reflection of light l in the illumination
model of OpenGL's lecture notes; the material table holds the products kd Ld and ks Ls.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config


def fraction_bits(config: Config) -> int:
    """Fraction bits of a term: those of W(i) cos(s)**n before any rounding."""
    return config.weight.fraction + config.power.fraction


def light_terms(
    diffuse: Ints, colour: Ints, cosine: Ints, highlight: Ints, lit: Flags, config: Config,
    trace: Trace | None = None,
) -> Ints:  # fmt: skip
    """The two terms together, int64[channels, n] (u2.35); all bits are kept.

    diffuse, colour: int64[channels, n], kd Ld and ks Ls in `coefficient` (u1.16). cosine: int64[n]
    in `cosine` (u0.18). highlight: int64[n], see `light_highlight`. lit: bool[n]; a pixel that the
    light does not reach gets nothing of it.
    """
    fraction = fraction_bits(config)
    ones = lit.astype(np.int64)
    term = diffuse * (cosine * ones) if config.diffuse else 0 * diffuse
    term <<= fraction - config.coefficient.fraction - config.cosine.fraction
    if config.specular and config.highlight_colour:
        coloured = colour * (highlight * ones)
        term += coloured << (fraction - config.coefficient.fraction - config.highlight.fraction)
    elif config.specular:
        whole = fraction - config.highlight.fraction if config.rounds_highlight else 0
        term += (highlight * ones) << whole
    if trace is not None:
        trace["light_terms.sum"] = tuple(term)
    return term
