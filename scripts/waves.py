"""A waveform of a short run with one module's signals grouped for GTKWave: `make waves MODULE=`.

Writes build/waves/<module>.vcd and .gtkw. The whole pipeline runs a sphere of a few dots; the
save file shows clock and flow control, then the ports of each instance of the module, then the
signals of its stages.
"""

from __future__ import annotations

import re
import shutil
import sys
from dataclasses import dataclass, field
from pathlib import Path

from phong75.model.config import DEFAULT as CONFIG
from phong75.model.frame import InputError
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.sim import design
from phong75.sim.build import Bench, BuildError
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import Job, SimulationError, simulate_jobs

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
        known = sorted(file.stem for file in design.sources() if instances(file.stem))
        raise InputError(f"MODULE is `{module}`, not one of {', '.join(known)}")
    lines = [f'[dumpfile] "{vcd.name}"']
    for title, signals in groups:
        if not signals:
            continue
        lines += ["@800200", f"-{title}"]
        for signal in signals:
            lines += ["@22" if "[" in signal else "@28", signal]
        lines += ["@1000200", f"-{title}"]
    return "\n".join(lines) + "\n"


def _stage(signal: str) -> tuple[int, str]:
    """Sorts signals by the stage in their name (_p7), as the data flow; others first."""
    stage = re.search(r"_p(\d+)\b", signal)
    return int(stage[1]) if stage else -1, signal


def main(argv: list[str]) -> int:
    """Write the two files; returns the exit code."""
    module = argv[0] if argv else TOP
    if design.module_file(module) is None or not instances(module):
        known = sorted(file.stem for file in design.sources() if instances(file.stem))
        print(f"MODULE is `{module}`, not one of {', '.join(known)}", file=sys.stderr)
        return 2
    folder = BUILD / "waves"
    folder.mkdir(parents=True, exist_ok=True)
    vcd = folder / f"{module}.vcd"
    try:
        frame = front_end(load_scene("sphere", SIZE)).frame
        simulate_jobs([Job(frame)], CONFIG, Bench("frame_bench", CONFIG, trace=True), waves=vcd)
        vcd.with_suffix(".gtkw").write_text(save_file(vcd, module))
    except (InputError, BuildError, SimulationError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    viewer = (
        "" if shutil.which("gtkwave") else "; GTKWave is not installed (apt-get install gtkwave)"
    )
    print(f"gtkwave {vcd.with_suffix('.gtkw')}{viewer}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
