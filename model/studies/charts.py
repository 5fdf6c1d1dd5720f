# SPDX-License-Identifier: MIT
"""Charts of the studies: error over run time and hardware, error against true surfaces, artefacts.

Each chart is written as PNG and as SVG. The same numbers give the same files.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.ticker
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from phong75.model.studies import methods, pareto, tessellation
from phong75.model.studies.tessellation import SIZE

#: Colours that remain distinct with colour blindness (Okabe and Ito, 2008).
_CURVES = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")

_STYLE: dict[Any, Any] = {
    "svg.hashsalt": "phong75", "font.size": 8, "axes.grid": True, "grid.alpha": 0.3,
    "axes.titlesize": 9, "legend.fontsize": 7, "lines.markersize": 4,
}  # fmt: skip
_MARKERS = "osD^v<>PXp*hdH8"


def wrong_share(row: dict) -> float:
    """The share of channel values that are not correctly rounded, for a logarithmic axis.

    `row` counts pixels of three channels each. No wrong value at all counts as one.
    """
    return max(1 - row["correctly_rounded"], 1 / (3 * row["pixels"]))


def _curves(axes: Axes, rows: list[dict], x: Callable, y: Callable, hollow: list[dict]) -> None:
    """Draw a curve for each method and the Pareto front of all `rows`.

    x, y: functions from a row to its coordinates. hollow: the rows whose markers are hollow.
    """
    for k, method in enumerate(dict.fromkeys(row["method"] for row in rows)):
        curve = [row for row in rows if row["method"] == method]
        curve.sort(key=y)
        default = method == "default"
        axes.plot(
            [x(row) for row in curve], [y(row) for row in curve],
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
    front = pareto.front([(x(row), y(row)) for row in rows])
    axes.step(*zip(*front, strict=True), where="post", color="black", linewidth=2.5, alpha=0.25,
              marker="o", markersize=12, zorder=1, label="Pareto front")  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.minorticks_on()


def _colour(k: int) -> str:
    """The colour of curve `k`."""
    return _CURVES[k % len(_CURVES)]


def _plain(axes: Axes) -> None:
    """Label a short logarithmic axis with plain numbers."""
    axes.xaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.tick_params(axis="x", which="both", labelsize=6, labelrotation=45)


def _figure(
    rows: list[dict], columns: list[tuple[str, Callable]], title: str, path: Path,
    hollow: list[dict] | None = None,
) -> None:  # fmt: skip
    """Chart the RMS error and the share of wrong roundings over each of `columns`.

    columns: (title of the axis, function from a row to its cost) pairs, a column of panels each.
    hollow: the rows whose markers are hollow. Writes `path`.png and .svg.
    """
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
                    perfect = methods.perfect()["rms_lsb"]
                    axes.axhline(perfect, color="gray", linewidth=0.8, linestyle=":")
                    axes.annotate(
                        "perfect rounding", (1, perfect), xytext=(-2, 2), ha="right",
                        textcoords="offset points", fontsize=6, color="gray",
                        xycoords=("axes fraction", "data"),
                    )  # fmt: skip
        handles, labels = grid[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper")
        figure.suptitle(title, fontsize=9)
        _save(figure, path)


def time_chart(rows: list[dict], path: Path) -> None:
    """Chart the error over the time of all frames, and over the latency of one span.

    The title says where the clocks come from. If only some clocks are measured, the markers of
    those that are stated are hollow. Writes `path`.png and .svg.
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
    """Chart the error over multipliers and, if all rows have been synthesized, over logic.

    Writes `path`.png and .svg.
    """
    columns = [("multipliers of at most 18 x 18 bits", lambda row: row["multipliers"])]
    if all(row["lut_cells"] is not None for row in rows):
        columns.append(("LUT cells (Yosys)", lambda row: row["lut_cells"]))
    _figure(rows, columns, "Error against hardware (ECP5)", path)


#: Names of the techniques in legends.
TECHNIQUE_NAMES = {
    "phong": "Phong", "gouraud": "Gouraud", "flat": "flat", "cubic": "cubic (model only)",
    "quadratic": "quadratic", "quadratic_vlachos": "quadratic, Vlachos' rule",
    "quadratic_exact": "quadratic, exact mid-edge normals",
}  # fmt: skip


