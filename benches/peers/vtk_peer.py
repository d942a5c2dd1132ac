"""VTK's renderers of unstructured grids, off screen on software OpenGL: a camera in, milliseconds and a float picture out.

All of them read the opacity of a volume property as an extinction per unit distance (`1 - exp(-opacity length / unit)`), not as the
opacity of a unit; so opacity κ/κmax with the unit 1/κmax is exactly κ. (VTK's ray integrators say so; a test checks it.)
"""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass

from meshes import ARRAY

WINDOW = "vtkOSOpenGLRenderWindow"
PROBE = """
import vtk
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.AddRenderer(vtk.vtkRenderer())
window.Render()
print("\\n".join(line for line in window.ReportCapabilities().splitlines() if line.startswith("OpenGL ")))
"""


class Missing(Exception):
    """VTK or software OpenGL is not there."""


def prepare(threads):
    """Settings that VTK and Mesa read when they are loaded; then VTK's version and the lines of OpenGL that name the device.

    A window is opened in a process of its own first: without a library VTK ends the process.
    """
    os.environ.setdefault("VTK_DEFAULT_OPENGL_WINDOW", WINDOW)
    os.environ["LP_NUM_THREADS"] = str(threads)
    os.environ["VTK_SMP_MAX_THREADS"] = str(threads)
    try:
        import vtk
    except ImportError as error:
        raise Missing(f"VTK cannot be imported ({error}): pip install -r requirements.txt") from error
    probe = subprocess.run([sys.executable, "-c", PROBE], check=False, capture_output=True, text=True)
    lines = [line.split(":", 1) for line in probe.stdout.splitlines() if ":" in line]
    device = {name.removeprefix("OpenGL ").removesuffix(" string"): value.strip() for name, value in lines}
    if probe.returncode or "renderer" not in device:
        tail = (probe.stderr.strip().splitlines() or ["no message"])[-1]
        raise Missing(
            f"VTK opens no off-screen window ({os.environ['VTK_DEFAULT_OPENGL_WINDOW']}): {tail}\n"
            "Software OpenGL is Mesa's libOSMesa.so.8 (Debian: apt install libosmesa6); "
            "or set VTK_DEFAULT_OPENGL_WINDOW=vtkEGLRenderWindow"
        )
    vtk.vtkSMPTools.Initialize(threads)
    return {"vtk": vtk.vtkVersion().GetVTKVersion(), "window": os.environ["VTK_DEFAULT_OPENGL_WINDOW"], **device}


def read_tetrahedra(path):
    """The mesh of a .vtu of tetrahedra, or a .vts cut in five tetrahedra a hexahedron (`vtkDataSetTriangleFilter`)."""
    import vtk

    is_structured = path.suffix == ".vts"
    reader = vtk.vtkXMLStructuredGridReader() if is_structured else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.SetCellArrayStatus("cell_value", 0)
    reader.Update()
    if not is_structured:
        return reader.GetOutput()
    triangulate = vtk.vtkDataSetTriangleFilter()
    triangulate.SetInputConnection(reader.GetOutputPort())
    triangulate.Update()
    return triangulate.GetOutput()


def arrays(grid):
    """Points, cells (m × 4) and values of tetrahedra; the cells and values are VTK's own memory."""
    from vtk.util.numpy_support import vtk_to_numpy

    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray())
    if len(cells) != 4 * grid.GetNumberOfCells():
        raise ValueError("the mesh holds other cells than tetrahedra")
    return (
        vtk_to_numpy(grid.GetPoints().GetData()),
        cells.reshape(-1, 4),
        vtk_to_numpy(grid.GetPointData().GetArray(ARRAY)),
    )


def projected_tetrahedra(_threads):
    """Shirley and Tuchman's, sorted by centres; a float framebuffer where there is one."""
    import vtk

    mapper = vtk.vtkProjectedTetrahedraMapper()
    mapper.UseFloatingPointFrameBufferOn()
    return mapper


def ray_caster(threads):
    """Bunyk's, a ray a pixel, with partial pre-integration: of VTK's integrators the fastest that is right to 8 bits."""
    import vtk

    mapper = vtk.vtkUnstructuredGridVolumeRayCastMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetImageSampleDistance(1)
    mapper.SetNumberOfThreads(threads)
    mapper.SetRayIntegrator(vtk.vtkUnstructuredGridPartialPreIntegration())
    return mapper


def z_sweep(_threads):
    """A sweep along the view axis (Farias, Mitchell, Silva 2000), one thread, with the same integrator."""
    import vtk

    mapper = vtk.vtkUnstructuredGridVolumeZSweepMapper()
    mapper.AutoAdjustSampleDistancesOff()
    mapper.SetImageSampleDistance(1)
    mapper.SetRayIntegrator(vtk.vtkUnstructuredGridPartialPreIntegration())
    return mapper


class Peer:
    """A window that shows a mesh through one mapper."""

    def __init__(self, mapper, grid, transfer, size_px):
        import vtk

        mapper.SetInputData(grid)
        mapper.SetScalarModeToUsePointFieldData()
        mapper.SelectScalarArray(ARRAY)
        unit = 1 / transfer.max_extinction()
        colors, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
        for value, r, g, b, extinction in transfer.points.tolist():
            colors.AddRGBPoint(value, r, g, b)
            opacity.AddPoint(value, extinction * unit)
        volume = vtk.vtkVolume()
        volume.SetMapper(mapper)
        volume.GetProperty().SetColor(colors)
        volume.GetProperty().SetScalarOpacity(opacity)
        volume.GetProperty().SetScalarOpacityUnitDistance(unit)
        volume.GetProperty().SetInterpolationTypeToLinear()
        volume.GetProperty().ShadeOff()
        self.renderer, self.window, self.bounds = vtk.vtkRenderer(), vtk.vtkRenderWindow(), grid.GetBounds()
        self.renderer.SetBackground(0, 0, 0)
        self.renderer.SetBackgroundAlpha(0)
        self.renderer.AddVolume(volume)
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetAlphaBitPlanes(1)
        self.window.SetSize(*size_px)
        self.window.AddRenderer(self.renderer)

    def frame(self, camera):
        """Milliseconds from a changed camera until the picture is finished."""
        view = self.renderer.GetActiveCamera()
        start = time.perf_counter()
        view.SetPosition(camera.eye)
        view.SetFocalPoint(camera.target)
        view.SetViewUp(camera.up)
        view.SetViewAngle(camera.fov_degrees)
        self.renderer.ResetCameraClippingRange(self.bounds)
        self.window.Render()
        self.window.WaitForCompletion()
        return (time.perf_counter() - start) * 1e3

    def picture(self):
        """The last frame: height × width × 4, premultiplied, row 0 on top."""
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy

        width, height = self.window.GetSize()
        pixels = vtk.vtkFloatArray()
        self.window.GetRGBAPixelData(0, 0, width - 1, height - 1, 0, pixels)
        return vtk_to_numpy(pixels).reshape(height, width, 4)[::-1].copy()

    def close(self):
        """Gives back the window and what the mapper holds."""
        self.window.Finalize()
        self.renderer.RemoveAllViewProps()


@dataclass(frozen=True)
class Renderer:
    """One of VTK's: `make(threads)` is its mapper; its rays pass so far right of and below the centres of pixels."""

    make: Callable
    ray_px: tuple = (0.0, 0.0)


PEERS = {
    "projected tetrahedra": Renderer(projected_tetrahedra),
    # Through the lower left corner: there its errors are a half to a third of those at the centre.
    "ray caster": Renderer(ray_caster, (-0.5, 0.5)),
    "z sweep": Renderer(z_sweep),
}
