"""Data sets: what is made, what is made again, what is quarantined, on this machine and on a Dask cluster."""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from urllib.parse import unquote

import distributed
import numpy as np
import pytest
import raymap
from conftest import make_ball
from dask_cluster import Cluster, children_of
from helpers import load
from raymap._dataset_files import buffer_hashes

NAMES = ["ball.ply", "deep/tetrahedron.ply", "open.OBJ", "small.ply"]


@pytest.fixture
def meshes(tmp_path: Path) -> Path:
    """A folder with four meshes, one of them in a folder, one open, and a file that is none."""
    folder = tmp_path / "meshes"
    (folder / "deep").mkdir(parents=True)
    shutil.copy("ball.ply", folder)
    shutil.copy("tetrahedron.ply", folder / "deep")
    vertices, faces = make_ball(1)
    raymap.Mesh(vertices, faces[:-7]).save("open.obj")
    shutil.move("open.obj", folder / "open.OBJ")
    raymap.Mesh(vertices, faces).save(folder / "small.ply")
    (folder / "notes.txt").write_text("no mesh")
    return folder


def generate(meshes: Path, out: str = "out", **options) -> raymap.dataset.Summary:
    return raymap.dataset.generate(meshes, out, **{"resolution": 16, "workers": 2, **options})


def contents(folder: str | Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}


def identities(folder: str | Path) -> dict[str, tuple[int, int]]:
    """Returns what changes when a result is written again, even with the same content."""
    return {
        str(p.relative_to(folder)): (p.stat().st_ino, p.stat().st_mtime_ns)
        for p in Path(folder).rglob("*")
        if p.is_file() and p.name not in ("table.csv", "index.html")
    }


def table(out: str | Path = "out") -> dict[str, dict[str, str]]:
    with open(Path(out, "table.csv"), newline="") as file:
        return {row["mesh"]: row for row in csv.DictReader(file)}


def test_results_are_those_of_signed_distance(meshes: Path) -> None:
    summary = generate(meshes, arrays=("winding",))
    assert summary.done == summary.new == NAMES
    assert summary.quarantined == summary.unfinished == []
    for name in NAMES:
        made = raymap.load_field(f"out/{name}.npz")
        direct = raymap.signed_distance(meshes / name, resolution=16, device="cpu", arrays=("winding",))
        np.testing.assert_array_equal(made.distance, direct.distance)
        np.testing.assert_array_equal(made.winding, direct.winding)
        np.testing.assert_array_equal(made.origin, direct.origin)
        assert Path(f"out/{name}.png").read_bytes().startswith(b"\x89PNG")


def test_the_table_holds_figures_of_info_and_of_the_field(meshes: Path) -> None:
    generate(meshes)
    rows = table()
    assert list(rows) == NAMES
    for name, row in rows.items():
        found = raymap.info(meshes / name)
        field = raymap.signed_distance(meshes / name, resolution=16, device="cpu")
        assert int(row["triangles"]) == found["triangles"]
        assert row["watertight"] == str(found["watertight"]) == str(name != "open.OBJ")
        assert int(row["boundary_edges"]) == found["boundary_edges"]
        assert float(row["area"]) == found["area"]
        assert float(row["bbox_max_y"]) == found["bbox_max"][1]
        assert int(row["self_intersections"]) == found["self_intersections"]["pairs"]
        assert tuple(int(row[f"samples_{axis}"]) for axis in "xyz") == field.shape
        assert float(row["origin_z"]) == field.origin[2]
        assert float(row["inside_share"]) == (field.distance < 0).mean()
        assert float(row["doubtful_share"]) == field.stats.doubtful_share
        assert (row["state"], row["reason"]) == ("done", "")


