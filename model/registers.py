"""The write port of the pipeline: its address map, and the writes that set up a frame.

An address is {kind, material, index}: kind 0 is interval `index` of W(i) of a material, kind 1 is
one of `FIELDS` of a material (the registers are fields of any material).
"""

from __future__ import annotations

import numpy as np

from .config import Config
from .frame import Frame

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

    def write(name, word, base=0, channel=0, needed=True):
        if needed:
            out.append((kind | base | (FIELDS[name] + channel), int(word) & word_mask))

    write("half_x", frame.half_vector[0])
    write("half_z", frame.half_vector[1])
    write("control", frame.two_sided, needed=config.two_sided or frame.two_sided)
    for material in np.unique(frame.spans["material"]).tolist():
        base = material << config.weight_index_bits
        ambient, diffuse = table.ambient[material], table.diffuse[material]
        for c in range(3):
            alike = c and ambient[c] == ambient[0] and diffuse[c] == diffuse[0]
            if config.channels == 3 or not alike:
                for name, code, there in (
                    ("ambient", ambient[c], config.environment),
                    ("diffuse", diffuse[c], config.diffuse),
                ):
                    write(name, code, base, c, there or code)
        n = table.exponent[material]
        write("exponent", n, base, 0, config.power_function or n != config.exponent.one)
        points = table.weight[material].tolist()
        for k in range(config.weight_points - 1):
            step = points[k + 1] - points[k]
            if config.weight_function or k == 0 or step:
                word = (step << config.coefficient.bits | points[k]) & word_mask
                if config.specular or word:
                    out.append((base | k, word))
    return out
