# SPDX-License-Identifier: MIT
"""Pictures of meshes: which side is seen and lit, which of equal depths wins, which colour."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from phong75.model import twin
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import InputError
from phong75.model.front.mesh import make_mesh, rotation_matrix
from phong75.model.front.mesh_files.materials import Materials, reduce_materials
from phong75.model.front.scene import Material, load_scene
from phong75.model.scene_to_frame import front_end
from phong75.model.twin.core.phong_unit import interpolate
from phong75.model.twin.core.span_walker import span_walker
from tests.mesh_writers import CUBE, SQUARES, Gltf, cube_glb, obj, ply, triangles

QUICK = settings(
    max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
seeds = st.integers(0, 2**32 - 1)
SIZE = (64, 48)
SQUARE = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]


def scene(folder, text, size=SIZE, config=DEFAULT, **files):
    """The scene of a TOML text, with files beside it."""
    for name, content in files.items():
        data = content if isinstance(content, bytes) else content.encode()
        (folder / name.replace("_", ".")).write_bytes(data)
    (folder / "scene.toml").write_text(text)
    return load_scene(folder / "scene.toml", size, config)


def mesh_scene(folder, name, content, config=DEFAULT):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return load_scene(path, SIZE, config)


def picture(loaded, config=DEFAULT):
    """int64[height, width, 3]: the pixels of the model, -1 where there is none."""
    frame = front_end(loaded, config).frame
    pixels = twin.render(frame, config)
    result = np.full((loaded.height, loaded.width, 3), -1)
    result[pixels.y, pixels.x] = pixels.rgb
    return result


# -- which side is seen ----------------------------------------------------------------------------


@QUICK
@given(seeds)
def test_two_sided_changes_nothing_on_a_closed_body(tmp_path, seed):
    """Normals turn to the eye, not to the light: the far side of a ball stays dark."""
    light = np.random.default_rng(seed).normal(size=3).tolist()
    text = f"""[light]\ndirection = {light}
