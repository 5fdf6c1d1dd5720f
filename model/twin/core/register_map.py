# SPDX-License-Identifier: MIT
"""Twin of rtl/core/register_map.v: where a write goes, and whether a build can take it.

`phong75.model.registers` gives the address map and the writes of a frame; this module reads them.
"""

from __future__ import annotations

from typing import NamedTuple

from phong75.model.config import MAX_EXPONENT, Config
from phong75.model.registers import FIELDS
from phong75.model.twin.reflectance.reflectance_map import reflectance_map


class Destination(NamedTuple):
    """Where a write goes.

    name: `weight` for an interval of W(i), else a key of `registers.FIELDS`, or "" for an address
    that nothing listens to. material: row of the material table. entry: the interval of W(i), or
    the colour (0 to 2: red, green, blue).
    """

    name: str
    material: int
    entry: int


def register_map(address: int, config: Config) -> Destination:
    """Decode `address` of the write port."""
    index = address & ((1 << config.weight_index_bits) - 1)
    material = address >> config.weight_index_bits & (config.materials - 1)
    if address >> (config.material_bits + config.weight_index_bits) & 1 == 0:
        return Destination("weight", material, index)
    for name, first in FIELDS.items():
        colours = 3 if name in ("ambient", "diffuse", "highlight") else 1
        if first <= index < first + colours:
            return Destination(name, material, index - first)
    return Destination("", material, index)


def unsupported_write(address: int, word: int, built: Config) -> bool:
    """Whether the RTL of `built` flags a write of `word` to `address` as unsupported.

    Flagged is a word that asks for what `built` leaves out, that differs from a constant of
    `built`, or with `check_writes` that is not legal. The techniques without registers are not
    covered.
    """
    if built.technique != "phong" or not reflectance_map(address, built).plain:
        return False
    to = register_map(address, built)
    if built.check_writes and _illegal(to, word, built):
        return True
    if to.name == "weight":
        return _unsupported_weight(word, built)
    if to.name in ("half_x", "half_z"):
        constant = dict(zip(("half_x", "half_z"), built.constant_half_vector, strict=False))
        modulus = 1 << built.half_vector.bits
        return to.name in constant and (word - constant[to.name]) % modulus != 0
    if to.name == "control":
        return not built.two_sided and bool(word & 1)
    if to.name == "exponent":
        return built.specular and _unsupported_exponent(word & built.exponent.max, built)
    if to.name in ("ambient", "diffuse"):
        if to.entry and built.channels < 3:
            return True
        code = word & built.coefficient.max
        codes = getattr(built, f"constant_{to.name}")
        return (code != 0 and not getattr(built, to.name)) or (
            bool(codes) and code != codes[to.entry]
        )
    return False


def _illegal(to: Destination, word: int, built: Config) -> bool:
    """Whether `word` holds a coefficient or a point of W above 1 or below 0, or an n below 1 or
    above 128."""
    one, code = built.coefficient.one, word & built.coefficient.max
    if to.name == "weight":
        bits = built.coefficient.bits + 1
        step = word >> built.coefficient.bits & (1 << bits) - 1
        step -= step >> (bits - 1) << bits
        return code > one or not 0 <= code + step <= one
    if to.name == "exponent":
        n = word & built.exponent.max
        return built.specular and not built.exponent.one <= n <= MAX_EXPONENT * built.exponent.one
    return to.name in ("ambient", "diffuse") and code > one


def _unsupported_weight(word: int, built: Config) -> bool:
    """Of a word {step, left} of an interval of W(i)."""
    code, step = word & built.coefficient.max, word >> built.coefficient.bits
    if not built.specular:
        return word != 0
    if step != 0 and not built.weight_function:
        return True
    return bool(built.constant_weight) and code != built.constant_weight[0]


def _unsupported_exponent(n: int, built: Config) -> bool:
    """Of an exponent n in `exponent` (u8.9)."""
    if built.constant_exponent:
        return n != built.constant_exponent[0]
    if not built.power_function:
        return n != built.exponent.one
    if n == built.exponent.one:
        return not built.power_bypass
    return not built.log_octaves and n < vanishing_exponent(built)


def vanishing_exponent(config: Config) -> int:
    """The smallest n, in codes of `exponent` (u8.9), with cos(s)**n = 0 wherever cos(s) <= 1/2.

    The hardware cuts 2**-n from a word below 1 of `exp_value` and then rounds half up. The result
    is 0 once the shift by n takes the word below half an LSB of `power`.
    """
    return (config.power.fraction + 1) << config.exponent.fraction
