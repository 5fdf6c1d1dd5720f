# SPDX-License-Identifier: MIT
"""Quadratic normals: mid-edge normals, parabolas along spans, their words, and the bound."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from phong75.model import twin
from phong75.model.analysis import error_budget, metrics, pruning, reference
from phong75.model.config import DEFAULT, TECHNIQUES, Config
from phong75.model.frame import SPAN_DTYPE, ExactFrame, InputError, fitted
from phong75.model.front import mid_edge_normals as rules
from phong75.model.front import scene_to_spans, shapes
from phong75.model.front.camera import Camera, view_axes
from phong75.model.front.interpolation import interpolate_quadratic, scan_line_weights
from phong75.model.front.mesh import Mesh, normalize
from phong75.model.front.scene import (
    Material,
    Scene,
    SceneObject,
)
from phong75.model.front.visibility import GRID
from phong75.model.scene_to_frame import front_end
from phong75.model.spans import (
    illegal_spans,
    pack,
    read_spans,
    unpack,
    write_spans,
    written_for,
)
from phong75.model.studies import quadratic_cases
from phong75.model.twin.core.linear_interpolator import linear_interpolator
from phong75.model.twin.techniques.second_difference_interpolator import (
    jam,
    parabola,
    second_difference_interpolator,
)
from phong75.sim import design
from phong75.sim.build import Bench
from phong75.sim.frame import corner_cases as table
from phong75.sim.frame.locate import locate
from phong75.sim.frame.run_frame import SimJob, simulate_jobs
from tests.configuration_tests import QUADRATIC, bent, bent_misfits, plain, straight

RNG = np.random.default_rng(75)
BACK = normalize(np.array([0.2, -0.4, 1.0]))
seeds = st.integers(0, 2**32 - 1)


def picture(meshes, interpolation="quadratic", size=(96, 72), height=2.9, **camera):
    """A scene of `meshes`, seen along BACK."""
    axes = view_axes(BACK, (0, 0, 1))
    made = {"projection": "orthographic", "height": height, "eye": 10 * axes[2]} | camera
    return Scene(
        "test", *size, (0, 0, 0), Camera(axes=axes, target=np.zeros(3), **made),
        normalize(np.array([-0.5, 0.6, 1.0]) @ axes), False, interpolation,
        [SceneObject(f"mesh {k}", mesh, 0) for k, mesh in enumerate(meshes)], [Material()],
    )  # fmt: skip


def along(spans, start, step, bend):
    """The vector at every pixel of `spans`, and the number of the pixel's span."""
    span = np.repeat(np.arange(len(spans)), spans["length"])
    k = np.arange(len(span)) - np.repeat(
        np.cumsum(spans["length"]) - spans["length"], spans["length"]
    )
    k = k[:, None]
    return start[span] + k * step[span] + k * (k - 1) / 2 * bend[span], span


# -- mid-edge normals ------------------------------------------------------------------------------


def edge(first, last, along=(2.0, 0.0, 0.0)):
    """A mesh of one triangle whose first edge is `along`, with normals `first` and `last`."""
    corners = np.array([(0, 0, 0), along, (0, 1, 0)], float)
    normals = normalize(np.array([[first, last, (0, 0, 1)]], float))
    return Mesh(corners, np.array([[0, 1, 2]]), normals)


def test_vlachos_reflects_the_mean():
    """Both ends lean along the edge: the middle leans the other way, as an inflection does."""
    leaning = edge((0.6, 0, 0.8), (0.6, 0, 0.8))
    up = np.broadcast_to([0.0, 0, 1], (1, 3, 3))
    middle = rules.mid_edge_normals(leaning, "quadratic_vlachos", up)[0, 0]
    assert middle == pytest.approx([-0.6, 0, 0.8])
    arc = edge((-0.6, 0, 0.8), (0.6, 0, 0.8))
    assert rules.mid_edge_normals(arc, "quadratic_vlachos", up)[0, 0] == pytest.approx([0, 0, 1])


