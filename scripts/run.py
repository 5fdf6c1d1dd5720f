# SPDX-License-Identifier: MIT
"""Render one frame through the RTL and the model, compare them, and report: `phong75 run`.

Exit code: 0 if all is good; 1 if a pixel differs, or the cycle budget or the error bound is
missed; 2 if the input or the set-up is wrong, with one line on stderr that says what.
"""

from __future__ import annotations

import dataclasses
import fcntl
import json
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from phong75.model import spans, twin
from phong75.model.analysis import (
    error_budget,
    metrics,
    pictures,
    pruning,
    run_report,
    undecided,
)
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import ExactFrame, Frame, InputError, fitted
from phong75.model.front.mesh_files.report import MeshReport
from phong75.model.front.scene import load_scene
from phong75.model.front.scene_to_spans import FrontEnd
from phong75.model.scene_to_frame import front_end
from phong75.scripts import console, options
from phong75.scripts.console import Steps
from phong75.scripts.run_table import table
from phong75.sim.frame import run_frame
from phong75.sim.frame.locate import locatable, locate
from phong75.sim.frame.run_frame import SimResult

#: As `sim.frame.run_frame.simulate`: span file, frame, configuration, and what to call with the
#: name of each phase.
Simulate = Callable[[Path, Frame, Config, Callable[[str], None]], SimResult]

FILES = ("frame.png", "reference.png", "error.png", "spans", "report.json")


@dataclass(frozen=True)
class RunRequest:
    """What to run: a scene (`size` None for its own) or, where `spans` is set, a span file,
    with the hardware of `config`, and the lights that it has on `units` shading units.

    prune: "" for the full design, "self" for what is pruned to this scene, else the name or path
    of a scene: what is pruned to that one at the same size. clock_hz in hertz; fps in frames a
    second; out: folder of the results.
    """

    config: Config
    scene: str
    spans: Path | None
    size: tuple[int, int] | None
    fps: float
    clock_hz: float
    out: Path
    prune: str = ""
    units: int = 1


def request(
    scene: str = "teapot", spans: Path | None = None, size: tuple[int, int] | None = None,
    config: Config = DEFAULT, fps: float = 30, clock_mhz: float = 200, prune: str = "",
    out: Path | None = None, units: int = 1,
) -> RunRequest:  # fmt: skip
    """The request with its defaults: results go to build/<scene>-<configuration>."""
    suffix = "" if config == DEFAULT else f"-{config.name}"
    return RunRequest(
        config=config,
        scene=scene,
        spans=spans,
        size=size,
        fps=fps,
        clock_hz=options.whole(clock_mhz * 1e6),
        out=out or Path("build", Path(spans or scene).stem + suffix),
        prune=options.prune_scene(prune),
        units=units,
    )


@dataclass(frozen=True)
class Stimulus:
    """What the front end leaves: the frame, its file, the full configuration with the lights of the
    frame, and the configuration to build for it.

    exact: the scene before any rounding; None where there is no scene behind the spans. notes: what
    was assumed about the scene, and what the tables do not hold of it, a line each. full: the
    configuration of the request, with what the frame needs beyond it; built: what is left of it
    after pruning. meshes: what was decided about each object of the scene, by its name. front: what
    the front end found besides; None where there is no scene.
    """

    frame: Frame
    exact: ExactFrame | None
    notes: list[str]
    full: Config
    built: Config
    path: Path
    meshes: list[tuple[str, MeshReport]]
    front: FrontEnd | None


@dataclass(frozen=True)
class Ideal:
    """The reference: 255 S in float64, float64[n, 3], of the integers at the ports, and of the
    scene before any rounding where there is one; and the bound of the error in LSB, or None.

    undecided: pixels at a jump, whose reference is the side that is nearer to the code (see
    `model.analysis.undecided`)."""

    ports: np.ndarray
    scene: np.ndarray | None
    bound: float | None
    undecided: int


# -- the stages of a run ---------------------------------------------------------------------------


def _front_end(request: RunRequest, folder: Path, steps: Steps) -> Stimulus:
    """Scene or span file to a frame. Raises InputError."""
    config = request.config
    with steps.step("front_end") as step:
        if request.spans:
            written_for = spans.written_for(request.spans, config)
            frame, exact = spans.read_spans(request.spans, written_for), None
            notes: list[str] = []
            meshes, front = [], None
        else:
            scene = load_scene(request.scene, request.size, config)
            front = front_end(scene, config, step.done)
            frame, exact = front.frame, front.exact
            meshes = [(item.name, item.report) for item in scene.objects if item.report]
            notes = scene.remarks + front.notes
        config = fitted(config, frame, request.units)
        built = _built(request, frame, config)
        if built.values != config.values and (reasons := pruning.missing(frame, built, config)):
            raise InputError(f"its spans have no place for this scene: {reasons[0]}")
        if reason := error_budget.refusal(frame, built):
            raise InputError(reason)
        path = folder / "spans"
        spans.write_spans(path, frame, built)
    return Stimulus(frame, exact, notes, config, built, path, meshes, front)


