# SPDX-License-Identifier: MIT
"""What the hardware's approximation of a light at a place costs, by its rule: error and spans.

The error is that of the twin's codes, which the RTL has to the bit, against the exact picture:
float64, with the direction and the half vector of each pixel's own point.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from phong75.model import twin
from phong75.model.analysis import reference
from phong75.model.config import DEFAULT
from phong75.model.frame import with_lights
from phong75.model.front.scene import Scene, load_scene
from phong75.model.places import MOST_TURN, RULES
from phong75.model.scene_to_frame import front_end

#: The scene that is measured, with lights among its objects, and the size of its picture.
SCENE, SIZE = "near_light", (320, 240)

#: Angle that no span reaches: spans are not cut.
NEVER = 4.0


@dataclass(frozen=True)
class RuleRow:
    """The errors of one rule: LSB of a code, against the exact picture.

    rule: of `places.RULES`. most_turn: radians, at which spans are cut; None if they are not.
    spans: number of spans. max_lsb, rms_lsb: largest error, and root mean square.
    """

    rule: str
    most_turn: float | None
    spans: int
    max_lsb: float
    rms_lsb: float


def by_rule(scene: Scene, rule: str, most_turn: float) -> Scene:
    """`scene` with `rule` and `most_turn` for all its lights at a place."""
    lights = [
        replace(light, place=replace(light.place, rule=rule, most_turn=most_turn))
        for light in scene.lights
    ]
    return replace(scene, lights=lights)


def measure(name: str = SCENE, size: tuple[int, int] = SIZE) -> list[RuleRow]:
    """A row for each rule, without and with cut spans."""
    scene, rows = load_scene(name, size), []
    for rule in RULES:
        for most_turn in (NEVER, MOST_TURN) if rule != "face" else (NEVER,):
            front = front_end(by_rule(scene, rule, most_turn))
            config = with_lights(DEFAULT, front.frame)
            codes = twin.render(front.frame, config).rgb
            error = codes - reference.render_exact(front.frame, front.exact, config)
            rows.append(
                RuleRow(
                    rule, most_turn if most_turn < NEVER else None, len(front.frame.spans),
                    float(np.abs(error).max()), float(np.sqrt((error**2).mean())),
                )
            )  # fmt: skip
    return rows
