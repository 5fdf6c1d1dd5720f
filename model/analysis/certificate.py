# SPDX-License-Identifier: MIT
"""Certified bounds: the largest error of a colour code over all inputs, checked by a machine.

`error_budget` bounds the error of one frame by adding the largest errors of its stages. This module
bounds the error of every frame at once, and lower: it keeps how the errors of the stages are
connected at each input, and searches all inputs by branch and bound. An input is the half vector,
the direction of the normal and the exponent n, all in intervals; and the coefficients, of which the
corners are enough.

What is covered
    Builds for one white light with the normal method `normalize` or `dot_first`, any method of
    1/sqrt, and powers by tables. Every normal but the zero vector, of any length, one- or
    two-sided. Every half vector that the span file accepts: its length differs from 1 by at most
    sqrt(5)/2 of its LSB. n from 1 to 128. Cp d + Cp (1 - d) at most 1; W at each of its points from
    0 to 1. An unlit pixel is exact.

What is exhausted (`exhausted`)
    The relative error e of |m| / root(|m|**2) over every operand; the absolute error E of
    cos(s)**n over every code of 1 - cos(s) and of n, for each whole part of n.

What is an interval
    The half vector's angle f, h = (1 + eta) (sin f, 0, cos f); the unit normal d, by its components
    t = hz dx - hx dz and y = dy across h (both for |h| = 1) and the sign of its component along h;
    and n. All roundings: of the mantissas, of the unit normal, of cos(i), of the cross product, of
    the versine, of W(i) and of S. Each takes any value of its interval, independently of the
    others.

How an error arises. All equations are exact; bounds are rounded outward by Arb.
    The mantissas are L (d + r), |r_j| <= k, L > 0. With r = s d + p, p across d, their direction
    is d + T, T = c1 p - c2 d, where c1 <= 1/(1 - sqrt(3) k) and c2 <= 3/2 k**2 c1**2.
    The unit normal is (1 + e) (d + T) + R, |R_j| half an LSB, where a component near 1 may lose one
    LSB by its clamp and what e lifts it above 1.
    z = cos(i) has the error dz = e z + (1 + e) T_z + R'.
    w = (cos f y, t) has the error dw = a w + (1 + a) (cos f T_y, cos f T_x - sin f T_z)
    + (1 + eta) (cos f R_y, cos f R_x - sin f R_z) + R'', a = (1 + e)(1 + eta) - 1.
    With `dot_first` the products with h come before the scale: in place of the terms of R there are
    (1 + e) R_c, |R_c| at most 2 k c1 max|d_j| by component, since a product of mantissas is rounded
    to one bit less.
    v = 2 |w|**2 has the error dv = 4 w.dw + 2 |dw|**2 + R''', clamped below 1.
    q = (1 - v)**n has the error dq = E - D dv, D the slope n (1 - v')**(n - 1) between v and
    v + dv.
    W(i) has the error g dz + R'''', where g is at most the number of lines of its table, either
    way, or 0 if W is constant. Between two lines g is between their slopes.
    S has the error A dz + W dq + q' R'''' - cut, with A = Cp (1 - d) + g q', q' = q + dq.

    The sum is linear in r, in e and in each rounding, so its largest value has a closed form at
    every input. It is convex in (Cp (1 - d), W, g), so corners are enough. Products of two errors
    are not dropped: `ErrorBound._second` bounds them.

Saturation. Clamping S to 1 does not lengthen an error, and where both the exact and the rounded S
    are at least 1 the error is 0. So only inputs with Cp (1 - d) z + W q <= 1 + `SLACK` count. An
    input beyond that erred only if its error was larger than SLACK. S is at most 2, and all but
    the roundings of W(i) and S is linear in the coefficients; so about half of its coefficients
    would be an input that counts, with an error near SLACK/2. No error that is certified is larger
    than `LARGEST`, SLACK/4.

The code is 255 S rounded: 1/2 LSB is added to 255 times the error of S.
"""

from __future__ import annotations

import heapq
import math
from dataclasses import dataclass, replace

from flint import arb

from phong75.model.analysis.exhausted import Stages
from phong75.model.config import Config

#: How far the exact S may be above 1 where it is not left out as saturated.
SLACK = 2.0**-6

