# SPDX-License-Identifier: MIT
"""Vectors for the modules of rtl/lights/: what each is given and must give, for one light."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from phong75.model.arrays import Ints, Trace
from phong75.model.config import Config
from phong75.model.frame import Frame
from phong75.model.twin.lights import lights_unit
from phong75.model.twin.lights.light_terms import fraction_bits


@dataclass(frozen=True)
class Vectors:
    """What `module` is given for one light, and what its stages must give.

    inputs: int64[n] for each input of the bench. expected: {stage: int64[n] of each signal}. held:
    values of ports that are held. codes: {port of a table's write enable: int64[3, M] or
    int64[M], what the table holds for each material}.
    """

    module: str
    inputs: list[Ints]
    expected: Trace
    held: dict[str, int] = field(default_factory=dict)
    codes: dict[str, Ints] = field(default_factory=dict)


def packed(mantissas: tuple[Ints, ...], config: Config) -> Ints:
    """The words {z, y, x} of mantissas x, y, z, int64[n] each."""
    bits = config.mantissa.bits
    x, y, z = (part & ((1 << bits) - 1) for part in mantissas)
    return z << 2 * bits | y << bits | x


def factor_words(points: Ints, config: Config) -> Ints:
    """The words {step, left} of the intervals between `points` (int64[P] in `coefficient`)."""
    steps = np.diff(points) & ((2 << config.coefficient.bits) - 1)
    return steps << config.coefficient.bits | points[:-1]


def vectors(
    normals: Ints, material: Ints, frame: Frame, config: Config, light: int,
    span: Ints | None = None, depths: Ints | None = None,
) -> Iterator[Vectors]:  # fmt: skip
    """Yield the vectors of the modules that shade the light number `light`, in data order.

    Arguments as of `lights_unit.shade`. With `span` there must be one pixel, since the half vector
    is held.
    """
    traces: list[Trace] = [{} for _ in normals]
    lights_unit.shade(normals, material, frame, config, traces, span, depths)
    first, trace = traces[0], traces[light]

    def stages(*modules: str) -> Trace:
        return {k: v for k, v in trace.items() if k.partition(".")[0] in modules}

    ones = np.ones_like(material)
    shift, zero = first["light_align.leading_zeros"]
    yield Vectors(
        "light_align", [*normals[light], shift, zero], stages("light_align"),
        {"two_sided": int(frame.two_sided), "valid": 1},
    )  # fmt: skip
    if light == 0:
        mantissas = packed(first["light_align.align"], config)
        yield Vectors("held_root", [ones, mantissas], stages("held_root"))
    mantissas, less = packed(trace["light_align.align"], config), trace["light_align.shift"][1]
    root = first["held_root.hold"]
    yield Vectors("light_scale", [mantissas, less, *root], stages("light_scale"))
    *unit, cosine = trace["light_scale.round"]
    seen, table = frame.light(light, config), frame.materials
    given = seen.half_vector if span is None else frame.half_vector_of(light, span[:1], config)
    half = (int(np.ravel(c)[0]) & ((1 << config.half_vector.bits) - 1) for c in given)
    highlight = trace["light_highlight.round"][0]
    yield Vectors(
        "light_highlight", [*unit, cosine, material, table.exponent[material]],
        stages("reflection", "specular_power_tables", "specular_weight", "light_highlight"),
        dict(zip(("half_x", "half_z"), half, strict=True)),
    )  # fmt: skip
    if depths is not None:
        assert frame.falloff is not None
        inputs = [depths[light], 0 * material, cosine, highlight]
        yield Vectors(
            "light_attenuation", inputs, stages("light_attenuation"),
            codes={"write_enable": factor_words(frame.falloff[light], config)},
        )  # fmt: skip
        cosine, highlight = trace["light_attenuation.scale"]
    if config.rounds_highlight and not config.highlight_colour:
        highlight = highlight << (fraction_bits(config) - config.highlight.fraction)
    lit = trace["light_align.lit"][0]
    yield Vectors(
        "light_terms", [material, cosine, lit, highlight], stages("light_terms"),
        codes={"write_diffuse": seen.diffuse.T, "write_highlight": seen.highlight.T},
    )  # fmt: skip


async def write_codes(tb, codes: dict[str, Ints]) -> None:
    """Write the tables of `Vectors.codes`; tb: the `UnitTB` of the module."""
    for enable, table in codes.items():
        for channel, column in enumerate(np.atleast_2d(table)):
            for material, code in enumerate(column.tolist()):
                await tb.hold(
                    write_address=material, write_word=code, **{enable: 1 << channel}
                )  # fmt: skip
        await tb.hold(**{enable: 0})
