# SPDX-License-Identifier: MIT
"""The configuration: every width, table size and feature of the pipeline, in one object.

Nothing else in the project writes a width. The Verilog header that the RTL includes, the twin, the
tables, the span file and the error budget are all derived from a `Config`.

Formats are written in Q notation: `s<integer>.<fraction>` is two's complement with a sign bit
beside the integer bits, `u<integer>.<fraction>` is unsigned. The value of a word is
`code / 2**fraction`.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from phong75.model.arrays import ArrayLike, Flags, Ints, Reals

#: The largest number of lights of a build.
MAX_LIGHTS = 8

#: The largest number of jumps of W(i), and of a curve of cos(s), of one material.
MAX_JUMPS = 4

#: The largest exponent n that the hardware is specified for.
MAX_EXPONENT = 128

#: Possible numbers of shading units side by side.
UNITS = (1, 2, 4, 8)

#: Fields of `Config` that keep their default in a build that sums lights: each describes the normal
#: in the one light's frame, or a value that each light has for itself.
ONE_LIGHT_ONLY = (
    "normal_order", "interpolate_x", "interpolate_y", "interpolate_z", "constant_shift",
    "idle_step_bits", "hold_unlit", "check_writes", "constant_half_vector", "constant_exponent",
    "constant_weight", "constant_ambient", "constant_diffuse",
)  # fmt: skip


@dataclass(frozen=True)
class Format:
    """A fixed-point word: `signed` or not, number of `integer` bits and of `fraction` bits."""

    signed: bool
    integer: int
    fraction: int

    @property
    def bits(self) -> int:
        """Width of the word in bits, sign included."""
        return int(self.signed) + self.integer + self.fraction

    @property
    def one(self) -> int:
        """The code of 1.0. An `s0.f` or `u0.f` word cannot hold this code: see `max`."""
        return 1 << self.fraction

    @property
    def min(self) -> int:
        """The smallest code."""
        return -(1 << (self.bits - 1)) if self.signed else 0

    @property
    def max(self) -> int:
        """The largest code."""
        return (1 << (self.bits - int(self.signed))) - 1

    @property
    def lsb(self) -> float:
        """The value of one unit in the last place."""
        return 2.0**-self.fraction

    def quantize(self, value: ArrayLike) -> Ints:
        """Codes (int64) of the reals `value` (any shape): rounded half up, clamped to the
        format."""
        codes = np.floor(np.ldexp(np.asarray(value, dtype=np.float64), self.fraction) + 0.5)
        return np.clip(codes, self.min, self.max).astype(np.int64)

    def wrap(self, code: Ints) -> Ints:
        """The integers `code` (any shape) modulo the word of this signed format, as an adder
        leaves them."""
        sign = 1 << (self.bits - 1)
        return ((code + sign) & ((sign << 1) - 1)) - sign

    def real(self, code: ArrayLike) -> Reals:
        """The value (float64) of `code` (any shape)."""
        return np.ldexp(np.asarray(code, dtype=np.float64), -self.fraction)

    def contains(self, code: ArrayLike) -> Flags:
        """Whether each of the integers `code` (any shape) is a code of this format."""
        code = np.asarray(code)
        return (code >= self.min) & (code <= self.max)

    def __str__(self) -> str:
        return f"{'s' if self.signed else 'u'}{self.integer}.{self.fraction}"


def choice(*names: str) -> Any:
    """A field of `Config` that holds one of `names`, by default the first.

    In the Verilog header the macro PHONG_<FIELD> holds the number of the choice in `names`, from 0;
    a macro PHONG_<FIELD>_<NAME> holds the number of each name.
    """
    return field(default=names[0], metadata={"names": names})


def constants(*names: str) -> Any:
    """A field of `Config` that holds codes of one frame, one for each of `names`, as constants of
    the hardware; or () if the hardware must not rely on them.

    In the Verilog header the macro PHONG_<FIELD> is 1 or 0; PHONG_<FIELD>_<NAME> is the code, or 0;
    PHONG_<FIELD>_LEVELS is the number of cycles of a product with the constant (see
    `twin.pruning.constant_multiplier`).
    """
    return field(default=(), metadata={"constants": names})


def _signed(integer: int, fraction: int) -> Any:
    return field(default=Format(True, integer, fraction))


def _unsigned(integer: int, fraction: int) -> Any:
    return field(default=Format(False, integer, fraction))


@dataclass(frozen=True)
class Config:
    """Formats, table sizes and features of one pipeline, in the order of the data.

    Raises ValueError if a choice is not one of its names, `channels` is neither 1 nor 3,
    `normal_order` is neither 1 nor 2, or 2 where no normal is interpolated, there are too many
    jumps, or the lights do not fit their units or the features (see `_check_lights`).
    """

    name: str = "default"

    def __post_init__(self) -> None:
        for f in dataclasses.fields(self):
            names, value = f.metadata.get("names"), getattr(self, f.name)
            if names and value not in names:
                raise ValueError(f"{f.name} is `{value}`, not one of {', '.join(names)}")
        if self.channels not in (1, 3):
            raise ValueError(f"channels is {self.channels}, not 1 or 3")
        if self.normal_order not in (1, 2):
            raise ValueError(f"normal_order is {self.normal_order}, not 1 or 2")
        if self.normal_order == 2 and (self.technique != "phong" or self.spans_carry_squares):
            raise ValueError("normal_order is 2, but spans carry no normal")
        self._check_reflectance()
        self._check_lights()

    def _check_reflectance(self) -> None:
        """Raise ValueError for curves or jumps that the build has no place for."""
        for name in ("curve_jumps", "weight_jumps"):
            if not 0 <= getattr(self, name) <= MAX_JUMPS:
                raise ValueError(f"{name} is {getattr(self, name)}, not 0 to {MAX_JUMPS}")
        if self.curve_jumps and self.power_method != "curve":
            raise ValueError("curve_jumps are for power_method `curve`")
        if self.weight_jumps and not self.weight_function:
            raise ValueError("weight_jumps need weight_function")
        if self.power_method == "curve" and self.constant_exponent:
            raise ValueError("constant_exponent is for powers, not for power_method `curve`")
        reflectance = self.power_method == "curve" or self.weight_jumps
        if reflectance and self.check_writes:
            raise ValueError("check_writes is for powers, and for W without jumps")
        if reflectance and self.normal_method == "quadratic_spans":
            raise ValueError("normal_method `quadratic_spans` has neither curves nor jumps")
        if self.attenuation and (self.curve_jumps or self.weight_jumps):
            raise ValueError("attenuation and jumps cannot be in one build: they share addresses")

    def _check_lights(self) -> None:
        """Raise ValueError for lights or units out of range, and for a feature that rtl/lights does
        not have."""
        if not 1 <= self.lights <= MAX_LIGHTS:
            raise ValueError(f"lights is {self.lights}, not 1 to {MAX_LIGHTS}")
        if self.units not in UNITS or self.units > self.lights:
            raise ValueError(
                f"units is {self.units}, not one of {', '.join(map(str, UNITS))} and at most the "
                f"number of lights"
            )
        if not self.sums_lights:
            return
        if self.normal_method != "normalize":
            raise ValueError(f"normal_method `{self.normal_method}` has one light")
        for f in dataclasses.fields(self):
            if f.name in ONE_LIGHT_ONLY and getattr(self, f.name) != f.default:
                raise ValueError(f"{f.name} is for builds with one white light")
        if self.attenuation and not 5 <= self.weight_index_bits <= self.material_bits + 4:
            raise ValueError(
                f"weight_index_bits is {self.weight_index_bits}: attenuation has no addresses"
            )
        if self.attenuation and self.turn_bits > self.material_bits:
            raise ValueError("the table of attenuation has fewer rows than a pixel has turns")

    # -- technique ---------------------------------------------------------------------------------
    # phong interpolates normals, gouraud the intensities of vertices; flat holds one intensity per
    # face.
    technique: str = choice("phong", "gouraud", "flat")

    # -- spans and pixels --------------------------------------------------------------------------
    coordinate_bits: int = 12  # x and y: pictures of up to 4096 x 4096
    normal: Format = _signed(1, 30)  # one component of the interpolated normal; also of its step
    bend_fraction_bits: int = 12  # fraction bits of `bend` beyond those of `normal`
    material_bits: int = 4  # 16 materials
    colour_bits: int = 8  # code of one of red, green, blue

    # -- registers and material table --------------------------------------------------------------
    half_vector: Format = _signed(0, 17)  # one component of h, between light and eye
    coefficient: Format = _unsigned(1, 16)  # Cp d, Cp (1 - d), W: 0 and 1 are exact
    exponent: Format = _unsigned(8, 9)  # n
    weight_index_bits: int = 5  # 32 intervals of W(i) over 0 <= Zn <= 1

    # -- normalizer --------------------------------------------------------------------------------
    mantissa: Format = _signed(0, 17)  # block-normalized component
    root_operand: Format = _unsigned(2, 20)  # |m|**2 scaled into [1, 4)
    root_index_bits: int = 8  # table segments in each of [1, 2) and [2, 4)
    root_value_bits: int = 21  # table value: u0.21
    root_slope_bits: int = 15  # table slope: units of 2**-24 per segment
    root: Format = _unsigned(0, 18)  # 1/sqrt, in (1/2, 1]
    unit: Format = _signed(0, 17)  # component of the unit normal
    cosine: Format = _unsigned(0, 18)  # cos(i) = Zn

    # -- shading -----------------------------------------------------------------------------------
    versine: Format = _unsigned(0, 22)  # 1 - cos(s), saturated below 1
    log_index_bits: int = 9  # segments of -log2(1 - v), 0 <= v < 1/2
    log_value: Format = _unsigned(0, 22)  # table value
    log_slope_bits: int = 14  # table slope: units of log_value per segment
    log_mantissa_bits: int = 17  # -log2(cos s), normalized, at the product with n
    power_log: Format = _unsigned(5, 16)  # n * -log2(cos s)
    exp_index_bits: int = 9  # segments of 2**-f, 0 <= f < 1
    exp_value: Format = _unsigned(0, 20)  # table value
    exp_slope_bits: int = 11  # table slope: units of exp_value per segment
    power: Format = _unsigned(0, 18)  # cos(s)**n
    weight: Format = _unsigned(1, 17)  # W(i)
    intensity: Format = _unsigned(1, 24)  # S of one channel, before it is scaled to the code

    # -- lights ------------------------------------------------------------------------------------
    # 1 white light at infinity: eq. (3), in rtl/core/; else the sum over lights, in rtl/lights/.
    lights: int = 1  # most lights of a frame, 1 to 8
    units: int = 1  # shading units side by side: 1, 2, 4 or 8, at most `lights`
    highlight_colour: bool = False  # a colour for each light's highlight, or a sum beyond Cp <= 1
    highlight: Format = _unsigned(0, 18)  # W(i) cos(s)**n, rounded before it is coloured
    span_half_vector: bool = False  # each span brings its half vectors: a light at a place
    attenuation: bool = False  # a light that falls with the distance from it
    depth: Format = _signed(1, 29)  # distance from a light, interpolated; 0 to 1 in the table

    # -- features ----------------------------------------------------------------------------------
    # A feature that a scene does not need is left out: see model/analysis/pruning.py. The comment
    # says which scenes need the feature.
    specular: bool = True  # W(i) cos(s)**n: a material with W other than 0
    power_function: bool = True  # cos(s)**n by tables: a material with n other than 1
    power_bypass: bool = True  # cos(s) itself: a material with n = 1 beside others
    log_octaves: bool = True  # cos(s) <= 1/2: an n so small that cos(s)**n is not 0 there
    weight_function: bool = True  # W(i) by a table: a material whose W depends on i
    diffuse: bool = True  # Cp (1 - d) cos(i): a material with d other than 1
    ambient: bool = True  # Cp d: a material with d other than 0
    channels: int = 3  # 1: red, green and blue are equal in all materials
    two_sided: bool = True  # |Zn| in place of Zn: a two-sided frame
    normal_order: int = 1  # 2: normals are quadratic along a span (a scene with mid-edge normals)
    interpolate_x: bool = True  # a span along which the normal's x varies
    interpolate_y: bool = True
    interpolate_z: bool = True
    constant_shift: tuple[int, ...] = constants("by")  # the normalizer shifts all normals alike
    idle_step_bits: int = 0  # top bits of the steps that repeat the sign
    idle_material_bits: int = 0  # top bits of material, x and y that are 0
    idle_x_bits: int = 0
    idle_y_bits: int = 0
    check_writes: bool = False  # values outside what is legal are flagged (see docs/interface.md)
    hold_unlit: bool = False  # pixels that face away from the light toggle nothing (never pruned)
    constant_half_vector: tuple[int, ...] = constants("x", "z")  # hz is 0 or more
    constant_exponent: tuple[int, ...] = constants("n")  # of all materials
    constant_weight: tuple[int, ...] = constants("w")
    constant_ambient: tuple[int, ...] = constants("red", "green", "blue")
    constant_diffuse: tuple[int, ...] = constants("red", "green", "blue")

    # -- other methods for the same result ---------------------------------------------------------
    # The first choice is the default; model/studies/methods.py compares them.
    normal_method: str = choice("normalize", "dot_first", "none", "quadratic_spans")
    squared: Format = _signed(2, 42)  # quadratic_spans: |N|**2 and the cross square, interpolated
    quadratic_mantissa: Format = _unsigned(1, 17)  # quadratic_spans: Zn, aligned
    root_method: str = choice("lines", "quadratic", "table", "fast_inverse")  # of 1/sqrt
    root_newton_steps: int = 0  # table, fast_inverse: steps of Newton's iteration after them
    quadratic_index_bits: int = 4  # parabolas in each of [1, 2) and [2, 4)
    quadratic_value_bits: int = 20  # table value: u0.20
    quadratic_slope_bits: int = 18  # units of 2**-23 per segment
    quadratic_curve_bits: int = 14  # units of 2**-23 per segment squared
    start_index_bits: int = 6  # table: constants in each of [1, 2) and [2, 4), in `root`
    power_method: str = choice("tables", "squaring", "schlick", "curve")  # of cos(s)**n
    reciprocal_index_bits: int = 7  # schlick: lines of 1/m, 1 <= m < 2
    reciprocal_value_bits: int = 20  # table value: u0.20
    reciprocal_slope_bits: int = 14  # units of 2**-20 per segment

    # -- reflectance by table ----------------------------------------------------------------------
    # power_method "curve": any curve of cos(s) per material, in place of cos(s)**n; see
    # model/reflectance.py.
    curve_octave_bits: int = 3  # 8 octaves of 1 - cos(s) below 1/2, and 8 of cos(s) below 1/2
    curve_index_bits: int = 4  # 16 lines an octave
    curve_jumps: int = 0  # jumps of a curve beside those at the end of a line, up to 4
    weight_jumps: int = 0  # jumps of W(i), up to 4

    # -- derived -----------------------------------------------------------------------------------
    @property
    def white(self) -> int:
        """The code of S = 1, the largest of `colour_bits`."""
        return (1 << self.colour_bits) - 1

    @property
    def materials(self) -> int:
        """Number of entries of the material table."""
        return 1 << self.material_bits

    @property
    def weight_points(self) -> int:
        """Number of points of W(i), equally spaced over 0 <= Zn <= 1, both ends included."""
        return (1 << self.weight_index_bits) + 1

    @property
    def segment_bits(self) -> int:
        """Width of the number of a line of a curve."""
        return 1 + self.curve_octave_bits + self.curve_index_bits

    @property
    def has_curves(self) -> bool:
        """Whether the highlight is a curve of a table (`power_method`)."""
        return self.power_method == "curve" and self.specular and self.power_function

    @property
    def values(self) -> int:
        """How many values are interpolated along a span: x, y, z of a normal, or intensities."""
        return 3 if self.technique == "phong" else self.channels

    @property
    def bend(self) -> Format:
        """The format of a bend, with `normal_order` 2: how much the step grows from pixel to pixel.

        A rounded step is wrong by at most half an LSB of `normal`, which becomes (length - 1)/2 LSB
        at the last pixel. A rounded bend becomes (length - 1)(length - 2)/4 LSB of this format
        there. With as many further fraction bits as a coordinate has (12), that is less than
        (length - 2)/4 LSB of `normal`, however long the span: half as much as the step's share.
        """
        return dataclasses.replace(
            self.normal, fraction=self.normal.fraction + self.bend_fraction_bits
        )

    @property
    def spans_carry_squares(self) -> bool:
        """Whether a span carries squares of the normal in place of its x and y (see
        `phong75.model.quadratic_spans`)."""
        return self.technique == "phong" and self.normal_method == "quadratic_spans"

    @property
    def sums_lights(self) -> bool:
        """Whether a pixel is a sum over lights (rtl/lights/), not eq. (3) for one white light."""
        return self.technique == "phong" and (
            self.lights > 1 or self.highlight_colour or self.span_half_vector or self.attenuation
        )

    @property
    def rounds_highlight(self) -> bool:
        """Whether W(i) cos(s)**n of a light is rounded, since it is multiplied once more."""
        return self.highlight_colour or self.attenuation

    @property
    def span_units(self) -> int:
        """How many lights one beat of a span serves: each has a start and a step in it."""
        return self.units if self.sums_lights else 1

    @property
    def turns(self) -> int:
        """Beats of a span, and clocks of a pixel, of a frame with all lights."""
        return -(-self.lights // self.units) if self.sums_lights else 1

    @property
    def turn_bits(self) -> int:
        """Width of the number of a turn, at least 1."""
        return max((self.turns - 1).bit_length(), 1)

    @property
    def light_bits(self) -> int:
        """Width of the light's number in an address of the write port; 0 for one light."""
        return (self.lights - 1).bit_length() if self.sums_lights else 0

    @property
    def max_size(self) -> int:
        """Largest width and height of a picture, and largest length of a span, in pixels."""
        return 1 << self.coordinate_bits

    def as_dict(self) -> dict[str, Any]:
        """All fields, with formats as strings: the `config` of `report.json`."""
        return {
            f.name: str(v) if isinstance(v := getattr(self, f.name), Format) else v
            for f in dataclasses.fields(self)
        }

    @property
    def digest(self) -> str:
        """A short hash of all fields, which names builds."""
        text = json.dumps(self.as_dict(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:12]


DEFAULT = Config()

#: The configuration of each technique by name.
TECHNIQUES = {
    "phong": DEFAULT,
    "gouraud": Config(name="gouraud", technique="gouraud"),
    "flat": Config(name="flat", technique="flat"),
}

#: Builds for eight lights of all colours: in turns, side by side, and mixes of both.
LIGHT_BUILDS = {
    name: Config(name=name, lights=MAX_LIGHTS, units=units, highlight_colour=True)
    for units in UNITS
    for name in [f"lights_{MAX_LIGHTS}" + (f"_units_{units}" if units > 1 else "")]
}

#: Builds with curves of cos(s) by table, and with jumps, by name.
CURVE_BUILDS = {
    "weight_jump": Config(name="weight_jump", weight_jumps=1),
    "curve": Config(name="curve", power_method="curve"),
    "curve_jumps": Config(
        name="curve_jumps", power_method="curve", curve_jumps=MAX_JUMPS, weight_jumps=MAX_JUMPS
    ),
}

#: Builds for one white light: at a place, falling with the distance, and both.
PLACE_BUILDS = {
    "placed_light": Config(name="placed_light", span_half_vector=True),
    "falling_light": Config(name="falling_light", attenuation=True),
    "placed_falling_light": Config(
        name="placed_falling_light", span_half_vector=True, attenuation=True
    ),
}
