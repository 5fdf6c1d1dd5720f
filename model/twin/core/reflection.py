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

from phong75.model.config import Config
from phong75.model.twin.core.half_vector_cross import half_vector_cross_unit
from phong75.model.twin.core.versine_of_cross import versine_of_cross


def reflection(unit, half_vector, config: Config, trace: dict | None = None):
    """1 - cos(s) of unit normals (int64[3, n] in `unit`), int64[n] in `versine`."""
    cross = half_vector_cross_unit(unit, half_vector, config)
    v = versine_of_cross(*cross, config)
    if trace is not None:
        trace["reflection.half_vector_cross"] = cross
        trace["reflection.versine"] = (v,)
    return v
