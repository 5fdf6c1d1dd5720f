# SPDX-License-Identifier: MIT
"""Names for the types of arrays, as the annotations of `phong75.model` use them.

A docstring gives the shape: `float64[n, 3]` is a `Reals` of n rows and three columns.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

#: Codes, indices and counts: int64 of any shape.
Ints = NDArray[np.int64]

#: Real values: float64 of any shape.
Reals = NDArray[np.float64]

#: Flags: bool of any shape.
Flags = NDArray[np.bool_]

#: Records of SPAN_DTYPE (see `frame`).
Spans = NDArray[np.void]

#: What the stages of the twin leave behind: {"module.stage": one array per signal}, in the order
#: of the signals in sim/module/units.py.
Trace = dict[str, tuple[Ints, ...]]

__all__ = ["ArrayLike", "Flags", "Ints", "Reals", "Spans", "Trace"]
