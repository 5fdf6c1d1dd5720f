"""Twin of rtl/versine_of_parts.v: 1 - cos(s) from the parts of the unit normal across h."""

from __future__ import annotations

import numpy as np

from .. import fixed
from ..config import Config


def versine_of_parts(p, q, config: Config):
    """2 (p**2 + q**2) in `versine`, rounded; saturated where cos(s) <= 0."""
    drop = 2 * config.unit.fraction - 1 - config.versine.fraction
    return np.minimum(fixed.round_shift(p * p + q * q, drop), config.versine.max)
