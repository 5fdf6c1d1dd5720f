# SPDX-License-Identifier: MIT
"""Mutation testing of rtl/: `make mutate`, or `python -m tests.campaigns.mutation --help`.

A mutant is a copy of the design with one change. There are two kinds of mutants:

- constant: a hand-written number plus or minus one; in a sized literal the lowest or the highest
  bit is flipped.
- operator: an operator is replaced by a similar one, a condition is negated, the branches of a
  conditional operator are swapped, or a register keeps its value.

Each mutant runs through the module benches and configuration tests that contain the changed module
(`relevant_benches`). A mutant is killed if a bench does not build without warnings, a test fails or
the simulation hangs. A bench is not run if Verilator generates the same program for the mutant as
for the design. Survivors are printed with file and line. tests/campaigns/equivalent_mutants.txt
lists mutants that behave like the design, with the reasons; these are not run.

Exit code: 0; 1 if a mutant survived; 2 if the command line is wrong.
"""

from __future__ import annotations

import datetime
import itertools
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
from phong75.sim.results import read_results
from tests.campaigns.relevant_benches import relevant_benches
from tests.configuration_tests import CONFIGURATION_TESTS, configuration_test
from tests.modules.benches import ModuleBench, module_bench

EXPLAINED = Path(__file__).with_name("equivalent_mutants.txt")
FOLDER = design.BUILD / "mutants"
OUTCOMES = FOLDER / "outcomes.json"
SEED = 75
KINDS = ("constant", "operator")

#: Limit of the processor time of a bench, compilation and simulation together, seconds.
BENCH_SECONDS = 60

#: Limit of a worker's memory, bytes: for some mutants Verilator unrolls an endless loop.
MEMORY = 4 << 30

#: Reasons of mutants that are killed without a simulation: Verilator or the compiler rejects the
#: bench; or all benches accept the mutant, but Verilator's lint has a warning.
REFUSED, LINT = "does not build", "lint: warning"

#: Results of the benches on the design itself: one JSON file per bench, [hash, reason].
DESIGN_RESULTS = FOLDER / "design"

_COMMENT = re.compile(r"//[^\n]*|/\*.*?\*/|\"[^\"\n]*\"", re.DOTALL)
_UNUSED = re.compile(r"\bwire unused\w* = [^;]*;")  # no hardware: collects unused bits for the lint
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
    """The files that are mutated: the design and its hand-written headers."""
    return [*design.sources(), *design.headers()]


#: (offset in the file, old text, new text).
Change = tuple[int, str, str]


@dataclass(frozen=True)
class Mutant:
    """One change: at `offset` of `file` the text `old` becomes `new`.

    kind: one of KINDS. occurrence: number among the mutants of the file that give the same line.
    """

    file: str
    offset: int
    old: str
    new: str
    kind: str
    occurrence: int = 1

    @property
    def path(self) -> Path:
        """The file of the design."""
        return next(f for f in _files() if f.name == self.file)

    def text(self) -> str:
        """The text of the file with the change."""
        text = self.path.read_text()
        return text[: self.offset] + self.new + text[self.offset + len(self.old) :]

    @property
    def name(self) -> str:
        """Unique name for OUTCOMES: the kind, the hash of the unchanged file and the key."""
        return f"{self.kind} {build.digest(self.path)} {self.key}"

    @property
    def line(self) -> int:
        """Number of the changed line."""
        return self.path.read_text().count("\n", 0, self.offset) + 1

    @property
    def key(self) -> str:
        """The name in the table of equivalent mutants: the file and the changed line."""
        line = " ".join(self.text().splitlines()[self.line - 1].split())
        return f"{self.file}: {line}" + (f" #{self.occurrence}" if self.occurrence > 1 else "")


def _blank(pattern: re.Pattern, code: str) -> str:
    """`code` with spaces in place of what `pattern` matches, so that offsets stay the same."""
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m.group()), code)


def _constants(code: str) -> Iterator[Change]:
    """Changes of every hand-written constant: see the module's docstring."""
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
    """Offset of the first of `stops` after `begin`, outside of brackets opened after `begin`."""
    depth = 0
    for k in range(begin, len(code)):
        if depth == 0 and code[k] in stops:
            return k
        depth += (code[k] in "([{") - (code[k] in ")]}")
    raise ValueError(f"no {stops} after offset {begin}")


def _operators(code: str) -> Iterator[Change]:
    """Changes of operators, conditions and assignments: see the module's docstring."""
    code = _blank(_DECLARATION, code)
    inside = _blank(_RANGE, code)  # changes of ranges are covered by the constants
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
    """All mutants of the `kinds` of the file `path`."""
    text = path.read_text()
    code = _blank(_UNUSED, _blank(_COMMENT, text))
    changes = {"constant": _constants, "operator": _operators}
    result = [
        Mutant(path.name, begin, text[begin : begin + len(old)], new, kind)
        for kind in kinds
        # Headers contain sums of latencies; changes of their terms are enough.
        if (kind, path.suffix) != ("operator", ".vh")
        for begin, old, new in changes[kind](code)
    ]
    seen: dict[tuple[str, str], int] = {}
    for k, mutant in enumerate(result):
        key = mutant.kind, mutant.key
        count = seen[key] = seen.get(key, 0) + 1
        result[k] = replace(mutant, occurrence=count)
    return result


