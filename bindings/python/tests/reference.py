"""A renderer in float64, ray by ray and triangle by triangle, which shares nothing with cellfan."""

import itertools

import numpy as np

#: Faces by corners, in VTK's order.
FACES = {
    10: [(0, 1, 2), (0, 3, 1), (1, 3, 2), (0, 2, 3)],
    12: [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    13: [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)],
    14: [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
}
#: Between two control points, where a segment is integrated: Gauss and Legendre's nodes.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)


def triangles_of(code, cell):
    """Points of the triangles of a cell's faces: four corners are cut along the diagonal from the lowest."""
    for face in FACES[code]:
        face = [cell[i] for i in face]
        if len(face) == 3:
            yield face
            continue
        first = face.index(min(face))
        a, b, c, d = face[first:] + face[:first]
        yield a, b, c
        yield a, c, d


def rays(camera):
    """Eye and direction of each pixel; at view depth w the ray is at eye + w * direction."""
    eye, target, up = (np.array(v) for v in (camera.eye, camera.target, camera.up))
    width, height = camera.size
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    down = np.cross(forward, right)
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    if camera.fov is None:
        step = camera.orthographic_height / height
        origins = eye + step * (x[..., None] * right + y[..., None] * down)
        return origins.reshape(-1, 3), np.broadcast_to(forward, (width * height, 3))
    step = 2 * np.tan(np.radians(camera.fov) / 2) / height
    directions = forward + step * (x[..., None] * right + y[..., None] * down)
    return np.broadcast_to(eye, (width * height, 3)), directions.reshape(-1, 3)


def segments(points, values, code, cell, origins, directions):
    """Where each ray enters and leaves a convex cell, and the values there; NaN where it misses. ``values``: one a point, or one for all."""
    near, far = np.full(len(origins), np.inf), np.full(len(origins), -np.inf)
    s_near, s_far = np.zeros(len(origins)), np.zeros(len(origins))
    for corners in triangles_of(code, cell):
        a, b, c = points[list(corners)]
        s = values[list(corners)] if np.ndim(values) else np.full(3, values)
        # Möller and Trumbore.
        p = np.cross(directions, c - a)
        det = p @ (b - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            u = np.einsum("ij,ij->i", origins - a, p) / det
            q = np.cross(origins - a, b - a)
            v = np.einsum("ij,ij->i", directions, q) / det
            w = q @ (c - a) / det
            is_hit = (u >= 0) & (v >= 0) & (u + v <= 1)
            at = s[0] + u * (s[1] - s[0]) + v * (s[2] - s[0])
        is_near, is_far = is_hit & (w < near), is_hit & (w > far)
        near[is_near], s_near[is_near] = w[is_near], at[is_near]
        far[is_far], s_far[is_far] = w[is_far], at[is_far]
    is_met = (far > near) & (far > 0)
    near, far = np.where(is_met, near, np.nan), np.where(is_met, far, np.nan)
    return near, far, s_near, s_far


def over(transfer, length, s0, s1):
    """Light and transmittance of a segment along which the value runs from s0 to s1."""
    knots = np.array([value for value, _, _ in transfer.points])
    t = np.array([0.0, 1.0])
    if s0 != s1:
        t = np.unique(np.clip(np.concatenate([t, (knots - s0) / (s1 - s0)]), 0, 1))
    light, transmittance = np.zeros(3), 1.0
    table = np.array([[*color, extinction] for _, color, extinction in transfer.points])

    def look(at):
        return np.stack([np.interp(s0 + at * (s1 - s0), knots, table[:, k]) for k in range(4)], axis=-1)

    for begin, end in itertools.pairwise(t):
        if end <= begin:
            continue
        k0, k1 = look(np.array([begin, end]))[:, 3]
        span = (end - begin) * length
        x = (NODES + 1) / 2
        depth = span * (k0 * x + (k1 - k0) * x * x / 2)
        colors = look(begin + x * (end - begin))
        light += transmittance * (WEIGHTS / 2 * span * np.exp(-depth)) @ (colors[:, :3] * colors[:, 3:])
        transmittance *= np.exp(-span * (k0 + k1) / 2)
    return light, transmittance


def render(points, cells, values, transfer, camera, *, of_cells=False):
    """The picture of ``cells``, pairs of a VTK code and points; ``values`` are of points, or of cells."""
    points = np.asarray(points, dtype=np.float64)
    origins, directions = rays(camera)
    found = [[] for _ in origins]
    for nth, (code, cell) in enumerate(cells):
        near, far, s_near, s_far = segments(
            points, values[nth] if of_cells else values, code, list(cell), origins, directions
        )
        for ray in np.flatnonzero(~np.isnan(near)):
            found[ray].append((near[ray], far[ray], s_near[ray], s_far[ray]))
    image = np.zeros((len(origins), 4))
    for ray, of_ray in enumerate(found):
        light, transmittance = np.zeros(3), 1.0
        for near, far, s0, s1 in sorted(of_ray):
            color, through = over(transfer, (far - near) * np.linalg.norm(directions[ray]), s0, s1)
            light += transmittance * color
            transmittance *= through
        image[ray] = [*light, 1 - transmittance]
    width, height = camera.size
    return image.reshape(height, width, 4)
