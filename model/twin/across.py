"""Twin of rtl/across.v: the two parts of a vector across the half-way vector h = (hx, 0, hz)."""

from __future__ import annotations

from .. import fixed
from ..config import Config, Format


def across(vector, half_vector, out: Format, drop: int):
    """hz*y and hz*x - hx*z of `vector` (int64[3, n]), rounded by `drop` bits and saturated to the
    words of `out`."""
    hx, hz = half_vector
    x, y, z = vector
    p = fixed.saturate(fixed.round_shift(hz * y, drop), out)
    q = fixed.saturate(fixed.round_shift(hz * x - hx * z, drop), out)
    return p, q


def across_unit(unit, half_vector, config: Config):
    """Of a unit normal (int64[3, n] in `unit`), in `unit`."""
    return across(unit, half_vector, config.unit, config.half_vector.fraction)


def across_mantissa(mantissa, half_vector, config: Config):
    """Of mantissas (int64[3, n], `mantissa`), with one fraction bit less: |m| is up to sqrt(3)."""
    return across(mantissa, half_vector, config.mantissa, config.half_vector.fraction + 1)
