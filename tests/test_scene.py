# SPDX-License-Identifier: MIT
"""Scene files: what they may say, what is filled in, and one clear line for every mistake."""

import re

import numpy as np
import pytest
import trimesh

from phong75.model.config import DEFAULT, Config
from phong75.model.frame import InputError
from phong75.model.front.camera import FILL
from phong75.model.front.scene import (
    MAX_TESSELLATION,
    Material,
    bundled_scenes,
    load_scene,
    technique_scenes,
)
from phong75.model.scene_to_frame import front_end

MINIMAL = '[[objects]]\nshape = "sphere"\nsegments = 8\nrings = 4\n'


@pytest.fixture
def scene(tmp_path):
    """Write a scene file and load it."""

    def load(text, **kwargs):
        path = tmp_path / "a.toml"
        path.write_text(text)
        return load_scene(path, **kwargs)

    return load


def on_screen(scene):
    """Screen x and y of all vertices, as parts of the picture's half extents from its middle."""
    points = np.concatenate([o.mesh.vertices for o in scene.objects])
    x, y, w, _ = np.moveaxis(scene.camera.project(points, scene.width, scene.height), -1, 0)
    assert (w > 0).all()
    return x / w / scene.width * 2 - 1, y / w / scene.height * 2 - 1


def test_color_may_be_spelled_colour(scene):
    text = (
        """background = [0, 0, 0]\n[light]\ncolor = [1, 0.5, 0]\n[materials.colour]
color = [0.5, 0.25, 0]\n"""
        + MINIMAL
    )
    one, other = (scene(text.replace("color =", f"{word} =") + 'material = "colour"\n')
                  for word in ("color", "colour"))  # fmt: skip
    assert one.materials == other.materials and other.materials[0].color == (0.5, 0.25, 0)
    assert one.lights[0].diffuse == other.lights[0].diffuse == (1, 0.5, 0)


def test_what_the_file_leaves_open_is_said(scene):
    above = "[camera]\ndirection = [0, 0, 1]\n" + MINIMAL
    assert scene(above).remarks == ["camera: looks along z, so that y points up"]
    light = '[light]\nposition = "eye"\n'
    assert not scene(light + MINIMAL).remarks
    light += "attenuation = { linear = 1.0 }\n"
    (remark,) = scene(light + MINIMAL).remarks
    assert remark.endswith("are measured from the scene's nearest point")
    assert not scene(light + "[camera]\nprojection = 'perspective'\n" + MINIMAL).remarks


# -- bundled scenes and defaults ---------------------------------------------------------------


def test_bundled_scenes():
    assert set(bundled_scenes()) == {
        "cone", "pyramid", "sphere", "still_life", "teapot", "torus",
    }  # fmt: skip
    assert set(technique_scenes()) == {
        "coarse_torus", "coloured_lights", "flat_and_smooth", "lamps", "near_light",
        "normalized_edges", "scaling", "toon", "warnock",
    }  # fmt: skip
    for name in (*bundled_scenes(), *technique_scenes()):
        scene = load_scene(name)
        assert (scene.name, scene.width, scene.height) == (name, 640, 480)
        x, y = on_screen(scene)
        inside = (np.abs(x) <= 1) & (np.abs(y) <= 1)
        assert inside.mean() > 0.95, "the picture shows its objects"


def test_the_pyramid_has_the_colours_of_the_notes():
    (material,) = load_scene("pyramid").materials
    assert material.color == (0.2, 0.5, 0.9) and set(material.weight_values) == {0.4}


def test_still_life_spans_the_range_of_materials():
    materials = load_scene("still_life").materials
    powers = [m.n for m in materials]
    assert max(powers) == 128 and any(n != int(n) for n in powers)
    assert any(len(set(m.weight_values)) > 2 for m in materials)


