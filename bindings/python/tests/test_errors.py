"""Every argument that is none is an exception, and the session is what it was before."""

import numpy as np
import pytest

import cellfan
import meshes
from cellfan import _cellfan

POINTS, CELLS, VALUES = meshes.large(2)
OFFSETS, TYPES = np.arange(0, CELLS.size + 1, 4), np.full(len(CELLS), 10, np.uint8)


def session(points=POINTS, cells=CELLS, *rest, **keywords):
    return cellfan.Session(cellfan.Mesh(points, cells, *rest, **keywords))


def changed(array, at, value):
    array = array.copy()
    array[at] = value
    return array


MESHES = {
    "no points": ((None, CELLS), {}, "points: None"),
    "no cells": ((POINTS,), {}, "a mesh of what cells"),
    "no numbers": ((np.array([["a", "b", "c"]]), CELLS), {}, "points: an array of <U1"),
    "objects": ((POINTS.astype(object), CELLS), {}, "points: an array of object"),
    "complex": ((POINTS.astype(complex), CELLS), {}, "points: an array of complex128"),
    "ragged": (([[0, 0, 0], [1, 1]], CELLS), {}, "points"),
    "two columns": ((POINTS[:, :2], CELLS), {}, "three columns"),
    "a row": ((POINTS.reshape(-1), CELLS), {}, "three columns"),
    "short points": ((POINTS[:5], CELLS), {}, "only 5 points"),
    "no point": ((POINTS[:0], CELLS), {}, "only 0 points"),
    "not a number": ((changed(POINTS, (3, 1), np.nan), CELLS), {}, "not finite"),
    "infinite": ((changed(POINTS, (3, 1), np.inf), CELLS), {}, "not finite"),
    "a short axis": (
        (tuple(axis[nth:] for nth, axis in enumerate(np.ascontiguousarray(POINTS.T))), CELLS),
        {},
        "coordinates",
    ),
    "index out of range": ((POINTS, changed(CELLS, (5, 2), 999)), {}, "cell 5 refers to point 999"),
    "negative index": ((POINTS, changed(CELLS.astype(np.int64), (5, 2), -3)), {}, "cell 5 refers to point -3"),
    "negative narrow index": ((POINTS, changed(CELLS.astype(np.int16), (5, 2), -3)), {}, "cell 5 refers to point -3"),
    "indices that are not whole": ((POINTS, CELLS.astype(np.float32)), {}, "connectivity: an array of float32"),
    "three corners": ((POINTS, CELLS[:, :3]), {}, "connectivity"),
    "corners left over": ((POINTS, CELLS.reshape(-1)[1:]), {"kind": 10}, "connectivity"),
    "no kind": ((POINTS, CELLS.reshape(-1)), {}, "kind"),
    "unknown kind": ((POINTS, CELLS), {"kind": "cube"}, "'cube'"),
    "kind of other corners": ((POINTS, CELLS), {"kind": "wedge"}, "corners"),
    "no cell": ((POINTS, CELLS[:0]), {}, "no cell with a volume"),
    "flat cells": ((POINTS * np.float32([1, 1, 0]), CELLS), {}, "no cell with a volume"),
    "short offsets": ((POINTS, CELLS.reshape(-1), OFFSETS[:-1], TYPES), {}, "offsets"),
    "offsets that descend": ((POINTS, CELLS.reshape(-1), changed(OFFSETS, 3, 0), TYPES), {}, "cell"),
    "negative offset": ((POINTS, CELLS.reshape(-1), changed(OFFSETS, 3, -1), TYPES), {}, "cell"),
    "offsets beyond the end": ((POINTS, CELLS.reshape(-1), changed(OFFSETS, -1, 10**9), TYPES), {}, "cell"),
    "types without offsets": ((POINTS, CELLS.reshape(-1), None, TYPES), {}, "offsets and types"),
    "types that are not whole": ((POINTS, CELLS.reshape(-1), OFFSETS, TYPES.astype(float)), {}, "types"),
    "other dimensions": ((POINTS,), {"dims": (4, 3, 3)}, "points"),
    "flat dimensions": ((POINTS,), {"dims": (9, 3, 1)}, "dims"),
    "huge dimensions": ((POINTS,), {"dims": (2**31, 2**31, 2**31)}, "points"),
    "too few dimensions": ((POINTS,), {"dims": (3, 9)}, "dims"),
    "dims and cells": ((POINTS, CELLS), {"dims": (3, 3, 3)}, "dims alone"),
    "short point data": ((POINTS, CELLS), {"point_data": VALUES[1:]}, "27 are needed"),
    "long cell data": ((POINTS, CELLS), {"cell_data": {"p": VALUES}}, "'p': 27 rows"),
    "data of objects": ((POINTS, CELLS), {"point_data": VALUES.astype(object)}, "object"),
    "complex data": ((POINTS, CELLS), {"point_data": VALUES.astype(complex)}, "complex"),
    "texts": ((POINTS, CELLS), {"point_data": {"name": VALUES.astype(str)}}, "name"),
    "no data": ((POINTS, CELLS), {"point_data": {"p": None}}, "None"),
    "no finite value": ((POINTS, CELLS), {"point_data": VALUES * np.nan}, "no finite value"),
    "a number": ((POINTS, CELLS), {"point_data": 1.0}, "no rows"),
}


