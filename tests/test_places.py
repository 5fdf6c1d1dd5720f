# SPDX-License-Identifier: MIT
"""Lights at a place, and lights that fall with the distance: geometry, exact picture, rules."""

from __future__ import annotations

import shutil
from dataclasses import replace

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, reference
from phong75.model.analysis.pruning import prune
from phong75.model.config import DEFAULT as C
from phong75.model.config import MAX_JUMPS, TECHNIQUES
from phong75.model.frame import InputError, distance_range, falloff_codes, fitted, with_lights
from phong75.model.front.camera import light_frame
from phong75.model.front.scene import Light, load_scene
from phong75.model.front.scene_to_spans import make_frame
from phong75.model.places import (
    MOST_TURN,
    Falloff,
    Place,
    carried,
    frames,
    half_vectors,
    of_eye,
    toward,
)
from phong75.model.reflectance import power_words
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import read_spans, write_spans
from phong75.model.studies.light_places import measure
from phong75.model.studies.random_frames import placed, random_lights
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.frame.locate import locate
from phong75.sim.frame.run_frame import SimJob, simulate_jobs

RNG = np.random.default_rng(75)


def unit(count: int) -> np.ndarray:
    v = RNG.normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def scene_of(text: str, folder, size=(64, 48)):
    """A small torus under `text`, the lights of a scene file."""
    path = folder / "scene.toml"
    path.write_text(
        f'{text}\n[[objects]]\nshape = "torus"\nsegments = 16\nsides = 8\n'
        "material = { color = [0.6, 0.4, 0.3], n = 20, W = 0.4 }\n"
    )
    return load_scene(path, size)


@pytest.mark.parametrize("point", ["centre", "vertex"])
def test_where_flat_shading_takes_the_intensity(point, tmp_path):
    scene = scene_of(f'flat_point = "{point}"\n[light]\nposition = [0.2, -0.4, 1.0]', tmp_path)
    given = []

    def shader(normal, material, frame, exact, config, points):
        given.append(points)
        return np.zeros_like(normal), np.zeros_like(normal)

    make_frame(scene, TECHNIQUES["flat"], shader)
    mesh = scene.objects[0].mesh
    corners = mesh.vertices[mesh.faces] @ light_frame(scene.light, scene.camera.axes[2])[0].T
    want = corners.mean(axis=1) if point == "centre" else corners[:, 0]
    np.testing.assert_allclose(given[0], np.repeat(want, 3, axis=0), atol=1e-15)


# -- geometry --------------------------------------------------------------------------------------


def test_frames_are_light_frames():
    lights, eye = unit(200), unit(1)[0]
    lights[0], lights[1] = eye, -eye
    axes, angle = frames(lights, eye)
    for light, own, a in zip(lights, axes, angle, strict=True):
        want, u = light_frame(light, eye)
        assert np.allclose(own, want, atol=1e-7)
        assert np.allclose(of_eye(a[None])[0], u, atol=1e-7)
    halves = half_vectors(axes, angle)[2:]
    wanted = lights[2:] + eye
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    assert np.allclose(halves, wanted)


def test_carried_frames_turn_by_the_least_rotation():
    axes, _ = frames(unit(300), unit(1)[0])
    before, after = unit(300), unit(300)
    after[0], after[1] = before[0], -before[1]
    got = carried(axes, before, after)
    rotation = np.einsum("nij,nik->njk", axes, got).swapaxes(1, 2)  # takes axes to got
    assert np.allclose(np.einsum("nij,nkj->nik", got, got), np.eye(3))
    turned = np.einsum("nij,nj->ni", rotation, before)
    assert np.allclose(turned[2:], after[2:]) and np.allclose(got[1], axes[1])
    angle = np.arccos(np.clip((before * after).sum(axis=1), -1, 1))
    trace = np.einsum("nii->n", rotation)
    assert np.allclose(trace[2:], 1 + 2 * np.cos(angle[2:]))  # no further turn about the axis


