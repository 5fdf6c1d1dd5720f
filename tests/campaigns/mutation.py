# SPDX-License-Identifier: MIT
"""Tests of the tests: `make mutate`, or `python -m tests.campaigns.mutation --help`.

Two kinds of mutants of rtl/, one change each. Constants: every number that is written by hand,
changed by one (of a sized literal the lowest bit is flipped, or the highest). Operators: every
operator for its neighbour, every condition negated, every choice turned round, every register held.
The trials and module tests of the file run on the changed copy: on builds with what the default
configuration leaves out, too. A mutant is killed if it does not build without a warning, fails a
test or hangs; a bench of which Verilator makes the same program as before is not run. Survivors are
printed with file and line; those in tests/campaigns/equivalent_mutants.txt are explained
there and do not count.

Exit code: 0; 1 if a mutant survived that is not explained; 2 if the command line is wrong.
"""

from __future__ import annotations

import datetime
import json
import logging
import multiprocessing
import os
import random
import re
import resource
import shutil
import signal
import sys
import time
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import typer

from phong75.model.config import DEFAULT
from phong75.model.frame import InputError
from phong75.scripts import console, options, recorded
from phong75.scripts.configurations import unknown
from phong75.scripts.lint import CONFIGS
from phong75.scripts.main import single
from phong75.sim import build, design
from phong75.sim.build import Bench, BuildError
from phong75.sim.frame.run_frame import SimulationError
from phong75.sim.limits import Watch
from phong75.sim.module.units import MODULES
from tests.configuration_tests import TRIALS, trial
from tests.modules.benches import ModuleBench, module_bench

EXPLAINED = Path(__file__).with_name("equivalent_mutants.txt")
FOLDER = design.BUILD / "mutants"
OUTCOMES = FOLDER / "outcomes.json"
SEED = 75
KINDS = ("constant", "operator")
BENCH_SECONDS = 60  # processor time of a bench's compilation and simulation together
MEMORY = 4 << 30  # bytes: some mutants have Verilator unroll a loop without end
REFUSED = "does not build"

