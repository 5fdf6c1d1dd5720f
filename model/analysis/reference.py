# SPDX-License-Identifier: MIT
"""The float64 reference: the paper's eq. (3), written from the paper, not from the hardware.

It shares no arithmetic with the twin: no table, no rounding, no block, and cos(s) in the paper's
own form.
"""

from __future__ import annotations

import numpy as np

from phong75.model.config import DEFAULT, Config
from phong75.model.frame import ExactFrame, Frame


def shade(normal, cp_d, cp_rest, weight, exponent, eye, two_sided: bool):
    """255 * clamp(S, 0, 1), float64[n, 3], by the paper's eq. (3).

    normal: float64[n, 3], any length, light frame. cp_d, cp_rest: float64[n, 3], Cp d and
    Cp (1 - d). weight: float64[n, P], W at equally spaced Zn. exponent: float64[n].
    eye: float64[3] or [n, 3], unit. A normal turned away from the light, or zero, leaves Cp d.
    """
    if two_sided:
        normal = np.where(normal[:, 2:] < 0, -normal, normal)
    lit = normal[:, 2] > 0
    length = np.sqrt((normal**2).sum(axis=1))
    n = normal / np.where(length > 0, length, 1)[:, None]
    cos_i = n[:, 2]
    cos_s = np.maximum(2 * cos_i * (n * eye).sum(axis=1) - eye[..., 2], 0)
    points = weight.shape[1]
    place = np.clip(cos_i, 0, 1) * (points - 1)
    left = np.minimum(place.astype(np.int64), points - 2)
    row = np.arange(len(n))
    w = weight[row, left] + (weight[row, left + 1] - weight[row, left]) * (place - left)
    s = cp_d + np.where(lit, cos_i, 0)[:, None] * cp_rest
    s = s + np.where(lit, w * cos_s**exponent, 0)[:, None]
    return 255 * np.clip(s, 0, 1)


def _pixels(spans, start, step):
    """Normals float64[n, 3] and material indices of all pixels of `spans`."""
    length = np.maximum(spans["length"], 1)
    span = np.repeat(np.arange(len(spans)), length)
    k = np.arange(len(span)) - np.repeat(np.cumsum(length) - length, length)
    return start[span] + k[:, None] * step[span], spans["material"][span]


def eye_of(half_vector) -> np.ndarray:
    """The unit vector u, float64[..., 3], whose half vector to the light is along (hx, 0, hz).

    half_vector: hx and hz, numbers or arrays[...].
    """
    hx, hz = np.asarray(half_vector, np.float64)
    h = np.stack([hx, np.zeros_like(hx), hz], axis=-1)
    h /= np.linalg.norm(h, axis=-1, keepdims=True)
    return 2 * h[..., 2:] * h - np.array([0, 0, 1.0])


def zero_normals(frame: Frame) -> int:
    """How many pixels have no direction: their interpolated normal is zero."""
    normal, _ = _pixels(
        frame.spans, frame.spans["start"].astype(float), frame.spans["step"].astype(float)
    )
    return int((normal == 0).all(axis=1).sum())


def render(frame: Frame, config: Config = DEFAULT) -> np.ndarray:
    """255 * clamp(S, 0, 1), float64[n, 3], in the order of the stream, from the integers at the
    ports and in the tables."""
    start, step = frame.spans["start"].astype(float), frame.spans["step"].astype(float)
    if config.technique != "phong":
        intensity, _ = _pixels(frame.spans, start, step)
        return 255 * np.clip(intensity / config.normal.one, 0, 1)
    normal, material = _pixels(frame.spans, start, step)
    table, real = frame.materials, config.coefficient.real
    return shade(
        normal, real(table.ambient)[material], real(table.diffuse)[material],
        real(table.weight)[material], config.exponent.real(table.exponent)[material],
        eye_of(frame.half_vector), frame.two_sided,
    )  # fmt: skip


def render_exact(frame: Frame, exact: ExactFrame, config: Config = DEFAULT) -> np.ndarray:
    """The same from the scene's values before any rounding."""
    normal, m = _pixels(frame.spans, exact.start, exact.step)
    if config.technique != "phong":
        return 255 * np.clip(normal, 0, 1)
    cp, d = exact.cp, exact.d[:, None]
    return shade(
        normal, (cp * d)[m], (cp * (1 - d))[m], exact.weight[m], exact.exponent[m],
        exact.eye, frame.two_sided,
    )  # fmt: skip
