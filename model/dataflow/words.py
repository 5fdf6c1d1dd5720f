# SPDX-License-Identifier: MIT
"""Words that stand for any pixel: arrays of nodes that the twin's numpy calls accept.

The twin computes on int64 arrays whose last axis is the pixels. `Words` takes their place with one
pixel: an array of objects, each a node of a `Graph` or a whole number. numpy hands its functions to
`__array_ufunc__` and `__array_function__` below, which build nodes. A function of numpy that the
twin does not use raises TypeError.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from phong75.model.dataflow.graph import OPERATIONS, Graph, Memory, Node
from phong75.model.twin.primitives.rom import rom


def _graph(*operands: Any) -> Graph | None:
    return next((x.graph for x in operands if isinstance(x, Node)), None)


def _plain(value: Any) -> Any:
    """A number of numpy as one of Python, which has no limit."""
    return value.item() if isinstance(value, np.generic) else value


def _apply(operation: str) -> Callable:
    def apply(*operands: Any) -> Any:
        values = [_plain(x) for x in operands]
        graph = _graph(*values)
        if graph is None:
            return OPERATIONS[operation](*values)
        return graph.apply(operation, *values)

    return apply


def _invert(value: Any) -> Any:
    value = _plain(value)
    if isinstance(value, Node):
        if value.truth:
            return value.graph.apply("bitwise_xor", value, True)
        return value.graph.apply("subtract", -1, value)
    return (not value) if isinstance(value, bool) else ~value


def _frexp(value: Any) -> tuple[None, Any]:
    """Of `np.frexp` of a whole number the twin reads the exponent: the number of bits."""
    return None, _apply("bit_length")(value)


#: numpy's ufuncs that the twin calls, on single words.
_UFUNCS: dict[str, Callable] = {
    **{name: _apply(name) for name in OPERATIONS if name not in ("select", "bit_length")},
    "logical_and": _apply("bitwise_and"),
    "logical_or": _apply("bitwise_or"),
    "negative": lambda x: _apply("subtract")(0, x),
    "invert": _invert,
    "frexp": _frexp,
}


def _each(function: Callable, *operands: Any, results: int = 1) -> Any:
    """`function` on every element of the operands, broadcast."""
    arrays = [np.asarray(x, object) for x in operands]
    found = np.frompyfunc(function, len(arrays), results)(*arrays)
    parts = found if results > 1 else (found,)
    made = tuple(np.asarray(part, object).view(Words) for part in parts)
    return made if results > 1 else made[0]


class Words(np.ndarray):
    """An array of nodes and whole numbers; the last axis is one pixel."""

    def __array_ufunc__(
        self, ufunc: Any, method: str, *inputs: Any, out: Any = None, **options: Any
    ) -> Any:
        function = _UFUNCS.get(ufunc.__name__)
        if function is None:
            raise TypeError(f"{ufunc.__name__} of words")
        if method == "reduce":
            (array,), axis = inputs, options.get("axis", 0)
            rows = np.moveaxis(np.asarray(array, object), axis, 0)
            total = rows[0]
            for row in rows[1:]:
                total = _each(function, total, row)
            return np.asarray(total, object).view(Words)
        if method != "__call__" or options:
            raise TypeError(f"{ufunc.__name__}.{method} of words with {options}")
        made = _each(function, *inputs, results=ufunc.nout)
        if out is not None and isinstance(out[0], Words):
            np.ndarray.__setitem__(out[0], ..., np.asarray(made))
            return out[0]
        # `numbers += words` gives the name `numbers` to the result.
        return made

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return _function(func, args, kwargs)

    def astype(self, dtype: Any, *args: Any, **kwargs: Any) -> Any:
        """Flags become whole numbers; float64, which holds the twin's words exactly, changes
        nothing."""
        return _each(lambda x: x.graph.whole(x) if isinstance(x, Node) else int(_plain(x)), self)


def words(values: Any) -> Words:
    """An array of nodes and whole numbers as `Words`."""
    return np.asarray(values, object).view(Words)


class Places:
    """An array that a frame brings, of which the twin reads words by index: a `Memory`.

    shape: its length in each axis; offset, strides: where a word stands, in words.
    """

    def __init__(
        self, memory: Memory, shape: tuple[int, ...], offset: int = 0,
        strides: tuple[int, ...] | None = None,
    ):  # fmt: skip
        self.memory, self.shape, self.offset = memory, shape, offset
        full = [int(np.prod(shape[axis + 1 :])) for axis in range(len(shape))]
        self.strides = tuple(full) if strides is None else strides

    def __len__(self) -> int:
        return self.shape[0]

    @property
    def T(self) -> Places:  # noqa: N802 - numpy's name
        """The array with its axes in the opposite order."""
        return Places(self.memory, self.shape[::-1], self.offset, self.strides[::-1])

    def __iter__(self) -> Iterator[Places]:
        return (self[k] for k in range(len(self)))

    def __array__(self, *args: Any, **kwargs: Any) -> Any:
        raise TypeError(f"all words of {self.memory.name} at once")

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        return _function(func, args, kwargs)

    def __getitem__(self, index: Any) -> Any:
        index = index if isinstance(index, tuple) else (index,)
        shape, strides, offset = list(self.shape), list(self.strides), self.offset
        address: Any = None
        axis = 0
        for part in index:
            if isinstance(part, slice):
                begin, stop, jump = part.indices(shape[axis])
                offset += begin * strides[axis]
                shape[axis] = len(range(begin, stop, jump))
                strides[axis] *= jump
                axis += 1
                continue
            moved: Any = part * strides[axis]
            if isinstance(part, Words):
                address = moved if address is None else address + moved
            else:
                offset += moved
            del shape[axis], strides[axis]
        if address is None:
            return Places(self.memory, tuple(shape), offset, tuple(strides))
        return self._words(address + offset, shape, strides)

    def _words(self, address: Any, shape: list[int], strides: list[int]) -> Words:
        """The words from `address` on: one for each place of the axes that are left."""
        steps: Any = sum(
            np.arange(n).reshape([-1] + [1] * (len(shape) - 1 - axis)) * stride
            for axis, (n, stride) in enumerate(zip(shape, strides, strict=True))
        )
        places: Any = address.reshape(address.shape + (1,) * len(shape)) + steps
        return _load(self.memory, places)


def _load(memory: Memory, address: Words) -> Words:
    def load(x: Any) -> Any:
        if not isinstance(x, Node):
            raise TypeError(f"a fixed word of {memory.name}")
        return x.graph.load(memory, x)

    return _each(load, address)


@rom.register
def _(address: Words, table: Any) -> Words:
    return _load(Memory("constant table", tuple(np.asarray(table).tolist())), address)


def _take(array: Places, indices: Words) -> Words:
    if len(array.shape) == 1:
        return array[indices]
    whole = Places(array.memory, (int(np.prod(array.shape)),), array.offset)
    if array.strides != Places(array.memory, array.shape).strides:
        raise TypeError("np.take of a part of an array")
    return whole[indices]


def _select(condition: Any, yes: Any, no: Any) -> Any:
    condition, yes, no = _plain(condition), _plain(yes), _plain(no)
    graph = _graph(condition, yes, no)
    if graph is None or not isinstance(condition, Node):
        return yes if condition else no
    return graph.apply("select", condition, yes, no)


def _clip(array: Any, low: Any, high: Any) -> Any:
    return np.minimum(np.maximum(array, low), high)


def _rearranged(func: Callable) -> Callable:
    """A function of numpy that moves elements and computes nothing."""

    def call(*args: Any, **kwargs: Any) -> Words:
        def plain(x: Any) -> Any:
            if isinstance(x, Words):
                return np.asarray(x, object)
            if isinstance(x, list | tuple) and any(isinstance(y, Words | list) for y in x):
                return [plain(y) for y in x]
            return x

        return func(*(plain(x) for x in args), **kwargs).view(Words)

    return call


_FUNCTIONS: dict[Callable, Callable] = {
    np.take: _take,
    np.where: lambda condition, yes, no: _each(_select, condition, yes, no),
    np.clip: _clip,
    np.stack: _rearranged(np.stack),
    np.broadcast_to: _rearranged(np.broadcast_to),
    np.zeros_like: lambda array: words(np.zeros(array.shape, int)),
    np.full_like: lambda array, value: words(np.full(array.shape, value)),
}


def _function(func: Callable, args: tuple, kwargs: dict) -> Any:
    if func not in _FUNCTIONS:
        raise TypeError(f"{func.__name__} of words")
    return _FUNCTIONS[func](*args, **kwargs)
