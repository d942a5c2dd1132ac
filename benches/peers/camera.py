"""A camera and its rays, in float64, by cellfan's conventions.

Pixel (x, y): x right, y down, sampled at its centre. The direction of a ray has view depth 1, so a segment between the depths
w0 and w1 has the length (w1 - w0) |direction|.
"""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Camera:
    """Perspective; `fov_degrees` is vertical."""

    eye: tuple
    target: tuple
    up: tuple
    fov_degrees: float
    width: int
    height: int

    @classmethod
    def framing(cls, bounds, azimuth_degrees, elevation_degrees, size_px):
        """The view of `cellfan render --view`: the sphere around the corners of the bounds just fits; +z is up.

        `bounds`: two rows, the least and the greatest coordinates.
        """
        low, high = np.asarray(bounds, float)
        center, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
        width, height = size_px
        half_angle = np.arctan(np.tan(np.radians(30) / 2) * min(1, width / height))
        a, e = np.radians([azimuth_degrees, elevation_degrees])
        outward = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        eye = center + outward * (radius / np.sin(half_angle))
        return cls(tuple(eye.tolist()), tuple(center.tolist()), (0.0, 0.0, 1.0), 30.0, width, height)

    def orbited(self, degrees):
        """The eye turned about the axis through the target along `up`, right-handed (Rodrigues)."""
        axis = np.array(self.up) / np.linalg.norm(self.up)
        v = np.array(self.eye) - self.target
        angle = np.radians(degrees)
        turned = v * np.cos(angle) + np.cross(axis, v) * np.sin(angle) + axis * (axis @ v) * (1 - np.cos(angle))
        return replace(self, eye=tuple((turned + self.target).tolist()))

    def as_json(self):
        """What `cellfan render --camera` reads."""
        return {
            "eye": self.eye,
            "target": self.target,
            "up": self.up,
            "fov": self.fov_degrees,
            "width": self.width,
            "height": self.height,
        }

    def axes(self):
        """Unit vectors right, up and forward, and a pixel's side at view depth 1."""
        forward = np.subtract(self.target, self.eye)
        forward /= np.linalg.norm(forward)
        right = np.cross(forward, self.up)
        right /= np.linalg.norm(right)
        pixel = 2 * np.tan(np.radians(self.fov_degrees) / 2) / self.height
        return right, np.cross(right, forward), forward, pixel

    def direction(self, x, y):
        """The ray through the centre of pixel (x, y), of view depth 1."""
        right, up, forward, pixel = self.axes()
        return forward + right * (pixel * (x + 0.5 - self.width / 2)) - up * (pixel * (y + 0.5 - self.height / 2))

    def pixels(self, points):
        """Positions (x, y) of points in the picture, pixel centres at whole numbers; all must lie before the eye."""
        right, up, forward, pixel = self.axes()
        v = points - np.array(self.eye)
        depth = v @ forward
        if depth.min(initial=np.inf) <= 0:
            raise ValueError("the eye is inside the mesh; the reference needs all of it before the eye")
        scale = 1 / (pixel * depth)
        return np.stack([v @ right * scale + self.width / 2 - 0.5, v @ up * -scale + self.height / 2 - 0.5], axis=1)
