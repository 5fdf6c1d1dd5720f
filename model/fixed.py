"""Integer arithmetic that the twin's stages share: exact, vectorized, no floating-point result."""

from __future__ import annotations

import numpy as np

from phong75.model.config import Format


def round_shift(value, shift: int):
    """`value / 2**shift`, rounded half up: add half a unit, then shift right arithmetically."""
    total = value + (1 << (shift - 1))
    total >>= shift  # in place: `total` is ours
    return total


def saturate(value, fmt: Format):
    """Clamp integer codes to the range of `fmt`."""
    return np.clip(value, fmt.min, fmt.max)


def bit_length(value):
    """Number of bits of the integers `value`, 0 <= value < 2**53 (0 for 0).

    frexp of an integer below 2**53 is exact, so this is an integer operation in disguise.
    """
    return np.frexp(value.astype(np.float64))[1].astype(np.int64)


def wrap(value, fmt: Format):
    """Integer codes modulo the word of the signed format `fmt`, as an adder leaves them."""
    sign = 1 << (fmt.bits - 1)
    return ((value + sign) & ((sign << 1) - 1)) - sign
