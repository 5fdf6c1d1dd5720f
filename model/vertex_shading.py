# SPDX-License-Identifier: MIT
"""The shading of vertices and faces, for the techniques that interpolate intensities or nothing.

Gouraud "computes information about the curvature of the surface at each vertex ... From the
curvature, a shade intensity is computed and retained" (Phong 1975). Hardware beside the pipeline
would compute that intensity. This module computes it with the integer twin of normalizer and
shading unit, and once more in float64.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from phong75.model.analysis import reference
from phong75.model.arrays import Ints, Reals, Trace
from phong75.model.config import Config
from phong75.model.frame import ExactFrame, Frame
from phong75.model.twin.core.phong_unit import shade


def shade_vertices(
    normal: Reals, material: Ints, frame: Frame, exact: ExactFrame, config: Config
) -> tuple[Reals, Reals]:
    """S of red, green, blue as the hardware computes S, and exactly: a `VertexShader`.

    Arguments and results as in `front.scene_to_spans.VertexShader`.
    """
    return (
        intensities(normal, material, frame, config),
        exact_intensities(normal, material, exact, frame.two_sided),
    )


def intensities(normal: Reals, material: Ints, frame: Frame, config: Config) -> Reals:
    """S of red, green, blue by the twin, float64[n, 3]: multiples of the LSB of `intensity`.

    normal: float64[n, 3], unit vectors in the light frame. material: int64[n]. frame: registers and
    material table.
    """
    trace: Trace = {}
    phong = replace(config, technique="phong", channels=3)
    shade(config.normal.quantize(normal).T, material, frame, phong, trace)
    return config.intensity.real(np.stack(trace["colour_channel.intensity"], axis=-1))


def exact_intensities(normal: Reals, material: Ints, exact: ExactFrame, two_sided: bool) -> Reals:
    """S of red, green, blue by eq. (3) of the paper in float64, clamped to [0, 1], float64[n, 3].

    normal, material: as above. exact: eye and materials before rounding. two_sided: shade |Zn|.
    """
    cp, d = exact.cp, exact.d[:, None]
    return (
        reference.shade(
            normal, (cp * d)[material], (cp * (1 - d))[material], exact.weight[material],
            exact.exponent[material], exact.eye, two_sided,
        )
        / 255
    )  # fmt: skip
