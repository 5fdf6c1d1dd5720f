"""Quick synthesis: the resource bars, and a small frame through the netlist in ECP5 cells."""

import json

from phong75.model import twin
from phong75.model.analysis import metrics
from phong75.model.front.scene import load_scene
from phong75.model.scene_to_frame import front_end
from phong75.scripts import netlist, recorded
from phong75.sim.design import BUILD
from phong75.sim.frame.run_frame import SimJob, simulate_jobs


def test_resources_and_a_frame_in_ecp5_cells():
    made = netlist.bench()
    synthesis = json.loads((BUILD / "synth" / "default" / "synthesis.json").read_text())
    resources = synthesis["resources"]
    assert resources["dsp"] <= 19 and resources["ebr"] <= 4 and resources["lut"] <= 2500, resources
    # Flow control is reset (of the normalizer a flag), the datapath is not: nothing waits for data
    # to be flushed.
    assert set(synthesis["resets"]) == {"span_walker", "normalizer", "pixel_fifo"}
    recorded_resources = recorded.figures("synth-grade6")["resources"]
    assert resources == recorded_resources, "the record is old: make synth"
    frame = front_end(load_scene("still_life", (160, 120))).frame
    two_sided = front_end(load_scene("cone", (160, 120))).frame
    two_sided.two_sided = True
    frames = [frame, two_sided]
    for given, result in zip(
        frames, simulate_jobs([SimJob(f) for f in frames], bench=made), strict=True
    ):
        compared = metrics.compare(twin.render(given), result.pixels)
        assert compared.mismatches == 0 and result.stall_cycles == 0, compared.first
