# SPDX-License-Identifier: MIT
"""Mutated mesh files: `make mesh-fuzz FILES=10000 FOLDER=DIR`.

Each file is one of the tests' examples, or one of the mesh files in FOLDER, with a few bytes
changed. It must be drawn, or refused in one line; whatever the reader of the file does, this
process must neither fail nor hang. Each file is also read twice, with other numbers in the reader's
unused memory: what is read must be the same.

Exit code: 0; 1 if a file was neither; 2 if the command line is wrong.
"""

from __future__ import annotations

import multiprocessing
import os
import sys
import tempfile
import traceback
from functools import partial
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import track

from phong75.model.front.mesh_files.checks import TESTED_SUFFIXES
from phong75.scripts import console, options, recorded
from phong75.scripts.main import single
from tests.mesh_examples import complaint_about, mutated

MOST = 1_000_000

#: Larger files of FOLDER are left out: they would take the time of many small ones.
LARGEST = 200_000


def attempt(more: list[tuple[str, bytes]], seed: int) -> str:
    """What goes wrong with file `seed`; "" if nothing does. more: further files to mutate."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return complaint_about(Path(folder), *mutated(seed, more), twice=True)
        except Exception:
            return "an exception: " + traceback.format_exc().splitlines()[-1]


def main(
    files: Annotated[
        int,
        typer.Option(
            "--files",
            metavar="N",
            help="How many mutated files.",
            parser=lambda text: options.parse_count("--files", text, 0, MOST),
        ),
    ] = 10_000,
    folder: Annotated[Path | None, typer.Option(help="Further files to mutate.")] = None,
    record: options.Record = False,
) -> int:
    """Read and draw mutated mesh files (15 minutes)."""
    recorded.check(record)
    found = sorted(folder.rglob("*")) if folder else []
    more = [
        (path.name, path.read_bytes())
        for path in found
        if path.suffix.lower() in TESTED_SUFFIXES and path.stat().st_size <= LARGEST
    ]
    with multiprocessing.get_context("spawn").Pool(os.cpu_count()) as pool:
        work = pool.imap(partial(attempt, more), range(files), chunksize=20)
        complaints = list(track(work, "files", files, console=Console(stderr=True)))
    failures = [f"file {seed}: {text}" for seed, text in enumerate(complaints) if text]
    for line in failures[:20]:
        console.failure(line)
    console.say(f"{files} files, {len(more)} of {folder or 'no folder'}, {len(failures)} failures")
    if record:
        recorded.record(
            "mesh-fuzz", "make mesh-fuzz", ("cmeel-assimp", "numpy"),
            {"files": files, "further_files": len(more), "failures": len(failures)},
            {"files": files}, failed=bool(failures),
        )  # fmt: skip
    return console.FAILED if failures else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "mesh-fuzz"))
