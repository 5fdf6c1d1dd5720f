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

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from phong75.model import (
        DEFAULT,
        SPAN_DTYPE,
        TECHNIQUES,
        Config,
        ExactFrame,
        Format,
        Frame,
        FrontEnd,
        InputError,
        MaterialTable,
        Pixels,
        Scene,
        bundled_scenes,
        fitted,
        front_end,
        load_scene,
        picture,
        read_spans,
        reference,
        render,
        technique_scenes,
        twin,
        write_spans,
    )

__version__ = "0.2.0"

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
    "__version__",
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


def __getattr__(name: str) -> Any:
    """Import the model when one of its names is first asked for: `phong75 --help` needs none."""
    if name not in (*__all__, "model"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    model = importlib.import_module("phong75.model")
    return model if name == "model" else globals().setdefault(name, getattr(model, name))


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
