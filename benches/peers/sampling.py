"""Pictures against the float64 reference, at random pixels that some program covers."""

from dataclasses import dataclass

import numpy as np

import report

CENTER = (0.0, 0.0)


@dataclass(frozen=True)
class Drawn:
    """What a program drew: `pictures` by view, the name of its `field`, and where in a pixel its rays pass."""

    pictures: dict
    field: str
    ray_px: tuple = (0.0, 0.0)


def errors(drawn, references, camera_of, transfer, samples, seed, say):
    """Name of a program to its errors, over the views of the first round that it drew.

    `drawn`: name of a program to [`Drawn`]; `references`: name of a field to its cells. Also, where there are two fields, how far
    apart they are themselves.
    """
    views = sorted({view for one in drawn.values() for view in one.pictures})
    got, want = {name: [] for name in drawn}, {name: [] for name in drawn}
    apart = {name: [] for name in references}
    for number, view in enumerate(views):
        camera, present = camera_of(view), {name: one for name, one in drawn.items() if view in one.pictures}
        pictures = {name: one.pictures[view] for name, one in present.items()}
        pixels = covered(list(pictures.values()), -(-samples // len(views)), np.random.default_rng([seed, view]))
        say(f"reference: view {number + 1} of {len(views)}, {len(pixels)} pixels")
        for field, cells in references.items():
            boxes = cells.boxes(camera)
            for ray_px in {CENTER, *(one.ray_px for one in present.values() if one.field == field)}:
                exact = [cells.pixel(camera, boxes, *(pixel + ray_px), transfer) for pixel in pixels]
                if ray_px == CENTER:
                    apart[field] += exact
                for name, one in present.items():
                    if (one.field, one.ray_px) == (field, ray_px):
                        got[name] += list(pictures[name][pixels[:, 1], pixels[:, 0]])
                        want[name] += exact
    of_programs = {name: report.errors(got[name], want[name]) for name in drawn}
    return of_programs, report.errors(*apart.values()) if len(apart) == 2 else None


def covered(pictures, count, rng):
    """So many distinct pixels (x, y) where at least one of the pictures shows something."""
    places = np.flatnonzero(np.any([picture[..., 3] > 0 for picture in pictures], axis=0))
    if not len(places):
        raise ValueError("no program drew anything")
    y, x = np.divmod(rng.choice(places, min(count, len(places)), replace=False), pictures[0].shape[1])
    return np.stack([x, y], axis=1)