def test_a_point_at_the_light_is_lit_from_the_eye():
    position, eye = np.array([3.0, -2.0, 5.0]), np.array([0, 0, 1.0])
    points = np.array([position, position + 1e-3, [0, 0, 0]])
    got = toward(position, points, eye)
    assert (got[0] == eye).all() and np.allclose(np.linalg.norm(got, axis=1), 1)
    assert np.allclose(got[2], position / np.linalg.norm(position))


@pytest.mark.parametrize("falloff, distance, want", [
    (Falloff((1.0, 3.0), (1.0, 0.5)), [0, 1, 2, 3, 9], [1, 1, 0.75, 0.5, 0.5]),
    (Falloff(coefficients=(1.0, 0.5, 0.25)), [0, 2, 4], [1, 1 / 3, 1 / 7]),
    (Falloff(coefficients=(0.0, 0.0, 1.0)), [0, 0.5, 2], [1, 1, 0.25]),
])  # fmt: skip
def test_falloff(falloff, distance, want):
    assert np.allclose(falloff.factor(np.array(distance, float)), want)


def test_the_table_spans_what_varies():
    distances = [np.array([2.0, 9.0])]
    assert distance_range(distances, Falloff((3.0, 5.0), (1.0, 0.0))) == (3.0, 3 + 6 / 1.9)
    assert distance_range(distances, Falloff((3.0, 8.0), (1.0, 0.0))) == (3.0, 8.0)
    assert distance_range(distances, Falloff((0.0, 20.0), (1.0, 0.0))) == (2.0, 9.0)
    assert distance_range(distances, Falloff((20.0, 30.0), (1.0, 0.0))) == (2.0, 9.0)
    assert distance_range([np.array([2.0])], None) == (2.0, 3.0)
    codes = falloff_codes(Falloff((3.0, 8.0), (1.0, 0.0)), 3.0, 8.0, C)
    assert (codes == C.coefficient.quantize(np.linspace(1, 0, C.weight_points))).all()


# -- the exact picture -----------------------------------------------------------------------------


def test_exact_picture_by_hand(tmp_path):
    """The paper's vectors at each pixel's own point, one pixel after the other."""
    scene = scene_of(
        '[camera]\nprojection = "perspective"\n[light]\nposition = [0.6, -0.9, 1.3]\n'
        "attenuation = { constant = 0.5, linear = 0.4, quadratic = 0.2 }", tmp_path,
    )  # fmt: skip
    front = front_end(scene)
    frame, exact = front.frame, front.exact
    axes, _ = light_frame(scene.light, scene.camera.axes[2])
    got = reference.render_exact(frame, exact) / 255
    u, place, row = scene.camera.axes[2], scene.lights[0].place, 0
    for span in range(len(frame.spans)):
        for k in range(frame.spans["length"][span]):
            p = exact.point[span] + k * exact.point_step[span]
            point = axes.T @ (p[:3] / p[3])
            # The point is the one that the pixel shows.
            screen = scene.camera.project(point, scene.width, scene.height)
            place_on_screen = frame.spans["x"][span] + k + 0.5, frame.spans["y"][span] + 0.5
            assert np.allclose(screen[:2] / screen[2], place_on_screen, atol=2e-3)
            n = axes.T @ (exact.start[span] + k * exact.step[span])
            n /= np.linalg.norm(n)
            away = place.position - point
            r = np.linalg.norm(away)
            light = away / r
            cosine = n @ light
            intensity = exact.ambient[0].copy()
            if cosine > 0:
                s = max((2 * cosine * n - light) @ u, 0)
                factor = min(1, 1 / (0.5 + 0.4 * r + 0.2 * r * r))
                intensity += factor * (exact.diffuse[0] * cosine + 0.4 * s**20)
            assert np.allclose(got[row], np.clip(intensity, 0, 1), atol=1e-9)
            row += 1
    assert row == len(got) > 500


