"""Meshes: files, arrays of every layout, diagnostics and repair."""

from __future__ import annotations

import inspect
import json
import os
import pickle
import subprocess
import sys
import warnings
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import raymap


@pytest.mark.parametrize("extension", ["ply", "obj", "glb", "stl", "3mf"])
def test_files_give_back_the_mesh(ball, extension):
    ball.save(f"mesh.{extension}")
    read = raymap.load_mesh(f"mesh.{extension}")
    np.testing.assert_allclose(read.vertices[read.faces], ball.vertices[ball.faces], atol=1e-6)
    assert read.vertices.dtype == np.float64 and read.faces.dtype == np.uint32


def test_a_format_that_moves_a_mesh_far_away_warns(ball):
    far = raymap.Mesh(ball.vertices + (5e6, 4e6, 100), ball.faces)
    with pytest.warns(raymap.RaymapWarning, match="moves vertices by up to 0.* or move the mesh closer"):
        far.save("far.stl")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        far.save("far.ply")
        ball.save("near.stl")


def test_meshes_far_away_lose_no_precision(ball):
    far = ball.vertices + (1e7, -2e7, 3e7)
    raymap.Mesh(far, ball.faces).save("far.ply")
    read = raymap.load_mesh("far.ply")
    assert np.abs(read.vertices - far).max() < 1e-7
    field = raymap.generate("far.ply", resolution=16, device="cpu")
    near = raymap.generate(ball, resolution=16, device="cpu")
    np.testing.assert_allclose(field.distance, near.distance, atol=1e-6)


def test_a_mesh_never_changes(ball):
    vertices, faces = ball.vertices.copy(), ball.faces.copy()
    mesh = raymap.Mesh(vertices, faces)
    views: list[pickle.PickleBuffer] = []
    stream = pickle.dumps(mesh, protocol=5, buffer_callback=views.append)
    buffers = [bytearray(view.raw()) for view in views]
    copy = pickle.loads(stream, buffers=buffers)
    unpickled = copy.vertices, copy.faces
    far = raymap.Surface(vertices + 1e6, faces).mesh  # Its vertices are about an origin.
    for array in (mesh.vertices, mesh.faces, *unpickled, raymap.load_mesh("ball.ply").vertices, far.vertices, far.faces):
        assert not array.flags.writeable
        with pytest.raises(ValueError):
            array.flags.writeable = True
    vertices[:], faces[:] = 7, 0
    np.testing.assert_array_equal(mesh.vertices, ball.vertices)
    np.testing.assert_array_equal(mesh.faces, ball.faces)
    np.testing.assert_array_equal(mesh.bounds, ball.bounds)
    for buffer in buffers:
        buffer[:] = bytes(len(buffer))
    np.testing.assert_array_equal(unpickled[0], ball.vertices)
    np.testing.assert_array_equal(unpickled[1], ball.faces)


def test_functions_read_arrays_in_place(ball):
    vertices, faces = ball.vertices.copy(), ball.faces.copy()
    viewed = raymap._inputs.to_mesh(vertices, faces)
    assert np.shares_memory(viewed.vertices, vertices) and np.shares_memory(viewed.faces, faces)
    assert vertices.flags.writeable and faces.flags.writeable
    single, large = vertices.astype(np.float32), faces.astype(np.int64)
    viewed = raymap._inputs.to_mesh(single, large)
    assert np.shares_memory(viewed.vertices, single) and np.shares_memory(viewed.faces, large)


def test_arrays_of_loaded_meshes_are_read_only(ball):
    loaded = raymap.load_mesh("ball.ply")
    assert not loaded.vertices.flags.writeable and not loaded.faces.flags.writeable
    assert loaded.vertices is loaded.vertices
    faces = loaded.faces
    del loaded
    assert faces[0, 0] == ball.faces[0, 0]


def test_pickling(ball):
    loaded = raymap.load_mesh("ball.ply")
    made = raymap.generate(ball.vertices + (7, 8, 9), ball.faces, resolution=12, device="cpu").to_mesh()
    for mesh in (ball, loaded, made):
        copy = pickle.loads(pickle.dumps(mesh))
        np.testing.assert_array_equal(copy.vertices, mesh.vertices)
        np.testing.assert_array_equal(copy.faces, mesh.faces)
        assert copy.vertices.dtype == np.float64
        same = [raymap.generate(m, resolution=12, device="cpu").distance for m in (copy, mesh)]
        np.testing.assert_array_equal(*same)


