# SPDX-License-Identifier: MIT
"""Several lights: the same bits in turns and side by side, the model's rules, scenes and bounds."""

from __future__ import annotations

import dataclasses
import shutil

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, pruning, reference
from phong75.model.config import DEFAULT as C
from phong75.model.config import TECHNIQUES, UNITS, Config
from phong75.model.frame import Frame, FurtherLight, InputError, fitted
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import pack_frame, read_spans, turns, write_spans, written_for
from phong75.model.studies.random_frames import random_frame, random_lights
from phong75.model.twin.lights import lights_unit
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.frame.locate import locate
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from tests.configuration_tests import unrelated

SEED = 75
SCENE = """
size = [48, 36]
{top}
{lights}
[materials.m]
{material}
[[objects]]
shape = "sphere"
segments = 12
rings = 6
material = "m"
"""


@pytest.fixture
def scene(tmp_path):
    """Loads a scene with the text of its lights and of its material."""

    def load(lights: str = "", material: str = "", top: str = ""):
        path = tmp_path / "scene.toml"
        path.write_text(SCENE.format(lights=lights, material=material, top=top))
        return load_scene(path)

    return load


def light(**keys) -> str:
    return "[[lights]]\n" + "\n".join(f"{key} = {value}" for key, value in keys.items()) + "\n"


# -- the same bits ---------------------------------------------------------------------------------


@pytest.mark.parametrize("lights", [2, 5])
def test_all_ways_give_the_same_bits(lights):
    """In turns, side by side and mixed, under stalls, also of normals that are no vector."""
    frame = random_lights([SEED, lights], 300, 12, lights)
    unrelated(frame, SEED)
    want = twin.render(frame)
    for units in [u for u in UNITS if u <= lights]:
        config = fitted(C, frame, units)
        jobs = SimJob(frame), SimJob(frame, idle=64, stall=100, seed=SEED)
        bench = Bench("frame_bench", config, quick=True)
        results = simulate_jobs(list(jobs), config, bench)
        for result in results:
            assert metrics.compare(want, result.pixels).mismatches == 0, units
        assert results[0].stall_cycles == 0, "a gap between pixels or spans"
        pixels, each = len(want), turns(frame, config)
        assert results[0].cycles == pixels * each + results[0].latency_cycles - each


def test_a_light_that_adds_nothing_changes_no_bit():
    """The first light of several is, to the bit, the light of a build for one."""
    frame = random_frame(SEED, 500, 12, two_sided=True)
    nothing = np.zeros_like(frame.spans["start"])
    colours = frame.materials.diffuse
    one = np.full_like(colours, C.coefficient.one)
    further = [FurtherLight((1, 2), nothing, nothing, colours, one)]
    several = dataclasses.replace(frame, further=further)
    assert fitted(C, several).sums_lights and not fitted(C, frame).sums_lights
    assert metrics.compare(twin.render(frame), twin.render(several)).mismatches == 0


def test_a_broken_design_is_located(tmp_path):
    """The break shows as wrong pixels, and the stage is named."""
    frame = random_lights(SEED, 150, 5, 2)
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    file = design.module_file("light_terms", rtl)
    text = file.read_text()
    broken = text.replace("{COSINE_BITS{lit}}", "{COSINE_BITS{1'b1}}")
    assert broken != text
    file.write_text(broken)
    config = fitted(C, frame)
    bench = Bench("frame_bench", config, rtl=rtl, quick=True)
    got = simulate_jobs([SimJob(frame)], config, bench)[0].pixels
    compared = metrics.compare(twin.render(frame), got)
    assert compared.mismatches > 1
    assert "stage light_terms.sum" in locate(frame, compared.first.index, config, rtl)


# -- what a frame is built for ---------------------------------------------------------------------


def test_one_white_light_is_todays_hardware(scene):
    frame = front_end(scene(light(direction=[0, -1, 1]))).frame
    assert fitted(C, frame) == C
    grey = front_end(scene(light(direction=[0, -1, 1], diffuse=[0.5, 0.5, 0.5]))).frame
    assert fitted(C, grey) == C, "a light's colour is part of Cp"


@pytest.mark.parametrize(
    ("keys", "material"),
    [
        ({"specular": [1.0, 0.5, 0.5]}, ""),
        ({"diffuse": [1.5, 1.0, 1.0]}, "color = [0.9, 0.9, 0.9]"),
        ({"ambient": [0.9, 0.9, 0.9]}, "ambient = [0.8, 0.8, 0.8]"),
    ],
)
def test_one_light_with_a_colour_or_a_sum_beyond_1(scene, keys, material):
    made = front_end(scene(light(direction=[0.3, -1, 0.4], **keys), material))
    config = fitted(C, made.frame)
    assert (config.lights, config.turns, config.highlight_colour) == (1, 1, True)
    error = np.abs(twin.render(made.frame).rgb - reference.render(made.frame)).max()
    assert error <= error_budget.bound_lsb(made.frame)


