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

from .config import DEFAULT, Config
from .frame import Frame


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
    these with a specular term, whose exponents alone matter.
    """

    materials: np.ndarray
    ambient: np.ndarray
    diffuse: np.ndarray
    weight: np.ndarray
    exponent: np.ndarray
    two_sided: bool

    @property
    def shiny(self) -> np.ndarray:
        """Which of the materials have a specular term, bool[m]."""
        return self.weight.any(axis=1)


def facts(frame: Frame) -> Facts:
    """The facts of `frame`."""
    used = np.unique(frame.spans["material"]).astype(np.int64)
    table = frame.materials
    return Facts(
        used, table.ambient[used], table.diffuse[used], table.weight[used], table.exponent[used],
        bool(frame.two_sided),
    )  # fmt: skip


def vanishing_exponent(config: Config) -> int:
    """The smallest n, in codes, for which cos(s)**n is 0 wherever cos(s) <= 1/2.

    2**-n is cut from a word below 1 of `exp_value`, then rounded half up: that gives 0 once the
    shift by n takes it below half an LSB of `power`.
    """
    return (config.power.fraction + 1) << config.exponent.fraction


#: Fields of `Config` that `prune` decides on.
FEATURES = (
    "specular", "power_function", "power_bypass", "log_octaves", "weight_function", "diffuse",
    "environment", "channels", "two_sided",
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


def prune(frame: Frame, config: Config = DEFAULT) -> tuple[Config, list[Row]]:
    """The configuration with all that `frame` does not need left out, and why, a row a feature.

    Only takes away from `config`, never adds. The name is that of `config` with `pruned` to it.
    """
    if config.technique != "phong":
        return _prune_intensities(frame, config)
    f = facts(frame)
    count = len(f.materials)
    rows: list[Row] = []
    chosen: dict[str, object] = {}

    def decide(feature: str, needed: bool, why: str, saves: str, without=False):
        rows.append(Row(feature, bool(needed), why, saves))
        if not needed and getattr(config, feature):
            chosen[feature] = without
        return needed

    one = config.exponent.one
    shiny = f.shiny
    n = f.exponent[shiny]
    specular = decide(
        "specular", shiny.any(), _some(int(shiny.sum()), count, "W is other than 0"),
        "reflection, power, W(i), the unit normal's x and y",
    )  # fmt: skip
    power = decide(
        "power_function", (n != one).any(),
        _some(int((n != one).sum()), len(n), "n is other than 1") if specular else "no highlight",
        "tables of log and exp, product with n",
    )  # fmt: skip
    decide(
        "power_bypass", power and (n == one).any(),
        _some(int((n == one).sum()), len(n), "n is 1") if power else "n is 1 or nothing",
        "cos(s) kept beside the power",
    )  # fmt: skip
    least, limit = min(n[n != one], default=0), vanishing_exponent(config)
    decide(
        "log_octaves", power and least < limit,
        f"smallest n is {config.exponent.real(least):g}; "
        f"from {config.exponent.real(limit):g} on, 2^-n is 0" if power else "no power",
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
        "environment", dark.any(), _some(int(dark.sum()), count, "Cp d is other than 0"),
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
