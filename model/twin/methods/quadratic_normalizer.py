"""Twin of rtl/quadratic_normalizer.v: cos(i) and 1 - cos(s) from Zn and two squares."""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.twin.core.inverse_sqrt import inverse_sqrt


def clamp(square, config: Config):
    """Stage 1: `square` (`squared`) without its sign: what rounding took below 0 is 0."""
    return np.maximum(square, 0)


def shifts(square, cross, config: Config):
    """Stage 2: the even shift that brings `square` to [1, 4), and how much further `across` goes,
    0 to 15."""
    bits = config.squared.bits - 1
    even = (bits - fixed.bit_length(square)) & ~1
    return even, np.clip(bits - fixed.bit_length(cross) - even, 0, 15)


def align(z, square, cross, even, more, config: Config):
    """Stage 3: |Zn| in `quadratic_mantissa`, the operand of the root, and the top bits of
    `across`."""
    bits = config.squared.bits - 1
    operand = (square << even) >> (bits - config.root_operand.bits)
    magnitude = (np.abs(z) << (even >> 1)) & ((1 << config.normal.bits) - 1)
    mantissa = config.quadratic_mantissa
    drop = config.normal.fraction - mantissa.fraction
    z = fixed.saturate(fixed.round_shift(magnitude, drop), mantissa)
    part = ((cross << (even + more)) & ((1 << bits) - 1)) >> (bits - mantissa.bits)
    return z, operand, part


def cosine(z, root, config: Config):
    """Stage 5: |Zn| / |N| in `cosine`."""
    drop = config.quadratic_mantissa.fraction + config.root.fraction - config.cosine.fraction
    return fixed.saturate(fixed.round_shift(z * root, drop), config.cosine)


def versine(part, root, more, config: Config):
    """Stage 6: 1 - cos(s) = 2 |N x h|**2 / |N|**2 in `versine`."""
    reciprocal = fixed.saturate(fixed.round_shift(root * root, config.root.bits), config.root)
    fraction = config.quadratic_mantissa.bits - 2 + config.root.fraction - 1  # of the double
    product = (part * reciprocal) >> more
    return np.minimum(
        fixed.round_shift(product, fraction - config.versine.fraction), config.versine.max
    )


def quadratic_normalizer(
    z, square, cross, two_sided: bool, config: Config, trace: dict | None = None
):
    """1 - cos(s) int64[n] in `versine`, |cos(i)| int64[n] in `cosine`, and lit bool[n].

    z: int64[n] in `normal`; square, across: int64[n] in `squared`, |N|**2 and |N x h|**2.
    """
    square, cross = clamp(square, config), clamp(cross, config)
    even, more = shifts(square, cross, config)
    mantissa, operand, part = align(z, square, cross, even, more, config)
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
