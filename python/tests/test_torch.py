"""Distances that PyTorch differentiates."""

from __future__ import annotations

import math
import subprocess
import sys
from collections.abc import Callable

import numpy as np
import pytest
import raymap
from helpers import load


@pytest.fixture(scope="module")
def surface(ball) -> raymap.Surface:
    return raymap.Surface(ball)


def points_away_from_edges(torch, ball: raymap.Mesh, surface: raymap.Surface):
    """Returns points whose closest point is well within a triangle, so that the gradient is that of a plane."""
    candidates = np.random.default_rng(3).uniform(-1.5, 1.5, (4000, 3))
    found = surface.closest(candidates)
    far = (np.linalg.norm(candidates, axis=1) > 0.4) & (np.abs(found.distance) > 0.05)
    chosen = candidates[far & (found.barycentric.min(axis=1) > 0.2)][:12]
    assert (surface.signed_distance(chosen) < 0).any() and (surface.signed_distance(chosen) > 0).any()
    return torch.tensor(chosen.reshape(3, 4, 3), requires_grad=True)


def test_gradcheck(ball, surface):
    torch = load("torch")
    from raymap.torch import signed_distance

    points = points_away_from_edges(torch, ball, surface)
    # Positions are in single precision inside of the library, so differences need long steps.
    assert torch.autograd.gradcheck(lambda p: signed_distance(surface, p), points, eps=1e-3, atol=1e-3)


def test_values_and_gradients(surface):
    torch = load("torch")
    from raymap.torch import signed_distance

    for dtype in (torch.float32, torch.float64):
        points = torch.tensor([[(0, 0, 1.5), (0, 0, 0.9)]], dtype=dtype, requires_grad=True)
        distance = signed_distance(surface, points, threads=1)
        assert distance.dtype == dtype and distance.shape == (1, 2)
        np.testing.assert_array_equal(distance.detach().numpy(), surface.signed_distance(points.detach().numpy()))
        (distance * torch.tensor([2.0, 3.0], dtype=dtype)).sum().backward()
        assert points.grad.dtype == dtype
        np.testing.assert_allclose(points.grad[0, 0], (0, 0, 2), atol=1e-5)
        np.testing.assert_allclose(points.grad[0, 1], (0, 0, 3), atol=0.5)
        np.testing.assert_allclose(torch.linalg.norm(points.grad[0, 1]), 3, rtol=1e-5)
        assert points.grad[0, 1, 2] > 2.9
    assert not signed_distance(surface, points.detach()).requires_grad


def test_points_on_the_surface_have_no_gradient():
    torch = load("torch")
    from raymap.torch import signed_distance

    points = torch.tensor([0.25, 0.25, 0.0], requires_grad=True)
    signed_distance(raymap.Surface("tetrahedron.ply"), points).backward()
    assert (points.grad == 0).all()


def test_points_find_the_surface(surface):
    """Gradient descent with the squared distance."""
    torch = load("torch")
    from raymap.torch import signed_distance

    points = torch.tensor(np.random.default_rng(0).uniform(-1, 1, (50, 3)), requires_grad=True)
    optimizer = torch.optim.SGD([points], lr=0.25)
    for _ in range(40):
        optimizer.zero_grad()
        signed_distance(surface, points).square().sum().backward()
        optimizer.step()
    assert signed_distance(surface, points).abs().max() < 1e-4


def test_second_derivatives_are_refused(surface):
    torch = load("torch")
    from raymap.torch import signed_distance

    points = torch.tensor([0.0, 0.0, 1.5], requires_grad=True)
    (gradient,) = torch.autograd.grad(signed_distance(surface, points).square(), points, create_graph=True)
    with pytest.raises(RuntimeError, match="once_differentiable"):
        gradient.sum().backward()


def test_arguments_that_make_no_sense(surface):
    torch = load("torch")
    from raymap.torch import signed_distance

    with pytest.raises(TypeError, match="points must be a tensor, not ndarray"):
        signed_distance(surface, np.zeros((2, 3)))
    with pytest.raises(raymap.InputError, match="points must be"):
        signed_distance(surface, torch.zeros(2, 2))


