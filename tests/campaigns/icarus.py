"""The module tests once more, in Icarus Verilog with its four states: `make icarus`.

Arguments: names of benches (see sim/benches.py), else all. Exit code: 0; 1 if a test fails; 2 if
Icarus is missing or refuses a bench.
"""

from __future__ import annotations

import logging
import os
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as ET

from rich.console import Console

from phong75.scripts import recorded
from phong75.scripts.recorded import Row
from phong75.sim import environment
from phong75.sim.build import BuildError
from phong75.sim.design import BUILD
from phong75.sim.icarus import THIN, IcarusBench
from tests.modules.benches import NAMES, module_bench

SEED = 75


def main(argv: list[str]) -> int:
    """Run the benches `argv`; returns the exit code."""
    wrong = set(argv) - set(NAMES)
    if wrong:
        print(f"no such bench: {' '.join(wrong)}; there are {' '.join(NAMES)}", file=sys.stderr)
        return 2
    logging.disable(logging.CRITICAL)
    os.environ[environment.THIN] = str(THIN)
    console = Console(stderr=True)
    total, failures = 0, []
    for name in argv or NAMES:
        console.print(f"{name} ...")
        about = module_bench(name)
        folder = BUILD / "icarus" / "run" / name
        begin = time.monotonic()
        try:
            results = IcarusBench(about.top, about.config, about.sources).run(
                about.tests, folder, seed=SEED,
                extra_env=about.environment(folder, SEED),
            )  # fmt: skip
        except BuildError as error:
            print(error, file=sys.stderr)
            return 2
        cases = ET.parse(results).getroot().findall(".//testcase")
        failed = [case for case in cases if case.find("failure") is not None]
        total += len(cases)
        said = re.findall(r"(?:AssertionError|ValueError): .*", (folder / "sim.log").read_text())
        failures += [f"{name}: {case.get('name')}" for case in failed] + (said if failed else [])
        if not cases:
            failures.append(f"{name}: no test ran ({folder / 'sim.log'})")
        print(f"{name}: {len(cases)} tests, {len(failed)} failed, {time.monotonic() - begin:.0f} s")
    for line in failures:
        print(line, file=sys.stderr)
    print(f"{total} tests in four states, {len(failures)} complaints")
    if not argv:
        said = subprocess.run(["iverilog", "-V"], text=True, capture_output=True).stdout
        version = said.split()[3]
        recorded.save(
            "icarus", "make icarus", ("cocotb",),
            [Row("power-up: module tests with X in every register that nothing was written to",
                 f"{total} tests, {len(failures)} complaints", f"Icarus Verilog {version}; one in "
                 f"{THIN} of the datapath's vectors")],
        )  # fmt: skip
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
