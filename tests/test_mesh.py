# SPDX-License-Identifier: MIT
"""Mesh files and normals: what is kept, what is made, and what is refused, in one line."""

import re

import numpy as np
import pytest
import trimesh

from phong75.model.frame import InputError
from phong75.model.front import mesh_topology
from phong75.model.front.mesh import (
    Mesh,
    corner_normals,
    face_normals,
    is_closed,
    is_consistent,
    make_mesh,
    normalize,
    rotation_matrix,
)
from phong75.model.front.mesh_files.load import load_mesh

TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def box():
    """Vertices and faces of a cube around the origin with edges of 2."""
    cube = trimesh.creation.box((2, 2, 2))
    return np.asarray(cube.vertices), np.asarray(cube.faces)


def write(path, vertices, faces, normals=None, **kwargs):
    mesh = trimesh.Trimesh(vertices, faces, vertex_normals=normals, process=False)
    mesh.export(path, **kwargs)
    return path


# -- normals from faces ------------------------------------------------------------------------


@pytest.mark.parametrize("crease, smooth", [(0, False), (89, False), (91, True), (180, True)])
def test_cube_edges_stay_sharp_below_the_crease_angle(crease, smooth):
    vertices, faces = box()
    normals = corner_normals(vertices, faces, crease)
    flat = np.broadcast_to(face_normals(vertices, faces)[:, None], normals.shape)
    # Smooth corners point along the diagonal however the squares are cut in two.
    expected = vertices[faces] / np.sqrt(3) if smooth else flat
    assert normals == pytest.approx(expected, abs=1e-12)


def test_only_faces_that_hang_together_share_a_normal():
    """The saddle of the lecture notes, section 3: P0 goes smoothly into P2 and P4 at opposite
    sides, while P1 and P3 drop off with an abrupt edge."""
    x = np.array([-1.0, -0.5, 0.5, 1.0])
    z = np.array([-0.1, 0.0, 0.0, -0.1])  # gentle along x
    vertices = [(x[i], y, z[i]) for y in (-0.5, 0.5) for i in range(4)]
    vertices += [(x[i], y, -5.0) for y in (-0.6, 0.6) for i in (1, 2)]
    quads = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (8, 9, 2, 1), (5, 6, 11, 10)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    vertices = np.array(vertices)
    flat = face_normals(vertices, faces)
    normals = corner_normals(vertices, faces, 40)
    left, middle, right, front, back = flat[::2]
    for corner, face in ((0, 2), (1, 2)):  # vertices 1 and 2 in the first half of P0
        other = left if corner == 0 else right
        assert normals[face, corner] == pytest.approx(normalize(other + middle))
    assert normals[6:8] == pytest.approx(np.broadcast_to(front, (2, 3, 3)))
    assert normals[8:10] == pytest.approx(np.broadcast_to(back, (2, 3, 3)))


def test_faces_of_one_group_share_a_normal_at_an_edge_of_four():
    """Also if the faces between them are of another group."""
    turn = np.radians([0, 50, 100, 150])
    rim = np.stack([np.cos(turn), np.sin(turn), np.zeros(4)], axis=-1)
    vertices = np.concatenate([[[0, 0, -1.0], [0, 0, 1.0]], rim])
    faces = np.array([(0, 1, 2 + k) for k in range(4)])
    flat = face_normals(vertices, faces)
    means = normalize(flat[[0, 1, 0, 1]] + flat[[2, 3, 2, 3]])
    for order in ([0, 1, 2, 3], [1, 2, 0, 3], [3, 1, 0, 2]):
        normals = corner_normals(vertices, faces[order], 0, np.array([1, 2, 1, 2])[order])
        assert normals[:, :2] == pytest.approx(np.stack([means[order]] * 2, axis=1))


def test_round_the_end_of_a_crease_faces_hang_together():
    """One edge of six at a vertex is a crease: the faces still meet the other way round."""
    turn = np.arange(6) * np.pi / 3
    rim = np.stack([np.cos(turn), np.sin(turn), (0.0, 0.1, 0.5, 0.1, 0.0, 0.0)], axis=-1)
    vertices = np.concatenate([[[0.0, 0, 0]], rim])
    faces = np.array([(0, 1 + i, 1 + (i + 1) % 6) for i in range(6)])
    flat = face_normals(vertices, faces)
    bends = np.sort(np.degrees(np.arccos(np.sum(flat * np.roll(flat, 1, axis=0), axis=1))))
    one_crease = corner_normals(vertices, faces, bends[[5, 4]].mean())
    assert len(np.unique(one_crease[:, 0].round(9), axis=0)) == 1
    two_creases = corner_normals(vertices, faces, bends[[4, 3]].mean())
    assert len(np.unique(two_creases[:, 0].round(9), axis=0)) == 2


