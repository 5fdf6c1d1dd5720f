# SPDX-License-Identifier: MIT
"""Twin of rtl/core/specular_factors.v: cos(s)**n and W(i), by the methods of the configuration."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.reflectance import power_words
from phong75.model.twin.core.specular_cosine import specular_cosine
from phong75.model.twin.core.specular_power import specular_power
from phong75.model.twin.core.specular_weight import constant_weight, specular_weight
from phong75.model.twin.reflectance.reflectance_table import reflectance_table
from phong75.model.twin.reflectance.stepped_weight import stepped_weight


def specular_factors(
    v: Ints, cosine: Ints, material: Ints, frame: Frame, config: Config, trace: Trace | None = None
) -> tuple[Ints, Ints]:
    """cos(s)**n in `power` (u0.18) and W(i) in `weight` (u1.17), int64[n] each.

    v: int64[n], 1 - cos(s) in `versine` (u0.22). cosine: int64[n], cos(i) in `cosine` (u0.18).
    material: int64[n]. frame: its material table is read.
    """
    table = frame.materials
    if config.has_curves:
        curve = power_words(table.exponent, config) if table.curve is None else table.curve
        power = reflectance_table(v, material, curve, table.curve_jumps, config, trace)
    elif config.power_function:
        n = config.constant_exponent or table.exponent[material]
        power = specular_power(v, np.broadcast_to(n, v.shape), config, trace)
    else:
        power = specular_cosine(v, config, trace)
    if config.weight_function and config.weight_jumps:
        weight = stepped_weight(cosine, material, table.weight, table.weight_jumps, config, trace)
    elif config.weight_function:
        weight = specular_weight(cosine, material, table.weight, config, trace)
    else:
        left = config.constant_weight or table.weight[material, 0]
        weight = constant_weight(np.broadcast_to(left, v.shape), config)
    return power, weight
