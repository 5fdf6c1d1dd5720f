# SPDX-License-Identifier: MIT
"""From a scene to the frame that the hardware is given: the front end with its vertex shader.

`model/front` knows scenes and spans, `model/vertex_shading.py` knows the shading hardware. This
module joins the two.
"""

from __future__ import annotations

from collections.abc import Callable

from phong75.model.config import DEFAULT, Config
from phong75.model.front.scene import Scene
from phong75.model.front.scene_to_spans import FrontEnd, make_frame
from phong75.model.vertex_shading import shade_vertices


def front_end(
    scene: Scene, config: Config = DEFAULT, progress: Callable[[float], None] | None = None
) -> FrontEnd:
    """Make the spans, registers and material table of `scene` for the hardware of `config`.

    progress: called with the part done, 0 to 1, as the work goes on. A scene entirely outside the
    view gives a frame without spans. Raises InputError if the scene does not fit `config`.
    """
    return make_frame(scene, config, shade_vertices, progress)
