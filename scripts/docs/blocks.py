# SPDX-License-Identifier: MIT
"""Markers in Markdown files, and what stands between them.

`<!-- table: NAME -->` and `<!-- end -->` enclose a table or a drawing on lines of their own;
`<!-- figure: NAME -->` and `<!-- end -->` enclose a figure within a sentence. `make docs` fills
both; tests/test_docs.py compares the files with what would be filled in.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from phong75.sim.design import PACKAGE

Maker = Callable[[], str]

_MARKER = re.compile(r"<!-- (table|figure): ([\w.-]+) -->(.*?)<!-- end -->", re.DOTALL)
#: Markdown would end the paragraph there and begin a block of HTML.
_FIRST = re.compile(r"^\s*<!-- figure: [^>]* -->", re.MULTILINE)
_ANY = re.compile(r"<!-- (?:table: [^>]*|figure: [^>]*|end) -->")


class MarkerError(Exception):
    """A marker without its end, or of a name that nothing makes; the message is one line."""


def pages(root: Path = PACKAGE) -> list[Path]:
    """The Markdown files in which markers are filled: those of docs/ and of the top folder."""
    return [*sorted(root.glob("*.md")), *sorted((root / "docs").rglob("*.md"))]


def fill(
    text: str, tables: Mapping[str, Maker], figures: Mapping[str, Maker],
    keep: Collection[str] = (),
) -> str:  # fmt: skip
    """`text` with everything between markers made anew, but for the names in `keep`.

    Raises MarkerError.
    """
    if found := _FIRST.search(text):
        raise MarkerError(f"{found[0].strip()} is the first on its line")
    makers = {"table": tables, "figure": figures}
    paired = 0

    def replacement(match: re.Match[str]) -> str:
        nonlocal paired
        paired += 2
        kind, name, _ = match.groups()
        if _ANY.search(match[3]):
            raise MarkerError(f"<!-- {kind}: {name} --> has no end")
        if name not in makers[kind]:
            raise MarkerError(f"<!-- {kind}: {name} -->: nothing makes it")
        if name in keep:
            return match[0]
        made = makers[kind][name]()
        space = "\n\n" if kind == "table" else ""
        return f"<!-- {kind}: {name} -->{space}{made}{space}<!-- end -->"

    filled = _MARKER.sub(replacement, text)
    if paired != len(_ANY.findall(text)):
        raise MarkerError("a marker stands alone")
    return filled


def used(text: str) -> set[tuple[str, str]]:
    """(kind, name) of every marker in `text`."""
    return {(kind, name) for kind, name, _ in _MARKER.findall(text)}