def test_the_cubic_through_both_ends_leans_half_as_much():
    """y = a x (1 - x)(1 - 2 x)... has the slope s at both ends of a unit chord, -s/2 between."""
    slope = 0.01
    leaning = edge((-slope, 0, 1), (-slope, 0, 1), (1.0, 0, 0))
    flat = np.zeros((1, 3, 3, 3))
    middle = rules._of_curved_edge(leaning, flat)[0, 0]
    assert middle == pytest.approx(normalize(np.array([slope / 2, 0, 1])), abs=1e-6)


@pytest.mark.parametrize("rule", rules.RULES)
def test_a_shared_edge_has_one_normal(rule):
    """Both triangles of an edge compute the same, so that no edge shows."""
    mesh = shapes.torus(1.0, 0.4, 16, 8).transformed((1, 1.5, 0.8), (10, 20, 30), (3, 2, 1))
    back = np.broadcast_to(BACK, mesh.normals.shape)
    middle = rules.mid_edge_normals(mesh, rule, back)
    assert np.linalg.norm(middle, axis=-1) == pytest.approx(1)
    face = np.cross(
        mesh.vertices[mesh.faces[:, 1]] - mesh.vertices[mesh.faces[:, 0]],
        mesh.vertices[mesh.faces[:, 2]] - mesh.vertices[mesh.faces[:, 0]],
    )
    front = np.flatnonzero(face @ BACK > 0)
    known, seen = {}, 0
    for f in front:
        for k in range(3):
            ends = mesh.vertices[mesh.faces[f, [k, (k + 1) % 3]]]
            key = tuple(sorted(map(tuple, np.round(ends, 9))))
            if key in known:
                seen += 1
                assert middle[f, k] == pytest.approx(known[key], abs=1e-9)
            known[key] = middle[f, k]
    assert seen > 100


def test_flat_faces_stay_flat_and_a_crease_separates():
    mesh = shapes.pyramid()
    back = np.broadcast_to(BACK, mesh.normals.shape)
    for rule in ("quadratic", "quadratic_vlachos"):
        assert rules.mid_edge_normals(mesh, rule, back) == pytest.approx(mesh.normals, abs=1e-12)


@pytest.mark.parametrize(
    "mesh",
    [shapes.sphere(2.0, 32, 16), shapes.torus(1.0, 0.4, 48, 24),
     shapes.torus(1.0, 0.4, 48, 24).transformed((1, 2, 0.5), (20, 30, 40), (5, 6, 7))],
    ids=["sphere", "torus", "transformed"],
)  # fmt: skip
def test_the_eye_sees_the_corners_where_they_are(mesh):
    """From a point beside a corner, along a ray through it: the corner's normal."""
    corner, normal = mesh.vertices[mesh.faces].reshape(-1, 3), mesh.normals.reshape(-1, 3)
    facing = normal @ BACK
    chosen = facing > 0.3
    offset = RNG.uniform(-0.02, 0.02, len(corner))[:, None] * BACK
    reach = np.full(len(corner), 0.2)
    hit, seen = mesh.surface.see(corner + offset, np.broadcast_to(BACK, corner.shape), reach)
    assert hit[chosen].all()
    assert np.abs(seen - normal)[chosen].max() < 1e-6
    far = mesh.surface.see(corner + 100 * BACK, np.broadcast_to(BACK, corner.shape), reach)[0]
    assert not far.any()


def test_new_normals_have_no_surface():
    assert shapes.sphere().surface is not None
    assert shapes.sphere().with_crease(30.0).surface is None


# -- over triangles and along spans ----------------------------------------------------------------


