# SPDX-License-Identifier: MIT
"""Certified bounds: what they build on is exhausted, the derivation holds, a worse design fails."""

from __future__ import annotations

import math
import sys
from dataclasses import replace

import mpmath
import numpy as np
import pytest

from phong75.model import tables
from phong75.model.analysis import certificate, exhausted
from phong75.model.analysis.certificate import Box, ErrorBound, NoBoundError
from phong75.model.analysis.exhausted import Stages
from phong75.model.config import DEFAULT as C
from phong75.model.config import Format
from phong75.model.frame import InputError
from phong75.model.studies import adversarial, aligned
from phong75.model.studies.adversarial import Inputs
from phong75.model.studies.methods import CONFIGS
from phong75.model.twin.core.specular_power import specular_power
from phong75.scripts import prove, recorded
from phong75.scripts.configurations import CONFIGURATIONS
from phong75.scripts.docs.tables import above
from phong75.sim import power_errors
from phong75.sim.power_errors import PowerRow

RNG = np.random.default_rng(75)
INVERSE_SQRT = "phong75.model.twin.core.inverse_sqrt_linear"
KEPT = recorded.figures("prove")
ROWS = {row["whole"]: PowerRow(**row) for row in KEPT["power"]}
STAGES = prove.stages(C, list(ROWS.values()))
BOUNDS = {steep: ErrorBound(C, STAGES, steep) for steep in (False, True)}


def point(angle, t, y, n, side) -> Box:
    return Box((angle, angle), (t, t), (y, y), (n, n), side)


def worst(row) -> Box:
    """The box of one input at which the bound of a row of the record is largest."""
    return aligned.place(row["search"]["at"])


def lsb(bound: ErrorBound, box: Box, config=C) -> float:
    return certificate.lsb_of(bound(box), config)


# -- the exhausted stages --------------------------------------------------------------------------


def test_the_record_is_of_todays_tables():
    assert KEPT["power_digest"] == exhausted.power_digest(C), "make prove RECORD=1"
    assert tuple(KEPT["root"]) == exhausted.root_errors(C), "make prove RECORD=1"
    assert sorted(ROWS) == list(exhausted.WHOLE_PARTS)
    codes = (exhausted.WHOLE_PARTS[-1] - 1) * C.exponent.one + 1
    assert sum(row.pairs for row in ROWS.values()) == codes * C.versine.one


@pytest.mark.parametrize("whole", [127, 128])
def test_recorded_powers_are_found_again(whole):
    assert power_errors.rows(C, [whole], again=True) == [ROWS[whole]]


def test_recorded_powers_are_those_of_the_twin():
    for row in ROWS.values():
        for error, v, n in (
            (row.least, row.least_versine, row.least_exponent),
            (row.greatest, row.greatest_versine, row.greatest_exponent),
        ):
            assert n >> C.exponent.fraction == row.whole
            power = int(specular_power(np.array([v]), np.array([n]), C)[0])
            true = (1 - mpmath.mpf(v) / C.versine.one) ** (mpmath.mpf(n) / C.exponent.one)
            assert abs(power / mpmath.mpf(C.power.one) - true - error) < exhausted.POWER_MARGIN


@pytest.mark.parametrize(
    "config",
    [C, replace(C, log_octaves=False), replace(CONFIGS["power_tables_64"], power_bypass=False)],
)
def test_the_program_computes_the_twins_powers(config):
    v = np.concatenate(
        [RNG.integers(0, C.versine.one, 4000), np.arange(9), C.versine.max - np.arange(9)]
    )
    v[:2000] >>= RNG.integers(0, 20, 2000)
    n = RNG.integers(C.exponent.one, 128 * C.exponent.one + 1, len(v))
    n[::7] = C.exponent.one
    pairs = "".join(f"{a} {b}\n" for a, b in zip(v, n, strict=True))
    codes = power_errors.codes(config, pairs)
    assert codes == specular_power(v, n, config).tolist()


