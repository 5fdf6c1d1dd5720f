"""Twin of rtl/core/half_vector_cross.v: N x h for the half vector h = (hx, 0, hz)."""

from __future__ import annotations

from phong75.model import fixed
from phong75.model.config import Config, Format


def half_vector_cross(vector, half_vector, out: Format, drop: int):
    """hz*y and hz*x - hx*z of `vector` (int64[3, n]), rounded by `drop` bits and saturated to the
    words of `out`."""
    hx, hz = half_vector
    x, y, z = vector
    cross_xz = fixed.saturate(fixed.round_shift(hz * y, drop), out)
    cross_y = fixed.saturate(fixed.round_shift(hz * x - hx * z, drop), out)
    return cross_xz, cross_y


def half_vector_cross_unit(unit, half_vector, config: Config):
    """Of a unit normal (int64[3, n] in `unit`), in `unit`."""
    return half_vector_cross(unit, half_vector, config.unit, config.half_vector.fraction)


def half_vector_cross_mantissa(mantissa, half_vector, config: Config):
    """Of mantissas (int64[3, n], `mantissa`), with one fraction bit less: |m| is up to sqrt(3)."""
    return half_vector_cross(
        mantissa, half_vector, config.mantissa, config.half_vector.fraction + 1
    )