@settings(max_examples=50, deadline=None, derandomize=True)
@given(seeds)
def test_quadratic_polynomials_are_reproduced(seed):
    """Over triangles of all shapes, slivers too, at points inside."""
    rng = np.random.default_rng(seed)
    corner = rng.integers(0, 64 * GRID, (40, 3, 2))
    corner[::4, 2] = corner[::4, 1] + rng.integers(-3, 4, (10, 2))
    order = np.argsort(corner[..., 1], axis=1, kind="stable")
    corner = np.take_along_axis(corner, order[..., None], axis=1)
    corner = corner[corner[:, 0, 1] < corner[:, 2, 1]]
    share = rng.dirichlet(np.ones(3), len(corner))
    point = np.einsum("nk,nkc->nc", share, corner.astype(float))
    point[:, 1] = np.clip(point[:, 1], corner[:, 0, 1], corner[:, 2, 1] - 1e-3)
    a = rng.normal(size=(6, 3))

    def value(p):
        x, y = p[..., :1] / GRID / 64, p[..., 1:] / GRID / 64
        return a[0] + a[1] * x + a[2] * y + a[3] * x * x + a[4] * x * y + a[5] * y * y

    opposite = (np.roll(corner, -1, axis=1) + np.roll(corner, -2, axis=1)) / 2
    values = np.concatenate([value(corner), value(opposite)], axis=-1)
    weights = scan_line_weights(corner[..., 0], corner[..., 1], point[:, 0], point[:, 1])
    got = interpolate_quadratic(values, weights)
    across, down = (corner[:, k] - corner[:, 0] for k in (1, 2))
    wide = np.abs(across[:, 0] * down[:, 1] - across[:, 1] * down[:, 0]) > GRID**2 // 100
    assert np.abs(got - value(point))[wide].max() < 1e-6 and wide.sum() > 20
    largest = np.abs(values).max(axis=(1, 2))
    assert (np.abs(got).max(axis=1) <= 5 / 3 * largest + 1e-9).all(), "slivers stay in bounds"


@pytest.mark.parametrize("rule", rules.RULES)
@pytest.mark.parametrize("projection", [{}, {"projection": "perspective", "fov": 20.0, "near": 1}])
def test_spans_are_parabolas_and_nothing_is_lost(rule, projection):
    """The words of a span give the exact normal of each of its pixels, but for their rounding."""
    made = front_end(picture([shapes.torus(1.0, 0.4, 12, 8)], rule, **projection))
    spans, exact = made.frame.spans, made.exact
    config = fitted(DEFAULT, made.frame)
    assert config.normal_order == 2 and not illegal_spans(made.frame, config).any()
    codes = (
        config.normal.real(spans["start"]), config.normal.real(spans["step"]),
        config.bend.real(spans["bend"]),
    )  # fmt: skip
    true, span = along(spans, exact.start, exact.step, exact.bend)
    words, _ = along(spans, *codes)
    first = np.cumsum(spans["length"]) - spans["length"]
    k = (np.arange(len(span)) - first[span])[:, None]
    lsb, fine = config.normal.lsb, config.bend.lsb
    bound = (lsb + k * lsb + k * (k - 1) / 2 * fine) / 2
    assert (np.abs(words - true) <= bound * (1 + 1e-6)).all()
    assert (spans["bend"][spans["length"] <= 2] == 0).all()
    assert (spans["bend"] != 0).any(axis=1).mean() > 0.3
    assert np.linalg.norm(true, axis=1).max() < 2


def test_the_bend_costs_less_than_the_step_over_4096_pixels():
    """The promise of `Config.bend`: its share at the last pixel is below half of the step's."""
    length = DEFAULT.max_size
    step = (length - 1) / 2 * DEFAULT.normal.lsb
    bend = (length - 1) * (length - 2) / 4 * DEFAULT.bend.lsb
    assert DEFAULT.bend_fraction_bits == DEFAULT.coordinate_bits
    assert bend < step / 2 < 2 * bend
    one_less = replace(DEFAULT, bend_fraction_bits=DEFAULT.bend_fraction_bits - 1)
    assert (length - 1) * (length - 2) / 4 * one_less.bend.lsb > step / 2


