"""Twin of rtl/linear_interpolator.v: one component of the normal along spans.

Linear interpolation between the ends of a span (the paper, eq. (2) and Fig. 3) by forward
differences: exact, since only integers are added.
"""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config


def linear_interpolator(start, step, k, config: Config):
    """Component at pixel `k` of spans with `start` and `step` (int64[n], `normal`).

    Returns the component, wrapped to the word as the adder does, and whether it left the word
    (bool[n]): then the span is illegal.
    """
    exact = start + k * step
    sign = 1 << (config.normal.bits - 1)
    wrapped = ((exact + sign) & ((sign << 1) - 1)) - sign
    return wrapped, np.asarray(exact != wrapped)
