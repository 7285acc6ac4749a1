"""Fields that Dask computes chunk by chunk, and the values of boxes of a lattice."""

from __future__ import annotations

import concurrent.futures
import dataclasses
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
import raymap
from conftest import make_ball
from helpers import load
from raymap import _lattice
from raymap._cluster import dask_results

load("dask")

SIZES = {"resolution": 40, "bounds": ((-1.3, -1.1, -0.7), (1.2, 1.4, 1.1))}


def half_ball() -> raymap.Mesh:
    """Returns a bowl, across whose wide hole the sign changes far from any surface."""
    vertices, faces = make_ball(2)
    return raymap.Mesh(vertices, faces[vertices[faces, 2].mean(axis=1) < 0])


def turned_ball() -> raymap.Mesh:
    """Returns a ball with faces that point the wrong way, which the surface reverses, and others that are double."""
    vertices, faces = make_ball(2)
    vertices, more = np.concatenate([vertices, 0.4 * vertices]), faces + len(vertices)
    faces = np.concatenate([faces, more[:, ::-1]])
    faces[::9] = faces[::9, ::-1]
    return raymap.Mesh(vertices, faces)


MESHES = {"closed": lambda: raymap.Mesh(*make_ball(2)), "open": half_ball, "turned": turned_ball}


def truth(field: raymap.dask.LazyField, mesh: raymap.Mesh, **options) -> np.ndarray:
    """Returns what the surface says at the samples of a field."""
    samples = np.stack(np.indices(field.distance.shape), axis=-1)
    width = field.clamp_distance or None
    surface = raymap.Surface(mesh, **options)
    return surface.query(np.array(field.origin) + field.spacing * samples, max_distance=width).distance.astype(np.float32)


@pytest.mark.parametrize("band", [None, 2.5])
@pytest.mark.parametrize("name", MESHES)
def test_every_chunking_gives_what_the_surface_says(name: str, band: float | None) -> None:
    mesh = MESHES[name]()
    fields = [raymap.dask.field(mesh, chunks=chunks, band=band, **SIZES) for chunks in (64, 13, (40, 7, 16))]
    wanted = truth(fields[0], mesh)
    assert (wanted < 0).any() and (wanted > 0).any()
    for field in fields:
        assert (field.distance.dtype, field.distance.shape) == (np.float32, wanted.shape)
        np.testing.assert_array_equal(field.distance.compute(), wanted)


def test_unsigned_fields_and_their_lattice() -> None:
    mesh = half_ball()
    field = raymap.dask.field(mesh, chunks=16, band=2, sign=False, orientation="keep", **SIZES)
    np.testing.assert_array_equal(field.distance.compute(), truth(field, mesh, sign=False))
    like = raymap.generate(mesh, **SIZES, device="cpu")
    assert field.distance.shape == like.shape and field.spacing == like.spacing
    assert (field.origin == like.origin).all() and field.clamp_distance == 2 * field.spacing


def test_thin_parts_of_huge_lattices_far_from_zero() -> None:
    """Lattices of more than 2^31 and 2^32 samples, at coordinates of 1e7."""
    vertices, faces = make_ball(2)
    mesh = raymap.Mesh(vertices + (1e7, -1e7, 3), faces)
    for count in 2**18 + 5, 2**19 + 7:
        low = np.array((1e7, -1e7, 3)) - 0.0625 * np.array((count - 37, 31.3, 31.1))
        box = low, low + 0.0625 * np.array((count, 128, 64))
        field = raymap.dask.field(mesh, voxel_size=0.0625, bounds=box, chunks=(256, 128, 64), band=2)
        assert field.distance.shape == (count, 128, 64)
        part = field.distance[count - 70 :, 20:44, 31:33].compute()
        samples = np.stack(np.indices(part.shape), axis=-1) + (count - 70, 20, 31)
        positions = np.array(field.origin) + field.spacing * samples
        wanted = raymap.Surface(mesh).query(positions, max_distance=field.clamp_distance).distance.astype(np.float32)
        np.testing.assert_array_equal(part, wanted)
        assert (part < 0).any() and abs(part).min() < 0.01
        far = field.distance[: count // 2 : count // 3].compute()
        assert (far == np.float32(field.clamp_distance)).all()


def test_threads_of_a_process_share_one_surface(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    class Counted(raymap.Surface):
        def __init__(self, *arguments, **options) -> None:
            made.append(self)
            super().__init__(*arguments, **options)

    monkeypatch.setattr(_lattice, "Surface", Counted)
    monkeypatch.setattr(_lattice, "_prepared", {})
    for mesh in half_ball(), raymap.Mesh(*make_ball(1)), half_ball(), raymap.Mesh(*make_ball(1)):
        raymap.dask.field(mesh, resolution=12, chunks=3).distance.compute(scheduler="threads", num_workers=8)
    assert len(made) == 2
    for size in 1, 2, 3:
        raymap.dask.field(raymap.Mesh(size * make_ball(1)[0], make_ball(1)[1]), resolution=4).distance.compute()
    assert len(made) == 4 and len(_lattice._prepared) == 2


def test_the_mesh_is_that_of_the_call(tmp_path) -> None:
    vertices, faces = make_ball(1)

    class Other:  # As trimesh's
        def __init__(self) -> None:
            self.vertices, self.faces = vertices, faces

    field, file = raymap.dask.field(Other(), resolution=9), raymap.dask.field("ball.ply", resolution=9)
    wanted, of_file = (truth(f, m) for f, m in ((field, raymap.Mesh(vertices, faces)), (file, "ball.ply")))
    vertices *= 2
    (tmp_path / "ball.ply").unlink()
    np.testing.assert_array_equal(field.distance.compute(), wanted)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(file.distance)).compute(), of_file)


