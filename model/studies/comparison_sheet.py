# SPDX-License-Identifier: MIT
"""The sheet of `phong75 compare`: what several shadings make of one scene, side by side.

A column is a shading: its picture, its difference from what all are compared with, and an enlarged
detail of both. The last column shows what they are compared with, and the scale of the differences.
The same pixels always give the same bytes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from phong75.model.analysis.pictures import BACKGROUND, PERFECT_LSB, WITHIN_HALF, colours
from phong75.model.arrays import Flags, Reals

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Layout in pixels. Text and margins grow with the panels.
_DPI = 100
_PANEL = 320  # width of a panel that needs no scaling; smaller frames are enlarged to about this
_MOST = 640  # largest width of a panel; larger frames are reduced
_LEFT, _GAP, _RIGHT = 26, 8, 8  # names of the rows; between panels; right margin
_HEAD, _TITLE, _LINE = 34, 22, 15  # heading of the sheet; title of a column; a line of text
_BAR, _LOWEST = 14, 120  # height of the scale; least height of a row
_FONT = 8.0  # points

#: An enlarged detail shows this part of the width and of the height.
_DETAIL = 5
_ROWS = ("picture, RTL", "difference", "enlarged", "difference, enlarged")
_APART = "#0057d8"  # pixels that are shaded but not compared


class Box(NamedTuple):
    """A rectangle of a picture: its left upper pixel, its width and its height, in pixels."""

    x: int
    y: int
    width: int
    height: int

    def of(self, picture: NDArray[Any]) -> NDArray[Any]:
        """The part of `picture` (array[height, width, ...]) inside."""
        return picture[self.y : self.y + self.height, self.x : self.x + self.width]


@dataclass(frozen=True)
class Column:
    """A shading on the sheet.

    picture: uint8[height, width, 3]. difference: float64[height, width], LSB, the worst channel of
    each pixel; NaN where nothing is compared. lines: text below.
    """

    title: str
    picture: NDArray[np.uint8]
    difference: Reals
    lines: Sequence[str]


@dataclass(frozen=True)
class Basis:
    """What all columns are compared with.

    title: its name. picture: uint8[height, width, 3]; None if it is one of the columns. shaded:
    bool[height, width], where the columns have pixels. lines: text below.
    """

    title: str
    picture: NDArray[np.uint8] | None
    shaded: Flags
    lines: Sequence[str]


def where_they_differ(pictures: Sequence[NDArray[np.uint8]]) -> Box:
    """The detail, a fifth of the width and of the height, in which `pictures` differ most.

    pictures: uint8[height, width, 3] each. What counts is the sum of the squares of the largest
    difference of two pictures at each pixel. Equal pictures give the detail in their middle.
    """
    square = np.ptp(np.stack(pictures).astype(np.int64), axis=0).max(axis=-1) ** 2
    height, width = square.shape
    box = Box(0, 0, max(1, width // _DETAIL), max(1, height // _DETAIL))
    total = np.zeros((height + 1, width + 1), np.int64)
    total[1:, 1:] = square.cumsum(axis=0).cumsum(axis=1)
    above, left = height + 1 - box.height, width + 1 - box.width
    inside = (
        total[box.height :, box.width :] - total[:above, box.width :]
        - total[box.height :, :left] + total[:above, :left]
    )  # fmt: skip
    if not inside.any():
        return box._replace(x=left // 2, y=above // 2)
    y, x = divmod(int(np.argmax(inside)), left)
    return box._replace(x=x, y=y)


def write_sheet(path: str | Path, heading: str, columns: Sequence[Column], basis: Basis) -> Box:
    """Write a PNG that shows `columns`, then `basis`; returns the detail that is enlarged.

    heading: lines above. All differences have one logarithmic scale, from the 1/2 LSB of perfect
    rounding to the largest difference. Raises OSError.
    """
    # matplotlib takes long to import, and only pictures use it.
    from matplotlib.colors import LogNorm, to_rgb

    detail = where_they_differ([column.picture for column in columns])
    most = max(float(np.nanmax(column.difference, initial=0.0)) for column in columns)
    norm = LogNorm(PERFECT_LSB, max(most, 4 * PERFECT_LSB))
    shades = colours("YlOrRd", start=0.15)

    def shown(difference: Reals) -> NDArray[np.uint8]:
        """The colours of a map of differences, uint8[height, width, 3]."""
        rgb = shades(norm(np.nan_to_num(difference, nan=PERFECT_LSB)))[..., :3]
        rgb[difference <= PERFECT_LSB] = to_rgb(WITHIN_HALF)
        rgb[np.isnan(difference)] = to_rgb(_APART)
        rgb[~basis.shaded] = to_rgb(BACKGROUND)
        return (255 * rgb + 0.5).astype(np.uint8)

    lines = max(len(basis.lines), *(len(column.lines) for column in columns))
    height, width = basis.shaded.shape
    sheet = _Grid(width, height, len(columns) + 1, lines)
    sheet.write(heading)
    for k, column in enumerate(columns):
        sheet.caption(k, column.title, column.lines)
        for row, picture in ((0, column.picture), (1, shown(column.difference))):
            sheet.whole(row, k, picture, detail)
            sheet.enlarged(row + 2, k, picture, detail)
    last = len(columns)
    sheet.caption(last, basis.title, basis.lines)
    if basis.picture is not None:
        sheet.whole(0, last, basis.picture, detail)
        sheet.enlarged(2, last, basis.picture, detail)
    key = [(BACKGROUND, "no surface"), (WITHIN_HALF, "at most ½ LSB, as perfect rounding")]
    if any((np.isnan(column.difference) & basis.shaded).any() for column in columns):
        key.append((_APART, "not compared"))
    sheet.scale(last, norm, shades, key)
    sheet.save(path)
    return detail


class _Grid:
    """A sheet of four rows of panels, and the places on it.

    width, height: of a frame, in pixels. columns: how many. lines: of text below each column.
    """

    def __init__(self, width: int, height: int, columns: int, lines: int):
        # The Figure is made without pyplot: no window system and no global state are involved.
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        # A pixel of the frame is a square of pixels; of large frames, a square of the frame is one.
        self._zoom = max(1, -(-_PANEL // max(width, height)))
        self._reduced = max(1, -(-width // _MOST))
        size = np.array([width, height]) * self._zoom // self._reduced
        self._panel = np.maximum(size, 1)
        self._unit = max(1.0, float(self._panel[0]) / _PANEL)
        # However narrow or low a frame is, the texts beside its panel have room.
        cell = np.maximum(self._panel, self._unit * np.array([_PANEL, _LOWEST]))
        self._step = np.ceil(cell + self._unit * _GAP)
        above = self._unit * (_HEAD + _TITLE)
        below = self._unit * (lines * _LINE + _GAP)
        self._origin = np.ceil(np.array([self._unit * _LEFT, above]))
        self._full = np.ceil(
            self._origin + self._step * [columns, len(_ROWS)] + [self._unit * _RIGHT, below]
        )
        self._figure = Figure(figsize=self._full / _DPI, dpi=_DPI, facecolor="white")
        self._canvas = FigureCanvasAgg(self._figure)
        for row, name in enumerate(_ROWS):
            x, y = self._origin + self._step * [0, row + 0.5]
            self._text(x - self._unit * _GAP, y, name, rotation=90, va="center", ha="right")

    def write(self, heading: str) -> None:
        """Write lines above all columns, and how much whole pictures are reduced."""
        if self._reduced > 1:
            heading += f"; whole pictures reduced {self._reduced} ×"
        self._text(
            self._origin[0], self._unit * _GAP, heading, size=1.15, va="top", linespacing=1.4
        )

    def caption(self, column: int, title: str, lines: Sequence[str]) -> None:
        """Write the title of a column above it, and `lines` below it."""
        x, y = self._origin + self._step * [column, 0]
        self._text(x, y - self._unit * 5, title, size=1.15, weight="bold")
        bottom = self._origin[1] + len(_ROWS) * self._step[1]
        self._text(x, bottom, "\n".join(lines), va="top", linespacing=1.45)

    def whole(self, row: int, column: int, picture: NDArray[np.uint8], detail: Box) -> None:
        """Show a picture, and where its detail is. Reduced pictures are means of squares."""
        from matplotlib.patches import Rectangle

        if self._reduced > 1:
            image = Image.fromarray(picture).reduce(self._reduced)
            picture = np.asarray(image)
        axes = self._axes(row, column)
        axes.imshow(picture, interpolation="nearest", aspect="auto")
        x, y, width, height = (side / self._reduced for side in detail)
        for colour, line in (("black", 3.0), ("white", 1.2)):
            axes.add_patch(
                Rectangle(
                    (x - 0.5, y - 0.5), width, height, fill=False, edgecolor=colour,
                    linewidth=line * self._unit * 72 / _DPI,
                )
            )  # fmt: skip

    def enlarged(self, row: int, column: int, picture: NDArray[np.uint8], detail: Box) -> None:
        """Show the detail of a picture, in which each pixel is a square."""
        self._axes(row, column).imshow(detail.of(picture), interpolation="nearest", aspect="auto")

    def scale(self, column: int, norm: Any, shades: Any, key: Sequence[tuple[str, str]]) -> None:
        """Show the scale of the differences and the `key` of other colours, in the second row."""
        from matplotlib.cm import ScalarMappable
        from matplotlib.patches import Patch

        left, top = self._origin + self._step * [column, 1]
        width, unit = self._step[0] - self._unit * _GAP, self._unit
        box = self._rectangle(left + 4 * unit, top + 18 * unit, width - 18 * unit, unit * _BAR)
        bar = self._figure.colorbar(ScalarMappable(norm, shades), cax=box, orientation="horizontal")
        ticks = [t for d in (0.1, 1, 10, 100) for t in (d, 2 * d, 5 * d)]
        ticks = [t for t in ticks if norm.vmin <= t <= norm.vmax]
        bar.set_ticks(ticks, labels=[f"{t:g}" for t in ticks])
        bar.ax.minorticks_off()
        bar.ax.tick_params(labelsize=_FONT * unit)
        self._text(left, top + 12 * unit, "difference, worst channel, LSB")
        patches = [
            Patch(facecolor=colour, edgecolor="0.4", linewidth=0.5, label=text)
            for colour, text in key
        ]
        below = top + unit * (18 + _BAR + 24)
        self._figure.legend(
            handles=patches, fontsize=_FONT * unit, frameon=False, borderpad=0, borderaxespad=0,
            handlelength=1.2, loc="upper left",
            bbox_to_anchor=(left / self._full[0], 1 - below / self._full[1]),
        )  # fmt: skip

    def save(self, path: str | Path) -> None:
        """Write the sheet as PNG, without date and program. Raises OSError."""
        self._canvas.draw()
        rgb = np.asarray(self._canvas.buffer_rgba())[..., :3]
        Image.fromarray(rgb).save(path, format="PNG", optimize=True)

    def _axes(self, row: int, column: int) -> Axes:
        left, top = self._origin + self._step * [column, row]
        axes = self._rectangle(left, top, *self._panel)
        axes.set_xticks([])
        axes.set_yticks([])
        for spine in axes.spines.values():
            spine.set_visible(False)
        return axes

    def _rectangle(self, x: float, y: float, width: float, height: float) -> Axes:
        """Axes at `x`, `y` from the upper left corner, all in pixels."""
        box = np.array([x, self._full[1] - y - height, width, height])
        return self._figure.add_axes(tuple(box / np.tile(self._full, 2)))

    def _text(self, x: float, y: float, text: str, size: float = 1.0, **look: Any) -> None:
        """Write `text` at `x`, `y` from the upper left corner, in pixels."""
        self._figure.text(
            x / self._full[0], 1 - y / self._full[1], text, fontsize=_FONT * self._unit * size,
            **look,
        )  # fmt: skip
