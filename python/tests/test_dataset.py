"""Data sets: what is made, what is made again, what is quarantined."""

from __future__ import annotations

import argparse
import fcntl
import inspect
import json
import os
import re
import shutil
import struct
import sys
from collections.abc import Callable
from pathlib import Path
from urllib.parse import unquote

import numpy as np
import pytest
import raymap
from data_set import NAMES, contents, generate, identities, run_module, sample_memory, table
from helpers import load
from raymap import __main__ as command
from raymap import _progress
from raymap.dataset import child
from raymap.dataset.files import buffer_hashes

def test_results_are_those_of_generate(meshes: Path) -> None:
    summary = generate(meshes, arrays=("winding",))
    assert summary.done == summary.new == NAMES
    assert summary.quarantined == summary.unfinished == []
    for name in NAMES:
        made = raymap.load_field(f"out/{name}.npz")
        direct = raymap.generate(meshes / name, resolution=16, device="cpu", arrays=("winding",))
        np.testing.assert_array_equal(made.distance, direct.distance)
        np.testing.assert_array_equal(made.winding, direct.winding)
        np.testing.assert_array_equal(made.origin, direct.origin)
        assert Path(f"out/{name}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(("format", "band"), [("vdb", 2), ("nvdb", (1.5, 4))])
def test_narrow_bands_are_those_of_generate(meshes: Path, format: str, band: float | tuple[float, float]) -> None:
    generate(meshes)
    options = {"resolution": 40, "band": band, "normalize": "cube"}
    assert generate(meshes, format=format, sparse=True, **options).new == NAMES
    for name in NAMES:
        made = raymap.load_field(f"out/{name}.{format}", sparse=True)
        direct = raymap.generate(meshes / name, sparse=True, **options)
        for array in "origins", "distance", "tile_origins", "tile_sides":
            np.testing.assert_array_equal(getattr(made, array), getattr(direct, array))
        marker = json.loads(Path(f"out/{name}.json").read_text())
        dense = direct.to_dense().distance
        assert marker["field"] == {
            "samples": list(direct.shape),
            "origin": direct.origin.tolist(),
            "spacing": direct.spacing,
            "centre": direct.centre.tolist(),
            "scale": direct.scale,
            "distance_min": dense.min(),
            "distance_max": dense.max(),
            "inside_share": (dense < 0).mean(),
            "leaves": len(direct.origins),
            "active_samples": direct.active_count,
        }
        assert Path(f"out/{name}.png").read_bytes().startswith(b"\x89PNG")
        assert not Path(f"out/{name}.npz").exists()
    assert generate(meshes, format=format, sparse=True, **options).new == []


def test_markers_know_no_infinity(meshes: Path) -> None:
    (meshes / "broken.ply").write_text("no mesh")
    options = {"format": "vdb", "sparse": True, "band": (np.inf, 2), "time_limit": np.inf}
    assert generate(meshes, **options).quarantined == ["broken.ply"]
    markers = {name: json.loads(Path(f"out/{name}.json").read_text(), parse_constant=pytest.fail)
               for name in [*NAMES, "broken.ply"]}  # fmt: skip
    assert markers[NAMES[0]]["options"]["band"] == [None, 2]
    assert markers["broken.ply"]["limits"]["time_limit"] is None
    before = identities("out")
    assert generate(meshes, **options).new == []
    assert identities("out") == before


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({}, "which are written as vdb or nvdb, not as 'npz'"),
        ({"format": "vdb", "pages": True}, "leave out pages or sparse=True"),
        ({"format": "vdb", "pyramid": 1}, "pyramid needs files of several grids"),
        ({"format": "vdb", "close_holes": True}, "which has no close_holes"),
        ({"what": "points", "n": 9}, "sparse is no option of points"),
    ],
)
def test_narrow_bands_refuse_what_they_cannot_hold(meshes: Path, options: dict, text: str) -> None:
    with pytest.raises(raymap.UsageError, match=text):
        raymap.dataset.generate(meshes, "out", sparse=True, **options)
    assert not Path("out").exists()


