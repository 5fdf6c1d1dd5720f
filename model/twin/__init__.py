"""The bit-accurate twin: integers only, one file per RTL module, one function per stage.

`render` shades a whole frame as the hardware does, to the bit; `zero_normals` counts what it flags.
"""

from phong75.model.twin.phong_pipeline import Pixels, render, zero_normals

__all__ = ["Pixels", "render", "zero_normals"]
