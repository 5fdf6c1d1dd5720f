# SPDX-License-Identifier: MIT
"""Camera: projects scene points to the screen and turns scene directions into the light frame.

Screen coordinates are continuous and in pixels: x grows to the right, y grows downward, and the
centre of pixel (i, j) is at (i + 1/2, j + 1/2). The eye vector u of the shading is always the
camera's axis ("the eye is also removed to infinity", Phong 1975). A perspective camera changes
only the positions of the vertices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.arrays import ArrayLike, Reals
from phong75.model.front.mesh import apply_matrix, normalize

#: Default direction from the target towards the eye, for scenes whose z axis points up.
DEFAULT_DIRECTION = (0.35, -1.0, 0.45)
DEFAULT_UP = (0.0, 0.0, 1.0)
DEFAULT_FOV = 30.0

#: Default direction towards the light in camera axes (x right, y up, z towards the eye): over the
#: observer's left shoulder.
DEFAULT_LIGHT = (-0.5, 0.6, 1.0)

#: Fraction of the picture's width or height that default framing fills.
FILL = 0.88

#: Default distance of a perspective camera's near plane, as a fraction of the distance from eye to
#: target.
NEAR = 1e-3


@dataclass(frozen=True)
class Camera:
    """An orthographic or perspective camera.

    projection: "orthographic" or "perspective".
    axes: float64[3, 3], rows are the unit vectors right, up and back in scene axes; back points
    from the target towards the eye.
    target, eye: float64[3], scene points.
    height: height of the picture at the target, scene units (orthographic only).
    fov: vertical field of view, degrees (perspective only).
    near: distance from the eye to the near plane, scene units (perspective only).
    """

    projection: str
    axes: Reals
    target: Reals
    eye: Reals
    height: float = 1.0
    fov: float = DEFAULT_FOV
    near: float = 0.0

    def project(self, points: Reals, width: int, height: int) -> Reals:
        """Project scene points float64[..., 3] to homogeneous screen points float64[..., 4].

        The columns are X, Y, w, z. Screen x = X/w and screen y = Y/w, in pixels of a picture of
        `width` by `height` pixels. w is 1 (orthographic) or the distance from the eye along the
        camera's axis (perspective). z is the coordinate towards the eye. `depth` computes the
        depth from w and z.
        """
        perspective = self.projection == "perspective"
        origin = self.eye if perspective else self.target
        view = apply_matrix(self.axes, points - origin)
        x, y, z = view[..., 0], view[..., 1], view[..., 2]
        if perspective:
            w = -z
            scale = height / 2.0 / np.tan(np.radians(self.fov) / 2.0)
        else:
            w = np.ones_like(z)
            scale = height / self.height
        return np.stack([width / 2.0 * w + scale * x, height / 2.0 * w - scale * y, w, z], axis=-1)

    def depth(self, w: Reals, z: Reals) -> Reals:
        """Depth of points: -z (orthographic) or -1/w (perspective); same shape as w and z.

        The depth grows with the distance from the eye and is linear in screen x and y over a
        triangle.
        """
        return -1.0 / w if self.projection == "perspective" else -z


def view_axes(back: ArrayLike, up: ArrayLike) -> Reals | None:
    """Camera axes float64[3, 3]: unit rows right, up, back.

    back: vector from the target towards the eye. up: vector that points upward in the picture.
    Returns None if the two are parallel or one of them is zero.
    """
    back, up = normalize(np.asarray(back, float)), normalize(np.asarray(up, float))
    right = np.cross(up, back)
    if np.linalg.norm(right) < 1e-9:
        return None
    right = normalize(right)
    return np.stack([right, np.cross(back, right), back])


def fit_orthographic(
    points: Reals, axes: Reals, target: ArrayLike | None, aspect: float
) -> tuple[Reals, float]:
    """Target (float64[3]) and height (scene units) of an orthographic picture of all `points`.

    points: float64[V, 3]. axes: see `Camera`. target: the point in the middle of the picture
    (float64[3]), or None to centre the picture on the points. aspect: width / height.
    """
    view = apply_matrix(axes, points)
    low, high = view.min(axis=0), view.max(axis=0)
    if target is None:
        centre = (low + high) / 2.0
        middle = centre @ axes
    else:
        middle = np.asarray(target, float)
        centre = axes @ middle
    reach = np.maximum(high - centre, centre - low)
    height = 2.0 * max(reach[1], reach[0] / aspect) / FILL
    return middle, height if height > 0 else 1.0


def fit_perspective(
    points: Reals, axes: Reals, target: ArrayLike | None, aspect: float, fov: float
) -> tuple[Reals, float]:
    """Target (float64[3]) and distance from eye to target of a perspective picture of all `points`.

    fov: vertical field of view, degrees. The other arguments are those of `fit_orthographic`.
    """
    view = apply_matrix(axes, points)
    low, high = view.min(axis=0), view.max(axis=0)
    if target is None:
        target = (low + high) / 2.0 @ axes
    target = np.asarray(target, float)
    x, y, z = np.moveaxis(view - axes @ target, -1, 0)
    slope = np.tan(np.radians(fov) / 2.0) * FILL
    distance = float(np.max(z + np.maximum(np.abs(y), np.abs(x) / aspect) / slope))
    size = float(np.max(high - low)) or 1.0
    return target, max(distance, 1e-3 * size)


def light_frame(light: ArrayLike, eye: ArrayLike) -> tuple[Reals, Reals]:
    """Light frame of the paper (Phong 1975): z points towards the light, u_y = 0 and u_x >= 0.

    light, eye: non-zero scene vectors towards the light and the eye (3 reals each).
    Returns (axes, u). axes: float64[3, 3], unit rows; the product axes @ v takes a scene direction
    v to the light frame. u: float64[3], the unit eye vector in the light frame. If eye and light
    are parallel, every x axis satisfies u_y = 0; x is then derived from the scene axis farthest
    from the light.
    """
    k, u = normalize(np.asarray(light, float)), normalize(np.asarray(eye, float))
    cosine = float(np.clip(k @ u, -1.0, 1.0))
    perpendicular = u - cosine * k
    if np.linalg.norm(perpendicular) < 1e-9:
        cosine = float(np.sign(cosine))
        axis = np.eye(3)[np.argmin(np.abs(k))]
        perpendicular = axis - (axis @ k) * k
    x = normalize(perpendicular)
    x = normalize(x - (x @ k) * k)
    frame = np.stack([x, np.cross(k, x), k])
    sine = np.sqrt(max(0.0, 1.0 - cosine * cosine))
    return frame, np.array([sine, 0.0, cosine])
