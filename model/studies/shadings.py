# SPDX-License-Identifier: MIT
"""The shadings that `phong75 compare` puts side by side: the hardware and the scene of each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.front.scene import Scene


@dataclass(frozen=True)
class Shading:
    """One way to shade a scene.

    name: as in files. title: as in tables and pictures. config: the hardware that is built.
    interpolation: of the normals, see `Scene`. lighting: fields of `Scene` that this shading
    replaces to light the scene in another way; the true surface is then lit in the same way.
    """

    name: str
    title: str
    config: Config
    interpolation: str = "linear"
    lighting: Mapping[str, Any] = field(default_factory=dict)

    def lit(self, scene: Scene) -> Scene:
        """`scene` in the light of this shading, with normals that are linear over the screen."""
        return replace(scene, interpolation="linear", **self.lighting)

    def scene_of(self, scene: Scene) -> Scene:
        """`scene` as this shading asks for it."""
        return replace(self.lit(scene), interpolation=self.interpolation)


#: The column that all others are compared with where a scene has no true surface.
PHONG = Shading("phong", "Phong", DEFAULT)

#: The columns of a comparison, in order. A new shading is a line here.
SHADINGS = (
    Shading("flat", "flat", TECHNIQUES["flat"]),
    Shading("gouraud", "Gouraud", TECHNIQUES["gouraud"]),
    PHONG,
    Shading("normalized_edges", "Phong, edges normalized", DEFAULT, "normalized_edges"),
)
