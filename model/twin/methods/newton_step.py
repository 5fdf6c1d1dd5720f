"""Twin of rtl/newton_step.v: one step of Newton's iteration for 1/sqrt(x)."""

from __future__ import annotations

from phong75.model import fixed
from phong75.model.config import Config


def square(y, config: Config):
    """Stage 1: y**2 in `root`."""
    return fixed.saturate(fixed.round_shift(y * y, config.root.bits), config.root)


def error(x, squared, config: Config):
    """Stage 2: e = 1 - x y**2, |e| < 1/4, in units of 2**-(bits + 1), up to one unit too small.

    x: int64[n], the top bits of the operand: 2 integer bits, as many bits as `root`.
    """
    bits = config.root.bits
    drop = 2 * bits - 2 - (bits + 1)
    word = ~((x * squared) >> drop) & ((1 << bits) - 1)
    return word - ((word >> (bits - 1)) << bits)


def better(y, e, config: Config):
    """Stage 3: y + y e / 2 in `root`, rounded."""
    bits = config.root.bits
    return fixed.saturate(fixed.round_shift((y << (bits + 2)) + y * e, bits + 2), config.root)


def newton_step(x, y, config: Config, trace: dict | None = None):
    """A better estimate (int64[n], `root`) of 1/sqrt(x) from the estimate `y` (`root`)."""
    squared = square(y, config)
    e = error(x, squared, config)
    result = better(y, e, config)
    if trace is not None:
        trace["newton_step.square"] = (squared,)
        trace["newton_step.error"] = (e,)
        trace["newton_step.better"] = (result,)
    return result