def test_configurations_that_cannot_be():
    for wrong in ({"lights": 9}, {"lights": 0}, {"units": 3, "lights": 4}, {"units": 2},
                  {"lights": 2, "normal_method": "none"}, {"lights": 2, "hold_unlit": True},
                  {"lights": 2, "constant_exponent": (512,)}):  # fmt: skip
        with pytest.raises(ValueError):
            Config(**wrong)
    frame = random_lights(SEED, 5, 3, 3)
    with pytest.raises(InputError, match="4 units for 3 lights"):
        fitted(C, frame, 4)
    with pytest.raises(InputError, match="gouraud shading has no units"):
        fitted(TECHNIQUES["gouraud"], frame, 2)
    with pytest.raises(InputError, match="3 lights in a build for 2"):
        twin.render(frame, Config(lights=2))
    with pytest.raises(ValueError, match="3 lights in a build for 2"):
        pack_frame(frame, Config(lights=2))


def test_pruning_keeps_the_pixels():
    for seed, changed in ((1, "weight"), (2, "exponent"), (3, "ambient"), (4, "")):
        frame = random_lights(seed, 200, 9, 3, two_sided=seed > 2)
        if changed:
            table = getattr(frame.materials, changed)
            table[:] = C.exponent.one if changed == "exponent" else 0
        frame.spans["material"] &= 3
        pruned, rows = pruning.prune(frame)
        assert "lights" in [row.feature for row in rows] and pruned.idle_material_bits == 2
        assert metrics.compare(twin.render(frame), twin.render(frame, pruned)).mismatches == 0
        assert not pruning.missing(frame, pruned, fitted(C, frame))
    wide = Config(lights=8, units=4)
    frame = random_lights(5, 50, 5, 3, coloured=False)
    pruned, _ = pruning.prune(frame, wide)
    assert (pruned.lights, pruned.units) == (3, 2)


# -- scenes ----------------------------------------------------------------------------------------


def test_coefficients_are_the_products_of_light_and_material(scene):
    lights = light(direction=[0, -1, 0], color=[1.0, 0.5, 0.25], ambient=[0.1, 0.2, 0.3])
    lights += light(direction=[0, -1, 1], diffuse=[0.5, 0.5, 0.0], specular=[2.0, 0.0, 1.0])
    material = "ambient = [0.5, 0.4, 0.2]\ndiffuse = [0.8, 0.6, 0.4]\n"
    material += "specular = [0.5, 0.5, 0.9]\nemission = [0.1, 0.0, 0.2]\nn = 7"
    frame = front_end(scene(lights, material, "ambient = [0.5, 0.5, 1.0]")).frame
    real, table = C.coefficient.real, frame.materials
    second = frame.further[0]
    for codes, want in (
        (table.ambient, [0.1 + 0.5 * 0.6, 0.4 * 0.7, 0.2 + 0.2 * 1.3]),
        (table.diffuse, [0.8, 0.3, 0.1]), (table.highlight, [0.5, 0.25, 0.225]),
        (second.diffuse, [0.4, 0.3, 0.0]), (second.highlight, [1.0, 0.0, 0.9]),
    ):  # fmt: skip
        assert real(codes[0]) == pytest.approx(want, abs=2.0**-17), want
    assert (table.weight[0] == C.coefficient.one).all(), "with specular, W is 1"


@pytest.mark.parametrize("technique", TECHNIQUES)
def test_every_technique_shows_the_scene_itself(technique):
    config = TECHNIQUES[technique]
    for name in ("coloured_lights", "lamps"):
        made = front_end(load_scene(name, (160, 120)), config)
        codes = twin.render(made.frame, config).rgb
        ports = np.abs(codes - reference.render(made.frame, config)).max()
        assert ports <= error_budget.bound_lsb(made.frame, config)
        exact = reference.render_exact(made.frame, made.exact, config)
        assert np.abs(codes - exact).max() < ports + 0.02, "input error"
        if technique != "phong":
            assert not made.frame.further and fitted(config, made.frame) == config


def test_a_light_turns_with_its_frame(scene):
    """Lights in another order: the same picture, but for rounding."""
    one = light(direction=[1, -1, 0.5], color=[0.8, 0.2, 0.1])
    other = light(direction=[-1, -0.5, 0.7], color=[0.1, 0.3, 0.9])
    pictures = [front_end(scene(text)) for text in (one + other, other + one)]
    a, b = (reference.render_exact(made.frame, made.exact) for made in pictures)
    assert np.abs(a - b).max() < 1e-9
    a, b = (twin.render(made.frame).rgb for made in pictures)
    assert np.abs(a - b).max() <= 1


