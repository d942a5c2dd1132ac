"""VTK's projected tetrahedra, its ray caster and cellfan on the same meshes, views and transfer function: times, ratios, errors.

A Markdown table goes to stdout, progress to stderr; `--json` writes every figure. See README.md.
"""

import argparse
import json
import os
import resource
import sys
import tempfile
from datetime import datetime, timezone
from pathlib import Path

import numpy as np

import cellfan_peer
import meshes
import reference
import report
import rounds
import sampling
import vtk_peer
from camera import Camera
from load import Meter
from transfer import TransferFunction

REPOSITORY = Path(__file__).resolve().parents[2]
SEED = 1


def main():
    arguments = parse()
    if not arguments.cellfan.is_file():
        sys.exit(f"there is no {arguments.cellfan}: cargo build --release, or say where it is with --cellfan")
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: arguments.threads])
    try:
        versions = {"cellfan": cellfan_peer.version(arguments.cellfan), **vtk_peer.prepare(arguments.threads)}
        arguments.work.mkdir(parents=True, exist_ok=True)
        results = [compare(spec, arguments) for spec in meshes.SPECS if not arguments.only or spec.name in arguments.only]
    except (vtk_peer.Missing, cellfan_peer.Failed) as error:
        sys.exit(str(error))
    settings = {
        "date": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "machine": report.machine(),
        "versions": versions,
        "threads": arguments.threads,
        "size_px": arguments.size,
        "rounds": arguments.rounds,
        "frames_a_round": arguments.frames,
        "step_degrees": arguments.step,
        "transfer": arguments.transfer.points.tolist(),
        "cellfan_options": arguments.options,
        "peak_rss_gb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6,
    }
    print(report.head(settings))
    print(report.table(results))
    print(report.notes(results))
    if arguments.json:
        arguments.json.write_text(json.dumps({"settings": settings, "results": results}, indent=1) + "\n")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add = parser.add_argument
    names = [spec.name for spec in meshes.SPECS]
    add("--only", action="append", choices=names, help="this mesh alone; may be given again")
    add("--peers", nargs="*", default=["projected tetrahedra", "ray caster"], choices=list(vtk_peer.PEERS), help="VTK's renderers")
    add("--cellfan", type=Path, default=REPOSITORY / "target/release/cellfan", help="the program [default: %(default)s]")
    add("--work", type=Path, default=Path(tempfile.gettempdir()) / "cellfan-peers", help="where meshes are kept [default: %(default)s]")
    add("--rounds", type=positive, default=3)
    add("--frames", type=positive, default=3, help="frames a round that count [default: %(default)s]")
    add("--step", type=float, default=10, help="degrees from a view to the next [default: %(default)s]")
    add("--size", type=positive, default=1024, help="pixels a side [default: %(default)s]")
    add("--threads", type=positive, default=2, help="cores that every program may use [default: %(default)s]")
    add("--samples", type=int, default=600, help="pixels compared with the reference; 0: none [default: %(default)s]")
    slow = "a peer that takes more seconds a frame draws one a round, ten times as many: one in all [default: %(default)s]"
    add("--slow", type=float, default=6, help=slow)
    add("--json", type=Path, help="write all figures here")
    add("options", nargs="*", help="after --: options of cellfan render, such as --sort topological [default: --backend cpu]")
    arguments = parser.parse_args()
    # A bare name would be looked for in PATH.
    arguments.cellfan = arguments.cellfan.resolve()
    arguments.transfer = TransferFunction()
    arguments.options = arguments.options or ["--backend", "cpu"]
    return arguments


def positive(text):
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"{text} is not 1 or more")
    return number


def compare(spec, arguments):
    """All figures of a mesh."""
    say = lambda text: print(f"{spec.name}: {text}", file=sys.stderr, flush=True)
    generate = lambda options, path: cellfan_peer.generate(arguments.cellfan, options, path)
    path = meshes.make(spec, arguments.work, generate)
    grid = vtk_peer.read_tetrahedra(path)
    camera = Camera.framing(np.reshape(grid.GetBounds(), (3, 2)).T, 35, 20, (arguments.size,) * 2)
    plan = rounds.Plan(arguments.rounds, arguments.frames, arguments.step, arguments.slow * 1e3)
    options = ["--threads", str(arguments.threads), *arguments.options]
    meter = Meter()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        arguments.transfer.save(folder / "tf.json")
        draw = lambda camera, frames: cellfan_peer.render(
            arguments.cellfan, path, folder / "tf.json", camera, frames, arguments.step, folder, options
        )
        measured = rounds.measure(plan, camera, grid, arguments.transfer, arguments.peers, arguments.threads, draw, say)
    busy = meter.others()
    own = measured["cellfan"]
    errors, apart = {}, None
    if arguments.samples:
        references = {"tetrahedra": reference.Tetrahedra(*vtk_peer.arrays(grid))}
        if spec.side:
            dims, points, values = meshes.curvilinear(spec.side)
            references["whole"] = reference.Hexahedra(points, meshes.hexahedra(dims), values)
        drawn = {
            name: sampling.Drawn(measured[name].pictures, "tetrahedra", vtk_peer.PEERS[name].ray_px) for name in arguments.peers
        }
        drawn["cellfan"] = sampling.Drawn(own.pictures, "whole" if spec.side else "tetrahedra")
        camera_of = lambda view: plan.view(camera, view)
        errors, apart = sampling.errors(drawn, references, camera_of, arguments.transfer, arguments.samples, SEED, say)
    programs = {
        name: {"time": report.timing(one.rounds_ms, own.rounds_ms), "first_ms": one.warm_up_ms, "error": errors.get(name)}
        for name, one in measured.items()
    }
    return {
        "mesh": spec.name,
        "title": spec.title,
        "cells": own.stats["cells"]["total"],
        "vtk_tetrahedra": grid.GetNumberOfCells(),
        "wanted_ratio": spec.wanted_ratio,
        "camera": camera.as_json(),
        "programs": programs,
        "cellfan_stats": own.stats,
        "fields_apart": apart,
        "share_of_cores_taken_by_others": busy,
    }


if __name__ == "__main__":
    main()
