"""The input with the largest error: a search for it, and the worst inputs found so far.

The error of a code is the error of S before the final rounding and what that rounding adds, up to
1/2 LSB. So the search drives |255 S - its exact value| up over normals, directions of the eye,
exponents and coefficients: hypothesis first, then a hill-climb of many points at once; at the end
Cp d, which moves S without an error of its own, is tried at every value, so that S falls just on
the wrong side of a half. The worst of each family stands in data/adversarial.json as integers.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from phong75.model.analysis import error_budget, reference
from phong75.model.config import DEFAULT as C
from phong75.model.frame import SPAN_DTYPE, Frame, MaterialTable, half_vector_codes
from phong75.model.twin.core.phong_unit import shade
from phong75.model.twin.core.specular_power_tables import specular_power_tables

KEPT = Path(__file__).parent.parent / "data" / "adversarial.json"
LIMITS = (10, 32, 128)
ONE = C.coefficient.one

#: Cp d is tried up to this code: a little more than two LSB of a colour.
AMBIENT = 2 * ONE // 255 + 4

#: The exponents of the table of cos(s)**n, and the error that is to be beaten at n = 20: 50 M
#: powers a second in 12.3 k gates, AMM 229-231.1146 (2012).
EXPONENTS = (1.5, 2, 5, 10, 20, 32, 64, 128)
AMM_2012 = 0.00141


@dataclass(frozen=True)
class Family:
    """Inputs with n of at most `limit`, and W(i) constant or (`steep`) with any step."""

    limit: int
    steep: bool

    @property
    def name(self) -> str:
        """In words."""
        return f"n ≤ {self.limit}, {'any W' if self.steep else 'W constant'}"

    def bound_lsb(self) -> float:
        """The largest derived bound of the family, over angles of the eye and exponents."""
        points = np.arange(C.weight_points) % 2 if self.steep else np.ones(C.weight_points)
        n = [n for n in (1, 1.5, 2, 3, 5, 10, 20, 32, 64, 128) if n <= self.limit]
        worst = 0.0
        for exponent in n:
            table = MaterialTable.empty(C)
            table.set(0, (1, 1, 1), 0, points, exponent, C)
            for angle in np.linspace(0, np.pi, 33):
                h = half_vector_codes(np.array([np.sin(angle), 0, np.cos(angle)]), C)
                frame = Frame(1, 1, h, False, (0, 0, 0), table, np.zeros(1, SPAN_DTYPE))
                worst = max(worst, float(error_budget.bound_lsb(frame)))
        return worst


FAMILIES = tuple(Family(limit, steep) for steep in (False, True) for limit in LIMITS)


@dataclass
class Inputs:
    """Points of the search, codes: normal int64[3, n]; half_vector int64[2, n]; exponent, ambient,
    diffuse int64[n]; weight int64[2, n]: W at both ends of the interval that the normal is in."""

    normal: np.ndarray
    half_vector: np.ndarray
    exponent: np.ndarray
    ambient: np.ndarray
    diffuse: np.ndarray
    weight: np.ndarray

    def take(self, which) -> Inputs:
        """Those that `which` (a mask or indices) selects."""
        return Inputs(*(getattr(self, f)[..., which] for f in self.__dataclass_fields__))


def _points(inputs: Inputs) -> np.ndarray:
    """W at all points, int64[n, P]: the ends of the normal's interval, continued on each side."""
    z = inputs.normal[2] / np.maximum(np.linalg.norm(inputs.normal.astype(float), axis=0), 1)
    interval = np.clip((z * (C.weight_points - 1)).astype(np.int64), 0, C.weight_points - 2)
    right = np.arange(C.weight_points) > interval[:, None]
    return np.where(right, inputs.weight[1][:, None], inputs.weight[0][:, None])


