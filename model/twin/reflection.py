"""Twin of rtl/reflection.v: 1 - cos(s), the versine between the reflected ray and the eye.

The paper takes cos(s) = u.R = 2 Zn (N.u) - u_z (Shading Function Model, R = 2 Zn N - k). Near a
highlight that is a small difference from 1, and cos(s)**n multiplies its error by n. With
h = (hx, 0, hz) the unit vector halfway between light k and eye u, u = 2 hz h - k, the same
quantity is a sum of two squares,

    1 - cos(s) = 2 ((hz Yn)**2 + (hz Xn - hx Zn)**2),

whose relative error is small everywhere; the error that reaches cos(s)**n no longer grows with n
but with its square root. (Lyon 1993 uses |R - u|**2 / 2 in the same spirit, with more products.)
"""

from __future__ import annotations

import numpy as np

from .. import fixed
from ..config import Config


def across(unit, half_vector, config: Config):
    """Stage 1: the two parts of the normal across h: hz*Yn and hz*Xn - hx*Zn, in `unit`."""
    hx, hz = half_vector
    x, y, z = unit
    drop = config.half_vector.fraction
    p = fixed.saturate(fixed.round_shift(hz * y, drop), config.unit)
    q = fixed.saturate(fixed.round_shift(hz * x - hx * z, drop), config.unit)
    return p, q


def versine(p, q, config: Config):
    """Stage 2: 2 (p**2 + q**2) in `versine`, rounded; saturated where cos(s) <= 0."""
    drop = 2 * config.unit.fraction - 1 - config.versine.fraction
    return np.minimum(fixed.round_shift(p * p + q * q, drop), config.versine.max)


def reflection(unit, half_vector, config: Config, trace: dict | None = None):
    """1 - cos(s) of unit normals (int64[3, n] in `unit`), int64[n] in `versine`."""
    p, q = across(unit, half_vector, config)
    v = versine(p, q, config)
    if trace is not None:
        trace["reflection.across"] = (p, q)
        trace["reflection.versine"] = (v,)
    return v