def test_the_page_refers_to_files_that_exist(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    shutil.copy(meshes / "small.ply", meshes / "a & <b> #1.ply")
    generate(meshes)
    page = Path("out/index.html").read_text()
    assert "5 of 6 meshes done" in page and "a &amp; &lt;b&gt; #1.ply" in page
    links = re.findall(r'(?:href|src)="([^"]*)"', page)
    assert len(links) == 1 + 2 * 5 + 1
    assert all(Path("out", unquote(link)).is_file() for link in links)


def test_a_second_run_writes_nothing_again(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    generate(meshes)
    before, content = identities("out"), contents("out")
    again = generate(meshes, workers=1)
    assert (again.new, again.quarantined, again.done) == ([], ["bad.ply"], NAMES)
    assert identities("out") == before and contents("out") == content


@pytest.mark.parametrize("lost", [".npz", ".png", ".json"])
def test_what_is_missing_is_made_again(meshes: Path, lost: str) -> None:
    generate(meshes)
    content = contents("out")
    Path("out/ball.ply" + lost).unlink()
    assert generate(meshes).new == ["ball.ply"]
    assert contents("out") == content


def test_a_result_of_another_length_is_made_again(meshes: Path) -> None:
    generate(meshes)
    content = contents("out")
    os.truncate("out/ball.ply.npz", 100)
    assert generate(meshes).new == ["ball.ply"]
    assert contents("out") == content


def test_a_changed_mesh_is_made_again(meshes: Path) -> None:
    generate(meshes)
    shutil.copy(meshes / "small.ply", meshes / "ball.ply")
    assert generate(meshes).new == ["ball.ply"]
    assert Path("out/ball.ply.npz").read_bytes() == Path("out/small.ply.npz").read_bytes()
    os.utime(meshes / "ball.ply", (1, 1))  # The bytes count, not the time.
    assert generate(meshes).new == []


def write_gltf(path: Path, buffer: str) -> None:
    """Writes a tetrahedron whose buffer is a file, as .gltf or .glb."""
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], "<f4")
    faces = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)], "<u4")
    path.with_name(unquote(buffer)).write_bytes(corners.tobytes() + faces.tobytes())
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": buffer, "byteLength": 96}],
        "bufferViews": [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 48}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    }
    text = json.dumps(document).encode()
    if path.suffix == ".glb":  # A chunk that nobody knows comes first.
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", 4, 0x4E4E4E4E) + b"none" + struct.pack("<II", len(text), 0x4E4F534A) + text
        text = b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks
    path.write_bytes(text)


@pytest.mark.parametrize("name", ["scene.gltf", "scene.glb", "SCENE.GLTF"])
def test_a_changed_buffer_makes_a_mesh_again(tmp_path: Path, name: str) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    write_gltf(folder / name, "the%20corners.bin")
    shutil.copy("ball.ply", folder)
    assert generate(folder).done == sorted(["ball.ply", name])
    assert generate(folder).new == []
    buffer = folder / "the corners.bin"
    corners = np.fromfile(buffer, "<f4", 12)
    buffer.write_bytes((2 * corners).tobytes() + buffer.read_bytes()[48:])
    assert generate(folder).new == [name]
    assert float(table()[name]["bbox_max_x"]) == 2
    content = buffer.read_bytes()
    buffer.unlink()
    missing = generate(folder)
    assert missing.new == missing.quarantined == [name] and "the corners.bin" in table()[name]["reason"]
    assert generate(folder).new == []
    buffer.write_bytes(content)
    assert generate(folder).new == [name] and table()[name]["state"] == "done"


@pytest.mark.parametrize(
    "content",
    [b"", b"glTF", b"glTF\2\0\0\0", b"{", b"[" * 100_000, b"\xff", b"[]", b'{"buffers": 7}', b'{"buffers": [7]}',
     b'{"buffers": [{"uri": 7}]}', b'{"buffers": [{"uri": "a\\u0000b"}]}', b'{"buffers": [{"uri": "\\ud800"}]}',
     b"glTF" + struct.pack("<IIII", 2, 20, 0xFFFFFFFF, 0x4E4F534A)],
)  # fmt: skip
def test_a_malformed_scene_is_quarantined(tmp_path: Path, content: bytes) -> None:
    Path("bad.gltf").write_bytes(content)
    assert generate(tmp_path / "bad.gltf").quarantined == ["bad.gltf"]


def test_large_json_is_left_to_the_process_of_the_mesh(tmp_path: Path) -> None:
    write_gltf(tmp_path / "scene.gltf", "corners.bin")
    size = (tmp_path / "scene.gltf").stat().st_size
    assert list(buffer_hashes(str(tmp_path / "scene.gltf"), size)) == ["corners.bin"]
    assert buffer_hashes(str(tmp_path / "scene.gltf"), size - 1) == {}


@pytest.mark.parametrize("format", ["npy", "nrrd", "vti", "vdb"])
def test_other_formats(meshes: Path, format: str) -> None:
    assert generate(meshes, format=format).done == NAMES
    assert generate(meshes, format=format).new == []
    made = raymap.load_field(f"out/ball.ply.{format}")
    direct = raymap.signed_distance(meshes / "ball.ply", resolution=16, device="cpu")
    np.testing.assert_array_equal(made.distance, direct.distance)


