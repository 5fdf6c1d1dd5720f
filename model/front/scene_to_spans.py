# SPDX-License-Identifier: MIT
"""The front end: from a scene to the spans, registers and material table of one picture.

The camera projects the triangles of the scene's objects (`camera`). Hidden surfaces are removed per
scan line, which leaves visible segments (`visibility`). Each segment becomes a span: the normal at
its first pixel and the step from pixel to pixel (`interpolation`), in the light frame. With several
lights, the same vectors are also turned into the frame of each further light. The frame of a light
at a place changes along a span, which `phong75.model.places` approximates; a span along which the
direction to such a light turns too far is cut.

If the scene asks for quadratic normals, the triangles have normals in the middle of their edges as
well (`mid_edge_normals`), and a span has a bend: how much its step grows from pixel to pixel.

For Gouraud and flat shading a span carries intensities instead of normals: those of the vertices,
or that of the face. The front end does not know how the hardware shades a vertex; the caller of
`make_frame` passes a `VertexShader`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from phong75.model import places
from phong75.model.arrays import ArrayLike, Flags, Ints, Reals, Spans
from phong75.model.config import MAX_JUMPS, Config
from phong75.model.frame import (
    SPAN_DTYPE,
    ExactFrame,
    ExactLight,
    Frame,
    FurtherLight,
    InputError,
    MaterialTable,
    depth_codes,
    distance_range,
    falloff_codes,
    half_angle_codes,
    half_vector_codes,
)
from phong75.model.front import visibility
from phong75.model.front.camera import light_frame
from phong75.model.front.interpolation import (
    interpolate,
    interpolate_quadratic,
    quadratic,
    scan_line_weights,
)
from phong75.model.front.mesh import Mesh, apply_matrix, face_normals, normalize
from phong75.model.front.mid_edge_normals import RULES, mid_edge_normals
from phong75.model.front.scene import WHITE, Light, Material, Scene
from phong75.model.front.visibility import GRID, Segments, Triangles
from phong75.model.places import Place
from phong75.model.reflectance import (
    Curve,
    Polyline,
    Power,
    curve_distance,
    curve_words,
    jump_count,
    power_words,
    weight_distance,
    weight_points,
)
from phong75.model.spans import bent_beyond

#: Columns of what is interpolated over a triangle: the normal; the exact intensities, in its place;
#: the point (p/w, 1/w), and the centre of the face.
NORMAL, INTENSITIES, POINT, CENTRE = slice(0, 3), slice(3, 6), slice(3, 7), slice(7, 10)


class VertexShader(Protocol):
    """Gives the intensities that Gouraud and flat shading interpolate or hold."""

    def __call__(
        self, normal: Reals, material: Ints, frame: Frame, exact: ExactFrame, config: Config,
        points: Reals,
    ) -> tuple[Reals, Reals]:  # fmt: skip
        """S of red, green and blue, float64[n, 3], twice: as the hardware of `config` computes S,
        and by eq. (3) of the paper before any rounding.

        normal: float64[n, 3], unit vectors in the light frame. material: int64[n], rows of the
        material table. frame, exact: registers and materials in codes and before rounding. points:
        float64[n, 3], where the vertices or faces are, in the axes of `exact.places`.
        """
        ...


@dataclass(repr=False)
class FrontEnd:
    """What the front end makes of a scene.

    frame: the picture in codes. exact: the same picture before rounding. triangles: number of
    triangles in the scene. degenerate_triangles: number of further triangles that were left out
    because they have no area. lit_facing_away: pixels that are lit although their triangle turns
    away from the light, an effect of interpolated normals; None where they are not counted: with
    several lights or one at a place, quadratic normals, intensities, or `Scene.toward_light`.
    empty: why there is no pixel, in words; None if there is one. notes: what the tables of the
    materials do not hold as the scene has it, a line each.
    """

    frame: Frame
    exact: ExactFrame
    triangles: int
    degenerate_triangles: int
    lit_facing_away: int | None = None
    empty: str | None = None
    notes: list[str] = field(default_factory=list)

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
    if scene.interpolation in RULES and config.spans_carry_squares:
        raise InputError(
            f"{scene.name}: interpolation = {scene.interpolation} is for normals, which the spans "
            f"of {config.name} do not carry"
        )
    if scene.interpolation in RULES and len(scene.lights) > 1:
        raise InputError(
            f"{scene.name}: interpolation = {scene.interpolation} is for one light, "
            f"there are {len(scene.lights)}"
        )
    sources = [light.place.source for light in scene.lights]
    if scene.interpolation in RULES and any(source is not None for source in sources):
        raise InputError(
            f"{scene.name}: interpolation = {scene.interpolation} is for a light with a direction, "
            "not for one with a position"
        )
    at_place = any(light.place.position is not None for light in scene.lights)
    if scene.lit_faces_only and (len(scene.lights) > 1 or scene.interpolation in RULES):
        raise InputError(
            f"{scene.name}: lit_faces_only is for one light and normals without mid-edge normals"
        )
    if scene.lit_faces_only and at_place:
        raise InputError(f"{scene.name}: lit_faces_only is for a light at infinity")
    if scene.interpolation == "quadratic_exact":
        for item in scene.objects:
            if item.mesh.surface is None:
                raise InputError(
                    f"{scene.name}: interpolation = quadratic_exact needs the surface behind "
                    f"{item.name}, which is not known; quadratic does without"
                )
    if config.channels == 1 and _coloured(scene):
        raise InputError(f"{scene.name}: has colours, but the pipeline is built for grey")
    frame_axes, eye = light_frame(scene.light, scene.camera.axes[2])
    frame, exact, notes = _frame(scene, eye, config)
    if any(light.place.source is not None for light in scene.lights):
        exact.places = [light.place.turned(frame_axes) for light in scene.lights]
    _add_lights(scene, frame_axes, frame, exact, config)
    triangles, dark = _triangles(scene, frame_axes, frame, exact, config, shade_vertices)
    if config.technique != "phong":  # the intensities hold all lights
        frame.further, exact.further, exact.places = [], [], []

    counted = (
        config.technique == "phong" and not scene.toward_light
        and len(scene.lights) == 1 and not at_place and scene.interpolation not in RULES
    )  # fmt: skip
    parts, lit_facing_away = [], 0 if counted else None
    for segments, done in visible(triangles, scene.width, scene.height):
        if len(segments):
            parts.append(_spans(triangles, segments, config, scene.interpolation, exact))
            if lit_facing_away is not None and dark.any():
                lit_facing_away += _lit_pixels(parts[-1][0], segments, dark, scene.width)
        if progress:
            progress(done)
    centre = np.zeros((0, 3))
    if parts:
        frame.spans, start, step, bend = map(np.concatenate, zip(*parts, strict=True))
        frame.spans["last"][-1] = True
        at = INTENSITIES if config.technique != "phong" else NORMAL
        exact.start, exact.step, exact.bend = start[:, at], step[:, at], bend[:, at]
        if exact.places:
            exact.point, exact.point_step = start[:, POINT], step[:, POINT]
            centre = start[:, CENTRE]
    _add_spans(frame, exact, centre, config)
    meshes = [o.mesh for o in scene.objects]
    return FrontEnd(
        frame,
        exact,
        sum(len(m.faces) for m in meshes),
        sum(m.degenerate for m in meshes),
        lit_facing_away,
        None if parts else _why_empty(scene),
        notes,
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


def _add_spans(frame: Frame, exact: ExactFrame, centre: Reals, config: Config) -> None:
    """Give each light of `frame` its start and step, and what a light at a place needs beside them.

    centre: float64[n, 3], of the face of each span.
    """
    spans, here = frame.spans, exact.places or [Place()] * frame.lights
    steps = np.maximum(spans["length"].astype(np.int64) - 1, 0)[:, None]
    first = middle = last = np.zeros((len(spans), 3))
    if len(exact.point):
        along = [exact.point + part * steps * exact.point_step for part in (0.0, 0.5, 1.0)]
        first, middle, last = (p[:, :3] / p[:, 3:] for p in along)
    normals = exact.start, exact.start + steps * exact.step
    placed = any(place.position is not None for place in here)
    falls = any(place.falloff for place in here)
    half_vectors = np.zeros((len(here), len(spans), 2), np.int64)
    depths, falloff = np.zeros_like(half_vectors), []
    for number, place in enumerate(here):
        if place.position is not None:
            start, end, angle = places.span_ends(
                place, exact.eye, (first, middle, last, centre), normals
            )
            slope = (end - start) / np.maximum(steps, 1)
            codes = encode(start, slope, spans["length"], config)
            half_vectors[number] = half_angle_codes(angle, config)
        else:
            turn = exact.further[number - 1].turn if number else np.eye(3)
            codes = encode(exact.start @ turn.T, exact.step @ turn.T, spans["length"], config)
            half_vectors[number] = frame.light(number, config).half_vector
        if number:
            frame.further[number - 1].start, frame.further[number - 1].step = codes
        elif place.position is not None:
            spans["start"], spans["step"] = codes
        begin, end = (place.distance(p, exact.eye) for p in (first, last))
        low, high = distance_range([begin, end], place.falloff)
        depths[number] = depth_codes(begin, end, steps[:, 0], low, high, config)
        falloff.append(falloff_codes(place.falloff, low, high, config))
    if placed:
        frame.half_vectors = half_vectors
    if falls:
        frame.depths, frame.falloff = depths, np.stack(falloff)


def _frame(scene: Scene, eye: Reals, config: Config) -> tuple[Frame, ExactFrame, list[str]]:
    """The picture in codes and before rounding, with registers and materials but without spans;
    and the notes on the materials (see `FrontEnd`).

    eye: float64[3], unit vector to the eye in the light frame.
    """
    table, ambient, weight, curve, notes = _materials(scene, config)
    diffuse, highlight = _colours(scene, scene.lights[0], table, config)
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
    exact = ExactFrame(no_rows, no_rows, no_rows, eye, ambient, diffuse, highlight, weight, curve)
    return frame, exact, notes


def _coloured(scene: Scene) -> bool:
    """Whether red, green and blue may differ: in a material or a light of `scene`."""
    colours = [scene.ambient]
    for m in scene.materials:
        colours += [tuple(m.ka), tuple(m.kd), tuple(m.ks), m.emission]
    for light in scene.lights:
        colours += [light.ambient, light.diffuse, light.specular]
    return any(len(set(colour)) > 1 for colour in colours)


def _add_lights(
    scene: Scene, frame_axes: Reals, frame: Frame, exact: ExactFrame, config: Config
) -> None:
    """Add the lights of `scene` beside the first, without spans, to `frame` and `exact`.

    frame_axes: float64[3, 3], rows are the axes of the first light's frame in world coordinates.
    """
    for light in scene.lights[1:]:
        axes, eye = light_frame(light.direction, scene.camera.axes[2])
        table = MaterialTable.empty(config)
        diffuse, highlight = _colours(scene, light, table, config)
        codes = table.highlight
        if codes is None:
            codes = np.full_like(table.diffuse, config.coefficient.one)
        none = np.zeros((0, 3), np.int64)
        half_vector = half_vector_codes(eye, config)
        frame.further.append(FurtherLight(half_vector, none, none, table.diffuse, codes))
        exact.further.append(ExactLight(axes @ frame_axes.T, eye, diffuse, highlight))


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
    float64[T, 3, 3], or for quadratic normals float64[T, 3, 6], the normals at a corner and in the
    middle of the opposite edge; else float64[T, 3, 6], the intensities of red, green, blue as the
    hardware computes them and then the exact ones. With `exact.places` a linear normal is followed
    by the point (p/w, 1/w) and by the centre of the face. frame_axes: float64[3, 3], rows are the
    axes of the light frame in world coordinates. The normals of a two-sided triangle are reversed
    if they point away from the side that the eye sees.
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
    turned = np.zeros(len(points), bool)
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
    place = apply_matrix(frame_axes, points)
    centre = np.repeat(place.mean(axis=1, keepdims=True), 3, axis=1)
    if config.technique != "phong":
        seen = place
        if config.technique == "flat":
            seen = centre if scene.flat_point == "centre" else np.repeat(place[:, :1], 3, axis=1)
        both = shade_vertices(
            value.reshape(-1, 3), np.repeat(material, 3), frame, exact, config, seen.reshape(-1, 3)
        )
        value = np.concatenate(both, axis=-1).reshape(-1, 3, 6)
    elif exact.places:
        value = np.concatenate([value, place, np.ones_like(value[..., :1]), centre], axis=-1)
    # Clipping and culling carry the index of each triangle in place of its material.
    index = np.arange(len(points))
    if scene.interpolation in RULES:
        middle = np.concatenate([_mid_edge_normals(scene, m) for m in meshes])
        middle = apply_matrix(frame_axes, np.where(turned[:, None, None], -middle, middle))
        value = np.concatenate([value, middle], axis=-1)
        corners, value, index = _clip_quadratic(corners, value, index, scene.camera.near)
    else:
        corners, value, index = visibility.clip(corners, value, index, scene.camera.near)
    w = corners[..., 2]
    if exact.places and config.technique == "phong":
        value[..., POINT] /= w[..., None]
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


def _mid_edge_normals(scene: Scene, mesh: Mesh) -> Reals:
    """Normals in the middle of the edges opposite the corners of `mesh`, float64[F, 3, 3]."""
    start = mesh.vertices[mesh.faces]
    middle = (start + np.roll(start, -1, axis=1)) / 2
    camera = scene.camera
    back = np.broadcast_to(camera.axes[2], middle.shape)
    if camera.projection == "perspective":
        back = normalize(camera.eye - middle)
    return np.roll(mid_edge_normals(mesh, scene.interpolation, back), -1, axis=1)


def _clip_quadratic(
    corners: Reals, value: Reals, material: Ints, near: float
) -> tuple[Reals, Reals, Ints]:
    """`visibility.clip` for triangles whose `value` (float64[T, 3, 2 C]) is quadratic in space.

    What remains is quadratic on the screen, and has the values in space at its corners and at the
    points that are seen in the middle of its edges. Without perspective, both are the same.
    """
    count = value.shape[2] // 2
    shares = np.broadcast_to(np.eye(3), (len(corners), 3, 3))
    corners, shares, source = visibility.clip(corners, shares, np.arange(len(corners)), near)
    part = shares / corners[..., 2:3]  # barycentric coordinates, weighted as they are seen
    ahead, behind = np.roll(part, -1, axis=1), np.roll(part, -2, axis=1)
    opposite = (ahead + behind) / (ahead + behind).sum(axis=-1, keepdims=True)
    of = value[source]
    nodes = [
        quadratic(of[..., :count], of[..., count:], place[:, k])
        for place in (shares, opposite)
        for k in range(3)
    ]
    value = np.concatenate([np.stack(nodes[:3], axis=1), np.stack(nodes[3:], axis=1)], axis=-1)
    return corners, value, material[source]


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
    triangles: Triangles, segments: Segments, x: Ints, values: Reals, interpolation: str = "linear"
) -> Reals:
    """float64[n, C]: `values` (float64[T, 3, C]) at the centre of pixel `x` (int64[n]) of each of
    the n segments."""
    return _at(triangles, segments, x * GRID + GRID // 2, values, interpolation)


def _at(
    triangles: Triangles, segments: Segments, x: Ints, values: Reals, interpolation: str
) -> Reals:
    """As `_at_pixels`, at `x` (int64[n]) in units of 1/GRID pixel; for one of RULES, float64[n, C]
    of `values` (float64[T, 3, 2 C])."""
    t = segments.triangle
    weights = scan_line_weights(triangles.x[t], triangles.y[t], x, segments.y * GRID + GRID // 2)
    if interpolation in RULES:
        return interpolate_quadratic(values[t], weights)
    return interpolate(values[t], weights, interpolation == "normalized_edges")


def _spans(
    triangles: Triangles, segments: Segments, config: Config, interpolation: str, exact: ExactFrame
) -> tuple[Spans, Reals, Reals, Reals]:
    """The spans SPAN_DTYPE[n] of `segments`, and the start, step and bend of what is interpolated
    before rounding, float64[n, C] each.

    The step is the difference between the values at both ends of the segment, divided by the number
    of steps. Each value is a mean of the vertices' values with weights that are exact even in
    slivers; a gradient over the triangle's plane would not be. Quadratic normals are parabolas
    along the segment: that through the values at both ends and in the middle between them.
    """
    rule = "linear" if interpolation == "normalized_edges" else interpolation
    ends = []
    for x in (segments.left, segments.right - 1):
        end = _at_pixels(triangles, segments, x, triangles.value, rule)
        if rule != interpolation:  # only normals are normalized, not the points beside them
            normal = triangles.value[..., NORMAL]
            end[:, NORMAL] = _at_pixels(triangles, segments, x, normal, interpolation)
        ends.append(end)
    length = segments.right - segments.left
    start, step = ends[0], (ends[1] - ends[0]) / np.maximum(length - 1, 1)[:, None]
    bend = np.zeros_like(step)
    if interpolation in RULES:
        centre = (segments.left + segments.right) * GRID // 2
        middle = _at(triangles, segments, centre, triangles.value, interpolation)
        bend, step = _parabola(ends[0], middle, ends[1], length)

    # No code holds a step of +2, from a normal to its opposite in one pixel. Such a segment becomes
    # spans of one pixel each. So does a segment with such a bend, or one whose codes leave a format
    # between its pixels.
    rounded = np.floor(np.ldexp(step[:, :3], config.normal.fraction) + 0.5)
    single = ~np.all(config.normal.contains(rounded), axis=1)
    if interpolation in RULES:
        rounded = np.floor(np.ldexp(bend, config.bend.fraction) + 0.5)
        single |= ~np.all(config.bend.contains(rounded), axis=1)
        whole = np.zeros(len(length), SPAN_DTYPE)
        whole["length"] = length
        whole["start"], whole["step"], whole["bend"] = _codes(start, step, bend, config)
        single |= bent_beyond(whole, config)
    row, first, count = _cut(
        np.arange(len(length)), np.zeros_like(length), length, np.where(single, length, 1)
    )
    row, first, count = _cut_by_turn(row, first, count, start, step, exact)
    growth = (first * (first - 1) / 2)[:, None]
    start = start[row] + first[:, None] * step[row] + growth * bend[row]
    step, bend = (np.where(single[row, None], 0.0, word[row]) for word in (step, bend))

    spans = np.zeros(len(row), SPAN_DTYPE)
    spans["x"] = segments.left[row] + first
    spans["y"] = segments.y[row]
    spans["length"] = count
    spans["material"] = triangles.material[segments.triangle[row]]
    if interpolation in RULES:
        spans["start"], spans["step"], spans["bend"] = _codes(start, step, bend, config)
    else:
        spans["start"], spans["step"] = encode(start[:, :3], step[:, :3], spans["length"], config)
    return spans, start, step, bend


def _codes(start: Reals, step: Reals, bend: Reals, config: Config) -> tuple[Ints, Ints, Ints]:
    """Codes int64[n, 3] of start and step in `Config.normal`, and of bend in `Config.bend`.

    At pixel k the rounding moves the normal by at most (1 + k + 2**-12 k (k - 1)/2)/2 LSB of
    `normal`, where 2**-12 LSB of `normal` are one of `bend`: half an LSB for each of the three
    words, times what the word counts there.
    """
    normal = config.normal
    return normal.quantize(start), normal.quantize(step), config.bend.quantize(bend)


def _parabola(first: Reals, middle: Reals, last: Reals, length: Ints) -> tuple[Reals, Reals]:
    """Bend and step, float64[n, 3] each, of segments of `length` pixels (int64[n]).

    first, last: values at the centres of the first and of the last pixel. middle: in the middle
    between them. The bend is the second difference from pixel to pixel, the step the first one. A
    segment of one or two pixels has no bend.
    """
    steps = np.maximum(length - 1, 1)[:, None]
    bend = np.where(length[:, None] > 2, 4 * (first - 2 * middle + last) / steps**2, 0.0)
    return bend, (last - first) / steps - (steps - 1) / 2 * bend


def _cut(row: Ints, first: Ints, count: Ints, pieces: Ints) -> tuple[Ints, Ints, Ints]:
    """Cut runs of pixels into `pieces` each, int64[n], of lengths that differ by 1 at most.

    A run is a part of the segment `row`, from its pixel `first` on, and `count` pixels long. The
    same three arrays of the pieces are returned.
    """
    run = np.repeat(np.arange(len(row)), pieces)
    piece = np.arange(len(run)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    begin = count[run] * piece // pieces[run]
    end = count[run] * (piece + 1) // pieces[run]
    return row[run], first[run] + begin, end - begin


def _cut_by_turn(
    row: Ints, first: Ints, count: Ints, start: Reals, step: Reals, exact: ExactFrame
) -> tuple[Ints, Ints, Ints]:
    """Cut runs (see `_cut`) until the direction to a light at a place, or to the point from which a
    distance is measured, turns by at most `Place.most_turn` along a run, or the run is one pixel.
    The rule `face` needs no cut.

    start, step: float64[s, C], of what is interpolated along the segments.
    """
    near = [
        place for place in exact.places
        if (place.position is not None and place.rule != "face")
        or (place.position is None and place.falloff and not place.along)
    ]  # fmt: skip
    while near:
        pieces = np.ones_like(count)
        ends = [
            start[row, POINT] + at[:, None] * step[row, POINT] for at in (first, first + count - 1)
        ]
        begin, end = (p[:, :3] / p[:, 3:] for p in ends)
        for place in near:
            assert place.source is not None
            turn = places.turn(place.source, begin, end, exact.eye)
            pieces = np.maximum(pieces, np.ceil(turn / place.most_turn).astype(np.int64))
        pieces = np.minimum(pieces, count)
        if (pieces == 1).all():
            break
        row, first, count = _cut(row, first, count, pieces)
    return row, first, count


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


def _materials(
    scene: Scene, config: Config
) -> tuple[MaterialTable, Reals, list[Curve], list[Curve], list[str]]:
    """The material table in codes without colours of the lights; the ambient part, W and the curve
    of cos(s) of all its rows before rounding (as in `ExactFrame`); and notes (see `FrontEnd`).

    Raises InputError if an ambient part does not fit its word.
    """
    table = MaterialTable.empty(config)
    ambient = np.zeros((config.materials, 3))
    weight: list[Curve] = [Polyline((0.0, 1.0), (0.0, 0.0))] * config.materials
    curve: list[Curve] = [Power(1.0)] * config.materials
    notes = []
    if any(material.needs_curve for material in scene.materials):
        table.curve = power_words(table.exponent, config)
        table.curve_jumps = np.zeros((config.materials, MAX_JUMPS, 3), np.int64)
    for i, material in enumerate(scene.materials):
        light = np.sum([scene.ambient, *(light.ambient for light in scene.lights)], axis=0)
        ambient[i] = material.emission + material.ka * light
        weight[i], curve[i] = material.weight_curve, material.highlight
        table.ambient[i] = _coefficients(
            ambient[i], f"ambient light of material {i}", scene, config
        )
        n = 1.0 if material.curve else material.n
        table.exponent[i] = config.exponent.quantize(n)
        notes += _reflectance(material, i, table, config)
    return table, ambient, weight, curve, notes


#: A table that is farther than this from the scene's W or curve gets a note, LSB.
NOTED_LSB = 0.1


def _reflectance(material: Material, i: int, table: MaterialTable, config: Config) -> list[str]:
    """Set W of material `i` and, if `table` has curves, its curve of cos(s); returns notes."""
    notes, white = [], config.white
    points, jumps, smeared = weight_points(material.weight_curve, config)
    table.weight[i] = points
    if jump_count(jumps):
        if table.weight_jumps is None:
            table.weight_jumps = np.zeros((config.materials, MAX_JUMPS, 3), np.int64)
        table.weight_jumps[i] = jumps
    apart = white * weight_distance(material.weight_curve, points, jumps, config)
    if apart > NOTED_LSB:
        many = f", of which {MAX_JUMPS} of {len(smeared) + MAX_JUMPS} jumps" if smeared else ""
        notes.append(
            f"material {i}: {config.weight_points} points{many} hold W; up to {apart:.1f} LSB from "
            "the scene's W"
        )
    if table.curve is None or table.curve_jumps is None:
        return notes
    if material.curve is None and material.n < 1:
        notes.append(f"material {i}: n = {material.n:g} is below 1: a curve's table gives cos(s)^n")
    words, jumps, moved = curve_words(material.highlight, config)
    table.curve[i], table.curve_jumps[i] = words, jumps
    apart = white * curve_distance(material.highlight, words, jumps, config)
    if moved or apart > NOTED_LSB:
        jumps_at = ", ".join(f"{jump.place:g}" for jump in moved)
        where = f", the jumps at {jumps_at} at the end of a line" if moved else ""
        notes.append(
            f"material {i}: {len(words)} lines hold the curve of cos(s){where}; up to {apart:.1f} "
            "LSB from the scene's curve"
        )
    return notes


def _colours(
    scene: Scene, light: Light, table: MaterialTable, config: Config
) -> tuple[Reals, Reals]:
    """Set `diffuse` and `highlight` of `table` to kd Ld and ks Ls of `light`; returns both before
    rounding, float64[M, 3] each. `highlight` stays None where `MaterialTable` says so.

    By the paper's rule Cp d and Cp (1 - d) are rounded so that their sum is Cp in codes. Raises
    InputError if a product does not fit its word.
    """
    diffuse, highlight = np.zeros((config.materials, 3)), np.ones((config.materials, 3))
    codes = np.full((config.materials, 3), config.coefficient.one)
    for i, material in enumerate(scene.materials):
        what = f"of light `{light.name}` on material {i}"
        diffuse[i] = material.kd * light.diffuse
        highlight[i] = material.ks * light.specular
        codes[i] = _coefficients(highlight[i], f"highlight {what}", scene, config)
        if material.diffuse is None and light.diffuse == WHITE:
            cp = np.asarray(material.color)
            table.diffuse[i] = config.coefficient.quantize(cp)
            table.diffuse[i] -= config.coefficient.quantize(cp * material.d)
        else:
            table.diffuse[i] = _coefficients(diffuse[i], f"diffuse light {what}", scene, config)
    one = config.coefficient.one
    if (codes != one).any() or (table.ambient + table.diffuse > one).any():
        table.highlight = codes
    return diffuse, highlight


def _coefficients(values: Reals, what: str, scene: Scene, config: Config) -> Ints:
    """`values` (float64[3]) in `coefficient`. Raises InputError if one is beyond the word; what:
    names them in the message."""
    codes = np.floor(np.ldexp(values, config.coefficient.fraction) + 0.5).astype(np.int64)
    if not config.coefficient.contains(codes).all():
        most = config.coefficient.real(config.coefficient.max)
        raise InputError(f"{scene.name}: {what}: {max(values):g} is above {most:g}")
    return codes
