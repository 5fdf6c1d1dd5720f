# SPDX-License-Identifier: MIT
"""Twin of rtl/phong_pipeline.v: spans in, pixels out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from phong75.model.arrays import Flags, Ints
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame, with_lights
from phong75.model.twin.core.normalizer import zero
from phong75.model.twin.core.phong_unit import interpolate, phong_unit
from phong75.model.twin.core.span_walker import pixel_count, walk
from phong75.model.twin.lights import lights_unit
from phong75.model.twin.methods.quadratic_unit import quadratic_unit
from phong75.model.twin.techniques.flat_unit import flat_unit
from phong75.model.twin.techniques.gouraud_unit import gouraud_unit


@dataclass(repr=False)
class Pixels:
    """Pixels in the order of the stream.

    x, y: int64[n], place on the screen. rgb: int64[n, 3], codes of `colour_bits`. last: bool[n],
    the last pixel of the frame.
    """

    x: Ints
    y: Ints
    rgb: Ints
    last: Flags

    def __len__(self) -> int:
        return len(self.x)

    def __repr__(self) -> str:
        return f"Pixels({len(self)}, last: {int(self.last.sum())})"


def colours(frame: Frame, span: Ints, k: Ints, config: Config) -> Ints:
    """Codes int64[3, n] of red, green, blue at pixel `k` of the spans number `span` (int64[n] each)
    of `frame`, by the technique of `config`."""
    if config.technique == "gouraud":
        return gouraud_unit(frame.spans, span, k, config)
    if config.technique == "flat":
        return flat_unit(frame.spans, span, config)
    if config.sums_lights:
        return lights_unit.lights_unit(frame, span, k, config)
    if config.spans_carry_squares:
        return quadratic_unit(frame, span, k, config)
    return phong_unit(frame, span, k, config)


def render(
    frame: Frame, config: Config = DEFAULT, progress: Callable[[float], None] | None = None
) -> Pixels:
    """All pixels of `frame`, bit for bit as the RTL of `config` gives them.

    A `config` for one white light gets the lights of the frame (see `frame.fitted`). progress:
    called with the part done, 0 to 1, as the work goes on. Pixels of illegal spans are covered;
    pixels of spans that `config` leaves out (see `pruning.span_guard`) are not. Raises InputError
    if `config` cannot have the frame's lights.
    """
    config = with_lights(config, frame)
    total = pixel_count(frame.spans)
    x, y = np.empty(total, np.int64), np.empty(total, np.int64)
    rgb, last = np.empty((total, 3), np.int64), np.empty(total, bool)
    for block, pixels in walk(frame.spans, config):
        x[block], y[block], last[block] = pixels.x, pixels.y, pixels.last
        rgb[block] = colours(frame, pixels.span, pixels.k, config).T
        if progress:
            progress(block.stop / total)
    return Pixels(x, y, rgb, last)


def zero_normals(frame: Frame, config: Config = DEFAULT) -> int:
    """How many pixels of `frame` have the zero vector for a normal (that of the first light): the
    RTL flags each of them.

    0 where the hardware of `config` does not look for the zero vector: where it normalizes nothing,
    and where `constant_shift` makes `span_guard` flag such a span.
    """
    if config.technique != "phong" or config.normal_method == "none" or config.constant_shift:
        return 0
    return sum(
        int(zero(interpolate(frame.spans, pixels.span, pixels.k, config)[0]).sum())
        for _, pixels in walk(frame.spans, config)
    )
