"""`from_pyvista`: grids of PyVista and VTK as meshes. Neither has to be installed."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._cellfan import Error
from ._mesh import Mesh

#: Bits of VTK's ghost types: a cell of another piece, one that finer ones replace, one that is hidden.
HIDDEN = 1 | 8 | 32
#: The bit of a point whose cells are hidden.
HIDDEN_POINT = 2


def from_pyvista(grid: Any) -> Mesh:
    """The mesh of an unstructured, structured, rectilinear or image grid, of PyVista or plain VTK, or of anything with their attributes.

    Arrays are used in place where :class:`Mesh` says so. The points of rectilinear and image grids are made: 12 or 24 bytes each. VTK's
    64-bit connectivity is copied by a session. Cells that ``vtkGhostType`` hides are left out, and the others copied then.

    >>> cellfan.render(cellfan.from_pyvista(pyvista.Wavelet()), "RTData").save("wavelet.png")
    """
    if hasattr(grid, "IsA") and hasattr(grid, "GetPointData"):
        # PyVista's grids are VTK's too.
        parts = _of_vtk(grid)
    elif all(hasattr(grid, name) for name in ("points", "cell_connectivity", "celltypes")):
        offsets = grid.cell_offsets if hasattr(grid, "cell_offsets") else grid.offset
        cells = {"connectivity": grid.cell_connectivity, "offsets": offsets, "types": grid.celltypes}
        parts = {"points": grid.points, **cells, **_attributes(grid)}
    elif hasattr(grid, "dimensions") and hasattr(grid, "points"):
        parts = {"points": grid.points, "dims": grid.dimensions, **_attributes(grid)}
    elif all(hasattr(grid, name) for name in ("dimensions", "origin", "spacing")):
        points = _lattice(grid.dimensions, grid.origin, grid.spacing)
        parts = {"points": points, "dims": grid.dimensions, **_attributes(grid)}
    else:
        raise Error(f"{type(grid)}: no mesh, and no unstructured, structured, rectilinear or image grid")
    active = parts.pop("active")
    of_cells, of_points = (parts[data].pop("vtkGhostType", np.uint8(0)) for data in ("cell_data", "point_data"))
    if np.any(of_cells & HIDDEN) or np.any(of_points & HIDDEN_POINT):
        parts = _without(parts, of_cells & HIDDEN != 0, of_points & HIDDEN_POINT != 0)
    for name in ("points", "connectivity", "offsets", "types"):
        if name in parts:
            # A plain array, not a subclass, of the same memory.
            parts[name] = np.asarray(parts[name])
    mesh = Mesh(**parts)
    if active in mesh.point_data or active in mesh.cell_data:
        mesh.active = active
    return mesh


def _is_drawn(values: Any) -> bool:
    return np.asarray(values).dtype.kind in "iufb"


def _attributes(grid: Any) -> dict[str, Any]:
    """The data of a grid with PyVista's attributes."""
    named = [
        {n: np.asarray(v) for n, v in dict(getattr(grid, of, {})).items() if _is_drawn(v)}
        for of in ("point_data", "cell_data")
    ]
    return {"point_data": named[0], "cell_data": named[1], "active": getattr(grid, "active_scalars_name", None)}


def _lattice(dims: Any, origin: Any, spacing: Any, direction: Any = None, first: Any = (0, 0, 0)) -> np.ndarray:
    """The points of an image grid, i fastest."""
    k, j, i = np.meshgrid(*(first[axis] + np.arange(dims[axis], dtype=np.float64) for axis in (2, 1, 0)), indexing="ij")
    steps = np.stack([i, j, k], axis=-1).reshape(-1, 3) * np.asarray(spacing, dtype=np.float64)
    return np.asarray(
        np.asarray(origin, dtype=np.float64) + (steps if direction is None else steps @ np.asarray(direction).T)
    )