#: The largest error of S that is certified, about an LSB of an 8-bit code; a larger one is none.
LARGEST = SLACK / 4

#: pi/2, rounded up.
RIGHT_ANGLE = math.nextafter(math.pi / 2, 2)

#: How near a bound comes to that of a single input, relative to what that has beyond 1/2 LSB.
NEAR = 0.015

#: Fields of `Config` that the derivation holds for, with their values.
COVERED = {
    "technique": ("phong",), "normal_method": ("normalize", "dot_first"),
    "power_method": ("tables",), "normal_order": (1,), "constant_shift": ((),),
    "sums_lights": (False,), "weight_jumps": (0,), "power_function": (True,),
}  # fmt: skip


class NoBoundError(Exception):
    """The error of S may exceed LARGEST, on which the derivation relies."""


def check(config: Config) -> None:
    """Raise ValueError if the derivation does not hold for `config`."""
    for name, values in COVERED.items():
        if getattr(config, name) not in values:
            raise ValueError(f"nothing is certified for {name} `{getattr(config, name)}`")


@dataclass(frozen=True, order=True)
class Box:
    """A set of inputs. angle: f, radians. t, y: components of the normal across h. n: the exponent.
    Each is (from, to). side: 1 or -1, the sign of the normal's component along h.

    y is 0 or more: the error is the same for -y.
    """

    angle: tuple[float, float]
    t: tuple[float, float]
    y: tuple[float, float]
    n: tuple[float, float]
    side: int

    def halves(self) -> tuple[Box, Box]:
        """The box cut in two across the side that counts most: a highlight is 1/(2 sqrt(n)) wide
        in w = (cos f y, t)."""
        scale = 2 * math.sqrt(self.n[1])
        widths = {
            "angle": self.angle[1] - self.angle[0],
            "t": (self.t[1] - self.t[0]) * scale,
            "y": (self.y[1] - self.y[0]) * max(1.0, scale * math.cos(self.angle[0])),
            "n": math.log(self.n[1] / self.n[0]) / 2,
        }
        name = max(widths, key=lambda side: widths[side])
        low, high = getattr(self, name)
        middle = (low + high) / 2
        parts = {f: getattr(self, f) for f in self.__dataclass_fields__}
        return Box(**parts | {name: (low, middle)}), Box(**parts | {name: (middle, high)})

    def middle(self) -> Box:
        """The box of one input, in the middle of this one."""
        at = {f: (sum(getattr(self, f)) / 2,) * 2 for f in ("angle", "t", "y", "n")}
        return Box(**at, side=self.side)


def split(box: Box) -> list[Box]:
    """`box` without a change of sign of t, as `ErrorBound` needs it."""
    low, high = box.t
    if low < 0 < high:
        return [replace(box, t=(low, 0.0)), replace(box, t=(0.0, high))]
    return [box]


def _between(low: float | arb, high: float | arb) -> arb:
    return arb(low).union(arb(high))


def _clip(x: arb, low: float, high: float) -> arb:
    """The part of x that is neither below `low` nor above `high`; there must be one."""
    return _between(x.lower().max(arb(low)), x.upper().min(arb(high)))


def _most(x: arb) -> arb:
    """The largest |x|."""
    return x.abs_upper()


def _power(c: arb, exponent: arb) -> arb:
    """c**exponent, and 0 for c of 0 or less."""
    return c**exponent if c > 0 else arb(0)


def _length(a: arb, b: arb) -> arb:
    """The length of (a, b), both 0 or more, which grows with both."""
    low, high = (_low(a) ** 2 + _low(b) ** 2).sqrt(), (a.upper() ** 2 + b.upper() ** 2).sqrt()
    return _between(_low(low), high.upper())


def _direction(a: arb, b: arb) -> arb:
    """The share a/|(a, b)|, both 0 or more: it grows with a and falls with b."""
    if not (a > 0 or b > 0):
        return _between(0, 1)
    least = _low(a) / (_low(a) ** 2 + b.upper() ** 2).sqrt()
    most = a.upper() / (a.upper() ** 2 + _low(b) ** 2).sqrt()
    return _between(least.lower().max(arb(0)), most.upper().min(arb(1)))


