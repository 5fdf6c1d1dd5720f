# SPDX-License-Identifier: MIT
"""Meshes against true surfaces, and the paper's arguments: a small slice of `make sweep`."""

import json
from dataclasses import replace

import numpy as np
import pytest

from phong75.model.config import TECHNIQUES
from phong75.model.front.interpolation import interpolate_at
from phong75.model.front.mesh import normalize
from phong75.model.scene_to_frame import front_end
from phong75.model.studies import shading_artifacts, tessellation
from phong75.model.studies.surfaces import SURFACES
from phong75.model.twin import render
from phong75.scripts import recorded
from phong75.scripts.studies import artifact_runs, tessellation_runs

RNG = np.random.default_rng(75)
SIZE = (120, 90)
#: What the RTL shades in its default configuration and as Gouraud and flat shading; and the cubic.
OLDER = (*TECHNIQUES, "cubic")
BENT = ("quadratic_vlachos", "quadratic", "quadratic_exact")


# -- surfaces --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", SURFACES)
def test_rays_find_the_corners_of_the_mesh(name):
    """A ray to a corner that faces the eye meets the surface there, with the corner's normal."""
    surface = SURFACES[name]
    mesh = surface.mesh(32)
    back = tessellation.scene_of(surface, mesh).camera.axes[2]
    corner, normal = mesh.vertices[mesh.faces].reshape(-1, 3), mesh.normals.reshape(-1, 3)
    inside = np.ones(len(corner), bool)
    if name == "patch":  # on the border rounding decides
        place = mesh.faces.reshape(-1)
        u, v = place % 33, place // 33
        inside = (np.minimum(u, v) > 0) & (np.maximum(u, v) < 32)
    facing = inside & (normal @ back > 0.3)
    assert facing.sum() > 1000
    hit, seen = surface.see(corner[facing] + 5 * back, back)
    assert hit.all()
    assert np.abs(seen - normal[facing]).max() < 1e-7


@pytest.mark.parametrize("name", SURFACES)
def test_rays_miss_what_is_not_there(name):
    true = tessellation.truth(name, SIZE)
    assert 0.2 < true.covered.mean() < 0.8
    assert np.abs(true.facing[true.covered]).max() <= 1 + 1e-12
    assert true.facing[true.covered].min() > (0.6 if name == "patch" else -1e-9)


@pytest.mark.parametrize("name", SURFACES)
def test_normals_turn_as_finer_meshes_say(name):
    """From corner to corner of a fine mesh: the turn is the difference of normals, to the order
    of the steps squared."""
    surface = SURFACES[name]
    mesh = surface.mesh(surface.levels[-2])
    corner, normal = mesh.vertices[mesh.faces], mesh.normals
    step = np.roll(corner, -1, axis=1) - corner
    along = step - np.sum(step * normal, axis=-1, keepdims=True) * normal
    turn = surface.turn(mesh, along)
    error = np.linalg.norm(turn - (np.roll(normal, -1, axis=1) - normal), axis=-1)
    length = np.linalg.norm(step, axis=-1)
    assert (error <= 8 * length**2).all(), (error / length**2).max()


def test_the_cubic_keeps_quadratics():
    def quadratic(p):
        x, y = p[..., 0], p[..., 1]
        s = 3 + 2 * x - y + 0.5 * x * x - 0.25 * x * y + 0.125 * y * y
        return s, 2 + x - 0.25 * y, -1 - 0.25 * x + 0.25 * y

    corner = RNG.random((500, 3, 2)) * 9
    share = RNG.dirichlet(np.ones(3), 500)
    point = np.einsum("nk,nkc->nc", share, corner)
    value = np.repeat(np.stack(quadratic(corner), axis=-1), 3, axis=-1)
    got = tessellation._bezier(corner, value, point)
    assert np.abs(got - quadratic(point)[0][:, None]).max() < 1e-6


# -- convergence -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def rows():
    """Through the RTL; raises if a pixel differs from the model."""
    levels = {"sphere": (16, 32, 64), "torus": (16, 32, 64), "patch": (2, 4, 8)}
    return [r for shape, ks in levels.items()
            for r in tessellation_runs.measure(shape, ks, SIZE, techniques=OLDER)]  # fmt: skip


