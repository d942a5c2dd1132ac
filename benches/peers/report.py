"""From measured frames to figures: medians, ratios with their spread, errors, and the Markdown table."""

import os
import platform
from pathlib import Path
from statistics import median

import numpy as np


# Above this share of the cores for other programs a figure is called noisy.
NOISY = 0.1


def machine():
    """The processor, how many cores of it are used, memory and what else it does."""
    names = [line.split(":", 1)[1].strip() for line in read("/proc/cpuinfo").splitlines() if line.startswith("model name")]
    memory = [line.split()[1] for line in read("/proc/meminfo").splitlines() if line.startswith("MemTotal")]
    return {
        "cpu": names[0] if names else platform.processor() or platform.machine(),
        "cores": len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count(),
        "memory_gb": round(int(memory[0]) / 1e6, 1) if memory else None,
        "system": platform.platform(),
    }


def read(path):
    return Path(path).read_text() if Path(path).exists() else ""


def errors(pictures, references):
    """Mean and largest difference over pixels, of each the largest of its four channels."""
    worst = np.abs(np.asarray(pictures) - np.asarray(references)).max(axis=1)
    return {"mean": float(worst.mean()), "max": float(worst.max()), "pixels": len(worst)}


def timing(rounds, own):
    """Frames of a program by rounds, and those of cellfan in the same rounds: medians, and the ratio a round.

    A ratio compares what was measured within seconds; the median of rounds is the figure, the least and the greatest its spread.
    """
    ratios = [median(theirs) / median(ours) for theirs, ours in zip(rounds, own) if theirs and ours]
    frames = [ms for frames in rounds for ms in frames]
    return {
        "median_ms": median(frames),
        "least_ms": min(frames),
        "greatest_ms": max(frames),
        "rounds_ms": rounds,
        "ratio": median(ratios),
        "ratio_least": min(ratios),
        "ratio_greatest": max(ratios),
    }


def table(results):
    """Markdown: a row a mesh, a time and an error for each program."""
    peers = list(dict.fromkeys(name for result in results for name in result["programs"] if name != "cellfan"))
    head = ["mesh", "cells", *(f"VTK {peer}, ms" for peer in peers), "cellfan, ms"]
    head += [f"{peer} / cellfan" for peer in peers] + ["projected tetrahedra: wanted"]
    head += [f"error of {name}, mean / max" for name in [*peers, "cellfan"]]
    rows = [head, ["---"] + ["---:"] * (len(head) - 1)]
    for result in results:
        programs = result["programs"]
        cells = f"{result['cells']:,}"
        if result["vtk_tetrahedra"] != result["cells"]:
            cells += f" (VTK: {result['vtk_tetrahedra']:,})"
        row = [result["title"], cells]
        row += [show(programs, name, milliseconds) for name in [*peers, "cellfan"]]
        row += [show(programs, name, ratio) for name in peers]
        row.append(f"{result['wanted_ratio']:g}" if result["wanted_ratio"] else "")
        row += [show(programs, name, error) for name in [*peers, "cellfan"]]
        rows.append(row)
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def head(settings):
    """What the table was measured with."""
    machine, versions = settings["machine"], settings["versions"]
    return (
        f"{machine['cpu']}, {settings['threads']} cores, {machine['memory_gb']} GB; {versions['cellfan']}; VTK {versions['vtk']} "
        f"({versions['window']}, {versions['renderer']}, OpenGL {versions['version']}); {settings['size_px']}², "
        f"{settings['rounds']} rounds of {settings['frames_a_round']} new views. Median (least–greatest); "
        f"ratios: median of rounds.\n"
    )


def notes(results):
    """What a reader of the table has to know, a line each."""
    lines = [""]
    for result in results:
        for name, program in result["programs"].items():
            counts = [len(frames) for frames in program["time"]["rounds_ms"]]
            most = max(len(frames) for frames in result["programs"]["cellfan"]["time"]["rounds_ms"])
            if min(counts) < most:
                lines.append(f"{result['title']}: {name} is slow: {sum(counts)} frame{'s' * (sum(counts) > 1)} only.")
        if result["fields_apart"]:
            apart = result["fields_apart"]
            lines.append(
                f"{result['title']}: cellfan draws hexahedra whole, VTK five tetrahedra each; each is compared with the reference of "
                f"its own field. The two references differ by {apart['mean']:.1e} (mean), {apart['max']:.1e} (largest)."
            )
        busy = result["share_of_cores_taken_by_others"]
        noisy = ": **noisy**" if busy > NOISY else ""
        lines.append(f"{result['title']}: other programs took {busy:.0%} of the cores meanwhile{noisy}.")
    return "\n".join(lines)


def show(programs, name, how):
    return how(programs[name]) if name in programs else "not run"


def milliseconds(program):
    time = program["time"]
    return f"{time['median_ms']:,.0f} ({time['least_ms']:,.0f}–{time['greatest_ms']:,.0f})"


def ratio(program):
    time = program["time"]
    return f"**{time['ratio']:.1f}** ({time['ratio_least']:.1f}–{time['ratio_greatest']:.1f})"


def error(program):
    error = program["error"]
    return f"{error['mean']:.1e} / {error['max']:.1e}" if error else "not measured"
