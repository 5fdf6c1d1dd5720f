# SPDX-License-Identifier: MIT
"""Mesh files of every format and feature: the right triangles, and a word about what was done."""

import json

import numpy as np
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from phong75.model.frame import InputError
from phong75.model.front.mesh import is_closed
from phong75.model.front.mesh_files import library
from phong75.model.front.mesh_files import load as load_module
from phong75.model.front.mesh_files.checks import UNTESTED_SUFFIXES
from phong75.model.front.mesh_files.load import load_mesh_file
from phong75.model.front.mesh_normals import normals_and_areas
from tests.mesh_examples import (
    CUBE_FACES,
    CUBES,
    PER_CORNER,
    PLAIN,
    QUANTIZED,
    TEXTURED,
    complaint_about,
    gltf_file,
    mutated,
)
from tests.mesh_writers import CUBE, SQUARES, Gltf, cube_glb, obj, ply, stl, triangles

QUICK = settings(
    max_examples=12, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
seeds = st.integers(0, 2**32 - 1)


def area(mesh):
    return float(normals_and_areas(mesh.vertices, mesh.faces)[1].sum())


def volume(mesh):
    a, b, c = mesh.vertices[mesh.faces].swapaxes(0, 1)
    return float(np.sum(a * np.cross(b, c)) / 6)


def load(folder, name, content, **others):
    """The loaded file `name` of `content` beside `others`."""
    for other, data in others.items():
        (folder / other.replace("_", ".")).write_bytes(data)
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return load_mesh_file(path)


# -- a cube in every dress -------------------------------------------------------------------------


@pytest.mark.parametrize("name", CUBES)
def test_a_cube_is_a_cube_in_every_file(tmp_path, name):
    content = CUBES[name]
    content, others = content if isinstance(content, tuple) else (content, {})
    loaded = load(tmp_path, name, content, **others)
    mesh, report = loaded.mesh, loaded.report
    middle = (mesh.vertices.max(axis=0) + mesh.vertices.min(axis=0)) / 2
    assert volume(mesh) == pytest.approx(8, abs=1e-3)
    assert area(mesh) == pytest.approx(24, abs=1e-5)
    assert len(mesh.vertices) in (8, 12) and report.triangles == len(mesh.faces) in (12, 20)
    assert name in ("instances.glb", "strips.glb", "fans.glb") or is_closed(mesh)
    # Each corner has the normal of its side.
    out = mesh.vertices[mesh.faces].mean(axis=1) - middle
    side = np.argmax(np.abs(out), axis=1)
    expected = np.zeros_like(out)
    expected[np.arange(len(out)), side] = np.sign(out[np.arange(len(out)), side])
    assert mesh.normals == pytest.approx(np.repeat(expected[:, None], 3, axis=1), abs=1e-5)
    has_normals = any(word in name for word in ("normals", "quantized", "missing"))
    assert report.normals.startswith("of the file" if has_normals else "made here")
    assert (report.bodies_turned, report.faces_turned > 0) == (
        int(name == "clockwise.obj"), name == "mixed_winding.obj",
    )  # fmt: skip
    parts = {"objects.obj": 2, "two_solids.stl": 2, "instances.glb": 2}
    assert report.parts == (parts | {"strips.glb": 6, "fans.glb": 6}).get(name, 1)
    assert bool(report.unused) == (name == "lines.obj") and report.up
    assert len(loaded.materials) == 0 and not loaded.two_sided.any()


def test_the_list_of_untested_formats_is_the_librarys():
    import ctypes

    assimp = ctypes.CDLL(str(library.library_path()))
    text = ctypes.create_string_buffer(1028)
    assimp.aiGetExtensionList(text)
    known = {s.lstrip("*").lower() for s in text.raw[4:].split(b"\0")[0].decode().split(";")}
    assert set(UNTESTED_SUFFIXES) | {".obj", ".ply", ".stl", ".glb", ".gltf"} == known


# -- whole kinds -----------------------------------------------------------------------------------


@QUICK
@given(seeds)
def test_a_normal_belongs_to_the_corner(tmp_path, seed):
    """Any corner may have any of the file's normals, however vertices are shared."""
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(rng.integers(1, 9), 3))
    chosen = rng.integers(0, len(normals), (12, 3))
    text = "".join("vn {:.6f} {:.6f} {:.6f}\n".format(*n) for n in normals)
    for face, corner in zip(CUBE_FACES, chosen, strict=True):
        text += "f " + " ".join(f"{v + 1}//{n + 1}" for v, n in zip(face, corner, strict=True))
        text += "\n"
    mesh = load(tmp_path, "a.obj", obj(CUBE, []) + text).mesh
    expected = {}
    for face, corner in zip(CUBE_FACES, chosen, strict=True):
        for v, n in zip(face, corner, strict=True):
            expected[frozenset(face), v] = normals[n] / np.linalg.norm(normals[n])
    index = {tuple(v): i for i, v in enumerate(CUBE)}
    for face, given_normals in zip(mesh.faces, mesh.normals, strict=True):
        own = [index[tuple(v)] for v in mesh.vertices[face]]
        for v, normal in zip(own, given_normals, strict=True):
            assert normal == pytest.approx(expected[frozenset(own), v], abs=1e-5)


