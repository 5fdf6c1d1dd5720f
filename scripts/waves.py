# SPDX-License-Identifier: MIT
"""A waveform of a short run with one module's signals grouped for GTKWave: `phong75 waves MODULE`.

Writes build/waves/<module>.vcd and .gtkw. The whole pipeline runs a sphere of a few dots; the
save file shows clock and flow control, then the ports of each instance of the module, then the
signals of its stages.
"""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from phong75.model.config import Config
from phong75.model.frame import InputError
from phong75.model.front.scene import load_scene
from phong75.model.front.scene_to_spans import front_end
from phong75.scripts import console
from phong75.scripts.configurations import unknown
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import Job, simulate_jobs

TOP = "phong_pipeline"
SIZE = (24, 16)


@dataclass
class Scope:
    """An instance in the waveform: its path, and its signals with their ranges."""

    path: str
    signals: list[str] = field(default_factory=list)


def scopes(vcd: Path) -> list[Scope]:
    """The instances that the header of a VCD file declares."""
    path: list[str] = []
    found: dict[str, Scope] = {}
    with open(vcd) as file:
        for line in file:
            words = line.split()
            if line.startswith("$enddefinitions"):
                break
            if not words:
                continue
            if words[0] == "$scope":
                path.append(words[2])
            elif words[0] == "$upscope":
                path.pop()
            elif words[0] == "$var":
                name = ".".join(path)
                found.setdefault(name, Scope(name)).signals.append("".join(words[4:-1]))
    return list(found.values())


def instances(module: str) -> set[str]:
    """The instance names of `module` in the design."""
    pattern = re.compile(rf"^\s*{module}\b[^;]*?\b(u_\w+)\s*\(\s*$", re.MULTILINE | re.DOTALL)
    names = {name for file in design.sources() for name in pattern.findall(file.read_text())}
    return names | ({"dut"} if module == TOP else set())


def ports(module: str) -> set[str]:
    """The names of the ports of `module`."""
    text = design.module_file(module).read_text()
    return set(re.findall(r"^\s*(?:input|output)\s+(?:wire|reg).*?(\w+)\s*[,)]?\s*(?://.*)?$", text,
                          re.MULTILINE))  # fmt: skip


def save_file(vcd: Path, module: str) -> str:
    """The text of a GTKWave save file for `module`. Raises InputError if it is nowhere."""
    names, outside = instances(module), ports(module)
    groups: list[tuple[str, list[str]]] = []
    for scope in scopes(vcd):
        path = scope.path.split(".")
        leaf = path[-1]
        if leaf == "frame_bench":
            flow = [s for s in scope.signals if re.match(r"(clk|reset|[sm]_(valid|ready))\b", s)]
            groups.append(("flow control", [f"{scope.path}.{s}" for s in flow]))
        if leaf.startswith("gen_") and path[-2] in names:  # a generate block of the module
            leaf = f"{path[-2]} {leaf}"
        elif leaf not in names:
            continue
        signals = [s for s in scope.signals if re.match(r"\w+", s)[0] not in {"clk", "LATENCY"}]
        signals = [s for s in signals if not re.match(r"[A-Z0-9_]+\b", s)]  # parameters
        for title, wanted in (("ports", True), ("stages", False)):
            chosen = [s for s in signals if (re.match(r"\w+", s)[0] in outside) == wanted]
            chosen.sort(key=_stage)
            groups.append((f"{leaf} {title}", [f"{scope.path}.{s}" for s in chosen]))
    if len(groups) < 2:
        raise _unknown(module)
    lines = [f'[dumpfile] "{vcd.name}"']
    for title, signals in groups:
        if not signals:
            continue
        lines += ["@800200", f"-{title}"]
        for signal in signals:
            lines += ["@22" if "[" in signal else "@28", signal]
        lines += ["@1000200", f"-{title}"]
    return "\n".join(lines) + "\n"


def _unknown(module: str) -> InputError:
    """The error for a `module` that is not part of what runs."""
    known = sorted(file.stem for file in design.sources() if instances(file.stem))
    return unknown("MODULE", module, known)


def _stage(signal: str) -> tuple[int, str]:
    """Sorts signals by the stage in their name (_p7), as the data flow; others first."""
    stage = re.search(r"_p(\d+)\b", signal)
    return int(stage[1]) if stage else -1, signal


def main(module: str, config: Config) -> int:
    """Write the two files; returns the exit code.

    Raises InputError if `module` is no part of `config`; BuildError, SimulationError.
    """
    if design.module_file(module) is None or not instances(module):
        raise _unknown(module)
    folder = BUILD / "waves"
    folder.mkdir(parents=True, exist_ok=True)
    vcd = folder / f"{module}.vcd"
    frame = front_end(load_scene("sphere", SIZE), config).frame
    bench = Bench("frame_bench", config, trace=True)
    simulate_jobs([Job(frame)], config, bench, waves=vcd, progress=console.phase)
    save = vcd.with_suffix(".gtkw")
    save.write_text(save_file(vcd, module))
    viewer = (
        "" if shutil.which("gtkwave") else "; GTKWave is not installed (apt-get install gtkwave)"
    )
    console.say(f"gtkwave {console.shown(save)}{viewer}")
    return console.GOOD
