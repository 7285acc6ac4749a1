"""Thickness, simplification, pictures of defects, animated meshes."""

from __future__ import annotations

import base64
import json
import struct

import numpy as np
import pytest
import raymap


def box(size: tuple[float, float, float]) -> raymap.Mesh:
    corners = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float) * size
    faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4),
             (2, 6, 3), (3, 6, 7), (0, 4, 2), (2, 4, 6), (1, 3, 5), (3, 7, 5)]  # fmt: skip
    return raymap.Mesh(corners, faces)


def area_of(mesh: raymap.Mesh) -> np.ndarray:
    a, b, c = mesh.vertices[mesh.faces].transpose(1, 0, 2)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


def test_points_of_faces_stand_for_their_area():
    mesh = box((4, 3, 0.5))
    points = raymap.sample_faces(mesh, step=0.25)
    np.testing.assert_allclose(np.bincount(points.triangle, points.area), area_of(mesh), rtol=1e-6)
    np.testing.assert_allclose(raymap.Surface(mesh).signed_distance(points.position), 0, atol=1e-6)
    for step in (0, float("nan")):
        with pytest.raises(raymap.UsageError, match="step must be above 0"):
            raymap.sample_faces(mesh, step=step)


def test_a_plate_is_as_thick_as_it_is():
    surface = raymap.Surface(box((4, 3, 0.5)))
    points = [(2, 1.4, 0), (2, 1.6, 0.5)]
    found = surface.thickness(points, [0, 2])
    assert list(found.part) == ["wall", "wall"]
    np.testing.assert_allclose(found.diameter, 0.5, atol=1e-5)
    np.testing.assert_allclose(found.inward, [(0, 0, 1), (0, 0, -1)])
    thin = surface.thickness(points, [0, 2], max_thickness=0.4)
    assert set(thin.part) == {"solid"} and np.isinf(thin.diameter).all()


def test_a_summary_of_the_thickness():
    found = raymap.Surface(box((40, 30, 0.5))).thickness_summary(threads=1)
    assert found["thinnest"] == pytest.approx(0.5, abs=1e-4) and found["median"] == pytest.approx(0.5, abs=1e-4)
    assert found["sheet_share"] < 1e-4 and found["buried_share"] < 1e-4 and found["points"] == 100_000
    assert len(found["thinnest_at"]) == 3 and np.isnan(found["sharpest"])
    assert set(raymap.ThicknessSummary.__annotations__) == set(found)


def test_thickness_refuses_what_makes_no_sense(ball):
    surface = raymap.Surface(ball)
    points = np.zeros((2, 3))
    with pytest.raises(raymap.InputError, match=r"triangles must be \(2,\) whole numbers"):
        surface.thickness(points, [1])
    with pytest.raises(raymap.InputError, match="triangles must be"):
        surface.thickness(points, [0.0, 1.0])
    with pytest.raises(raymap.UsageError, match="point 1 lies on triangle 1280"):
        surface.thickness(points, [0, 1280])
    for wrong in (-1, 2**32):
        with pytest.raises(raymap.UsageError, match="triangles must be indices of faces, from 0 on"):
            surface.thickness(points, [0, wrong])
    with pytest.raises(raymap.UsageError, match="max_thickness must be above 0"):
        surface.thickness(points, [0, 1], max_thickness=0)
    with pytest.raises(raymap.UsageError, match="without a sign"):
        raymap.Surface(ball, sign=False).thickness_summary()


def test_simplify_keeps_to_its_tolerance(ball):
    mesh, report = raymap.simplify(ball, tolerance=0.02)
    assert report["triangles_before"] == len(ball.faces) and report["triangles_after"] == len(mesh.faces) < 640
    assert 0 < report["deviation"] <= report["tolerance"] == 0.02
    np.testing.assert_array_equal(raymap.simplify(ball, tolerance=0.02, threads=1).mesh.faces, mesh.faces)
    with pytest.raises(raymap.InputError):
        raymap.simplify(raymap.Mesh(ball.vertices, ball.faces[1:]), tolerance=0.02)
    with pytest.raises(raymap.UsageError, match="step must be above 0, not -1"):
        raymap.simplify(ball, tolerance=0.02, step=-1)
    with pytest.raises(raymap.UsageError):
        raymap.simplify(ball, tolerance=-1)


