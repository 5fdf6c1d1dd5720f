"""The shading of vertices and faces, for the techniques that interpolate intensities or nothing.

Gouraud "computes information about the curvature of the surface at each vertex ... From the
curvature, a shade intensity is computed and retained" (Phong 1975). It is computed by the integer
twin of normalizer and shading unit, as hardware beside the pipeline would, and once more in
float64.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from phong75.model.analysis import reference
from phong75.model.config import Config
from phong75.model.frame import ExactFrame, Frame
from phong75.model.twin.phong_pipeline import shade


def intensities(normal, material, frame: Frame, config: Config) -> np.ndarray:
    """S of red, green, blue by the twin, float64[n, 3]: multiples of the LSB of `intensity`.

    normal: float64[n, 3], unit, light frame; material: int[n]. frame: registers and materials.
    """
    trace: dict = {}
    phong = replace(config, technique="phong", channels=3)
    shade(config.normal.quantize(normal).T, material, frame, phong, trace)
    return config.intensity.real(np.stack(trace["shading_unit.intensity"], axis=-1))


def exact_intensities(normal, material, exact: ExactFrame, two_sided: bool) -> np.ndarray:
    """S of red, green, blue by eq. (3) in float64, clamped to [0, 1], float64[n, 3].

    Arguments as above; exact: eye and materials before rounding.
    """
    cp, d = exact.cp, exact.d[:, None]
    return (
        reference.shade(
            normal, (cp * d)[material], (cp * (1 - d))[material], exact.weight[material],
            exact.exponent[material], exact.eye, two_sided,
        )
        / 255
    )  # fmt: skip