def moved_distances(torch, ball: raymap.Mesh, points) -> Callable:
    """Returns a function of the vertices: distances to the mesh that they make."""
    from raymap.torch import signed_distance

    def distances(vertices):
        surface = raymap.Surface(vertices.detach().numpy(), ball.faces, orientation="keep")
        return signed_distance(surface, points.detach(), vertices=vertices)

    return distances


def test_gradients_of_vertices(ball, surface):
    torch = load("torch")
    points = points_away_from_edges(torch, ball, surface)
    vertices = torch.tensor(ball.vertices, dtype=torch.float64, requires_grad=True)
    distances = moved_distances(torch, ball, points)
    upstream = torch.tensor(np.random.default_rng(1).uniform(-1, 1, (3, 4)))
    (gradient,) = torch.autograd.grad((distances(vertices) * upstream).sum(), vertices)
    touched = np.flatnonzero(gradient.abs().sum(dim=1))
    assert 12 <= len(touched) <= 36
    step = 1e-3
    for vertex in touched[:6]:
        for axis in range(3):
            change = torch.zeros_like(vertices)
            change[vertex, axis] = step
            difference = (distances(vertices + change) - distances(vertices - change)) / (2 * step)
            assert (difference * upstream).sum().item() == pytest.approx(float(gradient[vertex, axis]), abs=1e-3)
    # A mesh that moves as a whole takes its distances along.
    from raymap.torch import signed_distance

    signed_distance(surface, points, vertices=vertices).sum().backward()
    np.testing.assert_allclose(vertices.grad.sum(dim=0), -points.grad.sum(dim=(0, 1)), atol=1e-5)


@pytest.mark.parametrize(
    ("point", "held"), [((0.2, 0.3, -0.5), 3), ((0.4, -0.5, -0.5), 2), ((-0.5, -0.5, -0.5), 1)], ids=["face", "edge", "vertex"]
)
def test_closest_points(point, held):
    torch = load("torch")
    from raymap.torch import closest_point

    surface = raymap.Surface("tetrahedron.ply")
    mesh = surface.mesh
    points = torch.tensor([point], dtype=torch.float64, requires_grad=True)
    vertices = torch.tensor(mesh.vertices, dtype=torch.float64, requires_grad=True)
    np.testing.assert_allclose(closest_point(surface, points).detach(), surface.closest(np.array([point])).point, atol=1e-12)
    assert int((surface.closest(np.array(point)).barycentric > 0).sum()) == held

    def closest(points, vertices):
        return closest_point(raymap.Surface(vertices.detach().numpy(), mesh.faces), points, vertices=vertices)

    assert torch.autograd.gradcheck(closest, (points, vertices), eps=1e-3, atol=2e-3)


def test_functional_transforms(surface):
    torch = load("torch")
    from raymap.torch import closest_point, signed_distance

    points = torch.tensor(np.random.default_rng(2).uniform(-1, 1, (5, 3)))
    single = torch.func.grad(lambda p: signed_distance(surface, p))
    expected = torch.autograd.functional.jacobian(lambda p: signed_distance(surface, p).sum(), points)
    np.testing.assert_array_equal(torch.stack([single(p) for p in points]), expected)
    np.testing.assert_array_equal(torch.vmap(single)(points), expected)
    np.testing.assert_array_equal(torch.vmap(lambda p: closest_point(surface, p))(points), closest_point(surface, points))
    vertices = torch.tensor(surface.mesh.vertices, dtype=torch.float64)
    both = torch.func.grad(lambda p, v: signed_distance(surface, p, vertices=v), argnums=1)
    np.testing.assert_allclose(torch.vmap(both, (0, None))(points, vertices).sum(dim=1), -expected, atol=1e-12)
    with pytest.raises(raymap.UsageError, match="vertices must be the same for all points"):
        torch.vmap(lambda v: signed_distance(surface, points, vertices=v))(vertices[None])


