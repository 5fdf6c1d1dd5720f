# SPDX-License-Identifier: MIT
"""Twin of rtl/reflectance/reflectance_map.v: the write port of curves and jumps."""

from __future__ import annotations

from typing import NamedTuple

from phong75.model.config import MAX_JUMPS, Config
from phong75.model.registers import FIELDS, address_bits


class ReflectanceWrite(NamedTuple):
    """Where a write goes. plain: whether register_map and light_map see it. strobes: bit 0 for a
    line of a curve; from bit 1 on, for each jump of a curve its threshold and its amount; then the
    same for the jumps of W. line: {material, line} of a curve."""

    plain: bool
    strobes: int
    line: int


def reflectance_map(address: int, config: Config) -> ReflectanceWrite:
    """Decode `address` of the write port."""
    line = address & ((1 << (config.material_bits + config.segment_bits)) - 1)
    if config.has_curves and address >> (address_bits(config) - 1):
        return ReflectanceWrite(False, 1, line)
    kind = address >> (config.material_bits + config.weight_index_bits) & 1
    field = address & ((1 << config.weight_index_bits) - 1)
    strobes = 0
    if kind:
        for name, first in (("curve_jump", 1), ("weight_jump", 1 + 2 * MAX_JUMPS)):
            if 0 <= field - FIELDS[name] < 2 * MAX_JUMPS:
                strobes |= 1 << (first + field - FIELDS[name])
    return ReflectanceWrite(True, strobes, line)
