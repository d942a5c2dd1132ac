"""VTK's fixed-point ray caster and cellfan's depth planes on the same volume, views and transfer function: times and their ratio.

The volume is 256³ bytes, smooth and partly empty, made here. Both take samples at the same distance, a ray a pixel, without shading.
VTK: `vtkFixedPointVolumeRayCastMapper`, in 15-bit fixed point, from setting the camera until the picture is there. cellfan: `frames` of
STATS.json. A Markdown table goes to stdout. cellfan has a plane a voxel along the view; VTK's distance is along rays: where a view is
at an angle to the axes, cellfan's planes are nearer together than a voxel's side and its rays are given VTK's distance by `--samples`.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from camera import Camera

ROOT = Path(__file__).resolve().parents[2]
# Value in parts of 255, colour, extinction per voxel.
TRANSFERS = {
    "surfaces": [[0.0, 0.1, 0.2, 0.8, 0.0], [0.35, 0.1, 0.2, 0.8, 0.0], [0.45, 0.9, 0.9, 0.9, 0.05], [0.55, 0.8, 0.5, 0.1, 0.0],
                 [0.8, 0.8, 0.1, 0.1, 0.3], [1.0, 0.8, 0.1, 0.1, 0.3]],
    "fog": [[0.0, 0.1, 0.2, 0.8, 0.0005], [0.5, 0.9, 0.9, 0.9, 0.003], [1.0, 0.8, 0.1, 0.1, 0.02]],
}


def volume(side):
    """Bytes: a few smooth blobs, nothing far from them."""
    random = np.random.default_rng(7)
    axis = np.linspace(-1, 1, side, dtype=np.float32)
    x, y, z = axis[None, None, :], axis[None, :, None], axis[:, None, None]
    total = np.zeros((side, side, side), np.float32)
    for _ in range(24):
        center, width = random.uniform(-0.6, 0.6, 3), random.uniform(0.08, 0.25)
        total += np.exp(-((x - center[0]) ** 2 + (y - center[1]) ** 2 + (z - center[2]) ** 2) / width**2).astype(np.float32)
    return np.clip(total * 140, 0, 255).astype(np.uint8)


def write_nrrd(values, path):
    sides = " ".join(str(side) for side in values.shape[::-1])
    head = f"NRRD0004\ntype: uint8\ndimension: 3\nsizes: {sides}\nspacings: 1 1 1\nencoding: raw\n\n"
    path.write_bytes(head.encode() + values.tobytes())


class Vtk:
    """A window that shows the volume."""

    def __init__(self, values, points, size_px, distance, threads):
        os.environ["LP_NUM_THREADS"] = str(threads)
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk

        self.version = vtk.vtkVersion().GetVTKVersion()
        image = vtk.vtkImageData()
        image.SetDimensions(*values.shape[::-1])
        image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(), deep=1))
        mapper = vtk.vtkFixedPointVolumeRayCastMapper()
        mapper.SetInputData(image)
        mapper.AutoAdjustSampleDistancesOff()
        mapper.SetSampleDistance(distance)
        mapper.SetImageSampleDistance(1)
        mapper.SetNumberOfThreads(threads)
        colors, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
        for value, r, g, b, extinction in points:
            colors.AddRGBPoint(255 * value, r, g, b)
        # Opacity of a voxel's length, in so many points that it is nearly linear between them.
        axis = np.linspace(0, 1, 256)
        for value, extinction in zip(axis, np.interp(axis, [p[0] for p in points], [p[4] for p in points])):
            opacity.AddPoint(255 * value, 1 - np.exp(-extinction))
        prop = vtk.vtkVolume()
        prop.SetMapper(mapper)
        prop.GetProperty().SetColor(colors)
        prop.GetProperty().SetScalarOpacity(opacity)
        prop.GetProperty().SetScalarOpacityUnitDistance(1)
        prop.GetProperty().SetInterpolationTypeToLinear()
        prop.GetProperty().ShadeOff()
        self.renderer, self.window = vtk.vtkRenderer(), vtk.vtkRenderWindow()
        self.renderer.SetBackground(0, 0, 0)
        self.renderer.AddVolume(prop)
        self.mapper = mapper
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(*size_px)
        self.window.AddRenderer(self.renderer)

    def frame(self, camera):
        view = self.renderer.GetActiveCamera()
        start = time.perf_counter()
        view.SetPosition(camera.eye)
        view.SetFocalPoint(camera.target)
        view.SetViewUp(camera.up)
        view.SetViewAngle(camera.fov_degrees)
        self.renderer.ResetCameraClippingRange()
        self.window.Render()
        return (time.perf_counter() - start) * 1e3

    def picture(self):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy

        width, height = self.window.GetSize()
        pixels = vtk.vtkFloatArray()
        self.window.GetRGBAPixelData(0, 0, width - 1, height - 1, 0, pixels)
        return vtk_to_numpy(pixels).reshape(height, width, 4)[::-1, :, :3].copy()


def cellfan(program, mesh, transfer, camera, planes, frames, step_degrees, threads, folder, options):
    camera_path, stats_path, out = folder / "camera.json", folder / "stats.json", folder / "out.npy"
    camera_path.write_text(json.dumps(camera.as_json()))
    command = [str(program), "render", str(mesh), "--quiet", "--method", "depth-planes", "--transfer", str(transfer)]
    command += ["--camera", str(camera_path), "--frames", str(frames), "--orbit", str(frames * step_degrees)]
    command += ["--samples", f"pixels,pixels,{planes}", "--threads", str(threads), "--stats", str(stats_path), "-o", str(out), *options]
    done = subprocess.run(command, check=False, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return json.loads(stats_path.read_text())["frames"], np.load(out).reshape(frames, camera.height, camera.width, 4)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=int, default=256)
    parser.add_argument("--size", type=int, default=1024)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--step", type=float, default=25.0, help="degrees from a view to the next")
    parser.add_argument("--distance", type=float, nargs="+", default=[1.0, 0.5], help="sample distances in voxels")
    parser.add_argument("--cellfan", type=Path, default=ROOT / "target/release/cellfan")
    parser.add_argument("options", nargs="*", help="of cellfan render, after --")
    arguments = parser.parse_args()
    values, side = volume(arguments.side), arguments.side
    bounds = [[0, 0, 0], [side - 1] * 3]
    first = Camera.framing(bounds, 35, 20, (arguments.size, arguments.size))
    print("| transfer function | distance (voxels) | VTK fixed point (ms) | cellfan (ms) | ratio | mean difference |")
    print("| --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        mesh = folder / "volume.nrrd"
        write_nrrd(values, mesh)
        for name, points in TRANSFERS.items():
            transfer = folder / f"{name}.json"
            rows = [{"value": 255 * p[0], "color": p[1:4], "extinction": p[4]} for p in points]
            transfer.write_text(json.dumps({"points": rows}))
            for distance in arguments.distance:
                window = Vtk(values, points, (arguments.size, arguments.size), distance, arguments.threads)
                window.frame(first.orbited(-arguments.step))
                vtk_ms, cellfan_ms, differences = [], [], []
                for number in range(arguments.rounds):
                    camera = first.orbited(number * arguments.step)
                    vtk_ms.append(window.frame(camera))
                    forward = np.subtract(camera.target, camera.eye)
                    forward /= np.linalg.norm(forward)
                    corners = np.array([[x, y, z] for x in (0, side - 1) for y in (0, side - 1) for z in (0, side - 1)])
                    depths = (corners - camera.eye) @ forward
                    planes = int(np.ceil((depths.max() - depths.min()) / distance))
                    # The first frame finds the blocks of the volume, as VTK's first does.
                    times, pictures = cellfan(arguments.cellfan, mesh, transfer, camera, planes, 2, 0.0, arguments.threads, folder, arguments.options)
                    cellfan_ms.append(times[1])
                    differences.append(np.abs(pictures[1][:, :, :3] - window.picture()).mean())
                ratios = [a / b for a, b in zip(vtk_ms, cellfan_ms)]
                print(
                    f"| {name} | {distance} | {statistics.median(vtk_ms):,.0f} | {statistics.median(cellfan_ms):,.0f} | "
                    f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f}) | {np.mean(differences):.4f} |"
                )
    print(f"\nVTK {window.version}, {arguments.size}² pixels, {side}³ bytes, {arguments.threads} threads")


if __name__ == "__main__":
    main()
