# SPDX-License-Identifier: MIT
"""Adversarial search: the input with the largest error, and the worst inputs found so far.

The error of a colour code has two parts: the error of S before the final rounding, and the final
rounding itself, up to 1/2 LSB. The search has three steps:

1. hypothesis maximizes the error of 255 S over normals, directions of the eye, exponents and
   coefficients.
2. Many points climb at once by random steps (hill climbing).
3. Every small value of Cp d is tried for the best points. Cp d shifts S without adding an error, so
   that S falls just on the wrong side of a half and the final rounding adds its 1/2 LSB.

`aligned` searches around one place instead. model/data/adversarial.json holds the worst input of
each family, in integers.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from phong75.model.analysis import error_budget, reference
from phong75.model.arrays import Ints, Reals, Trace
from phong75.model.config import DEFAULT as C
from phong75.model.config import MAX_EXPONENT, Config
from phong75.model.frame import SPAN_DTYPE, Frame, MaterialTable
from phong75.model.twin.core.normalizer import leading_zeros
from phong75.model.twin.core.phong_unit import shade
from phong75.model.twin.core.specular_power_tables import specular_power_tables

#: File of the worst inputs.
KEPT = Path(__file__).parent.parent / "data" / "adversarial.json"

#: Largest exponents n of the families.
LIMITS = (10, 32, MAX_EXPONENT)

#: Code of 1.0 in `Config.coefficient`.
ONE = C.coefficient.one

#: Largest code of Cp d in step 3: slightly more than two LSB of a colour code.
AMBIENT = 2 * ONE // 255 + 4

#: Exponents at which `power_errors` measures cos(s)**n.
EXPONENTS = (1.5, 2, 5, 10, 20, 32, 64, 128)

#: Error of cos(s)**20 in a published design, for comparison: 50 M powers per second, 12.3 k gates,
#: AMM 229-231.1146 (2012).
AMM_2012 = 0.00141


@dataclass(frozen=True)
class Family:
    """A family of inputs: n of at most `limit`; W(i) constant, or arbitrary if `steep`."""

    limit: int
    steep: bool

    @property
    def name(self) -> str:
        """The name that tables show."""
        return f"n ≤ {self.limit}, {'any W' if self.steep else 'W constant'}"


FAMILIES = tuple(Family(limit, steep) for steep in (False, True) for limit in LIMITS)


@dataclass
class Inputs:
    """n points of the search, in codes.

    normal: int64[3, n], `Config.normal`. half_vector: int64[2, n], `Config.half_vector`. exponent:
    int64[n], `Config.exponent`. ambient, diffuse: int64[n], Cp d and Cp (1 - d),
    `Config.coefficient`. weight: int64[2, n], W at both ends of the table interval that contains
    the Zn of the normal, `Config.coefficient`.
    """

    normal: np.ndarray
    half_vector: np.ndarray
    exponent: np.ndarray
    ambient: np.ndarray
    diffuse: np.ndarray
    weight: np.ndarray

    def take(self, which: Ints | slice | list[int]) -> Inputs:
        """The points selected by `which` (a mask or indices)."""
        return Inputs(*(getattr(self, f)[..., which] for f in self.__dataclass_fields__))


def _points(inputs: Inputs) -> np.ndarray:
    """W at all table points, int64[n, P]: constant on each side of the normal's interval."""
    z = inputs.normal[2] / np.maximum(np.linalg.norm(inputs.normal.astype(float), axis=0), 1)
    interval = np.clip((z * (C.weight_points - 1)).astype(np.int64), 0, C.weight_points - 2)
    right = np.arange(C.weight_points) > interval[:, None]
    return np.where(right, inputs.weight[1][:, None], inputs.weight[0][:, None])


