# SPDX-License-Identifier: MIT
"""The configurations of the precision sweep, and the frames that they are measured on.

One curve a method: what the sweep varies along it is its `label`. Every configuration is built,
simulated and compared with its twin like the default one.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from phong75.model.config import DEFAULT, Config, Format

#: The widest word that one multiplier of the chip takes.
MULTIPLIER_BITS = 18

_DATA = Path(__file__).parent.parent / "data"

#: Scene (name or file), size (None: the file's own), and what it is there for.
FRAMES = (
    ("teapot", (320, 240), "spans of 1 to 14 pixels, n = 10"),
    (str(_DATA / "highlights.toml"), None, "facets of 22.5 degrees, n = 10, 32 and 128"),
    (str(_DATA / "facets.toml"), None, "|N| down to 0.58, spans up to 425 pixels, n = 32"),
)


@dataclass(frozen=True)
class Point:
    """A configuration on a chart: `label` says where on the curve of `method` it is."""

    config: Config
    method: str
    label: str


def of_width(bits: int, name: str = "", **changes) -> Config:
    """The pipeline with words of `bits` bits, 10 to 18: the default's formats, all in proportion.

    Each word keeps its distance in bits from the multiplier's width: 18 gives the default. Tables
    lose an index bit for every two bits of width, since the error of a line falls with the square
    of its length. n keeps its format: it is a parameter, not a signal. changes: as for `replace`.
    """
    less = MULTIPLIER_BITS - bits
    half = less // 2
    d = DEFAULT

    def narrower(fmt: Format) -> Format:
        return Format(fmt.signed, fmt.integer, fmt.fraction - less)

    formats = {
        field.name: narrower(value)
        for field in dataclasses.fields(d)
        if isinstance(value := getattr(d, field.name), Format) and field.name != "exponent"
    }
    config = dataclasses.replace(
        d,
        name=name or f"width_{bits}",
        log_mantissa_bits=d.log_mantissa_bits - less,
        **formats
        | _lines(d.root_index_bits - half, d.root_value_bits - less)
        | _parabolas(d.quadratic_index_bits - less // 3, d.quadratic_value_bits - less)
        | _powers(d.log_index_bits - half, d.exp_index_bits - half, less),
        reciprocal_index_bits=d.reciprocal_index_bits - half,
        reciprocal_value_bits=d.reciprocal_value_bits - less,
        reciprocal_slope_bits=d.reciprocal_slope_bits - less + half,
    )
    return dataclasses.replace(config, **changes)


def _lines(index_bits: int, value_bits: int) -> dict:
    """The table of lines for 1/sqrt: the first slope is half a segment's length."""
    return {
        "root_index_bits": index_bits,
        "root_value_bits": value_bits,
        "root_slope_bits": value_bits + 2 - index_bits,
    }


def _parabolas(index_bits: int, value_bits: int) -> dict:
    """The table of parabolas for 1/sqrt: slope as for lines; the first curve is 3/8 length**2."""
    return {
        "quadratic_index_bits": index_bits,
        "quadratic_value_bits": value_bits,
        "quadratic_slope_bits": value_bits + 2 - index_bits,
        "quadratic_curve_bits": value_bits + 2 - 2 * index_bits,
    }


def _powers(log_index_bits: int, exp_index_bits: int, less: int = 0) -> dict:
    """The tables of log2 and 2**-f in words `less` bits narrower; slopes that fit a multiplier."""
    d = DEFAULT
    # The steepest line of log2 rises 2.9 times its length (in v); half as many segments as codes.
    log_fraction = min(d.log_value.fraction - less, MULTIPLIER_BITS - 1 + log_index_bits)
    return {
        "log_index_bits": log_index_bits,
        "log_value": Format(False, 0, log_fraction),
        "log_slope_bits": log_fraction + 1 - log_index_bits,
        "exp_index_bits": exp_index_bits,
        "exp_slope_bits": d.exp_value.fraction - less - exp_index_bits,
    }


