"""Gouraud and flat shading: whole frames to the bit, vertices within the budget, 0 multipliers."""

import dataclasses
import shutil

import numpy as np
import pytest

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, pruning, reference
from phong75.model.config import DEFAULT as C
from phong75.model.config import MAX_JUMPS, TECHNIQUES
from phong75.model.frame import InputError
from phong75.model.front.camera import light_frame
from phong75.model.front.mesh import apply_matrix, face_normals
from phong75.model.front.scene import bundled_scenes, load_scene
from phong75.model.reflectance import weight_distance
from phong75.model.scene_to_frame import front_end
from phong75.model.twin.core.phong_unit import shade
from phong75.model.vertex_shading import exact_intensities, intensities
from phong75.scripts import scene_results
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.frame.locate import locate
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from phong75.sim.latency import latencies
from tests.test_error import frame_of

GOURAUD_AND_FLAT = ("gouraud", "flat")
GOURAUD, FLAT = (TECHNIQUES[name] for name in GOURAUD_AND_FLAT)


def grey(config):
    return dataclasses.replace(config, name=f"grey_{config.name}", channels=1)


def grey_scene(name, size=None):
    scene = load_scene(name, size)
    for k, material in enumerate(scene.materials):
        scene.materials[k] = dataclasses.replace(material, color=(material.color[1],) * 3)
    return scene


def check(made, config, results):
    """Frames `made` by the front end and what the RTL gave for them."""
    for front, result in zip(made, results, strict=True):
        compared = metrics.compare(twin.render(front.frame, config), result.pixels)
        assert compared.mismatches == 0, compared.first
        assert result.complete and not result.extra_pixels and not result.illegal_spans
        assert result.stall_cycles == 0
        assert result.latency_cycles == latencies(config)["pixel"] + 3
        exact = reference.render(front.frame, config)
        error = np.abs(result.pixels.rgb - exact).max()
        assert error <= error_budget.bound_lsb(front.frame, config) < 0.5001


#: The largest size is that of one scene.
SIZES_OF = {"still_life": scene_results.SIZES}


@pytest.mark.parametrize("technique", GOURAUD_AND_FLAT)
@pytest.mark.parametrize("scene", bundled_scenes())
def test_bundled_scene(scene, technique):
    config = TECHNIQUES[technique]
    sizes = SIZES_OF.get(scene, scene_results.SIZES[:1])
    made = [front_end(load_scene(scene, size), config) for size in sizes]
    check(made, config, simulate_jobs([SimJob(front.frame) for front in made], config))


@pytest.mark.parametrize("config", [grey(GOURAUD), grey(FLAT)], ids=lambda c: c.name)
def test_grey_has_one_channel_and_the_same_pixels(config):
    colour = TECHNIQUES[config.technique]
    made = front_end(grey_scene("still_life", (320, 240)), colour)
    result = simulate_jobs([SimJob(made.frame)], config)[0]
    check([made], config, [result])
    assert metrics.compare(twin.render(made.frame, colour), result.pixels).mismatches == 0
    assert pruning.prune(made.frame, colour)[0].channels == 1
    assert pruning.prune(front_end(load_scene("still_life"), colour).frame, colour)[0].channels == 3
    with pytest.raises(InputError, match="has colours, but the pipeline is built for grey"):
        front_end(load_scene("still_life"), config)


# -- what stands in the spans ----------------------------------------------------------------------


