# SPDX-License-Identifier: MIT
"""Phong75's model: scenes to spans, the bit-accurate twin of the RTL, the float64 reference.

    import phong75

    front = phong75.front_end(phong75.load_scene("teapot"))
    pixels = phong75.render(front.frame)             # bit for bit what the RTL gives
    exact = phong75.reference.render(front.frame)    # 255 S in float64, eq. (3) of the paper
    phong75.picture(front.frame, pixels)             # a PIL image, which a notebook shows
    phong75.picture(front.frame, pixels).save("teapot.png")

Arrays are numpy arrays; the docstrings give their shapes and formats. What a user does wrong raises
`InputError` with one line that says where and how.
"""

from phong75.model import twin
from phong75.model.analysis import reference
from phong75.model.analysis.pictures import picture
from phong75.model.config import DEFAULT, TECHNIQUES, Config, Format
from phong75.model.frame import (
    SPAN_DTYPE,
    ExactFrame,
    Frame,
    InputError,
    MaterialTable,
    fitted,
)
from phong75.model.front.scene import Scene, bundled_scenes, load_scene, technique_scenes
from phong75.model.front.scene_to_spans import FrontEnd
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import read_spans, write_spans
from phong75.model.twin import Pixels, render

__all__ = [
    "DEFAULT",
    "SPAN_DTYPE",
    "TECHNIQUES",
    "Config",
    "ExactFrame",
    "Format",
    "Frame",
    "FrontEnd",
    "InputError",
    "MaterialTable",
    "Pixels",
    "Scene",
    "bundled_scenes",
    "fitted",
    "front_end",
    "load_scene",
    "picture",
    "read_spans",
    "reference",
    "render",
    "technique_scenes",
    "twin",
    "write_spans",
]
