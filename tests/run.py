# SPDX-License-Identifier: MIT
"""The tests, by tier: `python -m tests.run check|test|all`, which `make` forwards to.

check  lint and the fast tier, for the loop of editing
test   lint and everything that the main installation can run
all    lint and everything, with the hardware tools and the browser: what CI runs

Further arguments go to pytest. Exit code: pytest's, or 1 if lint has a complaint.
"""

from __future__ import annotations

import os
import sys

import pytest

from phong75.scripts import lint
from phong75.sim import build
from tests.conftest import recorded_durations

_MAIN = ("--ignore=tests/hardware", "--ignore=tests/page", "--ignore=tests/docs")
#: What each tier adds to pytest's arguments.
TIERS: dict[str, tuple[str, ...]] = {"check": (*_MAIN, "-m", "fast"), "test": _MAIN, "all": ()}


def main(arguments: list[str]) -> int:
    """Run a tier; returns the exit code."""
    if not arguments or arguments[0] not in TIERS:
        print(__doc__.partition("\n\n")[2], file=sys.stderr)
        return 2
    tier, *more = arguments
    cores = os.cpu_count() or 1
    print(f"lint ({tier}) ...", file=sys.stderr, flush=True)
    if status := lint.main():
        return status
    seconds = sum(recorded_durations().values())
    estimate = f", about {seconds / cores / 60:.0f} min when idle" if tier != "check" else ""
    print(f"tests on {cores} cores{estimate} ...", file=sys.stderr, flush=True)
    if tier != "check":
        build.runtime()  # once, before all need it
    options = [*TIERS[tier], "-n", str(cores), "--dist", "worksteal", "--progress"]
    return int(pytest.main([*options, *more]))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
