"""Frames on the builds of every feature, technique and method, with all that must come of them.

A trial is what no module bench can be: the design as a whole in a configuration that is not the
default one. tests/test_pruning.py and tests/test_trials.py run them; the mutants of a `generate`
branch that the default configuration leaves out have no other test (tests/campaigns/mutation.py).
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable
from pathlib import Path

import numpy as np

from phong75.model import twin
from phong75.model.analysis import metrics, pruning
from phong75.model.config import DEFAULT as C
from phong75.model.config import TECHNIQUES, Config
from phong75.model.frame import Frame
from phong75.model.front.scene import load_scene
from phong75.model.registers import writes
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import illegal_spans
from phong75.model.studies.methods import CONFIGS
from phong75.model.twin.core.register_map import unsupported_write, vanishing_exponent
from phong75.model.twin.pruning.span_guard import span_guard
from phong75.sim.build import Bench
from phong75.sim.frame.run_frame import Job, simulate_jobs
from phong75.sim.latency import latencies
from tests.modules.frames import random_frame

SEED = 1975


# -- frames that need everything but one feature ---------------------------------------------------


def plain(seed=SEED, spans: int = 300, longest: int = 12, **changes) -> Frame:
    """A random frame that needs everything, but for `changes` to its materials: functions of
    (table, rng) by the name of what they change."""
    rng = np.random.default_rng(seed)
    frame = random_frame(seed, spans, longest, two_sided=True)
    frame.materials.exponent[:4] = np.array([1, 1.5, 10, 128]) * C.exponent.one
    steepest(frame, rng)
    for change in changes.values():
        change(frame, rng)
    return frame


def steepest(frame, rng):
    """A span with the steepest slopes there are, between normals of the size of unit ones."""
    one = C.normal.one
    s = frame.spans[:1]
    s["length"], s["start"], s["step"] = 2, -one + 1, 2 * one - 2


def dull(frame, rng):
    frame.materials.weight[:] = 0


def cosine_only(frame, rng):
    frame.materials.exponent[:] = C.exponent.one


def tables_only(frame, rng):
    n = C.exponent.quantize(rng.uniform(1.01, 128, C.materials))
    frame.materials.exponent[:] = np.where(n == C.exponent.one, n + 1, n)


def sharp(frame, rng):
    least = vanishing_exponent(C)
    n = rng.integers(least, 128 * C.exponent.one, C.materials)
    frame.materials.exponent[:] = n
    frame.materials.exponent[:3] = least, least + 1, C.exponent.one


def even_weight(frame, rng):
    frame.materials.weight[:] = frame.materials.weight[:, :1]


def no_diffuse(frame, rng):
    frame.materials.diffuse[:] = 0


def no_ambient(frame, rng):
    frame.materials.ambient[:] = 0


def grey(frame, rng):
    frame.materials.ambient[:] = frame.materials.ambient[:, :1]
    frame.materials.diffuse[:] = frame.materials.diffuse[:, :1]


def one_sided(frame, rng):
    frame.two_sided = False


def one_exponent(frame, rng):
    frame.materials.exponent[:] = C.exponent.quantize(24.5)


def one_weight(frame, rng):
    frame.materials.weight[:] = frame.materials.weight[0, 0]


def one_ambient(frame, rng):
    frame.materials.ambient[:] = frame.materials.ambient[0]


def one_diffuse(frame, rng):
    frame.materials.diffuse[:] = frame.materials.diffuse[0]


def opposite(frame, rng):  # the half vector is always the frame's own; here hx < 0
    frame.half_vector = (-abs(frame.half_vector[0]), frame.half_vector[1])


def size_of_unit(frame, rng):
    """Normals whose largest component is 1/2 to 1 everywhere, except at the steepest span's ends,
    which are as large."""
    s = frame.spans[1:]
    largest = rng.integers(0, 3, len(s))
    row = np.arange(len(s))
    start = rng.integers(-C.normal.one // 2, C.normal.one // 2, (len(s), 3))
    start[row, largest] = np.where(rng.random(len(s)) < 0.5, 3, -3) * (C.normal.one // 4)
    s["start"], s["step"] = start, rng.integers(-(1 << 24), 1 << 24, (len(s), 3))


def gentle(frame, rng):
    s = frame.spans
    s["step"] >>= 5


def still_x(frame, rng):
    frame.spans["step"][:, 0] = 0


def still_y(frame, rng):
    frame.spans["step"][:, 1] = 0


def still_z(frame, rng):
    frame.spans["step"][:, 2] = 0


def few_materials(frame, rng):
    frame.spans["material"] &= 7


def narrow_picture(frame, rng):
    frame.spans["x"] %= 240


def low_picture(frame, rng):
    frame.spans["y"] &= 511


#: feature: (what makes it go, what goes with it beside the half vector, which always does).
ALONE = {
    "specular": (
        dull,
        {
            "power_function",
            "power_bypass",
            "log_octaves",
            "weight_function",
            "constant_exponent",
            "constant_weight",
        },
    ),
    "power_function": (cosine_only, {"power_bypass", "log_octaves", "constant_exponent"}),
    "power_bypass": (tables_only, set()),
    "log_octaves": (sharp, set()),
    "weight_function": (even_weight, set()),
    "diffuse": (no_diffuse, {"constant_diffuse"}),
    "ambient": (no_ambient, {"constant_ambient"}),
    "channels": (grey, set()),
    "two_sided": (one_sided, set()),
    "constant_half_vector": (opposite, set()),
    "constant_exponent": (one_exponent, {"power_bypass", "log_octaves"}),
    "constant_weight": (one_weight, {"weight_function"}),
    "constant_ambient": (one_ambient, set()),
    "constant_diffuse": (one_diffuse, set()),
    "constant_shift": (size_of_unit, set()),
    "interpolate_x": (still_x, set()),
    "interpolate_y": (still_y, set()),
    "interpolate_z": (still_z, set()),
    "idle_step_bits": (gentle, set()),
    "idle_material_bits": (few_materials, set()),
    "idle_x_bits": (narrow_picture, set()),
    "idle_y_bits": (low_picture, set()),
}


def without(feature: str, frame: Frame):
    """The full configuration without that one feature, as `prune` would leave it out."""
    pruned, _ = pruning.prune(frame)
    return dataclasses.replace(C, name="alone", **{feature: getattr(pruned, feature)})


# -- trials ----------------------------------------------------------------------------------------


class Trial:
    """`jobs` on the build `config`, each with all that must come of it."""

    def __init__(self, config: Config, *jobs: Job, full: Config | None = None):
        """full: the build whose pixels those of spans that fit must be; `config` by default."""
        self.config, self.jobs, self.full = config, jobs, full or config

    @functools.cached_property
    def expected(self) -> list[tuple]:
        """Counters, spans that are not supported (bool[n]) and pixels (None: any) of each job."""
        latency = 3 + latencies(self.config)["pixel"]
        return [self._expected(job, latency) for job in self.jobs]

    def _expected(self, job: Job, latency: int) -> tuple:
        config, frame = self.config, job.frame
        words = writes(frame, config) if job.writes is None else job.writes
        odd = span_guard(frame.spans, config)
        other = sum(unsupported_write(*word, config) for word in words)
        counters = {
            "complete": True,
            "extra_pixels": 0,
            "latency_cycles": latency,
            "unsupported": int(odd.sum()) + other,
        }
        if not odd.any():
            counters["illegal_spans"] = int(illegal_spans(frame, config).sum())
            counters["zero_normals"] = twin.zero_normals(frame, config)
        if job.stall == job.idle == 0:
            counters["cycles"] = int(frame.spans["length"].sum()) + latency - 1
        # Where other words were written the materials are others, too.
        return counters, odd, None if job.writes or other else twin.render(frame, self.full)

    def bench(self, rtl: Path | None = None) -> Bench:
        """The build, of the design in `rtl`."""
        return Bench("frame_bench", self.config, rtl=rtl, quick=True)

    def model_complaint(self) -> str:
        """Where the model of this build and that of the full one differ, "" if nowhere."""
        for k, (_, odd, pixels) in enumerate(self.expected):
            frame = self.jobs[k].frame
            if pixels is not None and self.full != self.config:
                rows = np.flatnonzero(np.repeat(~odd, frame.spans["length"]))
                fit = dataclasses.replace(frame, spans=frame.spans[~odd])
                own = twin.render(fit, self.config)
                compared = metrics.compare(_rows(pixels, rows), own)
                if compared.mismatches:
                    return f"job {k}, model: {compared.first}"
        return ""

    def complaint(self, bench: Bench | None = None) -> str:
        """Run all jobs; returns what is wrong first, "" if nothing is.

        Raises BuildError, SimulationError.
        """
        results = simulate_jobs(list(self.jobs), self.config, bench or self.bench())
        for k, (job, result) in enumerate(zip(self.jobs, results, strict=True)):
            if job.stop_after:
                continue
            counters, odd, pixels = self.expected[k]
            for what, want in counters.items():
                if (got := getattr(result, what)) != want:
                    return f"job {k}: {what} {got}, expected {want}"
            if pixels is not None:
                rows = np.flatnonzero(np.repeat(~odd, job.frame.spans["length"]))
                compared = metrics.compare(_rows(pixels, rows), _rows(result.pixels, rows))
                if compared.mismatches:
                    return f"job {k}: {compared.first}"
        return ""


def _rows(pixels: twin.Pixels, rows: np.ndarray) -> twin.Pixels:
    return twin.Pixels(*(getattr(pixels, f.name)[rows] for f in dataclasses.fields(pixels)))


def misfits(frame: Frame, seed: int) -> Frame:
    """`frame` with one in three of each of its spans' words anything, and one in six spans a single
    pixel of large normal, and one in six too large first, then of the size of unit ones."""
    rng = np.random.default_rng(seed)
    out, other = dataclasses.replace(frame, spans=frame.spans.copy()), plain(seed)
    for word in ("start", "step", "material", "x", "y"):
        rows = rng.random(len(out.spans)) < 1 / 3
        out.spans[word][rows] = other.spans[word][rows]
    rows = rng.random(len(out.spans)) < 1 / 6
    out.spans["length"][rows] = 1
    out.spans["start"][rows] = rng.integers(C.normal.min, C.normal.max + 1, (rows.sum(), 3))
    rows = rng.random(len(out.spans)) < 1 / 6
    longest = np.maximum(out.spans["length"][rows], 3)
    out.spans["length"][rows] = longest
    out.spans["start"][rows] = (0, 0, C.normal.one * 3 // 2)
    out.spans["step"][rows] = 0
    out.spans["step"][rows, 2] = -(C.normal.one * 3 // 4) // (longest - 1)
    out.spans = out.spans[~illegal_spans(out, C)]
    out.spans["last"] = False
    out.spans["last"][-1] = True
    return out


def odd_writes(frame: Frame, config: Config, seed: int) -> list[tuple[int, int]]:
    """(address, word) of writes to everywhere, many of the words at the border of what `config`
    supports: those of `frame`, and others."""
    rng = np.random.default_rng(seed)
    kind = 1 << (C.material_bits + C.weight_index_bits)
    one, vanishes = C.exponent.one, vanishing_exponent(C)
    values = [0, 1, 2, 3, one, one - 1, one + 1, vanishes, vanishes - 1, vanishes + 1]
    constants = (getattr(config, feature) for feature in pruning.FEATURES)
    mask = (1 << C.coefficient.bits + 1) - 1
    values += [int(v) & mask for c in constants if isinstance(c, tuple) for v in c]
    above = 1 << C.coefficient.bits + 1
    out = []
    for address in rng.permutation(2 * kind).tolist():
        word = rng.choice(values) if rng.random() < 0.8 else rng.integers(above)
        if rng.random() < 0.2:
            word ^= 1 << rng.integers(C.coefficient.bits)
        if rng.random() < 0.3:
            word += above * rng.integers(C.coefficient.one)
        out.append((address, int(word)))
    return out + writes(frame, C)


def _alone(feature: str) -> Trial:
    frame = plain(change=ALONE[feature][0])
    return _of(frame, without(feature, frame))


def _of(frame: Frame, config: Config, full: Config = C) -> Trial:
    """`frame`, which fits `config`, and then what does not."""
    return Trial(
        config, Job(frame), Job(frame, idle=100, stall=64, seed=SEED),
        Job(misfits(frame, SEED + 1)), Job(misfits(frame, SEED + 2), stall=100, idle=100),
        Job(frame, writes=odd_writes(frame, config, SEED)), full=full,
    )  # fmt: skip


def _default() -> Trial:
    frame, wild = plain(), random_frame(SEED, 300, 12)
    for first, axes in enumerate(([1], [0, 1], [1, 2], [0, 2])):  # most of these leave the format
        wild.spans["step"][first::50, axes] = C.normal.max
    return Trial(
        C, Job(frame), Job(wild), Job(frame, idle=100, stall=64, seed=SEED),
        Job(wild, stop_after=90, stall=255), Job(wild, reset_first=True),
        Job(frame, writes=odd_writes(frame, C, SEED)),
    )  # fmt: skip


def _hold() -> Trial:
    config = dataclasses.replace(C, name="hold", hold_unlit=True)
    frame, one_side = plain(), dataclasses.replace(plain(), two_sided=False)
    return Trial(config, Job(frame), Job(one_side), Job(one_side, idle=100, stall=64, seed=SEED),
                 full=C)  # fmt: skip


def narrow() -> tuple[Frame, Config]:
    """A frame that fits a build whose words are narrowed in every way, and that build."""
    fit = plain()
    for change in (size_of_unit, still_y, gentle, few_materials, narrow_picture, low_picture):
        change(fit, np.random.default_rng(SEED))
    fit.spans["start"][0, 0] = C.normal.one * 3 // 4  # the span that was steep, without a step in y
    names = ("constant_shift", "interpolate_y", "idle_step_bits", "idle_material_bits",
             "idle_x_bits", "idle_y_bits")  # fmt: skip
    pruned = pruning.prune(fit)[0]
    config = dataclasses.replace(C, name="narrow", **{n: getattr(pruned, n) for n in names})
    assert all(getattr(config, n) != getattr(C, n) for n in names)
    return fit, config


def _single(*changes: Callable) -> Trial:
    """One material, after `changes`, on the build pruned to it."""
    frame = plain(**{change.__name__: change for change in changes})
    frame.spans["material"] = 5
    return _of(frame, pruning.prune(frame)[0])


def _older(technique: str, channels: int) -> Trial:
    config = dataclasses.replace(TECHNIQUES[technique], name="older", channels=channels)
    frame = random_frame(SEED, 300, 12, config=config)
    if channels == 1:
        for word in ("start", "step"):
            frame.spans[word][:, 1:] = frame.spans[word][:, :1]
    return Trial(config, Job(frame), Job(frame, idle=100, stall=64, seed=SEED),
                 Job(frame, stop_after=40, stall=255), Job(frame, reset_first=True))  # fmt: skip


#: Small scenes for methods whose spans carry other words than normals.
SCENES = (("model/data/highlights.toml", (72, 24)), ("model/data/facets.toml", (96, 16)))


def in_words_of(config: Config, frame: Frame) -> Frame:
    """`frame`, which is in the default's words, in those of `config`, cut to fit."""
    less = C.normal.fraction - config.normal.fraction
    spans, materials = frame.spans.copy(), dataclasses.replace(frame.materials)
    for word in ("start", "step"):
        spans[word] >>= less
    cut = C.coefficient.fraction - config.coefficient.fraction
    for table in ("ambient", "diffuse", "weight"):
        setattr(materials, table, getattr(materials, table) >> cut)
    cut = C.half_vector.fraction - config.half_vector.fraction
    half = tuple(v >> cut for v in frame.half_vector)
    return dataclasses.replace(frame, spans=spans, materials=materials, half_vector=half)