#: {bench: hash of the program that Verilator generates for the design itself}, per worker.
_PROGRAMS: dict[str, str] = {}

#: {file: benches that killed mutants of it, the last one first}, per worker. The next mutant of the
#: file is often killed by the same bench.
_KILLERS: dict[str, list[str]] = {}


class RejectedDesignError(Exception):
    """A bench fails on the design itself, so that it would kill every mutant."""


def _start_worker(number) -> None:
    """Prepare a worker process, which runs one mutant at a time: its own folder and session."""
    with number.get_lock():
        number.value += 1
        build.BUILD = FOLDER / f"worker{number.value}"
    logging.disable(logging.CRITICAL)
    os.setsid()
    signal.signal(signal.SIGUSR1, lambda *_: None)  # ends the tools, not this process
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def judge(name: str, rtl: Path) -> tuple[str, str]:
    """Run the bench `name` on the design in `rtl`, within BENCH_SECONDS of processor time.

    Returns (program, reason). program: hash of the program that Verilator generates, "" if it
    generates none. reason: why the bench rejects the design, "" if it accepts the design. A program
    that is the same as for the design itself is accepted without a run.
    """
    shutil.rmtree(build.BUILD / "sim", ignore_errors=True)
    with Watch(BENCH_SECONDS, lambda: os.killpg(0, signal.SIGUSR1)) as watch:
        program, reason = _judge(name, rtl)
    return program, "hangs" if watch.expired else reason


def _judge(name: str, rtl: Path) -> tuple[str, str]:
    program = ""
    try:
        module = None if name in CONFIGURATION_TESTS else module_bench(name)
        if module:
            bench = Bench(module.top, module.config, module.sources, rtl, quick=True)
        else:
            bench = configuration_test(name).bench(rtl)
        program = build.digest(*bench.verilate())
        if program == _PROGRAMS.get(name):
            return program, ""
        if module:
            failure = _failure(module, bench)
        else:
            failure = configuration_test(name).failure(bench)
        return program, f"fails: {failure}" if failure else ""
    except BuildError:
        return program, REFUSED
    except (SimulationError, RuntimeError, SystemExit, OSError):
        return program, "breaks the simulation"


def _failure(module: ModuleBench, bench: Bench) -> str:
    """The first failed cocotb test of a module bench, "" if all tests pass."""
    folder = build.BUILD / "run"
    shutil.rmtree(folder, ignore_errors=True)
    bench.run(
        module.tests, folder, seed=SEED, test_filter=module.test_filter,
        extra_env=module.environment(folder, SEED),
    )  # fmt: skip
    return next(iter(read_results(folder).failures), "")


def _program(name: str) -> str:
    """The hash of the bench `name` for the design itself, which the bench must accept.

    The first worker that needs the bench runs it; the others read the result from a file. Raises
    RejectedDesignError.
    """
    if name not in _PROGRAMS:
        file = DESIGN_RESULTS / f"{name.replace('/', '.')}.json"
        with build.locked(file):
            if not file.is_file():
                file.write_text(json.dumps(judge(name, design.RTL)))
        program, reason = json.loads(file.read_text())
        if reason:
            raise RejectedDesignError(f"{name} rejects the design itself: {reason}")
        _PROGRAMS[name] = program
    return _PROGRAMS[name]


def killed_by(mutant: Mutant) -> tuple[str, bool]:
    """Run `mutant` through its relevant benches; returns (reason, differs).

    reason: the bench that kills the mutant, and how; "" if the mutant survives. differs: whether
    the program of any bench differs from that of the design. Raises RejectedDesignError.
    """
    rtl = build.BUILD / "rtl"
    shutil.rmtree(rtl, ignore_errors=True)
    shutil.copytree(design.RTL, rtl)
    (rtl / mutant.path.relative_to(design.RTL)).write_text(mutant.text())
    killers = _KILLERS.setdefault(mutant.file, [])
    tried: set[str] = set()
    differs = False
    for name in itertools.chain(list(killers), relevant_benches(mutant.path)):
        if name in tried:
            continue
        tried.add(name)
        own_program = _program(name)
        program, reason = judge(name, rtl)
        differs |= program != own_program
        if reason:
            if name in killers:
                killers.remove(name)
            killers.insert(0, name)
            return f"{name}: {reason}", differs
    return (LINT if lint_message(rtl) else ""), differs


def lint_message(rtl: Path) -> str:
    """Output of Verilator's -Wall for the whole design in `rtl`, as in `make lint`; "" if none."""
    command = [
        build.VERILATOR,
        "--lint-only",
        "-Wall",
        "--no-timing",
        "--top-module",
        "phong_pipeline",
    ]
    try:
        for config in (DEFAULT, *CONFIGS):
            folders = [build.generate_header(config), *design.folders(rtl)]
            folders = [f"-I{folder}" for folder in folders]
            build.run_tool([*command, *folders, design.SIM / "lint.vlt", rtl / "phong_pipeline.v"])
    except BuildError as error:
        return str(error)
    return ""