def test_defaults_of_a_minimal_scene(scene):
    s = scene(MINIMAL)
    assert (s.width, s.height, s.two_sided, s.interpolation) == (640, 480, False, "linear")
    assert s.materials == [Material()] and s.camera.projection == "orthographic"
    assert np.linalg.norm(s.light) == pytest.approx(1)
    assert s.light @ s.camera.axes[2] > 0.5, "the light is on the observer's side"


def test_the_size_argument_goes_before_the_files(scene):
    assert (scene("size = [64, 48]\n" + MINIMAL).width) == 64
    s = scene("size = [64, 48]\n" + MINIMAL, size=(30, 70))
    assert (s.width, s.height) == (30, 70)
    x, y = on_screen(s)
    assert np.abs(x).max() == pytest.approx(FILL) and np.abs(y).max() < 0.5


# -- materials ---------------------------------------------------------------------------------


def with_material(text):
    return "[materials.m]\n" + text + "\n" + MINIMAL + 'material = "m"\n'


@pytest.mark.parametrize(
    "text, expected",
    [
        ("W = 0.3", lambda zn: np.full_like(zn, 0.3)),
        ("W = 1", lambda zn: np.ones_like(zn)),
        ("W = [0.8, 0.2]", lambda zn: 0.8 - 0.6 * zn),
        ("W = [0.8, 0.2, 0.6]", lambda zn: np.where(zn < 0.5, 0.8 - 1.2 * zn, 0.8 * zn - 0.2)),
        ("W = {degrees = [0, 90], values = [0.2, 0.8]}", lambda zn: 0.8 - 0.6 * zn),
        (
            "W = {degrees = [0, 60, 90], values = [0.1, 0.2, 0.8]}",
            lambda zn: np.where(zn < 0.5, 0.8 - 1.2 * zn, 0.3 - 0.2 * zn),
        ),
        ("W = {degrees = [60], values = [0.5]}", lambda zn: np.full_like(zn, 0.5)),
    ],
)
def test_weights_become_points_equally_spaced_in_zn(scene, text, expected):
    made = front_end(scene(with_material(text), size=(8, 6)))
    zn = np.linspace(0, 1, DEFAULT.weight_points)
    assert made.exact.weight[0].at(zn) == pytest.approx(expected(zn))
    codes = DEFAULT.coefficient.real(made.frame.materials.weight[0])
    assert codes == pytest.approx(expected(zn), abs=DEFAULT.coefficient.lsb)


def test_a_list_of_the_tables_own_length_is_taken_as_it_is(scene):
    values = np.linspace(0.1, 0.8, DEFAULT.weight_points) ** 2
    made = front_end(scene(with_material(f"W = {values.tolist()}"), size=(8, 6)))
    assert made.exact.weight[0].at(np.linspace(0, 1, len(values))) == pytest.approx(
        values, abs=1e-15
    )


def test_materials_by_name_inline_and_by_default(scene):
    s = scene(
        "[materials.a]\nn = 2\n[materials.b]\nn = 3.25\n"
        + MINIMAL
        + 'material = "b"\n'
        + MINIMAL
        + MINIMAL
        + "material = {n = 5}\n"
        + MINIMAL
    )
    assert [s.materials[o.material].n for o in s.objects] == [3.25, 10, 5, 10]
    assert s.objects[1].material == s.objects[3].material


def test_interpolation_of_edges_is_an_option(scene):
    assert scene('interpolation = "normalized_edges"\n' + MINIMAL).interpolation == (
        "normalized_edges"
    )


# -- camera, light, objects --------------------------------------------------------------------


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
@pytest.mark.parametrize("more", ["", "direction = [0, 0, 1]", "direction = [5, 1, 0.2]"])
@pytest.mark.parametrize("size", [(64, 48), (20, 90)])
def test_default_framing_fills_the_picture(scene, projection, more, size):
    text = f'[camera]\nprojection = "{projection}"\n{more}\n' + MINIMAL
    text += "scale = [1, 2, 3]\ntranslate = [10, 20, 30]\n"
    x, y = on_screen(scene(text, size=size))
    reach = max(np.abs(x).max(), np.abs(y).max())
    assert reach <= FILL + 1e-9
    assert reach > (FILL - 1e-9 if projection == "orthographic" else 0.5)


