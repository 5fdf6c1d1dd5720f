"""Twin of rtl/versine_of_cross.v: 1 - cos(s) from the parts of the unit normal across h."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config


def versine_of_cross(cross_xz, cross_y, config: Config):
    """2 (cross_xz**2 + cross_y**2) in `versine`, rounded; saturated where cos(s) <= 0."""
    drop = 2 * config.unit.fraction - 1 - config.versine.fraction
    return np.minimum(
        fixed.round_shift(cross_xz * cross_xz + cross_y * cross_y, drop), config.versine.max
    )
