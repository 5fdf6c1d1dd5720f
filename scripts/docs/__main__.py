# SPDX-License-Identifier: MIT
"""Fill the tables and figures of docs/ and README.md, draw, and build the pages: `make docs`.

The pages go to build/docs. Exit code: 0; 1 if Sphinx has a warning; 2 if a marker or a record is
wrong, with one line on stderr that says which.
"""

from __future__ import annotations

import subprocess
import sys

from phong75.model.frame import InputError
from phong75.scripts import console
from phong75.scripts.docs import blocks, timing
from phong75.scripts.docs.contents import FIGURES, TABLES
from phong75.sim.design import BUILD, PACKAGE


def write() -> list[str]:
    """Fill all pages and draw all timing diagrams; returns the names of the files that changed.

    Raises MarkerError, OSError, ValueError (a diagram that cannot be drawn).
    """
    changed = []
    for page in blocks.pages():
        text = page.read_text()
        try:
            filled = blocks.fill(text, TABLES, FIGURES)
        except blocks.MarkerError as error:
            raise blocks.MarkerError(f"{page.relative_to(PACKAGE)}: {error}") from None
        if filled != text:
            page.write_text(filled)
            changed.append(str(page.relative_to(PACKAGE)))
    for source, drawing, svg in timing.drawings():
        if not drawing.is_file() or drawing.read_text() != svg:
            drawing.write_text(svg)
            changed.append(f"{drawing.relative_to(PACKAGE)} (from {source.name})")
    return changed


def build() -> int:
    """Build the pages with Sphinx, warnings being errors; returns the exit code."""
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html"]
    done = subprocess.run([*command, str(PACKAGE / "docs"), str(BUILD / "docs")], cwd=PACKAGE)
    return 1 if done.returncode else 0


def main() -> int:
    """All of it; returns the exit code. Raises InputError, OSError."""
    try:
        changed = write()
    except (blocks.MarkerError, ValueError) as error:
        raise InputError(str(error)) from None
    for name in changed:
        console.say(f"changed: {name}")
    console.phase("building the pages")
    if code := build():
        return code
    console.say(console.shown(BUILD / "docs" / "index.html"))
    return console.GOOD


if __name__ == "__main__":
    sys.exit(console.exit_code(main))