def test_a_far_light_is_one_at_infinity():
    scene = load_scene("torus", (64, 48))
    far = scene.lights[0].direction * 1e7
    near = replace(scene, lights=[replace(scene.lights[0], place=Place(far, far))])
    one, other = front_end(scene), front_end(near)
    assert (one.frame.spans["length"] == other.frame.spans["length"]).all()
    difference = reference.render_exact(one.frame, one.exact) - reference.render_exact(
        other.frame, other.exact
    )
    assert np.abs(difference).max() < 1e-3
    codes = twin.render(one.frame).rgb - twin.render(other.frame).rgb
    assert np.abs(codes).max() <= 1 and (codes != 0).mean() < 0.01


@pytest.mark.parametrize("technique", ["gouraud", "flat"])
def test_intensities_of_vertices_use_their_own_points(technique, tmp_path):
    scene = scene_of(
        '[[lights]]\nposition = [0.2, -0.4, 1.0]\n'
        "attenuation = { distance = [0.5, 2], values = [1, 0.2] }\n"
        '[[lights]]\ndirection = [1, 0, 0.5]\ncolor = [0.2, 0.3, 0.9]', tmp_path,
    )  # fmt: skip
    config = TECHNIQUES[technique]
    front = front_end(scene, config)
    codes = twin.render(front.frame, config).rgb
    assert np.abs(codes - reference.render_exact(front.frame, front.exact, config)).max() < 0.6
    flatter = front_end(scene_of("[light]\nposition = [0.2, -0.4, 1.0]", tmp_path), config)
    assert len(np.unique(twin.render(flatter.frame, config).rgb, axis=0)) > 20


# -- the hardware's rules --------------------------------------------------------------------------


def test_the_default_rule_is_the_best():
    rows = {(row.rule, row.most_turn is not None): row for row in measure()}
    best = rows["half", True]
    assert best.max_lsb < 1.5 and best.rms_lsb < 0.31
    assert all(best.max_lsb <= r.max_lsb and best.rms_lsb <= r.rms_lsb for r in rows.values())
    assert rows["half", False].rms_lsb < rows["middle", False].rms_lsb < rows["face", False].rms_lsb
    assert rows["face", False].max_lsb > 50  # a face as large as the scene


def test_spans_turn_by_no_more_than_asked():
    front = front_end(load_scene("near_light", (160, 120)))
    spans, exact = front.frame.spans, front.exact
    ends = [exact.point, exact.point + (spans["length"] - 1)[:, None] * exact.point_step]
    for place in exact.places[:2]:
        a, b = (toward(place.position, p[:, :3] / p[:, 3:], exact.eye) for p in ends)
        turn = np.arccos(np.clip((a * b).sum(axis=1), -1, 1))
        assert turn.max() <= MOST_TURN + 1e-6


@pytest.mark.parametrize("half, falls", [(True, False), (False, True), (True, True)])
def test_random_frames_are_within_the_bound(half, falls):
    for lights in (1, 3):
        frame = placed(random_lights(lights, 400, 9, lights), lights, half, falls)
        config = with_lights(C, frame)
        error = twin.render(frame).rgb - reference.render(frame, config)
        assert 0.45 < np.abs(error).max() <= error_budget.bound_lsb(frame, config) < 1.5


def test_bundled_scenes_are_within_the_bound_and_near_the_exact_picture():
    for name in ("near_light", "warnock"):
        front = front_end(load_scene(name, (160, 120)))
        config = with_lights(C, front.frame)
        rgb = twin.render(front.frame, config).rgb
        ports = np.abs(rgb - reference.render(front.frame, config)).max()
        assert ports <= error_budget.bound_lsb(front.frame, config) < 0.61
        exact = np.abs(rgb - reference.render_exact(front.frame, front.exact, config))
        assert exact.max() < 1.5, name


