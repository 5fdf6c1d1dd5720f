"""Twin of rtl/phong_pipeline.v: spans in, pixels out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame
from phong75.model.spans import squares_only
from phong75.model.twin.core.linear_interpolator import linear_interpolator
from phong75.model.twin.core.normalizer import normalizer, zero
from phong75.model.twin.core.shading_unit import shading_unit
from phong75.model.twin.core.span_walker import span_walker
from phong75.model.twin.methods.quadratic_unit import quadratic_unit
from phong75.model.twin.methods.unnormalized import unnormalized
from phong75.model.twin.techniques.flat_unit import flat_unit
from phong75.model.twin.techniques.gouraud_unit import gouraud_unit

#: Pixels worked on at a time: the temporaries of one block fit the cache.
BLOCK = 1 << 14


@dataclass
class Pixels:
    """Pixels in the order of the stream: x, y int64[n], rgb int64[n, 3], last bool[n]."""

    x: np.ndarray
    y: np.ndarray
    rgb: np.ndarray
    last: np.ndarray


def interpolate(spans, span, k, config: Config):
    """The three interpolators: normals int64[3, n], and whether a component left its word."""
    parts = [
        linear_interpolator(spans["start"][span, axis], spans["step"][span, axis], k, config)
        for axis in range(3)
    ]
    return np.stack([p[0] for p in parts]), parts[0][1] | parts[1][1] | parts[2][1]


def shade(normal, material, frame: Frame, config: Config = DEFAULT, trace: dict | None = None):
    """Codes int64[3, n] of interpolated normals (int64[3, n] in `normal`) and their materials."""
    if config.normal_method == "none":
        unit, cosine, lit = unnormalized(normal, frame.two_sided, config, trace)
    else:
        half_vector = config.constant_half_vector or frame.half_vector
        unit, cosine, lit = normalizer(normal, frame.two_sided, config, trace, half_vector)
    return shading_unit(unit, cosine, lit, material, frame, config, trace)


def colours(frame: Frame, span, k, config: Config):
    """Codes int64[3, n] of pixel `k` of the spans number `span` (int64[n]), by any technique."""
    if config.technique == "gouraud":
        return gouraud_unit(frame.spans, span, k, config)
    if config.technique == "flat":
        return flat_unit(frame.spans, span, config)
    if squares_only(config):
        return quadratic_unit(frame, span, k, config)
    normal, _ = interpolate(frame.spans, span, k, config)
    return shade(normal, frame.spans["material"][span], frame, config)


def render(
    frame: Frame, config: Config = DEFAULT, progress: Callable[[float], None] | None = None
) -> Pixels:
    """All pixels of `frame`, to the bit as the RTL gives them."""
    spans = frame.spans
    total = int(np.maximum(spans["length"], 1).sum())
    x, y = np.empty(total, np.int64), np.empty(total, np.int64)
    rgb, last = np.empty((total, 3), np.int64), np.empty(total, bool)
    for first in range(0, total, BLOCK):
        block = slice(first, min(first + BLOCK, total))
        span, k, x[block], y[block], last[block] = span_walker(spans, first, block.stop, config)
        rgb[block] = colours(frame, span, k, config).T
        if progress:
            progress(block.stop / total)
    return Pixels(x, y, rgb, last)


def zero_normals(frame: Frame, config: Config = DEFAULT) -> int:
    """How many pixels of `frame` have the zero vector for a normal (the RTL flags each).

    None where nothing is normalized.
    """
    if config.technique != "phong" or config.normal_method == "none":
        return 0
    spans, count = frame.spans, 0
    total = int(np.maximum(spans["length"], 1).sum())
    for first in range(0, total, BLOCK):
        span, k, *_ = span_walker(spans, first, min(first + BLOCK, total), config)
        count += int(zero(interpolate(spans, span, k, config)[0]).sum())
    return count
