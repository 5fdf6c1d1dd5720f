"""Whole frames through the RTL: every bundled scene at the sizes that are promised, to the bit."""

import shutil

import numpy as np
import pytest

from model import error_budget, metrics, reference, twin
from model.config import DEFAULT as C
from model.scene import bundled_scenes, load_scene
from model.scene_to_spans import front_end
from sim.build import RTL, Bench
from sim.locate import locate
from sim.run_frame import Job, simulate_jobs

SIZES = ((512, 512), (640, 480), (1920, 1080))
FPS, CLOCK_HZ = 30, 200e6


@pytest.mark.parametrize("scene", bundled_scenes())
def test_bundled_scene(scene):
    """RTL = model, within the derived bound, 99.9 % correctly rounded, in the cycle budget."""
    frames = [front_end(load_scene(scene, size)).frame for size in SIZES]
    for size, frame, result in zip(
        SIZES, frames, simulate_jobs([Job(f) for f in frames]), strict=True
    ):
        what = f"{scene} at {size}"
        comparison = metrics.compare(twin.render(frame), result.pixels)
        assert comparison.mismatches == 0, f"{what}: {comparison.first}"
        assert result.complete and not result.extra_pixels and not result.illegal_spans, what
        assert result.stall_cycles == 0, what
        assert result.cycles <= CLOCK_HZ / FPS, what
        error = metrics.error_metrics(result.pixels.rgb, reference.render(frame))
        assert error["max_lsb"] <= error_budget.bound_lsb(frame) <= 1, what
        assert error["correctly_rounded"] >= 0.999, what
        assert result.pixels.last.sum() == 1 and result.pixels.last[-1], what


def test_each_dot_is_shaded_once():
    for scene in bundled_scenes():
        pixels = twin.render(front_end(load_scene(scene, SIZES[1])).frame)
        assert len(np.unique(pixels.y * C.max_size + pixels.x)) == len(pixels.x), scene


def test_an_empty_frame_ends(tmp_path):
    frame = front_end(load_scene("sphere", (64, 48))).frame
    frame.spans = frame.spans[:0]
    result = simulate_jobs([Job(frame)])[0]
    assert result.complete and len(result.pixels.x) == 0


def test_a_broken_design_fails_and_is_located(tmp_path):
    """The check can fail: 1 - cos(s) from p*q in place of p*p, and the stage is named."""
    rtl = tmp_path / "rtl"
    shutil.copytree(RTL, rtl)
    text = (rtl / "reflection.v").read_text()
    broken = text.replace(".b(p_p5)", ".b(q_p5)")
    assert broken != text
    (rtl / "reflection.v").write_text(broken)
    frame = front_end(load_scene("sphere", (64, 48))).frame
    result = simulate_jobs([Job(frame)], C, Bench("frame_bench", C, rtl=rtl))[0]
    comparison = metrics.compare(twin.render(frame), result.pixels)
    assert comparison.mismatches > 100
    said = locate(frame, comparison.first.index, rtl)
    assert "stage reflection.versine" in said and "expected" in said and "got" in said
