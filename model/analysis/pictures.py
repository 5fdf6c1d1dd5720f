# SPDX-License-Identifier: MIT
"""Pictures of a frame: its pixels, the float64 reference, and the map of the error.

The same pixels always give the same bytes: the files hold no date and no program name.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from phong75.model.arrays import Flags, Reals
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame
from phong75.model.twin import Pixels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.colorbar import Colorbar
    from matplotlib.colors import Colormap

#: What a pixel of a picture is: codes or reals.
Shown = TypeVar("Shown", np.uint8, np.uint16, np.float64)

#: Largest error of perfect rounding to codes.
PERFECT_LSB = 0.5
#: Differences below this are rounding of the float64 reference, not of the hardware.
_NOISE_LSB = 1e-9
#: Lower end of the logarithmic scale of |error| - 1/2, in 1/1000 LSB.
_LEAST_MILLI = 0.1

# Layout of the error map in pixels, for frames of up to _NOMINAL pixels; larger frames scale it.
_DPI = 100
_NOMINAL = 640
_PANEL = 400  # least side of a panel; smaller frames are enlarged to about this many pixels
_LEFT, _GAP, _BAR, _RIGHT = 58, 10, 14, 72  # y axis; gap, colour bar, labels of the bar
_HEAD, _TITLE, _BOTTOM = 52, 30, 80  # title of the picture, of a panel; x axis and key below it

BACKGROUND = "white"  # no span
WITHIN_HALF = "#d3d7dc"  # at most 1/2 LSB
_ABOVE = "#e8590c"  # more than 1/2 LSB, in the map of |error|
_BROKEN = "#0057d8"  # more than the derived bound


def canvas(
    frame: Frame, x: ArrayLike, y: ArrayLike, rgb: ArrayLike, config: Config = DEFAULT
) -> NDArray[np.uint8 | np.uint16]:
    """The picture of the pixels at `x`, `y` (int[n]) with codes `rgb` (int[n, 3]).

    Returns uint8[height, width, 3], or uint16 if `config.colour_bits` is more than 8. Positions
    without a pixel show the frame's background. Of two pixels at one position the later one is
    shown. Pixels outside the frame, which only a faulty stream has, are left out.
    """
    codes = np.uint8 if config.colour_bits <= 8 else np.uint16
    picture = np.empty((frame.height, frame.width, 3), codes)
    picture[:] = frame.background
    return _place(picture, x, y, rgb)


def picture(frame: Frame, pixels: Pixels, config: Config = DEFAULT) -> Image.Image:
    """The picture of `pixels` of `frame` as a PIL image (RGB), which a notebook shows as it is.

    pixels: of `render`, or of a simulation. Codes of other than 8 bits are brought to 8.
    """
    codes = canvas(frame, pixels.x, pixels.y, pixels.rgb, config)
    if config.colour_bits != 8:
        codes = (codes * (255 / config.white) + 0.5).astype(np.uint8)
    return Image.fromarray(codes)


def write_picture(
    path: str | Path, picture: NDArray[np.uint8 | np.uint16], config: Config = DEFAULT
) -> None:
    """Write `picture`, codes[height, width, 3] of `config.colour_bits`, as PNG. Raises OSError.

    A PNG has 8 or 16 bits. Other codes are scaled to the next of the two, and the file says how
    many bits count (its chunk sBIT), so that a reader gets the codes back.
    """
    bits = config.colour_bits
    if bits == 8:
        Image.fromarray(picture).save(path, format="PNG")
        return
    import png  # only for these; Pillow writes no colours of 16 bits

    height, width, channels = picture.shape
    writer = png.Writer(width, height, greyscale=False, bitdepth=bits)
    with open(path, "wb") as file:
        writer.write(file, picture.reshape(height, width * channels))


def excess(error: ArrayLike) -> Reals:
    """How far each pixel is above the 1/2 LSB of perfect rounding, float64[n], in LSB.

    error: float64[n, 3], |code - 255 S| in LSB. A pixel counts by its worst channel; 0 or less
    means perfect rounding.
    """
    beyond = np.asarray(error, np.float64).max(axis=1, initial=0) - PERFECT_LSB
    return np.where(np.abs(beyond) < _NOISE_LSB, 0, beyond)


def write_error_map(
    path: str | Path, frame: Frame, x: ArrayLike, y: ArrayLike, error: ArrayLike,
    bound: float | None, *, name: str = "",
) -> None:  # fmt: skip
    """Write a PNG with two maps of `error` (float64[n, 3], LSB) at `x`, `y` (int[n]).

    The first map shows |error| from 0 to the 1/2 LSB of perfect rounding; pixels above 1/2 have a
    colour of their own. The second map shows only what exceeds perfect rounding, |error| - 1/2, on
    a logarithmic scale from 0.1/1000 LSB to `bound` - 1/2. Pixels above `bound` (LSB) have a colour
    of their own; if there are any, the first map's scale reaches to the largest error. A pixel
    shows the worst of its three channels. Pixels without a span are white.

    Pixels above 1/2 are few, so the second map draws them enlarged; where they overlap, the larger
    error is shown. bound: None if no bound is derived; both scales then reach to the largest error.
    name: scene and technique, for the title. Raises OSError.
    """
    # matplotlib takes long to import, and only this picture uses it.
    from matplotlib.colors import LogNorm

    beyond = excess(error)
    worst = float(beyond.max(initial=-PERFECT_LSB)) + PERFECT_LSB
    limit = np.inf if bound is None else bound - PERFECT_LSB
    above, broken = int((beyond > 0).sum()), int((beyond > limit).sum())
    to_worst = broken > 0 or (bound is None and worst > PERFECT_LSB)
    sheet = _Sheet(frame.width, frame.height)

    shape = (frame.height, frame.width)
    magnitude = _place(np.full(shape, np.nan), x, y, beyond + PERFECT_LSB)
    key = [(BACKGROUND, "no span")]
    if not to_worst:
        key.append((_ABOVE, "more than ½ LSB"))
    sheet.draw(
        0, magnitude, "|error| = |code − 255 S|, worst of three channels", key,
        cmap=colours("viridis", over=None if to_worst else _ABOVE),
        vmin=0, vmax=worst if to_worst else PERFECT_LSB,
    ).set_label("LSB", fontsize=9)  # fmt: skip

    side = 1 + 2 * round(2 * max(1, max(shape) / _NOMINAL)) if max(shape) >= _PANEL else 1
    milli = 1000 * _grow(_place(np.full(shape, -np.inf), x, y, beyond), side)
    top = max(1000 * (worst - PERFECT_LSB if bound is None else limit), 10 * _LEAST_MILLI)
    # The value beyond the scale stands for all errors above the bound.
    shown = np.where(milli > 1000 * limit, 2 * top, np.maximum(milli, _LEAST_MILLI))
    key = [(BACKGROUND, "no span"), (WITHIN_HALF, "at most ½ LSB")]
    if bound is not None:
        key.append((_BROKEN, f"more than the bound; pixels: {_count(broken)}"))
    enlarged = f", each drawn {side} × {side}" if side > 1 else ""
    bar = sheet.draw(
        1, np.where(milli > 0, shown, np.nan),
        "|error| − ½ LSB, what exceeds perfect rounding; "
        f"pixels: {_count(above)}{enlarged}", key,
        cmap=colours("YlOrRd", start=0.4, over=None if bound is None else _BROKEN),
        norm=LogNorm(_LEAST_MILLI, top), behind=~np.isnan(magnitude),
    )  # fmt: skip
    decades = [10.0**k for k in range(6) if 10.0**k < top / 1.8]
    labels = [f"≤ {_LEAST_MILLI}", *(f"{d:g}" for d in decades), f"{top:.3g}"]
    bar.set_ticks([_LEAST_MILLI, *decades, top], labels=labels)
    bar.ax.minorticks_off()
    end = "the largest error" if bound is None else "bound"
    bar.set_label(f"1/1000 LSB, up to {end} − ½", fontsize=9)

    size = f"{frame.width} × {frame.height}"
    parts = [name, size, f"{_count(len(beyond))} pixels shaded"]
    derived = "no bound derived" if bound is None else f"derived bound {bound:.4f} LSB"
    sheet.write(
        ", ".join(part for part in parts if part),
        f"largest error {worst:.4f} LSB, {derived}; "
        f"pixels above the ½ LSB of perfect rounding: {_count(above)}",
    )
    sheet.figure.savefig(path, format="png", metadata={"Software": None})


class _Sheet:
    """Two maps of a frame of `width` by `height` pixels, and their places on one picture."""

    def __init__(self, width: int, height: int):
        # The Figure is made without pyplot: no window system and no global state are involved.
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self._scale = max(1.0, max(width, height) / _NOMINAL)
        # A pixel of the frame is one pixel of the map, or a square of pixels, so that none is lost.
        zoom = max(1, -(-_PANEL // max(width, height)))
        self._map = np.array([width, height]) * zoom
        self._panel = np.maximum(self._map, _PANEL)
        margins = [_LEFT + _GAP + _BAR + _RIGHT, _TITLE + _BOTTOM]
        self._cell = self._panel + self._scale * np.array(margins)
        # Wide frames are stacked, others stand side by side.
        self._columns = 1 if width > 1.5 * height else 2
        grid = self._columns, 2 // self._columns
        self._full = np.ceil(self._cell * grid + [0, self._scale * _HEAD])
        dpi = _DPI * self._scale
        self.figure = Figure(figsize=self._full / dpi, dpi=dpi, facecolor="white")
        FigureCanvasAgg(self.figure)

    def draw(
        self, index: int, picture: Reals, title: str, key: list[tuple[str, str]], *,
        cmap: Colormap, behind: Flags | None = None, **scale: Any,
    ) -> Colorbar:  # fmt: skip
        """Draw map `index` (0 or 1) with its title, its colour bar and its key below it.

        picture: float64[height, width], NaN where nothing is drawn. key: (colour, text) pairs.
        behind: bool[height, width], pixels that are grey under `picture`. scale: vmin and vmax, or
        norm. Returns the colour bar.
        """
        from matplotlib.colors import ListedColormap
        from matplotlib.patches import Patch
        from matplotlib.ticker import MaxNLocator

        (width, height), unit = self._map, self._scale
        left = self._cell[0] * (index % self._columns) + unit * _LEFT
        top = self._cell[1] * (index // self._columns) + unit * (_HEAD + _TITLE)
        axes = self._axes(left, top, width, height)
        axes.set_facecolor(BACKGROUND)
        if behind is not None:
            grey = ListedColormap([WITHIN_HALF])
            axes.imshow(np.where(behind, 0.0, np.nan), cmap=grey, interpolation="nearest")
        image = axes.imshow(picture, cmap=cmap, interpolation="nearest", **scale)
        axes.set_title(title, fontsize=10, loc="left")
        axes.set_xlabel("x, pixels", fontsize=9, labelpad=2)
        axes.set_ylabel("y, pixels", fontsize=9, labelpad=2)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_locator(MaxNLocator(7, steps=[1, 2, 5, 10], integer=True))
        axes.tick_params(labelsize=8)

        box = self._axes(left + width + unit * _GAP, top, unit * _BAR, self._panel[1])
        bar = self.figure.colorbar(image, cax=box)  # its end shows the map's colour for `over`
        bar.ax.tick_params(labelsize=8)
        patches = [
            Patch(facecolor=colour, edgecolor="0.4", linewidth=0.5, label=text)
            for colour, text in key
        ]
        below = top + self._panel[1] + unit * 47
        self.figure.legend(
            handles=patches, fontsize=9, frameon=False, ncols=3, borderpad=0, borderaxespad=0,
            handlelength=1.2, columnspacing=1.2, loc="upper left",
            bbox_to_anchor=(left / self._full[0], 1 - below / self._full[1]),
        )  # fmt: skip
        return bar

    def write(self, *lines: str) -> None:
        """Write `lines` above the maps."""
        left, top = self._scale * np.array([_LEFT, 10]) / self._full
        self.figure.text(left, 1 - top, "\n".join(lines), fontsize=11, va="top", linespacing=1.35)

    def _axes(self, x: float, y: float, width: float, height: float) -> Axes:
        """Axes at `x`, `y` from the upper left corner, all in pixels."""
        box = np.array([x, self._full[1] - y - height, width, height])
        return self.figure.add_axes(tuple(box / np.tile(self._full, 2)))


def colours(name: str, start: float = 0.0, over: str | None = None) -> Colormap:
    """The colour map `name` of matplotlib from `start` (0 to 1) on.

    over: the colour of values beyond the scale, which the colour bar then shows at its end.
    """
    import matplotlib
    from matplotlib.colors import ListedColormap

    shades = ListedColormap(matplotlib.colormaps[name](np.linspace(start, 1, 256)))
    cmap = shades.with_extremes(over=over)
    cmap.colorbar_extend = "max" if over else "neither"  # type: ignore[assignment]
    return cmap


def _count(number: int) -> str:
    return f"{number:,}".replace(",", "\N{NO-BREAK SPACE}")


def _grow(picture: Reals, side: int) -> Reals:
    """`picture` with the largest value of the square of `side` (odd) pixels around each pixel."""
    reach = side // 2
    for axis in (0, 1):
        padded = np.pad(
            picture, [(reach, reach) if k == axis else (0, 0) for k in (0, 1)],
            constant_values=-np.inf,
        )  # fmt: skip
        windows = np.lib.stride_tricks.sliding_window_view(padded, side, axis=axis)
        picture = windows.max(axis=-1)
    return picture


def _place(
    picture: NDArray[Shown], x: ArrayLike, y: ArrayLike, values: ArrayLike
) -> NDArray[Shown]:
    """Set the pixels of `picture` at `x`, `y` to `values`; positions outside are left out."""
    x, y = np.asarray(x), np.asarray(y)
    inside = (x >= 0) & (x < picture.shape[1]) & (y >= 0) & (y < picture.shape[0])
    picture[y[inside], x[inside]] = np.asarray(values)[inside]
    return picture
