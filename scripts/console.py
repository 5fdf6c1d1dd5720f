# SPDX-License-Identifier: MIT
"""Everything that a command prints, and how a command ends.

Results go to stdout; progress, notes and errors go to stderr. Exit codes: 0; 1 if a pixel differs
or a bound or a budget is missed; 2 if the command line, the input or the set-up is wrong, after
one line that says what; 130 after Ctrl-C.
"""

from __future__ import annotations

import importlib.util
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress
    from rich.table import Table

GOOD, FAILED, WRONG, INTERRUPTED = 0, 1, 2, 130


def say(text: str) -> None:
    """Print a line of results."""
    print(text, flush=True)


def note(text: str) -> None:
    """Print a line that is not a result: what happens now, or what a reader should know."""
    print(text, file=sys.stderr, flush=True)


def phase(text: str) -> None:
    """Print what a phase of some seconds does, before it."""
    note(f"{text} ...")


def error(text: str) -> None:
    """Print one line on what is wrong with the command line, the input or the set-up."""
    note("Error: " + text.replace("\n", " "))


def failure(text: str) -> None:
    """Print one line on a pixel that differs or a bound that is missed."""
    note(f"FAILED: {text}")


def show(*tables: Table) -> None:
    """Print `tables`, as wide as the terminal."""
    from rich.console import Console

    console = Console()
    for table in tables:
        console.print(table)


# -- phases of a command ---------------------------------------------------------------------------


@dataclass
class Step:
    """A step while it lasts: `done` moves its bar, `phase` says what it does now."""

    bar: Progress | None = None
    number: int = 0

    def done(self, part: float) -> None:
        """Show that `part` of the step is done, 0 to 1."""
        if self.bar:
            self.bar.update(self.number, completed=part, total=1.0)

    def phase(self, text: str) -> None:
        """Show what the step does from here on."""
        if self.bar:
            self.bar.update(self.number, description=text, completed=0, total=None)
        elif text:
            phase(text)


@dataclass
class Steps:
    """Shows the steps of a command on stderr while they last, and keeps how long each took."""

    wall_s: dict[str, float] = field(default_factory=dict)  # seconds of each step by name

    @contextmanager
    def step(self, name: str, text: str | None = None) -> Iterator[Step]:
        """Time the body under `name`, and show `text` meanwhile (None: the name; "": nothing
        until `Step.phase` is called)."""
        start = time.perf_counter()
        text = name.replace("_", " ") if text is None else text
        if sys.stderr.isatty():
            from rich.console import Console
            from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

            columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
            with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
                yield Step(bar, bar.add_task(text, total=None))
        else:
            step = Step()
            step.phase(text)
            yield step
        self.wall_s[name] = time.perf_counter() - start


def require(group: str, *modules: str) -> None:
    """Raise InputError with what to install if one of `modules`, which `group` brings, is not
    there."""
    from phong75.model.frame import InputError

    missing = [name for name in modules if importlib.util.find_spec(name) is None]
    if missing:
        raise InputError(
            f"{missing[0]} is not installed: scripts/setup.sh {group}, or pip install "
            f"'phong75[{group}]'"
        )


# -- how a command ends ----------------------------------------------------------------------------


class MismatchError(Exception):
    """A pixel of RTL and model differs where a study needs them the same; the message is a line."""


def exit_code(command: Callable[[], int | None]) -> int:
    """Run `command`; returns the exit code that it returns, or that its exception stands for."""
    try:
        return command() or GOOD
    except KeyboardInterrupt:
        return INTERRUPTED
    except MismatchError as mismatch:
        failure(str(mismatch))
        return FAILED
    except Exception as exception:
        text = message(exception)
        if text is None:
            raise
        error(text)
        return WRONG


def message(exception: Exception) -> str | None:
    """The line that tells a user of `exception`; None if it is not about input or set-up.

    Where a tool said more than a line, the rest goes into a log that the line names.
    """
    from typer import TyperException

    if isinstance(exception, TyperException):
        return " ".join(exception.format_message().split())
    if isinstance(exception, OSError):
        name = exception.filename2 or exception.filename
        return f"{name}: {exception.strerror}" if name else str(exception)
    # Imported here: the command line answers `--help` without the model and the simulator.
    from phong75.model.frame import InputError
    from phong75.scripts.synthesis.ecp5 import SynthesisError
    from phong75.sim import design
    from phong75.sim.build import BuildError
    from phong75.sim.formal.engine import SetupError
    from phong75.sim.frame.run_frame import SimulationError

    if isinstance(exception, InputError | SynthesisError | SetupError):
        return str(exception)
    if not isinstance(exception, BuildError | SimulationError):
        return None
    text = str(exception)
    headline, _, rest = text.partition("\n")
    if not rest.strip():
        return headline
    log: Path = design.BUILD / "failure.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    log.write_text(f"{text}\n")
    return f"{headline.rstrip(':')}; more is in {shown(log)}"


def shown(path: Path) -> str:
    """`path` as a user would type it: relative where that is below the current folder."""
    try:
        return str(path.resolve().relative_to(Path.cwd()))
    except (ValueError, OSError):
        return str(path)