def _operand(index_bits: int) -> dict:
    """An operand of 1/sqrt short enough that the place in a segment fits a multiplier."""
    fraction = min(DEFAULT.root_operand.fraction, MULTIPLIER_BITS - 1 + index_bits)
    return {"root_operand": Format(False, 2, fraction)}


def _interpolator(fraction: int) -> Config:
    """Interpolators of `fraction` bits. Only where those are fewer than the normalizer's are its
    mantissas shorter, too: there is nothing to fill them with."""
    d = DEFAULT
    mantissa = min(d.mantissa.fraction, fraction)
    operand = min(d.root_operand.fraction, 2 * mantissa - 3)
    return dataclasses.replace(
        d, name=f"interpolator_{fraction}", normal=Format(True, 1, fraction),
        mantissa=Format(True, 0, mantissa), root_operand=Format(False, 2, operand),
    )  # fmt: skip


def _root(name: str, **changes) -> Config:
    return dataclasses.replace(DEFAULT, name=name, **changes)


def points() -> list[Point]:
    """All points of the sweep, curve by curve; the first is the default."""
    out = [Point(DEFAULT, "default", "18 bits")]
    out += [
        Point(_interpolator(f), "interpolator bits", f"{f} fraction bits")
        for f in range(10, DEFAULT.normal.fraction, 2)
    ]
    out += [Point(of_width(w), "word width", f"{w} bits") for w in range(10, MULTIPLIER_BITS)]
    out += [
        Point(
            _root(f"lines_{2 << k}", **_operand(k), **_lines(k, min(21, 16 + k))),
            "1/sqrt: lines", f"{2 << k} lines",
        )
        for k in range(2, DEFAULT.root_index_bits)
    ]  # fmt: skip
    out += [
        Point(
            _root(
                f"parabolas_{2 << k}", root_method="quadratic", **_operand(k),
                **_parabolas(k, min(21, 16 + k)),
            ),
            "1/sqrt: parabolas", f"{2 << k} parabolas",
        )
        for k in range(1, 6)
    ]  # fmt: skip
    out += [
        Point(
            _root(f"table_{2 << k}", root_method="table", start_index_bits=k),
            "1/sqrt: table only", f"{2 << k} constants",
        )
        for k in (2, 4, 6, 8, 10)
    ]  # fmt: skip
    out += [
        Point(
            _root(
                f"table_{2 << k}_newton", root_method="table", start_index_bits=k,
                root_newton_steps=1,
            ),
            "1/sqrt: table + Newton", f"{2 << k} constants + 1 step",
        )
        for k in (2, 4, 6)
    ]  # fmt: skip
    out += [
        Point(
            _root(f"fast_inverse_{steps}", root_method="fast_inverse", root_newton_steps=steps),
            "1/sqrt: 0x5f3759df + Newton", f"{steps} step{'s' * (steps != 1)}",
        )
        for steps in range(3)
    ]  # fmt: skip
    out.append(Point(_root("not_normalized", normal_method="none"), "not normalized", "18 bits"))
    out += [
        Point(_root(f"power_tables_{1 << k}", **_powers(k, k)), "power: tables", f"2 x {1 << k}")
        for k in range(3, DEFAULT.log_index_bits)
    ]
    out += [
        Point(of_width(w, f"dot_first_{w}", normal_method="dot_first"), "dot then scale",
              f"{w} bits")
        for w in range(12, MULTIPLIER_BITS + 1, 2)
    ]  # fmt: skip
    out += [
        Point(of_width(w, f"quadratic_spans_{w}", normal_method="quadratic_spans"),
              "squares by differences", f"{w} bits")
        for w in range(12, MULTIPLIER_BITS + 1, 2)
    ]  # fmt: skip
    for power_method, method in (("squaring", "power: squaring"), ("schlick", "power: Schlick")):
        out += [
            Point(of_width(w, f"{power_method}_{w}", power_method=power_method), method,
                  f"{w} bits")
            for w in (12, 14, 16, 18)
        ]  # fmt: skip
    return out


#: The sweep's configurations by name.
CONFIGS = {point.config.name: point.config for point in points()}