def test_a_number_may_begin_with_its_decimal_point(tmp_path):
    text = "v -1 -1 0\nv 1 -.5 +.25\nv\t.5 1 -.125\nvn .6 0 .8\nf 1//1 2//1 3//1\n"
    mesh = load(tmp_path, "a.obj", text).mesh
    corners = sorted(map(tuple, mesh.vertices.tolist()))
    assert corners == [(-1, -1, 0), (0.5, 1, -0.125), (1, -0.5, 0.25)]
    assert np.abs(mesh.normals[0]) == pytest.approx(np.tile([0.6, 0, 0.8], (3, 1)))


@QUICK
@given(seeds, st.integers(4, 14), st.booleans())
def test_a_concave_polygon_has_its_own_area(tmp_path, seed, count, as_ply):
    rng = np.random.default_rng(seed)
    radius = rng.uniform(0.2, 1, count)
    turn = (np.arange(count) + rng.uniform(0, 0.8, count)) * 2 * np.pi / count
    x, y = radius * np.cos(turn), radius * np.sin(turn)
    shoelace = np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)) / 2
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    basis[:, 2] *= np.linalg.det(basis)
    points = np.c_[x, y, np.zeros(count)] @ basis.T
    order = np.roll(np.arange(count), rng.integers(count))
    name, write = ("a.ply", ply) if as_ply else ("a.obj", obj)
    mesh = load(tmp_path, name, write(points, [order])).mesh
    assert area(mesh) == pytest.approx(shoelace, rel=1e-4)
    assert mesh.normals == pytest.approx(np.broadcast_to(basis[:, 2], mesh.normals.shape), abs=1e-3)


@QUICK
@given(seeds, st.integers(2, 6))
def test_negative_indices_count_back_from_their_face(tmp_path, seed, squares):
    rng = np.random.default_rng(seed)
    text, total, expected = "", 0, []
    for k in range(squares):
        corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]) + (2 * k, 0, 0)
        spare = rng.integers(0, 3)
        text += obj([*corners, *rng.normal(size=(spare, 3))], [])
        total += 4 + spare
        back = rng.random() < 0.5
        base = -(4 + spare) if back else total - spare - 3
        text += "f " + " ".join(str(base + i) for i in range(4)) + "\n"
        expected.append(corners)
    mesh = load(tmp_path, "a.obj", text).mesh
    points = {tuple(p) for p in mesh.vertices}
    assert points == {tuple(map(float, p)) for c in expected for p in c}
    assert area(mesh) == pytest.approx(squares)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian"])
def test_strips_of_ply(tmp_path, form):
    """A strip of n vertices is n - 2 triangles, every second one turned; -1 begins a new strip."""
    points = [(x, y, 0) for x in range(5) for y in (1, 0)]
    ends = [0, 1, 2, 3, 4, 5, -1, 6, 7, 8, 9]
    content = ply(points, [ends], form, element="tristrips", count="int")
    mesh = load(tmp_path, "a.ply", content).mesh
    assert len(mesh.faces) == 6 and area(mesh) == pytest.approx(3)
    assert mesh.normals == pytest.approx(np.broadcast_to([0, 0, 1.0], (6, 3, 3)))


