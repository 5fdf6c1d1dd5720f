# SPDX-License-Identifier: MIT
"""The write port of the pipeline: its address map, and the writes that set up a frame.

An address is {kind, material, index}: 1 bit, `material_bits` and `weight_index_bits`.

- Kind 0: interval `index` of the table W(i) of a material. The word is {step, left}: the point at
  the left of the interval in `coefficient` (u1.16) and the step to the next point, signed.
- Kind 1: `index` is one of `FIELDS` of a material. The word is a code, from bit 0 up. The fields
  half_x, half_z and control are registers; any material addresses them. Bit 0 of control is 1 for a
  two-sided frame.

In a build for several lights the number of a light stands above: {light, kind, material, index}.
The fields diffuse, highlight, half_x and half_z belong to a light; any light addresses the others.
Bits 3 to 1 of control hold the number of the frame's lights minus 1.

In a build with curves of cos(s) one more bit stands at the top. If it is 1, the address is
{1, zeros, material, line}, the word {step, left} as for W(i). In a build with jumps the fields
weight_jump and curve_jump hold two words a jump: {above, threshold}, then the amount in
`coefficient` (u1.16).
Where lights fall with the distance, interval k of a light's table of factors is at the field
attenuation + k mod 16 of the material k div 16. The word is {step, left} as for W(i). No build has
both jumps and factors, so that these fields may be the same.
"""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.reflectance import power_words

#: Index of each field at addresses of kind 1. Ambient, diffuse and highlight take three each: red,
#: green, blue. weight_jump and curve_jump take two for each of MAX_JUMPS jumps.
FIELDS = {
    "ambient": 0, "diffuse": 3, "exponent": 6, "half_x": 8, "half_z": 9, "control": 10,
    "highlight": 11, "weight_jump": 16, "curve_jump": 24, "attenuation": 16,
}  # fmt: skip


def address_bits(config: Config) -> int:
    """Width of the write port's address, in bits."""
    plain = config.light_bits + 1 + config.material_bits + config.weight_index_bits
    if not config.has_curves:
        return plain
    return 1 + max(plain, config.material_bits + config.segment_bits)


def word_bits(config: Config) -> int:
    """Width of the write port's word, in bits: {step, left} of an interval of W(i)."""
    return 2 * config.coefficient.bits + 1


def writes(frame: Frame, config: Config) -> list[tuple[int, int]]:
    """(address, word) of every write that `frame` needs on the build `config`: the registers, and
    the materials that spans name.

    A value that the build leaves out, or holds as a constant, is written only if the frame needs
    another one; the RTL answers such a write with `unsupported`. Spans of intensities need no
    writes. Raises ValueError if the frame has more lights than the build.
    """
    if config.technique != "phong":
        return []
    if frame.lights > config.lights:
        raise ValueError(f"{frame.lights} lights in a build for {config.lights}")
    kind = 1 << (config.material_bits + config.weight_index_bits)
    word_mask = (1 << word_bits(config)) - 1
    table = frame.materials
    out = []

    def write(name: str, word: int, needed: bool, base: int = 0, channel: int = 0) -> None:
        if needed:
            out.append((kind | base | (FIELDS[name] + channel), int(word) & word_mask))

    hx, hz = frame.half_vector
    differs = config.specular and (hx, hz) != tuple(config.constant_half_vector)
    differs = differs and not config.span_half_vector
    write("half_x", hx, differs)
    write("half_z", hz, differs)
    control = frame.two_sided | (frame.lights - 1) << 1
    write("control", control, config.two_sided or frame.two_sided or config.light_bits > 0)
    for material in np.unique(frame.spans["material"]).tolist():
        base = material << config.weight_index_bits
        ambient, diffuse = table.ambient[material], table.diffuse[material]
        for c in range(3):
            alike = c and ambient[c] == ambient[0] and diffuse[c] == diffuse[0]
            there = config.channels == 3 or not alike
            for name, code, constant, term in (
                ("ambient", ambient[c], config.constant_ambient, config.ambient),
                ("diffuse", diffuse[c], config.constant_diffuse, config.diffuse),
            ):
                known = code == (constant[c] if constant else 0 if not term else -1)
                write(name, code, there and not known, base, c)
        n = int(table.exponent[material])
        known = config.constant_exponent or (
            () if config.power_function else (config.exponent.one,)
        )
        by_exponent = config.specular and not config.has_curves
        write("exponent", n, by_exponent and (n,) != tuple(known), base)
        points = table.weight[material].tolist()
        known = config.constant_weight or (() if config.specular else (0,))
        for k in range(config.weight_points - 1):
            step = points[k + 1] - points[k]
            if config.weight_function or step or (k == 0 and (points[0],) != tuple(known)):
                word = (step << config.coefficient.bits | points[k]) & word_mask
                out.append((base | k, word))
    if config.specular:
        out += _reflectance_writes(frame, config)
    return out + (_light_writes(frame, config) if config.sums_lights else [])


