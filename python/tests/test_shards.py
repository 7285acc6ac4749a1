"""Data sets in shards, plans of runs, tables for pandas, and readers for PyTorch."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
import tarfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import raymap
from conftest import ROOT
from data_set import NAMES, contents, generate, run_module, sample_memory
from helpers import load
from test_dataset import write_gltf

KEYS = ["ball_ply", "deep/tetrahedron_ply", "open_OBJ", "small_ply"]


OPTIONS = {"resolution": 8, "cube": True}


@pytest.fixture(scope="module")
def kept() -> dict[str, bytes]:
    """Contents of a folder of results: those of the first test that needs them."""
    return {}


@pytest.fixture
def fields(meshes: Path, kept: dict[str, bytes]) -> Path:
    if not kept:
        generate(meshes, **OPTIONS)
        kept |= contents("out")
    for name, content in kept.items():
        Path("out", name).parent.mkdir(parents=True, exist_ok=True)
        Path("out", name).write_bytes(content)
    return Path("out")


def test_shards_hold_results_and_markers_as_webdataset_reads_them(fields: Path) -> None:
    packed = raymap.dataset.pack(fields, "shards", samples=3)
    assert packed == (2, 2, NAMES)
    members: dict[str, bytes] = {}
    for shard, count in (("shard-000000.tar", 6), ("shard-000001.tar", 2)):
        with tarfile.open(f"shards/{shard}") as archive:
            found = archive.getmembers()
            assert len(found) == count and all(info.mtime == 0 and info.uid == 0 for info in found)
            members |= {info.name: archive.extractfile(info).read() for info in found}  # type: ignore[union-attr]
    assert list(members) == [f"{key}.{ending}" for key in KEYS for ending in ("npz", "json")]
    for key, name in zip(KEYS, NAMES):
        assert members[f"{key}.npz"] == Path(f"out/{name}.npz").read_bytes()
        assert json.loads(members[f"{key}.json"]) == json.loads(Path(f"out/{name}.json").read_bytes())
    index = json.loads(Path("shards/index.json").read_bytes())
    for shard in index["shards"]:
        content = Path("shards", shard["name"]).read_bytes()
        for sample in shard["samples"]:
            part = content[sample["start"] : sample["start"] + sample["bytes"]]
            assert part == Path(f"out/{sample['name']}.npz").read_bytes()


def test_zarr_arrays_have_the_mesh_as_first_axis(fields: Path) -> None:
    zarr = load("zarr")
    assert raymap.dataset.pack(fields, "shards", samples=3, format="zarr") == (2, 2, NAMES)
    group = zarr.open_group("shards", mode="r")
    results = [dict(np.load(f"out/{name}.npz")) for name in NAMES]
    assert sorted(group.array_keys()) == sorted(results[0])
    for name, array in group.arrays():
        stacked = np.stack([result[name] for result in results])
        assert array.dtype == stacked.dtype and array.shape == stacked.shape
        np.testing.assert_array_equal(array[:], stacked)
    assert group["distance"].chunks == (1, 8, 8, 8) and group["distance"].shards == (3, 8, 8, 8)
    assert group["distance"].metadata.dimension_names == ("mesh", "x", "y", "z") and group["spacing"].chunks == (3,)
    about = group.attrs["raymap"]
    assert [shard["meshes"] for shard in about["shards"]] == [NAMES[:3], NAMES[3:]] and about["complete"] is True
    assert about["inside"] == "negative" and about["options"]["resolution"] == 8 and about["raymap"] and about["what"] == "field"
    files = {name for shard in about["shards"] for name in shard["files"]}
    assert {name for name in contents("shards") if not name.endswith("zarr.json")} == files


def test_the_index_of_a_run_that_was_stopped_last_is_completed(fields: Path) -> None:
    load("zarr")
    raymap.dataset.pack(fields, "shards", samples=3, format="zarr")
    before, index = contents("shards"), Path("shards/zarr.json")
    index.write_text(index.read_text().replace('"complete": true', '"complete": false'))
    assert index.read_bytes() != before["zarr.json"]
    Path("shards/distance/zarr.json").unlink()
    assert raymap.dataset.pack(fields, "shards", samples=3, format="zarr").new == 0
    assert contents("shards") == before


def test_zarr_arrays_are_the_same_for_any_number_of_threads(fields: Path) -> None:
    load("zarr")
    for threads in (1, 3):
        raymap.set_threads(threads)
        raymap.dataset.pack(fields, f"shards{threads}", samples=3, format="zarr")
    raymap.set_threads(None)
    assert contents("shards1") == contents("shards3")


FORMATS = ["tar", "zarr"]


def shard_files(number: int, folder: str = "shards") -> list[Path]:
    """Returns the files of a shard of one result."""
    names = (f"shard-{number:06d}.tar", f"distance/c/{number}/0/0/0", f"spacing/c/{number}")
    return [path for name in names if (path := Path(folder, name)).exists()]


@pytest.mark.parametrize("format", FORMATS)
def test_shards_are_written_again_only_where_something_changed(fields: Path, meshes: Path, format: str) -> None:
    load("zarr")
    raymap.dataset.pack(fields, "shards", samples=1, format=format)
    before = contents(Path("shards"))
    assert raymap.dataset.pack(fields, "shards", samples=1, format=format).new == 0
    torn, lost = shard_files(2)[0], shard_files(3)[-1]
    torn.write_bytes(torn.read_bytes()[:100])
    lost.unlink()
    assert raymap.dataset.pack(fields, "shards", samples=1, format=format).new == 2
    assert contents(Path("shards")) == before
    ball = raymap.load_mesh(meshes / "small.ply")
    raymap.Mesh(ball.vertices * 2, ball.faces).save(meshes / "small.ply")
    generate(meshes, **OPTIONS)
    assert raymap.dataset.pack(fields, "shards", samples=1, format=format).new == 1
    for path in Path("out").glob("small.ply.*"):
        path.unlink()
    assert raymap.dataset.pack(fields, "shards", samples=1, format=format) == (3, 0, NAMES[:3])
    assert shard_files(2) and not shard_files(3)


def test_tars_of_another_size_take_the_place_of_others(fields: Path) -> None:
    raymap.dataset.pack(fields, "shards", samples=1)
    assert raymap.dataset.pack(fields, "shards", samples=4).new == 1
    assert sorted(contents(Path("shards"))) == ["index.json", "shard-000000.tar"]


@pytest.mark.parametrize("format", FORMATS)
def test_a_stopped_run_goes_on(fields: Path, monkeypatch: pytest.MonkeyPatch, format: str) -> None:
    load("zarr"), load("torch")
    raymap.dataset.pack(fields, "whole", samples=1, format=format)
    storage = sys.modules["raymap.dataset.storage"].LocalFolder
    original = storage.put
    last = shard_files(2, "whole")[0].relative_to("whole")

    def put(self, path: Path, name: str) -> None:
        if name == str(last):
            raise KeyboardInterrupt
        original(self, path, name)

    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(storage, "put", put)
        raymap.dataset.pack(fields, "shards", samples=1, format=format)
    assert shard_files(0) and shard_files(1) and not Path("shards", last).exists()
    assert len(raymap.torch.ResultDataset("shards")) == 2
    assert raymap.dataset.pack(fields, "shards", samples=1, format=format).new == 2
    assert contents(Path("shards")) == contents(Path("whole"))
    shard_files(1)[0].unlink(), shard_files(2)[0].unlink()
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(storage, "put", put)
        raymap.dataset.pack(fields, "shards", samples=1, format=format)
    data = raymap.torch.ResultDataset("shards")
    assert len(data) == 4 and [data[k]["name"] for k in (0, 1, 3)] == [NAMES[k] for k in (0, 1, 3)]


@pytest.mark.parametrize("format", FORMATS)
def test_shards_behind_an_url(fields: Path, format: str) -> None:
    load("fsspec"), load("zarr")
    files = sys.modules["fsspec"].filesystem("memory")
    if files.exists("/bucket/shards"):
        files.rm("/bucket/shards", recursive=True)
    raymap.dataset.pack(fields, "shards", samples=3, format=format)
    assert raymap.dataset.pack(fields, "memory://bucket/shards", samples=3, format=format).new == 2
    assert raymap.dataset.pack(fields, "memory://bucket/shards", samples=3, format=format).new == 0
    for name, content in contents(Path("shards")).items():
        assert files.cat_file(f"/bucket/shards/{name}") == content
    load("torch")
    remote, local = (raymap.torch.ResultDataset(place) for place in ("memory://bucket/shards", "shards"))
    for k in range(4):
        np.testing.assert_array_equal(remote[k]["distance"], local[k]["distance"])
    assert not [path for path in Path().iterdir() if path.name.startswith(".")]
    with pytest.raises(raymap.FileError, match="memory://bucket/none: there are no shards here"):
        raymap.torch.ResultDataset("memory://bucket/none")
    with pytest.raises(raymap.FileError, match="nothing://bucket"):
        raymap.dataset.pack(fields, "nothing://bucket")


def test_meshes_behind_an_url(fields: Path, meshes: Path) -> None:
    files = load("fsspec").filesystem("memory")
    for name in NAMES:
        files.pipe_file(f"/bucket/meshes/{name}", (meshes / name).read_bytes())
    assert raymap.dataset.generate("memory://bucket/meshes", "out", **OPTIONS).new == []  # They are those of the folder.
    ball = raymap.dataset.generate("memory://bucket/meshes/ball.ply", "one", workers=1, **OPTIONS)
    assert ball.new == ["ball.ply"] and Path("one/ball.ply.npz").read_bytes() == Path("out/ball.ply.npz").read_bytes()
    files.rm("/bucket/meshes/small.ply")
    given = [f"memory://bucket/meshes/{name}" for name in ("ball.ply", "small.ply")]
    plan = raymap.dataset.generate(given, "out", dry_run=True, **OPTIONS)
    assert plan.done == ["ball.ply"] and plan.unfinished == ["small.ply"] and plan.new == []
    with pytest.raises(raymap.UsageError, match="memory://bucket/nothing: no meshes here"):
        raymap.dataset.generate("memory://bucket/nothing", "out")


def test_a_mesh_behind_an_url_brings_its_buffers() -> None:
    files = load("fsspec").filesystem("memory")
    Path("scenes").mkdir()
    write_gltf(Path("scenes/scene.gltf"), "the%20corners.bin")
    for path in Path("scenes").iterdir():
        files.pipe_file(f"/bucket/scenes/{path.name}", path.read_bytes())
    url = "memory://bucket/scenes"
    assert generate(url, workers=1).done == ["scene.gltf"] and generate("scenes").new == []
    files.rm("/bucket/scenes/the corners.bin")
    assert generate(url, workers=1).quarantined == ["scene.gltf"]
    scene = Path("scenes/scene.gltf").read_bytes()
    for odd in (b"../corners.bin", b"a\\u0000b"):
        files.pipe_file("/bucket/scenes/scene.gltf", scene.replace(b"the%20corners.bin", odd))
        assert generate(url, workers=1).quarantined == ["scene.gltf"]


def test_what_cannot_be_packed(fields: Path, meshes: Path) -> None:
    with pytest.raises(raymap.UsageError, match="no finished points here"):
        raymap.dataset.pack(fields, "shards", what="points")
    with pytest.raises(raymap.UsageError, match="samples must be 1 or more, not 0"):
        raymap.dataset.pack(fields, "shards", samples=0)
    with pytest.raises(raymap.UsageError, match="format must be 'tar' or 'zarr', not 'zip'"):
        raymap.dataset.pack(fields, "shards", format="zip")
    with pytest.warns(raymap.RaymapWarning):
        raymap.dataset.generate([meshes / "ball.ply"], "out", resolution=9)
    with pytest.raises(raymap.UsageError, match="ball.ply and deep/tetrahedron.ply are results of different options"):
        raymap.dataset.pack(fields, "other")
    generate(meshes, **OPTIONS)
    result = Path("out/small.ply.npz")
    result.write_bytes(result.read_bytes()[:-1])
    with pytest.raises(raymap.InputError, match="small.ply.npz: not as it was when it was finished"):
        raymap.dataset.pack(fields, "other")


def test_two_meshes_with_one_key(meshes: Path) -> None:
    (meshes / "ball.ply").rename(meshes / "small_ply.ply")
    (meshes / "small.ply").rename(meshes / "small.ply.ply")
    generate(meshes, resolution=8)
    with pytest.raises(raymap.UsageError, match="small.ply.ply and small_ply.ply would both be small_ply_ply"):
        raymap.dataset.pack("out", "shards")


def test_a_dry_run_writes_nothing(meshes: Path) -> None:
    plan = generate(meshes, dry_run=True)
    assert plan.new == plan.unfinished == NAMES and plan.done == [] and not Path("out").exists()
    generate(meshes)
    before = contents(Path("out"))
    (meshes / "small.ply").write_bytes((meshes / "ball.ply").read_bytes())
    plan = generate(meshes, dry_run=True)
    assert plan.new == plan.unfinished == ["small.ply"] and plan.done == NAMES[:3]
    ran = run_module("dataset", meshes, "-o", "out", "--resolution", 16, "--dry-run")
    assert ran.stdout == "3 done, 0 quarantined; 1 to make\n" and ran.returncode == 0, ran.stderr
    assert contents(Path("out")) == before


def test_the_command_packs(fields: Path) -> None:
    load("zarr")
    ran = run_module("pack", "out", "-o", "shards", "--samples", 2, "--format", "zarr", "--what", "field")
    assert ran.stdout == "4 results in 2 shards, 2 of them new\n", ran.stderr
    assert len(raymap.dataset.pack("out", "shards", samples=2, format="zarr").meshes) == 4


def test_pandas_reads_whole_numbers_as_such(meshes: Path) -> None:
    pandas, _ = load("pandas"), load("pyarrow")
    (meshes / "bad.ply").write_text("no mesh")
    generate(meshes, resolution=8, table="table.parquet")
    for table in (pandas.read_parquet("table.parquet"), pandas.read_csv("out/table.csv", dtype_backend="numpy_nullable")):
        rows = table.set_index("mesh")
        assert str(rows["triangles"].dtype) == "Int64" and str(rows["watertight"].dtype) == "boolean"
        assert rows["triangles"]["ball.ply"] == 1280 and rows["triangles"].isna()["bad.ply"]
        assert rows["spacing"].dtype.kind == "f" and rows["watertight"].sum() == 3


@pytest.mark.parametrize("format", FORMATS)
@pytest.mark.parametrize(
    "change",
    [
        lambda index: [],
        lambda index: {**index, "shards": [{}]},
        lambda index: {**index, "shards": 3},
        lambda index: {**index, "shards": [{**index["shards"][0], "identity": None}]},
        lambda index: {**index, "samples": 0, "shards": [{**index["shards"][0], "samples": [], "meshes": []}]},
        lambda index: {**index, "shards": [{**index["shards"][0], "bytes": 9, "files": {"x": 9}}]},
    ],
)
def test_torn_indices(fields: Path, format: str, change: Callable[[Any], Any]) -> None:
    load("zarr"), load("torch")
    raymap.dataset.pack(fields, "shards", format=format)
    path = Path("shards", "index.json" if format == "tar" else "zarr.json")
    found = json.loads(path.read_bytes())
    changed = change(found) if format == "tar" else {**found, "attributes": {"raymap": change(found["attributes"]["raymap"])}}
    for content in (json.dumps(changed), path.read_text()[:-9]):
        path.write_text(content)
        for call in (lambda: raymap.dataset.pack(fields, "shards", format=format), lambda: raymap.torch.ResultDataset("shards")):
            with pytest.raises(raymap.InputError, match=f"{path.name}: no index of shards; remove it, and pack again"):
                call()


def test_what_cannot_be_stacked(fields: Path, meshes: Path) -> None:
    load("zarr")
    raymap.dataset.pack(fields, "tars")
    with pytest.raises(raymap.UsageError, match="tars holds shards of the format tar; choose another folder, or remove it"):
        raymap.dataset.pack(fields, "tars", format="zarr")
    raymap.dataset.pack(fields, "arrays", format="zarr")
    with pytest.raises(raymap.UsageError, match="arrays holds shards of the format zarr"):
        raymap.dataset.pack(fields, "arrays")
    with pytest.raises(raymap.UsageError, match="arrays holds shards of other arrays, or of 1000 samples each, not 2; choose"):
        raymap.dataset.pack(fields, "arrays", samples=2, format="zarr")
    ball = raymap.load_mesh(meshes / "ball.ply")
    raymap.Mesh(ball.vertices * (1, 1, 0.5), ball.faces).save("flat.ply")
    generate([meshes / "ball.ply", "flat.ply"], "other", resolution=8)
    text = r"ball.ply has distance \[8, 8, 8\], flat.ply has \[8, 8, 5\]: Zarr arrays stack results of one shape; make them"
    with pytest.raises(raymap.UsageError, match=text):
        raymap.dataset.pack("other", "stacked", format="zarr")
    assert not Path("stacked").exists()


def test_results_that_changed_their_arrays_cannot_be_stacked(fields: Path) -> None:
    load("zarr")
    path = Path("out/small.ply.npz")
    arrays = dict(np.load(path))
    for change, text in (
        ({"spacing": np.float32(1)}, "spacing .. <f8, small.ply has spacing .. <f4"),
        ({"more": np.zeros(3)}, "no more, small.ply has more .3. <f8"),
        ({"more": np.array(["a"])}, "small.ply.npz: a Zarr array cannot hold more, <U1 of the shape .1,.; leave it out"),
    ):
        np.savez(path, **{**arrays, **change})
        marker = json.loads(Path("out/small.ply.json").read_bytes())
        Path("out/small.ply.json").write_text(json.dumps({**marker, "bytes": path.stat().st_size}))
        with pytest.raises(raymap.UsageError, match=text):
            raymap.dataset.pack(fields, "shards", format="zarr")


@pytest.mark.parametrize("format", [None, *FORMATS])
def test_results_as_a_dataset(fields: Path, format: str | None) -> None:
    torch, _ = load("torch"), load("zarr")
    place = fields if format is None else "shards"
    if format is not None:
        raymap.dataset.pack(fields, "shards", samples=3, format=format)
    data = raymap.torch.ResultDataset(place, arrays="distance")
    assert len(data) == 4 and [data[k]["name"] for k in range(4)] == NAMES
    batch = next(iter(torch.utils.data.DataLoader(data, batch_size=4)))
    assert batch["distance"].shape == (4, 8, 8, 8) and batch["distance"].dtype == torch.float32
    whole = pickle.loads(pickle.dumps(raymap.torch.ResultDataset(place)))
    for k, name in enumerate(NAMES):
        np.testing.assert_array_equal(batch["distance"][k], raymap.load_field(f"out/{name}.npz").distance)
        stored, item = np.load(f"out/{name}.npz"), whole[k]
        assert item.keys() == {"name", *stored}
        for array in stored:
            np.testing.assert_array_equal(item[array], stored[array])
    with pytest.raises(raymap.UsageError, match="the result of ball.ply has no array 'winding'"):
        raymap.torch.ResultDataset(place, arrays=("winding",))[0]


@pytest.mark.parametrize("package, shown", [("numcodecs", "numcodecs"), ("google_crc32c", "google-crc32c")])
def test_zarr_arrays_without_a_package(fields: Path, monkeypatch: pytest.MonkeyPatch, package: str, shown: str) -> None:
    load("zarr"), load("torch")
    raymap.dataset.pack(fields, "shards", format="zarr")
    data = raymap.torch.ResultDataset("shards")
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(raymap.UsageError, match=f"this needs the package {shown}: pip install 'raymap.zarr.'"):
        data[0]


@pytest.mark.parametrize(
    "format, file",
    [
        (None, "out/open.OBJ.npz"),
        ("tar", "shards/shard-000000.tar"),
        ("zarr", "shards/distance/c/0/0/0/0"),
        ("zarr", "shards/spacing/c/0"),
    ],
)
def test_shards_torn_by_force(fields: Path, format: str | None, file: str) -> None:
    load("torch"), load("zarr")
    place = fields if format is None else "shards"
    if format is not None:
        raymap.dataset.pack(fields, "shards", samples=3, format=format)
    path = Path(file)
    content = path.read_bytes()
    samples = np.load("out/open.OBJ.npz")["distance"].tobytes("F")
    end = len(content) - 70 if format == "zarr" else content.index(samples)
    flipped = bytearray(content)
    flipped[end] ^= 255
    readers = [raymap.torch.ResultDataset(place) for _ in range(4)]
    for bad, reader in zip((bytes(flipped), content[: end + 1], b""), readers):
        path.write_bytes(bad)
        with pytest.raises(raymap.InputError, match=f"{file}: the result of open.OBJ is torn .*write it again"):
            reader[2]
    path.unlink()
    with pytest.raises(raymap.FileError, match=f"{file}: no such file, so there is no result of open.OBJ; write it again"):
        readers[3][2]


def test_a_tar_that_lacks_a_member(fields: Path) -> None:
    load("torch")
    raymap.dataset.pack(fields, "shards", samples=4)
    with tarfile.open("shards/shard-000000.tar") as archive, tarfile.open("other.tar", "w", format=tarfile.PAX_FORMAT) as other:
        for member in archive.getmembers():
            if not member.name.startswith("open"):
                other.addfile(member, archive.extractfile(member))
    Path("other.tar").replace("shards/shard-000000.tar")
    data = raymap.torch.ResultDataset("shards")
    assert data[1]["name"] == "deep/tetrahedron.ply"
    with pytest.raises(raymap.InputError, match="result of open.OBJ is torn .open_OBJ.npz is not where index.json says"):
        data[2]
    with pytest.raises(raymap.InputError, match="result of small.ply is torn .small_ply.npz is not where"):
        data[3]


@pytest.mark.parametrize("format", FORMATS)
def test_a_stream_has_every_result_once_in_one_order(fields: Path, format: str) -> None:
    torch, _ = load("torch"), load("zarr")
    raymap.dataset.pack(fields, "shards", samples=2, format=format)

    def names(workers: int = 0, epoch: int = 0, **options) -> list[str]:
        stream = raymap.torch.ResultStream("shards", "distance", **options)
        stream.set_epoch(epoch)
        return [item["name"] for item in torch.utils.data.DataLoader(stream, batch_size=None, num_workers=workers)]

    order = names()
    assert sorted(order) == NAMES and {frozenset(order[:2]), frozenset(order[2:])} == {frozenset(NAMES[:2]), frozenset(NAMES[2:])}
    assert names(workers=2) == order
    assert any(names(epoch=epoch) != order for epoch in range(1, 6)) and any(names(seed=seed) != order for seed in range(1, 6))
    assert names(rank=0, ranks=2) == order[::2] and names(rank=1, ranks=2, workers=2) == order[1::2]


def test_epochs_are_the_same_for_any_workers(fields: Path) -> None:
    load("torch"), load("zarr")
    for format in FORMATS:
        raymap.dataset.pack(fields, format, samples=3, format=format)
    program, workers = ROOT / "python/tests/stream_samples.py", ["fork:1", "fork:4", "spawn:2", "0"]
    ran = subprocess.run([sys.executable, str(program), *workers], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    found: dict[str, list[list[str]]] = {}
    for name, _, *hashes in map(str.split, ran.stdout.splitlines()):
        found.setdefault(name, []).append(hashes)
    assert found.keys() == {"stream:samples", "stream:tar", "stream:zarr", "dataset"}
    for hashes in found.values():
        assert hashes == [hashes[0]] * len(workers) and len(set(hashes[0])) == 2  # Epochs differ.


def test_surfaces_are_kept_within_the_memory_limit(ball: raymap.Mesh) -> None:
    load("torch")
    meshes = [raymap.Mesh(ball.vertices * size, ball.faces) for size in (1.0, 2.0, 3.0)]
    need = raymap.Surface(meshes[0]).nbytes
    small, large = (raymap.torch.SurfaceSamples(meshes, blocks=2, block=20, memory_limit=limit) for limit in (4 * need, 1 << 30))
    for one, other in zip(small, large, strict=True):
        assert one["mesh"] == other["mesh"] and one["points"].shape == (20, 3)
        np.testing.assert_array_equal(one["points"], other["points"])
        np.testing.assert_allclose(one["distance"], one["points"].norm(dim=1) - (one["mesh"] + 1), atol=0.05)
    assert len(small._kept) == 2 and len(large._kept) == 3
    assert [item["mesh"] for item in large][:3] == [item["mesh"] for item in large][3:]
    with pytest.raises(raymap.UsageError, match="meshes: there is none"):
        raymap.torch.SurfaceSamples([])
    with pytest.raises(raymap.UsageError, match="rank must be 1 or less, not 2"):
        raymap.torch.SurfaceSamples(meshes, rank=2, ranks=2)


def test_a_stream_keeps_to_its_memory_limit(large_ball: raymap.Mesh) -> None:
    """Six meshes of 13 MB each when they are prepared, which would take twice the limit."""
    load("torch")
    large_ball.save("large.ply")
    limit, count = 40_000_000, 100_000
    own = sample_memory("stream", "ball.ply", 1, 10**9)[0]
    peak, result = sample_memory("stream", "large.ply", count, limit, copies=6)
    assert result == "streamed" and raymap.Surface(large_ball).nbytes < peak - own <= limit
    assert 6 * raymap.Surface(large_ball).nbytes > 1.5 * limit
    peak, result = sample_memory("stream", "large.ply", count, limit // 2)
    assert peak - own <= limit // 2
    text = "meshes: number 0 and a block of 16,384 points do not fit into memory_limit, 20,000,000 bytes; use a higher limit"
    assert result.startswith(text)
    with pytest.raises(raymap.MemoryLimitError, match="a block of 100,000 points takes up to 32,000,000 bytes, but memory_lim"):
        raymap.torch.SurfaceSamples(["large.ply"], block=100_000, memory_limit=30_000_000)


@pytest.mark.parametrize("array", ["distance", "closest"])
@pytest.mark.parametrize("surface", [0.0, 1.0])
def test_a_block_takes_no_more_than_a_stream_counts(array: str, surface: float) -> None:
    load("torch")
    program = f"""
import raymap
from pathlib import Path
def peak():
    return next(int(line.split()[1]) * 1024 for line in Path("/proc/self/status").read_text().splitlines() if "VmHWM" in line)
options = dict(arrays=["gradient", "winding", "{array}"], surface={surface}, near=0.0, threads=1, dtype="float16")
prepared = raymap.Surface("ball.ply")
raymap.Sampler(prepared, 1000, block=1000, **options)[0]
own = peak()
raymap.Sampler(prepared, 400_000, block=400_000, **options)[0]
taken = (peak() - own) / 400_000
assert taken <= {raymap.torch._POINT_BYTES}, taken
"""
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
