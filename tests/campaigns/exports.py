# SPDX-License-Identifier: MIT
"""Every named configuration, exported and simulated: `python -m tests.campaigns.exports`.

Verilator lints the exports with its usual warnings, and their testbenches run in Icarus Verilog,
whose registers are undefined until written. Exit code: 0; 1 if an export fails; 2 if Icarus Verilog
is missing or a name is wrong.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from phong75.model.frame import InputError
from phong75.scripts import console
from phong75.scripts.configurations import CONFIGURATIONS, named
from phong75.scripts.export import export
from phong75.scripts.main import single
from phong75.sim.build import BuildError, run_tool


def trial(name: str, folder: Path) -> str:
    """Export, lint and simulate `name` in `folder`; returns what the testbench printed at the end.

    Raises InputError, BuildError.
    """
    export(named(name), folder, prefix="x_")
    run_tool(["verilator", "--lint-only", "--timing", "--top-module", "x_testbench",
              "-f", "testbench.f"], cwd=folder)  # fmt: skip
    run_tool(["iverilog", "-g2005", "-s", "x_testbench", "-o", "testbench.vvp",
              "-c", "testbench.f"], cwd=folder)  # fmt: skip
    printed = run_tool(["vvp", "-N", "testbench.vvp"], cwd=folder)
    verdict = [line for line in printed.splitlines() if line.startswith("PASS")]
    if not verdict:
        raise BuildError(f"the testbench gave no verdict:\n{printed}")
    return verdict[0]


def main(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME", help="Names of configurations; else all.")
    ] = None,
) -> int:
    """Export, lint and simulate every named configuration (ten minutes)."""
    if not shutil.which("iverilog"):
        raise InputError("Icarus Verilog is missing: apt-get install iverilog")
    for name in names or []:
        named(name, "NAME")
    failed = 0
    for name in names or CONFIGURATIONS:
        with tempfile.TemporaryDirectory() as folder:
            try:
                console.say(f"{name}: {trial(name, Path(folder, 'export'))}")
            except (InputError, BuildError) as error:
                console.failure(f"{name}: {error}")
                failed += 1
    console.say(f"{len(names or CONFIGURATIONS)} exports, {failed} failed")
    return console.FAILED if failed else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "exports"))
