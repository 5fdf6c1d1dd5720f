# SPDX-License-Identifier: MIT
"""Twin of rtl/pruning/normal_hold.v: the last normal that may be lit stays.

Pixels that face away from the light keep the datapath at the normal before them, so that no
register behind toggles. Their colour is the ambient term and depends on no normal.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints


def normal_hold(normal: Ints, two_sided: bool | Flags) -> tuple[Ints, Flags]:
    """Held normals int64[3, n] and whether each pixel's own normal is held, bool[n].

    normal: int64[3, n] in `normal` (s1.30), consecutive pixels. Pixels before the first normal that
    may be lit get zeros, where the hardware keeps what was before.
    """
    shown = two_sided | (normal[2] >= 0)
    latest = np.maximum.accumulate(np.where(shown, np.arange(len(shown)), -1))
    return np.where(latest >= 0, normal[:, latest], 0), shown
