"""Pictures against the float64 reference."""

import numpy as np
import pytest

import cellfan
import meshes
import reference

SMOOTH = cellfan.Transfer(
    [
        (0.0, (0.9, 0.2, 0.1), 0.5),
        (0.35, (0.2, 0.7, 0.3), 6.0),
        (0.6, (0.1, 0.3, 0.9), 1.0),
        (1.0, (1.0, 0.9, 0.5), 9.0),
    ]
)
SIZE = (32, 24)


def assert_close(image, expected):
    difference = np.abs(image.array.astype(np.float64) - expected)
    covered = (expected[..., 3] > 0) | (image.array[..., 3] > 0)
    assert covered.sum() > 150
    assert difference[covered].mean() <= 1e-4 and difference.max() <= 2e-3, (
        difference[covered].mean(),
        difference.max(),
    )


def pictures(mesh, cells, values, of_cells=False):
    """A picture and what it should be, in perspective and with parallel rays."""
    with cellfan.Session(mesh) as session:
        perspective = session.camera(30, 20, SIZE)
        parallel = cellfan.Camera(perspective.eye, perspective.target, size=SIZE, orthographic_height=1.9)
        for camera in (perspective, parallel):
            image = session.render(camera, SMOOTH)
            yield image, reference.render(meshes_points(mesh), cells, values, SMOOTH, camera, of_cells=of_cells)


def meshes_points(mesh):
    return np.stack(mesh.points, axis=-1) if isinstance(mesh.points, tuple) else mesh.points


@pytest.mark.parametrize("of_cells", [False, True])
@pytest.mark.parametrize("n", [1, 3])
def test_tetrahedra(n, of_cells):
    points, cells = meshes.lattice(n).reshape(-1, 3).astype(np.float32), meshes.tetrahedra(n).astype(np.uint32)
    values = meshes.values(points[cells[:, 0]] if of_cells else points)
    mesh = cellfan.Mesh(points, cells, **{"cell_data" if of_cells else "point_data": values})
    assert "points" not in mesh.copied and "connectivity" not in mesh.copied
    for image, expected in pictures(mesh, [(10, cell) for cell in cells], values, of_cells):
        assert_close(image, expected)
        assert image.stats["is_exact"]


def test_structured_hexahedra():
    points = meshes.lattice(3)
    values = meshes.values(points)
    mesh = cellfan.Mesh(points, point_data={"value": values})
    assert mesh.dims == (4, 4, 4) and mesh.n_cells == 27
    for image, expected in pictures(mesh, [(12, cell) for cell in meshes.hexahedra(3)], values.reshape(-1)):
        assert_close(image, expected)


def test_cells_of_several_kinds():
    points = meshes.lattice(2).reshape(-1, 3)
    # A box in wedges, one in pyramids, one in tetrahedra, the others whole; faces are cut along the diagonal from their lowest point.
    cells = []
    for nth, (a, b, c, d, e, f, g, h) in enumerate(meshes.hexahedra(2).tolist()):
        cells += {
            0: [(13, (a, b, c, e, f, g)), (13, (a, c, d, e, g, h))],
            2: [(14, (a, d, c, b, g)), (14, (a, b, f, e, g)), (14, (a, e, h, d, g))],
            5: [
                (10, (a, b, c, g)),
                (10, (a, c, d, g)),
                (10, (a, d, h, g)),
                (10, (a, h, e, g)),
                (10, (a, e, f, g)),
                (10, (a, f, b, g)),
            ],
        }.get(nth, [(12, (a, b, c, d, e, f, g, h))])
    types = np.array([code for code, _ in cells], dtype=np.uint8)
    offsets = np.cumsum([0] + [len(cell) for _, cell in cells])
    values = meshes.values(points)
    mesh = cellfan.Mesh(points, np.concatenate([cell for _, cell in cells]), offsets, types, point_data=values)
    for image, expected in pictures(mesh, cells, values):
        assert_close(image, expected)


def test_the_comparison_can_fail():
    points, cells = meshes.lattice(1).reshape(-1, 3), meshes.tetrahedra(1)
    values = meshes.values(points)
    mesh = cellfan.Mesh(points, cells, point_data=values)
    for image, expected in pictures(mesh, [(10, cell) for cell in cells], values * 0.98):
        with pytest.raises(AssertionError):
            assert_close(image, expected)


def test_a_slab_has_its_closed_form():
    cube = cellfan.Mesh(
        meshes.lattice(1, bend=0) * 0 + np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij")[::-1], axis=-1)
    )
    camera = cellfan.Camera((5, 0.5, 0.5), (0.5, 0.5, 0.5), size=(9, 9), orthographic_height=0.5)
    image = cellfan.render(cube, camera=camera, transfer=cellfan.Transfer.constant((1, 0.5, 0), 2.0))
    alpha = 1 - np.exp(-2.0)
    assert np.allclose(image.array, [alpha, alpha / 2, 0, alpha], atol=1e-6)
    absorption = cellfan.render(
        cube, camera=camera, transfer=cellfan.Transfer.constant((1, 0.5, 0), 2.0), model="absorption"
    )
    assert np.allclose(absorption.array, np.exp([-2.0, -1.0, 0.0, -2.0]), atol=1e-6)
