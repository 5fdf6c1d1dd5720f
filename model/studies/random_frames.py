# SPDX-License-Identifier: MIT
"""Random frames of legal spans: stimuli for tests of the whole pipeline and for long runs."""

from __future__ import annotations

import numpy as np

from phong75.model.arrays import Ints
from phong75.model.config import DEFAULT as C
from phong75.model.config import Config
from phong75.model.frame import SPAN_DTYPE, Frame, FurtherLight, MaterialTable


def random_frame(
    seed: int | list[int], spans: int, longest: int, two_sided: bool = False, config: Config = C
) -> Frame:
    """A frame of `spans` legal spans of 1 to `longest` pixels each, of random materials.

    The normals have all directions and lengths; about half of the spans are lit throughout. For
    Gouraud and flat shading (`config.technique`) `start` and `step` are read as intensities, some
    outside [0, 1]. The frame is in the formats of the default configuration. The same `seed` gives
    the same frame.
    """
    rng = np.random.default_rng(seed)
    table = MaterialTable.empty(C)
    for m in range(C.materials):
        table.set(m, rng.random(3), rng.random(), rng.random(C.weight_points),
                  float(rng.choice([1, 1.5, 10, 128])), C)  # fmt: skip
    s = np.zeros(spans, SPAN_DTYPE)
    s["length"] = rng.integers(1, longest + 1, spans)
    s["x"] = rng.integers(0, C.max_size - longest, spans)
    s["y"] = rng.integers(0, C.max_size, spans)
    s["material"] = rng.integers(0, C.materials, spans)
    ends = rng.integers(C.normal.min, C.normal.max + 1, (2, spans, 3))
    lit = rng.random(spans) < 0.5
    ends[..., 2] = np.where(lit, np.abs(ends[..., 2]) & C.normal.max, ends[..., 2])
    ends >>= rng.integers(0, C.normal.bits, spans)[:, None]
    s["start"] = ends[0]
    s["step"] = (ends[1] - ends[0]) // np.maximum(s["length"] - 1, 4)[:, None]
    if config.technique == "flat":
        s["step"] = 0
    s["last"][-1] = True
    angle = rng.random() * 1.5
    hx, hz = C.half_vector.quantize([np.sin(angle), np.cos(angle)])
    return Frame(C.max_size, C.max_size, (int(hx), int(hz)), two_sided, (0, 0, 0), table, s)


def placed(frame: Frame, seed: int | list[int], half_vectors: bool, falls: bool) -> Frame:
    """`frame` with random half vectors of each light in each span, and with random distances and
    factors of them, in place.

    Some distances leave the table's range of 0 to 1, which clamps them.
    """
    rng, spans = np.random.default_rng(seed), frame.spans
    lights, count = frame.lights, len(spans)
    if half_vectors:
        angle = rng.uniform(0, np.pi / 2, (lights, count))
        h = C.half_vector.quantize(np.stack([np.sin(angle), np.cos(angle)], axis=-1))
        frame.half_vectors = h
    if falls:
        fmt, steps = C.depth, np.maximum(spans["length"].astype(np.int64) - 1, 1)
        first, last = rng.integers(0, fmt.one, (2, lights, count))
        first[:, ::9] >>= 12
        last[:, 1::9] = fmt.max
        first[:, 2::9] = -rng.integers(0, fmt.one, first[:, 2::9].shape)
        frame.depths = np.stack([first, (last - first) // steps], axis=-1)
        frame.falloff = rng.integers(0, C.coefficient.one + 1, (lights, C.weight_points))
        frame.falloff[0, :2] = C.coefficient.one
    return frame


def random_lights(
    seed: int | list[int], spans: int, longest: int, lights: int, two_sided: bool = False,
    coloured: bool = True,
) -> Frame:  # fmt: skip
    """A `random_frame` with several `lights` in random directions.

    coloured: whether the highlights have colours, some of them brighter than 1; else all are white.
    The normals are at most sqrt(3) long, so that no light sees a component beyond the format.
    """
    rng = np.random.default_rng(seed)
    frame = random_frame(seed, spans, longest, two_sided)
    frame.spans["start"] >>= 1
    frame.spans["step"] >>= 1
    one, table = C.coefficient.one, frame.materials

    def colours(most: int) -> Ints:
        return rng.integers(0, most + 1, table.diffuse.shape)

    table.ambient = colours(C.coefficient.max // 4)
    table.highlight = colours(C.coefficient.max) if coloured else None
    for _ in range(lights - 1):
        turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
        start, step = (
            np.floor(frame.spans[name] @ turn.T + 0.5).astype(np.int64)
            for name in ("start", "step")
        )
        angle = rng.random() * 1.5
        hx, hz = C.half_vector.quantize([np.sin(angle), np.cos(angle)]).tolist()
        highlight = colours(one // 2) if coloured else np.full_like(table.diffuse, one)
        frame.further.append(
            FurtherLight((hx, hz), start, step, colours(C.coefficient.max // lights), highlight)
        )
    return frame
