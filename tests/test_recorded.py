# SPDX-License-Identifier: MIT
"""Records in results/: written only where that is asked for, and never by a lesser run."""

import json
import re

import pytest

from phong75.model.frame import InputError
from phong75.scripts import benchmark, console, formal, main, recorded, synth
from phong75.scripts.console import MismatchError
from phong75.scripts.studies import sweep
from phong75.sim.design import PACKAGE


@pytest.fixture
def results(tmp_path, monkeypatch):
    """An empty folder of records."""
    monkeypatch.setattr(recorded, "FOLDER", tmp_path)
    return tmp_path


def record(name="synth", effort=None, **run):
    return recorded.record(name, "make synth", ("numpy",), {"clock": 200.0}, effort, **run)


def test_a_run_is_recorded_with_its_effort(results, capsys):
    assert record(effort={"seeds": 3})
    found = recorded.load("synth")
    assert (found["effort"], found["figures"]) == ({"seeds": 3}, {"clock": 200.0})
    assert capsys.readouterr().err == "recorded in results/synth.json\n"


@pytest.mark.parametrize(
    ("run", "reason"),
    [
        ({"effort": {"seeds": 2}}, "2 seeds, and the record has 3"),
        ({}, "0 seeds, and the record has 3"),
        ({"effort": {"seeds": 5}, "failed": True}, "the run failed"),
        ({"effort": {"seeds": 5}, "part": "only a sample was tried"}, "only a sample was tried"),
    ],
)
def test_a_lesser_run_leaves_the_record(results, capsys, run, reason):
    record(effort={"seeds": 3})
    before = (results / "synth.json").read_bytes()
    capsys.readouterr()
    assert not record(**run)
    assert (results / "synth.json").read_bytes() == before
    assert capsys.readouterr().err == f"not recorded in results/synth.json: {reason}\n"


def test_as_much_or_more_effort_replaces_the_record(results):
    for seeds in (3, 3, 5):
        assert record(effort={"seeds": seeds})
    assert recorded.load("synth")["effort"] == {"seeds": 5}


def test_a_first_run_that_failed_or_is_a_part_is_no_record(results):
    assert not record(failed=True) and not record(part="a part")
    assert recorded.load("synth") is None


def test_outside_a_checkout_the_run_does_not_begin(monkeypatch):
    monkeypatch.setattr(recorded, "IN_CHECKOUT", False)
    recorded.check(False)
    with pytest.raises(InputError, match="--record writes into results/ of a checkout"):
        recorded.check(True)


# -- the commands ----------------------------------------------------------------------------------

REPORT = {
    "config": "default", "device": "chip", "grade": 6, "tools": {"numpy": "1"},
    "resources": {"lut": 1, "carry": 2, "lut_ram": 3, "ff": 4, "dsp": 5, "ebr": 6, "lut_sites": 7},
    "fmax_mhz": {"median": 1, "best": 2, "worst": 1}, "limit_mhz": 3, "limit_by": "block RAM",
    "fmax_reported_mhz": {"median": 1, "best": 2, "worst": 1}, "pixels_per_s": 1e6,
    "frames_per_s": {"640x480": 3.0},
    "seeds": [{"fmax_mhz": 1, "critical_path": {
        "from": {"module": "rom"}, "to": {"module": "ram"}, "delay_ns": 4}}],
}  # fmt: skip


def test_synth_records_configurations_with_more_built_in_side_by_side(results, monkeypatch):
    monkeypatch.setattr(
        synth.ecp5, "run",
        lambda config, *given: REPORT | {"config": config.name, "seeds": REPORT["seeds"] * 3},
    )  # fmt: skip
    for name in ("quadratic_normals", "hold_unlit"):
        assert main.main(["synth", f"--config={name}", "--seeds=3", "--record"]) == 0
    assert [path.name for path in results.iterdir()] == ["synth-more.json"]
    kept = recorded.figures("synth-more")["configurations"]
    assert list(kept) == ["quadratic_normals", "hold_unlit"]
    assert kept["hold_unlit"]["resources"] == REPORT["resources"]


