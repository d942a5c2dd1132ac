"""`Mesh`: arrays as they are drawn, in place where their layout allows."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._cellfan import Error

#: VTK's codes of the kinds that are drawn, and their corners.
KINDS = {"tetrahedron": 10, "voxel": 11, "hexahedron": 12, "wedge": 13, "pyramid": 14}
CORNERS = {10: 4, 11: 8, 12: 8, 13: 6, 14: 5}
#: What so many columns of connectivity are.
OF_COLUMNS = {4: 10, 5: 14, 6: 13, 8: 12}

Data = Mapping[str, ArrayLike] | ArrayLike | None


class Mesh:
    """Points, cells and data, held for as long as the mesh or a session of it is.

    ``points`` is an array of shape (points, 3), or three arrays x, y, z. Cells are one of

    * ``connectivity`` of shape (cells, corners): 4 corners are tetrahedra, 5 pyramids, 6 wedges, 8 hexahedra, or what ``kind`` says;
    * ``connectivity``, ``offsets`` (one more than cells) and VTK's ``types``, as in VTK's unstructured grids;
    * ``dims``, points along i, j and k of a structured grid, i fastest. Points of shape (nk, nj, ni, 3), or x, y, z of shape
      (nk, nj, ni), say so themselves.

    ``point_data`` and ``cell_data`` map names to arrays of one value, or one vector, a point or cell; an array by itself is called
    "scalars".

    Arrays are used in place: do not change points and connectivity while a session draws them. Copied are: what is not C-contiguous,
    not of the machine's byte order or not aligned; points that are neither float32 nor float64; connectivity of fewer than 32 bits;
    lists. ``copied`` says of which arrays the mesh made a copy. What a session copies in addition is in its documentation.

    >>> mesh = Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]], point_data={"p": [0, 1, 2, 3]})
    >>> mesh.n_points, mesh.n_cells, mesh.copied
    (4, 1, ('points', 'connectivity', 'p'))
    """

    def __init__(
        self,
        points: ArrayLike | Sequence[ArrayLike],
        connectivity: ArrayLike | None = None,
        offsets: ArrayLike | None = None,
        types: ArrayLike | None = None,
        *,
        kind: str | int | None = None,
        dims: Sequence[int] | None = None,
        point_data: Data = None,
        cell_data: Data = None,
    ) -> None:
        copied: list[str] = []
        self.points, of_shape = positions(points, copied)
        if connectivity is None and dims is None:
            dims = of_shape
        self.connectivity = _indices("connectivity", connectivity, copied)
        self.offsets = _indices("offsets", offsets, copied)
        self.types = _numbers("types", types, np.uint8, copied)
        self.kind = _kind(kind, self.connectivity, self.types)
        self.dims = _dims(dims)
        self.n_points = len(self.points[0] if isinstance(self.points, tuple) else self.points)
        self.n_cells = self._cells()
        self.point_data = _data("point_data", point_data, self.n_points, copied)
        self.cell_data = _data("cell_data", cell_data, self.n_cells, copied)
        #: The array that is drawn where none is named.
        self.active: str | None = next(iter([*self.point_data, *self.cell_data]), None)
        #: The arrays that were copied to be drawn.
        self.copied = tuple(copied)

    def _cells(self) -> int:
        if self.types is not None:
            return self.types.size
        if self.kind is not None and self.connectivity is not None:
            return self.connectivity.size // CORNERS[self.kind]
        if self.dims is not None:
            return int(np.prod([max(along - 1, 0) for along in self.dims], dtype=np.int64))
        raise Error("a mesh of what cells? give connectivity of two dimensions, or with offsets and types, or dims")

    def scalars(self, name: str | None = None, component: int | None = None) -> tuple[str, np.ndarray] | None:
        """What is drawn of the array ``name``: ("points" or "cells", values). Of vectors, a component or the magnitude."""
        name = self.active if name is None else name
        if name is None:
            return None
        for of, data in (("points", self.point_data), ("cells", self.cell_data)):
            if name in data:
                return of, scalar(name, data[name], component)
        names = ", ".join([*self.point_data, *self.cell_data]) or "none"
        raise Error(f"there is no array {name!r}; there is: {names}")

    def _parts(self) -> tuple[Any, ...]:
        return self.points, self.connectivity, self.offsets, self.types, self.kind, self.dims

    def __repr__(self) -> str:
        return (
            f"<cellfan.Mesh {self.n_points} points, {self.n_cells} cells, data {[*self.point_data, *self.cell_data]}>"
        )


def scalar(name: str, values: np.ndarray, component: int | None = None) -> np.ndarray:
    """One value a row."""
    if values.ndim == 1:
        if component not in (None, 0):
            raise Error(f"array {name!r} has one component; there is no component {component}")
        return values
    if component is None:
        return np.asarray(np.linalg.norm(values.reshape(len(values), -1), axis=1))
    try:
        return np.ascontiguousarray(values.reshape(len(values), -1)[:, component])
    except IndexError:
        raise Error(f"array {name!r} has {values[0].size} components; there is no component {component}") from None


def numeric(name: str, values: ArrayLike) -> np.ndarray:
    """``values`` as an array of numbers; masked ones are not a number."""
    if values is None:
        raise Error(f"{name}: None is no array")
    if isinstance(values, np.ma.MaskedArray):
        values = np.ma.filled(values.astype(np.float64), np.nan)
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise Error(f"{name}: {error}") from None
    if array.dtype.kind not in "iufb":
        raise Error(f"{name}: an array of {array.dtype}; it has to be of integers or floating-point numbers")
    return array


def in_place(
    name: str, values: ArrayLike, array: np.ndarray, dtype: Any, copied: list[str] | None = None
) -> np.ndarray:
    """``array``, which is ``values``, of ``dtype`` and in the layout that is drawn; itself where it is so."""
    out = np.require(array, dtype, ["C", "A"])
    if copied is not None and not (isinstance(values, np.ndarray) and np.may_share_memory(out, array)):
        copied.append(name)
    return out


def _numbers(name: str, values: ArrayLike | None, dtype: Any, copied: list[str]) -> np.ndarray | None:
    """Whole numbers of ``dtype``, in a row."""
    if values is None:
        return None
    array = numeric(name, values)
    if array.size == 0:
        array = array.astype(dtype)
    if array.dtype.kind not in "iu":
        raise Error(f"{name}: an array of {array.dtype}; it has to be of integers")
    return in_place(name, values, array, dtype, copied) if array.ndim else array.reshape(1)


def _indices(name: str, values: ArrayLike | None, copied: list[str]) -> np.ndarray | None:
    if values is None:
        return None
    dtype = getattr(values, "dtype", np.dtype(np.int64))
    is_wide = dtype.kind in "iu" and dtype.itemsize >= 4
    return _numbers(name, values, dtype.newbyteorder("=") if is_wide else np.int64, copied)


def real(name: str, values: ArrayLike, copied: list[str] | None = None) -> np.ndarray:
    """Coordinates: float32 stays, all else is float64."""
    array = numeric(name, values)
    return in_place(
        name, values, array, np.float32 if array.dtype.kind == "f" and array.itemsize == 4 else np.float64, copied
    )


def positions(points: Any, copied: list[str]) -> tuple[Any, tuple[int, ...] | None]:
    """The points, one array or an axis an array, and the dimensions that their shape says."""
    if isinstance(points, (tuple, list)) and len(points) == 3 and all(isinstance(axis, np.ndarray) for axis in points):
        axes = [real(name, axis, copied) for name, axis in zip("xyz", points)]
        if len({axis.dtype for axis in axes}) > 1:
            axes = [real(name, axis.astype(np.float64), copied) for name, axis in zip("xyz", axes)]
        shape = axes[0].shape
        return tuple(axis.reshape(-1) for axis in axes), shape[::-1] if len(shape) == 3 else None
    array = real("points", points, copied)
    if array.ndim not in (2, 4) or array.shape[-1] != 3:
        raise Error(f"points: an array of shape {array.shape}; it needs three columns: x, y, z")
    return array.reshape(-1, 3), array.shape[2::-1] if array.ndim == 4 else None


def _kind(kind: str | int | None, connectivity: np.ndarray | None, types: np.ndarray | None) -> int | None:
    """VTK's code of all cells, where they are of one kind."""
    if connectivity is None or types is not None:
        if kind is not None:
            raise Error("kind: it goes with connectivity alone")
        return None
    columns = connectivity.shape[1] if connectivity.ndim == 2 else None
    if kind is None:
        if columns not in OF_COLUMNS:
            raise Error(
                f"connectivity: of shape {connectivity.shape}; give (cells, 4, 5, 6 or 8), or kind, or offsets and types"
            )
        return OF_COLUMNS[columns]
    code = KINDS.get(kind) if isinstance(kind, str) else kind
    if code not in CORNERS:
        raise Error(f"kind: {kind!r} is none of {', '.join(KINDS)}")
    if columns not in (None, CORNERS[code]):
        raise Error(f"connectivity: {columns} columns, and {kind!r} has {CORNERS[code]} corners")
    return code


