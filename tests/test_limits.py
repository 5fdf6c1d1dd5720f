# SPDX-License-Identifier: MIT
"""Limits in processor time end what computes too long, and nothing that only waits."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from phong75.sim.limits import cpu_seconds, run_limited

#: A program that starts a child which computes for ever, and waits for it.
SPIN = """
import subprocess, sys
child = subprocess.Popen([sys.executable, "-c", "while True: pass"], process_group=0)
print(child.pid, flush=True)
child.wait()
"""


def test_a_tool_that_ends_keeps_status_and_output():
    done = run_limited([sys.executable, "-c", "import sys; print('x'); sys.exit(3)"], 100)
    assert (done.status, done.output, done.out_of_time) == (3, "x\n", False)


def test_the_time_of_descendants_counts_and_all_of_them_end():
    done = run_limited([sys.executable, "-c", SPIN], 0.5)
    assert done.out_of_time and done.status == -signal.SIGKILL
    stat = Path("/proc", done.output.strip(), "stat")
    assert not stat.exists() or stat.read_text().rpartition(")")[2].split()[0] in "XZ"


def test_waiting_does_not_count():
    """A second and more of wall time, next to no processor time."""
    done = run_limited([sys.executable, "-c", "import time; time.sleep(1.2)"], 1.0)
    assert done.status == 0 and not done.out_of_time and done.seconds > 1


def test_a_program_that_is_missing():
    with pytest.raises(FileNotFoundError):
        run_limited(["no-such-program"], 1)


@pytest.mark.parametrize(("limit", "expired"), [(0.3, True), (100, False)])
def test_a_watch_ends_what_its_session_computes(limit, expired):
    """In a process of its own, since a watch counts all of a session."""
    program = f"""
import os, signal, subprocess, sys
from phong75.sim.limits import Watch
os.setsid()
signal.signal(signal.SIGUSR1, lambda *_: None)
code = "import time; begin = time.process_time()\\nwhile time.process_time() < 2: pass"
with Watch({limit}, lambda: os.killpg(0, signal.SIGUSR1)) as watch:
    done = subprocess.run([sys.executable, "-c", code])
print(watch.expired, done.returncode == -signal.SIGUSR1)
"""
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.stdout == f"{expired} {expired}\n", done.stderr


def test_the_time_of_this_session_rises():
    before = cpu_seconds(os.getsid(0))
    sum(k * k for k in range(10**6))
    assert cpu_seconds(os.getsid(0)) >= before >= 0
