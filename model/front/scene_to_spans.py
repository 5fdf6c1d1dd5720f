"""The front end: from a scene to the spans, registers and material table of one picture.

Triangles come from the scene's objects, go through the camera, are resolved into visible segments
by scan line (`visibility`), and each segment becomes a span: the normal at its first dot and the
step to the next (`interpolation`), in the light frame. Gouraud and flat shading have intensities in
place of normals, of the vertices or of the face (`vertex_shading`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from phong75.model import vertex_shading
from phong75.model.config import DEFAULT, Config
from phong75.model.frame import (
    SPAN_DTYPE,
    ExactFrame,
    Frame,
    InputError,
    MaterialTable,
    half_vector_codes,
)
from phong75.model.front import visibility
from phong75.model.front.camera import light_frame
from phong75.model.front.interpolation import interpolate, scan_line_weights
from phong75.model.front.mesh import apply_matrix, face_normals, normalize
from phong75.model.front.scene import Scene
from phong75.model.front.visibility import GRID, Segments, Triangles


@dataclass
class FrontEnd:
    """What the front end makes of a scene.

    frame: the picture in codes. exact: the same before rounding. triangles: number of triangles
    of the scene, without `degenerate_triangles`, those left out because they have no area.
    """

    frame: Frame
    exact: ExactFrame
    triangles: int
    degenerate_triangles: int


def front_end(
    scene: Scene, config: Config = DEFAULT, progress: Callable[[float], None] | None = None
) -> FrontEnd:
    """Make the spans of `scene` for the hardware of `config`.

    progress: called with the part done, 0 to 1, as the work goes on. A scene entirely outside the
    view gives a frame without spans. Raises InputError if the scene does not fit `config`.
    """
    if not (1 <= scene.width <= config.max_size and 1 <= scene.height <= config.max_size):
        raise InputError(
            f"{scene.name}: size {scene.width}x{scene.height} is outside 1 to {config.max_size}"
        )
    if len(scene.materials) > config.materials:
        raise InputError(
            f"{scene.name}: {len(scene.materials)} materials, but the table has {config.materials}"
        )
    if config.technique != "phong" and scene.interpolation != "linear":
        raise InputError(
            f"{scene.name}: interpolation = {scene.interpolation} is for normals, "
            f"which {config.technique} shading does not interpolate"
        )
    if config.channels == 1 and any(len(set(m.color)) > 1 for m in scene.materials):
        raise InputError(f"{scene.name}: has colours, but the pipeline is built for grey")
    frame_axes, eye = light_frame(scene.light, scene.camera.axes[2])
    frame, exact = _frame(scene, eye, config)
    triangles = _triangles(scene, frame_axes, frame, exact, config)

    parts = []
    for segments, done in visible(triangles, scene.width, scene.height):
        if len(segments):
            parts.append(_spans(triangles, segments, config, scene.interpolation))
        if progress:
            progress(done)
    if parts:
        frame.spans, exact.start, exact.step = map(np.concatenate, zip(*parts, strict=True))
        frame.spans["last"][-1] = True
    return FrontEnd(
        frame,
        exact,
        sum(len(o.mesh.faces) for o in scene.objects),
        sum(o.mesh.degenerate for o in scene.objects),
    )


def _frame(scene: Scene, eye: np.ndarray, config: Config) -> tuple[Frame, ExactFrame]:
    """Registers and material table of the picture in codes and before rounding, without spans."""
    table, cp, d, weight, exponent = _materials(scene, config)
    background = np.floor(np.asarray(scene.background) * (2**config.colour_bits - 1) + 0.5)
    frame = Frame(
        scene.width,
        scene.height,
        half_vector_codes(eye, config),
        scene.two_sided,
        tuple(int(c) for c in background),
        table,
        np.zeros(0, SPAN_DTYPE),
    )
    nothing = np.zeros((0, 3))
    return frame, ExactFrame(nothing, nothing, eye, cp, d, weight, exponent)


def _triangles(
    scene: Scene, frame_axes: np.ndarray, frame: Frame, exact: ExactFrame, config: Config
) -> Triangles:
    """All triangles of the scene that face the eye, on the screen, with what is interpolated:
    normals in the light frame, or intensities as the hardware has them, then exact ones."""
    meshes = [o.mesh for o in scene.objects]
    points = np.concatenate([m.vertices[m.faces] for m in meshes])
    if config.technique == "flat":
        face = np.concatenate([face_normals(m.vertices, m.faces) for m in meshes])
        normal = np.repeat(face[:, None], 3, axis=1)
    else:
        normal = np.concatenate([m.normals for m in meshes])
    value = normalize(apply_matrix(frame_axes, normal))
    material = np.repeat([o.material for o in scene.objects], [len(m.faces) for m in meshes])
    if config.technique != "phong":
        given = value.reshape(-1, 3), np.repeat(material, 3)
        rounded = vertex_shading.intensities(*given, frame, config)
        ideal = vertex_shading.exact_intensities(*given, exact, scene.two_sided)
        value = np.concatenate([rounded, ideal], axis=-1).reshape(-1, 3, 6)
    corners = scene.camera.project(points, scene.width, scene.height)
    corners, value, material = visibility.clip(corners, value, material, scene.camera.near)
    w = corners[..., 2]
    return visibility.set_up(
        corners[..., 0] / w,
        corners[..., 1] / w,
        scene.camera.depth(w, corners[..., 3]),
        value,
        material,
        scene.two_sided,
    )


def visible(triangles: Triangles, width: int, height: int):
    """Yield the visible segments of one band of scan lines after the other, from the top, with
    the part of the picture done; bands are cut so that memory stays bounded."""
    first, end = visibility.line_range(triangles, width, height)
    change = np.bincount(first, minlength=height + 1) - np.bincount(end, minlength=height + 1)
    strips = np.cumsum(change)[:height]  # on each line
    top = 0
    while top < height:
        room = np.count_nonzero(np.cumsum(strips[top:]) <= visibility.BLOCK_STRIPS)
        lines = min(room, visibility.BLOCK_PIXELS // width)
        bottom = min(top + max(lines, 1), height)
        here = np.flatnonzero((first < bottom) & (end > top))
        part = triangles.take(here)
        segments = visibility.cover(
            part, np.maximum(first[here], top), np.minimum(end[here], bottom), width
        )
        ends = (segments.left, segments.right - 1)
        depth = [_at_pixels(part, segments, x, part.depth[..., None])[:, 0] for x in ends]
        visible = visibility.resolve(segments, np.stack(depth, axis=-1), width)
        visible.triangle = here[visible.triangle]
        yield visible, bottom / height
        top = bottom


def _at_pixels(triangles: Triangles, segments: Segments, x, values, normalize_edges=False):
    """float64[n, C]: `values` (float64[T, 3, C]) at the centre of dot `x` of each segment."""
    t = segments.triangle
    weights = scan_line_weights(
        triangles.x[t],
        triangles.y[t],
        x * GRID + GRID // 2,
        segments.y * GRID + GRID // 2,
    )
    return interpolate(values[t], weights, normalize_edges)


def _spans(triangles: Triangles, segments: Segments, config: Config, interpolation: str):
    """SPAN_DTYPE[n] of `segments`, and start and step before rounding, float64[n, 3] each.

    The step comes from the values at both ends, each a mean of those of the vertices whose weights
    are sound even in slivers; a gradient over the triangle's plane would not be.
    """
    ends = [
        _at_pixels(triangles, segments, x, triangles.value, interpolation == "normalized_edges")
        for x in (segments.left, segments.right - 1)
    ]
    length = segments.right - segments.left
    start, step = ends[0], (ends[1] - ends[0]) / np.maximum(length - 1, 1)[:, None]

    # A step of +2, from a normal to its opposite in one dot, is no code: single dots instead.
    rounded = np.floor(np.ldexp(step[:, :3], config.normal.fraction) + 0.5)
    single = ~np.all(config.normal.contains(rounded), axis=1)
    pieces = np.where(single, length, 1)
    piece = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    row = np.repeat(np.arange(len(length)), pieces)
    start = start[row] + piece[:, None] * step[row]
    step = np.where(single[row, None], 0.0, step[row])

    spans = np.zeros(len(row), SPAN_DTYPE)
    spans["x"] = segments.left[row] + piece
    spans["y"] = segments.y[row]
    spans["length"] = np.where(single[row], 1, length[row])
    spans["material"] = triangles.material[segments.triangle[row]]
    spans["start"], spans["step"] = encode(start[:, :3], step[:, :3], spans["length"], config)
    return spans, start[:, -3:], step[:, -3:]


def encode(start, step, length, config: Config) -> tuple[np.ndarray, np.ndarray]:
    """Codes int64[n, 3] of `start` and `step` (float64[n, 3]) in `Config.normal`.

    The step is held where the last of `length` (int[n]) dots, start + (length - 1) step, is a code
    of the format, too; rounding alone could carry it out. It drifts by (length - 1)/2 LSB at most.
    """
    steps = np.maximum(np.asarray(length, np.int64) - 1, 1)[:, None]
    start, step = config.normal.quantize(start), config.normal.quantize(step)
    lowest = -((start - config.normal.min) // steps)
    return start, np.clip(step, lowest, (config.normal.max - start) // steps)


def _materials(scene: Scene, config: Config):
    """The material table in codes, and Cp, d, W, n of all its rows before rounding."""
    table = MaterialTable.empty(config)
    cp, d = np.zeros((config.materials, 3)), np.zeros(config.materials)
    weight = np.zeros((config.materials, config.weight_points))
    exponent = np.ones(config.materials)
    zn = np.linspace(0.0, 1.0, config.weight_points)
    for i, material in enumerate(scene.materials):
        cp[i], d[i], exponent[i] = material.color, material.d, material.n
        weight[i] = material.weight(zn)
        table.set(i, cp[i], d[i], weight[i], exponent[i], config)
    return table, cp, d, weight, exponent
