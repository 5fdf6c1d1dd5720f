# SPDX-License-Identifier: MIT
"""Locates a wrong pixel: compares the stages of the pixel's modules with the twin, one by one."""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import cocotb
import numpy as np

from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.frame import Frame
from phong75.model.spans import read_spans, write_spans, written_for
from phong75.model.twin.core.normalizer import normalizer
from phong75.model.twin.core.phong_unit import interpolate
from phong75.model.twin.core.shading_unit import shading_unit
from phong75.model.twin.core.span_walker import span_walker
from phong75.model.twin.lights import lights_unit
from phong75.model.twin.lights.light_sum import light_sum
from phong75.model.twin.techniques.intensity_code import intensity_code
from phong75.sim import environment
from phong75.sim.build import Bench
from phong75.sim.design import BUILD
from phong75.sim.module.lights import Vectors, vectors, write_codes
from phong75.sim.module.unit_tb import UnitTB, first_difference
from phong75.sim.module.units import bench_source


def _vectors(frame: Frame, pixel: int, config: Config):
    """Yield (module, input columns, expected stages) of the modules that shade pixel `pixel`.

    pixel: number of the pixel in the stream of `frame`.
    """
    span, k, _, _, _ = span_walker(frame.spans, pixel, pixel + 1, config)
    if config.sums_lights:
        normals = lights_unit.interpolate(frame, span, k, config)
        material = frame.spans["material"][span].astype(np.int64)
        depths = None
        if config.attenuation:
            depths = lights_unit.depth_interpolators(frame, span, k, config)
        for light in range(frame.lights):
            for found in vectors(normals, material, frame, config, light, span, depths):
                yield found.module, found, found.expected
        yield "light_sum", *_sum(normals, material, frame, config, span, depths)
        return
    normal, _ = interpolate(frame.spans, span, k, config)
    trace: dict = {}
    if config.technique != "phong":
        value = normal[: config.values, 0]
        intensity_code(value, config, trace)
        yield "intensity_code", [value], trace
        return
    unit, cosine, lit = normalizer(normal, frame.two_sided, config, trace, frame.half_vector)
    yield "normalizer", list(normal), trace
    material = frame.spans["material"][span].astype(np.int64)
    trace = {}
    shading_unit(unit, cosine, lit, material, frame, config, trace)
    yield "shading_unit", [*unit, cosine, lit.astype(np.int64), material], trace


def _sum(normals, material, frame: Frame, config: Config, span, depths):
    """Vectors and expected stages of `light_sum` for the first channel of one pixel."""
    traces: list[dict] = [{} for _ in normals]
    lights_unit.shade(normals, material, frame, config, traces, span, depths)
    terms = np.concatenate([trace["light_terms.sum"][0] for trace in traces])
    turns = len(terms)
    sums = {}
    light_sum(frame.materials.ambient[material[0], 0], np.cumsum(terms), config, sums)
    first = np.arange(turns) == 0
    expected = {name: (word,) for name, word in sums.items()}
    inputs = [terms, first.astype(np.int64), np.repeat(material, turns)]
    codes = {"write_ambient": frame.materials.ambient[:, 0]}
    return Vectors("light_sum", inputs, expected, codes=codes), expected


@cocotb.test()
async def locate_stage(dut):
    """Run the pixel of where.json through one module; write the first difference to result.json.

    The result is a message, or null if all stages agree with the twin.
    """
    folder = Path(os.environ[environment.VECTORS])
    where = json.loads((folder / "where.json").read_text())
    config = written_for(folder / "spans", TECHNIQUES[where["technique"]])
    frame = read_spans(folder / "spans", config)
    message = None
    for module, inputs, expected in _vectors(frame, where["pixel"], config):
        if module != where["module"]:
            continue
        tb = UnitTB(dut, module)
        if isinstance(inputs, Vectors):
            await tb.hold(**inputs.held)
            await write_codes(tb, inputs.codes)
            if module == "light_highlight":
                await tb.write_table(replace(frame, further=[]), config)
            inputs = inputs.inputs
        if module == "normalizer":
            await tb.hold(valid=1, two_sided=int(frame.two_sided))
        elif module == "shading_unit":
            half = (code & ((1 << config.half_vector.bits) - 1) for code in frame.half_vector)
            await tb.hold(**dict(zip(("half_x", "half_z"), half, strict=True)))
            await tb.write_table(frame)
        got = await tb.send(*inputs)
        message = message or first_difference(module, inputs, expected, got)
    (folder / "result.json").write_text(json.dumps(message))


def locate(frame: Frame, pixel: int, config: Config = DEFAULT, rtl: Path | None = None) -> str:
    """One line that names the first stage at which the RTL differs from the twin.

    pixel: number of the wrong pixel in the stream of `frame`. rtl: folder of the design, None for
    the project's own. Builds the testbenches of the modules if necessary. Raises BuildError.
    """
    (BUILD / "run").mkdir(parents=True, exist_ok=True)
    folder = Path(tempfile.mkdtemp(dir=BUILD / "run"))
    try:
        write_spans(folder / "spans", frame, config)
        phong = config.technique == "phong"
        modules = ("normalizer", "shading_unit") if phong else ("intensity_code",)
        build = DEFAULT
        if config.sums_lights:
            # The modules of one unit: they are the same however many stand side by side.
            build = replace(config, name=f"{config.name}_locate", units=1)
            modules = (
                "light_align", "held_root", "light_scale", "light_highlight",
                *(("light_attenuation",) if config.attenuation else ()), "light_terms",
                "light_sum",
            )  # fmt: skip
        where = {"technique": config.technique, "pixel": pixel}
        for module in modules:
            (folder / "where.json").write_text(json.dumps(where | {"module": module}))
            top, text = bench_source(module)
            bench = Bench(top, build, {f"{top}.v": text}, rtl, quick=True)
            handed = {environment.VECTORS: str(folder)}
            bench.run("phong75.sim.frame.locate", folder, extra_env=handed)
            message = json.loads((folder / "result.json").read_text())
            if message:
                return message
        other = "register_map" if phong else f"{config.technique}_unit"
        interpolator = ("linear", "second_difference")[config.normal_order - 1]
        interpolator = f"{interpolator}_interpolator"
        if config.sums_lights:
            other = "light_turns, register_map, light_map, lights_unit"
            interpolator = "the interpolators"
        return (
            f"{' and '.join(modules)} agree with the twin for this pixel's interpolated vector: "
            f"the difference is in span_walker, {interpolator}, {other} or pixel_fifo"
        )
    finally:
        shutil.rmtree(folder, ignore_errors=True)
