# SPDX-License-Identifier: MIT
"""Twin of rtl/lights/lights_unit.v: Phong shading with several lights.

I = e + ka Ia + sum over lights of (ka La + kd Ld (N.L) + ks Ls W(i) cos(s)**n), for red, green and
blue. In turns, side by side, or in any mix of both the hardware gives the same bits, so that the
twin knows neither.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.twin.core.colour_channel import coefficient
from phong75.model.twin.core.normalizer import lit, zero
from phong75.model.twin.lights.context_interpolator import context_interpolator
from phong75.model.twin.lights.held_root import held_root
from phong75.model.twin.lights.light_align import light_align
from phong75.model.twin.lights.light_attenuation import light_attenuation
from phong75.model.twin.lights.light_highlight import light_highlight
from phong75.model.twin.lights.light_scale import light_scale
from phong75.model.twin.lights.light_sum import light_sum
from phong75.model.twin.lights.light_terms import light_terms


def interpolate(frame: Frame, span: Ints, k: Ints, config: Config) -> Ints:
    """Normals int64[lights, 3, n] in `normal` (s1.30) at pixel `k` of the spans number `span`
    (int64[n] each), each in its light's frame."""
    lights = [frame.light(number, config) for number in range(frame.lights)]
    return np.stack(
        [
            [
                context_interpolator(light.start[span, axis], light.step[span, axis], k, config)[0]
                for axis in range(3)
            ]
            for light in lights
        ]
    )


def depth_interpolators(frame: Frame, span: Ints, k: Ints, config: Config) -> Ints:
    """Depths int64[lights, n] in `depth` (s1.29) at pixel `k` of the spans number `span`."""
    assert frame.depths is not None
    return np.stack([
        context_interpolator(its[span, 0], its[span, 1], k, config, config.depth)[0]
        for its in frame.depths
    ])  # fmt: skip


def shade(
    normals: Ints, material: Ints, frame: Frame, config: Config,
    traces: list[Trace] | None = None, span: Ints | None = None, depths: Ints | None = None,
) -> Ints:  # fmt: skip
    """Codes int64[3, n] of red, green, blue.

    normals: int64[lights, 3, n] in `normal` (s1.30), each in its light's frame; the first one gives
    the length. Where it is the zero vector, no light reaches the pixel. material: int64[n]. frame:
    registers, material table and lights. traces: one for each light; the last one has the sum.
    span: int64[n], the span of each pixel, if spans bring their half vectors. depths: int64[lights,
    n] in `depth`, if lights fall with the distance.
    """
    table, first = frame.materials, None
    terms = np.zeros((config.channels, len(material)), np.int64)
    reached = ~zero(normals[0])
    for number, normal in enumerate(normals):
        trace = traces[number] if traces else None
        light = frame.light(number, config)
        half_vector: tuple[Any, ...] = light.half_vector
        if span is not None:
            half_vector = frame.half_vector_of(number, span, config)
        seen = dataclasses.replace(frame, half_vector=half_vector, further=[])
        mantissa, less, first = light_align(normal, first, config, trace)
        if number == 0:
            root, below_one = held_root(mantissa, config, trace)
        unit, cosine = light_scale(mantissa, root, below_one, less, config, trace)
        highlight = np.zeros_like(cosine)
        if config.specular:
            highlight = light_highlight(unit, cosine, material, seen, config, trace)
        if config.attenuation and depths is not None:
            cosine, highlight = light_attenuation(
                depths[number], number, cosine, highlight, frame, config, trace
            )
        reaches = lit(normal, frame.two_sided) & reached
        if trace is not None:
            trace["light_align.lit"] = (reaches.astype(np.int64),)
        terms += light_terms(
            coefficient(light.diffuse, (), material, config),
            coefficient(light.highlight, (), material, config),
            cosine, highlight, reaches, config, trace,
        )  # fmt: skip
    ambient = coefficient(table.ambient, (), material, config)
    colour = light_sum(ambient, terms, config, traces[-1] if traces else None)
    return np.broadcast_to(colour, (3, colour.shape[1]))


def lights_unit(frame: Frame, span: Ints, k: Ints, config: Config) -> Ints:
    """Codes int64[3, n] of red, green, blue at pixel `k` of the spans number `span` (int64[n]
    each) of `frame`."""
    normals = interpolate(frame, span, k, config)
    depths = depth_interpolators(frame, span, k, config) if config.attenuation else None
    material = frame.spans["material"][span].astype(np.int64)
    return shade(normals, material, frame, config, span=span, depths=depths)