def evaluate(inputs: Inputs):
    """(codes, 255 S before the final rounding, 255 S exactly), one channel, [n] each."""
    count = inputs.normal.shape[1]
    material = np.arange(count)
    points = _points(inputs)
    channel = np.zeros((count, 3), np.int64)
    table = MaterialTable(
        channel + inputs.ambient[:, None], channel + inputs.diffuse[:, None], points,
        inputs.exponent,
    )  # fmt: skip
    # A material and a direction of the eye for each point, which the twin takes in its stride.
    frame = Frame(1, 1, inputs.half_vector, False, (0, 0, 0), table, np.zeros(0, SPAN_DTYPE))
    trace: dict = {}
    codes = shade(inputs.normal, material, frame, C, trace)[0]
    white = (1 << C.colour_bits) - 1
    given = white * C.intensity.real(trace["colour_channel.intensity"][0])
    real = C.coefficient.real
    exact = reference.shade(
        inputs.normal.T.astype(float), real(table.ambient), real(table.diffuse), real(points),
        C.exponent.real(inputs.exponent), reference.eye_of(inputs.half_vector), False,
    )[:, 0]  # fmt: skip
    return codes, given, exact


def _badness(inputs: Inputs) -> np.ndarray:
    """The error of S in LSB, 0 where Cp d could carry S to 1."""
    _, given, exact = evaluate(inputs)
    return np.where(exact < 252, np.abs(given - exact), 0)


def _start(family: Family, count: int, rng) -> tuple[Inputs, np.ndarray]:
    """Random points, half of them in a highlight, and the angles of the eye."""
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


def _step(family: Family, inputs: Inputs, angle, rng) -> tuple[Inputs, np.ndarray]:
    """Neighbours of all points, at all scales."""
    count = len(angle)

    def moved(values, low, high):
        scale = 2.0 ** rng.uniform(0, np.log2(high - low), values.shape)
        by = np.rint(rng.normal(size=values.shape) * scale).astype(np.int64)
        return np.clip(np.where(rng.random(values.shape) < 0.4, values + by, values), low, high)

    angle = np.where(
        rng.random(count) < 0.3,
        np.clip(angle + rng.normal(size=count) * 10.0 ** rng.uniform(-6, 0, count), 0, np.pi),
        angle,
    )
    one = C.exponent.one
    exponent = moved(inputs.exponent, one, family.limit * one)
    exponent = np.where(rng.random(count) < 0.1, family.limit * one, exponent)
    weight = moved(inputs.weight, 0, ONE)
    ends = rng.integers(0, 2, weight.shape) * ONE
    weight = np.where(rng.random(weight.shape) < 0.1, ends, weight)
    if not family.steep:
        weight[1] = weight[0]
    half_vector = C.half_vector.quantize([np.sin(angle / 2), np.cos(angle / 2)])
    return Inputs(
        moved(inputs.normal, C.normal.min, C.normal.max), half_vector, exponent, inputs.ambient,
        moved(inputs.diffuse, 0, ONE - AMBIENT), weight,
    ), angle  # fmt: skip


