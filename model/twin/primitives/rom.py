# SPDX-License-Identifier: MIT
"""Twin of rtl/primitives/rom.v: words of a constant table."""

from __future__ import annotations

from functools import singledispatch

import numpy as np

from phong75.model.arrays import Ints


@singledispatch
def rom(address: Ints, table: Ints) -> Ints:
    """The words of `table` (int64[m]) at `address` (int64, any shape, 0 <= address < m).

    `phong75.model.dataflow` registers what it does for its own kind of address.
    """
    return np.take(table, address)