def _method(name: str) -> Trial:
    config = CONFIGS[name]
    if config.normal_method == "quadratic_spans":
        frames = [front_end(load_scene(*scene), config).frame for scene in SCENES]
        frames.append(dataclasses.replace(frames[1], two_sided=True))
        frames[1].spans["start"][5:9] = frames[1].spans["step"][5:9] = 0  # no direction at all
    else:
        frames = [in_words_of(config, frame) for frame in (
            plain(), dataclasses.replace(plain(SEED + 1), two_sided=False))]  # fmt: skip
    return Trial(config, *map(Job, frames), Job(frames[0], idle=100, stall=64, seed=SEED))


#: What there is, by name.
TRIALS: dict[str, Callable[[], Trial]] = {
    "default": _default,
    **{name: functools.partial(_alone, name) for name in ALONE},
    "hold_unlit": _hold,
    "narrow": lambda: _of(*narrow()),
    "single": lambda: _single(),
    "single grey": lambda: _single(grey),
    "single matte": lambda: _single(dull, one_sided),
    "single cosine": lambda: _single(cosine_only, no_ambient),
    "single glow": lambda: _single(no_diffuse, even_weight, sharp),
    **{
        f"{technique} {channels}": functools.partial(_older, technique, channels)
        for technique in TECHNIQUES if technique != "phong" for channels in (3, 1)
    },
    **{
        name: functools.partial(_method, name)
        for name in (
            "not_normalized", "dot_first_18", "dot_first_14", "quadratic_spans_18",
            "quadratic_spans_14",
            "table_32", "table_32_newton", "fast_inverse_0", "fast_inverse_2", "parabolas_8",
            "parabolas_32",
            "lines_32", "squaring_18", "squaring_14", "schlick_18", "schlick_14", "width_10",
            "width_13", "interpolator_20", "power_tables_32", "power_tables_128",
        )
    },
}  # fmt: skip


@functools.cache
def trial(name: str) -> Trial:
    """The trial `name` of TRIALS. Raises KeyError."""
    return TRIALS[name]()


# -- random scenes ---------------------------------------------------------------------------------


def random_scene(seed: int) -> Frame:
    """A frame with a random choice of what it needs."""
    rng = np.random.default_rng(seed)
    frame = random_frame(seed, 120, 16, two_sided=bool(rng.random() < 0.5))
    for change in (dull, even_weight, no_diffuse, no_ambient, grey, one_exponent, one_weight,
                   one_ambient, one_diffuse, cosine_only, sharp, tables_only):  # fmt: skip
        if rng.random() < 0.2:
            change(frame, rng)
    used = rng.choice(C.materials, rng.choice([1, 1, 2, 5, 16]), replace=False)
    frame.spans["material"] = rng.choice(used, len(frame.spans))
    return frame


def random_trial(seed: int) -> Trial:
    """Random scene `seed` on the build pruned to it."""
    frame = random_scene(seed)
    return Trial(pruning.prune(frame)[0], Job(frame), full=C)
