# SPDX-License-Identifier: MIT
"""Aligned search: the worst inputs around one place, where all roundings add up.

The certificate (`phong75.model.analysis.certificate`) names the place at which the bound is
largest: the direction of the eye, that of the normal, and n. Its bound lets all roundings add up.
This search looks for inputs nearby at which nearly all of them do:

1. Many normals, of a length at which the mantissas are shortest, each component nearly half a unit
   of its mantissa beside it. Where W is steep, Zn is beside a point of its table, where W jumps.
2. For the best of them, by turns: many half vectors, many exponents, many other mantissas.
3. Every Cp d, as in `adversarial`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from phong75.model.analysis.certificate import Box
from phong75.model.arrays import Ints, Reals
from phong75.model.config import DEFAULT as C
from phong75.model.studies import adversarial
from phong75.model.studies.adversarial import AMBIENT, ONE, Family, Inputs

#: Inputs at once.
BLOCK = 1 << 15

#: Bits of a component of the normal below its mantissa, where the largest one is 1/2 to 1.
BELOW = C.normal.fraction - C.mantissa.fraction


def _half_vectors(angle: Reals, rng: np.random.Generator) -> Ints:
    """Half vectors int64[2, n] at `angle` (radians, from the light) that are legal at the ports:
    those of length 1, and others that differ from it by no more than rounding."""
    direction = np.stack([np.sin(angle), np.cos(angle)])
    off = math.sqrt(5) / 2
    length = C.half_vector.one + rng.uniform(-off, off, angle.shape)
    other = np.rint(direction * length).astype(np.int64)
    legal = np.abs(np.hypot(*other) - C.half_vector.one) <= off
    legal &= (np.abs(other) <= C.half_vector.max).all(axis=0)
    return np.where(legal, other, C.half_vector.quantize(direction))


def _around(family: Family, around: Box, count: int, rng: np.random.Generator) -> Inputs:
    """`count` inputs around `around`, with mantissas as short and as wrong as they get."""
    angle, t, y = (side[0] * (1 + 0.08 * rng.normal(size=count)) for side in
                   (around.angle, around.t, around.y))  # fmt: skip
    angle = np.clip(angle, 0, math.pi / 2)
    along = around.side * np.sqrt(np.maximum(1 - t**2 - y**2, 0))
    x, z = t * np.cos(angle) + along * np.sin(angle), along * np.cos(angle) - t * np.sin(angle)
    weight = np.full((2, count), ONE)
    if family.steep:
        intervals = C.weight_points - 1
        rising = rng.integers(0, 2, count)
        beside = np.rint(z * intervals) / intervals - np.where(rising, 2e-5, -2e-5)
        z = np.clip(beside, 0, 1)
        weight = np.stack([1 - rising, rising]) * ONE
    across = np.sqrt(1 - z**2) / np.maximum(np.hypot(x, y), 1e-9)
    direction = np.stack([x * across, y * across, z])
    power = _power(direction, angle, around.n[0])
    # As much Cp (1 - d) as leaves S below 1, or none.
    room = np.maximum(0.985 - power, 0) / np.maximum(z, 1e-6)
    diffuse = np.clip(room * rng.integers(0, 2, count) * ONE, 0, ONE - AMBIENT).astype(np.int64)
    scale = rng.uniform(0.5, 0.53, count) / np.abs(direction).max(axis=0)
    mantissa = np.rint(direction * scale * C.mantissa.one).astype(np.int64)
    beside = rng.choice([-1, 1], (3, count)) * ((1 << BELOW - 1) - 1)
    return Inputs(
        (mantissa << BELOW) + beside, _half_vectors(angle, rng),
        np.full(count, C.exponent.quantize(around.n[0])), np.zeros(count, np.int64),
        diffuse, weight,
    )  # fmt: skip


def _power(direction: Reals, angle: Reals, n: float) -> Reals:
    """cos(s)**n of unit normals float64[3, k] for half vectors at `angle`."""
    x, y, z = direction
    w = np.stack([np.cos(angle) * y, np.cos(angle) * x - np.sin(angle) * z])
    return np.maximum(1 - 2 * (w**2).sum(axis=0), 0) ** n


def _errors(inputs: Inputs) -> Reals:
    count = inputs.normal.shape[1]
    blocks = (inputs.take(slice(k, k + BLOCK)) for k in range(0, count, BLOCK))
    return np.concatenate([adversarial.unrounded_error(block) for block in blocks])


def _best(inputs: Inputs, tries: int, change: Callable[[Inputs], Inputs]) -> tuple[Inputs, Reals]:
    """The best of `tries` changes of each of `inputs`, which may be the input itself."""
    many = inputs.take(np.repeat(np.arange(inputs.normal.shape[1]), tries))
    changed = change(many)
    for name in Inputs.__dataclass_fields__:
        getattr(changed, name)[..., ::tries] = getattr(many, name)[..., ::tries]
    errors = _errors(changed).reshape(-1, tries)
    best = errors.argmax(axis=1)
    return changed.take(np.arange(len(best)) * tries + best), errors.max(axis=1)


def place(at: dict) -> Box:
    """The box of one input in a record of `phong75 prove`."""
    angle, t, y, n = (tuple(at[name]) for name in ("angle", "t", "y", "n"))
    return Box(angle, t, y, n, at["side"])


def search(
    family: Family, around: Box, points: int = 1 << 20, rounds: int = 5, kept: int = 600,
    tries: int = 1024, progress: Callable[[float], None] | None = None,
) -> dict:  # fmt: skip
    """The worst input found near `around` (a box of one input), as a row of `adversarial.KEPT`.

    points: number of normals of step 1. rounds: turns of step 2, for the best `kept` of them, with
    `tries` changes each. progress: called with the part done. The same arguments give the same
    result.
    """
    rng = np.random.default_rng([family.limit, family.steep])

    def half_vectors(many: Inputs) -> Inputs:
        angle = np.arctan2(*many.half_vector) + 2e-3 * rng.normal(size=len(many.exponent))
        return replace(many, half_vector=_half_vectors(np.clip(angle, 0, math.pi / 2), rng))

    def exponents(many: Inputs) -> Inputs:
        width = min(700, 20 * family.limit)
        n = many.exponent + rng.integers(-width, width + 1, len(many.exponent))
        return replace(many, exponent=np.clip(n, C.exponent.one, family.limit * C.exponent.one))

    def mantissas(many: Inputs) -> Inputs:
        size = 10.0 ** rng.uniform(-0.3, 3, len(many.exponent))
        step = np.rint(size * rng.normal(size=many.normal.shape)).astype(np.int64)
        normal = np.clip(many.normal + (step << BELOW), C.normal.min, C.normal.max)
        return replace(many, normal=normal)

    inputs = _around(family, around, points, rng)
    inputs = inputs.take(np.argsort(-_errors(inputs), kind="stable")[:kept])
    for k in range(rounds):
        inputs, _ = _best(inputs, tries, half_vectors)
        inputs, errors = _best(inputs, tries // 2, exponents)
        inputs = inputs.take(np.argsort(-errors, kind="stable")[: max(kept // 10, 1)])
        inputs, errors = _best(inputs, 16 * tries, mantissas)
        if progress:
            progress((k + 1) / rounds)
    return adversarial.worst(family, inputs.take(np.argsort(-errors, kind="stable")))
