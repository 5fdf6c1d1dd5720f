"""The sweep: sound configurations, a slice of them against their twins, charts that repeat."""

import csv
import dataclasses
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from model import charts, error_budget
from model.config import DEFAULT
from model.differences import coefficients
from model.frame import SPAN_DTYPE, InputError
from model.scene import load_scene
from model.scene_to_spans import front_end
from model.spans import read_spans, write_spans
from model.sweep import CONFIGS, of_width, points
from model.twin.quadratic_interpolator import quadratic_interpolator
from model.verilog import header
from scripts import records, sweep
from sim.build import ROOT
from sim.elaborate import instances
from sim.latency import latencies
from sim.sweep import measure

SMALL = (("model/data/highlights.toml", (72, 24), ""), ("model/data/facets.toml", (96, 16), ""))
SLICE = ("width_12", "table_8_newton", "dot_first_16", "differences_16")


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
    assert found["bound_lsb"] is None or found["port_max_lsb"] <= found["bound_lsb"]
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


@pytest.mark.parametrize("length", [2, 40, 500])
def test_differences_give_the_squares_along_a_span(length):
    """Three words are rounded once, by half a unit: after k steps 1 + k + k (k - 1)/2 of it."""
    rng = np.random.default_rng(75)
    spans = np.zeros(200, SPAN_DTYPE)
    one = DEFAULT.normal.one
    spans["start"] = rng.integers(-one // 2, one // 2, (200, 3))
    spans["step"] = rng.integers(-one // 3, one // 3, (200, 3)) // length
    config = CONFIGS["differences_18"]
    half = (30000, 127000)
    words = coefficients(spans, half, config)
    hx, hz = config.half_vector.real(half)
    for k in range(length):
        x, y, z = config.normal.real(spans["start"] + k * spans["step"]).T
        true = {"square": x**2 + y**2 + z**2, "across": (hz * y) ** 2 + (hz * x - hx * z) ** 2}
        bound = (1 + k + k * (k - 1) / 2) * config.squared.lsb / 2
        for name, value in true.items():
            code = quadratic_interpolator(*(words[f"{name}_{d}"] for d in range(3)), k, config)
            assert np.abs(config.squared.real(code) - value).max() <= bound, name


def test_spans_of_differences_are_not_read_back(tmp_path):
    config = CONFIGS["differences_18"]
    frame = front_end(load_scene(*SMALL[0][:2]), config).frame
    write_spans(tmp_path / "spans", frame, config)
    with pytest.raises(InputError, match="cannot be read back"):
        read_spans(tmp_path / "spans", config)


def test_fewer_multipliers():
    """With the squares given, three products stand for eleven."""
    default = instances()["multiplier"]
    assert instances(CONFIGS["differences_18"])["multiplier"] == default - 8
    assert instances(CONFIGS["dot_first_18"])["multiplier"] == default


def test_where_no_bound_is_derived_there_is_none():
    without = {"not_normalized"}
    without |= {name for name in CONFIGS if name.startswith(("schlick", "differences"))}
    for name, config in CONFIGS.items():
        assert error_budget.derived(config, 10.0) == (name not in without), name


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
            "multipliers": 19, "complete": True,
            "mismatches": 0, "port_max_lsb": 0.5, "bound_lsb": None,
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
    assert sweep.main(["--area=yes"]) == 2
    assert sweep.main(["--route=default,magic1"]) == 2
    assert sweep.main(["--areal"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 3 and said[:2] == [
        "Error: AREA is `yes`; it must be 0 or 1",
        "Error: ROUTE: there is no configuration `magic1`; did you mean magic_1?",
    ]


def test_failures():
    rows = _rows()
    assert sweep.failures(rows) == []
    rows[2] |= {"port_max_lsb": 0.7, "bound_lsb": 0.6}
    rows[3]["complete"] = False
    said = sweep.failures(rows)
    assert len(said) == 2 and "derived bound 0.6" in said[0] and rows[3]["name"] in said[1]


def test_the_readme_shows_the_record():
    text = (ROOT / "README.md").read_text()
    assert records.load("sweep")["readme"] in text, "the README's table is old: make sweep"


def test_the_record_is_what_is_measured_now(tmp_path):
    """The default configuration anew, at full size."""
    found = measure(points()[0], folder=tmp_path)
    line = next(line for line in records.load("sweep")["readme"].split("\n") if "| default" in line)
    found |= {"multipliers": instances()["multiplier"]}
    rows = [found | {"name": name} for name in sweep.SHOWN]
    assert sweep.readme(rows).split("\n")[2] == line