def test_a_worker_with_another_version_is_refused() -> None:
    source = _lattice.make_source(half_ball(), True, "auto")
    other = dataclasses.replace(source, version="0.0.9")
    with pytest.raises(raymap.UsageError, match=rf"this machine has raymap {source.version}, but .* has 0\.0\.9; install"):
        _lattice.prepare(other, _lattice.this_machine(), 0)


def test_memory_is_predicted() -> None:
    source = _lattice.make_source(half_ball(), True, "auto")
    surface = _lattice.prepare(source, _lattice.Machine("it", 1, 10**9), 0).surface.stats["bytes"]
    _lattice.prepare(source, _lattice.Machine("it", 2, surface + 2000), 1000)
    with pytest.raises(raymap.MemoryLimitError, match=rf"it: .* {surface:,} bytes and each of 2 threads 1,001.* {surface + 2000:,};"):
        _lattice.prepare(source, _lattice.Machine("it", 2, surface + 2000), 1001)
    assert _lattice.thread_bytes((100, 10, 1)) > 4000


@pytest.mark.parametrize("error", [raymap.Error, *raymap.Error.__subclasses__(), raymap.DeviceMemoryError])
def test_errors_travel_from_workers(error: type[raymap.Error]) -> None:
    core = pytest.importorskip("distributed.core")
    try:
        raise error("what and where")
    except raymap.Error as raised:
        sent = core.error_message(raised)
    kind, found, _ = core.clean_exception(sent["exception"].data)
    assert (kind, str(found)) == (error, "what and where")


@pytest.mark.parametrize("raised, error, text", [
    (ModuleNotFoundError("No module named 'raymap'"), raymap.UsageError, r"lacks raymap.* \(No module named 'raymap'\); install"),
    (RuntimeError("Error during deserialization of the task graph."), raymap.UsageError, "install the same version"),
    (RuntimeError("of the function"), RuntimeError, "of the function"),
    (raymap.FileError("of the function"), raymap.FileError, "of the function"),
    (OSError("Timed out"), raymap.Error, "the scheduler of Dask was lost"),
])  # fmt: skip
def test_errors_of_a_cluster(monkeypatch: pytest.MonkeyPatch, raised: Exception, error: type, text: str) -> None:
    future = concurrent.futures.Future()
    future.key = "key"
    future.set_exception(raised)
    client = SimpleNamespace(map=lambda *arguments, **options: [future])
    monkeypatch.setattr(load("distributed"), "as_completed", iter)
    with pytest.raises(error, match=text):
        list(dask_results(client, print, [0], ["key"]))


@pytest.mark.parametrize("options, text", [
    ({"chunks": 0}, "chunks must be 1 or more, not 0"),
    ({"chunks": (4, 4)}, r"chunks must be a number or \(x, y, z\), not \(4, 4\)"),
    ({"chunks": 2000}, "a chunk of 2000 x 2000 x 2000 samples is too large"),
    ({"band": 0}, "band must be above 0, not 0"),
    ({"resolution": 0}, "resolution must be 1 or more, not 0"),
    ({"resolution": 2**21}, "needs more than 1048576 samples"),
])  # fmt: skip
def test_arguments_that_make_no_sense(options: dict, text: str) -> None:
    with pytest.raises(raymap.UsageError, match=text):
        raymap.dask.field("ball.ply", **options)