@QUICK
@given(seeds, st.integers(1, 4))
def test_each_body_is_wound_by_itself(tmp_path, seed, count):
    rng = np.random.default_rng(seed)
    vertices, faces, inverted = [], [], rng.random(count) < 0.5
    for k in range(count):
        own = [f[::-1] if inverted[k] else f for f in CUBE_FACES]
        faces += [tuple(i + 8 * k for i in f) for f in own]
        vertices += list(CUBE * rng.uniform(0.3, 1, 3) + (4 * k, 0, 0))
    order = rng.permutation(len(faces))
    content = stl(vertices, [faces[i] for i in order])
    loaded = load(tmp_path, "a.stl", content)
    mesh, report = loaded.mesh, loaded.report
    assert (report.bodies, report.bodies_turned) == (count, inverted.sum())
    points = mesh.vertices[mesh.faces].mean(axis=1)
    out = points - np.c_[np.rint(points[:, 0] / 4) * 4, np.zeros((len(points), 2))]
    assert (np.sum(normals_and_areas(mesh.vertices, mesh.faces)[0] * out, axis=1) > 0).all()
    assert (np.sum(mesh.normals * out[:, None], axis=-1) > 0).all()


@QUICK
@given(seeds, st.sampled_from([3, 4, 5, 6, 7, 8, 9, 12, 48]))
@example(1, 6)
@example(2, 6)
@example(3, 6)
def test_the_edges_of_a_regular_prism_are_all_alike(tmp_path, seed, sides):
    """Also when coordinates are rounded: no edge of a regular polygon is near the crease angle."""
    rng = np.random.default_rng(seed)
    turn = np.arange(sides) * 2 * np.pi / sides
    circle = np.c_[np.cos(turn), np.sin(turn)]
    basis = np.linalg.qr(rng.normal(size=(3, 3)))[0] * rng.uniform(0.01, 100)
    points = np.concatenate([np.c_[circle, np.full(sides, z)] for z in (0.0, 1.0)]) @ basis.T
    quads = [(i, (i + 1) % sides, sides + (i + 1) % sides, sides + i) for i in range(sides)]
    mesh = load(tmp_path, "a.stl", stl(points, triangles(quads))).mesh
    flat, _ = normals_and_areas(mesh.vertices, mesh.faces)
    bend = np.sum(mesh.normals * flat[:, None], axis=-1)
    assert (bend > 1 - 1e-5).all() if 360 / sides > 56 else (bend < 1 - 1e-4).any(axis=1).all()


@pytest.mark.parametrize("form", ["ascii", "binary_big_endian"])
def test_vertices_of_no_face_are_left_out_and_counted(tmp_path, form):
    loaded = load(tmp_path, "a.ply", ply([*CUBE, (90, 0, 0), (0, 90, 0)], SQUARES, form))
    assert loaded.mesh.vertices.max() == 1 and loaded.report.unused_vertices == 2
    assert "2 vertices of no face left out" in loaded.report.lines()


# -- smoothing groups ------------------------------------------------------------------------------


def saddle():
    """The saddle of the lecture notes, section 3: P0 between P2 and P4 is gentle, while P1 and P3
    drop off. Vertices, and P4, P0, P2, P1, P3."""
    x, z = (-1.0, -0.5, 0.5, 1.0), (-0.1, 0.0, 0.0, -0.1)
    vertices = [(x[i], y, z[i]) for y in (-0.5, 0.5) for i in range(4)]
    vertices += [(x[i], y, -0.3) for y in (-0.8, 0.8) for i in (1, 2)]
    return vertices, [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (8, 9, 2, 1), (5, 6, 11, 10)]


def face_line(polygon):
    return "f " + " ".join(str(i + 1) for i in polygon) + "\n"


