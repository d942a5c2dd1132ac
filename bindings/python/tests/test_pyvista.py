"""Grids of PyVista, of VTK, and of anything that looks like them."""

from types import SimpleNamespace

import numpy as np
import pytest

import cellfan
import meshes

SIZE = (80, 60)


def assert_alike(found, expected):
    assert expected.array[..., 3].max() > 0.3
    assert np.abs(found.array - expected.array).max() < 1e-3


def test_what_looks_like_a_grid_is_one():
    points, cells, values = meshes.large(4)
    expected = cellfan.render(cellfan.Mesh(points, cells, point_data={"p": values}), size=SIZE)
    data = {
        "point_data": {"name": np.array(["a"] * len(points)), "p": values},
        "cell_data": {},
        "active_scalars_name": "p",
    }
    offsets = np.arange(0, cells.size + 1, 4)
    cells = {"cell_connectivity": cells.reshape(-1), "celltypes": np.full(len(cells), 10, np.uint8)}
    grid = SimpleNamespace(points=points, offset=offsets, **cells, **data)
    mesh = cellfan.from_pyvista(grid)
    assert mesh.active == "p" and mesh.copied == () and np.shares_memory(mesh.points, points)
    assert_alike(cellfan.render(grid, size=SIZE), expected)

    image = SimpleNamespace(dimensions=(4, 3, 5), origin=(1, 2, 3), spacing=(0.5, 0.25, 1), point_data={}, cell_data={})
    assert np.allclose(
        cellfan.from_pyvista(image).points[[1, 4, 12, -1]], [[1.5, 2, 3], [1, 2.25, 3], [1, 2, 4], [2.5, 2.5, 7]]
    )
    with pytest.raises(cellfan.Error):
        cellfan.from_pyvista(SimpleNamespace(points=None, dimensions=(3, 3, 3)))


def test_hidden_cells_are_left_out():
    points = meshes.lattice(3)
    hidden = np.zeros(27, np.uint8)
    hidden[[4, 13]] = [1, 32]
    of_points = np.zeros(64, np.uint8)
    of_points[63] = 2
    kept = np.delete(meshes.hexahedra(3), [4, 13, 26], axis=0)
    values = np.arange(27.0)
    expected = cellfan.render(
        cellfan.Mesh(points.reshape(-1, 3), kept, cell_data=np.delete(values, [4, 13, 26])), size=SIZE
    )
    data = {"point_data": {"vtkGhostType": of_points}, "cell_data": {"vtkGhostType": hidden, "v": values}}
    structured = SimpleNamespace(points=points.reshape(-1, 3), dimensions=(4, 4, 4), **data)
    cells = {"cell_connectivity": meshes.hexahedra(3).reshape(-1), "celltypes": np.full(27, 12, np.uint8)}
    unstructured = SimpleNamespace(points=points.reshape(-1, 3), offset=np.arange(0, 217, 8), **cells, **data)
    for grid in (structured, unstructured):
        mesh = cellfan.from_pyvista(grid)
        assert mesh.n_cells == 24 and list(mesh.cell_data) == ["v"]
        assert_alike(cellfan.render(mesh, size=SIZE), expected)


@pytest.fixture(scope="module")
def pyvista():
    return pytest.importorskip(
        "pyvista", reason="PYVISTA IS NOT INSTALLED: its grids are not tested (pip install pyvista)"
    )


