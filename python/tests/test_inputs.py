"""Meshes of other packages and arrays of other frameworks."""

from __future__ import annotations

import sys

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
