# SPDX-License-Identifier: MIT
"""The bundled shapes: closed, outward, of unit normals that are those of the true surface."""

import numpy as np
import pytest

from phong75.model.front import shapes
from phong75.model.front.mesh import face_normals, is_closed, is_consistent, weld

ALL = {
    "sphere": shapes.sphere(),
    "sphere 3x2": shapes.sphere(2.0, 3, 2),
    "torus": shapes.torus(),
    "torus 3x3": shapes.torus(2.0, 0.5, 3, 3),
    "cone": shapes.cone(),
    "cone 3x1": shapes.cone(1.0, 1.0, 3, 1),
    "pyramid": shapes.pyramid(),
}


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return np.sum(a * np.cross(b, c)) / 6


@pytest.mark.parametrize("name", [*ALL, "teapot"])
def test_normals_are_unit_vectors_on_the_outer_side(name):
    mesh = ALL.get(name) or shapes.teapot(6)
    assert np.linalg.norm(mesh.normals, axis=-1) == pytest.approx(1, abs=1e-12)
    flat = face_normals(mesh.vertices, mesh.faces)
    assert np.linalg.norm(flat, axis=-1) == pytest.approx(1), "no degenerate triangle"
    assert mesh.degenerate == 0
    # Three or four facets to a full turn leave the true normal far from the facet's.
    least = 0.2 if name in ("sphere 3x2", "torus 3x3", "cone 3x1", "teapot") else 0.9
    assert np.min(np.sum(flat[:, None] * mesh.normals, axis=-1)) > least
    assert volume(mesh) > 0


@pytest.mark.parametrize("name", ALL)
def test_shapes_are_closed(name):
    assert is_closed(ALL[name])


def test_sphere_normals_are_its_points():
    mesh = shapes.sphere(2.5, 20, 11)
    points = mesh.vertices[mesh.faces]
    assert np.linalg.norm(points, axis=-1) == pytest.approx(2.5)
    assert mesh.normals == pytest.approx(points / 2.5)
    assert volume(shapes.sphere(1.0, 200, 100)) == pytest.approx(4 / 3 * np.pi, rel=2e-3)


def test_torus_normals_point_away_from_its_circle():
    mesh = shapes.torus(2.0, 0.5, 20, 12)
    points = mesh.vertices[mesh.faces]
    middle = points * (1, 1, 0)
    middle *= 2.0 / np.linalg.norm(middle, axis=-1, keepdims=True)
    assert np.linalg.norm(points - middle, axis=-1) == pytest.approx(0.5)
    assert mesh.normals == pytest.approx((points - middle) / 0.5)
    assert volume(shapes.torus(2.0, 0.5, 200, 100)) == pytest.approx(np.pi**2, rel=2e-3)


def test_cone_normals_are_square_to_its_side():
    mesh = shapes.cone(1.5, 2.0, 24, 3)
    points = mesh.vertices[mesh.faces]
    apex = np.array([0, 0, 2.0])
    side = mesh.normals[..., 2] > 0
    base = mesh.normals[..., 2] == -1
    assert (side | base).all() and base.sum() == 3 * 24
    assert (points[base][:, 2] == 0).all()
    along = (points - apex)[side]
    assert np.abs(np.sum(along * mesh.normals[side], axis=-1)).max() < 1e-12
    assert np.abs(mesh.normals[side][:, 2] - 1.5 / 2.5).max() < 1e-12
    # Each facet at the tip has its own normal there, in the middle of those below it.
    tip = np.linalg.norm(points - apex, axis=-1) == 0
    assert tip.sum() == 24 and len(np.unique(mesh.normals[tip].round(9), axis=0)) == 24
    flat = face_normals(mesh.vertices, mesh.faces)[tip.any(axis=1)]
    up = np.broadcast_to([0.0, 0.0, 1.0], flat.shape)  # in one plane with both normals
    assert np.abs(np.linalg.det(np.stack([flat, mesh.normals[tip], up], axis=1))).max() < 1e-12


def test_pyramid_is_that_of_the_notes():
    mesh = shapes.pyramid()
    assert mesh.vertices.tolist() == [
        [0, 0, 0],
        [150, 0, 0],
        [150, 150, 0],
        [0, 150, 0],
        [75, 75, 150],
    ]
    five = np.sqrt(5.0)
    expected = {
        (0, -2 / five, 1 / five),
        (2 / five, 0, 1 / five),
        (0, 2 / five, 1 / five),
        (-2 / five, 0, 1 / five),
        (0, 0, -1),
    }
    got = {tuple(n) for n in (mesh.normals.reshape(-1, 3) + 0.0).round(12)}
    assert got == {tuple(np.round(n, 12) + 0.0) for n in np.array(list(expected))}


