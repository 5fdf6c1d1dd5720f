# SPDX-License-Identifier: MIT
"""Results print in one line, and a picture shows itself in a notebook."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image

import phong75
from phong75.sim.frame.run_frame import SimResult


def test_results_print_in_one_line():
    scene = phong75.load_scene("cone", (64, 48))
    front = phong75.front_end(scene)
    frame, pixels = front.frame, phong75.render(front.frame)
    spans, count = len(frame.spans), int(frame.spans["length"].sum())
    triangles = len(scene.objects[0].mesh.faces)
    result = SimResult(pixels, True, count + 70, 71, 0, 0, 0, 0.0, 0.0)
    eye = ", ".join(f"{component:.3f}" for component in front.exact.eye)
    assert repr(scene) == f"Scene(cone, 64x48, objects: 1, triangles: {triangles}, materials: 1)"
    assert repr(frame) == f"Frame(64x48, spans: {spans}, pixels: {count})"
    assert repr(front) == f"FrontEnd({frame}, triangles: {triangles})"
    assert repr(front.exact) == f"ExactFrame(spans: {spans}, eye: ({eye}))"
    assert repr(frame.materials) == "MaterialTable(rows: 16, black: 15)"
    assert repr(pixels) == f"Pixels({count}, last: 1)"
    assert repr(result) == f"SimResult({pixels}, cycles: {count + 70}, complete: True)"


def test_a_picture_holds_the_pixels_and_shows_itself():
    frame = phong75.front_end(phong75.load_scene("cone", (64, 48))).frame
    pixels = phong75.render(frame)
    picture = phong75.picture(frame, pixels)
    assert (picture.size, picture.mode) == ((64, 48), "RGB")
    shown = np.asarray(picture)
    assert np.array_equal(shown[pixels.y, pixels.x], pixels.rgb)
    covered = np.zeros((48, 64), bool)
    covered[pixels.y, pixels.x] = True
    assert (shown[~covered] == frame.background).all() and 0 < covered.sum() < covered.size
    png = picture._repr_png_()  # what a notebook asks for
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(png))), shown)