def test_smoothing_groups_decide_which_normals_are_averaged(tmp_path):
    vertices, polygons = saddle()
    text = obj(vertices, []) + "s 1\n" + "".join(map(face_line, polygons[:3]))
    text += "s 2\n" + face_line(polygons[3]) + "s off\n" + face_line(polygons[4])
    loaded = load(tmp_path, "a.obj", text)
    mesh = loaded.mesh
    assert loaded.report.normals == "made here, by the smoothing groups of the file"
    flat, _ = normals_and_areas(mesh.vertices, mesh.faces)
    x, y = mesh.vertices[mesh.faces].mean(axis=1)[:, :2].T
    left, middle, right = (flat[(np.abs(y) < 0.5) & side].mean(axis=0)
                           for side in (x < -0.5, np.abs(x) < 0.5, x > 0.5))  # fmt: skip
    for face in np.flatnonzero(np.abs(y) < 0.5):
        for corner, normal in zip(mesh.vertices[mesh.faces[face]], mesh.normals[face], strict=True):
            mean = {-1: left, -0.5: left + middle, 0.5: middle + right, 1: right}[corner[0]]
            assert normal == pytest.approx(mean / np.linalg.norm(mean), abs=1e-5)
    for face in np.flatnonzero(np.abs(y) > 0.5):  # abrupt, though the edges bend by 45 degrees
        assert mesh.normals[face] == pytest.approx(np.repeat(flat[face][None], 3, 0), abs=1e-9)


@pytest.mark.parametrize("line, smooth", [("s 1", True), ("s off", False), ("s 0", False)])
def test_one_smoothing_group_for_all(tmp_path, line, smooth):
    mesh = load(tmp_path, "a.obj", obj(CUBE, SQUARES, before=line + "\n")).mesh
    flat, _ = normals_and_areas(mesh.vertices, mesh.faces)
    diagonal = mesh.vertices[mesh.faces] / np.sqrt(3)
    expected = diagonal if smooth else np.repeat(flat[:, None], 3, axis=1)
    assert mesh.normals == pytest.approx(expected, abs=1e-9)


def test_groups_and_materials_do_not_mix_up(tmp_path):
    """`s` between `usemtl` lines changes no material, and `usemtl` changes no group."""
    library_text = b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n"
    text = "mtllib a.mtl\n" + obj(CUBE, []) + "usemtl red\ns 1\n"
    text += "".join(map(face_line, SQUARES[:2])) + "usemtl blue\n" + face_line(SQUARES[2])
    text += "s 0\n" + face_line(SQUARES[3]) + "usemtl red\n" + "".join(map(face_line, SQUARES[4:]))
    loaded = load(tmp_path, "a.obj", text, a_mtl=library_text)
    colour = loaded.materials.colour[loaded.material]
    sides = loaded.mesh.vertices[loaded.mesh.faces].mean(axis=1)
    blue = (sides[:, 1] < -0.9) | (sides[:, 0] > 0.9)
    assert (colour == np.where(blue[:, None], (0, 0, 1), (1, 0, 0))).all()
    flat, _ = normals_and_areas(loaded.mesh.vertices, loaded.mesh.faces)
    is_flat = np.all(np.sum(loaded.mesh.normals * flat[:, None], axis=-1) > 0.999, axis=1)
    assert (is_flat == ((sides[:, 0] > 0.9) | (sides[:, 1] > 0.9) | (sides[:, 0] < -0.9))).all()


def test_normals_of_the_file_come_before_groups_and_crease_before_all(tmp_path):
    text = obj(CUBE, [], before="s 1\n") + PER_CORNER
    assert load(tmp_path, "a.obj", text).report.normals == "of the file"
    mesh = load_mesh_file(tmp_path / "a.obj", crease=120).mesh
    assert mesh.normals == pytest.approx(mesh.vertices[mesh.faces] / np.sqrt(3), abs=1e-6)


def test_a_large_file_is_read_while_it_is_looked_at(tmp_path, monkeypatch):
    """As a small one is: also if the look finds that it must be changed first, or is wrong."""
    monkeypatch.setattr(load_module, "LARGE_TEXT", 0)
    for name in ("quads.obj", "comments.obj"):
        loaded = load(tmp_path, name, CUBES[name])
        assert volume(loaded.mesh) == pytest.approx(8) and len(loaded.mesh.faces) == 12
    with pytest.raises(InputError, match="line 15: vertex 9 has one coordinate"):
        load(tmp_path, "a.obj", PLAIN + "v 3")


# -- materials -------------------------------------------------------------------------------------

MTL = b"""newmtl shiny
Kd 0.8 0.2 0.1
Ks 0.5 0.25 0
Ns 500
illum 2
newmtl dull # chalk
Kd 0.1 0.2 0.3
Ks 1 1 1
Ns 20
illum 1
d 0.5
"""


