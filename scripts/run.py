"""Render one frame through the RTL and the model, compare them, and report: `make run`.

Exit code: 0 if all is good; 1 if a pixel differs, or the cycle budget or the error bound is
missed; 2 if the input or the set-up is wrong, with one line on stderr that says what.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import re
import sys
import tempfile
import time
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from phong75.model import spans, twin
from phong75.model.analysis import error_budget, metrics, pictures, pruning, reference, run_report
from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.frame import InputError
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.sim.build import BuildError
from phong75.sim.design import BUILD
from phong75.sim.frame.locate import locate
from phong75.sim.frame.run_frame import SimulationError, simulate


@dataclass(frozen=True)
class Job:
    """What to run: a scene (`size` None for its own) or, where `spans` is set, a span file,
    with the hardware of `config`.

    prune: "" for the full design, "1" for what is pruned to this job, else the name or path of a
    scene: what is pruned to that one at the same size.
    """

    config: Config
    scene: str
    spans: Path | None
    size: tuple[int, int] | None
    fps: float
    clock_hz: float
    out: Path
    prune: str = ""


@dataclass
class Steps:
    """Shows the steps of a run on stderr while they last, and keeps how long each took."""

    console: Console = field(default_factory=lambda: Console(stderr=True))
    wall_s: dict[str, float] = field(default_factory=dict)

    @contextmanager
    def step(self, name: str):
        """Time the body under `name`; gives it a function to call with the part done, 0 to 1."""
        start = time.perf_counter()
        if self.console.is_terminal:
            columns = TextColumn("{task.description:<10}"), BarColumn(), TimeElapsedColumn()
            with Progress(*columns, console=self.console, transient=True) as bar:
                task = bar.add_task(name.replace("_", " "), total=None)
                yield lambda done: bar.update(task, completed=done, total=1.0)
        else:
            print(f"{name.replace('_', ' ')} ...", file=sys.stderr, flush=True)
            yield lambda done: None
        self.wall_s[name] = time.perf_counter() - start


def parse(argv) -> Job:
    """The job that the command line `argv` asks for. Raises InputError."""
    parser = _Parser(prog="run", description=__doc__.partition("\n")[0])
    parser.add_argument("--scene", default="", help="bundled scene, scene file or mesh")
    parser.add_argument("--spans", default="", help="span file to run instead of a scene")
    parser.add_argument("--technique", default="", help="phong, gouraud or flat")
    parser.add_argument("--size", default="", help="WIDTHxHEIGHT; default: the scene's own")
    parser.add_argument("--fps", default="30", help="frames a second to check for")
    parser.add_argument("--clock-mhz", default="200", help="clock of the hardware")
    parser.add_argument(
        "--prune", default="", help="1, or a scene: leave out what it does not need"
    )
    parser.add_argument("--out", default="", help="folder of the results; default: build/<scene>")
    given = parser.parse_args(argv)
    scene, technique = given.scene or "teapot", given.technique or DEFAULT.technique
    if technique not in TECHNIQUES:
        raise InputError(f"TECHNIQUE is `{technique}`, not one of {', '.join(TECHNIQUES)}")
    config = TECHNIQUES[technique]
    suffix = "" if config is DEFAULT else f"-{config.name}"
    fps, clock = _positive("FPS", given.fps), _positive("CLOCK_MHZ", given.clock_mhz)
    return Job(
        config=config,
        scene=scene,
        spans=Path(given.spans) if given.spans else None,
        size=parse_size(given.size, config) if given.size else None,
        fps=fps,
        clock_hz=_whole(clock * 1e6),
        out=Path(given.out or Path("build", Path(given.spans or scene).stem + suffix)),
        prune="" if given.prune == "0" else given.prune,
    )


class _Parser(argparse.ArgumentParser):
    """Reports a wrong command line like any other wrong input."""

    def error(self, message):
        raise InputError(message)


def parse_size(text: str, config: Config) -> tuple[int, int]:
    """(width, height) of a text such as 640x480. Raises InputError."""
    match = re.fullmatch(r"([0-9]{1,9})x([0-9]{1,9})", text)
    if not match:
        raise InputError(f"SIZE is `{text}`, not WIDTHxHEIGHT such as 640x480")
    size = int(match[1]), int(match[2])
    if not all(1 <= side <= config.max_size for side in size):
        raise InputError(f"SIZE is {text}: each side must be from 1 to {config.max_size}")
    return size


def _positive(name, text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 1e-9 <= value <= 1e9:
        raise InputError(f"{name} is `{text}`, not a number from 1e-9 to 1e9")
    return _whole(value)


def _whole(value):
    """`value` as an int where it is one, so that reports say 30 and not 30.0."""
    return int(value) if value == int(value) else value


def run(job: Job, simulate, steps: Steps) -> dict:
    """Do `job` and write its files; returns the report. `simulate`: `sim.run_frame.simulate`.

    Raises InputError if the input is wrong or `job.out` no folder to write to, OSError if a file
    cannot be written, BuildError or SimulationError if the simulator does not work.
    """
    with _results(job.out) as folder:
        return _run(job, simulate, steps, job.config, folder)


def _run(job, simulate, steps, config, folder):
    with steps.step("front_end") as progress:
        if job.spans:
            frame, exact, degenerate = spans.read_spans(job.spans, config), None, 0
        else:
            made = front_end(load_scene(job.scene, job.size, config), config, progress)
            frame, exact, degenerate = made.frame, made.exact, made.degenerate_triangles
        built = _built(job, frame, config)
        if built.values != config.values and (reasons := pruning.missing(frame, built, config)):
            raise InputError(f"its spans have no place for this scene: {reasons[0]}")
        stimulus = folder / "spans"
        spans.write_spans(stimulus, frame, built)
    with steps.step("model") as progress:
        expected = twin.render(frame, config, progress)
        pruned_differ = 0
        if built != config:
            pruned_differ = metrics.compare(expected, twin.render(frame, built)).mismatches
    with steps.step("simulation") as progress:
        simulation = simulate(stimulus, frame, built, progress)
    steps.wall_s |= {"build": simulation.build_s, "simulate": simulation.simulate_s}
    with steps.step("reference"):
        ideal = reference.render(frame, config)
        scene_ideal = reference.render_exact(frame, exact, config) if exact else None
        bound = error_budget.bound_lsb(frame, config)

    comparison = metrics.compare(expected, simulation.pixels)
    # A broken stream may be shorter or longer; what can be set against the reference is.
    both = min(len(ideal), len(simulation.pixels.rgb))
    codes = simulation.pixels.rgb[:both]
    found = run_report.make_report(
        scene=Path(job.spans or job.scene).stem,
        frame=frame,
        config=built,
        fps=job.fps,
        clock_hz=job.clock_hz,
        simulation=simulation,
        comparison=comparison,
        zero_normals=twin.zero_normals(frame, config),
        error=metrics.error_metrics(codes, ideal[:both]),
        bound_lsb=float(bound),
        pruned_differ=pruned_differ,
        input_error=metrics.error_metrics(codes, scene_ideal[:both]) if exact else None,
        degenerate_triangles=degenerate,
        wall_s={
            name: round(steps.wall_s[name], 3)
            for name in ("front_end", "model", "reference", "build", "simulate")
        },
    )
    with steps.step("pictures"):
        x, y = simulation.pixels.x, simulation.pixels.y
        shown = pictures.canvas(frame, x, y, simulation.pixels.rgb)
        pictures.write_picture(folder / "frame.png", shown)
        shown = pictures.canvas(frame, expected.x, expected.y, metrics.rounded(ideal))
        pictures.write_picture(folder / "reference.png", shown)
        error = np.abs(codes - ideal[:both])
        pictures.write_error_map(folder / "error.png", frame, x[:both], y[:both], error, bound)
    text = json.dumps(found, indent=2, allow_nan=False) + "\n"
    (folder / "report.json").write_text(text, encoding="utf-8")
    for reason in pruning.missing(frame, built, config):
        print(f"left out, but needed: {reason}", file=sys.stderr)
    if comparison.first:
        print(_where(comparison.first), file=sys.stderr)
        if comparison.first.expected and built == config:
            print(locate(frame, comparison.first.index, config), file=sys.stderr)
    return found


def _built(job: Job, frame, config: Config) -> Config:
    """The configuration to build for `job`, whose frame is `frame`."""
    if not job.prune:
        return config
    if job.prune != "1":
        scene = load_scene(job.prune, (frame.width, frame.height), config)
        frame = front_end(scene, config).frame
    return pruning.prune(frame, config)[0]


@contextmanager
def _results(out: Path):
    """A folder whose files move into `out` once the body is through; else `out` stays as it was.

    Raises InputError if `out` cannot be a folder to write to.
    """
    made = not out.exists()
    try:
        out.mkdir(parents=True, exist_ok=True)
        partial = tempfile.TemporaryDirectory(dir=out, prefix=".partial-")
    except OSError as error:
        raise InputError(f"cannot write to OUT {out}: {error.strerror}") from None
    try:
        with partial as name:
            yield Path(name)
            for file in sorted(Path(name).iterdir()):
                os.replace(file, out / file.name)
    except BaseException:
        if made:
            with suppress(OSError):  # not empty: keep what is there
                out.rmdir()
        raise


def _where(first: metrics.Mismatch) -> str:
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


def main(argv=None, simulate=simulate) -> int:
    """Run the command line `argv`; returns the exit code. `simulate` may stand in for the RTL."""
    try:
        job = parse(argv)
        found = run(job, simulate, Steps())
    except InputError as error:
        print(f"Error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"Error: {error.filename2 or error.filename}: {error.strerror}", file=sys.stderr)
        return 2
    except (BuildError, SimulationError) as error:
        log = BUILD / "failure.log"
        log.parent.mkdir(exist_ok=True)
        log.write_text(f"{error}\n")
        headline = str(error).partition("\n")[0].rstrip(":")
        print(f"Error: {headline}; more is in {os.path.relpath(log)}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    Console().print(run_report.table(found))
    print(f"{job.out}: frame.png reference.png error.png spans run_report.json")
    failures = run_report.failures(found)
    for line in failures:
        print(f"FAILED: {line}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
