# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/quadratic_unit.v: Phong's shading with the normal's squares interpolated."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.quadratic_spans import coefficients
from phong75.model.twin.core.linear_interpolator import linear_interpolator
from phong75.model.twin.core.shading_unit import shading_unit
from phong75.model.twin.methods.quadratic_interpolator import quadratic_interpolator
from phong75.model.twin.methods.quadratic_normalizer import quadratic_normalizer


def interpolate(frame: Frame, span: Ints, k: Ints, config: Config) -> tuple[Ints, Ints, Ints]:
    """Zn int64[n] in `normal` (s1.30), |N|**2 and the cross square int64[n] in `squared` (s2.42),
    at pixel `k` of the spans number `span` (int64[n] each; `span` rises)."""
    first, last = (int(span[0]), int(span[-1])) if len(span) else (0, -1)
    spans = frame.spans[first : last + 1]
    row = span - first
    z, _ = linear_interpolator(spans["start"][row, 2], spans["step"][row, 2], k, config)
    words = coefficients(spans, frame.half_vector, config)

    def along(name: str) -> Ints:
        value, first_difference, second_difference = (words[f"{name}_{d}"][row] for d in range(3))
        return quadratic_interpolator(value, first_difference, second_difference, k, config)

    return z, along("square"), along("cross")


def quadratic_unit(frame: Frame, span: Ints, k: Ints, config: Config) -> Ints:
    """Codes int64[3, n] of red, green, blue at pixel `k` of the spans number `span` (int64[n] each;
    `span` rises) of `frame`."""
    z, square, cross_square = interpolate(frame, span, k, config)
    v, cosine, lit = quadratic_normalizer(z, square, cross_square, frame.two_sided, config)
    material = frame.spans["material"][span].astype(np.int64)
    no_unit = np.zeros((3, 0), np.int64)
    return shading_unit(no_unit, cosine, lit, material, frame, config, given_versine=v)