@pytest.mark.parametrize("kept", [
    "raymap.Surface(ball).mesh",
    "raymap.Surface(ball).mesh.vertices",
    "raymap.Mesh(ball.vertices, ball.faces)",
    "raymap.Surface(raymap.Mesh(ball.vertices, ball.faces))",
    "pickle.loads(pickle.dumps(ball))",
    "raymap._inputs.to_mesh(ball.vertices, ball.faces)",
])
def test_what_is_kept_until_the_end_is_no_leak(kept):
    program = f"import pickle, raymap; ball = raymap.load_mesh('ball.ply'); kept = {kept}"
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "", "")


def test_names_that_are_not_utf_8():
    name = os.fsdecode(b"caf\xe9.obj")
    Path(name).write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ncurv2 1 2\n")
    with pytest.warns(raymap.RaymapWarning, match=r"^caf\\xe9\.obj: "):
        assert len(raymap.load_mesh(name).faces) == 1
    with pytest.raises(raymap.FileError, match=r"^gone\\xe9\.obj: "):
        raymap.load_mesh(os.fsdecode(b"gone\xe9.obj"))


def strided(array: np.ndarray) -> np.ndarray:
    wide = np.zeros((len(array), 5), array.dtype)
    wide[:, :3] = array
    return wide[:, :3]


@pytest.mark.parametrize("change", [
    lambda v, f: (v, f.astype(np.int64)),
    lambda v, f: (v, f.astype(np.uint64)),
    lambda v, f: (v, f.astype(np.int32)),
    lambda v, f: (v, f.astype(np.int16)),
    lambda v, f: (v, f.astype(">u4")),
    lambda v, f: (v.astype(">f8"), f),
    lambda v, f: (np.asfortranarray(v), np.asfortranarray(f)),
    lambda v, f: (strided(v), strided(f)),
    lambda v, f: (v[::-1], len(v) - 1 - f),
    lambda v, f: (np.ascontiguousarray(v[:, ::-1])[:, ::-1], f),
    lambda v, f: (v.tolist(), f.tolist()),
    lambda v, f: (np.repeat(v, 2, axis=0)[::2], f),
])
def test_layouts_of_arrays(ball, change):
    expected = raymap.generate(ball, resolution=12, device="cpu").distance
    vertices, faces = change(ball.vertices, ball.faces)
    made = raymap.generate(vertices, faces, resolution=12, device="cpu").distance
    np.testing.assert_array_equal(made, expected)


@pytest.mark.parametrize("given, read", [("i4", "u4"), ("u4", "u4"), ("i2", "u4"), ("i8", "u8"), ("u8", "u8")])
def test_faces_keep_their_size(ball, given, read):
    faces = ball.faces.astype(given)
    mesh = raymap.Mesh(ball.vertices, faces)
    assert mesh.faces.dtype == read
    np.testing.assert_array_equal(mesh.faces, ball.faces)


def test_decimals_of_a_file_stay_as_they_are():
    text = "v 0.1 0 0.3\nv 1.7 0 0\nv 0 0.22 0\nv 0.7 0.7 123.456\nf 1 2 3\nf 1 3 4\n"
    Path("a.obj").write_text(text)
    mesh = raymap.load_mesh("a.obj")
    np.testing.assert_array_equal(mesh.vertices, [(0.1, 0, 0.3), (1.7, 0, 0), (0, 0.22, 0), (0.7, 0.7, 123.456)])
    mesh.save("b.obj")
    assert Path("b.obj").read_text() == text
    again = pickle.loads(pickle.dumps(mesh))
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    field = raymap.generate(raymap.Mesh(mesh.vertices, mesh.faces), resolution=8, device="cpu")
    np.testing.assert_array_equal(raymap.generate("a.obj", resolution=8, device="cpu").distance, field.distance)