def test_the_table_holds_figures_of_info_and_of_the_field(meshes: Path) -> None:
    generate(meshes)
    rows = table()
    assert list(rows) == NAMES
    for name, row in rows.items():
        found = raymap.info(meshes / name)
        field = raymap.generate(meshes / name, resolution=16, device="cpu")
        assert int(row["triangles"]) == found["triangles"]
        assert row["watertight"] == str(found["watertight"]) == str(name != "open.OBJ")
        assert int(row["boundary_edges"]) == found["boundary_edges"]
        assert float(row["area"]) == found["area"]
        assert float(row["bounds_max_y"]) == found["bounds"][1][1]
        assert int(row["self_intersections_pairs"]) == found["self_intersections"]["pairs"]
        assert tuple(int(row[f"samples_{axis}"]) for axis in "xyz") == field.shape
        assert float(row["origin_z"]) == field.origin[2]
        assert float(row["inside_share"]) == (field.distance < 0).mean()
        assert float(row["doubtful_share"]) == field.stats["doubtful_share"]
        assert (row["state"], row["reason"]) == ("done", "")


def test_the_table_holds_warnings_with_their_codes(meshes: Path) -> None:
    with open(meshes / "open.OBJ", "a") as file:
        file.write("curv2 1 2\nf 1 2\n")
    generate(meshes)
    rows = table()
    assert {name: row["warning_codes"] for name, row in rows.items() if row["warnings"]} == {"open.OBJ": "file_content"}
    texts = ["1 face with fewer than three corners dropped", "free-form curves and surfaces are not read"]
    assert rows["open.OBJ"]["warnings"] == "; ".join(f"open.OBJ: {text}" for text in texts)


def test_the_page_refers_to_files_that_exist(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    shutil.copy(meshes / "small.ply", meshes / "a & <b> #1.ply")
    generate(meshes)
    page = Path("out/index.html").read_text()
    assert "5 of 6 meshes done" in page and "a &amp; &lt;b&gt; #1.ply" in page
    links = re.findall(r'(?:href|src)="([^"]*)"', page)
    assert len(links) == 1 + 2 * 5 + 1
    assert all(Path("out", unquote(link)).is_file() for link in links)


def test_pages_are_linked_and_made_where_they_are_missing(meshes: Path) -> None:
    names = ["ball.ply", "open.OBJ"]  # Each page has a picture, which takes its time.
    for name in set(NAMES) - set(names):
        (meshes / name).unlink()
    generate(meshes)
    assert "Look at it" not in Path("out/index.html").read_text().partition("<script")[0]
    assert generate(meshes, pages=True).new == names
    assert generate(meshes, pages=True).new == []
    index = Path("out/index.html").read_text()
    for name in names:
        assert f'<a href="{name}.html">Look at it</a>' in index
        page = Path("out", f"{name}.html").read_text(encoding="utf-8")
        assert f"<title>{Path(name).name}</title>" in page
        assert ('"name":"Holes"' in page) is (name == "open.OBJ")
    Path("out/ball.ply.html").unlink()
    before = contents("out")
    assert generate(meshes, pages=True).new == ["ball.ply"]
    assert contents("out").keys() - before.keys() == {"ball.ply.html"}
    assert generate(meshes).new == []  # A page that is there keeps its link.
    assert '<a href="ball.ply.html">' in Path("out/index.html").read_text()
    assert generate(meshes, resolution=12).new == names
    assert list(Path("out").glob("**/*.html")) == [Path("out/index.html")]  # They showed other fields.
    with pytest.raises(raymap.UsageError, match="pages show fields"):
        generate(meshes, "points", what="points", n=10, resolution=None, pages=True)


def test_a_page_goes_into_quarantine_with_its_result(meshes: Path) -> None:
    for name in NAMES[1:]:
        (meshes / name).unlink()
    generate(meshes, pages=True)
    Path(meshes, "ball.ply").write_bytes(b"ply")
    assert generate(meshes, pages=True).quarantined == ["ball.ply"]
    assert Path("out/quarantine/ball.ply/ball.ply.html").exists() and not Path("out/ball.ply.html").exists()


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
    assert float(table()[name]["bounds_max_x"]) == 2
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


def test_buffers_elsewhere_and_pipes_are_not_read(tmp_path: Path) -> None:
    folder = tmp_path / "folder"
    folder.mkdir()
    (tmp_path / "secret.bin").write_bytes(b"secret")
    (folder / "link.bin").symlink_to("../secret.bin")
    os.mkfifo(folder / "pipe.bin")
    for name in "../secret.bin", "link.bin", "pipe.bin":
        (folder / "scene.gltf").write_text('{"buffers": [{"uri": "' + name + '"}]}')
        assert buffer_hashes(str(folder / "scene.gltf"), 1 << 20) == {name: None}


def test_spreadsheets_and_pages_show_names_as_they_are(meshes: Path) -> None:
    names = ["=cmd|calc!A1.ply", "+1.ply", "-1.ply", "@sum.ply", "a=b.ply", "turned\u202eylp.\x1b.ply"]
    for name in names:
        shutil.copy(meshes / "small.ply", meshes / name)
    (meshes / "small.ply").write_text("ply\nformat \x1b[31m\n")
    generate(meshes)
    shown = ["'=cmd|calc!A1.ply", "'+1.ply", "'-1.ply", "'@sum.ply", "a=b.ply", r"turned\u202eylp.\x1b.ply"]
    rows = table()
    assert set(shown) < rows.keys()
    assert float(rows["a=b.ply"]["distance_min"]) < 0 and rows["a=b.ply"]["distance_min"].startswith("-")
    assert rows["small.ply"]["reason"] == r"small.ply: line 2: unknown PLY format '\x1b[31m'"
    for text in Path("out/table.csv").read_text(), Path("out/index.html").read_text():
        assert "\u202e" not in text and "\x1b" not in text and str(meshes) not in text


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
    direct = raymap.generate(meshes / "ball.ply", resolution=16, device="cpu")
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
    "same", [{"padding": 0.1}, {"threads": 2}, {"memory_limit": 1 << 30}, {"time_limit": 1e8}, {"arrays": ["distance"]}]
)
def test_defaults_and_limits_do_not_make_results_again(meshes: Path, same: dict) -> None:
    generate(meshes)
    assert generate(meshes, **same).new == []


