# SPDX-License-Identifier: MIT
"""The options of `phong75`, each defined once: its name, its help, its values.

A parser raises InputError for a wrong value. What a parser needs of the model is imported when it
is called, so that `phong75 --help` is quick.
"""

from __future__ import annotations

import glob
import math
import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, NamedTuple

import typer

if TYPE_CHECKING:
    from phong75.model.config import Config

MOST_SEEDS = 100


class Size(NamedTuple):
    """Width and height of a picture in pixels."""

    width: int
    height: int


def parse_size(text: str) -> Size:
    """The size in a text such as 640x480. Raises InputError."""
    from phong75.model.config import DEFAULT
    from phong75.model.frame import InputError

    match = re.fullmatch(r"([0-9]{1,9})x([0-9]{1,9})", text)
    if not match:
        raise InputError(f"--size is `{text}`, not WIDTHxHEIGHT such as 640x480")
    size = Size(int(match[1]), int(match[2]))
    if not all(1 <= side <= DEFAULT.max_size for side in size):
        raise InputError(f"--size is {text}: each side must be from 1 to {DEFAULT.max_size}")
    return size


def parse_positive(name: str, text: str | float) -> float:
    """The number in `text` (or the default itself), an int where it is one, so that reports say 30
    and not 30.0. Raises InputError.
    """
    from phong75.model.frame import InputError

    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 1e-9 <= value <= 1e9:
        raise InputError(f"{name} is `{text}`, not a number from 1e-9 to 1e9")
    return whole(value)


def whole(value: float) -> float:
    """`value` as an int where it is one."""
    return int(value) if value == int(value) else value


def parse_count(name: str, value: str | int, least: int, most: int) -> int:
    """The whole number in `value`, a text or a default, from `least` to `most`.

    Raises InputError.
    """
    from phong75.model.frame import InputError

    text = str(value)
    if not (text.isascii() and text.isdigit() and least <= int(text) <= most):
        raise InputError(f"{name} is `{text}`, not a number from {least} to {most}")
    return int(text)


#: What --prune takes in place of a scene: the one that is run, or shown.
SELF = "self"


def prune_scene(text: str) -> str:
    """What --prune asks for: "" for nothing left out (also 0), SELF (also 1), else a scene."""
    return {"0": "", "1": SELF}.get(text, text)


def parse_grade(value: str | int) -> int:
    """The speed grade of the chip in `value`, a text or the default. Raises InputError."""
    from phong75.model.frame import InputError
    from phong75.scripts.synthesis.ecp5 import GRADES

    if str(value) not in map(str, GRADES):
        raise InputError(f"--grade is `{value}`, not one of {', '.join(map(str, GRADES))}")
    return int(value)


def parse_units(value: str | int) -> int:
    """The number of shading units in `value`, a text or the default. Raises InputError."""
    from phong75.model.config import UNITS
    from phong75.model.frame import InputError

    if str(value) not in map(str, UNITS):
        raise InputError(f"--units is `{value}`, not one of {', '.join(map(str, UNITS))}")
    return int(value)


def configuration(technique: str | None, config: str | None) -> Config:
    """The configuration that --technique or --config names, else the default one.

    Raises InputError.
    """
    from phong75.model.config import DEFAULT
    from phong75.model.frame import InputError
    from phong75.scripts import configurations

    if technique and config:
        raise InputError("--technique and --config both name what to build: give one of them")
    if technique:
        return configurations.technique(technique)
    return configurations.named(config) if config else DEFAULT


# -- completion by Tab -----------------------------------------------------------------------------


def scenes(incomplete: str) -> list[str]:
    """Bundled scenes, then files and folders, that begin with `incomplete`."""
    from phong75.model.front.scene import bundled_scenes

    files = sorted(glob.glob(f"{glob.escape(incomplete)}*")) if incomplete else []
    files = [f"{file}/" if Path(file).is_dir() else file for file in files]
    return [name for name in bundled_scenes() if name.startswith(incomplete)] + files


def configs(incomplete: str) -> list[str]:
    """Names of configurations that begin with `incomplete`."""
    from phong75.scripts.configurations import CONFIGURATIONS

    return [name for name in CONFIGURATIONS if name.startswith(incomplete)]


def techniques(incomplete: str) -> list[str]:
    """Names of techniques that begin with `incomplete`."""
    from phong75.model.config import TECHNIQUES

    return [name for name in TECHNIQUES if name.startswith(incomplete)]


def modules(incomplete: str) -> list[str]:
    """Names of modules in rtl/ that begin with `incomplete`."""
    from phong75.sim import design

    names = sorted(file.stem for file in design.sources())
    return [name for name in names if name.startswith(incomplete)]


# -- options ---------------------------------------------------------------------------------------

Scene = Annotated[
    str,
    typer.Argument(
        metavar="SCENE",
        help="A bundled scene, or the path of a scene file or a mesh.",
        autocompletion=scenes,
    ),
]
AnySize = Annotated[
    Size | None,
    typer.Option(
        "--size",
        metavar="WIDTHxHEIGHT",
        help="Size of the picture; default: what the scene gives.",
        parser=parse_size,
        show_default=False,
    ),
]
Technique = Annotated[
    str | None,
    typer.Option(
        "--technique",
        metavar="NAME",
        help="What is interpolated: phong (normals, the default), gouraud or flat.",
        autocompletion=techniques,
    ),
]
ConfigName = Annotated[
    str | None,
    typer.Option(
        "--config",
        metavar="NAME",
        help="A configuration of the pipeline; `phong75 configs` lists them.",
        autocompletion=configs,
    ),
]
Units = Annotated[
    int,
    typer.Option(
        "--units",
        metavar="N",
        help="How many lights are shaded side by side, 1, 2, 4 or 8; the others take turns.",
        parser=parse_units,
    ),
]
Fps = Annotated[
    float,
    typer.Option(
        "--fps",
        metavar="NUMBER",
        help="Frames a second that the cycle budget is checked for.",
        parser=lambda text: parse_positive("--fps", text),
    ),
]
Clock = Annotated[
    float,
    typer.Option(
        "--clock",
        metavar="MHZ",
        help="Clock of the hardware in MHz.",
        parser=lambda text: parse_positive("--clock", text),
    ),
]
Prune = Annotated[
    str,
    typer.Option(
        "--prune",
        metavar="SCENE",
        help="Build without what this SCENE does not need; `self`: the one that is run or shown.",
        autocompletion=scenes,
    ),
]
Spans = Annotated[
    Path | None,
    typer.Option("--spans", metavar="FILE", help="A span file to run in place of a scene."),
]
Out = Annotated[
    Path | None,
    typer.Option("--out", metavar="DIR", help="Folder of the results.", show_default=False),
]
SeedsOrNone = Annotated[
    int,
    typer.Option(
        "--seeds",
        metavar="N",
        help="How many placements to route; the median of their clocks counts; 0: no clock.",
        parser=lambda text: parse_count("--seeds", text, 0, MOST_SEEDS),
    ),
]
Grade = Annotated[
    int,
    typer.Option(
        "--grade", metavar="N", help="Speed grade of the chip, 6 or 8.", parser=parse_grade
    ),
]
Gates = Annotated[
    bool, typer.Option("--gates", help="Count gate equivalents in standard cells, too (minutes).")
]
Record = Annotated[
    bool,
    typer.Option(
        "--record",
        help="Write the figures into results/, unless a better run is there.",
    ),
]
