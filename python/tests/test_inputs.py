"""Meshes of other packages and arrays of other frameworks."""

from __future__ import annotations

import io
import os
import sys
from decimal import Decimal
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
import raymap
from helpers import Exporter, load


def check(ball: raymap.Mesh, given, faces=None, atol: float = 0.0) -> None:
    expected = raymap.generate(ball, resolution=12, device="cpu").distance
    for call in (raymap.generate, raymap.Generator().generate):
        np.testing.assert_allclose(call(given, faces, resolution=12, device="cpu").distance, expected, atol=atol, rtol=0)
    assert raymap.info(given, faces)["triangles"] == len(ball.faces)


def test_trimesh(ball):
    trimesh = load("trimesh")
    mesh = trimesh.Trimesh(ball.vertices, ball.faces, process=False)
    check(ball, mesh)
    scene = trimesh.Scene()
    scene.add_geometry(mesh, transform=trimesh.transformations.translation_matrix((5, 0, 0)))
    field = raymap.generate(scene, resolution=12, device="cpu")
    assert field.sample((5, 0, 0)) < -0.5
    made = field.to_mesh()
    assert trimesh.Trimesh(made.vertices, made.faces).is_watertight


CORNERS = np.array([(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
QUADS = np.array([(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
TRIANGLES = QUADS[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


@pytest.mark.parametrize(
    "mesh",
    [
        (CORNERS, TRIANGLES),
        (CORNERS.tolist(), TRIANGLES.tolist()),
        [CORNERS, TRIANGLES],
        {"vertices": CORNERS, "faces": TRIANGLES},
        (CORNERS.astype(object), TRIANGLES.astype(object)),
        (CORNERS, TRIANGLES.astype(np.float32)),
        (CORNERS, TRIANGLES.astype(float).tolist()),
        (CORNERS, QUADS),
        (CORNERS, QUADS.astype(float)),
        (CORNERS, np.insert(QUADS, 0, 4, axis=1)),
        (CORNERS, np.insert(QUADS, 0, 4, axis=1).ravel()),
        (CORNERS, np.insert(TRIANGLES, 0, 3, axis=1)),
        (CORNERS, np.insert(TRIANGLES, 0, 3, axis=1).ravel()),
        (CORNERS, np.concatenate([[3, 0, 2, 3, 3, 0, 3, 1], np.insert(QUADS[1:], 0, 4, axis=1).ravel()])),
        CORNERS[TRIANGLES],
        CORNERS[TRIANGLES].tolist(),
        list(CORNERS[TRIANGLES].astype(np.float32)),
    ],
)
def test_ways_to_give_a_cube(mesh):
    surface = raymap.Surface(mesh)
    kept = surface.mesh
    np.testing.assert_array_equal(kept.vertices[kept.faces], CORNERS[TRIANGLES])
    np.testing.assert_array_equal(surface.signed_distance([(0.5, 0.5, 0.5), (0.5, 0.5, 3)]), [-0.5, 2])
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        made = raymap.Mesh(*mesh)
        np.testing.assert_array_equal(made.vertices[made.faces], CORNERS[TRIANGLES])


def test_two_triangles():
    """A tuple of two arrays is vertices and faces, all else is triangles."""
    triangles = np.array([[(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2), (1, 2, 0), (2, 0, 1)]], float)
    for mesh in (triangles, triangles.tolist(), list(triangles)):
        assert len(raymap.Surface(mesh, sign=False).mesh.vertices) == 6
    assert len(raymap.Surface(tuple(triangles), sign=False).mesh.vertices) == 3


def test_rows_that_begin_with_their_length():
    """A row of a triangle whose vertex 3 does not exist, or which has the number 3 again, is padded."""
    np.testing.assert_array_equal(raymap.Mesh(CORNERS[:3], [(3, 0, 1, 2)]).faces, [(0, 1, 2)])
    np.testing.assert_array_equal(raymap.Mesh(CORNERS, [(3, 0, 1, 2), (3, 3, 2, 1)]).faces, [(0, 1, 2), (3, 2, 1)])
    np.testing.assert_array_equal(raymap.Mesh(CORNERS, [(3, 1, 0, 2), (2, 0, 4, 6)]).faces[2:], [(2, 0, 4), (2, 4, 6)])
    assert raymap.Mesh(CORNERS, np.empty((0, 4), int)).faces.shape == (0, 3)


def test_polygons_that_are_not_convex():
    corners = np.array([(0, 0, 0), (2, 0, 0), (0.5, 0.5, 0), (0, 2, 0)])
    made = raymap.Mesh(corners, [(1, 2, 3, 0)])
    a, b, c = (made.vertices[made.faces[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all() and np.cross(b - a, c - a)[:, 2].sum() == pytest.approx(2)
    with pytest.warns(raymap.RaymapWarning, match="faces that cross themselves, or whose corners lie on a line: 1"):
        raymap.Mesh(np.zeros((4, 3)), [(0, 1, 2, 3)])


def test_open_files(ball, tmp_path):
    expected = raymap.load_mesh("ball.ply")
    for extension in ("ply", "stl", "obj", "glb", "3mf", "off"):
        path = tmp_path / f"ball.{extension}"
        if extension == "off":
            rows = [*(" ".join(map(repr, v)) for v in ball.vertices.tolist()), *("3 " + " ".join(map(str, f)) for f in ball.faces)]
            path.write_text("\n".join(["OFF", f"{len(ball.vertices)} {len(ball.faces)} 0", *rows]))
        else:
            expected.save(path)
        named = raymap.load_mesh(path)
        content = path.read_bytes()
        with path.open("rb") as file:
            for given in (file, io.BytesIO(content)):
                np.testing.assert_array_equal(raymap.load_mesh(given).vertices, named.vertices)
                assert given.read() == b""
        np.testing.assert_array_equal(raymap.Surface(io.BytesIO(content)).mesh.faces, raymap.Surface(path).mesh.faces)
        assert raymap.load_mesh(os.fsencode(path)).faces.shape == raymap.load_mesh(str(path)).faces.shape
    with open(tmp_path / "ball.obj") as file:
        assert len(raymap.load_mesh(file).faces) == len(ball.faces)
    text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid a\n"
    assert len(raymap.load_mesh(io.StringIO(text)).faces) == 1
    with pytest.raises(raymap.UnsupportedError, match="an open file without a name: its content is of no format of meshes"):
        raymap.load_mesh(io.BytesIO(b"nothing"))
    with pytest.raises(raymap.InputError, match="^the open file: "):
        raymap.load_mesh(io.BytesIO(b"ply\nformat none\n"))


def test_files_at_home(ball, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    raymap.load_mesh("ball.ply").save("~/a.ply")
    assert len(raymap.Surface("~/a.ply").mesh.faces) == len(raymap.load_mesh(Path("~/a.ply")).faces) == len(ball.faces)
    field = raymap.generate("~/a.ply", resolution=8, device="cpu")
    for name in ("~/a.npz", "~/a.vdb"):
        field.save(name)
        np.testing.assert_array_equal(raymap.load_field(name).distance, field.distance)
    field.to_sparse(band=3).save("~/b.vdb")
    assert raymap.load_field("~/b.vdb", sparse=True).shape == field.shape
    raymap.save_pyramid([field], "~/p.npz")
    assert len(raymap.load_pyramid("~/p.npz")) == 1
    raymap.sample_points("~/a.ply", 10).save("~/s.npz")
    assert {"a.ply", "a.npz", "a.vdb", "b.vdb", "p.npz", "s.npz"} <= {path.name for path in tmp_path.iterdir()}


def test_points_that_are_objects(ball):
    surface = raymap.Surface(ball)
    points = np.array([(0, 0.5, Decimal("1.5")), (Fraction(1, 2), np.float32(0), 2)], object)
    np.testing.assert_array_equal(surface.signed_distance(points), surface.signed_distance(points.astype(float)))
    for given, text in (
        ([(0, 0, 0), (0, 0)], "points must be rows of the same length: row 1 has 2 numbers, row 0 has 3"),
        (np.array([(0, 1j, 0)], object), r"points must be numbers, but \[0, 1\] is complex"),
        (np.array([(0, "1", 0)], object), r"points must be numbers, but \[0, 1\] is str"),
    ):
        with pytest.raises(raymap.InputError, match=text):
            surface.signed_distance(given)


def test_meshio(ball):
    meshio = load("meshio")
    faces = ball.faces.astype(int)
    check(ball, meshio.Mesh(ball.vertices, [("triangle", faces[:500]), ("vertex", [[0]]), ("triangle", faces[500:])]))
    corners = np.array(list(np.ndindex(2, 2, 2)), float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cube = meshio.Mesh(corners, [("quad", quads)])
    found = raymap.info(cube)
    assert found["triangles"] == 12 and found["signed_volume"] == pytest.approx(1)
    np.testing.assert_array_equal(raymap._inputs.to_mesh(cube).faces[:2], [(0, 1, 3), (0, 3, 2)])
    with pytest.raises(raymap.UsageError, match="cells of the type 'tetra' are not faces"):
        raymap.info(meshio.Mesh(corners, [("tetra", [[0, 1, 2, 4]])]))
    with pytest.raises(raymap.InputError, match="the mesh has no faces"):
        raymap.info(meshio.Mesh(corners, [("vertex", [[0]])]))


def test_pyvista(ball):
    pyvista = load("pyvista")
    check(ball, pyvista.PolyData.from_regular_faces(ball.vertices, ball.faces))
    cube = pyvista.Cube()
    assert not cube.is_all_triangles
    found = raymap.info(cube)
    assert found["triangles"] == 12 and abs(found["signed_volume"]) == pytest.approx(1)
    with pytest.raises(raymap.UsageError, match=r"no surface but ImageData; give mesh.extract_surface\(\)"):
        raymap.info(pyvista.ImageData(dimensions=(3, 3, 3)))


# A U of area 7, extruded to a height of 1: two polygons and the walls of each edge.
U = [(0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3)]
U_POINTS = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in U])
U_ENDS = [[7, 6, 5, 4, 3, 2, 1, 0], [9, 10, 11, 12, 13, 14, 15, 8]]
U_WALLS = [[i, (i + 1) % 8, 8 + (i + 1) % 8, 8 + i] for i in range(8)]


def test_concave_polygons():
    meshio, pyvista = load("meshio"), load("pyvista")
    padded = np.concatenate([[len(face), *face] for face in U_ENDS + U_WALLS])
    for mesh in (
        meshio.Mesh(U_POINTS, [("polygon", U_ENDS), ("line", [[0, 1]]), ("quad", U_WALLS)]),
        pyvista.PolyData(U_POINTS, padded),
    ):
        found = raymap.info(mesh)
        assert found["triangles"] == 28 and found["watertight"] and found["degenerate_faces"] == 0
        assert found["area"] == pytest.approx(2 * 7 + 16) and found["signed_volume"] == pytest.approx(7)
    with pytest.raises(raymap.InputError, match="a vertex number out of range: 0 to 16"):
        raymap.info(meshio.Mesh(U_POINTS, [("quad", [[0, 1, 2, 16]])]))
    with pytest.warns(raymap.RaymapWarning, match="lie on a line: 1; their triangles may overlap"):
        raymap.info(meshio.Mesh(U_POINTS, [("quad", [[0, 2, 1, 7]]), ("triangle", [[0, 1, 8]])]))


def test_strips_of_pyvista():
    pyvista = load("pyvista")
    strips = pyvista.PolyData(U_POINTS[:4], strips=[4, 0, 1, 3, 2])
    np.testing.assert_array_equal(raymap._inputs.to_mesh(strips).faces, [(0, 1, 3), (2, 3, 1)])
    both = pyvista.PolyData(U_POINTS[:4], [3, 0, 1, 2], strips=[4, 0, 1, 3, 2])
    np.testing.assert_array_equal(raymap._inputs.to_mesh(both).faces, [(0, 1, 2), (0, 1, 3), (2, 3, 1)])


def test_open3d(ball):
    open3d = load("open3d")
    vertices = open3d.utility.Vector3dVector(ball.vertices.copy())
    triangles = open3d.utility.Vector3iVector(ball.faces.astype(np.int32))
    legacy = open3d.geometry.TriangleMesh(vertices, triangles)
    check(ball, legacy)
    check(ball, open3d.t.geometry.TriangleMesh.from_legacy(legacy), atol=1e-6)
    field = raymap.generate(legacy, resolution=12, device="cpu")
    points = open3d.core.Tensor(np.zeros((4, 3), np.float32))
    assert field.sample(points).shape == (4,)


def test_jax(ball):
    jax = load("jax")
    vertices, faces = jax.numpy.asarray(ball.vertices), jax.numpy.asarray(ball.faces)
    field = raymap.generate(vertices, faces, resolution=12, device="cpu")
    expected = raymap.generate(np.asarray(vertices), ball.faces, resolution=12, device="cpu")
    np.testing.assert_array_equal(field.distance, expected.distance)
    points = jax.numpy.linspace(-1, 1, 30).reshape(2, 5, 3)
    for call, shape in ((field.sample, (2, 5)), (field.gradient, (2, 5, 3))):
        answer = call(points)
        assert isinstance(answer, jax.Array) and answer.shape == shape and answer.dtype == np.float32
        assert answer.device == points.device
        np.testing.assert_array_equal(np.asarray(answer), call(np.asarray(points)))
    check_surface(ball, points, np.asarray, jax.Array)
    made = raymap.Field(jax.numpy.asarray(field.distance), field.origin, field.spacing)
    np.testing.assert_array_equal(made.distance, field.distance)


def check_surface(ball: raymap.Mesh, points, to_numpy, kind: type) -> None:
    """Checks that a surface answers in the framework of the points."""
    surface = raymap.Surface(ball)
    found, expected = (surface.query(p, raymap.Query._fields) for p in (points, to_numpy(points)))
    for array, other in zip(found, expected, strict=True):
        assert isinstance(array, kind) and array.device == points.device
        np.testing.assert_array_equal(to_numpy(array), other)
    assert found.distance.dtype == points.dtype
    inside = surface.contains(points)
    assert isinstance(inside, kind)
    np.testing.assert_array_equal(to_numpy(inside), expected.distance < 0)
    assert isinstance(surface.contains(points[0, 0]), kind)


def test_torch(ball):
    torch = load("torch")
    vertices, faces = torch.from_numpy(ball.vertices.copy()), torch.from_numpy(ball.faces.astype(np.int64))
    check(ball, torch.nn.Parameter(vertices), faces)
    field = raymap.generate(ball, resolution=12, device="cpu")
    for dtype in (torch.float32, torch.float64):
        points = torch.linspace(-1, 1, 30, dtype=dtype).reshape(2, 5, 3)
        check_surface(ball, points, torch.Tensor.numpy, torch.Tensor)
        answer = field.sample(points)
        assert isinstance(answer, torch.Tensor) and answer.shape == (2, 5) and answer.dtype == torch.float32
    found = raymap.Surface(ball).closest(points)
    corners = vertices[faces[found.triangle]]  # PyTorch indexes with int64.
    assert torch.allclose((found.barycentric[..., None] * corners).sum(-2), found.point, atol=1e-5)


class HostTensor:
    """Like PyTorch's on the CPU."""

    def __init__(self, array: np.ndarray) -> None:
        self.array = array

    def numpy(self) -> np.ndarray:
        return self.array


class Tensor:
    """An array on a device without an interface of NumPy's, like PyTorch's on a GPU that is part of a graph."""

    def __init__(self, array: np.ndarray, has_graph: bool = True) -> None:
        self.array, self.has_graph, self.shape = array, has_graph, array.shape

    def __dlpack__(self, **_) -> object:
        raise BufferError("on the device")

    def detach(self) -> Tensor:
        return Tensor(self.array, has_graph=False)

    def cpu(self) -> HostTensor:
        assert not self.has_graph
        return HostTensor(self.array)


class CuPyArray:
    """An array on a device, like CuPy's."""

    device = "gpu"

    def __init__(self, array: np.ndarray) -> None:
        self.array, self.shape = array, array.shape

    def __dlpack__(self, **_) -> object:
        raise BufferError("on the device")

    def get(self) -> np.ndarray:
        return self.array

    def __array_namespace__(self):
        class Namespace:
            @staticmethod
            def asarray(array, device):
                assert device == "gpu"
                return CuPyArray(array)

        return Namespace


def test_arrays_on_a_gpu_come_through_the_host(ball):
    expected = raymap.generate(ball, resolution=12, device="cpu")
    for kind in (Tensor, CuPyArray, Exporter):
        vertices, faces = kind(ball.vertices.copy()), kind(ball.faces.copy())
        field = raymap.generate(vertices, faces, resolution=12, device="cpu")
        np.testing.assert_array_equal(field.distance, expected.distance)
    answer = expected.sample(CuPyArray(np.zeros((2, 4, 3))))
    assert isinstance(answer, CuPyArray) and answer.shape == (2, 4)


def test_fields_are_exported_without_a_copy(ball):
    field = raymap.generate(ball, resolution=12, device="cpu")
    assert np.shares_memory(np.from_dlpack(field.distance), field.distance)


def test_numpy_stays_numpy_if_torch_is_loaded(ball, monkeypatch):
    class Torch:
        class Tensor:
            pass

    monkeypatch.setitem(sys.modules, "torch", Torch)
    field = raymap.generate(ball, resolution=12, device="cpu")
    assert type(field.sample(np.zeros((2, 3)))) is np.ndarray
    assert type(field.sample([(0.0, 0.0, 0.0)])) is np.ndarray
