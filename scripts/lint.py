"""Lint of everything: `make lint`. Quiet where all is well.

Exit code: 0; or 1 after the messages of every tool that has any.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

from model.config import DEFAULT, TECHNIQUES, Config
from scripts.synthesis import TECHNOLOGY
from sim import build
from sim.build import BuildError

_BIN = Path(sys.executable).parent
_RULES = build.ROOT / "scripts" / "verible.rules"

_OLDER = [config for config in TECHNIQUES.values() if config is not DEFAULT]
#: Configurations besides the default one in which the whole design is looked at.
CONFIGS = (*_OLDER, *(replace(c, name=f"grey_{c.name}", channels=1) for c in _OLDER))


def verilator(source: Path, config: Config = DEFAULT) -> str:
    """What Verilator's -Wall says of the module in `source` (and of those below it)."""
    folders = [build.generate_header(config), build.RTL, build.SIM]
    if source.parent == TECHNOLOGY:  # what it has comes first, on models of the chip's blocks
        folders = [TECHNOLOGY, build.SIM / "ecp5", *folders]
    folders = [f"-I{folder}" for folder in folders]
    top = ["--top-module", source.stem]
    try:
        build.run_tool(
            ["verilator", "--lint-only", "-Wall", "--no-timing", *top, *folders]
            + [build.SIM / "lint.vlt", source]
        )
    except BuildError as error:
        return str(error)
    return ""


def tool(name: str, *arguments) -> str:
    """What the program `name` of the virtual environment says, if it objects to anything."""
    done = subprocess.run(
        [_BIN / name, *arguments],
        cwd=build.ROOT,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    return f"{name}:\n{done.stdout}" if done.returncode else ""


def main() -> int:
    """Run all tools; returns the exit code."""
    designs = sorted(build.RTL.glob("*.v")) + sorted(TECHNOLOGY.glob("*.v"))
    benches = sorted(build.SIM.glob("*.v"))
    headers = sorted(build.RTL.glob("*.vh"))
    models = sorted((build.SIM / "ecp5").glob("*.v"))  # their names and style are Lattice's
    said = [verilator(source) for source in designs + benches + models]
    said += [verilator(build.RTL / "phong_pipeline.v", config) for config in CONFIGS]
    said.append(
        tool("verible-verilog-lint", f"--rules_config={_RULES}", *designs, *headers, *benches)
    )
    said.append(tool("ruff", "check", "--quiet", "--output-format=concise"))
    said.append(tool("ruff", "format", "--check", "--quiet"))
    said = [text.strip() for text in said if text.strip()]
    for text in said:
        print(text, file=sys.stderr)
    return 1 if said else 0


if __name__ == "__main__":
    sys.exit(main())