#: Module benches and trials (tests/trials.py) that could notice a change of a file. Those
#: of the default configuration come first, for most changes fail them.
_SMALL = ("default", "primitives")
_MEMORIES = ("ram", "small_ram")  # whose tests are the same
_SINGLE = ("single", "single grey", "single matte", "single cosine", "single glow")
_OLDER = ("gouraud 3", "gouraud 1", "flat 3", "flat 1", "gouraud", "flat")
_METHODS = (
    "not_normalized", "dot_first_18", "quadratic_spans_18", "table_32_newton", "fast_inverse_2",
    "parabolas_8", "squaring_18", "schlick_18",
)  # fmt: skip
BENCHES = {
    "half_vector_cross": (
        "default", "reflection", "dot_first_18", "constant_half_vector", "single", "single grey",
    ),
    "colour_channel": (
        *_SMALL, "shading_unit", "specular", "diffuse", "ambient", "constant_ambient",
        "constant_diffuse", *_SINGLE, "width_13",
    ),
    "constant_multiplier": ("primitives", *_SINGLE),
    "delay": _SMALL,
    "quadratic_normalizer": (
        "quadratic_spans_18", "quadratic_normalizer", "quadratic_normalizer@quadratic_spans_14",
    ),
    "quadratic_unit": ("quadratic_spans_18", "quadratic_spans_14"),
    "flat_unit": ("flat 3", "flat 1", "flat"),
    "gouraud_unit": ("gouraud 3", "gouraud 1", "gouraud"),
    "intensity_code": ("gouraud 3", "intensity_code", "gouraud", "flat"),
    "inverse_sqrt_linear": ("default", "inverse_sqrt_linear", "normalizer", "lines_32", "width_10"),
    "inverse_sqrt_iterated": (
        "table_32", "fast_inverse_2", "inverse_sqrt_iterated",
        "inverse_sqrt_iterated@fast_inverse_1",
        "table_32_newton", "fast_inverse_0",
    ),
    "inverse_sqrt": ("default", "fast_inverse_2", "parabolas_8", "table_32", "quadratic_spans_18"),
    "inverse_sqrt_quadratic": ("parabolas_8", "inverse_sqrt_quadratic", "parabolas_32"),
    "latency": (
        "default", *_METHODS, "gouraud 3", "hold_unlit", "specular", "power_function", "single",
        "single matte", "single cosine", "primitives", *MODULES, *TRIALS, "control",
        "phong_pipeline", "gouraud", "flat",
    ),
    "leading_zeros": (*_SMALL, "width_10"),
    "left_shifter": (*_SMALL, "width_10"),
    "multiplier": (*_SMALL, "width_10"),
    "narrow_multiplier": (*_SMALL, "power_tables_32", "width_10"),
    "newton_step": ("fast_inverse_2", "newton_step", "table_32_newton"),
    "normal_hold": ("hold_unlit", "primitives"),
    "linear_interpolator": (
        *_SMALL, "interpolate_x", "idle_step_bits", "narrow", "gouraud 3", "phong_pipeline",
    ),
    "normalizer": (
        "default", "normalizer", "constant_shift", "two_sided", "dot_first_18", "dot_first_14",
        "specular", *_SINGLE, "width_10", "interpolator_20",
    ),
    "phong_pipeline": ("default", *_OLDER, "quadratic_spans_18", "narrow", "phong_pipeline"),
    "phong_unit": (
        "default", "hold_unlit", "not_normalized", "narrow", "interpolate_x", "interpolate_y",
        "interpolate_z", "idle_step_bits", "idle_material_bits", "idle_x_bits", "idle_y_bits",
        "constant_shift", *_SINGLE, "phong_pipeline",
    ),
    "pixel_fifo": (
        "default", "control", "gouraud 3", "hold_unlit", "narrow", "idle_x_bits", "idle_y_bits",
        "channels", "phong_pipeline",
    ),
    "specular_power_schlick": ("schlick_18", "specular_power_schlick", "schlick_14"),
    "specular_power_squaring": (
        "squaring_18", "specular_power_squaring", "specular_power_squaring@squaring_14",
    ),
    "quadratic_interpolator": ("quadratic_spans_18", "quadratic_interpolator"),
    "ram": _SMALL,
    "reflection": ("default", "reflection", *_SINGLE, "width_13"),
    "register_map": (
        *_SMALL, *_SINGLE, "specular", "power_function", "power_bypass", "log_octaves",
        "weight_function", "diffuse", "ambient", "channels", "two_sided",
        "constant_half_vector", "constant_exponent", "constant_weight", "constant_ambient",
        "constant_diffuse",
    ),
    "rom": _SMALL,
    "round_saturate": (*_SMALL, "width_13", "single"),
    "shading_unit": (
        "default", "shading_unit", "specular", "power_function", "weight_function",
        "constant_exponent", "constant_weight", "channels", "dot_first_18", "quadratic_spans_18",
        *_SINGLE,
    ),
    "slope_multiplier": ("default", "specular_power_tables", "power_tables_32", "power_tables_128"),
    "small_ram": _SMALL,
    "span_guard": (
        "default", "narrow", "interpolate_x", "interpolate_y", "interpolate_z", "idle_step_bits",
        "idle_material_bits", "idle_x_bits", "idle_y_bits", "constant_shift", *_SINGLE,
    ),
    "span_walker": (
        "default", "control", "narrow", "idle_x_bits", "gouraud 3", "quadratic_spans_18",
        "phong_pipeline",
    ),
    "specular_cosine": ("power_function", "squaring_18", "specular_cosine", "single cosine"),
    "specular_power_tables": (
        "default", "specular_power_tables", "power_bypass", "log_octaves", "constant_exponent",
        "single", "single glow", "power_tables_32", "width_10",
    ),
    "specular_power": ("default", "squaring_18", "schlick_18", "shading_unit", "single"),
    "specular_weight": ("default", "specular_weight", "shading_unit", "width_13"),
    "unnormalized": ("not_normalized", "unnormalized"),
    "versine_of_cross": ("default", "reflection", "dot_first_18", "dot_first_14", "single"),
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


def _files() -> list[Path]:
    """What is mutated: the design and its headers."""
    return [*design.sources(), *design.headers()]


Change = tuple[int, str, str]  # offset, what stands there, what takes its place


@dataclass(frozen=True)
class Mutant:
    """One change: `old` becomes `new` at `offset` of `file`."""

    file: str
    offset: int
    old: str
    new: str
    kind: str  # one of KINDS
    occurrence: int = 1  # number among the mutants that make the same line

    @property
    def path(self) -> Path:
        """The file itself."""
        return next(f for f in _files() if f.name == self.file)

    def text(self) -> str:
        """The file with the change."""
        text = self.path.read_text()
        return text[: self.offset] + self.new + text[self.offset + len(self.old) :]

    @property
    def name(self) -> str:
        """What names it among all: kind, key, and the text that it is a change of."""
        return f"{self.kind} {build.digest(self.path)} {self.key}"

    @property
    def line(self) -> int:
        """Number of its line."""
        return self.path.read_text().count("\n", 0, self.offset) + 1

    @property
    def key(self) -> str:
        """What names it in the table of explained ones: the file and the line as it becomes."""
        line = " ".join(self.text().splitlines()[self.line - 1].split())
        return f"{self.file}: {line}" + (f" #{self.occurrence}" if self.occurrence > 1 else "")


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
            for bit in sorted({0, int(size or 32) - 1}):
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
        if (kind, path.suffix) != ("operator", ".vh")  # sums of latencies: their terms are tried
        for begin, old, new in changes[kind](code)
    ]
    seen: dict[tuple[str, str], int] = {}
    for k, mutant in enumerate(found):
        key = mutant.kind, mutant.key
        count = seen[key] = seen.get(key, 0) + 1
        found[k] = replace(mutant, occurrence=count)
    return found


