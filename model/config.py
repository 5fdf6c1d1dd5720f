"""The one configuration object: every width, table size and feature of the pipeline.

Nothing else in the project writes a width. The Verilog header that the RTL includes, the twin,
the tables, the span file and the error budget are all derived from a `Config`.

Formats are written `s<integer>.<fraction>` (two's complement, sign bit extra) and
`u<integer>.<fraction>` (unsigned); the value of a word is `code / 2**fraction`.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Format:
    """A fixed-point word: `signed`, number of `integer` bits and of `fraction` bits."""

    signed: bool
    integer: int
    fraction: int

    @property
    def bits(self) -> int:
        """Width of the word in bits, sign included."""
        return int(self.signed) + self.integer + self.fraction

    @property
    def one(self) -> int:
        """The code of 1.0 (which an `s0.f` or `u0.f` word cannot hold: see `max`)."""
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

    def quantize(self, value) -> np.ndarray:
        """Round real `value` (any shape) half up to codes (int64), saturated to the format."""
        codes = np.floor(np.ldexp(np.asarray(value, dtype=np.float64), self.fraction) + 0.5)
        return np.clip(codes, self.min, self.max).astype(np.int64)

    def real(self, code) -> np.ndarray:
        """The float64 value of `code` (any shape)."""
        return np.ldexp(np.asarray(code, dtype=np.float64), -self.fraction)

    def contains(self, code) -> np.ndarray:
        """Whether each of the integers `code` is a code of this format (bool, same shape)."""
        code = np.asarray(code)
        return (code >= self.min) & (code <= self.max)

    def __str__(self) -> str:
        return f"{'s' if self.signed else 'u'}{self.integer}.{self.fraction}"


def choice(*names: str):
    """A field that is one of `names`, the first by default.

    In the Verilog header it becomes its place in `names`: PHONG_<FIELD>, with a macro
    PHONG_<FIELD>_<NAME> for each name to compare it with.
    """
    return field(default=names[0], metadata={"names": names})


def constants(*names: str):
    """A field that holds a frame's own codes, one for each of `names`, where the hardware may rely
    on them, or () where it may not.

    In the Verilog header: PHONG_<FIELD>, 0 or 1; PHONG_<FIELD>_<NAME>, the codes, or 0; and
    PHONG_<FIELD>_LEVELS, the clocks that products with them take (see `digits`).
    """
    return field(default=(), metadata={"constants": names})


def digits(constant: int) -> int:
    """How many digits other than 0 `constant` (0 or more) has in canonical signed form, digits
    -1, 0 and 1, no two side by side: rtl/constant_multiplier.v adds that many words."""
    return (constant ^ (3 * constant)).bit_count()


def levels(constant: int) -> int:
    """Levels of the tree of additions that multiplies by `constant`, 1 or more."""
    return max(1, (digits(constant) - 1).bit_length())


def _signed(integer: int, fraction: int):
    return field(default=Format(True, integer, fraction))


def _unsigned(integer: int, fraction: int):
    return field(default=Format(False, integer, fraction))


@dataclass(frozen=True)
class Config:
    """Formats, table sizes and features of one pipeline, in the order of the data."""

    name: str = "default"

    def __post_init__(self):
        for f in dataclasses.fields(self):
            names = f.metadata.get("names")
            if names and getattr(self, f.name) not in names:
                said = f"{f.name} is `{getattr(self, f.name)}`, not one of {', '.join(names)}"
                raise ValueError(said)
        if self.channels not in (1, 3):
            raise ValueError(f"channels is {self.channels}, not 1 or 3")

    # -- technique ---------------------------------------------------------------------------------
    technique: str = choice("phong", "gouraud", "flat")  # what is interpolated: normals, or
    #   intensities from the vertices, or nothing: one intensity a face

    # -- spans and pixels --------------------------------------------------------------------------
    coordinate_bits: int = 12  # x and y: pictures of up to 4096 x 4096
    normal: Format = _signed(1, 30)  # what is interpolated, one component; also its step
    material_bits: int = 4  # 16 materials
    colour_bits: int = 8  # code of red, green, blue

    # -- registers and material table --------------------------------------------------------------
    half_vector: Format = _signed(0, 17)  # one component of h, halfway between light and eye
    coefficient: Format = _unsigned(1, 16)  # Cp*d, Cp*(1-d), W: 0 and 1 are exact
    exponent: Format = _unsigned(8, 9)  # n
    weight_index_bits: int = 5  # 32 intervals of W(i) over 0 < Zn <= 1

    # -- normalizer --------------------------------------------------------------------------------
    mantissa: Format = _signed(0, 17)  # block-normalized component
    root_operand: Format = _unsigned(2, 20)  # |m|**2 scaled into [1, 4)
    root_index_bits: int = 8  # table segments in each of [1, 2) and [2, 4)
    root_value_bits: int = 21  # table value: u0.21
    root_slope_bits: int = 15  # table slope: units of 2**-24 a segment
    root: Format = _unsigned(0, 18)  # 1/sqrt, in (1/2, 1]
    unit: Format = _signed(0, 17)  # component of the unit normal
    cosine: Format = _unsigned(0, 18)  # cos(i) = Zn

    # -- shading -----------------------------------------------------------------------------------
    versine: Format = _unsigned(0, 22)  # 1 - cos(s), saturated below 1
    log_index_bits: int = 9  # segments of -log2(1 - v), 0 <= v < 1/2
    log_value: Format = _unsigned(0, 22)  # table value
    log_slope_bits: int = 14  # table slope: units of log_value a segment
    log_mantissa_bits: int = 17  # -log2(cos s) as it enters the multiplication by n
    power_log: Format = _unsigned(5, 16)  # n * -log2(cos s)
    exp_index_bits: int = 9  # segments of 2**-f, 0 <= f < 1
    exp_value: Format = _unsigned(0, 20)  # table value
    exp_slope_bits: int = 11  # table slope: units of exp_value a segment
    power: Format = _unsigned(0, 18)  # cos(s)**n
    weight: Format = _unsigned(1, 17)  # W(i)
    intensity: Format = _unsigned(1, 24)  # S of one channel, before the scale to the code

    # -- features: what a scene does not need is left out (see model/pruning.py) -------------------
    specular: bool = True  # W(i) cos(s)^n: a material with W other than 0
    power_function: bool = True  # cos(s)^n by tables: a material with n other than 1
    power_bypass: bool = True  # cos(s) itself: a material with n = 1 beside others
    log_octaves: bool = True  # cos(s) <= 1/2: an n so small that cos(s)^n is not 0 there
    weight_function: bool = True  # W(i) by a table: a material whose W depends on i
    diffuse: bool = True  # Cp (1 - d) cos(i): a material with d other than 1
    ambient: bool = True  # Cp d: a material with d other than 0
    channels: int = 3  # 1: red, green and blue alike
    two_sided: bool = True  # |Zn| in place of Zn, where a frame asks for it
    interpolate_x: bool = True  # a span along which the normal's x varies
    interpolate_y: bool = True
    interpolate_z: bool = True
    constant_shift: tuple = constants("by")  # of the block normalization, the same for all normals
    idle_step_bits: int = 0  # top bits of the steps that repeat the sign
    idle_material_bits: int = 0  # top bits of material, x and y that are 0
    idle_x_bits: int = 0
    idle_y_bits: int = 0
    hold_unlit: bool = False  # pixels turned away from the light toggle nothing (never pruned)
    constant_half_vector: tuple = constants("x", "z")  # hz 0 or more
    constant_exponent: tuple = constants("n")  # of all materials
    constant_weight: tuple = constants("w")
    constant_ambient: tuple = constants("red", "green", "blue")
    constant_diffuse: tuple = constants("red", "green", "blue")

    # -- other methods for the same job, the first the default (see model/sweep.py) ----------------
    normal_method: str = choice("normalize", "dot_first", "none", "quadratic_spans")
    squared: Format = _signed(2, 42)  # differences: |N|**2 and its part across h, interpolated
    quadratic_mantissa: Format = _unsigned(1, 17)  # differences: Zn, aligned
    root_method: str = choice("lines", "quadratic", "table", "fast_inverse")  # of 1/sqrt
    root_newton_steps: int = 0  # after table or magic: steps of Newton's iteration
    quadratic_index_bits: int = 4  # parabolas in each of [1, 2) and [2, 4)
    quadratic_value_bits: int = 20  # table value: u0.20
    quadratic_slope_bits: int = 18  # units of 2**-23 a segment
    quadratic_curve_bits: int = 14  # units of 2**-23 a segment squared
    start_index_bits: int = 6  # constants in each of [1, 2) and [2, 4), in `root`
    power_method: str = choice("tables", "squaring", "schlick")  # of cos(s)**n
    reciprocal_index_bits: int = 7  # lines of 1/m, 1 <= m < 2
    reciprocal_value_bits: int = 20  # table value: u0.20
    reciprocal_slope_bits: int = 14  # units of 2**-20 a segment

    # -- derived -----------------------------------------------------------------------------------
    @property
    def materials(self) -> int:
        """Number of entries of the material table."""
        return 1 << self.material_bits

    @property
    def weight_points(self) -> int:
        """Number of points of W(i): equally spaced over 0 <= Zn <= 1, both ends included."""
        return (1 << self.weight_index_bits) + 1

    @property
    def values(self) -> int:
        """How many values a span carries over its pixels: a normal's x, y, z, or intensities."""
        return 3 if self.technique == "phong" else self.channels

    @property
    def max_size(self) -> int:
        """Largest width and height of a picture, and largest length of a span, in pixels."""
        return 1 << self.coordinate_bits

    def as_dict(self) -> dict:
        """All fields, formats as strings: the `config` of `report.json`."""
        return {
            f.name: str(v) if isinstance(v := getattr(self, f.name), Format) else v
            for f in dataclasses.fields(self)
        }

    @property
    def digest(self) -> str:
        """A short hash of all fields, to name builds by."""
        text = json.dumps(self.as_dict(), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:12]


DEFAULT = Config()

#: The configuration of each technique by name.
TECHNIQUES = {
    "phong": DEFAULT,
    "gouraud": Config(name="gouraud", technique="gouraud"),
    "flat": Config(name="flat", technique="flat"),
}
