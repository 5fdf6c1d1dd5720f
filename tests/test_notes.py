# SPDX-License-Identifier: MIT
"""Scene and object files as the lecture notes write them."""

import math

import numpy as np
import pytest
import tomli_w

from phong75.model import twin
from phong75.model.analysis import error_budget
from phong75.model.config import DEFAULT, TECHNIQUES
from phong75.model.frame import InputError, fitted
from phong75.model.front.notes import read_object, scene_table
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts.main import main

#: The two examples of the notes, as they stand there.
PYRAMID = """\
// pyramid.des file:

5, 5      // number of vertices and polygons
// World coordinates of pyramid vertices:
(0,0,0), (150,0,0), (150,150,0), (0,150,0), (75,75,150)
//Pyramid polygons:
3,(0,1,4), 3,(1,2,4), 3,(2,3,4), 3,(0,4,3), 4,(0,3,2,1)
0.2, 0.5, 0.9    // kr, kg, kb diffuse reflection coefficients
0.4                  // ks specular reflection coefficient
// n specular exponent
"""
SCENE = """\
200, 1000, 45, 60    // scrn_dist, \u03c1, \u03b8, \u03c6
1                              // number of objects in scene
pyramid.des  // name of generic object description file
1.8, 1.0, 1.0    // sx, sy, sz scaling factors
0, 0, 0             // x, y, z, rotation angles
200, 0, 0         // x, y, z translation components
1                     // number of light sources
500, 500, 500, 100   // x,y,z & Intensity of light source
50                   // ambient light intensity
"""


@pytest.fixture
def files(tmp_path):
    """Writes the two examples, after changes {old: new}; returns the path of the scene file."""

    def write(changes=None):
        for name, text in (("pyramid.des", PYRAMID), ("example.scn", SCENE)):
            for old, new in (changes or {}).items():
                text = text.replace(old, new)
            (tmp_path / name).write_text(text)
        return tmp_path / "example.scn"

    return write


def test_the_object_of_the_notes(files):
    item = read_object(files().with_name("pyramid.des"))
    assert item.points == [(0, 0, 0), (150, 0, 0), (150, 150, 0), (0, 150, 0), (75, 75, 150)]
    assert item.polygons == [(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2, 1)]
    assert item.diffuse == (0.2, 0.5, 0.9) and item.specular == 0.4 and item.exponent is None


def test_the_scene_of_the_notes(files):
    table, remarks = scene_table(files())
    camera = table["camera"]
    assert camera["screen_distance"] == 200
    # rho = 1000, theta = 45 and phi = 60 degrees, in this order after the screen distance.
    assert camera["eye"] == pytest.approx([250 * math.sqrt(6), 250 * math.sqrt(6), 500])
    (item,) = table["objects"]
    assert (item["mesh"], item["material"]) == ("pyramid.des", "pyramid")
    assert (item["scale"], item["rotate"]) == ([1.8, 1, 1], [0, 0, 0])
    assert item["translate"] == [200, 0, 0]
    assert table["lights"] == [{"direction": [500, 500, 500], "color": [100] * 3}]
    assert table["ambient"] == [50] * 3
    material = table["materials"]["pyramid"]
    assert material["ambient"] == material["diffuse"] == [0.2, 0.5, 0.9]
    assert material["specular"] == [0.4] * 3 and material["n"] == 20
    assert any("no exponent n: 20 is taken" in remark for remark in remarks)


def test_an_exponent_that_is_there_is_taken_without_a_remark(files):
    table, remarks = scene_table(files({"// n specular exponent": "32 // n"}))
    assert table["materials"]["pyramid"]["n"] == 32
    assert not any("exponent" in remark for remark in remarks)


def test_layout_does_not_matter(files):
    one_line = PYRAMID.replace("5, 5 ", "5\n5").replace("), (", ")\n\n(")
    path = files()
    usual = read_object(path.with_name("pyramid.des"))
    path.with_name("pyramid.des").write_text("\ufeff" + one_line.replace("\n", "\r\n"))
    assert read_object(path.with_name("pyramid.des")) == usual


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("5, 5 ", "5, x ", r"pyramid.des: line 3: 'x' is not a number: the number of polygons"),
        ("5, 5 ", "5.5, 5 ", r"line 3: the number of points is 5.5, not a whole number"),
        ("3,(0,1,4)", "3,(0,1,5)", r"line 7: a vertex of polygon 0 is 5, not a whole number from"),
        ("3,(0,1,4)", "2,(0,1)", r"line 7: the number of vertices of polygon 0 is 2, not"),
        ("0.2, 0.5", "0.2, 1.5", r"line 8: kg is 1.5, outside 0 to 1"),
        ("0.4   ", "", r"pyramid.des: line 8: the file ends where ks should stand"),
        ("// n specular", "20 30 // ", r"line 10: '30' is more than the file should have"),
        ("pyramid.des  //", "cube.des //", r"cube.des: cannot be read: No such file"),
        ("200, 1000", "-200, 1000", r"example.scn: line 1: the screen distance is -200, outside"),
        ("500, 500, 500,", "0, 0, 0,", r"line 8: light 0 is at the origin"),
        ("500, 100 ", "500, nan ", r"line 8: the intensity of light 0 is nan, outside"),
        ("1                     //", "9 //", r"line 7: the number of light sources is 9, not"),
        ("50                  ", "", r"line 8: the file ends where the intensity of the ambient"),
    ],
)
def test_a_mistake_is_one_line_with_its_place(files, old, new, message):
    with pytest.raises(InputError, match=message) as error:
        scene_table(files({old: new}))
    assert "\n" not in str(error.value)