def test_a_far_vertex_is_named():
    Path("a.obj").write_text("".join(f"v {v & 1} {v >> 1 & 1} {v >> 2}\n" for v in range(7)) + "v 1 1 1e20\n"
                             + "".join(f"f {a} {b} {c}\n" for a, b, c in ((1, 3, 2), (2, 3, 4), (5, 6, 7), (6, 8, 7), (1, 2, 5), (2, 6, 5))))
    with pytest.warns(raymap.RaymapWarning, match=r"vertex 7 \(used by triangle 3\) at \(1, 1, 1e\+20\)") as caught:
        mesh = raymap.load_mesh("a.obj")
    assert (caught[0].message.code, caught[0].message.fields["count"]) == ("far_vertices", 1)
    assert raymap.info(mesh)["far_vertices"] == 1


def test_single_precision(ball):
    vertices = ball.vertices.astype(np.float32)
    mesh = raymap.Mesh(vertices, ball.faces)
    assert mesh.vertices.dtype == np.float32
    single = raymap.generate(mesh, resolution=12, device="cpu")
    double = raymap.generate(ball, resolution=12, device="cpu")
    np.testing.assert_allclose(single.distance, double.distance, atol=1e-6)
    half = raymap.generate(vertices.astype(np.float16), ball.faces, resolution=12, device="cpu")
    np.testing.assert_allclose(half.distance, double.distance, atol=1e-2)


@pytest.mark.parametrize("vertices, faces, text", [
    (np.zeros((4, 2)), [(0, 1, 2)], r"vertices must be \(n, 3\) positions, not of the shape \(4, 2\)"),
    (np.zeros(3), [(0, 1, 2)], "vertices must be"),
    (np.zeros((4, 3)), [(0, 1)], r"faces must be \(n, 3\) vertex numbers, not of the shape \(1, 2\)"),
    (np.zeros((4, 3)), [(0.0, 1.0, 2.5)], "faces must be whole numbers, not float64 such as 2.5; for distances at points, use"),
    (np.zeros((4, 3)), [(0.0, np.nan, 2.0)], "faces must be whole numbers, not float64 such as nan"),
    (np.zeros((4, 3)), [(0.0, 2.0**53, 2.0)], "faces must be whole numbers, not float64 such as 9.0"),
    (np.zeros((4, 3)), [(True, False, True)], "faces must be whole numbers, not bool"),
    (np.zeros((4, 3)), [(0, 1, 2), (0, 1)], "faces must be rows of the same length: row 1 has 2 numbers, row 0 has 3"),
    ([(0, 0, 0), (1, 0)], [(0, 1, 2)], "vertices must be rows of the same length: row 1 has 2 numbers, row 0 has 3"),
    ([[(0, 0, 0)], [(1, 0)]], [(0, 1, 2)], "vertices must be rows of the same length: they are ragged"),
    ([(0, 0, 0), (1, 0, "2")], [(0, 1, 2)], "vertices must be numbers, not <U"),
    (np.array([(0, 0, None)]), [(0, 1, 2)], r"vertices must be numbers, but \[0, 2\] is None"),
    (np.array([(0, 0, "1")], object), [(0, 1, 2)], r"vertices must be numbers, but \[0, 2\] is str"),
    (np.zeros((4, 3)), [3, 0, 1, 2, 3, 0, 1], r"faces of the shape \(7,\) must have the number of its corners before each face, "
     "but number 4 is 3"),
    (np.zeros((4, 3)), [0, 1, 2, 0, 2, 3], "must have the number of its corners before each face, but number 0 is 0"),
    (np.zeros((4, 3)), [2, 1, 2], "before each face, but number 0 is 2"),
    (np.zeros((9, 3)), [(3, 0, 1, 2), (3, 4, 5, 6)], "faces: each row of 4 numbers begins with 3, which may be the number of its"),
    (np.zeros((4, 3)), [(0, 1, 2, 4)], "a face has a vertex number out of range: 0 to 4"),
    (np.zeros((4, 3)), [(0, 1, 2), (0, -1, 2)], r"face 1 has a negative vertex number: \[0, -1, 2\]"),
    (np.zeros((4, 3), complex), [(0, 1, 2)], "vertices must be numbers, not complex128"),
])
def test_arrays_that_are_no_mesh(vertices, faces, text):
    with pytest.raises(raymap.InputError, match=text):
        raymap.Mesh(vertices, faces)


