"""Twin of rtl/gouraud_unit.v: intensities from the vertices, interpolated along the span."""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config
from phong75.model.twin.core.linear_interpolator import linear_interpolator
from phong75.model.twin.techniques.intensity_code import intensity_code


def gouraud_unit(spans, span, k, config: Config):
    """Codes int64[3, n] of red, green, blue at pixel `k` of the spans number `span` (int64[n])."""
    intensity = [
        linear_interpolator(spans["start"][span, c], spans["step"][span, c], k, config)[0]
        for c in range(config.channels)
    ]
    return np.broadcast_to(intensity_code(np.stack(intensity), config), (3, len(span)))
