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
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from phong75.sim.elaborate import instances
from tests.configuration_tests import CONFIGURATION_TESTS, configuration_test
from tests.modules.benches import NAMES, PRIMITIVES, module_bench

#: All benches. The small modules are tested one by one.
BENCHES = (*CONFIGURATION_TESTS, *PRIMITIVES, *(name for name in NAMES if name != "primitives"))

#: The bench that comes first wherever it is relevant: most changes fail it.
FIRST = "default"


def instances_of(name: str) -> Counter[str]:
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
        return dict(zip(BENCHES, pool.map(instances_of, BENCHES), strict=True))


def relevant_benches(file: Path) -> Iterator[str]:
    """The benches that can notice a change of `file`, a module or a header of the design.

    The order is FIRST, then the benches of the module itself, then benches with few instances
    before those with many, because a small bench is built in a shorter time. All benches are
    elaborated only if those of the module do not suffice. Raises BuildError.
    """
    module = file.stem
    header = file.suffix == ".vh"
    own = [name for name in BENCHES if _module(name) == module]
    if FIRST not in own and (header or module in instances_of(FIRST)):
        own.insert(0, FIRST)
    yield from own
    others = [
        name for name, modules in contents().items()
        if name not in own and (header or module in modules)
    ]  # fmt: skip
    yield from sorted(others, key=lambda name: contents()[name].total())


def _module(bench: str) -> str:
    """The module of which `bench` is the own bench, "" for a configuration test."""
    if bench in CONFIGURATION_TESTS:
        return ""
    return bench.removeprefix("primitives/").partition("@")[0]