def test_eye_target_up_and_height(scene):
    text = "[camera]\neye = [10, 0, 0]\ntarget = [0, 0, 0]\nup = [0, 1, 0]\nheight = 4\n"
    s = scene(text + MINIMAL, size=(64, 64))
    assert s.camera.axes == pytest.approx(np.array([(0, 0, -1), (0, 1, 0), (1, 0, 0)]))
    x, y = on_screen(s)
    assert y.min() == pytest.approx(-0.5, abs=0.1) and y.max() == pytest.approx(0.5, abs=0.1)


@pytest.mark.parametrize("projection", ["orthographic", "perspective"])
def test_a_target_is_the_middle_of_a_picture_that_still_holds_all(scene, projection):
    text = f'[camera]\nprojection = "{projection}"\ntarget = [11, 20.5, 29]\n' + MINIMAL
    s = scene(text + "translate = [10, 20, 30]\n")
    x, y, w, _ = s.camera.project(np.array([11, 20.5, 29]), s.width, s.height)
    assert (x / w, y / w) == pytest.approx((s.width / 2, s.height / 2))
    x, y = on_screen(s)
    assert 0.4 < max(np.abs(x).max(), np.abs(y).max()) <= FILL + 1e-9


def test_perspective_eye_and_fov(scene):
    text = '[camera]\nprojection = "perspective"\neye = [0, -10, 0]\ntarget = [0, 0, 0]\nfov = 90\n'
    camera = scene(text + MINIMAL).camera
    x, y, w, _ = camera.project(np.array([10.0, 0, 10.0]), 640, 480)
    assert (x / w, y / w, w) == pytest.approx((560, 0, 10))
    assert camera.near == pytest.approx(0.01)


def test_looking_straight_down_needs_no_up(scene):
    axes = scene("[camera]\ndirection = [0, 0, 1]\n" + MINIMAL).camera.axes
    assert axes == pytest.approx(np.eye(3))


def test_light_relative_to_scene_and_camera(scene):
    camera = "[camera]\ndirection = [0, -1, 0]\n"
    light = scene(camera + "[light]\ndirection = [0, 0, 5]\n" + MINIMAL).light
    assert light == pytest.approx([0, 0, 1])
    text = camera + '[light]\ndirection = [0, 0, 5]\nrelative_to = "camera"\n' + MINIMAL
    assert scene(text).light == pytest.approx([0, -1, 0])


def test_meshes_are_found_beside_the_scene_file(scene, tmp_path):
    trimesh.creation.box().export(tmp_path / "cube.stl")
    s = scene('[[objects]]\nmesh = "cube.stl"\nscale = 3\ntranslate = [1, 0, 0]\n')
    assert s.objects[0].mesh.vertices.max(axis=0) == pytest.approx([2.5, 1.5, 1.5])


def test_crease_makes_shapes_flat(scene):
    smooth, flat = scene(MINIMAL), scene(MINIMAL + "crease = 0\n")
    assert np.ptp(flat.objects[0].mesh.normals, axis=1).max() < 1e-9
    assert np.ptp(smooth.objects[0].mesh.normals, axis=1).max() > 0.1


@pytest.mark.parametrize("suffix, up", [("stl", 2), ("obj", 1), ("ply", 1), ("glb", 1)])
def test_a_bare_mesh_is_framed_and_lit(tmp_path, suffix, up):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / f"box.{suffix}")
    s = load_scene(tmp_path / f"box.{suffix}", (64, 48))
    assert s.name == "box" and not s.two_sided
    assert s.camera.axes[1][up] > 0.8
    x, y = on_screen(s)
    assert max(np.abs(x).max(), np.abs(y).max()) == pytest.approx(FILL)
    made = front_end(s)
    assert made.triangles == 12 and made.frame.spans["length"].sum() > 500