#: What Verilator makes of each bench of the design as it is, as a hash.
_OWN: dict[str, str] = {}
#: Benches of a file, those first that killed a mutant of it last: its neighbour falls to the same.
_ORDER: dict[str, list[str]] = {}


def _start_worker(number) -> None:
    """A process of its own for one mutant at a time: with its own folder and session."""
    with number.get_lock():
        number.value += 1
        build.BUILD = FOLDER / f"worker{number.value}"
    logging.disable(logging.CRITICAL)
    os.setsid()
    signal.signal(signal.SIGUSR1, lambda *_: None)  # it ends the tools, not this process
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def _benches(file: str) -> list[str]:
    """Names of the benches for `file`: of the small modules "primitives/<module>" has only one."""
    stem, _, suffix = file.rpartition(".")
    found = [
        f"{name}/{stem}" if (name, suffix) == ("primitives", "v") else name
        for name in BENCHES[stem]
    ]
    return list(dict.fromkeys(found))


def judge(name: str, rtl: Path) -> tuple[str, str]:
    """The hash of bench `name` of the design in `rtl`, and why it rejects that; "" if it does not,
    also where it is the very bench of the design as it is."""
    shutil.rmtree(build.BUILD / "sim", ignore_errors=True)
    with Watch(BENCH_SECONDS, lambda: os.killpg(0, signal.SIGUSR1)) as watch:
        made, why = _judge(name, rtl)
    return made, "hangs" if watch.expired else why


def _judge(name: str, rtl: Path) -> tuple[str, str]:
    made = ""
    try:
        if name in TRIALS:
            bench = trial(name).bench(rtl)
        else:
            base, _, small = name.partition("/")
            about = module_bench(base, _MEMORIES if small in _MEMORIES else (small,) * bool(small))
            bench = Bench(about.top, about.config, about.sources, rtl, quick=True)
        made = build.digest(*bench.verilate())
        if made == _OWN.get(name):
            return made, ""
        if name in TRIALS:
            return made, _fails(trial(name).complaint(bench))
        return made, _failing(about, bench, small)
    except BuildError:
        return made, REFUSED
    except (SimulationError, RuntimeError, SystemExit, OSError, ET.ParseError):
        return made, "breaks the simulation"


def _fails(complaint: str) -> str:
    return f"fails: {complaint}" if complaint else ""


def _failing(about: ModuleBench, bench: Bench, small: str) -> str:
    """Which of the cocotb tests of a module bench fails, if any."""
    only = "memory" if small in _MEMORIES else small
    folder = build.BUILD / "run"
    shutil.rmtree(folder, ignore_errors=True)
    results = bench.run(
        about.tests, folder, seed=SEED, test_filter=rf"\.{only}\b" if small else None,
        extra_env=about.environment(folder, SEED),
    )  # fmt: skip
    cases = ET.parse(results).getroot().findall(".//testcase")
    failed = [case.get("name") for case in cases if case.find("failure") is not None]
    return f"fails {failed[0]}" if failed else "" if cases else "runs no test"


