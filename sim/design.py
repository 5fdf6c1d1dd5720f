# SPDX-License-Identifier: MIT
"""Files of the design: the only module that knows the folders of rtl/.

rtl/phong75.f lists the files of the design in data order. A copy of rtl/ (a mutated one, for
example) has its own list. In a folder without a list, such as that of a netlist, all .v files
belong to the design.
"""

from __future__ import annotations

import os
from pathlib import Path

from phong75.sim import environment

#: Root of the package: the checkout, or the folder of the installed package.
PACKAGE = Path(__file__).resolve().parent.parent
RTL = PACKAGE / "rtl"
SIM = PACKAGE / "sim"
#: Modules that replace those of the same names on a Lattice ECP5.
ECP5 = RTL / "ecp5"
TOP = "phong_pipeline"

IN_CHECKOUT = (PACKAGE / "pyproject.toml").is_file()


def _build_folder() -> Path:
    """The build folder: $PHONG75_BUILD, else build/ of a checkout, else the user's cache folder."""
    if named := os.environ.get(environment.BUILD):
        return Path(named).resolve()
    if IN_CHECKOUT:
        return PACKAGE / "build"
    cache = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(cache) / "phong75"


#: Folder of everything that is built.
BUILD = _build_folder()


def sources(rtl: Path | None = None, technology: Path | None = None) -> list[Path]:
    """The Verilog files of the design, in the order of its file list.

    rtl: folder of the design, None for the project's own. technology: folder whose modules replace
    those of the same names; its further modules are appended.
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
    """The hand-written headers; `build.generate_header` generates phong_config.vh."""
    return sorted((rtl or RTL).glob("*.vh"))


def folders(rtl: Path | None = None) -> list[Path]:
    """The folders in which a tool finds the design's headers and modules by name."""
    rtl = rtl or RTL
    return list(dict.fromkeys([rtl, *(file.parent for file in sources(rtl))]))


def module_file(name: str, rtl: Path | None = None) -> Path | None:
    """The Verilog file of module `name`; None if the design has no such module."""
    return next((file for file in sources(rtl) if file.stem == name), None)