[[objects]]\nshape = "sphere"\nsegments = 16\nrings = 8\n"""
    one, two = (picture(scene(tmp_path, head + text)) for head in ("", "two_sided = true\n"))
    assert (one == two).all() and (one >= 0).any()


def test_a_face_from_behind_is_lit_where_the_eye_sees_it(tmp_path):
    front = picture(mesh_scene(tmp_path, "a.obj", obj(SQUARE, [(0, 1, 2, 3)])))
    behind = obj(SQUARE, [(3, 2, 1, 0)])
    assert (picture(mesh_scene(tmp_path, "b.obj", behind)) == -1).all()
    camera = "[camera]\nup = [0, 1, 0]\ndirection = [0.35, 0.35, 1]\n"
    item = '[[objects]]\nmesh = "b.obj"\n'
    shown = {
        "scene": f"two_sided = true\n{camera}{item}",
        "object": f"{camera}{item}two_sided = true\n",
        "material": f'{camera}[materials.m]\ntwo_sided = true\n{item}material = "m"\n',
    }
    for text in shown.values():
        assert (picture(scene(tmp_path, text)) == front).all()
    file = Gltf()
    material = file.material(doubleSided=True, pbrMetallicRoughness={"roughnessFactor": 1})
    file.node(file.mesh(SQUARE, triangles([(3, 2, 1, 0)]), material=material))
    glb = picture(mesh_scene(tmp_path, "a.glb", file.glb()))
    assert ((glb >= 0) == (front >= 0)).all()


@pytest.mark.parametrize("technique", ["gouraud", "flat"])
def test_two_sided_faces_in_other_techniques(tmp_path, technique):
    from phong75.model.config import TECHNIQUES

    config = TECHNIQUES[technique]
    camera = "two_sided = true\n[camera]\nup = [0, 1, 0]\ndirection = [0.35, 0.35, 1]\n"
    item = '[[objects]]\nmesh = "a.obj"\n'
    pictures = [
        picture(scene(tmp_path, camera + item, a_obj=obj(SQUARE, [square])), config)
        for square in ((0, 1, 2, 3), (3, 2, 1, 0))
    ]
    assert (pictures[0] == pictures[1]).all()
    assert pictures[0].max() > np.ceil(255 * Material().ka.max())  # more than ambient light


def test_toward_light_is_the_papers_option(tmp_path):
    """The hardware takes |Zn|: "the normal will always point toward the light source". In the
    middle of the ball |Zn| = 1 and cos(s) = 0, so that eq. (3) gives Cp; without it, Cp d."""
    text = RIM.format(light=[0, 0, -1])
    for head, middle in (("toward_light = true\n", (204, 102, 51)), ("", (51, 26, 13))):
        loaded = scene(tmp_path, head + text)
        assert front_end(loaded).frame.two_sided == bool(head)
        assert tuple(picture(loaded)[SIZE[1] // 2, SIZE[0] // 2]) == middle


@pytest.mark.parametrize("text, why", [
    ("", "no pixel: of 2 triangles all turn away from the eye (try two_sided = true"),
    ("[camera]\nprojection = 'perspective'\neye = [0, 0, -5]\ntarget = [0, 0, -9]\n",
     "no pixel: of 2 triangles all are behind the eye (try another [camera] eye"),
    ("[camera]\ndirection = [0, 0, -1]\ntarget = [50, 0, 0]\nup = [0, 1, 0]\nheight = 2\n",
     "no pixel: of 2 triangles all are outside the view or between pixels"),
])  # fmt: skip
def test_a_picture_without_pixels_says_why(tmp_path, text, why):
    behind = obj(SQUARE, [(3, 2, 1, 0)])
    camera = text or "[camera]\ndirection = [0, 0, 1]\nup = [0, 1, 0]\n"
    made = front_end(scene(tmp_path, camera + '[[objects]]\nmesh = "a.obj"\n', a_obj=behind))
    assert made.empty and made.empty.startswith(why)
    assert front_end(scene(tmp_path, '[[objects]]\nshape = "cone"\n')).empty is None


# -- which side is lit -----------------------------------------------------------------------------

RIM = """[light]
direction = {light}
relative_to = "camera"
[[objects]]
shape = "sphere"
segments = 24
rings = 12
material = {{ color = [0.8, 0.4, 0.2], d = 0.25, n = 10, W = 0.4 }}
"""


def test_faces_lit_only_by_interpolated_normals_are_counted_and_can_be_left_dark(tmp_path):
    text = RIM.format(light=[0, 0, -1])
    made = front_end(scene(tmp_path, text, (160, 120)))
    rgb = twin.render(made.frame).rgb
    assert made.lit_facing_away == np.any(rgb != (51, 26, 13), axis=1).sum() > 0
    dark = front_end(scene(tmp_path, "lit_faces_only = true\n" + text, (160, 120)))
    assert (twin.render(dark.frame).rgb == (51, 26, 13)).all() and dark.lit_facing_away == 0


@QUICK
@given(seeds)
def test_the_count_is_that_of_the_pixels_that_lit_faces_only_makes_dark(tmp_path, seed):
    """A pixel is lit if the code of its Zn is greater than 0."""
    rng = np.random.default_rng(seed)
    text = RIM.format(light=rng.normal(size=3).tolist())
    lit = []
    for head in ("", "lit_faces_only = true\n"):
        made = front_end(scene(tmp_path, head + text))
        spans = made.frame.spans
        span, k, *_ = span_walker(spans, 0, int(spans["length"].sum()), DEFAULT)
        normal, _ = interpolate(spans, span, k, DEFAULT)
        lit.append((int(np.count_nonzero(normal[2] > 0)), made.lit_facing_away))
    assert lit[0][1] == lit[0][0] - lit[1][0] and lit[1][1] == 0


# -- which of equal depths wins --------------------------------------------------------------------


@settings(QUICK, max_examples=25)
@given(seeds, st.booleans())
def test_of_coplanar_faces_the_first_object_wins_everywhere(tmp_path, seed, perspective):
    rng = np.random.default_rng(seed)
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    basis *= np.sign(basis[2, 2])
    flat = np.array(SQUARE, float)
    small = 0.8 * flat @ rotation_matrix((0, 0, rng.uniform(0, 360)))
    squares = [make_mesh("a", p @ basis.T, triangles([(0, 1, 2, 3)])) for p in (2 * flat, small)]
    direction = (basis[:, 2] + rng.normal(size=3) * 0.3) * 6
    text = f"""two_sided = true
