"""cellfan's program: a camera and a number of frames in, milliseconds a frame and float pictures out."""

import json
import subprocess
from dataclasses import dataclass

import numpy as np

from meshes import ARRAY


class Failed(Exception):
    """cellfan ended with an error."""


@dataclass(frozen=True)
class Run:
    """`pictures`: frames × height × width × 4, premultiplied; `stats`: STATS.json."""

    frames_ms: list
    pictures: np.ndarray
    stats: dict


def version(program):
    """What `cellfan --version` says."""
    return run([str(program), "--version"]).strip()


def generate(program, arguments, path):
    """Writes a generated mesh, its arrays as they are."""
    run([str(program), "generate", *arguments, "--raw", "-o", str(path)])


def render(program, mesh, transfer, camera, frames, step_degrees, folder, options):
    """Frames of one process, the eye turned by `step_degrees` from one to the next; `options` go to the program as they are."""
    camera_path, stats_path, picture_path = folder / "camera.json", folder / "stats.json", folder / "frames.npy"
    camera_path.write_text(json.dumps(camera.as_json()))
    run([
        *(str(program), "render", str(mesh), "--quiet"),
        *("--array", f"point:{ARRAY}", "--transfer", str(transfer), "--camera", str(camera_path)),
        *("--frames", str(frames), "--orbit", str(frames * step_degrees)),
        *("--stats", str(stats_path), "-o", str(picture_path), *options),
    ])
    stats = json.loads(stats_path.read_text())
    pictures = np.load(picture_path)
    return Run(stats["frames"], pictures.reshape(-1, *pictures.shape[-3:]), stats)


def run(command):
    """Standard output of a command that succeeds."""
    try:
        done = subprocess.run(command, check=False, capture_output=True, text=True)
    except OSError as error:
        raise Failed(f"{command[0]} cannot be run: {error.strerror}") from error
    if done.returncode:
        raise Failed(f"{' '.join(command)}\n{done.stderr.strip()}")
    return done.stdout
