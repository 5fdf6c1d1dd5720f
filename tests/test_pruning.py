"""Leaving out: what a frame does not need goes, and no pixel changes."""

from __future__ import annotations

import dataclasses
import os
import shutil

import numpy as np
import pytest

from model import metrics, pruning, twin
from model.config import DEFAULT as C
from model.config import digits, levels
from model.frame import Frame, MaterialTable
from model.registers import writes
from model.scene import bundled_scenes, load_scene
from model.scene_to_spans import front_end
from model.spans import illegal_spans
from model.twin.specular_power import specular_power
from scripts import prune, records
from sim.build import ROOT, Bench
from sim.elaborate import instances
from sim.latency import latencies
from sim.run_frame import Job, simulate_jobs
from tests.modules.frames import random_frame

SEED = 1975
SIZE = (96, 72)
KEPT = 3  # random scenes in `make test`


def plain(seed=SEED, spans: int = 300, longest: int = 12, **changes) -> Frame:
    """A random frame that needs everything, but for `changes` to its materials: functions of
    (table, rng) by the name of what they change."""
    rng = np.random.default_rng(seed)
    frame = random_frame(seed, spans, longest, two_sided=True)
    frame.materials.exponent[:4] = np.array([1, 1.5, 10, 128]) * C.exponent.one
    steepest(frame, rng)
    for change in changes.values():
        change(frame, rng)
    return frame


def steepest(frame, rng):
    """A span with the steepest slopes there are, between normals of the size of unit ones."""
    one = C.normal.one
    s = frame.spans[:1]
    s["length"], s["start"], s["step"] = 2, -one + 1, 2 * one - 2


def dull(frame, rng):
    frame.materials.weight[:] = 0


def cosine_only(frame, rng):
    frame.materials.exponent[:] = C.exponent.one


def tables_only(frame, rng):
    n = C.exponent.quantize(rng.uniform(1.01, 128, C.materials))
    frame.materials.exponent[:] = np.where(n == C.exponent.one, n + 1, n)


def sharp(frame, rng):
    least = pruning.vanishing_exponent(C)
    n = rng.integers(least, 128 * C.exponent.one, C.materials)
    frame.materials.exponent[:] = n
    frame.materials.exponent[:3] = least, least + 1, C.exponent.one


def even_weight(frame, rng):
    frame.materials.weight[:] = frame.materials.weight[:, :1]


def no_diffuse(frame, rng):
    frame.materials.diffuse[:] = 0


def no_environment(frame, rng):
    frame.materials.ambient[:] = 0


def grey(frame, rng):
    frame.materials.ambient[:] = frame.materials.ambient[:, :1]
    frame.materials.diffuse[:] = frame.materials.diffuse[:, :1]


def one_sided(frame, rng):
    frame.two_sided = False


def one_exponent(frame, rng):
    frame.materials.exponent[:] = C.exponent.quantize(24.5)


def one_weight(frame, rng):
    frame.materials.weight[:] = frame.materials.weight[0, 0]


def one_ambient(frame, rng):
    frame.materials.ambient[:] = frame.materials.ambient[0]


def one_diffuse(frame, rng):
    frame.materials.diffuse[:] = frame.materials.diffuse[0]


def opposite(frame, rng):  # the half-way vector is always the frame's own; here hx < 0
    frame.half_vector = (-abs(frame.half_vector[0]), frame.half_vector[1])


