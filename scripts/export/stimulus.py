# SPDX-License-Identifier: MIT
"""The stimulus of an export: a frame's register writes, spans and expected pixels as text that
Verilog's `$readmemh` reads, and the testbench that streams them."""

from __future__ import annotations

import dataclasses
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from phong75.model import twin
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.registers import address_bits, word_bits, writes
from phong75.model.spans import pack_frame, record_bits, span_fields, turns
from phong75.sim import design
from phong75.sim.latency import latencies

#: The testbench. It holds the numbers of the default configuration, which `fill` replaces.
TESTBENCH = design.SIM / "testbench" / "testbench.v"

#: A stimulus of more pixels takes every k-th span only.
MOST_PIXELS = 4096

#: Cycles from an accepted span to its first pixel, beside those of `latencies(...)["pixel"]`: the
#: walker, and the FIFO's slot and output register.
WALKER_AND_FIFO = 3


@dataclass(frozen=True)
class Stimulus:
    """A frame as text. spans, writes, pixels: the contents of the files of these names; numbers:
    {localparam of the testbench: value}."""

    spans: str
    writes: str
    pixels: str
    numbers: dict[str, int]

    def files(self) -> dict[str, str]:
        """{file name: text}."""
        return {f"{name}.hex": getattr(self, name) for name in ("spans", "writes", "pixels")}


def thin(frame: Frame, most: int = MOST_PIXELS) -> Frame:
    """`frame` with every k-th span, k so that about `most` pixels are left at the most."""
    stride = -(-int(frame.spans["length"].sum()) // most)
    if stride <= 1:
        return frame
    thinned = frame.take(np.arange(0, len(frame.spans), stride))
    spans = thinned.spans.copy()
    spans["last"] = False
    spans["last"][-1:] = True
    return dataclasses.replace(thinned, spans=spans)


def _hex(words: list[int], bits: int, layout: str) -> str:
    """`words` of `bits` bits, one a line; `layout` says in a comment what is in them."""
    digits = -(-bits // 4)
    return f"// {layout}\n" + "".join(f"{word:0{digits}x}\n" for word in words)


def span_bits(config: Config) -> int:
    """Width of `s_axis_tdata`."""
    return span_fields(config)[-1].lsb


def pixel_bits(config: Config) -> int:
    """Width of `m_axis_tdata`."""
    return 2 * config.coordinate_bits + 3 * config.colour_bits


def stimulus(frame: Frame, config: Config) -> Stimulus:
    """The stimulus of `frame`, a legal one with a span at least. Raises BuildError."""
    size = record_bits(config) // 8
    body = pack_frame(frame, config)
    records = [int.from_bytes(body[k : k + size], "big") for k in range(0, len(body), size)]
    to_write = writes(frame, config)
    place = [(address << word_bits(config)) | word for address, word in to_write]
    pixels = twin.render(frame, config)
    colour, coordinate = config.colour_bits, config.coordinate_bits
    codes = [
        (int(last) << pixel_bits(config))
        | (y << (3 * colour + coordinate)) | (x << 3 * colour)
        | (red << 2 * colour) | (green << colour) | blue
        for x, y, (red, green, blue), last in zip(
            pixels.x.tolist(), pixels.y.tolist(), pixels.rgb.tolist(), pixels.last, strict=True
        )
    ]  # fmt: skip
    numbers = {
        "SPAN_BITS": span_bits(config),
        "ADDRESS_BITS": address_bits(config),
        "WORD_BITS": word_bits(config),
        "COORDINATE_BITS": coordinate,
        "COLOUR_BITS": colour,
        "TURNS": turns(frame, config),
        "LATENCY": first_pixel_latency(config) + turns(frame, config) - 1,
        "RECORDS": len(records),
        "WRITES": len(to_write),
        "PIXELS": len(codes),
        "ZERO_NORMALS": twin.zero_normals(frame, config),
    }
    write_bits = address_bits(config) + word_bits(config)
    return Stimulus(
        _hex(records, span_bits(config) + 1, "{last, s_axis_tdata} of each record"),
        # A memory has one word at least.
        _hex(place or [0], write_bits, "{write_address, write_word} of each write"),
        _hex(codes, pixel_bits(config) + 1, "{last, m_axis_tdata} of each pixel"),
        numbers,
    )


def first_pixel_latency(config: Config) -> int:
    """Cycles from the edge that takes a span to the first edge at which its first pixel is offered,
    where a pixel takes one turn; each further turn adds a cycle. Raises BuildError.
    """
    return latencies(config)["pixel"] + WALKER_AND_FIFO


def fill(text: str, numbers: dict[str, int]) -> str:
    """The testbench `text` with `numbers` as its localparams. Raises ValueError if it lacks one."""
    for name, value in numbers.items():
        text, count = re.subn(
            rf"(?m)^(  localparam {name} += )-?\d+;", lambda m, v=value: f"{m[1]}{v};", text
        )
        if count != 1:
            raise ValueError(f"the testbench has no localparam {name}")
    return text


def testbench(numbers: dict[str, int], template: Path = TESTBENCH) -> str:
    """The text of the testbench with `numbers` filled in."""
    return fill(template.read_text(), numbers)
