"""Twin of rtl/normalizer.v: an interpolated normal of any length becomes a unit normal.

The paper's "extra hardware ... to normalize the outputs of the interpolators" (Conclusion).
"""

from __future__ import annotations

import numpy as np

from phong75.model import fixed
from phong75.model.config import Config
from phong75.model.twin.core.half_vector_cross import half_vector_cross_mantissa
from phong75.model.twin.core.inverse_sqrt import inverse_sqrt


def leading_zeros(normal, config: Config):
    """Stage 1: the shift that brings the largest of three components (int64[3, n]) to the top; or
    the one that does so for all normals of the build."""
    if config.constant_shift:
        return np.full(normal.shape[1], config.constant_shift[0])
    sign = normal >> (config.normal.bits - 1)
    ones = (normal[0] ^ sign[0]) | (normal[1] ^ sign[1]) | (normal[2] ^ sign[2])
    return config.normal.bits - 1 - fixed.bit_length(ones)


def align(normal, shift, config: Config):
    """Stage 2: block-normalized components in `mantissa`, rounded half up and saturated."""
    drop = config.normal.bits - config.mantissa.bits
    mantissa = fixed.round_shift(normal << shift, drop)
    return np.minimum(mantissa, config.mantissa.max)


def sum_of_squares(mantissa):
    """Stage 3: |m|**2, exact. 1/4 <= |m|**2 <= 3, or 0 for the zero vector."""
    return (mantissa * mantissa).sum(axis=0)


def root_operand(square, config: Config):
    """Stage 4: |m|**2 as `root_operand` in [1, 4), times 4 if below 1 (`below_one`)."""
    one = 2 * config.mantissa.fraction
    below_one = (square >> one) == 0
    drop = one - config.root_operand.fraction
    return np.where(below_one, square >> (drop - 2), square >> drop), below_one


def scale(mantissa, root, below_one):
    """Stage 6: m / |m|, exact products; doubled if the operand was taken four times."""
    return (mantissa * root) << below_one


def round_unit(product, config: Config):
    """Stage 7: the unit normal in `unit`, and |Zn| in `cosine`, each rounded once.

    Without `specular` there is no unit normal: zeros. Without `two_sided` the cosine of a Zn below
    0 is of no use and the largest code.
    """
    fraction = config.mantissa.fraction + config.root.fraction
    z = product[2]
    cosine = fixed.saturate(
        fixed.round_shift(np.abs(z), fraction - config.cosine.fraction), config.cosine
    )
    if not config.two_sided:
        cosine = np.where(z < 0, config.cosine.max, cosine)
    if not config.specular:
        return np.zeros_like(product), cosine
    # Parts across h have one fraction bit less (see `across`).
    less = np.array([[1], [1], [0]]) if config.normal_method == "dot_first" else 0
    drop = fraction - config.unit.fraction - less
    unit = fixed.saturate((product + (1 << (drop - 1))) >> drop, config.unit)
    return unit, cosine


def lit(normal, two_sided: bool):
    """Zn > 0, or Zn not 0 if `two_sided`: decided on the interpolated Zn, before any rounding."""
    return (normal[2] > 0) | (two_sided & (normal[2] < 0))


def zero(normal):
    """Whether it is the zero vector, bool[n]: `zero_normal` of the RTL."""
    return (normal == 0).all(axis=0)


def normalizer(
    normal, two_sided: bool, config: Config, trace: dict | None = None, half_vector=(0, 0)
):
    """Unit normal, |cos(i)| and whether they are lit, of interpolated normals.

    By the method `dot_first` the parts q and p across `half_vector` take the places of x and y:
    dot products first, then the scale.
    normal: int64[3, n] in `normal`. Returns unit int64[3, n] in `unit`, |Zn| int64[n] in
    `cosine`, which keeps one more bit, and lit bool[n]. The zero vector gives zeros, not lit.
    """
    shift = leading_zeros(normal, config)
    mantissa = align(normal, shift, config)
    square = sum_of_squares(mantissa)
    operand, below_one = root_operand(square, config)
    root = inverse_sqrt(operand, config, trace)
    scaled = mantissa
    if config.normal_method == "dot_first":
        cross_xz, cross_y = half_vector_cross_mantissa(mantissa, half_vector, config)
        scaled = np.stack([cross_y, cross_xz, mantissa[2]])
    product = scale(scaled, root, below_one)
    unit, cosine = round_unit(product, config)
    if trace is not None:
        trace["normalizer.leading_zeros"] = (shift,)
        trace["normalizer.align"] = tuple(mantissa)
        trace["normalizer.sum_of_squares"] = (square,)
        trace["normalizer.root_operand"] = (operand, below_one.astype(np.int64))
        trace["normalizer.scale"] = tuple(product)
        trace["normalizer.round"] = (*unit, cosine)
        trace["normalizer.lit"] = (lit(normal, two_sided).astype(np.int64),)
        trace["normalizer.zero"] = (zero(normal).astype(np.int64),)
    return unit, cosine, lit(normal, two_sided)
