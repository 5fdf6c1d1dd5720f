# SPDX-License-Identifier: MIT
"""Twin of rtl/core/reflection.v: 1 - cos(s), the versine of the angle between reflected ray and
eye.

The paper takes cos(s) = u.R = 2 Zn (N.u) - u_z (Phong 1975, "Shading Function Model", with
R = 2 Zn N - k). Near a highlight cos(s) differs little from 1, and cos(s)**n multiplies its error
by n. Let h = (hx, 0, hz) be the unit half vector between light k and eye u, so that
u = 2 hz h - k. Then the same quantity is a sum of two squares,

    1 - cos(s) = 2 ((hz Yn)**2 + (hz Xn - hx Zn)**2),

of the x and y components of N x h. Its relative error is small everywhere. The error that reaches
cos(s)**n grows with the square root of n instead of n. Lyon 1993 uses |R - u|**2 / 2 for the same
purpose, with more products.
"""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.half_vector_cross import half_vector_cross_unit
from phong75.model.twin.core.versine_of_cross import versine_of_cross


def reflection(
    unit: Ints, half_vector: tuple[int, ...], config: Config, trace: Trace | None = None
) -> Ints:
    """1 - cos(s), int64[n] in `versine` (u0.22), of unit normals (int64[3, n] in `unit`, s0.17).

    half_vector: (hx, hz) in `half_vector` (s0.17).
    """
    cross = half_vector_cross_unit(unit, half_vector, config)
    v = versine_of_cross(*cross, config)
    if trace is not None:
        trace["reflection.half_vector_cross"] = cross
        trace["reflection.versine"] = (v,)
    return v
