"""Lint of everything: `make lint`. Quiet where all is well.

Exit code: 0; or 1 after the messages of every tool that has any.
"""

from __future__ import annotations

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path

from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.scripts import console
from phong75.sim import build, design
from phong75.sim.build import BuildError

_BIN = Path(sys.executable).parent
_RULES = design.PACKAGE / "scripts" / "verible.rules"
BENCHES = (design.SIM / "frame", design.SIM / "module")

_OTHER_TECHNIQUES = [config for config in TECHNIQUES.values() if config is not DEFAULT]
#: Configurations besides the default one in which the whole design is looked at.
CONFIGS = (
    *_OTHER_TECHNIQUES,
    *(replace(c, name=f"grey_{c.name}", channels=1) for c in _OTHER_TECHNIQUES),
    replace(DEFAULT, name="quadratic_normals", normal_order=2),
)


def verilator(source: Path, config: Config = DEFAULT) -> str:
    """What Verilator's -Wall says of the module in `source` (and of those below it)."""
    folders = [build.generate_header(config), *design.folders(), *BENCHES]
    if source.parent == design.ECP5:  # what it has comes first, on models of the chip's blocks
        folders = [design.ECP5, design.SIM / "ecp5", *folders]
    folders = [f"-I{folder}" for folder in folders]
    top = ["--top-module", source.stem]
    try:
        build.run_tool(
            [build.VERILATOR, "--lint-only", "-Wall", "--no-timing", *top, *folders]
            + [design.SIM / "lint.vlt", source]
        )
    except BuildError as error:
        return str(error)
    return ""


def tool(name: str, *arguments) -> str:
    """What the program `name` of the virtual environment says, if it objects to anything."""
    done = subprocess.run(
        [_BIN / name, *arguments],
        cwd=design.PACKAGE,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    return f"{name}:\n{done.stdout}" if done.returncode else ""


def main() -> int:
    """Run all tools; returns the exit code."""
    designs = design.sources() + sorted(design.ECP5.glob("*.v"))
    benches = [file for folder in BENCHES for file in sorted(folder.glob("*.v"))]
    headers = design.headers()
    models = sorted((design.SIM / "ecp5").glob("*.v"))  # their names and style are Lattice's
    checks = [partial(verilator, source) for source in designs + benches + models]
    checks += [partial(verilator, design.module_file(design.TOP), config) for config in CONFIGS]
    for command in (
        ("mypy", "--cache-dir", design.BUILD / "mypy"),
        ("verible-verilog-lint", f"--rules_config={_RULES}", *designs, *headers, *benches),
        ("ruff", "check", "--quiet", "--output-format=concise"),
        ("ruff", "format", "--check", "--quiet"),
        ("lint-imports", "--no-logo", "--cache-dir", design.BUILD / "import_linter"),
    ):
        checks.insert(0, partial(tool, *command))  # the longest first
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        complaints = list(pool.map(lambda check: check(), checks))
    complaints = [text.strip() for text in complaints if text.strip()]
    for text in complaints:
        console.note(text)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
