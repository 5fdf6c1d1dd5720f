# SPDX-License-Identifier: MIT
"""Register toggles per pixel of every bundled scene, a number for energy: `phong75 activity`.

Counted by Verilator's toggle coverage over one frame: changes of bits that rtl/ declares as `reg`,
so that wires and ports, which repeat them, do not count twice. No glitches, no wires, no clock
tree; not joules. The numbers go to build/activity.json.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path

from rich.table import Table

from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame, with_lights
from phong75.model.front.scene import bundled_scenes, load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, recorded
from phong75.scripts.configurations import CONFIGURATIONS
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.coverage import points
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import SimJob, simulate_jobs


def registers() -> dict[str, set[str]]:
    """{file: names} of everything that rtl/ declares as `reg`."""
    found = {}
    for file in design.sources():
        lines = re.findall(r"\breg\b\s*(?:\[[^\]]*\])?\s*([^;/]*)", file.read_text())
        found[file.name] = {name for line in lines for name in re.findall(r"\b[a-z]\w*", line)}
    return found


def toggles_per_pixel(frame: Frame, config: Config, folder: Path) -> tuple[int, float]:
    """Pixels of `frame`, and register toggles a pixel, on a build of `config`; counts into
    `folder`, which is emptied first."""
    shutil.rmtree(folder, ignore_errors=True)
    bench = Bench("frame_bench", config, coverage=folder)
    pixels = len(simulate_jobs([SimJob(frame)], config, bench)[0].pixels.x)
    declared = registers()
    toggles = sum(
        count
        for (kind, name, _, what), count in points(folder).items()
        if kind == "toggle" and re.search(r"[a-z]\w*", what)[0] in declared[name]
    )
    return pixels, toggles / pixels


def main(record: bool) -> int:
    """Measure and print; returns the exit code. Raises BuildError, SimulationError."""
    recorded.check(record)
    table = Table(title="register toggles a pixel, 640x480")
    hold = CONFIGURATIONS["hold_unlit"]
    for title in ("scene", "pixels", "toggles a pixel", "with hold_unlit"):
        table.add_column(title, justify="right")
    found = {}
    for scene in bundled_scenes():
        console.phase(scene)
        frame = front_end(load_scene(scene)).frame
        if with_lights(DEFAULT, frame) != DEFAULT:
            continue  # hold_unlit is for one light
        pixels, toggles = toggles_per_pixel(frame, DEFAULT, BUILD / "activity")
        held = toggles_per_pixel(frame, hold, BUILD / "activity")[1]
        found[scene] = {
            "pixels": pixels, "toggles_per_pixel": round(toggles, 1),
            "hold_unlit": round(held, 1),
        }  # fmt: skip
        table.add_row(scene, str(pixels), f"{toggles:.0f}", f"{held:.0f}")
    console.show(table)
    (BUILD / "activity.json").write_text(json.dumps(found, indent=2) + "\n")
    if record:
        recorded.record(
            "activity", "make activity", ("verilator",), {"scenes": found}, {"scenes": len(found)}
        )
    return console.GOOD
