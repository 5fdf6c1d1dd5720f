# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/light_align.v: the mantissas of a light's normal.

The normals of all lights are one vector in several frames, so that all have the length of the first
light's normal N0. A light's normal is shifted as N0 is, or by less where a component would leave
the word. For one vector that is one bit less at most, since |N| is at most sqrt(3) times the
largest component of N0. A longer normal keeps its direction; it is taken as shortened by the
further bits.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.normalizer import align, leading_zeros


def shift(own: Ints, first: Ints) -> tuple[Ints, Flags]:
    """Stage 2: the shift int64[n] of a normal, and whether it is less than that of N0, bool[n].

    own: the shift that brings the normal's largest component to the top. first: that of N0.
    """
    return np.minimum(own, first), own < first


def light_align(
    normal: Ints, first: Ints | None, config: Config, trace: Trace | None = None
) -> tuple[Ints, Flags, Ints]:
    """Mantissas int64[3, n] in `mantissa` (s0.17); whether they are shifted less than those of N0,
    bool[n]; and the shift of N0, int64[n].

    normal: int64[3, n] in `normal` (s1.30). first: int64[n], the shift of N0; None for N0 itself.
    """
    own = leading_zeros(normal, config)
    first = own if first is None else first
    by, less = shift(own, first)
    mantissa = align(normal, by, config)
    if trace is not None:
        zero = (normal == 0).all(axis=0)
        trace["light_align.leading_zeros"] = (own, zero.astype(np.int64))
        trace["light_align.shift"] = (by, less.astype(np.int64))
        trace["light_align.align"] = tuple(mantissa)
    return mantissa, less, first
