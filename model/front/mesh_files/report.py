# SPDX-License-Identifier: MIT
"""What was decided about one mesh, as data for `report.json` and as lines for the terminal."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass
class MeshReport:
    """What one object of a scene is made of, and what was decided about it.

    source: the file's name or the shape. triangles, parts: as drawn. normals: where they come from,
    in words. crease: degrees, where normals were made with it. corners_made: corners whose normal
    was made. bodies: connected bodies. bodies_turned: bodies that were wound clockwise as a whole.
    faces_turned: further faces that did not fit their body. two_sided: triangles shown from both
    sides. two_sided_why: the reasons. degenerate_triangles: left out, without area.
    unused_vertices: vertices of no face, left out; None where the reader does not count them. up:
    the axis that points up and why. unit: what the file says. materials: materials of the file in
    use. reduction: see `materials.Reduction`; None where nothing was reduced. unused: what the file
    has and the picture does not show. notes: what was changed or is missing.
    """

    source: str
    triangles: int
    parts: int = 1
    normals: str = "exact, of the shape"
    crease: float | None = None
    corners_made: int = 0
    bodies: int | None = None
    bodies_turned: int = 0
    faces_turned: int = 0
    two_sided: int = 0
    two_sided_why: list[str] = field(default_factory=list)
    degenerate_triangles: int = 0
    unused_vertices: int | None = 0
    up: str | None = None
    unit: str | None = None
    materials: int = 0
    reduction: dict[str, Any] | None = None
    unused: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def lines(self) -> list[str]:
        """What a user should know, one fact a line; empty for a shape without surprises."""
        facts = [
            (
                self.up is not None,
                f"{_count(self.triangles, 'triangle')} in {_count(self.parts, 'part')}; "
                f"normals: {self.normals}",
            ),
            (
                self.normals.startswith("of the file") and self.corners_made,
                f"{_count(self.corners_made, 'corner')} without a normal in the file: made",
            ),
            (
                self.bodies_turned,
                f"{_count(self.bodies_turned, 'body', 'bodies')} of {self.bodies} turned round: "
                "wound clockwise",
            ),
            (
                self.faces_turned,
                f"{_count(self.faces_turned, 'triangle')} turned round to fit the neighbours",
            ),
            (
                self.two_sided,
                f"{_count(self.two_sided, 'triangle')} shown from both sides: "
                + "; ".join(self.two_sided_why),
            ),
            (
                self.degenerate_triangles,
                f"{_count(self.degenerate_triangles, 'triangle')} without area left out",
            ),
            (
                self.unused_vertices,
                f"{_count(self.unused_vertices or 0, 'vertex', 'vertices')} of no face left out",
            ),
            (self.up, f"up: {self.up}; unit: {self.unit}"),
            (self.materials, f"{_count(self.materials, 'material')} of the file"),
            (self.unused, "not shown: " + ", ".join(self.unused)),
        ]
        result = [text for condition, text in facts if condition]
        if self.reduction:
            result.append(
                f"materials: {self.reduction['before']} reduced to {self.reduction['after']}; "
                f"largest change of a colour {self.reduction['largest_change']:.0f}/255"
            )
        return result + self.notes


def _count(number: int, one: str, many: str = "") -> str:
    """A number with its noun, such as 3 parts."""
    return f"{number} {one if number == 1 else many or one + 's'}"
