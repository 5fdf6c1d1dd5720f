"""Tests of the tests: `python -m scripts.mutate`, with --help for the options.

Two kinds of mutants of rtl/, one change each. Constants: every number that is written by hand,
changed by one (one bit of a sized literal is flipped). Operators: every operator for its
neighbour, every condition negated, every choice turned round, every register held. The module
tests run on the changed copy. A mutant is killed if it does not build without a warning, fails a
test or hangs. Survivors are printed with file and line; those in scripts/equivalent_mutants.txt
are explained there and do not count.

Exit code: 0; 1 if a mutant survived that is not explained; 2 if the command line is wrong.
"""

from __future__ import annotations

import argparse
import datetime
import logging
import multiprocessing
import os
import random
import re
import shutil
import signal
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from model.config import DEFAULT
from scripts import records
from scripts.lint import CONFIGS
from sim import build
from sim.benches import module_bench
from sim.build import ROOT, RTL, Bench, BuildError
from sim.units import MODULES

EXPLAINED = ROOT / "scripts" / "equivalent_mutants.txt"
FOLDER = ROOT / "build" / "mutants"
SURVIVORS = FOLDER / "survivors.txt"
SEED = 75
KINDS = ("constant", "operator")
SIMULATION_SECONDS = 40
MUTANT_SECONDS = 150

#: Benches that could notice a change of a file, the cheapest first.
_OLDER = ("gouraud", "flat")
BENCHES = {
    **{name: ("primitives",) for name in (
        "multiplier", "constant_multiplier", "narrow_multiplier", "leading_zeros", "left_shifter",
        "round_saturate", "delay", "rom", "ram", "small_ram",
    )},
    **{name: (name,) for name in MODULES},
    "inverse_sqrt_method": ("normalizer",),
    "specular_power_method": ("shading_unit",),
    "slope_multiplier": ("specular_power",),
    "across": ("reflection",),
    "versine_of_parts": ("reflection",),
    "differences_unit": (),  # wiring; tests/test_sweep.py runs frames through it
    "normal_interpolator": ("primitives", "phong_pipeline"),
    "register_map": ("primitives", "phong_pipeline"),
    "colour_channel": ("primitives", "shading_unit"),
    "span_walker": ("control", "phong_pipeline"),
    "pixel_fifo": ("control", "phong_pipeline"),
    "phong_pipeline": ("phong_pipeline", *_OLDER),
    "phong_unit": ("phong_pipeline",),
    "intensity_code": ("intensity_code", "gouraud"),
    "gouraud_unit": ("gouraud",),
    "flat_unit": ("flat",),
    "latency": ("primitives", *MODULES, "control", "phong_pipeline", *_OLDER),
}  # fmt: skip

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/|\"[^\"\n]*\"", re.DOTALL)
_UNUSED = re.compile(r"\bwire unused\w* = [^;]*;")  # no hardware: they collect what is dropped
_DECLARATION = re.compile(r"^ *(?:parameter|localparam|input|output|for)\b[^\n]*", re.MULTILINE)
_RANGE = re.compile(r"\[[^\[\]]*\]")
_OPERATOR = re.compile(r"<<|>>|<=|>=|==|!=|&&|\|\||[-+]:|[-+&|^~<>*!]")
_BINARY = {
    "+": "-", "-": "+", "&": "|", "|": "&^", "^": "|", "<<": (">>",), ">>": ("<<",),
    "==": ("!=",), "!=": ("==",), "<": ("<=", ">"), ">": (">=", "<"), "&&": ("||",),
    "||": ("&&",), "*": "+",
}  # fmt: skip
_UNARY = {"~": (" ",), "!": (" ",), "&": "|", "|": "&", "-": (" ",)}
_ASSIGNMENT = re.compile(r"(?<!\w)([a-z_]\w*(?:\[[^\]]*\])?|\{[^{}]*\}) <=(?=[ \n])")
_NUMBER = re.compile(r"(?<![\w`.'])(\d+)?(?:'([sS]?[bdohBDOH])([0-9a-fA-F_]+))?(?![\w'])")


Change = tuple[int, str, str]  # offset, what stands there, what takes its place


@dataclass(frozen=True)
class Mutant:
    """One change: `old` becomes `new` at `offset` of `file`."""

    file: str
    offset: int
    old: str
    new: str
    kind: str  # one of KINDS
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


def _blank(pattern: re.Pattern, code: str) -> str:
    """`code` with spaces where `pattern` matches, so that offsets stay."""
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), code)