def test_simplify_reaches_a_number_of_triangles(ball):
    mesh, report = raymap.simplify(ball, triangles=400)
    assert 350 < report["triangles_after"] == len(mesh.faces) <= 400
    with pytest.warns(raymap.RaymapWarning, match="are left instead of 400") as warned:
        limited = raymap.simplify(ball, tolerance=0.001, triangles=400)
    assert warned[0].message.code == "triangles_missed"
    assert warned[0].message.fields["count"] == limited.report["triangles_after"] > 400
    repaired = raymap.repair(ball, triangles=400, remesh=True, resolution=32).report["simplified"]
    assert 350 < repaired["triangles_after"] <= 400 < repaired["triangles_before"]
    for call in (raymap.simplify, raymap.repair):
        with pytest.raises(raymap.UsageError, match="a tolerance of 0 keeps all triangles"):
            call(ball, tolerance=0, triangles=400)
        with pytest.raises(raymap.UsageError, match="triangles must be 1 or more, not 0"):
            call(ball, triangles=0)
    with pytest.raises(raymap.UsageError, match="needs a tolerance, a number of triangles, or both"):
        raymap.simplify(ball)


def test_pictures_show_defects(ball):
    options = {"width": 160, "height": 120, "direction": (0, 0, -1)}
    whole = raymap.render_defects(ball, **options).astype(int)
    assert whole.shape == (120, 160, 3)
    top = ball.vertices[ball.faces].mean(axis=1)[:, 2] > 0.95
    holed = raymap.render_defects(ball.vertices, ball.faces[~top], **options).astype(int)
    is_red = [(p[..., 0] > p[..., 1] + 80) & (p[..., 0] > p[..., 2] + 80) for p in (whole, holed)]
    assert not is_red[0].any() and is_red[1].sum() > 20
    with pytest.raises(raymap.UsageError):
        raymap.render_defects(ball, width=0)


def animated(path: str) -> None:
    """Writes a triangle that moves by (2, 4, 0) within two seconds, and stays for another one."""
    vertices = struct.pack("<9f", 0, 0, 0, 1, 0, 0, 0, 1, 0)
    times = struct.pack("<3f", 0, 2, 3)
    values = struct.pack("<9f", 0, 0, 0, 2, 4, 0, 2, 4, 0)
    data = vertices + times + values
    views = [{"buffer": 0, "byteOffset": o, "byteLength": n} for o, n in ((0, 36), (36, 12), (48, 36))]
    accessor = {"componentType": 5126, "count": 3}
    document = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
        "bufferViews": views,
        "accessors": [
            {**accessor, "bufferView": 0, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {**accessor, "bufferView": 1, "type": "SCALAR", "min": [0], "max": [3]},
            {**accessor, "bufferView": 2, "type": "VEC3"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "animations": [{
            "samplers": [{"input": 1, "output": 2, "interpolation": "LINEAR"}],
            "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
        }],
    }  # fmt: skip
    with open(path, "w") as file:
        json.dump(document, file)


def test_animated_meshes():
    animated("walk.gltf")
    animation = raymap.load_animation("walk.gltf")
    assert animation.duration == 3 and repr(animation) == "raymap.Animation(3 s)"
    rest = raymap.load_mesh("walk.gltf")
    for time, moved in ((-1, (0, 0, 0)), (0, (0, 0, 0)), (0.5, (0.5, 1, 0)), (2, (2, 4, 0)), (9, (2, 4, 0))):
        mesh = animation.mesh(time)
        np.testing.assert_allclose(mesh.vertices, [(0, 0, 0), (1, 0, 0), (0, 1, 0)] + np.array(moved), atol=1e-6)
        np.testing.assert_array_equal(mesh.faces, rest.faces)
    with pytest.raises(raymap.UsageError, match="there is no animation 1: it has 1 animation"):
        raymap.load_animation("walk.gltf", 1)
    with pytest.raises(raymap.UsageError, match="index must be 0 or more, not -1"):
        raymap.load_animation("walk.gltf", -1)
    with pytest.raises(raymap.UsageError, match="time must be finite, not nan"):
        animation.mesh(float("nan"))
    with pytest.raises(raymap.FileError):
        raymap.load_animation("gone.glb")
