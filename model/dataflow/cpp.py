# SPDX-License-Identifier: MIT
"""The graph of a configuration as a C++ function that shades all pixels of a frame."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from phong75.model.dataflow.graph import Memory, Node, live
from phong75.model.dataflow.trace import Program

#: Pixels that are shaded in one loop: the words between the two parts of a program fit the cache.
BLOCK = 512

_BINARY = {
    "add": "+", "subtract": "-", "multiply": "*", "left_shift": "<<", "right_shift": ">>",
    "bitwise_and": "&", "bitwise_or": "|", "bitwise_xor": "^", "equal": "==", "not_equal": "!=",
    "less": "<", "greater": ">", "greater_equal": ">=",
}  # fmt: skip

_EXPRESSIONS: dict[str, str] = {
    **{name: f"{{0}} {sign} {{1}}" for name, sign in _BINARY.items()},
    "minimum": "{0} < {1} ? {0} : {1}",
    "maximum": "{0} > {1} ? {0} : {1}",
    "absolute": "{0} < 0 ? -{0} : {0}",
    "select": "{0} ? {1} : {2}",
    "bit_length": "bit_length({0})",
}

_FUNCTION = """\
#include <algorithm>
#include <bit>
#include <cstdint>

using word = int64_t;

// The number of bits of x, 0 <= x < 2^53: the exponent of the double that equals x.
static inline word bit_length(word x) {{
    return x == 0 ? 0 : (std::bit_cast<word>(double(x)) >> 52) - 1022;
}}

{tables}
// The words between the two loops: pixels of a block, and what the interpolators give for each.
struct Block {{
    alignas(64) word of_span[{block}];
    alignas(64) word walked[{walked_words}][{block}];
}};

// The codes {{red, green, blue}} of `count` pixels.
static void shade_block(const word *const *memory, const word *scalar,
                        const Block &__restrict block, word count, word *__restrict codes) {{
{arguments}
    for (word i = 0; i < count; ++i) {{
        [[maybe_unused]] const word input_span = block.of_span[i];
{shade}
    }}
}}

// Shades the pixels of `spans` spans of length[span] >= 1 pixels. Writes the column and the codes
// {{red, green, blue}} of each pixel.
extern "C" void shade(const word *const *memory, const word *scalar, const word *length,
                      word spans, word *column, word *codes) {{
{arguments}
    Block block;
    word span = 0, k = 0;
    while (span < spans) {{
        word count = 0;
        while (span < spans && count < {block}) {{
            const word take = std::min(length[span] - k, word({block}) - count);
            const word input_span = span;
            for (word j = 0; j < take; ++j) {{
                const word i = count + j, input_k = k + j;
                block.of_span[i] = span;
{walk}
            }}
            count += take;
            k += take;
            if (k == length[span]) {{
                ++span;
                k = 0;
            }}
        }}
        shade_block(memory, scalar, block, count, codes);
        column += count;
        codes += 3 * count;
    }}
}}
"""


def _statements(
    results: Iterable[Node], address: Callable[[Memory], str], name: Callable[[Node], str]
) -> list[str]:
    """One statement for each operation that `results` need."""
    lines = []
    for node in live(list(results)):
        if node.operation in ("constant", "input"):
            continue
        operands = [name(operand) for operand in node.operands]
        if node.operation == "load":
            assert isinstance(node.what, Memory)
            value = f"{address(node.what)}[{operands[0]}]"
        else:
            value = _EXPRESSIONS[node.operation].format(*operands)
        lines.append(f"const word {name(node)} = {value};")
    return lines


def source(program: Program) -> str:
    """The C++ text of `program`."""
    tables: dict[tuple[int, ...], str] = {}
    between = {node: f"block.walked[{n}][i]" for n, node in enumerate(program.between)}

    def address(memory: Memory) -> str:
        if memory.content is None:
            return f"memory_{memory.name}"
        return tables.setdefault(memory.content, f"table{len(tables)}")

    def name(node: Node) -> str:
        if node.operation == "constant":
            return f"word({node.what})"
        if node.operation == "input":
            return between.get(node, f"input_{node.what}")
        return f"v{node.number}"

    walk = _statements((program.column, *program.walked), address, name)
    walk.append(f"column[i] = {name(program.column)};")
    walk += [
        f"{place} = {name(node)};"
        for place, node in zip(between.values(), program.walked, strict=True)
    ]
    shade = _statements(program.colours, address, name)
    shade += [f"codes[3 * i + {c}] = {name(node)};" for c, node in enumerate(program.colours)]
    given = [
        f"[[maybe_unused]] const word *__restrict memory_{name} = memory[{n}];"
        for n, name in enumerate(program.memories)
    ]
    given += [
        f"[[maybe_unused]] const word input_{name} = scalar[{n}];"
        for n, name in enumerate(program.scalars)
    ]
    return _FUNCTION.format(
        tables="\n".join(
            f"alignas(64) static const word {name}[] = {{{', '.join(map(str, content))}}};\n"
            for content, name in tables.items()
        ),
        arguments=_indented(given, 4), walk=_indented(walk, 16), shade=_indented(shade, 12),
        walked_words=len(program.walked), block=BLOCK,
    )  # fmt: skip


def _indented(lines: list[str], spaces: int) -> str:
    return "\n".join(" " * spaces + line for line in lines)