def test_columns(rows):
    assert len(rows) == 3 * 4 * 3
    assert all(tuple(row) == tessellation_runs.COLUMNS for row in rows)
    for row in rows:
        assert (row["cycles"] == "") == (row["technique"] == "cubic")


def test_orders_of_convergence(rows):
    """Flat 1, Phong 2 where no outline disturbs, Gouraud on the way to it on coarse meshes."""
    orders = tessellation_runs.summary(rows)["orders"]
    for shape, by in orders.items():
        assert 0.6 < by["flat"]["facing_rms"] < 1.3, shape
        assert 1.7 < by["phong"]["facing_rms"] < 2.3, shape
        assert 1.2 < by["gouraud"]["facing_rms"] < 2.3, shape
        assert by["phong"]["highlight_rms"] > 1.5, shape


def test_phong_is_better_on_highlights(rows):
    found = tessellation_runs.summary(rows)
    for ratios in found["times_phong"]["gouraud, highlight"].values():
        assert min(ratios) > 1.5
    near, far = found["from_phong_rms_lsb"]["cubic"], found["from_phong_rms_lsb"]["gouraud"]
    for shape in near:
        assert near[shape][-1] < far[shape][-1], "the cubic's picture is nearer to Phong's"


def test_errors_are_those_of_the_codes(rows):
    """The rounding to codes moves an error by half an LSB at most, and the hardware's little."""
    for row in rows:
        if row["technique"] != "cubic":
            assert abs(row["max_lsb"] - row["method_max_lsb"]) < 0.51


def test_order_of_a_known_sequence():
    levels = [4, 8, 16, 32, 64]
    assert tessellation.order(levels, [k**-3.0 for k in levels]) == pytest.approx(3)


def test_orders_below_the_floor_do_not_count():
    values = [k**-3.0 for k in (1, 2, 4, 8)] + [5e-4, 4e-4]
    assert tessellation.order([1, 2, 4, 8, 16, 32], values) == pytest.approx(3)


@pytest.mark.parametrize("name", SURFACES)
def test_quadratic_normals_converge_faster(name):
    """Exact mid-edge normals with order 2.9 and more, Vlachos' rule with order 2; and from the
    normals of the mesh alone the error is a fraction of that of linear normals."""
    surface = SURFACES[name]
    levels = surface.levels[:4] if name == "torus" else surface.levels[:3]
    found = {
        technique: [
            tessellation.errors(
                tessellation.shaded(surface, level, technique, SIZE)[1], name, SIZE, where="facing"
            )["rms_lsb"]
            for level in levels
        ]
        for technique in ("phong", *BENT)
    }
    assert tessellation.order(levels[1:], found["quadratic_exact"][1:]) > 2.8
    assert 1.5 < tessellation.order(levels[1:], found["quadratic_vlachos"][1:]) < 2.3
    assert found["quadratic"][-1] < found["phong"][-1] / 3
    assert found["quadratic_exact"][-1] < found["phong"][-1] / 10


def test_the_recorded_torus():
    """The promises: 0.8 LSB from vertex data alone, order 2.9 with exact mid-edge normals."""
    found = recorded.figures("tessellation")
    rms = {row["technique"]: row["method_rms_lsb"] for row in found["meshes"]
           if row["shape"] == "torus"}  # fmt: skip
    assert rms["quadratic"] <= 0.8 < rms["quadratic_vlachos"] < rms["phong"]
    assert min(by["quadratic_exact"]["facing_rms"] for by in found["orders"].values()) >= 2.9
    jumps = {t: of["slope_mean"] for t, of in found["mach_bands"]["torus"]["16"].items()}
    assert jumps["quadratic"] < jumps["gouraud"] < jumps["phong"]


# -- the arguments ---------------------------------------------------------------------------------


def test_mach_bands_are_weaker_with_phong():
    found = artifact_runs.mach({"sphere": (16,), "patch": (8,)}, SIZE)
    for by in (found["sphere"][16], found["patch"][8]):
        assert by["phong"]["slope_mean"] < by["gouraud"]["slope_mean"] / 2
        assert by["flat"]["slope_max"] < 1e-9
        assert by["flat"]["intensity_rms"] > 10 * by["gouraud"]["intensity_rms"]