@pytest.mark.parametrize("what", MESHES)
def test_meshes_that_are_none(what):
    arguments, keywords, message = MESHES[what]
    with pytest.raises(cellfan.Error, match=message):
        mesh = cellfan.Mesh(*arguments, **keywords)
        cellfan.Session(mesh)
    if not isinstance(arguments[0], tuple):
        # And where it would replace one that is drawn.
        with session(point_data=VALUES) as drawn:
            expected = drawn.render(size=(24, 18)).array
            with pytest.raises(cellfan.Error):
                drawn.update_topology(cellfan.Mesh(*arguments, **keywords))
            assert np.array_equal(drawn.render(size=(24, 18)).array, expected)


def test_what_is_no_mesh_at_all():
    for nothing in (None, 3, "mesh", POINTS, [], object()):
        with pytest.raises(cellfan.Error, match="no mesh"):
            cellfan.render(nothing)
    with pytest.raises(cellfan.Error, match="no array 'q'; there is: p"):
        cellfan.Session(cellfan.Mesh(POINTS, CELLS, point_data={"p": VALUES}), "q")
    with pytest.raises(cellfan.Error, match="threads"):
        cellfan.Session(cellfan.Mesh(POINTS, CELLS), threads=-1)


def test_updates_that_are_none():
    with session(point_data=VALUES) as drawn:
        expected = drawn.render(size=(24, 18)).array
        for values in (None, "a", VALUES[1:], VALUES[:0], VALUES.astype(object), VALUES * np.nan, 1.0, [[1.0, 2.0]]):
            with pytest.raises(cellfan.Error):
                drawn.update_scalars(values)
        for on in ("cells", "faces"):
            with pytest.raises(cellfan.Error):
                drawn.update_scalars(VALUES, on)
        for points in (
            None,
            "a",
            POINTS[1:],
            POINTS[:, :2],
            POINTS * np.nan,
            POINTS * 0,
            POINTS.astype(object),
            np.zeros((3, 3)),
            [POINTS] * 3,
        ):
            with pytest.raises(cellfan.Error):
                drawn.update_positions(points)
        assert np.array_equal(drawn.render(size=(24, 18)).array, expected)


def test_pictures_that_are_none():
    with session(point_data=VALUES) as drawn:
        for keywords in (
            {"model": "glow"},
            {"sort": "bogo"},
            {"transfer": "jet"},
            {"memory_bytes": 1},
            {"size": (0, 5)},
            {"size": (10**6, 5)},
        ):
            with pytest.raises(cellfan.Error):
                drawn.render(**keywords)
        for keywords in ({"camera": "front"}, {"transfer": 3}, {"progress": 3}, {"size": 5}, {"memory_bytes": "much"}):
            with pytest.raises((TypeError, cellfan.Error)):
                drawn.render(**keywords)
        assert drawn.render(size=(24, 18)).stats["drawn"] == len(CELLS)


