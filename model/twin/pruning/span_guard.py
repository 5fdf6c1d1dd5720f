# SPDX-License-Identifier: MIT
"""Twin of rtl/pruning/span_guard.v: which spans need what a build leaves out."""

from __future__ import annotations

import dataclasses

from phong75.model.arrays import Flags, Spans
from phong75.model.config import Config
from phong75.model.frame import walked
from phong75.model.twin.core.normalizer import leading_zeros
from phong75.model.twin.core.phong_unit import interpolate
from phong75.model.twin.core.span_walker import walk


def span_guard(spans: Spans, built: Config) -> Flags:
    """Which of the legal `spans` (SPAN_DTYPE[n]) the RTL of `built` flags as unsupported, bool[n].

    Flagged are a step or a bend that is not 0 in a component that `built` does not interpolate, a
    step, material or place beyond its narrowed words, and a pixel whose normal has another shift
    than `built.constant_shift`. Step and bend of a span of one pixel do not count.
    """
    longer = (spans["length"] > 1)[:, None]
    fixed = [not getattr(built, f"interpolate_{axis}") for axis in "xyz"]
    limit = 1 << (built.normal.bits - 1 - built.idle_step_bits)
    step = spans["step"]
    moves = (step != 0) | (spans["bend"] != 0)
    bad = (longer & (fixed & moves | (step < -limit) | (step >= limit))).any(axis=1)
    right = spans["x"] + walked(spans) - 1
    for largest, bits, idle in (
        (spans["material"], built.material_bits, built.idle_material_bits),
        (right, built.coordinate_bits, built.idle_x_bits),
        (spans["y"], built.coordinate_bits, built.idle_y_bits),
    ):
        bad |= largest >= 1 << (bits - idle)
    if built.constant_shift:
        full = dataclasses.replace(built, constant_shift=())
        for _, pixels in walk(spans, full):
            normal, _ = interpolate(spans, pixels.span, pixels.k, full)
            shift = leading_zeros(normal, full)
            bad[pixels.span[shift != built.constant_shift[0]]] = True
    return bad
