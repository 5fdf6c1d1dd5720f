"""Squares along a span as polynomials, after Duff (1979).

Along a span the interpolated normal is N = S + k T. So |N|**2, and with it the square of the part
of N across the half vector, |N x h|**2 = (hz y)**2 + (hz x - hx z)**2, are quadratic in k: two
additions a pixel instead of products. Whoever makes the spans makes their differences, too, as it
makes S and T; they are a span's in place of x and y.

The hardware aligns both squares to the first of them, so the second must not be larger: it is that
across h / |h|, for the codes of h may be longer than 1, and less by a share of 2**-MARGIN_BITS, for
both are rounded.
"""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config
from phong75.model.fixed import wrap

#: The words of a span, in the order of the record: value, first and second difference of each.
NAMES = ("square_0", "square_1", "square_2", "cross_0", "cross_1", "cross_2")

#: Costs at most 2**-MARGIN_BITS of cos(s)**n (n v (1 - v)**(n - 1) is at most 1): 0.004 LSB.
MARGIN_BITS = 16


def coefficients(spans, half_vector, config: Config) -> dict[str, np.ndarray]:
    """{name of NAMES: codes int64[n]} in `Config.squared` of `spans` (SPAN_DTYPE[n]).

    Exact but for one rounding each. What does not fit the word (|N|**2 of 4 and more) wraps.
    """
    start, step = (spans[what].T.astype(object) for what in ("start", "step"))
    hx, hz = (int(h) for h in half_vector)
    out = _differences(start, step, 1, 1, config)
    parts = [(hz * v[1], hz * v[0] - hx * v[2]) for v in (start, step)]
    margin = 1 << MARGIN_BITS
    out += _differences(*parts, margin - 1, margin * (hx * hx + hz * hz), config)
    return dict(zip(NAMES, out, strict=True))


def _differences(start, step, above: int, below: int, config: Config) -> list[np.ndarray]:
    """Value, first and second difference of the sum of squares of start + k step (`normal`), times
    `above` / `below`."""
    square = sum(s * s for s in start)
    twice = sum(2 * s * t for s, t in zip(start, step, strict=True))
    bend = sum(t * t for t in step)
    below <<= 2 * config.normal.fraction - config.squared.fraction
    mask = (1 << 62) - 1  # still exact modulo any word
    exact = (square, twice + bend, 2 * bend)
    rounded = [(2 * above * c + below) // (2 * below) for c in exact]
    return [wrap((c & mask).astype(np.int64), config.squared) for c in rounded]