def test_roots_by_whole_numbers():
    """The extremes of R**2 x, exactly, over all operands."""
    operand = np.arange(1 << 20, 4 << 20)
    square = exhausted.inverse_sqrt(operand, C) ** 2
    low, high = int((square * operand).min()), int((square * (operand + 1)).max())
    with mpmath.workdps(40):
        one = mpmath.mpf(2) ** 56
        true = [mpmath.sqrt(low / one) - 1, mpmath.sqrt(high / one) - 1]
        found = STAGES.root
        assert found[0] <= true[0] < found[0] + 1e-15 and found[1] - 1e-15 < true[1] <= found[1]


# -- the derivation --------------------------------------------------------------------------------


def inputs(count: int, near: Box | None = None, spread: float = 0.0) -> tuple[Inputs, list[Box]]:
    """Random inputs, or some around `near`, and each as a box of one input."""
    angle = RNG.uniform(0, np.pi / 2, count)
    direction = RNG.normal(size=(3, count))
    n = np.exp(RNG.uniform(0, np.log(128), count))
    if near:
        angle = np.clip(near.angle[0] + spread * RNG.normal(size=count), 0, np.pi / 2)
        t, y = (
            near.t[0] + spread * RNG.normal(size=count),
            near.y[0] + spread * RNG.normal(size=count),
        )
        along = near.side * np.sqrt(1 - t**2 - y**2)
        direction = np.stack([
            t * np.cos(angle) + along * np.sin(angle), y, along * np.cos(angle) - t * np.sin(angle)
        ])  # fmt: skip
        n = np.full(count, near.n[0])
    direction[2] = np.abs(direction[2])
    direction *= 2.0 ** -RNG.integers(0, 12, count) / np.linalg.norm(direction, axis=0)
    normal = C.normal.quantize(direction)
    half = C.half_vector.quantize(np.stack([np.sin(angle), np.cos(angle)]))
    exponent = C.exponent.quantize(n)
    one, ambient = C.coefficient.one, RNG.integers(0, 600, count)
    diffuse = np.where(RNG.random(count) < 0.5, one - ambient, RNG.integers(0, one // 2, count))
    weight = np.where(RNG.random((2, count)) < 0.6, RNG.integers(0, 2, (2, count)) * one,
                      RNG.integers(0, one + 1, (2, count)))  # fmt: skip
    points = Inputs(normal, half, exponent, ambient, diffuse, weight)
    d = normal / np.linalg.norm(normal.astype(float), axis=0)
    h = half / np.hypot(*half)
    boxes = [
        point(math.atan2(h[0, k], h[1, k]), h[1, k] * d[0, k] - h[0, k] * d[2, k], abs(d[1, k]),
              C.exponent.real(exponent[k]), 1 if h[0, k] * d[0, k] + h[1, k] * d[2, k] >= 0 else -1)
        for k in range(count)
    ]  # fmt: skip
    return points, boxes


@pytest.mark.parametrize("steep", [False, True], ids=["W constant", "any W"])
def test_no_input_errs_more_than_its_own_bound(steep):
    """Random inputs and some around the worst ones: the twin against the reference."""
    rows = [row for row in KEPT["families"] if row["steep"] == steep]
    closest = 0.0
    for near in (None, *map(worst, rows)):
        points, boxes = inputs(1000, near, 0.003)
        if not steep:
            points.weight[1] = points.weight[0]
        codes, unrounded, exact = adversarial.evaluate(points)
        bounds = np.array([lsb(BOUNDS[steep], box) for box in boxes])
        assert (np.abs(codes - exact) <= bounds).all()
        share = np.abs(unrounded - exact) / (bounds - 0.5)
        assert (share <= 1).all()
        closest = max(closest, float(share.max()))
    assert closest > 0.25  # before the last rounding, too; all roundings seldom add up


@pytest.mark.parametrize("name", prove.METHODS)
def test_no_input_errs_more_by_another_method(name):
    """Before the last rounding, too, at random inputs and around a worst one."""
    config = CONFIGS[name]
    assert exhausted.power_digest(config) == KEPT["power_digest"]
    bound = ErrorBound(config, prove.stages(config, list(ROWS.values())), True)
    for near in (None, worst(KEPT["families"][-1])):
        points, boxes = inputs(120, near, 0.003)
        _, unrounded, exact = adversarial.evaluate(points, config)
        bounds = np.array([lsb(bound, box) for box in boxes])
        assert (np.abs(unrounded - exact) <= bounds - 0.5).all()


@pytest.mark.parametrize("row", adversarial.kept(), ids=lambda row: f"{row['limit']}")
def test_the_worst_inputs_reach_most_of_their_own_bound(row):
    normal, half = np.array(row["normal"], float), np.array(row["half_vector"], float)
    (d, (hx, hz)) = normal / np.linalg.norm(normal), half / np.hypot(*half)
    box = point(
        math.atan2(hx, hz), hz * d[0] - hx * d[2], abs(d[1]), C.exponent.real(row["exponent"]),
        1 if hx * d[0] + hz * d[2] >= 0 else -1,
    )  # fmt: skip
    bound = lsb(BOUNDS[row["steep"]], box)
    assert 0.75 < (row["error_lsb"] - 0.5) / (bound - 0.5) <= 1


@pytest.mark.parametrize("steep", [False, True], ids=["W constant", "any W"])
def test_the_bound_of_a_box_is_that_of_each_input_in_it(steep):
    _, boxes = inputs(300)
    checked = 0
    for inner in boxes:
        sides = {}
        for name, (least, most) in {
            "angle": (0, certificate.RIGHT_ANGLE), "y": (0, 1), "n": (1, 128),
            "t": (0, 1) if inner.t[0] >= 0 else (-1, 0),
        }.items():  # fmt: skip
            width = 2.0 ** -RNG.integers(0, 9) * (most - least)
            low, high = getattr(inner, name)
            sides[name] = (
                float(max(low - width * RNG.random(), least)),
                float(min(high + width * RNG.random(), most)),
            )
        one, all_of_them = BOUNDS[steep](inner), BOUNDS[steep](Box(**sides, side=inner.side))
        if one is not None:
            checked += 1
            assert one <= all_of_them
    assert checked > 250


# -- the record, and a slice of its search ---------------------------------------------------------


def test_the_record_keeps_what_the_project_promises():
    assert not prove.beyond(KEPT["families"])
    reached = {(row["limit"], row["steep"]): row["error_lsb"] for row in adversarial.kept()}
    for row in KEPT["families"]:
        found = row["search"]
        assert row["reached_lsb"] == reached[row["limit"], row["steep"]], "make prove RECORD=1"
        assert row["reached_lsb"] < found["point_lsb"] <= row["certified_lsb"]
        assert row["certified_lsb"] <= found["point_lsb"] + prove.GAP
        assert lsb(BOUNDS[row["steep"]], worst(row)) == found["point_lsb"]


@pytest.mark.parametrize("row", KEPT["families"], ids=lambda row: row["family"])
def test_a_slice_of_the_search(row):
    """Boxes around the worst input and at random places are certified again."""
    bound, at = BOUNDS[row["steep"]], worst(row)
    target = row["certified_lsb"] + 0.004
    width = 0.1 / math.sqrt(row["limit"])

    def beside(side, width, least):
        return max(side[0] - width, least), side[0] + width

    places = [
        Box(
            beside(at.angle, width, 0), beside(at.t, width / 4, -1), beside(at.y, width / 4, 0),
            (0.9 * row["limit"], row["limit"]), at.side,
        )
    ]  # fmt: skip
    for _ in range(4):
        angle, t, y = RNG.random(3) * (1.4, 1.9, 0.9) - (0, 1, 0)
        n = float(RNG.uniform(1, 0.8 * row["limit"]))
        places.append(
            Box((angle, angle + 0.1), (t, min(t + 0.05, 1.0)), (y, y + 0.05), (n, 1.2 * n), 1)
        )
    for place in places:
        found = certificate.search(bound, C, certificate.split(place), 0, target)
        assert found.bound_lsb <= target and found.boxes < 30_000


def test_the_methods_are_certified_above_what_is_seen():
    rows = recorded.figures("prove-methods")["methods"]
    assert tuple(row["name"] for row in rows) == prove.METHODS
    seen = {row["name"]: row["max_lsb"] for row in recorded.figures("stability")["methods"]}
    swept = recorded.figures("sweep")["configurations"]
    for row in rows:
        constant, most = row["constant_lsb"] or np.inf, row["any_lsb"] or np.inf
        assert 0.59 < constant < most or most == np.inf
        assert seen[row["name"]] <= most and swept[row["name"]]["port_max_lsb"] <= most


# -- broken designs --------------------------------------------------------------------------------

NARROWER = [
    {"mantissa": Format(True, 0, 16)}, {"unit": Format(True, 0, 16)},
    {"half_vector": Format(True, 0, 15)}, {"versine": Format(False, 0, 18)},
    {"cosine": Format(False, 0, 16)}, {"intensity": Format(False, 1, 14)},
    {"root": Format(False, 0, 16)}, {"root_operand": Format(False, 2, 17)},
    {"root_index_bits": 6, "root_slope_bits": 17},
]  # fmt: skip


def table_with(table, config, **changes):
    """`table` of `config` with one entry changed: {name of the column: (entry, by how much)}."""
    made = table(config)
    for name, (entry, by) in changes.items():
        column = getattr(made, name).copy()
        column[entry] += by
        made = replace(made, **{name: column})
    return made


def test_a_wrong_entry_of_the_roots_is_seen(monkeypatch):
    wrong = table_with(tables.inverse_sqrt_linear_table, C, value=(100, 16))
    monkeypatch.setattr(sys.modules[INVERSE_SQRT], "inverse_sqrt_linear_table", lambda _: wrong)
    roots = exhausted.root_errors(C)
    assert roots[1] > STAGES.root[1]
    found, row = Stages(roots, STAGES.power), KEPT["families"][-1]
    assert lsb(ErrorBound(C, found, True), worst(row)) > row["search"]["point_lsb"]


def test_a_wrong_entry_of_the_powers_is_seen(monkeypatch):
    wrong = table_with(tables.exp_table, C, value=(17, 64))
    monkeypatch.setattr(exhausted, "exp_table", lambda _: wrong)
    assert KEPT["power_digest"] != exhausted.power_digest(C)
    (row,) = power_errors.rows(C, [128], again=True)
    assert row.greatest > ROWS[128].greatest


@pytest.mark.parametrize("change", NARROWER, ids=lambda change: next(iter(change)))
def test_a_narrower_word_breaks_a_certified_bound(change):
    config = replace(C, **change)
    found = Stages(exhausted.root_errors(config), STAGES.power)
    broken = [
        row for row in KEPT["families"]
        if lsb(ErrorBound(config, found, row["steep"]), worst(row), config) > row["certified_lsb"]
    ]  # fmt: skip
    assert broken


@pytest.mark.parametrize("row", KEPT["families"][1:], ids=lambda row: row["family"])
def test_words_of_a_bit_less_fail(row):
    """Even if their powers were exact."""
    config = CONFIGS["width_17"]
    exact = dict.fromkeys(exhausted.WHOLE_PARTS, (0.0, 0.0))
    found = Stages(exhausted.root_errors(config), exact)
    bound = lsb(ErrorBound(config, found, row["steep"]), worst(row), config)
    assert prove.beyond([row | {"certified_lsb": bound}])


# -- the command -----------------------------------------------------------------------------------


def test_a_bound_too_far_above_what_is_found_fails(monkeypatch, capsys):
    rows = [dict(row) for row in KEPT["families"]]
    monkeypatch.setattr(prove, "families", lambda *_: rows)
    assert prove.main(C, False, False) == 0
    out = capsys.readouterr().out
    assert all(above(row["certified_lsb"], 4) in out for row in rows)
    rows[1]["certified_lsb"], rows[2]["certified_lsb"] = 1.06 * rows[1]["reached_lsb"], None
    assert prove.main(C, False, False) == 1
    lines = [line for line in capsys.readouterr().err.splitlines() if "FAILED" in line]
    assert len(lines) == 2 and "more than 0.5696" in lines[0] and "no bound is" in lines[1]


@pytest.mark.parametrize("name", ["gouraud", "quadratic_spans_18", "squaring_18", "curve"])
def test_what_the_derivation_does_not_cover_is_refused(name):
    with pytest.raises(InputError, match=f"{name}: nothing is certified for "):
        prove.main(CONFIGURATIONS[name], False, False)


def test_an_error_too_large_for_the_derivation_has_no_certificate():
    config = CONFIGS["width_10"]
    found = Stages(exhausted.root_errors(config), STAGES.power)
    with pytest.raises(NoBoundError):
        certificate.certify(ErrorBound(config, found, True), config, 32, 128, prove.GAP)
