# SPDX-License-Identifier: MIT
"""Twin of rtl/techniques/flat_unit.v: one intensity for all pixels of a span."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints, Spans
from phong75.model.config import Config
from phong75.model.twin.techniques.intensity_code import intensity_code


def flat_unit(spans: Spans, span: Ints, config: Config) -> Ints:
    """Codes int64[3, n] of red, green, blue of the spans number `span` (int64[n])."""
    held = spans["start"][span, : config.channels].T
    return np.broadcast_to(intensity_code(held, config), (3, len(span)))
