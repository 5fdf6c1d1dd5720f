# SPDX-License-Identifier: MIT
"""Twin of rtl/core/linear_interpolator.v: one component of the normal along spans.

Linear interpolation between the ends of a span (Phong 1975, eq. (2) and Fig. 3) by forward
differences. The result is exact, since integers are added.
"""

from __future__ import annotations

from phong75.model.arrays import Flags, Ints
from phong75.model.config import Config, Format


def linear_interpolator(
    start: Ints, step: Ints, k: Ints, config: Config, word: Format | None = None
) -> tuple[Ints, Flags]:
    """The component at pixel `k` of spans with `start` and `step`, int64[n] in `word`, by default
    `normal` (s1.30).

    Returns the component, wrapped to the word as the adder wraps, and whether the exact value left
    the word (bool[n]), which makes the span illegal.
    """
    exact = start + k * step
    wrapped = (word or config.normal).wrap(exact)
    return wrapped, exact != wrapped
