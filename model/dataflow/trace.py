# SPDX-License-Identifier: MIT
"""From the twin to its graph: what a pixel takes along its span, and its colours from that."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from phong75.model.arrays import Ints
from phong75.model.config import MAX_JUMPS, Config
from phong75.model.dataflow.graph import Graph, Memory, Node, live
from phong75.model.dataflow.words import Places, Words, words
from phong75.model.frame import Frame, FurtherLight, InputError, MaterialTable
from phong75.model.reflectance import power_words
from phong75.model.twin.core import phong_unit, span_walker
from phong75.model.twin.lights import lights_unit
from phong75.model.twin.phong_pipeline import colours


@dataclass(frozen=True)
class Program:
    """The graph of a configuration, in two parts with words between them.

    column: where pixel `k` of span `span` is, and walked: what the interpolators give there, both
    from the inputs `span` and `k`. colours: red, green, blue, from the inputs `between`, which
    stand for `walked`, and `span`. memories, scalars: names of the arrays and of the other inputs
    that a frame brings (see `arguments`).
    """

    column: Node
    walked: tuple[Node, ...]
    between: tuple[Node, ...]
    colours: tuple[Node, ...]
    memories: tuple[str, ...]
    scalars: tuple[str, ...]


class _Rows(list):
    """`Places` for each light: an array whose other axes have a length that the frame decides."""

    def __getitem__(self, index: Any) -> Any:
        if isinstance(index, tuple):
            return list.__getitem__(self, index[0])[index[1:]]
        return list.__getitem__(self, index)


def _frame(config: Config, lights: int, graph: Graph) -> Frame:
    """A frame whose words are those of `arguments`."""
    rows, points = config.materials, config.weight_points

    def places(name: str, *shape: int) -> Any:
        return Places(Memory(name), shape)

    def half_vector(light: int) -> Any:
        return graph.input(f"half_x{light}"), graph.input(f"half_z{light}")

    def by_span(name: str, *shape: int) -> Any:
        return _Rows(places(f"{name}{light}", 0, *shape) for light in range(lights))

    table = MaterialTable(
        places("ambient", rows, 3), places("diffuse0", rows, 3), places("weight", rows, points),
        places("exponent", rows), places("highlight0", rows, 3),
        places("curve", rows, 1 << config.segment_bits, 2),
        places("curve_jumps", rows, MAX_JUMPS, 3), places("weight_jumps", rows, MAX_JUMPS, 3),
    )  # fmt: skip
    spans: Any = {name: places(name, 0, 3) for name in ("bend", "start", "step")}
    spans |= {name: places(name, 0) for name in ("material", "x")}
    further = [
        FurtherLight(
            half_vector(light), places(f"start{light}", 0, 3), places(f"step{light}", 0, 3),
            places(f"diffuse{light}", rows, 3), places(f"highlight{light}", rows, 3),
        )
        for light in range(1, lights)
    ]  # fmt: skip
    two_sided: Any = graph.input("two_sided", truth=True)
    half_vectors = by_span("half_vectors", 2) if config.span_half_vector else None
    depths = by_span("depths", 2) if config.attenuation else None
    falloff = places("falloff", lights, points) if config.attenuation else None
    return Frame(
        0, 0, half_vector(0), two_sided, (0, 0, 0), table, spans, further, half_vectors, depths,
        falloff,
    )  # fmt: skip


def trace(config: Config, lights: int = 1) -> Program:
    """The graph of `config`, for frames of `lights` lights.

    Raises InputError for quadratic_spans, whose words are computed from all spans at once.
    """
    if config.spans_carry_squares:
        raise InputError(f"{config.name}: spans that carry squares are not compiled")
    # A held normal changes no colour (see `twin.pruning.normal_hold`), but needs other pixels.
    config = dataclasses.replace(config, hold_unlit=False) if config.hold_unlit else config
    graph = Graph()
    frame = _frame(config, lights, graph)
    span: Any = words([graph.input("span")])
    k: Any = words([graph.input("k")])
    walked: list[Any]
    results: Any
    if config.technique != "phong":
        walked = [colours(frame, span, k, config)]
        between = _given(graph, walked)
        (results,) = between
    else:
        walked = _walked(frame, span, k, config)
        between = _given(graph, walked)
        results = _shaded(frame, span, between, config)
    column = span_walker.column(frame.spans["x"][span], k, config)
    own = {*_nodes(span), *_nodes(k), *_nodes(*between)}
    given = [
        node for node in live([*_nodes(column), *_nodes(*walked), *_nodes(results)])
        if node not in own
    ]  # fmt: skip
    memories = {
        node.what.name for node in given
        if isinstance(node.what, Memory) and node.what.content is None
    }  # fmt: skip
    scalars = {str(node.what) for node in given if node.operation == "input"}
    return Program(
        _nodes(column)[0], _nodes(*walked), _nodes(*between), _nodes(results),
        tuple(sorted(memories)), tuple(sorted(scalars)),
    )  # fmt: skip


def _nodes(*arrays: Any) -> tuple[Node, ...]:
    return tuple(node for array in arrays for node in np.asarray(array, object).ravel())


def _given(graph: Graph, arrays: list[Any]) -> list[Any]:
    """Arrays of inputs in place of `arrays`."""
    number = itertools.count()

    def given(node: Node) -> Node:
        return graph.input(f"walked{next(number)}")

    return [np.frompyfunc(given, 1, 1)(np.asarray(a, object)).view(Words) for a in arrays]


def _walked(frame: Frame, span: Ints, k: Ints, config: Config) -> list[Any]:
    """What `_shaded` needs of the interpolators: normals, material and, if lights fall with the
    distance, the distances."""
    if config.sums_lights:
        normals = lights_unit.interpolate(frame, span, k, config)
    else:
        normals, _ = phong_unit.interpolate(frame.spans, span, k, config)
    found = [normals, frame.spans["material"][span]]
    if config.attenuation:
        found.append(lights_unit.depth_interpolators(frame, span, k, config))
    return found


def _shaded(frame: Frame, span: Ints, walked: list[Any], config: Config) -> Ints:
    """The colours from what `_walked` gives."""
    normals, material, *depths = walked
    if not config.sums_lights:
        return phong_unit.shade(normals, material, frame, config)
    distances = depths[0] if depths else None
    return lights_unit.shade(normals, material, frame, config, span=span, depths=distances)


def arguments(frame: Frame, config: Config) -> dict[str, Ints | int]:
    """{name: its words or its value} of what `frame` brings to a `Program` of `config`."""
    table, spans = frame.materials, frame.spans
    found: dict[str, Any] = {
        "ambient": table.ambient, "weight": table.weight, "exponent": table.exponent,
        "bend": spans["bend"], "material": spans["material"], "two_sided": int(frame.two_sided),
        "start": spans["start"], "step": spans["step"], "x": spans["x"],
    }  # fmt: skip
    if frame.falloff is not None:
        found["falloff"] = frame.falloff
    if config.has_curves:
        curve = power_words(table.exponent, config) if table.curve is None else table.curve
        found["curve"] = curve
    for name in ("curve_jumps", "weight_jumps"):
        jumps = getattr(table, name)
        # A jump that changes nothing in place of one that is not there.
        nothing = np.zeros((config.materials, MAX_JUMPS, 3), np.int64)
        found[name] = nothing if jumps is None else jumps
    for number in range(frame.lights):
        light = frame.light(number, config)
        found[f"half_x{number}"], found[f"half_z{number}"] = light.half_vector
        for field in ("start", "step", "diffuse", "highlight"):
            found[f"{field}{number}"] = getattr(light, field)
        if frame.half_vectors is not None:
            found[f"half_vectors{number}"] = frame.half_vectors[number]
        if frame.depths is not None:
            found[f"depths{number}"] = frame.depths[number]
    return found