def test_points_that_are_not_finite_leave_the_others_alone(surface):
    torch = load("torch")
    from raymap.torch import closest_point, signed_distance

    points = torch.tensor([[0, 0, 1.5], [np.nan, 0, 0]], dtype=torch.float64, requires_grad=True)
    for function in (lambda p, v: signed_distance(surface, p, vertices=v), lambda p, v: closest_point(surface, p, vertices=v)):
        vertices = torch.tensor(surface.mesh.vertices, dtype=torch.float64, requires_grad=True)
        result = function(points, vertices)
        assert result[0].isfinite().all() and result[1].isnan().all()
        result.sum().backward()
        assert vertices.grad.isfinite().all() and vertices.grad.abs().sum() > 0


def test_vertices_of_another_mesh(surface):
    torch = load("torch")
    from raymap.torch import signed_distance

    points, vertices = torch.zeros(1, 3), torch.tensor(surface.mesh.vertices)
    with pytest.raises(raymap.InputError, match=r"vertices must be \(\d+, 3\), those of the surface, not \(2, 3\)"):
        signed_distance(surface, points, vertices=vertices[:2])
    vertices[7, 1] += 1e-5
    with pytest.raises(raymap.InputError, match="vertices: number 7 is not that of the surface; prepare a raymap.Surface"):
        signed_distance(surface, points, vertices=vertices)
    with pytest.raises(TypeError, match="vertices must be a tensor, not ndarray"):
        signed_distance(surface, points, vertices=np.zeros((1, 3)))


AnyField = raymap.Field | raymap.SparseField


def make_field(mesh: raymap.Mesh, **options) -> tuple[raymap.Surface, AnyField]:
    """Returns a surface and its field, of samples none of which lies on the tetrahedron or between its faces."""
    surface = raymap.Surface(mesh)
    return surface, surface.generate(shape=(7, 6, 5), origin=(-0.33, -0.42, -0.57), voxel_size=0.26, **options)


# No sample of `make_field` is closer than 0.015 to a distance at which these clamp.
DENSE = [{}, {"truncation": 0.3}]
BANDS = [{"sparse": True, "band": (inside, 0.22 / 0.26)} for inside in (0.12 / 0.26, math.inf)]


def within(field: AnyField, count: int) -> np.ndarray:
    """Returns points within the field's box, and away from the sides of its cells."""
    random = np.random.default_rng(4)
    cells = random.integers(0, np.array(field.shape) - 1, (count, 3))
    return field.origin + field.spacing * (cells + random.uniform(0.1, 0.9, (count, 3)))


@pytest.mark.parametrize("options", [{}, *BANDS])
def test_samples_of_fields(options):
    torch = load("torch")
    from raymap.torch import sample

    surface, field = make_field(raymap.load_mesh("tetrahedron.ply"), **options)
    places = np.concatenate([within(field, 20), [field.origin, field.origin + field.spacing * np.array((6, 5, 4))]])
    for dtype in (torch.float32, torch.float64):
        points = torch.tensor(places.reshape(2, 11, 3), dtype=dtype)
        expected = field.sample(points.numpy(), outside="nan")
        vertices = torch.tensor(surface.mesh.vertices, dtype=torch.float64)
        for found in (sample(field, points), sample(field, points, surface=surface, vertices=vertices, threads=1)):
            assert found.dtype == dtype and found.shape == (2, 11)
            np.testing.assert_allclose(found, expected, atol=1e-6)
    points = torch.tensor(places[:6], requires_grad=True)
    assert torch.autograd.gradcheck(lambda p: sample(field, p), points)
    assert torch.autograd.gradgradcheck(lambda p: sample(field, p), points)
    single = torch.func.grad(lambda p: sample(field, p))
    (gradient,) = torch.autograd.grad(sample(field, points).sum(), points)
    np.testing.assert_allclose(torch.vmap(single)(points.detach()), gradient, atol=1e-12)
    flat = raymap.Field(np.array([[[1.0], [3.0]]]), spacing=2)  # One sample along x and z.
    np.testing.assert_array_equal(sample(flat, torch.tensor([(0.0, 1.5, 0.0), (0.1, 1.5, 0.0)])), [2.5, np.nan])