def _low(x: arb) -> arb:
    """The least x, and 0 where that is below 0."""
    return x.lower().max(arb(0))


class ErrorBound:
    """The bound of the error of S over a box of inputs. steep: W(i) of any form, not constant.

    Raises ValueError if the derivation does not hold for `config`.
    """

    def __init__(self, config: Config, stages: Stages, steep: bool):
        check(config)
        self._stages = stages
        half = arb(1) / 2
        self._slope = arb(config.weight_points - 1 if steep else 0)
        self._weight = config.weight.lsb * half if steep else arb(0)
        self._cut = arb(config.intensity.lsb)
        self._e = _between(*stages.root)
        e = _most(self._e)
        # |r_j| <= k max|d_j|. A rounded component errs by half an LSB, and the largest one is at
        # least 1/2; a clamped one errs by up to an LSB, and is at least 1 - LSB/2.
        self._k = config.mantissa.lsb * (1 + arb(config.mantissa.lsb))
        stretch = 1 / (1 - arb(3).sqrt() * self._k)  # c1
        self._stretch = stretch
        self._bent = 3 * half * self._k**2 * stretch**2  # c2
        self._turn = arb(3).sqrt() * self._k * stretch + self._bent  # |T|
        self._unit, self._unit_clamped = config.unit.lsb * half, config.unit.lsb + e
        self._cosine = arb(config.cosine.lsb)
        self._near_one = (1 - 2 * (config.unit.lsb + e + self._turn)).lower()
        self._eta = arb(5).sqrt() * half * config.half_vector.lsb
        self._a = (1 + e) * (1 + self._eta) - 1
        self._versine = arb(config.versine.lsb)
        self._dot_first = config.normal_method == "dot_first"
        # |dw| - a |w|, whatever the input: |R| with any component clamped or |R_c|, and R''.
        products = 2 * arb(2).sqrt() * (1 + e) * self._k * stretch
        components = (1 + self._eta) * arb(3).sqrt() * self._unit_clamped
        self._dw = (
            (1 + self._a) * self._turn
            + (products if self._dot_first else components)
            + arb(2).sqrt() * config.unit.lsb
        )

    def __call__(self, box: Box) -> arb | None:
        """The largest |error of S| over `box`; None if no input is in it."""
        t, y = _between(*box.t), _between(*box.y)
        sine, cosine = _between(*box.angle).sin_cos()
        sine, cosine = _clip(sine, 0, 1), _clip(cosine, 0, 1)
        rest = 1 - t * t - y * y
        if rest < 0:
            return None
        least, most = rest.lower().max(arb(0)), rest.upper().min(arb(1))
        along = box.side * _between(least.sqrt(), most.sqrt())
        z = along * cosine - t * sine
        if z < 0:
            return None
        z, x = _clip(z, 0, 1), _clip(t * cosine + along * sine, -1, 1)
        cross_x, cross_y = cosine * y, abs(t)  # |w|, by component
        to_x, to_y = _direction(cross_x, cross_y), _direction(cross_y, cross_x)  # w/|w|
        toward = to_y if box.t[0] >= 0 else -to_y
        size = _length(cross_x, cross_y)
        v = 2 * size * size
        v = arb(1) if v > 1 else _clip(v, 0, 1)
        largest = _most(x).max(_most(y)).max(_most(z))
        longest = _most(size)
        dw = self._a * longest + self._dw
        dv = (4 * longest * dw + 2 * dw**2 + self._versine).upper()
        q, slope, steepness = self._power(size, dv, box.n)
        below_power, above_power = self._table_errors(box.n)
        dq = slope.upper() * dv + max(-below_power, above_power)
        rounded = _clip(q + _between(-dq, dq), 0, 1)

        def rounding(component: arb, plain: arb, clamped: arb) -> arb:
            return clamped if _most(component) > self._near_one else plain

        r_x, r_y, r_z = (rounding(d, self._unit, self._unit_clamped) for d in (x, y, z))
        clamped = z.upper() > self._near_one  # cos(i) may be clamped below 1
        # A product that is clamped is near 1, and so v is near 2, where the power is 0 anyway.
        r_cross = [rounding(w, self._unit, 2 * self._unit) for w in (cross_x, cross_y)]
        saturated = v.upper() + dv > 1 - self._versine  # v may be clamped below 1
        # dv without e and T: what D |w| multiplies, and what D does.
        k = self._k * largest * self._stretch
        if self._dot_first:
            normal = (1 + _most(self._e)) * 2 * k * (to_x + to_y)
        else:
            normal = (1 + self._eta) * (
                to_x * cosine * r_y + to_y * (cosine * r_x + sine * r_z)
            )  # fmt: skip
        own = 4 * (size * self._eta + normal + to_x * r_cross[0] + to_y * r_cross[1])
        fixed = (self._versine if saturated else self._versine / 2) + self._second(longest)
        specular = steepness * own + slope * fixed
        outward = 4 * steepness  # how the error grows with dw along w, per W

        worst = arb(0)
        for diffuse, weight in self._corners(z, q):
            for sign in (1, -1) if self._slope > 0 else (0,):
                # The error is linear in T and e, by the gradient g and by g.d.
                big_a = diffuse + sign * self._slope * rounded
                along_d = big_a * z - weight * outward * size
                g_x = -weight * outward * toward * cosine - along_d * x
                g_y = -weight * outward * to_x * cosine - along_d * y
                g_z = big_a + weight * outward * toward * sine - along_d * z
                both = (
                    k * (_most(g_x) + _most(g_y) + _most(g_z))
                    + self._bent * _most(along_d)
                    + _most(big_a) * _most(self._e) * self._turn
                    + weight * specular
                    + _most(rounded) * self._weight
                )
                e = self._with_cosine(along_d, big_a, clamped)
                above = both + e.upper() + weight * above_power
                below = both - e.lower() - weight * below_power + self._cut
                worst = worst.max(above.upper()).max(below.upper())
        return worst if worst.is_finite() else arb("inf")

    def _with_cosine(self, along_d: arb, big_a: arb, clamped: bool) -> arb:
        """The error e times `along_d` and the rounding of cos(i) times `big_a`, together.

        The rounding is at most half an LSB either way. Where cos(i) may be clamped it is down to
        -LSB, and for e > 0, which lifts cos(i) above 1, down to -LSB - e.
        """
        half = big_a * self._cosine / 2
        error = along_d * self._e
        error = _between((error - abs(half)).lower(), (error + abs(half)).upper())
        if not clamped:
            return error
        lifted = (along_d - big_a) * _between(0, self._e.upper().max(arb(0)))
        lowered = along_d * _between(self._e.lower().min(arb(0)), 0)
        return error.union((lifted.union(lowered)) - big_a * self._cosine)

    def _second(self, size: arb) -> arb:
        """Products of two errors in dv for |w| of at most `size`."""
        e = _most(self._e)
        dw = self._a * size + self._dw
        return 4 * size**2 * e * self._eta + 4 * size * self._a * self._turn + 2 * dw**2

    def _power(self, size: arb, dv: arb, n: tuple[float, float]) -> tuple[arb, arb, arb]:
        """(1 - v)**n, D and D |w| for |w| in `size`: D is n c**(n - 1) for any c within `dv` of
        1 - v."""
        near, far = size.lower().max(arb(0)), size.upper()
        low, high = (1 - 2 * far * far).lower(), (1 - 2 * near * near).upper().min(arb(1))
        least, most = arb(n[0]), arb(n[1])
        q = _between(_power(low, most).lower(), _power(high, least).upper())
        low, high = (low - dv).lower(), (high + dv).upper().min(arb(1))
        if not high > 0:
            return q, arb(0), arb(0)
        # n c**(n - 1) grows with c; in n it rises to n = -1/log(c), and falls from there.
        ends = [n * high ** (n - 1) for n in (least, most)]
        top = ends[0].upper().max(ends[1].upper())
        if high < 1:
            turn = -1 / high.log()
            if turn.upper() > least and turn.lower() < most:
                top = top.max((turn * high ** (turn - 1)).upper())
        bottom = arb(0)
        if low > 0:
            bottom = (least * low ** (least - 1)).lower().min((most * low ** (most - 1)).lower())
        slope = _between(bottom, top)
        product = slope * _between(near, far)
        if not (low > 0 and near > 0):
            return q, slope, product
        # The mean value theorem, on the logarithm of n (c + x)**(n - 1) |w| for all |x| <= dv.
        at, middle = (near + far) / 2, (least + most) / 2
        c = _between(low, (1 - 2 * near * near + dv).upper())
        across = 1 / _between(near, far) - 4 * _between(near, far) * (_between(*n) - 1) / c
        along = 1 / _between(*n) + c.log()
        centre = 1 - 2 * at * at + _between(-dv, dv)
        mean = (
            (middle * at).log() + (middle - 1) * centre.log()
            + across * (_between(near, far) - at) + along * (_between(*n) - middle)
        ).exp()  # fmt: skip
        return q, slope, product.intersection(mean) if product.overlaps(mean) else product

    def _table_errors(self, n: tuple[float, float]) -> tuple[float, float]:
        """Least and greatest E for n from n[0] to n[1]."""
        rows = [self._stages.power[k] for k in range(math.floor(n[0]), math.floor(n[1]) + 1)]
        return min(0.0, *(low for low, _ in rows)), max(0.0, *(high for _, high in rows))

    @staticmethod
    def _corners(z: arb, q: arb) -> list[tuple[arb, arb]]:
        """The corners (Cp (1 - d), W) of a polygon around all with Cp (1 - d) z + W q <= 1 + SLACK,
        where z and q are at their least."""
        one, least_z, least_q = arb(1), z.lower(), q.lower()
        if not least_z + least_q > 1 + SLACK:
            return [(one, one), (one, arb(0)), (arb(0), one)]
        beside_diffuse = ((1 + SLACK - least_z) / least_q).upper()
        beside_weight = ((1 + SLACK - least_q) / least_z).upper()
        return [
            (one, arb(0)), (one, beside_diffuse.min(one)),
            (beside_weight.min(one), one), (arb(0), one),
        ]  # fmt: skip