[camera]\nprojection = "{"perspective" if perspective else "orthographic"}"
target = [0, 0, 0]\neye = {direction.tolist()}
[materials.first]\n[materials.second]
[[objects]]\nshape = "pyramid"\nmaterial = "first"
[[objects]]\nshape = "pyramid"\nmaterial = "second"\n"""
    loaded = scene(tmp_path, text)
    if not perspective:
        loaded.camera = replace(loaded.camera, height=6.0)
    if rng.random() < 0.5:
        squares.reverse()
    for item, square in zip(loaded.objects, squares, strict=True):
        item.mesh = square
    both = front_end(loaded).frame.spans
    loaded.objects = loaded.objects[:1]
    alone = front_end(loaded).frame.spans
    assert both[both["material"] == 0]["length"].sum() == alone["length"].sum() > 0


# -- the order of faces ----------------------------------------------------------------------------


@settings(QUICK, max_examples=30)
@given(seeds, st.integers(6, 24))
def test_the_order_of_faces_changes_no_normal(seed, sides):
    """A tube with fins: edges of three and four faces, some of them creases."""
    rng = np.random.default_rng(seed)
    turn = np.arange(sides) * 2 * np.pi / sides
    ring = np.c_[np.cos(turn), np.sin(turn)]
    vertices = [np.c_[ring, np.full(sides, z)] for z in (0.0, 1.0)]
    vertices += [np.c_[1.3 * ring, np.full(sides, z)] for z in (0.0, 1.0)]
    quads = [(i, (i + 1) % sides, sides + (i + 1) % sides, sides + i) for i in range(sides)]
    fins = [(i, 2 * sides + i, 3 * sides + i, sides + i) for i in range(0, sides, 2)]
    fins += [f[::-1] for f in fins if rng.random() < 0.5]
    faces = np.array(triangles(quads + fins))
    points = np.concatenate(vertices)
    one = make_mesh("tube", points, faces, crease=56.0).normals
    order = rng.permutation(len(faces))
    other = make_mesh("tube", points, faces[order], crease=56.0).normals
    assert np.array_equal(one[order], other)
    if 360 / sides < 56:  # the tube stays smooth beside its fins
        tube = points[faces[: 2 * sides]] * (1, 1, 0)
        assert one[: 2 * sides] == pytest.approx(tube, abs=1e-9)


def test_a_chamfered_box_keeps_its_faces_flat():
    """The sides keep their own normal, the narrow chamfers are round between them."""
    corner = 1 - 0.05
    points, faces = [], []
    signs = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    index = {}
    for s in signs:
        for axis in range(3):
            p = [corner * c for c in s]
            p[axis] = float(s[axis])
            index[s, axis] = len(points)
            points.append(p)
    points = np.array(points)

    def polygon(indices):
        centre = points[indices].mean(axis=0)
        normal = np.cross(
            points[indices[1]] - points[indices[0]], points[indices[2]] - points[indices[0]]
        )
        ordered = indices if normal @ centre > 0 else indices[::-1]
        faces.extend(triangles([ordered]))

    for axis in range(3):
        a, b = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1, 1):
            ring = []
            for sa, sb in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                s = [0, 0, 0]
                s[axis], s[a], s[b] = side, sa, sb
                ring.append(index[tuple(s), axis])
            polygon(ring)
        for sa in (-1, 1):
            for sb in (-1, 1):
                s, t = [0, 0, 0], [0, 0, 0]
                s[axis], s[a], s[b], t[axis], t[a], t[b] = -1, sa, sb, 1, sa, sb
                s, t = tuple(s), tuple(t)
                polygon([index[s, a], index[t, a], index[t, b], index[s, b]])
    for s in signs:
        polygon([index[s, 0], index[s, 1], index[s, 2]])
    mesh = make_mesh("box", points, faces)
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    on_side = np.abs(middle).max(axis=1) > 0.999
    assert on_side.sum() == 12
    sides = np.where(np.abs(middle) > 0.999, np.sign(middle), 0)[on_side]
    assert mesh.normals[on_side] == pytest.approx(np.repeat(sides[:, None], 3, 1), abs=1e-12)


# -- colours ---------------------------------------------------------------------------------------


def test_few_colours_are_exact(tmp_path):
    file = Gltf()
    colours = [(1, 0, 0), (0, 0, 1), (0.2, 0.6, 0.4)]
    for k, colour in enumerate(colours):
        material = file.material(pbrMetallicRoughness={"baseColorFactor": [*colour, 1]})
        file.node(file.mesh(CUBE, triangles(SQUARES), material=material), translation=[3 * k, 0, 0])
    loaded = mesh_scene(tmp_path, "a.glb", file.glb())
    found = np.array(sorted(m.color for m in loaded.materials))
    assert found == pytest.approx(np.array(sorted(colours)), abs=1e-6)
    assert loaded.objects[0].report.reduction is None
    front_end(loaded)


def test_many_colours_are_reduced_and_counted(tmp_path):
    rng = np.random.default_rng(75)
    centres = rng.uniform(20, 230, (4, 3))
    colours = np.repeat(centres[rng.integers(0, 4, 200)] + rng.normal(0, 3, (200, 3)), 3, axis=0)
    points = rng.normal(size=(600, 3))
    content = ply(points, np.arange(600).reshape(-1, 3), colours=colours.clip(0, 255))
    text = """[materials.own]\ncolor = [1, 1, 1]
