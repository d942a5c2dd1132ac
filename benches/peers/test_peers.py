"""Checks of the reference and of what VTK is told, against closed forms: `python -m unittest` in this folder."""

import unittest

import numpy as np
from scipy.integrate import quad

import integral
import meshes
import reference
import vtk_peer
from camera import Camera
from transfer import TransferFunction

# The corners of a hexahedron as five tetrahedra.
FIVE = np.array([[0, 1, 3, 4], [1, 2, 3, 6], [1, 4, 5, 6], [3, 4, 6, 7], [1, 3, 4, 6]])
PIXELS = [(20.3, 31.1), (33.7, 29.2), (31.6, 40.9), (25.2, 22.4), (40.1, 35.3)]


def sheared_grid(n):
    """n³ boxes of a sheared cube and a linear field, whose cells may be split in any way."""
    x = np.stack(np.meshgrid(*[np.arange(n + 1) / n] * 3, indexing="ij"), axis=-1)[..., ::-1].reshape(-1, 3)
    points = x @ np.array([[1, 0.2, 0], [0, 1, 0.3], [0.1, 0, 1]])
    return points, meshes.hexahedra((n + 1,) * 3), points @ [0.3, 0.2, 0.4]


def camera(points):
    return Camera.framing([points.min(axis=0), points.max(axis=0)], 35, 20, (64, 64))


def drawn(cells, view, transfer):
    boxes = cells.boxes(view)
    return np.array([cells.pixel(view, boxes, x, y, transfer) for x, y in PIXELS])


class Integral(unittest.TestCase):
    transfer = TransferFunction()

    def test_is_that_of_adaptive_quadrature(self):
        """Three control points crossed, thin and thick, both ways."""
        for length, s0, s1 in [(0.3, -0.1, 1.2), (40.0, 0.1, 0.9), (1e-4, 0.9, 0.2), (2.0, 0.7, 0.7)]:
            at = lambda t: self.transfer.evaluate(s0 + (s1 - s0) * t)
            kinks = [t for t in ((0.5 - s0) / (s1 - s0 or np.inf), -s0 / (s1 - s0 or np.inf)) if 0 < t < 1]
            settings = {"points": kinks or None, "epsabs": 1e-13, "epsrel": 1e-12, "limit": 400}
            depth = lambda t: length * quad(lambda u: at(u)[3], 0, t, **{**settings, "points": [k for k in kinks if k < t] or None})[0]
            got = integral.composite(*np.array([[length], [s0], [s1]]), self.transfer)
            self.assertAlmostEqual(got[3], -np.expm1(-depth(1)), delta=1e-10)
            for channel in range(3):
                light = quad(lambda t: length * at(t)[channel] * at(t)[3] * np.exp(-depth(t)), 0, 1, **settings)[0]
                self.assertAlmostEqual(got[channel], light, delta=1e-9)

    def test_segments_follow_each_other(self):
        whole = integral.composite(*np.array([[2.0], [0.1], [0.9]]), self.transfer)
        parts = integral.composite(np.array([0.5, 1.5]), np.array([0.1, 0.3]), np.array([0.3, 0.9]), self.transfer)
        np.testing.assert_allclose(parts, whole, atol=1e-13)
        turned = integral.composite(np.array([1.5, 0.5]), np.array([0.3, 0.1]), np.array([0.9, 0.3]), self.transfer)
        self.assertGreater(np.abs(turned - whole).max(), 1e-3)