def size_of_unit(frame, rng):
    """Normals whose largest component is 1/2 to 1 everywhere, except at the steepest span's ends,
    which are as large."""
    s = frame.spans[1:]
    largest = rng.integers(0, 3, len(s))
    row = np.arange(len(s))
    start = rng.integers(-C.normal.one // 2, C.normal.one // 2, (len(s), 3))
    start[row, largest] = np.where(rng.random(len(s)) < 0.5, 3, -3) * (C.normal.one // 4)
    s["start"], s["step"] = start, rng.integers(-(1 << 24), 1 << 24, (len(s), 3))


def gentle(frame, rng):
    s = frame.spans
    s["step"] >>= 5


def still_x(frame, rng):
    frame.spans["step"][:, 0] = 0


def still_y(frame, rng):
    frame.spans["step"][:, 1] = 0


def still_z(frame, rng):
    frame.spans["step"][:, 2] = 0


def few_materials(frame, rng):
    frame.spans["material"] &= 7


def narrow_picture(frame, rng):
    frame.spans["x"] %= 240


def low_picture(frame, rng):
    frame.spans["y"] &= 511


#: feature: (what makes it go, what goes with it beside the half-way vector, which always does).
ALONE = {
    "specular": (
        dull,
        {
            "power_function",
            "power_bypass",
            "log_octaves",
            "weight_function",
            "constant_exponent",
            "constant_weight",
        },
    ),
    "power_function": (cosine_only, {"power_bypass", "log_octaves", "constant_exponent"}),
    "power_bypass": (tables_only, set()),
    "log_octaves": (sharp, set()),
    "weight_function": (even_weight, set()),
    "diffuse": (no_diffuse, {"constant_diffuse"}),
    "environment": (no_environment, {"constant_ambient"}),
    "channels": (grey, set()),
    "two_sided": (one_sided, set()),
    "constant_half_vector": (opposite, set()),
    "constant_exponent": (one_exponent, {"power_bypass", "log_octaves"}),
    "constant_weight": (one_weight, {"weight_function"}),
    "constant_ambient": (one_ambient, set()),
    "constant_diffuse": (one_diffuse, set()),
    "constant_shift": (size_of_unit, set()),
    "interpolate_x": (still_x, set()),
    "interpolate_y": (still_y, set()),
    "interpolate_z": (still_z, set()),
    "idle_step_bits": (gentle, set()),
    "idle_material_bits": (few_materials, set()),
    "idle_x_bits": (narrow_picture, set()),
    "idle_y_bits": (low_picture, set()),
}


def without(feature: str, frame: Frame):
    """The full configuration without that one feature, as `prune` would leave it out."""
    pruned, _ = pruning.prune(frame)
    return dataclasses.replace(C, name="alone", **{feature: getattr(pruned, feature)})


def check(frame: Frame, config, jobs=()):
    """RTL and model of `config` give the pixels of the full model; nothing is unsupported."""
    full = twin.render(frame)
    assert metrics.compare(full, twin.render(frame, config)).mismatches == 0, "pruned model"
    bench = Bench("frame_bench", config, quick=True)
    results = simulate_jobs([Job(frame), *jobs], config, bench)
    for result in results:
        compared = metrics.compare(full, result.pixels)
        assert compared.mismatches == 0, f"pruned RTL: {compared.first}"
        assert result.complete and not result.extra_pixels and not result.unsupported
        assert result.latency_cycles == latencies(config)["pixel"] + 3


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
    assert not (pruned.specular or pruned.diffuse or pruned.environment)
    assert len(twin.render(frame, pruned).x) == 0


def test_powers_of_large_exponents_vanish_below_one_half():
    """All versines from 1/2 on, at the smallest exponent that leaves the octaves out, and not one
    below it."""
    v = np.arange(C.versine.one // 2, C.versine.max + 1)
    least = pruning.vanishing_exponent(C)
    assert not specular_power(v, np.full(len(v), least), C).any()
    assert specular_power(v[:1], np.array([least - C.exponent.one]), C).any()


def test_digits_of_constants():
    """Canonical signed digits, against the definition."""
    for constant in [*range(300), 26214, 131071, 2**18 - 1, 2**17 + 1]:
        rest, count = constant, 0
        while rest:
            if rest % 2:
                digit = 2 - rest % 4
                rest, count = rest - digit, count + 1
            rest //= 2
        assert digits(constant) == count, constant
        assert 2 ** levels(constant) >= count


# -- pixels ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("feature", ALONE)
def test_each_feature_alone(feature):
    frame = plain(change=ALONE[feature][0])
    check(frame, without(feature, frame))


@pytest.mark.parametrize("two_sided", [False, True])
def test_holding_unlit_normals_changes_no_pixel(two_sided):
    frame = plain()
    frame.two_sided = two_sided
    config = dataclasses.replace(C, name="hold", hold_unlit=True)
    check(frame, config, [Job(frame, idle=100, stall=64, seed=SEED)])


@pytest.mark.parametrize("scene", bundled_scenes())
def test_bundled_scene(scene):
    frame = front_end(load_scene(scene, SIZE)).frame
    check(frame, pruning.prune(frame)[0], [Job(frame, idle=64, stall=100, seed=SEED)])


def random_scene(seed: int) -> Frame:
    """A frame with a random choice of what it needs."""
    rng = np.random.default_rng(seed)
    frame = random_frame(seed, 120, 16, two_sided=bool(rng.random() < 0.5))
    for change in (dull, even_weight, no_diffuse, no_environment, grey, one_exponent, one_weight,
                   one_ambient, one_diffuse, cosine_only, sharp, tables_only):  # fmt: skip
        if rng.random() < 0.2:
            change(frame, rng)
    used = rng.choice(C.materials, rng.choice([1, 1, 2, 5, 16]), replace=False)
    frame.spans["material"] = rng.choice(used, len(frame.spans))
    return frame


@pytest.mark.parametrize("seed", range(int(os.environ.get("PHONG_RANDOM_SCENES", KEPT))))
def test_random_scene(seed):
    frame = random_scene(SEED + seed)
    config, _ = pruning.prune(frame)
    check(frame, config)
    if seed >= KEPT:  # nobody will run this build again
        shutil.rmtree(Bench("frame_bench", config, quick=True).folder)


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
    config = dataclasses.replace(C, normal_method="differences")
    pruned, rows = pruning.prune(plain(), config)
    assert pruned == config and all(row.needed for row in rows)


def test_another_method_is_pruned_in_rtl():
    frame = front_end(load_scene("teapot", SIZE)).frame
    config = dataclasses.replace(C, power_method="squaring", root_method="quadratic")
    pruned = pruning.prune(frame, config)[0]
    result = simulate_jobs([Job(frame)], pruned, Bench("frame_bench", pruned, quick=True))[0]
    compared = metrics.compare(twin.render(frame, config), result.pixels)
    assert compared.mismatches == 0 and not result.unsupported, compared.first


def test_a_sharp_power_is_the_same_without_octaves():
    """Every versine, at the smallest exponent that leaves the octaves out."""
    without_octaves = dataclasses.replace(C, log_octaves=False)
    v = np.arange(C.versine.max + 1)
    n = np.full(len(v), pruning.vanishing_exponent(C))
    assert np.array_equal(specular_power(v, n, C), specular_power(v, n, without_octaves))


# -- safety ----------------------------------------------------------------------------------------


def test_what_does_not_fit_is_flagged():
    """Frames that need each feature in turn, on a build that has none of them."""
    bare = plain(SEED, 40)
    for change in (dull, no_environment, grey, one_sided, one_diffuse):
        change(bare, np.random.default_rng(SEED))
    config, _ = pruning.prune(bare)
    assert not (config.specular or config.environment or config.two_sided) and config.channels == 1

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
        "environment": need(ambient=7),
        "channels": need(diffuse=np.array(bare.materials.diffuse[5]) // np.array([1, 2, 3])),
        "two_sided": need(two_sided=True),
        "constant_diffuse": need(diffuse=bare.materials.diffuse[5] ^ 1),
    }
    frames = [bare, *wanted.values(), bare]
    bench = Bench("frame_bench", config, quick=True)
    results = simulate_jobs([Job(f) for f in frames], config, bench)
    assert results[0].unsupported == results[-1].unsupported == 0
    assert not pruning.missing(bare, config)
    for (feature, frame), result in zip(wanted.items(), results[1:], strict=False):
        assert result.unsupported > 0, feature
        assert any(line.startswith(feature) for line in pruning.missing(frame, config)), feature


def test_spans_that_do_not_fit_are_flagged_once_each():
    """Random spans of all kinds on builds that are narrowed in every way: as many as the model
    says, with and without stalls."""
    fit = plain()
    for change in (size_of_unit, still_y, gentle, few_materials, narrow_picture, low_picture):
        change(fit, np.random.default_rng(SEED))
    fit.spans["start"][0, 0] = C.normal.one * 3 // 4  # the span that was steep, without a step in y
    names = ("constant_shift", "interpolate_y", "idle_step_bits", "idle_material_bits",
             "idle_x_bits", "idle_y_bits")  # fmt: skip
    narrow = pruning.prune(fit)[0]
    config = dataclasses.replace(C, name="narrow", **{n: getattr(narrow, n) for n in names})
    assert all(getattr(config, n) != getattr(C, n) for n in names)
    assert not pruning.unsupported_spans(fit, config).any()
    frames = [fit]
    for change in ("start", "step", "material", "x", "y"):  # one in three of each is any
        rng = np.random.default_rng(SEED)
        frame, other = dataclasses.replace(fit, spans=fit.spans.copy()), plain(SEED + 1)
        rows = np.flatnonzero(rng.random(len(fit.spans)) < 1 / 3)
        frame.spans[change][rows] = other.spans[change][rows]
        frames.append(frame)
    for frame in frames:
        frame.spans = frame.spans[~illegal_spans(frame, C)]
        frame.spans["last"][-1] = True
    wanted = [int(pruning.unsupported_spans(frame, config).sum()) for frame in frames]
    assert wanted[0] == 0 and min(wanted[1:]) > 20 and max(wanted) < len(fit.spans)
    bench = Bench("frame_bench", config, quick=True)
    jobs = [Job(f, stall=s, idle=s) for s in (0, 100) for f in frames]
    results = simulate_jobs(jobs, config, bench)
    assert [r.unsupported for r in results] == 2 * wanted
    for job, result in zip(jobs, results, strict=True):
        fits = ~pruning.unsupported_spans(job.frame, config)
        pixel = np.repeat(fits, job.frame.spans["length"])
        want = twin.render(job.frame)
        assert np.array_equal(result.pixels.rgb[pixel], want.rgb[pixel])


def test_a_pruned_build_needs_fewer_writes():
    frame = front_end(load_scene("teapot", SIZE)).frame
    pruned, _ = pruning.prune(frame)
    assert len(writes(frame, C)) > 40 and writes(frame, pruned) == []


def test_latency_falls():
    for scene in bundled_scenes():
        pruned, _ = pruning.prune(front_end(load_scene(scene, SIZE)).frame)
        assert latencies(pruned)["pixel"] < latencies(C)["pixel"], scene


# -- the table -------------------------------------------------------------------------------------


def test_the_readme_shows_the_last_measurement_of_these_builds():
    """The table is that of the record, and the record is of the builds of today's analysis."""
    record = records.load("prune")
    assert prune.for_readme(record) in (ROOT / "README.md").read_text()
    today = {case.name: case for case in prune.cases()}
    assert [found["name"] for found in record["table"]] == list(today)
    for found in record["table"]:
        config = today[found["name"]].config
        assert found["left_out"] == prune.left_out(config), f"{found['name']}: make prune SCENE=all"
        assert found["pruned"]["latency"] == latencies(config)["pixel"] + 3


def test_the_bars():
    """DSP multipliers: 8 for diffuse colour, 6 for grey, none for the older techniques, and for
    the teapot a quarter fewer than in the full design; measured, and as it is elaborated. No
    pruned build simulates slower than the full one."""
    rows = {found["name"]: found for found in records.load("prune")["table"]}
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
    found = dict.fromkeys(prune.COLUMNS, 3) | {"constant_multipliers": 0, "constant_lut_sites": 0}
    pruned = found | {"constant_multipliers": 2, "constant_lut_sites": 70, "dsp": 1}
    pruned["gate_equivalents"] = pruned["clock_mhz"] = None
    cells = prune.row({"name": "a", "pruned": pruned, "full": found}).strip("| ").split(" | ")
    assert cells[:4] == ["a", "1 (33 %)", "2, 70", "3 (100 %)"]
    assert len(cells) == prune.HEADER.splitlines()[1].count("|") - 1
    assert [k for k, cell in enumerate(cells) if cell == "-"] == [6, 8]


@pytest.mark.parametrize("wrong", ["--gates=2", "--seeds=x", "--seeds=101", "--what"])
def test_wrong_input_is_one_line(wrong, capsys):
    assert prune.main(["--scene=all", wrong]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.count("\n") == 1
