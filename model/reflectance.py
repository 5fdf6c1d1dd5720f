# SPDX-License-Identifier: MIT
"""Reflectance by table: any curve of cos(s) in place of cos(s)**n, and jumps of W(i).

Ohbuchi and Unno (2002) put the reflectance of a material into tables; the PICA200 did so in
hardware. Here a curve is a table of straight lines over the versine v = 1 - cos(s), a word of
`Config.versine`. The lengths of the lines grow by octaves from both ends: below 1/2 by the leading
zeros of v, from 1/2 on by those of v inverted, which is cos(s) minus one LSB. So a highlight of
n = 128 (v near 0) and a curve of n = 1/2 (cos(s) near 0) are both resolved. Neighbouring lines need
not meet. A jump elsewhere than at the end of a line takes a comparator: an amount is subtracted on
one side of a threshold. W(i) takes jumps in the same way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple, Protocol

import numpy as np

from phong75.model.arrays import ArrayLike, Flags, Ints, Reals
from phong75.model.config import MAX_JUMPS, Config, Format

#: Points at which a line is fitted to a curve, both ends included.
SAMPLES = 33


class Jump(NamedTuple):
    """A jump of a function: its place, and the value at and above the place minus that below."""

    place: float
    height: float


class Curve(Protocol):
    """A function on [0, 1] with values from 0 to 1."""

    def at(self, x: ArrayLike, below: bool = False) -> Reals:
        """The values at `x` (any shape), float64; below: the limit from below at a jump."""
        ...

    @property
    def jumps(self) -> list[Jump]:
        """The jumps between 0 and 1, in the order of their places."""
        ...

    def moved(self, places: dict[float, float]) -> Curve:
        """The curve with its jumps at the keys of `places` moved to the values."""
        ...


@dataclass(frozen=True)
class Polyline:
    """Straight lines between points (x, y), constant beyond them.

    x: increasing, but for two equal places in a row, which are a jump. At a jump the second value
    counts.
    """

    x: tuple[float, ...]
    y: tuple[float, ...]

    def at(self, x: ArrayLike, below: bool = False) -> Reals:
        """As in `Curve`."""
        at, px, py = np.asarray(x, np.float64), np.array(self.x), np.array(self.y)
        right = np.searchsorted(px, at, side="left" if below else "right")
        left = np.maximum(right - 1, 0)
        right = np.minimum(right, len(px) - 1)
        width = px[right] - px[left]
        inside = width > 0
        part = np.where(inside, (at - px[left]) / np.where(inside, width, 1), 0)
        # Beyond the first point, `left` and `right` are both the first one, or a jump in it.
        return np.where(
            inside,
            py[left] + part * (py[right] - py[left]),
            np.where(at > px[0] if below else at >= px[0], py[right], py[0]),
        )

    @property
    def jumps(self) -> list[Jump]:
        """As in `Curve`."""
        ends = zip(self.x, self.x[1:], self.y, self.y[1:], strict=False)
        return [Jump(a, d - c) for a, b, c, d in ends if a == b and 0 < a < 1 and c != d]

    def moved(self, places: dict[float, float]) -> Polyline:
        """As in `Curve`."""
        twice = {a for a, b in zip(self.x, self.x[1:], strict=False) if a == b}
        fixed = np.array([place in twice for place in self.x])
        x = np.array([places.get(place, place) if place in twice else place for place in self.x])
        x[fixed] = np.maximum.accumulate(x[fixed])
        # The points between two jumps stay between them.
        lower = np.maximum.accumulate(np.where(fixed, x, -np.inf))
        upper = np.minimum.accumulate(np.where(fixed, x, np.inf)[::-1])[::-1]
        return Polyline(tuple(np.clip(x, lower, upper).tolist()), self.y)


@dataclass(frozen=True)
class Power:
    """The curve c**n; n = 0 gives 1 also at c = 0."""

    n: float

    def at(self, x: ArrayLike, below: bool = False) -> Reals:
        """As in `Curve`."""
        return np.power(np.clip(np.asarray(x, np.float64), 0, 1), self.n)

    @property
    def jumps(self) -> list[Jump]:
        """A power has none."""
        return []

    def moved(self, places: dict[float, float]) -> Power:
        """The power itself."""
        return self


# -- the lines -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Segments:
    """The segments of a curve in the order of their addresses, S in all.

    first: int64[S], the code at which the segment begins; length: int64[S], codes in it. Codes are
    those of v where `mirrored` is 0, else those of v inverted. mirrored: bool[S].
    """

    first: Ints
    length: Ints
    mirrored: Flags

    def versine(self, part: ArrayLike, config: Config) -> Reals:
        """The versine at `part` (float[...], 0 to 1) of each segment's way from its first code,
        float64[..., S]."""
        code = self.first + np.asarray(part, np.float64)[..., None] * self.length
        return np.where(self.mirrored, config.versine.max - code, code) * config.versine.lsb


def segments(config: Config) -> Segments:
    """The segments of the curves of `config`.

    An address is {mirrored, octave, index}. The octave o holds the codes from half of 2**-o up to
    2**-o of the half word; the last one holds all that is left.
    """
    octaves, per_octave = 1 << config.curve_octave_bits, 1 << config.curve_index_bits
    half = 1 << (config.versine.bits - 1)
    first, length = [], []
    for octave in range(octaves):
        last = octave == octaves - 1
        base, size = (0, half >> octave) if last else (half >> octave + 1, half >> octave + 1)
        step = size // per_octave
        first += [base + k * step for k in range(per_octave)]
        length += [step] * per_octave
    mirrored = np.repeat([False, True], octaves * per_octave)
    return Segments(np.array(first * 2), np.array(length * 2), mirrored)


def curve_words(curve: Curve, config: Config) -> tuple[Ints, Ints, list[Jump]]:
    """The table of `curve`: words int64[S, 2], {left, step} of each line in `coefficient` (step:
    signed); jumps int64[MAX_JUMPS, 3] as in `MaterialTable`; and the jumps that were moved to the
    end of a line, because there are no comparators left for them.

    A line is a chord, moved by half of its largest error to either side.
    """
    cut = segments(config)
    ends = np.unique(1 - cut.versine([0.0, 1.0], config))
    compared: list[Jump] = []
    places: dict[float, float] = {}
    moved: list[Jump] = []
    for jump in sorted(curve.jumps, key=lambda j: -abs(j.height)):
        nearest = float(ends[np.argmin(np.abs(ends - jump.place))])
        if abs(nearest - jump.place) <= config.versine.lsb:
            places[jump.place] = nearest
        elif len(compared) < MAX_JUMPS:
            compared.append(jump)
        else:
            places[jump.place] = nearest
            moved.append(jump)
    fitted, part = curve.moved(places), np.linspace(0, 1, SAMPLES)
    c = 1 - cut.versine(part, config)
    # Limits from within the segment: from below at its upper end.
    upper = np.zeros_like(c, bool)
    upper[-1, cut.mirrored] = upper[0, ~cut.mirrored] = True
    value = np.where(upper, _without(fitted, compared, c, True),
                     _without(fitted, compared, c, False))  # fmt: skip
    bend = value - (value[0] + part[:, None] * (value[-1] - value[0]))
    shift = (bend.max(axis=0) + bend.min(axis=0)) / 2
    left, right = (config.coefficient.quantize(value[k] + shift) for k in (0, -1))
    codes = []
    for jump in compared:
        # cos(s) >= place where the code of v is below the threshold.
        threshold = int(np.floor(np.ldexp(1 - jump.place, config.versine.fraction))) + 1
        threshold = min(threshold, config.versine.max)
        codes.append((int(jump.height > 0), threshold, abs(jump.height)))
    return np.stack([left, right - left], axis=-1), _jump_codes(codes, config), moved


def weight_points(weight: Curve, config: Config) -> tuple[Ints, Ints, list[Jump]]:
    """The table of W: points int64[P] in `coefficient`; jumps int64[MAX_JUMPS, 3] as in
    `MaterialTable`; and the jumps that became steep lines, because there are no comparators left
    for them."""
    ordered = sorted(weight.jumps, key=lambda j: -abs(j.height))
    compared, smeared = ordered[:MAX_JUMPS], ordered[MAX_JUMPS:]
    zn = np.linspace(0, 1, config.weight_points)
    codes = []
    for jump in compared:
        threshold = int(np.ceil(np.ldexp(jump.place, config.cosine.fraction)))
        codes.append((int(jump.height < 0), min(threshold, config.cosine.max), abs(jump.height)))
    points = config.coefficient.quantize(_without(weight, compared, zn, False))
    return points, _jump_codes(codes, config), smeared


def _without(curve: Curve, jumps: Sequence[Jump], x: Reals, below: bool) -> Reals:
    """`curve` at `x` without its `jumps`: the height of each is added on the lower side, so that
    nothing gets negative."""
    value = curve.at(x, below)
    for jump in jumps:
        above = x > jump.place if below else x >= jump.place
        value = value + abs(jump.height) * (above == (jump.height < 0))
    return value


def _jump_codes(codes: Sequence[tuple[int, int, float]], config: Config) -> Ints:
    """int64[MAX_JUMPS, 3]: {above, threshold, amount} of `codes`, whose amount is real, and zeros
    for the jumps that are not there."""
    table = np.zeros((MAX_JUMPS, 3), np.int64)
    for row, (above, threshold, amount) in zip(table, codes, strict=False):
        row[:] = above, threshold, config.coefficient.quantize(amount)
    return table


def jump_count(jumps: Ints | None) -> int:
    """How many comparators `jumps` (int64[..., MAX_JUMPS, 3]) needs: those up to the last amount
    that is not 0."""
    if jumps is None:
        return 0
    used = (jumps[..., 2] != 0).reshape(-1, jumps.shape[-2]).any(axis=0)
    return int(used.nonzero()[0].max(initial=-1)) + 1


def power_words(exponent: Ints, config: Config) -> Ints:
    """The tables int64[M, S, 2] of cos(s)**n for the codes `exponent` (int64[M])."""
    return np.stack([_power_lines(code, config) for code in exponent.tolist()])


@lru_cache(maxsize=256)
def _power_lines(code: int, config: Config) -> Ints:
    """The table int64[S, 2] of cos(s)**n for the code of n."""
    return curve_words(Power(float(config.exponent.real(code))), config)[0]


# -- what the tables say, in float64 ---------------------------------------------------------------


def _fall(jumps: Ints, x: Reals, word: Format, config: Config) -> Reals:
    """The amounts that are subtracted at `x` (float64[n]); jumps: int64[n, J, 3]."""
    total = np.zeros_like(x)
    for k in range(jumps.shape[1]):
        above, threshold, amount = jumps[:, k].T
        applies = (x >= word.real(threshold)) == (above == 1)
        total = total + np.where(applies, config.coefficient.real(amount), 0)
    return total


def curve_value(
    words: Ints, jumps: Ints | None, v: Reals, config: Config, side: ArrayLike = 0.0
) -> Reals:
    """What the tables give at 1 - cos(s) = `v` (float64[n], 0 to 1), float64[n].

    words: int64[n, S, 2] of each pixel's material; jumps: int64[n, J, 3]. side: real[n], added to v
    where a line and the side of a jump are chosen, but not where the line is evaluated.
    """
    cut, half = segments(config), 1 << (config.versine.bits - 1)
    code = np.ldexp(v, config.versine.fraction)
    chosen = np.clip(code + np.ldexp(side, config.versine.fraction), 0, config.versine.max)
    mirrored = chosen >= half
    folded = np.where(mirrored, config.versine.max - chosen, chosen)
    per_side = len(cut.first) // 2
    order = np.argsort(cut.first[:per_side])
    found = np.searchsorted(cut.first[:per_side][order], folded, side="right") - 1
    k = order[np.maximum(found, 0)] + per_side * mirrored
    place = np.where(mirrored, config.versine.max - code, code) - cut.first[k]
    row = np.arange(len(v))
    left, step = config.coefficient.real(np.moveaxis(words[row, k], -1, 0))
    value = left + step * (place / cut.length[k])
    if jumps is not None:
        value = value - _fall(jumps, np.ldexp(chosen, -config.versine.fraction),
                              config.versine, config)  # fmt: skip
    return np.clip(value, 0, 1)


def weight_value(
    points: Ints, jumps: Ints | None, cosine: Reals, config: Config, side: float = 0.0
) -> Reals:
    """What the tables give for W at cos(i) = `cosine` (float64[n]), float64[n].

    points: int64[n, P] of each pixel's material; jumps: int64[n, J, 3]. side: added to cos(i) where
    the side of a jump is chosen.
    """
    count = points.shape[1]
    position = np.clip(cosine, 0, 1) * (count - 1)
    left = np.minimum(position.astype(np.int64), count - 2)
    row = np.arange(len(cosine))
    a, b = (config.coefficient.real(points[row, left + k]) for k in (0, 1))
    value = a + (b - a) * (position - left)
    if jumps is not None:
        value = value - _fall(jumps, np.clip(cosine + side, 0, 1), config.cosine, config)
        value = np.maximum(value, 0)
    return value


def curve_distance(curve: Curve, words: Ints, jumps: Ints, config: Config) -> float:
    """The largest distance of the tables (int64[S, 2], int64[J, 3]) from `curve`, but within two
    codes of a jump."""
    v = np.unique(segments(config).versine(np.linspace(0, 1, SAMPLES), config))
    v = v[(v >= 0) & (v < 1 - config.versine.lsb)]
    return _distance(
        curve, 1 - v,
        curve_value(np.broadcast_to(words, (len(v), *words.shape)),
                    np.broadcast_to(jumps, (len(v), *jumps.shape)), v, config),
        2 * config.versine.lsb,
    )  # fmt: skip


def weight_distance(weight: Curve, points: Ints, jumps: Ints, config: Config) -> float:
    """As `curve_distance`, of the table of W (int64[P], int64[J, 3]) from `weight`."""
    zn = np.linspace(0, 1, 1 << 13)
    if isinstance(weight, Polyline):
        zn = np.unique(np.concatenate([zn, weight.x]).clip(0, 1))
    table = weight_value(
        np.broadcast_to(points, (len(zn), len(points))),
        np.broadcast_to(jumps, (len(zn), *jumps.shape)), zn, config,
    )  # fmt: skip
    compared = weight.jumps if len(weight.jumps) <= MAX_JUMPS else []
    return _distance(weight, zn, table, 2 * config.cosine.lsb, compared)


def _distance(
    curve: Curve, x: Reals, value: Reals, near: float, jumps: Sequence[Jump] | None = None
) -> float:
    """The largest |value - curve| at `x`, but for places within `near` of a jump of `jumps`."""
    counted = np.ones(len(x), bool)
    for jump in curve.jumps if jumps is None else jumps:
        counted &= np.abs(x - jump.place) > near
    return float(np.abs(value - curve.at(x))[counted].max(initial=0.0))