def test_parabola_goes_through_three_points():
    length = np.array([1, 2, 3, 4, 4096])
    first, middle, last = RNG.normal(size=(3, 5, 3))
    bend, step = scene_to_spans._parabola(first, middle, last, length)
    k = (length - 1)[:, None]
    assert first + k * step + k * (k - 1) / 2 * bend == pytest.approx(
        np.where(k > 0, last, first), abs=1e-9
    )
    h = k[2:] / 2
    assert first[2:] + h * step[2:] + h * (h - 1) / 2 * bend[2:] == pytest.approx(
        middle[2:], abs=1e-9
    )
    assert not bend[:2].any()


def test_clipping_does_not_move_a_normal():
    """Triangles cut at the guard band show the same normals as whole ones."""
    corners = np.array([[(-90.0, -60, 0), (90, -60, 0), (0, 90, 0)]]).reshape(3, 3)
    normals = normalize(np.array([[(0.6, 0, 0.8), (-0.6, 0.2, 0.8), (0, 0.5, 0.9)]]))
    mesh = Mesh(corners, np.array([[0, 1, 2]]), normals)
    camera = dict(target=np.zeros(3), eye=np.array([0, 0, 1.0]), axes=np.eye(3), near=0.0)

    def frame(height):
        scene = picture([mesh], "quadratic", (64, 64))
        # One scene unit is 64/height pixels: beyond 65536 pixels a triangle is clipped.
        scene.camera = Camera("orthographic", height=height, **camera)
        made = front_end(scene)
        return along(made.frame.spans, made.exact.start, made.exact.step, made.exact.bend)[0]

    whole, cut = frame(0.1), frame(0.05)
    assert len(whole) == len(cut) == 64 * 64
    # The pixel (i, j) of the second picture is half as far from the middle as that of the first.
    whole, cut = whole.reshape(64, 64, 3), cut.reshape(64, 64, 3)
    corners_of_cut = (cut[0, 0] + cut[0, 1] + cut[1, 0] + cut[1, 1]) / 4
    assert corners_of_cut == pytest.approx((whole[15, 15] + whole[16, 16]) / 2, abs=1e-6)


@pytest.mark.parametrize("rule", ["quadratic", "quadratic_vlachos"])
def test_a_triangle_that_passes_the_eye_has_the_normals_of_its_part(rule):
    """In perspective, cut at the near plane: the part in the picture has the normals of the whole
    triangle, quadratic in space, at its corners and where the middles of its edges are seen."""
    corners = np.array([(-4.0, 0, -1), (4, 0, -1), (0, 14, -1.2)])  # the eye is above y = 0
    normals = normalize(np.array([[(0.3, 0, 0.9), (-0.3, 0.1, 0.9), (0, 0.3, 0.9)]]))
    mesh = Mesh(corners, np.array([[0, 1, 2]]), normals)
    axes = view_axes((0, -1, 0.1), (0, 0, 1))
    scene = picture([mesh], rule, (64, 64))
    scene.camera = Camera(
        "perspective", axes, np.array([0, 5.0, -1]), np.array([0, 3.0, 0]), fov=60.0, near=0.5
    )
    made = front_end(scene)
    value, _ = along(made.frame.spans, made.exact.start, made.exact.step, made.exact.bend)
    assert len(value) > 300 and not illegal_spans(made.frame, QUADRATIC).any()
    length = np.linalg.norm(value, axis=1)
    assert length.min() > 0.8 and length.max() < 1.1


