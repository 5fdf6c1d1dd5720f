# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/context_interpolator.v: components of the normals of several lights in turns.

Each light's component is interpolated as `linear_interpolator` does it. The hardware keeps one
light's state while it shades the others, which changes no value.
"""

from __future__ import annotations

from phong75.model.arrays import Flags, Ints
from phong75.model.config import Config, Format
from phong75.model.twin.core.linear_interpolator import linear_interpolator


def context_interpolator(
    start: Ints, step: Ints, k: Ints, config: Config, word: Format | None = None
) -> tuple[Ints, Flags]:
    """The component of one light at pixel `k` of spans with `start` and `step`, int64[n] in `word`,
    by default `normal` (s1.30), and whether the exact value left the word, bool[n]."""
    return linear_interpolator(start, step, k, config, word)
