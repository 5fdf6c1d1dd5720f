# SPDX-License-Identifier: MIT
"""The module tests in Icarus Verilog, which simulates 0, 1, X and Z: `make icarus`.

Exit code: 0; 1 if a test fails; 2 if Icarus Verilog is missing or rejects a bench.
"""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import time
from typing import Annotated

import typer

from phong75.scripts import console, options, recorded
from phong75.scripts.configurations import unknown
from phong75.scripts.main import single
from phong75.sim import environment
from phong75.sim.design import BUILD
from phong75.sim.icarus import THIN, IcarusBench
from phong75.sim.results import read_results
from tests.modules.benches import NAMES, module_bench

SEED = 75


def run(name: str) -> tuple[int, list[str]]:
    """Run the bench `name`; returns the number of its tests and the failures, one message each.

    Raises BuildError.
    """
    bench = module_bench(name)
    folder = BUILD / "icarus" / "run" / name
    begin = time.monotonic()
    IcarusBench(bench.top, bench.config, bench.sources).run(
        bench.tests, folder, seed=SEED, extra_env=bench.environment(folder, SEED)
    )
    results = read_results(folder)
    seconds = time.monotonic() - begin
    verdict = "failed" if results.failures else "passed"
    console.say(f"{name}: {len(results.tests)} tests {verdict}, {seconds:.0f} s")
    return len(results.tests), [f"{name}: {failure}" for failure in results.failures]


def main(
    benches: Annotated[
        list[str] | None, typer.Argument(metavar="BENCH", help="Names of benches; else all.")
    ] = None,
    record: options.Record = False,
) -> int:
    """Run the module tests in Icarus Verilog, with X in every register at power-up (minutes)."""
    recorded.check(record)
    for name in benches or []:
        if name not in NAMES:
            raise unknown("BENCH", name, NAMES)
    logging.disable(logging.CRITICAL)
    os.environ[environment.THIN] = str(THIN)
    total, failures = 0, []
    for name in benches or NAMES:
        console.phase(name)
        count, messages = run(name)
        total += count
        failures += messages
    for line in failures:
        console.failure(line)
    console.say(f"{total} tests in Icarus Verilog, {len(failures)} failures")
    if record:
        version = subprocess.run(["iverilog", "-V"], text=True, capture_output=True).stdout
        recorded.record(
            "icarus", "make icarus", ("cocotb",),
            {"tests": total, "complaints": len(failures), "icarus_version": version.split()[3],
             "one_vector_in": THIN},
            failed=bool(failures), part="only some benches were run" if benches else "",
        )  # fmt: skip
    return console.FAILED if failures else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "icarus"))
