"""Fields in Zarr stores, made on this machine."""

from __future__ import annotations

import json
import os
import resource
import shutil
import sys
import threading
from pathlib import Path

import numpy as np
import pytest
import raymap
from data_set import contents, identities
from helpers import load
from raymap import __main__ as command
from raymap._lattice import Machine, make_source
from raymap.zarr import shards, store

zarr = load("zarr")

SIZES = {"resolution": 44, "bounds": ((-1.3, -1.1, -0.7), (1.3, 2.9, 1.1)), "chunks": 8, "shards": 16}


def generate(out: str = "out.zarr", mesh: object = "ball.ply", **options) -> raymap.zarr.Summary:
    return raymap.zarr.generate(mesh, out, **{**SIZES, "band": 2, "threads": 2, **options})


def without_lock(folder: str = "out.zarr") -> dict[str, bytes]:
    """Returns all contents of a store. The lines of the log have no order."""
    found = contents(folder)
    del found["0/.lock"]
    if log := found.get("0/.outside"):
        found["0/.outside"] = b"".join(sorted(log.splitlines(keepends=True)))
    return found


@pytest.mark.parametrize("band", [2, None])
def test_levels_hold_what_the_surface_says_at_their_positions(band: float | None) -> None:
    summary = generate(band=band, pyramid=2, unit="millimeter")
    group = zarr.open_group("out.zarr", mode="r")
    ome = group.attrs["ome"]
    assert ome["version"] == "0.5"
    scales = ome["multiscales"][0]
    assert scales["axes"] == [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]
    surface, shapes = raymap.Surface("ball.ply"), []
    for level, dataset in enumerate(scales["datasets"]):
        array = group[dataset["path"]]
        scale, move = (np.array(step[step["type"]]) for step in dataset["coordinateTransformations"])
        positions = (move + scale * np.stack(np.indices(array.shape), axis=-1))[..., ::-1]
        width = None if band is None else band * scale[0]
        wanted = surface.query(positions, max_distance=width).distance.astype(np.float32)
        np.testing.assert_array_equal(array[:], wanted)
        assert np.isnan(array.fill_value) if band is None else array.fill_value == np.float32(width)
        assert (array.chunks, array.shards, array.metadata.dimension_names) == ((8,) * 3, (16,) * 3, ("z", "y", "x"))
        shapes.append(array.shape)
        if level == 0:
            like = raymap.generate("ball.ply", resolution=44, bounds=SIZES["bounds"], device="cpu")
            assert like.distance.T.shape == array.shape and (like.origin == move[::-1]).all()
            first = move - scale / 2
        assert np.allclose(move - scale / 2, first) and scale[0] == 2**level * like.spacing
    assert shapes == [(20, 44, 29), (10, 22, 15), (5, 11, 8)]
    files = len(list(Path("out.zarr").rglob("c/*/*/*")))
    assert summary[:3] == (15, 15, 15 - files) and (summary.outside > 0) == (band is not None)
    own = group.attrs["raymap"]
    assert (own["complete"], own["inside"], own["band"], own["unit"]) == (True, "negative", band, "millimeter")


