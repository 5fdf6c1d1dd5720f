"""Twin of rtl/difference_normalizer.v: cos(i) and 1 - cos(s) from Zn and two squares."""

from __future__ import annotations

import numpy as np

from .. import fixed
from ..config import Config
from .inverse_sqrt_method import inverse_sqrt_method


def clamp(square, config: Config):
    """Stage 1: `square` (`squared`) without its sign: what rounding took below 0 is 0."""
    return np.maximum(square, 0)


def shifts(square, across, config: Config):
    """Stage 2: the even shift that brings `square` to [1, 4), and how much further `across` goes,
    0 to 15."""
    bits = config.squared.bits - 1
    even = (bits - fixed.bit_length(square)) & ~1
    return even, np.clip(bits - fixed.bit_length(across) - even, 0, 15)


def align(z, square, across, even, more, config: Config):
    """Stage 3: |Zn| in `difference_mantissa`, the operand of the root, and the top bits of
    `across`."""
    bits = config.squared.bits - 1
    operand = (square << even) >> (bits - config.root_operand.bits)
    magnitude = (np.abs(z) << (even >> 1)) & ((1 << config.normal.bits) - 1)
    mantissa = config.difference_mantissa
    drop = config.normal.fraction - mantissa.fraction
    z = fixed.saturate(fixed.round_shift(magnitude, drop), mantissa)
    part = ((across << (even + more)) & ((1 << bits) - 1)) >> (bits - mantissa.bits)
    return z, operand, part


def cosine(z, root, config: Config):
    """Stage 5: |Zn| / |N| in `cosine`."""
    drop = config.difference_mantissa.fraction + config.root.fraction - config.cosine.fraction
    return fixed.saturate(fixed.round_shift(z * root, drop), config.cosine)


def versine(part, root, more, config: Config):
    """Stage 6: 1 - cos(s) = 2 |N x h|**2 / |N|**2 in `versine`."""
    reciprocal = fixed.saturate(fixed.round_shift(root * root, config.root.bits), config.root)
    fraction = config.difference_mantissa.bits - 2 + config.root.fraction - 1  # of the double
    product = (part * reciprocal) >> more
    return np.minimum(
        fixed.round_shift(product, fraction - config.versine.fraction), config.versine.max
    )


def difference_normalizer(
    z, square, across, two_sided: bool, config: Config, trace: dict | None = None
):
    """1 - cos(s) int64[n] in `versine`, |cos(i)| int64[n] in `cosine`, and lit bool[n].

    z: int64[n] in `normal`; square, across: int64[n] in `squared`, |N|**2 and |N x h|**2.
    """
    square, across = clamp(square, config), clamp(across, config)
    even, more = shifts(square, across, config)
    mantissa, operand, part = align(z, square, across, even, more, config)
    root = inverse_sqrt_method(operand, config)
    cos = cosine(mantissa, root, config)
    v = versine(part, root, more, config)
    lit = (z > 0) | (two_sided & (z < 0))
    if trace is not None:
        trace["difference_normalizer.operand"] = (operand,)
        trace["difference_normalizer.part"] = (part,)
        trace["difference_normalizer.mantissa"] = (mantissa,)
        trace["difference_normalizer.root"] = (root,)
        trace["difference_normalizer.out"] = (v, cos, lit.astype(np.int64))
    return v, cos, lit