def _climb(family, inputs, angle, rounds, rng, progress) -> Inputs:
    """Every point climbs by random steps; now and then the worse half starts anew from the better.

    Returns the points, the best first.
    """
    best = _badness(inputs)
    count = len(angle)
    for k in range(rounds):
        tried, tried_angle = _step(family, inputs, angle, rng)
        found = _badness(tried)
        better = found > best
        best = np.where(better, found, best)
        angle = np.where(better, tried_angle, angle)
        inputs = Inputs(*(
            np.where(better, getattr(tried, f), getattr(inputs, f))
            for f in inputs.__dataclass_fields__
        ))  # fmt: skip
        if k % 50 == 49 and k < rounds * 0.8:
            order = np.argsort(-best, kind="stable")
            order[count // 2 :] = order[: count - count // 2]
            inputs, angle, best = inputs.take(order), angle[order], best[order]
        progress((k + 1) / rounds)
    return inputs.take(np.argsort(-best, kind="stable"))


def _explore(family: Family, examples: int) -> list[dict]:
    """Points that hypothesis comes upon while it drives the error up, the best last."""
    from hypothesis import HealthCheck, given, settings, target
    from hypothesis import strategies as st

    component = st.integers(C.normal.min, C.normal.max) | st.integers(-64, 64)
    coefficient = st.integers(0, ONE)
    found: list[tuple[float, dict]] = []

    @settings(
        max_examples=examples, derandomize=True, database=None, deadline=None,
        suppress_health_check=list(HealthCheck),
    )  # fmt: skip
    @given(
        st.tuples(component, component, st.integers(1, C.normal.max)), st.floats(0, np.pi),
        st.integers(C.exponent.one, family.limit * C.exponent.one),
        st.integers(0, ONE - AMBIENT), st.tuples(coefficient, coefficient),
    )  # fmt: skip
    def drive(normal, angle, exponent, diffuse, weight):
        point = {
            "normal": normal, "angle": angle, "exponent": exponent, "diffuse": diffuse,
            "weight": weight if family.steep else weight[:1] * 2,
        }  # fmt: skip
        badness = float(_badness(_gathered([point])[0])[0])
        found.append((badness, point))
        target(badness)

    drive()
    return [point for _, point in sorted(found, key=lambda f: f[0])[-200:]]


def _gathered(points: list[dict]) -> tuple[Inputs, np.ndarray]:
    """`points` of `_explore` as arrays, and their angles."""
    angle = np.array([p["angle"] for p in points])

    def column(name):
        return np.array([p[name] for p in points], np.int64).T

    return Inputs(
        column("normal"), C.half_vector.quantize([np.sin(angle / 2), np.cos(angle / 2)]),
        column("exponent"), np.zeros(len(points), np.int64), column("diffuse"), column("weight"),
    ), angle  # fmt: skip


def search(
    family: Family, points: int = 4096, rounds: int = 1500, examples: int = 1500, climbs: int = 3,
    progress: Callable[[float], None] | None = None,
) -> dict:  # fmt: skip
    """The worst input found in `climbs` climbs of `points` points, as a row for `KEPT`. The same
    for the same arguments."""
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

        def done(part, climb=climb):
            if progress:
                progress((climb + part) / climbs)

        rows.append(_worst(family, _climb(family, inputs, angle, rounds, rng, done)))
    return max(rows, key=lambda row: row["error_lsb"])


def _worst(family: Family, inputs: Inputs) -> dict:
    """The worst of the first of `inputs`, each with every Cp d."""
    inputs = inputs.take(slice(0, 256))
    count, room = inputs.normal.shape[1], np.arange(AMBIENT + 1)
    inputs = inputs.take(np.repeat(np.arange(count), len(room)))
    inputs = replace(inputs, ambient=np.tile(room, count))
    codes, _, exact = evaluate(inputs)
    worst = int(np.argmax(np.abs(codes - exact)))
    one = inputs.take([worst])
    return {
        "limit": family.limit,
        "steep": family.steep,
        "normal": one.normal[:, 0].tolist(),
        "half_vector": one.half_vector[:, 0].tolist(),
        "exponent": int(one.exponent[0]),
        "ambient": int(one.ambient[0]),
        "diffuse": int(one.diffuse[0]),
        "weight": _points(one)[0].tolist(),
        "error_lsb": float(np.abs(codes - exact)[worst]),
    }


def kept() -> list[dict]:
    """The worst inputs found so far, one a family, as `search` returns them."""
    return json.loads(KEPT.read_text())


def keep(rows: list[dict]) -> None:
    """Write `rows` in place of the kept ones."""
    lines = ",\n".join(f" {json.dumps(row)}" for row in rows)
    KEPT.write_text(f"[\n{lines}\n]\n")


def frame(row: dict) -> Frame:
    """The frame of one pixel that shows the input `row`."""
    table = MaterialTable.empty(C)
    table.ambient[0], table.diffuse[0] = row["ambient"], row["diffuse"]
    table.weight[0], table.exponent[0] = row["weight"], row["exponent"]
    spans = np.zeros(1, SPAN_DTYPE)
    spans["start"], spans["length"], spans["last"] = row["normal"], 1, True
    return Frame(1, 1, tuple(row["half_vector"]), False, (0, 0, 0), table, spans)


def power_errors(progress: Callable[[float], None] | None = None) -> list[dict]:
    """The error of cos(s)**n alone at EXPONENTS, over every code of 1 - cos(s)."""
    rows = []
    block = 1 << 18
    for done, n in enumerate(EXPONENTS):
        worst, at = 0.0, 0
        exponent = np.full(block, C.exponent.quantize(n))
        for first in range(0, C.versine.one, block):
            v = np.arange(first, first + block)
            power = C.power.real(specular_power_tables(v, exponent, C))
            error = np.abs(power - (1 - C.versine.real(v)) ** n)
            if error.max() > worst:
                worst, at = float(error.max()), first + int(error.argmax())
        rows.append({
            "n": n, "codes": C.versine.one, "max_error": worst, "at_versine": at,
            "bound": float(error_budget.specular_power_tables(n, C)),
        })  # fmt: skip
        if progress:
            progress((done + 1) / len(EXPONENTS))
    return rows
