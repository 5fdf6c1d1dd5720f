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

from phong75.model.analysis import reference
from phong75.model.arrays import Ints, Reals, Trace
from phong75.model.config import Config
from phong75.model.frame import ExactFrame, Frame, fitted
from phong75.model.twin.core.phong_unit import shade
from phong75.model.twin.lights import lights_unit


def shade_vertices(
    normal: Reals, material: Ints, frame: Frame, exact: ExactFrame, config: Config
) -> tuple[Reals, Reals]:
    """S of red, green, blue as the hardware computes S, and exactly: a `VertexShader`.

    Arguments and results as in `front.scene_to_spans.VertexShader`.
    """
    return (
        intensities(normal, material, frame, config, [light.turn for light in exact.further]),
        exact_intensities(normal, material, exact, frame.two_sided),
    )


def intensities(
    normal: Reals, material: Ints, frame: Frame, config: Config, turns: Sequence[Reals] = ()
) -> Reals:
    """S of red, green, blue by the twin, float64[n, 3]: multiples of the LSB of `intensity`.

    normal: float64[n, 3], unit vectors in the first light's frame. material: int64[n]. frame:
    registers and material table. turns: float64[3, 3] of each further light, as in `ExactLight`.
    """
    phong = fitted(replace(config, technique="phong", channels=3), frame)
    normals = [normal, *(normal @ turn.T for turn in turns)]
    codes = np.stack([config.normal.quantize(n).T for n in normals])
    traces: list[Trace] = [{} for _ in normals]
    if phong.sums_lights:
        lights_unit.shade(codes, material, frame, phong, traces)
        stage = "light_sum.clamp"
    else:
        shade(codes[0], material, frame, phong, traces[0])
        stage = "colour_channel.intensity"
    return config.intensity.real(np.stack(traces[-1][stage], axis=-1))


def exact_intensities(normal: Reals, material: Ints, exact: ExactFrame, two_sided: bool) -> Reals:
    """S of red, green, blue in float64, clamped to [0, 1], float64[n, 3].

    normal, material: as above. exact: eye and materials before rounding. two_sided: shade |Zn|.
    """
    return reference.shade_exact(normal, material, exact, two_sided, white=1)
