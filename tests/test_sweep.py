"""The sweep: sound configurations, a slice of them against their twins, charts that repeat."""

import csv
import dataclasses
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from model import charts, error_budget
from model.config import DEFAULT
from model.sweep import CONFIGS, of_width, points
from model.verilog import header
from scripts import sweep
from sim.build import Bench
from sim.latency import latencies
from sim.sweep import measure
from sim.units import bench_source
from tests.test_modules import run

SMALL = (("model/data/highlights.toml", (72, 24), ""), ("model/data/facets.toml", (96, 16), ""))
SLICE = ("width_12", "parabolas_8", "table_8_newton", "squaring_14", "dot_first_16")


def test_there_are_forty_different_configurations():
    digests = {dataclasses.replace(c, name="").digest for c in CONFIGS.values()}
    assert len(points()) == len(CONFIGS) == len(digests) >= 40
    assert CONFIGS["default"] == DEFAULT


def test_every_configuration_has_header_and_latency():
    found = {name: latencies(config)["pixel"] for name, config in CONFIGS.items()}
    assert len({header(config) for config in CONFIGS.values()}) == len(CONFIGS)
    newton = latencies()["newton_step"]
    assert found["magic_2"] == found["magic_1"] + newton == found["magic_0"] + 2 * newton
    assert found["not_normalized"] < found["magic_0"] < found["default"] < found["parabolas_8"]


def test_eighteen_bits_are_the_default():
    assert of_width(18, "default") == DEFAULT


@pytest.mark.parametrize("width", range(10, 19))
def test_no_word_outgrows_the_multiplier(width):
    config = of_width(width)
    for name in ("half_vector", "mantissa", "root", "unit", "cosine", "power", "weight"):
        assert getattr(config, name).bits == width, name


@pytest.mark.parametrize("name", SLICE)
def test_rtl_equals_twin(name, tmp_path):
    point = next(p for p in points() if p.config.name == name)
    found = measure(point, SMALL, tmp_path)
    assert found["complete"] and found["pixels"] > 500
    assert found["mismatches"] == 0
    assert found["latency_cycles"] == latencies(point.config)["pixel"] + 3
    assert found["port_max_lsb"] <= found["bound_lsb"]
    again = measure(point, SMALL, tmp_path)  # from what is kept
    assert again["rms_lsb"] == found["rms_lsb"] and again["key"] == found["key"]


def test_a_kept_run_that_differs_from_the_twin_is_noticed(tmp_path):
    point = next(p for p in points() if p.config.name == SLICE[0])
    measure(point, SMALL, tmp_path)
    kept = tmp_path / f"{SLICE[0]}.npz"
    with np.load(kept) as file:
        arrays = dict(file)
    arrays["c0"][7, 1] ^= 1
    np.savez(kept, **arrays)
    found = measure(point, SMALL, tmp_path)
    assert found["mismatches"] == 1
    assert sweep.failures([found]) == [
        f"{SLICE[0]}: 1 of {found['pixels']} pixels of RTL and twin differ"
    ]


def test_the_magic_start_in_rtl(tmp_path):
    top, text = bench_source("inverse_sqrt_iterated")
    bench = Bench(top, CONFIGS["magic_1"], sources={f"{top}.v": text})
    run(bench, "inverse_sqrt_iterated", "tests.modules.methods", tmp_path, "magic_1")


def test_where_no_bound_is_derived_there_is_none():
    for name in ("not_normalized", "schlick_18"):
        assert not error_budget.derived(CONFIGS[name], 10.0)
    assert all(error_budget.derived(CONFIGS[name], 10.0) for name in SLICE)


def test_pareto():
    cost, error = [1, 2, 3, 3, 4, 1], [9, 5, 6, 2, 2, 9]
    assert charts.pareto(cost, error) == [True, True, False, True, False, True]


def _rows():
    rows = []
    for k, point in enumerate(points()[:12]):
        rows.append({
            "name": point.config.name, "family": "precision", "method": point.method,
            "label": point.label, "cycles": 1000 + k, "clock_mhz": 200.0, "clock_source": "stated",
            "frame_us": (1000 + k) / 200, "latency_cycles": 77 + k, "max_lsb": 0.5 + k,
            "rms_lsb": 0.3 + (k % 5), "p999_lsb": 0.5, "mean_lsb": 0.26, "psnr_db": None,
            "correctly_rounded": 1 - k / 100, "simulate_s": 0.1, "model_s": 0.1, "pixels": 100,
            "mismatches": 0, "complete": True, "port_max_lsb": 0.5, "bound_lsb": None,
            "dsp": 19 - k if k % 2 else None, "lut": 3000 if k % 2 else None,
            "ff": 10 if k % 2 else None, "ebr": 4 if k % 2 else None,
        })  # fmt: skip
    return rows


def test_table_and_charts(tmp_path):
    for folder in ("a", "b"):
        sweep.finish(_rows(), tmp_path / folder)
    names = {"precision.csv"} | {
        f"precision_{chart}.{kind}" for chart in ("time", "hardware") for kind in ("png", "svg")
    }
    for name in names:
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes(), name
    assert {file.name for file in (tmp_path / "a").iterdir()} == names
    with (tmp_path / "a" / "precision.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == list(sweep.COLUMNS) and len(rows) == 12
    assert [row["pareto"] for row in rows] == ["1"] + ["0"] * 11
    assert rows[0]["dsp"] == rows[0]["psnr_db"] == "" and rows[1]["dsp"] == "18"
    text = "".join(ET.parse(tmp_path / "a" / "precision_time.svg").getroot().itertext())
    assert text is not None


def test_bad_command_lines(capsys):
    assert sweep.main(["--route=yes"]) == 2
    assert sweep.main(["--areal"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert said[0] == "Error: ROUTE is `yes`; it must be 0 or 1" and len(said) == 2


def test_failures():
    rows = _rows()
    assert sweep.failures(rows) == []
    rows[2] |= {"port_max_lsb": 0.7, "bound_lsb": 0.6}
    rows[3]["complete"] = False
    said = sweep.failures(rows)
    assert len(said) == 2 and "derived bound 0.6" in said[0] and rows[3]["name"] in said[1]
