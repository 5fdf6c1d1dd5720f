# SPDX-License-Identifier: MIT
"""Twin of rtl/core/specular_power.v: cos(s)**n by the method that the configuration names."""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.specular_power_tables import specular_power_tables
from phong75.model.twin.methods.specular_power_schlick import specular_power_schlick
from phong75.model.twin.methods.specular_power_squaring import specular_power_squaring

METHODS = {
    "tables": specular_power_tables,
    "squaring": specular_power_squaring,
    "schlick": specular_power_schlick,
}


def specular_power(v: Ints, n: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """cos(s)**n, int64[n] in `power` (u0.18), of v = 1 - cos(s) in `versine` (u0.22) and n in
    `exponent` (u8.9), 1 to 128."""
    return METHODS[config.power_method](v, n, config, trace)
