# SPDX-License-Identifier: MIT
"""Errors of single stages over all of their operands: the maxima that `certificate` builds on.

Nothing is sampled here. 1/sqrt is compared with the exact value at both ends of what each of its
operands stands for. cos(s)**n is compared at every code of 1 - cos(s) for every code of n from 1 to
128; that takes minutes even in C++ (power_errors.cpp), so `phong75 prove` records it.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from phong75.model.arrays import Ints
from phong75.model.config import MAX_EXPONENT, Config
from phong75.model.tables import exp_table, log_table
from phong75.model.twin.core.inverse_sqrt import inverse_sqrt
from phong75.model.twin.core.specular_power_tables import log_bits

#: The program that exhausts cos(s)**n; it includes `power_header` as power_tables.h.
SOURCE = Path(__file__).with_name("power_errors.cpp")

#: Whole parts of n. The last one is of a single n.
WHOLE_PARTS = range(1, MAX_EXPONENT + 1)

#: How far an error that power_errors.cpp prints may be from the true one: its (1 - v)**n, at most
#: 1, is wrong by less than 2**-40; the difference from the power is rounded once.
POWER_MARGIN = 2.0**-39

#: Operands at once in `root_errors`.
BLOCK = 1 << 18


@dataclass(frozen=True)
class Stages:
    """The exhausted stages of one configuration.

    root: least and greatest relative error of |m| times the root, against 1; the operand's cut is
    part of it. power: for each whole part of n (`WHOLE_PARTS`) the least and the greatest absolute
    error of cos(s)**n against the power of its operands, `POWER_MARGIN` included.
    """

    root: tuple[float, float]
    power: dict[int, tuple[float, float]]


def root_errors(config: Config) -> tuple[float, float]:
    """Least and greatest relative error of the length of the unit normal before it is rounded.

    Each operand k of 1/sqrt stands for all |m|**2 from k to k + 1 units, since it is cut. The
    product of |m| and the root R is smallest at k, and largest short of k + 1. R**2 is exact in
    float64; its product with k or k + 1 is rounded, and so is the root of that: both are widened by
    a unit in the last place.
    """
    fraction = config.root_operand.fraction
    least, greatest = np.inf, -np.inf
    for first in range(1 << fraction, 4 << fraction, BLOCK):
        operand: Ints = np.arange(first, min(first + BLOCK, 4 << fraction))
        square = np.square(inverse_sqrt(operand, config).astype(np.float64))
        least = min(least, float((square * operand).min()))
        greatest = max(greatest, float((square * (operand + 1)).max()))
    scale = 2.0 ** -(2 * config.root.fraction + fraction)
    low = np.nextafter(np.sqrt(np.nextafter(least * scale, 0)), 0) - 1
    high = np.nextafter(np.sqrt(np.nextafter(greatest * scale, 4)), 4) - 1
    return float(np.nextafter(low, -1)), float(np.nextafter(high, 1))


def power_header(config: Config) -> str:
    """The formats and tables of cos(s)**n in C, from which SOURCE is compiled."""
    numbers = {
        "VERSINE_FRACTION": config.versine.fraction,
        "EXPONENT_FRACTION": config.exponent.fraction,
        "LOG_INDEX_BITS": config.log_index_bits,
        "LOG_VALUE_FRACTION": config.log_value.fraction,
        "LOG_BITS": log_bits(config),
        "LOG_MANTISSA_BITS": config.log_mantissa_bits,
        "LOG_OCTAVES": int(config.log_octaves),
        "POWER_LOG_FRACTION": config.power_log.fraction,
        "POWER_LOG_MAX": config.power_log.max,
        "EXP_INDEX_BITS": config.exp_index_bits,
        "EXP_VALUE_FRACTION": config.exp_value.fraction,
        "POWER_FRACTION": config.power.fraction,
        "POWER_BYPASS": int(config.power_bypass),
    }
    log, exp = log_table(config), exp_table(config)
    tables = {
        "log_values": log.value, "log_slopes": log.slope,
        "exp_values": exp.value, "exp_slopes": exp.slope,
    }  # fmt: skip
    lines = ["// Written by phong75.model.analysis.exhausted.", "#include <cstdint>"]
    lines += [f"#define {name} {value}" for name, value in numbers.items()]
    lines += [
        f"static const uint32_t {name}[] = {{{', '.join(map(str, codes.tolist()))}}};"
        for name, codes in tables.items()
    ]
    return "\n".join(lines) + "\n"


def power_digest(config: Config) -> str:
    """A short hash of all that the errors of cos(s)**n depend on."""
    text = power_header(config) + SOURCE.read_text()
    return hashlib.sha256(text.encode()).hexdigest()[:12]
