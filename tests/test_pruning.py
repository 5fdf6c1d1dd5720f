"""Leaving out: what a frame does not need goes, and no pixel changes."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import metrics, pruning
from phong75.model.config import DEFAULT as C
from phong75.model.frame import Frame, MaterialTable, with_lights
from phong75.model.front.scene import bundled_scenes, load_scene
from phong75.model.registers import writes
from phong75.model.scene_to_frame import front_end
from phong75.model.twin.core.register_map import unsupported_write, vanishing_exponent
from phong75.model.twin.core.specular_power_tables import specular_power_tables
from phong75.model.twin.pruning.constant_multiplier import (
    constant_multiplier,
    levels,
    signed_digits,
)
from phong75.model.twin.pruning.span_guard import span_guard
from phong75.scripts import main, prune, recorded
from phong75.scripts.docs import tables
from phong75.sim.build import Bench
from phong75.sim.elaborate import instances
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from phong75.sim.latency import latencies
from tests.configuration_tests import (
    ALONE,
    ConfigurationTest,
    configuration_test,
    dull,
    grey,
    misfits,
    narrow,
    no_ambient,
    one_diffuse,
    one_sided,
    plain,
    random_configuration_test,
    random_scene,
)

SEED = 1975
SIZE = (96, 72)
KEPT = 3  # random scenes in `make test`


# -- the analysis ----------------------------------------------------------------------------------


def test_what_needs_everything_keeps_everything():
    pruned, rows = pruning.prune(plain())
    assert {row.feature for row in rows if not row.needed} == {"constant_half_vector"}
    assert [row.feature for row in rows] == list(pruning.FEATURES)
    rest = dataclasses.replace(pruned, name=C.name, constant_half_vector=())
    assert rest == C
    assert all(row.why and row.saves for row in rows)


@pytest.mark.parametrize("feature", ALONE)
def test_a_feature_goes_when_its_reason_goes(feature):
    change, others = ALONE[feature]
    _, rows = pruning.prune(plain(change=change))
    gone = {row.feature for row in rows if not row.needed}
    assert gone == {feature, "constant_half_vector"} | others


def test_every_feature_is_in_the_analysis_and_in_the_tests():
    assert set(ALONE) == set(pruning.FEATURES)
    assert all(f.name not in pruning.FEATURES or f.default in (True, 3, (), 0)
               for f in dataclasses.fields(C))  # fmt: skip


def test_only_materials_that_spans_name_count():
    frame = plain(change=dull)
    frame.materials.weight[3] = C.coefficient.one
    assert pruning.prune(frame)[0].specular
    frame.spans["material"][frame.spans["material"] == 3] = 2
    assert not pruning.prune(frame)[0].specular


def test_the_analysis_is_pure():
    frame = plain()
    before = [a.copy() for a in (frame.spans, frame.materials.weight, frame.materials.ambient)]
    assert pruning.prune(frame) == pruning.prune(frame)
    after = (frame.spans, frame.materials.weight, frame.materials.ambient)
    assert all(np.array_equal(a, b) for a, b in zip(before, after, strict=True))


def test_an_empty_frame_needs_nothing():
    frame = plain()
    frame.spans = frame.spans[:0]
    pruned, _ = pruning.prune(frame)
    assert not (pruned.specular or pruned.diffuse or pruned.ambient)
    assert len(twin.render(frame, pruned).x) == 0


def test_powers_of_large_exponents_vanish_below_one_half():
    """All versines from 1/2 on, at the smallest exponent that leaves the octaves out, and not one
    below it."""
    v = np.arange(C.versine.one // 2, C.versine.max + 1)
    least = vanishing_exponent(C)
    assert not specular_power_tables(v, np.full(len(v), least), C).any()
    assert specular_power_tables(v[:1], np.array([least - C.exponent.one]), C).any()


def test_digits_of_constants():
    """Canonical signed digits, against the definition."""
    word = np.arange(-5, 6)
    for constant in [*range(300), 26214, 131071, 2**18 - 1, 2**17 + 1]:
        rest, count = constant, 0
        while rest:
            if rest % 2:
                digit = 2 - rest % 4
                rest, count = rest - digit, count + 1
            rest //= 2
        digits = signed_digits(constant)
        assert len(digits) == count, constant
        assert all(b - a > 1 for (_, a), (_, b) in itertools.pairwise(digits)), constant
        assert 2 ** levels(constant) >= count
        assert constant_multiplier(word, constant).tolist() == (constant * word).tolist()


# -- pixels ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("scene", bundled_scenes())
def test_bundled_scene(scene):
    frame = front_end(load_scene(scene, SIZE)).frame
    jobs = SimJob(frame), SimJob(frame, idle=64, stall=100, seed=SEED)
    test = ConfigurationTest(pruning.prune(frame)[0], *jobs, full=C)
    assert test.model_failure() == test.failure() == ""


@pytest.mark.parametrize("seed", range(KEPT))
def test_random_scene(seed):
    """More of them: `make prune-random`."""
    test = random_configuration_test(SEED + seed)
    assert test.model_failure() == test.failure() == ""


@pytest.mark.parametrize("method", [
    {"power_method": "squaring"}, {"power_method": "schlick"}, {"normal_method": "none"},
    {"normal_method": "dot_first"}, {"root_method": "table", "root_newton_steps": 1},
])  # fmt: skip
def test_other_methods_are_pruned_to_their_own_pixels(method):
    config = dataclasses.replace(C, name="method", **method)
    for seed in range(20):
        frame = random_scene(SEED + seed)
        pruned, _ = pruning.prune(frame, config)
        assert all(getattr(pruned, name) == value for name, value in method.items())
        own, full = twin.render(frame, pruned), twin.render(frame, config)
        assert metrics.compare(full, own).mismatches == 0, seed


def test_a_method_without_a_guard_is_left_whole():
    config = dataclasses.replace(C, normal_method="quadratic_spans")
    pruned, rows = pruning.prune(plain(), config)
    assert pruned == config and all(row.needed for row in rows)


def test_another_method_is_pruned_in_rtl():
    frame = front_end(load_scene("teapot", SIZE)).frame
    config = dataclasses.replace(C, power_method="squaring", root_method="quadratic")
    pruned = pruning.prune(frame, config)[0]
    result = simulate_jobs([SimJob(frame)], pruned, Bench("frame_bench", pruned, quick=True))[0]
    compared = metrics.compare(twin.render(frame, config), result.pixels)
    assert compared.mismatches == 0 and not result.unsupported, compared.first


def test_a_sharp_power_is_the_same_without_octaves():
    """Every versine, at the smallest exponent that leaves the octaves out."""
    without_octaves = dataclasses.replace(C, log_octaves=False)
    v = np.arange(C.versine.max + 1)
    n = np.full(len(v), vanishing_exponent(C))
    assert np.array_equal(
        specular_power_tables(v, n, C), specular_power_tables(v, n, without_octaves)
    )


# -- safety ----------------------------------------------------------------------------------------


def test_what_does_not_fit_is_flagged():
    """Frames that need each feature in turn, on a build that has none of them."""
    bare = plain(SEED, 40)
    for change in (dull, no_ambient, grey, one_sided, one_diffuse):
        change(bare, np.random.default_rng(SEED))
    config, _ = pruning.prune(bare)
    assert not (config.specular or config.ambient or config.two_sided) and config.channels == 1

    def need(**parts) -> Frame:
        table = MaterialTable(*(getattr(bare.materials, n).copy() for n in
                                ("ambient", "diffuse", "weight", "exponent")))  # fmt: skip
        frame = dataclasses.replace(bare, materials=table)
        for name, value in parts.items():
            if hasattr(table, name):
                getattr(table, name)[5] = value
            else:
                setattr(frame, name, value)
        frame.spans = bare.spans.copy()
        frame.spans["material"][7] = 5
        return frame

    wanted = {
        "specular": need(weight=C.coefficient.one // 3),
        "ambient": need(ambient=7),
        "channels": need(diffuse=np.array(bare.materials.diffuse[5]) // np.array([1, 2, 3])),
        "two_sided": need(two_sided=True),
        "constant_diffuse": need(diffuse=bare.materials.diffuse[5] ^ 1),
    }
    frames = [bare, *wanted.values(), bare]
    bench = Bench("frame_bench", config, quick=True)
    results = simulate_jobs([SimJob(f) for f in frames], config, bench)
    assert results[0].unsupported == results[-1].unsupported == 0
    assert not pruning.missing(bare, config)
    for (feature, frame), result in zip(wanted.items(), results[1:], strict=False):
        assert result.unsupported > 0, feature
        assert any(line.startswith(feature) for line in pruning.missing(frame, config)), feature


def test_spans_and_writes_that_do_not_fit_are_known():
    """The configuration tests contain spans and writes that the builds do not support."""
    fit, config = narrow()
    assert not span_guard(fit.spans, config).any()
    bad = span_guard(misfits(fit, SEED).spans, config)
    assert 20 < bad.sum() < len(bad)
    for name in ("specular", "constant_exponent", "two_sided", "channels"):
        build = configuration_test(name)
        words = build.jobs[-1].writes
        flagged = sum(unsupported_write(*word, build.config) for word in words)
        assert 0 < flagged < len(words) - 100, name


def test_a_pruned_build_needs_fewer_writes():
    frame = front_end(load_scene("teapot", SIZE)).frame
    pruned, _ = pruning.prune(frame)
    assert len(writes(frame, C)) > 40 and writes(frame, pruned) == []


def test_latency_falls():
    for scene in bundled_scenes():
        frame = front_end(load_scene(scene, SIZE)).frame
        pruned, full = pruning.prune(frame)[0], with_lights(C, frame)
        assert latencies(pruned)["pixel"] < latencies(full)["pixel"], scene


# -- the table -------------------------------------------------------------------------------------


def test_the_record_is_of_the_builds_of_todays_analysis():
    builds = recorded.figures("prune")["builds"]
    today = {case.name: case for case in prune.cases()}
    assert [found["name"] for found in builds] == list(today)
    for found in builds:
        config = today[found["name"]].config
        assert found["left_out"] == prune.left_out(config), f"{found['name']}: make prune SCENE=all"
        assert found["pruned"]["latency"] == latencies(config)["pixel"] + 3


def test_the_bars():
    """DSP multipliers: 8 for diffuse colour, 6 for grey, none for Gouraud and flat shading, and for
    the teapot a quarter fewer than in the full design; measured, and as it is elaborated. No
    pruned build simulates slower than the full one."""
    rows = {found["name"]: found for found in recorded.figures("prune")["builds"]}
    for name, found in rows.items():
        pruned, of_full = (found[key]["simulation_clocks_per_s"] for key in ("pruned", "full"))
        assert pruned >= of_full, name
    dsp = {name: found["pruned"]["dsp"] for name, found in rows.items()}
    assert dsp["diffuse"] <= 8 and dsp["diffuse grey"] <= 6
    assert dsp["gouraud"] == dsp["flat"] == 0
    full = rows["teapot"]["full"]["dsp"]
    assert dsp["teapot"] <= 0.75 * full
    assert instances(pruning.BY_HAND["diffuse"])["multiplier"] <= 8
    assert instances(pruning.BY_HAND["diffuse grey"])["multiplier"] <= 6
    teapot = pruning.prune(front_end(load_scene("teapot", SIZE)).frame)[0]
    built = instances(teapot)
    assert built["multiplier"] <= 0.75 * instances(C)["multiplier"]
    assert built["constant_multiplier"] == rows["teapot"]["pruned"]["constant_multipliers"]


def test_what_was_not_measured_is_a_dash():
    found = dict.fromkeys(tables.PRUNING, 3) | {"lut_sites": 3, "constant_multipliers": 0}
    found["constant_lut_cells"] = 0
    pruned = found | {"constant_multipliers": 2, "constant_lut_cells": 70, "dsp": 1}
    pruned["gate_equivalents"] = pruned["clock_mhz"] = None
    cells = tables.pruning_row("a", pruned, found)
    assert cells[:4] == ["a", "1 (33 %)", "2, 70", "3 (100 %)"]
    header = tables.pruning([{"name": "teapot", "pruned": pruned, "full": found}]).split("\n")[0]
    assert len(cells) == header.count("|") - 1
    assert [k for k, cell in enumerate(cells) if cell == tables.DASH] == [6, 8]


@pytest.mark.parametrize("wrong", ["--gates=1", "--seeds=x", "--seeds=101", "--what"])
def test_wrong_input_is_one_line(wrong, capsys):
    assert main.main(["prune", "all", wrong]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
