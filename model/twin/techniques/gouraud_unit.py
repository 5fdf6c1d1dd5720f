# SPDX-License-Identifier: MIT
"""Twin of rtl/techniques/gouraud_unit.v: Gouraud's shading (1971), the intensities of the vertices
interpolated along the span."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Spans
from phong75.model.config import Config
from phong75.model.twin.core.linear_interpolator import linear_interpolator
from phong75.model.twin.techniques.intensity_code import intensity_code


def gouraud_unit(spans: Spans, span: Ints, k: Ints, config: Config) -> Ints:
    """Codes int64[3, n] of red, green, blue at pixel `k` of the spans number `span` (int64[n]
    each)."""
    intensity = [
        linear_interpolator(spans["start"][span, c], spans["step"][span, c], k, config)[0]
        for c in range(config.channels)
    ]
    return np.broadcast_to(intensity_code(np.stack(intensity), config), (3, len(span)))
