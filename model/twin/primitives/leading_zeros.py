# SPDX-License-Identifier: MIT
"""Twin of rtl/primitives/leading_zeros.v: the number of zeros above the highest one of a word."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints


def leading_zeros(word: Ints, bits: int) -> Ints:
    """Zeros above the highest one of `word` (int64, any shape, 0 <= word < 2**bits); `bits` for 0.

    bits: width of the word, 53 at most. float64 holds every such integer exactly, so the exponent
    that `frexp` returns is the integer's number of bits.
    """
    return bits - np.frexp(word.astype(np.float64))[1].astype(np.int64)
