"""The bit-accurate twin: integers only, one file per RTL module, one function per stage.

`render` shades a whole frame as the hardware does, to the bit.
"""

from .phong_pipeline import Pixels, render

__all__ = ["Pixels", "render"]