def test_parallel_faces_at_other_depths_differ():
    """As the paper says of Warnock's pictures; without the falloff they are the same."""
    scene = load_scene("warnock", (320, 240))
    light = scene.lights[0]
    assert np.allclose(light.direction, scene.camera.axes[2])
    shades = {}
    for name, place in (("warnock", light.place), ("same", Place())):
        front = front_end(replace(scene, lights=[replace(light, place=place)]))
        # The left faces of the pyramids: one normal, one colour each without the falloff.
        normal = front.exact.start / np.linalg.norm(front.exact.start, axis=1, keepdims=True)
        flat = (front.frame.spans["length"] > 3) & (np.abs(front.exact.step).max(axis=1) < 1e-12)
        face = flat & (np.abs(normal - normal[flat][0]).max(axis=1) < 1e-6)
        shown = np.repeat(face, front.frame.spans["length"])
        shades[name] = np.unique(twin.render(front.frame).rgb[shown, 0])
    assert len(shades["same"]) == 1
    assert np.ptp(shades["warnock"]) > 60


# -- builds and files ------------------------------------------------------------------------------


def test_a_light_needs_no_more_than_it_uses():
    one = fitted(C, front_end(load_scene("warnock", (64, 48))).frame)
    assert one.attenuation and not one.span_half_vector and not one.highlight_colour
    near = fitted(C, front_end(load_scene("near_light", (64, 48))).frame)
    assert (near.lights, near.attenuation, near.span_half_vector) == (3, True, True)
    assert fitted(C, front_end(load_scene("teapot", (64, 48))).frame) == C
    frame = front_end(load_scene("near_light", (64, 48))).frame
    for feature in ("attenuation", "span_half_vector"):
        with pytest.raises(InputError, match="which the build leaves out"):
            with_lights(replace(near, **{feature: False}), frame)


def test_builds_without_room_for_attenuation_are_refused():
    for bits in ({"weight_index_bits": 4}, {"weight_index_bits": 9}):
        with pytest.raises(ValueError, match="attenuation has no addresses"):
            replace(C, attenuation=True, **bits)
    with pytest.raises(ValueError, match="fewer rows"):
        replace(C, attenuation=True, lights=8, material_bits=2)
    with pytest.raises(ValueError, match="attenuation and jumps cannot be in one build"):
        replace(C, attenuation=True, weight_jumps=1)


@pytest.mark.parametrize("scene, message", [
    ('interpolation = "quadratic"\n[light]\nposition = [0, 0, 2]', "for a light with a direction"),
    ('lit_faces_only = true\n[light]\nposition = [0, 0, 2]', "is for a light at infinity"),
])  # fmt: skip
def test_scenes_that_cannot_have_a_light_at_a_place(scene, message, tmp_path):
    with pytest.raises(InputError, match=message):
        front_end(scene_of(scene, tmp_path))


def test_curves_with_lights_at_a_place_and_jumps_without_a_fall(tmp_path):
    """A curve of cos(s) goes with lights that fall with the distance, a jump does not."""
    frame = front_end(load_scene("near_light", (64, 48))).frame
    table = frame.materials
    table.curve = power_words(table.exponent, C)
    table.curve_jumps = np.zeros((C.materials, MAX_JUMPS, 3), np.int64)
    config = fitted(C, frame)
    assert config.has_curves and config.attenuation
    error = np.abs(twin.render(frame, config).rgb - reference.render(frame, config)).max()
    assert error <= error_budget.bound_lsb(frame, config)
    table.curve_jumps[:, 0] = (1, 1000, 100)
    with pytest.raises(InputError, match="attenuation and jumps cannot be in one build"):
        fitted(C, frame)


def test_a_scene_decides_what_is_built(tmp_path):
    near = "[light]\nposition = [0.2, -0.4, 1.0]"
    matte = near.replace("position", "attenuation = { linear = 1 }\nposition")
    for text, change, left_out in (
        (near, lambda table: None, set()),
        (matte, lambda table: table.weight.fill(0), {"specular", "span_half_vector"}),
        (matte.replace("[0.2, -0.4, 1.0]", '"eye"'), lambda table: None, set()),
    ):
        frame = front_end(scene_of(text, tmp_path)).frame
        change(frame.materials)
        config, rows = prune(frame)
        full = with_lights(C, frame)
        assert all(getattr(full, name) and not getattr(config, name) for name in left_out)
        assert config.lights == 1 and with_lights(config, frame) == config
        assert (twin.render(frame, config).rgb == twin.render(frame).rgb).all()
        named = {row.feature: row.needed for row in rows}
        assert named.get("attenuation", False) == full.attenuation == config.attenuation