def _dims(dims: Sequence[int] | None) -> tuple[int, int, int] | None:
    if dims is None:
        return None
    try:
        i, j, k = (int(along) for along in dims)
    except (TypeError, ValueError):
        raise Error(f"dims: {dims!r} is not points along i, j and k") from None
    if min(i, j, k) < 2:
        raise Error(f"dims: {(i, j, k)}; a grid of volumes has two points at least along each axis")
    return i, j, k


def _data(what: str, data: Any, count: int, copied: list[str]) -> dict[str, np.ndarray]:
    if data is None:
        return {}
    named = data.items() if isinstance(data, Mapping) else [("scalars", data)]
    return {str(name): data_array(f"{what} {name!r}", str(name), values, count, copied) for name, values in named}


def data_array(what: str, name: str, values: ArrayLike, count: int, copied: list[str] | None = None) -> np.ndarray:
    """An array with ``count`` rows, of a type that is drawn."""
    array = numeric(what, values)
    dtype = {"b": np.uint8, "f": np.float32 if array.itemsize <= 4 else np.float64}.get(
        array.dtype.kind, array.dtype.newbyteorder("=")
    )
    array = in_place(name, values, array, dtype, copied)
    if array.ndim > 1 and array.shape[0] != count and array.size == count:
        # A value at each point of a grid.
        array = array.reshape(-1)
    if array.ndim == 0 or array.shape[0] != count:
        raise Error(f"{what}: {array.shape[0] if array.ndim else 'no'} rows where {count} are needed")
    return array