def test_the_table_as_parquet(meshes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    parquet = load("pyarrow.parquet")
    (meshes / "bad.ply").write_text("ply\n")
    ran = run_module("dataset", meshes, "-o", "out", "--resolution", 16, "--table", "table.parquet")
    assert ran.returncode == 0, ran.stderr
    rows = {row["mesh"]: row for row in parquet.read_table("table.parquet").to_pylist()}
    plain = table()
    assert list(rows) == list(plain) == sorted([*NAMES, "bad.ply"])
    for name, row in rows.items():
        assert {k: "" if v is None else str(v) for k, v in row.items()} == plain[name]
    ball, bad = rows["ball.ply"], rows["bad.ply"]
    assert ball["triangles"] == 1280 and ball["watertight"] is True and isinstance(ball["area"], float)
    assert (ball["reason"], bad["triangles"], bad["state"]) == (None, None, "quarantined")
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(raymap.UsageError, match=r"needs pyarrow: pip install 'raymap\[parquet\]'"):
        generate(meshes, table="table.parquet")


@pytest.mark.parametrize("change", [{"resolution": 17}, {"sign": "rays"}, {"format": "nrrd"}, {"arrays": "winding"}])
def test_a_changed_option_makes_all_again(meshes: Path, change: dict) -> None:
    generate(meshes)
    assert generate(meshes, **change).new == NAMES
    assert generate(meshes, **change).new == []


@pytest.mark.parametrize(
    "same", [{"padding": 0.1}, {"threads": 2}, {"memory_limit": 1 << 30}, {"time_limit": 99}, {"arrays": ["distance"]}]
)
def test_defaults_and_limits_do_not_make_results_again(meshes: Path, same: dict) -> None:
    generate(meshes)
    assert generate(meshes, **same).new == []


def test_another_version_makes_all_again(meshes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    generate(meshes)
    monkeypatch.setattr("raymap._dataset_work.version", lambda: "9.9.9")
    assert generate(meshes).new == NAMES


def test_results_do_not_depend_on_workers(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    generate(meshes, "one", workers=1)
    generate(meshes, "two", workers=2, threads=2)
    assert contents("one") == contents("two")


def test_a_malformed_mesh_is_quarantined_until_it_is_mended(meshes: Path) -> None:
    (meshes / "deep/bad.ply").write_bytes(b"ply\nformat ascii 1.0\n")
    summary = generate(meshes)
    assert (summary.done, summary.quarantined) == (NAMES, ["deep/bad.ply"])
    with pytest.raises(raymap.InputError) as error:
        raymap.load_mesh(meshes / "deep/bad.ply")
    assert Path("out/quarantine/deep/bad.ply/reason.txt").read_text() == f"{error.value}\n"
    assert "Traceback" in Path("out/quarantine/deep/bad.ply/log.txt").read_text()
    assert table()["deep/bad.ply"]["reason"] == str(error.value)
    shutil.copy(meshes / "small.ply", meshes / "deep/bad.ply")
    assert generate(meshes).new == ["deep/bad.ply"]
    assert not Path("out/quarantine/deep/bad.ply").exists()


def test_a_mesh_that_turns_bad_loses_its_result(meshes: Path) -> None:
    generate(meshes)
    (meshes / "ball.ply").write_text("ply\n")
    assert generate(meshes).quarantined == ["ball.ply"]
    assert not Path("out/ball.ply.npz").exists() and not Path("out/ball.ply.png").exists()


def test_removing_the_quarantine_tries_again(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    generate(meshes)
    shutil.rmtree("out/quarantine")
    assert generate(meshes).new == ["bad.ply"]


def test_the_time_limit(meshes: Path, large_ball: raymap.Mesh) -> None:
    large_ball.save(meshes / "large.ply")
    summary = raymap.dataset.generate([meshes / "large.ply"], "out", resolution=256, time_limit=0.01)
    assert summary.quarantined == ["large.ply"]
    assert table()["large.ply"]["reason"] == "takes longer than 0.01 s; raise time_limit"
    assert raymap.dataset.generate([meshes / "large.ply"], "out", resolution=256, time_limit=0.01).new == []
    assert raymap.dataset.generate([meshes / "large.ply"], "out", resolution=256, time_limit=500).done == ["large.ply"]
    assert not Path("out/quarantine/large.ply").exists()


def test_the_memory_limit(meshes: Path, large_ball: raymap.Mesh) -> None:
    large_ball.save(meshes / "large.ply")
    summary = generate(meshes, memory_limit=30_000_000, workers=1)
    assert (summary.done, summary.quarantined) == ([n for n in NAMES if n != "large.ply"], ["large.ply"])
    assert table()["large.ply"]["reason"].endswith("(memory_limit is 30000000 bytes)")
    assert generate(meshes).new == ["large.ply"]


def wait_for(condition: Callable[[], object], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.02)


class KillChildren(threading.Thread):
    """Sends a signal to the process that makes a mesh, once it has begun: its parent has removed the old marker."""

    def __init__(self, marker: Path, killing: signal.Signals, times: int) -> None:
        super().__init__()
        self._marker, self._signal, self._times, self.killed = marker, killing, times, set()
        marker.parent.mkdir(parents=True, exist_ok=True)
        marker.write_text("old")

    def run(self) -> None:
        wait_for(lambda: not self._marker.exists())
        while len(self.killed) < self._times:
            for child in set(children_of(os.getpid())) - self.killed:
                if is_at_work(child):
                    os.kill(child, self._signal)
                    self.killed.add(child)
            time.sleep(0.01)


def is_at_work(child: int) -> bool:
    """Returns whether a process makes a mesh: it has used more than the time that starting takes."""
    try:
        user, system = Path(f"/proc/{child}/stat").read_text().rpartition(")")[2].split()[11:13]
    except OSError:
        return False
    return int(user) + int(system) > 1.2 * os.sysconf("SC_CLK_TCK")


def is_running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_crash_is_quarantined(meshes: Path, large_ball: raymap.Mesh) -> None:
    large_ball.save(meshes / "large.ply")
    killer = KillChildren(Path("out/large.ply.json"), signal.SIGSEGV, 1)
    killer.start()
    summary = raymap.dataset.generate([meshes / "large.ply", meshes / "small.ply"], "out", resolution=300, workers=1)
    killer.join()
    assert (summary.done, summary.quarantined) == (["small.ply"], ["large.ply"])
    assert table()["large.ply"]["reason"] == "its process crashed: SIGSEGV, Segmentation fault"
    assert "Segmentation fault" in Path("out/quarantine/large.ply/log.txt").read_text()


def test_a_crash_counts_in_a_fresh_process_only(meshes: Path, large_ball: raymap.Mesh) -> None:
    large_ball.save(meshes / "z.ply")
    both = [meshes / "small.ply", meshes / "z.ply"]
    killer = KillChildren(Path("out/z.ply.json"), signal.SIGKILL, 1)
    killer.start()
    summary = raymap.dataset.generate(both, "out", resolution=200, workers=1)
    killer.join()
    assert summary.done == ["small.ply", "z.ply"] and len(killer.killed) == 1


def test_children_end_with_their_parent(meshes: Path, large_ball: raymap.Mesh) -> None:
    large_ball.save(meshes / "large.ply")
    program = f"import raymap; raymap.dataset.generate([{str(meshes / 'large.ply')!r}], 'out', resolution=400)"
    parent = subprocess.Popen([sys.executable, "-c", program])
    wait_for(lambda: children_of(parent.pid))
    child = children_of(parent.pid)[0]
    wait_for(lambda: is_at_work(child))
    parent.kill()
    parent.wait()
    wait_for(lambda: not is_running(child))
    assert not Path("out/large.ply.json").exists()


def test_points_are_those_of_sample_points(meshes: Path) -> None:
    options = {"n": 500, "near": 0.5, "sigma": [0.01], "surface": 0.1, "seed": 7, "normalize": True}
    assert raymap.dataset.generate(meshes, "out", what="points", **options).done == NAMES
    for name in NAMES:
        direct = raymap.sample_points(meshes / name, **options)
        made = np.load(f"out/{name}.npz")
        np.testing.assert_array_equal(made["pos"], direct.pos)
        np.testing.assert_array_equal(made["neg"], direct.neg)
        np.testing.assert_array_equal(made["centre"], direct.centre)
        assert made["scale"] == direct.scale
        assert int(table()[name]["points_inside"]) == len(direct.neg) > 0
        assert float(table()[name]["centre_z"]) == direct.centre[2]
        assert Path(f"out/{name}.png").exists()
    content = contents("out")
    raymap.dataset.generate(meshes, "again", what="points", workers=1, threads=2, **options)
    assert contents("again") == content
    assert raymap.dataset.generate(meshes, "out", what="points", **options).new == []
    assert raymap.dataset.generate(meshes, "out", what="points", **{**options, "seed": 8}).new == NAMES


def test_leftovers_of_killed_programs_are_removed(meshes: Path) -> None:
    Path("out/deep").mkdir(parents=True)
    Path("out/deep/.tetrahedron.ply.npz.tmp123-0-456").touch()
    Path("out/.table.csv.tmp123-456").touch()
    Path("out/.mine").touch()
    generate(meshes)
    assert [p.name for p in Path("out").rglob(".*")] == [".mine"]


def test_progress(meshes: Path) -> None:
    said: list[tuple[str, float]] = []
    generate(meshes, workers=1, progress=lambda text, done: said.append((text, done)))
    assert [done for _, done in said] == [0.25, 0.5, 0.75, 1.0]
    assert re.fullmatch(r"2 of 4 meshes, \S+ per second, \d+ s left,", said[1][0])
    said.clear()
    (meshes / "ball.ply").write_text("ply\n")
    generate(meshes, workers=1, progress=lambda text, done: said.append((text, done)))
    assert said[-1][0].startswith("4 of 4 meshes, 1 quarantined, ")
    with pytest.raises(raymap.Cancelled):
        generate(meshes, "other", workers=1, progress=lambda text, done: False)
    assert generate(meshes, "other").done == NAMES[1:]


def test_odd_arguments(meshes: Path, tmp_path: Path) -> None:
    with pytest.raises(raymap.UsageError, match="both results would be ball.ply"):
        raymap.dataset.generate(["ball.ply", meshes / "ball.ply"], "out")
    with pytest.raises(raymap.UsageError, match="a folder among paths"):
        raymap.dataset.generate([meshes, "ball.ply"], "out")
    with pytest.raises(raymap.UsageError, match="no meshes here"):
        (tmp_path / "empty").mkdir()
        raymap.dataset.generate(tmp_path / "empty", "out")
    with pytest.raises(raymap.FileError, match="nowhere: no such file"):
        raymap.dataset.generate("nowhere", "out")
    for options, text in [
        ({"what": "mesh"}, "what must be"),
        ({"format": "ply"}, "format must be"),
        ({"table": "table.csv"}, "table.csv: the table is written as .parquet"),
        ({"what": "points"}, "needs n"),
        ({"workers": 0}, "workers must be at least 1, not 0"),
        ({"time_limit": 0}, "time_limit must be above 0"),
        ({"resolution": 0}, "resolution must be at least 1"),
        ({"memory_limit": -1}, "memory_limit must be above 0"),
        ({"arrays": ["colour"]}, "no array is named 'colour'"),
    ]:
        with pytest.raises(raymap.UsageError, match=text):
            raymap.dataset.generate(meshes, "out", **options)
    for options, text in [
        ({"n": -1}, "n must not be negative"),
        ({"n": 9, "near": 2}, "near must be"),
        ({"n": 9, "format": "npy"}, "points are written as npz"),
    ]:
        with pytest.raises(raymap.UsageError, match=text):
            raymap.dataset.generate(meshes, "out", what="points", **options)
    with pytest.raises(TypeError, match="resolution"):
        generate(meshes, what="points", n=9)
    with pytest.raises(TypeError, match="'n'"):
        generate(meshes, n=9)
    with pytest.raises(TypeError, match="resolutoin"):
        generate(meshes, resolutoin=3)
    with pytest.raises(raymap.FileError, match="nowhere/table.parquet: cannot write: there is no folder"):
        generate(meshes, table="nowhere/table.parquet")
    assert not Path("out").exists()


def test_an_unwritable_result_stops_the_run_and_quarantines_nothing(meshes: Path) -> None:
    Path("out").mkdir()
    Path("out/deep").write_text("a file where a folder must be")
    with pytest.raises(raymap.FileError, match="deep"):
        generate(meshes)
    assert not Path("out/quarantine").exists()


def run_module(*arguments: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "raymap", *map(str, arguments)], capture_output=True, text=True, check=False
    )


def test_the_command_line(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    options = ["--resolution", 16, "--arrays", "winding", "--memory-limit", "1GB", "--time-limit", 300, "--workers", 2]
    ran = run_module("dataset", meshes, "-o", "out", *options)
    assert ran.returncode == 0 and ran.stderr == ""
    assert ran.stdout.startswith("4 done, 1 quarantined, 0 unfinished; 5 of them new, in ")
    assert generate(meshes, arrays=["winding"], memory_limit=1 << 30, time_limit=300.0).new == []
    wrong = run_module("dataset", meshes, "-o", "out", "--resolution", 0)
    assert wrong.returncode == 2 and wrong.stderr.startswith("raymap: error: the resolution must")
    assert run_module("dataset", "nowhere", "-o", "out").returncode == 4
    assert run_module("dataset", meshes, "-o", "out", "--memory-limit", "much").returncode == 2


# On a cluster of Dask.
@pytest.fixture
def many(meshes: Path) -> Path:
    """The meshes, a malformed one, and twelve that take a moment."""
    vertices, faces = make_ball(4)
    for k in range(12):
        raymap.Mesh(vertices * (1 + 0.1 * k), faces).save(meshes / f"ball_{k:02}.ply")
    (meshes / "bad.ply").write_text("ply\n")
    return meshes


def finished(out: str) -> int:
    return sum(1 for p in Path(out).rglob("*.json"))


def in_background(many: Path, address: str, answer: list) -> threading.Thread:
    def run() -> None:
        with distributed.Client(address, timeout=10) as client:
            try:
                answer.append(generate(many, "cluster", resolution=48, client=client))
            except raymap.Error as error:
                answer.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    return thread


def test_a_cluster_loses_nothing_when_a_worker_is_killed(many: Path, tmp_path: Path) -> None:
    generate(many, "serial", resolution=48, workers=1)
    with Cluster(tmp_path / "dask", 2) as cluster:
        answer: list = []
        thread = in_background(many, cluster.address, answer)
        wait_for(lambda: finished("cluster") >= 3)
        wait_for(lambda: children_of(cluster.workers[0].pid))
        child = children_of(cluster.workers[0].pid)[0]
        cluster.workers[0].kill()
        before = identities("cluster")
        thread.join(120)
    assert not is_running(child)
    assert (len(answer[0].done), answer[0].quarantined, answer[0].unfinished) == (16, ["bad.ply"], [])
    markers = {name: identity for name, identity in before.items() if name.endswith(".json")}
    after = identities("cluster")
    assert {name: after[name] for name in markers} == markers  # Nothing twice
    assert contents("cluster") == contents("serial")


def test_a_lost_scheduler_is_an_error_and_the_next_run_goes_on(many: Path, tmp_path: Path) -> None:
    generate(many, "serial", resolution=48, workers=1)
    with Cluster(tmp_path / "first", 2) as cluster:
        answer: list = []
        thread = in_background(many, cluster.address, answer)
        wait_for(lambda: finished("cluster") >= 3)
        cluster.scheduler.kill()
        thread.join(120)
        assert isinstance(answer[0], raymap.Error) and "scheduler of Dask was lost" in str(answer[0])
    before = {name: i for name, i in identities("cluster").items() if name.endswith(".json")}
    assert 3 <= len(before) < 17
    with Cluster(tmp_path / "second", 2) as cluster, distributed.Client(cluster.address) as client:
        summary = generate(many, "cluster", resolution=48, client=client)
        assert len(summary.new) == 17 - len(before)
        ran = run_module("dataset", many, "-o", "cluster", "--resolution", 48, "--scheduler", cluster.address)
        assert ran.stdout.startswith("16 done, 1 quarantined, 0 unfinished; 0 of them new")
    after = identities("cluster")
    assert {name: after[name] for name in before} == before
    assert contents("cluster") == contents("serial")


def test_a_mesh_whose_workers_are_all_killed_is_unfinished(meshes: Path, tmp_path: Path, large_ball) -> None:
    """Dask gives up a task that four workers died with. That says nothing about the mesh."""
    large_ball.save(meshes / "large.ply")
    with Cluster(tmp_path / "dask", 4) as cluster, distributed.Client(cluster.address) as client:
        answer: list = []
        paths = [meshes / "large.ply"]
        thread = threading.Thread(
            target=lambda: answer.append(raymap.dataset.generate(paths, "out", resolution=500, client=client))
        )
        thread.start()
        for _ in range(4):
            wait_for(lambda: any(children_of(worker.pid) for worker in cluster.workers))
            for worker in cluster.workers:
                if children_of(worker.pid):
                    worker.kill()
                    worker.wait()
        thread.join(60)
    summary = answer[0]
    assert (summary.done, summary.quarantined, summary.new, summary.unfinished) == ([], [], [], ["large.ply"])
    assert table()["large.ply"]["state"] == "unfinished"
