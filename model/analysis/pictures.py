"""Pictures of a frame: its pixels, the reference, and where the error is.

The same pixels always give the same bytes: no dates and no program names go into the files.
"""

from __future__ import annotations

import numpy as np
from PIL import Image

from phong75.model.frame import Frame

_DPI = 100
_MARGIN = (70, 90, 55, 45)  # left, right, bottom, top of the error map, in dots
_SMALL = 400  # error maps of smaller frames are enlarged to about this many dots
_ROOM = 240  # of the title and of the scale, in dots


def canvas(frame: Frame, x, y, rgb) -> np.ndarray:
    """The picture uint8[height, width, 3] of pixels at `x`, `y` (int[n]) with codes `rgb` [n, 3].

    Dots without a pixel show the background, of two pixels at one dot the later one wins, and
    pixels outside the frame (which only a broken stream has) are left out.
    """
    picture = np.empty((frame.height, frame.width, 3), np.uint8)
    picture[:] = frame.background
    return _place(picture, x, y, rgb)


def write_picture(path, picture) -> None:
    """Write `picture` (uint8[height, width, 3]) as PNG. Raises OSError."""
    Image.fromarray(picture).save(path, format="PNG")


def write_error_map(path, frame: Frame, x, y, error, bound: float | None) -> None:
    """Write a heat map (PNG) of `error` (float64[n, 3], in LSB) at `x`, `y` (int[n]).

    A dot shows the largest error of its three channels; dots without a span are grey. The scale
    starts at 0 and ends at 1 LSB, or at the largest error if that is more, so that the maps of
    good runs can be laid side by side; a mark on it shows `bound`, if there is one. Raises OSError.
    """
    # Slow to import, and only this picture needs it. The Figure is made without pyplot, so that
    # no window system and no global state are involved.
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    worst = np.asarray(error, np.float64).max(axis=1, initial=0)
    dots = _place(np.full((frame.height, frame.width), np.nan), x, y, worst)
    top = max(1.0, float(worst.max(initial=0)))

    # One dot of the frame is one dot of the map, or a square of them, so that none gets lost.
    zoom = max(1, -(-_SMALL // max(frame.width, frame.height)))
    wide, high = frame.width * zoom, frame.height * zoom
    left, right, bottom, above = _MARGIN
    full = np.array([left + max(wide, _ROOM) + right, above + max(high, _ROOM) + bottom])
    figure = Figure(figsize=full / _DPI, dpi=_DPI)
    FigureCanvasAgg(figure)

    def box(x, w, h):
        return figure.add_axes((x / full[0], 1 - (above + h) / full[1], w / full[0], h / full[1]))

    axes = box(left, wide, high)
    axes.set_facecolor("0.6")
    image = axes.imshow(dots, cmap="inferno", vmin=0, vmax=top, interpolation="nearest")
    axes.set_title("|code − 255 S|, grey: no span", fontsize=9, loc="left")
    axes.set_xlabel("x")
    axes.set_ylabel("y")
    bar = figure.colorbar(image, cax=box(left + wide + 15, 18, max(high, _ROOM)), label="LSB")
    if bound is not None and bound <= top:
        bar.ax.axhline(bound, color="cyan", linewidth=2)
        bar.ax.set_title("line:\nbound", fontsize=7, color="teal")
    figure.savefig(path, format="png", metadata={"Software": None})


def _place(picture, x, y, values):
    """Set the dots of `picture` at `x`, `y` to `values`; what lies outside is left out."""
    x, y = np.asarray(x), np.asarray(y)
    inside = (x >= 0) & (x < picture.shape[1]) & (y >= 0) & (y < picture.shape[0])
    picture[y[inside], x[inside]] = np.asarray(values)[inside]
    return picture
