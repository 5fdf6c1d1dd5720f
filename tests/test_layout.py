# SPDX-License-Identifier: MIT
"""The layout of the model: a twin file for every RTL file, and the layers between modules."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

import phong75
from phong75 import model
from phong75.model.twin import NO_TWIN
from phong75.sim import design
from phong75.sim.design import PACKAGE

TWIN = PACKAGE / "model" / "twin"
SOURCES = {file.stem: file.relative_to(design.RTL) for file in design.sources()}
TWINS = {
    file.stem: file.relative_to(TWIN) for file in TWIN.rglob("*.py") if file.name != "__init__.py"
}


@pytest.mark.parametrize("module", SOURCES)
def test_a_module_has_its_twin_in_the_same_folder_or_a_reason(module):
    assert (module in TWINS) != (module in NO_TWIN), module
    if module in TWINS:
        assert TWINS[module] == SOURCES[module].with_suffix(".py")
    else:
        assert len(NO_TWIN[module]) > 20


def test_there_is_no_twin_and_no_reason_without_a_module():
    assert set(TWINS) | set(NO_TWIN) == set(SOURCES)


@pytest.mark.parametrize("module", TWINS)
def test_a_twin_names_its_file_and_has_a_function_of_its_name(module):
    text = (TWIN / TWINS[module]).read_text()
    tree = ast.parse(text)
    assert ast.get_docstring(tree).startswith(f"Twin of rtl/{SOURCES[module]}: ")
    name = "render" if module == design.TOP else module
    functions = [node for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert name in [function.name for function in functions]
    assert all(ast.get_docstring(function) for function in functions)


def test_the_twin_makes_no_real_numbers():
    """`frexp` in leading_zeros is exact for words of up to 53 bits. The part done, which `progress`
    gets, is no result."""
    for module, file in TWINS.items():
        tree = ast.parse((TWIN / file).read_text())
        calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
        aside = {
            id(inner)
            for call in calls
            if getattr(call.func, "id", "") == "progress"
            for inner in ast.walk(call)
        }
        for node in ast.walk(tree):
            real = isinstance(node, ast.Constant) and isinstance(node.value, float)
            real |= isinstance(node, ast.BinOp | ast.AugAssign) and isinstance(node.op, ast.Div)
            real |= isinstance(node, ast.Attribute) and node.attr.startswith("float")
            assert not real or id(node) in aside or module == "leading_zeros", (
                f"{file}:{node.lineno}"
            )


def test_the_package_names_no_test_in_a_string():
    """import-linter finds imports only. A docstring may name a test file."""
    for folder in ("model", "sim", "scripts"):
        for file in sorted((PACKAGE / folder).rglob("*.py")):
            for line in file.read_text().splitlines():
                assert not re.search(r"[\"']tests[.]\w", line), f"{file}: {line}"


def lint_imports(package: Path, settings: str) -> str:
    (package / "pyproject.toml").write_text(settings)
    done = subprocess.run(
        [Path(sys.executable).parent / "lint-imports", "--no-cache", "--no-logo"],
        cwd=package, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    return done.stdout if done.returncode else ""


FORBIDDEN = {
    "model/front/camera.py": "from phong75.model.twin import render",
    "model/twin/core/reflection.py": "from phong75.model.analysis import metrics",
    "model/analysis/metrics.py": "from phong75.model.studies import methods",
    "model/config.py": "from phong75.sim import design",
    "sim/design.py": "from phong75.scripts import lint",
    "sim/build.py": "from tests.modules import benches",
}


@pytest.mark.parametrize("file", FORBIDDEN)
def test_the_linter_finds_an_import_against_the_layers(file, tmp_path):
    """Through the links of phong75/, as in the checkout."""
    settings = (PACKAGE / "pyproject.toml").read_text()
    (tmp_path / "phong75").mkdir()
    for source in PACKAGE.glob("phong75/*.py"):
        (tmp_path / "phong75" / source.name).write_text(source.read_text())
    for folder in ("model", "sim", "scripts"):
        (tmp_path / "phong75" / folder).symlink_to(f"../{folder}")
        for source in (PACKAGE / folder).rglob("*.py"):
            copy = tmp_path / source.relative_to(PACKAGE)
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_text(source.read_text())
    assert lint_imports(tmp_path, settings) == ""
    (tmp_path / file).write_text((tmp_path / file).read_text() + FORBIDDEN[file] + "\n")
    assert "BROKEN" in lint_imports(tmp_path, settings)


def test_the_package_offers_what_the_model_does():
    assert set(phong75.__all__) == {*model.__all__, "__version__"}
