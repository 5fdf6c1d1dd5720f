# SPDX-License-Identifier: MIT
"""A mesh of many triangles from file to spans: `make mesh-large TRIANGLES=10000000`.

Memory is that of this process and of the reader's process at their largest, added up.

Exit code: 0; 1 if the memory is more than 24 GiB; 2 if the command line is wrong.
"""

from __future__ import annotations

import math
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Annotated

import typer

from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, options, recorded
from phong75.scripts.benchmark import write_torus
from phong75.scripts.main import single

SIZE = (1920, 1080)
MOST_GIB = 24.0


def peak_gib() -> float:
    """Largest memory of this process and of its ended children so far, in GiB."""
    who = resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN
    return sum(resource.getrusage(w).ru_maxrss for w in who) / 2**20


def main(
    triangles: Annotated[
        int,
        typer.Option(
            "--triangles",
            metavar="N",
            help="About how many triangles.",
            parser=lambda text: options.parse_count("--triangles", text, 1000, 50_000_000),
        ),
    ] = 10_000_000,
    record: options.Record = False,
) -> int:
    """Load a large mesh and make its spans at 1920x1080 (minutes)."""
    recorded.check(record)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "torus.stl"
        steps = math.isqrt(triangles // 2)
        console.phase("writing")
        count = write_torus(path, steps, steps)
        console.phase("loading")
        start = time.perf_counter()
        scene = load_scene(path, SIZE)
        loaded = time.perf_counter()
        console.phase("spans")
        frame = front_end(scene).frame
        done = time.perf_counter()
    memory = peak_gib()
    figures = {
        "triangles": count, "load_s": round(loaded - start, 1), "spans_s": round(done - loaded, 1),
        "spans": len(frame.spans), "pixels": int(frame.spans["length"].sum()),
        "memory_gib": round(memory, 1),
    }  # fmt: skip
    console.say(", ".join(f"{name} {value}" for name, value in figures.items()))
    failed = memory > MOST_GIB or not len(frame.spans)
    if record:
        recorded.record(
            "mesh-large", "make mesh-large", ("cmeel-assimp", "numpy"), figures,
            {"triangles": count}, failed=failed,
        )  # fmt: skip
    return console.FAILED if failed else console.GOOD


if __name__ == "__main__":
    sys.exit(single(main, sys.argv[1:], "mesh-large"))
