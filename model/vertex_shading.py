# SPDX-License-Identifier: MIT
"""The shading of vertices and faces, for the techniques that interpolate intensities or nothing.

Gouraud "computes information about the curvature of the surface at each vertex ... From the
curvature, a shade intensity is computed and retained" (Phong 1975). Hardware beside the pipeline
would compute that intensity. This module computes it with the integer twin of normalizer and
shading unit, and once more in float64.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from phong75.model import places
from phong75.model.analysis import reference
from phong75.model.arrays import Ints, Reals, Trace
from phong75.model.config import Config
from phong75.model.frame import (
    ExactFrame,
    Frame,
    depth_codes,
    distance_range,
    falloff_codes,
    fitted,
    half_angle_codes,
)
from phong75.model.twin.core.phong_unit import shade
from phong75.model.twin.lights import lights_unit


def shade_vertices(
    normal: Reals, material: Ints, frame: Frame, exact: ExactFrame, config: Config, points: Reals
) -> tuple[Reals, Reals]:
    """S of red, green, blue as the hardware computes S, and exactly: a `VertexShader`.

    Arguments and results as in `front.scene_to_spans.VertexShader`.
    """
    turns = [np.eye(3), *(light.turn for light in exact.further)]
    normals = [normal @ turn.T for turn in turns]
    if exact.places:
        frame, normals = _placed(normals, frame, exact, config, points)
    return (
        intensities(normals, material, frame, config),
        exact_intensities(normal, material, exact, frame.two_sided, points),
    )


def _placed(
    normals: list[Reals], frame: Frame, exact: ExactFrame, config: Config, points: Reals
) -> tuple[Frame, list[Reals]]:
    """The frame with a half vector, a depth and a factor for each vertex, as if a vertex were a
    span; and the `normals` in each light's frame, which for a light at a place is another at each
    vertex."""
    normal = normals[0]  # the first light's turn changes nothing
    frames = [frame.light(number, config) for number in range(frame.lights)]
    half_vectors = np.stack([np.tile(f.half_vector, (len(points), 1)) for f in frames])
    depths, falloff = np.zeros_like(half_vectors), []
    for number, place in enumerate(exact.places):
        if place.position is not None:
            axes, angle = places.frames(places.toward(place.position, points, exact.eye), exact.eye)
            half_vectors[number] = half_angle_codes(angle, config)
            normals[number] = places.seen(axes, normal)
        distance = place.distance(points, exact.eye)
        low, high = distance_range([distance], place.falloff)
        depths[number] = depth_codes(
            distance, distance, np.zeros(len(points), np.int64), low, high, config
        )
        falloff.append(falloff_codes(place.falloff, low, high, config))
    falls = any(place.falloff for place in exact.places)
    return replace(
        frame, half_vectors=half_vectors, depths=depths if falls else None,
        falloff=np.stack(falloff) if falls else None,
    ), normals  # fmt: skip


def intensities(normals: Sequence[Reals], material: Ints, frame: Frame, config: Config) -> Reals:
    """S of red, green, blue by the twin, float64[n, 3]: multiples of the LSB of `intensity`.

    normals: float64[n, 3] of each light, unit vectors in its frame. material: int64[n]. frame:
    registers and material table; where it has half vectors or depths, those of a vertex are in the
    place of a span's.
    """
    phong = fitted(replace(config, technique="phong", channels=3), frame)
    codes = np.stack([config.normal.quantize(n).T for n in normals])
    traces: list[Trace] = [{} for _ in normals]
    if phong.sums_lights:
        depths = None if frame.depths is None else frame.depths[..., 0]
        span = None if frame.half_vectors is None else np.arange(len(material))
        lights_unit.shade(codes, material, frame, phong, traces, span, depths)
        stage = "light_sum.clamp"
    else:
        shade(codes[0], material, frame, phong, traces[0])
        stage = "colour_channel.intensity"
    return config.intensity.real(np.stack(traces[-1][stage], axis=-1))


def exact_intensities(
    normal: Reals, material: Ints, exact: ExactFrame, two_sided: bool, points: Reals | None = None
) -> Reals:
    """S of red, green, blue in float64, clamped to [0, 1], float64[n, 3].

    normal, material: as above, in the first light's frame. exact: eye and materials before
    rounding. two_sided: shade |Zn|. points: float64[n, 3], if `exact` has places.
    """
    return reference.shade_exact(normal, material, exact, two_sided, white=1, points=points)
