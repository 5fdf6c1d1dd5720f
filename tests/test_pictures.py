# SPDX-License-Identifier: MIT
"""The pictures of a frame show what they should, and the same pixels give the same bytes."""

import numpy as np
import png
import pytest
from PIL import Image

from phong75.model.analysis import pictures
from phong75.model.analysis.pictures import canvas, excess, write_error_map, write_picture
from phong75.model.config import DEFAULT
from phong75.model.frame import SPAN_DTYPE, Frame, MaterialTable
from phong75.model.twin import Pixels
from phong75.scripts.configurations import CONFIGURATIONS

WHITE, GREY = (255, 255, 255), (0xD3, 0xD7, 0xDC)
ORANGE, BLUE = (0xE8, 0x59, 0x0C), (0x00, 0x57, 0xD8)
BOUND = 0.8


@pytest.fixture
def frame():
    table = MaterialTable.empty(DEFAULT)
    return Frame(5, 4, (0, 1), False, (10, 20, 30), table, np.zeros(0, SPAN_DTYPE))


def test_canvas(frame):
    x, y = np.array([0, 4, 4, 5, -1, 0]), np.array([0, 3, 3, 0, 0, 4])
    rgb = np.array([[1, 2, 3], [4, 5, 6], [7, 8, 9], [9, 9, 9], [9, 9, 9], [9, 9, 9]])
    picture = canvas(frame, x, y, rgb)
    assert picture.shape == (4, 5, 3) and picture.dtype == np.uint8
    assert picture[0, 0].tolist() == [1, 2, 3]
    assert picture[3, 4].tolist() == [7, 8, 9]  # the later one is shown
    assert (picture == (10, 20, 30)).all(axis=2).sum() == 18  # pixels outside are left out


def test_picture_keeps_every_bit(tmp_path):
    rng = np.random.default_rng(1)
    picture = rng.integers(0, 256, (4, 5, 3), np.uint8)
    write_picture(tmp_path / "a.png", picture)
    with Image.open(tmp_path / "a.png") as file:
        assert file.mode == "RGB" and not file.info
        np.testing.assert_array_equal(np.asarray(file), picture)


@pytest.mark.parametrize("name", ["colour_10", "colour_12"])
def test_picture_of_more_bits_keeps_every_code(frame, tmp_path, name):
    config = CONFIGURATIONS[name]
    y, x = (axis.reshape(-1) for axis in np.indices((4, 5)))
    codes = np.random.default_rng(1).integers(0, config.white + 1, (20, 3))
    codes[0], codes[1] = 0, config.white
    picture = canvas(frame, x, y, codes, config)
    write_picture(tmp_path / "a.png", picture, config)
    with open(tmp_path / "a.png", "rb") as file:
        width, height, rows, information = png.Reader(file).read()
        kept = np.array([list(row) for row in rows]).reshape(20, 3)
    assert (width, height, information["bitdepth"]) == (5, 4, 16)
    assert kept.min() == 0 and kept.max() == 65535
    np.testing.assert_array_equal(np.floor(kept * config.white / 65535 + 0.5), codes)
    shown = np.asarray(pictures.picture(frame, Pixels(x, y, codes, x > 9), config))
    assert (shown[0, :2] == [[0] * 3, [255] * 3]).all()