def _constants(code: str) -> Iterator[Change]:
    """Every hand-written constant, changed by one in every way."""
    for m in _NUMBER.finditer(code):
        size, base, digits = m.groups()
        if size:
            number = int(size)
            for new in (number + 1, number - 1):
                if new >= (1 if base else 0):
                    yield m.start(1), size, str(new)
        if base:
            radix = {"b": 2, "o": 8, "d": 10, "h": 16}[base[-1].lower()]
            value = int(digits.replace("_", ""), radix)
            spelled = {2: "b", 8: "o", 10: "d", 16: "x"}[radix]
            for bit in range(int(size or 32)):
                yield m.start(3), digits, format(value ^ (1 << bit), spelled)


def _end(code: str, begin: int, stops: str) -> int:
    """Where the first of `stops` stands after `begin`, outside all brackets opened since."""
    depth = 0
    for k in range(begin, len(code)):
        if depth == 0 and code[k] in stops:
            return k
        depth += (code[k] in "([{") - (code[k] in ")]}")
    raise ValueError(f"no {stops} after offset {begin}")


def _operators(code: str) -> Iterator[Change]:
    """Every operator for its neighbour, conditions negated, choices swapped, registers held."""
    code = _blank(_DECLARATION, code)
    inside = _blank(_RANGE, code)  # a range that is wrong is a constant that is wrong
    for m in _OPERATOR.finditer(inside):
        before = code[: m.start()].rstrip()[-1:]
        unary = before in "=(,{?:&|^~<>+-!"
        for new in (_UNARY if unary else _BINARY).get(m[0], ()):
            yield m.start(), m[0], new
    for m in re.finditer(r"\bif \(", inside):
        condition = code[m.end() : _end(code, m.end(), ")")]
        yield m.end(), condition, f"!({condition})"
    for m in re.finditer(r"\?", inside):
        colon = _end(code, m.end(), ":")
        end = _end(code, colon + 1, ";,)}:")
        yes, no = code[m.end() : colon], code[colon + 1 : end]
        yield m.end(), code[m.end() : end], f"{no.rstrip()} : {yes.strip()}"
    for m in _ASSIGNMENT.finditer(code):
        end = _end(code, m.end(), ";")
        yield m.end(), code[m.end() : end], f" {m[1].strip()}"


def mutants(path: Path, kinds: tuple[str, ...] = KINDS) -> list[Mutant]:
    """Every change of those `kinds` to the file `path`."""
    text = path.read_text()
    code = _blank(_UNUSED, _blank(_COMMENT, text))
    changes = {"constant": _constants, "operator": _operators}
    found = [
        Mutant(path.name, begin, text[begin : begin + len(old)], new, kind)
        for kind in kinds
        for begin, old, new in changes[kind](code)
    ]
    seen: dict[tuple[str, str], int] = {}
    for k, mutant in enumerate(found):
        key = mutant.kind, mutant.key
        count = seen[key] = seen.get(key, 0) + 1
        found[k] = replace(mutant, twin=count)
    return found


def _compile_quickly() -> None:
    """Build in a folder of our own, without optimization."""
    build.BUILD = FOLDER
    flags = build.CXX_FLAGS.replace("-O2", "-O0")  # a mutant runs but once
    build.CXX_FLAGS = flags
    library = build.runtime()
    build.runtime = lambda: library


def _out_of_time(*_):
    raise TimeoutError


def _start_worker(number) -> None:
    """A process of its own for one mutant at a time: with its own folder, and an alarm clock."""
    with number.get_lock():
        number.value += 1
        build.BUILD = FOLDER / f"worker{number.value}"
    logging.disable(logging.CRITICAL)
    signal.signal(signal.SIGALRM, _out_of_time)


