# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/quadratic_normalizer.v: cos(i) and 1 - cos(s) from Zn and two squares.

The squares are |N|**2 and `cross_square` (C in the Verilog), the sum of squares of the x and y
components of N x h (see `phong75.model.quadratic_spans`), so that 1 - cos(s) = 2 C / |N|**2.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.inverse_sqrt import inverse_sqrt
from phong75.model.twin.primitives.leading_zeros import leading_zeros
from phong75.model.twin.primitives.left_shifter import left_shifter
from phong75.model.twin.primitives.round_saturate import round_half_up, round_saturate


def clamp(square: Ints, config: Config) -> Ints:
    """Stage 1: `square` in `squared` (s2.42), or 0 where its rounding made it negative."""
    return np.maximum(square, 0)


def shifts(square: Ints, cross_square: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 2: the even shift that brings `square` to [1, 4), and how much further `cross_square`
    is shifted, 0 to 15."""
    bits = config.squared.bits - 1
    even = leading_zeros(square, bits) & ~1
    return even, np.clip(leading_zeros(cross_square, bits) - even, 0, 15)


def align(
    z: Ints, square: Ints, cross_square: Ints, even: Ints, more: Ints, config: Config
) -> tuple[Ints, Ints, Ints]:
    """Stage 3: |Zn| in `quadratic_mantissa` (u1.17), the operand of the root in `root_operand`
    (u2.20), and the top bits of `cross_square`, as many as `quadratic_mantissa` has."""
    bits = config.squared.bits - 1
    operand = (square << even) >> (bits - config.root_operand.bits)
    magnitude = left_shifter(np.abs(z), even >> 1, config.normal.bits)
    mantissa = config.quadratic_mantissa
    aligned = round_saturate(magnitude, config.normal.fraction - mantissa.fraction, mantissa)
    part = left_shifter(cross_square, even + more, bits) >> (bits - mantissa.bits)
    return aligned, operand, part


def cosine(z: Ints, root: Ints, config: Config) -> Ints:
    """Stage 5: |Zn| / |N| in `cosine` (u0.18), rounded."""
    drop = config.quadratic_mantissa.fraction + config.root.fraction - config.cosine.fraction
    return round_saturate(z * root, drop, config.cosine)


def versine(part: Ints, root: Ints, more: Ints, config: Config) -> Ints:
    """Stage 6: 1 - cos(s) = 2 cross_square / |N|**2 in `versine` (u0.22)."""
    reciprocal = round_saturate(root * root, config.root.bits, config.root)
    fraction = config.quadratic_mantissa.bits - 2 + config.root.fraction - 1  # of the double
    product = (part * reciprocal) >> more
    return np.minimum(
        round_half_up(product, fraction - config.versine.fraction), config.versine.max
    )


def quadratic_normalizer(
    z: Ints, square: Ints, cross_square: Ints, two_sided: bool, config: Config,
    trace: Trace | None = None,
) -> tuple[Ints, Ints, Flags]:  # fmt: skip
    """1 - cos(s) int64[n] in `versine` (u0.22), |cos(i)| int64[n] in `cosine` (u0.18), lit bool[n].

    z: int64[n] in `normal` (s1.30), Zn. square, cross_square: int64[n] in `squared` (s2.42).
    """
    square, cross_square = clamp(square, config), clamp(cross_square, config)
    even, more = shifts(square, cross_square, config)
    mantissa, operand, part = align(z, square, cross_square, even, more, config)
    root = inverse_sqrt(operand, config)
    cos = cosine(mantissa, root, config)
    v = versine(part, root, more, config)
    lit = (z > 0) | (two_sided & (z < 0))
    if trace is not None:
        trace["quadratic_normalizer.operand"] = (operand,)
        trace["quadratic_normalizer.part"] = (part,)
        trace["quadratic_normalizer.mantissa"] = (mantissa,)
        trace["quadratic_normalizer.root"] = (root,)
        trace["quadratic_normalizer.out"] = (v, cos, lit.astype(np.int64))
    return v, cos, lit
