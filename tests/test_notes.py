# SPDX-License-Identifier: MIT
"""Scene and object files as the lecture notes write them."""

import math

import pytest

from phong75.model.frame import InputError
from phong75.model.front.notes import read_object, scene_table

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