def test_things_that_are_no_mesh():
    with pytest.raises(raymap.UsageError, match="vertices without faces"):
        raymap.generate(np.zeros((4, 3)))
    with pytest.raises(TypeError, match="no mesh: builtins.int"):
        raymap.generate(3)
    with pytest.raises(raymap.UsageError, match="a surface where a mesh is wanted: give surface.mesh, or call surface.generate"):
        raymap.generate(raymap.Surface("ball.ply"))
    with pytest.raises(raymap.InputError, match=r"triangles must be \(n, 3, 3\) positions, not of the shape \(4, 3, 2\)"):
        raymap.generate(np.zeros((4, 3, 2)))


@pytest.mark.parametrize("function", [raymap.generate, raymap.Generator().generate, raymap.Surface, raymap.info])
def test_points_in_place_of_faces(function, ball):
    hint = r"for distances at points, use raymap.signed_distance\(mesh, points\), or raymap.Surface"
    points = np.zeros((5, 3))
    for mesh in (ball, "ball.ply", Path("ball.ply"), SimpleNamespace(vertices=ball.vertices, faces=ball.faces)):
        with pytest.raises(raymap.UsageError, match="a mesh and faces: give the mesh alone; " + hint):
            function(mesh, points)
    with pytest.raises(raymap.InputError, match="faces must be whole numbers, not float64; " + hint):
        function(ball.vertices, points)


def figures(info):
    """Returns what is found about a mesh, without its words."""
    return {name: value for name, value in info.items() if not name.endswith("_text")}


def test_info_is_that_of_the_command_line(ball, run_raymap):
    broken = raymap.Mesh(ball.vertices, np.concatenate([ball.faces[40:90, ::-1], ball.faces[95:], ball.faces[200:203]]))
    broken.save("broken.ply")
    found = raymap.info("broken.ply")

    def printed(*arguments):
        """Returns what the command line prints, without the file and its unit."""
        result = json.loads(run_raymap("info", "broken.ply", "--json", *arguments))
        assert (result.pop("file"), result.pop("unit")) == ("broken.ply", None)
        return result

    assert figures(found) == printed()
    assert found["hole_count"] > 0 and found["duplicate_faces"] == 3 and not found["watertight"]
    assert figures(raymap.info("broken.ply", fast=True)) == printed("--fast")
    assert set(found) == set(raymap.Info.__annotations__)
    text = run_raymap("info", "broken.ply")
    assert "\nThis is " + found["kind_text"] + "\n" in text
    assert text.endswith(found["thickness_text"].replace("a voxel size of ", "--voxel-size ") + "\n")
    assert "wrong with it: " + found["defects_text"] + "\n" in run_raymap("repair", "broken.ply", "-o", "solid.ply", "--resolution", "32")


def test_repair_is_that_of_the_command_line(ball, run_raymap):
    broken = raymap.Mesh(ball.vertices, ball.faces[60:])
    broken.save("broken.ply")
    options = dict(resolution=40, offset=0.1, shell=0.3, drain_hole=0.4, drain_holes=2, down=(0, -1, 0),
                   min_thickness=0.25)
    arguments = "--resolution 40 --offset 0.1 --shell 0.3 --drain-hole 0.4 --drain-holes 2 --down 0 -1 0"
    arguments = (arguments + " --min-thickness 0.25").split()
    run_raymap("repair", "broken.ply", "-o", "solid.glb", "--device", "cpu", "--stats", "stats.json", *arguments)
    mesh, report = raymap.repair("broken.ply", device="cpu", **options)
    mesh.save("mine.glb")  # A format that rounds nothing.
    assert Path("mine.glb").read_bytes() == Path("solid.glb").read_bytes()
    written = json.load(open("stats.json"))
    assert set(report) == set(raymap.RepairReport.__annotations__)
    stats, theirs = report.pop("stats"), written.pop("stats")
    assert report == {key: written[key] for key in report}
    assert set(stats) == set(theirs) == set(raymap.Stats.__annotations__)
    assert stats["patch_area"] == theirs["patch_area"] and len(stats["turned_faces"]) == theirs["turned_faces"]
    assert report["hollows"] == 1 and report["drain_holes"] == 2
    directions = [place["direction"] for place in report["drain_hole_places"]]
    np.testing.assert_allclose(directions, [[0, -1, 0], [0, 1, 0]], atol=1e-12)


