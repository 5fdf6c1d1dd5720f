# SPDX-License-Identifier: MIT
"""Corner cases through the RTL: one row of the table per case, with all failures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, field

import numpy as np

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import Frame, fitted
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import illegal_spans
from phong75.model.studies import corner_cases
from phong75.model.studies.corner_cases import CornerCase
from phong75.model.studies.random_frames import random_frame
from phong75.sim.build import Bench
from phong75.sim.frame.run_frame import SimJob, SimResult, simulate_jobs

#: Probabilities, in 1/256 per cycle, that the long run offers no span or takes no pixel.
CHANCES = (0, 16, 64, 160)

#: Number of spans per frame of the long run.
PIECE = 50_000

#: Seed of the random register contents at power-up, for the second run of every case.
POWER_UP = 75


@dataclass
class CornerCaseRow:
    """One row of the table.

    max_lsb, bound_lsb: largest error and its derived bound, LSB of a colour code; None if the case
    shades nothing. mismatches: number of pixels in which RTL and twin differ. failures: one message
    per failure.
    """

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
        """The row as a dict for JSON, with its verdict: "ok" or "FAILED"."""
        return asdict(self) | {"verdict": "FAILED" if self.failures else "ok"}


def judge(case: CornerCase, results: list[SimResult], config: Config = DEFAULT) -> CornerCaseRow:
    """Compare the simulated `results` of `case` with the twin and with the error bound.

    All results are compared with the twin. Counters, the error and the case's own check are taken
    from the first result.
    """
    frame, first = case.frame, results[0]
    expected = twin.render(frame, config)
    failures, mismatches = [], 0
    for result in results:
        compared = metrics.compare(expected, result.pixels)
        mismatches += compared.mismatches
        if not result.complete:
            failures.append(f"the pixels stop after {len(result.pixels.x)}")
        if result.extra_pixels:
            failures.append(f"{result.extra_pixels} pixels after the last one")
        if compared.mismatches:
            failures.append(
                f"{compared.mismatches} pixels of RTL and model differ: {compared.first}"
            )
    flagged, zeros = first.zero_normals, twin.zero_normals(frame, config)
    if flagged != zeros:
        failures.append(f"{flagged} zero vectors flagged, expected {zeros}")
    illegal = int(illegal_spans(frame, config).sum())
    if first.illegal_spans != illegal:
        failures.append(f"{first.illegal_spans} illegal spans flagged, expected {illegal}")
    if case.full_rate and first.stall_cycles:
        failures.append(f"{first.stall_cycles} cycles without a pixel")
    bound = float(error_budget.bound_lsb(frame, config))
    worst = 0.0
    if len(first.pixels.x) == len(expected.x):
        worst = float(corner_cases.errors(frame, first.pixels.rgb).max(initial=0))
        failures += case.check(frame, first.pixels)
    if worst > bound:
        failures.append(f"the largest error is {worst:.4f} LSB, the bound {bound:.4f}")
    return CornerCaseRow(
        case.name, case.extreme, case.expected, len(first.pixels.x), worst, bound, mismatches,
        flagged, failures,
    )  # fmt: skip


def run_cases(
    cases: list[CornerCase], bench: Bench | None = None, config: Config = DEFAULT
) -> list[CornerCaseRow]:
    """Simulate all `cases` twice, with zeros and with random register contents at power-up.

    bench: of whole frames, by default that of `config`.
    Raises BuildError, SimulationError.
    """
    runs = [
        simulate_jobs(
            [SimJob(case.frame) for case in cases], config, bench=bench, power_up=power_up
        )
        for power_up in (None, POWER_UP)
    ]
    return [judge(c, list(results), config) for c, results in zip(cases, zip(*runs, strict=True),
                                                          strict=True)]  # fmt: skip


def plain_cases() -> list[CornerCase]:
    """The corner cases that any method can show: one light, powers of cos(s), linear normals."""
    return [
        case for case in corner_cases.cases()
        if fitted(DEFAULT, case.frame) == DEFAULT and not case.frame.spans["bend"].any()
    ]  # fmt: skip


def method_row(config: Config, cases: list[CornerCase]) -> dict:
    """`cases` through the RTL of `config`, all together: how many, how many of them the method
    refuses, pixels, pixels in which RTL and twin differ, the largest error and the largest bound of
    the cases with a derived bound, and of those without one the number and the largest error, LSB;
    and failures.

    Refused cases are compared with the twin, but have no error. Raises BuildError, SimulationError.
    """
    found = simulate_jobs([SimJob(case.frame) for case in cases], config)
    row: dict = {
        "name": config.name, "cases": len(cases), "refused": 0, "pixels": 0, "mismatches": 0,
        "max_lsb": 0.0, "bound_lsb": None, "unbounded": 0, "unbounded_lsb": None, "failures": [],
    }  # fmt: skip
    for case, result in zip(cases, found, strict=True):
        compared = metrics.compare(twin.render(case.frame, config), result.pixels)
        row["pixels"] += compared.pixels
        row["mismatches"] += compared.mismatches
        if compared.mismatches or not result.complete or result.extra_pixels:
            row["failures"].append(f"{case.name}: RTL and model differ: {compared.first}")
            continue
        if error_budget.refusal(case.frame, config):
            row["refused"] += 1
            continue
        error = float(corner_cases.errors(case.frame, result.pixels.rgb).max(initial=0))
        bound = error_budget.bound_lsb(case.frame, config)
        if bound is None:
            row["unbounded"] += 1
            row["unbounded_lsb"] = max(row["unbounded_lsb"] or 0.0, error)
            continue
        row["max_lsb"] = max(row["max_lsb"], error)
        row["bound_lsb"] = max(row["bound_lsb"] or 0.0, float(bound))
        if error > bound:
            row["failures"].append(f"{case.name}: {error:.4f} LSB is beyond {bound:.4f}")
    return row


def results(cases: list[CornerCase]) -> list[SimResult]:
    """Simulate `cases` once. Raises BuildError, SimulationError."""
    return simulate_jobs([SimJob(case.frame) for case in cases])


def scene_case(name: str, size: tuple[int, int] | None = None) -> CornerCase:
    """A bundled scene as a case. size: (width, height) in pixels, else the scene's own."""
    frame = front_end(load_scene(name, size)).frame
    return CornerCase(
        f"{name} {frame.width}×{frame.height}",
        f"a frame of {frame.width}×{frame.height} pixels in {len(frame.spans)} spans",
        "every pixel once, within the bound, one pixel per cycle",
        frame,
        full_rate=True,
    )


