# SPDX-License-Identifier: MIT
"""What the whole suite shares: order, the fast tier, and progress.

results/test-durations.json holds how long each test took when it was recorded (`make test
RECORD=1`). It decides three things: long tests start first, so that no core idles at the end; tests
below FAST_S make up the fast tier (`make check`); and the time left is estimated from it. A test
that is not in the file counts as fast until the next record.
"""

from __future__ import annotations

import importlib.metadata
import json
import sys
import threading
import time
from pathlib import Path

import pytest

from phong75.sim.design import PACKAGE

TESTS = Path(__file__).parent
DURATIONS = PACKAGE / "results" / "test-durations.json"
FAST_S = 0.4
#: Folders of tests that use packages which the main installation does not have.
OPTIONAL = ("hardware", "page", "docs")
PROGRESS_S = 10


def recorded_durations() -> dict[str, float]:
    """{test id: seconds} of the record; empty if there is none."""
    return json.loads(DURATIONS.read_text())["seconds"] if DURATIONS.is_file() else {}


@pytest.fixture(autouse=True)
def main_installation(request, monkeypatch):
    """Tests outside the folders of OPTIONAL find no package of the hardware tools, so that `make
    test-all` fails where `make test` would fail without them."""
    if request.path.relative_to(TESTS).parts[0] in OPTIONAL:
        return
    version = importlib.metadata.version

    def hidden(package: str) -> str:
        if package.startswith("yowasp"):
            raise importlib.metadata.PackageNotFoundError(package)
        return version(package)

    monkeypatch.setattr(importlib.metadata, "version", hidden)


class Progress:
    """Counts tests and prints, every PROGRESS_S seconds, what runs and how long is left."""

    def __init__(self, durations: dict[str, float]):
        self._durations = durations
        self._typical = sorted(durations.values())[len(durations) // 2] if durations else 0.1
        self._lock = threading.Lock()
        self._running: dict[str, float] = {}
        self._weight_done = self._weight_all = 0.0
        self._done = self._all = 0
        self._stop = threading.Event()
        self.seconds: dict[str, float] = {}

    def weight(self, test: str) -> float:
        """The recorded seconds of `test`, or a typical value."""
        return self._durations.get(test, self._typical)

    def begin(self, tests: list[str]) -> None:
        """All of `tests` will run."""
        self._all, self._weight_all = len(tests), sum(map(self.weight, tests))
        self._start = time.monotonic()
        threading.Thread(target=self._tick, daemon=True).start()

    def _tick(self) -> None:
        while not self._stop.wait(PROGRESS_S):
            self._print()

    def _print(self) -> None:
        with self._lock:
            now = time.monotonic()
            elapsed = now - self._start
            # A running test counts for as long as it has run, up to what it took in the record.
            done = self._weight_done + sum(
                min(now - begin, self.weight(test)) for test, begin in self._running.items()
            )
            part = done / self._weight_all if self._weight_all else 1.0
            parts = [f"{self._done} of {self._all} tests", f"{elapsed / 60:.1f} min"]
            if part > 0.02:
                parts.append(f"about {elapsed * max(0, 1 - part) / part / 60:.1f} min left")
            line = ", ".join(parts)
            if running := [test.partition("::")[2] or test for test in self._running]:
                line += f"; running {', '.join(running)}"
            print(line, file=sys.__stderr__, flush=True)

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_logstart(self, nodeid):
        """A test begins."""
        with self._lock:
            self._running[nodeid] = time.monotonic()

    def pytest_runtest_logreport(self, report):
        """A phase of a test ended: set-up, the call itself, or tear-down."""
        with self._lock:
            self.seconds[report.nodeid] = self.seconds.get(report.nodeid, 0.0) + report.duration

    @pytest.hookimpl(trylast=True)
    def pytest_runtest_logfinish(self, nodeid):
        """A test ended."""
        with self._lock:
            if self._running.pop(nodeid, None) is not None:
                self._done += 1
                self._weight_done += self.weight(nodeid)

    def pytest_sessionfinish(self):
        """All ended."""
        self._stop.set()


def pytest_addoption(parser):
    """Options of the suite."""
    parser.addoption("--record-durations", action="store_true", help="write the tests' durations")
    parser.addoption("--progress", action="store_true", help="lines of progress in place of dots")


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """Mark the fast tier, and put long tests first."""
    durations = recorded_durations()
    for item in items:
        if durations.get(item.nodeid, 0.0) < FAST_S:
            item.add_marker("fast")
    items.sort(key=lambda item: -durations.get(item.nodeid, 0.0))


def pytest_configure(config):
    """Register the progress, in the process that reports."""
    config.addinivalue_line("markers", "fast: short when it was recorded; `make check`")
    if hasattr(config, "workerinput") or not config.getoption("--progress"):
        return
    config.stash[_PROGRESS] = progress = Progress(recorded_durations())
    config.pluginmanager.register(progress, "phong75-progress")


_PROGRESS = pytest.StashKey[Progress]()


def pytest_report_teststatus(report, config):
    """No dot for a test that passed, where lines of progress are printed."""
    if report.passed and report.when == "call" and config.getoption("--progress"):
        return "passed", "", "PASSED"
    return None


def pytest_collection_finish(session):
    """Without xdist: these tests will run."""
    _begin(session.config, [item.nodeid for item in session.items])


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_node_collection_finished(node, ids):
    """With xdist: these tests will run, as each worker says."""
    _begin(node.config, list(ids))


def _begin(config, tests: list[str]) -> None:
    progress = config.stash.get(_PROGRESS, None)
    if progress and tests and not config.stash.get(_BEGUN, False):
        config.stash[_BEGUN] = True
        progress.begin(tests)


_BEGUN = pytest.StashKey[bool]()


def pytest_sessionfinish(session, exitstatus):
    """Write the durations, if that was asked for and nothing failed."""
    progress = session.config.stash.get(_PROGRESS, None)
    if progress and session.config.getoption("--record-durations") and exitstatus == 0:
        seconds = recorded_durations() | {t: round(s, 2) for t, s in progress.seconds.items()}
        kept = dict(sorted(seconds.items()))
        DURATIONS.write_text(json.dumps({"seconds": kept}, indent=0, sort_keys=True) + "\n")
