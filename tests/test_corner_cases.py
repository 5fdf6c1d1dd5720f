# SPDX-License-Identifier: MIT
"""Stiff and extreme cases through the RTL; `make stability` runs more of them."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import error_budget, reference
from phong75.model.config import DEFAULT as C
from phong75.model.front import visibility
from phong75.model.spans import illegal_spans
from phong75.model.studies import corner_cases
from phong75.model.studies.methods import CONFIGS, PORTS_OF_DEFAULT
from phong75.model.twin.core import phong_unit
from phong75.scripts import recorded
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.frame import corner_cases as table
from phong75.sim.frame.run_frame import SimResult
from tests.records import differences


def result(frame, **changes):
    """What a perfect RTL would give."""
    pixels = twin.render(frame)
    made = SimResult(pixels, True, len(pixels.x) + 75, 75, 0, 0, 0, 0.0, 0.0)
    return replace(made, zero_normals=twin.zero_normals(frame), **changes)


def test_every_case():
    cases = corner_cases.cases()
    assert len({case.name for case in cases}) == len(cases) >= 40
    rows = table.run_cases(cases)
    for row in rows:
        assert not row.failures, f"{row.case}: {row.failures}"
        assert row.mismatches == 0 and row.max_lsb <= row.bound_lsb <= 1, row.case
    assert sum(row.zero_normals for row in rows) > 800


def test_cases_are_legal_and_the_same_at_every_call():
    for frame, again in zip(corner_cases.frames(), corner_cases.frames(), strict=True):
        assert np.array_equal(frame.spans, again.spans)
        assert not illegal_spans(frame, C).any()
        assert (frame.spans["x"] + frame.spans["length"]).max() <= frame.width <= C.max_size


def test_model_and_reference_agree_on_zero_vectors():
    counts = [(twin.zero_normals(f), reference.zero_normals(f)) for f in corner_cases.frames()]
    assert all(a == b for a, b in counts) and sum(a for a, _ in counts) > 800


def test_shared_edges():
    assert not table.shared_edges(20_000).failures


def test_shared_edges_are_seen_to_break(monkeypatch):
    """With another rule for edges, or inexact crossings, pixels are missing or drawn twice."""
    exact = visibility._crossing

    def other_rule(xa, ya, xb, yb, y):
        on_a_centre = (xa - visibility.GRID // 2) % visibility.GRID == 0
        return exact(xa, ya, xb, yb, y) + ((xb > xa) & on_a_centre)

    def inexact(xa, ya, xb, yb, y):
        slope = ((xb - xa) / (yb - ya)).astype(np.float16)
        x = (xa + slope * (y - ya)) / visibility.GRID
        return np.ceil(x - 0.5).astype(np.int64)

    for crossing in (other_rule, inexact):
        monkeypatch.setattr(visibility, "_crossing", crossing)
        assert table.shared_edges(2000).failures


def test_long_run():
    row = table.long_run(20_000)
    assert not row.failures and row.mismatches == 0 and row.pixels > 50_000
    assert row.zero_normals > 0 and row.max_lsb <= row.bound_lsb


@pytest.mark.parametrize("what", ["pixel", "lost", "extra", "zero", "illegal", "stall", "hang"])
def test_a_row_fails(what):
    """Each thing that can go wrong in the RTL shows in the row."""
    case = next(c for c in corner_cases.cases() if c.full_rate)
    got = result(case.frame)
    if what == "pixel":
        got.pixels.rgb[5, 1] ^= 1
    elif what == "lost":
        p = got.pixels
        got.pixels = twin.Pixels(p.x[1:], p.y[1:], p.rgb[1:], p.last[1:])
    else:
        got = replace(got, **{
            "extra": {"extra_pixels": 1}, "zero": {"zero_normals": 1},
            "illegal": {"illegal_spans": 1}, "stall": {"stall_cycles": 1},
            "hang": {"complete": False},
        }[what])  # fmt: skip
    assert not table.judge(case, [result(case.frame)]).failures
    assert table.judge(case, [result(case.frame), got] if what == "pixel" else [got]).failures


def test_an_error_beyond_the_bound_fails(monkeypatch):
    """RTL and model may agree and both be wrong: the reference decides."""
    case = next(c for c in corner_cases.cases() if c.name == "normals of 2⁻²⁰")
    shade = phong_unit.shade
    monkeypatch.setattr(phong_unit, "shade", lambda *a: np.minimum(shade(*a) + 1, 255))
    failures = table.judge(case, [result(case.frame)]).failures
    assert any("the largest error is" in line for line in failures)


def perfect_rtl(jobs, config):
    """What perfect RTL of `config` would give, in place of `simulate_jobs`."""
    return [replace(result(job.frame), pixels=twin.render(job.frame, config)) for job in jobs]


@pytest.mark.parametrize("name", ["quadratic_spans_18", "squaring_18"])
def test_a_method_on_every_corner_case(monkeypatch, name):
    monkeypatch.setattr(table, "simulate_jobs", perfect_rtl)
    row = table.method_row(CONFIGS[name], table.plain_cases())
    assert row.pop("failures") == []
    kept = {of["name"]: of for of in recorded.figures("stability")["methods"]}
    assert tuple(kept) == PORTS_OF_DEFAULT
    assert not differences(row, kept[name]), "make stability RECORD=1"
    assert row["cases"] == len(table.plain_cases()) > 40 and row["max_lsb"] <= row["bound_lsb"]


def test_every_method_shows_all_corner_cases_as_its_model_does():
    for of in recorded.figures("stability")["methods"]:
        assert of["mismatches"] == 0, of["name"]
        assert of["refused"] == 0 or of["name"].startswith("quadratic_spans")
        assert of["bound_lsb"] is None or of["max_lsb"] <= of["bound_lsb"]


def test_a_method_beyond_its_bound_fails(monkeypatch):
    case = next(c for c in table.plain_cases() if c.name == "normals of 2⁻²⁰")
    monkeypatch.setattr(table, "simulate_jobs", perfect_rtl)
    config = CONFIGS["lines_32"]
    assert not table.method_row(config, [case])["failures"]
    render = twin.render
    monkeypatch.setattr(twin, "render", lambda *a: bright(render(*a)))
    assert "is beyond" in table.method_row(config, [case])["failures"][0]
    broken = [replace(got, pixels=bright(got.pixels)) for got in perfect_rtl([case], config)]
    monkeypatch.setattr(table, "simulate_jobs", lambda *_: broken)
    assert "RTL and model differ" in table.method_row(config, [case])["failures"][0]


def bright(pixels):
    """`pixels`, each colour two codes brighter."""
    return twin.Pixels(pixels.x, pixels.y, np.minimum(pixels.rgb + 2, 255), pixels.last)


def test_spans_that_quadratic_spans_cannot_take_are_refused():
    config = CONFIGS["quadratic_spans_18"]
    said = {case.name: error_budget.refusal(case.frame, config) for case in table.plain_cases()}
    refused = {name for name, reason in said.items() if reason}
    assert {"normals of a few units", "slope at full scale", "ends 179.99° apart"} <= refused
    assert not refused & {"spans of 3", "ends 120° apart", "grazing light, eye at 40°"}
    assert said["normals of a few units"].startswith("span 0 is not for quadratic_spans: its norm")
    assert not any(error_budget.refusal(case.frame, C) for case in table.plain_cases())


def test_broken_designs_fail_their_cases(tmp_path):
    """Lit at Zn = 0, and no clamp of S: the cases that are about it fail, another does not."""
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    for module, old, new in (
        ("normalizer", "(z != 0) & (two_sided", "(two_sided"),
        ("colour_channel", "|sum_p4[SUM_BITS-1:SPECULAR_FRACTION]", "sum_p4[SUM_BITS-1]"),
    ):
        text = design.module_file(module, rtl).read_text()
        assert text.count(old) == 1
        design.module_file(module, rtl).write_text(text.replace(old, new))
    wrong = ("zero vector, two-sided", "saturation", "terminator, eye opposite exactly")
    chosen = [c for c in corner_cases.cases() if c.name in (*wrong, "spans of 3")]
    rows = table.run_cases(chosen, Bench("frame_bench", C, rtl=rtl))
    assert {row.case for row in rows if row.failures} == set(wrong)
