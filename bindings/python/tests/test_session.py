"""What is copied, what is kept, threads, progress, the end of a picture before it is done."""

import _thread
import gc
import signal
import sys
import threading
import time
import weakref

import numpy as np
import pytest

import cellfan
import meshes

SMALL = meshes.large(6)


def mesh_of(points, cells, values):
    return cellfan.Mesh(points, cells, point_data={"value": values})


@pytest.fixture(scope="module")
def large():
    """384,000 cells: a picture takes some tenths of a second."""
    with cellfan.Session(mesh_of(*meshes.large(40)), threads=2) as session:
        yield session


def test_arrays_are_used_in_place():
    points, cells, values = SMALL
    mesh = mesh_of(points, cells, values)
    assert mesh.copied == ()
    assert np.shares_memory(mesh.points, points) and np.shares_memory(mesh.connectivity, cells)
    assert np.shares_memory(mesh.point_data["value"], values)
    with cellfan.Session(mesh) as borrowed:
        held = borrowed.owned_bytes
        wide = cellfan.Mesh(points.astype(np.float64), cells.astype(np.uint64), point_data=values)
        assert wide.copied == ()
        with cellfan.Session(wide) as copied:
            # 12 bytes a point, 16 a cell.
            assert copied.owned_bytes - held >= 12 * len(points) + 16 * len(cells)
            assert np.abs(copied.render(size=(64, 48)).array - borrowed.render(size=(64, 48)).array).max() < 1e-4


def test_what_a_mesh_copies_is_said():
    points, cells, values = SMALL
    assert mesh_of(np.asfortranarray(points), cells, values).copied == ("points",)
    assert mesh_of(points, cells[:, ::-1], values).copied == ("connectivity",)
    assert mesh_of(points, cells, values[::-1]).copied == ("value",)
    assert mesh_of(points.astype(">f4"), cells.astype(np.uint16), values.astype(np.float16)).copied == (
        "points",
        "connectivity",
        "value",
    )
    assert cellfan.Mesh(points[::2][:8], dims=(2, 2, 2)).copied == ("points",)


def test_layouts_give_the_same_picture():
    points, cells, values = SMALL
    expected = cellfan.render(mesh_of(points, cells, values), size=(80, 60)).array
    x, y, z = np.ascontiguousarray(points.T)
    offsets, types = np.arange(0, 4 * len(cells) + 1, 4), np.full(len(cells), 10, np.uint8)
    layouts = [
        cellfan.Mesh((x, y, z), cells, point_data=values),
        cellfan.Mesh(
            tuple(axis.astype(np.float64) for axis in (x, y, z)),
            cells.reshape(-1),
            kind="tetrahedron",
            point_data=values,
        ),
        cellfan.Mesh(points.tolist(), cells.tolist(), point_data=values.tolist()),
        cellfan.Mesh(
            points.astype(np.float64),
            cells.astype(np.int64).reshape(-1),
            offsets,
            types,
            point_data=values.astype(">f8"),
        ),
        cellfan.Mesh(
            points[:, [0, 1, 2]], cells.astype(np.int32)[:, [0, 1, 2, 3]], point_data=np.repeat(values, 2)[::2]
        ),
    ]
    for mesh in layouts:
        assert np.abs(cellfan.render(mesh, size=(80, 60)).array - expected).max() < 1e-4


def test_arrays_live_as_long_as_they_are_drawn():
    class Array(np.ndarray):
        """One that can be watched."""

    def new():
        arrays = [Array(array.shape, array.dtype) for array in SMALL]
        for array, values in zip(arrays, SMALL):
            array[...] = values
        return arrays, [weakref.ref(array) for array in arrays[:2]]

    (points, cells, values), first = new()
    session = cellfan.Session(mesh_of(points, cells, values))
    with pytest.raises(ValueError, match="cannot resize"):
        points.resize((2, 3))
    expected = session.render(size=(64, 48)).array
    del points, cells, values
    gc.collect()
    assert all(ref() is not None for ref in first)
    rubbish = [np.full(SMALL[0].shape, np.nan, np.float32) for _ in range(8)]
    assert np.array_equal(session.render(size=(64, 48)).array, expected)
    del rubbish
    (points, cells, values), second = new()
    session.update_topology(mesh_of(points, cells, values))
    del points, cells, values
    gc.collect()
    assert all(ref() is None for ref in first) and all(ref() is not None for ref in second)
    session.close()
    gc.collect()
    assert all(ref() is None for ref in second)


