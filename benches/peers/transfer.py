"""The transfer function: control points (value, r, g, b, extinction per world unit), linear between them, clamped outside."""

import json

import numpy as np

# That of docs/performance.md: emission-absorption over the values 0 to 1 of the generated fields.
POINTS = np.array([
    [0.0, 0.1, 0.2, 0.8, 0.2],
    [0.5, 0.9, 0.9, 0.9, 1.0],
    [1.0, 0.8, 0.1, 0.1, 6.0],
])


class TransferFunction:
    """Colour and extinction of scalar values, in float64."""

    def __init__(self, points=POINTS):
        self.points = np.asarray(points, float)
        self.values = self.points[:, 0]
        if (np.diff(self.values) <= 0).any():
            raise ValueError("the values of a transfer function must ascend")

    def evaluate(self, s):
        """Red, green, blue and extinction, on a last axis."""
        return np.stack([np.interp(s, self.values, channel) for channel in self.points.T[1:]], axis=-1)

    def max_extinction(self):
        """The largest extinction per world unit."""
        return self.points[:, 4].max()

    def save(self, path):
        """Writes what `cellfan render --transfer` reads."""
        points = [{"value": p[0], "color": list(p[1:4]), "extinction": p[4]} for p in self.points.tolist()]
        path.write_text(json.dumps({"points": points}, indent=1) + "\n")
