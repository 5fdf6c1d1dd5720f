"""Phong75's model: scenes to spans, the bit-accurate twin, the float64 reference.

import model
front = model.front_end(model.load_scene("teapot"))
pixels = model.render(front.frame)             # to the bit what the RTL gives
exact = model.reference.render(front.frame)    # 255 * S in float64
"""

from . import reference, twin
from .config import DEFAULT, TECHNIQUES, Config, Format
from .frame import SPAN_DTYPE, ExactFrame, Frame, InputError, MaterialTable
from .scene import Scene, bundled_scenes, load_scene
from .scene_to_spans import FrontEnd, front_end
from .spans import read_spans, write_spans
from .twin import Pixels, render

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
    "front_end",
    "load_scene",
    "read_spans",
    "reference",
    "render",
    "twin",
    "write_spans",
]