def test_changes_give_the_picture_of_a_new_session():
    points, cells, values = SMALL
    moved, others = (points * [1.0, 1.3, 0.8]).astype(np.float32), (values**2).astype(np.float64)
    of_cells = meshes.values(points[cells[:, 0]])

    def new(points, **data):
        return cellfan.Session(cellfan.Mesh(points, cells, **data))

    with new(points, point_data=values) as session:
        camera, transfer = session.camera(size=(80, 60)), session.transfer("inferno")
        session.render(camera, transfer)
        session.update_scalars(others)
        found = session.render(camera, transfer)
        assert np.array_equal(found.array, new(points, point_data=others).render(camera, transfer).array)
        again = session.render(camera, transfer)
        assert "sort" not in again.stats["stages_ms"]
        session.update_scalars(of_cells)
        assert np.array_equal(
            session.render(camera, transfer).array, new(points, cell_data=of_cells).render(camera, transfer).array
        )
        session.update_positions(moved)
        assert np.array_equal(
            session.render(camera, transfer).array, new(moved, cell_data=of_cells).render(camera, transfer).array
        )
        session.update_positions(tuple(np.ascontiguousarray(points.T)))
        assert np.array_equal(
            session.render(camera, transfer).array, new(points, cell_data=of_cells).render(camera, transfer).array
        )
        session.update_topology(cellfan.Mesh(meshes.lattice(3), point_data=meshes.values(meshes.lattice(3))))
        assert session.counts["cells"] == 27 and session.render(camera, transfer).stats["drawn"] == 27
    assert session.is_closed


def test_vectors_are_drawn_by_magnitude_or_component():
    points, cells, values = SMALL
    vectors = np.stack([values, -2 * values, 0.5 * values], axis=-1)
    mesh = cellfan.Mesh(points, cells, point_data={"v": vectors})
    assert cellfan.Session(mesh).value_range == pytest.approx(
        (np.linalg.norm(vectors, axis=1).min(), np.linalg.norm(vectors, axis=1).max())
    )
    assert cellfan.Session(mesh, component=1).value_range == pytest.approx((-2 * values.max(), -2 * values.min()))
    with pytest.raises(cellfan.Error, match="no component 3"):
        cellfan.Session(mesh, component=3)


def test_masked_values_leave_out_their_cells():
    points, cells, _ = SMALL
    values = np.ma.masked_less(meshes.values(points[cells[:, 0]]), 0.5)
    image = cellfan.render(cellfan.Mesh(points, cells, cell_data=values), size=(32, 24))
    assert image.stats["invalid"] == values.mask.sum() > 0


def test_images_are_arrays_files_and_pictures(tmp_path):
    image = cellfan.render(mesh_of(*SMALL), size=(40, 30))
    array = np.asarray(image)
    assert array is image.array and array.shape == (30, 40, 4) and array.dtype == np.float32 and image.size == (40, 30)
    assert np.array(image, dtype=np.float64).dtype == np.float64
    assert not np.shares_memory(np.array(image), array)
    for text in (image._repr_png_(), image.to_png(background=(1, 1, 1))):
        assert text.startswith(b"\x89PNG\r\n\x1a\n")
    for name in ("a.png", "a.exr", "a.npy"):
        image.save(tmp_path / name)
        assert (tmp_path / name).stat().st_size > 100
    assert np.array_equal(np.load(tmp_path / "a.npy"), array)
    with pytest.raises(cellfan.Error, match="jpg"):
        image.save(tmp_path / "a.jpg")
    with pytest.raises(OSError):
        image.save(tmp_path / "no folder" / "a.png")


def test_cameras_and_transfer_functions_say_what_they_are():
    camera = cellfan.Camera((5, 0, 0), (0, 0, 0), size=(64, 48), near=0.1)
    assert camera.orbited(90).eye == pytest.approx((0, 5, 0)) and camera.orbited(0) == camera and camera.near == 0.1
    assert cellfan.Camera((5, 0, 0), (0, 0, 0), orthographic_height=2).fov is None
    transfer = cellfan.Transfer([[0, 1, 0, 0, 0], [2, 0, 0, 1, 8]])
    assert transfer(0.5) == ((0.75, 0, 0.25), 2) and transfer.scaled(2).points[1] == (2, (0, 0, 1), 16)
    assert transfer.stretched((0, 4))(1) == transfer(0.5)
    assert transfer == cellfan.Transfer(transfer.points) and "2 points" in repr(transfer)