def evaluate(inputs: Inputs, config: Config = C) -> tuple[Ints, Reals, Reals]:
    """Shade all points with the twin of `config` and in float64, one channel.

    config: has the words of the default at its ports.

    Returns (codes int[n], 255 S of the twin before the final rounding, exact 255 S), float64[n].
    """
    count = inputs.normal.shape[1]
    material = np.arange(count)
    points = _points(inputs)
    channel = np.zeros((count, 3), np.int64)
    table = MaterialTable(
        channel + inputs.ambient[:, None], channel + inputs.diffuse[:, None], points,
        inputs.exponent,
    )  # fmt: skip
    # Each point has a material and a half vector of its own. The twin broadcasts over both.
    half_vector: Any = inputs.half_vector
    frame = Frame(1, 1, half_vector, False, (0, 0, 0), table, np.zeros(0, SPAN_DTYPE))
    trace: Trace = {}
    codes = shade(inputs.normal, material, frame, config, trace)[0]
    white = C.white
    unrounded = white * config.intensity.real(trace["colour_channel.intensity"][0])
    real = C.coefficient.real
    exact = reference.shade(
        inputs.normal.T.astype(float), real(table.ambient), real(table.diffuse), real(points),
        C.exponent.real(inputs.exponent), reference.eye_of(inputs.half_vector), False,
    )[:, 0]  # fmt: skip
    return codes, unrounded, exact


def unrounded_error(inputs: Inputs) -> np.ndarray:
    """The error of 255 S in LSB, float64[n]; 0 for points that step 3 could saturate at S = 1."""
    _, unrounded, exact = evaluate(inputs)
    return np.where(exact < 252, np.abs(unrounded - exact), 0)


def _start(family: Family, count: int, rng: np.random.Generator) -> tuple[Inputs, Reals]:
    """`count` random points, half of them near a highlight, and their eye angles (radians)."""
    angle = rng.uniform(0, np.pi, count)
    half = np.stack([np.sin(angle / 2), 0 * angle, np.cos(angle / 2)])
    spread = np.where(rng.random(count) < 0.5, 0.2, 1.0)
    direction = half + spread * rng.normal(size=(3, count))
    direction[2] = np.abs(direction[2])
    direction *= 2.0 ** -rng.integers(0, 20, count) / np.linalg.norm(direction, axis=0)
    n = np.where(rng.random(count) < 0.5, family.limit, rng.uniform(1, family.limit, count))
    inputs = Inputs(
        C.normal.quantize(direction), C.half_vector.quantize(half[[0, 2]]), C.exponent.quantize(n),
        np.zeros(count, np.int64), rng.integers(0, ONE - AMBIENT + 1, count),
        rng.integers(0, ONE + 1, (2, count)),
    )  # fmt: skip
    if not family.steep:
        inputs.weight[1] = inputs.weight[0]
    return inputs, angle


def _step(
    family: Family, inputs: Inputs, angle: Reals, rng: np.random.Generator
) -> tuple[Inputs, Reals]:
    """A random neighbour of each point, at a random scale, and the neighbours' eye angles."""
    count = len(angle)

    def perturb(values: Ints, low: int, high: int) -> Ints:
        scale = 2.0 ** rng.uniform(0, np.log2(high - low), values.shape)
        step = np.rint(rng.normal(size=values.shape) * scale).astype(np.int64)
        return np.clip(np.where(rng.random(values.shape) < 0.4, values + step, values), low, high)

    angle = np.where(
        rng.random(count) < 0.3,
        np.clip(angle + rng.normal(size=count) * 10.0 ** rng.uniform(-6, 0, count), 0, np.pi),
        angle,
    )
    one = C.exponent.one
    exponent = perturb(inputs.exponent, one, family.limit * one)
    exponent = np.where(rng.random(count) < 0.1, family.limit * one, exponent)
    normal = perturb(inputs.normal, C.normal.min, C.normal.max)
    normal = np.where(rng.random(count) < 0.5, _on_grid(inputs.normal, normal, rng), normal)
    weight = perturb(inputs.weight, 0, ONE)
    ends = rng.integers(0, 2, weight.shape) * ONE
    weight = np.where(rng.random(weight.shape) < 0.1, ends, weight)
    if not family.steep:
        weight[1] = weight[0]
    half_vector = C.half_vector.quantize([np.sin(angle / 2), np.cos(angle / 2)])
    return Inputs(
        normal, half_vector, exponent, inputs.ambient,
        perturb(inputs.diffuse, 0, ONE - AMBIENT), weight,
    ), angle  # fmt: skip


