"""Twin of rtl/specular_power_method.v: cos(s)**n by the method that the configuration names."""

from __future__ import annotations

from ..config import Config
from .power_schlick import power_schlick
from .power_squaring import power_squaring
from .specular_power import specular_power

METHODS = {"tables": specular_power, "squaring": power_squaring, "schlick": power_schlick}


def specular_power_method(v, n, config: Config, trace: dict | None = None):
    """cos(s)**n, int64[n] in `power`, from v (`versine`) and n (`exponent`, 1 to 128)."""
    return METHODS[config.power_method](v, n, config, trace)
