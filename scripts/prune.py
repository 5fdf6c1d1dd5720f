"""What a scene needs of the pipeline, and what the rest costs: `make prune`.

Exit code: 0; 1 if a tool failed; 2 if the input is wrong, with one line on stderr that says what.
"""

from __future__ import annotations

import argparse
import sys

from rich.console import Console
from rich.table import Table

from model.config import DEFAULT, Config
from model.frame import InputError
from model.pruning import Row, prune
from model.scene import load_scene
from model.scene_to_spans import front_end
from scripts.run import Steps, parse_size
from sim.latency import latencies


class _Parser(argparse.ArgumentParser):
    """Reports a wrong command line like any other wrong input."""

    def error(self, message):
        raise InputError(message)


def table(scene: str, rows: list[Row], config: Config) -> Table:
    """`rows` of `scene` as a table for the terminal."""
    before, after = (latencies(c)["pixel"] for c in (DEFAULT, config))
    out = Table(title=f"{scene}: latency {before} -> {after} clocks", title_style="bold")
    for title in ("feature", "needed", "because", "without it go"):
        out.add_column(title)
    for row in rows:
        needed = "yes" if row.needed else "[green]no[/]"
        out.add_row(row.feature, needed, row.why, "" if row.needed else row.saves)
    return out


def main(argv=None) -> int:
    """Run with the command line `argv`; returns the exit code."""
    parser = _Parser(prog="prune", description=__doc__.partition("\n")[0])
    parser.add_argument("--scene", default="teapot", help="bundled scene, scene file or mesh")
    parser.add_argument("--size", default="", help="WIDTHxHEIGHT; default: the scene's own")
    try:
        given = parser.parse_args(argv)
        size = parse_size(given.size, DEFAULT) if given.size else None
        with Steps().step("front_end") as progress:
            frame = front_end(load_scene(given.scene, size), DEFAULT, progress).frame
    except InputError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    config, rows = prune(frame)
    Console().print(table(given.scene, rows, config))
    return 0


if __name__ == "__main__":
    sys.exit(main())
