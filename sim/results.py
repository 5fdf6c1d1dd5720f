# SPDX-License-Identifier: MIT
"""Results of cocotb tests: reads the XML file and the log that a simulation leaves."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from dataclasses import dataclass
from pathlib import Path

_MESSAGE = re.compile(r"(?:AssertionError|ValueError): (.*)")


@dataclass(frozen=True)
class CocotbResults:
    """Results of one simulation.

    tests: names of the tests that ran. failures: empty if tests ran and all of them passed; else
    the names of the failed tests, then the messages of their exceptions.
    """

    tests: tuple[str, ...]
    failures: tuple[str, ...]


def read_results(folder: Path) -> CocotbResults:
    """The results of a simulation that ran in `folder` (files results.xml and sim.log).

    A missing or broken file counts as a failure: no test ran.
    """
    log = folder / "sim.log"
    try:
        cases = ET.parse(folder / "results.xml").getroot().findall(".//testcase")
    except (OSError, ET.ParseError):
        cases = []
    tests = tuple(case.get("name", "") for case in cases)
    if not tests:
        return CocotbResults((), (f"no cocotb test ran, see {log}",))
    failed = [case.get("name", "") for case in cases if case.find("failure") is not None]
    messages = _MESSAGE.findall(log.read_text()) if failed else []
    return CocotbResults(tests, (*failed, *messages))