def passes(name: str, rtl: Path, file: str = "") -> str:
    """Why bench `name` rejects the design in `rtl`; empty if all its tests pass.

    file: the changed one; of the small modules, which share a bench, only its own tests run.
    """
    only = {"ram.v": "memory", "small_ram.v": "memory"}.get(file, Path(file).stem)
    folder = build.BUILD / "run"
    shutil.rmtree(folder, ignore_errors=True)
    shutil.rmtree(build.BUILD / "sim", ignore_errors=True)
    signal.alarm(MUTANT_SECONDS)
    try:
        about = module_bench(name)
        results = Bench(about.top, about.config, about.sources, rtl).run(
            about.tests, folder, seed=SEED,
            test_filter=rf"\.{only}\b" if name == "primitives" and file != "latency.vh" else None,
            extra_env={
                "PHONG_MODULE": name, "PHONG_VECTORS": str(folder), "PHONG_SEED": str(SEED)
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


def killed_by(mutant: Mutant) -> str:
    """The bench that kills `mutant` (None: the design as it is), and how; empty if none does."""
    rtl = build.BUILD / "rtl"
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


def _record(chosen: list[Mutant], outcomes: list[str], everything: list[Mutant]) -> None:
    """Put what was found into the record, file by file; the other files' results stay."""
    found = (records.load("mutate") or {}).get("files", {})
    found = {name: of for name, of in found.items() if (RTL / name).is_file()}
    for file, kind in {(m.file, m.kind) for m in everything}:
        ours = [
            why for m, why in zip(chosen, outcomes, strict=True) if (m.file, m.kind) == (file, kind)
        ]
        total = sum((m.file, m.kind) == (file, kind) for m in everything)
        built = sum(why.endswith(("does not build", "complains")) for why in ours)
        found.setdefault(file, {})[kind] = {
            "mutants": total, "refused": built, "killed": len(ours) - built - ours.count(""),
            "survived": ours.count(""), "equivalent": total - len(ours),
            "date": datetime.date.today().isoformat(), "commit": records.commit(),
        }  # fmt: skip
    rows = []
    for kind, what in (
        ("operator", "operators of `rtl/`, each changed"),
        ("constant", "hand-written constants of `rtl/`, each changed by one"),
    ):
        of = [kinds[kind] for kinds in found.values() if kind in kinds]
        add = {
            key: sum(entry[key] for entry in of)
            for key in ("mutants", "refused", "killed", "survived", "equivalent")
        }
        if not of:
            continue
        when = sorted({(entry["date"], entry["commit"]) for entry in of})
        rows.append(
            records.Row(
                what,
                f"{add['mutants']} mutants: {add['killed']} fail a test, {add['refused']} the "
                f"lint, {add['equivalent']} are the same hardware, {add['survived']} survive",
                f"`scripts/equivalent_mutants.txt` says why; {len(of)} files, run on "
                + ", ".join(f"{date} at {commit}" for date, commit in when),
            )
        )
    records.save("mutate", "make mutate", ("verilator", "cocotb"), rows, files=found)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="mutate", description=__doc__.split("\n\n")[1])
    parser.add_argument("--files", nargs="+", metavar="MODULE", help="these files of rtl/ only")
    parser.add_argument("--kind", choices=KINDS, help="mutants of this kind only")
    parser.add_argument("--sample", type=int, metavar="N", help="N mutants at random")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="mutants at a time")
    parser.add_argument("--again", action="store_true", help="the survivors of the last run only")
    parser.add_argument("--list", action="store_true", help="show the mutants, run nothing")
    return parser.parse_args()


def main() -> int:
    """Run the campaign; returns the exit code."""
    arguments = _arguments()
    known = explained()
    files = sorted(RTL.glob("*.v*"))
    if arguments.files:
        by_name = {path.stem: path for path in files}
        if missing := [name for name in arguments.files if name not in by_name]:
            print(f"mutate: not in rtl/: {' '.join(missing)}", file=sys.stderr)
            return 2
        files = [by_name[name] for name in arguments.files]
    kinds = (arguments.kind,) if arguments.kind else KINDS
    everything = [m for path in files for m in mutants(path, kinds)]
    stale = set(known) - {m.key for m in everything}
    if arguments.files or arguments.kind:
        stale = set()
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
    survivors: list[Mutant] = []
    outcomes: list[str] = []
    begin = time.monotonic()
    context = multiprocessing.get_context("fork")
    with context.Pool(arguments.jobs, _start_worker, (context.Value("i", 0),)) as pool:
        # A bench that rejects the design itself would kill every mutant, and mean nothing.
        used = {name for m in chosen for name in BENCHES[Path(m.file).stem]}
        for name, why in zip(used, pool.starmap(passes, [(n, RTL) for n in used]), strict=True):
            if why:
                print(f"mutate: {name} rejects the design itself: {why}", file=sys.stderr)
                return 2
        for mutant, why in zip(chosen, pool.imap(killed_by, chosen), strict=True):
            outcomes.append(why)
            if not why:
                survivors.append(mutant)
                print(f"SURVIVED {mutant.file}:{mutant.line}: {mutant.old} -> {mutant.new}: "
                      f"{mutant.key.partition(': ')[2]}", flush=True)  # fmt: skip
            done = len(outcomes)
            left = (time.monotonic() - begin) / done * (len(chosen) - done)
            print(f"{done}/{len(chosen)} mutants, {len(survivors)} survived, "
                  f"{left / 60:.0f} min left; {mutant.file}:{mutant.line} {why or 'survived'}",
                  file=sys.stderr, flush=True)  # fmt: skip
    if not (arguments.sample or arguments.again):
        _record(chosen, outcomes, everything)
    SURVIVORS.write_text("".join(f"{m.key}\n" for m in survivors))
    print(
        f"{len(chosen)} mutants, {len(chosen) - len(survivors)} killed, "
        f"{len(survivors)} survived; {len(everything) - len(chosen)} left out or explained"
    )
    return 1 if survivors else 0


if __name__ == "__main__":
    sys.exit(main())