def test_an_open_mesh_that_winds_both_ways_is_two_sided(tmp_path):
    vertices, faces = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2), (0, 3, 2)]
    trimesh.Trimesh(vertices, faces, process=False).export(tmp_path / "a.obj")
    item = load_scene(tmp_path / "a.obj").objects[0]
    assert item.two_sided.all() and item.report.two_sided_why


# -- mistakes ----------------------------------------------------------------------------------


MISTAKES = {
    # the file
    "size = [640, 480\n": "malformed TOML: .*line 2",
    MINIMAL + "\n\nx = = 3": "malformed TOML: .*line 7",
    '[light]\ndirection = "': "malformed TOML: .*line 2",
    "": "objects missing: a scene needs at least one",
    "objects = 3": "objects is not a list of tables",
    "objects = [3]": r"objects\[0\] = 3 is not a table",
    # unknown keys
    "colour = 1\n" + MINIMAL: "colour: unknown key$",
    "two_side = true\n" + MINIMAL: r"two_side: unknown key; did you mean two_sided\?",
    MINIMAL + "radios = 3": r"objects\[0\].radios: unknown key; did you mean radius\?",
    MINIMAL + "tube = 3": r"objects\[0\].tube: unknown key",
    with_material("colour = [0, 0]"): r"materials.m.colour = \[0.0, 0.0\] does not have 3 numbers",
    with_material(
        "colour = [0, 0, 0]\ncolor = [0, 0, 0]"
    ): "materials.m.colour and color cannot bo",
    with_material("W = {degrees = [1], values = [1], x = 1}"): "materials.m.W.x: unknown key",
    "[camera]\nfow = 3\n" + MINIMAL: r"camera.fow: unknown key; did you mean fov\?",
    "[light]\nhue = 3\n" + MINIMAL: "light.hue: unknown key",
    "[light]\ncolor = 3\n" + MINIMAL: "light.color = 3 is not a list of numbers",
    MINIMAL + "material = {N = 3}": r"objects\[0\].material.N: unknown key",
    # size and switches
    "size = [0, 480]\n" + MINIMAL: "size = 0x480 is outside 1 to 4096 pixels",
    "size = [640, 4097]\n" + MINIMAL: "size = 640x4097 is outside 1 to 4096 pixels",
    "size = [640]\n" + MINIMAL: r"size = \[640\] is not \[width, height\]",
    "size = [64.0, 48]\n" + MINIMAL: r"size = \[64.0, 48\] is not \[width, height\]",
    'size = "640x480"\n' + MINIMAL: "size = '640x480' is not",
    "two_sided = 1\n" + MINIMAL: "two_sided = 1 is not true or false",
    "background = [0, 0, 1.5]\n" + MINIMAL: r"background\[2\] = 1.5 is outside \[0, 1\]",
    "background = [0, 0]\n" + MINIMAL: r"background = \[0.0, 0.0\] does not have 3 numbers",
    'interpolation = "cubic"\n'
    + MINIMAL: "interpolation = 'cubic' is not one of linear, normalized_edges",
    # materials
    with_material("n = -0.5"): r"materials.m.n = -0.5 is outside \[0, 128\]",
    with_material("n = 129"): r"materials.m.n = 129 is outside \[0, 128\]",
    with_material(
        "n = 5\ncurve = {cos = [0], values = [1]}"
    ): "materials.m.n has no effect beside curve",
    with_material("curve = 1"): "materials.m.curve = 1 is not a table",
    with_material(
        "curve = {cos = [0, 1], values = [1]}"
    ): "materials.m.curve 2 cosines, but 1 values",
    with_material(
        "curve = {cos = [0.5, 0.4], values = [0, 1]}"
    ): r"materials.m.curve.cos = \[0.5, 0.4\] do not increase",
    with_material(
        "curve = {cos = [0.5, 0.5, 0.5], values = [0, 1, 0]}"
    ): "has three equal ones in a row; a jump has two",
    with_material(
        "curve = {cos = [0, 1], values = [0, 1.5]}"
    ): r"materials.m.curve.values\[1\] = 1.5 is outside \[0, 1\]",
    with_material("n = nan"): "materials.m.n = nan is not finite",
    with_material("n = true"): "materials.m.n = True is not a number",
    with_material('n = "10"'): "materials.m.n = '10' is not a number",
    with_material("d = -0.1"): r"materials.m.d = -0.1 is outside \[0, 1\]",
    with_material("W = 1.01"): r"materials.m.W = 1.01 is outside \[0, 1\]",
    with_material("W = [0.5]"): r"materials.m.W = \[0.5\] needs at least two points",
    with_material("W = [0.5, 2]"): r"materials.m.W\[1\] = 2 is outside \[0, 1\]",
    with_material("W = {degrees = [0, 90]}"): "materials.m.W.values = None is not a list",
    with_material("W = {degrees = [0], values = [0, 1]}"): "materials.m.W 1 degrees, but 2 values",
    with_material("W = {degrees = [9, 3], values = [0, 1]}"): r"W.degrees = \[9.0, 3.0\] do not",
    with_material("W = {degrees = [0, 91], values = [0, 1]}"): r"degrees\[1\] = 91 is outside",
    with_material("color = [1, 1, 1.1]"): r"materials.m.color\[2\] = 1.1 is outside \[0, 1\]",
    with_material("color = 1"): "materials.m.color = 1 is not a list of numbers",
    MINIMAL + 'material = "m"': r"objects\[0\].material = 'm' is not in \[materials\] \(.*none",
    "[materials.a]\n" + MINIMAL + 'material = "b"': r"= 'b' is not in \[materials\] \(known: a\)",
    "materials = 3\n" + MINIMAL: "materials = 3 is not a table",
    "".join(f"[materials.m{i}]\n" for i in range(17))
    + MINIMAL
    + 'material = "m1"': "materials 17 materials, but the table has 16 entries",
    (MINIMAL + "material = {}\n") * 17: "materials 17 materials, but the table has 16 entries",
    # light and camera
    "[light]\ndirection = [0, 0, 0]\n" + MINIMAL: r"light.direction = \[0, 0, 0\] has no direction",
    "[light]\ndirection = [0, inf, 0]\n" + MINIMAL: r"light.direction\[1\] = inf is not finite",
    '[light]\nrelative_to = "me"\n' + MINIMAL: "light.relative_to = 'me' is not one of scene, cam",
    "[camera]\ndirection = [0, 0, 0]\n"
    + MINIMAL: r"camera.direction = \[0, 0, 0\] has no direction",
    "[camera]\neye = [1, 1, 1]\ntarget = [1, 1, 1]\n"
    + MINIMAL: "camera.eye = target: the line of sight has no direction",
    "[camera]\neye = [1, 1, 1]\ndirection = [1, 1, 1]\n" + MINIMAL: "camera.direction and eye",
    "[camera]\nup = [0, 0, 0]\n" + MINIMAL: "camera.up = .* has no direction",
    "[camera]\nup = [0, 0, 1]\ndirection = [0, 0, 2]\n"
    + MINIMAL: "camera.up = .* is parallel to the line of sight",
    "[camera]\nheight = 0\n" + MINIMAL: "camera.height = 0 is not greater than 0",
    "[camera]\nfov = 30\n" + MINIMAL: "camera.fov is for perspective cameras",
    '[camera]\nprojection = "perspective"\nheight = 3\n'
    + MINIMAL: "camera.height is for orthographic cameras",
    '[camera]\nprojection = "perspective"\nfov = 180\n'
    + MINIMAL: r"camera.fov = 180 is outside \[1, 170\]",
    '[camera]\nprojection = "perspective"\nnear = -1\n' + MINIMAL: "camera.near = -1 is not gr",
    '[camera]\nprojection = "fisheye"\n' + MINIMAL: "camera.projection = 'fisheye' is not one of",
    # objects
    "[[objects]]\n": r"objects\[0\] needs either shape = ... or mesh = ...",
    MINIMAL + 'mesh = "a.obj"': r"objects\[0\] needs either",
    '[[objects]]\nshape = "cube"': r"objects\[0\].shape = 'cube' is not one of sphere, torus",
    '[[objects]]\nmesh = "none.obj"': r"objects\[0\].mesh: .*none.obj: no such file",
    '[[objects]]\nmesh = "a.toml"': r"objects\[0\].mesh: .*a.toml: not a mesh file",
    MINIMAL + "radius = -1": r"objects\[0\].radius = -1 is not greater than 0",
    '[[objects]]\nshape = "sphere"\nrings = 1': r"objects\[0\].rings = 1 is outside \[2, 1024\]",
    '[[objects]]\nshape = "sphere"\nsegments = 9.5': "segments = 9.5 is not a whole number",
    '[[objects]]\nshape = "teapot"\ndivisions = 0': r"divisions = 0 is outside \[1, 128\]",
    MINIMAL + "scale = 0": r"objects\[0\].scale = 0 would flatten the object",
    MINIMAL + "scale = [1, 0, 1]": "scale = 0 would flatten the object",
    MINIMAL + "scale = [1, 1]": r"objects\[0\].scale = \[1.0, 1.0\] does not have 3 numbers",
    MINIMAL + "rotate = 90": r"objects\[0\].rotate = 90 is not a list of numbers",
    MINIMAL + "crease = 181": r"objects\[0\].crease = 181 is outside \[0, 180\]",
    MINIMAL + "name = 3": r"objects\[0\].name = 3 is not a string",
}


