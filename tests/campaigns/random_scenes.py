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

from rich.console import Console
from rich.progress import track

from phong75.scripts import recorded
from phong75.sim.build import BuildError, runtime
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


def main(argv: list[str]) -> int:
    """Run as many scenes as `argv` says; returns the exit code."""
    wanted = argv[0] if argv else "200"
    if not (wanted.isascii() and wanted.isdigit() and 1 <= int(wanted) <= MOST):
        print(f"Error: SCENES is `{wanted}`, not a number from 1 to {MOST}", file=sys.stderr)
        return 2
    runtime()  # once, before all need it
    seeds = range(SEED, SEED + int(wanted))
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        tried = track(
            pool.imap(attempt, seeds), "random scenes", len(seeds), console=Console(stderr=True)
        )
        found = list(tried)
    wrong = [f"seed {seed}: {said}" for seed, (said, *_) in zip(seeds, found, strict=True) if said]
    for line in wrong:
        print(line, file=sys.stderr)
    pixels, builds = sum(p for _, p, _ in found), len({build for *_, build in found})
    print(f"{len(found)} scenes, {builds} builds, {pixels} pixels, {len(wrong)} complaints")
    recorded.save(
        "prune-random", "make prune-random", ("verilator", "numpy"),
        {"scenes": len(found), "builds": builds, "pixels": pixels, "complaints": len(wrong)},
        effort={"scenes": len(found)},
    )  # fmt: skip
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
