# SPDX-License-Identifier: MIT
"""Where the design's files are: the one place that knows the folders of `rtl/`.

The file list rtl/phong75.f says which files belong to the design, in the order of the data. A copy
of `rtl/` (a mutated one, say) brings its own list; a folder without a list, such as that of a
netlist, is taken as it is.
"""

from __future__ import annotations

import os
from pathlib import Path

from phong75.sim import environment

#: The package: the checkout, or where a wheel was installed.
PACKAGE = Path(__file__).resolve().parent.parent
RTL = PACKAGE / "rtl"
SIM = PACKAGE / "sim"
#: The modules that stand for those of the same names on a Lattice ECP5.
ECP5 = RTL / "ecp5"
TOP = "phong_pipeline"

IN_CHECKOUT = (PACKAGE / "pyproject.toml").is_file()


def _build_folder() -> Path:
    """$PHONG75_BUILD; else build/ of a checkout; else phong75/ in the user's cache folder."""
    if named := os.environ.get(environment.BUILD):
        return Path(named).resolve()
    if IN_CHECKOUT:
        return PACKAGE / "build"
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "phong75"


#: Where everything that is built goes, and nothing else.
BUILD = _build_folder()


def sources(rtl: Path | None = None, technology: Path | None = None) -> list[Path]:
    """The Verilog files of the design in `rtl` (RTL if None), in the order of its file list.

    technology: a folder whose modules replace those of the same names.
    """
    rtl = rtl or RTL
    listed = rtl / "phong75.f"
    if listed.is_file():
        lines = (line.partition("//")[0].strip() for line in listed.read_text().splitlines())
        files = [rtl / line for line in lines if line.endswith(".v")]
    else:
        files = sorted(rtl.glob("*.v"))
    if technology:
        replaced = {file.name: file for file in technology.glob("*.v")}
        files = [replaced.get(file.name, file) for file in files]
        files += [
            file
            for name, file in sorted(replaced.items())
            if file not in files and name != "harness.v"
        ]
    return files


def headers(rtl: Path | None = None) -> list[Path]:
    """The headers that are written by hand (`build.generate_header` writes the other one)."""
    return sorted((rtl or RTL).glob("*.vh"))


def folders(rtl: Path | None = None) -> list[Path]:
    """The folders in which a tool finds headers and modules by name."""
    rtl = rtl or RTL
    return list(dict.fromkeys([rtl, *(file.parent for file in sources(rtl))]))


def module_file(name: str, rtl: Path | None = None) -> Path | None:
    """The file of module `name`; None if the design has no such module."""
    return next((file for file in sources(rtl) if file.stem == name), None)
