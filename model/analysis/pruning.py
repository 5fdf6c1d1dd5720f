"""What a frame does not need of the pipeline: the smallest configuration with the same pixels.

`prune` looks at the spans, registers and material table of a frame, all of them integers, and
leaves out every feature whose work is the same whatever the hardware does: a term that is zero, a
function that is constant, bits that never differ. The pixels stay the same to the bit; what would
change one is no pruning.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.frame import Frame
from phong75.model.registers import FIELDS
from phong75.model.twin.core.normalizer import leading_zeros
from phong75.model.twin.core.span_walker import span_walker
from phong75.model.twin.phong_pipeline import BLOCK, interpolate


@dataclass(frozen=True)
class Row:
    """A feature: whether the frame needs it, the fact that says so, and what goes without it."""

    feature: str
    needed: bool
    why: str
    saves: str


@dataclass(frozen=True)
class Facts:
    """What the features depend on, of the materials that a frame's spans name.

    ambient, diffuse: int64[m, 3], weight: int64[m, P], exponent: int64[m]; `shiny`: the rows among
    these with a specular term, whose exponents alone matter. shifts: the different shifts of the
    block normalization. steps: int64[n, 3] of the spans of more than one pixel.
    """

    materials: np.ndarray
    ambient: np.ndarray
    diffuse: np.ndarray
    weight: np.ndarray
    exponent: np.ndarray
    two_sided: bool
    shifts: np.ndarray
    steps: np.ndarray

    @property
    def shiny(self) -> np.ndarray:
        """Which of the materials have a specular term, bool[m]."""
        return self.weight.any(axis=1)


def facts(frame: Frame, config: Config) -> Facts:
    """The facts of `frame`."""
    spans = frame.spans
    used = np.unique(frame.spans["material"]).astype(np.int64)
    table = frame.materials
    return Facts(
        used, table.ambient[used], table.diffuse[used], table.weight[used], table.exponent[used],
        bool(frame.two_sided), _shifts(spans, config), spans["step"][spans["length"] > 1],
    )  # fmt: skip


def _shifts(spans: np.ndarray, config: Config) -> np.ndarray:
    """The different shifts of the block normalization over all pixels of `spans`."""
    found = set()
    total = int(np.maximum(spans["length"], 1).sum())
    for first in range(0, total, BLOCK):
        span, k, _, _, _ = span_walker(spans, first, first + BLOCK, config)
        normal, _ = interpolate(spans, span, k, config)
        found |= set(np.unique(leading_zeros(normal, config)).tolist())
    return np.array(sorted(found), np.int64)


def unsupported_spans(frame: Frame, built: Config) -> np.ndarray:
    """Which spans the RTL of `built` flags, bool[n] (of legal spans; see rtl/span_guard.v)."""
    spans = frame.spans
    longer = (spans["length"] > 1)[:, None]
    fixed = [not getattr(built, f"interpolate_{axis}") for axis in "xyz"]
    limit = 1 << (built.normal.bits - 1 - built.idle_step_bits)
    step = spans["step"]
    bad = (longer & (fixed & (step != 0) | (step < -limit) | (step >= limit))).any(axis=1)
    right = spans["x"] + np.maximum(spans["length"], 1) - 1
    for largest, bits, idle in (
        (spans["material"], built.material_bits, built.idle_material_bits),
        (right, built.coordinate_bits, built.idle_x_bits),
        (spans["y"], built.coordinate_bits, built.idle_y_bits),
    ):
        bad |= largest >= 1 << (bits - idle)
    if built.constant_shift:
        full = dataclasses.replace(built, constant_shift=())
        total = int(np.maximum(spans["length"], 1).sum())
        for first in range(0, total, BLOCK):
            span, k, _, _, _ = span_walker(spans, first, first + BLOCK, full)
            normal, _ = interpolate(spans, span, k, full)
            bad[span[leading_zeros(normal, full) != built.constant_shift[0]]] = True
    return bad


def unsupported_write(address: int, word: int, built: Config) -> bool:
    """Whether the RTL of `built` flags a write of `word` to `address` (see rtl/register_map.v)."""
    if built.technique != "phong":
        return False
    index = address & ((1 << built.weight_index_bits) - 1)
    kind = address >> (built.material_bits + built.weight_index_bits)
    code, step = word & built.coefficient.max, word >> built.coefficient.bits
    if kind == 0:  # an interval of W(i)
        if not built.specular:
            return word != 0
        return (not built.weight_function and step != 0) or code not in (
            built.constant_weight or (code,)
        )
    if index == FIELDS["control"]:
        return not built.two_sided and bool(word & 1)
    for field, constant in zip(("half_x", "half_z"), built.constant_half_vector, strict=False):
        if index == FIELDS[field]:
            return (word - constant) % (1 << built.half_vector.bits) != 0
    if index == FIELDS["exponent"]:
        n, one = word & built.exponent.max, built.exponent.one
        if not built.specular:
            return False  # of no use
        if built.constant_exponent:
            return (n,) != tuple(built.constant_exponent)
        if not built.power_function:
            return n != one
        if n == one:
            return not built.power_bypass
        return not built.log_octaves and n < vanishing_exponent(built)
    for field, there, constant in (
        ("ambient", built.ambient, built.constant_ambient),
        ("diffuse", built.diffuse, built.constant_diffuse),
    ):
        channel = index - FIELDS[field]
        if 0 <= channel < 3:
            if channel and built.channels < 3:
                return True
            return (not there and code != 0) or bool(constant and code != constant[channel])
    return False


def _idle(largest: int, bits: int) -> int:
    """How many of `bits` are 0 at the top of `largest`, a word that is 0 or more."""
    return max(bits - int(largest).bit_length(), 0)


def vanishing_exponent(config: Config) -> int:
    """The smallest n, in codes, for which cos(s)**n is 0 wherever cos(s) <= 1/2.

    2**-n is cut from a word below 1 of `exp_value`, then rounded half up: that gives 0 once the
    shift by n takes it below half an LSB of `power`.
    """
    return (config.power.fraction + 1) << config.exponent.fraction


_MATTE = dict(
    specular=False, power_function=False, power_bypass=False, log_octaves=False,
    weight_function=False, two_sided=False,
)  # fmt: skip

#: Configurations by hand, beside those of a scene. paper: W one number a material, "n from 1 to
#: 10", one-sided, as in Phong 1975.
BY_HAND = {
    "paper": Config(name="paper", weight_function=False, two_sided=False),
    "diffuse": Config(name="diffuse", **_MATTE),
    "diffuse grey": Config(name="diffuse-grey", channels=1, **_MATTE),
    "gouraud": TECHNIQUES["gouraud"],
    "flat": TECHNIQUES["flat"],
}

#: Fields of `Config` that `prune` decides on.
FEATURES = (
    "specular", "power_function", "power_bypass", "log_octaves", "weight_function", "diffuse",
    "ambient", "channels", "two_sided", "constant_half_vector", "constant_exponent",
    "constant_weight", "constant_ambient", "constant_diffuse", "constant_shift", "interpolate_x",
    "interpolate_y", "interpolate_z", "idle_step_bits", "idle_material_bits", "idle_x_bits",
    "idle_y_bits",
)  # fmt: skip


def missing(frame: Frame, built: Config, config: Config = DEFAULT) -> list[str]:
    """What `frame` needs of `config` and `built` leaves out, a line each; empty if it fits."""
    least, rows = prune(frame, config)
    lines = []
    for row in rows:
        full, here, fits = (getattr(c, row.feature) for c in (config, built, least))
        if here != full and here != fits:
            lines.append(f"{row.feature}: {row.why}")
    return lines


def _some(count: int, of: int, what: str) -> str:
    return f"{what} in {count or 'none'} of {of} material{'s' if of != 1 else ''}"


def _many(count: int, what: str) -> str:
    return f"{count} different {what}" if count != 1 else f"one {what}"


def prune(frame: Frame, config: Config = DEFAULT) -> tuple[Config, list[Row]]:
    """The configuration with all that `frame` does not need left out, and why, a row a feature.

    Only takes away from `config`, never adds. The name is that of `config` with `pruned` to it.
    """
    if config.technique != "phong":
        return _prune_intensities(frame, config)
    if config.normal_method == "quadratic_spans":  # its spans have other words, and no guard
        why = "the method's spans are not looked into"
        return config, [Row(feature, True, why, "") for feature in FEATURES]
    f = facts(frame, config)
    count = len(f.materials)
    rows: list[Row] = []
    chosen: dict[str, object] = {}

    def decide(feature: str, needed: bool, why: str, saves: str, without=False):
        rows.append(Row(feature, bool(needed), why, saves))
        if not needed:
            chosen[feature] = without
        return needed

    def fold(feature: str, used: bool, codes, why: str, saves: str, unused: str):
        """A value of the frame becomes one of the build if it is used and `codes` has one row."""
        constant = tuple(int(c) for c in np.ravel(codes[0])) if used and len(codes) == 1 else ()
        decide(feature, used and not constant, why if used else unused, saves, without=constant)

    one = config.exponent.one
    shiny = f.shiny
    n = f.exponent[shiny]
    specular = decide(
        "specular", shiny.any(), _some(int(shiny.sum()), count, "W is other than 0"),
        "reflection, power, W(i), the unit normal's x and y",
    )  # fmt: skip
    tables = config.power_method == "tables"
    power = decide(
        "power_function", (n != one).any() or (specular and config.power_method == "schlick"),
        _some(int((n != one).sum()), len(n), "n is other than 1") if specular else "no highlight",
        "tables of log and exp, product with n" if tables else f"power by {config.power_method}",
    )  # fmt: skip
    none = "no power" if not power else f"power by {config.power_method} has none"
    decide(
        "power_bypass", power and ((n == one).any() or not tables),
        _some(int((n == one).sum()), len(n), "n is 1") if power and tables else none,
        "cos(s) kept beside the power",
    )  # fmt: skip
    least, limit = min(n[n != one], default=0), vanishing_exponent(config)
    decide(
        "log_octaves", power and (least < limit or not tables),
        f"smallest n is {config.exponent.real(least):g}; from {config.exponent.real(limit):g} on, "
        "2^-n is 0" if power and tables else none,
        "leading ones of 1 - cos(s) and their shifter",
    )  # fmt: skip
    varies = (f.weight != f.weight[:, :1]).any(axis=1)
    decide(
        "weight_function", varies.any(), _some(int(varies.sum()), count, "W depends on i"),
        "table of W(i) and its product",
    )  # fmt: skip
    lit = f.diffuse.any(axis=1)
    decide(
        "diffuse", lit.any(), _some(int(lit.sum()), count, "Cp (1 - d) is other than 0"),
        "product with cos(i) in each channel",
    )  # fmt: skip
    dark = f.ambient.any(axis=1)
    decide(
        "ambient", dark.any(), _some(int(dark.sum()), count, "Cp d is other than 0"),
        "table and sum of Cp d in each channel",
    )  # fmt: skip
    coloured = (f.ambient != f.ambient[:, :1]).any(axis=1)
    coloured |= (f.diffuse != f.diffuse[:, :1]).any(axis=1)
    decide(
        "channels", coloured.any(),
        _some(int(coloured.sum()), count, "red, green and blue differ"),
        "two of three channels", without=1,
    )  # fmt: skip
    decide(
        "two_sided", f.two_sided, f"the frame is {'two' if f.two_sided else 'one'}-sided",
        "turning of Zn",
    )  # fmt: skip
    sums = "its multiplier becomes a sum of shifted words"
    hx, hz = frame.half_vector
    fold(
        "constant_half_vector", specular, [(hx, hz)] if hz >= 0 else [],
        f"h = ({hx}, {hz}) in the whole frame", f"its registers; {sums} (three)", "no highlight",
    )  # fmt: skip
    values = np.unique(n)
    fold(
        "constant_exponent", power, values, _many(len(values), "exponent n"),
        f"table of n; {sums}", "no power",
    )  # fmt: skip
    values = np.unique(f.weight[:, 0]) if not varies.any() else []
    fold(
        "constant_weight", specular, values,
        "W depends on i" if varies.any() else _many(len(values), "weight W"),
        f"table of W; {sums}", "no highlight",
    )  # fmt: skip
    for feature, codes, saves in (
        ("constant_ambient", f.ambient, "table of Cp d in each channel"),
        ("constant_diffuse", f.diffuse, f"table of Cp (1 - d) in each channel; {sums}"),
    ):
        values = np.unique(codes, axis=0)
        fold(
            feature, codes.any(), values, _many(len(values), "colour of the term"), saves,
            "the term is 0",
        )  # fmt: skip
    shifts = f.shifts
    decide(
        "constant_shift",
        len(shifts) > 1 or config.normal_method == "none"
        or config.normal.bits - 1 in shifts,  # the zero vector, which is to be flagged
        f"shifts from {shifts[0]} to {shifts[-1]}" if len(shifts) > 1
        else f"every normal is shifted by {shifts[0]}" if len(shifts) else "no normal but 0",
        "leading zeros of the components, their shifters", without=tuple(shifts.tolist()),
    )  # fmt: skip
    for axis, name in enumerate("xyz"):
        moving = int((f.steps[:, axis] != 0).sum())
        decide(
            f"interpolate_{name}", moving, f"the step is other than 0 in {moving} spans",
            "adders of the interpolator",
        )  # fmt: skip

    def narrow(feature: str, idle: int, why: str, saves: str):
        decide(feature, not idle, why, saves, without=idle)

    spans = frame.spans
    steepest = int(np.max(np.where(f.steps < 0, ~f.steps, f.steps), initial=0))
    narrow(
        "idle_step_bits", _idle(steepest, config.normal.bits - 1),
        f"steps take {steepest.bit_length() + 1} of {config.normal.bits} bits",
        "top bits of the steps",
    )  # fmt: skip
    for feature, largest, bits, what in (
        ("idle_material_bits", max(f.materials, default=0), config.material_bits, "material"),
        (
            "idle_x_bits",
            max(spans["x"] + spans["length"], default=1) - 1,
            config.coordinate_bits,
            "x",
        ),
        ("idle_y_bits", max(spans["y"], default=0), config.coordinate_bits, "y"),
    ):
        narrow(
            feature, min(_idle(largest, bits), bits - 1), f"largest {what} is {largest}",
            f"top bits of {what}",
        )  # fmt: skip
    return dataclasses.replace(config, name=f"{config.name}-pruned", **chosen), rows


def _prune_intensities(frame: Frame, config: Config) -> tuple[Config, list[Row]]:
    """`prune` where spans carry intensities: for grey, one interpolator will do."""
    values = frame.spans["start"], frame.spans["step"]
    coloured = np.any([(v != v[:, :1]).any(axis=1) for v in values], axis=0)
    why = f"red, green and blue differ in {int(coloured.sum()) or 'none'} of {len(coloured)} spans"
    row = Row(
        "channels", bool(coloured.any()), why, "two of three channels, and of the span's words"
    )
    channels = config.channels if row.needed else 1
    return dataclasses.replace(config, name=f"{config.name}-pruned", channels=channels), [row]
