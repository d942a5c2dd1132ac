"""Meshes that tests draw."""

import numpy as np


def lattice(n, bend=0.15):
    """The points of n boxes along each axis in shape (k, j, i, 3), bent so that faces stay flat: sheared, and stretched along each axis."""
    k, j, i = np.meshgrid(*[np.arange(n + 1) / n] * 3, indexing="ij")
    x, y, z = (t + bend * t * (t - 1) for t in (i, j, k))
    return np.stack([x + 0.2 * z, y + 0.1 * x, z - 0.15 * y], axis=-1)


def hexahedra(n):
    """Points of each of the boxes."""
    first = np.arange((n + 1) ** 3).reshape([n + 1] * 3)[:-1, :-1, :-1].reshape(-1, 1)
    layer = np.array([0, 1, n + 2, n + 1])
    return first + np.concatenate([layer, layer + (n + 1) ** 2])


def tetrahedra(n):
    """Six tetrahedra in each of the boxes."""
    six = [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)]
    return np.ascontiguousarray(hexahedra(n)[:, six].reshape(-1, 4))


def values(points):
    """A smooth value from 0 to 1 at each point."""
    x, y, z = np.moveaxis(np.asarray(points, dtype=np.float64), -1, 0)
    return 0.5 + 0.4 * np.sin(5 * x) * np.cos(4 * y) * np.cos(3 * z + 0.5)


def large(n=40):
    """Points in float32, tetrahedra in uint32, values: six times n³ cells."""
    points = lattice(n).reshape(-1, 3).astype(np.float32)
    return points, tetrahedra(n).astype(np.uint32), values(points).astype(np.float32)
