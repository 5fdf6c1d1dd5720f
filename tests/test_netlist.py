"""Quick synthesis: the resource bars, and a small frame through the netlist in ECP5 cells."""

import json

from model import metrics, twin
from model.scene import load_scene
from model.scene_to_spans import front_end
from scripts import netlist
from sim.build import BUILD
from sim.run_frame import Job, simulate_jobs


def test_resources_and_a_frame_in_ecp5_cells():
    made = netlist.bench()
    resources = json.loads((BUILD / "synth" / "default" / "synthesis.json").read_text())[
        "resources"
    ]
    assert resources["dsp"] <= 19 and resources["ebr"] <= 4 and resources["lut"] <= 2500, resources
    frame = front_end(load_scene("still_life", (160, 120))).frame
    two_sided = front_end(load_scene("cone", (160, 120))).frame
    two_sided.two_sided = True
    frames = [frame, two_sided]
    for given, result in zip(
        frames, simulate_jobs([Job(f) for f in frames], bench=made), strict=True
    ):
        compared = metrics.compare(twin.render(given), result.pixels)
        assert compared.mismatches == 0 and result.stall_cycles == 0, compared.first
