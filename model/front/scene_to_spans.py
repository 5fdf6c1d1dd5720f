# SPDX-License-Identifier: MIT
"""The front end: from a scene to the spans, registers and material table of one picture.

The camera projects the triangles of the scene's objects (`camera`). Hidden surfaces are removed per
scan line, which leaves visible segments (`visibility`). Each segment becomes a span: the normal at
its first pixel and the step from pixel to pixel (`interpolation`), in the light frame.

For Gouraud and flat shading a span carries intensities instead of normals: those of the vertices,
or that of the face. The front end does not know how the hardware shades a vertex; the caller of
`make_frame` passes a `VertexShader`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from phong75.model.arrays import ArrayLike, Flags, Ints, Reals, Spans
from phong75.model.config import Config
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


class VertexShader(Protocol):
    """Gives the intensities that Gouraud and flat shading interpolate or hold."""

    def __call__(
        self, normal: Reals, material: Ints, frame: Frame, exact: ExactFrame, config: Config
    ) -> tuple[Reals, Reals]:
        """S of red, green and blue, float64[n, 3], twice: as the hardware of `config` computes S,
        and by eq. (3) of the paper before any rounding.

        normal: float64[n, 3], unit vectors in the light frame. material: int64[n], rows of the
        material table. frame, exact: registers and materials in codes and before rounding.
        """
        ...


@dataclass(repr=False)
class FrontEnd:
    """What the front end makes of a scene.

    frame: the picture in codes. exact: the same picture before rounding. triangles: number of
    triangles in the scene. degenerate_triangles: number of further triangles that were left out
    because they have no area. lit_facing_away: pixels that are lit although their triangle turns
    away from the light, an effect of interpolated normals. empty: why there is no pixel, in words;
    None if there is one.
    """

    frame: Frame
    exact: ExactFrame
    triangles: int
    degenerate_triangles: int
    lit_facing_away: int = 0
    empty: str | None = None

    def __repr__(self) -> str:
        return f"FrontEnd({self.frame}, triangles: {self.triangles})"


def make_frame(
    scene: Scene,
    config: Config,
    shade_vertices: VertexShader,
    progress: Callable[[float], None] | None = None,
) -> FrontEnd:
    """Make the spans, registers and material table of `scene` for the hardware of `config`.

    shade_vertices: called once if `config.technique` is Gouraud's or flat shading, with all
    vertices of the scene. progress: called with the part done, 0 to 1, as the work goes on. A scene
    entirely outside the view gives a frame without spans. Raises InputError if the scene does not
    fit `config`.
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
    triangles, dark = _triangles(scene, frame_axes, frame, exact, config, shade_vertices)

    parts, lit_facing_away = [], 0
    for segments, done in visible(triangles, scene.width, scene.height):
        if len(segments):
            parts.append(_spans(triangles, segments, config, scene.interpolation))
            if dark.any() and config.technique == "phong" and not scene.toward_light:
                lit_facing_away += _lit_pixels(parts[-1][0], segments, dark, scene.width)
        if progress:
            progress(done)
    if parts:
        frame.spans, exact.start, exact.step = map(np.concatenate, zip(*parts, strict=True))
        frame.spans["last"][-1] = True
    meshes = [o.mesh for o in scene.objects]
    return FrontEnd(
        frame,
        exact,
        sum(len(m.faces) for m in meshes),
        sum(m.degenerate for m in meshes),
        lit_facing_away,
        None if parts else _why_empty(scene),
    )


