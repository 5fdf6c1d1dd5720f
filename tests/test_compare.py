# SPDX-License-Identifier: MIT
"""`phong75 compare`: true surfaces of scenes, the sheet, the table, and what makes it fail."""

import inspect
import json
import shutil
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from phong75.model import twin
from phong75.model.analysis.pictures import PERFECT_LSB
from phong75.model.config import TECHNIQUES
from phong75.model.front.scene import SHAPES, Light, load_scene
from phong75.model.studies import comparison_sheet, true_scene
from phong75.model.studies.comparison_sheet import (
    Basis,
    Box,
    Column,
    where_they_differ,
    write_sheet,
)
from phong75.model.studies.shadings import (
    FARTHEST_FACTOR,
    PHONG,
    SHADINGS,
    Shading,
    light_at_eye,
)
from phong75.model.studies.surfaces import Sphere, Torus
from phong75.model.studies.true_scene import NoTrueSurfaceError
from phong75.scripts import compare, main, recorded
from phong75.scripts.docs import tables
from phong75.sim import design
from phong75.sim.build import Bench, BuildError
from phong75.sim.frame.run_frame import SimJob, SimResult, simulate_jobs
from tests.records import differences
from tests.wrong_results import extra_pixel, far_away, lost_pixel, wrong_colour

GREY, BLUE, WHITE = (0xD3, 0xD7, 0xDC), (0x00, 0x57, 0xD8), (255, 255, 255)

#: Shapes that surfaces are known of, moved in every way, seen from near.
MOVED = """
size = [96, 72]
[camera]
projection = "perspective"
eye = [2.5, -4, 3]
target = [0, 0, 0.3]
fov = 40
[[objects]]
shape = "torus"
radius = 1.3
tube = 0.5
scale = [1, 0.8, -1.2]
rotate = [20, -30, 70]
[[objects]]
shape = "sphere"
radius = 0.7
scale = [1, 1.5, 0.6]
rotate = [0, 40, 10]
translate = [0.2, 0, 0.4]
material = { color = [0.2, 0.5, 0.3], n = 20 }
"""
SMALL = """
size = [48, 36]
[[objects]]
shape = "sphere"
segments = 8
rings = 4
"""