def killed_by(mutant: Mutant) -> tuple[str, bool]:
    """The bench that kills `mutant`, and how ("" if none does); whether any differs for it."""
    rtl = build.BUILD / "rtl"
    shutil.rmtree(rtl, ignore_errors=True)
    shutil.copytree(design.RTL, rtl)
    (rtl / mutant.path.relative_to(design.RTL)).write_text(mutant.text())
    order = _ORDER.setdefault(mutant.file, _benches(mutant.file))
    seen = False
    for name in order:
        made, why = judge(name, rtl)
        seen |= made != _OWN[name]
        if why:
            order.remove(name)
            order.insert(0, name)
            return f"{name}: {why}", seen
    return ("lint: complains" if complaint(rtl) else ""), seen


def complaint(rtl: Path) -> str:
    """What Verilator's -Wall says of the whole design in `rtl`, as `make lint` would."""
    command = ["verilator", "--lint-only", "-Wall", "--no-timing", "--top-module", "phong_pipeline"]
    try:
        for config in (DEFAULT, *CONFIGS):
            folders = [build.generate_header(config), *design.folders(rtl)]
            folders = [f"-I{folder}" for folder in folders]
            build.run_tool([*command, *folders, design.SIM / "lint.vlt", rtl / "phong_pipeline.v"])
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


def _outcomes() -> dict[str, str]:
    """{name of a mutant: what killed it, or ""} of all runs so far."""
    return json.loads(OUTCOMES.read_text()) if OUTCOMES.is_file() else {}


def _record(everything: list[Mutant], survivors: list[Mutant], part: str) -> None:
    """Put what was found into the record, file by file, where all mutants of a file have been
    tried; the other files' results stay. A run with `survivors`, or a `part` of one, is refused."""
    known = explained()
    found = (recorded.load("mutate") or {}).get("files", {})
    found = {name: of for name, of in found.items() if name in {file.name for file in _files()}}
    outcomes = _outcomes()
    for file, kind in sorted({(m.file, m.kind) for m in everything}):
        all_of = [m for m in everything if (m.file, m.kind) == (file, kind)]
        ours = [outcomes.get(m.name) for m in all_of if m.key not in known]
        if None in ours:
            continue
        built = sum(why.endswith((REFUSED, "complains")) for why in ours)
        found.setdefault(file, {})[kind] = {
            "mutants": len(all_of), "refused": built, "killed": len(ours) - built - ours.count(""),
            "survived": ours.count(""), "equivalent": len(all_of) - len(ours),
            "date": datetime.date.today().isoformat(), "commit": recorded.commit(),
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
            recorded.Row(
                what,
                f"{add['mutants']} mutants: {add['killed']} fail a test, {add['refused']} the "
                f"lint, {add['equivalent']} are the same hardware, {add['survived']} survive",
                f"`tests/campaigns/equivalent_mutants.txt` says why; {len(of)} files, run on "
                + ", ".join(f"{date} at {commit}" for date, commit in when),
            )
        )
    recorded.record(
        "mutate", "make mutate", ("verilator", "cocotb"), rows,
        failed=bool(survivors), part=part, files=found,
    )  # fmt: skip


def _pool(jobs: int):
    context = multiprocessing.get_context("fork")
    return context.Pool(jobs, _start_worker, (context.Value("i", 0),))


def _know_the_design(used: list[str], jobs: int) -> str:
    """Run all benches in `used` on the design itself; returns a complaint, or "".

    A bench that rejects the design would kill every mutant, and mean nothing.
    """
    build.runtime()  # once, before all need it
    for name in used:
        if name in TRIALS:
            _ = trial(name).expected  # before the workers start, so that all have it
    with _pool(jobs) as workers:
        found = workers.starmap(judge, [(name, design.RTL) for name in used], 1)
    for name, (made, why) in zip(used, found, strict=True):
        if why:
            return f"{name} rejects the design itself: {why}"
        _OWN[name] = made
    return ""


