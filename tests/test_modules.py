"""Runs the cocotb testbench of every RTL module; a failure says what differs and where."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest

from sim.build import Bench
from sim.units import bench_source

SEED = 75
DATAPATH = (
    "inverse_sqrt", "normalizer", "reflection", "specular_power", "specular_weight",
    "shading_unit",
)  # fmt: skip


def outcome(results, folder) -> list[str]:
    """The failures that cocotb wrote to `results`, each as one line; raises if no test ran."""
    cases = ET.parse(results).getroot().findall(".//testcase")
    assert cases, f"no cocotb test ran; see {folder / 'sim.log'}"
    failed = [case for case in cases if case.find("failure") is not None]
    said = re.findall(r"AssertionError: (.*)", (folder / "sim.log").read_text())
    return [case.get("name") for case in failed] + (said if failed else [])


def run(bench: Bench, module: str, tests: str, folder) -> None:
    """Run the cocotb tests `tests` of `module` in `bench`."""
    results = bench.run(
        tests, folder, plusargs=[f"+dir={folder}"], seed=SEED,
        extra_env={
            "PHONG_MODULE": module, "PHONG_VECTORS": str(folder), "PHONG_SEED": str(SEED)
        },
    )  # fmt: skip
    failures = outcome(results, folder)
    if failures:
        pytest.fail("\n".join(failures), pytrace=False)


@pytest.mark.parametrize("module", DATAPATH)
def test_datapath(module, tmp_path):
    top, text = bench_source(module)
    run(Bench(top, sources={f"{top}.v": text}), module, "tests.modules.datapath", tmp_path)
