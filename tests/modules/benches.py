"""The benches of the module tests: which top level, and which cocotb tests run on it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.studies.methods import CONFIGS
from phong75.sim import environment
from phong75.sim.module import primitives
from phong75.sim.module.units import MODULES, bench_source

#: The pipeline with an older technique in place of normals.
_OLDER = tuple(name for name, config in TECHNIQUES.items() if config is not DEFAULT)
#: Modules in another configuration of the sweep, where the default one has less of them.
_VARIANTS = (
    "inverse_sqrt_iterated@fast_inverse_1", "specular_power_squaring@squaring_14",
    "quadratic_normalizer@quadratic_spans_14",
)  # fmt: skip
#: All of them, small modules first. `primitives` holds the small modules, side by side.
NAMES = ("primitives", *MODULES, *_VARIANTS, "control", "phong_pipeline", *_OLDER)


@dataclass(frozen=True)
class ModuleBench:
    """Top level `top`, its text where it is generated, its configuration, and the Python module
    of its tests."""

    name: str
    top: str
    tests: str
    sources: dict[str, str] = field(default_factory=dict)
    config: Config = DEFAULT

    def environment(self, vectors: Path, seed: int) -> dict[str, str]:
        """What its tests want to know: the folder for `vectors`, and the seed."""
        module, _, config = self.name.partition("@")
        return {
            environment.MODULE: module, environment.CONFIG: config or "default",
            environment.VECTORS: str(vectors), environment.SEED: str(seed),
        }  # fmt: skip


def module_bench(name: str, only: tuple[str, ...] = ()) -> ModuleBench:
    """The bench `name` of NAMES. only: of the small modules these. Raises KeyError."""
    if name == "primitives":
        sources = {f"{primitives.TOP}.v": primitives.source(only)}
        return ModuleBench(name, primitives.TOP, "tests.modules.primitives", sources)
    module, _, config = name.partition("@")
    if module in MODULES:
        top, text = bench_source(module)
        tests = f"tests.modules.{MODULES[module].tests}"
        return ModuleBench(name, top, tests, {f"{top}.v": text}, CONFIGS[config or "default"])
    if name in _OLDER:
        tests = "tests.modules.phong_pipeline"
        return ModuleBench(name, "pipeline_bench", tests, config=TECHNIQUES[name])
    top = {"control": "control_bench", "phong_pipeline": "pipeline_bench"}[name]
    return ModuleBench(name, top, f"tests.modules.{name}")