def maps_of(path):
    """The colours of the pixels in the two maps of a 5 x 4 frame, int[2, 4, 5, 3]."""
    with Image.open(path) as file:
        assert file.format == "PNG" and not set(file.info) - {"dpi"}
        picture = np.asarray(file.convert("RGB")).astype(int)
    side, left, top = 80, 58, 82  # of an enlarged pixel; the margins of a map
    width = 58 + 400 + 10 + 14 + 72
    return np.array(
        [
            picture[top + side // 2 :: side, k * width + left + side // 2 :: side][:4, :5]
            for k in (0, 1)
        ]
    )


def errors(*worst):
    """Errors of pixels whose worst channel, each time another one, is `worst`."""
    error = np.tile(np.array(worst)[:, None], (1, 3)) / 4
    error[np.arange(len(worst)), np.arange(len(worst)) % 3] = worst
    return error


def draw(path, frame, *worst, bound=BOUND):
    """The two maps of a first line of pixels with these errors."""
    x = np.arange(len(worst))
    write_error_map(path, frame, x, 0 * x, errors(*worst), bound, name="a scene")
    return maps_of(path)


def test_the_first_map_shows_the_magnitude(tmp_path, frame):
    magnitude, _ = draw(tmp_path / "map", frame, 0.0, 0.2, 0.4, 0.51)
    assert (magnitude[1:] == WHITE).all() and (magnitude[0, 4] == WHITE).all()  # no span
    brightness = magnitude[0, :3] @ (2, 7, 1)
    assert brightness[0] < brightness[1] < brightness[2] < 2000  # none looks like the background
    assert (magnitude[0, 3] == ORANGE).all()  # above 1/2


def test_the_second_map_shows_what_exceeds_perfect_rounding(tmp_path, frame):
    _, beyond = draw(tmp_path / "map", frame, 0.0, 0.5, 0.501, 0.51, 0.7)
    assert (beyond[1:] == WHITE).all()
    assert (beyond[0, :2] == GREY).all()  # at most 1/2
    brightness = beyond[0, 2:] @ (2, 7, 1)
    assert (np.diff(brightness) < -100).all()
    assert brightness[0] < GREY @ np.array((2, 7, 1)) - 200


def test_errors_above_the_bound_stand_out(tmp_path, frame):
    magnitude, beyond = draw(tmp_path / "map", frame, 0.3, 0.6, 0.79, 0.81, 9.0)
    blue = (beyond[0] == BLUE).all(axis=-1)
    assert blue.tolist() == [False, False, False, True, True]
    assert not (magnitude[0] == ORANGE).all(axis=-1).any()  # the scale reaches to the largest
    small, _ = draw(tmp_path / "other", frame, 0.3 / 9 * 0.5)
    assert np.abs(magnitude[0, 0] - small[0, 0]).max() < 12  # 0.3 of 9 LSB, and as much of 1/2


def test_without_a_bound_the_scales_reach_to_the_largest_error(tmp_path, frame, monkeypatch):
    lines = []
    monkeypatch.setattr(pictures._Sheet, "write", lambda self, *text: lines.extend(text))
    magnitude, beyond = draw(tmp_path / "map", frame, 0.3, 0.6, 9.0, bound=None)
    assert not (magnitude[0] == ORANGE).all(axis=-1).any()
    assert not (beyond[0] == BLUE).all(axis=-1).any()
    assert np.ptp(beyond[0, 2]) > 90 and (beyond[0, 0] == GREY).all()
    assert "9.0000 LSB, no bound derived; pixels" in lines[1]


def test_the_scale_of_good_runs_is_the_same(tmp_path, frame):
    one, _ = draw(tmp_path / "one", frame, 0.3, 0.4)
    two, _ = draw(tmp_path / "two", frame, 0.3, 0.79)
    assert (one[0, 0] == two[0, 0]).all()


def test_the_same_pixels_give_the_same_bytes(tmp_path, frame):
    for name in "ab":
        draw(tmp_path / name, frame, 0.3, 0.6)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_rounding_of_the_reference_is_no_error():
    assert excess(errors(0.5 + 1e-12, 0.5 - 1e-12, 0.25)).tolist() == [0, 0, -0.25]
    assert excess(errors(0.5001))[0] == pytest.approx(1e-4)


def test_the_title_says_scene_size_bound_and_count(tmp_path, frame, monkeypatch):
    lines = []
    monkeypatch.setattr(pictures._Sheet, "write", lambda self, *text: lines.extend(text))
    draw(tmp_path / "map", frame, 0.1, 0.5, 0.6, 0.7)
    assert lines == [
        "a scene, 5 × 4, 4 pixels shaded",
        "largest error 0.7000 LSB, derived bound 0.8000 LSB; "
        "pixels above the ½ LSB of perfect rounding: 2",
    ]


def test_single_pixels_of_large_frames_are_enlarged(tmp_path, frame):
    frame.width, frame.height = 640, 480
    x, y = np.divmod(np.arange(640 * 480), 480)
    error = np.zeros((len(x), 3))
    error[(x == 200) & (y == 300)] = 0.51
    write_error_map(tmp_path / "map", frame, x, y, error, BOUND)
    with Image.open(tmp_path / "map") as file:
        second = np.asarray(file.convert("RGB")).astype(int)[82:562, 58 + 640 + 96 + 58 :][:, :640]
    coloured = np.argwhere(np.ptp(second[5:-5, 5:-5], axis=-1) > 40) + 5
    assert len(coloured) == 25
    assert coloured.mean(axis=0).tolist() == [300, 200]


@pytest.mark.parametrize(("width", "height"), [(1, 1), (4096, 1), (1, 4096)])
def test_odd_shapes(tmp_path, frame, width, height):
    frame.width, frame.height = width, height
    x, y = np.array([width - 1]), np.array([height - 1])
    write_error_map(tmp_path / "error.png", frame, x, y, np.full((1, 3), 0.6), BOUND)
    with Image.open(tmp_path / "error.png") as file:
        assert file.width >= width and file.height >= height


def test_frame_without_spans(tmp_path, frame):
    none = np.zeros(0, int)
    write_error_map(tmp_path / "error.png", frame, none, none, np.zeros((0, 3)), BOUND)
    assert (maps_of(tmp_path / "error.png") == WHITE).all()
    assert canvas(frame, none, none, np.zeros((0, 3), int)).std(axis=(0, 1)).max() == 0