@pytest.fixture
def coarse(monkeypatch):
    """True surfaces from fewer triangles, for the time that takes."""
    finest = {name: count // 2 for name, count in true_scene.FINEST.items()}
    monkeypatch.setattr(true_scene, "FINEST", finest)


@pytest.fixture
def write(tmp_path):
    """Write a scene file; returns its path."""

    def write(text, name="small.toml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


# -- true surfaces ---------------------------------------------------------------------------------


def far_from_exact(path, monkeypatch):
    """RMS difference of exact normals and of triangles alone, for coarser and finer triangles."""
    scene, finest, found = load_scene(path), true_scene.FINEST, []
    for divisor in (4, 2):
        steps = {name: count // divisor for name, count in finest.items()}
        monkeypatch.setattr(true_scene, "FINEST", steps)
        objects = true_scene.true_objects(path)
        assert all(item.surface for item in objects)
        meshes = [replace(item, surface=None) for item in objects]
        exact, fine = (true_scene.true_picture(scene, given) for given in (objects, meshes))
        assert (fine.item == 0).sum() > 500 and (fine.item == 1).sum() > 300
        assert (exact.item != fine.item).mean() < 0.01
        both = (exact.item == fine.item) & (exact.item >= 0)
        found.append(np.sqrt(np.mean((exact.value - fine.value)[both] ** 2)))
    return found


@pytest.mark.parametrize("projection", ["perspective", "orthographic"])
def test_exact_normals_are_those_that_fine_triangles_come_to(write, monkeypatch, projection):
    """Twice as many steps, about a quarter of the difference."""
    text = MOVED
    if projection == "orthographic":
        text = text.replace("perspective", projection).replace("fov = 40\n", "")
    coarser, finer = far_from_exact(write(text), monkeypatch)
    assert finer < 0.1 and 3 < coarser / finer < 5


def test_a_surface_in_a_wrong_place_is_seen(write, monkeypatch):
    """The test above can fail: the surface turned by a degree."""
    turned = true_scene.rotation_matrix
    monkeypatch.setattr(true_scene, "rotation_matrix", lambda r: turned(np.asarray(r) + [0, 0, 1]))
    coarser, finer = far_from_exact(write(MOVED), monkeypatch)
    assert finer > 0.3 and coarser / finer < 2


def test_a_mesh_comes_to_its_true_surface():
    """Twice as many segments, a quarter of the difference."""
    scene, objects = load_scene("sphere", (160, 120)), true_scene.true_objects("sphere")
    true = true_scene.true_picture(scene, objects)
    errors = []
    for segments in (16, 32):
        item = replace(scene.objects[0], mesh=SHAPES["sphere"](1.0, segments, segments // 2))
        mesh = true_scene._rendered(replace(scene, objects=[item]))
        both = (mesh.item == 0) & (true.item == 0)
        errors.append(np.sqrt(np.mean((mesh.value - true.value)[both] ** 2)))
    assert 3 < errors[0] / errors[1] < 5


@pytest.mark.parametrize("surface", [Sphere(), Torus()])
def test_only_what_is_before_the_eye_is_seen(surface):
    """From within, along x: there is a surface on both sides."""
    origin, back = np.zeros((1, 3)), np.array([[1.0, 0.0, 0.0]])
    assert surface.see(origin, back)[1][0, 0] == pytest.approx(1)
    hit, normal = surface.see(origin, back, 0.0)
    inward = 1 if isinstance(surface, Torus) else -1  # the eye is in the hole, or in the sphere
    assert hit.all() and normal[0, 0] == pytest.approx(inward)
    assert not surface.see(origin, back, -2.0)[0].any()


def test_pixels_say_which_object_they_show(write):
    objects = "".join(
        f'[[objects]]\nshape = "pyramid"\nwidth = 1\nheight = 1\ntranslate = [{2 * k}, 0, 0]\n'
        for k in range(20)  # more than there are materials in the table
    )
    path = write(f"size = [200, 20]\n{objects}")
    scene = load_scene(path)
    seen = true_scene.objects_seen(scene)
    assert set(seen) == {-1, *range(20)}
    true = true_scene.true_picture(scene, true_scene.true_objects(path))
    np.testing.assert_array_equal(true.item, seen)  # a pyramid is its own true surface
    assert np.isnan(true.value).all(axis=1).tolist() == (seen < 0).tolist()


def test_every_shape_has_a_finest_mesh():
    for name, shape in SHAPES.items():
        steps = [
            parameter for parameter, of in inspect.signature(shape).parameters.items()
            if isinstance(of.default, int)
        ]  # fmt: skip
        assert set(steps) <= set(true_scene.FINEST), name


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        ("crease = 30\n", r"objects\[0\] has `crease`"),
        ('[[objects]]\nmesh = "a.obj"\n', r"objects\[1\] is a mesh"),
    ],
)
def test_what_has_no_true_surface(write, more, reason):
    with pytest.raises(NoTrueSurfaceError, match=reason):
        true_scene.true_objects(write(SMALL + more))


# -- the sheet -------------------------------------------------------------------------------------


def test_the_detail_is_where_the_pictures_differ_most():
    pictures = [np.full((50, 100, 3), 90, np.uint8) for _ in range(3)]
    assert where_they_differ(pictures) == Box(40, 20, 20, 10)
    pictures[1][32:40, 70:80, 1] += 30
    pictures[2][:, :30] += 2
    x, y, width, height = where_they_differ(pictures)
    assert (width, height) == (20, 10)
    assert x <= 70 and x + width >= 80 and y <= 32 and y + height >= 40


def sheet(path, differences, width=320, height=240):
    """The pixels of a sheet with columns of these differences, and the pictures in its columns."""
    rng = np.random.default_rng(75)
    rows = [rng.integers(0, 256, (1, width, 3), np.uint8) for _ in differences]
    films = [np.repeat(row, height, axis=0) for row in rows]
    shaded = np.ones((height, width), bool)
    shaded[:9] = False
    columns = [
        Column(f"column {k}", film, np.full((height, width), value), ["a line"])
        for k, (film, value) in enumerate(zip(films, differences, strict=True))
    ]
    write_sheet(path, "heading", columns, Basis("basis", films[0], shaded, []))
    with Image.open(path) as file:
        assert file.mode == "RGB" and not file.info
        return np.asarray(file), films


def test_the_sheet_shows_every_pixel_once(tmp_path):
    shown, films = sheet(tmp_path / "a.png", [0.4, 3.0])
    left, top, step = 26, 56, 328
    for k, film in enumerate((*films, films[0])):
        panel = shown[top : top + 240, left + k * step : left + k * step + 320]
        same = (panel == film).all(axis=-1)
        assert 0.97 < same.mean() < 1  # all but the frame of the detail


def test_differences_have_one_scale(tmp_path):
    shown, _ = sheet(tmp_path / "a.png", [0.5, 3.0, 3.0, 9.0, np.nan])
    panels = [shown[304 + 20, 26 + k * 328 + 10] for k in range(5)]
    assert tuple(panels[0]) == GREY and tuple(panels[4]) == BLUE
    assert (panels[1] == panels[2]).all() and (panels[1] != panels[3]).any()
    assert panels[3].sum() < panels[1].sum() < np.sum(GREY)
    assert tuple(shown[304 + 4, 26 + 328 + 10]) == WHITE  # no surface
    assert PERFECT_LSB == 0.5


@pytest.mark.parametrize(("width", "height"), [(1, 1), (3, 400), (1500, 90)])
def test_sheets_of_any_size(tmp_path, width, height):
    shown, _ = sheet(tmp_path / "a.png", [0.4, 3.0], width, max(height, 1))
    assert 300 < shown.shape[1] < 2400


def test_the_same_pixels_give_the_same_sheet(tmp_path):
    for name in "ab":
        sheet(tmp_path / name, [0.4, 3.0])
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


# -- the command, the RTL stood in for by the model ------------------------------------------------


def perfect(jobs, config, progress=None):
    """Simulations that do what the model does."""
    made = [twin.render(job.frame, config) for job in jobs]
    return [SimResult(pixels, True, len(pixels) + 70, 70, 0, 0, 0, 0.0, 0.0) for pixels in made]


def broken(technique, change):
    """Simulations in which `change` has altered the result of one technique."""

    def simulate(jobs, config, progress=None):
        results = perfect(jobs, config)
        if config.technique == technique:
            change(results[0])
        return results

    return simulate


@pytest.fixture
def start(tmp_path, coarse, monkeypatch, capsys):
    """`phong75 compare`: (exit code, stdout, lines of stderr without those of progress)."""

    def not_drawn(path, heading, columns, basis):
        path.touch()
        return Box(0, 0, 1, 1)

    def start(*arguments, simulate=perfect, draw=not_drawn):
        monkeypatch.setattr(compare, "simulate_jobs", simulate)
        monkeypatch.setattr(comparison_sheet, "write_sheet", draw)
        out = f"--out={tmp_path / 'out'}"
        code = main.main(["compare", *map(str, arguments), out])
        shown = capsys.readouterr()
        return code, shown.out, [x for x in shown.err.splitlines() if not x.endswith(" ...")]

    return start


def found(tmp_path):
    return json.loads((tmp_path / "out" / "comparison.json").read_text())


def test_a_good_comparison(start, write, tmp_path):
    code, shown, lines = start(write(SMALL), "--clock=100", draw=write_sheet)
    assert (code, lines) == (0, [])
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == sorted(compare.FILES)
    assert "true surface: sphere: exact normals" in shown
    report = found(tmp_path)
    assert (report["scene"], report["size"], report["clock_hz"]) == ("small", [48, 36], 100e6)
    rows = {row["shading"]: row for row in report["shadings"]}
    assert list(rows) == [shading.name for shading in SHADINGS]
    for row in rows.values():
        assert row["mismatches"] == 0 and row["fps"] == 100e6 / row["cycles"]
        assert row["error"]["max_lsb"] <= row["error"]["bound_lsb"]
    apart = [rows[name]["difference"]["rms_lsb"] for name in ("flat", "gouraud", "phong")]
    assert apart[0] > apart[1] > apart[2] > 12**-0.5
    assert rows["phong"]["hardware"] == rows["normalized_edges"]["hardware"]
    assert rows["phong"]["hardware"]["dsp"] == 19 and rows["flat"]["hardware"]["dsp"] == 0
    with Image.open(tmp_path / "out" / "sheet.png") as picture:
        assert picture.format == "PNG"


def test_each_shading_has_its_own_interpolation(start, write, tmp_path):
    start(write(SMALL))
    linear = found(tmp_path)["shadings"]
    code, _, lines = start(write(f'interpolation = "normalized_edges"\n{SMALL}'))
    assert code == 0 and found(tmp_path)["shadings"] == linear
    assert lines == ["interpolation = normalized_edges of the scene is not used: each shading "
                     "has its own"]  # fmt: skip
    differences = [row["difference"] for row in linear]
    assert all(a not in differences[:k] for k, a in enumerate(differences))


def test_a_new_shading_is_one_line(start, write, tmp_path, monkeypatch):
    """It brings a light of its own, and is compared with the surface in that light."""

    def from_above(scene):
        light = np.array([0.0, 0.0, 1.0])
        return {"light": light, "lights": [Light(light)]}

    line = Shading("above", "light from above", PHONG.config, lighting=from_above)
    monkeypatch.setattr(compare, "SHADINGS", (*SHADINGS, line))
    code, shown, lines = start(write(SMALL))
    assert (code, lines) == (0, [])
    rows = {row["shading"]: row for row in found(tmp_path)["shadings"]}
    phong, above = rows["phong"], rows["above"]
    assert above["title"] == "light from above" and above["hardware"] == phong["hardware"]
    assert above["difference"] != phong["difference"]
    assert above["difference"]["rms_lsb"] < 2 * phong["difference"]["rms_lsb"]


def test_warnocks_light_is_at_the_eye_and_falls(start, write, tmp_path):
    """The nearest vertex has the light's full factor, the farthest one the least."""
    path = write(SMALL)
    scene = load_scene(path)
    (light,) = light_at_eye(scene)["lights"]
    points, back = scene.objects[0].mesh.vertices, scene.camera.axes[2]
    assert np.array_equal(light.direction, back)
    factor = light.place.falloff.factor(light.place.distance(points, back))
    depth = points @ back
    assert factor[np.argmax(depth)] == 1
    assert factor[np.argmin(depth)] == pytest.approx(FARTHEST_FACTOR)
    start(path)
    rows = {row["shading"]: row for row in found(tmp_path)["shadings"]}
    assert rows["warnock"]["configuration"] == "default_lights_1_falloff"
    builds = recorded.figures("synth-more")["configurations"]
    assert rows["warnock"]["hardware"]["dsp"] == builds["falling_light"]["resources"]["dsp"]
    assert rows["quadratic"]["configuration"] == "quadratic_normals"
    assert rows["quadratic"]["difference"]["rms_lsb"] < rows["phong"]["difference"]["rms_lsb"]


def test_a_shading_that_cannot_show_a_scene_is_left_out_and_said(start, write, tmp_path):
    lamp = "[[lights]]\ndirection = [{}, -1, 1]\ncolor = [0.4, 0.3, 0.2]\n"
    lamps = lamp.format(0) + lamp.format(1)
    code, shown, _ = start(write(SMALL.replace("[[objects]]", f"{lamps}[[objects]]", 1)))
    report = found(tmp_path)
    assert code == 0 and list(report["left_out"]) == ["Phong, quadratic normals"]
    names = [row["shading"] for row in report["shadings"]]
    assert names == [s.name for s in SHADINGS if s.name != "quadratic"]
    assert "Phong, quadratic normals is left out: " in shown
    assert report["basis"]["what"] == ["sphere: fine triangles"]


def test_a_mesh_is_compared_with_phong(start, write, tmp_path):
    obj = write("v -1 -1 0\nv 1 -1 0\nv 0 1 .5\nv 0 0 1\nf 1 2 4\nf 2 3 4\nf 3 1 4\n", "a.obj")
    code, shown, lines = start(obj, "--size=60x40", draw=write_sheet)
    assert (code, lines) == (0, [])
    assert "no true surface (a.obj is a mesh): differences are from Phong" in shown
    report = found(tmp_path)
    assert "from Phong, RMS, LSB" in [row[0] for row in tables.comparison_rows(report)]
    assert report["basis"] == {"true_surface": False, "what": ["a.obj is a mesh"]}
    phong = next(row for row in report["shadings"] if row["shading"] == PHONG.name)
    assert phong["difference"]["max_lsb"] == 0 and phong["difference"]["pixels"] == phong["pixels"]


def test_what_is_not_recorded_is_a_dash_and_said(start, write, tmp_path, monkeypatch):
    monkeypatch.setattr(recorded, "FOLDER", tmp_path / "none")
    code, shown, _ = start(write(SMALL))
    assert code == 0 and "–: not recorded in results/ (flat, Gouraud, Warnock, " in shown
    assert found(tmp_path)["shadings"][0]["hardware"]["dsp"] is None


def test_figures_of_a_method_come_from_the_sweep():
    from phong75.model.studies.methods import CONFIGS

    points = recorded.figures("sweep")["configurations"]
    of = compare.recorded_hardware(CONFIGS["quadratic_spans_18"])
    assert of["dsp"] == points["quadratic_spans_18"]["dsp"] == 11
    other = replace(TECHNIQUES["flat"], name="other", channels=1)
    assert set(compare.recorded_hardware(other).values()) == {None}


def test_nothing_to_see_is_good(start, write, tmp_path):
    away = "[camera]\neye = [0, 0, 99]\ntarget = [50, 0, 99]\nup = [0, 1, 0]\nheight = 2\n"
    code, _, lines = start(write(SMALL.replace("[[", f"{away}[[", 1)), draw=write_sheet)
    assert (code, lines) == (0, [])
    assert {row["pixels"] for row in found(tmp_path)["shadings"]} == {0}


def unsupported(result):
    result.unsupported = 3


def zero_vectors(result):
    result.zero_normals = 2


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (wrong_colour, "Gouraud: 1 of "), (lost_pixel, "Gouraud: 1 of "),
        (extra_pixel, "Gouraud: 1 of "), (far_away, "Gouraud: 1 of "),
        (unsupported, "Gouraud: 3 spans or register writes are unsupported"),
        (zero_vectors, "Gouraud: the RTL flags 2 zero vectors, the model 0"),
    ],
)  # fmt: skip
def test_what_fails(start, write, tmp_path, change, says):
    code, _, lines = start(write(SMALL), simulate=broken("gouraud", change))
    failed = [line for line in lines if line.startswith("FAILED: ")]
    assert code == 1 and failed[0].startswith(f"FAILED: {says}")
    assert len(failed) == 1 or change is wrong_colour  # which misses the bound, too
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == sorted(compare.FILES)


def test_a_missed_bound_fails(start, write, monkeypatch):
    monkeypatch.setattr(compare.error_budget, "bound_lsb", lambda frame, config: 0.25)
    code, _, lines = start(write(SMALL))
    assert code == 1 and len(lines) == len(SHADINGS)
    assert all("the largest error is 0." in line and "bound 0.25" in line for line in lines)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["teapto"], "did you mean teapot?"),
        (["cone", "--size=3"], "--size is `3`, not WIDTHxHEIGHT"),
        (["cone", "--clock=0"], "--clock is `0`"),
        (["cone", "--technique=flat"], "No such option: --technique"),
        (["a.toml"], "a.toml: no such file"),
    ],
)
def test_wrong_input(start, tmp_path, arguments, says):
    code, shown, lines = start(*arguments)
    assert code == 2 and not shown and len(lines) == 1 and says in lines[0]
    assert not (tmp_path / "out").exists()


