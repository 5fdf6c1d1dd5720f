# SPDX-License-Identifier: MIT
"""The RTL of one configuration as plain text: no macro, no include, a prefix on module names.

The expansion is textual, as a preprocessor's, but comments stay: what the header of the
configuration defines becomes the number or the table that it stands for, and a latency becomes the
number of cycles that Verilator elaborates for it.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Container
from pathlib import Path

from phong75.model.config import DEFAULT, Config, Format
from phong75.model.tables import tables
from phong75.model.verilog import header
from phong75.sim import design
from phong75.sim.latency import latencies

SPDX = "// SPDX-License-Identifier: MIT"

_COMMENT = re.compile(r"(//[^\n]*|/\*.*?\*/)", re.DOTALL)
_MACRO = re.compile(r"`(PHONG_\w+)")
_DEFINE = re.compile(r"^`define (PHONG_\w+) +([^\s/]+)", re.MULTILINE)
_FORMAT = re.compile(r"\b[su]\d+\.\d+\b")
_RANGE = re.compile(r"\[([0-9+*() -]*[+*(-][0-9+*() -]*):0\]")
_PORT = re.compile(
    r"^ +(?P<direction>input|output) +(?P<kind>wire|reg) *(?P<range>\[[^\]]*\])? *"
    r"(?P<name>\w+,?) *(?P<comment>//.*)?$"
)
#: Comments that send the reader to what an export does not have, and what they say there. A gap may
#: be the end of a comment's line.
_GAP = r"(?:\s+//)?\s+"
_ELSEWHERE = (
    (rf"(PHONG_\w+){_GAP}in{_GAP}latency\.vh;{_GAP}\d+{_GAP}by{_GAP}default", r"\1"),
    (rf"see{_GAP}latency\.vh;{_GAP}(\d+)", r"\1"),
)
_WORDS_A_LINE = 6


def macros(config: Config) -> dict[str, str]:
    """{macro: text} of all that the configuration header and rtl/latency.vh define.

    A table becomes a concatenation of its words, some on each line. A choice (see
    `model.config.choice`) keeps its name in a comment. Raises BuildError.
    """
    values = dict(_DEFINE.findall(header(config)))
    for field in dataclasses.fields(config):
        macro = f"PHONG_{field.name.upper()}"
        for k, name in enumerate(field.metadata.get("names", ())):
            values[f"{macro}_{name.upper()}"] = f"{k} /* {name} */"
        if "names" in field.metadata:
            values[macro] = f"{values[macro]} /* {getattr(config, field.name)} */"
    for block, cycles in latencies(config).items():
        values[f"PHONG_{block.upper()}_LATENCY"] = str(cycles)
    for table in tables(config):
        values[f"PHONG_{table.name.upper()}_TABLE"] = _concatenation(table)
    return values


def _concatenation(table) -> str:
    """The words of `table`, the last one first: that one is at the top of the constant."""
    digits = -(-table.word_bits // 4)
    words = [f"{table.word_bits}'h{word:0{digits}x}" for word in reversed(table.words.tolist())]
    lines = [", ".join(words[k : k + _WORDS_A_LINE]) for k in range(0, len(words), _WORDS_A_LINE)]
    first = f"// {len(words)} words of {table.word_bits} bits, the last one first"
    return "{  " + first + "\n" + ",\n".join(lines) + "\n}"


def _widths(config: Config) -> list:
    """Everything that decides the width of a signal."""
    return [
        getattr(config, field.name)
        for field in dataclasses.fields(config)
        if isinstance(getattr(config, field.name), Format)
        or (field.name.endswith("_bits") and not field.name.startswith("idle"))
    ]


def _formats(comment: str, code: str, config: Config) -> str:
    """`comment` with the Q-formats of `config` in place of the default configuration's.

    code: what stands before it on its line; a macro there says which word the comment describes.
    Where it does not, and the words of that format in the default configuration have different
    ones in `config`, the comment says that its format is the default's.
    """
    if _widths(config) == _widths(DEFAULT):
        return comment
    fields = {
        f.name: str(value)
        for f in dataclasses.fields(config)
        if isinstance(value := getattr(DEFAULT, f.name), Format)
    }
    named = {field for field in fields if re.search(rf"`PHONG_{field.upper()}_BITS\b", code)}

    def replaced(match: re.Match) -> str:
        alike = {field for field, text in fields.items() if text == match[0]}
        chosen = {str(getattr(config, field)) for field in (alike & named) or alike}
        return chosen.pop() if len(chosen) == 1 else f"{match[0]} (default)"

    return _FORMAT.sub(replaced, comment)


def expand(text: str, config: Config, values: dict[str, str]) -> str:
    """`text`, Verilog, with the macros `values` in place; comments stay.

    Raises ValueError if a macro or another directive than `default_nettype` is left.
    """
    text = re.sub(r'^`include "[^"]*"\n', "", text, flags=re.MULTILINE)
    for pattern, replacement in _ELSEWHERE:
        text = re.sub(pattern, replacement, text)
    parts = _COMMENT.split(text)  # code, comment, code, ...
    for k in range(1, len(parts), 2):
        line = parts[k - 1].rpartition("\n")[2]
        parts[k] = _formats(parts[k], line, config)
        parts[k] = re.sub(
            r"`?\b(PHONG_\w+)\b",
            lambda m: m[0] if "\n" in values.get(m[1], "\n") else values[m[1]].split()[0],
            parts[k],
        )
    for k in range(0, len(parts), 2):
        parts[k] = _RANGE.sub(_folded, _substitute(parts[k], values))
        left = re.search(r"`(?!default_nettype\b)\w+", parts[k])
        if left:
            raise ValueError(f"no value for the macro {left[0]}")
    return align("".join(parts))


def _folded(match: re.Match) -> str:
    """`[N-1:0]` with the number that N-1 is; the pattern lets only sums and products pass."""
    return f"[{eval(match[1], {'__builtins__': {}})}:0]"


def align(text: str) -> str:
    """`text` with the ports that stand together in columns."""
    out: list[str] = []
    ports: list[re.Match] = []

    def flush() -> None:
        if not ports:
            return
        kind = max(len(f"{p['direction']} {p['kind']}") for p in ports)
        ranges = max(len(p["range"] or "") for p in ports)
        names = max(len(p["name"]) for p in ports)
        for p in ports:
            direction = p["direction"].ljust(kind - len(p["kind"])) + p["kind"]
            words = [direction, *([(p["range"] or "").ljust(ranges)] if ranges else [])]
            line = f"    {' '.join(words)} {p['name'].ljust(names)}  {p['comment'] or ''}"
            out.append(line.rstrip())
        ports.clear()

    for line in text.split("\n"):
        if match := _PORT.match(line):
            ports.append(match)
        else:
            flush()
            out.append(line)
    flush()
    return "\n".join(out)


def _substitute(code: str, values: dict[str, str]) -> str:
    out = []
    for line in code.split("\n"):
        indent = " " * (len(line) - len(line.lstrip()))

        def value(match: re.Match, indent: str = indent) -> str:
            text = values.get(match[1], match[0])
            first, *middle = text.split("\n")
            lines = [first, *(f"{indent}    {m}" for m in middle[:-1])]
            return "\n".join(lines + [indent + m for m in middle[-1:]])

        out.append(_MACRO.sub(value, line))
    return "\n".join(out)


def rename(text: str, modules: set[str], prefix: str) -> str:
    """`text` with `prefix` on the names of `modules`, where they are declared or instantiated."""
    names = "|".join(sorted(modules, key=len, reverse=True))
    declared = re.compile(rf"\b(module\s+)({names})\b")
    # An instance's name or its parameters follow; neither can follow a signal's name.
    instance = re.compile(rf"(?<![\w.$])({names})(?=\s+(?:#|[A-Za-z_]))")
    parts = _COMMENT.split(text)
    for k in range(0, len(parts), 2):
        parts[k] = instance.sub(rf"{prefix}\1", declared.sub(rf"\1{prefix}\2", parts[k]))
    text = "".join(parts)
    return re.sub(rf"^// ({names}):", rf"// {prefix}\1:", text, count=1, flags=re.MULTILINE)


def used(present: Container[str], technology: Path | None = None) -> list[Path]:
    """The files of the modules `present`, in the order of the file list.

    technology: as for `design.sources`; what its modules are made of is among the files.
    """
    sources = design.sources(technology=technology)
    files = [file for file in sources if file.stem in present]
    text = "".join(file.read_text() for file in files if file.parent == technology)
    parts = [
        file
        for file in sources
        if file.parent == technology
        and file not in files
        and re.search(rf"^\s*{file.stem}\s+(#|\w)", text, re.MULTILINE)
    ]
    return files + parts


def export_module(
    file: Path, config: Config, values: dict[str, str], modules: set[str], prefix: str, origin: str
) -> str:
    """The text of one exported module; `origin` is one line that says where it is from."""
    text = rename(expand(file.read_text(), config, values), modules, prefix)
    text = text.removeprefix(SPDX + "\n")
    return f"{SPDX}\n// {origin}\n{text}"
