"""Comparison of streams and error against exact values, on cases worked out by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from phong75.model.analysis.metrics import compare, error_metrics, rounded


def stream(rows):
    rows = np.array(rows, np.int64).reshape(-1, 6)
    return SimpleNamespace(x=rows[:, 0], y=rows[:, 1], rgb=rows[:, 2:5], last=rows[:, 5] != 0)


ROWS = [(0, 0, 1, 2, 3, 0), (1, 0, 4, 5, 6, 0), (2, 0, 7, 8, 9, 1)]


def test_equal_streams():
    found = compare(stream(ROWS), stream(ROWS))
    assert (found.pixels, found.mismatches, found.first) == (3, 0, None)
    assert compare(stream([]), stream([])).pixels == 0


@pytest.mark.parametrize("column", range(6))
@pytest.mark.parametrize("row", range(3))
def test_every_part_of_every_pixel_counts(row, column):
    changed = [list(r) for r in ROWS]
    changed[row][column] ^= 1
    found = compare(stream(ROWS), stream(changed))
    assert (found.pixels, found.mismatches) == (3, 1)
    assert found.first.index == row
    assert found.first.expected == ROWS[row] and found.first.got == tuple(changed[row])


def test_lost_repeated_and_reordered_pixels():
    lost = compare(stream(ROWS), stream(ROWS[:2]))
    assert (lost.pixels, lost.mismatches) == (3, 1)
    assert lost.first.expected == ROWS[2] and lost.first.got is None
    extra = compare(stream(ROWS), stream(ROWS + ROWS[2:]))
    assert (extra.pixels, extra.mismatches) == (4, 1)
    assert extra.first.expected is None and extra.first.got == ROWS[2]
    assert compare(stream(ROWS), stream(ROWS[::-1])).mismatches == 2


def test_rounding_is_half_up():
    assert rounded([0, 0.49, 0.5, 1.5, 2.5, 254.5, 255]).tolist() == [0, 0, 1, 2, 3, 255, 255]


def test_errors_by_hand():
    codes = np.array([[10, 20, 30], [40, 50, 255]], np.uint8)
    exact = np.array([[10.0, 20.25, 29.5], [41.0, 50.0, 255.0]])
    found = error_metrics(codes, exact)
    assert found["max_lsb"] == 1.0
    assert found["p999_lsb"] == 1.0
    assert found["mean_lsb"] == pytest.approx((0.25 + 0.5 + 1) / 6)
    assert found["rms_lsb"] == pytest.approx(np.sqrt((0.0625 + 0.25 + 1) / 6))
    assert found["correctly_rounded"] == 5 / 6  # 29.5 rounds to 30
    assert found["psnr_db"] == pytest.approx(10 * np.log10(255**2 * 6 / 1.3125))


def test_the_999th_thousandth():
    exact = np.zeros((1000, 3))
    codes = np.zeros((1000, 3), int)
    codes.reshape(-1)[:3] = (4, 3, 2)  # a thousandth of the channel values
    assert error_metrics(codes, exact)["p999_lsb"] == 2.0
    codes.reshape(-1)[2] = 0
    assert error_metrics(codes, exact)["p999_lsb"] == 0.0


def test_without_error_and_without_pixels():
    perfect = error_metrics(np.full((2, 3), 7), np.full((2, 3), 7.0))
    empty = error_metrics(np.zeros((0, 3), np.uint8), np.zeros((0, 3)))
    expected = {
        "max_lsb": 0.0, "mean_lsb": 0.0, "rms_lsb": 0.0, "p999_lsb": 0.0,
        "correctly_rounded": 1.0, "psnr_db": None,
    }  # fmt: skip
    assert perfect == empty == expected


def test_shapes_must_agree():
    with pytest.raises(ValueError, match="codes are"):
        error_metrics(np.zeros((2, 3)), np.zeros((3, 3)))
