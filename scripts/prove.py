# SPDX-License-Identifier: MIT
"""Bounds of the error that a machine has checked: `phong75 prove`.

Exhausts 1/sqrt and cos(s)**n, then bounds the error of every input by branch and bound
(model/analysis/certificate.py). Prints, for each family of inputs, the worst input found and the
certified bound. Exit code: 0; 1 if a certified bound is more than `RATIO` times the worst input
found in the default configuration; 2.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict
from pathlib import Path

from rich.table import Table

from phong75.model.analysis import certificate, exhausted
from phong75.model.analysis.certificate import ErrorBound
from phong75.model.analysis.exhausted import Stages
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import InputError
from phong75.model.studies import adversarial
from phong75.model.studies.methods import CONFIGS
from phong75.scripts import console, recorded
from phong75.scripts.console import Steps
from phong75.scripts.docs.tables import above
from phong75.sim import build, power_errors
from phong75.sim.design import BUILD
from phong75.sim.power_errors import PowerRow

#: A certified bound is at most this many times the worst input found.
RATIO = 1.05

#: How far a certified bound may be above the bound of a single input, LSB.
GAP = 0.003

#: The methods beside the default that are certified: those with its words and its powers.
METHODS = (
    "dot_first_18", "table_2048", "lines_32", "parabolas_8", "table_128_newton", "fast_inverse_1",
    "fast_inverse_2",
)  # fmt: skip

#: The same as GAP, for the methods.
METHOD_GAP = 0.01

#: What a certificate depends on beside its job.
SOURCES = (Path(certificate.__file__), Path(exhausted.__file__))

#: n of each search: from the limit of the family before to that of its own.
RANGES = tuple(zip((1, *adversarial.LIMITS), adversarial.LIMITS, strict=False))


def power_rows(config: Config, again: bool, done: Callable[[float], None]) -> list[PowerRow]:
    """The errors of cos(s)**n: those of the record, if they are of the tables of `config`, unless
    they are wanted `again`. Raises BuildError."""
    kept = recorded.figures("prove")
    if not again and kept.get("power_digest") == exhausted.power_digest(config):
        console.note("the errors of cos(s)^n are those of results/prove.json; --again: anew")
        return [PowerRow(**row) for row in kept["power"]]
    return power_errors.rows(config, again=again, done=done)


def stages(config: Config, rows: list[PowerRow]) -> Stages:
    """The exhausted stages of `config`; rows: those of `power_rows`."""
    return Stages(exhausted.root_errors(config), {row.whole: row.bounds() for row in rows})


def search(job: tuple[Config, Stages, bool, float, float, float]) -> dict | None:
    """The certificate, as a dict, of a `job`: configuration, stages, steep, n from and to, gap;
    None if there is none. For a process of its own. The build folder keeps it, so that a run that
    was stopped goes on from there."""
    config, found, steep, least, most, gap = job
    kept = BUILD / "prove" / f"{build.digest(repr(job), *SOURCES)}.json"
    if not kept.is_file():
        bound = ErrorBound(config, found, steep)
        try:
            result = asdict(certificate.certify(bound, config, least, most, gap))
        except certificate.NoBoundError:
            result = None
        build.replace(kept, json.dumps(result))
    return json.loads(kept.read_text())


def families(config: Config, found: Stages, gap: float) -> list[dict]:
    """A row a family of inputs: worst input found in the default configuration, certified bound
    (None if there is none) and the searches behind it."""
    jobs = [(config, found, steep, *n, gap) for steep in (False, True) for n in RANGES]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        results = dict(zip([job[2:5] for job in jobs], pool.map(search, jobs), strict=True))
    reached = {(row["limit"], row["steep"]): row["error_lsb"] for row in adversarial.kept()}
    rows = []
    for family in adversarial.FAMILIES:
        ranges = [n for n in RANGES if n[1] <= family.limit]
        searches = [results[family.steep, *n] for n in ranges]
        bounds = [found["bound_lsb"] for found in searches if found]
        rows.append({
            "family": family.name, "limit": family.limit, "steep": family.steep,
            "reached_lsb": reached[family.limit, family.steep],
            "certified_lsb": max(bounds) if len(bounds) == len(ranges) else None,
            "boxes": sum(found["boxes"] for found in searches if found),
            "search": searches[-1],
        })  # fmt: skip
    return rows


def method_rows(rows: list[PowerRow]) -> list[dict]:
    """A row for each of METHODS: the certified bounds for n <= 128, LSB, for a constant W and for
    any; None if there is none. rows: those of `power_rows`."""
    limit = float(adversarial.LIMITS[-1])
    jobs = [
        (CONFIGS[name], stages(CONFIGS[name], rows), steep, 1.0, limit, METHOD_GAP)
        for name in METHODS
        for steep in (False, True)
    ]
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        bounds = [found and found["bound_lsb"] for found in pool.map(search, jobs)]
    return [
        {"name": name, "constant_lsb": bounds[2 * k], "any_lsb": bounds[2 * k + 1]}
        for k, name in enumerate(METHODS)
    ]


def methods_table(rows: list[dict]) -> Table:
    """`rows` of `method_rows` for the terminal."""
    out = Table(title="certified for n ≤ 128, LSB", title_style="bold")
    for title in ("method", "W constant", "any W"):
        out.add_column(title, justify="left" if title == "method" else "right")
    for row in rows:
        bounds = (row["constant_lsb"], row["any_lsb"])
        out.add_row(row["name"], *(above(b, 4) if b else "–" for b in bounds))
    return out


def methods(record: bool) -> int:
    """Certify METHODS, print; returns the exit code. Raises InputError, BuildError."""
    recorded.check(record)
    steps = Steps()
    with steps.step("powers", "every power cos(s)^n") as step:
        powers = power_rows(DEFAULT, False, step.done)
    with steps.step("inputs", "all inputs of each method, by branch and bound"):
        rows = method_rows(powers)
    console.show(methods_table(rows))
    seen = {row["name"]: row for row in recorded.figures("stability")["methods"]}
    failures = [
        f"{row['name']}: {seen[row['name']]['max_lsb']:.4f} LSB is seen, {row['any_lsb']:.4f} is "
        "certified"
        for row in rows if row["any_lsb"] and row["any_lsb"] < seen[row["name"]]["max_lsb"]
    ]  # fmt: skip
    if record:
        recorded.record(
            "prove-methods", "make prove METHODS=1", ("python-flint", "numpy"), {"methods": rows},
            {"methods": len(rows)}, failed=bool(failures),
        )  # fmt: skip
    for line in failures:
        console.failure(line)
    return console.FAILED if failures else console.GOOD


def beyond(rows: list[dict]) -> list[str]:
    """What is wrong with `rows` of `families`, a line each."""
    lines = []
    for row in rows:
        most = RATIO * row["reached_lsb"]
        if row["certified_lsb"] is None:
            lines.append(f"{row['family']}: no bound is certified")
        elif row["certified_lsb"] > most:
            lines.append(
                f"{row['family']}: {row['certified_lsb']:.4f} LSB is certified, more than "
                f"{most:.4f}, {RATIO} times the worst input found"
            )
    return lines


def table(rows: list[dict]) -> Table:
    """`rows` of `families` for the terminal."""
    out = Table(title="largest error of a colour code, LSB", title_style="bold")
    for title in ("inputs", "worst found", "", "certified", "ratio", "boxes"):
        out.add_column(title, justify="left" if title in ("inputs", "") else "right")
    for row in rows:
        certified, reached = row["certified_lsb"], row["reached_lsb"]
        out.add_row(
            row["family"], f"{reached:.4f}", "≤", above(certified, 4) if certified else "–",
            above(certified / reached, 3) if certified else "–", f"{row['boxes']}",
        )  # fmt: skip
    return out


def main(config: Config, again: bool, record: bool) -> int:
    """Exhaust, search, print; returns the exit code. Raises InputError, BuildError."""
    recorded.check(record)
    try:
        certificate.check(config)
    except ValueError as error:
        raise InputError(f"{config.name}: {error}") from None
    steps = Steps()
    with steps.step("powers", "every power cos(s)^n") as step:
        powers = power_rows(config, again, step.done)
    with steps.step("roots", "every root"):
        found = stages(config, powers)
    with steps.step("inputs", "all inputs, by branch and bound"):
        rows = families(config, found, GAP)
    low, high = found.root
    pairs = sum(row.pairs for row in powers)
    console.say(f"1/sqrt, every operand: relative error {low:.3e} to {high:.3e}")
    console.say(
        f"cos(s)^n, {pairs:,} pairs of codes: error ".replace(",", " ")
        + f"{min(row.least for row in powers):.3e} to {max(row.greatest for row in powers):.3e}"
    )
    console.show(table(rows))
    failures = beyond(rows)
    if record:
        recorded.record(
            "prove", "make prove", ("python-flint", "numpy"),
            {
                "config": config.name, "power_digest": exhausted.power_digest(config),
                "root": found.root, "power": [asdict(row) for row in powers], "families": rows,
            },
            {"pairs": pairs}, failed=bool(failures),
            part="" if config.name == "default" else f"it is for {config.name}",
        )  # fmt: skip
    for line in failures:
        console.failure(line)
    return console.FAILED if failures else console.GOOD
