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
from phong75.model.spans import read_spans, write_spans
from phong75.model.twin.core.normalizer import normalizer
from phong75.model.twin.core.phong_unit import interpolate
from phong75.model.twin.core.shading_unit import shading_unit
from phong75.model.twin.core.span_walker import span_walker
from phong75.model.twin.techniques.intensity_code import intensity_code
from phong75.sim import environment
from phong75.sim.build import Bench
from phong75.sim.design import BUILD
from phong75.sim.module.unit_tb import UnitTB, first_difference
from phong75.sim.module.units import bench_source


def _vectors(frame: Frame, pixel: int, config: Config):
    """Yield (module, input columns, expected stages) of the modules that shade pixel `pixel`.

    pixel: number of the pixel in the stream of `frame`.
    """
    span, k, _, _, _ = span_walker(frame.spans, pixel, pixel + 1, config)
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


@cocotb.test()
async def locate_stage(dut):
    """Run the pixel of where.json through one module; write the first difference to result.json.

    The result is a message, or null if all stages agree with the twin.
    """
    folder = Path(os.environ[environment.VECTORS])
    where = json.loads((folder / "where.json").read_text())
    config = replace(TECHNIQUES[where["technique"]], normal_order=where["normal_order"])
    frame = read_spans(folder / "spans", config)
    for module, inputs, expected in _vectors(frame, where["pixel"], config):
        if module != where["module"]:
            continue
        tb = UnitTB(dut, module)
        if module == "normalizer":
            await tb.hold(valid=1, two_sided=int(frame.two_sided))
        elif module == "shading_unit":
            half = (code & ((1 << config.half_vector.bits) - 1) for code in frame.half_vector)
            await tb.hold(**dict(zip(("half_x", "half_z"), half, strict=True)))
            await tb.write_table(frame)
        got = await tb.send(*inputs)
        message = first_difference(module, inputs, expected, got)
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
        where = {"technique": config.technique, "pixel": pixel, "normal_order": config.normal_order}
        for module in modules:
            (folder / "where.json").write_text(json.dumps(where | {"module": module}))
            top, text = bench_source(module)
            bench = Bench(top, sources={f"{top}.v": text}, **({"rtl": rtl} if rtl else {}))
            handed = {environment.VECTORS: str(folder)}
            bench.run("phong75.sim.frame.locate", folder, extra_env=handed)
            message = json.loads((folder / "result.json").read_text())
            if message:
                return message
        other = "register_map" if phong else f"{config.technique}_unit"
        interpolator = ("linear", "second_difference")[config.normal_order - 1]
        return (
            f"{' and '.join(modules)} agree with the twin for this pixel's interpolated vector: "
            f"the difference is in span_walker, {interpolator}_interpolator, {other} or pixel_fifo"
        )
    finally:
        shutil.rmtree(folder, ignore_errors=True)
