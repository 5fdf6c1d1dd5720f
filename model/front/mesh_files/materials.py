# SPDX-License-Identifier: MIT
"""From the materials of a mesh file to the coefficients of eq. (3) of the paper.

A material of OBJ (MTL) or of another format of the same family has Kd, Ks and Ns: Cp = Kd, W is the
largest component of Ks because the highlight is white, and n = Ns, limited to 1 to 128. Without a
highlight (Ns = 0, Ks = 0 or `illum` below 2) W is 0.

A material of glTF has a base colour, a metallic factor m and a roughness r: Cp is the base colour.
The reflectance at right angles is F0 = 0.04 (1 - m) + m max(Cp) (glTF 2.0, appendix B), and
W = (1 - r) sqrt(F0): a rough surface shows no highlight. The exponent of a half vector that fits
the roughness is 2/r^4 - 2 (Karis 2013); the angle of a reflected ray is twice as large, so
n = (2/r^4 - 2)/4, limited to 1 to 128.

Nothing is blended: transparent materials are drawn opaque.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from phong75.model.arrays import Ints, Reals
from phong75.model.config import MAX_EXPONENT

#: d of materials from files: formats have no such share, or a value that few writers set with care.
AMBIENT_SHARE = 0.15

#: The range of n, to which exponents of files are limited.
LEAST_N, MOST_N = 1.0, float(MAX_EXPONENT)

#: Rounds of moving each material of a reduced table to the mean of what it stands for.
ROUNDS = 8

#: What Assimp sets for a material of an OBJ file whose name no MTL file defines.
_UNDEFINED: dict[str, list[float]] = {
    "$clr.diffuse": [0.6] * 3, "$clr.specular": [0.0] * 3, "$clr.ambient": [0.0] * 3,
    "$mat.shininess": [0.0], "$mat.illum": [1],
}  # fmt: skip


@dataclass
class Materials:
    """K materials in the terms of eq. (3).

    colour: float64[K, 3], Cp. d, n, w: float64[K], the ambient share, the exponent and the
    specular share W, the same at all angles.
    """

    colour: Reals
    d: Reals
    n: Reals
    w: Reals

    def __len__(self) -> int:
        return len(self.colour)

    @classmethod
    def of(cls, colour: Any, d: Any, n: Any, w: Any) -> Materials:
        """K materials from lists of numbers, limited to the ranges of eq. (3)."""
        colour = np.clip(np.asarray(colour, np.float64).reshape(-1, 3), 0.0, 1.0)
        d, n, w = (np.asarray(v, np.float64).reshape(-1) for v in (d, n, w))
        return cls(colour, np.clip(d, 0, 1), np.clip(n, LEAST_N, MOST_N), np.clip(w, 0, 1))

    @classmethod
    def join(cls, several: list[Materials]) -> Materials:
        """All materials of `several`, one after the other."""
        return cls(
            np.concatenate([m.colour for m in several]),
            *(np.concatenate([getattr(m, k) for m in several]) for k in ("d", "n", "w")),
        )

    def take(self, which: Ints) -> Materials:
        """The materials of the indices `which`."""
        return Materials(self.colour[which], self.d[which], self.n[which], self.w[which])

    def table(self) -> Reals:
        """float64[K, 6]: red, green, blue, d, n, W."""
        return np.column_stack([self.colour, self.d, self.n, self.w])

    def grey(self) -> Materials:
        """The same materials with the luminance (ITU-R BT.709) in place of each colour."""
        grey = self.colour @ np.array([0.2126, 0.7152, 0.0722])
        return Materials(np.repeat(grey[:, None], 3, axis=1), self.d, self.n, self.w)


@dataclass(frozen=True)
class FileMaterial:
    """One material of a file: Cp, n and W of eq. (3), and what eq. (3) has no place for.

    defined: whether the file says anything of the material. two_sided, opacity: as in the file.
    clipped: whether n was outside the range.
    """

    name: str
    colour: tuple[float, float, float]
    n: float
    w: float
    defined: bool
    two_sided: bool = False
    opacity: float = 1.0
    clipped: bool = False


def file_material(said: dict[str, Any], defined: bool, has_sides: bool) -> FileMaterial:
    """The material of what Assimp says.

    said: values by Assimp's names. defined: whether the file defines this material, as far as is
    known. has_sides: whether Assimp's "two-sided" comes from the file.
    """
    name = str(said.get("?mat.name", ""))
    base, diffuse = said.get("$clr.base"), said.get("$clr.diffuse")
    colour = _colour(base or diffuse or [1.0, 1.0, 1.0])
    undefined = "$mat.illum" in said and all(
        np.allclose(said.get(key, np.inf), value, atol=1e-6) for key, value in _UNDEFINED.items()
    )
    if "$mat.metallicFactor" in said and "$mat.illum" not in said:
        metallic, roughness = (
            _number(said, "$mat.metallicFactor"),
            _number(said, "$mat.roughnessFactor", 1.0),
        )
        reflectance = 0.04 * (1.0 - metallic) + metallic * max(colour)
        w = (1.0 - roughness) * np.sqrt(max(reflectance, 0.0))
        exponent = (2.0 / max(roughness, 1e-3) ** 4 - 2.0) / 4.0
    else:
        exponent = _number(said, "$mat.shininess")
        shines = exponent > 0 and said.get("$mat.illum", [2])[0] >= 2
        w = max(_colour(said.get("$clr.specular", [0.0] * 3))) if shines else 0.0
    n = min(max(exponent, LEAST_N), MOST_N)
    return FileMaterial(
        name,
        colour,
        n,
        float(min(max(w, 0.0), 1.0)),
        defined and not undefined,
        has_sides and bool(_number(said, "$mat.twosided")),
        min(_number(said, "$mat.opacity", 1.0), (list(base or ()) + [1.0] * 4)[3]),
        bool(w) and n != exponent,
    )


def _colour(values: Any) -> tuple[float, float, float]:
    """Three finite components from 0 to 1."""
    numbers = np.nan_to_num(np.asarray(list(values)[:3] + [0.0] * 3, np.float64)[:3])
    red, green, blue = np.clip(numbers, 0.0, 1.0).tolist()
    return red, green, blue


def _number(said: dict[str, Any], key: str, default: float = 0.0) -> float:
    """A finite number that Assimp says, or `default`."""
    values = said.get(key)
    if not isinstance(values, list) or not values:
        return default
    value = float(values[0])
    return value if np.isfinite(value) else default


@dataclass(frozen=True)
class Reduction:
    """How many materials became how many, and the largest change of a colour, in 1/255."""

    before: int
    after: int
    largest: float


def reduce_materials(
    materials: Materials, weight: Reals, room: int
) -> tuple[Materials, Ints, Reduction]:
    """At most `room` materials that stand for `materials`: (table, index, what was changed).

    weight: float64[K], the area that each material covers. index: int64[K], rows of the table.
    Equal materials share a row. If that is not enough, the set of materials with the largest sum of
    squared differences is cut in two at its mean, along the component that varies most (Heckbert
    1982 cuts at the median), until `room` sets are there; then each material goes to the nearest
    mean, several times. Differences of n count as differences of the highlight's width,
    1/sqrt(n).
    """
    rows, index = np.unique(materials.table(), axis=0, return_inverse=True)
    index = index.reshape(-1)
    area = np.maximum(np.bincount(index, weight, len(rows)), 1e-300)
    before = len(rows)
    if before > room:
        points = rows.copy()
        points[:, 4] = 1.0 / np.sqrt(rows[:, 4])
        label = _cut(points, area, room)
        for _ in range(ROUNDS):
            means = _means(points, area, label, room)
            distance = np.stack([np.sum((points - mean) ** 2, axis=1) for mean in means])
            label = np.argmin(distance, axis=0)
        used, label = np.unique(label, return_inverse=True)
        means = _means(points, area, label, len(used))
        means[:, 4] = 1.0 / means[:, 4] ** 2
        change = float(np.max(np.abs(rows[:, :3] - means[label, :3])))
        rows, index = means, label.reshape(-1)[index]
    else:
        change = 0.0
    table = Materials.of(rows[:, :3], rows[:, 3], rows[:, 4], rows[:, 5])
    return table, index, Reduction(before, len(rows), 255.0 * change)


def _cut(points: Reals, area: Reals, room: int) -> Ints:
    """The set of each of `points`, int64[K], 0 to `room` - 1."""
    label = np.zeros(len(points), np.int64)
    for new in range(1, room):
        means = _means(points, area, label, new)
        spread = np.stack(
            [np.bincount(label, area * (points[:, k] - means[label, k]) ** 2, new)
             for k in range(points.shape[1])], axis=1,
        )  # fmt: skip
        worst = int(np.argmax(spread.sum(axis=1)))
        axis = int(np.argmax(spread[worst]))
        label[(label == worst) & (points[:, axis] > means[worst, axis])] = new
    return label


def _means(points: Reals, area: Reals, label: Ints, count: int) -> Reals:
    """The mean of each set, float64[count, columns], weighted by `area`."""
    total = np.bincount(label, area, count)
    sums = [np.bincount(label, area * column, count) for column in points.T]
    return np.stack(sums, axis=1) / np.where(total > 0, total, 1.0)[:, None]