def test_vertex_intensities_are_those_of_the_pipeline_and_within_its_bound():
    rng = np.random.default_rng(75)
    frame = frame_of(0.7, 10, (0.7, 0.5, 0.2), 0.2, 0.5)
    normal = rng.normal(size=(50_000, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    material = np.zeros(len(normal), np.int64)
    s = intensities([normal], material, frame, GOURAUD)
    codes = shade(C.normal.quantize(normal).T, material, frame).T
    assert (metrics.rounded(255 * s) == codes).all()
    exact = C.normal.quantize(normal).astype(float)
    table, real = frame.materials, C.coefficient.real
    ideal = reference.shade(
        exact, real(table.ambient)[material], real(table.diffuse)[material],
        real(table.weight)[material], C.exponent.real(table.exponent)[material],
        reference.eye_of(frame.half_vector), False,
    )  # fmt: skip
    # The bound of the code is that of S and the last rounding.
    assert np.abs(255 * s - ideal).max() <= error_budget.bound_lsb(frame) - 0.5


def test_gouraud_pixels_are_means_of_the_vertices():
    """The same pixels as with normals, and no intensity beyond those of the vertices."""
    scene = load_scene("sphere")
    phong = twin.render(front_end(scene).frame)
    made = front_end(scene, GOURAUD)
    gouraud = twin.render(made.frame, GOURAUD)
    assert (gouraud.x == phong.x).all() and (gouraud.y == phong.y).all()
    mesh = scene.objects[0].mesh
    axes, _ = light_frame(scene.light, scene.camera.axes[2])
    normal = apply_matrix(axes, mesh.normals).reshape(-1, 3)
    s = exact_intensities(normal, np.zeros(len(normal), np.int64), made.exact, False)
    assert gouraud.rgb.max() <= np.ceil(255 * s.max())
    ends = made.exact.start, made.exact.start + made.exact.step * (
        made.frame.spans["length"] - 1
    )[:, None]  # fmt: skip
    for end in ends:
        assert end.min() >= s.min() - 1e-12 and end.max() <= s.max() + 1e-12


def test_flat_has_one_code_a_face():
    scene = load_scene("torus", (320, 240))
    made = front_end(scene, FLAT)
    assert (made.frame.spans["step"] == 0).all() and (made.exact.step == 0).all()
    mesh = scene.objects[0].mesh
    faces = face_normals(mesh.vertices, mesh.faces)
    colours = len(np.unique(made.frame.spans["start"], axis=0))
    assert 100 < colours <= len(np.unique(np.round(faces, 12), axis=0))


@pytest.mark.parametrize("technique", GOURAUD_AND_FLAT)
def test_rounding_before_the_ports_costs_no_more_than_the_pipeline_itself(technique):
    """Codes against the scene in float64: the twin at the vertices, s1.30 along the span."""
    config = TECHNIQUES[technique]
    for scene in bundled_scenes():
        loaded = load_scene(scene)
        made = front_end(loaded, config)
        codes = twin.render(made.frame, config).rgb
        error = np.abs(codes - reference.render_exact(made.frame, made.exact, config))
        table = made.frame.materials
        assert table.curve is None and table.weight_jumps is None, "then no bound holds at a jump"
        none = np.zeros((MAX_JUMPS, 3), np.int64)
        apart = max(  # how far the tables of W are from the scene
            255 * weight_distance(m.weight_curve, table.weight[k], none, C)
            for k, m in enumerate(loaded.materials)
        )
        assert error.max() <= error_budget.bound_lsb(made.frame) + 0.01 + apart, scene


def test_normalized_edges_are_refused():
    scene = load_scene("sphere")
    scene.interpolation = "normalized_edges"
    with pytest.raises(InputError, match="normalized_edges is for normals, which flat shading"):
        front_end(scene, FLAT)


# -- the checks can fail ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("module", "old", "new", "says"),
    [
        ("intensity_code", "1'b1 << INTENSITY_FRACTION", "0", "stage intensity_code.clamp"),
        ("gouraud_unit", ".step(values[(CHANNELS+c)", ".step(values[(2*CHANNELS-1-c)",
         "intensity_code agree with the twin for this pixel's interpolated vector"),
    ],
)  # fmt: skip
def test_a_broken_design_fails_and_is_located(tmp_path, module, old, new, says):
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    text = design.module_file(module, rtl).read_text()
    assert text.count(old) == 1
    design.module_file(module, rtl).write_text(text.replace(old, new))
    frame = front_end(load_scene("still_life", (160, 120)), GOURAUD).frame
    frame.spans["start"][::7] += C.normal.one // 2  # some above 1
    result = simulate_jobs([SimJob(frame)], GOURAUD, Bench("frame_bench", GOURAUD, rtl=rtl))[0]
    first = metrics.compare(twin.render(frame, GOURAUD), result.pixels).first
    assert says in locate(frame, first.index, GOURAUD, rtl)
