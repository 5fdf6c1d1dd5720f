# SPDX-License-Identifier: MIT
"""Twin of rtl/reflectance/stepped_weight.v: W(i), straight lines between points, with jumps."""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.twin.core.specular_weight import lookup
from phong75.model.twin.reflectance.jumps import jumps as jumps_of
from phong75.model.twin.reflectance.stepped_line import stepped_line


def stepped_weight(
    cosine: Ints, material: Ints, weight: Ints, jumps: Ints | None, config: Config,
    trace: Trace | None = None,
) -> Ints:  # fmt: skip
    """W(i), int64[n] in `weight` (u1.17).

    cosine, material, weight: as in `specular_weight`. jumps: as `weight_jumps` of `MaterialTable`.
    """
    left, step, offset = lookup(cosine, material, weight, config)
    fall = jumps_of(cosine, material, jumps, config.weight_jumps)
    bits = config.cosine.bits - config.weight_index_bits
    inner: Trace | None = None if trace is None else {}
    w = stepped_line(left, step, offset, fall, bits, config.weight, config, inner)
    if trace is not None and inner is not None:
        trace["stepped_weight.lookup"] = (left, step, offset)
        trace["stepped_weight.level"] = inner["stepped_line.level"]
        trace["stepped_weight.result"] = (w,)
    return w