def explained() -> dict[str, str]:
    """{key of an equivalent mutant: reason}, from equivalent_mutants.txt.

    In the file the key is a line of its own; the lines of the reason are indented.
    """
    table, key = {}, ""
    for line in EXPLAINED.read_text().splitlines():
        if line.startswith(" ") and key:
            table[key] = f"{table[key]} {line.strip()}".strip()
        elif line.strip() and not line.startswith("#"):
            key = line.strip()
            table[key] = ""
    return table


def _outcomes() -> dict[str, str]:
    """{name of a mutant: reason why it was killed, or ""} of all runs so far."""
    return json.loads(OUTCOMES.read_text()) if OUTCOMES.is_file() else {}


def _record(everything: list[Mutant], survivors: list[Mutant], part: str) -> None:
    """Record the counts of each file and kind of which all mutants have been run.

    The counts of other files stay. `recorded.record` refuses a run with `survivors` and a partial
    run (`part` says why it is partial).
    """
    known = explained()
    names = {file.name for file in _files()}
    files = recorded.figures("mutate").get("files", {})
    files = {name: kinds for name, kinds in files.items() if name in names}
    outcomes = _outcomes()
    for file, kind in sorted({(m.file, m.kind) for m in everything}):
        group = [m for m in everything if (m.file, m.kind) == (file, kind)]
        reasons = [outcomes.get(m.name) for m in group if m.key not in known]
        if None in reasons:
            continue
        refused = sum(reason.endswith((REFUSED, LINT)) for reason in reasons)
        survived = reasons.count("")
        files.setdefault(file, {})[kind] = {
            "mutants": len(group), "refused": refused,
            "killed": len(reasons) - refused - survived, "survived": survived,
            "equivalent": len(group) - len(reasons),
            "date": datetime.date.today().isoformat(), "commit": recorded.commit(),
        }  # fmt: skip
    recorded.record(
        "mutate", "make mutate", ("verilator", "cocotb"), {"files": files},
        failed=bool(survivors), part=part,
    )  # fmt: skip


def _pool(jobs: int):
    context = multiprocessing.get_context("fork")
    return context.Pool(jobs, _start_worker, (context.Value("i", 0),))


def _campaign(chosen: list[Mutant], jobs: int) -> list[Mutant]:
    """Run all `chosen` mutants, show the progress and record the outcomes; returns the survivors.

    Raises RejectedDesignError, BuildError.
    """
    survivors: list[Mutant] = []
    if not chosen:
        return survivors
    tried = _outcomes()
    shutil.rmtree(DESIGN_RESULTS, ignore_errors=True)
    console.phase("compiling Verilator's runtime (once)")
    build.runtime()  # before the workers start, which all need it
    begin = time.monotonic()
    with _pool(jobs) as workers:
        for done, (reason, differs) in enumerate(workers.imap(killed_by, chosen), 1):
            mutant = chosen[done - 1]
            tried[mutant.name] = reason
            if not reason:
                survivors.append(mutant)
                print(f"SURVIVED {mutant.file}:{mutant.line}: {mutant.old} -> {mutant.new}: "
                      f"{mutant.key.partition(': ')[2]}{'' if differs else ' (no bench differs)'}",
                      flush=True)  # fmt: skip
            left = (time.monotonic() - begin) / done * (len(chosen) - done)
            print(f"{done}/{len(chosen)} mutants, {len(survivors)} survived, "
                  f"{left / 60:.0f} min left; {mutant.file}:{mutant.line} {reason or 'survived'}",
                  file=sys.stderr, flush=True)  # fmt: skip
            if done % 50 == 0 or done == len(chosen):
                OUTCOMES.write_text(json.dumps(tried, indent=0))
    return survivors


def _chosen(files: list[str], kind: str | None) -> tuple[list[Mutant], list[Mutant]]:
    """All mutants of `files` and `kind`, and those among them that are not listed as equivalent.

    files: names of modules or headers, empty for all. kind: one of KINDS, None for both. Raises
    InputError.
    """
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
            console.note(f"in {EXPLAINED.name}, but not a mutant: {key}")
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
        console.say(f"{len(chosen)} mutants, {len(everything) - len(chosen)} not chosen")
        return console.GOOD

    os.environ["COCOTB_MAX_FAILURES"] = "1"
    try:
        survivors = _campaign(chosen, jobs)
    except RejectedDesignError as error:
        raise InputError(str(error)) from None
    if record:
        _record(everything, survivors, "only a sample was tried" if sample is not None else "")
    console.say(
        f"{len(chosen)} mutants, {len(chosen) - len(survivors)} killed, "
        f"{len(survivors)} survived; {len(everything) - len(chosen)} equivalent or not chosen"
    )
    return console.FAILED if survivors else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "mutate"))