@pytest.mark.parametrize(
    ("lights", "material", "message"),
    [
        (light(direction=[0, 0, 1]) * 9, "", "lights 9 lights, but there are at most 8"),
        ("[light]\nname = 'a'\n" + light(direction=[0, 0, 1]), "", "cannot both be given"),
        (light(direction=[0, 0, 1], diffuse=[3, 3, 3]), "diffuse = [1.0, 0.5, 0.5]",
         "diffuse light of light `light` on material 0: 3 is above 1.99998"),
        (light(direction=[0, 0, 1], specular=[2, 2, 2], name='"key"'), "",
         "highlight of light `key` on material 0: 2 is above 1.99998"),
        (light(direction=[0, 0, 1], ambient=[4, 4, 4]), "ambient = [0.5, 0.5, 0.5]",
         "ambient light of material 0: 2.5 is above 1.99998"),
        (light(color=[1, 1, 1], diffuse=[1, 1, 1], specular=[1, 1, 1]), "",
         "color has no effect beside diffuse and specular"),
        ("", "color = [1, 1, 1]\nambient = [1, 1, 1]\ndiffuse = [1, 1, 1]",
         "color has no effect beside ambient and diffuse"),
        (light(direction=[0, 0, 1], hue=3), "", r"lights\[0\].hue: unknown key"),
    ],
)  # fmt: skip
def test_mistakes_give_one_line(scene, lights, material, message):
    with pytest.raises(InputError, match=message) as caught:
        front_end(scene(lights, material))
    assert "\n" not in str(caught.value)


# -- bounds ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_errors_are_within_the_bound(seed):
    """Random directions, lengths and colours; also normals that are not one vector."""
    frame = random_lights([SEED, seed], 1500, 20, 2 + seed * 2, two_sided=seed > 1)
    for light in frame.further:
        light.diffuse >>= 2
        light.highlight >>= 3
    if seed % 2:
        unrelated(frame, seed)
    error = np.abs(twin.render(frame).rgb - reference.render(frame)).max()
    bound = error_budget.bound_lsb(frame)
    assert error <= bound, (error, bound)


def test_the_bound_grows_with_the_lights():
    bounds = []
    for lights in (1, 2, 4, 8):
        frame = random_lights(SEED, 100, 9, lights)
        for light in frame.further:
            light.diffuse[:] = light.highlight[:] = C.coefficient.one // 4
        bounds.append(error_budget.bound_lsb(frame))
    steps = np.diff(bounds) / [1, 2, 4]
    assert (steps > 0).all() and steps.max() / steps.min() < 1.5, "about the same for each light"


def test_each_stage_is_within_its_bound():
    """cos(i) of a further light against the reference's, and 1/|N0| for its length."""
    frame = random_lights(SEED, 2000, 9, 3)
    span = np.repeat(np.arange(len(frame.spans)), frame.spans["length"])
    k = np.arange(len(span)) - np.repeat(
        np.cumsum(frame.spans["length"]) - frame.spans["length"], frame.spans["length"]
    )
    config = fitted(C, frame)
    normals = lights_unit.interpolate(frame, span, k, config)
    traces = [{} for _ in range(3)]
    lights_unit.shade(
        normals, frame.spans["material"][span].astype(np.int64), frame, config, traces
    )
    exact = np.clip(reference.shared_length(frame), -1, 1)
    for number, reach in ((1, 0), (2, 1)):
        cosine = C.cosine.real(traces[number]["light_scale.round"][3])
        lit = traces[number]["light_align.lit"][0] == 1
        error = np.abs(cosine - np.abs(exact[number, :, 2]))[lit].max()
        assert error <= error_budget.cosine(config, reach=error_budget.reaches(frame)[reach])


# -- span files ------------------------------------------------------------------------------------


@pytest.mark.parametrize("units", [1, 2, 4])
def test_a_span_file_gives_back_the_frame(units, tmp_path):
    frame = random_lights(SEED, 50, 9, 5)
    config = fitted(C, frame, units)
    write_spans(tmp_path / "spans", frame, config)
    build = written_for(tmp_path / "spans", C)
    assert (build.lights, build.units, build.highlight_colour) == (5, units, True)
    again = read_spans(tmp_path / "spans", build)
    assert pack_frame(again, build) == pack_frame(frame, config)
    assert metrics.compare(twin.render(frame), twin.render(again)).mismatches == 0
    assert len(pack_frame(frame, config)) == 50 * turns(frame, config) * (32, 64, 128)[units // 2]


def _frame_file(tmp_path, change) -> Frame:
    frame = random_lights(SEED, 4, 3, 3)
    path = tmp_path / "spans"
    write_spans(path, frame, fitted(C, frame, 2))
    build = written_for(path, C)
    path.write_bytes(change(path.read_bytes()))
    return read_spans(path, build)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda data: data[:-25] + bytes([data[-25] ^ 1]) + data[-24:], "a unit without a light"),
        (lambda data: data[:-49] + bytes([data[-49] ^ 8]) + data[-48:], "its records differ in x"),
        (lambda data: data[:-64], "spans of 128 bytes are announced"),
        (lambda data: data.replace(b'"lights":[{', b'"lights":[3,{', 1), "JSON|body_offset"),
    ],
)
def test_a_wrong_span_file_is_refused(change, message, tmp_path):
    with pytest.raises(InputError, match=message):
        _frame_file(tmp_path, change)
