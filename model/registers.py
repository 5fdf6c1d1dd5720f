"""The write port of the pipeline: its address map, and the writes that set up a frame.

An address is {kind, material, index}: kind 0 is interval `index` of W(i) of a material, kind 1 is
one of `FIELDS` of a material (the registers are fields of any material).
"""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config
from phong75.model.frame import Frame

#: Index of each field at addresses of kind 1. Ambient and diffuse take three: red, green, blue.
FIELDS = {"ambient": 0, "diffuse": 3, "exponent": 6, "half_x": 8, "half_z": 9, "control": 10}


def address_bits(config: Config) -> int:
    """Width of the write port's address."""
    return 1 + config.material_bits + config.weight_index_bits


def word_bits(config: Config) -> int:
    """Width of the write port's word: {step, left} of an interval of W(i)."""
    return 2 * config.coefficient.bits + 1


def writes(frame: Frame, config: Config) -> list[tuple[int, int]]:
    """(address, word) of every write that `frame` needs: registers and the materials in use.

    What a build leaves out is written only where the frame does need it; the RTL answers such a
    write with `unsupported`. Nothing is written where intensities come with the spans.
    """
    if config.technique != "phong":
        return []
    kind = 1 << (config.material_bits + config.weight_index_bits)
    word_mask = (1 << word_bits(config)) - 1
    table = frame.materials
    out = []

    def write(name, word, needed, base=0, channel=0):
        if needed:
            out.append((kind | base | (FIELDS[name] + channel), int(word) & word_mask))

    hx, hz = frame.half_vector
    differs = config.specular and (hx, hz) != tuple(config.constant_half_vector)
    write("half_x", hx, differs)
    write("half_z", hz, differs)
    write("control", frame.two_sided, config.two_sided or frame.two_sided)
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
        write("exponent", n, config.specular and (n,) != tuple(known), base)
        points = table.weight[material].tolist()
        known = config.constant_weight or (() if config.specular else (0,))
        for k in range(config.weight_points - 1):
            step = points[k + 1] - points[k]
            if config.weight_function or step or (k == 0 and (points[0],) != tuple(known)):
                word = (step << config.coefficient.bits | points[k]) & word_mask
                out.append((base | k, word))
    return out
