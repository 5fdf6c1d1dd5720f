# SPDX-License-Identifier: MIT
"""Twin of rtl/core/span_walker.v: spans become pixels, from left to right."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from phong75.model.arrays import Flags, Ints, Spans
from phong75.model.config import Config
from phong75.model.frame import walked

#: Pixels that the twin works on at a time: the temporaries of one block fit the cache.
BLOCK = 1 << 14


class WalkedPixels(NamedTuple):
    """Consecutive pixels of a stream of spans, one entry a pixel.

    span: int64[n], index of the pixel's span, rising. k: int64[n], number of the pixel in its span,
    from 0. x, y: int64[n], place on the screen. last: bool[n], the last pixel of the frame.
    """

    span: Ints
    k: Ints
    x: Ints
    y: Ints
    last: Flags


def column(x: Ints, k: Ints, config: Config) -> Ints:
    """The column of pixel `k` of spans that begin at `x`, int64[n] each: it wraps as the counter of
    `coordinate_bits` does."""
    return (x + k) & (config.max_size - 1)


def span_walker(spans: Spans, first: int, stop: int, config: Config) -> WalkedPixels:
    """Pixels `first` to `stop` (exclusive) of the stream that `spans` (SPAN_DTYPE[n]) make.

    A span of length 0 is walked as 1 pixel.
    """
    length = walked(spans)
    end = np.cumsum(length)
    pixel = np.arange(first, min(stop, int(end[-1]) if len(end) else 0))
    span = np.searchsorted(end, pixel, side="right")
    k = pixel - (end - length)[span]
    x = column(spans["x"][span], k, config)
    last = spans["last"][span] & (k == length[span] - 1)
    return WalkedPixels(span, k, x, spans["y"][span].astype(np.int64), last)


def pixel_count(spans: Spans) -> int:
    """How many pixels `spans` (SPAN_DTYPE[n]) make."""
    return int(walked(spans).sum())


def walk(spans: Spans, config: Config) -> Iterator[tuple[slice, WalkedPixels]]:
    """Yield all pixels of `spans` in blocks of BLOCK: their place in the stream, and the pixels."""
    total = pixel_count(spans)
    for first in range(0, total, BLOCK):
        block = slice(first, min(first + BLOCK, total))
        yield block, span_walker(spans, first, block.stop, config)