[[objects]]\nshape = "cone"\nmaterial = "own"\n[[objects]]\nmesh = "a.ply"\n"""
    loaded = scene(tmp_path, text, a_ply=content)
    assert len(loaded.materials) == 16 and loaded.materials[0].color == (1, 1, 1)
    reduction = loaded.objects[1].report.reduction
    in_file = colours[::3].clip(0, 255).astype(int)
    assert reduction["before"] == len(np.unique(in_file, axis=0)) and reduction["after"] == 15
    index = loaded.objects[1].material
    kept = np.array([m.color for m in loaded.materials])[index] * 255
    assert index.min() >= 1
    assert reduction["largest_change"] == pytest.approx(np.abs(kept - in_file).max())
    assert len(front_end(loaded).frame.spans)
    lines = loaded.objects[1].report.lines()
    assert any(line.startswith(f"materials: {reduction['before']} reduced to 15") for line in lines)


@QUICK
@given(seeds, st.integers(1, 40), st.integers(1, 16))
def test_a_reduction_states_its_largest_change(seed, count, room):
    rng = np.random.default_rng(seed)
    colour = rng.choice([0.0, 0.25, 1.0, rng.random()], (count, 3))
    given_ = Materials.of(
        colour, np.full(count, 0.15), rng.uniform(1, 128, count), rng.random(count)
    )
    table, index, reduction = reduce_materials(given_, rng.random(count), room)
    assert len(table) <= room and index.max() < len(table) == reduction.after
    assert reduction.before == len(np.unique(given_.table(), axis=0))
    change = 255 * np.abs(table.colour[index] - colour).max()
    assert change == pytest.approx(reduction.largest, abs=1e-9)
    if reduction.before <= room:
        assert (table.table()[index] == given_.table()).all()


def test_materials_of_the_scene_replace_those_of_the_file(tmp_path):
    text = """[[objects]]\nmesh = "a.glb"\nmaterial = { color = [0, 1, 0] }\n"""
    glb = cube_glb(pbrMetallicRoughness={"baseColorFactor": [1, 0, 0, 1]}).glb()
    loaded = scene(tmp_path, text, a_glb=glb)
    assert [m.color for m in loaded.materials] == [(0, 1, 0)] and loaded.objects[0].material == 0


def test_a_full_table_has_no_room_for_the_materials_of_a_file(tmp_path):
    names = "".join(f"[materials.m{k}]\ncolor = [0, 0, 0]\n" for k in range(16))
    glb = cube_glb(pbrMetallicRoughness={"baseColorFactor": [1, 0, 0, 1]}).glb()
    with pytest.raises(InputError, match="16 materials leave no room for those of a mesh file"):
        scene(tmp_path, names + '[[objects]]\nmesh = "a.glb"\n', a_glb=glb)


def test_colours_of_a_file_become_grey_in_a_grey_build(tmp_path):
    glb = cube_glb(pbrMetallicRoughness={"baseColorFactor": [1, 0, 0, 1]}).glb()
    config = Config(name="grey", channels=1)
    loaded = mesh_scene(tmp_path, "a.glb", glb, config)
    assert loaded.materials[0].color == pytest.approx((0.2126,) * 3)
    assert len(front_end(loaded, config).frame.spans)