@pytest.mark.parametrize("units", [1, 2])
def test_span_files_keep_half_vectors_and_distances(units, tmp_path):
    frame = front_end(load_scene("near_light", (64, 48))).frame
    config = fitted(C, frame, units)
    write_spans(tmp_path / "frame", frame, config)
    again = read_spans(tmp_path / "frame", config)
    for name in ("half_vectors", "depths", "falloff"):
        assert (getattr(again, name) == getattr(frame, name)).all()
    assert (twin.render(again, config).rgb == twin.render(frame, config).rgb).all()
    frame.half_vectors[2, 7] = 0
    write_spans(tmp_path / "frame", frame, config)
    with pytest.raises(InputError, match="span 7: a half vector has length zero"):
        read_spans(tmp_path / "frame", config)


@pytest.mark.parametrize("light, message", [
    ("direction = [0, 0, 1]\nposition = [0, 0, 1]", "direction and position cannot both be given"),
    ("direction = [0, 0, 1]\nattenuation = { linear = 1 }", "attenuation needs a position"),
    ('direction = [0, 0, 1]\nplace = "half"', "place needs a position"),
    ('position = [0, 0, 1]\nplace = "vertex"', "place"),
    ('position = "sun"', "position = 'sun' is not a list of numbers"),
    ('position = "eye"\nrelative_to = "camera"', "relative_to has no effect on a light at the eye"),
    ("position = [0, 0, 1]\nattenuation = 3", "attenuation = 3 is not a table"),
    ("position = [0, 0, 1]\nattenuation = { constant = 0 }", "attenuation has no term"),
    ("position = [0, 0, 1]\nattenuation = { linear = -1 }", r"attenuation.linear = -1 is outside"),
    ("position = [0, 0, 1]\nattenuation = { distance = [1, 2], values = [1] }",
     "2 distances, but 1 values"),
    ("position = [0, 0, 1]\nattenuation = { distance = [2, 1], values = [1, 0] }",
     "do not increase"),
    ("position = [0, 0, 1]\nattenuation = { distance = [1, 2], values = [1, 2] }",
     r"values\[1\] = 2 is outside"),
])  # fmt: skip
def test_mistakes_in_a_light(light, message, tmp_path):
    with pytest.raises(InputError, match=message) as error:
        scene_of(f"[light]\n{light}", tmp_path)
    assert "\n" not in str(error.value) and "light" in str(error.value)


def test_places_in_axes_of_the_camera(tmp_path):
    camera = scene_of(
        "[camera]\ntarget = [0.1, 0.2, 0.3]\n[light]\nposition = [0, 0, 2]\n"
        'relative_to = "camera"', tmp_path,
    )  # fmt: skip
    want = np.array([0.1, 0.2, 0.3]) + 2 * camera.camera.axes[2]
    assert np.allclose(camera.lights[0].place.position, want)
    middle = scene_of("[light]\nposition = [0, 0, 0]", tmp_path)  # the middle of the torus
    assert np.allclose(middle.light, middle.camera.axes[2])
    assert isinstance(middle.lights[0], Light) and len(front_end(middle).frame.spans) > 0


# -- broken designs --------------------------------------------------------------------------------


def test_a_broken_design_is_located(tmp_path):
    """Without the clamp beyond the table pixels are wrong, and the stage is named."""
    frame = placed(random_lights(75, 60, 5, 1), 75, True, True)
    config, want = fitted(C, frame), twin.render(frame)
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    file = design.module_file("light_attenuation", rtl)
    clamp = "| {COSINE_BITS{depth[SIGN-1]}}"
    assert clamp in file.read_text()
    file.write_text(file.read_text().replace(clamp, ""))
    bench = Bench("frame_bench", config, rtl=rtl, quick=True)
    compared = metrics.compare(want, simulate_jobs([SimJob(frame)], config, bench)[0].pixels)
    assert compared.mismatches > 1
    assert "stage light_attenuation.factor" in locate(frame, compared.first.index, config, rtl)
