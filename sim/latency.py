"""The latencies that rtl/latency.vh states, as numbers."""

from __future__ import annotations

import re

from model.config import DEFAULT, Config
from model.verilog import header
from sim.build import RTL


def latencies(config: Config = DEFAULT) -> dict[str, int]:
    """{block: clocks} of every macro PHONG_<BLOCK>_LATENCY, in the order of the file."""
    numbers = dict(re.findall(r"`define (PHONG_\w+) (\d+)\b(?!')", header(config)))
    text = (RTL / "latency.vh").read_text()
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL).replace("\\\n", " ")
    found: dict[str, int] = {}
    for name, value in re.findall(r"`define PHONG_(\w+)_LATENCY\s+(.+)", text):
        found[name.lower()] = _value(re.sub(r"`(\w+)", lambda m: str(numbers[m[1]]), value))
        numbers[f"PHONG_{name}_LATENCY"] = str(found[name.lower()])
    return found


def _value(expression: str) -> int:
    """A Verilog expression of numbers: sums, comparisons, and choices in brackets of their own."""
    while match := re.search(r"\(([^()]*)\)", expression):
        chosen = re.fullmatch(r"(.*)\?(.*):(.*)", match[1])
        inner = (chosen[2] if _value(chosen[1]) else chosen[3]) if chosen else match[1]
        expression = f"{expression[: match.start()]}{_value(inner)}{expression[match.end() :]}"
    assert re.fullmatch(r"[\d\s+*=!<>-]+", expression), expression
    return int(eval(expression))
