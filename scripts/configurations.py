# SPDX-License-Identifier: MIT
"""Every configuration that has a name, for --config: those of all tables and charts."""

from __future__ import annotations

import dataclasses
import difflib
import re
from collections.abc import Iterable

from phong75.model.analysis.pruning import BY_HAND
from phong75.model.config import (
    CURVE_BUILDS,
    DEFAULT,
    LIGHT_BUILDS,
    PLACE_BUILDS,
    TECHNIQUES,
    Config,
)
from phong75.model.frame import InputError
from phong75.model.studies import methods


def plain(name: str) -> str:
    """A name as it is typed: `diffuse grey` of a table is diffuse_grey."""
    return re.sub(r"\W+", "_", name)


def _groups() -> dict[str, dict[str, Config]]:
    older = {name: config for name, config in TECHNIQUES.items() if config is not DEFAULT}
    by_hand = {plain(name): config for name, config in BY_HAND.items()}
    sweep = {plain(name): config for name, config in methods.CONFIGS.items()}
    return {
        "the full pipeline": {DEFAULT.name: DEFAULT},
        "older techniques": older,
        "with less built in": {n: c for n, c in by_hand.items() if n not in older},
        "with more built in": {
            "check_writes": dataclasses.replace(DEFAULT, name="check_writes", check_writes=True),
            "hold_unlit": dataclasses.replace(DEFAULT, name="hold_unlit", hold_unlit=True),
            "quadratic_normals": dataclasses.replace(
                DEFAULT, name="quadratic_normals", normal_order=2
            ),
        },
        "for pictures of 10 and 12 bits a colour": {
            "colour_10": dataclasses.replace(DEFAULT, name="colour_10", colour_bits=10),
            "colour_10_wide": methods.of_width(20, "colour_10_wide", colour_bits=10),
            "colour_12": methods.of_width(22, "colour_12", colour_bits=12),
        },
        "with curves by table, or jumps": CURVE_BUILDS,
        "with several lights": LIGHT_BUILDS,
        "with a light at a place": PLACE_BUILDS,
        "points of `phong75 sweep`": {n: c for n, c in sweep.items() if n != DEFAULT.name},
    }


#: {what they are: {name: configuration}}; no name is in two of them.
GROUPS = _groups()
#: Builds of which `phong75 synth --record` keeps the figures, beside the default one.
BUILDS = GROUPS["with more built in"] | CURVE_BUILDS | LIGHT_BUILDS | PLACE_BUILDS
CONFIGURATIONS = {name: config for group in GROUPS.values() for name, config in group.items()}


def unknown(what: str, name: str, names: Iterable[str], listed_by: str = "") -> InputError:
    """The error for a `name` that is not among `names`: with the one that was meant, or all, or
    the command that lists them. what: what the user gave it to, such as --config."""
    names = list(names)
    close = difflib.get_close_matches(plain(name), names, 1, 0.5)
    if close:
        hint = f"did you mean {close[0]}?"
    else:
        hint = f"`{listed_by}` lists them" if listed_by else f"there is {', '.join(names)}"
    return InputError(f"{what}: there is no `{name}`; {hint}")


def named(name: str, what: str = "--config") -> Config:
    """The configuration called `name`. Raises InputError."""
    try:
        return CONFIGURATIONS[plain(name)]
    except KeyError:
        raise unknown(what, name, CONFIGURATIONS, "phong75 configs") from None


def technique(name: str) -> Config:
    """The configuration of technique `name`. Raises InputError."""
    if name not in TECHNIQUES:
        raise unknown("--technique", name, TECHNIQUES)
    return TECHNIQUES[name]
