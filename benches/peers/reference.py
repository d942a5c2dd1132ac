"""The float64 reference: every cell that a ray meets, no order assumed, no acceleration but boxes of pixels.

Two fields inside a cell. `Tetrahedra`: linear, what both programs draw. `Hexahedra`, whole as cellfan draws them: linear on each of
the two triangles of a face (cut from its corner of lowest number) and linear along the ray between entry and exit.
"""

import numpy as np

from integral import composite

# Opposite to each vertex.
TETRAHEDRON_FACES = [(1, 2, 3), (0, 2, 3), (0, 1, 3), (0, 1, 2)]
HEXAHEDRON_FACES = [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
CHUNK = 1 << 20


class Cells:
    """Cells of one kind with a value at each point: `points` n × 3, `cells` m × corners, `values` n."""

    def __init__(self, points, cells, values):
        self.points, self.cells, self.values = points, cells, values

    def boxes(self, camera):
        """The least and greatest pixel positions of each cell, four columns x0, y0, x1, y1, widened by a rounding."""
        pixels = camera.pixels(self.points.astype(float)).astype(np.float32)
        boxes = np.empty((4, len(self.cells)), np.float32)
        for start in range(0, len(self.cells), CHUNK):
            corners = pixels[self.cells[start : start + CHUNK]]
            boxes[:2, start : start + CHUNK] = corners.min(axis=1).T - 1e-3
            boxes[2:, start : start + CHUNK] = corners.max(axis=1).T + 1e-3
        return boxes

    def pixel(self, camera, boxes, x, y, transfer):
        """Premultiplied RGBA of the ray through pixel (x, y)."""
        x0, y0, x1, y1 = boxes
        near = np.flatnonzero((x0 <= x) & (x <= x1) & (y0 <= y) & (y <= y1))
        direction = camera.direction(x, y)
        corners = self.cells[near]
        p, s = self.points[corners].astype(float) - camera.eye, self.values[corners].astype(float)
        depths0, depths1, s0, s1 = self.segments(near, p, s, direction)
        order = np.argsort(depths0 + depths1, kind="stable")
        lengths = (depths1 - depths0) * np.linalg.norm(direction)
        return composite(lengths[order], s0[order], s1[order], transfer)


class Tetrahedra(Cells):
    """A linear field in each cell."""

    @staticmethod
    def segments(_near, p, s, d):
        """Depths and scalars where the ray from the origin along `d` enters and leaves the cells p (m × 4 × 3) that it meets."""
        enters, leaves = np.full(len(p), -np.inf), np.full(len(p), np.inf)
        for opposite, (a, b, c) in enumerate(TETRAHEDRON_FACES):
            normal = np.cross(p[:, b] - p[:, a], p[:, c] - p[:, a])
            # Positive on the side of the opposite vertex.
            side = np.einsum("mi,mi->m", normal, p[:, opposite] - p[:, a])
            slope, offset = (normal @ d) * np.sign(side), np.einsum("mi,mi->m", normal, p[:, a]) * np.sign(side)
            with np.errstate(divide="ignore", invalid="ignore"):
                depth = offset / slope
            enters = np.where(slope > 0, np.maximum(enters, depth), enters)
            leaves = np.where(slope < 0, np.minimum(leaves, depth), leaves)
            leaves = np.where((slope == 0) & (offset > 0), -np.inf, leaves)
        is_met = (enters < leaves) & (leaves > 0)
        p, s, enters, leaves = p[is_met], s[is_met], np.maximum(enters[is_met], 0), leaves[is_met]
        # s(x) = s_0 + g·(x − p_0); the gradient g from the three edges at vertex 0.
        gradient = np.linalg.solve(p[:, 1:] - p[:, :1], (s[:, 1:] - s[:, :1])[..., None])[..., 0]
        at_eye = s[:, 0] - np.einsum("mi,mi->m", gradient, p[:, 0])
        along = gradient @ d
        # A sliver's gradient is large; its scalars are not.
        within = lambda depth: np.clip(at_eye + along * depth, s.min(axis=1), s.max(axis=1))
        return enters, leaves, within(enters), within(leaves)


class Hexahedra(Cells):
    """Linear on the triangles of the faces, and along the ray from each entry to the exit behind it."""

    def __init__(self, points, cells, values):
        super().__init__(points, cells, values)
        # Per cell and face the place of the lowest number among the corners: the diagonal starts there.
        self.first = np.argmin(cells[:, HEXAHEDRON_FACES], axis=2).astype(np.uint8)

    def segments(self, near, p, s, d):
        """As [`Tetrahedra.segments`]: a ray may enter a folded cell twice, and crossings pair up in order of depth."""
        turned = (self.first[near][:, :, None] + np.arange(4)) % 4
        quads = np.take_along_axis(np.array(HEXAHEDRON_FACES)[None], turned, axis=2)
        triangles = quads[:, :, [[0, 1, 2], [0, 2, 3]]].reshape(len(p), 12, 3)
        cell = np.arange(len(p))[:, None, None]
        a, scalars = p[cell, triangles], s[cell, triangles]
        # Volumes that the ray spans with the edges: of one sign where it passes inside, and barycentric weights then.
        b, c = np.roll(a, -1, axis=2), np.roll(a, -2, axis=2)
        weights = np.cross(b, c) @ d
        is_crossed = (weights > 0).all(axis=2) | (weights < 0).all(axis=2)
        weights = weights[is_crossed] / weights[is_crossed].sum(axis=1, keepdims=True)
        # A point of the triangle is w·d, and d·d-projected it gives w.
        depths = np.einsum("tk,tki,i->t", weights, a[is_crossed], d) / (d @ d)
        values = np.einsum("tk,tk->t", weights, scalars[is_crossed])
        owner = np.nonzero(is_crossed)[0]
        order = np.lexsort((depths, owner))
        owner, depths, values = owner[order], depths[order], values[order]
        counts = np.bincount(owner, minlength=1)
        if (counts % 2).any():
            raise ValueError("a ray meets an edge exactly; take another pixel")
        return depths[::2], depths[1::2], values[::2], values[1::2]
