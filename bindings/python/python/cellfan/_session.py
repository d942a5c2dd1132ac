"""`Session` and `render`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ._cellfan import Camera, CancelToken, Error, Image, SessionCore, Transfer
from ._mesh import Mesh, data_array, positions, scalar
from ._vtk import from_pyvista

Progress = Callable[[float], object]


def _mesh(mesh: Any) -> Mesh:
    return mesh if isinstance(mesh, Mesh) else from_pyvista(mesh)


class Session:
    """Draws a mesh again and again, on the CPU, and keeps between pictures what does not change.

    ``mesh`` is a :class:`Mesh`, or anything that :func:`from_pyvista` takes. ``array`` names what is drawn (the mesh's active array by
    default), ``component`` which component of a vector (its magnitude by default). ``threads`` threads draw, 0 for one a core; they
    sleep between pictures, and the interpreter is free while they draw. Calls from several threads at once are errors; ``cancel`` is not.

    The session borrows float32 points of shape (n, 3) that are not far from the origin, and 32-bit connectivity of tetrahedra or
    hexahedra: these arrays must not change until it is closed, or they are replaced. It copies points of other layouts (12 bytes each),
    64-bit connectivity (16 bytes a tetrahedron, 32 a hexahedron), cells of several kinds (20 bytes a tetrahedron, 36 any other cell),
    and 4 bytes a scalar: scalars may change once a call returns.

    >>> session = Session(Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]], cell_data=[0.5]))
    >>> session.render(size=(64, 48)).stats["drawn"]
    1
    >>> session.update_scalars([2.5])
    >>> session.value_range
    (2.5, 2.5)
    """

    def __init__(self, mesh: Any, array: str | None = None, *, component: int | None = None, threads: int = 0) -> None:
        mesh = _mesh(mesh)
        of, values = mesh.scalars(array, component) or (None, None)
        if threads < 0:
            raise Error(f"threads: {threads}; 0 or more")
        self._core = SessionCore(mesh._parts(), of, values, threads)
        self._take(mesh, of)

    def _take(self, mesh: Mesh, of: str | None) -> None:
        self._on, self._rows = of, {"points": mesh.n_points, "cells": mesh.n_cells}

    def update_scalars(self, values: ArrayLike, on: str | None = None) -> None:
        """Draws other values, one a point or one a cell (``on`` is "points" or "cells"; by default as before, else as their number says).

        Those that are not finite leave out their cells. While the camera stays, the next picture needs no sort.
        """
        if on is None:
            rows = np.shape(values)[:1]
            fits = [of for of in (self._on or "points", "points", "cells") if rows == (self._rows[of],)]
            on = fits[0] if fits else self._on or "points"
        if on not in self._rows:
            raise Error(f'scalars on {on!r}: say "points" or "cells"')
        self._core.update_scalars(on, scalar("scalars", data_array("scalars", "scalars", values, self._rows[on])))
        self._on = on

    def update_positions(self, points: ArrayLike | Sequence[ArrayLike]) -> None:
        """Moves the points, as many as there were. They are copied: 12 bytes each."""
        self._core.update_positions(positions(points, [])[0])

    def update_topology(self, mesh: Any, array: str | None = None, *, component: int | None = None) -> None:
        """Draws another mesh; threads, token and the memory of pictures stay. After an error the mesh is that of before."""
        mesh = _mesh(mesh)
        of, values = mesh.scalars(array, component) or (None, None)
        self._core.update_topology(mesh._parts(), of, values)
        self._take(mesh, of)

    def camera(self, azimuth: float = 35.0, elevation: float = 20.0, size: tuple[int, int] = (1024, 768)) -> Camera:
        """A camera that shows the whole mesh, from azimuth and elevation in degrees, +z up."""
        return Camera.framing(self.bounds, azimuth, elevation, size)

    def transfer(self, name: str = "viridis", *, opacity: float = 0.1) -> Transfer:
        """A colour map over the values of now: see :meth:`Transfer.preset`."""
        return Transfer.preset(name, self.value_range, self.diagonal / 100.0, opacity=opacity)

    def render(
        self,
        camera: Camera | None = None,
        transfer: Transfer | str = "viridis",
        *,
        size: tuple[int, int] = (1024, 768),
        model: str = "emission-absorption",
        sort: str = "auto",
        memory_bytes: int | None = None,
        progress: Progress | None = None,
    ) -> Image:
        """Draws one picture; ``size`` is for the default camera.

        ``model`` is "emission-absorption", "absorption", "emission" or "mip"; ``sort`` "auto", "none", "centroid", "power", "topological"
        or "exact". ``memory_bytes`` bounds the session's memory and that of the picture. ``progress`` is called, on this thread, with the
        share that is done; an exception that it raises ends the picture, and so does Ctrl-C. The session can be used on after either.
        """
        camera = self.camera(size=size) if camera is None else camera
        transfer = self.transfer(transfer) if isinstance(transfer, str) else transfer
        return self._core.render(camera, transfer, model, sort, memory_bytes, progress)

    def cancel(self) -> None:
        """Ends the picture that another thread is drawing, or the next: it raises :class:`Cancelled`."""
        self._core.cancel_token.cancel()

    @property
    def cancel_token(self) -> CancelToken:
        """What ends pictures, for other threads to keep."""
        return self._core.cancel_token

    @property
    def bounds(self) -> tuple[float, float, float, float, float, float]:
        """The box around the mesh: smallest x, y, z, then largest."""
        return self._core.bounds

    @property
    def diagonal(self) -> float:
        """Length of the diagonal of that box."""
        return self._core.diagonal

    @property
    def value_range(self) -> tuple[float, float]:
        """Smallest and largest finite scalar."""
        return self._core.value_range

    @property
    def counts(self) -> dict[str, int]:
        """What became of the mesh's cells."""
        return self._core.counts

    @property
    def owned_bytes(self) -> int:
        """Bytes that the session holds beside arrays that it borrows and what pictures were drawn with."""
        return self._core.owned_bytes

    @property
    def is_closed(self) -> bool:
        """Whether :meth:`close` was called."""
        return self._core.is_closed

    def close(self) -> None:
        """Lets go of arrays, memory and threads; every other call is an error then."""
        self._core.close()

    def __enter__(self) -> Session:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def render(
    mesh: Any,
    array: str | None = None,
    *,
    component: int | None = None,
    camera: Camera | None = None,
    view: tuple[float, float] = (35.0, 20.0),
    size: tuple[int, int] = (1024, 768),
    transfer: Transfer | str = "viridis",
    model: str = "emission-absorption",
    sort: str = "auto",
    memory_bytes: int | None = None,
    threads: int = 0,
    progress: Progress | None = None,
) -> Image:
    """Draws one picture of a mesh: a :class:`Mesh`, or anything that :func:`from_pyvista` takes.

    ``view`` is azimuth and elevation in degrees, where no ``camera`` is given. For all else see :class:`Session` and its ``render``.

    >>> cube = Mesh(np.mgrid[0:2, 0:2, 0:2].astype(np.float32).reshape(3, -1).T[:, ::-1], dims=(2, 2, 2))
    >>> render(cube, transfer=Transfer.constant((1, 1, 1), 1.0), size=(32, 32)).size
    (32, 32)
    """
    with Session(mesh, array, component=component, threads=threads) as session:
        camera = session.camera(*view, size) if camera is None else camera
        return session.render(camera, transfer, model=model, sort=sort, memory_bytes=memory_bytes, progress=progress)
