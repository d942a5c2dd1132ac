"""The meshes: what each is, its file, and its points, cells and values.

Every program draws the same file: tetrahedra that `cellfan generate` writes, and curvilinear hexahedra that are written here.
"""

from dataclasses import dataclass

import numpy as np

ARRAY = "value"  # a point array, 0 to 1


@dataclass(frozen=True)
class Spec:
    """How a mesh is made. `generate`: arguments of `cellfan generate`; none for `side`³ curvilinear hexahedra."""

    name: str
    title: str
    file: str
    generate: tuple = ()
    side: int = 0
    wanted_ratio: float = 0  # over VTK's projected tetrahedra, on two cores without a GPU


SPECS = [
    Spec("delaunay241k", "241 k Delaunay tetrahedra", "delaunay241k.vtu", ("delaunay", "--cells", "241000"), 0, 8),
    Spec("delaunay1.3m", "1.3 M Delaunay tetrahedra", "delaunay1.3m.vtu", ("delaunay", "--cells", "1300000"), 0, 12),
    Spec("grid6m", "6 M grid tetrahedra", "grid6m.vtu", ("tets", "--cells", "6000000"), 0, 20),
    Spec("hexahedra1m", "1 M curvilinear hexahedra", "hexahedra1m.vts", (), 100, 20),
]


def make(spec, folder, generate):
    """Writes the mesh into `folder` unless it is there; its path. `generate(arguments, path)` is that of cellfan."""
    path = folder / spec.file
    if not path.exists():
        partial = path.with_name("partial." + path.name)
        if spec.side:
            write_vts(partial, *curvilinear(spec.side))
        else:
            generate(spec.generate, partial)
        partial.rename(path)
    return path


def curvilinear(n):
    """A quarter of a shell of n³ cells, twisted about its axis, as in `benches/frames.rs`: points and values, x fastest.

    The values are the signal of Marschner and Lobb (1994) over the three parameters, as `cellfan generate` has it over the cube.
    """
    share = np.arange(n + 1) / n
    z, y, x = np.meshgrid(share, share, share, indexing="ij")
    angle, radius = np.pi / 2 * x + 0.8 * z, 0.4 + 0.6 * y
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=-1)
    u, v, w = 2 * x - 1, 2 * y - 1, 2 * z - 1
    ring = np.cos(12 * np.pi * np.cos(np.pi / 2 * np.hypot(u, v)))
    values = (1 - np.sin(np.pi / 2 * w) + 0.25 * (1 + ring)) / 2.5
    return (n + 1,) * 3, points.reshape(-1, 3).astype("<f4"), values.reshape(-1).astype("<f4")


def write_vts(path, dims, points, values):
    """A structured grid: little-endian float32, appended raw with 64-bit lengths."""
    extent = " ".join(f"0 {d - 1}" for d in dims)
    blocks = [block.tobytes() for block in (values, points)]
    head = (
        '<?xml version="1.0"?>\n<VTKFile type="StructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">\n'
        f'<StructuredGrid WholeExtent="{extent}"><Piece Extent="{extent}">\n'
        f'<PointData Scalars="{ARRAY}"><DataArray type="Float32" Name="{ARRAY}" format="appended" offset="0"/></PointData>\n'
        '<Points><DataArray type="Float32" Name="Points" NumberOfComponents="3" format="appended" '
        f'offset="{8 + len(blocks[0])}"/></Points>\n</Piece></StructuredGrid>\n<AppendedData encoding="raw">\n_'
    )
    with path.open("wb") as file:
        file.write(head.encode())
        for block in blocks:
            file.write(len(block).to_bytes(8, "little") + block)
        file.write(b"\n</AppendedData></VTKFile>\n")


def hexahedra(dims):
    """The cells of a structured grid: n × 8 points in VTK's order of a hexahedron."""
    nx, ny, nz = dims
    z, y, x = np.meshgrid(np.arange(nz - 1), np.arange(ny - 1), np.arange(nx - 1), indexing="ij")
    first = (x + nx * (y + ny * z)).reshape(-1)
    around = np.array([0, 1, 1 + nx, nx])
    return first[:, None] + np.concatenate([around, around + nx * ny])