@dataclass(frozen=True)
class Certificate:
    """What a search of all inputs proved.

    bound_lsb: no colour code errs by more, LSB. boxes: how many boxes were bounded. at: the box of
    one input at which the bound of that input alone, point_lsb, is largest of those tried.
    """

    bound_lsb: float
    point_lsb: float
    boxes: int
    at: Box


def lsb_of(error: arb, config: Config) -> float:
    """The error of a code in LSB that an error of S allows, rounded up."""
    total = (config.white * error + arb(1) / 2).upper()
    value = float(total)
    return value if not arb(value) < total else math.nextafter(value, math.inf)


def search(
    bound: ErrorBound, config: Config, boxes: list[Box], gap: float, target: float = 0.0
) -> Certificate:
    """Bound the error of all inputs in `boxes`.

    The box with the largest bound is halved until that bound is at most `target`, or at most `gap`
    above the bound of a single input, both in LSB; or above that by the share `NEAR` of what it has
    beyond 1/2. Raises NoBoundError.
    """
    heap: list[tuple[float, Box]] = []
    count, point, at = 0, 0.5, boxes[0].middle()

    def add(box: Box) -> None:
        nonlocal count
        count += 1
        error = bound(box)
        if error is not None:
            heapq.heappush(heap, (-lsb_of(error, config), box))

    for box in boxes:
        add(box)
    largest = 0.5
    while heap:
        largest, box = -heap[0][0], heap[0][1]
        if largest <= max(target, point + max(gap, NEAR * (point - 0.5))):
            break
        middle = box.middle()
        error = bound(middle)
        if error is not None and (single := lsb_of(error, config)) > point:
            point, at = single, middle
        if (point - 0.5) / config.white > LARGEST:
            break
        heapq.heappop(heap)
        for half in box.halves():
            add(half)
        largest = 0.5
    if (largest - 0.5) / config.white > LARGEST:
        raise NoBoundError(f"the error of S may exceed {LARGEST}")
    return Certificate(largest, point, count, at)


def certify(
    bound: ErrorBound, config: Config, least: float, most: float, gap: float
) -> Certificate:
    """Bound the error of all inputs with n from `least` to `most`. gap: see `search`.

    Raises NoBoundError.
    """
    everything = Box((0.0, RIGHT_ANGLE), (-1.0, 1.0), (0.0, 1.0), (least, most), 1)
    boxes = split(everything) + split(replace(everything, side=-1))
    return search(bound, config, boxes, gap)
