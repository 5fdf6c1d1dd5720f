# SPDX-License-Identifier: MIT
"""Corner cases of quadratic normals: frames of extreme bends, for builds with `normal_order` 2.

Like `corner_cases`, which covers what is extreme in linear spans.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from phong75.model.arrays import ArrayLike, Spans
from phong75.model.config import DEFAULT
from phong75.model.frame import Frame
from phong75.model.spans import bent_beyond
from phong75.model.studies.corner_cases import EXPONENTS, CornerCase, _frame, _span
from phong75.model.twin import Pixels

C = replace(DEFAULT, name="quadratic_normals", normal_order=2)
ONE, FINE = C.normal.one, 1 << C.bend_fraction_bits
MATERIALS = 2 * len(EXPONENTS)


def _bent(
    start: ArrayLike, step: ArrayLike, bend: ArrayLike, length: ArrayLike, material: ArrayLike = 0
) -> Spans:
    """SPAN_DTYPE[n] of codes. start, step, bend: int[n, 3] or [3]. length, material: int[n]."""
    bend = np.asarray(bend, np.int64)
    count = len(np.broadcast_to(bend, np.broadcast_shapes(bend.shape, np.shape(start), (1, 3))))
    spans = _span(
        np.broadcast_to(start, (count, 3)), np.broadcast_to(step, (count, 3)), length, material
    )
    spans["bend"] = bend
    assert not bent_beyond(spans, C).any()
    return spans


def _arcs(length: int, rng: np.random.Generator) -> Spans:
    """Spans whose normals start and end as random unit vectors and bend by up to 1 between."""
    count, last = MATERIALS, max(length - 1, 1)
    ends = rng.normal(size=(2, count, 3))
    ends /= np.linalg.norm(ends, axis=-1, keepdims=True)
    bend = np.floor(8 * rng.uniform(-0.9, 0.9, (count, 3)) / last**2 * ONE * FINE)
    step = np.floor((ends[1] - ends[0]) / last * ONE - bend / FINE * (last - 1) / 2)
    return _bent(
        np.floor(ends[0] * ONE).astype(np.int64), step.astype(np.int64), bend.astype(np.int64),
        length, np.arange(count),
    )  # fmt: skip


def _dark_where(z_is_dark: bool) -> str:
    return "Cp d on every pixel" if z_is_dark else "lit from the third pixel on"


def _slivers_of_light(sign: int) -> CornerCase:
    """Zn that is less than one unit of the normal's last place from 0."""
    spans = _bent((ONE, 0, 0), 0, (0, 0, sign), 40, np.arange(MATERIALS))

    def check(frame: Frame, got: Pixels) -> list[str]:
        ambient = frame.materials.ambient[np.repeat(frame.spans["material"], 40)]
        white = C.white
        dark = (ambient * white + C.coefficient.one // 2) >> C.coefficient.fraction
        k = np.tile(np.arange(40), len(frame.spans))
        wrong = (got.rgb != dark).any(axis=1)
        # Materials 7 and on are a highlight alone, which the eye opposite the light sees.
        shiny = np.repeat(frame.spans["material"], 40) == len(EXPONENTS)
        lit = shiny & (k >= 2)
        if sign < 0:
            return [f"{int(wrong.sum())} dark pixels are not Cp d"] if wrong.any() else []
        faults = []
        if wrong[k < 2].any():
            faults.append("a pixel with Zn = 0 is not Cp d")
        if not wrong[lit].all():
            faults.append(f"{int((~wrong[lit]).sum())} pixels with Zn > 0 are dark")
        return faults

    return CornerCase(
        f"Zn {'above' if sign > 0 else 'below'} 0 by less than its last bit",
        "Zn = ±k (k − 1) 2⁻⁴³: the cut to s1.30 would be 0, or lit on the wrong side",
        _dark_where(sign < 0),
        _frame(spans, angle=np.radians(150)),
        check,
    )


def cases() -> list[CornerCase]:
    """All cases. Every call returns the same integers."""
    rng = np.random.default_rng(7)
    out = [
        CornerCase(
            f"arcs of {length}",
            f"normals that bend by up to 1, over spans of {length} pixel{'s' * (length > 1)}",
            "every pixel once, one pixel per cycle",
            _frame(_arcs(length, rng)),
            full_rate=True,
        )
        for length in (3, 100, C.max_size)
    ]
    top, bottom = C.bend.max, C.bend.min
    signs = np.stack(np.meshgrid(*[[0, 1]] * 3), axis=-1).reshape(-1, 3).astype(bool)
    anything = [
        _bent(np.where(signs, ONE, -ONE), np.where(signs, -ONE, ONE), np.where(signs, top, bottom),
              length, np.arange(8))
        for length in (1, 2)
    ]  # fmt: skip
    out.append(
        CornerCase(
            "bends in spans of 1 and 2",
            "bends of ±2 in spans too short for them",
            "the pixels of spans without a bend",
            _frame(np.concatenate(anything), two_sided=True),
            full_rate=True,
        )
    )
    low, high = C.normal.min, C.normal.max
    edge = _bent(
        np.where(signs, high, low), np.where(signs, low, high), np.where(signs, top, bottom), 3,
        np.arange(8),
    )  # fmt: skip
    out.append(
        CornerCase(
            "every word at its end",
            "start, step and bend of ±2 in spans of 3, from one end of the format to its middle",
            "no wrap-around; not flagged",
            _frame(edge, two_sided=True),
        )
    )
    rise = np.where(signs, 1, -1)
    apex = _bent(0, rise * (ONE * 3 // 4), -rise * (ONE // 2 * FINE), 4, np.arange(8))
    out.append(
        CornerCase(
            "there and back",
            "a component that rises to 1 and falls again within 4 pixels",
            "no flag at the top, where the step changes its sign",
            _frame(apex, two_sided=True),
        )
    )
    for bend in (1, -1):
        out.append(
            CornerCase(
                f"a bend of {bend} unit",
                "the smallest bend, over 4096 pixels: the normal moves by 2⁻²⁰",
                "within the bound",
                _frame(
                    _bent((ONE // 2, -ONE // 3, ONE), 0, bend, C.max_size, np.arange(MATERIALS))
                ),
            )
        )
    # (k - 64)^2 times a vector: the zero vector at pixel 64, and nowhere else.
    vector = rng.integers(-(1 << 15), 1 << 15, (MATERIALS, 3))
    through = _bent(4096 * vector, -127 * vector, 2 * FINE * vector, 129, np.arange(MATERIALS))
    out.append(
        CornerCase(
            "zero at the vertex",
            "parabolas whose vertex is exactly the zero vector",
            "Cp d there, flagged once per span; accurate one pixel beside it",
            _frame(through),
        )
    )
    return [*out, _slivers_of_light(1), _slivers_of_light(-1)]
