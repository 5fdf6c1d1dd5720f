# SPDX-License-Identifier: MIT
"""Relevant benches: which benches can notice a change of a file of the design.

A bench is a module bench (tests/modules/benches.py) or a configuration test
(tests/configuration_tests.py). It is relevant for a module if the module is instantiated in it,
which the elaborated design says. So no list has to be kept by hand. A header is relevant to every
bench.
"""

from __future__ import annotations

import functools
import os
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from phong75.sim.elaborate import instances
from tests.configuration_tests import CONFIGURATION_TESTS, configuration_test
from tests.modules.benches import NAMES, PRIMITIVES, module_bench

#: All benches. The small modules are tested one by one.
BENCHES = (*CONFIGURATION_TESTS, *PRIMITIVES, *(name for name in NAMES if name != "primitives"))

#: The bench that comes first wherever it is relevant: most changes fail it.
FIRST = "default"


def _instances(name: str) -> Counter[str]:
    """{module: number of its instances} in the bench `name`. Raises BuildError."""
    if name in CONFIGURATION_TESTS:
        return instances(configuration_test(name).config)
    bench = module_bench(name)
    return instances(bench.config, bench.top, bench.sources.get(f"{bench.top}.v"))


@functools.cache
def contents() -> dict[str, Counter[str]]:
    """{bench: {module: number of its instances}} of all benches. Raises BuildError.

    Elaboration takes about a quarter of a second of processor time per bench; `instances` caches
    the results in the build folder.
    """
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return dict(zip(BENCHES, pool.map(_instances, BENCHES), strict=True))


def relevant_benches(file: Path) -> list[str]:
    """The benches that can notice a change of `file`, a module or a header of the design.

    The order is FIRST, then the benches of the module itself, then benches with few instances
    before those with many, because a small bench is built in a shorter time. Raises BuildError.
    """
    module = file.stem
    relevant = [
        name for name, modules in contents().items() if file.suffix == ".vh" or module in modules
    ]

    def priority(name: str) -> tuple[bool, bool, int]:
        own = name in (module, f"primitives/{module}") or name.startswith(f"{module}@")
        return name != FIRST, not own, contents()[name].total()

    return sorted(relevant, key=priority)