def test_triangle_soup_is_welded_for_normals(tmp_path):
    ball = trimesh.creation.icosphere(3)
    write(tmp_path / "a.stl", ball.vertices, ball.faces)
    mesh = load_mesh(tmp_path / "a.stl")
    assert len(mesh.vertices) == len(ball.vertices)
    points = mesh.vertices[mesh.faces]
    assert np.max(np.abs(mesh.normals - points)) < 0.01
    flat = load_mesh(tmp_path / "a.stl", crease=0)
    assert np.max(np.abs(flat.normals - points)) > 0.05


def test_normals_do_not_depend_on_scale():
    vertices, faces = box()
    for scale in (1e-150, 1e-20, 1e20, 1e59):
        mesh = make_mesh("box", vertices * scale, faces)
        assert len(mesh.faces) == 12
        assert mesh.normals == pytest.approx(make_mesh("box", vertices, faces).normals)


def test_opposite_faces_keep_their_own_normals():
    vertices = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], float)
    normals = corner_normals(vertices, np.array([(0, 1, 2), (2, 1, 0)]), 180)
    assert normals[0].tolist() == [[0, 0, 1]] * 3 and normals[1].tolist() == [[0, 0, -1]] * 3


@pytest.mark.parametrize("bits", [0, 1, 64])
def test_points_of_one_hash_are_told_apart(monkeypatch, bits):
    """Also where all points have one hash, or one of two."""
    rng = np.random.default_rng(75)
    points = rng.integers(-2, 3, (300, 3)) * np.array([1.0, -0.5, 0.0])
    hash_ = mesh_topology._hash
    monkeypatch.setattr(mesh_topology, "_hash", lambda c: hash_(c) & np.uint64((1 << bits) - 1))
    label, first = mesh_topology.weld(points)
    seen = {}
    assert label.tolist() == [seen.setdefault(tuple(p), len(seen)) for p in points.tolist()]
    assert first.tolist() == [label.tolist().index(k) for k in range(len(seen))]


# -- files -------------------------------------------------------------------------------------


@pytest.mark.parametrize("suffix", ["obj", "ply", "stl", "glb"])
def test_all_kinds_of_files(tmp_path, suffix):
    vertices, faces = box()
    mesh = load_mesh(write(tmp_path / f"cube.{suffix}", vertices, faces))
    assert len(mesh.faces) == 12 and is_closed(mesh)
    flat = face_normals(mesh.vertices, mesh.faces)
    assert mesh.normals == pytest.approx(np.repeat(flat[:, None], 3, axis=1), abs=1e-6)
    assert np.abs(mesh.vertices).max() == pytest.approx(1)


@pytest.mark.parametrize("suffix", ["obj", "ply", "glb"])
def test_normals_of_the_file_are_kept(tmp_path, suffix):
    vertices, faces = box()
    own = normalize(vertices + (0.3, -0.2, 0.1))
    kwargs = {"vertex_normal": True} if suffix == "ply" else {"include_normals": True}
    path = write(tmp_path / f"a.{suffix}", vertices, faces, own, **kwargs)
    mesh = load_mesh(path)
    expected = normalize(mesh.vertices[mesh.faces] + (0.3, -0.2, 0.1))
    assert mesh.normals == pytest.approx(expected, abs=1e-6)
    flat = load_mesh(path, crease=10)
    assert np.abs(flat.normals).max(axis=-1) == pytest.approx(1, abs=1e-6)


def test_unusable_normals_of_the_file_are_made_anew():
    vertices, faces = box()
    given = np.full((12, 3, 3), np.nan)
    given[3] = 0.0
    given[4] = (0, 0, 7.0)
    mesh = make_mesh("box", vertices, faces, given)
    flat = face_normals(vertices, faces)
    assert mesh.normals[3] == pytest.approx(np.repeat(flat[3][None], 3, axis=0))
    assert mesh.normals[4] == pytest.approx(np.broadcast_to([0, 0, 1.0], (3, 3)))


