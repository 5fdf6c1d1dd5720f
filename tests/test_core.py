# SPDX-License-Identifier: MIT
"""The file lists that other tools read: rtl/phong75.f, rtl/phong75_ecp5.f and phong75.core."""

import re
import shutil

import pytest

import phong75
from phong75.sim import build, design
from phong75.sim.build import BuildError, run_tool

CORE = design.PACKAGE / "phong75.core"
LIST, ECP5_LIST = design.RTL / "phong75.f", design.RTL / "phong75_ecp5.f"


def listed(path):
    """The Verilog files of a file list."""
    lines = (line.partition("//")[0].strip() for line in path.read_text().splitlines())
    return [design.RTL / line for line in lines if line.endswith(".v")]


def filesets():
    """{fileset of phong75.core: its files}."""
    section = re.search(r"^filesets:\n(.*?)^targets:", CORE.read_text(), re.DOTALL | re.MULTILINE)
    found = {}
    for line in section[1].splitlines():
        if match := re.match(r"^  (\w+):$", line):
            found[match[1]] = files = []
        elif match := re.match(r"^      - (\S+?)(:|$)", line):
            files.append(design.PACKAGE / match[1])
    return found


def test_lists_hold_every_file_once():
    folders = [folder for folder in design.RTL.iterdir() if folder.is_dir()]
    there = {file for folder in (design.RTL, *folders) for file in folder.glob("*.v")}
    generic = {file for file in there if file.parent != design.ECP5}
    for path, want in (
        (LIST, generic),
        (ECP5_LIST, set(design.sources(technology=design.ECP5))),
    ):
        files = listed(path)
        assert len(files) == len(set(files)) and set(files) == want, path
    assert design.sources() == listed(LIST)


def test_core_holds_the_files_of_the_lists():
    sets = filesets()
    parts = [sets["rtl"], sets["generic"], sets["ecp5"]]
    assert all(len(files) == len(set(files)) for files in parts)
    assert set(parts[0] + parts[1]) == set(listed(LIST))
    assert set(parts[0] + parts[2]) == set(listed(ECP5_LIST))
    assert not set(parts[1]) & set(parts[0])
    included = {*design.headers(), design.RTL / "include" / "phong_config.vh"}
    assert set(sets["headers"]) == included
    missing = [file for files in sets.values() for file in files if not file.is_file()]
    assert not missing


def test_core_has_the_version_of_the_package():
    name = re.search(r"^name: (\S+)$", CORE.read_text(), re.MULTILINE)[1]
    assert name == f"phong75:graphics:phong75:{phong75.__version__}"


def lint(options):
    """Verilator's complaints, all warnings on, about the design that `options` give."""
    # A parameter may serve other configurations only.
    run_tool(["verilator", "--lint-only", "-Wall", "-Wno-UNUSEDPARAM", "--no-timing",
              "--top-module", design.TOP, design.SIM / "lint.vlt", *options])  # fmt: skip


def test_verilator_reads_the_lists_without_a_complaint(tmp_path):
    lint(["-F", LIST])
    lint(["-F", ECP5_LIST, *sorted((design.SIM / "ecp5").glob("*.v"))])
    shutil.copytree(design.RTL, tmp_path / "rtl")
    walker = tmp_path / "rtl" / "core" / "span_walker.v"
    walker.write_text(walker.read_text().replace("remaining == 2;", "remaining == 2'd2;", 1))
    with pytest.raises(BuildError, match="WIDTH"):
        lint(["-F", tmp_path / "rtl" / "phong75.f"])


def test_icarus_reads_the_list():
    """Where Icarus is installed; a Debian package, which the tests do without."""
    for path in [LIST] if shutil.which("iverilog") else []:
        run_tool(["iverilog", "-g2005", "-t", "null", "-s", design.TOP, "-c", path.name],
                 cwd=path.parent)  # fmt: skip


def test_testbench_of_the_core_lints():
    testbench = design.SIM / "testbench" / "testbench.v"
    build.run_tool(["verilator", "--lint-only", "--timing", "-Wall", "-Wno-UNUSEDPARAM",
                    "--top-module", "testbench", design.SIM / "lint.vlt", "-F", LIST,
                    testbench])  # fmt: skip
