"""Charts of the sweeps: error over time and over hardware, against true surfaces, artefacts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib
import matplotlib.ticker
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

#: RMS error of perfect rounding to codes.
PERFECT_RMS = 12**-0.5

_STYLE = {
    "svg.hashsalt": "phong75", "font.size": 8, "axes.grid": True, "grid.alpha": 0.3,
    "axes.titlesize": 9, "legend.fontsize": 7, "lines.markersize": 4,
}  # fmt: skip
_MARKERS = "osD^v<>PXp*hdH8"


def pareto(cost: Sequence[float], error: Sequence[float]) -> list[bool]:
    """Which points are not beaten: no other has at most their cost and at most their error, and
    less of one of them."""
    points = list(zip(cost, error, strict=True))
    return [
        not any(c <= cost and e <= error and (c, e) != (cost, error) for c, e in points)
        for cost, error in points
    ]


def wrong_share(row: dict) -> float:
    """The share of channel values that are not correctly rounded; never below what one would be,
    which is as far down as a logarithmic axis goes."""
    return max(1 - row["correctly_rounded"], 1 / (3 * row["pixels"]))


def _curves(axes: Axes, rows: list[dict], x: Callable, y: Callable, hollow: list[dict]) -> None:
    """One curve a method, and the Pareto front of all points; hollow markers for `hollow`."""
    for k, method in enumerate(dict.fromkeys(row["method"] for row in rows)):
        own = [row for row in rows if row["method"] == method]
        own.sort(key=y)
        default = method == "default"
        axes.plot(
            [x(row) for row in own], [y(row) for row in own],
            marker="*" if default else _MARKERS[k % len(_MARKERS)], linewidth=0.8,
            color="black" if default else matplotlib.colormaps["tab20"](k % 20),
            markersize=10 if default else None,
            zorder=5 if default else 2, label=method, alpha=0.9,
        )  # fmt: skip
    if hollow:
        axes.plot(
            [x(row) for row in hollow], [y(row) for row in hollow], marker=".", linestyle="none",
            color="white", markersize=4, markeredgewidth=0, zorder=6,
        )  # fmt: skip
    front = pareto([x(row) for row in rows], [y(row) for row in rows])
    ends = sorted((x(row), y(row)) for row, on in zip(rows, front, strict=True) if on)
    axes.step(*zip(*ends, strict=True), where="post", color="black", linewidth=2.5, alpha=0.25,
              marker="o", markersize=12, zorder=1, label="Pareto front")  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.minorticks_on()


def _plain(axes: Axes) -> None:
    """Whole numbers along a short logarithmic axis."""
    axes.xaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.tick_params(axis="x", which="both", labelsize=6, labelrotation=45)


def _figure(
    rows: list[dict], columns: list[tuple[str, Callable]], title: str, path: Path,
    hollow: list[dict] | None = None,
) -> None:  # fmt: skip
    """RMS error and share of wrong roundings (rows) over each of `columns`; `path`.png and .svg."""
    errors = (
        ("RMS error, LSB of 8 bits", lambda row: row["rms_lsb"]),
        ("share of values not correctly rounded", wrong_share),
    )
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(5.2 * len(columns) + 2.4, 8), layout="constrained")
        grid = figure.subplots(len(errors), len(columns), sharex="col", squeeze=False)
        for i, (error_name, error) in enumerate(errors):
            for k, (name, cost) in enumerate(columns):
                axes = grid[i][k]
                _curves(axes, rows, cost, error, hollow or [])
                _plain(axes)
                axes.set_ylabel(error_name)
                if i == len(errors) - 1:
                    axes.set_xlabel(name)
                if i == 0:
                    axes.axhline(PERFECT_RMS, color="gray", linewidth=0.8, linestyle=":")
                    axes.annotate(
                        "perfect rounding", (1, PERFECT_RMS), xytext=(-2, 2), ha="right",
                        textcoords="offset points", fontsize=6, color="gray",
                        xycoords=("axes fraction", "data"),
                    )  # fmt: skip
        handles, labels = grid[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper")
        figure.suptitle(title, fontsize=9)
        _save(figure, path)


def time_chart(rows: list[dict], path: Path) -> None:
    """Error over the time of all frames, and over that of one pixel through the pipeline.

    The title says where the clocks come from; where some are stated, those markers are hollow.
    """
    stated = [row for row in rows if row["clock_source"] == "stated"]
    if len(stated) == len(rows):
        clock = f"clock NOT measured: {rows[0]['clock_mhz']:g} MHz stated for all"
    elif stated:
        clock = (
            f"clock by place and route; {len(stated)} of {len(rows)}, the hollow markers, at the "
            f"stated {stated[0]['clock_mhz']:g} MHz"
        )
    else:
        clock = "each at its own clock by place and route"
    columns = [
        ("time of all frames, us", lambda row: row["frame_us"]),
        ("from a span to its first pixel, ns",
         lambda row: 1e3 * row["latency_cycles"] / row["clock_mhz"]),
    ]  # fmt: skip
    mixed = len(stated) < len(rows)
    _figure(rows, columns, f"Error against time; {clock}", path, stated if mixed else None)


def cost_chart(rows: list[dict], path: Path) -> None:
    """Error over multipliers and, if all rows have been synthesized, over logic."""
    columns = [("multipliers of at most 18 x 18 bits", lambda row: row["multipliers"])]
    if all(row["lut_sites"] is not None for row in rows):
        columns.append(("LUT sites (nextpnr)", lambda row: row["lut_sites"]))
    _figure(rows, columns, "Error against hardware (ECP5)", path)


def tessellation_chart(rows: list[dict], path: Path) -> None:
    """Error against the true surface, a column a shape: of the RTL's codes over cycles a frame,
    and of the techniques themselves over triangles; `path`.png and .svg."""
    shapes = list(dict.fromkeys(row["shape"] for row in rows))
    techniques = list(dict.fromkeys(row["technique"] for row in rows))
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(4 * len(shapes) + 1.5, 8), layout="constrained")
        grid = figure.subplots(2, len(shapes), squeeze=False, sharey="row")
        for column, shape in enumerate(shapes):
            above, below = grid[0][column], grid[1][column]
            for k, technique in enumerate(techniques):
                own = [r for r in rows if (r["shape"], r["technique"]) == (shape, technique)]
                look = dict(marker=_MARKERS[k], color=f"C{k}", linewidth=0.8, label=technique)
                if all(r["cycles"] for r in own):
                    above.plot([r["cycles"] for r in own], [r["rms_lsb"] for r in own], **look)
                triangles = [r["triangles"] for r in own]
                below.plot(triangles, [r["method_rms_lsb"] for r in own], **look)
                highlight = [r["highlight_rms_lsb"] for r in own]
                below.plot(triangles, highlight, **look | {"linestyle": ":", "label": None})
            above.axhline(PERFECT_RMS, color="gray", linewidth=0.8, linestyle=":")
            above.set_title(shape)
            above.set_yscale("log")
            above.set_xlabel("cycles a frame: a dot takes one, whatever the mesh")
            above.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(5))
            below.loglog()
            below.set_xlabel("triangles; dotted: in the highlight")
        grid[0][0].set_ylabel("RMS error of the RTL's codes, LSB (dotted: perfect rounding)")
        grid[1][0].set_ylabel("RMS error of the technique, LSB")
        handles, labels = grid[1][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper")
        figure.suptitle("Against the true surface, on the dots that mesh and surface cover")
        _save(figure, path)


def _save(figure: Figure, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(f"{path}.png", dpi=150, metadata={"Software": None})
    figure.savefig(f"{path}.svg", metadata={"Date": None})


def mach_chart(profiles: dict[str, tuple], path: Path) -> None:
    """Intensity along a scan line (codes), and its slope, by technique: {name: (x, 255 S)}."""
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(10, 7), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True)
        for k, (name, (x, value)) in enumerate(profiles.items()):
            look = dict(color="black" if name == "true" else f"C{k}", linewidth=0.9, label=name)
            above.plot(x, value, **look)
            below.plot(x[1:] - 0.5, np.diff(value), **look)
        above.set_ylabel("255 S, green")
        below.set_ylabel("change from dot to dot, LSB")
        below.set_ylim(-8, 8)
        below.set_xlabel("x along the middle scan line")
        above.legend()
        figure.suptitle("Mach bands arise where the slope jumps")
        _save(figure, path)


def flicker_chart(films: dict[str, np.ndarray], changes: dict[str, list], path: Path) -> None:
    """Maps of the largest change of each dot from picture to picture, {title: float64[h, w]}, and
    RMS change over the pictures, {title: LSB}."""
    with matplotlib.rc_context(_STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(2.2 * len(films), 5), layout="constrained")
        grid = figure.add_gridspec(2, len(films), height_ratios=(3, 2))
        top = max(float(np.nanmax(film)) for film in films.values())
        for k, (title, film) in enumerate(films.items()):
            axes = figure.add_subplot(grid[0, k])
            shown = axes.imshow(film, cmap="inferno", vmin=0, vmax=min(top, 10))
            axes.set_title(title)
            axes.axis("off")
        figure.colorbar(shown, ax=figure.axes, label="largest change in a degree, LSB", shrink=0.6)
        axes = figure.add_subplot(grid[1, :])
        for k, (title, change) in enumerate(changes.items()):
            axes.plot(range(1, len(change) + 1), change, color=f"C{k}", label=title)
        axes.set_xlabel("degree")
        axes.set_ylabel("RMS change, LSB")
        axes.set_yscale("log")
        axes.grid(True, alpha=0.3)
        axes.legend()
        figure.suptitle("A surface that turns into itself: all change is the mesh's")
        _save(figure, path)


def orientation_chart(pictures: dict[str, np.ndarray], path: Path) -> None:
    """The square in several orientations: {title: float64[h, w], 0 to 255, NaN outside}."""
    with matplotlib.rc_context(_STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(3 * len(pictures) / 2, 6.4), layout="constrained")
        for axes, (title, picture) in zip(
            figure.subplots(2, len(pictures) // 2).flat, pictures.items(), strict=True
        ):
            axes.set_facecolor("steelblue")
            axes.imshow(picture, cmap="gray", vmin=0, vmax=255)
            axes.set_title(title)
            axes.set_xticks([])
            axes.set_yticks([])
        figure.suptitle("One corner black, three white: as one polygon, and as two triangles")
        _save(figure, path)
