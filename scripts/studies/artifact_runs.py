# SPDX-License-Identifier: MIT
"""The paper's arguments as numbers and pictures: Mach bands, flicker, orientation.

Part of `phong75 tessellation`. Writes build/sweep/arguments.json, mach.png, flicker.png and
orientation.png (and .svg). Codes of turning objects and of the square come from the RTL.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
from rich.table import Table

from phong75.model import twin
from phong75.model.analysis import metrics
from phong75.model.config import TECHNIQUES
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import charts, shading_artifacts, tessellation
from phong75.model.studies.surfaces import SURFACES
from phong75.scripts.console import MismatchError
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import SimJob, simulate_jobs

FOLDER = BUILD / "sweep"
#: Meshes on which the techniques can be told apart: steps once round.
LEVELS = {"sphere": (16, 32, 64), "torus": (16, 32, 64), "patch": (4, 8, 16)}
TURNING = {"sphere": 16, "torus": 32}
FLICKERING = (*TECHNIQUES, "quadratic")
FRAMES = 30
FLICKER_SIZE = (320, 240)
SQUARE_SIZE = 200


def shaded_by_rtl(frames: list, technique: str) -> list:
    """`Pixels` of each of `frames`. Raises MismatchError, BuildError, SimulationError."""
    config = tessellation.SHADED[technique]
    results = simulate_jobs([SimJob(frame) for frame in frames], config)
    for frame, result in zip(frames, results, strict=True):
        if metrics.compare(twin.render(frame, config), result.pixels).mismatches:
            raise MismatchError(f"{technique}: RTL and model differ")
    return [result.pixels for result in results]


def mach(levels=LEVELS, size=tessellation.SIZE) -> dict:
    """{shape: {level: {technique: jumps}}}, on pixels whose normal is within 60 degrees of the
    eye."""
    out: dict = {}
    for shape, steps in levels.items():
        surface, true = SURFACES[shape], tessellation.truth(shape, size)
        for level in steps:
            for technique, config in tessellation.SHADED.items():
                mesh = surface.mesh(level)
                scene = tessellation.shaded_scene(surface, mesh, technique, size)
                found = shading_artifacts.mach_bands(
                    front_end(scene, config), technique, true.covered & (true.facing >= 0.5)
                )
                out.setdefault(shape, {}).setdefault(level, {})[technique] = found
    return out


def flicker(
    turning=TURNING, count: int = FRAMES, size=FLICKER_SIZE, techniques=FLICKERING
) -> tuple[dict, dict, dict]:
    """{shape: {technique: changes}}, and what `charts.flicker_chart` shows."""
    out: dict = {}
    maps, curves = {}, {}
    for shape, level in turning.items():
        for technique in techniques:
            frames = list(shading_artifacts.turning(shape, level, technique, count, size))
            pixels = shaded_by_rtl(frames, technique)
            out.setdefault(shape, {})[technique] = shading_artifacts.flicker(frames, pixels)
            film = np.full((count, size[1], size[0], 3), np.nan)
            for picture, p in zip(film, pixels, strict=True):
                picture[p.y, p.x] = p.rgb
            change = np.abs(np.diff(film, axis=0))
            title = f"{shape} of {level}, {charts.TECHNIQUE_NAMES[technique]}"
            maps[title] = change.max(axis=(0, 3))
            curves[title] = np.sqrt(np.nanmean(change**2, axis=(1, 2, 3))).tolist()
    return out, maps, curves


def orientation(size: int = SQUARE_SIZE) -> tuple[dict, dict]:
    """Numbers of `shading_artifacts.orientation`, with the RTL's two triangles; and pictures."""
    found = shading_artifacts.orientation()
    angles = (0.0, 45.0, 90.0)
    frames = [front_end(shading_artifacts.square_scene(a, size), TECHNIQUES["gouraud"]).frame
              for a in angles]  # fmt: skip
    pixels = shaded_by_rtl(frames, "gouraud")
    found["triangles"]["rtl_quarter_turn_lsb"] = shading_artifacts.quarter_turn_difference(
        pixels[0], pixels[2], size
    )
    pictures = {}
    for angle in angles:
        pictures[f"quadrilateral, {angle:g}°"] = shading_artifacts.polygon_picture(angle, size)
    for angle, p in zip(angles, pixels, strict=True):
        picture = np.full((size, size), np.nan)
        picture[p.y, p.x] = p.rgb[:, 0]
        pictures[f"two triangles (RTL), {angle:g}°"] = picture
    return found, pictures


def run(progress: Callable[[str], None] = lambda text: None, folder: Path = FOLDER) -> dict:
    """Measure everything and write it to `folder`; returns what is in shading_artifacts.json.

    Raises MismatchError, BuildError, SimulationError.
    """
    folder.mkdir(parents=True, exist_ok=True)
    progress("Mach bands")
    found: dict = {"mach_bands": mach()}
    level = LEVELS["sphere"][0]
    profiles = {t: shading_artifacts.profile("sphere", level, t) for t in (*TECHNIQUES, "true")}
    size = "{} × {}".format(*tessellation.SIZE)
    scene = f"sphere of {level} steps, {size}, before rounding"
    charts.mach_chart(profiles, folder / "mach", scene)
    progress("flicker")
    found["flicker"], maps, curves = flicker()
    size = "{} × {}".format(*FLICKER_SIZE)
    scene = f"{FRAMES} frames of {size}, a degree apart; codes of the RTL"
    charts.flicker_chart(maps, curves, folder / "flicker", scene)
    progress("orientation")
    found["orientation"], pictures = orientation()
    scene = f"Gouraud shading, {SQUARE_SIZE} × {SQUARE_SIZE}"
    charts.orientation_chart(pictures, folder / "orientation", scene)
    (folder / "arguments.json").write_text(json.dumps(found, indent=2) + "\n")
    return found


def table(found: dict) -> Table:
    """What there is to see of `found` in a terminal."""
    out = Table(title="the paper's arguments")
    out.add_column("what")
    techniques = tuple(tessellation.SHADED)
    for technique in techniques:
        out.add_column(technique, justify="right")
    for shape, levels in found["mach_bands"].items():
        for level, by in levels.items():
            out.add_row(
                f"slope jump at edges, {shape} of {level}, LSB/pixel, mean",
                *(f"{by[t]['slope_mean']:.3f}" for t in techniques),
            )
            out.add_row(
                f"intensity jump, {shape} of {level}, LSB, RMS",
                *(f"{by[t]['intensity_rms']:.3f}" for t in techniques),
            )
    for shape, by in found["flicker"].items():
        out.add_row(
            f"change in a degree, {shape}, LSB, RMS (max)",
            *(
                f"{by[t]['change_rms']:.3f} ({by[t]['change_max']:.0f})" if t in by else ""
                for t in techniques
            ),
        )
        out.add_row(
            f"highlight's peak, {shape}",
            *("{} to {}".format(*by[t]["peak_range"]) if t in by else "" for t in techniques),
        )
    for kind in ("quadrilateral", "triangles"):
        spread = found["orientation"][kind]["largest_spread_lsb"]
        out.add_row(f"spread over orientations, {kind}, LSB", "", f"{spread:.3g}")
    return out
