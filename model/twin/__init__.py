# SPDX-License-Identifier: MIT
"""The bit-accurate twin: integers only, one file per RTL module, one function per stage.

The folders and file names are those of `rtl/`. The section headings of a Verilog file are the names
of the stage functions in its twin. `render` shades a whole frame as the hardware does, bit for bit.
`zero_normals` counts the pixels that the hardware flags for a zero normal.

A stage function takes codes (int64 arrays) and gives codes. Docstrings name a format by its field
of `Config` and give the default's Q-format behind it: `cosine` (u0.18). A function with a `trace`
records what each stage gives under "module.stage"; the testbenches compare that with the RTL.
"""

from phong75.model.twin.phong_pipeline import Pixels, render, zero_normals

#: The RTL modules without a twin file, and why: they carry data and compute no new value.
NO_TWIN = {
    "pixel_fifo": "passes every pixel on unchanged and in order, however the sink stalls",
    "delay": "gives the word unchanged, CYCLES cycles later",
    "light_turns": "takes the records of a span and orders the turns of a pixel's lights",
    "span_word": "keeps a word of a span's record for all pixels of the span",
    "turn_hold": "keeps the word of a pixel's first turn for its other turns",
    "lut_ram": "gives the word last written to the address: a light's interpolated state",
    "ram": "gives the word last written to the address: an index into the material table",
    "small_ram": "gives the word last written to the address: an index into the material table",
    "multiplier": "exact product, which `*` gives in Python",
    "narrow_multiplier": "exact product, which `*` gives in Python",
    "slope_multiplier": "exact product, which `*` gives in Python",
}

__all__ = ["NO_TWIN", "Pixels", "render", "zero_normals"]