def _lit_pixels(spans: Spans, segments: Segments, dark: Flags, width: int) -> int:
    """The number of pixels that are lit although their triangle turns away from the light.

    spans: those of `segments`, both sorted by y, then x. dark: bool[T], triangles that turn away
    from the light. A pixel is lit where Zn, the normal's z, is greater than 0.
    """
    row = np.searchsorted(
        segments.y * width + segments.left, spans["y"] * width + spans["x"], "right"
    )
    spans = spans[dark[segments.triangle[row - 1]]]
    first, step, length = spans["start"][:, 2], spans["step"][:, 2], spans["length"]
    slope = np.where(step == 0, 1, np.abs(step))
    rising = length - np.clip(-first // slope + 1, 0, length)
    falling = np.clip(-(-first // slope), 0, length)
    level = np.where(first > 0, length, 0)
    return int(np.sum(np.where(step > 0, rising, np.where(step < 0, falling, level))))


def _why_empty(scene: Scene) -> str:
    """Why a picture of `scene` has no pixel, and what to try."""
    points = np.concatenate([o.mesh.vertices[o.mesh.faces] for o in scene.objects])
    corners = scene.camera.project(points, scene.width, scene.height)
    behind = np.all(corners[..., 2] < scene.camera.near, axis=1)
    two_sided = _of_triangles(scene, "two_sided") | scene.two_sided | scene.toward_light
    away = ~behind & ~two_sided & (_screen_side(corners) >= 0)
    beside = len(points) - np.count_nonzero(behind) - np.count_nonzero(away)
    reasons = [
        (np.count_nonzero(away), "turn away from the eye (try two_sided = true in a scene file)"),
        (np.count_nonzero(behind), "are behind the eye (try another [camera] eye or near)"),
        (beside, "are outside the view or between pixels (try without the keys of [camera])"),
    ]
    return f"no pixel: of {len(points)} triangles " + ", ".join(
        f"{'all' if count == len(points) else count} {why}" for count, why in reasons if count
    )


def _of_triangles(scene: Scene, name: str) -> NDArray[Any]:
    """The attribute `name` of each object, `material` or `two_sided`, for each triangle: [T]."""
    return np.concatenate(
        [np.broadcast_to(getattr(o, name), len(o.mesh.faces)) for o in scene.objects]
    )


def _screen_side(corners: Reals) -> Reals:
    """float64[T], negative for triangles that face the eye.

    corners: float64[T, 3, 4], homogeneous screen points (X, Y, w, z). The determinant of X, Y and w
    is twice the area on the screen times the product of all w. Its sign holds for what is in front
    of the eye, however a triangle is clipped.
    """
    (x0, y0, w0), (x1, y1, w1), (x2, y2, w2) = (corners[:, k, :3].T for k in range(3))
    return x0 * (y1 * w2 - y2 * w1) - y0 * (x1 * w2 - x2 * w1) + w0 * (x1 * y2 - x2 * y1)


def _frame(scene: Scene, eye: Reals, config: Config) -> tuple[Frame, ExactFrame]:
    """The picture in codes and before rounding, with registers and materials but without spans.

    eye: float64[3], unit vector to the eye in the light frame.
    """
    table, cp, d, weight, exponent = _materials(scene, config)
    background = np.floor(np.asarray(scene.background) * (2**config.colour_bits - 1) + 0.5)
    frame = Frame(
        scene.width,
        scene.height,
        half_vector_codes(eye, config),
        scene.toward_light,
        (int(background[0]), int(background[1]), int(background[2])),
        table,
        np.zeros(0, SPAN_DTYPE),
    )
    no_rows = np.zeros((0, 3))
    return frame, ExactFrame(no_rows, no_rows, eye, cp, d, weight, exponent)


def _triangles(
    scene: Scene,
    frame_axes: Reals,
    frame: Frame,
    exact: ExactFrame,
    config: Config,
    shade_vertices: VertexShader,
) -> tuple[Triangles, Flags]:
    """The triangles of the scene that are shown, projected to the screen, and which of them turn
    away from the light, bool[T].

    `Triangles.value` holds what is interpolated: for Phong's shading the normal in the light frame,
    float64[T, 3, 3]; else float64[T, 3, 6], the intensities of red, green, blue as the hardware
    computes them and then the exact ones. frame_axes: float64[3, 3], rows are the axes of the light
    frame in world coordinates. The normals of a two-sided triangle are reversed if they point away
    from the side that the eye sees.
    """
    meshes = [o.mesh for o in scene.objects]
    points = np.concatenate([m.vertices[m.faces] for m in meshes])
    corners = scene.camera.project(points, scene.width, scene.height)
    two_sided = _of_triangles(scene, "two_sided") | scene.two_sided | scene.toward_light
    face = np.concatenate([face_normals(m.vertices, m.faces) for m in meshes])
    if config.technique == "flat":
        normal = np.repeat(face[:, None], 3, axis=1)
    else:
        normal = np.concatenate([m.normals for m in meshes])
    value = normalize(apply_matrix(frame_axes, normal))
    light_side = apply_matrix(frame_axes, face)
    if two_sided.any() and not scene.toward_light:
        behind = two_sided & (_screen_side(corners) > 0)
        light_side[behind] = -light_side[behind]
        turned = two_sided & (np.sum(value * light_side[:, None], axis=(1, 2)) < 0)
        value[turned] = -value[turned]
    dark = light_side[:, 2] <= 0
    if scene.lit_faces_only:
        wrong = dark[:, None] & (value[..., 2] > 0)
        value[wrong] = np.broadcast_to(light_side[:, None], value.shape)[wrong]
    material = _of_triangles(scene, "material")
    if config.technique != "phong":
        both = shade_vertices(value.reshape(-1, 3), np.repeat(material, 3), frame, exact, config)
        value = np.concatenate(both, axis=-1).reshape(-1, 3, 6)
    # Clipping and culling carry the index of each triangle in place of its material.
    index = np.arange(len(points))
    corners, value, index = visibility.clip(corners, value, index, scene.camera.near)
    w = corners[..., 2]
    triangles = visibility.set_up(
        corners[..., 0] / w,
        corners[..., 1] / w,
        scene.camera.depth(w, corners[..., 3]),
        value,
        index,
        two_sided[index],
    )
    index, triangles.material = triangles.material, material[triangles.material]
    return triangles, dark[index]


def visible(triangles: Triangles, width: int, height: int) -> Iterator[tuple[Segments, float]]:
    """Yield the visible segments of a picture, one band of scan lines after the other from the top.

    width, height: of the picture, in pixels. The second item is the part of the picture done, 0 to
    1. A band holds at most `visibility.BLOCK_STRIPS` strips, which bounds the memory.
    """
    first, end = visibility.line_range(triangles, width, height)
    change = np.bincount(first, minlength=height + 1) - np.bincount(end, minlength=height + 1)
    strips = np.cumsum(change)[:height]  # on each line
    top = 0
    while top < height:
        room = int(np.count_nonzero(np.cumsum(strips[top:]) <= visibility.BLOCK_STRIPS))
        lines = min(room, visibility.BLOCK_PIXELS // width)
        bottom = min(top + max(lines, 1), height)
        here = np.flatnonzero((first < bottom) & (end > top))
        part = triangles.take(here)
        segments = visibility.cover(
            part, np.maximum(first[here], top), np.minimum(end[here], bottom), width
        )
        ends = (segments.left, segments.right - 1)
        depth = [_at_pixels(part, segments, x, part.depth[..., None])[:, 0] for x in ends]
        resolved = visibility.resolve(
            segments, np.stack(depth, axis=-1), part.tolerance[segments.triangle], width
        )
        resolved.triangle = here[resolved.triangle]
        yield resolved, bottom / height
        top = bottom


def _at_pixels(
    triangles: Triangles, segments: Segments, x: Ints, values: Reals, normalize_edges: bool = False
) -> Reals:
    """float64[n, C]: `values` (float64[T, 3, C]) at the centre of pixel `x` (int64[n]) of each of
    the n segments."""
    t = segments.triangle
    weights = scan_line_weights(
        triangles.x[t],
        triangles.y[t],
        x * GRID + GRID // 2,
        segments.y * GRID + GRID // 2,
    )
    return interpolate(values[t], weights, normalize_edges)


def _spans(
    triangles: Triangles, segments: Segments, config: Config, interpolation: str
) -> tuple[Spans, Reals, Reals]:
    """The spans SPAN_DTYPE[n] of `segments`, and their start and step before rounding,
    float64[n, 3] each.

    The step is the difference between the values at both ends of the segment, divided by the number
    of steps. Each value is a mean of the vertices' values with weights that are exact even in
    slivers; a gradient over the triangle's plane would not be.
    """
    ends = [
        _at_pixels(triangles, segments, x, triangles.value, interpolation == "normalized_edges")
        for x in (segments.left, segments.right - 1)
    ]
    length = segments.right - segments.left
    start, step = ends[0], (ends[1] - ends[0]) / np.maximum(length - 1, 1)[:, None]

    # No code holds a step of +2, from a normal to its opposite in one pixel. Such a segment becomes
    # spans of one pixel each.
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


def encode(start: Reals, step: Reals, length: ArrayLike, config: Config) -> tuple[Ints, Ints]:
    """Codes int64[n, 3] of `start` and of `step` (float64[n, 3] each) in `Config.normal`.

    length: int[n], pixels of each span. The step is limited so that the value at the last pixel,
    start + (length - 1) step, is a code of the format; rounding alone could carry the value out.
    The rounding of the step moves the last pixel by at most (length - 1)/2 LSB.
    """
    steps = np.maximum(np.asarray(length, np.int64) - 1, 1)[:, None]
    first, slope = config.normal.quantize(start), config.normal.quantize(step)
    lowest = -((first - config.normal.min) // steps)
    return first, np.clip(slope, lowest, (config.normal.max - first) // steps)


def _materials(scene: Scene, config: Config) -> tuple[MaterialTable, Reals, Reals, Reals, Reals]:
    """The material table in codes, and Cp, d, W and n of all its rows before rounding (shapes as
    in `ExactFrame`)."""
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
