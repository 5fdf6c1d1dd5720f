# SPDX-License-Identifier: MIT
"""Twin of rtl/core/shading_unit.v: eq. (3) of the paper for red, green and blue.

S = Cp [cos(i) (1 - d) + d] + W(i) cos(s)**n = Cp d + Cp (1 - d) cos(i) + W(i) cos(s)**n
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.twin.core.colour_channel import coefficient, colour_channel
from phong75.model.twin.core.reflection import reflection
from phong75.model.twin.core.specular_factors import specular_factors
from phong75.model.twin.core.versine_of_cross import versine_of_cross


def specular_term(
    unit: Ints, cosine: Ints, material: Ints, frame: Frame, config: Config,
    trace: Trace | None = None, given_versine: Ints | None = None,
) -> Ints:  # fmt: skip
    """W(i) cos(s)**n, int64[n], the product of `weight` and `power` (u1.35). Arguments as in
    `shading_unit`."""
    if given_versine is not None:
        v = given_versine
    elif config.normal_method == "dot_first":
        v = versine_of_cross(unit[1], unit[0], config)
    else:
        v = reflection(unit, config.constant_half_vector or frame.half_vector, config, trace)
    power, weight = specular_factors(v, cosine, material, frame, config, trace)
    return weight * power


def shading_unit(
    unit: Ints, cosine: Ints, lit: Flags, material: Ints, frame: Frame, config: Config,
    trace: Trace | None = None, given_versine: Ints | None = None,
) -> Ints:  # fmt: skip
    """Codes of red, green, blue, int64[3, n] of `colour_bits`.

    unit: int64[3, n] in `unit` (s0.17), from `normalizer`. cosine: int64[n], cos(i) = Zn in
    `cosine` (u0.18). lit: bool[n]. material: int64[n]. frame: registers and material table.
    given_versine: int64[n], 1 - cos(s) in `versine` (u0.22), if `quadratic_normalizer` computed it;
    then `unit` is not read.
    """
    specular = np.zeros_like(cosine)
    if config.specular:
        specular = specular_term(unit, cosine, material, frame, config, trace, given_versine)
    table = frame.materials
    colour = colour_channel(
        coefficient(table.ambient, config.constant_ambient, material, config),
        coefficient(table.diffuse, config.constant_diffuse, material, config),
        cosine, specular, lit, config, trace,
    )  # fmt: skip
    return np.broadcast_to(colour, (3, colour.shape[1]))
