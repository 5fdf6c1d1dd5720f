# SPDX-License-Identifier: MIT
"""Latencies of a configuration: the macros of rtl/latency.vh, evaluated by Verilator."""

from __future__ import annotations

import functools
import re

from phong75.model.config import DEFAULT, Config
from phong75.sim import design
from phong75.sim.elaborate import elaborate

_MACRO = re.compile(r"^`define PHONG_(\w+)_LATENCY\b", re.MULTILINE)


def latencies(config: Config = DEFAULT) -> dict[str, int]:
    """{block: cycles} of every macro PHONG_<BLOCK>_LATENCY, in the order of the file.

    Raises BuildError.
    """
    return dict(_latencies(config))


@functools.cache
def _latencies(config: Config) -> tuple[tuple[str, int], ...]:
    header = design.RTL / "latency.vh"
    blocks = _MACRO.findall(header.read_text())
    constants = "".join(f"  localparam {b} = `PHONG_{b}_LATENCY;\n" for b in blocks)
    text = f'`include "{header.name}"\nmodule latencies;\n{constants}endmodule\n'
    tree = elaborate("latencies", config, text)
    statements = next(m for m in tree["modulesp"] if m["name"] == "latencies")["stmtsp"]
    values = {s["name"]: s["valuep"][0]["name"] for s in statements if s["type"] == "VAR"}
    return tuple((b.lower(), int(values[b].partition("h")[2], 16)) for b in blocks)
