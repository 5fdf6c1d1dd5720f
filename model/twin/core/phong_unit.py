# SPDX-License-Identifier: MIT
"""Twin of rtl/core/phong_unit.v: the hardware that Phong 1975 proposes for his shading.

Three interpolators work in parallel, one for each component of the normal; the normalizer and the
shading unit follow.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Spans, Trace
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame
from phong75.model.twin.core.linear_interpolator import linear_interpolator
from phong75.model.twin.core.normalizer import normalizer
from phong75.model.twin.core.shading_unit import shading_unit
from phong75.model.twin.methods.unnormalized import unnormalized
from phong75.model.twin.pruning.normal_hold import normal_hold
from phong75.model.twin.techniques.second_difference_interpolator import (
    second_difference_interpolator,
)


def interpolate(spans: Spans, span: Ints, k: Ints, config: Config) -> tuple[Ints, Flags]:
    """The three interpolators: normals int64[3, n] in `normal` (s1.30) at pixel `k` of the spans
    number `span` (int64[n] each), and whether a component left its word, bool[n].

    With `normal_order` 2 the second is all false: see `spans.illegal_spans`.
    """
    if config.normal_order == 2:
        start, step, bend = (spans[word][span].T for word in ("start", "step", "bend"))
        return second_difference_interpolator(start, step, bend, k, config), np.zeros(len(k), bool)
    parts = [
        linear_interpolator(spans["start"][span, axis], spans["step"][span, axis], k, config)
        for axis in range(3)
    ]
    return np.stack([p[0] for p in parts]), parts[0][1] | parts[1][1] | parts[2][1]


def shade(
    normal: Ints, material: Ints, frame: Frame, config: Config = DEFAULT, trace: Trace | None = None
) -> Ints:
    """Codes int64[3, n] of red, green, blue for interpolated normals.

    normal: int64[3, n] in `normal` (s1.30), consecutive pixels. material: int64[n]. frame:
    registers and material table.
    """
    shown: Flags | bool = True
    if config.hold_unlit:
        normal, shown = normal_hold(normal, frame.two_sided)
    if config.normal_method == "none":
        unit, cosine, lit = unnormalized(normal, frame.two_sided, config, trace)
    else:
        half_vector = config.constant_half_vector or frame.half_vector
        unit, cosine, lit = normalizer(normal, frame.two_sided, config, trace, half_vector)
    return shading_unit(unit, cosine, lit & shown, material, frame, config, trace)


def phong_unit(frame: Frame, span: Ints, k: Ints, config: Config) -> Ints:
    """Codes int64[3, n] of red, green, blue at pixel `k` of the spans number `span` (int64[n]
    each) of `frame`."""
    normal, _ = interpolate(frame.spans, span, k, config)
    return shade(normal, frame.spans["material"][span], frame, config)
