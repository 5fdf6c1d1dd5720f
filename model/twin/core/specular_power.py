"""Twin of rtl/specular_power.v: cos(s)**n by the method that the configuration names."""

from __future__ import annotations

from phong75.model.config import Config
from phong75.model.twin.core.specular_power_tables import specular_power_tables
from phong75.model.twin.methods.specular_power_schlick import specular_power_schlick
from phong75.model.twin.methods.specular_power_squaring import specular_power_squaring

METHODS = {
    "tables": specular_power_tables,
    "squaring": specular_power_squaring,
    "schlick": specular_power_schlick,
}


def specular_power(v, n, config: Config, trace: dict | None = None):
    """cos(s)**n, int64[n] in `power`, from v (`versine`) and n (`exponent`, 1 to 128)."""
    return METHODS[config.power_method](v, n, config, trace)