def _built(request: RunRequest, frame: Frame, config: Config) -> Config:
    """The part of `config` to build for `request`, whose frame is `frame`.

    Raises InputError if the scene to prune for has other lights than `frame`.
    """
    if not request.prune:
        return config
    if request.prune != options.SELF:
        scene = load_scene(request.prune, (frame.width, frame.height), config)
        frame = front_end(scene, config).frame
        if not config.sums_lights and fitted(config, frame) != config:
            raise InputError(f"--prune {request.prune}: it has other lights than what is run")
    return pruning.prune(frame, config)[0]


def _twin(stimulus: Stimulus, steps: Steps) -> tuple[twin.Pixels, int]:
    """The model's pixels by the full design, and in how many the pruned design's model differs."""
    config = stimulus.full
    with steps.step("model") as step:
        expected = twin.render(stimulus.frame, config, step.done)
        if stimulus.built == config:
            return expected, 0
        pruned = twin.render(stimulus.frame, stimulus.built)
        return expected, metrics.compare(expected, pruned).mismatches


def _simulation(stimulus: Stimulus, simulate: Simulate, steps: Steps) -> SimResult:
    """The frame through the RTL. Raises BuildError, SimulationError."""
    with steps.step("simulation", "") as step:
        result = simulate(stimulus.path, stimulus.frame, stimulus.built, step.phase)
    steps.wall_s |= {"build": result.build_s, "simulate": result.simulate_s}
    return result


def _reference(stimulus: Stimulus, simulation: SimResult, steps: Steps) -> Ideal:
    """The frame in float64, and how far from it a code may be."""
    frame, exact, config = stimulus.frame, stimulus.exact, stimulus.full
    codes = simulation.pixels.rgb
    with steps.step("reference"):
        ports = undecided.nearest(codes, frame, config)
        scene = undecided.nearest(codes, frame, config, exact).ideal if exact else None
        return Ideal(ports.ideal, scene, error_budget.bound_lsb(frame, config), ports.undecided)


def _report(
    request: RunRequest, stimulus: Stimulus, comparison: metrics.Comparison, pruned_differ: int,
    simulation: SimResult, ideal: Ideal, steps: Steps,
) -> dict:  # fmt: skip
    """The contents of report.json."""
    codes, ports = _common(simulation, ideal.ports)
    front, scene_error = stimulus.front, None
    if ideal.scene is not None:
        scene_error = metrics.error_metrics(*_common(simulation, ideal.scene), request.config.white)
    return run_report.make_report(
        scene=Path(request.spans or request.scene).stem,
        frame=stimulus.frame,
        config=stimulus.built,
        fps=request.fps,
        clock_hz=request.clock_hz,
        simulation=simulation,
        comparison=comparison,
        zero_normals=twin.zero_normals(stimulus.frame, stimulus.full),
        error=metrics.error_metrics(codes, ports, request.config.white),
        undecided=ideal.undecided,
        notes=stimulus.notes,
        bound_lsb=None if ideal.bound is None else float(ideal.bound),
        pruned_differ=pruned_differ,
        input_error=scene_error,
        degenerate_triangles=front.degenerate_triangles if front else 0,
        mesh=[{"object": name} | dataclasses.asdict(mesh) for name, mesh in stimulus.meshes],
        lit_facing_away=front.lit_facing_away if front else None,
        empty=front.empty if front else None,
        wall_s={
            name: round(steps.wall_s[name], 3)
            for name in ("front_end", "model", "reference", "build", "simulate")
        },
    )


