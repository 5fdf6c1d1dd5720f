# SPDX-License-Identifier: MIT
"""Twin of rtl/core/normalizer.v: an interpolated normal of any length becomes a unit normal.

This is the paper's "extra hardware ... to normalize the outputs of the interpolators" (Phong 1975,
Conclusion). The components are shifted together until the largest one fills the word; then they are
multiplied by 1/sqrt of the sum of their squares.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.half_vector_cross import half_vector_cross_mantissa
from phong75.model.twin.core.inverse_sqrt import inverse_sqrt
from phong75.model.twin.primitives.leading_zeros import leading_zeros as zeros_above
from phong75.model.twin.primitives.round_saturate import round_half_up, round_saturate


def leading_zeros(normal: Ints, config: Config) -> Ints:
    """Stage 1: the shift int64[n] that brings the largest of three components to the top.

    normal: int64[3, n] in `normal` (s1.30). With `constant_shift` it is the shift of the build.
    """
    if config.constant_shift:
        return np.full(normal.shape[1], config.constant_shift[0])
    sign = normal >> (config.normal.bits - 1)
    ones = (normal[0] ^ sign[0]) | (normal[1] ^ sign[1]) | (normal[2] ^ sign[2])
    return zeros_above(ones, config.normal.bits - 1)


def align(normal: Ints, shift: Ints, config: Config) -> Ints:
    """Stage 2: block-normalized components int64[3, n] in `mantissa` (s0.17), rounded half up and
    clamped below 1."""
    drop = config.normal.bits - config.mantissa.bits
    return np.minimum(round_half_up(normal << shift, drop), config.mantissa.max)


def sum_of_squares(mantissa: Ints) -> Ints:
    """Stage 3: |m|**2, exact: between 1/4 and 3, or 0 for the zero vector."""
    return (mantissa * mantissa).sum(axis=0)


def root_operand(square: Ints, config: Config) -> tuple[Ints, Flags]:
    """Stage 4: |m|**2 in `root_operand` (u2.20), cut; and whether it was below 1.

    A value below 1 is taken four times, so that all operands but 0 are in [1, 4).
    """
    one = 2 * config.mantissa.fraction
    below_one = (square >> one) == 0
    drop = one - config.root_operand.fraction
    return np.where(below_one, square >> (drop - 2), square >> drop), below_one


def scale(mantissa: Ints, root: Ints, below_one: Flags) -> Ints:
    """Stage 6: m / |m|, exact products; doubled where the operand was taken four times."""
    return (mantissa * root) << below_one


def round_unit(product: Ints, config: Config) -> tuple[Ints, Ints]:
    """Stage 7: the unit normal int64[3, n] in `unit` (s0.17) and |Zn| int64[n] in `cosine` (u0.18),
    each rounded once.

    Without `specular` there is no unit normal: zeros. Without `two_sided` a Zn below 0 gives the
    largest code, since such a pixel is not lit.
    """
    fraction = config.mantissa.fraction + config.root.fraction
    z = product[2]
    cosine = round_saturate(np.abs(z), fraction - config.cosine.fraction, config.cosine)
    if not config.two_sided:
        cosine = np.where(z < 0, config.cosine.max, cosine)
    if not config.specular:
        return np.zeros_like(product), cosine
    # By `dot_first`, x and y hold components of N x h with one fraction bit less.
    less = np.array([[1], [1], [0]]) if config.normal_method == "dot_first" else 0
    drop = fraction - config.unit.fraction - less
    rounded = (product + (1 << (drop - 1))) >> drop
    return np.clip(rounded, config.unit.min, config.unit.max), cosine


def lit(normal: Ints, two_sided: bool) -> Flags:
    """Whether Zn > 0, or with `two_sided` Zn is not 0: bool[n], decided on the interpolated Zn
    before any rounding. normal: int64[3, n]."""
    return (normal[2] > 0) | (two_sided & (normal[2] < 0))


def zero(normal: Ints) -> Flags:
    """Whether a normal (int64[3, n]) is the zero vector, bool[n]: `zero_normal` of the RTL."""
    return (normal == 0).all(axis=0)


def normalizer(
    normal: Ints, two_sided: bool, config: Config, trace: Trace | None = None,
    half_vector: tuple[int, ...] = (0, 0),
) -> tuple[Ints, Ints, Flags]:  # fmt: skip
    """Unit normal, |cos(i)|, and whether the pixel is lit.

    normal: int64[3, n] in `normal` (s1.30). two_sided: shade |Zn|. Returns the unit normal
    int64[3, n] in `unit` (s0.17), |Zn| int64[n] in `cosine` (u0.18) and lit bool[n]. The zero
    vector gives zeros and is not lit.

    By the method `dot_first`, dot products come before the scaling: x and y of the result are
    `cross_y` and `cross_xz` of N x h (see `half_vector_cross`). half_vector: (hx, hz) in
    `half_vector` (s0.17).
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
    is_lit = lit(normal, two_sided)
    if trace is not None:
        trace["normalizer.leading_zeros"] = (shift,)
        trace["normalizer.align"] = tuple(mantissa)
        trace["normalizer.sum_of_squares"] = (square,)
        trace["normalizer.root_operand"] = (operand, below_one.astype(np.int64))
        trace["normalizer.scale"] = tuple(product)
        trace["normalizer.round"] = (*unit, cosine)
        trace["normalizer.lit"] = (is_lit.astype(np.int64),)
        trace["normalizer.zero"] = (zero(normal).astype(np.int64),)
    return unit, cosine, is_lit
