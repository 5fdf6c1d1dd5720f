"""The stability cases through the RTL: a row of the table for each, with all that went wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field

import numpy as np

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import illegal_spans
from phong75.model.studies import corner_cases
from phong75.model.studies.corner_cases import Case
from phong75.sim.build import Bench
from phong75.sim.frame.run_frame import Job, SimResult, simulate_jobs

#: Chances of 256 that a span is not offered, or a pixel not taken, in a clock of the long run.
CHANCES = (0, 16, 64, 160)

#: Spans of one frame of the long run.
PIECE = 50_000

#: Seed of what all registers hold at power-up in the second run of every case.
POWER_UP = 75


@dataclass
class Row:
    """A line of the table. max_lsb, bound_lsb: None where there is no shading. mismatches: pixels
    of RTL and model that differ. failures: a line each, empty if all is as expected."""

    case: str
    extreme: str
    expected: str
    pixels: int
    max_lsb: float | None
    bound_lsb: float | None
    mismatches: int | None
    zero_normals: int | None
    failures: list[str] = field(default_factory=list)

    def as_dict(self) -> dict:
        """For JSON."""
        return asdict(self) | {"verdict": "FAILED" if self.failures else "ok"}


def judge(case: Case, results: list[SimResult], config: Config = DEFAULT) -> Row:
    """The row of `case`, whose frame gave `results`: the first counts, the others must be equal."""
    frame, first = case.frame, results[0]
    expected = twin.render(frame, config)
    said, mismatches = [], 0
    for result in results:
        compared = metrics.compare(expected, result.pixels)
        mismatches += compared.mismatches
        if not result.complete:
            said.append(f"no pixel came any more after {len(result.pixels.x)}")
        if result.extra_pixels:
            said.append(f"{result.extra_pixels} pixels after the last")
        if compared.mismatches:
            said.append(f"{compared.mismatches} pixels of RTL and model differ: {compared.first}")
    flagged, zeros = first.zero_normals, twin.zero_normals(frame, config)
    if flagged != zeros:
        said.append(f"{flagged} zero vectors flagged, there are {zeros}")
    illegal = int(illegal_spans(frame, config).sum())
    if first.illegal_spans != illegal:
        said.append(f"{first.illegal_spans} illegal spans flagged, there are {illegal}")
    if case.full_rate and first.stall_cycles:
        said.append(f"{first.stall_cycles} clocks without a pixel")
    bound = float(error_budget.bound_lsb(frame, config))
    worst = 0.0
    if len(first.pixels.x) == len(expected.x):
        worst = float(corner_cases.errors(frame, first.pixels.rgb).max(initial=0))
        said += case.check(frame, first.pixels)
    if worst > bound:
        said.append(f"the largest error is {worst:.4f} LSB, the bound {bound:.4f}")
    return Row(
        case.name, case.extreme, case.expected, len(first.pixels.x), worst, bound, mismatches,
        flagged, said,
    )  # fmt: skip


def run_cases(cases: list[Case], bench: Bench | None = None) -> list[Row]:
    """All `cases` in one simulation, and once more with random contents of all registers."""
    runs = [
        simulate_jobs([Job(case.frame) for case in cases], bench=bench, power_up=power_up)
        for power_up in (None, POWER_UP)
    ]
    return [judge(c, list(results)) for c, results in zip(cases, zip(*runs, strict=True),
                                                          strict=True)]  # fmt: skip


def results(cases: list[Case]) -> list[SimResult]:
    """What the RTL does with `cases`, in one simulation."""
    return simulate_jobs([Job(case.frame) for case in cases])


def scene_case(name: str, size: tuple[int, int] | None = None) -> Case:
    """A bundled scene as a case."""
    frame = front_end(load_scene(name, size)).frame
    return Case(
        f"{name} {frame.width}×{frame.height}",
        f"a frame of {frame.width}×{frame.height} pixels in {len(frame.spans)} spans",
        "every dot once, within the bound, a pixel every clock",
        frame,
        full_rate=True,
    )


def shared_edges(meshes: int, progress: Callable[[float], None] | None = None) -> Row:
    """The row of `meshes` random triangulations: no gap, no dot twice."""
    said = corner_cases.shared_edges(meshes, progress=progress)
    failures = [
        f"{said[what]} dots {words}"
        for what, words in (("gaps", "missing"), ("doubles", "drawn twice"), ("outside", "outside"))
        if said[what]
    ]
    return Row(
        "shared edges",
        f"{said['meshes']} random triangulations of rectangles, {said['triangles']} triangles",
        "every dot of each rectangle once, no other",
        said["dots"], None, None, None, None, failures,
    )  # fmt: skip


def long_run(spans: int, seed: int = 75) -> Row:
    """The row of `spans` random spans in frames of PIECE, each run whole under random pauses at
    both ends, after a run that a reset breaks off at a random clock."""
    rng = np.random.default_rng(seed)
    jobs = []
    for piece in range(-(-spans // PIECE)):
        count = min(PIECE, spans - piece * PIECE)
        frame = corner_cases.random_frame(count, 5, [seed, piece])
        for stop in (int(rng.integers(1, 2 * count)), 0):
            jobs.append(
                Job(
                    frame, idle=int(rng.choice(CHANCES)), stall=int(rng.choice(CHANCES)),
                    seed=int(rng.integers(1, 1 << 31)), stop_after=stop, reset_first=not stop,
                )
            )  # fmt: skip
    results = simulate_jobs(jobs)
    row = Row(
        "long run",
        f"{spans} spans with random pauses of spans and of pixels, {len(jobs) // 2} random resets",
        "every pixel once, in order, whatever the pauses; a frame after a reset is whole",
        0, 0.0, 0.0, 0, 0,
    )  # fmt: skip
    for (broken_off, _), (whole, job) in zip(
        *[iter(zip(results, jobs, strict=True))] * 2, strict=True
    ):
        row.failures += _prefix(broken_off, job.frame)
        found = judge(Case(row.case, "", "", job.frame), [whole])
        row.pixels += found.pixels
        row.mismatches += found.mismatches
        row.zero_normals += found.zero_normals
        row.max_lsb = max(row.max_lsb, found.max_lsb)
        row.bound_lsb = max(row.bound_lsb, found.bound_lsb)
        row.failures += found.failures
    return row


def _prefix(result: SimResult, frame: Frame) -> list[str]:
    """What came before a reset must be the beginning of what was to come."""
    want, count = twin.render(frame), len(result.pixels.x)
    want = twin.Pixels(want.x[:count], want.y[:count], want.rgb[:count], want.last[:count])
    differ = metrics.compare(want, result.pixels).mismatches
    return [f"{differ} pixels before a reset differ"] if differ or result.complete else []
