# SPDX-License-Identifier: MIT
"""The guide of docs/extending.md, followed step by step on a copy of the tree."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from phong75.sim.design import BUILD, PACKAGE

GUIDE = PACKAGE / "docs" / "extending.md"
COPIED = ("model", "phong75", "results", "rtl", "scripts", "sim", "tests", "pyproject.toml")
_STEP = re.compile(
    r"<!-- guide: (create|append|insert) (\S+?)(?: after \"(.*?)\")? -->\n\n```\w+\n(.*?)```",
    re.DOTALL,
)


def follow(guide: str, tree: Path) -> list[str]:
    """Do in `tree` what the steps of `guide` say; returns the files they name."""
    files = []
    for action, name, line, text in _STEP.findall(guide):
        file = tree / name
        if action == "create":
            assert not file.exists(), name
            file.write_text(text)
        elif action == "append":
            file.write_text(f"{file.read_text()}\n\n{text}")
        else:
            old = file.read_text()
            assert old.count(f"{line}\n") == 1, (name, line)
            file.write_text(old.replace(f"{line}\n", f"{line}\n{text}"))
        files.append(name)
    return files


@pytest.fixture
def tree(tmp_path) -> Path:
    """A copy of what the steps touch and the tests need."""
    for name in COPIED:
        source, target = PACKAGE / name, tmp_path / name
        if source.is_dir():
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(source, target, symlinks=True, ignore=ignored)
        else:
            shutil.copy(source, target)
    return tmp_path


def run_the_tests(tree: Path) -> subprocess.CompletedProcess:
    """What the last step of the guide runs, in `tree`."""
    command = re.search(r"```sh\n\.venv/bin/python (-m pytest .*?)\n```", GUIDE.read_text())[1]
    return subprocess.run(
        [sys.executable, *command.split(), "-n0"], cwd=tree, text=True, capture_output=True,
        env=os.environ | {"PHONG75_BUILD": str(BUILD)},
    )  # fmt: skip


def test_the_guide_adds_a_module(tree):
    files = follow(GUIDE.read_text(), tree)
    named = [file for file in files if not file.startswith("tests/")]
    assert len(named) == 4 and "A module is named in four places" in GUIDE.read_text()
    done = run_the_tests(tree)
    assert done.returncode == 0, done.stdout + done.stderr
    # The test that the guide adds can fail.
    module = tree / "rtl" / "methods" / "mean.v"
    module.write_text(module.read_text().replace("x + y", "x - y"))
    broken = run_the_tests(tree)
    assert broken.returncode == 1 and "module mean, stage mean.half" in broken.stdout
