# SPDX-License-Identifier: MIT
"""The table of `make stability` in terminals of several widths."""

import io

import pytest
from rich.console import Console

from phong75.scripts import stability

GOOD = {
    "case": "normals 179.99° apart, along a span as long as the largest picture",
    "extreme": "", "expected": "every pixel within the bound, none lost", "pixels": 8_294_400,
    "max_lsb": 0.5123, "bound_lsb": 0.6, "mismatches": 0, "zero_normals": 0, "failures": [],
    "verdict": "ok",
}  # fmt: skip
BAD = GOOD | {
    "case": "[a case] that failed", "mismatches": 7, "max_lsb": None, "verdict": "FAILED",
}  # fmt: skip
ERRORS = [
    {"family": "n ≤ 128, W constant", "bound_lsb": 0.6, "scenes_lsb": 0.5, "adversarial_lsb": 0.55,
     "adversarial_bound_lsb": 0.58}
]  # fmt: skip


def text_of(table, width):
    """What a terminal of `width` characters shows."""
    console = Console(file=io.StringIO(), width=width)
    console.print(table)
    return console.file.getvalue()


@pytest.mark.parametrize("width", [60, 80, 100, 119, 120, 200])
def test_verdicts_and_figures_are_whole(width):
    text = text_of(stability.case_table([GOOD, BAD]), width)
    assert "…" not in text
    assert max(map(len, text.splitlines())) <= width
    (good,) = (line.split("│") for line in text.splitlines() if "│ ok " in line)
    (bad,) = (line.split("│") for line in text.splitlines() if "│ FAILED " in line)
    good, bad = ([cell.strip() for cell in line if cell.strip()] for line in (good, bad))
    assert good[0] == "ok" and good[-4:] == ["8 294 400", "0", "0.5123", "0.6000"]
    assert bad[0] == "FAILED" and bad[1].startswith("[a case]")
    assert bad[-4:] == ["8 294 400", "7", "–", "0.6000"]


def test_a_wide_terminal_shows_what_is_expected():
    for width, there in ((119, False), (120, True)):
        text = text_of(stability.case_table([GOOD]), width)
        assert ("expected" in text) == there
        assert ("every pixel" in text) == there


def test_a_row_takes_at_most_three_lines_of_80_characters():
    one, two = (text_of(stability.case_table([GOOD] * k), 80).count("\n") for k in (1, 2))
    assert two - one <= 3


def test_the_other_tables_fit_80_characters():
    powers = [{"n": 20, "max_error": 1.25e-5, "bound": 2.5e-5}]
    for table in (stability.error_table(ERRORS), stability.power_table(powers)):
        text = text_of(table, 80)
        assert "…" not in text and max(map(len, text.splitlines())) <= 80
    assert "1.25e-05" in text and "2.5e-05" in text
    assert "0.5500" in text_of(stability.error_table(ERRORS), 80)
