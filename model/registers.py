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

    None where intensities come with the spans.
    """
    if config.technique != "phong":
        return []
    kind = 1 << (config.material_bits + config.weight_index_bits)
    word_mask = (1 << word_bits(config)) - 1
    table = frame.materials
    out = [
        (kind | FIELDS["half_x"], frame.half_vector[0] & word_mask),
        (kind | FIELDS["half_z"], frame.half_vector[1] & word_mask),
        (kind | FIELDS["control"], int(frame.two_sided)),
    ]
    for material in np.unique(frame.spans["material"]).tolist():
        base = material << config.weight_index_bits
        for c in range(3):
            out.append((kind | base | (FIELDS["ambient"] + c), int(table.ambient[material, c])))
            out.append((kind | base | (FIELDS["diffuse"] + c), int(table.diffuse[material, c])))
        out.append((kind | base | FIELDS["exponent"], int(table.exponent[material])))
        points = table.weight[material].tolist()
        for k in range(config.weight_points - 1):
            step = points[k + 1] - points[k]
            word = (step << config.coefficient.bits | points[k]) & word_mask
            out.append((base | k, word))
    return out
