"""The pictures show what they should, and the same pixels give the same bytes."""

import numpy as np
import pytest
from PIL import Image

from phong75.model.analysis.pictures import canvas, write_error_map, write_picture
from phong75.model.config import DEFAULT
from phong75.model.frame import SPAN_DTYPE, Frame, MaterialTable


@pytest.fixture
def frame():
    table = MaterialTable.empty(DEFAULT)
    return Frame(5, 4, (0, 1), False, (10, 20, 30), table, np.zeros(0, SPAN_DTYPE))


def test_canvas(frame):
    x, y = np.array([0, 4, 4, 5, -1, 0]), np.array([0, 3, 3, 0, 0, 4])
    rgb = np.array([[1, 2, 3], [4, 5, 6], [7, 8, 9], [9, 9, 9], [9, 9, 9], [9, 9, 9]])
    shown = canvas(frame, x, y, rgb)
    assert shown.shape == (4, 5, 3) and shown.dtype == np.uint8
    assert shown[0, 0].tolist() == [1, 2, 3]
    assert shown[3, 4].tolist() == [7, 8, 9]  # the later one wins
    assert (shown == (10, 20, 30)).all(axis=2).sum() == 18  # what lies outside is left out


def test_picture_keeps_every_bit(tmp_path, frame):
    rng = np.random.default_rng(1)
    picture = rng.integers(0, 256, (4, 5, 3), np.uint8)
    write_picture(tmp_path / "a.png", picture)
    with Image.open(tmp_path / "a.png") as read:
        assert read.mode == "RGB" and not read.info
        np.testing.assert_array_equal(np.asarray(read), picture)


def dots_of(path, frame):
    """The colours of the dots of an error map of 5 x 4 dots, int[4, 5, 3]."""
    with Image.open(path) as read:
        assert read.format == "PNG" and not set(read.info) - {"dpi"}
        shown = np.asarray(read.convert("RGB")).astype(int)
    side, left, top = 80, 70, 45  # of a dot; the margins
    return shown[top + side // 2 :: side, left + side // 2 :: side][: frame.height, : frame.width]


def test_error_map(tmp_path, frame):
    x, y = np.array([0, 1, 2]), np.array([0, 0, 0])
    error = np.array([[0.0, 0.0, 0.0], [0.1, 0.5, 0.2], [0.9, 0.0, 1.0]])
    for name in "ab":
        write_error_map(tmp_path / name, frame, x, y, error, 0.8)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()
    dots = dots_of(tmp_path / "a", frame)
    assert (dots[1:] == 153).all() and (dots[0, 3:] == 153).all()  # grey: no span
    brightness = dots[0, :3].sum(axis=1)
    assert brightness[0] < 10 < brightness[1] < brightness[2]  # the largest channel counts


def test_the_scale_grows_with_the_error(tmp_path, frame):
    x, y = np.arange(2), np.zeros(2, int)
    error = np.repeat([[1.0], [9.0]], 3, axis=1)
    write_error_map(tmp_path / "small", frame, x[:1], y[:1], error[:1], 0.8)
    write_error_map(tmp_path / "large", frame, x, y, error, 0.8)
    small, large = dots_of(tmp_path / "small", frame)[0], dots_of(tmp_path / "large", frame)[0]
    assert (small[0] == large[1]).all() and large[0].sum() < large[1].sum() / 2


@pytest.mark.parametrize(("width", "height"), [(1, 1), (4096, 1), (1, 4096)])
def test_odd_shapes(tmp_path, frame, width, height):
    frame.width, frame.height = width, height
    x, y = np.array([width - 1]), np.array([height - 1])
    write_error_map(tmp_path / "error.png", frame, x, y, np.full((1, 3), 0.5), 0.8)
    with Image.open(tmp_path / "error.png") as read:
        assert read.width >= width and read.height >= height


def test_frame_without_spans(tmp_path, frame):
    none = np.zeros(0, int)
    write_error_map(tmp_path / "error.png", frame, none, none, np.zeros((0, 3)), 0.8)
    assert canvas(frame, none, none, np.zeros((0, 3), int)).std(axis=(0, 1)).max() == 0
