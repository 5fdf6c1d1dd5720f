# SPDX-License-Identifier: MIT
"""Random scenes, each on the build that is pruned to the scene: `make prune-random SCENES=200`.

Exit code: 0; 1 if a pixel, a counter or the latency differs from what is expected; 2 if the command
line is wrong.
"""

from __future__ import annotations

import multiprocessing
import os
import shutil
import sys
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track

from phong75.scripts import console, options, recorded
from phong75.scripts.main import single
from phong75.sim.build import BuildError, runtime, runtime_built
from phong75.sim.frame.run_frame import SimulationError
from tests.configuration_tests import SEED, random_configuration_test

MOST = 100_000


def attempt(seed: int) -> tuple[str, int, tuple]:
    """Run random scene `seed`; returns (failure, pixels, configuration).

    failure: a message, "" if the scene passes. pixels: number of pixels. configuration: all fields
    of the build, to count different builds.
    """
    test = random_configuration_test(seed)
    bench = test.bench()
    frame = test.jobs[0].frame
    try:
        failure = test.model_failure() or test.failure(bench)
    except (BuildError, SimulationError) as error:
        failure = str(error).splitlines()[0]
    shutil.rmtree(bench.folder, ignore_errors=True)  # hardly any build is needed twice
    fields = {**test.config.as_dict(), "name": ""}.items()
    return failure, int(frame.spans["length"].sum()), tuple(map(str, fields))


def main(
    scenes: Annotated[
        int,
        typer.Option(
            "--scenes",
            metavar="N",
            help="How many random scenes.",
            parser=lambda text: options.parse_count("--scenes", text, 0, MOST),
        ),
    ] = 200,
    record: options.Record = False,
) -> int:
    """Run random scenes, each on the build that is pruned to it (minutes)."""
    recorded.check(record)
    if scenes and not runtime_built():
        console.phase("compiling Verilator's runtime (once)")
    runtime()  # before the workers start, which all need it
    seeds = range(SEED, SEED + scenes)
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        results = list(
            track(
                pool.imap(attempt, seeds), "random scenes", len(seeds), console=Console(stderr=True)
            )
        )
    failures = [f"seed {s}: {text}" for s, (text, *_) in zip(seeds, results, strict=True) if text]
    for message in failures:
        console.failure(message)
    pixels, builds = sum(p for _, p, _ in results), len({build for *_, build in results})
    console.say(
        f"{len(results)} scenes, {builds} builds, {pixels} pixels, {len(failures)} failures"
    )
    if record:
        recorded.record(
            "prune-random", "make prune-random", ("verilator", "numpy"),
            {"scenes": len(results), "builds": builds, "pixels": pixels,
             "complaints": len(failures)},
            {"scenes": scenes}, failed=bool(failures),
        )  # fmt: skip
    return console.FAILED if failures else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "prune-random"))
