# SPDX-License-Identifier: MIT
"""Errors of cos(s)**n over all of its operands: compiles power_errors.cpp and runs it.

Each whole part of n takes seconds. What is done is kept in the build folder, so that a run that was
stopped goes on from there.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from phong75.model.analysis import exhausted
from phong75.model.config import Config
from phong75.sim import build
from phong75.sim.design import BUILD

#: No native instructions: a cached build may move to another machine.
_FLAGS = ("-O3",)


@dataclass(frozen=True)
class PowerRow:
    """The errors of cos(s)**n for all n with the same `whole` part, over every 1 - cos(s).

    pairs: how many pairs of codes that are. least, greatest: the errors, and the codes of
    1 - cos(s) and of n where they are; as power_errors.cpp prints them, without its margin.
    """

    whole: int
    pairs: int
    least: float
    least_versine: int
    least_exponent: int
    greatest: float
    greatest_versine: int
    greatest_exponent: int

    @classmethod
    def of(cls, line: str) -> PowerRow:
        """The row in a `line` of the program."""
        kinds = (int, int, float, int, int, float, int, int)
        return cls(*(kind(word) for kind, word in zip(kinds, line.split(), strict=True)))

    def bounds(self) -> tuple[float, float]:
        """The least and the greatest error, as `exhausted.Stages` has them."""
        return self.least - exhausted.POWER_MARGIN, self.greatest + exhausted.POWER_MARGIN


def _folder(config: Config) -> Path:
    return BUILD / "power_errors" / exhausted.power_digest(config)


def program(config: Config) -> Path:
    """The program for `config`, compiled if necessary. Raises BuildError."""
    target = _folder(config) / "power_errors"
    with build.locked(target):
        if not target.is_file():
            build.replace(target.with_name("power_tables.h"), exhausted.power_header(config))
            part = target.with_suffix(".part")
            build.run_tool(["g++", *_FLAGS, f"-I{target.parent}", "-o", part, exhausted.SOURCE])
            part.replace(target)
    return target


def rows(
    config: Config, parts: Iterable[int] = exhausted.WHOLE_PARTS, again: bool = False,
    done: Callable[[float], None] | None = None,
) -> list[PowerRow]:  # fmt: skip
    """The rows of the whole `parts` of n, on all cores. Rows that the build folder keeps are read,
    unless they are wanted `again`. done: called with the part done, 0 to 1. Raises BuildError."""
    parts, found = list(parts), 0
    binary = program(config)

    def row(whole: int) -> PowerRow:
        nonlocal found
        kept = binary.parent / f"{whole}.row"
        if again or not kept.is_file():
            build.replace(kept, build.run_tool([binary, "rows", whole, whole]))
        found += 1
        if done:
            done(found / len(parts))
        return PowerRow.of(kept.read_text())

    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(row, parts))


def codes(config: Config, pairs: str) -> list[int]:
    """The codes of the powers of `pairs`, lines with a code of 1 - cos(s) and one of n.

    Raises BuildError.
    """
    return [int(line) for line in build.run_tool([program(config), "codes"], text=pairs).split()]