class Cells(unittest.TestCase):
    def test_both_kinds_agree_on_a_linear_field(self):
        points, cells, values = sheared_grid(4)
        view, transfer = camera(points), TransferFunction()
        whole = drawn(reference.Hexahedra(points, cells, values), view, transfer)
        split = drawn(reference.Tetrahedra(points, cells[:, FIVE].reshape(-1, 4), values), view, transfer)
        self.assertGreater(whole[:, 3].min(), 0.1)
        np.testing.assert_allclose(whole, split, atol=1e-12)
        values = values.copy()
        values[len(values) // 2] += 0.1
        other = drawn(reference.Hexahedra(points, cells, values), view, transfer)
        self.assertGreater(np.abs(other - split).max(), 1e-6)

    def test_a_homogeneous_cube_is_the_length_of_its_chord(self):
        _, cells, values = sheared_grid(3)
        points = np.stack(np.meshgrid(*[np.arange(4) / 3] * 3, indexing="ij"), axis=-1)[..., ::-1].reshape(-1, 3)
        view, transfer = camera(points), TransferFunction([[0, 1, 1, 1, 1.7]])
        want = []
        for x, y in PIXELS:
            direction = view.direction(x, y)
            sides = np.sort((np.array([[0.0], [1.0]]) - view.eye) / direction, axis=0)
            want.append(-np.expm1(-1.7 * (sides[1].min() - sides[0].max()) * np.linalg.norm(direction)))
        tetrahedra = cells[:, FIVE].reshape(-1, 4)
        for mesh in [reference.Hexahedra(points, cells, values), reference.Tetrahedra(points, tetrahedra, values)]:
            got = drawn(mesh, view, transfer)
            np.testing.assert_allclose(got, np.repeat(np.array(want)[:, None], 4, axis=1), atol=1e-12)

    def test_folded_hexahedra_leave_no_gap(self):
        dims, points, values = meshes.curvilinear(12)
        cells = reference.Hexahedra(points, meshes.hexahedra(dims), values)
        view = camera(points)
        for x, y in PIXELS:
            near = np.arange(len(cells.cells))
            p, s = points[cells.cells].astype(float) - view.eye, values[cells.cells].astype(float)
            enters, leaves, s0, s1 = cells.segments(near, p, s, view.direction(x, y))
            order = np.argsort(enters)
            self.assertGreater(len(order), 8)
            gaps = enters[order][1:] - leaves[order][:-1]
            jumps = s0[order][1:] - s1[order][:-1]
            # The shell is hollow: a ray may leave it once and enter again.
            self.assertLessEqual((np.abs(gaps) > 1e-12).sum(), 1)
            self.assertLess(np.abs(jumps[np.abs(gaps) < 1e-12]).max(), 1e-9)


class Vtk(unittest.TestCase):
    def test_opacity_of_the_property_is_extinction(self):
        """A homogeneous box in tetrahedra, through each of VTK's mappers, to what 8 bits hold."""
        try:
            vtk_peer.prepare(2)
        except vtk_peer.Missing as error:
            self.skipTest(str(error))
        import vtk

        box = vtk.vtkImageData()
        box.SetDimensions(5, 5, 5)
        box.SetSpacing(0.25, 0.25, 0.25)
        values = vtk.vtkFloatArray()
        values.SetName(meshes.ARRAY)
        values.SetNumberOfTuples(125)
        values.Fill(0.5)
        box.GetPointData().SetScalars(values)
        split = vtk.vtkDataSetTriangleFilter()
        split.SetInputData(box)
        split.Update()
        grid = split.GetOutput()
        cells = reference.Tetrahedra(*vtk_peer.arrays(grid))
        transfer = TransferFunction([[0, 1, 0.8, 0.6, 0.7], [1, 1, 0.8, 0.6, 0.7]])
        view = Camera.framing([[0] * 3, [1] * 3], 35, 20, (64, 64))
        boxes = cells.boxes(view)
        for name, renderer in vtk_peer.PEERS.items():
            with self.subTest(name):
                peer = vtk_peer.Peer(renderer.make(2), grid, transfer, (64, 64))
                # The first frame of projected tetrahedra lacks the first thousand cells.
                peer.frame(view)
                peer.frame(view)
                picture = peer.picture()
                peer.close()
                for x, y in [(20, 31), (33, 29), (31, 40)]:
                    want = cells.pixel(view, boxes, x + renderer.ray_px[0], y + renderer.ray_px[1], transfer)
                    # Read as the opacity of a unit it would be 1: opaque.
                    self.assertTrue(0.3 < want[3] < 0.8)
                    np.testing.assert_allclose(picture[y, x], want, atol=0.02)


if __name__ == "__main__":
    unittest.main()
