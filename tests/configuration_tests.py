# SPDX-License-Identifier: MIT
"""Configuration tests: whole frames on a build of one configuration, with the expected result.

The module testbenches run single modules, most of them in the default configuration. A
configuration test runs the whole design in a configuration of its own: without a feature, with
another shading technique or with another arithmetic method. It is the only test of a `generate`
branch that the default configuration leaves out. tests/test_configurations.py and
tests/test_pruning.py run the configuration tests; the mutation campaign uses them
(tests/campaigns/mutation.py).
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
from phong75.model.config import MAX_EXPONENT, MAX_JUMPS, TECHNIQUES, Config
from phong75.model.frame import Frame, fitted
from phong75.model.front.scene import load_scene
from phong75.model.reflectance import segments
from phong75.model.registers import address_bits, writes
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import bent_beyond, illegal_spans, turns
from phong75.model.studies.methods import CONFIGS
from phong75.model.studies.random_frames import placed, random_frame, random_lights
from phong75.model.twin.core.register_map import unsupported_write, vanishing_exponent
from phong75.model.twin.lights.light_map import unsupported_light_write
from phong75.model.twin.pruning.span_guard import span_guard
from phong75.scripts.configurations import CONFIGURATIONS
from phong75.sim.build import Bench
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from phong75.sim.latency import latencies

SEED = 1975


# -- frames that need all features except one ------------------------------------------------------


def plain(seed=SEED, spans: int = 300, longest: int = 12, **changes) -> Frame:
    """A random frame that needs every feature, after `changes`.

    changes: functions change(frame, rng) that modify the frame in place; each removes the need for
    a feature.
    """
    rng = np.random.default_rng(seed)
    frame = random_frame(seed, spans, longest, two_sided=True)
    frame.materials.exponent[:4] = np.array([1, 1.5, 10, 128]) * C.exponent.one
    steepest(frame, rng)
    for change in changes.values():
        change(frame, rng)
    return frame


def steepest(frame, rng):
    """Give the first span the steepest steps of the format, between components of about 1."""
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


def opposite(frame, rng):
    """A half vector with hx < 0. (The default frames have hx >= 0.)"""
    frame.half_vector = (-abs(frame.half_vector[0]), frame.half_vector[1])


def size_of_unit(frame, rng):
    """Normals whose largest component is 1/2 to 1 in every pixel, so that no shift is needed."""
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


#: {feature: (change to a frame that removes the need for the feature, further features that such a
#: frame does not need)}. `constant_half_vector` is in no set: no single frame needs a writable half
#: vector.
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
    """The default configuration with one `feature` pruned, as `prune` does it for `frame`."""
    pruned, _ = pruning.prune(frame)
    return dataclasses.replace(C, name="alone", **{feature: getattr(pruned, feature)})


# -- configuration tests ---------------------------------------------------------------------------


class ConfigurationTest:
    """Simulates `jobs` on the build `config` and compares with the twin."""

    def __init__(self, config: Config, *jobs: SimJob, full: Config | None = None):
        """full: the configuration of the twin that gives the expected pixels of supported spans.

        By default that is `config` itself.
        """
        self.config, self.jobs, self.full = config, jobs, full or config

    @functools.cached_property
    def expected(self) -> list[tuple]:
        """(counters, unsupported, pixels) that are expected of each job.

        counters: {name of a field of SimResult: value}. unsupported: bool[n], spans that need a
        feature that the build leaves out. pixels: of the twin; None if pixels are not compared.
        """
        latency = 3 + latencies(self.config)["pixel"]
        return [self._expected(job, latency) for job in self.jobs]

    def _expected(self, job: SimJob, latency: int) -> tuple:
        config, frame = self.config, job.frame
        words = writes(frame, config) if job.writes is None else job.writes
        unsupported = span_guard(frame.spans, config)
        flags = unsupported_light_write if config.sums_lights else unsupported_write
        unsupported_writes = sum(flags(*word, config) for word in words)
        counters = {
            "complete": True,
            "extra_pixels": 0,
            "unsupported": int(unsupported.sum()) + unsupported_writes,
        }
        if turns(frame, config) == 1 or job.idle == 0:  # else a turn may wait for its record
            counters["latency_cycles"] = latency + turns(frame, config) - 1
        if not unsupported.any():
            counters["illegal_spans"] = int(illegal_spans(frame, config).sum())
            counters["zero_normals"] = twin.zero_normals(frame, config)
        if job.stall == job.idle == 0:
            pixels = int(frame.spans["length"].sum())
            counters["cycles"] = pixels * turns(frame, config) + latency - 1
        # Other register writes than the frame's give other materials than the twin's.
        compared = not (job.writes or unsupported_writes)
        return counters, unsupported, twin.render(frame, self.full) if compared else None

    def bench(self, rtl: Path | None = None) -> Bench:
        """The whole-frame testbench of this configuration, with the design in the folder `rtl`."""
        return Bench("frame_bench", self.config, rtl=rtl, quick=True)

    def model_failure(self) -> str:
        """The first difference between the twins of this build and of the full one; "" if none."""
        for k, (_, unsupported, pixels) in enumerate(self.expected):
            frame = self.jobs[k].frame
            if pixels is not None and self.full != self.config:
                rows = np.flatnonzero(np.repeat(~unsupported, frame.spans["length"]))
                supported = frame.take(~unsupported)
                compared = metrics.compare(_rows(pixels, rows), twin.render(supported, self.config))
                if compared.mismatches:
                    return f"job {k}, model: {compared.first}"
        return ""

    def failure(self, bench: Bench | None = None) -> str:
        """Simulate all jobs; returns the first failure, "" if there is none.

        Raises BuildError, SimulationError.
        """
        results = simulate_jobs(list(self.jobs), self.config, bench or self.bench())
        for k, (job, result) in enumerate(zip(self.jobs, results, strict=True)):
            if job.stop_after:
                continue
            counters, unsupported, pixels = self.expected[k]
            for name, want in counters.items():
                if (got := getattr(result, name)) != want:
                    return f"job {k}: {name} {got}, expected {want}"
            if pixels is not None:
                rows = np.flatnonzero(np.repeat(~unsupported, job.frame.spans["length"]))
                compared = metrics.compare(_rows(pixels, rows), _rows(result.pixels, rows))
                if compared.mismatches:
                    return f"job {k}: {compared.first}"
        return ""


def _rows(pixels: twin.Pixels, rows: np.ndarray) -> twin.Pixels:
    """The pixels number `rows` (int[n]) of a stream."""
    return twin.Pixels(*(getattr(pixels, f.name)[rows] for f in dataclasses.fields(pixels)))


def misfits(frame: Frame, seed: int) -> Frame:
    """`frame` with spans that a pruned build may not support.

    One third of each word of the spans is replaced by a word of a frame that needs everything. One
    span in six becomes a single pixel with a large normal. One span in six starts with a normal
    longer than 1 that gets shorter than 1 along the span. Illegal spans are removed.
    """
    rng = np.random.default_rng(seed)
    spans, other = frame.spans.copy(), plain(seed)
    for word in ("start", "step", "material", "x", "y"):
        rows = rng.random(len(spans)) < 1 / 3
        spans[word][rows] = other.spans[word][rows]
    rows = rng.random(len(spans)) < 1 / 6
    spans["length"][rows] = 1
    spans["start"][rows] = rng.integers(C.normal.min, C.normal.max + 1, (rows.sum(), 3))
    rows = rng.random(len(spans)) < 1 / 6
    length = np.maximum(spans["length"][rows], 3)
    spans["length"][rows] = length
    spans["start"][rows] = (0, 0, C.normal.one * 3 // 2)
    spans["step"][rows] = 0
    spans["step"][rows, 2] = -(C.normal.one * 3 // 4) // (length - 1)
    result = dataclasses.replace(frame, spans=spans)
    result.spans = spans[~illegal_spans(result, C)]
    result.spans["last"] = False
    result.spans["last"][-1] = True
    return result


def odd_writes(frame: Frame, config: Config, seed: int) -> list[tuple[int, int]]:
    """Register writes (address, word): random words to every address, then those of `frame`.

    Many of the words are at the limits of what `config` supports.
    """
    rng = np.random.default_rng(seed)
    kind = 1 << (C.material_bits + C.weight_index_bits)
    one, vanishes = C.exponent.one, vanishing_exponent(C)
    values = [0, 1, 2, 3, one, one - 1, one + 1, vanishes, vanishes - 1, vanishes + 1]
    constants = (getattr(config, feature) for feature in pruning.FEATURES)
    mask = (1 << C.coefficient.bits + 1) - 1
    values += [int(v) & mask for c in constants if isinstance(c, tuple) for v in c]
    if config.check_writes:
        most = MAX_EXPONENT * one
        values += [C.coefficient.one, C.coefficient.one + 1, most, most + 1]
    above = 1 << C.coefficient.bits + 1
    random_writes = []
    for address in rng.permutation(2 * kind).tolist():
        word = rng.choice(values) if rng.random() < 0.8 else rng.integers(above)
        if rng.random() < 0.2:
            word ^= 1 << rng.integers(C.coefficient.bits)
        if rng.random() < 0.3:
            word += above * rng.integers(C.coefficient.one)
        random_writes.append((address, int(word)))
    return random_writes + writes(frame, C)


def _alone(feature: str) -> ConfigurationTest:
    frame = plain(change=ALONE[feature][0])
    return _of(frame, without(feature, frame))


def _of(frame: Frame, config: Config, full: Config = C) -> ConfigurationTest:
    """Jobs with `frame`, which `config` supports, and jobs with spans and writes it does not."""
    return ConfigurationTest(
        config, SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED),
        SimJob(misfits(frame, SEED + 1)), SimJob(misfits(frame, SEED + 2), stall=100, idle=100),
        SimJob(frame, writes=odd_writes(frame, config, SEED)), full=full,
    )  # fmt: skip


def _default() -> ConfigurationTest:
    frame, overflowing = plain(), random_frame(SEED, 300, 12)
    for first, axes in enumerate(([1], [0, 1], [1, 2], [0, 2])):  # most leave the format
        overflowing.spans["step"][first::50, axes] = C.normal.max
    return ConfigurationTest(
        C, SimJob(frame), SimJob(overflowing), SimJob(frame, idle=100, stall=64, seed=SEED),
        SimJob(overflowing, stop_after=90, stall=255), SimJob(overflowing, reset_first=True),
        SimJob(frame, writes=odd_writes(frame, C, SEED)),
    )  # fmt: skip


def _hold() -> ConfigurationTest:
    config = dataclasses.replace(C, name="hold", hold_unlit=True)
    frame, single = plain(), dataclasses.replace(plain(), two_sided=False)
    # A zero normal is flagged once, also if the pixels behind it face away from the light.
    for spans in (frame.spans, single.spans):
        spans["start"][10:14:2] = spans["step"][10:14:2] = 0
        spans["start"][11:15:2] = 0, 0, -C.normal.one
        spans["step"][11:15:2] = 0
    jobs = SimJob(frame), SimJob(single), SimJob(single, idle=100, stall=64, seed=SEED)
    return ConfigurationTest(config, *jobs, full=C)


def _checked() -> ConfigurationTest:
    config, frame = dataclasses.replace(C, name="checked", check_writes=True), plain()
    assert not any(unsupported_write(*word, config) for word in writes(frame, config))
    odd = [odd_writes(frame, config, SEED + k) for k in range(3)]
    assert all(50 < sum(unsupported_write(*word, config) for word in words) for words in odd)
    return ConfigurationTest(
        config, SimJob(frame), *(SimJob(frame, writes=words) for words in odd), full=C
    )


def narrow() -> tuple[Frame, Config]:
    """A frame, and a build whose words are narrowed in every possible way and that supports it."""
    frame = plain()
    for change in (size_of_unit, still_y, gentle, few_materials, narrow_picture, low_picture):
        change(frame, np.random.default_rng(SEED))
    # The steepest span now has no step in y: its x keeps the largest component above 1/2.
    frame.spans["start"][0, 0] = C.normal.one * 3 // 4
    names = ("constant_shift", "interpolate_y", "idle_step_bits", "idle_material_bits",
             "idle_x_bits", "idle_y_bits")  # fmt: skip
    pruned = pruning.prune(frame)[0]
    config = dataclasses.replace(C, name="narrow", **{n: getattr(pruned, n) for n in names})
    assert all(getattr(config, n) != getattr(C, n) for n in names)
    return frame, config


def _single(*changes: Callable) -> ConfigurationTest:
    """A frame of one material, after `changes`, on the build that is pruned to the frame."""
    frame = plain(**{change.__name__: change for change in changes})
    frame.spans["material"] = 5
    return _of(frame, pruning.prune(frame)[0])


#: The full design with quadratic normals.
QUADRATIC = dataclasses.replace(C, name="quadratic", normal_order=2)


def bent(frame, rng):
    """Give each span a bend that moves the middle of each component by up to 1 and no end by more
    than the rounding. Spans of one or two pixels, in which a bend has no effect, get any bend."""
    s, extra = frame.spans, C.bend_fraction_bits
    s["start"] >>= 1
    s["step"] >>= 1
    last = np.maximum(s["length"].astype(np.int64) - 1, 1)[:, None]
    shape = s["start"].shape
    moved = rng.integers(-C.normal.one, C.normal.one, shape) >> rng.integers(0, 30, shape)
    bend = -(moved << (extra + 3)) // (last * last)
    bend[bent_beyond(_with_bends(s, bend), QUADRATIC)] = 0
    step = s["step"] - (bend * (last - 1) >> (extra + 1))
    fits = C.normal.contains(step)
    s["step"], bend = np.where(fits, step, s["step"]), np.where(fits, bend, 0)
    bend[bent_beyond(_with_bends(s, bend), QUADRATIC)] = 0
    short = s["length"] <= 2
    bend[short] = rng.integers(QUADRATIC.bend.min, QUADRATIC.bend.max + 1, (short.sum(), 3))
    s["bend"] = bend


def _with_bends(spans, bend):
    """A copy of `spans` with other bends."""
    spans = spans.copy()
    spans["bend"] = bend
    return spans


def bent_misfits(frame: Frame, seed: int) -> Frame:
    """`misfits` in which one span in three has any bends, in one to three components; some of
    these spans are illegal."""
    rng = np.random.default_rng(seed)
    frame = misfits(frame, seed)
    rows = np.flatnonzero(rng.random(len(frame.spans)) < 1 / 3)
    bend = rng.integers(QUADRATIC.bend.min, QUADRATIC.bend.max + 1, (len(rows), 3))
    bend = bend >> rng.integers(0, 40, bend.shape)
    frame.spans["bend"][rows] = np.where(rng.random(bend.shape) < 0.5, bend, 0)
    return frame


def straight(frame, rng):
    """A normal that is the same along each span."""
    frame.spans["step"] = frame.spans["bend"] = 0


def _quadratic() -> ConfigurationTest:
    """The full design with quadratic normals, and its linear spans."""
    linear, frame = plain(), plain(change=bent)
    one_sided_frame = dataclasses.replace(plain(SEED + 1, longest=400, spans=60, change=bent))
    one_sided_frame.two_sided = False
    beyond = bent_misfits(frame, SEED)
    return ConfigurationTest(
        QUADRATIC, SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED), SimJob(linear),
        SimJob(one_sided_frame), SimJob(beyond), SimJob(beyond, idle=64, stall=100, seed=SEED),
        SimJob(beyond, stop_after=90, stall=255), SimJob(frame, reset_first=True),
    )  # fmt: skip


def _quadratic_still() -> ConfigurationTest:
    """Quadratic normals on a build without the adders of the interpolators."""
    frame = plain(still=straight)
    axes = {f"interpolate_{axis}": False for axis in "xyz"}
    return ConfigurationTest(
        dataclasses.replace(QUADRATIC, name="still", **axes), SimJob(frame),
        SimJob(bent_misfits(frame, SEED + 1)),
        SimJob(bent_misfits(frame, SEED + 2), stall=100, idle=100), full=QUADRATIC,
    )  # fmt: skip


def _intensities(technique: str, channels: int) -> ConfigurationTest:
    """Gouraud or flat shading with 1 or 3 colour channels."""
    config = dataclasses.replace(TECHNIQUES[technique], name="intensities", channels=channels)
    frame = random_frame(SEED, 300, 12, config=config)
    if channels == 1:
        for word in ("start", "step"):
            frame.spans[word][:, 1:] = frame.spans[word][:, :1]
    return ConfigurationTest(
        config, SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED),
        SimJob(frame, stop_after=40, stall=255), SimJob(frame, reset_first=True),
    )  # fmt: skip


#: Small scenes for methods whose spans carry further words beside the normals.
SCENES = (("model/data/highlights.toml", (72, 24)), ("model/data/facets.toml", (96, 16)))


# -- several lights --------------------------------------------------------------------------------


def unrelated(frame: Frame, seed: int) -> None:
    """Give every third span normals that are not one vector in several frames: some longer, some
    shorter than that of the first light, which is the zero vector in some spans."""
    rng = np.random.default_rng(seed)
    for light in frame.further:
        for name in ("start", "step"):
            codes = rng.integers(-(1 << 30), 1 << 30, (len(frame.spans), 3))
            codes >>= rng.integers(0, 31, len(frame.spans))[:, None]
            getattr(light, name)[::3] = codes[::3] >> (4 if name == "step" else 0)
    frame.spans["start"][::9] = frame.spans["step"][::9] = 0


def overflowing(frame: Frame) -> None:
    """Let a component of one light leave its format in some spans."""
    for number, light in enumerate(frame.further):
        light.step[number::40, number % 3] = C.normal.max
    frame.spans["step"][20::50, 1] = C.normal.min


def several(lights: int, units: int, coloured: bool = True, **features) -> Config:
    """A build for several lights."""
    name = f"lights_{lights}_units_{units}{'_coloured' if coloured else ''}"
    return Config(
        name=name, lights=lights, units=units, highlight_colour=coloured, **features
    )  # fmt: skip


def _lights(lights: int, units: int, coloured: bool) -> ConfigurationTest:
    """Frames of all numbers of lights that the build has, from most to fewest."""
    config = several(lights, units, coloured)
    jobs = []
    for count in range(lights, 0, -1):
        seed = [SEED, lights, count]
        frame = random_lights(seed, 60 if count < lights else 200, 7, count, count % 2 == 0,
                              coloured)  # fmt: skip
        if count == lights:
            most = frame
            pixel = random_lights(seed, 200, 1, count, coloured=coloured)
            odd = random_lights([*seed, 1], 200, 7, count, True, coloured)
            unrelated(odd, SEED)
            wild = random_lights([*seed, 2], 200, 7, count, coloured=coloured)
            overflowing(wild)
            jobs += [SimJob(pixel), SimJob(odd), SimJob(wild), SimJob(wild, idle=90, stall=90)]
        jobs += [SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED + count)]
    jobs += [
        SimJob(most, stop_after=clocks, stall=stall) for clocks, stall in ((90, 255), (301, 0))
    ]
    jobs += [SimJob(most, reset_first=True, idle=200), SimJob(most, stall=200)]
    for clocks in range(25, 25 + 9 * lights, 5):  # a reset in every turn of a pixel
        jobs += [SimJob(pixel, stop_after=clocks), SimJob(pixel, reset_first=True)]
    jobs.append(SimJob(most, writes=_odd_light_writes(most, config)))
    return ConfigurationTest(config, *jobs)


def _odd_light_writes(frame: Frame, config: Config) -> list[tuple[int, int]]:
    """Register writes: random words to every address, then those of `frame`."""
    rng = np.random.default_rng(SEED)
    one = C.coefficient.one
    values = [0, 1, one, one - 1, one + 1, C.exponent.one, *range(16)]
    random_writes = []
    for address in rng.permutation(1 << address_bits(config)).tolist():
        word = rng.choice(values) if rng.random() < 0.8 else rng.integers(1 << 33)
        random_writes.append((address, int(word)))
    return random_writes + writes(frame, config)


def _lights_without(**left_out) -> ConfigurationTest:
    """Three lights on two units, without some features, and a frame that needs all of them."""
    config = several(3, 2, left_out.pop("coloured", True), **left_out)
    frame = random_lights(SEED, 200, 7, 3, config.two_sided, config.highlight_colour)
    needs = random_lights(SEED + 1, 60, 7, 3, True)
    for feature, change in (
        ("specular", dull), ("power_function", cosine_only), ("weight_function", even_weight),
        ("diffuse", no_diffuse), ("ambient", no_ambient),
    ):  # fmt: skip
        if not getattr(config, feature):
            change(frame, np.random.default_rng(SEED))
    if not config.diffuse:
        for light in frame.further:
            light.diffuse[:] = 0
    if config.channels == 1:
        table = frame.materials
        for colours in (table.ambient, table.diffuse, table.highlight,
                        *(c for v in frame.further for c in (v.diffuse, v.highlight))):  # fmt: skip
            colours[:] = colours[:, :1]
    if config.idle_x_bits:
        frame.spans["x"] %= 240
        frame.spans["y"] &= 511
        frame.spans["material"] &= 7
    stray = frame.take(np.arange(len(frame.spans)))
    rng = np.random.default_rng(SEED)
    for word in ("material", "x", "y"):
        rows = rng.random(len(stray.spans)) < 1 / 4
        stray.spans[word][rows] = needs.spans[word][rng.integers(0, 60, rows.sum())]
    return ConfigurationTest(
        config, SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED),
        SimJob(stray), SimJob(frame, writes=_odd_light_writes(needs, config)),
    )  # fmt: skip


def _places(
    lights: int, units: int, half_vectors: bool, falls: bool, coloured: bool, **left_out
) -> ConfigurationTest:
    """Frames in which spans bring half vectors, or distances, on a build for them."""
    config = several(
        lights, units, coloured, span_half_vector=half_vectors, attenuation=falls, **left_out
    )

    def frame(spans: int, longest: int, count: int, two_sided: bool = False) -> Frame:
        seed = [SEED, spans, longest, count]
        made = random_lights(seed, spans, longest, count, two_sided, coloured)
        if not config.specular:
            dull(made, np.random.default_rng(SEED))
        return placed(made, seed, half_vectors, falls)

    most, pixel = frame(200, 7, lights, True), frame(200, 1, lights)
    wild = frame(120, 9, lights)
    if falls:
        wild.depths[:, ::7, 1] = C.depth.max
        wild.spans["step"][::14, 0] = C.normal.max  # a normal leaves its word with a distance
    jobs = [
        SimJob(most), SimJob(most, idle=100, stall=64, seed=SEED), SimJob(pixel), SimJob(wild),
        SimJob(most, stop_after=170, stall=100), SimJob(pixel, reset_first=True, idle=90),
    ]  # fmt: skip
    if lights > 1:
        jobs.append(SimJob(frame(60, 9, 1), stall=50))
    jobs.append(SimJob(most, writes=_odd_light_writes(most, config)))
    return ConfigurationTest(config, *jobs)


#: {name: (lights, units, whether highlights have colours)}.
LIGHTS = {
    "lights 3": (3, 1, False), "lights 8 coloured": (8, 1, True), "lights 5 on 2": (5, 2, True),
    "lights 7 on 4": (7, 4, False), "lights 8 on 8": (8, 8, True), "light coloured": (1, 1, True),
}  # fmt: skip


# -- reflectance by table --------------------------------------------------------------------------


def reflectant(frame: Frame, seed: int, curves: int = MAX_JUMPS, steps: int = MAX_JUMPS) -> Frame:
    """`frame` with random curves and jumps, half of the lines flat, some of extreme codes.

    curves, steps: jumps of each curve and of each W.
    """
    rng, one = np.random.default_rng(seed), C.coefficient.one
    table = dataclasses.replace(frame.materials)
    shape = (C.materials, len(segments(C).first))
    left, right = rng.integers(0, one + 1, (2, *shape))
    step = np.where(rng.random(shape) < 0.5, 0, right - left)
    table.curve = np.stack([left, step], axis=-1)
    table.curve[:, ::17] = (C.coefficient.max, -C.coefficient.max)

    def jumps(fmt, count):
        of = np.zeros((C.materials, MAX_JUMPS, 3), np.int64)
        of[:, :count, 0] = rng.integers(0, 2, (C.materials, count))
        of[:, :count, 1] = rng.integers(0, fmt.max + 1, (C.materials, count))
        of[:, :count, 2] = rng.integers(1, one // 3, (C.materials, count))
        return of

    table.curve_jumps = jumps(C.versine, curves)
    table.weight_jumps = jumps(C.cosine, steps) if steps else None
    return dataclasses.replace(frame, materials=table)


def _curves(name: str, frame: Frame, **changes) -> ConfigurationTest:
    """`frame` on a build with `changes`, with and without stalls, and after other writes."""
    config = dataclasses.replace(C, name=name, **changes)
    rng = np.random.default_rng(SEED)
    bits, most = address_bits(config), 2 << 2 * C.coefficient.bits
    odd = [(int(a), int(rng.integers(most))) for a in rng.permutation(1 << bits)[:3000]]
    return ConfigurationTest(
        config, SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED),
        SimJob(frame, writes=odd + writes(frame, config)),
    )  # fmt: skip


def _pruned_curves() -> ConfigurationTest:
    """Two materials of one block RAM, on the build that is pruned to them."""
    frame = reflectant(plain(), SEED, 2, 1)
    frame.spans["material"] &= 1
    config = pruning.prune(frame)[0]
    assert config.has_curves and config.idle_material_bits == C.material_bits - 1
    return ConfigurationTest(
        config, SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED),
        full=fitted(C, frame),
    )  # fmt: skip


def _lights_curves() -> ConfigurationTest:
    """Three lights on two units, with curves and jumps. No write of the frame may be flagged: the
    fields of the jumps are those of the factors of the distance in other builds."""
    frame = reflectant(random_lights(SEED, 200, 7, 3, True), SEED)
    config = fitted(C, frame, 2)
    assert not any(unsupported_light_write(*word, config) for word in writes(frame, config))
    return ConfigurationTest(
        config, SimJob(frame), SimJob(frame, idle=100, stall=64, seed=SEED),
        SimJob(frame, writes=_odd_light_writes(frame, config)),
    )  # fmt: skip


def in_words_of(config: Config, frame: Frame) -> Frame:
    """`frame`, whose codes are in the default formats, in the narrower formats of `config`."""
    drop = C.normal.fraction - config.normal.fraction
    spans, materials = frame.spans.copy(), dataclasses.replace(frame.materials)
    for word in ("start", "step"):
        spans[word] >>= drop
    drop = C.coefficient.fraction - config.coefficient.fraction
    for table in ("ambient", "diffuse", "weight"):
        setattr(materials, table, getattr(materials, table) >> drop)
    drop = C.half_vector.fraction - config.half_vector.fraction
    half = tuple(v >> drop for v in frame.half_vector)
    return dataclasses.replace(frame, spans=spans, materials=materials, half_vector=half)


def _method(name: str) -> ConfigurationTest:
    """The configuration `name` of the precision sweep."""
    config = CONFIGS[name]
    if config.normal_method == "quadratic_spans":
        frames = [front_end(load_scene(*scene), config).frame for scene in SCENES]
        frames.append(dataclasses.replace(frames[1], two_sided=True))
        frames[1].spans["start"][5:9] = frames[1].spans["step"][5:9] = 0  # zero normals
    else:
        frames = [in_words_of(config, frame) for frame in (
            plain(), dataclasses.replace(plain(SEED + 1), two_sided=False))]  # fmt: skip
    jobs = *map(SimJob, frames), SimJob(frames[0], idle=100, stall=64, seed=SEED)
    return ConfigurationTest(config, *jobs)


def _wide() -> ConfigurationTest:
    """Words of 22 bits, whose tables are wider than Verilator's longest literal, and 12-bit
    colours."""
    config = CONFIGURATIONS["colour_12"]
    frames = [front_end(load_scene(*scene), config).frame for scene in SCENES]
    return ConfigurationTest(config, *map(SimJob, frames))


#: {name: function that makes the configuration test}.
CONFIGURATION_TESTS: dict[str, Callable[[], ConfigurationTest]] = {
    "default": _default,
    **{name: functools.partial(_alone, name) for name in ALONE},
    "hold_unlit": _hold,
    "check_writes": _checked,
    "quadratic": _quadratic,
    "quadratic still": _quadratic_still,
    "narrow": lambda: _of(*narrow()),
    "colour_12": _wide,
    **{name: functools.partial(_lights, *what) for name, what in LIGHTS.items()},
    "placed light": lambda: _places(1, 1, True, False, False),
    "placed lights 3": lambda: _places(3, 1, True, True, True),
    "placed lights 5 on 2": lambda: _places(5, 2, True, True, False),
    "falling light": lambda: _places(1, 1, False, True, False),
    "falling light coloured": lambda: _places(1, 1, False, True, True),
    "falling light matte": lambda: _places(1, 1, True, True, False, specular=False),
    "falling light curve": lambda: _places(1, 1, False, True, False, power_method="curve"),
    "lights matte": lambda: _lights_without(specular=False, two_sided=False),
    "lights cosine": lambda: _lights_without(
        power_function=False, power_bypass=False, log_octaves=False, ambient=False
    ),
    "lights glow": lambda: _lights_without(diffuse=False, weight_function=False, coloured=False),
    "lights grey": lambda: _lights_without(
        channels=1, idle_x_bits=4, idle_y_bits=3, idle_material_bits=1
    ),
    "curve": lambda: _curves("curve", plain(), power_method="curve"),
    "curve jumps": lambda: _curves(
        "curve_jumps", reflectant(plain(), SEED), power_method="curve",
        curve_jumps=MAX_JUMPS, weight_jumps=MAX_JUMPS,
    ),
    "curve pruned": _pruned_curves,
    "curve lights": _lights_curves,
    "weight jump": lambda: _curves(
        "weight_jump",
        dataclasses.replace(
            stepped := reflectant(plain(), SEED, 0, 1),
            materials=dataclasses.replace(stepped.materials, curve=None, curve_jumps=None),
        ),
        weight_jumps=1,
    ),
    "single": lambda: _single(),
    "single grey": lambda: _single(grey),
    "single matte": lambda: _single(dull, one_sided),
    "single cosine": lambda: _single(cosine_only, no_ambient),
    "single glow": lambda: _single(no_diffuse, even_weight, sharp),
    **{
        f"{technique} {channels}": functools.partial(_intensities, technique, channels)
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
def configuration_test(name: str) -> ConfigurationTest:
    """The configuration test `name` of CONFIGURATION_TESTS, made once. Raises KeyError."""
    return CONFIGURATION_TESTS[name]()


# -- random scenes ---------------------------------------------------------------------------------


def random_scene(seed: int) -> Frame:
    """A random frame that needs a random choice of features."""
    rng = np.random.default_rng(seed)
    frame = random_frame(seed, 120, 16, two_sided=bool(rng.random() < 0.5))
    for change in (dull, even_weight, no_diffuse, no_ambient, grey, one_exponent, one_weight,
                   one_ambient, one_diffuse, cosine_only, sharp, tables_only):  # fmt: skip
        if rng.random() < 0.2:
            change(frame, rng)
    used = rng.choice(C.materials, rng.choice([1, 1, 2, 5, 16]), replace=False)
    frame.spans["material"] = rng.choice(used, len(frame.spans))
    return frame


def random_configuration_test(seed: int) -> ConfigurationTest:
    """Random scene `seed` on the build that is pruned to the scene."""
    frame = random_scene(seed)
    return ConfigurationTest(pruning.prune(frame)[0], SimJob(frame), full=C)