def test_samples_of_large_bands(surface):
    """With many leaves and tiles, and with more samples than an int64 counts."""
    torch = load("torch")
    from raymap.torch import sample

    # The last samples lie where rounding moves their positions out of the box.
    band = surface.generate(shape=(50, 51, 49), origin=(-1.3, -1.2, -1.1), voxel_size=0.05, sparse=True, band=(2, 3.5))
    assert len(band.origins) > 50 and len(band.tile_origins) > 0
    corners = np.stack(np.meshgrid(*((0, n - 1) for n in band.shape)), axis=-1).reshape(-1, 3)
    indices = np.concatenate([np.random.default_rng(6).integers(0, band.shape, (3000, 3)), corners])
    dense = band.to_dense()
    at_samples = sample(dense, torch.tensor(dense.origin + dense.spacing * indices))
    np.testing.assert_array_equal(sample(band, torch.tensor(band.origin + band.spacing * indices)), at_samples)
    reached = at_samples[at_samples.isfinite()]
    assert (reached.min(), reached.max()) == (np.float32(-band.inside), np.float32(band.outside))
    points = torch.tensor(within(band, 3000))
    np.testing.assert_allclose(sample(band, points), band.sample(points.numpy()), rtol=0, atol=1e-6)
    np.testing.assert_array_equal(sample(band, points), sample(dense, points))

    huge = surface.generate(shape=(2**24,) * 3, origin=(-0.2, -0.3, -(2.0**20)), voxel_size=2.0**-3, sparse=True)
    points = torch.tensor([(0.9, 0.1, 0.2), (0.9 + 2**16 * 2.0**-3, 0.1, 0.2), (2.0**20, 2.0**20, 2.0**19), (0.0, 0.0, 0.1)])
    np.testing.assert_allclose(sample(huge, points), huge.sample(points.numpy()), rtol=0, atol=1e-6)


@pytest.mark.parametrize("options", [*DENSE, *BANDS])
def test_samples_of_fields_change_with_vertices(options):
    torch = load("torch")
    from raymap.torch import sample

    mesh = raymap.load_mesh("tetrahedron.ply")
    surface, field = make_field(mesh, **options)
    points = torch.tensor(within(field, 8))

    def samples(vertices):
        moved = raymap.Mesh(vertices.detach().numpy(), mesh.faces)
        surface, field = make_field(moved, **options)
        return sample(field, points, surface=surface, vertices=vertices)

    vertices = torch.tensor(mesh.vertices, dtype=torch.float64, requires_grad=True)
    # Positions are in single precision inside of the library, so differences need long steps.
    assert torch.autograd.gradcheck(samples, vertices, eps=1e-3, atol=2e-3)
    alone = torch.func.grad(lambda p, v: sample(field, p, surface=surface, vertices=v), argnums=1)
    samples(vertices).sum().backward()
    together = torch.vmap(alone, (0, None))(points, vertices.detach()).sum(dim=0)
    np.testing.assert_allclose(together, vertices.grad, atol=1e-12)
    # The slope of a sample changes with the vertices, too.
    points.requires_grad_()
    (slope,) = torch.autograd.grad(sample(field, points, surface=surface, vertices=vertices).sum(), points, create_graph=True)
    (mixed,) = torch.autograd.grad(slope[:, 0].sum(), vertices)
    step = torch.tensor((1e-4, 0, 0))
    before, after = (torch.func.grad(lambda v, p=points + s: sample(field, p, surface=surface, vertices=v).sum())(vertices)
                     for s in (-step, step))  # fmt: skip
    np.testing.assert_allclose(mixed, ((after - before) / 2e-4).detach(), atol=1e-6)


def test_clamped_samples_do_not_change_with_vertices():
    """Inside, outside and where both clamp, at widths that differ."""
    torch = load("torch")
    from raymap.torch import sample

    mesh = raymap.load_mesh("tetrahedron.ply")
    for inside, outside in ((0.12, 0.22), (math.inf, 0.22)):
        surface, field = make_field(mesh, sparse=True, band=(inside / 0.26, outside / 0.26))
        indices = np.stack(np.meshgrid(*map(np.arange, field.shape), indexing="ij"), axis=-1).reshape(-1, 3)
        places = field.origin + field.spacing * (indices + np.where(indices == np.array(field.shape) - 1, -1e-9, 1e-9))
        exact = surface.signed_distance(places)
        is_clamped = (exact < -inside) | (exact > outside)
        assert ((exact < -0.12) & is_clamped).any() == (inside < 1)
        vertices = torch.tensor(surface.mesh.vertices, dtype=torch.float64)
        alone = torch.func.grad(lambda p, v: sample(field, p, surface=surface, vertices=v), argnums=1)
        change = torch.vmap(alone, (0, None))(torch.tensor(places), vertices).abs().sum(dim=(1, 2))
        np.testing.assert_array_equal(change.numpy() > 1e-6, ~is_clamped)


