# SPDX-License-Identifier: MIT
"""Scene and object description files as lecture notes on shading write them.

The notes ("Illumination, Reflection, Shading", section "Scene Description Files") give an example
of each. Both are lists of numbers; commas, brackets and line breaks separate them, and `//` begins
a comment.

A scene file: screen distance, rho, theta, phi; the number of objects; per object the name of its
object file (a line of its own), three scale factors, three rotation angles about x, y and z in
degrees, three translation distances; the number of lights; per light x, y, z and intensity; the
intensity of the ambient light.

An object file: the numbers of points and polygons; x, y, z of every point; per polygon the number
of its vertices and their indices from 0; the diffuse reflection coefficients kr, kg, kb; the
specular coefficient ks; the exponent n. The notes' example has no n.

`scene_table` gives the scene as the table that a TOML scene file holds, so that both kinds of files
are checked and read by the same code.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from phong75.model.config import MAX_EXPONENT
from phong75.model.frame import InputError

SCENE_SUFFIX, OBJECT_SUFFIX = ".scn", ".des"

#: The exponent of an object file that has none: the value of the notes' OpenGL example.
DEFAULT_EXPONENT = 20.0

_SEPARATORS = re.compile(r"[,()\s]+")


@dataclass(frozen=True)
class NotesObject:
    """An object file.

    points: (x, y, z) of every point, object units. polygons: indices of points per polygon,
    counter-clockwise seen from outside. diffuse: kr, kg, kb, 0 to 1. specular: ks, 0 to 1.
    exponent: n, None if the file has none.
    """

    points: list[tuple[float, float, float]]
    polygons: list[tuple[int, ...]]
    diffuse: tuple[float, float, float]
    specular: float
    exponent: float | None


class _Numbers:
    """The numbers of a file in their order, each with its line.

    Every method raises InputError with file and line where the file has something else.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        try:
            text = path.read_bytes().decode(errors="replace")
        except OSError as error:
            raise InputError(f"{path}: cannot be read: {error.strerror}") from None
        lines = (line.partition("//")[0] for line in text.removeprefix("\ufeff").splitlines())
        self._words = [
            (number, _SEPARATORS.split(line.strip(" \t,()")), line.strip())
            for number, line in enumerate(lines, 1)
            if line.strip(" \t,()")
        ]
        self._row = self._column = 0

    def error(self, message: str) -> InputError:
        """An InputError at the current line."""
        row = min(self._row, len(self._words) - 1)
        line = self._words[row][0] if self._words else 1
        return InputError(f"{self.path}: line {line}: {message}")

    @property
    def ended(self) -> bool:
        """Whether nothing is left."""
        return self._row == len(self._words)

    def real(self, what: str, low: float = -1e9, high: float = 1e9) -> float:
        """The next number, `low` to `high`; what: its name for messages."""
        if self.ended:
            raise self.error(f"the file ends where {what} should stand")
        word = self._words[self._row][1][self._column]
        try:
            value = float(word)
        except ValueError:
            raise self.error(f"{word[:40]!r} is not a number: {what} should stand here") from None
        if not (math.isfinite(value) and low <= value <= high):
            raise self.error(f"{what} is {word[:40]}, outside {low:g} to {high:g}")
        self._column += 1
        if self._column == len(self._words[self._row][1]):
            self._row, self._column = self._row + 1, 0
        return value

    def triple(
        self, *what: str, low: float = -1e9, high: float = 1e9
    ) -> tuple[float, float, float]:
        """The next three numbers, each `low` to `high`."""
        x, y, z = (self.real(name, low, high) for name in what)
        return x, y, z

    def whole(self, what: str, low: int, high: int = 10**7) -> int:
        """The next number, which must be whole and `low` to `high`."""
        row, column = self._row, self._column
        value = self.real(what)
        if value != int(value) or not low <= value <= high:
            self._row, self._column = row, column
            raise self.error(f"{what} is {value:g}, not a whole number from {low} to {high}")
        return int(value)

    def name(self, what: str) -> str:
        """The whole next line, for a name in which anything may stand."""
        if self.ended:
            raise self.error(f"the file ends where {what} should stand")
        if self._column:
            raise self.error(f"{what} needs a line of its own")
        self._row += 1
        return self._words[self._row - 1][2]

    def finish(self) -> None:
        """Raises InputError if numbers are left."""
        if not self.ended:
            word = self._words[self._row][1][self._column]
            raise self.error(f"{word[:40]!r} is more than the file should have")


