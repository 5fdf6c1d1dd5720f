# SPDX-License-Identifier: MIT
"""Squares along a span as quadratic polynomials, after Duff (1979).

Along a span the interpolated normal is N = S + k T at pixel k. Two squares are therefore quadratic
in k, and forward differences give each with two additions per pixel instead of products:

- the square |N|**2;
- the cross square (hz y)**2 + (hz x - hx z)**2, of the x and y components of N x h, with which
  1 - cos(s) = 2 cross square / |N|**2 for |h| = 1 (see `twin.core.reflection`).

The software that makes S and T also makes the values and differences of both squares. A span
carries them in place of the normal's x and y.

The hardware aligns both squares by the leading zeros of |N|**2, so the cross square must not be
larger. It is therefore divided by |h|**2, since the codes of h may be longer than 1, and reduced by
a share of 2**-MARGIN_BITS, since both squares are rounded.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from phong75.model.arrays import Ints, Spans
from phong75.model.config import Config

#: The words of a span, in the order of the record: value, first and second difference of |N|**2
#: (square) and of the cross square (cross).
NAMES = ("square_0", "square_1", "square_2", "cross_0", "cross_1", "cross_2")

#: The margin changes cos(s)**n by at most 2**-MARGIN_BITS, since n v (1 - v)**(n - 1) is at most 1:
#: 0.004 LSB of the colour.
MARGIN_BITS = 16


def coefficients(spans: Spans, half_vector: tuple[int, ...], config: Config) -> dict[str, Ints]:
    """{name of NAMES: codes int64[n] in `squared` (s2.42)} of `spans` (SPAN_DTYPE[n]).

    half_vector: (hx, hz) in `half_vector` (s0.17). Each code is exact but for one rounding. A value
    that does not fit the word (|N|**2 of 4 and more) wraps.
    """
    start, step = (spans[what].T.astype(object) for what in ("start", "step"))
    hx, hz = (int(h) for h in half_vector)
    out = _differences(start, step, 1, 1, config)
    cross_start, cross_step = ((hz * v[1], hz * v[0] - hx * v[2]) for v in (start, step))
    margin = 1 << MARGIN_BITS
    out += _differences(cross_start, cross_step, margin - 1, margin * (hx * hx + hz * hz), config)
    return dict(zip(NAMES, out, strict=True))


def _differences(start: Any, step: Any, above: int, below: int, config: Config) -> list[Ints]:
    """Value at k = 0, first and second difference of the sum of squares of start + k step, times
    `above` / `below`, rounded to `squared`.

    start, step: components, each an array of Python integers in units of `normal`'s LSB (times
    that of `half_vector`, which `below` takes out again).
    """
    square: Any = sum(s * s for s in start)
    twice: Any = sum(2 * s * t for s, t in zip(start, step, strict=True))
    bend: Any = sum(t * t for t in step)
    below <<= 2 * config.normal.fraction - config.squared.fraction
    mask = (1 << 62) - 1  # fits int64, and keeps the value modulo any word
    exact = (square, twice + bend, 2 * bend)
    rounded = [(2 * above * c + below) // (2 * below) for c in exact]
    return [config.squared.wrap((c & mask).astype(np.int64)) for c in rounded]
