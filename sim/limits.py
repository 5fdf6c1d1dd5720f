# SPDX-License-Identifier: MIT
"""Limits in processor time for tools that run beside us.

A limit in wall time fails on a busy machine, where nothing is wrong. Here the processor time of a
tool and of all its descendants counts, so that other work on the machine changes nothing. Where
/proc does not exist (it does on Linux) there is no limit.
"""

from __future__ import annotations

import os
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

_TICK = os.sysconf("SC_CLK_TCK")
_POLL_S = 0.25


def _members(session: int) -> Iterator[tuple[int, float]]:
    """Number and processor time in seconds, with that of its ended children, of each process."""
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            # The name, in brackets, may hold anything; the session is the fourth field behind it.
            fields = stat.read_text(errors="replace").rpartition(")")[2].split()
        except OSError:  # it ended meanwhile
            continue
        if int(fields[3]) == session and fields[0] not in "XZ":  # not dead already
            yield int(stat.parent.name), sum(map(int, fields[11:15])) / _TICK


def cpu_seconds(session: int) -> float:
    """Processor time in seconds that the processes of `session` and their ended children took."""
    return sum(seconds for _, seconds in _members(session))


def _end(session: int) -> None:
    """Kill all of `session`, whatever process groups it has, and wait until they are gone."""
    while members := list(_members(session)):
        for process, _ in members:
            with suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        time.sleep(0.01)  # a busy machine takes a moment to end them


@dataclass(frozen=True)
class Finished:
    """How a tool ended: exit `status`, what it wrote (standard output and error together), wall
    `seconds`, and whether it was ended because its processor time was used up."""

    status: int
    output: str
    seconds: float
    out_of_time: bool


def run_limited(
    command: Sequence[str | Path],
    cpu_s: float,
    cwd: Path | None = None,
    env: Mapping[str, str] | None = None,
) -> Finished:
    """Run `command` in a session of its own, and end all of the session after `cpu_s` seconds of
    processor time.

    Its output goes to a file, not through a pipe, so that nothing stays open whatever happens.
    Raises FileNotFoundError if there is no such program.
    """
    begin = time.monotonic()
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(
            [str(word) for word in command], cwd=cwd, env=env, stdin=subprocess.DEVNULL,
            stdout=output, stderr=subprocess.STDOUT, start_new_session=True,
        )  # fmt: skip
        out_of_time = False
        try:
            while True:
                try:
                    process.wait(_POLL_S)
                    break
                except subprocess.TimeoutExpired:
                    if cpu_seconds(process.pid) > cpu_s:
                        out_of_time = True
                        break
        finally:
            if out_of_time or process.poll() is None:
                _end(process.pid)
            if process.poll() is None:
                process.kill()  # where there is no /proc
                process.wait()
        output.seek(0)
        text = output.read().decode(errors="replace")
    return Finished(process.returncode, text, time.monotonic() - begin, out_of_time)


class Watch:
    """A context that calls `end` once this process's session has taken `cpu_s` seconds of
    processor time since it was entered. `expired` says whether it did."""

    def __init__(self, cpu_s: float, end: Callable[[], None]):
        self._cpu_s, self._end = cpu_s, end
        self._left = threading.Event()
        self.expired = False

    def __enter__(self) -> Watch:
        self._start = cpu_seconds(os.getsid(0))
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        return self

    def _run(self) -> None:
        while not self._left.wait(_POLL_S):
            if cpu_seconds(os.getsid(0)) - self._start > self._cpu_s:
                self.expired = True
                self._end()
                return

    def __exit__(self, *_) -> None:
        self._left.set()
        self._thread.join()