def test_parts_of_a_scene_file_are_put_in_their_places(tmp_path):
    scene = trimesh.Scene()
    vertices, faces = box()
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 0, 1), (0, 0, 0))
    turn[:3, 3] = (10, 0, 0)
    mirror = np.diag([-1.0, 1, 1, 1])
    mirror[:3, 3] = (-10, 0, 0)
    ball = trimesh.creation.icosphere(1)
    own = np.asarray(ball.vertices) * 1.0
    scene.add_geometry(trimesh.Trimesh(vertices * (1, 2, 1), faces), transform=turn)
    scene.add_geometry(
        trimesh.Trimesh(ball.vertices, ball.faces, vertex_normals=own, process=False),
        transform=mirror,
    )
    flatten = np.diag([1.0, 1, 0.25, 1])
    flatten[:3, 3] = (0, 20, 0)
    scene.add_geometry(
        trimesh.Trimesh(ball.vertices, ball.faces, vertex_normals=own, process=False),
        transform=flatten,
    )
    scene.export(tmp_path / "two.glb")
    mesh = load_mesh(tmp_path / "two.glb")
    assert mesh.vertices.min(axis=0) == pytest.approx([-11, -1, -1], abs=1e-3)
    assert mesh.vertices.max(axis=0) == pytest.approx([12, 21, 1], abs=1e-3)
    assert is_closed(mesh)
    points = mesh.vertices[mesh.faces]
    centre = np.where(points[..., :1] < -5, [-10.0, 0, 0], [10.0, 0, 0])
    centre = np.where(points[..., 1:2] > 10, [0, 20.0, 0], centre)
    assert (np.sum(mesh.normals * (points - centre), axis=-1) > 0).all()
    flat = face_normals(mesh.vertices, mesh.faces)
    assert (np.sum(flat * (points - centre)[:, 0], axis=-1) > 0).all()
    flattened = points[..., 1] > 10
    true = normalize((points - centre)[flattened] / (1, 1, 0.25**2))
    assert mesh.normals[flattened] == pytest.approx(true, abs=1e-6)


def test_faces_that_wind_clockwise_are_turned_round(tmp_path):
    vertices, faces = box()
    with_normals = write(
        tmp_path / "a.obj", vertices, faces[:, ::-1], normalize(vertices), include_normals=True
    )
    closed = write(tmp_path / "b.stl", vertices, faces[:, ::-1])
    for path in (with_normals, closed):
        mesh = load_mesh(path)
        points = mesh.vertices[mesh.faces]
        flat = face_normals(mesh.vertices, mesh.faces)
        assert (np.sum(flat * points.mean(axis=1), axis=-1) > 0).all()
        assert (np.sum(mesh.normals * points, axis=-1) > 0).all()


def test_degenerate_triangles_are_left_out_and_counted(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE + "v 0 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 2\nf 1 3 4\nf 1 2 5\nf 2 5 3\n")
    mesh = load_mesh(path)
    assert (len(mesh.faces), mesh.degenerate) == (2, 3)
    assert mesh.normals == pytest.approx(np.broadcast_to([0, 0, 1.0], (2, 3, 3)))
    assert mesh.transformed(2.0).degenerate == mesh.with_crease(0).degenerate == 3


def test_points_on_a_line_but_for_rounding_are_degenerate():
    rng = np.random.default_rng(75)
    start, along = rng.normal(size=(2, 200, 1, 3))
    vertices = (start + rng.uniform(-1, 1, (200, 3, 1)) * along).reshape(-1, 3)
    faces = np.arange(600).reshape(-1, 3)
    with pytest.raises(InputError, match="all 200 triangles are degenerate"):
        make_mesh("lines", vertices, faces)


def test_quads_and_negative_indices_of_obj(tmp_path):
    path = tmp_path / "a.obj"
    path.write_text(TRIANGLE + "v 1 1 0\nf 1 2 4 3\nf -4 -3 -2\n")
    mesh = load_mesh(path)
    assert len(mesh.faces) == 3 and mesh.vertices.max() == 1


PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
0 1 0
3 0 1 7
"""

BAD = {
    "no_faces.obj": (TRIANGLE, "the mesh has no faces"),
    "empty.obj": ("", "the file is empty"),
    "only_lines.obj": (TRIANGLE + "l 1 2\n", "the mesh has no faces"),
    "nan.obj": ("v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1: 'nan' is not finite"),
    "inf.obj": ("v 0 0 0\nv 1 -inf 0\nv 0 1 0\nf 1 2 3\n", "line 2: '-inf' is not finite"),
    "huge.obj": ("v 0 0 0\nv 1e99 0 0\nv 0 1 0\nf 1 2 3\n", "line 2: 1e99 exceeds 3.4e+38"),
    "high.obj": (TRIANGLE + "f 1 2 9\n", "line 4: index out of range: vertex 9, but there are 3"),
    "low.obj": (TRIANGLE + "f 1 2 -9\n", "line 4: index out of range: vertex -9, but there are 3"),
    "zero.obj": (
        TRIANGLE + "f 1 2 3\nf 0 1 2\n",
        "line 5: index out of range: vertex 0 (the first vertex of OBJ is 1)",
    ),
    "zero_later.obj": (
        "vn 0 0 1\n" + TRIANGLE + "f 1//1 2//1 0//1\n",
        "line 5: index out of range: vertex 0",
    ),
    "word.obj": ("v 0 0 zero\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "line 1: 'zero' is not a number"),
    "high.ply": (PLY, "face 0 refers to vertex 7, but there are 3 vertices"),
    "negative.ply": (PLY.replace("0 1 7", "0 1 -1"), "face 0 refers to vertex -1"),
    "short.ply": ("ply\nformat ascii 1.0\n", "not a PLY file: its header has no end"),
    "text.stl": ("hello", "not an STL file: neither 'solid' nor a binary header"),
    "text.glb": ("glTFxxxxxxxxx", "not a GLB file: no 'glTF' at its start"),
    "flat.obj": (TRIANGLE + "f 1 2 2\nf 1 1 1\n", "all 2 triangles are degenerate"),
    "flat_in_line.obj": ("v 0 0 0\nv 1 1 1\nv 3 3 3\nf 1 2 3\n", "the only triangle is degenerate"),
    "mesh.xyz": ("", "not a mesh file"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_files_give_one_clear_line(tmp_path, name):
    text, message = BAD[name]
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        load_mesh(path)
    line = str(caught.value)
    assert "\n" not in line and len(line) < len(str(path)) + 120
    assert line.startswith(f"{path}: ")
    assert re.match(message if "\\" in message else re.escape(message), line[len(f"{path}: ") :])


def test_missing_file_and_folder(tmp_path):
    for path in (tmp_path / "none.obj", tmp_path):
        path = path if path.suffix else tmp_path / "folder.obj"
        (tmp_path / "folder.obj").mkdir(exist_ok=True)
        with pytest.raises(InputError, match="no such file$"):
            load_mesh(path)


# -- transforms --------------------------------------------------------------------------------


def test_transform_order_is_scale_then_rotate_then_translate():
    mesh = Mesh(np.array([(1.0, 2, 3)]), np.zeros((1, 3), int), np.full((1, 3, 3), 0.0))
    moved = mesh.transformed((2, 1, 1), (90, 0, 0), (0, 0, 10))
    assert moved.vertices[0] == pytest.approx([2, -3, 12])


def test_rotations_go_about_x_then_y_then_z():
    turn = rotation_matrix((90, 90, 0))
    assert turn @ (0, 1, 0) == pytest.approx([1, 0, 0])  # y to z, then z to x
    assert rotation_matrix((0, 0, 90)) @ (1, 0, 0) == pytest.approx([0, 1, 0])


@pytest.mark.parametrize("scale", [(2, 1, 0.5), (-1, 1, 1), (-2, -1, -0.5)])
def test_normals_stay_square_to_the_surface(scale):
    vertices, faces = box()
    mesh = make_mesh("box", vertices @ rotation_matrix((30, 40, 50)).T, faces)
    moved = mesh.transformed(scale, (10, 20, 30), (1, 2, 3))
    flat = face_normals(moved.vertices, moved.faces)
    assert moved.normals == pytest.approx(np.repeat(flat[:, None], 3, axis=1))
    assert (np.sum(flat * (moved.vertices[moved.faces].mean(axis=1) - (1, 2, 3)), 1) > 0).all()
    assert is_consistent(moved)
