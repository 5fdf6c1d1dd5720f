"""Charts of the precision sweep: error over time, and error over what it costs in hardware."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib
import matplotlib.ticker
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


def _curves(axes: Axes, rows: list[dict], x: Callable, y: Callable) -> None:
    """One curve a method, from the default point on where that belongs to it."""
    for k, method in enumerate(dict.fromkeys(row["method"] for row in rows)):
        own = [row for row in rows if row["method"] == method]
        own.sort(key=y)
        default = method == "default"
        axes.plot(
            [x(row) for row in own], [y(row) for row in own],
            marker="*" if default else _MARKERS[k % len(_MARKERS)], linewidth=0.8,
            color="black" if default else f"C{k % 10}", markersize=10 if default else None,
            zorder=5 if default else 2, label=method, alpha=0.9,
        )  # fmt: skip
    front = pareto([x(row) for row in rows], [y(row) for row in rows])
    ends = sorted((x(row), y(row)) for row, on in zip(rows, front, strict=True) if on)
    axes.step(*zip(*ends, strict=True), where="post", color="black", linewidth=2.5, alpha=0.25,
              zorder=1, label="Pareto front")  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.minorticks_on()


def _plain(axes: Axes) -> None:
    """Whole numbers along a short logarithmic axis."""
    axes.xaxis.set_major_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.xaxis.set_minor_formatter(matplotlib.ticker.StrMethodFormatter("{x:g}"))
    axes.tick_params(axis="x", which="both", labelsize=6, labelrotation=45)


def _figure(rows: list[dict], columns: list[tuple[str, Callable]], title: str, path: Path) -> None:
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
                _curves(axes, rows, cost, error)
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
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(f"{path}.png", dpi=150, metadata={"Software": None})
        figure.savefig(f"{path}.svg", metadata={"Date": None})


def time_chart(rows: list[dict], path: Path) -> None:
    """Error over the time of all frames, and over that of one pixel through the pipeline.

    The title says where the clock comes from.
    """
    stated = [row for row in rows if row["clock_source"] == "stated"]
    if len(stated) == len(rows):
        clock = f"clock NOT measured: {rows[0]['clock_mhz']:g} MHz stated for all"
    elif stated:
        clock = (
            f"clock by place and route; {len(stated)} of {len(rows)} at the stated "
            f"{stated[0]['clock_mhz']:g} MHz"
        )
    else:
        clock = "each at its own clock by place and route"
    columns = [
        ("time of all frames, us", lambda row: row["frame_us"]),
        ("from a span to its first pixel, ns",
         lambda row: 1e3 * row["latency_cycles"] / row["clock_mhz"]),
    ]  # fmt: skip
    _figure(rows, columns, f"Error against time; {clock}", path)


def cost_chart(rows: list[dict], path: Path) -> None:
    """Error over multipliers and over logic, of the rows that have been synthesized."""
    columns = [
        ("DSP blocks (MULT18X18D)", lambda row: row["dsp"]),
        ("LUT sites: LUT4 + 2 per carry cell + 4 per LUT RAM", lambda row: row["lut"]),
    ]
    _figure(rows, columns, "Error against hardware (ECP5, Yosys)", path)
