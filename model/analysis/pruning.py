# SPDX-License-Identifier: MIT
"""What a frame does not need of the pipeline: the smallest configuration with the same pixels.

`prune` looks at the spans, registers and material table of a frame, all of them integers. It leaves
out every feature that cannot change a pixel of the frame: a term that is zero, a function that is
constant, a bit that is the same in all words. The pixels stay the same bit for bit.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from phong75.model.arrays import Flags, Ints, Spans
from phong75.model.config import DEFAULT, MAX_JUMPS, TECHNIQUES, UNITS, Config
from phong75.model.frame import Frame, with_lights
from phong75.model.reflectance import jump_count
from phong75.model.twin.core.normalizer import leading_zeros
from phong75.model.twin.core.phong_unit import interpolate
from phong75.model.twin.core.register_map import vanishing_exponent
from phong75.model.twin.core.span_walker import walk


@dataclass(frozen=True)
class FeatureRow:
    """A feature: whether the frame needs the feature, the fact that decides so, and what hardware
    is saved without the feature."""

    feature: str
    needed: bool
    why: str
    saves: str


@dataclass(frozen=True)
class Facts:
    """The facts of a frame that the features depend on.

    materials: int64[m], the rows of the material table that spans name; of those rows: ambient,
    diffuse: int64[m, 3]; weight: int64[m, P]; exponent: int64[m]; curve_jumps, weight_jumps:
    int64[m, J, 3]. two_sided: of the frame. shifts: the different shifts of the block
    normalization, int64, sorted. steps, bends: int64[n, 3], of the spans of more than one pixel.
    further_diffuse: int64[m, 3] of each further light; highlights: int64[m, 3] of each light.
    """

    materials: Ints
    ambient: Ints
    diffuse: Ints
    weight: Ints
    exponent: Ints
    curve_jumps: Ints
    weight_jumps: Ints
    two_sided: bool
    shifts: Ints
    steps: Ints
    bends: Ints
    further_diffuse: list[Ints] = field(default_factory=list)
    highlights: list[Ints] = field(default_factory=list)

    @property
    def shiny(self) -> Flags:
        """Which of the materials have a specular term, bool[m]. Only their exponents count."""
        return np.any(self.weight != 0, axis=1)


def facts(frame: Frame, config: Config) -> Facts:
    """The facts of `frame` for the hardware of `config`."""
    spans = frame.spans
    used = np.unique(frame.spans["material"]).astype(np.int64)
    table, longer = frame.materials, spans["length"] > 1
    return Facts(
        used, table.ambient[used], table.diffuse[used], table.weight[used], table.exponent[used],
        _jumps(table.curve_jumps, used), _jumps(table.weight_jumps, used),
        bool(frame.two_sided), _shifts(spans, config), spans["step"][longer],
        spans["bend"][longer],
        [light.diffuse[used] for light in frame.further],
        [frame.light(number, config).highlight[used] for number in range(frame.lights)],
    )  # fmt: skip


def _jumps(jumps: Ints | None, used: Ints) -> Ints:
    """Rows `used` of `jumps` (int64[M, J, 3]), zeros for None."""
    return np.zeros((len(used), MAX_JUMPS, 3), np.int64) if jumps is None else jumps[used]


def _shifts(spans: Spans, config: Config) -> Ints:
    """The different shifts of the block normalization over all pixels of `spans`, sorted."""
    shifts: set[int] = set()
    for _, pixels in walk(spans, config):
        normal, _ = interpolate(spans, pixels.span, pixels.k, config)
        shifts |= set(np.unique(leading_zeros(normal, config)).tolist())
    return np.array(sorted(shifts), np.int64)


_MATTE = dataclasses.replace(
    DEFAULT, name="diffuse", specular=False, power_function=False, power_bypass=False,
    log_octaves=False, weight_function=False, two_sided=False,
)  # fmt: skip

#: Configurations by hand, beside those of a scene. paper: as in Phong 1975, W is one number per
#: material, n goes "from 1 to 10", and surfaces are one-sided.
BY_HAND = {
    "paper": Config(name="paper", weight_function=False, two_sided=False),
    "diffuse": _MATTE,
    "diffuse grey": dataclasses.replace(_MATTE, name="diffuse-grey", channels=1),
    "gouraud": TECHNIQUES["gouraud"],
    "flat": TECHNIQUES["flat"],
}

#: The fields of `Config` that `prune` decides on. Where `normal_order` is 2, `prune` decides on
#: that as well; the default configuration is without it.
FEATURES = (
    "specular", "power_function", "power_bypass", "log_octaves", "weight_function", "diffuse",
    "ambient", "channels", "two_sided", "constant_half_vector", "constant_exponent",
    "constant_weight", "constant_ambient", "constant_diffuse", "constant_shift", "interpolate_x",
    "interpolate_y", "interpolate_z", "idle_step_bits", "idle_material_bits", "idle_x_bits",
    "idle_y_bits",
)  # fmt: skip


def missing(frame: Frame, built: Config, config: Config = DEFAULT) -> list[str]:
    """What `frame` needs of `config` and `built` leaves out, one line each; empty if the frame
    fits."""
    least, rows = prune(frame, config)
    lines = []
    for row in rows:
        full, here, fits = (getattr(c, row.feature) for c in (config, built, least))
        if here != full and here != fits:
            lines.append(f"{row.feature}: {row.why}")
    return lines


def prune(frame: Frame, config: Config = DEFAULT) -> tuple[Config, list[FeatureRow]]:
    """The configuration without all that `frame` does not need, and the reason for each feature.

    A feature that `config` leaves out stays out. The name is that of `config` and `-pruned`. A
    `config` for one white light gets the lights of the frame first. With lights, constants and
    steps stay in: each light has its own.
    """
    config = with_lights(config, frame)
    if config.technique != "phong":
        return _prune_intensities(frame, config)
    if config.spans_carry_squares:  # span_guard does not read such spans
        why = "the method's spans are not analysed"
        return config, [FeatureRow(feature, True, why, "") for feature in FEATURES]
    pruner = _Pruner(frame, config)
    pruner.terms()
    pruner.jumps()
    if config.sums_lights:
        pruner.lights()
    else:
        pruner.constants()
        pruner.normals()
    pruner.widths()
    return dataclasses.replace(config, name=f"{config.name}-pruned", **pruner.chosen), pruner.rows


class _Pruner:
    """Decides on the features of one frame: a row for each, in the order of FEATURES.

    chosen: {feature: value} of those that are not needed.
    """

    def __init__(self, frame: Frame, config: Config) -> None:
        self.config, self.spans, self.half_vector = config, frame.spans, frame.half_vector
        self.frame = frame
        self.facts = facts(frame, config)
        self.rows: list[FeatureRow] = []
        self.chosen: dict[str, Any] = {}
        shiny = self.facts.shiny
        n, one = self.facts.exponent[shiny], config.exponent.one
        self.exponents = n
        self.specular = bool(shiny.any())
        self.power = bool((n != one).any()) or (self.specular and config.power_method == "schlick")
        self.weight_varies = (self.facts.weight != self.facts.weight[:, :1]).any(axis=1)
        self.weight_varies |= self.facts.weight_jumps[..., 2].any(axis=1)
        if config.power_method == "curve":
            self.power = self.specular

    def decide(
        self, feature: str, needed: object, why: str, saves: str, without: object = False
    ) -> None:
        """Add the row of `feature`; where it is not needed, its value becomes `without`."""
        self.rows.append(FeatureRow(feature, bool(needed), why, saves))
        if not needed:
            self.chosen[feature] = without

    def fold(
        self, feature: str, used: bool, codes: Ints | Sequence, why: str, saves: str, unused: str
    ) -> None:
        """Make a value of the frame a constant of the build, if it is used and `codes` has one
        row."""
        constant = tuple(int(c) for c in np.ravel(codes[0])) if used and len(codes) == 1 else ()
        needed = used and not constant
        self.decide(feature, needed, why if used else unused, saves, without=constant)

    def terms(self) -> None:
        """The terms of eq. (3), and the functions in them."""
        config, f, n, one = self.config, self.facts, self.exponents, self.config.exponent.one
        count, tables = len(f.materials), config.power_method == "tables"
        self.decide(
            "specular", self.specular, _some(int(f.shiny.sum()), count, "W is other than 0"),
            "reflection, power, W(i), the unit normal's x and y",
        )  # fmt: skip
        sharp = _some(int((n != one).sum()), len(n), "n is other than 1")
        self.decide(
            "power_function", self.power, sharp if self.specular else "no highlight",
            "tables of log and exp, product with n" if tables
            else f"power by {config.power_method}",
        )  # fmt: skip
        none = f"power by {config.power_method} has none" if self.power else "no power"
        self.decide(
            "power_bypass", self.power and ((n == one).any() or not tables),
            _some(int((n == one).sum()), len(n), "n is 1") if self.power and tables else none,
            "cos(s) kept beside the power",
        )  # fmt: skip
        least, limit = min(n[n != one], default=0), vanishing_exponent(config)
        self.decide(
            "log_octaves", self.power and (least < limit or not tables),
            f"smallest n is {config.exponent.real(least):g}; from {config.exponent.real(limit):g} "
            "on, 2^-n is 0" if self.power and tables else none,
            "leading ones of 1 - cos(s) and their shifter",
        )  # fmt: skip
        varies = self.weight_varies
        self.decide(
            "weight_function", varies.any(), _some(int(varies.sum()), count, "W depends on i"),
            "table of W(i) and its product",
        )  # fmt: skip
        lit = np.any([d.any(axis=1) for d in (f.diffuse, *f.further_diffuse)], axis=0)
        self.decide(
            "diffuse", lit.any(), _some(int(lit.sum()), count, "Cp (1 - d) is other than 0"),
            "product with cos(i) in each channel",
        )  # fmt: skip
        dark = f.ambient.any(axis=1)
        self.decide(
            "ambient", dark.any(), _some(int(dark.sum()), count, "Cp d is other than 0"),
            "table and sum of Cp d in each channel",
        )  # fmt: skip
        coloured = np.zeros(count, bool)
        for colour in (f.ambient, f.diffuse, *f.further_diffuse, *f.highlights):
            coloured |= (colour != colour[:, :1]).any(axis=1)
        self.decide(
            "channels", coloured.any(),
            _some(int(coloured.sum()), count, "red, green and blue differ"),
            "two of three channels", without=1,
        )  # fmt: skip
        sides = "two" if f.two_sided else "one"
        self.decide("two_sided", f.two_sided, f"the frame is {sides}-sided", "turning of Zn")

    def jumps(self) -> None:
        """How many jumps W and the curves of cos(s) have."""
        f = self.facts
        for name, jumps, built in (
            ("curve_jumps", f.curve_jumps, self.config.curve_jumps),
            ("weight_jumps", f.weight_jumps, self.config.weight_jumps),
        ):
            least = jump_count(jumps) if self.specular else 0
            if built:
                self.decide(
                    name, least == built, f"{least} jumps in a material", "comparators, amounts",
                    without=least,
                )  # fmt: skip

    def lights(self) -> None:
        """How many lights, whether their highlights have colours, and where the lights are."""
        config, count = self.config, self.frame.lights
        placed = self.frame.half_vectors is not None and self.specular
        falls = self.frame.falloff is not None
        # One light with a sum beyond 1 needs the wide sum of a build for several.
        alone = config.highlight_colour or (placed and config.span_half_vector) or falls
        least = count if count > 1 or alone else 2
        self.decide(
            "lights", least == config.lights, f"{count} light{'s' if count > 1 else ''}",
            "contexts of the interpolators, entries of the tables", without=least,
        )  # fmt: skip
        if self.chosen.get("lights", config.lights) < config.units:
            self.chosen["units"] = max(u for u in UNITS if u <= least)
        self.decide(
            "highlight_colour", config.highlight_colour == self.specular,
            "no highlight" if not self.specular else "decides the rounding of the highlight",
            "product with ks Ls in each channel",
        )  # fmt: skip
        if config.span_half_vector:
            why = "no highlight" if not self.specular else "a light is at a place"
            self.decide(
                "span_half_vector", placed,
                why if self.frame.half_vectors is not None else "every light is at infinity",
                "half vectors that pass beside the normals",
            )  # fmt: skip
        if config.attenuation:
            why = "a light falls" if falls else "no light falls"
            self.decide(
                "attenuation", falls, f"{why} with the distance",
                "interpolator of the distance, table of factors, two products",
            )  # fmt: skip

    def constants(self) -> None:
        """Values that are the same in the whole frame."""
        f, sums = self.facts, "its multiplier becomes a sum of shifted words"
        hx, hz = self.half_vector
        self.fold(
            "constant_half_vector", self.specular, [(hx, hz)] if hz >= 0 else [],
            f"h = ({hx}, {hz}) in the whole frame", f"its registers; {sums} (three)",
            "no highlight",
        )  # fmt: skip
        values = np.unique(self.exponents)
        curves = self.config.power_method == "curve"
        self.fold(
            "constant_exponent", self.power, values[:0] if curves else values,
            "a curve has no n" if curves else _many(len(values), "exponent n"),
            f"table of n; {sums}", "no power",
        )  # fmt: skip
        varies = self.weight_varies.any()
        values = f.weight[:0, 0] if varies else np.unique(f.weight[:, 0])
        self.fold(
            "constant_weight", self.specular, values,
            "W depends on i" if varies else _many(len(values), "weight W"),
            f"table of W; {sums}", "no highlight",
        )  # fmt: skip
        for feature, codes, saves in (
            ("constant_ambient", f.ambient, "table of Cp d in each channel"),
            ("constant_diffuse", f.diffuse, f"table of Cp (1 - d) in each channel; {sums}"),
        ):
            values = np.unique(codes, axis=0)
            why = _many(len(values), "colour of the term")
            self.fold(feature, bool(codes.any()), values, why, saves, "the term is 0")

    def normals(self) -> None:
        """The block normalization and the interpolators."""
        config, shifts = self.config, self.facts.shifts
        if len(shifts) > 1:
            why = f"shifts from {shifts[0]} to {shifts[-1]}"
        else:
            why = f"every normal is shifted by {shifts[0]}" if len(shifts) else "no normal but 0"
        zero_vector = config.normal.bits - 1 in shifts  # must be flagged, which a full build does
        self.decide(
            "constant_shift", len(shifts) > 1 or config.normal_method == "none" or zero_vector, why,
            "leading zeros of the components, their shifters", without=tuple(shifts.tolist()),
        )  # fmt: skip
        bent = int(self.spans["bend"].any(axis=1).sum())
        if config.normal_order == 2:
            self.decide(
                "normal_order", bent, f"the bend is other than 0 in {bent} spans",
                "second differences in the interpolators, and words of the span", without=1,
            )  # fmt: skip
        moves = (self.facts.steps != 0) | (self.facts.bends != 0)
        for axis, name in enumerate("xyz"):
            moving = int(moves[:, axis].sum())
            self.decide(
                f"interpolate_{name}", moving, f"step or bend is other than 0 in {moving} spans",
                "adders of the interpolator",
            )  # fmt: skip

    def widths(self) -> None:
        """Top bits of words that are the same in the whole frame."""
        config, f, spans = self.config, self.facts, self.spans
        steepest = int(np.max(np.where(f.steps < 0, ~f.steps, f.steps), initial=0))
        if config.normal_order == 1 or "normal_order" in self.chosen:
            idle = _idle(steepest, config.normal.bits - 1)
            why = f"steps take {steepest.bit_length() + 1} of {config.normal.bits} bits"
        else:
            idle, why = 0, "steps change along a span"
        if not config.sums_lights:
            self._narrow("idle_step_bits", idle, why, "top bits of the steps")
        right = max(spans["x"] + spans["length"], default=1) - 1
        for feature, largest, bits, word in (
            ("idle_material_bits", max(f.materials, default=0), config.material_bits, "material"),
            ("idle_x_bits", right, config.coordinate_bits, "x"),
            ("idle_y_bits", max(spans["y"], default=0), config.coordinate_bits, "y"),
        ):
            idle = min(_idle(largest, bits), bits - 1)
            self._narrow(feature, idle, f"largest {word} is {largest}", f"top bits of {word}")

    def _narrow(self, feature: str, idle: int, why: str, saves: str) -> None:
        self.decide(feature, not idle, why, saves, without=idle)


def _some(count: int, total: int, property_: str) -> str:
    return f"{property_} in {count or 'none'} of {total} material{'s' if total != 1 else ''}"


def _many(count: int, thing: str) -> str:
    return f"{count} different {thing}" if count != 1 else f"one {thing}"


def _idle(largest: int, bits: int) -> int:
    """How many of `bits` are 0 at the top of `largest`, a word that is 0 or more."""
    return max(bits - int(largest).bit_length(), 0)


def _prune_intensities(frame: Frame, config: Config) -> tuple[Config, list[FeatureRow]]:
    """`prune` for spans that carry intensities: a grey frame needs one interpolator of three."""
    values = frame.spans["start"], frame.spans["step"]
    coloured = np.any([(v != v[:, :1]).any(axis=1) for v in values], axis=0)
    why = f"red, green and blue differ in {int(coloured.sum()) or 'none'} of {len(coloured)} spans"
    row = FeatureRow(
        "channels", bool(coloured.any()), why, "two of three channels, and of the span's words"
    )
    channels = config.channels if row.needed else 1
    return dataclasses.replace(config, name=f"{config.name}-pruned", channels=channels), [row]