@pytest.mark.parametrize("options", [{}, {"sparse": True, "band": (2, 9)}])
def test_samples_outside_of_a_field_leave_the_others_alone(options):
    torch = load("torch")
    from raymap.torch import sample

    surface, field = make_field(raymap.load_mesh("tetrahedron.ply"), **options)
    points = torch.tensor([within(field, 1)[0].tolist(), (0, 0, 9), (np.nan, 0, 0), (0, np.inf, 0)], requires_grad=True)
    vertices = torch.tensor(surface.mesh.vertices, dtype=torch.float64, requires_grad=True)
    found = sample(field, points, surface=surface, vertices=vertices)
    assert found.isfinite().tolist() == [True, False, False, False] and found[1:].isnan().all()
    found.sum().backward()
    assert (points.grad[0] != 0).any() and (points.grad[1:] == 0).all()
    assert vertices.grad.isfinite().all() and vertices.grad.abs().sum() > 0.5
    assert sample(field, torch.zeros(0, 3), surface=surface, vertices=vertices).shape == (0,)


def test_samples_of_arguments_that_make_no_sense():
    torch = load("torch")
    from raymap.torch import sample

    surface, field = make_field(raymap.load_mesh("tetrahedron.ply"))
    points, vertices = torch.zeros(1, 3), torch.tensor(surface.mesh.vertices)
    with pytest.raises(TypeError, match=r"field must be a raymap.Field or a raymap.SparseField, not a Surface"):
        sample(surface, points)
    with pytest.raises(raymap.UsageError, match="surface and vertices belong together"):
        sample(field, points, vertices=vertices)
    with pytest.raises(TypeError, match="points must be a tensor, not list"):
        sample(field, [0, 0, 0])
    with pytest.raises(raymap.InputError, match="points must be"):
        sample(field, torch.zeros(2, 2))
    field.distance[1, 2, 3] *= 1.001
    at = torch.tensor(field.origin + field.spacing * np.array((1.5, 2.5, 2.5)))
    with pytest.raises(raymap.InputError, match=r"field: sample \(1, 2, 3\) is .* make the field by the generate of this"):
        sample(field, at, surface=surface, vertices=vertices)
    for options in BANDS:
        _, band = make_field(raymap.Mesh(surface.mesh.vertices * 1.01, surface.mesh.faces), **options)
        with pytest.raises(raymap.InputError, match=r"field: sample \(\d, \d, \d\) is .* make the field by the generate of"):
            sample(band, torch.tensor(within(band, 8)), surface=surface, vertices=vertices)


def run(program: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)


def test_without_torch():
    for use in ("import raymap.torch", "import raymap; raymap.torch.signed_distance"):
        ran = run(f"import sys; sys.modules['torch'] = None; {use}")
        assert "ImportError: raymap.torch needs PyTorch; install it with: pip install torch" in ran.stderr
    ran = run("import raymap; raymap.toch")
    assert "AttributeError: module 'raymap' has no attribute 'toch'" in ran.stderr


def test_it_is_imported_when_it_is_used():
    """With a module in the place of PyTorch, so that the test needs none."""
    program = """
import sys, types
torch = types.ModuleType("torch")
torch.autograd = types.SimpleNamespace(
    Function=object, function=types.SimpleNamespace(once_differentiable=lambda function: function))
torch.Tensor = type("Tensor", (), {})
torch.utils = types.SimpleNamespace(data=types.SimpleNamespace(Dataset=object, IterableDataset=object))
sys.modules["torch"] = torch
import raymap
assert "raymap.torch" not in sys.modules
raymap.torch.signed_distance(None, 3)
"""
    error = "TypeError: points must be a tensor, not int; NumPy: surface.signed_distance(points)\n"
    assert run(program).stderr.endswith(error)