# -- the teapot --------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def control():
    points, patches = shapes._read_patches()
    assert points.shape == (290, 3) and patches.shape == (32, 16)
    return points[patches].reshape(32, 4, 4, 3)


def test_patches_pass_through_their_corners(control):
    grid, _ = shapes.patch_surface(control, 4)
    for i, j in ((0, 0), (0, -1), (-1, 0), (-1, -1)):
        assert grid[:, i, j] == pytest.approx(control[:, i, j])
    # The middle of a bicubic patch by de Casteljau's halves.
    half = np.array([1, 3, 3, 1]) / 8
    assert grid[:, 2, 2] == pytest.approx(np.einsum("i,pijc,j->pc", half, control, half))


def de_casteljau(control, u, v):
    """The points [P, 3] of all patches at parameters u, v."""
    points = control
    for t in (u, v):  # the first axis of what is left of the grid
        for _ in range(3):
            points = points[:, :-1] + t * (points[:, 1:] - points[:, :-1])
        points = points[:, 0]
    return points


def test_patch_normals_are_those_of_small_differences(control):
    grid, normals = shapes.patch_surface(control, 8)
    h = 1e-5
    for i in (1, 2, 4, 7):
        for j in (1, 3, 6):
            u, v = i / 8, j / 8
            assert grid[:, i, j] == pytest.approx(de_casteljau(control, u, v))
            along_u = de_casteljau(control, u + h, v) - de_casteljau(control, u - h, v)
            along_v = de_casteljau(control, u, v + h) - de_casteljau(control, u, v - h)
            across = np.cross(along_v, along_u)
            across /= np.linalg.norm(across, axis=-1, keepdims=True)
            assert np.abs(normals[:, i, j] - across).max() < 1e-7


def test_normals_where_patches_close_in_a_point(control):
    _, normals = shapes.patch_surface(control, 6)
    lid, bottom = normals[20:24, 0], normals[28:32, 0]
    assert lid == pytest.approx(np.broadcast_to([0, 0, 1.0], lid.shape), abs=1e-12)
    assert bottom == pytest.approx(np.broadcast_to([0, 0, -1.0], bottom.shape), abs=1e-12)


@pytest.mark.parametrize("divisions", [2, 5, 8, 10])
def test_teapot_has_no_cracks_but_its_rims(divisions):
    mesh = shapes.teapot(divisions)
    assert is_consistent(mesh)
    assert len(np.unique(weld(mesh.vertices))) == len(mesh.vertices)
    # 8 of 32 patches lose one row of triangles at the lid's tip and the bottom's middle.
    assert len(mesh.faces) == 32 * 2 * divisions**2 - 8 * divisions
    start, end = mesh.faces.reshape(-1), np.roll(mesh.faces, -1, axis=1).reshape(-1)
    directed = set(zip(start.tolist(), end.tolist(), strict=True))
    open_edges = [e for e in directed if e[::-1] not in directed]
    # Open are the rim of the body, the edge of the lid, both ends of spout and handle: six
    # loops over 4 patches (two patches each for spout and handle).
    assert len(open_edges) == (4 + 4 + 2 * 2 + 2 * 2) * divisions


def test_teapot_is_symmetric():
    mesh = shapes.teapot(4)
    mirrored = mesh.vertices * (1, -1, 1)
    distance = np.abs(mesh.vertices[:, None] - mirrored[None]).max(axis=2)
    assert distance.min(axis=1).max() < 1e-12
    assert mesh.vertices.min(axis=0) == pytest.approx([-3, -2, 0], abs=0.05)
    assert mesh.vertices.max(axis=0) == pytest.approx([3.434, 2, 3.15], abs=0.05)


def test_teapot_normals_agree_across_smooth_borders():
    mesh = shapes.teapot(4)
    corner = mesh.faces.reshape(-1)
    normals = mesh.normals.reshape(-1, 3)
    total = np.zeros_like(mesh.vertices)
    np.add.at(total, corner, normals)
    count = np.bincount(corner)
    spread = np.linalg.norm(total, axis=1) / count
    # Only where the handle's and spout's halves, or knob and lid, meet at an angle do they differ.
    assert np.count_nonzero(spread < 1 - 1e-9) <= 24