def shared_edges(meshes: int, progress: Callable[[float], None] | None = None) -> CornerCaseRow:
    """The row of `meshes` random triangulations: no gap, no pixel twice (model only)."""
    counts = corner_cases.shared_edges(meshes, progress=progress)
    faults = (("gaps", "missing"), ("doubles", "drawn twice"), ("outside", "outside"))
    failures = [f"{counts[key]} pixels {fault}" for key, fault in faults if counts[key]]
    return CornerCaseRow(
        "shared edges",
        f"{counts['meshes']} random triangulations of rectangles, {counts['triangles']} triangles",
        "every pixel of each rectangle once, no other pixel",
        counts["pixels"], None, None, None, None, failures,
    )  # fmt: skip


def long_run(spans: int, seed: int = 75) -> CornerCaseRow:
    """The row of `spans` random spans, in frames of PIECE spans.

    Each frame is simulated twice with random pauses of spans and pixels: first up to a reset at a
    random cycle, then to its end. Raises BuildError, SimulationError.
    """
    rng = np.random.default_rng(seed)
    jobs = []
    for piece in range(-(-spans // PIECE)):
        count = min(PIECE, spans - piece * PIECE)
        frame = random_frame([seed, piece], count, 5, two_sided=bool(rng.random() < 0.5))
        frame.materials.exponent[:] = DEFAULT.exponent.quantize(
            rng.uniform(1, 128, DEFAULT.materials)
        )
        for stop in (int(rng.integers(1, 2 * count)), 0):
            jobs.append(
                SimJob(
                    frame, idle=int(rng.choice(CHANCES)), stall=int(rng.choice(CHANCES)),
                    seed=int(rng.integers(1, 1 << 31)), stop_after=stop, reset_first=not stop,
                )
            )  # fmt: skip
    results = simulate_jobs(jobs)
    row = CornerCaseRow(
        "long run",
        f"{spans} spans with random pauses of spans and of pixels, {len(jobs) // 2} random resets",
        "every pixel once, in order, under all pauses; a frame after a reset is complete",
        0, 0.0, 0.0, 0, 0,
    )  # fmt: skip
    for (interrupted, _), (complete, job) in zip(
        *[iter(zip(results, jobs, strict=True))] * 2, strict=True
    ):
        row.failures += _prefix(interrupted, job.frame)
        frame_row = judge(CornerCase(row.case, "", "", job.frame), [complete])
        row.pixels += frame_row.pixels
        row.mismatches += frame_row.mismatches
        row.zero_normals += frame_row.zero_normals
        row.max_lsb = max(row.max_lsb, frame_row.max_lsb)
        row.bound_lsb = max(row.bound_lsb, frame_row.bound_lsb)
        row.failures += frame_row.failures
    return row


def _prefix(result: SimResult, frame: Frame) -> list[str]:
    """Check that the pixels before a reset are the first pixels of `frame`, but not all."""
    want, count = twin.render(frame), len(result.pixels.x)
    want = twin.Pixels(want.x[:count], want.y[:count], want.rgb[:count], want.last[:count])
    differ = metrics.compare(want, result.pixels).mismatches
    return [f"{differ} pixels before a reset differ"] if differ or result.complete else []
