# SPDX-License-Identifier: MIT
"""Every Verilog file begins with what a reader needs, and the latencies stated there are true."""

from __future__ import annotations

import re

import pytest

from phong75.model.config import DEFAULT
from phong75.model.studies.methods import CONFIGS
from phong75.sim import design
from phong75.sim.latency import latencies

MODULES = [*design.sources(), *sorted(design.ECP5.glob("*.v"))]

#: Modules whose latency is another macro's, and how many cycles more.
MACROS = {
    "phong_pipeline": ("pixel", 3), "phong_unit": ("pixel", 0), "pixel_fifo": ("pixel", 0),
    "flat_unit": ("intensity_code", 0), "gouraud_unit": ("intensity_code", 0),
    "slope_multiplier": ("narrow_multiplier", 0), "specular_factors": ("power", 0),
}  # fmt: skip


def header(path) -> str:
    """The comment at the start of a file, without the signs of a comment, in one line."""
    lines = re.match(r"(?://[^\n]*\n)+", path.read_text())[0].splitlines()
    return " ".join(line.removeprefix("//").strip() for line in lines)


@pytest.mark.parametrize("path", MODULES, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_a_module_says_what_it_is(path):
    text = header(path)
    assert text.startswith(f"SPDX-License-Identifier: MIT {path.stem}")
    assert "Reset: " in text
    if path.stem != "harness":
        assert "Latency: " in text and "Throughput: " in text
    if stated := re.search(r"(\d+) by default", text):
        macro, more = MACROS.get(path.stem, (path.stem, 0))
        assert int(stated[1]) == latencies(DEFAULT)[macro] + more
    elif stated := re.search(r"(\d+) in the configuration (\w+)", text):
        assert int(stated[1]) == latencies(CONFIGS[stated[2]])["pixel"]
    else:
        assert "_LATENCY" not in text or path.stem == "normal_hold"