def test_an_empty_file(tmp_path):
    (tmp_path / "a.scn").write_text("// nothing\n")
    with pytest.raises(InputError, match="a.scn: line 1: the file ends where the screen distance"):
        scene_table(tmp_path / "a.scn")


@pytest.mark.parametrize("place", [(0, 1, 1), (1, 0, 3), (-2, 1, 0.5)])
def test_a_flat_face_has_the_intensity_of_the_notes(files, place):
    """FB = 255 I/Imax per polygon, computed here from the formula of the notes."""
    light = ", ".join(map(str, place))
    path = files({"500, 500, 500, 100": f"{light}, 100"})
    scene = load_scene(path)
    front = front_end(scene, TECHNIQUES["flat"])
    shown = {tuple(rgb) for rgb in twin.render(front.frame, TECHNIQUES["flat"]).rgb.tolist()}
    corners = np.array([(0, 0, 0), (150, 0, 0), (150, 150, 0), (0, 150, 0), (75, 75, 150)])
    corners = corners * (1.8, 1, 1) + (200, 0, 0)
    kd, ks, n, ia, ip = np.array([0.2, 0.5, 0.9]), 0.4, 20, 50, 100
    imax = max(kd * ia + ip * kd + ip * ks)
    to_light = np.array(place) / np.linalg.norm(place)
    v = np.array([math.cos(math.pi / 4) * math.sin(math.pi / 3)] * 2 + [math.cos(math.pi / 3)])
    expected = []
    for a, b, c in ((0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2)):
        normal = np.cross(corners[b] - corners[a], corners[c] - corners[a])
        normal /= np.linalg.norm(normal)
        intensity = kd * ia
        if (cosine := normal @ to_light) > 0:
            r = 2 * cosine * normal - to_light
            intensity = intensity + ip * kd * cosine + ip * ks * max(r @ v, 0) ** n
        expected.append(255 * intensity / imax)
    # Two faces look towards the eye.
    assert 1 <= len(shown) <= 3
    # The formula has real coefficients and a real half vector. Three terms are products with a
    # rounded coefficient. An error e of the half vector moves cos(s)**n by at most 2 sqrt(n) e.
    phong = front_end(scene, DEFAULT).frame
    arithmetic = error_budget.bound_lsb(phong, fitted(DEFAULT, phong))
    coefficients = 3 * DEFAULT.coefficient.lsb / 2
    half_vector = ks * ip / imax * 2 * math.sqrt(n) * math.sqrt(2) * DEFAULT.half_vector.lsb / 2
    bound = arithmetic + 255 * (coefficients + half_vector)
    assert bound < 0.6
    for rgb in shown:
        assert min(np.abs(np.array(rgb) - e).max() for e in expected) <= bound


def test_a_converted_scene_gives_the_same_frame(files, capsys):
    path = files()
    out = path.parent / "below" / "converted.toml"
    out.parent.mkdir()
    assert main(["convert", str(path), "--out", str(out)]) == 0
    captured = capsys.readouterr()
    assert captured.out == f"{out}\n" and "no exponent n: 20 is taken" in captured.err
    a, b = (front_end(load_scene(p)).frame for p in (path, out))
    assert len(a.spans) and a.spans.tobytes() == b.spans.tobytes()
    assert (twin.render(a).rgb == twin.render(b).rgb).all()
    assert main(["convert", str(path), "--out", str(out)]) == 2
    assert "exists: name another file" in capsys.readouterr().err


def test_exposure(files):
    path = files()
    table, _ = scene_table(path)
    toml = path.with_suffix(".toml")
    scenes = {}
    for exposure in ("Imax", 1 / 175, 1 / 350):
        toml.write_text(tomli_w.dumps(table | {"exposure": exposure}))
        scenes[exposure] = load_scene(toml, (320, 240))
    (light,) = scenes["Imax"].lights
    assert light.diffuse == pytest.approx([100 / 175] * 3)
    assert scenes["Imax"].ambient == pytest.approx(scenes[1 / 175].ambient)
    assert scenes[1 / 350].ambient == pytest.approx([50 / 350] * 3)
    assert "Imax is 175" in scenes["Imax"].remarks[0] and not scenes[1 / 175].remarks
