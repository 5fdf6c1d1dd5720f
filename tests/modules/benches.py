# SPDX-License-Identifier: MIT
"""The module benches: their names, top levels, configurations and cocotb tests."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.studies.methods import CONFIGS
from phong75.sim import environment
from phong75.sim.design import module_file
from phong75.sim.module import primitives
from phong75.sim.module.units import MODULES, bench_source

#: The pipeline with Gouraud and flat shading.
_TECHNIQUES = tuple(name for name, config in TECHNIQUES.items() if config is not DEFAULT)

#: Builds for several lights.
_LIGHTS = {
    "lights_3": Config(name="lights_3", lights=3),
    "lights_8": Config(name="lights_8", lights=8, highlight_colour=True),
}

#: Builds with curves of cos(s) by table, and with jumps.
_REFLECTANCE = {
    "jumps": Config(name="jumps", power_method="curve", curve_jumps=4, weight_jumps=4),
    "jump": Config(
        name="jump", power_method="curve", curve_jumps=1, weight_jumps=1, idle_material_bits=3
    ),
}

#: {name: configuration}: what the benches are built in.
BUILDS = CONFIGS | _LIGHTS | _REFLECTANCE

#: <module>@<name of BUILDS>: modules that have further branches in that configuration.
_VARIANTS = (
    "inverse_sqrt_iterated@fast_inverse_1", "specular_power_squaring@squaring_14",
    "quadratic_normalizer@quadratic_spans_14", "light_highlight@lights_8", "light_terms@lights_8",
    "context_interpolator@lights_8", "reflectance_table@jump", "span_word@lights_8",
    "light_attenuation@lights_8",
)  # fmt: skip

#: The benches of the whole design's control and pipeline, and their top levels.
_TOPS = {
    "control": "control_bench", "phong_pipeline": "pipeline_bench",
    "lights_pipeline": "pipeline_bench",
}  # fmt: skip

#: All module benches, small modules first. `primitives` contains all small modules.
NAMES = ("primitives", *MODULES, *_VARIANTS, *_TOPS, *_TECHNIQUES)

#: Benches of a single one of the small modules: parts of `primitives`.
PRIMITIVES = tuple(f"primitives/{module}" for module in primitives.modules())


@dataclass(frozen=True)
class ModuleBench:
    """A module bench.

    name: see `module_bench`. top: module name of the Verilog top level. tests: Python module with
    the cocotb tests. sources: {file name: text} of a generated top level. config: configuration of
    the design. test_filter: regular expression of the cocotb tests to run, None for all.
    """

    name: str
    top: str
    tests: str
    sources: dict[str, str] = field(default_factory=dict)
    config: Config = DEFAULT
    test_filter: str | None = None

    def environment(self, vectors: Path, seed: int) -> dict[str, str]:
        """The environment variables of the cocotb tests; vectors: folder for vector files."""
        module = self.name.partition("@")[0]
        config = self.config.name if self.config.name in BUILDS else "default"
        return {
            environment.MODULE: module, environment.CONFIG: config,
            environment.VECTORS: str(vectors), environment.SEED: str(seed),
        }  # fmt: skip


def module_bench(name: str) -> ModuleBench:
    """The bench `name` of NAMES or PRIMITIVES. Raises KeyError."""
    if name == "primitives" or name in PRIMITIVES:
        module = name.partition("/")[2]
        text = primitives.source((module,) if module else ())
        return ModuleBench(
            name, primitives.TOP, "tests.modules.primitives", {f"{primitives.TOP}.v": text},
            test_filter=rf"\.{module}\b" if module else None,
        )  # fmt: skip
    module, _, config = name.partition("@")
    if module in MODULES:
        top, text = bench_source(module)
        folder = module_file(module).parent.name
        tests = folder if folder in ("methods", "lights", "reflectance") else "datapath"
        usual = "jumps" if folder == "reflectance" else "default"
        return ModuleBench(
            name, top, f"tests.modules.{tests}", {f"{top}.v": text}, BUILDS[config or usual]
        )
    if name in _TECHNIQUES:
        tests = "tests.modules.phong_pipeline"
        return ModuleBench(name, "pipeline_bench", tests, config=TECHNIQUES[name])
    config = BUILDS["lights_3"] if name == "lights_pipeline" else DEFAULT
    return ModuleBench(name, _TOPS[name], f"tests.modules.{name}", config=config)