def _campaign(chosen: list[Mutant], jobs: int) -> list[Mutant]:
    """Try all of `chosen`, keeping what comes of each; returns the survivors. Shows progress."""
    survivors: list[Mutant] = []
    tried = _outcomes()
    begin = time.monotonic()
    with _pool(jobs) as workers:
        for done, (why, seen) in enumerate(workers.imap(killed_by, chosen), 1):
            mutant = chosen[done - 1]
            tried[mutant.name] = why
            if not why:
                survivors.append(mutant)
                print(f"SURVIVED {mutant.file}:{mutant.line}: {mutant.old} -> {mutant.new}: "
                      f"{mutant.key.partition(': ')[2]}{'' if seen else ' (no bench differs)'}",
                      flush=True)  # fmt: skip
            left = (time.monotonic() - begin) / done * (len(chosen) - done)
            print(f"{done}/{len(chosen)} mutants, {len(survivors)} survived, "
                  f"{left / 60:.0f} min left; {mutant.file}:{mutant.line} {why or 'survived'}",
                  file=sys.stderr, flush=True)  # fmt: skip
            if done % 50 == 0 or done == len(chosen):
                OUTCOMES.write_text(json.dumps(tried, indent=0))
    return survivors


def _chosen(files: list[str], kind: str | None) -> tuple[list[Mutant], list[Mutant]]:
    """All mutants of `files` (names of modules; all if empty) and of `kind` (both if None); and
    of these the ones that are not explained. Raises InputError."""
    if kind not in (None, *KINDS):
        raise InputError(f"--kind is `{kind}`, not one of {', '.join(KINDS)}")
    by_name = {path.stem: path for path in sorted(_files(), key=lambda file: file.name)}
    for name in files:
        if name not in by_name:
            raise unknown("MODULE", name, by_name)
    known = explained()
    everything = [
        mutant
        for name in files or by_name
        for mutant in mutants(by_name[name], (kind,) if kind else KINDS)
    ]
    if not (files or kind):
        for key in sorted(set(known) - {m.key for m in everything}):
            console.note(f"explained, but no mutant: {key}")
    return everything, [m for m in everything if m.key not in known]


def main(
    modules: Annotated[
        list[str] | None,
        typer.Argument(metavar="MODULE", help="Files of rtl/, without .v; else all."),
    ] = None,
    kind: Annotated[
        str | None,
        typer.Option("--kind", metavar="KIND", help="Mutants of this kind: constant or operator."),
    ] = None,
    sample: Annotated[
        int | None,
        typer.Option("--sample", metavar="N", help="So many mutants at random.", min=0),
    ] = None,
    jobs: Annotated[
        int, typer.Option("--jobs", metavar="N", help="Mutants at a time.", min=1)
    ] = os.cpu_count() or 1,
    again: Annotated[
        bool, typer.Option("--again", help="Not those that were killed and did not change.")
    ] = False,
    show: Annotated[bool, typer.Option("--list", help="Show the mutants, run nothing.")] = False,
    record: options.Record = False,
) -> int:
    """Change each constant and operator of rtl/ and run the tests; every change must fail one."""
    recorded.check(record)
    everything, chosen = _chosen(modules or [], kind)
    if again:
        tried = _outcomes()
        chosen = [m for m in chosen if not tried.get(m.name)]
    if sample is not None:
        chosen = random.Random(SEED).sample(chosen, min(sample, len(chosen)))
    if show:
        for m in chosen:
            console.say(f"{m.file}:{m.line}: {m.old} -> {m.new}: {m.key.partition(': ')[2]}")
        console.say(f"{len(chosen)} mutants, {len(everything) - len(chosen)} left out")
        return console.GOOD

    os.environ["COCOTB_MAX_FAILURES"] = "1"
    used = list(dict.fromkeys(name for m in chosen for name in _benches(m.file)))
    if complaint := _know_the_design(used, jobs):
        raise InputError(complaint)
    survivors = _campaign(chosen, jobs)
    if record:
        _record(everything, survivors, "only a sample was tried" if sample is not None else "")
    console.say(
        f"{len(chosen)} mutants, {len(chosen) - len(survivors)} killed, "
        f"{len(survivors)} survived; {len(everything) - len(chosen)} left out or explained"
    )
    return console.FAILED if survivors else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "mutate"))