def test_what_no_span_can_hold_becomes_single_pixels():
    """A bend or a change of 2 and more per pixel."""
    segment = scene_to_spans.Segments(*(np.array([v]) for v in (0, 0, 0, 4)))
    triangles = scene_to_spans.Triangles(
        np.array([[0, 0, 8]]) * GRID, np.array([[0, 8, 8]]) * GRID, np.zeros((1, 3)),
        np.zeros((1, 3, 6)), np.array([3]), np.zeros(1),
    )  # fmt: skip
    segment.y[:] = 4
    triangles.value[0, :, 3:] = (1.0, 0, 0)
    triangles.value[0, 1, 3:] = (-1.0, 0, 0)
    exact = ExactFrame(*[np.zeros((0, 3))] * 7, [], [])  # without a light at a place
    gentle = scene_to_spans._spans(triangles, segment, DEFAULT, "quadratic", exact)
    assert len(gentle[0]) == 1
    triangles.value *= 40
    spans, start, step, bend = scene_to_spans._spans(
        triangles, segment, DEFAULT, "quadratic", exact
    )
    assert spans["x"].tolist() == [0, 1, 2, 3] and (spans["length"] == 1).all()
    assert not step.any() and not bend.any() and not spans["bend"].any()
    k = np.arange(4)[:, None]
    want = 40 * (gentle[1] + k * gentle[2] + k * (k - 1) / 2 * gentle[3])
    assert start == pytest.approx(want)


def test_a_model_without_second_differences_refuses_bends():
    made = front_end(picture([shapes.torus(1.0, 0.4, 12, 8)]))
    with pytest.raises(ValueError, match="linear has no normal_order 2"):
        twin.render(made.frame, replace(DEFAULT, name="linear"))
    assert len(twin.render(made.frame, fitted(DEFAULT, made.frame))) > 1000
    assert len(twin.render(made.frame)) > 1000  # the default configuration is fitted


def test_linear_frames_need_no_bend():
    made = front_end(picture([shapes.torus(1.0, 0.4, 12, 8)], "linear"))
    assert not made.frame.spans["bend"].any() and not made.exact.bend.any()
    assert fitted(DEFAULT, made.frame) == DEFAULT


@pytest.mark.parametrize(
    ("interpolation", "config", "says"),
    [
        ("quadratic_exact", DEFAULT, "mesh 1, which is not known"),
        ("quadratic", TECHNIQUES["gouraud"], "is for normals"),
        ("quadratic", Config(normal_method="quadratic_spans"), "do not carry"),
    ],
)
def test_what_cannot_be_done_is_one_line(interpolation, config, says):
    scene = picture([shapes.sphere(), shapes.cone()], interpolation)
    with pytest.raises(InputError, match=says) as error:
        front_end(scene, config)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "changes",
    [{"normal_order": 3}, {"normal_order": 2, "technique": "flat"},
     {"normal_order": 2, "normal_method": "quadratic_spans"}],
)  # fmt: skip
def test_orders_that_do_not_exist(changes):
    with pytest.raises(ValueError, match="normal_order"):
        Config(**changes)


# -- words -----------------------------------------------------------------------------------------


def random_spans(rng, count, longest):
    spans = np.zeros(count, SPAN_DTYPE)
    spans["length"] = rng.integers(1, longest, count)
    for word, form in (("start", QUADRATIC.normal), ("step", QUADRATIC.normal),
                       ("bend", QUADRATIC.bend)):  # fmt: skip
        code = rng.integers(form.min, form.max, (count, 3), endpoint=True)
        shift = rng.integers(0, form.bits, (count, 1))
        spans[word] = code >> shift
    return spans


@settings(max_examples=20, deadline=None, derandomize=True)
@given(seeds)
def test_illegal_spans_are_those_that_leave_a_word(seed):
    """Against a walk through the pixels in whole numbers of any size."""
    rng = np.random.default_rng(seed)
    spans = random_spans(rng, 20, 40)
    spans["length"][0] = rng.choice([40, 400, 4096])
    frame = replace(plain(spans=20), spans=spans)
    form, want = QUADRATIC.bend, []
    for s in spans:
        bad = False
        for axis in range(3):
            value, step = (
                int(s[w][axis]) << QUADRATIC.bend_fraction_bits for w in ("start", "step")
            )
            for _ in range(int(s["length"]) - 1):
                value += step
                bad |= not (form.contains(value) and form.contains(step))
                step += int(s["bend"][axis])
        want.append(bool(bad))
    assert illegal_spans(frame, QUADRATIC).tolist() == want


