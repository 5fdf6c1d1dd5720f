"""Twin of rtl/shading_unit.v: the paper's eq. (3) for red, green and blue.

S = Cp [cos(i) (1 - d) + d] + W(i) cos(s)**n = Cp d + Cp (1 - d) cos(i) + W(i) cos(s)**n
"""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.twin.core.reflection import reflection
from phong75.model.twin.core.specular_cosine import specular_cosine
from phong75.model.twin.core.specular_power import specular_power
from phong75.model.twin.core.specular_weight import constant_weight, specular_weight
from phong75.model.twin.core.versine_of_cross import versine_of_cross


def coefficients(column, constant, material, config: Config):
    """Codes int64[channels, n] of the materials int[n], from a `column` of the table (int64[M, 3])
    or from the `constant` of the build."""
    if constant:
        codes = np.array(constant)[: config.channels, None]
        return np.repeat(codes, len(material), axis=1)
    return np.stack([np.take(channel, material) for channel in column.T[: config.channels]])


def intensity(ambient, diffuse, cosine, weight, power, lit, config: Config):
    """Stage: S per channel, int64[channels, n], all products whole; clamped to 1, cut to
    `intensity`."""
    coefficient, cos, power_f = config.coefficient, config.cosine, config.power
    fraction = config.weight.fraction + power_f.fraction
    lit = lit.astype(np.int64)
    s = diffuse * (cosine * lit) if config.diffuse else np.zeros_like(ambient)
    s <<= fraction - coefficient.fraction - cos.fraction
    if config.ambient:
        s += ambient << (fraction - coefficient.fraction)
    if config.specular:
        s += weight * power * lit
    return np.minimum(s, 1 << fraction) >> (fraction - config.intensity.fraction)


def code(s, config: Config):
    """Stage: floor(255 S + 1/2), linear, no gamma."""
    white = (1 << config.colour_bits) - 1
    return fixed.round_shift(s * white, config.intensity.fraction)


def shading_unit(
    unit, cosine, lit, material, frame, config: Config, trace: dict | None = None,
    given_versine=None,
):  # fmt: skip
    """Codes of red, green, blue, int64[3, n].

    unit: int64[3, n] in `unit`, as `normalizer` gives it; cosine: Zn in `cosine`; lit: bool[n];
    material: int[n]; frame: model.frame.Frame (registers and material table); given_versine:
    int64[n] in `versine`, in place of unit by the method `quadratic_spans`.
    """
    table = frame.materials
    power = weight = np.zeros_like(cosine)
    if config.specular:
        if config.normal_method == "quadratic_spans":
            v = given_versine
        elif config.normal_method == "dot_first":
            v = versine_of_cross(unit[1], unit[0], config)
        else:
            half_vector = config.constant_half_vector or frame.half_vector
            v = reflection(unit, half_vector, config, trace)
        if config.power_function:
            n = config.constant_exponent or table.exponent[material]
            power = specular_power(v, np.broadcast_to(n, v.shape), config, trace)
        else:
            power = specular_cosine(v, config, trace)
        if config.weight_function:
            weight = specular_weight(cosine, material, table.weight, config, trace)
        else:
            left = config.constant_weight or table.weight[material, 0]
            weight = constant_weight(np.broadcast_to(left, v.shape), config)
    s = intensity(
        coefficients(table.ambient, config.constant_ambient, material, config),
        coefficients(table.diffuse, config.constant_diffuse, material, config),
        cosine, weight, power, lit, config,
    )  # fmt: skip
    colour = code(s, config)
    if trace is not None:
        trace["shading_unit.intensity"] = tuple(s)
        trace["shading_unit.code"] = tuple(colour)
    return np.broadcast_to(colour, (3, colour.shape[1]))