def tessellation_chart(rows: list[dict], path: Path) -> None:
    """Error against the true surface over triangles of the mesh, a column a shape.

    The two upper lines of panels show the techniques themselves, in float64 before any rounding,
    over all pixels and in the highlight. The lowest line shows the 8-bit codes of the RTL, so the
    cubic interpolant, which has no RTL, is not in it. Columns of `rows`: see
    scripts/studies/tessellation_runs.py. Writes `path`.png and .svg.
    """
    shapes = list(dict.fromkeys(row["shape"] for row in rows))
    techniques = list(dict.fromkeys(row["technique"] for row in rows))
    lines = (
        ("method_rms_lsb", "not rounded, all pixels", rows),
        ("highlight_rms_lsb", "not rounded, in the highlight", rows),
        ("rms_lsb", "8-bit codes of the RTL, all pixels", [r for r in rows if r["cycles"]]),
    )
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(3.6 * len(shapes) + 0.8, 8.6), layout="constrained")
        grid = figure.subplots(len(lines), len(shapes), squeeze=False, sharey="row", sharex="col")
        for line, (error, name, shown) in enumerate(lines):
            for column, shape in enumerate(shapes):
                axes = grid[line][column]
                for k, technique in enumerate(techniques):
                    curve = [r for r in shown if (r["shape"], r["technique"]) == (shape, technique)]
                    if not curve:
                        continue
                    axes.plot(
                        [r["triangles"] for r in curve], [r[error] for r in curve],
                        marker=_MARKERS[k], color=_colour(k), linewidth=1,
                        label=TECHNIQUE_NAMES.get(technique, technique),
                    )  # fmt: skip
                axes.loglog()
                axes.yaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
                axes.xaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
                axes.set_title(name, loc="left", fontsize=8)
                if line == len(lines) - 1:
                    perfect = tessellation.perfect_rms(shape)
                    axes.axhline(perfect, color="gray", linewidth=0.8, linestyle=":")
                    axes.annotate(
                        "perfect rounding", (0, perfect), xytext=(2, 2),
                        textcoords="offset points", fontsize=6, color="gray",
                        xycoords=("axes fraction", "data"),
                    )  # fmt: skip
                    axes.set_xlabel("triangles")
            grid[line][0].set_ylabel("RMS error, LSB of 8 bits")
        for column, shape in enumerate(shapes):
            cycles = [r["cycles"] for r in lines[2][2] if r["shape"] == shape]
            title = f"{shape}\n"
            if cycles:
                title += f"{min(cycles):,} to {max(cycles):,} cycles per frame".replace(",", " ")
            axes = grid[0][column]
            axes.annotate(
                title, (0.5, 1), xytext=(0, 16), xycoords="axes fraction", ha="center",
                textcoords="offset points", fontsize=8.5,
            )  # fmt: skip
        figure.legend(*grid[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
        figure.suptitle(
            "Error against the true surface at {} × {}, on the pixels that mesh and surface both "
            "cover".format(*SIZE), fontsize=9,
        )  # fmt: skip
        _save(figure, path)


def _save(figure: Figure, path: Path) -> None:
    """Write `path`.png and .svg without dates."""
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(f"{path}.png", dpi=150, metadata={"Software": None})
    figure.savefig(f"{path}.svg", metadata={"Date": None})


def _titled(title: str, scene: str) -> str:
    return f"{title}\n{scene}" if scene else title


def mach_chart(profiles: dict[str, tuple], path: Path, scene: str = "") -> None:
    """Chart the intensity along a scan line, and its change from pixel to pixel.

    profiles: {technique: (x int[n], 255 S float64[n])}, before any rounding; "true" is the surface
    itself. scene: what is shown, for the title. Writes `path`.png and .svg.
    """
    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(10, 7), layout="constrained")
        above, below = figure.subplots(2, 1, sharex=True)
        for k, (name, (x, value)) in enumerate(profiles.items()):
            look = {
                "color": "black" if name == "true" else _colour(k), "linewidth": 0.9,
                "label": {"true": "true surface"}.get(name, TECHNIQUE_NAMES.get(name, name)),
            }  # fmt: skip
            above.plot(x, value, **look)
            below.plot(x[1:] - 0.5, np.diff(value), **look)
        above.set_ylabel("255 S, green channel, LSB")
        below.set_ylabel("change from pixel to pixel, LSB")
        below.set_ylim(-8, 8)
        below.set_xlabel("x along the middle scan line, pixels")
        above.legend()
        figure.suptitle(_titled("Mach bands arise where the slope jumps", scene))
        _save(figure, path)


def flicker_chart(
    films: dict[str, np.ndarray], changes: dict[str, list], path: Path, scene: str = ""
) -> None:
    """Chart how much the pixels change while a surface turns into itself, by technique.

    films: {title: float64[h, w]}, the largest change of each pixel from a picture to the next, in
    LSB. changes: {title: RMS change of each picture, in LSB}. scene: what is shown, for the title.
    Writes `path`.png and .svg.
    """
    with matplotlib.rc_context(_STYLE | {"axes.grid": False}):
        figure = Figure(figsize=(2.2 * len(films), 5.2), layout="constrained")
        grid = figure.add_gridspec(2, len(films), height_ratios=(3, 2))
        top = max(float(np.nanmax(film)) for film in films.values())
        maps = []
        for k, (title, film) in enumerate(films.items()):
            maps.append(figure.add_subplot(grid[0, k]))
            shown = maps[-1].imshow(film, cmap="inferno", vmin=0, vmax=min(top, 10))
            maps[-1].set_title(title)
            maps[-1].axis("off")
        figure.colorbar(
            shown, ax=maps, label="largest change per degree, LSB", shrink=0.8,
            extend="max" if top > 10 else "neither",
        )  # fmt: skip
        axes = figure.add_subplot(grid[1, :])
        for k, (title, change) in enumerate(changes.items()):
            axes.plot(range(1, len(change) + 1), change, color=_colour(k), label=title)
        axes.set_xlabel("degree")
        axes.set_ylabel("RMS change, LSB")
        axes.set_yscale("log")
        axes.yaxis.set_major_locator(matplotlib.ticker.LogLocator(subs=(1, 2, 5)))
        axes.yaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
        axes.yaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())
        axes.grid(True, alpha=0.3)
        axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), borderaxespad=0)
        figure.suptitle(
            _titled("A surface that turns into itself: every change comes from the mesh", scene)
        )
        _save(figure, path)


def orientation_chart(pictures: dict[str, np.ndarray], path: Path, scene: str = "") -> None:
    """Show a square in several orientations.

    pictures: {title: float64[h, w]}, 255 S from 0 to 255, NaN outside the square. scene: what is
    shown, for the title. Writes `path`.png and .svg.
    """
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
        title = "One corner black, three white: as one polygon, and as two triangles"
        figure.suptitle(_titled(title, scene))
        _save(figure, path)
