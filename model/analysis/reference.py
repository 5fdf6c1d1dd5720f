# SPDX-License-Identifier: MIT
"""Float64 reference: eq. (3) of Phong (1975), implemented from the paper, not from the hardware.

The reference shares no arithmetic with the twin: it has no tables and no rounding, and it computes
cos(s) in the form of the paper.
"""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import ArrayLike, Ints, Reals, Spans
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import ExactFrame, Frame


def shade(
    normal: Reals,
    cp_d: Reals,
    cp_rest: Reals,
    weight: Reals,
    exponent: Reals,
    eye: Reals,
    two_sided: bool,
) -> Reals:
    """255 clamp(S, 0, 1) by the paper's eq. (3), float64[n, 3].

    normal: float64[n, 3], any length, light frame.
    cp_d, cp_rest: float64[n, 3], Cp d and Cp (1 - d), 0 to 1.
    weight: float64[n, P], W at P equally spaced Zn from 0 to 1.
    exponent: float64[n], n of eq. (3).
    eye: float64[3] or [n, 3], unit vector u, light frame.
    two_sided: shade |Zn|.

    A zero normal, or one that points away from the light, gives Cp d.
    """
    if two_sided:
        normal = np.where(normal[:, 2:] < 0, -normal, normal)
    lit = normal[:, 2] > 0
    length = np.sqrt((normal**2).sum(axis=1))
    n = normal / np.where(length > 0, length, 1)[:, None]
    cos_i = n[:, 2]
    cos_s = np.maximum(2 * cos_i * (n * eye).sum(axis=1) - eye[..., 2], 0)
    points = weight.shape[1]
    position = np.clip(cos_i, 0, 1) * (points - 1)
    left = np.minimum(position.astype(np.int64), points - 2)
    row = np.arange(len(n))
    w = weight[row, left] + (weight[row, left + 1] - weight[row, left]) * (position - left)
    s = cp_d + np.where(lit, cos_i, 0)[:, None] * cp_rest
    s = s + np.where(lit, w * cos_s**exponent, 0)[:, None]
    return 255 * np.clip(s, 0, 1)


def _pixels(spans: Spans, start: Reals, step: Reals, bend: Reals) -> tuple[Reals, Ints]:
    """Interpolated vectors float64[n, 3] and material indices int[n] of all pixels of `spans`.

    start, step, bend: float64[spans, 3], value at the first pixel, change to the second, and growth
    of that change per pixel: Newton's forward differences of a parabola.
    """
    length = np.maximum(spans["length"], 1)
    span = np.repeat(np.arange(len(spans)), length)
    k = np.arange(len(span)) - np.repeat(np.cumsum(length) - length, length)
    value = start[span] + k[:, None] * step[span]
    if bend.any():
        # Whole numbers and fractions apart: both sums are then exact for the codes of legal spans.
        growth, whole = (k * (k - 1) / 2)[:, None], np.trunc(bend)
        value = value + growth * whole[span] + growth * (bend - whole)[span]
    return value, spans["material"][span]


def _differences(spans: Spans, config: Config) -> list[Reals]:
    """Start, step and bend of `spans`, float64[spans, 3] each, in units of the LSB of `normal`."""
    bend = np.ldexp(spans["bend"].astype(float), -config.bend_fraction_bits)
    return [spans["start"].astype(float), spans["step"].astype(float), bend]


def eye_of(half_vector: ArrayLike) -> Reals:
    """The unit eye vector u, float64[..., 3], light frame: u = 2 (h.k) h - k, k = (0, 0, 1).

    half_vector: (hx, hz), numbers or arrays[...], of any scale; h is the unit vector along
    (hx, 0, hz).
    """
    hx, hz = np.asarray(half_vector, np.float64)
    h = np.stack([hx, np.zeros_like(hx), hz], axis=-1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    return 2 * h[..., 2:] * h - np.array([0, 0, 1.0])


def zero_normals(frame: Frame, config: Config = DEFAULT) -> int:
    """Number of pixels of `frame` whose interpolated normal is the zero vector."""
    normal, _ = _pixels(frame.spans, *_differences(frame.spans, config))
    return int((normal == 0).all(axis=1).sum())


def render(frame: Frame, config: Config = DEFAULT) -> np.ndarray:
    """255 clamp(S, 0, 1) from the integers at the ports and in the tables, float64[n, 3].

    Rows are in the order of the stream. The comparison with the pipeline's codes shows the error of
    the pipeline alone.
    """
    differences = _differences(frame.spans, config)
    if config.technique != "phong":
        intensity, _ = _pixels(frame.spans, *differences)
        return 255 * np.clip(intensity / config.normal.one, 0, 1)
    normal, material = _pixels(frame.spans, *differences)
    table, real = frame.materials, config.coefficient.real
    return shade(
        normal, real(table.ambient)[material], real(table.diffuse)[material],
        real(table.weight)[material], config.exponent.real(table.exponent)[material],
        eye_of(frame.half_vector), frame.two_sided,
    )  # fmt: skip


def render_exact(frame: Frame, exact: ExactFrame, config: Config = DEFAULT) -> np.ndarray:
    """255 clamp(S, 0, 1) from the scene's values before any rounding, float64[n, 3].

    exact: the values that were rounded to `frame`. The comparison with the pipeline's codes also
    shows the error of rounding the input.
    """
    normal, m = _pixels(frame.spans, exact.start, exact.step, exact.bend)
    if config.technique != "phong":
        return 255 * np.clip(normal, 0, 1)
    cp, d = exact.cp, exact.d[:, None]
    return shade(
        normal, (cp * d)[m], (cp * (1 - d))[m], exact.weight[m], exact.exponent[m],
        exact.eye, frame.two_sided,
    )  # fmt: skip