def test_another_version_makes_all_again(meshes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    generate(meshes)
    monkeypatch.setattr("raymap.dataset.work.version", lambda: "9.9.9")
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
    reason = str(error.value).removeprefix(f"{meshes}/")
    assert reason.startswith("deep/bad.ply: line 3: ")
    assert Path("out/quarantine/deep/bad.ply/reason.txt").read_text() == f"{reason}\n"
    assert str(meshes) not in Path("out/quarantine/deep/bad.ply/log.txt").read_text()
    assert "Traceback" in Path("out/quarantine/deep/bad.ply/log.txt").read_text()
    assert table()["deep/bad.ply"]["reason"] == reason
    shutil.copy(meshes / "small.ply", meshes / "deep/bad.ply")
    assert generate(meshes).new == ["deep/bad.ply"]
    assert not Path("out/quarantine/deep/bad.ply").exists()


def test_a_mesh_that_turns_bad_takes_its_result_into_quarantine(meshes: Path) -> None:
    generate(meshes)
    before = {name: Path("out", name).read_bytes() for name in ("ball.ply.npz", "ball.ply.png")}
    (meshes / "ball.ply").write_text("ply\n")
    for _ in range(2):
        assert generate(meshes, retry=True).quarantined == ["ball.ply"]
        assert sorted(p.name for p in Path("out").glob("ball*")) == ["ball.ply.json"]
        quarantine = contents("out/quarantine/ball.ply")
        assert sorted(quarantine) == ["ball.ply.npz", "ball.ply.png", "log.txt", "reason.txt"]
        assert before.items() <= quarantine.items()
    shutil.copy("ball.ply", meshes)
    assert generate(meshes).done == NAMES
    assert contents("out").items() >= before.items() and not Path("out/quarantine/ball.ply").exists()


def test_removing_the_quarantine_tries_again(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    generate(meshes)
    shutil.rmtree("out/quarantine")
    assert generate(meshes).new == ["bad.ply"]


def test_retry_tries_again(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    generate(meshes)
    content = contents("out")
    assert generate(meshes).new == []
    assert generate(meshes, retry=True).new == ["bad.ply"]
    assert contents("out") == content
    for arguments, count in (([], 0), (["--retry"], 1)):
        ran = run_module("dataset", meshes, "-o", "out", "--resolution", 16, *arguments)
        assert f"; {count} of them new, in " in ran.stdout


def test_a_mesh_that_cannot_be_read_stays_as_it_was(meshes: Path) -> None:
    paths = [meshes / "ball.ply", meshes / "small.ply"]
    generate(paths)
    content = contents("out")
    (meshes / "ball.ply").unlink()
    (meshes / "ball.ply").symlink_to("/proc/self/mem")  # Reading its begin is an error of the device.
    summary = generate(paths, resolution=17)
    assert (summary.done, summary.unfinished, summary.new) == (["small.ply"], ["ball.ply"], ["small.ply"])
    row = table()["ball.ply"]
    assert (row["state"], row["reason"]) == ("unfinished", "the mesh cannot be read: Input/output error")
    assert {name: data for name, data in content.items() if "ball" in name}.items() <= contents("out").items()
    assert summary.others == ["ball.ply.npz"]


@pytest.mark.parametrize(
    "device, error, code",
    [("vulkan:99", raymap.UnsupportedError, 7), ("vulkna:0", raymap.UsageError, 2), ("cuda", raymap.UsageError, 2)],
)
def test_a_missing_device_stops_the_run_and_touches_nothing(meshes: Path, device: str, error, code: int) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    generate(meshes)
    content, before = contents("out"), identities("out")
    for workers in (1, 2):
        with pytest.raises(error, match=r" \(on the machine .+\)$"):
            generate(meshes, device=device, workers=workers)
    ran = run_module("dataset", meshes, "-o", "out", "--resolution", 16, "--device", device)
    assert (ran.returncode, ran.stderr.count("\n")) == (code, 1)
    assert contents("out") == content and identities("out") == before


def test_a_lost_device_is_tried_again_in_a_fresh_process() -> None:
    job = {"memory_limit": 1000, "options": {"device": "cpu"}}
    lost = child._explain(raymap.DeviceLostError("the GPU is gone"), job)
    assert lost == {"reason": "the GPU is gone", "again": True, "is_machine": False}
    other = child._explain(raymap.InputError("no mesh"), {**job, "options": {"device": "vulkan:99"}})
    assert other == {"reason": "no mesh", "again": False, "is_machine": False}
    missing = child._explain(raymap.DeviceLostError("gone"), {**job, "options": {"device": "vulkan:99"}})
    assert missing["trouble"] == "unsupported" and "(on the machine " in missing["reason"]


def test_a_full_gpu_is_the_machine_s_fault_and_the_memory_limit_is_not() -> None:
    full = "the device's buffer 'distance' needs 2 MiB, but only 1 MiB is available; use a lower resolution"
    job = {"memory_limit": 1000, "options": {"device": "vulkan:0"}}
    assert child._explain(raymap.DeviceMemoryError(full), job) == {"reason": full, "again": True, "is_machine": True}
    text = "the device's buffer 'distance' needs 2 MiB, but only 1 MiB of the limit is left"
    limited = child._explain(raymap.MemoryLimitError(text), job)
    assert limited == {"reason": f"{text} (memory_limit is 1000 bytes)", "again": True, "is_machine": False}


def write_dae(path: Path) -> None:
    """Writes a tetrahedron in a format that raymap-import reads."""
    path.write_text(
        """<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
        <library_geometries><geometry id="g"><mesh>
        <source id="p"><float_array id="a" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
        <accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
        <param name="Z" type="float"/></accessor></technique_common></source>
        <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
        <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
        </mesh></geometry></library_geometries>
        <library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
        </library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""
    )


def test_an_importer_that_cannot_start_leaves_its_meshes_unfinished(meshes: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_dae(meshes / "scene.dae")
    all_names = [*NAMES[:3], "scene.dae", NAMES[3]]
    assert generate(meshes).new == all_names
    before = {name: identity for name, identity in identities("out").items() if "scene" in name}
    monkeypatch.setenv("RAYMAP_IMPORT", "/nowhere/raymap-import")
    summary = generate(meshes, resolution=17)
    assert (summary.new, summary.unfinished, summary.quarantined) == (NAMES, ["scene.dae"], [])
    assert table()["scene.dae"]["reason"].startswith("cannot start /nowhere/raymap-import: ")
    assert before.items() <= identities("out").items()
    monkeypatch.delenv("RAYMAP_IMPORT")
    assert generate(meshes, resolution=17).new == ["scene.dae"]


def test_a_missing_importer_leaves_its_meshes_unfinished(tmp_path: Path) -> None:
    package = tmp_path / "package/raymap"
    package.mkdir(parents=True)
    for path in Path(raymap.__file__).parent.iterdir():
        if path.name != "raymap-import":
            (package / path.name).symlink_to(path)
    write_dae(tmp_path / "scene.dae")
    python_path = os.pathsep.join([str(package.parent), *filter(None, sys.path)])
    ran = run_module("dataset", "scene.dae", "ball.ply", "-o", "out", env={**os.environ, "PYTHONPATH": python_path})
    if ran.stdout.startswith("2 done"):
        pytest.skip("an importer is installed where every program finds it")
    assert (ran.returncode, ran.stdout[:36]) == (9, "1 done, 0 quarantined, 1 unfinished;")
    assert "the program raymap-import that reads this format is missing" in table()["scene.dae"]["reason"]


def test_what_the_machine_cannot_read_leaves_a_mesh_unfinished(tmp_path: Path) -> None:
    error = raymap.FileError("mesh.ply: cannot read it: Input/output error")
    found = child._explain(error, {"memory_limit": 1000, "options": {}})
    assert found == {"reason": str(error), "again": False, "is_machine": True}
    (tmp_path / "mesh.ply").symlink_to("/proc/self/mem")  # Reading its begin is an error of the device.
    assert generate(tmp_path / "mesh.ply").unfinished == ["mesh.ply"]
    scene = tmp_path / "scene.gltf"
    write_gltf(scene, "corners.bin")
    scene.write_text(scene.read_text().replace("corners.bin", "corners" * 99))  # No file can have this name.
    assert generate(scene).quarantined == ["scene.gltf"]


def test_no_meshes(tmp_path: Path) -> None:
    summary = generate([])
    assert (summary.done, summary.new, summary.others) == ([], [], [])
    assert sorted(os.listdir("out")) == [".lock", "index.html", "table.csv"]


def test_what_the_build_cannot_read_is_quarantined_all_the_same(meshes: Path) -> None:
    """The error is of the class that a missing device has."""
    (meshes / "bad.gltf").write_text('{"asset": {"version": "2.0"}, "extensionsRequired": ["ACME_shape"]}')
    with pytest.raises(raymap.UnsupportedError) as error:
        raymap.load_mesh(meshes / "bad.gltf")
    assert generate(meshes).quarantined == ["bad.gltf"] and f"{meshes}/{table()['bad.gltf']['reason']}" == str(error.value)


def test_names_send_no_control_characters_to_the_terminal(meshes: Path) -> None:
    ran = run_module("dataset", "gone\x1b[31m\x9b.ply", "-o", "out")
    assert ran.returncode == 4 and "gone\\x1b[31m\\x9b.ply" in ran.stderr
    ran = run_module("dataset", meshes, "-o", "out\x1b", "--resolution", 16)
    assert "\x1b" not in ran.stdout and "out\\x1b" in ran.stdout


@pytest.mark.parametrize(
    ("text", "size"),
    [("1e9", 10**9), ("1e+9", 10**9), ("15e-1 kB", 1536), (".5GB", 2**29), ("1.5 gib", 3 * 2**29), ("2.", 2), ("3T", 3 << 40)],
)
def test_sizes_are_read_as_by_the_program(text: str, size: int) -> None:
    assert command._bytes(text) == size


@pytest.mark.parametrize("text", ["", ".", "GB", "1e", "-1", "1.5XB", "nan", "1.5GBs"])
def test_what_is_no_size_is_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match="is not a size"):
        command._bytes(text)


def test_fields_and_points_lie_side_by_side(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    fields = {"resolution": 16}
    points = {"what": "points", "n": 50}
    for options in (fields, points):
        made = raymap.dataset.generate(meshes, "out", **options)
        assert (made.new, made.quarantined, made.others) == (sorted([*NAMES, "bad.ply"]), ["bad.ply"], [])
    content = contents("out")
    assert {"ball.ply.npz", "ball.ply.points.npz", "quarantine/bad.ply.points/reason.txt"} <= content.keys()
    assert {"table.csv", "index.html", "table.points.csv", "index.points.html"} <= content.keys()
    assert list(table()) == list(table(name="table.points.csv"))
    for options in (fields, points):
        assert raymap.dataset.generate(meshes, "out", **options).new == []
    assert contents("out") == content


def test_a_result_replaces_that_of_another_format(meshes: Path) -> None:
    assert generate(meshes).others == generate(meshes, format="nrrd").others == []
    assert sorted(p.name for p in Path("out").glob("ball*")) == ["ball.ply.json", "ball.ply.nrrd", "ball.ply.png"]


def test_results_of_other_options_are_noticed(meshes: Path) -> None:
    generate(meshes)
    Path("out/mine.npy").touch()
    Path("out/mine.txt").touch()
    shutil.rmtree(meshes / "deep")
    (meshes / "small.ply").write_text("ply\n")
    others = ["deep/tetrahedron.ply.npz", "mine.npy"]
    with pytest.warns(raymap.RaymapWarning, match="out also holds 2 results of other options, formats or meshes; index"):
        summary = generate(meshes, resolution=17)
    assert (summary.others, summary.quarantined) == (others, ["small.ply"])
    page = Path("out/index.html").read_text()
    listed = page.split("<h2>Of other options, formats or meshes</h2>")[1].split("<h2>Done</h2>")[0]
    assert re.findall('href="(.*?)">(.*?)</a>', listed) == [(name, name) for name in others]
    Path("out/mine.npy").unlink()
    ran = run_module("dataset", meshes, "-o", "out", "--resolution", 17)
    assert ran.returncode == 0 and ran.stderr.startswith("raymap: warning: ") and ran.stderr.count("\n") == 1
    assert "out also holds a result of other options" in ran.stderr


def test_names_that_are_not_utf_8(meshes: Path) -> None:
    good, bad = os.fsdecode(b"caf\xe9 <1>.ply"), os.fsdecode(b"b\xe9d.ply")
    shutil.copy(meshes / "small.ply", meshes / good)
    (meshes / bad).write_text("ply\n")
    parquet = load("pyarrow.parquet")
    ran = run_module("dataset", meshes, "-o", os.fsdecode(b"\xe9"), "--resolution", 16, "--table", "table.parquet")
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.startswith("5 done, 1 quarantined, ") and ran.stdout.endswith("See \\xe9/index.html\n")
    out = Path(os.fsdecode(b"\xe9"))
    rows = table(out)
    assert rows[r"caf\xe9 <1>.ply"]["state"] == "done"
    assert rows[r"b\xe9d.ply"]["reason"] == r"b\xe9d.ply: line 2: the file ends within its header"
    assert {row["mesh"] for row in parquet.read_table("table.parquet").to_pylist()} == set(rows)
    page = (out / "index.html").read_text()
    assert r"caf\xe9 &lt;1&gt;.ply" in page and 'href="caf%E9%20%3C1%3E.ply.npz"' in page
    summary = generate(meshes, out)
    assert summary.new == [] and good in summary.done and summary.quarantined == [bad]


def test_the_table_may_lie_in_a_folder_that_does_not_exist(meshes: Path) -> None:
    load("pyarrow")
    generate(meshes, table="out/deep/down/t.parquet")
    generate(meshes, table="elsewhere/t.parquet")
    assert Path("out/deep/down/t.parquet").read_bytes() == Path("elsewhere/t.parquet").read_bytes()
    with pytest.raises(raymap.FileError, match="ball.ply"):
        generate(meshes, table="ball.ply/t.parquet")


def test_a_reader_that_ends_early_is_an_error_in_one_line(meshes: Path) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    ran = run_module("dataset", meshes, "-o", "out", "--resolution", 16, stdout=writing)
    os.close(writing)
    text = "raymap: error: standard output: cannot write the text: the program that reads it has ended\n"
    assert (ran.returncode, ran.stderr) == (4, text)
    with open("/dev/full", "w") as full:
        ran = run_module("dataset", meshes, "-o", "out", "--resolution", 16, stdout=full)
    text = "raymap: error: standard output: cannot write the text: No space left on device\n"
    assert (ran.returncode, ran.stderr) == (4, text)


def test_the_memory_limit(meshes: Path, large_ball: raymap.Mesh) -> None:
    large_ball.save(meshes / "large.ply")
    summary = generate(meshes, memory_limit=30_000_000, workers=1)
    assert (summary.done, summary.quarantined) == ([n for n in NAMES if n != "large.ply"], ["large.ply"])
    assert table()["large.ply"]["reason"].endswith("(memory_limit is 30000000 bytes)")
    assert generate(meshes).new == ["large.ply"]


def test_points_keep_to_the_memory_limit() -> None:
    limit = 100_000_000
    own, _ = sample_memory("dataset", "ball.ply", 1, limit)
    peak, result = sample_memory("dataset", "ball.ply", 400_000, limit)
    assert result == "written" and 20_000_000 < peak - own <= limit
    for count in (10**6, 10**8):  # The first would take half as much again.
        peak, result = sample_memory("dataset", "ball.ply", count, limit)
        text = f": the mesh and all {count} points are held at once; make fewer, or use a higher limit; raymap.Sampler streams any"
        assert result.endswith(f"{text} number (memory_limit is {limit} bytes)") and "resolution" not in result
        assert peak - own <= limit


def test_a_result_that_cannot_be_written_for_lack_of_memory_is_that_of_its_mesh(monkeypatch: pytest.MonkeyPatch) -> None:
    job = {"memory_limit": 1000, "options": {"device": "cpu"}}

    def answer(error: Exception) -> dict:
        def write() -> None:
            raise error

        monkeypatch.setattr(child, "_make", lambda job: ({}, write))
        return child._answer(job, 1 << 40)

    monkeypatch.setattr(child.resource, "setrlimit", lambda *_: None)
    for error, text in ((MemoryError(), "needs more memory"), (raymap.MemoryLimitError("no memory"), "no memory")):
        assert answer(error) == {"reason": f"{text} (memory_limit is 1000 bytes)", "again": True, "is_machine": False}
    assert answer(raymap.UnsupportedError("no OpenVDB")) == {"trouble": "unsupported", "reason": "no OpenVDB"}
    with pytest.raises(ZeroDivisionError):
        answer(ZeroDivisionError())


def test_points_are_those_of_sample_points(meshes: Path) -> None:
    options = {"n": 500, "near": 0.5, "sigma": [0.01], "surface": 0.1, "seed": 7, "normalize": True}
    assert raymap.dataset.generate(meshes, "out", what="points", **options).done == NAMES
    for name in NAMES:
        direct = raymap.sample_points(meshes / name, **options)
        made = np.load(f"out/{name}.points.npz")
        np.testing.assert_array_equal(made["pos"], direct.pos)
        np.testing.assert_array_equal(made["neg"], direct.neg)
        np.testing.assert_array_equal(made["centre"], direct.centre)
        assert made["scale"] == direct.scale
        row = table(name="table.points.csv")[name]
        assert int(row["points_inside"]) == len(direct.neg) > 0
        assert float(row["centre_z"]) == direct.centre[2]
        assert Path(f"out/{name}.points.png").exists()
    content = contents("out")
    raymap.dataset.generate(meshes, "again", what="points", workers=1, threads=2, **options)
    assert contents("again") == content
    assert raymap.dataset.generate(meshes, "out", what="points", **options).new == []
    assert raymap.dataset.generate(meshes, "out", what="points", **{**options, "seed": 8}).new == NAMES


def test_leftovers_of_killed_programs_are_removed(meshes: Path) -> None:
    """Those that somebody still writes are locked. Names with other numbers are of other users."""
    me = os.geteuid()
    Path(f"out/deep/.tetrahedron.ply.npz.tmp{me}-abc").mkdir(parents=True)
    Path(f"out/deep/.tetrahedron.ply.npz.tmp{me}-abc/result").touch()
    Path(f"out/.table.csv.tmp{me}-0").touch()
    kept = [f".b.npz.tmp{me}-0", f".table.csv.tmp{me + 1}-0", ".mine"]
    for name in kept:
        Path("out", name).touch()
    Path(f"out/.a.npz.tmp{me}-def").mkdir()
    with open(Path("out", kept[0])) as file:
        folder = os.open(f"out/.a.npz.tmp{me}-def", os.O_RDONLY)
        fcntl.flock(file, fcntl.LOCK_EX)
        fcntl.flock(folder, fcntl.LOCK_EX)
        generate(meshes)
        os.close(folder)
    assert sorted(p.name for p in Path("out").rglob(".*")) == sorted([".lock", f".a.npz.tmp{me}-def", *kept])


def test_progress(meshes: Path) -> None:
    said: list[tuple[str, float]] = []
    generate(meshes, workers=1, progress=lambda text, done: said.append((text, done)))
    assert [done for _, done in said] == [0.25, 0.5, 0.75, 1.0]
    assert re.fullmatch(r"2 of 4 meshes, \S+ per second, [0-9.]+ (s|min|h) left,", said[1][0])
    durations = {59.4: "59 s", 60: "1 min", 5399: "90 min", 5400: "1.5 h"}
    assert {seconds: _progress._duration(seconds) for seconds in durations} == durations
    said.clear()
    (meshes / "ball.ply").write_text("ply\n")
    generate(meshes, workers=1, progress=lambda text, done: said.append((text, done)))
    assert said[-1][0].startswith("4 of 4 meshes, 1 quarantined, ")
    with pytest.raises(raymap.Cancelled):
        generate(meshes, "other", workers=1, progress=lambda text, done: False)
    assert generate(meshes, "other").done == NAMES[1:]


def test_progress_of_the_command(meshes: Path, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["dataset", str(meshes), "-o", "out", "--workers", "1", "--resolution", "9"]
    assert command.main([*arguments, "--progress", "json"]) == 0
    said = [json.loads(line) for line in capsys.readouterr().err.splitlines()]
    assert [each["done"] for each in said] == [0.25, 0.5, 0.75, 1.0]
    assert re.fullmatch(r"2 of 4 meshes, \S+ per second, [0-9.]+ (s|min|h) left", said[1]["stage"])
    for style in (["--progress", "off"], ["--progress", "plain"], []):
        assert command.main([*arguments, *style]) == 0
        assert capsys.readouterr().err == ""


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
        ({"resolution": 0}, "resolution must be 1 or more"),
        ({"memory_limit": -1}, "memory_limit must be above 0"),
        ({"arrays": ["colour"]}, "nothing is named 'colour'"),
    ]:
        with pytest.raises(raymap.UsageError, match=text):
            raymap.dataset.generate(meshes, "out", **options)
    for options, text in [
        ({"n": -1}, "n must be 0 or more"),
        ({"n": 9, "near": 2}, "near must be"),
        ({"n": 9, "format": "npy"}, "points are written as npz"),
    ]:
        with pytest.raises(raymap.UsageError, match=text):
            raymap.dataset.generate(meshes, "out", what="points", **options)
    with pytest.raises(raymap.UsageError, match="resolution is no option of points"):
        generate(meshes, what="points", n=9)
    with pytest.raises(raymap.UsageError, match="n is no option of fields"):
        generate(meshes, n=9)
    with pytest.raises(TypeError, match="resolutoin"):
        generate(meshes, resolutoin=3)
    assert not Path("out").exists()


def test_an_unwritable_result_stops_the_run_and_quarantines_nothing(meshes: Path) -> None:
    Path("out").mkdir()
    Path("out/deep").write_text("a file where a folder must be")
    with pytest.raises(raymap.FileError, match="deep"):
        generate(meshes)
    assert not Path("out/quarantine").exists()


def test_the_command_line_takes_the_options_of_the_sign(meshes: Path) -> None:
    ran = run_module("dataset", meshes / "small.ply", "-o", "out", "--resolution", 16, "--sign", "evolution",
                     "--passes", 2, "--sampling", "paper", "--threshold", 0.4, "--invert")  # fmt: skip
    assert ran.returncode == 0 and ran.stderr == ""
    options = {"sign": "evolution", "passes": 2, "sampling": "paper", "threshold": 0.4, "invert": True}
    expected = raymap.generate(meshes / "small.ply", resolution=16, device="cpu", **options).distance
    np.testing.assert_array_equal(raymap.load_field("out/small.ply.npz").distance, expected)
    offsets = np.array([(1, 2, 3)])
    given = {**options, "sign": "paths", "offsets": offsets, "resolution": 16}
    for count in (1, 0):
        assert len(raymap.dataset.generate([meshes / "small.ply"], "other", **given).new) == count


def test_the_command_line(meshes: Path) -> None:
    (meshes / "bad.ply").write_text("ply\n")
    options = ["--resolution", 16, "--arrays", "winding", "--memory-limit", "1.0e0GiB", "--workers", 2]
    ran = run_module("dataset", meshes, "-o", "out", *options)
    assert ran.returncode == 0 and ran.stderr == ""
    assert ran.stdout.startswith("4 done, 1 quarantined, 0 unfinished; 5 of them new, in ")
    assert generate(meshes, arrays=["winding"], memory_limit=1 << 30).new == []
    wrong = run_module("dataset", meshes, "-o", "out", "--resolution", 0)
    assert wrong.returncode == 2 and wrong.stderr.startswith("raymap: error: resolution must")
    wrong = run_module("dataset", meshes, "-o", "out", "--what", "points", "-n", 9, "--resolution", 16)
    assert (wrong.returncode, wrong.stderr) == (2, "raymap: error: resolution is no option of points\n")
    assert run_module("dataset", "nowhere", "-o", "out").returncode == 4
    assert run_module("dataset", meshes, "-o", "out", "--memory-limit", "much").returncode == 2


@pytest.mark.parametrize(
    ("name", "functions", "others"),
    [
        ("dataset", [raymap.dataset.generate, raymap.generate], {"client", "origin", "offsets", "allow_empty"}),
        ("field", [raymap.zarr.generate], {"client", "sign"}),
    ],
)
def test_a_command_explains_the_arguments_of_its_functions(
    name: str, functions: list[Callable[..., object]], others: set[str], capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        command.main([name, "--help"])
    text = " ".join(capsys.readouterr().out.partition("options:")[2].split())
    for function in functions:
        for parameter in inspect.signature(function).parameters.values():
            if parameter.kind is parameter.KEYWORD_ONLY and parameter.name not in others:
                assert re.search(rf"--{parameter.name.replace('_', '-')} [^-]*[a-z]{{3,}}", text), parameter.name
