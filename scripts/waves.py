# SPDX-License-Identifier: MIT
"""A waveform of a short run with one module's signals grouped for GTKWave: `phong75 waves MODULE`.

The whole pipeline runs a picture of 64 x 32 pixels, whose spans have up to 27 pixels. Writes
build/waves/<module>.fst and .gtkw. The waveform has every signal of the design, and the fields of
spans and pixels. The save file shows flow control, the fields, the ports of each instance of the
module, then the signals of its stages; its view starts at the first pixel. Exit code: 0; 2 if there
is no such module.
"""

from __future__ import annotations

import math
import os
import re
import shlex
import shutil
import tempfile
from pathlib import Path

from phong75.model.config import DEFAULT as CONFIG
from phong75.model.config import Config
from phong75.model.frame import InputError
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console
from phong75.scripts.configurations import unknown
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.design import BUILD, PACKAGE
from phong75.sim.frame import waveform
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from phong75.sim.frame.waveform import Scope, Waveform

TOP = "phong_pipeline"
#: The scene: few spans, of many lengths, with normals that differ much along a span.
SCENE, SIZE = PACKAGE / "model" / "data" / "facets.toml", (64, 32)

# Flags of a trace in a GTKWave save file.
_GROUP, _GROUP_END = "@800200", "@1000200"
_BIT, _HEX, _UNSIGNED, _SIGNED = "@28", "@22", "@24", "@420"
_SIGNED_FRACTION = "@40000420"  # with a line that says how many bits stand behind the point

#: The view: cycles before the first pixel, and cycles in 1000 pixels of the window.
BEFORE, SHOWN = 4, 40


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


def save_file(wave: Waveform, module: str, config: Config) -> str:
    """The text of a GTKWave save file for `module` of `config`. Raises InputError if no instance
    of `module` is in the waveform."""
    groups: list[tuple[str, list[str]]] = []
    names, outside = instances(module), ports(module)
    shown = False
    for scope in wave.scopes():
        parent, leaf = ("." + scope.path).split(".")[-2:]
        if leaf == waveform.BENCH:
            groups += _bench_groups(scope, config)
        if leaf.startswith("gen_") and parent in names:  # a generate block of the module
            leaf = f"{parent} {leaf}"
        elif leaf not in names:
            continue
        shown = True
        groups += _module_groups(scope, leaf, outside)
    if not shown:
        raise InputError(f"configuration {config.name} has no {module}")
    # With both names GTKWave finds the waveform beside the save file, wherever it is started.
    save = wave.path.with_suffix(".gtkw")
    lines = [f'[dumpfile] "{wave.path.resolve()}"', f'[savefile] "{save.resolve()}"', *_view(wave)]
    for title, traces in groups:
        if traces:
            lines += [_GROUP, f"-{title}", *traces, _GROUP_END, f"-{title}"]
    return "\n".join(lines) + "\n"


def _unknown(module: str) -> InputError:
    """The error for a `module` that is not part of what runs."""
    known = sorted(file.stem for file in design.sources() if instances(file.stem))
    return unknown("MODULE", module, known)


def _view(wave: Waveform) -> list[str]:
    """The lines that place the window and the view: its start, its zoom, and the markers.

    The main marker is at the first pixel, marker A at the first span.
    """
    if wave.first_pixel is None or wave.period is None:
        return []
    start = max(0, wave.first_pixel - BEFORE * wave.period)
    # GTKWave draws 2 ** -zoom units of time in 200 pixels of the window.
    zoom = -math.log2(200 * SHOWN * wave.period / 1000)
    unset = " -1" * 25
    return [
        f"[timestart] {start}", "[size] 1400 900", "[pos] -1 -1",
        f"*{zoom:.6f} {wave.first_pixel} {wave.first_span}{unset}",
        "[sst_width] 220", "[signals_width] 260",
    ]  # fmt: skip


