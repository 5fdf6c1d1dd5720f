# SPDX-License-Identifier: MIT
"""Whole frames through the RTL: every bundled scene at the sizes that are promised, to the bit."""

import shutil

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, reference, undecided
from phong75.model.config import DEFAULT as C
from phong75.model.frame import fitted
from phong75.model.front.scene import bundled_scenes, load_scene, technique_scenes
from phong75.model.scene_to_frame import front_end
from phong75.scripts import recorded, scene_results
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.frame.locate import locate
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from tests.records import differences


@pytest.mark.parametrize("scene", bundled_scenes())
def test_bundled_scene(scene):
    """RTL = model, in the derived bound, 99.9 % rounded right, 30 frames/s, as recorded."""
    measured = scene_results.measure(scene)
    for size, result in zip(scene_results.SIZES, measured, strict=True):
        what, done = f"{scene} at {size}", result.simulation
        assert result.mismatches == 0, f"{what}: {result.first}"
        assert done.complete and not done.extra_pixels and not done.illegal_spans, what
        assert done.stall_cycles == 0, what
        assert result.max_fps >= scene_results.FPS, what
        assert result.error["max_lsb"] <= result.bound_lsb <= 1, what
        assert result.error["correctly_rounded"] >= 0.999, what
        assert done.pixels.last.sum() == 1 and done.pixels.last[-1], what
    now = scene_results.figures({scene: measured})["scenes"][scene]
    for new, kept in zip(now, recorded.figures("scenes")["scenes"][scene], strict=True):
        assert not differences(new, kept), "the record is old: make scenes RECORD=1"


@pytest.mark.parametrize("scene", technique_scenes())
def test_technique_scene(scene):
    """RTL = model with and without stalls, in the derived bound, at full rate.

    `make scenes` does the same at full size.
    """
    frame = front_end(load_scene(scene, (320, 240))).frame
    config = fitted(C, frame)
    assert config != C, "the scene needs more than the default configuration"
    bench = Bench("frame_bench", config, quick=True)
    jobs = [SimJob(frame), SimJob(frame, idle=64, stall=100, seed=75)]
    expected, (free, stalled) = twin.render(frame, config), simulate_jobs(jobs, config, bench)
    for result in (free, stalled):
        assert result.complete and not result.illegal_spans and not result.unsupported
        compared = metrics.compare(expected, result.pixels)
        assert compared.mismatches == 0, compared.first
    assert free.stall_cycles == 0 < stalled.stall_cycles
    ideal = reference.render(frame, config)
    ideal = undecided.nearest(free.pixels.rgb, ideal, frame, config).ideal
    error = np.abs(free.pixels.rgb - ideal).max()
    assert error <= error_budget.bound_lsb(frame, config)


def test_each_pixel_is_shaded_once():
    for scene in bundled_scenes():
        pixels = twin.render(front_end(load_scene(scene)).frame)
        assert len(np.unique(pixels.y * C.max_size + pixels.x)) == len(pixels.x), scene


def test_an_empty_frame_ends(tmp_path):
    frame = front_end(load_scene("sphere", (64, 48))).frame
    frame.spans = frame.spans[:0]
    result = simulate_jobs([SimJob(frame)])[0]
    assert result.complete and len(result.pixels.x) == 0


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_no_pixel_depends_on_what_registers_hold_at_power_up(seed):
    frame = front_end(load_scene("still_life")).frame
    result = simulate_jobs([SimJob(frame)], power_up=seed)[0]
    assert metrics.compare(twin.render(frame), result.pixels).mismatches == 0, f"seed {seed}"
    assert result.stall_cycles == 0 and result.illegal_spans == 0


def test_a_broken_design_fails_and_is_located(tmp_path):
    """The check can fail: 1 - cos(s) from p*q in place of p*p, and the stage is named."""
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    text = (rtl / "core" / "versine_of_cross.v").read_text()
    broken = text.replace(".b(cross_xz),", ".b(cross_y),")
    assert broken != text
    (rtl / "core" / "versine_of_cross.v").write_text(broken)
    frame = front_end(load_scene("sphere", (64, 48))).frame
    result = simulate_jobs([SimJob(frame)], C, Bench("frame_bench", C, rtl=rtl))[0]
    comparison = metrics.compare(twin.render(frame), result.pixels)
    assert comparison.mismatches > 100
    message = locate(frame, comparison.first.index, rtl=rtl)
    assert "stage reflection.versine" in message and "expected" in message and "got" in message
