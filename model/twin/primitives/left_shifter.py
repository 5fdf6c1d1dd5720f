# SPDX-License-Identifier: MIT
"""Twin of rtl/primitives/left_shifter.v: a word shifted left, zeros shifted in."""

from __future__ import annotations

from phong75.model.arrays import Ints


def left_shifter(word: Ints, count: Ints, bits: int) -> Ints:
    """`word << count` (int64, any shape), without what leaves the `bits` of the word."""
    return (word << count) & ((1 << bits) - 1)
