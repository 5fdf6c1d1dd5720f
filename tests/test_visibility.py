# SPDX-License-Identifier: MIT
"""Camera, coverage, visibility and spans: each pixel once, nearest surface, right normals."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from phong75.model.config import DEFAULT, Config, Format
from phong75.model.frame import ExactFrame, InputError
from phong75.model.front import scene_to_spans, visibility
from phong75.model.front.camera import Camera, light_frame, view_axes
from phong75.model.front.interpolation import interpolate, interpolate_at, scan_line_weights
from phong75.model.front.mesh import Mesh
from phong75.model.front.scene import Material, Scene, SceneObject, bundled_scenes, load_scene
from phong75.model.front.scene_to_spans import encode
from phong75.model.front.shapes import sphere
from phong75.model.front.visibility import GRID, Segments, Triangles
from phong75.model.scene_to_frame import front_end

WIDTH, HEIGHT = 24, 20
SMALL = (96, 72)
seeds = st.integers(0, 2**32 - 1)


# -- helpers -----------------------------------------------------------------------------------


def screen_triangles(corners, depth=None, two_sided=True):
    """Triangles of screen corners (float [T, 3, 2] pixels), normals and materials of no matter."""
    corners = np.asarray(corners, float)
    count = len(corners)
    depth = np.zeros((count, 3)) if depth is None else np.asarray(depth, float)
    normal = np.broadcast_to([0.0, 0.0, 1.0], (count, 3, 3))
    return visibility.set_up(
        corners[..., 0], corners[..., 1], depth, normal, np.arange(count), two_sided
    )


def cover(triangles, width=WIDTH, height=HEIGHT):
    return visibility.cover(triangles, *visibility.line_range(triangles, width, height), width)


def count_pixels(segments, width=WIDTH, height=HEIGHT):
    """int [height, width]: how often each pixel is in a segment."""
    pixels = np.zeros((height, width), int)
    for y, left, right in zip(segments.y, segments.left, segments.right, strict=True):
        pixels[y, left:right] += 1
    return pixels


def visible(triangles, width=WIDTH, height=HEIGHT):
    """The visible segments of all bands, joined."""
    bands = [s for s, _ in scene_to_spans.visible(triangles, width, height)]
    fields = ("triangle", "y", "left", "right")
    return Segments(*(np.concatenate([getattr(b, f) for b in bands]) for f in fields))


def owners(segments, width=WIDTH, height=HEIGHT):
    """int [height, width]: the triangle of each pixel, -1 without."""
    picture = np.full((height, width), -1)
    for t, y, left, right in zip(
        segments.triangle, segments.y, segments.left, segments.right, strict=True
    ):
        assert (picture[y, left:right] == -1).all(), "a pixel is shaded twice"
        picture[y, left:right] = t
    return picture


def edge_function_coverage(corners, width=WIDTH, height=HEIGHT):
    """The textbook test in whole numbers, which shares nothing with `cover`: a pixel is covered if
    its centre is inside all three edges, or on an edge that is a top edge or a left edge."""
    x, y = (np.floor(np.asarray(corners, float)[:, i] * GRID + 0.5).astype(object) for i in (0, 1))
    area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    if area < 0:
        x, y = x[::-1], y[::-1]
    pixels = np.zeros((height, width), bool)
    if area == 0:
        return pixels
    for j in range(height):
        for i in range(width):
            px, py = i * GRID + GRID // 2, j * GRID + GRID // 2
            inside = True
            for a in range(3):
                b = (a + 1) % 3
                dx, dy = x[b] - x[a], y[b] - y[a]
                e = dx * (py - y[a]) - dy * (px - x[a])
                # Positive area with y down is clockwise on the screen: left edges go up, top
                # edges go right.
                inside &= e > 0 or (e == 0 and (dy < 0 or (dy == 0 and dx > 0)))
            pixels[j, i] = inside
    return pixels


def jittered_grid(seed, step, columns, rows, jitter):
    """A triangulated rectangle [0, columns step] x [0, rows step] whose inner vertices are moved
    by choices from `jitter`, diagonals at random: corners [T, 3, 2]."""
    rng = np.random.default_rng(seed)
    j, i = np.mgrid[: rows + 1, : columns + 1]
    points = np.stack([i, j], axis=-1) * float(step)
    points[1:-1, 1:-1] += rng.choice(jitter, (rows - 1, columns - 1, 2))
    triangles = []
    for r in range(rows):
        for c in range(columns):
            a, b = points[r, c], points[r, c + 1]
            d, e = points[r + 1, c], points[r + 1, c + 1]
            cut = rng.integers(2)
            triangles += [(a, d, e), (a, e, b)] if cut else [(a, d, b), (b, d, e)]
    return np.array(triangles)


def picture(meshes, camera, size=(WIDTH, HEIGHT), two_sided=False, light=(0, 0, 1), **changes):
    """A scene of meshes, one material each."""
    objects = [SceneObject(str(i), m, i) for i, m in enumerate(meshes)]
    scene = Scene(
        "test",
        *size,
        (0.0, 0.0, 0.0),
        camera,
        np.array(light, float),
        two_sided,
        "linear",
        objects,
        [Material() for _ in meshes],
    )
    for name, value in changes.items():
        setattr(scene, name, value)
    return scene


def face_on(height=2.0, projection="orthographic", distance=10.0, **kwargs):
    """A camera that looks down the z axis, y up."""
    return Camera(
        projection, np.eye(3), np.zeros(3), np.array([0, 0, distance]), height=height, **kwargs
    )


def one_triangle(corners, normals=((0, 0, 1),) * 3):
    return Mesh(np.array(corners, float), np.array([[0, 1, 2]]), np.array([normals], float))


def pixels_of(spans):
    """Row of `spans`, x, y and step number of every pixel."""
    length = spans["length"]
    row = np.repeat(np.arange(len(spans)), length)
    k = np.arange(len(row)) - np.repeat(np.cumsum(length) - length, length)
    return row, spans["x"][row] + k, spans["y"][row], k


def assert_legal(frame, config=DEFAULT):
    """Everything that the hardware expects of spans."""
    spans = frame.spans
    assert config.normal.contains(spans["start"]).all()
    assert config.normal.contains(spans["step"]).all()
    end = spans["start"] + (spans["length"][:, None] - 1) * spans["step"]
    assert config.normal.contains(end).all()
    assert (spans["length"] >= 1).all()
    assert (spans["x"] >= 0).all() and (spans["x"] + spans["length"] <= frame.width).all()
    assert (spans["y"] >= 0).all() and (spans["y"] < frame.height).all()
    assert (spans["step"][spans["length"] == 1] == 0).all()
    place = spans["y"].astype(np.int64) * frame.width + spans["x"]
    assert (np.diff(place) >= spans["length"][:-1]).all(), "out of order, or a pixel twice"
    assert not spans["last"][:-1].any() and (len(spans) == 0 or spans["last"][-1])


# -- interpolation -----------------------------------------------------------------------------


NOTES = [(9, 15), (3, 3), (17, 7)]
NORMALS = [(1, 0, 0), (np.sqrt(0.5), np.sqrt(0.5), 0), (0, 0, 1)]


def test_worked_example_of_the_notes_intensities():
    assert interpolate_at(NOTES, [[0], [24], [4]], (10, 11)) == pytest.approx(5)
    assert interpolate_at(NOTES, [[0], [24], [4]], (7, 11)) == pytest.approx(8)
    assert interpolate_at(NOTES, [[0], [24], [4]], (13, 11)) == pytest.approx(2)


def unit(*vector):
    return np.array(vector) / np.linalg.norm(vector)


@pytest.mark.parametrize(
    "normalize_edges, printed, slip, exact",
    [
        # The notes' last normalization is off in the fourth place: the mean they print,
        # (0.8373, 0.1264, 0.3536), has the length 0.9177, which gives 0.9124, 0.1377, 0.3853.
        (
            True,
            (0.9127, 0.1378, 0.3854),
            3e-4,
            unit(*(unit(2 + np.sqrt(0.5), np.sqrt(0.5), 0) + unit(1, 0, 1))),
        ),
        # The point is 7/12 of the first vertex, 2/12 of the second and 3/12 of the third.
        (
            False,
            (0.9303, 0.1564, 0.3317),
            5e-5,
            unit(7 + 2 * np.sqrt(0.5), 2 * np.sqrt(0.5), 3),
        ),
    ],
    ids=["normalized_edges", "linear"],
)
def test_worked_example_of_the_notes_normals(normalize_edges, printed, slip, exact):
    normal = unit(*interpolate_at(NOTES, NORMALS, (10, 11), normalize_edges))
    assert normal == pytest.approx(printed, abs=slip)
    assert normal == pytest.approx(exact, abs=1e-14)


@settings(max_examples=200, deadline=None)
@given(seeds, st.sampled_from([1, 5, 2000, 400_000]))
def test_weights_are_those_of_the_plane_also_in_slivers(seed, breadth):
    """Against exact fractions; `breadth` is the height of the triangle in grid units."""
    rng = np.random.default_rng(seed)
    x = rng.integers(0, 1 << 22, 3)
    y = np.sort(rng.integers(0, breadth + 1, 3)) + 12345
    if y[0] == y[2]:
        y[2] += 1
    py = int(rng.integers(y[0], y[2]))
    xs, ys = [Fraction(int(v)) for v in x], [Fraction(int(v)) for v in y]
    k = 1 if py >= y[1] else 0
    long = xs[0] + (py - ys[0]) * (xs[2] - xs[0]) / (ys[2] - ys[0])
    short = xs[k] + (py - ys[k]) * (xs[k + 1] - xs[k]) / (ys[k + 1] - ys[k])
    low, high = sorted([long, short])
    first, end = (-(-v.numerator // v.denominator) for v in (low, high))
    assume(first < end)
    px = int(rng.integers(first, end))
    values = rng.uniform(-1, 1, 3)
    got = interpolate(
        values[None, :, None],
        scan_line_weights(x[None], y[None], np.array([px]), np.array([py])),
    )[0, 0]
    v = [Fraction(float(c)) for c in values]
    area = (xs[1] - xs[0]) * (ys[2] - ys[0]) - (xs[2] - xs[0]) * (ys[1] - ys[0])
    w1 = ((px - xs[0]) * (ys[2] - ys[0]) - (xs[2] - xs[0]) * (py - ys[0])) / area
    w2 = ((xs[1] - xs[0]) * (py - ys[0]) - (px - xs[0]) * (ys[1] - ys[0])) / area
    exact = (1 - w1 - w2) * v[0] + w1 * v[1] + w2 * v[2]
    assert abs(got - float(exact)) < 1e-14


# -- coverage ----------------------------------------------------------------------------------


@settings(max_examples=100, deadline=None)
@given(seeds, st.sampled_from([0.5, 0.25, 1 / 64, 1 / GRID]))
def test_coverage_is_the_top_left_rule(seed, snap):
    """Vertices on multiples of 1/2 pixel put many pixels exactly on edges and vertices."""
    rng = np.random.default_rng(seed)
    corners = np.floor(rng.uniform(-4, 28, (3, 2)) / snap) * snap
    got = count_pixels(cover(screen_triangles([corners])))
    assert np.array_equal(got, edge_function_coverage(corners))


@settings(max_examples=200, deadline=None)
@given(seeds, st.sampled_from([(-1.0, -0.5, 0.0, 0.5, 1.0), (-0.9, -0.123, 0.0, 0.31, 0.77)]))
def test_a_mesh_has_no_gap_and_no_dot_twice(seed, jitter):
    corners = jittered_grid(seed, 5, 4, 3, jitter)
    expected = np.zeros((HEIGHT, WIDTH), int)
    expected[:15, :20] = 1
    assert np.array_equal(count_pixels(cover(screen_triangles(corners))), expected)


@settings(max_examples=200, deadline=None)
@given(seeds, st.floats(0, 6.3), st.floats(0.2, 3.0))
def test_a_turned_mesh_covers_what_its_outline_covers(seed, angle, scale):
    corners = jittered_grid(seed, 5, 4, 3, (-1.0, 0.0, 0.4)) - (10, 7.5)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def place(p):
        return np.asarray(p, float) @ turn.T * scale + (12.3, 9.1)

    pixels = count_pixels(cover(screen_triangles(place(corners))))
    assert pixels.max() <= 1
    outline = [(-10, -7.5), (10, -7.5), (10, 7.5), (-10, 7.5)]
    # The inner points of the outline's edges are snapped on their own, so that the edges of the
    # mesh bend by a grid step: compare pixels that are clear of the outline.
    j, i = np.mgrid[:HEIGHT, :WIDTH]
    inside = np.ones((HEIGHT, WIDTH), bool)
    clear = np.ones((HEIGHT, WIDTH), bool)
    for a, b in zip(place(outline), place(np.roll(outline, -1, axis=0)), strict=True):
        edge = (b - a) / np.linalg.norm(b - a)
        side = edge[0] * (j + 0.5 - a[1]) - edge[1] * (i + 0.5 - a[0])
        inside &= side > 0
        clear &= np.abs(side) > 3 / GRID
    assert np.array_equal(pixels[clear], inside[clear].astype(int))


@settings(max_examples=100, deadline=None)
@given(seeds)
def test_a_fan_round_a_pixel_centre_covers_it_once(seed):
    rng = np.random.default_rng(seed)
    centre = np.array([8.5, 7.5])
    angles = np.sort(rng.uniform(0, 2 * np.pi, rng.integers(3, 12)))
    angles = np.unique(np.append(angles, [0.0, np.pi / 2, np.pi, 3 * np.pi / 2]))
    rim = centre + 6 * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    corners = [(centre, a, b) for a, b in zip(rim, np.roll(rim, -1, axis=0), strict=True)]
    pixels = count_pixels(cover(screen_triangles(corners)))
    assert pixels.max() == 1 and pixels[7, 8] == 1


def test_parts_off_the_screen_are_cut():
    pixels = count_pixels(cover(screen_triangles([[(-900, -900), (5000, -10), (-10, 5000)]])))
    assert (pixels == 1).all()
    assert len(cover(screen_triangles([[(30, 1), (40, 1), (35, 9)]]))) == 0
    assert len(cover(screen_triangles([[(1, -30), (9, -30), (5, -20)]]))) == 0


def test_back_faces_are_culled_unless_two_sided():
    corners = [(2, 2), (2, 12), (12, 2)]  # counter-clockwise on the screen
    for two_sided, turned, drawn in [(0, 0, 1), (0, 1, 0), (1, 0, 1), (1, 1, 1)]:
        order = corners[::-1] if turned else corners
        assert len(screen_triangles([order], two_sided=bool(two_sided))) == drawn


# -- visibility --------------------------------------------------------------------------------


@settings(max_examples=100, deadline=None)
@given(seeds, st.integers(1, 12))
def test_the_nearest_triangle_owns_each_dot_also_where_they_penetrate(seed, count):
    rng = np.random.default_rng(seed)
    corners = rng.uniform(-3, 27, (count, 3, 2))
    depth = rng.uniform(0, 1, (count, 3))
    triangles = screen_triangles(corners, depth)
    got = owners(visible(triangles))

    best = np.full((HEIGHT, WIDTH, count), np.inf)
    for t in range(count):
        pixels = edge_function_coverage(corners[t])
        j, i = np.nonzero(pixels)
        a = np.c_[np.floor(corners[t] * GRID + 0.5) / GRID, np.ones(3)]
        if pixels.any():
            best[j, i, t] = np.c_[i + 0.5, j + 0.5, np.ones(len(i))] @ np.linalg.solve(a, depth[t])
    # The first triangle that may be as near as the nearest one owns a dot.
    tolerance = np.zeros(count)
    tolerance[triangles.material] = triangles.tolerance
    limit = (best + tolerance).min(axis=2, keepdims=True)
    nearest = np.where(np.isfinite(limit[..., 0]), np.argmax(best - tolerance <= limit, axis=2), -1)
    with np.errstate(invalid="ignore"):
        clear = ~(np.abs(best - tolerance - limit) < 1e-9).any(axis=2)
    assert clear.mean() > 0.5
    assert np.array_equal(got[clear], nearest[clear])
    assert np.array_equal(got >= 0, np.isfinite(best.min(axis=2)))


def test_the_first_of_equals_is_visible():
    corners = [(2, 2), (2, 12), (12, 2)]
    triangles = screen_triangles([corners, corners, corners])
    assert set(np.unique(owners(visible(triangles)))) == {-1, 0}


def test_penetrating_triangles_meet_where_their_planes_do():
    corners = [[(0, 0), (0, 40), (40, 0)], [(0, 0), (0, 40), (40, 0)]]
    # Depth x/40 of the first against 1/4 + x/80 of the second: equal at x = 20.
    picture_ = owners(visible(screen_triangles(corners, [[0, 0, 1], [0.25, 0.25, 0.75]])))
    assert (picture_[:10, :20] == 0).all() and (picture_[:10, 20:] == 1).all()


def test_segments_that_meet_nobody_need_no_depth(monkeypatch):
    """The front of a convex body is resolved by whole segments: they touch, but do not overlap."""

    def per_dot(*_):
        raise AssertionError("pixels were compared")

    monkeypatch.setattr(visibility, "_nearest_runs", per_dot)
    assert len(front_end(load_scene("sphere", SMALL)).frame.spans) > 1000


@pytest.mark.parametrize("strips, pixels", [(1, 1), (40, 300), (10_000, 500)])
def test_blocks_do_not_show(monkeypatch, strips, pixels):
    scene = load_scene("still_life", SMALL)
    whole = front_end(scene)
    monkeypatch.setattr(visibility, "BLOCK_STRIPS", strips)
    monkeypatch.setattr(visibility, "BLOCK_PIXELS", pixels)
    assert np.array_equal(front_end(scene).frame.spans, whole.frame.spans)


# -- camera ------------------------------------------------------------------------------------


def test_orthographic_projection_to_pixels():
    camera = face_on(height=2.0)
    points = np.array([(0, 0, 0), (1, 0, 3), (0, 1, -2), (-1.5, -1, 0)], float)
    x, y, w, z = np.moveaxis(camera.project(points, 300, 200), -1, 0)
    assert x == pytest.approx([150, 250, 150, 0])
    assert y == pytest.approx([100, 100, 0, 200])
    assert (w == 1).all() and z == pytest.approx([0, 3, -2, 0])


def test_perspective_projection_to_pixels():
    camera = face_on(projection="perspective", fov=90.0, near=0.01)
    points = np.array([(0, 0, 0), (10, 0, 0), (0, 10, 0), (4, 0, 6)], float)
    x, y, w, _ = np.moveaxis(camera.project(points, 300, 200), -1, 0)
    assert x / w == pytest.approx([150, 250, 150, 250])
    assert y / w == pytest.approx([100, 100, 0, 100])
    assert w == pytest.approx([10, 10, 10, 4])


def test_perspective_depth_is_linear_on_the_screen():
    camera = face_on(projection="perspective", fov=60.0)
    ends = np.array([(-3, 1, -20), (2, -1, 8)], float)
    inner = ends[0] + np.array([0.1, 0.5, 0.9])[:, None] * (ends[1] - ends[0])
    x, _, w, z = np.moveaxis(camera.project(np.r_[ends, inner], 300, 200), -1, 0)
    screen, depth = x / w, camera.depth(w, z)
    along = (screen[2:] - screen[0]) / (screen[1] - screen[0])
    assert depth[2:] == pytest.approx(depth[0] + along * (depth[1] - depth[0]))
    assert depth[1] < depth[0], "depth grows away from the eye"


@settings(max_examples=100, deadline=None)
@given(seeds)
def test_light_frame(seed):
    rng = np.random.default_rng(seed)
    light, eye = rng.normal(size=(2, 3)) * 10.0 ** rng.uniform(-6, 6, (2, 1))
    axes, u = light_frame(light, eye)
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(axes) == pytest.approx(1)
    assert axes @ (light / np.linalg.norm(light)) == pytest.approx([0, 0, 1], abs=1e-14)
    assert axes @ (eye / np.linalg.norm(eye)) == pytest.approx(u, abs=1e-14)
    assert u[1] == 0 and u[0] >= 0 and np.linalg.norm(u) == pytest.approx(1, abs=1e-15)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    "light", [(0, 0, 1), (1, 0, 0), (1, 2, -3), (0, -2, 0), (0.3, 0.7, 0.9), (-0.11, 0.013, 0.77)]
)
def test_light_frame_with_the_eye_on_the_light(light, sign):
    axes, u = light_frame(light, sign * 3.0 * np.array(light))
    assert u.tolist() == [0, 0, sign]
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=1e-14)


def test_view_axes_of_parallel_vectors():
    assert view_axes((0, 0, 2), (0, 0, -1)) is None
    assert view_axes((0, -1, 0), (0, 0, 1)) == pytest.approx(
        np.array([(1, 0, 0), (0, 0, 1), (0, -1, 0)])
    )


# -- whole front end ---------------------------------------------------------------------------


def true_normals(scene, x, y):
    """Normals, in the light frame, of a unit sphere at the origin at pixels of an orthographic
    picture; NaN beside it."""
    scale = scene.camera.height / scene.height
    px = (x + 0.5 - scene.width / 2) * scale
    py = (scene.height / 2 - y - 0.5) * scale
    with np.errstate(invalid="ignore"):
        pz = np.sqrt(1 - px**2 - py**2)
    world = np.stack([px, py, pz], axis=-1) @ scene.camera.axes
    axes, _ = light_frame(scene.light, scene.camera.axes[2])
    return world @ axes.T


@pytest.mark.parametrize("interpolation", ["linear", "normalized_edges"])
def test_normals_of_a_sphere_from_scene_to_span(interpolation):
    back = (0.3, -0.8, 0.5)
    camera = Camera("orthographic", view_axes(back, (0, 0, 1)), np.zeros(3), np.zeros(3), 2.4)
    scene = picture(
        [sphere(1.0, 256, 128)],
        camera,
        (120, 90),
        light=(-0.2, -0.3, 1.0),
        interpolation=interpolation,
    )
    made = front_end(scene)
    row, x, y, k = pixels_of(made.frame.spans)
    normal = made.exact.start[row] + k[:, None] * made.exact.step[row]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    true = true_normals(scene, x, y)
    inner = true @ made.exact.eye > 0.2
    assert np.count_nonzero(inner) > 3900
    assert np.linalg.norm(normal - true, axis=1)[inner].max() < 2e-3
    j, i = np.mgrid[:90, :120]
    inside = np.count_nonzero(np.isfinite(true_normals(scene, i, j)[..., 0]))
    assert abs(len(x) - inside) < 30


@pytest.mark.parametrize("name", bundled_scenes())
def test_bundled_scenes_become_legal_spans(name):
    made = front_end(load_scene(name, SMALL))
    assert_legal(made.frame)
    assert len(made.frame.spans) > 50 and made.degenerate_triangles == 0
    assert made.exact.start.shape == made.exact.step.shape == (len(made.frame.spans), 3)
    assert np.linalg.norm(made.exact.start, axis=1).max() <= 1 + 1e-12
    codes = DEFAULT.normal.real(made.frame.spans["start"])
    assert np.abs(codes - made.exact.start).max() <= DEFAULT.normal.lsb / 2
    length = made.frame.spans["length"]
    drift = np.abs(DEFAULT.normal.real(made.frame.spans["step"]) - made.exact.step)
    assert (drift <= DEFAULT.normal.lsb / 2).all(), length[drift.max(axis=1).argmax()]
    again = front_end(load_scene(name, SMALL))
    assert np.array_equal(made.frame.spans, again.frame.spans)


@pytest.mark.parametrize("normal", [Format(True, 1, 30), Format(True, 0, 17), Format(True, 1, 12)])
@settings(max_examples=30, deadline=None)
@given(seed=seeds)
def test_encoded_spans_stay_inside_the_format(normal, seed):
    config = Config(normal=normal)
    rng = np.random.default_rng(seed)
    ends = rng.choice([-1.0, -0.999999, 0.0, 0.3333, 0.999999, 1.0], (2, 50, 3))
    length = rng.integers(3, 4096, 50)
    real = (ends[1] - ends[0]) / (length - 1)[:, None]
    start, step = encode(ends[0], real, length, config)
    end = start + (length[:, None] - 1) * step
    assert normal.contains(start).all() and normal.contains(end).all()
    assert np.abs(normal.real(step) - real).max() <= 1.5 * normal.lsb


def test_a_step_of_two_becomes_single_pixels():
    triangles = Triangles(
        np.array([[0, 0, 2]]) * GRID + GRID // 2,
        np.array([[0, 2, 2]]) * GRID + GRID // 2,
        np.zeros((1, 3)),
        np.array([[(0.0, -1.0, 0.6), (0.0, -1.0, 0.6), (0.0, 1.0, 0.8)]]),
        np.array([3]),
        np.zeros(1),
    )
    segment = Segments(*(np.array([v]) for v in (0, 1, 0, 2)))
    normals = np.array([[(0, 0, 1.0), (1.0, 0, 0), (-1.0, 0, 0)]])
    triangles.value = normals  # at line 1: half down both edges
    exact = ExactFrame(*[np.zeros((0, 3))] * 7, [], [])  # without a light at a place
    spans, start, step, bend = scene_to_spans._spans(triangles, segment, DEFAULT, "linear", exact)
    assert len(spans) == 1
    triangles.value = np.array([[(0, -1.0, 0), (0, -1.0, 0), (0, 3.0, 0)]])  # step exactly 2
    spans, start, step, bend = scene_to_spans._spans(triangles, segment, DEFAULT, "linear", exact)
    assert spans["x"].tolist() == [0, 1] and spans["length"].tolist() == [1, 1]
    assert spans["material"].tolist() == [3, 3]
    assert (step == 0).all() and (spans["step"] == 0).all() and not bend.any()
    assert start[:, 1] == pytest.approx([-1, 1])


def test_a_scene_outside_the_view_is_an_empty_frame():
    scene = picture([sphere()], face_on())
    scene.camera = Camera("orthographic", np.eye(3), np.array([9.0, 0, 0]), np.zeros(3), 2.0)
    made = front_end(scene)
    assert len(made.frame.spans) == 0 and made.exact.start.shape == (0, 3)
    assert made.triangles == len(sphere().faces)
    behind = face_on(projection="perspective", distance=-10.0, fov=40.0, near=0.01)
    assert len(front_end(picture([sphere()], behind)).frame.spans) == 0


def test_triangles_through_the_eye_plane_are_cut_at_it():
    """A floor under the eye reaches from behind it to the horizon: it fills the lower half."""
    floor = Mesh(
        np.array([(-1e5, -1, 1e5), (1e5, -1, 1e5), (1e5, -1, -1e5), (-1e5, -1, -1e5)], float),
        np.array([(0, 1, 2), (0, 2, 3)]),
        np.broadcast_to([0.0, 1.0, 0.0], (2, 3, 3)),
    )
    camera = face_on(projection="perspective", distance=0.0, fov=60.0, near=1e-3)
    made = front_end(picture([floor], camera))
    assert_legal(made.frame)
    _, x, y, _ = pixels_of(made.frame.spans)
    pixels = np.zeros((HEIGHT, WIDTH), int)
    np.add.at(pixels, (y, x), 1)
    assert (pixels[: HEIGHT // 2] == 0).all() and (pixels[HEIGHT // 2 :] == 1).all()


def test_what_is_nearer_than_the_near_plane_is_cut_off():
    square = [(-9, -9, 0), (9, -9, 0), (-9, 9, 0)]
    for near, drawn in [(9.9, True), (10.1, False)]:
        camera = face_on(projection="perspective", fov=60.0, near=near)
        made = front_end(picture([one_triangle(square)], camera))
        assert bool(len(made.frame.spans)) is drawn
    steep = one_triangle([(-9, -9, 8), (9, -9, 8), (-9, 9, -8)])
    counts = []
    for near in (1.0, 6.0, 10.0, 14.0, 19.0):
        camera = face_on(projection="perspective", fov=60.0, near=near)
        counts.append(front_end(picture([steep], camera)).frame.spans["length"].sum())
    assert counts == sorted(counts, reverse=True) and counts[0] > counts[2] > counts[3] > 0
    assert counts[-1] == 0


@pytest.mark.parametrize("size", [1e2, 1e6, 1e12, 1e30])
def test_a_square_far_beyond_the_screen_fills_it_once(size):
    square = Mesh(
        np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]) * size,
        np.array([(0, 1, 2), (0, 2, 3)]),
        np.broadcast_to([0.0, 0.0, 1.0], (2, 3, 3)),
    )
    made = front_end(picture([square], face_on()))
    assert made.frame.spans["length"].sum() == WIDTH * HEIGHT
    assert_legal(made.frame)


def test_nearer_objects_hide_farther_ones_in_both_projections():
    near, far = sphere(0.5), sphere(0.8)
    near = near.transformed(translate=(0, 0, 2))
    for camera in (face_on(), face_on(projection="perspective", fov=15.0, near=0.01)):
        spans = front_end(picture([far, near], camera)).frame.spans
        middle = spans[(spans["y"] == HEIGHT // 2) & (spans["x"] <= WIDTH // 2)][-1]
        assert middle["material"] == 1
        assert set(spans["material"]) == {0, 1}


def test_two_sided_shows_the_inside():
    cup = one_triangle([(-1, -1, 0), (-1, 1, 0), (1, -1, 0)])  # clockwise: seen from behind
    assert len(front_end(picture([cup], face_on())).frame.spans) == 0
    made = front_end(picture([cup], face_on(), two_sided=True))
    assert len(made.frame.spans) > 0 and not made.frame.two_sided
    assert (made.frame.spans["start"][:, 2] > 0).all()  # turned to the eye
    towards = front_end(picture([cup], face_on(), toward_light=True))
    assert towards.frame.two_sided and len(towards.frame.spans) == len(made.frame.spans)


def test_interpolation_modes_differ_and_agree_at_vertices():
    bent = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]
    mesh = one_triangle([(-1, -1, 0), (1, -1, 0), (-1, 1, 0)], bent)
    linear = front_end(picture([mesh], face_on(), interpolation="linear"))
    edges = front_end(picture([mesh], face_on(), interpolation="normalized_edges"))
    assert np.array_equal(linear.frame.spans["x"], edges.frame.spans["x"])
    longer = np.linalg.norm(edges.exact.start, axis=1) - np.linalg.norm(linear.exact.start, axis=1)
    assert longer.max() > 0.1 and longer.min() > -1e-12


def test_registers_and_material_table():
    camera = face_on()
    scene = picture([sphere(), sphere(0.5)], camera, light=(1, 0, 1), background=(0, 0.5, 1))
    scene.materials = [
        Material((0.5, 0.25, 1.0), 0.5, 2.5, (0.0, 1.0), (0.0, 1.0)),
        Material(n=128.0),
    ]
    made = front_end(scene)
    one = DEFAULT.coefficient.one
    assert made.frame.background == (0, 128, 255)
    assert made.exact.eye == pytest.approx([np.sqrt(0.5), 0, np.sqrt(0.5)])
    assert made.frame.materials.ambient[0].tolist() == [one // 4, one // 8, one // 2]
    assert made.frame.materials.exponent[:2].tolist() == [
        5 * DEFAULT.exponent.one // 2,
        128 * DEFAULT.exponent.one,
    ]
    assert made.exact.weight[0].at([0, 0.3, 1]) == pytest.approx([0, 0.3, 1])
    assert made.exact.ambient.shape == (DEFAULT.materials, 3)


def test_seventy_thousand_triangles_at_full_hd():
    mesh = sphere(1.0, 264, 134)
    assert len(mesh.faces) > 70_000
    made = front_end(picture([mesh], face_on(height=2.2), (1920, 1080)))
    # Half of the faces look to the eye and cover a disc.
    disc = np.pi * (1080 / 2.2) ** 2
    assert made.frame.spans["length"].sum() == pytest.approx(disc, rel=1e-3)


def test_progress_rises_to_one():
    seen = []
    front_end(load_scene("sphere", SMALL), progress=seen.append)
    assert seen == sorted(seen) and seen[-1] == 1.0


def test_a_scene_too_large_for_the_configuration_is_refused():
    scene = load_scene("sphere", (600, 400))
    with pytest.raises(InputError, match=r"^sphere: size 600x400 is outside 1 to 512$"):
        front_end(scene, Config(coordinate_bits=9))
    scene.materials = [Material()] * 3
    with pytest.raises(InputError, match=r"^sphere: 3 materials, but the table has 2$"):
        front_end(scene, Config(material_bits=1))
