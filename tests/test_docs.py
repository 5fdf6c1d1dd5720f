# SPDX-License-Identifier: MIT
"""README.md and docs/: tables and figures against records and design, links, commands, examples."""

from __future__ import annotations

import json
import re

import pytest

from phong75.model import registers
from phong75.model.config import DEFAULT as C
from phong75.scripts import recorded
from phong75.scripts.docs import blocks, facts, tables, timing
from phong75.scripts.docs.contents import FIGURES, TABLES, UNCOMPARED
from phong75.sim.design import PACKAGE
from phong75.sim.formal.proofs import PROOFS

PAGES = blocks.pages()
README = PACKAGE / "README.md"
NAMES = [str(page.relative_to(PACKAGE)) for page in PAGES]


# -- tables and figures ----------------------------------------------------------------------------


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_tables_and_figures_are_those_of_records_and_design(page):
    text = page.read_text()
    filled = blocks.fill(text, TABLES, FIGURES, keep=UNCOMPARED)
    assert filled == text, f"{page.name} is old: make docs"


def test_every_table_and_figure_is_shown():
    shown = set().union(*(blocks.used(page.read_text()) for page in PAGES))
    assert shown == {("table", name) for name in TABLES} | {("figure", name) for name in FIGURES}


def test_a_date_or_a_commit_alone_changes_nothing_that_is_compared(tmp_path, monkeypatch):
    for path in recorded.FOLDER.glob("*.json"):
        record = json.loads(path.read_text())
        record |= {"date": "1975-06-01", "commit": "0000000"}
        (tmp_path / path.name).write_text(json.dumps(record))
    before = {name: make() for name, make in TABLES.items() if name not in UNCOMPARED}
    figures = {name: make() for name, make in FIGURES.items()}
    monkeypatch.setattr(recorded, "FOLDER", tmp_path)
    assert before == {name: TABLES[name]() for name in before}
    assert figures == {name: FIGURES[name]() for name in figures}
    assert "1975-06-01" in TABLES["provenance"]()


def test_a_changed_figure_is_noticed(tmp_path, monkeypatch):
    record = recorded.load("formal")
    record["figures"]["hold"] -= 1
    (tmp_path / "formal.json").write_text(json.dumps(record))
    tests = TABLES["tests"]()
    monkeypatch.setattr(recorded, "FOLDER", tmp_path)
    assert TABLES["tests"]() not in tests


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<!-- table: none --> <!-- end -->", "nothing makes it"),
        ("a <!-- figure: one --> 1", "stands alone"),
        ("1 <!-- end -->", "stands alone"),
        ("a <!-- figure: one --> <!-- figure: one -->1<!-- end -->", "has no end"),
        ("a\n<!-- figure: one -->1<!-- end -->", "first on its line"),
    ],
)
def test_a_wrong_marker_is_an_error(text, message):
    with pytest.raises(blocks.MarkerError, match=message):
        blocks.fill(text, {}, {"one": lambda: "1"})


def test_markers_are_filled():
    text = "a <!-- figure: one -->0<!-- end -->, <!-- table: two --> <!-- end -->"
    makers = {"one": lambda: "1", "two": lambda: "| 2 |"}
    filled = "a <!-- figure: one -->1<!-- end -->, <!-- table: two -->\n\n| 2 |\n\n<!-- end -->"
    assert blocks.fill(text, makers, makers) == filled
    assert blocks.fill(filled, makers, makers) == filled
    assert blocks.fill(text, makers, makers, keep=("one", "two")) == text


def test_timing_diagrams_are_drawn_from_their_sources():
    drawn = list(timing.drawings())
    assert drawn
    for _, drawing, svg in drawn:
        assert drawing.read_text() == svg, f"{drawing.name} is old: make docs"


# -- what the records say of today's design --------------------------------------------------------


def test_bounds_are_rounded_up():
    for n in (32, 128):
        bound = next(
            row["certified_lsb"] for row in recorded.figures("prove")["families"]
            if (row["limit"], row["steep"]) == (n, True)
        )  # fmt: skip
        assert bound <= float(FIGURES[f"bound.n{n}"]()) <= bound + 0.01
    assert tables.above(0.501) == "0.51" and tables.above(0.5) == "0.50"
    assert (
        tables.above_digits(1.841e-5, 2) == "1.9e-05" and tables.above_digits(0.542, 3) == "0.542"
    )


def test_the_multipliers_are_counted():
    assert facts.modules()["multiplier"] <= 19
    assert recorded.figures("synth-grade6")["resources"]["dsp"] == facts.modules()["multiplier"]


def test_the_record_has_all_proofs():
    found = recorded.figures("formal")
    broken = sum(len(proof.broken_designs) for proof in PROOFS)
    assert found["proofs"] == found["hold"] == len(PROOFS), "the record is old: make formal"
    assert found["broken_designs"] == found["broken_designs_failing"] == broken
    assert found["unbounded"] == sum(proof.mode == "prove" for proof in PROOFS)


def test_the_address_map_has_every_field():
    rows = facts.register_table().splitlines()[2:]
    assert len(rows) == len(registers.FIELDS)  # half_x and half_z share one, W(i) has its own
    assert f"n ({C.exponent})" in facts.register_table()


# -- words -----------------------------------------------------------------------------------------


def test_the_first_page_is_short():
    assert len(README.read_text().splitlines()) <= 130


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_links_lead_somewhere(page):
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith("https://"):
            continue
        name, _, anchor = target.partition("#")
        file = (page.parent / name).resolve() if name else page
        assert file.exists(), target
        if anchor:
            headings = re.findall(r"^#+ (.*)$", file.read_text(), re.MULTILINE)
            slugs = [re.sub(r"[^\w\- ]", "", h.lower()).replace(" ", "-") for h in headings]
            assert anchor in slugs, target


@pytest.mark.parametrize("page", PAGES, ids=NAMES)
def test_make_targets_and_their_variables_exist(page):
    makefile = (PACKAGE / "Makefile").read_text()
    targets = set(re.findall(r"^([a-z][\w-]*):", makefile, re.MULTILINE))
    variables = dict(re.findall(r"^variables_([\w-]+) := (.*)$", makefile, re.MULTILINE))
    calls = re.compile(r"(?:`|^)make ([a-z][\w-]*(?: [A-Z_]+=[^\s`]*)*)", re.MULTILINE)
    for command in calls.findall(page.read_text()):
        target, *given = command.split(" ")
        assert target in targets, f"make {command}"
        for setting in given:
            assert setting.partition("=")[0] in variables.get(target, "").split(), command


@pytest.mark.parametrize("page", [README, PACKAGE / "docs" / "python.md"], ids=lambda p: p.name)
def test_the_python_example_runs(page, capsys):
    code = re.search(r"```python\n(.*?)```", page.read_text(), re.DOTALL)[1]
    names: dict = {}
    exec(compile(code, page.name, "exec"), names)
    assert abs(names["pixels"].rgb - names["exact"]).max() < 0.6