def test_materials_of_obj(tmp_path):
    text = "mtllib a.mtl\n" + obj(CUBE, []) + "usemtl shiny\n" + face_line(SQUARES[0])
    text += "usemtl dull\n" + face_line(SQUARES[1]) + "usemtl gold\n" + face_line(SQUARES[2])
    loaded = load(tmp_path, "a.obj", text, a_mtl=MTL.replace(b" # chalk", b""))
    shiny, dull, none = (loaded.material[2 * k] for k in range(3))
    m, notes = loaded.materials, loaded.report.lines()
    assert m.colour[shiny] == pytest.approx([0.8, 0.2, 0.1], abs=1e-6)
    assert (m.n[shiny], m.w[shiny]) == (128, 0.5)  # Ns = 500 is more than the hardware has
    assert m.colour[dull] == pytest.approx([0.1, 0.2, 0.3], abs=1e-6) and m.w[dull] == 0
    assert none == -1 and "material gold is not defined" in notes
    assert "n of 1 material limited to the range 1 to 128" in notes
    assert any("transparency of 1 material" in line for line in notes)
    (tmp_path / "a.mtl").unlink()
    lost = load_mesh_file(tmp_path / "a.obj")
    assert (lost.material == -1).all() and "a.mtl is not there" in lost.report.lines()
    lost = load(tmp_path, "a.obj", text.replace("a.mtl", "b.mtl"))
    assert [line for line in lost.report.lines() if "mtl" in line] == ["b.mtl is not there"]


@pytest.mark.parametrize("metallic, roughness, n, w", [
    (0.0, 0.0, 128, 0.2), (0.0, 1.0, 1, 0), (1.0, 0.5, 7.5, 0.4472), (0.5, 0.4, 19.03, 0.3888),
])  # fmt: skip
def test_materials_of_gltf(tmp_path, metallic, roughness, n, w):
    content = cube_glb(pbrMetallicRoughness={
        "baseColorFactor": [0.8, 0.4, 0.2, 1], "metallicFactor": metallic,
        "roughnessFactor": roughness,
    }).glb()  # fmt: skip
    m = load(tmp_path, "a.glb", content).materials
    assert m.colour[0] == pytest.approx([0.8, 0.4, 0.2], abs=1e-6)
    assert (m.n[0], m.w[0]) == (pytest.approx(n, rel=1e-3), pytest.approx(w, rel=1e-3))


def test_colours_of_vertices(tmp_path):
    """A face has the mean colour of its corners; in glTF they multiply the base colour."""
    red, green = (200, 0, 0), (0, 100, 0)
    split = [*CUBE[:4], *CUBE[4:]]
    loaded = load(tmp_path, "a.ply", ply(split, CUBE_FACES, colours=[red] * 4 + [green] * 4))
    sides = loaded.mesh.vertices[loaded.mesh.faces].mean(axis=1)
    colour = np.rint(255 * loaded.materials.colour[loaded.material])
    assert (colour[sides[:, 2] < -0.9] == red).all() and (colour[sides[:, 2] > 0.9] == green).all()
    assert len(loaded.materials) == 4 == loaded.report.materials  # and two mixtures

    text = "".join("v {} {} {} 1 0.5 0\n".format(*v) for v in CUBE)
    loaded = load(tmp_path, "a.obj", text + "".join(map(face_line, SQUARES)))
    assert 255 * loaded.materials.colour == pytest.approx(np.array([[255, 127.5, 0]]), abs=0.6)

    file = Gltf()
    base = file.material(pbrMetallicRoughness={"baseColorFactor": [0.5, 1, 1, 1]})
    for values, kind in ((0.8, "f4"), (204, "u1"), (52428, "u2")):
        paint = file.accessor(np.full((8, 4), values), kind, normalized=kind != "f4")
        file.root["nodes"], file.root["scenes"][0]["nodes"] = [], []
        file.node(file.mesh(CUBE, CUBE_FACES, material=base, COLOR_0=paint))
        loaded = load(tmp_path, "a.glb", file.glb())
        assert loaded.materials.colour == pytest.approx(np.array([[0.4, 0.8, 0.8]]), abs=0.002)


