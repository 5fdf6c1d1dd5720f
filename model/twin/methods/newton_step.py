# SPDX-License-Identifier: MIT
"""Twin of rtl/methods/newton_step.v: one step of Newton's iteration for 1/sqrt(x).

y (3 - x y**2) / 2, computed as y + y e / 2 with the residual e = 1 - x y**2.
"""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.primitives.round_saturate import round_saturate


def square(y: Ints, config: Config) -> Ints:
    """Stage 1: y**2 in `root` (u0.18), rounded."""
    return round_saturate(y * y, config.root.bits, config.root)


def error(x: Ints, squared: Ints, config: Config) -> Ints:
    """Stage 2: the residual e = 1 - x y**2, |e| < 1/4, in units of 2**-(bits + 1) for `bits` of
    `root`: cut, then up to one more unit too small.

    x: int64[n], the top bits of the operand: 2 integer bits, as many bits as `root`.
    """
    bits = config.root.bits
    drop = 2 * bits - 2 - (bits + 1)
    word = ~((x * squared) >> drop) & ((1 << bits) - 1)
    return word - ((word >> (bits - 1)) << bits)


def better(y: Ints, e: Ints, config: Config) -> Ints:
    """Stage 3: y + y e / 2 in `root` (u0.18), rounded."""
    bits = config.root.bits
    return round_saturate((y << (bits + 2)) + y * e, bits + 2, config.root)


def newton_step(x: Ints, y: Ints, config: Config, trace: Trace | None = None) -> Ints:
    """A better estimate of 1/sqrt(x), int64[n] in `root` (u0.18), from the estimate `y` in `root`.

    x: as in `error`.
    """
    squared = square(y, config)
    e = error(x, squared, config)
    result = better(y, e, config)
    if trace is not None:
        trace["newton_step.square"] = (squared,)
        trace["newton_step.error"] = (e,)
        trace["newton_step.better"] = (result,)
    return result
