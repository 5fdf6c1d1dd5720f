# SPDX-License-Identifier: MIT
"""Environment variables: one place has their names, and it says what each is for."""

import re

from phong75.sim import environment
from phong75.sim.design import PACKAGE

FOLDERS = ("model", "scripts", "sim", "tests")
#: Variables of other programs.
FOREIGN = {"PATH", "XDG_CACHE_HOME", "COCOTB_MAX_FAILURES", "MAKEFLAGS", "PYTHONPATH"}


def sources():
    return [file for folder in FOLDERS for file in (PACKAGE / folder).rglob("*.py")]


def test_no_other_file_spells_a_variable():
    names = {value for key, value in vars(environment).items() if key.isupper()}
    assert "PHONG75_BUILD" in names and len(names) > 5
    for file in sources():
        if file.name != "environment.py" and PACKAGE / "tests" not in file.parents:
            for name in names:
                assert f'"{name}"' not in file.read_text(), f"{file}: {name}"


def test_every_variable_that_is_read_is_listed_or_another_programs():
    pattern = re.compile(r"environ(?:\.get\(|\[|\.setdefault\()[\"'](\w+)")
    for file in sources():
        for name in pattern.findall(file.read_text()):
            assert name in FOREIGN, f"{file} reads {name}: it belongs into sim/environment.py"


def test_the_one_for_users_is_in_the_documentation():
    text = (PACKAGE / "docs" / "commands.md").read_text()
    assert environment.BUILD in text
    assert environment.BUILD in environment.__doc__
