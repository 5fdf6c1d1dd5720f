# SPDX-License-Identifier: MIT
"""Twin of rtl/core/versine_of_cross.v: 1 - cos(s) from N x h (see `reflection`)."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints
from phong75.model.config import Config
from phong75.model.twin.primitives.round_saturate import round_half_up


def versine_of_cross(cross_xz: Ints, cross_y: Ints, config: Config) -> Ints:
    """2 (cross_xz**2 + cross_y**2), int64[n] in `versine` (u0.22), rounded.

    cross_xz, cross_y: int64[n] in `unit` (s0.17). Where cos(s) <= 0 the result is the largest code.
    """
    drop = 2 * config.unit.fraction - 1 - config.versine.fraction
    square = cross_xz * cross_xz + cross_y * cross_y
    return np.minimum(round_half_up(square, drop), config.versine.max)