@pytest.mark.parametrize("text", MISTAKES, ids=range(len(MISTAKES)))
def test_mistakes_give_one_clear_line(scene, tmp_path, text):
    with pytest.raises(InputError) as caught:
        scene(text)
    line = str(caught.value)
    start = f"{tmp_path / 'a.toml'}: "
    assert "\n" not in line and line.startswith(start)
    assert re.search(MISTAKES[text], line[len(start) :]), line
    assert len(line) < len(start) + len(str(tmp_path)) + 150


def test_size_argument_is_checked(scene):
    for size, message in [((0, 3), "size = 0x3"), ((3, 5000), "size = 3x5000")]:
        with pytest.raises(InputError, match=message):
            scene(MINIMAL, size=size)
    with pytest.raises(InputError, match="size = 600x10 is outside 1 to 512 pixels"):
        scene(MINIMAL, size=(600, 10), config=Config(coordinate_bits=9))


def test_names_that_are_nothing(tmp_path):
    for name, message in [
        ("teapott", r"^teapott: no such file, nor a bundled scene \(.*\); did you mean teapot\?$"),
        ("no/such.obj", "^no/such.obj: no such file"),
        (str(tmp_path), "not a file$"),
    ]:
        with pytest.raises(InputError, match=message):
            load_scene(name)
    (tmp_path / "a.txt").write_text("x")
    with pytest.raises(InputError, match="neither a scene .* nor a mesh"):
        load_scene(tmp_path / "a.txt")
    (tmp_path / "a.toml").write_bytes(b"x = '\xff'")
    with pytest.raises(InputError, match="not UTF-8 text"):
        load_scene(tmp_path / "a.toml")


def test_every_whole_parameter_of_a_shape_has_a_limit(scene):
    for shape in ("sphere", "torus", "cone", "teapot"):
        for key in MAX_TESSELLATION:
            with pytest.raises(InputError, match="is outside|unknown key"):
                scene(f'[[objects]]\nshape = "{shape}"\n{key} = 100000\n')
