"""The camera: from the scene to the screen, and from scene directions to the light frame.

Screen coordinates are continuous, in pixels: x to the right, y down, the centre of pixel (i, j)
at (i + 1/2, j + 1/2). The eye vector u is the camera's axis for shading in any case ("the eye is
also removed to infinity", Phong 1975); a perspective camera only moves vertices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from phong75.model.front.mesh import apply_matrix, normalize

#: Where the camera looks from by default: target towards eye, for pictures with z up.
DEFAULT_DIRECTION = (0.35, -1.0, 0.45)
DEFAULT_UP = (0.0, 0.0, 1.0)
DEFAULT_FOV = 30.0

#: The light of a scene without one, relative to the camera (x right, y up, z towards the eye):
#: over the observer's left shoulder.
DEFAULT_LIGHT = (-0.5, 0.6, 1.0)

#: Part of the picture that default framing fills.
FILL = 0.88

#: Distance of the near plane of a perspective camera, in units of eye to target.
NEAR = 1e-3


@dataclass(frozen=True)
class Camera:
    """projection: "orthographic" or "perspective". axes: float64[3, 3], unit rows right, up and
    back (from the target towards the eye) in the scene. target, eye: float64[3].
    height: extent of the picture from top to bottom at the target, scene units (orthographic).
    fov: angle from top to bottom, degrees (perspective). near: distance of the near plane from
    the eye, scene units (perspective).
    """

    projection: str
    axes: np.ndarray
    target: np.ndarray
    eye: np.ndarray
    height: float = 1.0
    fov: float = DEFAULT_FOV
    near: float = 0.0

    def project(self, points: np.ndarray, width: int, height: int) -> np.ndarray:
        """Scene points float64[..., 3] to homogeneous screen points float64[..., 4].

        Columns X, Y, w, z: screen x = X/w, screen y = Y/w in pixels of a picture of `width` by
        `height`; w is 1, or the distance from the eye along the axis in perspective; z is the
        coordinate towards the eye. `depth` makes depths of w and z.
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

    def depth(self, w: np.ndarray, z: np.ndarray) -> np.ndarray:
        """A depth that grows with the distance from the eye and is linear over a triangle on the
        screen: -z, or -1/w in perspective."""
        return -1.0 / w if self.projection == "perspective" else -z


def view_axes(back, up) -> np.ndarray | None:
    """float64[3, 3]: unit rows right, up, back for a camera whose axis towards the eye is `back`
    and whose picture has `up` upward; None if the two are parallel or one is zero."""
    back, up = normalize(np.asarray(back, float)), normalize(np.asarray(up, float))
    right = np.cross(up, back)
    if np.linalg.norm(right) < 1e-9:
        return None
    right = normalize(right)
    return np.stack([right, np.cross(back, right), back])


def fit_orthographic(points, axes, target, aspect: float) -> tuple[np.ndarray, float]:
    """Target and height of an orthographic picture that holds all `points` (float64[V, 3]).

    target: None, to centre the picture, or the point (float64[3]) to keep in the middle.
    aspect: width over height.
    """
    view = apply_matrix(axes, points)
    low, high = view.min(axis=0), view.max(axis=0)
    if target is None:
        centre = (low + high) / 2.0
        target = centre @ axes
    else:
        target = np.asarray(target, float)
        centre = axes @ target
    reach = np.maximum(high - centre, centre - low)
    height = 2.0 * max(reach[1], reach[0] / aspect) / FILL
    return target, height if height > 0 else 1.0


def fit_perspective(points, axes, target, aspect: float, fov: float):
    """Target and distance of the eye from it so that all `points` are in a perspective picture.

    Arguments as for `fit_orthographic`, fov in degrees; returns (float64[3], float).
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


def light_frame(light, eye) -> tuple[np.ndarray, np.ndarray]:
    """The paper's frame for shading: z towards the light, turned about z so that u_y = 0 <= u_x.

    light, eye: non-zero vectors in the scene towards the light and the eye (3 reals each).
    Returns float64[3, 3], the unit rows of the frame (it takes scene directions to the light
    frame), and the unit vector u there, float64[3]. If eye and light are parallel, any x axis
    serves; it is then made from the scene axis farthest from the light.
    """
    k, u = normalize(np.asarray(light, float)), normalize(np.asarray(eye, float))
    cosine = float(np.clip(k @ u, -1.0, 1.0))
    across = u - cosine * k
    if np.linalg.norm(across) < 1e-9:
        cosine = float(np.sign(cosine))
        axis = np.eye(3)[np.argmin(np.abs(k))]
        across = axis - (axis @ k) * k
    x = normalize(across)
    x = normalize(x - (x @ k) * k)
    frame = np.stack([x, np.cross(k, x), k])
    sine = np.sqrt(max(0.0, 1.0 - cosine * cosine))
    return frame, np.array([sine, 0.0, cosine])