def _reflectance_writes(frame: Frame, config: Config) -> list[tuple[int, int]]:
    """The writes of the curves of cos(s), and of the jumps."""
    out = []
    table, top = frame.materials, 1 << (address_bits(config) - 1)
    kind = 1 << (config.material_bits + config.weight_index_bits)
    used = np.unique(frame.spans["material"])
    if config.has_curves:
        curves = table.curve[used] if table.curve is not None else power_words(
            table.exponent[used], config
        )  # fmt: skip
        step_mask = (1 << (config.coefficient.bits + 1)) - 1
        for material, lines in zip(used.tolist(), curves.tolist(), strict=True):
            for k, (left, step) in enumerate(lines):
                word = (step & step_mask) << config.coefficient.bits | left
                out.append((top | material << config.segment_bits | k, word))
    for name, jumps, count, operand in (
        ("weight_jump", table.weight_jumps, config.weight_jumps, config.cosine),
        ("curve_jump", table.curve_jumps, config.curve_jumps, config.versine),
    ):
        for material in used.tolist():
            for k in range(count):
                above, threshold, amount = (0, 0, 0) if jumps is None else jumps[material, k]
                field = kind | material << config.weight_index_bits | FIELDS[name] + 2 * k
                out.append((field, int(above) << operand.bits | int(threshold)))
                out.append((field + 1, int(amount)))
    return out


def _light_writes(frame: Frame, config: Config) -> list[tuple[int, int]]:
    """The writes of the further lights, and of the colours of all lights' highlights."""
    out = []
    above = 1 + config.material_bits + config.weight_index_bits
    half_mask = (1 << config.half_vector.bits) - 1

    def write(light: int, name: str, word: int, material: int = 0, channel: int = 0) -> None:
        field = material << config.weight_index_bits | (FIELDS[name] + channel)
        out.append((light << above | 1 << (above - 1) | field, int(word)))

    used = np.unique(frame.spans["material"]).tolist()
    for number in range(frame.lights):
        light = frame.light(number, config)
        if frame.falloff is not None or config.attenuation:
            out += _falloff_writes(number, frame, config)
        if number and config.specular and not config.span_half_vector:
            for name, code in zip(("half_x", "half_z"), light.half_vector, strict=True):
                write(number, name, code & half_mask)
        for material in used:
            for name, codes, there, neutral in (
                ("diffuse", light.diffuse[material], config.diffuse, 0),
                ("highlight", light.highlight[material], config.highlight_colour,
                 config.coefficient.one),
            ):  # fmt: skip
                if (name == "diffuse" and not number) or (
                    name == "highlight" and not config.specular
                ):
                    continue
                for channel, code in enumerate(codes.tolist()):
                    needed = there or code != neutral
                    if needed and (channel < config.channels or code != codes[0]):
                        write(number, name, code, material, channel)
    return out


def _falloff_writes(number: int, frame: Frame, config: Config) -> list[tuple[int, int]]:
    """The writes of the factors of the light `number`: 1 at all distances if the frame has none."""
    points = [config.coefficient.one] * config.weight_points
    if frame.falloff is not None:
        points = frame.falloff[number].tolist()
    above = 1 + config.material_bits + config.weight_index_bits
    word_mask, out = (1 << word_bits(config)) - 1, []
    for k in range(config.weight_points - 1):
        field = (k >> 4) << config.weight_index_bits | (FIELDS["attenuation"] + (k & 15))
        word = ((points[k + 1] - points[k]) << config.coefficient.bits | points[k]) & word_mask
        out.append((number << above | 1 << (above - 1) | field, word))
    return out
