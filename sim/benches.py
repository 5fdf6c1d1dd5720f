"""The benches of the module tests: which top level, and which cocotb tests run on it."""

from __future__ import annotations

from dataclasses import dataclass, field

from sim import primitives
from sim.units import MODULES, bench_source

#: All of them, small modules first. `primitives` holds the small modules, side by side.
NAMES = ("primitives", *MODULES, "control", "phong_pipeline")


@dataclass(frozen=True)
class ModuleBench:
    """Top level `top`, its text where it is generated, and the Python module of its tests."""

    name: str
    top: str
    tests: str
    sources: dict[str, str] = field(default_factory=dict)


def module_bench(name: str) -> ModuleBench:
    """The bench `name` of NAMES. Raises KeyError."""
    if name == "primitives":
        sources = {f"{primitives.TOP}.v": primitives.source()}
        return ModuleBench(name, primitives.TOP, "tests.modules.primitives", sources)
    if name in MODULES:
        top, text = bench_source(name)
        tests = f"tests.modules.{MODULES[name].tests}"
        return ModuleBench(name, top, tests, {f"{top}.v": text})
    top = {"control": "control_bench", "phong_pipeline": "pipeline_bench"}[name]
    return ModuleBench(name, top, f"tests.modules.{name}")