def grids(pyvista):
    """A grid of each kind with an array of points and one of cells, its points, and its cells as PyVista counts them."""
    image = pyvista.ImageData(dimensions=(7, 6, 5), spacing=(0.2, 0.3, 0.25), origin=(1, -2, 0.5))
    image.direction_matrix = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]
    rectilinear = pyvista.RectilinearGrid(
        np.array([0, 0.3, 0.5, 1.2]), np.array([0, 0.4, 1.0]), np.array([0, 0.1, 0.6, 0.9, 1.0])
    )
    x, y, z = np.moveaxis(meshes.lattice(4).astype(np.float32), -1, 0)
    structured = pyvista.StructuredGrid(x, y, z)
    tetrahedra = pyvista.UnstructuredGrid(
        {10: meshes.tetrahedra(3)}, meshes.lattice(3).reshape(-1, 3).astype(np.float32)
    )
    mixed = pyvista.UnstructuredGrid(
        {12: meshes.hexahedra(2)[1:], 13: meshes.hexahedra(2)[:1, [0, 1, 2, 4, 5, 6]]}, meshes.lattice(2).reshape(-1, 3)
    )
    cut = image.cast_to_unstructured_grid().extract_cells(range(0, image.n_cells, 3))
    for grid in (image, rectilinear, structured, tetrahedra, mixed, cut):
        grid.clear_data()
        grid.point_data["p"] = meshes.values(grid.points)
        grid.cell_data["c"] = meshes.values(grid.cell_centers().points)
        grid.set_active_scalars("p")
        yield grid


def by_hand(grid):
    """The same mesh without a word of PyVista's about kinds of grids."""
    cells = [(int(grid.get_cell(nth).type), grid.get_cell(nth).point_ids) for nth in range(grid.n_cells)]
    voxel = [0, 1, 3, 2, 4, 5, 7, 6]
    cells = [(12, [ids[i] for i in voxel]) if code == 11 else (code, ids) for code, ids in cells]
    offsets = np.cumsum([0] + [len(ids) for _, ids in cells])
    types = np.array([code for code, _ in cells], np.uint8)
    points = np.array([grid.GetPoint(nth) for nth in range(grid.n_points)])
    return points, np.concatenate([ids for _, ids in cells]), offsets, types


def test_grids_of_pyvista(pyvista):
    import vtkmodules.all as vtk

    for grid in grids(pyvista):
        for name, data in (("p", "point_data"), ("c", "cell_data")):
            expected = cellfan.render(cellfan.Mesh(*by_hand(grid), **{data: {name: np.array(grid[name])}}), size=SIZE)
            assert_alike(cellfan.render(grid, name, size=SIZE), expected)
            # The same grid as plain VTK knows it.
            plain = getattr(
                vtk, grid.GetClassName() if hasattr(vtk, grid.GetClassName()) else "vtk" + type(grid).__name__
            )()
            plain.ShallowCopy(grid)
            assert not hasattr(plain, "point_data") or not hasattr(plain, "celltypes")
            assert_alike(cellfan.render(plain, name, size=SIZE), expected)
        assert cellfan.from_pyvista(grid).active == "p"
        assert cellfan.Session(grid).value_range == pytest.approx((grid["p"].min(), grid["p"].max()), rel=1e-6)


def test_points_of_pyvista_are_not_copied(pyvista):
    grid = pyvista.UnstructuredGrid({10: meshes.tetrahedra(3)}, meshes.lattice(3).reshape(-1, 3).astype(np.float32))
    mesh = cellfan.from_pyvista(grid)
    assert (
        mesh.copied == ()
        and np.shares_memory(mesh.points, grid.points)
        and np.shares_memory(mesh.connectivity, grid.cell_connectivity)
    )


def test_what_is_no_grid_of_volumes(pyvista):
    for mesh in (
        pyvista.Sphere(),
        pyvista.PolyData(),
        pyvista.UnstructuredGrid(),
        pyvista.ImageData(dimensions=(5, 5, 1)),
        pyvista.MultiBlock(),
    ):
        with pytest.raises(cellfan.Error):
            cellfan.render(mesh, size=SIZE)


def test_the_picture_of_pyvistas_wavelet(pyvista):
    image = cellfan.render(pyvista.Wavelet(), "RTData", size=SIZE)
    assert image.stats["drawn"] == 8000 and image.array[..., 3].max() > 0.5
