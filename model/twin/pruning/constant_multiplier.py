# SPDX-License-Identifier: MIT
"""Twin of rtl/pruning/constant_multiplier.v: a product with a constant, as a sum of shifted words.

The constant is written in canonical signed digit form: digits -1, 0 and 1, no two digits other than
0 side by side, which needs the fewest digits other than 0 (Reitwiesner 1960). Each of those digits
is one shifted word, added or subtracted in a tree.
"""

from __future__ import annotations

from phong75.model.arrays import Ints


def signed_digits(constant: int) -> list[tuple[int, int]]:
    """The digits of `constant` (0 or more) other than 0: (digit, place) from the lowest place up.

    `constant` is the sum of digit * 2**place; digit is -1 or 1.
    """
    triple = 3 * constant  # constant and its double: they differ in the places with a digit
    return [
        (-1 if constant >> place & 1 else 1, place - 1)
        for place in range(1, triple.bit_length())
        if (constant ^ triple) >> place & 1
    ]


def levels(constant: int) -> int:
    """Levels of the tree that adds the digits, 1 or more: cycles that the product takes."""
    return max(1, (len(signed_digits(constant)) - 1).bit_length())


def constant_multiplier(word: Ints, constant: int) -> Ints:
    """`word * constant` (int64, any shape), exact: the sum of the shifted words."""
    product = 0 * word
    for digit, place in signed_digits(constant):
        product += digit * (word << place)
    return product
