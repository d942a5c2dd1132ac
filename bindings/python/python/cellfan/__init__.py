"""Renders volumetric simulation data by projecting its cells, from NumPy arrays and without copies.

>>> import cellfan, numpy as np
>>> points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
>>> cells = np.array([[0, 1, 2, 3]], dtype=np.uint32)
>>> image = cellfan.render(cellfan.Mesh(points, cells, point_data=[0.0, 1.0, 2.0, 3.0]), size=(64, 48))
>>> image.array.shape
(48, 64, 4)

``render`` draws one picture. A ``Session`` draws many of one mesh and keeps what does not change between them.
"""

from ._cellfan import Camera, Cancelled, CancelToken, Error, Image, Transfer, __version__
from ._mesh import Mesh
from ._session import Session, render
from ._vtk import from_pyvista

__all__ = [
    "Camera",
    "CancelToken",
    "Cancelled",
    "Error",
    "Image",
    "Mesh",
    "Session",
    "Transfer",
    "__version__",
    "from_pyvista",
    "render",
]