def test_the_twin_is_the_parabola_and_keeps_sign_and_zero():
    rng = np.random.default_rng(1)
    spans = random_spans(rng, 3000, 60)
    k = rng.integers(0, spans["length"])
    for axis in range(3):
        start, step, bend = (spans[w][:, axis] for w in ("start", "step", "bend"))
        wide = parabola(start, step, bend, k, QUADRATIC)
        extra, bits = QUADRATIC.bend_fraction_bits, QUADRATIC.bend.bits
        exact = [
            ((int(a) + int(n) * int(b)) << extra) + n * (n - 1) // 2 * int(c)
            for a, b, c, n in zip(start, step, bend, k.tolist(), strict=True)
        ]
        assert all((int(w) - e) % (1 << bits) == 0 for w, e in zip(wide, exact, strict=True))
        word = second_difference_interpolator(start, step, bend, k, QUADRATIC)
        assert np.array_equal(word, jam(wide, QUADRATIC))
        assert (np.abs((word << extra) - wide) < 1 << extra).all()
        assert np.array_equal(np.sign(word), np.sign(wide))
        linear, left = linear_interpolator(start, step, k, QUADRATIC)
        still = second_difference_interpolator(start, step, 0 * bend, k, QUADRATIC)
        assert np.array_equal(still[~left], linear[~left]) and (~left).sum() > 500


def test_span_file_with_bends(tmp_path):
    rng = np.random.default_rng(2)
    frame = replace(plain(spans=50), spans=random_spans(rng, 50, 40))
    frame.spans["last"][-1] = True
    write_spans(tmp_path / "spans", frame, QUADRATIC)
    assert np.array_equal(read_spans(tmp_path / "spans", QUADRATIC).spans, frame.spans)
    found = written_for(tmp_path / "spans", DEFAULT)  # what `run --spans` builds
    assert np.array_equal(read_spans(tmp_path / "spans", found).spans, frame.spans)
    with pytest.raises(InputError, match="built without normal_order 2"):
        read_spans(tmp_path / "spans", DEFAULT)
    write_spans(tmp_path / "linear", plain(spans=50), DEFAULT)
    assert b"normal_order" not in (tmp_path / "linear").read_bytes()
    with pytest.raises(InputError, match="formats.normal_order is None"):
        read_spans(tmp_path / "linear", QUADRATIC)
    with pytest.raises(ValueError, match="no place for"):
        pack(frame.spans, DEFAULT)


def test_layout_of_a_span_with_bends():
    """Written down once more, by hand."""
    spans = np.zeros(1, SPAN_DTYPE)
    spans[0] = (0xABC, 0x123, 0x1000, (-1, 2, 3), (4, 5, -6), 9, True, (-7, 1 << 42, -(1 << 43)))
    word = int.from_bytes(pack(spans, QUADRATIC), "big")
    fields = [  # lsb, bits, value
        (0, 32, -1), (32, 32, 2), (64, 32, 3), (96, 32, 4), (128, 32, 5), (160, 32, -6),
        (192, 44, -7), (236, 44, 1 << 42), (280, 44, -(1 << 43)),
        (324, 12, 0xABC), (336, 12, 0x123), (348, 13, 0x1000), (361, 4, 9), (365, 1, 1),
    ]  # fmt: skip
    assert word == sum((value & (1 << bits) - 1) << lsb for lsb, bits, value in fields)
    assert np.array_equal(unpack(pack(spans, QUADRATIC), QUADRATIC), spans)


# -- error -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_errors_are_within_the_bound(seed):
    """Of random bent spans with normals of all lengths; and shorter normals give a larger bound."""
    frame = plain(seed, change=bent)
    pixels = twin.render(frame, QUADRATIC)
    bound = error_budget.bound_lsb(frame, QUADRATIC)
    if bound is None:  # a normal of no more than the error of its words
        assert error_budget.tilt_of_words(frame, QUADRATIC) is None
        keep = ~(np.abs(frame.spans["start"]).max(axis=1) < 1 << 12)
        frame.spans = frame.spans[keep]
        frame.spans["last"][-1] = True
        pixels, bound = twin.render(frame, QUADRATIC), error_budget.bound_lsb(frame, QUADRATIC)
    assert bound is not None
    error = np.abs(pixels.rgb - reference.render(frame, QUADRATIC))
    assert error.max() <= bound
    assert twin.zero_normals(frame, QUADRATIC) == reference.zero_normals(frame, QUADRATIC)


