# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/light_scale.v: a light's unit normal, from its mantissas and 1/|N0|."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Flags, Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.normalizer import round_unit


def scale(mantissa: Ints, root: Ints, below_one: Flags, less: Flags) -> Ints:
    """Stage 1: m / |m0|, exact products; doubled where the root's operand was taken four times, and
    where the mantissas are shifted less than those of N0."""
    return (mantissa * root) << (below_one.astype(np.int64) + less)


def light_scale(
    mantissa: Ints, root: Ints, below_one: Flags, less: Flags, config: Config,
    trace: Trace | None = None,
) -> tuple[Ints, Ints]:  # fmt: skip
    """The unit normal int64[3, n] in `unit` (s0.17) and |Zn| int64[n] in `cosine` (u0.18), each
    rounded once and clamped. Arguments as of `light_align` and `held_root`."""
    product = scale(mantissa, root, below_one, less)
    unit, cosine = round_unit(product, config)
    if trace is not None:
        trace["light_scale.scale"] = tuple(product)
        trace["light_scale.round"] = (*unit, cosine)
    return unit, cosine
