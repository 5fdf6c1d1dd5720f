# SPDX-License-Identifier: MIT
"""Settings of Sphinx. `make docs` builds the pages; nothing is fetched from a network."""

import inspect
import re

import phong75

project = "Phong75"
author = "Phong75 contributors"
project_copyright = author
version = release = phong75.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = f"Phong75 {release}"
html_show_sphinx = False
html_static_path = ["static"]
html_css_files = ["page.css"]
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True
autodoc_class_signature = "separated"  # a configuration has dozens of fields

_CODE = re.compile(r"`([^`]+)`")


def _items(lines):
    """Lines of a paragraph; of a list, one line per item, with an empty line before the first."""
    found = []
    for line in map(str.strip, lines):
        item = line.startswith("- ")
        if item and found and not found[-1].startswith("- "):
            found.append("")
        if not item and found and found[-1].startswith("- "):
            found[-1] += f" {line}"
        else:
            found.append(line)
    return found


def plain_docstring(app, what, name, thing, options, lines):
    """Docstrings are plain text with `code` between single backticks: escape what would be markup
    in reStructuredText, and keep indented blocks as they are."""
    text = inspect.cleandoc("\n".join(lines))
    blocks = []
    for block in text.split("\n\n"):
        indented = all(line.startswith("    ") for line in block.splitlines() if line)
        if indented and block.strip():
            blocks.append("::\n\n" + block)
            continue
        parts = re.split(r"(`[^`]+`)", block)
        for k, part in enumerate(parts):
            if k % 2:
                parts[k] = _CODE.sub(r"``\1``", part)
            else:
                parts[k] = re.sub(r"([*|_\\])", r"\\\1", part)
        blocks.append("\n".join(_items("".join(parts).splitlines())))
    lines[:] = "\n\n".join(blocks).splitlines()


def setup(app):
    """Connect what this file adds."""
    app.connect("autodoc-process-docstring", plain_docstring)