def test_the_bound_knows_how_short_a_bent_normal_is():
    """One pixel of 2**-20: 1774 times the tilt of a unit normal; a linear span has none."""
    spans = np.zeros(1, SPAN_DTYPE)
    spans["length"], spans["last"] = 3, True
    spans["start"][0, 2] = one = QUADRATIC.normal.one
    frame = replace(plain(spans=1), spans=spans)
    assert error_budget.tilt_of_words(frame, QUADRATIC) == 0
    spans["bend"][0, 0] = 1
    unit = error_budget.tilt_of_words(frame, QUADRATIC)
    assert unit == pytest.approx(np.sqrt(3) / one, rel=1e-6)
    spans["start"][0, 2] = one >> 20
    short = error_budget.tilt_of_words(frame, QUADRATIC)
    assert short == pytest.approx(unit * 2**20, rel=1e-3)
    small, large = (
        error_budget.rows(0, frame, QUADRATIC, tilt)[-1].bound for tilt in (unit, short)
    )
    assert small < large
    spans["start"][0, 2] = 1
    assert error_budget.tilt_of_words(frame, QUADRATIC) is None
    assert error_budget.bound_lsb(frame, QUADRATIC) is None


# -- leaving out -----------------------------------------------------------------------------------


def test_second_differences_go_where_no_span_bends():
    config, rows = pruning.prune(plain(), QUADRATIC)
    row = next(row for row in rows if row.feature == "normal_order")
    assert config.normal_order == 1 and not row.needed
    config, rows = pruning.prune(plain(change=bent), QUADRATIC)
    assert config.normal_order == 2 and config.idle_step_bits == 0
    assert pruning.prune(plain(still=straight), QUADRATIC)[0].normal_order == 1
    only_bends = plain(still=straight)
    only_bends.spans["bend"][only_bends.spans["length"] > 2, 1] = 5
    config, _ = pruning.prune(only_bends, QUADRATIC)
    assert (config.interpolate_x, config.interpolate_y, config.interpolate_z) == (0, 1, 0)


# -- through the RTL -------------------------------------------------------------------------------


def test_corner_cases():
    bench = Bench("frame_bench", QUADRATIC, quick=True)
    cases = quadratic_cases.cases()
    assert len({case.name for case in cases}) == len(cases) >= 8
    for row in table.run_cases(cases, bench, QUADRATIC):
        assert not row.failures, f"{row.case}: {row.failures}"


def test_a_broken_interpolator_fails_and_is_located(tmp_path):
    """Without the carry into the step's high half: pixels differ, and the message says where."""
    rtl = tmp_path / "rtl"
    shutil.copytree(design.RTL, rtl)
    file = design.module_file("second_difference_interpolator", rtl)
    text = file.read_text()
    old = "step_high + bend_held[SIGN:LOW_BITS] + {{HIGH_BITS - 1{1'b0}}, step_carry};"
    assert text.count(old) == 1
    file.write_text(text.replace(old, old.replace("step_carry", "1'b0")))
    frame = bent_misfits(plain(change=bent), 3)
    bench = Bench("frame_bench", QUADRATIC, rtl=rtl, quick=True)
    result = simulate_jobs([SimJob(frame)], QUADRATIC, bench)[0]
    compared = metrics.compare(twin.render(frame, QUADRATIC), result.pixels)
    assert compared.mismatches > 20
    message = locate(frame, compared.first.index, QUADRATIC, rtl)
    assert "span_walker, second_difference_interpolator, register_map" in message
