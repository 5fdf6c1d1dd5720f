# SPDX-License-Identifier: MIT
"""Twin of rtl/primitives/round_saturate.v: fewer fraction bits, rounded half up, then clamped."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints
from phong75.model.config import Format


def round_half_up(value: Ints, drop: int) -> Ints:
    """`value / 2**drop`, rounded half up: half a unit is added, then the word is shifted right
    arithmetically. drop: 1 or more."""
    total: Ints = value + (1 << (drop - 1))
    total >>= drop  # in place: no caller holds `total`
    return total


def round_saturate(value: Ints, drop: int, fmt: Format) -> Ints:
    """`value / 2**drop` (int64, any shape), rounded half up and clamped to the codes of `fmt`."""
    return np.clip(round_half_up(value, drop), fmt.min, fmt.max)