def test_a_set_up_that_does_not_work_leaves_nothing(start, write, tmp_path):
    def simulate(*arguments, **more):
        raise BuildError("g++ failed")

    assert start(write(SMALL), simulate=simulate) == (2, "", ["Error: g++ failed"])
    assert not (tmp_path / "out").exists()


# -- the command and the RTL -----------------------------------------------------------------------


def test_a_broken_design_fails(start, write, tmp_path):
    """Flat shading with red and blue exchanged, in the RTL itself."""
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    file = rtl / "techniques" / "flat_unit.v"
    text = file.read_text()
    wrong = text.replace("assign {blue, green, red}", "assign {red, green, blue}")
    assert wrong != text
    file.write_text(wrong)

    def simulate(jobs, config, progress=None):
        if config.technique != "flat":
            return perfect(jobs, config)
        return simulate_jobs([SimJob(job.frame) for job in jobs], config,
                             Bench("frame_bench", config, rtl=rtl))  # fmt: skip

    code, _, lines = start(write(SMALL), simulate=simulate)
    assert code == 1 and any(line.startswith("FAILED: flat: ") for line in lines)


def test_the_record_is_what_is_measured_now(tmp_path):
    """The scene of the documentation anew, through the RTL: figures and picture."""
    scene, size = compare.SHOWN
    report = compare.compare(compare.request(scene, size, out=tmp_path), compare.Steps())
    assert not compare.failures(report)
    old = recorded.figures("compare")
    assert not differences(json.loads(json.dumps(report)), old), "make compare RECORD=1"
    with Image.open(tmp_path / "sheet.png") as new, Image.open(compare.SHOWN_PICTURE) as kept:
        np.testing.assert_array_equal(new, kept)
    assert compare.SHOWN_PICTURE.stat().st_size < 75_000 * len(SHADINGS)


@pytest.mark.parametrize("arguments", [["cone", "--size=16x12"], ["pyramid", "--size=320x240"]])
def test_another_scene_is_not_recorded(start, tmp_path, monkeypatch, arguments):
    monkeypatch.setattr(recorded, "FOLDER", tmp_path / "results")
    before = compare.SHOWN_PICTURE.read_bytes()
    code, _, lines = start(*arguments, "--record")
    reason = "the record shows cone at 320x240"
    assert code == 0 and lines == [f"not recorded in results/compare.json: {reason}"]
    assert not (tmp_path / "results").exists()
    assert compare.SHOWN_PICTURE.read_bytes() == before