def test_a_count_of_a_build_does_not_replace_its_clock(results, monkeypatch, capsys):
    monkeypatch.setattr(synth.ecp5, "run", lambda config, *given: REPORT | {"config": config.name})
    monkeypatch.setattr(synth.ecp5, "synthesize", lambda *given: REPORT)
    monkeypatch.setattr(synth.ecp5, "versions", lambda: REPORT["tools"])
    monkeypatch.setattr(synth.ecp5, "FOLDER", results.parent / "synth")
    command = ["synth", "--config=lights_8", "--record"]
    assert main.main([*command, "--seeds=0"]) == 0
    assert recorded.figures("synth-more")["configurations"]["lights_8"]["clock_mhz"] is None
    assert main.main([*command, "--seeds=1"]) == 0
    routed = (results / "synth-more.json").read_bytes()
    assert main.main([*command, "--seeds=0"]) == 0
    assert (results / "synth-more.json").read_bytes() == routed
    assert "0 seeds, and the record has 1 of lights_8" in capsys.readouterr().err


def test_synth_records_the_default_configuration_with_as_many_seeds(results, monkeypatch, capsys):
    monkeypatch.setattr(
        synth.ecp5, "run", lambda *given: REPORT | {"seeds": REPORT["seeds"] * len(given[2])}
    )
    assert main.main(["synth", "--seeds=5"]) == 0
    assert not list(results.iterdir()), "nothing is written unless that is asked for"
    assert main.main(["synth", "--seeds=5", "--record"]) == 0
    before = (results / "synth-grade6.json").read_bytes()
    for arguments, reason in (
        (["--seeds=3"], "3 seeds, and the record has 5"),
        (["--seeds=5", "--config=flat"], "flat is not the default configuration"),
    ):
        capsys.readouterr()
        assert main.main(["synth", "--record", *arguments]) == 0
        assert f"not recorded in results/synth-grade6.json: {reason}" in capsys.readouterr().err
        assert (results / "synth-grade6.json").read_bytes() == before


@pytest.mark.parametrize("names", [["fifo"], []])
def test_some_of_the_proofs_are_no_record(results, monkeypatch, tmp_path_factory, names, capsys):
    monkeypatch.setattr(formal, "BUILD", tmp_path_factory.mktemp("build"))
    monkeypatch.setattr(formal.console, "require", lambda *_: None)

    def prove(proof):
        result = dict.fromkeys(("claim", "size", "mode"), "") | {"proof": proof.name, "seconds": 1}
        return result | {"status": "pass", "broken_designs": 1, "broken_designs_failed": 1}, []

    monkeypatch.setattr(formal, "prove", prove)
    monkeypatch.setattr(recorded.importlib.metadata, "version", lambda name: "1")
    assert main.main(["formal", *names, "--record"]) == 0
    assert (results / "formal.json").is_file() == (not names)
    if names:
        assert f": 1 of {len(formal.PROOFS)} proofs were run" in capsys.readouterr().err


def test_a_sweep_with_a_wrong_pixel_is_no_record(results, monkeypatch):
    monkeypatch.setattr(sweep, "run", lambda *_: [])
    monkeypatch.setattr(sweep, "finish", lambda rows: None)
    monkeypatch.setattr(sweep, "failures", lambda rows: ["a pixel differs"])
    assert sweep.main(area=False, route=set(), record=True) == 1
    assert not list(results.iterdir())
    monkeypatch.setattr(sweep, "failures", lambda rows: [])
    assert sweep.main(area=False, route=set(), record=False) == 0
    assert not list(results.iterdir())
    assert sweep.main(area=False, route=set(), record=True) == 0
    assert [path.name for path in results.iterdir()] == ["sweep.json"]


def test_a_pixel_that_differs_in_a_study_is_exit_code_1(monkeypatch, capsys):
    def differs(*_):
        raise MismatchError("sphere, phong: RTL and model differ")

    monkeypatch.setattr(benchmark, "main", differs)
    assert main.main(["bench"]) == console.FAILED == 1
    assert capsys.readouterr().err == "FAILED: sphere, phong: RTL and model differ\n"


def test_nothing_writes_a_record_by_itself():
    """`save` does not ask; all but the clocks of place and route go through `record`."""
    for folder in ("scripts", "tests/campaigns"):
        for file in (PACKAGE / folder).rglob("*.py"):
            if file.name not in ("clocks.py", "recorded.py"):
                assert "recorded.save" not in file.read_text(), file
    text = (PACKAGE / "scripts/studies/sweep.py").read_text()
    assert re.search(r"if record and .*\n *clocks\.keep\(", text)


def test_the_records_are_well_formed():
    for path in recorded.FOLDER.glob("*.json"):
        found = json.loads(path.read_text())
        assert all(type(count) is int for count in found.get("effort", {}).values()), path.name