@pytest.mark.parametrize("top", [2, 0])
def test_far_shards_are_passed_over(top: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of an open mesh, too, whose sign may change far from its surface."""
    made, ball = [], raymap.load_mesh("ball.ply")
    generate_region = raymap.Surface.generate_region

    def counted(self: raymap.Surface, low: tuple, *arguments, **options) -> raymap.Field:
        made.append(low)
        return generate_region(self, low, *arguments, **options)

    monkeypatch.setattr(raymap.Surface, "generate_region", counted)
    mesh = raymap.Mesh(ball.vertices, ball.faces[ball.vertices[ball.faces, 2].mean(axis=1) < top])
    summary = generate(mesh=mesh, bounds=((-3, -3, -3), (3, 3, 3)), band=1, shards=8)
    assert summary.shards == 216 and summary.shards - summary.outside <= len(made) <= 30
    array = zarr.open_array("out.zarr/0", mode="r")
    step = 6 / 44
    positions = step * (np.stack(np.indices(array.shape), axis=-1)[..., ::-1] - 21.5)
    distance = raymap.Surface(mesh).query(positions, max_distance=step).distance
    np.testing.assert_allclose(array[:], distance, atol=1e-6)


def test_a_second_run_makes_what_is_missing() -> None:
    assert generate().new == 12
    whole, before = without_lock(), identities("out.zarr")
    summary = generate()
    assert summary.new == 0 and identities("out.zarr") == before
    log = Path("out.zarr/0/.outside")
    lines = log.read_text().splitlines()
    assert len(lines) == summary.outside == 4
    log.write_text("\n".join(lines)[:-1])  # A line that was cut off
    missing = sorted(Path("out.zarr").rglob("c/*/*/*"))[3:5]
    for path in missing:
        path.unlink()
    assert generate().new == 3
    after = identities("out.zarr")
    made = {str(path.relative_to("out.zarr")) for path in missing}
    changed = {name for name, identity in before.items() if after[name] != identity}
    assert changed <= made | {"zarr.json", "0/.outside", "0/zarr.json"}
    assert without_lock().keys() == whole.keys()
    del whole["0/.outside"]
    assert whole.items() <= without_lock().items()
    assert generate().outside == 4


def test_a_cancelled_run_goes_on_and_threads_change_nothing() -> None:
    generate("serial.zarr", threads=1)
    done: list[float] = []

    def progress(text: str, share: float) -> bool | None:
        assert text.startswith(f"{len(done) + 1} of 12 shards, ")
        done.append(share)
        return False if len(done) == 5 else None

    with pytest.raises(raymap.Cancelled):
        generate(progress=progress)
    assert done == [k / 12 for k in range(1, 6)]
    assert not zarr.open_group("out.zarr").attrs["raymap"]["complete"]
    assert generate(threads=3).new <= 12 - 5
    assert without_lock() == without_lock("serial.zarr")


def test_a_shard_stops_when_it_is_told() -> None:
    source, stop = make_source("ball.ply", True, "auto"), threading.Event()
    lattice = raymap._lattice.make_lattice(source, 8, None, None, 0.1)
    prepared = raymap._lattice.prepare(source, raymap._lattice.this_machine(), 0)
    box = prepared, lattice, (0, 0, 0), (8, 8, 8), None
    assert raymap._lattice.distances(*box, stop).shape == (8, 8, 8)
    stop.set()
    with pytest.raises(raymap.Cancelled):
        raymap._lattice.distances(*box, stop)


def test_another_field_is_not_touched_unless_overwritten() -> None:
    generate()
    before = contents("out.zarr")
    with pytest.raises(raymap.UsageError, match=r"out.zarr holds another field \(band 2.0 there, 3.0 now; chunks 8 there, 16 now\); .*--overwrite"):
        generate(band=3, chunks=16)
    with pytest.raises(raymap.UsageError, match=r"\(another mesh\)"):
        generate(mesh=raymap.Mesh(raymap.load_mesh("ball.ply").vertices + 1e-6, raymap.load_mesh("ball.ply").faces))
    with pytest.raises(raymap.MemoryLimitError):
        generate(band=3, overwrite=True, memory_limit=1_000_000)
    assert contents("out.zarr") == before
    group = json.loads(before["zarr.json"])
    group["attributes"]["raymap"].update(raymap="0.0.9", key="that of 0.0.9")
    Path("out.zarr/zarr.json").write_text(json.dumps(group))
    with pytest.raises(raymap.UsageError, match=rf"holds another field \(raymap 0\.0\.9 there, {raymap.__version__} now\);"):
        generate()
    assert {**contents("out.zarr"), "zarr.json": b""} == {**before, "zarr.json": b""}
    generate("new.zarr", shards=32)
    generate(shards=32, overwrite=True)
    assert without_lock() == without_lock("new.zarr")


def test_only_stores_are_overwritten() -> None:
    Path("out.zarr").mkdir()
    Path("out.zarr/thesis.txt").write_text("all of it")
    with pytest.raises(raymap.UsageError, match="out.zarr holds something else than a store; choose another folder"):
        generate(overwrite=True)
    assert contents("out.zarr") == {"thesis.txt": b"all of it"}
    Path("begun.zarr/0").mkdir(parents=True)
    for name in "0/.lock", f".zarr.json.tmp{os.geteuid()}-abc":
        Path("begun.zarr", name).touch()
    generate("begun.zarr")
    generate("new.zarr")
    assert contents("begun.zarr").keys() == contents("new.zarr").keys()
    zarr.create_group("other.zarr")
    with pytest.raises(raymap.UsageError, match="other.zarr holds another field"):
        generate("other.zarr")
    generate("other.zarr", overwrite=True)
    Path("file").write_text("a file")
    with pytest.raises(raymap.FileError, match="file"):
        generate("file/out.zarr")
    with pytest.raises(raymap.FileError, match="file"):
        generate("file")


@pytest.mark.parametrize("band", [2, None])
def test_torn_shards_are_errors_and_kept(band: float | None) -> None:
    generate(band=band)
    whole = contents("out.zarr")
    path = sorted(Path("out.zarr").rglob("c/*/*/*"))[-1]
    content = path.read_bytes()
    for torn in b"", content[:100], content[:-1], content + b"0", bytes(len(content)), content[:-132] + b"\xff" * 132:
        path.write_bytes(torn)
        with pytest.raises(raymap.FileError, match=f"{path}: not the whole shard that was written there; remove it"):
            generate(band=band)
        assert path.read_bytes() == torn
    path.unlink()
    assert generate(band=band).new == 1
    assert contents("out.zarr") == whole


def test_a_full_disk_is_an_error_and_the_next_run_goes_on() -> None:
    generate("whole.zarr", band=None)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (9000, limits[1]))  # Larger than metadata, smaller than shards
    try:
        with pytest.raises(raymap.FileError, match=r"out.zarr/0/c/\d/\d/\d: cannot write"):
            generate(band=None)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert 0 < generate(band=None).new <= 12
    assert contents("out.zarr") == contents("whole.zarr")


def test_workers_must_see_the_store() -> None:
    source = make_source("ball.ply", True, "auto")
    levels = [store.Level(raymap._lattice.make_lattice(source, 8, None, None, 0.1), 1.0)]
    other = store.make_store(Path("out.zarr").resolve(), source, levels, 8, 16, None)
    machine = Machine("the worker w", 1, 10**9)
    with pytest.raises(raymap.FileError, match="the worker w sees no store there; all workers must reach it by the same path"):
        shards.make_shard("0/c/0/0/0", source, other, machine)
    generate()
    with pytest.raises(raymap.FileError, match="another run has overwritten the store"):
        shards.make_shard("0/c/0/0/0", source, other, machine)


@pytest.mark.parametrize("options, text", [
    ({"chunks": 9}, "shards must be a multiple of chunks, 9, not 16"),
    ({"shards": 1024}, "shards must be 512 or less, not 1024"),
    ({"unit": "mm"}, "unit must be one of OME-Zarr's, such as meter or millimeter, not 'mm'"),
    ({"orientation": "up"}, "orientation must be one of auto, keep, repair, not 'up'"),
    ({"client": object()}, "threads and memory_limit are those of this machine; set them where workers"),
    ({"client": object(), "threads": None, "memory_limit": 9**9}, "set them where workers of the cluster start"),
    ({"pyramid": -1}, "pyramid must be 0 or more, not -1"),
    ({"band": -1}, "band must be above 0, not -1"),
    ({"resolution": 0}, "resolution must be 1 or more, not 0"),
    ({"bounds": ((1, 1, 1), (0, 2, 2))}, "bounds"),
    ({"bounds": ((0, 0, 0), (1, 1, float("nan")))}, "bounds"),
    ({"bounds": None, "resolution": 2**20}, "make 281,474,976,710,656 shards, but a store holds at most 4,194,304; use"),
])  # fmt: skip
def test_arguments_that_make_no_sense(options: dict, text: str) -> None:
    with pytest.raises(raymap.UsageError, match=text):
        generate(**options)
    assert not Path("out.zarr").exists()


def test_zarr_may_be_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "zarr", None)
    with pytest.raises(raymap.UsageError, match=r"needs the package zarr 3 or later: pip install 'raymap\[zarr\]'"):
        generate()


def test_the_command_line_needs_no_dask(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture) -> None:
    for package in "dask", "distributed":
        monkeypatch.setitem(sys.modules, package, None)
    generate(pyramid=1, unit="meter", orientation="keep", sign=False)
    bounds = [str(value) for corner in SIZES["bounds"] for value in corner]
    arguments = ["field", "ball.ply", "-o", "cli.zarr", "--resolution", "44", "--bounds", *bounds, "--band", "2",
                 "--chunks", "8", "--shards", "16", "--pyramid", "1", "--unit", "meter", "--orientation", "keep",
                 "--unsigned", "--threads", "2", "--memory-limit", "2GB", "--progress", "off"]  # fmt: skip
    assert command.main(arguments) == 0
    attributes = json.loads(Path("cli.zarr/zarr.json").read_text())["attributes"]["raymap"]
    assert attributes["band"] == 2.0
    assert without_lock("cli.zarr") == without_lock()
    assert capfd.readouterr().out.startswith("cli.zarr: 14 shards, 14 of them new, 5 of them all outside and without a file, in ")
    assert command.main(arguments) == 0
    assert capfd.readouterr().out == "cli.zarr was finished before: 14 shards\n"
    assert command.main([*arguments, "--shards", "32"]) == 2
    assert "holds another field (shards 16 there, 32 now)" in capfd.readouterr().err
    assert command.main([*arguments, "--shards", "32", "--overwrite"]) == 0
    assert command.main([*arguments, "--voxel-size", "0.5", "--padding", "0", "--scheduler", "tcp://127.0.0.1:9"]) == 2
    assert "--scheduler needs Dask: pip install 'raymap[dask]'" in capfd.readouterr().err
    shutil.rmtree("cli.zarr")
