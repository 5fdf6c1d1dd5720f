"""The benches of the module tests: which top level, and which cocotb tests run on it."""

from __future__ import annotations

from dataclasses import dataclass, field

from model.config import DEFAULT, TECHNIQUES, Config
from sim import primitives
from sim.units import MODULES, bench_source

#: The pipeline with an older technique in place of normals.
_OLDER = tuple(name for name, config in TECHNIQUES.items() if config is not DEFAULT)
#: All of them, small modules first. `primitives` holds the small modules, side by side.
NAMES = ("primitives", *MODULES, "control", "phong_pipeline", *_OLDER)


@dataclass(frozen=True)
class ModuleBench:
    """Top level `top`, its text where it is generated, its configuration, and the Python module
    of its tests."""

    name: str
    top: str
    tests: str
    sources: dict[str, str] = field(default_factory=dict)
    config: Config = DEFAULT


def module_bench(name: str, only: tuple[str, ...] = ()) -> ModuleBench:
    """The bench `name` of NAMES. only: of the small modules these. Raises KeyError."""
    if name == "primitives":
        sources = {f"{primitives.TOP}.v": primitives.source(only)}
        return ModuleBench(name, primitives.TOP, "tests.modules.primitives", sources)
    if name in MODULES:
        top, text = bench_source(name)
        tests = f"tests.modules.{MODULES[name].tests}"
        return ModuleBench(name, top, tests, {f"{top}.v": text})
    if name in _OLDER:
        tests = "tests.modules.phong_pipeline"
        return ModuleBench(name, "pipeline_bench", tests, config=TECHNIQUES[name])
    top = {"control": "control_bench", "phong_pipeline": "pipeline_bench"}[name]
    return ModuleBench(name, top, f"tests.modules.{name}")