def test_two_sided_is_said_by_the_material(tmp_path):
    file = Gltf()
    for sides, place in ((True, 0.0), (False, 5.0)):
        material = file.material(doubleSided=sides)
        file.node(file.mesh(CUBE, CUBE_FACES, material=material), translation=[place, 0, 0])
    loaded = load(tmp_path, "a.glb", file.glb())
    assert (loaded.two_sided == (loaded.mesh.vertices[loaded.mesh.faces[:, 0], 0] < 3)).all()
    assert loaded.report.two_sided == 12 and loaded.report.two_sided_why == ["the file says so"]
    # PLY has no such word, whatever Assimp makes of it.
    assert not load(tmp_path, "a.ply", ply(CUBE, SQUARES)).two_sided.any()


# -- what is not used, and what cannot be read -----------------------------------------------------


def test_what_is_not_shown_is_named(tmp_path):
    file = cube_glb(pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
    root = file.root
    root["images"] = [{"uri": "wood.png"}]
    root["textures"] = [{"source": 0}]
    root["extensionsUsed"] = ["KHR_materials_clearcoat", "EXT_mesh_gpu_instancing"]
    target = file.accessor(CUBE * 2)
    root["meshes"][0]["primitives"][0]["targets"] = [{"POSITION": target}]
    unused = load(tmp_path, "a.glb", file.glb()).report.unused
    assert unused[:2] == ["extension KHR_materials_clearcoat", "extension EXT_mesh_gpu_instancing"]
    assert "1 texture" in unused and "1 mesh with morph targets" in unused
    assert len(unused) == 4


@pytest.mark.parametrize("name", [
    "KHR_draco_mesh_compression", "EXT_meshopt_compression", "VENDOR_anything",
])  # fmt: skip
def test_a_required_extension_that_is_not_read_is_named(tmp_path, name):
    file = cube_glb()
    file.root["extensionsUsed"] = file.root["extensionsRequired"] = [name]
    with pytest.raises(InputError, match=f"requires the extension {name}, which is not read"):
        load(tmp_path, "a.glb", file.glb())


GOOD_GLB = cube_glb().glb()
BROKEN = {
    "few.obj": (obj(CUBE[:3], []) + "v 7 8\n" + PLAIN, "line 4: vertex 4 has two coordinates"),
    "none.obj": ("v\n" + PLAIN, "line 1: vertex 1 has no coordinates"),
    "one.obj": (PLAIN + "v 3", "line 15: vertex 9 has one coordinate"),
    "utf16.obj": (PLAIN.encode("utf-16"), "text in UTF-16: save the file as UTF-8"),
    "normal.obj": (obj(CUBE, []) + PER_CORNER + "f 1//1 2//9 3//1", "line 21: index out of "),
    "texture.obj": (obj(CUBE, []) + TEXTURED + "f 1/9/1 2/1/1 3/1/1\nvn 0 0 1", "line 19: index "),
    "corner.obj": (PLAIN + "f 1 two 3\n", "line 15: 'two' is not a corner of a face"),
    "text.ply": ("play\n", "not a PLY file: no 'ply' at its start"),
    "count.ply": (ply(CUBE, SQUARES).replace(b"vertex 8", b"vertex x"), "header line 'element ver"),
    "cut.ply": (ply(CUBE, SQUARES, "binary_little_endian")[:-150], "cut short: its header "),
    "cut_faces.ply": (ply(CUBE, SQUARES, "binary_little_endian")[:-9], "cut short: its last list"),
    "bare.ply": (ply(CUBE, SQUARES).replace(b" float y", b""), "header line 'property' has"),
    "points.ply": (ply(CUBE, []), "the mesh has no faces"),
    "cut.stl": (stl(CUBE, CUBE_FACES)[:-7], "cut short: its header declares 12 triangles, 11 fol"),
    "short.stl": (b"\0" * 50, "not an STL file: neither 'solid' nor a binary header"),
    "version.glb": (GOOD_GLB[:4] + b"\1" + GOOD_GLB[5:], "version 1 of GLB; only version 2 is"),
    "cut.glb": (GOOD_GLB[:300], "cut short: its header declares"),
    "json.glb": (GOOD_GLB.replace(b'"asset"', b'"asset:'), "malformed JSON: "),
    "list.gltf": (b"[]", "malformed glTF: no object at the top"),
    "lost.gltf": (cube_glb().gltf("lost.bin"), "not a readable mesh: "),
    "index.glb": (gltf_file(lambda f: f.node(f.mesh(CUBE, [(0, 1, 8)]))), "mesh 0: index 2 re"),
    "polygon.ply": (ply(CUBE, [*SQUARES, (0, 1, 3, 900)]), "face 6 refers to vertex 900, but "),
    "first.gltf": (b'{"asset": {"version": "1.0"}}', "version 1.0 of glTF; only version 2 is read"),
    "mixed.ply": (ply(CUBE, [*CUBE_FACES, *SQUARES], "binary_big_endian")[:-3], "cut short: its "),
    "empty.stl": (stl(CUBE, []), "the mesh has no faces"),
    "empty_ascii.stl": (stl(CUBE, [], "ascii"), "the mesh has no faces"),
    "nan.ply": (ply([(np.nan, 0, 0), *CUBE[1:]], SQUARES, "binary_big_endian"), "vertex 0 = (nan"),
    "words.3ds": (b"nothing of the kind", "not a readable mesh: "),
    "nothing.fbx": (b"", "the file is empty"),
}  # fmt: skip


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_gives_one_clear_line(tmp_path, name):
    content, message = BROKEN[name]
    with pytest.raises(InputError) as caught:
        load(tmp_path, name, content)
    line = str(caught.value)
    assert line.startswith(f"{tmp_path / name}: {message}") and "\n" not in line
    assert len(line) < len(str(tmp_path / name)) + 260


def test_a_bomb_ends_at_the_limits(tmp_path, monkeypatch):
    path = tmp_path / "a.obj"
    path.write_text(obj(CUBE, SQUARES * 20000))
    monkeypatch.setattr(library, "MEMORY", 60 << 20)
    monkeypatch.setattr(library, "MEMORY_PER_BYTE", 0)
    with pytest.raises(InputError, match=r"a.obj: takes more than 0\.1 GiB of memory to read$"):
        load_mesh_file(path)
    monkeypatch.undo()
    monkeypatch.setattr(library, "CPU_S", 0)
    monkeypatch.setattr(library, "CPU_S_PER_BYTE", 0)
    path.write_text(obj(CUBE, SQUARES * 200000))
    with pytest.raises(InputError, match=r"takes more than \d s of processor time to read$"):
        load_mesh_file(path)


def test_a_crash_of_the_reader_is_one_line(tmp_path, monkeypatch):
    path, script = tmp_path / "a.obj", tmp_path / "child.py"
    path.write_text(PLAIN)
    monkeypatch.setattr(library, "CHILD", script)
    crash = "import os, signal; os.kill(os.getpid(), signal.SIGSEGV)"
    for text, how in ((crash, r"crashes \(signal 11\)"), ("1/0", "ends without an answer$")):
        script.write_text(text)
        with pytest.raises(InputError, match=f"a.obj: not a readable mesh: the reader {how}"):
            load_mesh_file(path)


@QUICK
@given(seeds, st.sampled_from([None, -1, 2**40, 1.5, "x", [], {}, [[]], True]))
@example(0, -1)
def test_gltf_with_a_wrong_value_anywhere(tmp_path, seed, value):
    rng = np.random.default_rng(seed)
    root = json.loads(json.dumps(QUANTIZED.root))
    root["buffers"] = [{"byteLength": len(QUANTIZED.blob), "uri": "cube.bin"}]
    (tmp_path / "cube.bin").write_bytes(QUANTIZED.blob)
    places = []

    def walk(node):
        for key in node if isinstance(node, dict) else range(len(node)):
            places.append((node, key))
            if isinstance(node[key], (dict, list)):
                walk(node[key])

    walk(root)
    node, key = places[rng.integers(len(places))]
    node[key] = value
    assert not complaint_about(tmp_path, "a.gltf", json.dumps(root).encode())


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(seeds)
def test_a_mutated_file_is_read_or_refused_in_one_line(tmp_path, seed):
    """More of them, and their pictures: `make mesh-fuzz`."""
    name, content = mutated(seed)
    complaint = complaint_about(tmp_path, name, content)
    assert not complaint
