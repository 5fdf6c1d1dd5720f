# SPDX-License-Identifier: MIT
"""Precision sweep: its configurations, and the frames on which they are measured.

A method is a curve of the charts; along the curve one parameter varies, which the `label` of a
point shows. Every configuration is built, simulated and compared with its twin, as the default
configuration is.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from phong75.model.analysis import metrics, reference
from phong75.model.config import DEFAULT, Config, Format
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end

#: Width of the operands of a multiplier of the FPGA, bits.
MULTIPLIER_BITS = 18

_DATA = Path(__file__).parent.parent / "data"

#: (scene name or file, size or None for the file's own, what the scene tests).
FRAMES = (
    ("teapot", (320, 240), "spans of 1 to 14 pixels, n = 10"),
    (str(_DATA / "highlights.toml"), None, "facets of 22.5 degrees, n = 10, 32 and 128"),
    (str(_DATA / "facets.toml"), None, "|N| down to 0.58, spans up to 425 pixels, n = 32"),
)


@dataclass(frozen=True)
class Point:
    """A point of the sweep: its configuration, its curve `method` and its `label` on the curve."""

    config: Config
    method: str
    label: str


def of_width(bits: int, name: str = "", **changes: Any) -> Config:
    """The configuration with words of `bits` bits, 10 to 22; 18 gives the default formats.

    Every word loses 18 - bits fraction bits, or gains bits - 18. Tables of lines lose one index bit
    per two bits of width, because the error of a line falls with the square of its length. n keeps
    its format: the exponent is a parameter, not a signal. name: of the configuration, by default
    width_<bits>. changes: further fields of `Config`.
    """
    drop = MULTIPLIER_BITS - bits
    half = drop // 2
    d = DEFAULT

    def narrower(fmt: Format) -> Format:
        return Format(fmt.signed, fmt.integer, fmt.fraction - drop)

    formats = {
        field.name: narrower(value)
        for field in dataclasses.fields(d)
        if isinstance(value := getattr(d, field.name), Format) and field.name != "exponent"
    }
    config = dataclasses.replace(
        d,
        name=name or f"width_{bits}",
        log_mantissa_bits=d.log_mantissa_bits - drop,
        **formats
        | _lines(d.root_index_bits - half, d.root_value_bits - drop)
        | _parabolas(d.quadratic_index_bits - drop // 3, d.quadratic_value_bits - drop)
        | _powers(d.log_index_bits - half, d.exp_index_bits - half, drop),
        reciprocal_index_bits=d.reciprocal_index_bits - half,
        reciprocal_value_bits=d.reciprocal_value_bits - drop,
        reciprocal_slope_bits=d.reciprocal_slope_bits - drop + half,
    )
    return dataclasses.replace(config, **changes)


def _lines(index_bits: int, value_bits: int) -> dict:
    """Fields of `Config` for a table of lines for 1/sqrt.

    The largest slope, times the length of a segment, is half that length; this sets the width of
    the slopes.
    """
    return {
        "root_index_bits": index_bits,
        "root_value_bits": value_bits,
        "root_slope_bits": value_bits + 2 - index_bits,
    }


def _parabolas(index_bits: int, value_bits: int) -> dict:
    """Fields of `Config` for a table of parabolas for 1/sqrt.

    The slopes are as wide as those of `_lines`. The largest curvature term is 3/8 length**2; this
    sets the width of the curvatures.
    """
    return {
        "quadratic_index_bits": index_bits,
        "quadratic_value_bits": value_bits,
        "quadratic_slope_bits": value_bits + 2 - index_bits,
        "quadratic_curve_bits": value_bits + 2 - 2 * index_bits,
    }


def _powers(log_index_bits: int, exp_index_bits: int, drop: int = 0) -> dict:
    """Fields of `Config` for the tables of log2 and 2**-f.

    The words are `drop` bits narrower than the default's; the slopes of the lines fit a multiplier.
    """
    d = DEFAULT
    # A segment has the length 2**-(log_index_bits + 1) in v, and the steepest line of log2 rises by
    # 2.9 times the length: less than 2**(log_fraction + 1 - log_index_bits) codes.
    log_fraction = min(d.log_value.fraction - drop, MULTIPLIER_BITS - 1 + log_index_bits)
    return {
        "log_index_bits": log_index_bits,
        "log_value": Format(False, 0, log_fraction),
        "log_slope_bits": log_fraction + 1 - log_index_bits,
        "exp_index_bits": exp_index_bits,
        "exp_slope_bits": d.exp_value.fraction - drop - exp_index_bits,
    }


def _operand(index_bits: int) -> dict:
    """A format of the operand of 1/sqrt for which the offset in a segment fits a multiplier."""
    fraction = min(DEFAULT.root_operand.fraction, MULTIPLIER_BITS - 1 + index_bits)
    return {"root_operand": Format(False, 2, fraction)}


def _interpolator(fraction: int) -> Config:
    """The default configuration with interpolators of `fraction` fraction bits.

    If these are fewer than the fraction bits of the normalizer's mantissas, the mantissas get as
    short.
    """
    d = DEFAULT
    mantissa = min(d.mantissa.fraction, fraction)
    operand = min(d.root_operand.fraction, 2 * mantissa - 3)
    return dataclasses.replace(
        d, name=f"interpolator_{fraction}", normal=Format(True, 1, fraction),
        mantissa=Format(True, 0, mantissa), root_operand=Format(False, 2, operand),
    )  # fmt: skip


def _variant(name: str, **changes: Any) -> Config:
    """The default configuration with another name and `changes`."""
    return dataclasses.replace(DEFAULT, name=name, **changes)


def points() -> list[Point]:
    """All points of the sweep, curve by curve; the first point is the default configuration."""
    out = [Point(DEFAULT, "default", "18 bits")]
    out += [
        Point(_interpolator(f), "interpolator bits", f"{f} fraction bits")
        for f in range(10, DEFAULT.normal.fraction, 2)
    ]
    out += [Point(of_width(w), "word width", f"{w} bits") for w in range(10, MULTIPLIER_BITS)]
    out += [
        Point(
            _variant(f"lines_{2 << k}", **_operand(k), **_lines(k, min(21, 16 + k))),
            "1/sqrt: lines", f"{2 << k} lines",
        )
        for k in range(2, DEFAULT.root_index_bits)
    ]  # fmt: skip
    out += [
        Point(
            _variant(
                f"parabolas_{2 << k}", root_method="quadratic", **_operand(k),
                **_parabolas(k, min(21, 16 + k)),
            ),
            "1/sqrt: parabolas", f"{2 << k} parabolas",
        )
        for k in range(1, 6)
    ]  # fmt: skip
    out += [
        Point(
            _variant(f"table_{2 << k}", root_method="table", start_index_bits=k),
            "1/sqrt: table only", f"{2 << k} constants",
        )
        for k in (2, 4, 6, 8, 10)
    ]  # fmt: skip
    out += [
        Point(
            _variant(
                f"table_{2 << k}_newton", root_method="table", start_index_bits=k,
                root_newton_steps=1,
            ),
            "1/sqrt: table + Newton", f"{2 << k} constants + 1 step",
        )
        for k in (2, 4, 6)
    ]  # fmt: skip
    out += [
        Point(
            _variant(f"fast_inverse_{steps}", root_method="fast_inverse", root_newton_steps=steps),
            "1/sqrt: 0x5f3759df + Newton", f"{steps} step{'s' * (steps != 1)}",
        )
        for steps in range(3)
    ]  # fmt: skip
    out.append(Point(_variant("not_normalized", normal_method="none"), "not normalized", "18 bits"))
    out += [
        Point(_variant(f"power_tables_{1 << k}", **_powers(k, k)), "power: tables", f"2 x {1 << k}")
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


@lru_cache
def perfect() -> dict[str, Any]:
    """The errors (see `metrics.error_metrics`) of perfect rounding on FRAMES: of the nearest codes
    to the shading of the scenes before any rounding, LSB."""
    fronts = [front_end(load_scene(name, size)) for name, size, _ in FRAMES]
    exact = np.concatenate([reference.render_exact(f.frame, f.exact) for f in fronts])
    return metrics.error_metrics(np.floor(exact + 0.5), exact)


#: A configuration of each method with the words of the default at its ports: they run all corner
#: cases.
PORTS_OF_DEFAULT = (
    "default", "quadratic_spans_18", "dot_first_18", "table_2048", "lines_32", "parabolas_8",
    "table_128_newton", "fast_inverse_1", "fast_inverse_2", "not_normalized", "power_tables_32",
    "squaring_18", "schlick_18",
)  # fmt: skip

#: {name: configuration} of the sweep.
CONFIGS = {point.config.name: point.config for point in points()}
