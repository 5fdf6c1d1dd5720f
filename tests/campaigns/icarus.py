# SPDX-License-Identifier: MIT
"""The module tests once more, in Icarus Verilog with its four states: `make icarus`.

Exit code: 0; 1 if a test fails; 2 if Icarus is missing or refuses a bench.
"""

from __future__ import annotations

import logging
import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ET
from typing import Annotated

import typer

from phong75.scripts import console, options, recorded
from phong75.scripts.configurations import unknown
from phong75.scripts.main import single
from phong75.sim import environment
from phong75.sim.design import BUILD
from phong75.sim.icarus import THIN, IcarusBench
from tests.modules.benches import NAMES, module_bench

SEED = 75


def run(name: str) -> tuple[int, list[str]]:
    """Run bench `name`: number of its tests; what is wrong, a line each. Raises BuildError."""
    bench = module_bench(name)
    folder = BUILD / "icarus" / "run" / name
    begin = time.monotonic()
    results = IcarusBench(bench.top, bench.config, bench.sources).run(
        bench.tests, folder, seed=SEED, extra_env=bench.environment(folder, SEED)
    )
    cases = ET.parse(results).getroot().findall(".//testcase")
    failed = [case for case in cases if case.find("failure") is not None]
    complaints = [f"{name}: {case.get('name')}" for case in failed]
    if failed:
        log = (folder / "sim.log").read_text()
        complaints += re.findall(r"(?:AssertionError|ValueError): .*", log)
    if not cases:
        complaints.append(f"{name}: no test ran ({folder / 'sim.log'})")
    seconds = time.monotonic() - begin
    console.say(f"{name}: {len(cases)} tests, {len(failed)} failed, {seconds:.0f} s")
    return len(cases), complaints


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
        count, complaints = run(name)
        total += count
        failures += complaints
    for line in failures:
        console.failure(line)
    console.say(f"{total} tests in four states, {len(failures)} complaints")
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
