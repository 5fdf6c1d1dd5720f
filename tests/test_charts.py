# SPDX-License-Identifier: MIT
"""The tessellation chart compares like with like."""

import pytest

from phong75.model.studies import charts, methods, tessellation
from phong75.scripts import recorded

TECHNIQUES = ("phong", "gouraud", "flat", "cubic")


def row(shape, technique, level):
    """A row of the study; every figure of a row is another one."""
    error = 8.0 / level / (1 + TECHNIQUES.index(technique))
    return {
        "shape": shape, "technique": technique, "level": level, "triangles": 10 * level**2,
        "cycles": "" if technique == "cubic" else 70_000 + level, "rms_lsb": error + 0.25,
        "method_rms_lsb": error, "highlight_rms_lsb": 3 * error,
    }  # fmt: skip


@pytest.fixture
def rows():
    return [row(s, t, k) for s in ("sphere", "torus") for t in TECHNIQUES for k in (4, 8, 16)]


@pytest.fixture
def figure(rows, tmp_path, monkeypatch):
    """The chart of `rows`."""
    figures = []
    monkeypatch.setattr(charts, "_save", lambda figure, path: figures.append(figure))
    charts.tessellation_chart(rows, tmp_path / "chart")
    return figures[0]


def curves(axes):
    """{label: heights} of the curves in a panel."""
    return {
        line.get_label(): list(line.get_ydata())
        for line in axes.get_lines() if not line.get_label().startswith("_")
    }  # fmt: skip


def test_a_panel_shows_either_codes_or_unrounded_values(figure, rows):
    panels = figure.get_axes()
    assert len(panels) == 6
    for k, panel in enumerate(panels):
        line, column = divmod(k, 2)
        shape = ("sphere", "torus")[column]
        error = ("method_rms_lsb", "highlight_rms_lsb", "rms_lsb")[line]
        expected = {
            charts.TECHNIQUE_NAMES[t]: [
                r[error] for r in rows if (r["shape"], r["technique"]) == (shape, t)
            ]
            for t in TECHNIQUES if line < 2 or t != "cubic"
        }  # fmt: skip
        assert curves(panel) == expected
        title = panel.get_title(loc="left")
        assert title.startswith("not rounded" if line < 2 else "8-bit codes of the RTL")


def test_the_legend_says_what_has_no_rtl(figure):
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "Phong", "Gouraud", "flat", "cubic (model only)"
    ]  # fmt: skip


def test_perfect_rounding_is_drawn_where_codes_are(figure):
    for k, panel in enumerate(figure.get_axes()):
        levels = [line.get_ydata()[0] for line in panel.get_lines() if line.get_linestyle() == ":"]
        shape = ("sphere", "torus")[k % 2]
        assert levels == ([tessellation.perfect_rms(shape)] if k >= 4 else [])
        assert all(0.28 < level < 0.30 for level in levels)


def test_perfect_rounding_is_that_of_the_frames():
    """The frames of the sweep have flat parts, so their errors are not spread evenly over 1/2."""
    found = methods.perfect()
    assert found["rms_lsb"] == pytest.approx(0.294440, abs=1e-6)
    assert found["max_lsb"] <= 0.5 and found["correctly_rounded"] == 1
    figures = recorded.figures("sweep")["configurations"]
    assert all(found["rms_lsb"] <= of["rms_lsb"] for of in figures.values())


def test_files_repeat(rows, tmp_path):
    for name in "ab":
        charts.tessellation_chart(rows, tmp_path / name)
    for kind in ("png", "svg"):
        assert (tmp_path / f"a.{kind}").read_bytes() == (tmp_path / f"b.{kind}").read_bytes()
