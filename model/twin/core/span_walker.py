"""Twin of rtl/span_walker.v: spans become pixels, left to right."""

from __future__ import annotations

import numpy as np

from phong75.model.config import Config


def span_walker(spans, first: int, stop: int, config: Config):
    """Pixels `first` to `stop` (exclusive) of the stream that `spans` (SPAN_DTYPE[n]) make.

    Returns the index of each pixel's span, its place k in the span, its x (wrapped to the
    counter), y, and whether it is the last of the frame. A length of 0 is walked as 1 pixel.
    """
    length = np.maximum(spans["length"], 1).astype(np.int64)
    end = np.cumsum(length)
    pixel = np.arange(first, min(stop, int(end[-1]) if len(end) else 0))
    span = np.searchsorted(end, pixel, side="right")
    k = pixel - (end - length)[span]
    x = (spans["x"][span] + k) & (config.max_size - 1)
    last = spans["last"][span] & (k == length[span] - 1)
    return span, k, x, spans["y"][span].astype(np.int64), last
