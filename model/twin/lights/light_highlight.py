# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/light_highlight.v: W(i) cos(s)**n of one light, rounded if it is multiplied by
a colour or by the factor of the distance."""

from __future__ import annotations

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.twin.core.shading_unit import specular_term
from phong75.model.twin.primitives.round_saturate import round_saturate


def round_highlight(product: Ints, config: Config) -> Ints:
    """Stage 2: W(i) cos(s)**n in `highlight` (u0.18), rounded half up. The product is below 1."""
    drop = config.weight.fraction + config.power.fraction - config.highlight.fraction
    return round_saturate(product, drop, config.highlight)


def light_highlight(
    unit: Ints, cosine: Ints, material: Ints, frame: Frame, config: Config,
    trace: Trace | None = None,
) -> Ints:  # fmt: skip
    """W(i) cos(s)**n, int64[n]: in `highlight` (u0.18) with `Config.rounds_highlight`, else the
    product of `weight` and `power` (u1.35).

    unit: int64[3, n] in `unit` (s0.17). cosine: int64[n] in `cosine` (u0.18). material: int64[n].
    frame: materials, and the half vector
    of the light, as two numbers or int64[n] each.
    """
    product = specular_term(unit, cosine, material, frame, config, trace)
    word = round_highlight(product, config) if config.rounds_highlight else product
    if trace is not None:
        trace["light_highlight.round"] = (word,)
    return word
