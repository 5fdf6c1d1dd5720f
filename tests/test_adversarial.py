# SPDX-License-Identifier: MIT
"""The worst inputs found, replayed in RTL, and the search that found them."""

import sys

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import error_budget, reference
from phong75.model.config import DEFAULT as C
from phong75.model.front.scene import bundled_scenes
from phong75.model.spans import illegal_spans
from phong75.model.studies import adversarial, aligned, corner_cases
from phong75.model.studies.adversarial import FAMILIES
from phong75.scripts import recorded
from phong75.scripts.stability import (
    adversarial_cases,
    error_rows,
    power_row,
    scene_errors,
)
from phong75.sim.frame import corner_cases as table
from tests.records import differences

PROVEN = recorded.figures("prove")["families"]
CERTIFIED = {
    family: row["certified_lsb"] for family, row in zip(FAMILIES, PROVEN, strict=True)
}  # fmt: skip
QUICK = {"points": 512, "rounds": 60, "examples": 60, "climbs": 1}


def test_the_worst_inputs_come_out_of_the_rtl_as_found():
    rows = table.run_cases(adversarial_cases())
    for row in rows:
        assert not row.failures and row.mismatches == 0, f"{row.case}: {row.failures}"
    scenes = [table.scene_case(name) for name in bundled_scenes()]
    errors = error_rows(scene_errors(scenes, table.results(scenes)), rows)
    for row, kept in zip(errors, recorded.figures("stability")["errors"], strict=True):
        assert not differences(row, kept), "the record is old: make stability"
        assert 0.5 < row["adversarial_lsb"] <= row["adversarial_bound_lsb"], row
        assert row["adversarial_lsb"] <= row["bound_lsb"], row
        assert row["scenes_lsb"] <= row["adversarial_lsb"], "a scene is worse than the search"


def test_the_rows_are_counted():
    single = ("shared edges", "powers", "long run", "large frame")
    rows = len(corner_cases.cases()) + len(FAMILIES) + len(bundled_scenes()) + len(single)
    kept = recorded.figures("stability")["rows"]
    assert len(kept) == rows and all(row["verdict"] == "ok" for row in kept), "make stability"


def test_the_worst_inputs_are_legal():
    assert [(r["limit"], r["steep"]) for r in adversarial.kept()] == [
        (f.limit, f.steep) for f in FAMILIES
    ]
    for row in adversarial.kept():
        frame = adversarial.frame(row)
        assert not illegal_spans(frame, C).any()
        assert 0 <= row["ambient"] and row["ambient"] + row["diffuse"] <= C.coefficient.one
        assert C.exponent.one <= row["exponent"] <= row["limit"] * C.exponent.one
        weight = np.array(row["weight"])
        assert weight.min() >= 0 and weight.max() <= C.coefficient.one
        assert row["steep"] or len(set(row["weight"])) == 1
        assert abs(np.hypot(*row["half_vector"]) / C.half_vector.one - 1) < 2**-16
        pixels, exact = twin.render(frame), reference.render(frame)
        assert abs(np.abs(pixels.rgb - exact).max() - row["error_lsb"]) < 1e-9


@pytest.mark.parametrize("family", FAMILIES, ids=lambda f: f.name)
def test_a_short_search(family):
    """It finds errors beyond rounding, within the bound, and the same ones again."""
    found = adversarial.search(family, **QUICK)
    assert 0.505 < found["error_lsb"] <= error_budget.bound_lsb(adversarial.frame(found))
    assert found["error_lsb"] <= CERTIFIED[family]
    assert found == adversarial.search(family, **QUICK)


@pytest.mark.parametrize("family", [FAMILIES[0], FAMILIES[-1]], ids=lambda f: f.name)
def test_a_short_search_around_the_place_of_the_largest_bound(family):
    row = next(r for r in PROVEN if (r["limit"], r["steep"]) == (family.limit, family.steep))
    place = aligned.place(row["search"]["at"])
    quick = {"points": 1 << 15, "rounds": 1, "kept": 60, "tries": 64}
    found = aligned.search(family, place, **quick)
    least = 0.515 if family.limit == 10 else 0.6
    assert least < found["error_lsb"] <= CERTIFIED[family]
    assert found == aligned.search(family, place, **quick)
    half = np.array(found["half_vector"])
    assert abs(np.hypot(*half) - C.half_vector.one) <= 5**0.5 / 2


def test_the_search_sees_a_bound_that_is_too_low(monkeypatch):
    """It would have caught the paper's form of 1 - cos(s), whose error grows with n."""

    def papers(unit, half_vector, config, trace=None):
        hx, hz = half_vector
        x, _, z = unit
        n_h = (hx * x + hz * z) >> config.half_vector.fraction
        cos_s = 2 * n_h * n_h - (1 << 2 * config.unit.fraction)
        v = (1 << 2 * config.unit.fraction) - np.maximum(cos_s, 0)
        shift = 2 * config.unit.fraction - config.versine.fraction
        return np.clip(v >> shift, 0, config.versine.max)

    monkeypatch.setattr(sys.modules["phong75.model.twin.core.shading_unit"], "reflection", papers)
    found = adversarial.search(FAMILIES[2], **QUICK)
    assert found["error_lsb"] > CERTIFIED[FAMILIES[2]]


def test_the_power_alone():
    errors = adversarial.power_errors()
    assert not power_row(errors).failures
    assert errors == recorded.figures("stability")["powers"], "the record is old: make stability"
    rows = [{"n": 20, "max_error": 0.0002, "bound": 0.0001, "codes": 1}]
    assert len(power_row(rows).failures) == 2
