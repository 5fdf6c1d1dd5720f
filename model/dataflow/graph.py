# SPDX-License-Identifier: MIT
"""Nodes of the twin's graph: one operation on integers of 64 bits each, equal nodes once.

The operations are those of numpy on int64, which wrap, so that a graph gives what the twin gives
for every input.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Memory:
    """An array that a load reads: a constant table, or what a frame brings.

    content: the words of a constant table, None for an array of the frame.
    """

    name: str
    content: tuple[int, ...] | None = None


@dataclass(frozen=True, eq=False)
class Node:
    """One operation of a `Graph`.

    operation: a key of OPERATIONS, "constant", "input" or "load". operands: nodes, with smaller
    numbers. truth: whether the value is a flag, 0 or 1, for which `~` is "not". what: value of a
    constant, name of an input, `Memory` of a load.
    """

    graph: Graph = field(repr=False)
    number: int
    operation: str
    operands: tuple[Node, ...] = field(repr=False)
    truth: bool = False
    what: int | str | Memory = 0


#: {operation: its value for whole numbers}. The first ones have the names of numpy's ufuncs.
OPERATIONS: dict[str, Callable] = {
    "add": operator.add,
    "subtract": operator.sub,
    "multiply": operator.mul,
    "left_shift": operator.lshift,
    "right_shift": operator.rshift,
    "bitwise_and": operator.and_,
    "bitwise_or": operator.or_,
    "bitwise_xor": operator.xor,
    "minimum": min,
    "maximum": max,
    "absolute": abs,
    "equal": operator.eq,
    "not_equal": operator.ne,
    "less": operator.lt,
    "greater": operator.gt,
    "greater_equal": operator.ge,
    "select": lambda condition, yes, no: yes if condition else no,
    "bit_length": int.bit_length,
}

#: Operations whose result is a flag, and those whose result is one if all operands are.
FLAGS = ("equal", "not_equal", "less", "greater", "greater_equal")
_LOGICAL = ("bitwise_and", "bitwise_or", "bitwise_xor")


class Graph:
    """Operations in data order; the same operation on the same operands is one node."""

    def __init__(self) -> None:
        self.nodes: list[Node] = []
        self._known: dict[tuple, Node] = {}

    def _node(
        self, operation: str, operands: tuple[Node, ...], truth: bool, what: int | str | Memory = 0
    ) -> Node:
        key = (operation, *(node.number for node in operands), truth, what)
        if key not in self._known:
            node = Node(self, len(self.nodes), operation, operands, truth, what)
            self.nodes.append(node)
            self._known[key] = node
        return self._known[key]

    def constant(self, value: int | bool) -> Node:
        """A whole number or a flag."""
        return self._node("constant", (), isinstance(value, bool | np.bool_), int(value))

    def input(self, name: str, truth: bool = False) -> Node:
        """A word that is given for each pixel, or once."""
        return self._node("input", (), truth, name)

    def load(self, memory: Memory, address: Node) -> Node:
        """The word at `address` of `memory`."""
        return self._node("load", (address,), False, memory)

    def apply(self, operation: str, *operands: Node | int | bool) -> Node:
        """The result of one of OPERATIONS; of constants it is a constant."""
        nodes = tuple(x if isinstance(x, Node) else self.constant(x) for x in operands)
        flags = nodes[1:] if operation == "select" else nodes
        truth = operation in FLAGS or (
            operation in (*_LOGICAL, "select") and all(node.truth for node in flags)
        )
        if all(node.operation == "constant" for node in nodes):
            result = OPERATIONS[operation](*(node.what for node in nodes))
            return self.constant(bool(result) if truth else int(result))
        return self._node(operation, nodes, truth)

    def whole(self, node: Node) -> Node:
        """`node` as a whole number: a flag is 0 or 1."""
        if not node.truth:
            return node
        if node.operation == "constant":
            return self.constant(int(str(node.what)))
        return self._node("select", (node, self.constant(1), self.constant(0)), False)


def live(results: list[Node]) -> list[Node]:
    """The nodes that `results` need, in data order."""
    seen: dict[int, Node] = {}
    stack = list(results)
    while stack:
        node = stack.pop()
        if node.number not in seen:
            seen[node.number] = node
            stack.extend(node.operands)
    return [seen[number] for number in sorted(seen)]
