"""Twin of rtl/differences_unit.v: Phong's shading with the normal's squares interpolated."""

from __future__ import annotations

from ..config import Config
from ..differences import coefficients
from ..frame import Frame
from .difference_normalizer import difference_normalizer
from .normal_interpolator import normal_interpolator
from .quadratic_interpolator import quadratic_interpolator
from .shading_unit import shading_unit


def interpolate(frame: Frame, span, k, config: Config):
    """Zn int64[n] in `normal`, |N|**2 and |N x h|**2 int64[n] in `squared`, of pixel `k` of the
    spans number `span` (rising)."""
    first, last = (int(span[0]), int(span[-1])) if len(span) else (0, -1)
    spans = frame.spans[first : last + 1]
    own = span - first
    z, _ = normal_interpolator(spans["start"][own, 2], spans["step"][own, 2], k, config)
    words = coefficients(spans, frame.half_vector, config)
    square, across = (
        quadratic_interpolator(*(words[f"{name}_{d}"][own] for d in range(3)), k, config)
        for name in ("square", "across")
    )
    return z, square, across


def differences_unit(frame: Frame, span, k, config: Config):
    """Codes int64[3, n] of pixel `k` of the spans number `span` (int64[n], rising)."""
    z, square, across = interpolate(frame, span, k, config)
    v, cosine, lit = difference_normalizer(z, square, across, frame.two_sided, config)
    material = frame.spans["material"][span].astype(int)
    return shading_unit(None, cosine, lit, material, frame, config, given_versine=v)