def test_files_are_read_as_transfer_functions(tmp_path):
    (tmp_path / "tf.csv").write_text("0 1 0 0 0\n2 0 0 1 8\n")
    assert cellfan.Transfer.read(tmp_path / "tf.csv")(0.5) == ((0.75, 0, 0.25), 2)
    (tmp_path / "tf.json").write_text("{")
    with pytest.raises(cellfan.Error, match="tf.json"):
        cellfan.Transfer.read(tmp_path / "tf.json")
    with pytest.raises(FileNotFoundError):
        cellfan.Transfer.read(tmp_path / "none.json")


def test_other_threads_run_while_a_picture_is_drawn(large):
    counted, is_done = 0, threading.Event()

    def count():
        nonlocal counted
        while not is_done.is_set():
            counted += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    before, start = counted, time.perf_counter()
    large.render(large.camera(11, 5))
    elapsed, between = time.perf_counter() - start, counted - before
    is_done.set()
    thread.join()
    # Were the lock held, the other thread could count once or twice.
    assert elapsed > 0.03 and between > 10, (elapsed, between)


def test_a_session_is_used_by_one_thread_at_a_time(large):
    errors, is_drawing = [], threading.Event()

    def ask(_):
        is_drawing.set()

    thread = threading.Thread(target=lambda: large.render(large.camera(12, 5), progress=ask))
    thread.start()
    is_drawing.wait()
    try:
        large.render(size=(16, 16))
    except cellfan.Error as error:
        errors.append(str(error))
    thread.join()
    assert errors and "in use" in errors[0]


def test_two_sessions_draw_side_by_side():
    sessions = [cellfan.Session(mesh_of(*meshes.large(12)), threads=1) for _ in range(2)]
    expected = sessions[0].render(size=(200, 150)).array
    found = [None, None]

    def draw(nth):
        found[nth] = sessions[nth].render(size=(200, 150)).array

    threads = [threading.Thread(target=draw, args=(nth,)) for nth in range(2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all(np.array_equal(array, expected) for array in found)


def test_progress_ascends_on_the_calling_thread(large):
    told = []
    large.render(large.camera(13, 5), progress=lambda share: told.append((share, threading.get_ident())))
    shares = [share for share, _ in told]
    assert shares == sorted(shares) and shares[-1] == 1 and len(shares) > 3
    assert {thread for _, thread in told} == {threading.get_ident()}


def test_an_exception_of_progress_ends_the_picture(large):
    def stop(share):
        raise RuntimeError(f"enough at {share}")

    with pytest.raises(RuntimeError, match="enough"):
        large.render(large.camera(14, 5), progress=stop)
    assert large.render(large.camera(14, 5), size=(64, 48)).stats["drawn"] > 0


def test_a_token_ends_a_picture_from_another_thread(large):
    expected = large.render(large.camera(15, 5)).array
    token, is_drawing = large.cancel_token, threading.Event()

    def cancel():
        is_drawing.wait()
        token.cancel()

    thread = threading.Thread(target=cancel)
    thread.start()
    with pytest.raises(cellfan.Cancelled):
        large.render(large.camera(16, 5), progress=lambda _: is_drawing.set())
    thread.join()
    assert not token.is_cancelled
    assert np.array_equal(large.render(large.camera(15, 5)).array, expected)
    large.cancel()
    with pytest.raises(cellfan.Cancelled):
        large.render(size=(16, 16))


def test_ctrl_c_ends_a_picture(large):
    is_drawing = threading.Event()

    def interrupt():
        is_drawing.wait()
        _thread.interrupt_main()

    # So many pixels that it would take seconds.
    camera, start = large.camera(17, 5, (4000, 3000)), time.perf_counter()
    whole = None
    thread = threading.Thread(target=interrupt)
    # A shell that runs tests in the background has it ignored.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        thread.start()
        with pytest.raises(KeyboardInterrupt):
            large.render(camera, progress=lambda _: is_drawing.set())
            whole = time.perf_counter() - start
    finally:
        signal.signal(signal.SIGINT, before)
    assert whole is None
    thread.join()
    assert large.render(large.camera(17, 5, (64, 48))).stats["drawn"] > 0
