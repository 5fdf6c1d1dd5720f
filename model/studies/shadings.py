# SPDX-License-Identifier: MIT
"""The shadings that `phong75 compare` puts side by side: the hardware and the scene of each."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.front.scene import Light, Scene
from phong75.model.places import Falloff, Place

#: Warnock's column: the factor of the light at the point that is farthest from the eye; it is 1 at
#: the nearest one.
FARTHEST_FACTOR = 0.3


@dataclass(frozen=True)
class Shading:
    """One way to shade a scene.

    name: as in files. title: as in tables and pictures. config: the hardware that is built, with
    what the scene needs beyond it. interpolation: of the normals, see `Scene`. lighting: gives the
    fields of a `Scene` that this shading replaces to light the scene in another way; the true
    surface is then lit in the same way.
    """

    name: str
    title: str
    config: Config
    interpolation: str = "linear"
    lighting: Callable[[Scene], Mapping[str, Any]] | None = None

    def lit(self, scene: Scene) -> Scene:
        """`scene` in the light of this shading, with normals that are linear over the screen."""
        changes = self.lighting(scene) if self.lighting else {}
        return replace(scene, interpolation="linear", **changes)

    def scene_of(self, scene: Scene) -> Scene:
        """`scene` as this shading asks for it."""
        return replace(self.lit(scene), interpolation=self.interpolation)


def light_at_eye(scene: Scene) -> dict[str, Any]:
    """Warnock's light (see docs/shading.md) for `scene`: at the eye, in the colours of the scene's
    first light. Its factor falls in a straight line from 1 at the vertex that is nearest to the eye
    to FARTHEST_FACTOR at the farthest one.
    """
    camera, first = scene.camera, scene.lights[0]
    points = np.concatenate([item.mesh.vertices for item in scene.objects])
    back, along = camera.axes[2], camera.projection == "orthographic"
    source = back * float((points @ back).max()) if along else camera.eye
    distance = Place(None, source, along).distance(points, back)
    ends = float(distance.min()), float(distance.max())
    falloff = Falloff(ends, (1.0, FARTHEST_FACTOR)) if ends[0] < ends[1] else None
    place = Place(None, source, along, falloff)
    light = Light(back, first.ambient, first.diffuse, first.specular, "at the eye", place)
    return {"light": back, "lights": [light]}


#: The column that all others are compared with where a scene has no true surface.
PHONG = Shading("phong", "Phong", DEFAULT)

#: The columns of a comparison, in order. A new shading is a line here.
SHADINGS = (
    Shading("flat", "flat", TECHNIQUES["flat"]),
    Shading("gouraud", "Gouraud", TECHNIQUES["gouraud"]),
    Shading("warnock", "Warnock", DEFAULT, lighting=light_at_eye),
    PHONG,
    Shading("normalized_edges", "Phong, edges normalized", DEFAULT, "normalized_edges"),
    Shading(
        "quadratic", "Phong, quadratic normals",
        replace(DEFAULT, name="quadratic_normals", normal_order=2), "quadratic",
    ),
)  # fmt: skip