def test_cameras_that_are_none():
    for arguments, keywords in [
        (((0, 0, 0), (0, 0, 0)), {}),
        (((np.nan, 0, 0), (0, 0, 0)), {}),
        (((0, 0, 5), (0, 0, 0)), {"up": (0, 0, 1)}),
        (((5, 0, 0), (0, 0, 0)), {"fov": 180}),
        (((5, 0, 0), (0, 0, 0)), {"fov": np.nan}),
        (((5, 0, 0), (0, 0, 0)), {"orthographic_height": 0}),
        (((5, 0, 0), (0, 0, 0)), {"near": -1}),
        (((5, 0, 0), (0, 0, 0)), {"size": (0, 10)}),
    ]:
        with pytest.raises(cellfan.Error):
            cellfan.Camera(*arguments, **keywords)
    for arguments, keywords in [
        ((None, (0, 0, 0)), {}),
        (((0, 0), (0, 0, 0)), {}),
        (((5, 0, 0), (0, 0, 0)), {"size": (-1, 10)}),
    ]:
        with pytest.raises((TypeError, ValueError, OverflowError)):
            cellfan.Camera(*arguments, **keywords)
    with pytest.raises(cellfan.Error):
        cellfan.Camera.framing([np.nan] * 6)


def test_transfer_functions_that_are_none():
    for points in (
        [],
        [(0, (1, 1, 1), -1)],
        [(0, (1, 1, 1), np.nan)],
        [(1, (1, 1, 1), 1), (0, (1, 1, 1), 1)],
        [(0, 1)],
        [None],
        ["a"],
        [(0, "red", 1)],
    ):
        with pytest.raises(cellfan.Error):
            cellfan.Transfer(points)
    with pytest.raises(TypeError):
        cellfan.Transfer(None)
    with pytest.raises(cellfan.Error, match="viridis"):
        cellfan.Transfer.preset("jet", (0, 1), 1)
    with pytest.raises(cellfan.Error):
        cellfan.Transfer.preset("viridis", (1, 0), 1)


def test_a_closed_session_says_so():
    drawn = session(point_data=VALUES)
    drawn.close()
    drawn.close()
    calls = [
        lambda: drawn.render(size=(8, 8)),
        lambda: drawn.update_scalars(VALUES),
        lambda: drawn.update_positions(POINTS),
        lambda: drawn.update_topology(cellfan.Mesh(POINTS, CELLS)),
        lambda: drawn.bounds,
        lambda: drawn.value_range,
        lambda: drawn.counts,
        lambda: drawn.owned_bytes,
    ]
    for call in calls:
        with pytest.raises(cellfan.Error, match="closed"):
            call()
    drawn.cancel()
    assert drawn.is_closed


def test_the_compiled_part_checks_for_itself():
    """What `Mesh` converts is refused below it, where anybody may call."""
    core = _cellfan.SessionCore
    strided = np.asfortranarray(POINTS)
    flat = np.frombuffer(b"\0" * 1 + POINTS.tobytes(), dtype=np.uint8)[1:].view(np.float32).reshape(-1, 3)
    for points in (strided, flat, POINTS.astype(np.float16), POINTS.astype(">f4"), POINTS.tolist(), None):
        with pytest.raises(cellfan.Error):
            core((points, CELLS, None, None, 10, None), None, None, 1)
    for cells in (CELLS[:, ::-1], CELLS.astype(np.int8), CELLS.astype(float), "cells"):
        with pytest.raises(cellfan.Error):
            core((POINTS, cells, None, None, 10, None), None, None, 1)
    for of, scalars in (
        ("points", VALUES[::-1]),
        ("points", VALUES.astype(bool)),
        ("faces", VALUES),
        (None, VALUES),
        ("cells", VALUES),
    ):
        with pytest.raises(cellfan.Error):
            core((POINTS, CELLS, None, None, 10, None), of, scalars, 1)
    for kind in (3, 42, 255):
        with pytest.raises(cellfan.Error):
            core((POINTS, CELLS, None, None, kind, None), None, None, 1)
    for arguments in (
        (),
        (None, None, None, 1),
        ((POINTS,), None, None, 1),
        ((POINTS, CELLS, None, None, 10, None), None, None, -1),
    ):
        with pytest.raises((TypeError, ValueError, OverflowError)):
            core(*arguments)


def test_errors_are_value_errors():
    assert issubclass(cellfan.Error, ValueError) and issubclass(cellfan.Cancelled, cellfan.Error)
    assert cellfan.Error.__module__ == "cellfan"