def _trace(path: str, signal: waveform.Signal, flag: str | None = None) -> list[str]:
    """The lines that show `signal` of the scope `path`: by default as a bit or as hexadecimal."""
    flag = flag or (_HEX if signal.range else _BIT)
    return [flag, f"{path}.{signal.shown}"]


def _bench_groups(bench: Scope, config: Config) -> list[tuple[str, list[str]]]:
    """Clock and flow control, the fields of a span, and those of a pixel."""
    flow = re.compile(r"clk|reset|[sm]_(valid|ready|last)")
    order = ["clk", "reset", "s_valid", "s_ready", "s_last", "m_valid", "m_ready", "m_last"]
    control = sorted(
        (s for s in bench.signals if flow.fullmatch(s.name)), key=lambda s: order.index(s.name)
    )
    groups = [("flow control", [line for s in control for line in _trace(bench.path, s)])]
    scopes = {scope.name: scope for scope in bench.scopes}
    for name, members in waveform.fields(config).items():
        signals = {s.name: s for s in scopes[name].signals}
        lines = []
        for member in members:
            flag = _SIGNED if member.signed else _UNSIGNED
            if member.fraction:
                flag = _SIGNED_FRACTION
                lines.append(f"[fpshift_count] {member.fraction}")
            lines += _trace(scopes[name].path, signals[member.name], flag)
        groups.append((name, lines))
    return groups


def _module_groups(scope: Scope, title: str, outside: set[str]) -> list[tuple[str, list[str]]]:
    """Ports of an instance, then its other signals, both in the order of the stages."""
    hidden = re.compile("clk|[A-Z0-9_]+")  # the clock, which is shown once, and parameters
    signals = [s for s in scope.signals if not hidden.fullmatch(s.name)]
    groups = []
    for kind, is_port in (("ports", True), ("stages", False)):
        chosen = [s for s in signals if (s.name in outside) == is_port]
        chosen.sort(key=lambda s: _stage(s.name))
        lines = [line for s in chosen for line in _trace(scope.path, s)]
        groups.append((f"{title} {kind}", lines))
    return groups


def _stage(signal: str) -> tuple[int, str]:
    """Sorts signals by the stage in their name (_p7); signals without a stage come first."""
    stage = re.search(r"_p(\d+)\b", signal)
    return int(stage[1]) if stage else -1, signal


def record(module: str, config: Config = CONFIG, folder: Path = BUILD / "waves") -> Waveform:
    """Simulate, and write the waveform and its save file into `folder`.

    Raises InputError if `module` is not part of `config`; BuildError, SimulationError, OSError.
    """
    if design.module_file(module) is None or not instances(module):
        raise _unknown(module)
    folder.mkdir(parents=True, exist_ok=True)
    frame = front_end(load_scene(str(SCENE), SIZE, config), config).frame
    bench = Bench(waveform.BENCH, config, trace=True)
    with tempfile.TemporaryDirectory(dir=folder) as scratch:
        vcd = Path(scratch, "run.vcd")
        simulate_jobs([SimJob(frame)], config, bench, waves=vcd, progress=console.phase)
        wave = waveform.split(vcd, folder / module, config)
    wave.path.with_suffix(".gtkw").write_text(save_file(wave, module, config))
    return wave


def command(wave: Waveform) -> str:
    """The command that shows `wave`, for the current folder, and what it needs."""
    files = wave.path, wave.path.with_suffix(".gtkw")
    text = shlex.join(["gtkwave", *(os.path.relpath(file) for file in files)])
    notes = []
    if not shutil.which("gtkwave"):
        notes.append(
            "GTKWave is not installed (apt-get install gtkwave); Surfer reads "
            f"{os.path.relpath(wave.path)}, too"
        )
    if wave.path.suffix == ".vcd":
        notes.append("VCD in place of FST: pylibfst is not installed (pip install pylibfst)")
    return "\n".join([text, *notes])


def main(module: str, config: Config) -> int:
    """Write the two files; returns the exit code.

    Raises InputError if `module` is no part of `config`; BuildError, SimulationError.
    """
    console.say(command(record(module, config)))
    return console.GOOD
