# SPDX-License-Identifier: MIT
"""Timing diagrams: docs/images/*.json, a subset of WaveDrom's WaveJSON, drawn as SVG.

A signal is {"name", "wave", "data"} or {} for a gap between groups. In a wave, a character stands
for a cycle: 0 and 1 are levels, p a clock, = a word (labelled by the next entry of "data"), x an
unknown word, z nothing at all; . continues the cycle before, and | continues it over many cycles
that are not drawn.
"foot": {"tick"} holds the number of each cycle, "head": {"text"} the title.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from phong75.sim.design import PACKAGE

FOLDER = PACKAGE / "docs" / "images"

_CYCLE, _LANE, _HIGH, _NAMES = 44, 26, 16, 128  # pixels: a cycle, a lane, a level, the names
_STYLE = (
    "text{font:12px sans-serif;fill:#1a1a1a}.small{font-size:11px;fill:#555}"
    ".line{fill:none;stroke:#1a1a1a;stroke-width:1.3}.grid{stroke:#ddd}.word{fill:#dcebf7}"
    ".unknown{fill:#e6e6e6}.break{fill:#fff;stroke:#999;stroke-width:1.3}"
)


def load(path: Path) -> dict[str, Any]:
    """The diagram in `path`. Raises ValueError if waves and ticks differ in length."""
    diagram = json.loads(path.read_text())
    cycles = len(ticks(diagram))
    for signal in diagram["signal"]:
        if signal and len(signal["wave"]) != cycles:
            raise ValueError(f"{path.name}: {signal['name']} has not {cycles} cycles")
    return diagram


def ticks(diagram: dict[str, Any]) -> list[str]:
    """The number of each cycle drawn, as text; "…" where cycles are left out."""
    return diagram["foot"]["tick"].split()


def values(signal: dict[str, Any]) -> list[str]:
    """The value of `signal` in each cycle drawn: "0", "1", "p", "x", "z", or a word's label."""
    labels: Iterator[str] = iter(signal.get("data", []))
    found: list[str] = []
    for letter in signal["wave"]:
        if letter in ".|":
            found.append(found[-1])
        elif letter == "=":
            found.append(next(labels))
        else:
            found.append(letter)
    return found


def _lane(signal: dict[str, Any], top: int) -> list[str]:
    """The drawing of `signal`, whose lane starts at `top`."""
    wave = signal["wave"]
    low, high = top + _LANE - 5, top + _LANE - 5 - _HIGH
    parts = []
    path = ""
    words = 0
    begin = 0
    while begin < len(wave):
        end = begin + 1
        while end < len(wave) and wave[end] in ".|":
            end += 1
        left, right = _NAMES + begin * _CYCLE, _NAMES + end * _CYCLE
        letter = wave[begin]
        if letter == "p":
            for cycle in range(begin, end):
                x = _NAMES + cycle * _CYCLE
                path += f"M{x} {low}V{high}H{x + _CYCLE // 2}V{low}H{x + _CYCLE}"
        elif letter in "01":
            level = high if letter == "1" else low
            path += f"{'L' if path else 'M'}{left} {level}H{right}"
        elif letter in "=x":
            kind = "word" if letter == "=" else "unknown"
            corners = (
                f"M{left + 3} {high}H{right - 3}L{right} {(low + high) // 2}L{right - 3} {low}"
                f"H{left + 3}L{left} {(low + high) // 2}Z"
            )
            parts.append(f'<path class="line {kind}" d="{corners}"/>')
            if letter == "=":
                text = escape(signal["data"][words])
                middle = (left + right) // 2
                parts.append(f'<text x="{middle}" y="{low - 4}" text-anchor="middle">{text}</text>')
                words += 1
        begin = end
    if path:
        parts.append(f'<path class="line" d="{path}"/>')
    name = escape(signal["name"])
    parts.append(f'<text x="{_NAMES - 10}" y="{low - 4}" text-anchor="end">{name}</text>')
    for cycle, letter in enumerate(wave):
        if letter == "|":
            x = _NAMES + cycle * _CYCLE + _CYCLE // 2
            parts.append(
                f'<path class="break" d="M{x - 5} {low + 4}L{x + 1} {high - 4}H{x + 7}L{x + 1} '
                f'{low + 4}Z"/>'
            )
    return parts


def svg(diagram: dict[str, Any]) -> str:
    """`diagram` as the text of an SVG file."""
    cycles = ticks(diagram)
    width = _NAMES + len(cycles) * _CYCLE + 12
    title = escape(diagram["head"]["text"])
    parts = [f'<text x="{_NAMES}" y="18">{title}</text>']
    top = 28
    lanes: list[str] = []
    for signal in diagram["signal"]:
        if signal:
            lanes += _lane(signal, top)
        top += _LANE if signal else _LANE // 2
    for cycle in range(len(cycles) + 1):
        x = _NAMES + cycle * _CYCLE
        parts.append(f'<path class="grid" d="M{x} 26V{top + 2}"/>')
    parts += lanes
    for cycle, number in enumerate(cycles):
        x = _NAMES + cycle * _CYCLE + _CYCLE // 2
        parts.append(
            f'<text class="small" x="{x}" y="{top + 16}" text-anchor="middle">{number}</text>'
        )
    parts.append(
        f'<text class="small" x="{_NAMES - 10}" y="{top + 16}" text-anchor="end">cycle</text>'
    )
    height = top + 24
    return "\n".join([
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" '
        f'height="{height}" role="img" aria-label="Timing diagram: {title}">',
        f"<style>{_STYLE}</style>",
        f'<rect width="{width}" height="{height}" fill="#fff"/>',
        *parts, "</svg>", "",
    ])  # fmt: skip


def drawings(folder: Path = FOLDER) -> Iterator[tuple[Path, Path, str]]:
    """(source, drawing, text of the drawing) of every diagram. Raises ValueError."""
    for source in sorted(folder.glob("*.json")):
        yield source, source.with_suffix(".svg"), svg(load(source))