def test_mach_bands_vanish_where_the_edge_is_none():
    """A flat square of two triangles: the slope jumps across the diagonal of one black corner, and
    not at all with one colour."""
    scene = shading_artifacts.square_scene(10.0, 80)
    scene.materials[0] = replace(scene.materials[0], color=(0.5, 0.5, 0.5))  # nothing saturates
    counted = np.ones(80 * 80, bool)
    config = TECHNIQUES["gouraud"]
    black = shading_artifacts.mach_bands(front_end(scene, config), "gouraud", counted)
    # From 0 to 1/2 over the square's half diagonal, 80/2.2 pixels.
    want = 255 * 0.5 * 2.2 / 80 * np.sin(np.radians(10))
    assert black["slope_mean"] == pytest.approx(want, rel=0.01)
    scene.objects[0].mesh.normals[:] = (0.0, 0.6, 0.8)
    plain = shading_artifacts.mach_bands(front_end(scene, config), "gouraud", counted)
    assert plain["edges"] > 0 and plain["slope_max"] < 1e-9 > plain["intensity_max"]


def test_turning_changes_what_is_only_the_meshs():
    found, maps, curves = artifact_runs.flicker({"sphere": 16}, 3, SIZE, tuple(TECHNIQUES))
    by = found["sphere"]
    changes = [by[t]["change_rms"] for t in ("phong", "gouraud", "flat")]
    assert changes == sorted(changes) and changes[0] < changes[1] / 1.5
    low, high = by["phong"]["peak_range"]
    assert high - low <= 1
    assert len(maps) == len(curves) == 3
    still = list(shading_artifacts.turning("sphere", 16, "phong", 1, SIZE)) * 2
    none = shading_artifacts.flicker(still, [render(frame) for frame in still])
    assert none["change_max"] == none["highlight_path"] == 0


def test_orientation_matters_to_quadrilaterals_only():
    found, pictures = artifact_runs.orientation(60)
    assert found["quadrilateral"]["largest_spread_lsb"] > 100
    assert found["quadrilateral"]["middle_lsb"] == {"0": 255.0, "45": 191.25, "90": 127.5}
    assert found["triangles"]["largest_spread_lsb"] < 1e-9
    assert found["triangles"]["rtl_quarter_turn_lsb"] == 0
    assert len(pictures) == 6 and json.dumps(found)


def test_a_triangle_is_a_polygon():
    for _ in range(100):
        corners, shades = RNG.random((3, 2)), RNG.random(3)
        point = RNG.dirichlet(np.ones(3)) @ corners
        by_edges = shading_artifacts.polygon_shade(corners, shades, point)
        assert by_edges == pytest.approx(interpolate_at(corners, shades[:, None], point)[0])


def test_highlights_are_looked_for_where_they_are():
    true = tessellation.truth("sphere", SIZE)
    scene = tessellation.scene_of(SURFACES["sphere"], SURFACES["sphere"].mesh(4), SIZE)
    half = normalize(scene.light + scene.camera.axes[2])
    y, x = np.divmod(np.flatnonzero(true.highlight), SIZE[0])
    step = scene.camera.height / SIZE[1]
    right, up, _ = scene.camera.axes
    assert (x.mean() + 0.5 - SIZE[0] / 2) * step == pytest.approx(half @ right, abs=0.05)
    assert -(y.mean() + 0.5 - SIZE[1] / 2) * step == pytest.approx(half @ up, abs=0.05)


# -- the record ------------------------------------------------------------------------------------


def test_the_record_is_what_is_measured_now():
    """One mesh of the record anew, at full size and through the RTL."""
    kept = [row for row in recorded.figures("tessellation")["meshes"] if row["shape"] == "sphere"]
    level = kept[0]["level"]
    older = [row for row in kept if row["technique"] in OLDER]
    now = tessellation_runs.measure("sphere", (level,), techniques=OLDER)
    for old, new in zip(older, now, strict=True):
        for name, value in old.items():
            same = new[name] == (value if type(value) is not float else pytest.approx(value, 1e-6))
            assert same, (old["technique"], name, value, new[name])
    for old in (row for row in kept if row["technique"] in BENT):
        _, picture = tessellation.shaded(SURFACES["sphere"], level, old["technique"])
        rms = tessellation.errors(picture, "sphere")["rms_lsb"]
        assert rms == pytest.approx(old["method_rms_lsb"], 1e-6), old["technique"]
