"""The latencies that rtl/latency.vh states, as numbers."""

from __future__ import annotations

import re

from sim.build import RTL


def latencies() -> dict[str, int]:
    """{block: clocks} of every macro PHONG_<BLOCK>_LATENCY, in the order of the file."""
    text = (RTL / "latency.vh").read_text()
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL).replace("\\\n", " ")
    found: dict[str, int] = {}
    for name, terms in re.findall(r"`define PHONG_(\w+)_LATENCY\s+(.+)", text):
        numbers = re.sub(r"`PHONG_(\w+)_LATENCY", lambda m: str(found[m[1].lower()]), terms)
        found[name.lower()] = sum(int(term) for term in re.findall(r"\d+", numbers))
    return found