def test_repair_tells_where_faces_come_from(ball):
    open_ball = raymap.Mesh(ball.vertices, np.delete(ball.faces, 5, axis=0))
    result = raymap.repair(open_ball, device="cpu")
    assert result.report["depth"] == "mended" and result.face_source.dtype == np.uint32
    np.testing.assert_array_equal(result.face_source[:-1], np.arange(len(open_ball.faces)))
    assert result.face_source[-1] == raymap.NO_TRIANGLE and len(result.face_source) == len(result.mesh.faces)
    mesh, report = result
    assert mesh is result.mesh and repr(result).startswith("raymap.Repaired\nmesh")
    assert len(raymap.repair(ball, resolution=32, remesh=True, device="cpu").face_source) == 0


def test_repair_keeps_what_is_right(ball):
    kept = raymap.repair(ball)
    assert kept.report["depth"] == "as_given" and kept.report["solids"] == 1 and kept.report["cavities"] == 0
    np.testing.assert_array_equal(kept.mesh.faces, ball.faces)
    crumb = 0.09 * ball.vertices + (2, 0, 0)
    both = raymap.Mesh(np.vstack([ball.vertices, crumb]), np.vstack([ball.faces, ball.faces + len(ball.vertices)]))
    with pytest.warns(UserWarning, match="kept 1 part"):
        assert raymap.repair(both).report["solids"] == 2
    dropped = raymap.repair(both, drop_smaller=0.01)
    assert dropped.report["depth"] == "as_given" and len(dropped.mesh.faces) == len(ball.faces)
    with pytest.raises(raymap.UsageError):
        raymap.repair(both, drop_smaller=-1)


def test_repair_joins_a_sheet_to_a_base():
    sheet = raymap.Mesh([(0, 0, 1), (3, 0, 1), (0, 3, 1.5)], [(0, 1, 2)])
    with pytest.warns(raymap.RaymapWarning, match=r"is a sheet.*\(base, or thickness=0.06 of raymap.generate\)"):
        raymap.repair(sheet, resolution=16, device="cpu")
    report = raymap.repair(sheet, base=-1, device="cpu").report
    assert report["depth"] == "mended" and report["after"]["watertight"] and abs(report["after"]["bounds"][0][2] + 1) < 1e-6
    with pytest.raises(raymap.InputError):
        raymap.repair(sheet, base=1.5, device="cpu")


def test_repair_without_options(ball):
    result = raymap.repair(ball, voxel_size=0.1, close_holes=False, orientation="keep", threads=1, remesh=True)
    found = raymap.info(result.mesh)
    assert found.pop("verdict")["kind"] == "clean_solid"
    assert found["watertight"] and figures(found) == result.report["after"]
    for options in (dict(voxel_size=-1), dict(shell=0.001), dict(min_thickness=0.001), dict(drain_hole=1),
                    dict(down=(0, 0, 0)), dict(orientation="up"), dict(memory_limit=0)):
        with pytest.raises(raymap.UsageError):
            raymap.repair(ball, **{"resolution": 16, **options})


def test_the_defaults_of_a_repair_are_those_of_the_command_line(ball, run_raymap):
    open_ball = raymap.Mesh(ball.vertices, ball.faces[1:])
    open_ball.save("mesh.ply")
    run_raymap("repair", "mesh.ply", "-o", "solid.ply", "--stats", "solid.json")
    stats = json.loads(Path("solid.json").read_text())
    report = raymap.repair(open_ball).report
    assert report["closed_holes"] == stats["closed_holes"] == 1 and stats["options"]["close_holes"]
    assert max(stats["grid"]["dims"]) == 256
    assert inspect.signature(raymap.repair).parameters["resolution"].default is None