def _common(simulation: SimResult, ideal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Codes and `ideal` of the pixels that both have: a broken stream may be shorter or longer."""
    both = min(len(ideal), len(simulation.pixels.rgb))
    return simulation.pixels.rgb[:both], ideal[:both]


def _pictures(
    folder: Path, name: str, stimulus: Stimulus, expected: twin.Pixels, simulation: SimResult,
    ideal: Ideal, steps: Steps,
) -> None:  # fmt: skip
    """Write the picture of the RTL, that of the reference, and the map of the error, which shows
    `name`."""
    frame, config = stimulus.frame, stimulus.full
    with steps.step("pictures"):
        x, y = simulation.pixels.x, simulation.pixels.y
        frame_picture = pictures.canvas(frame, x, y, simulation.pixels.rgb, config)
        pictures.write_picture(folder / "frame.png", frame_picture, config)
        rounded = metrics.rounded(ideal.ports)
        reference_picture = pictures.canvas(frame, expected.x, expected.y, rounded, config)
        pictures.write_picture(folder / "reference.png", reference_picture, config)
        codes, ports = _common(simulation, ideal.ports)
        error = np.abs(codes - ports)
        both = len(error)
        pictures.write_error_map(
            folder / "error.png",
            frame,
            x[:both],
            y[:both],
            error,
            ideal.bound,
            name=name,
        )


def run(request: RunRequest, simulate: Simulate, steps: Steps) -> dict:
    """Do `request` and write its FILES; returns the report. simulate: `run_frame.simulate`.

    Raises InputError if the input is wrong, or `request.out` no folder to write to or in use by
    another run; OSError if a file cannot be written; BuildError or SimulationError if the
    simulator does not work.
    """
    with results_folder(request.out) as folder:
        stimulus = _front_end(request, folder, steps)
        expected, pruned_differ = _twin(stimulus, steps)
        simulation = _simulation(stimulus, simulate, steps)
        ideal = _reference(stimulus, simulation, steps)
        comparison = metrics.compare(expected, simulation.pixels)
        report = _report(request, stimulus, comparison, pruned_differ, simulation, ideal, steps)
        name = f"{report['scene']}, {report['technique']}"
        _pictures(folder, name, stimulus, expected, simulation, ideal, steps)
        text = json.dumps(report, indent=2, allow_nan=False) + "\n"
        (folder / "report.json").write_text(text, encoding="utf-8")
        if stimulus.full != request.config:
            asked, full = request.config.name, stimulus.full.name
            console.note(f"the scene needs more than {asked} has: {full} is built")
        _explain(stimulus, comparison)
    return report


def _explain(stimulus: Stimulus, comparison: metrics.Comparison) -> None:
    """Say why pixels differ: what the build leaves out, and the first place in the stream."""
    config = stimulus.full
    for reason in pruning.missing(stimulus.frame, stimulus.built, config):
        console.note(f"left out, but needed: {reason}")
    if comparison.first:
        console.note(first_difference(comparison.first))
        whole = stimulus.built == config and locatable(config)
        if comparison.first.expected and whole:
            console.note(locate(stimulus.frame, comparison.first.index, config))


def first_difference(first: metrics.Mismatch) -> str:
    """A line that says where two streams part."""

    def show(pixel):
        if pixel is None:
            return "no pixel"
        x, y, *rgb, last = pixel
        return f"x {x}, y {y}, rgb {rgb}, {'last' if last else 'not last'}"

    return (
        f"first difference at pixel {first.index} of the stream: "
        f"model {show(first.expected)}; RTL {show(first.got)}"
    )


# -- the folder of the results ---------------------------------------------------------------------


@contextmanager
def results_folder(out: Path) -> Iterator[Path]:
    """A folder whose files move into `out` once the body is through; else `out` stays as it was.

    Raises InputError if `out` cannot be a folder to write to, or if another run writes to it.
    """
    created = not out.exists()
    try:
        with _locked(out), tempfile.TemporaryDirectory(dir=out, prefix=".partial-") as name:
            yield Path(name)
            for file in sorted(Path(name).iterdir()):
                os.replace(file, out / file.name)
    except BaseException:
        if created:
            with suppress(OSError):  # not empty: keep what is there
                out.rmdir()
        raise


@contextmanager
def _locked(out: Path) -> Iterator[None]:
    """Make the folder `out`, and keep other runs out of it meanwhile.

    Raises InputError if `out` cannot be made or written to, or if another run is in it. The lock
    goes with the process, however that ends.
    """
    path = out / ".lock"
    held = False
    while not held:
        try:
            out.mkdir(parents=True, exist_ok=True)
            lock = open(path, "w")
        except OSError as error:
            raise InputError(f"cannot write to --out {out}: {error.strerror}") from None
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            held = os.path.samestat(os.fstat(lock.fileno()), path.stat())
        except BlockingIOError:
            lock.close()
            raise InputError(
                f"another run writes to --out {out}: wait for it, or name another folder"
            ) from None
        except FileNotFoundError:  # its last holder removed the file after we had opened it
            lock.close()
    with lock:
        try:
            yield
        finally:
            path.unlink(missing_ok=True)


def mesh_lines(report: dict) -> list[str]:
    """What was decided about the meshes of the scene, and why there is no picture, a line each."""
    lines = []
    for mesh in report["mesh"]:
        fields = {key: value for key, value in mesh.items() if key != "object"}
        lines += [f"{mesh['object']}: {line}" for line in MeshReport(**fields).lines()]
    return lines + ([report["empty"]] if report["empty"] else [])


def main(request: RunRequest) -> int:
    """Run `request`, print what came of it; returns the exit code. Raises as `run`."""
    report = run(request, run_frame.simulate, Steps())
    for note in report["notes"]:
        console.note(note)
    console.show(table(report))
    for line in mesh_lines(report):
        console.say(line)
    console.say(f"{request.out}: {' '.join(FILES)}")
    failures = run_report.failures(report)
    for line in failures:
        console.failure(line)
    return console.FAILED if failures else console.GOOD
