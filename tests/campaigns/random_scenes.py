# SPDX-License-Identifier: MIT
"""Random scenes, each on the build that is pruned to it: `make prune-random SCENES=200`.

Exit code: 0; 1 if a pixel, a count or the latency is not the full design's; 2 if the number is
none.
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
    """What is wrong with random scene `seed` ("": nothing), its pixels, the features left out."""
    found = random_configuration_test(seed)
    bench = found.bench()
    frame = found.jobs[0].frame
    try:
        said = found.model_failure() or found.failure(bench)
    except (BuildError, SimulationError) as error:
        said = str(error).splitlines()[0]
    shutil.rmtree(bench.folder, ignore_errors=True)  # nobody will run this build again
    left = {**found.config.as_dict(), "name": ""}.items()
    return said, int(frame.spans["length"].sum()), tuple(map(str, left))


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
    runtime()  # once, before all need it
    seeds = range(SEED, SEED + scenes)
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        tried = track(
            pool.imap(attempt, seeds), "random scenes", len(seeds), console=Console(stderr=True)
        )
        found = list(tried)
    wrong = [f"seed {s}: {text}" for s, (text, *_) in zip(seeds, found, strict=True) if text]
    for line in wrong:
        console.failure(line)
    pixels, builds = sum(p for _, p, _ in found), len({build for *_, build in found})
    console.say(f"{len(found)} scenes, {builds} builds, {pixels} pixels, {len(wrong)} complaints")
    if record:
        recorded.record(
            "prune-random", "make prune-random", ("verilator", "numpy"),
            {"scenes": len(found), "builds": builds, "pixels": pixels, "complaints": len(wrong)},
            {"scenes": scenes}, failed=bool(wrong),
        )  # fmt: skip
    return console.FAILED if wrong else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "prune-random"))