def _of_vtk(grid: Any) -> dict[str, Any]:
    """The parts of one of VTK's own grids."""
    from vtkmodules.util import numpy_support

    def vtk_to_numpy(array: Any) -> np.ndarray:
        return np.asarray(numpy_support.vtk_to_numpy(array))  # type: ignore[no-untyped-call]

    def data(of: Any) -> dict[str, Any]:
        arrays = (of.GetArray(i) for i in range(of.GetNumberOfArrays()))
        return {
            array.GetName() or f"array {i}": vtk_to_numpy(array) for i, array in enumerate(arrays) if array is not None
        }

    def active(of: Any) -> str | None:
        return of.GetScalars().GetName() if of.GetScalars() is not None else None

    def points() -> np.ndarray:
        if grid.GetPoints() is None:
            raise Error("the grid has no points")
        return vtk_to_numpy(grid.GetPoints().GetData())

    of_points, of_cells = grid.GetPointData(), grid.GetCellData()
    parts: dict[str, Any] = {
        "point_data": data(of_points),
        "cell_data": data(of_cells),
        "active": active(of_points) or active(of_cells),
    }
    if grid.IsA("vtkUnstructuredGrid"):
        cells = grid.GetCells()
        if grid.GetNumberOfCells() == 0:
            raise Error("the grid has no cells")
        parts["connectivity"], parts["offsets"] = (
            vtk_to_numpy(cells.GetConnectivityArray()),
            vtk_to_numpy(cells.GetOffsetsArray()),
        )
        try:
            types = grid.GetCellTypes()
        except TypeError:
            # VTK before 9.6.
            types = grid.GetCellTypesArray()
        return parts | {"points": points(), "types": vtk_to_numpy(types)}
    dims = [0, 0, 0]
    if any(grid.IsA(name) for name in ("vtkStructuredGrid", "vtkImageData", "vtkRectilinearGrid")):
        grid.GetDimensions(dims)
    if grid.IsA("vtkStructuredGrid"):
        return parts | {"points": points(), "dims": dims}
    if grid.IsA("vtkImageData"):
        turn, extent = grid.GetDirectionMatrix(), grid.GetExtent()
        direction = [[turn.GetElement(row, column) for column in range(3)] for row in range(3)]
        return parts | {
            "points": _lattice(dims, grid.GetOrigin(), grid.GetSpacing(), direction, extent[::2]),
            "dims": dims,
        }
    if grid.IsA("vtkRectilinearGrid"):
        axes = [vtk_to_numpy(axis) for axis in (grid.GetXCoordinates(), grid.GetYCoordinates(), grid.GetZCoordinates())]
        z, y, x = np.meshgrid(*axes[::-1], indexing="ij")
        return parts | {"points": np.stack([x, y, z], axis=-1).reshape(-1, 3), "dims": dims}
    raise Error(f"{grid.GetClassName()}: an unstructured, structured, rectilinear or image grid is needed")


def _without(parts: dict[str, Any], is_hidden: np.ndarray, is_hidden_point: np.ndarray) -> dict[str, Any]:
    """The cells that are not hidden, as those of an unstructured grid."""
    if "dims" in parts:
        ni, nj, nk = parts.pop("dims")
        first = np.arange(ni * nj * nk).reshape(nk, nj, ni)[:-1, :-1, :-1].reshape(-1, 1)
        layer = np.array([0, 1, ni + 1, ni])
        corners = first + np.concatenate([layer, layer + ni * nj])
        is_hidden = is_hidden | (is_hidden_point[corners].any(axis=1) if is_hidden_point.ndim else is_hidden_point)
        parts["connectivity"] = corners[~is_hidden]
    else:
        corners, offsets = np.asarray(parts["connectivity"]), np.asarray(parts["offsets"])
        lens = np.diff(offsets)
        is_hidden = is_hidden | np.zeros(len(lens), bool)
        if is_hidden_point.ndim:
            is_hidden[np.repeat(np.arange(len(lens)), lens)[is_hidden_point[corners]]] = True
        parts["connectivity"] = corners[np.repeat(~is_hidden, lens)]
        parts["offsets"] = np.concatenate([[0], np.cumsum(lens[~is_hidden])])
        parts["types"] = np.asarray(parts["types"])[~is_hidden]
    parts["cell_data"] = {name: np.asarray(values)[~is_hidden] for name, values in parts["cell_data"].items()}
    return parts