def read_object(path: Path) -> NotesObject:
    """Read an object file. Raises InputError."""
    numbers = _Numbers(path)
    count = numbers.whole("the number of points", 3)
    faces = numbers.whole("the number of polygons", 1)
    points = [numbers.triple(*(f"{axis} of point {k}" for axis in "xyz")) for k in range(count)]
    polygons = []
    for k in range(faces):
        corners = numbers.whole(f"the number of vertices of polygon {k}", 3, count)
        what = f"a vertex of polygon {k}"
        polygons.append(tuple(numbers.whole(what, 0, count - 1) for _ in range(corners)))
    diffuse = numbers.triple("kr", "kg", "kb", low=0.0, high=1.0)
    specular = numbers.real("ks", 0.0, 1.0)
    exponent = None if numbers.ended else numbers.real("n", 1.0, MAX_EXPONENT)
    numbers.finish()
    return NotesObject(points, polygons, diffuse, specular, exponent)


def as_obj(item: NotesObject) -> bytes:
    """The points and polygons of an object as an OBJ file."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in item.points]
    lines += ["f " + " ".join(str(k + 1) for k in corners) for corners in item.polygons]
    return ("\n".join(lines) + "\n").encode()


def scene_table(path: Path) -> tuple[dict[str, Any], list[str]]:
    """The scene file `path` and its object files as the table of a TOML scene file, and sentences
    about what was assumed. Raises InputError.

    The viewpoint (rho, theta, phi) is at rho (cos theta sin phi, sin theta sin phi, cos phi) and
    looks at the origin; z points up. One unit of the screen is a pixel. A light is the direction
    from the origin to its place ("assumes light source is at infinity"). Each light reflects from
    the object's kr, kg, kb diffusely and from ks as white. All intensities are divided by Imax, the
    formula with all products of vectors at 1 and the largest coefficients of the scene's objects.
    """
    numbers = _Numbers(path)
    remarks = []
    distance = numbers.real("the screen distance", 1e-9)
    rho = numbers.real("rho", 1e-9)
    theta, phi = (math.radians(numbers.real(name, -360, 360)) for name in ("theta", "phi"))
    eye = [
        rho * math.cos(theta) * math.sin(phi),
        rho * math.sin(theta) * math.sin(phi),
        rho * math.cos(phi),
    ]
    materials: dict[str, Any] = {}
    objects: list[dict[str, Any]] = []
    for k in range(numbers.whole("the number of objects", 1, 1000)):
        file = numbers.name(f"the file name of object {k}")
        material = str(Path(file).with_suffix(""))
        entry: dict[str, Any] = {"mesh": file, "material": material}
        for key, what in (("scale", "scale factor"), ("rotate", "rotation angle"),
                          ("translate", "translation")):  # fmt: skip
            entry[key] = list(numbers.triple(*(f"the {what} of object {k} in {a}" for a in "xyz")))
        objects.append(entry)
        if material in materials:
            continue
        item = read_object(path.parent / file)
        if item.exponent is None:
            remarks.append(f"{file} has no exponent n: {DEFAULT_EXPONENT:g} is taken")
        materials[material] = {
            "ambient": list(item.diffuse), "diffuse": list(item.diffuse),
            "specular": [item.specular] * 3, "W": 1.0,
            "n": DEFAULT_EXPONENT if item.exponent is None else item.exponent,
        }  # fmt: skip
    lights = []
    for k in range(numbers.whole("the number of light sources", 1, 8)):
        place = numbers.triple(*(f"{axis} of light {k}" for axis in "xyz"))
        if not any(place):
            raise numbers.error(f"light {k} is at the origin, where it has no direction")
        intensity = numbers.real(f"the intensity of light {k}", 0.0, 1e6)
        lights.append({"direction": list(place), "color": [intensity] * 3})
    ambient = numbers.real("the intensity of the ambient light", 0.0, 1e6)
    numbers.finish()
    remarks.append("lights are taken as directions from the origin, one screen unit as a pixel")
    return {
        "shading": "flat",
        "exposure": "Imax",
        "ambient": [ambient] * 3,
        "camera": {
            "projection": "perspective", "eye": eye, "target": [0.0, 0.0, 0.0],
            "up": [0.0, 0.0, 1.0], "screen_distance": distance,
        },
        "lights": lights,
        "materials": materials,
        "objects": objects,
    }, remarks  # fmt: skip