def _on_grid(before: Ints, after: Ints, rng: np.random.Generator) -> Ints:
    """Normals int64[3, n] near `after` whose mantissas are rounded as those of `before`, or by
    nearly half a unit: what is found about that rounding survives a step of the direction."""
    drop = np.maximum(C.normal.bits - C.mantissa.bits - leading_zeros(before, C), 0)
    unit, half = np.int64(1) << drop, np.int64(1) << np.maximum(drop - 1, 0)
    rest = (before + half) % unit - half
    ends = np.where(rng.random(before.shape) < 0.5, half - 1, -half)
    rest = np.where(rng.random(before.shape) < 0.1, np.where(drop > 1, ends, rest), rest)
    return np.clip((after + half) // unit * unit + rest, C.normal.min, C.normal.max)


def _climb(
    family: Family,
    inputs: Inputs,
    angle: Reals,
    rounds: int,
    rng: np.random.Generator,
    progress: Callable[[float], None],
) -> Inputs:
    """Hill climbing: each point moves to a neighbour with a larger error, `rounds` times.

    Every 50 rounds copies of the better half replace the worse half. Returns the points, sorted by
    falling error.
    """
    best = unrounded_error(inputs)
    count = len(angle)
    for k in range(rounds):
        neighbours, neighbour_angle = _step(family, inputs, angle, rng)
        objective = unrounded_error(neighbours)
        better = objective > best
        best = np.where(better, objective, best)
        angle = np.where(better, neighbour_angle, angle)
        inputs = Inputs(*(
            np.where(better, getattr(neighbours, f), getattr(inputs, f))
            for f in inputs.__dataclass_fields__
        ))  # fmt: skip
        if k % 50 == 49 and k < rounds * 0.8:
            order = np.argsort(-best, kind="stable")
            order[count // 2 :] = order[: count - count // 2]
            inputs, angle, best = inputs.take(order), angle[order], best[order]
        progress((k + 1) / rounds)
    return inputs.take(np.argsort(-best, kind="stable"))


def _explore(family: Family, examples: int) -> list[dict]:
    """The best 200 points that hypothesis generates while it maximizes the error, best last."""
    from hypothesis import HealthCheck, given, settings, target
    from hypothesis import strategies as st

    component = st.integers(C.normal.min, C.normal.max) | st.integers(-64, 64)
    coefficient = st.integers(0, ONE)
    scored: list[tuple[float, dict]] = []

    @settings(
        max_examples=examples, derandomize=True, database=None, deadline=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(
        st.tuples(component, component, st.integers(1, C.normal.max)), st.floats(0, np.pi),
        st.integers(C.exponent.one, family.limit * C.exponent.one),
        st.integers(0, ONE - AMBIENT), st.tuples(coefficient, coefficient),
    )  # fmt: skip
    def drive(
        normal: tuple[int, ...], angle: float, exponent: int, diffuse: int, weight: tuple[int, ...]
    ) -> None:
        point = {
            "normal": normal, "angle": angle, "exponent": exponent, "diffuse": diffuse,
            "weight": weight if family.steep else weight[:1] * 2,
        }  # fmt: skip
        objective = float(unrounded_error(_gathered([point])[0])[0])
        scored.append((objective, point))
        target(objective)

    drive()
    return [point for _, point in sorted(scored, key=lambda pair: pair[0])[-200:]]


def _gathered(points: list[dict]) -> tuple[Inputs, np.ndarray]:
    """The `points` of `_explore` as arrays, and their eye angles (radians)."""
    angle = np.array([p["angle"] for p in points])

    def column(name: str) -> Ints:
        return np.array([p[name] for p in points], np.int64).T

    return Inputs(
        column("normal"), C.half_vector.quantize([np.sin(angle / 2), np.cos(angle / 2)]),
        column("exponent"), np.zeros(len(points), np.int64), column("diffuse"), column("weight"),
    ), angle  # fmt: skip


def search(
    family: Family, points: int = 4096, rounds: int = 1500, examples: int = 1500, climbs: int = 3,
    progress: Callable[[float], None] | None = None,
) -> dict:  # fmt: skip
    """The worst input that the search finds, as a row of `KEPT`.

    points: number of points that climb at once. rounds: steps of a climb. examples: examples that
    hypothesis generates. climbs: number of climbs from different starts. progress: called with the
    part done, 0 to 1. The same arguments give the same result.
    """
    explored = _gathered(_explore(family, examples))
    rows = []
    for climb in range(climbs):
        rng = np.random.default_rng([climb, family.limit, family.steep])
        inputs, angle = _start(family, points, rng)
        if climb == 0:
            count = min(len(explored[1]), points)
            for name in inputs.__dataclass_fields__:
                getattr(inputs, name)[..., :count] = getattr(explored[0], name)[..., :count]
            angle[:count] = explored[1][:count]

        def done(part: float, climb: int = climb) -> None:
            if progress:
                progress((climb + part) / climbs)

        rows.append(worst(family, _climb(family, inputs, angle, rounds, rng, done)))
    return max(rows, key=lambda row: row["error_lsb"])


def worst(family: Family, inputs: Inputs) -> dict:
    """The worst of the first 256 of `inputs` after every Cp d up to AMBIENT has been tried."""
    inputs = inputs.take(slice(0, 256))
    count, ambient = inputs.normal.shape[1], np.arange(AMBIENT + 1)
    inputs = inputs.take(np.repeat(np.arange(count), len(ambient)))
    inputs = replace(inputs, ambient=np.tile(ambient, count))
    codes, _, exact = evaluate(inputs)
    at = int(np.argmax(np.abs(codes - exact)))
    one = inputs.take([at])
    return {
        "limit": family.limit,
        "steep": family.steep,
        "normal": one.normal[:, 0].tolist(),
        "half_vector": one.half_vector[:, 0].tolist(),
        "exponent": int(one.exponent[0]),
        "ambient": int(one.ambient[0]),
        "diffuse": int(one.diffuse[0]),
        "weight": _points(one)[0].tolist(),
        "error_lsb": float(np.abs(codes - exact)[at]),
    }


def kept() -> list[dict]:
    """The worst inputs found so far, one per family: rows as `search` returns them."""
    return json.loads(KEPT.read_text())


def keep(rows: list[dict]) -> None:
    """Replace the file of the worst inputs by `rows`."""
    lines = ",\n".join(f" {json.dumps(row)}" for row in rows)
    KEPT.write_text(f"[\n{lines}\n]\n")


def frame(row: dict) -> Frame:
    """The frame of one pixel whose input is `row` (of `kept` or `search`)."""
    table = MaterialTable.empty(C)
    table.ambient[0], table.diffuse[0] = row["ambient"], row["diffuse"]
    table.weight[0], table.exponent[0] = row["weight"], row["exponent"]
    spans = np.zeros(1, SPAN_DTYPE)
    spans["start"], spans["length"], spans["last"] = row["normal"], 1, True
    return Frame(1, 1, tuple(row["half_vector"]), False, (0, 0, 0), table, spans)


def power_errors(progress: Callable[[float], None] | None = None) -> list[dict]:
    """The largest error of cos(s)**n for each of EXPONENTS, over every code of 1 - cos(s).

    Returns one dict per exponent: n, number of codes, max_error, the code at_versine where the
    error is largest, and the derived bound. Errors are absolute. progress: see `search`.
    """
    rows = []
    block = 1 << 18
    for done, n in enumerate(EXPONENTS):
        worst, worst_code = 0.0, 0
        exponent = np.full(block, C.exponent.quantize(n))
        for first in range(0, C.versine.one, block):
            v = np.arange(first, first + block)
            power = C.power.real(specular_power_tables(v, exponent, C))
            error = np.abs(power - (1 - C.versine.real(v)) ** n)
            if error.max() > worst:
                worst, worst_code = float(error.max()), first + int(error.argmax())
        rows.append({
            "n": n, "codes": C.versine.one, "max_error": worst, "at_versine": worst_code,
            "bound": float(error_budget.specular_power_tables(n, C)),
        })  # fmt: skip
        if progress:
            progress((done + 1) / len(EXPONENTS))
    return rows
