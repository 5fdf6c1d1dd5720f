"""The latencies that rtl/latency.vh states for a configuration, as numbers."""

from __future__ import annotations

import re

from model.config import DEFAULT, Config
from model.verilog import header
from sim.build import RTL

_TOKEN = re.compile(r"\s*(?:`(\w+)|(\d+)|(<=|>=|==|!=|&&|\|\||[-+*/%()?:<>&|!]))")
#: Binary operators, those that bind least first.
_LEVELS = (
    ("||",), ("&&",), ("|",), ("&",), ("==", "!="), ("<", "<=", ">", ">="), ("+", "-"),
    ("*", "/", "%"),
)  # fmt: skip
_OPERATIONS = {
    "||": lambda a, b: int(a or b), "|": lambda a, b: a | b,
    "&&": lambda a, b: int(a and b), "&": lambda a, b: a & b,
    "==": lambda a, b: int(a == b), "!=": lambda a, b: int(a != b),
    "<": lambda a, b: int(a < b), "<=": lambda a, b: int(a <= b),
    ">": lambda a, b: int(a > b), ">=": lambda a, b: int(a >= b),
    "+": lambda a, b: a + b, "-": lambda a, b: a - b, "*": lambda a, b: a * b,
    "/": lambda a, b: a // b, "%": lambda a, b: a % b,
}  # fmt: skip


def latencies(config: Config = DEFAULT) -> dict[str, int]:
    """{block: clocks} of every macro PHONG_<BLOCK>_LATENCY, in the order of the file."""
    macros = _macros(header(config) + (RTL / "latency.vh").read_text())
    return {
        name.removeprefix("PHONG_").removesuffix("_LATENCY").lower(): _value(text, macros)
        for name, text in macros.items()
        if name.endswith("_LATENCY")
    }


def _macros(text: str) -> dict[str, str]:
    text = re.sub(r"/\*.*?\*/|//[^\n]*", "", text, flags=re.DOTALL)
    text = re.sub(r"\\[ \t]*\n", " ", text)
    return dict(re.findall(r"`define (PHONG_\w+)[ \t]+(.+)", text))


def _value(text: str, macros: dict[str, str]) -> int:
    """The value of a constant expression of Verilog: whole numbers, macros, and operators."""
    tokens, place = [], 0
    while text[place:].strip():
        found = _TOKEN.match(text, place)
        if not found:
            raise ValueError(f"latency.vh: cannot read `{text[place:].strip()}`")
        macro, number, sign = found.groups()
        tokens.append(sign or (_value(macros[macro], macros) if macro else int(number)))
        place = found.end()
    value = _choice(tokens)
    if tokens:
        raise ValueError(f"latency.vh: `{tokens[0]}` is left over in `{text}`")
    return value


def _choice(tokens: list) -> int:
    condition = _binary(tokens, 0)
    if not (tokens and tokens[0] == "?"):
        return condition
    tokens.pop(0)
    yes = _choice(tokens)
    _expect(tokens, ":")
    no = _choice(tokens)
    return yes if condition else no


def _binary(tokens: list, level: int) -> int:
    if level == len(_LEVELS):
        return _unary(tokens)
    value = _binary(tokens, level + 1)
    while tokens and tokens[0] in _LEVELS[level]:
        operation = _OPERATIONS[tokens.pop(0)]
        value = operation(value, _binary(tokens, level + 1))
    return value


def _unary(tokens: list) -> int:
    token = tokens.pop(0)
    if token == "-":
        return -_unary(tokens)
    if token == "!":
        return int(not _unary(tokens))
    if token == "(":
        value = _choice(tokens)
        _expect(tokens, ")")
        return value
    if isinstance(token, int):
        return token
    raise ValueError(f"latency.vh: `{token}` where a number should be")


def _expect(tokens: list, sign: str) -> None:
    if not tokens or tokens.pop(0) != sign:
        raise ValueError(f"latency.vh: `{sign}` is missing")
