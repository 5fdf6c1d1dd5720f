"""Twin of rtl/quadratic_unit.v: Phong's shading with the normal's squares interpolated."""

from __future__ import annotations

from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.quadratic_spans import coefficients
from phong75.model.twin.core.linear_interpolator import linear_interpolator
from phong75.model.twin.core.shading_unit import shading_unit
from phong75.model.twin.methods.quadratic_interpolator import quadratic_interpolator
from phong75.model.twin.methods.quadratic_normalizer import quadratic_normalizer


def interpolate(frame: Frame, span, k, config: Config):
    """Zn int64[n] in `normal`, |N|**2 and |N x h|**2 int64[n] in `squared`, of pixel `k` of the
    spans number `span` (rising)."""
    first, last = (int(span[0]), int(span[-1])) if len(span) else (0, -1)
    spans = frame.spans[first : last + 1]
    own = span - first
    z, _ = linear_interpolator(spans["start"][own, 2], spans["step"][own, 2], k, config)
    words = coefficients(spans, frame.half_vector, config)
    square, cross = (
        quadratic_interpolator(*(words[f"{name}_{d}"][own] for d in range(3)), k, config)
        for name in ("square", "cross")
    )
    return z, square, cross


def quadratic_unit(frame: Frame, span, k, config: Config):
    """Codes int64[3, n] of pixel `k` of the spans number `span` (int64[n], rising)."""
    z, square, cross = interpolate(frame, span, k, config)
    v, cosine, lit = quadratic_normalizer(z, square, cross, frame.two_sided, config)
    material = frame.spans["material"][span].astype(int)
    return shading_unit(None, cosine, lit, material, frame, config, given_versine=v)
