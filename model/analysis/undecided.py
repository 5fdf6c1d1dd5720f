# SPDX-License-Identifier: MIT
"""Pixels at a jump of W(i) or of a curve of cos(s): either side of the jump is right there.

The hardware computes cos(i) and 1 - cos(s) with an error that the budget bounds. Where a jump is
nearer than that, no bound of the error is smaller than the jump. For such a pixel the reference is
the interval between the values on both sides, and the error is the distance to the interval. The
same holds where two lines of a curve do not meet.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from phong75.model.analysis import error_budget, reference
from phong75.model.arrays import Ints, Reals
from phong75.model.config import Config
from phong75.model.frame import ExactFrame, Frame

#: A pixel counts as undecided where the interval is wider than this, LSB.
UNDECIDED_LSB = 0.5


class Nearest(NamedTuple):
    """ideal: float64[n, 3], of the values that the reference allows, those nearest to the codes.
    undecided: number of pixels at a jump."""

    ideal: Reals
    undecided: int


def _sides(frame: Frame, config: Config, rounded: bool) -> reference.Sides:
    """How far cos(i) and 1 - cos(s) of the hardware can be from the exact ones.

    rounded: also cover the rounding of the half vector, of a threshold, and of a unit normal by up
    to one LSB of its components.
    """
    lights = [frame.light(number, config) for number in range(frame.lights)]
    reach = [None, *(error_budget.reaches(frame) if frame.further else [])]
    unit = config.unit.lsb if rounded else 0.0
    cosine = max(error_budget.cosine(config, reach=r) for r in reach) + 2 * unit

    def versine(v: Reals) -> Reals:
        widest = np.zeros_like(v)
        for light, its_reach in zip(lights, reach, strict=True):
            dv = error_budget.versine(v, light.half_vector, config, reach=its_reach)
            relative, absolute = error_budget.half_vector_cross(
                light.half_vector, config, reach=its_reach
            )
            w, extra = np.sqrt(v / 2), unit + (config.half_vector.lsb if rounded else 0.0)
            dw = relative * w + absolute + extra
            dv = dv + 4 * (w + dw) * extra + config.versine.lsb
            widest = np.maximum(widest, dv)
        return widest

    return reference.Sides(cosine, versine)


def nearest(codes: Ints, frame: Frame, config: Config, exact: ExactFrame | None = None) -> Nearest:
    """`reference.render`, or with `exact` `reference.render_exact`, moved towards `codes`
    (int64[n, 3]) where a pixel is at a jump. Rows beyond those of `codes` stay as they are."""

    def rendered(sides: reference.Sides | None = None) -> Reals:
        if exact is None:
            return reference.render(frame, config, sides)
        return reference.render_exact(frame, exact, config, sides)

    ideal = rendered()
    table = frame.materials
    jumps = table.curve is not None or table.weight_jumps is not None or config.has_curves
    if config.technique != "phong" or not jumps:
        return Nearest(ideal, 0)
    far, low, high = _sides(frame, config, exact is not None), ideal, ideal
    for weight in (-far.weight, far.weight):
        for versine in (far.versine, lambda v: -far.versine(v)):
            other = rendered(reference.Sides(weight, versine))
            low, high = np.minimum(low, other), np.maximum(high, other)
    undecided = int(((high - low).max(axis=1, initial=0) > UNDECIDED_LSB).sum())
    both = min(len(codes), len(ideal))
    moved = ideal.copy()
    moved[:both] = np.clip(codes[:both], low[:both], high[:both])
    return Nearest(moved, undecided)
