# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/light_map.v: what the write port holds beside `register_map`, for lights.

`phong75.model.registers` gives the address map: the number of a light stands above the address that
`register_map` decodes.
"""

from __future__ import annotations

from typing import NamedTuple

from phong75.model.config import Config
from phong75.model.registers import FIELDS
from phong75.model.twin.core.register_map import register_map, unsupported_write
from phong75.model.twin.reflectance.reflectance_map import reflectance_map

#: Fields that each light has for itself.
OF_A_LIGHT = ("diffuse", "highlight", "half_x", "half_z", "attenuation")


class LightDestination(NamedTuple):
    """Where a write goes: the number of the `light`, 0 for fields that all lights share; the field
    `name`, `material` and `entry` as of `register_map`; for `attenuation`, `entry` is the interval
    of the table."""

    light: int
    name: str
    material: int
    entry: int


def light_map(address: int, config: Config) -> LightDestination:
    """Decode `address` of the write port.

    In builds with jumps the fields of the factors are `reflectance_map`'s; they are not decoded
    here.
    """
    below = 1 + config.material_bits + config.weight_index_bits
    index = address & ((1 << config.weight_index_bits) - 1)
    light = address >> below & ((1 << config.light_bits) - 1)
    is_field, jumps = address >> (below - 1) & 1, config.curve_jumps + config.weight_jumps
    is_factor = is_field and not jumps and index >= FIELDS["attenuation"]
    if config.weight_index_bits > 4 and is_factor:
        material = address >> config.weight_index_bits & (config.materials - 1)
        interval = (material << 4 | index & 15) & ((1 << config.weight_index_bits) - 1)
        return LightDestination(light, "attenuation", 0, interval)
    to = register_map(address & ((1 << below) - 1), config)
    return LightDestination(light if to.name in OF_A_LIGHT else 0, *to)


def unsupported_light_write(address: int, word: int, built: Config) -> bool:
    """Whether the RTL of `built`, which sums lights, flags a write of `word` to `address`.

    Beside what `register_map` flags, these are writes for a light that is not built, more lights
    than are built, and a coloured highlight that is left out.
    """
    below = 1 + built.material_bits + built.weight_index_bits
    if not reflectance_map(address, built).plain:
        return False
    if unsupported_write(address & ((1 << below) - 1), word, built):
        return True
    to = light_map(address, built)
    if to.light >= built.lights:
        return True
    if to.name in ("half_x", "half_z"):
        return built.span_half_vector and built.specular
    if to.name == "attenuation":
        return not built.attenuation and word != built.coefficient.one
    if to.name == "control":
        return built.lights > 1 and (word >> 1 & 7) >= built.lights
    if to.name == "highlight" and built.specular:
        code = word & built.coefficient.max
        left_out = not built.highlight_colour and code != built.coefficient.one
        return left_out or (to.entry > 0 and built.channels < 3)
    return False
