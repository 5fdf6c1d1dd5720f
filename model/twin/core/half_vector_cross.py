# SPDX-License-Identifier: MIT
"""Twin of rtl/core/half_vector_cross.v: N x h for the half vector h = (hx, 0, hz).

1 - cos(s) needs the x and y components of N x h (see `reflection`). `cross_xz` is the x component
hz Yn; the z component -hx Yn, of the same plane, does not count, since the light is along z.
`cross_y` is the y component with its sign turned, hz Xn - hx Zn.
"""

from __future__ import annotations

from phong75.model.arrays import Ints
from phong75.model.config import Config, Format
from phong75.model.twin.primitives.round_saturate import round_saturate


def half_vector_cross(
    vector: Ints, half_vector: tuple[int, ...], out: Format, drop: int
) -> tuple[Ints, Ints]:
    """cross_xz = hz y and cross_y = hz x - hx z of `vector` (x, y, z), int64[3, n]; int64[n] each.

    half_vector: (hx, hz) in `half_vector` (s0.17). Both results are rounded by `drop` bits and
    clamped to `out`.
    """
    hx, hz = half_vector
    x, y, z = vector
    return round_saturate(hz * y, drop, out), round_saturate(hz * x - hx * z, drop, out)


def half_vector_cross_unit(
    unit: Ints, half_vector: tuple[int, ...], config: Config
) -> tuple[Ints, Ints]:
    """The same for a unit normal (int64[3, n] in `unit`, s0.17); results in `unit`."""
    return half_vector_cross(unit, half_vector, config.unit, config.half_vector.fraction)


def half_vector_cross_mantissa(
    mantissa: Ints, half_vector: tuple[int, ...], config: Config
) -> tuple[Ints, Ints]:
    """The same for mantissas (int64[3, n] in `mantissa`, s0.17).

    The results are in words of that width with one fraction bit less, since |m| is up to sqrt(3).
    """
    return half_vector_cross(
        mantissa, half_vector, config.mantissa, config.half_vector.fraction + 1
    )
