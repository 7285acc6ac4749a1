"""Distances that PyTorch differentiates."""

from __future__ import annotations

import math
import re
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


@pytest.mark.parametrize(
    ("point", "expected"),
    [
        ((0.2, 0.3, -0.5), np.zeros((3, 3))),  # A face
        ((0.4, -0.3, -0.4), np.outer(n := np.array((0, 0.8, -0.6)), n) / 0.5),  # The edge along x
        ((-0.2, -0.2, -0.1), (np.eye(3) - np.outer(n := np.array((-2, -2, -1)) / 3, n)) / 0.3),  # The corner at 0
        ((0.2, 0.2, 0.1), np.zeros((3, 3))),  # Inside
    ],
)
def test_second_derivatives(point, expected):
    """Those of the distance to what holds the closest point, by all modes."""
    torch = load("torch")
    from raymap.torch import signed_distance

    surface = raymap.Surface("tetrahedron.ply")
    for dtype in (torch.float64, torch.float32):
        points = torch.tensor(point, dtype=dtype, requires_grad=True)

        def distance(p):
            return signed_distance(surface, p)

        (gradient,) = torch.autograd.grad(distance(points), points, create_graph=True)
        rows = torch.stack([torch.autograd.grad(g, points, retain_graph=True)[0] for g in gradient])
        for found in (rows, torch.func.hessian(distance)(points.detach()), torch.func.jacrev(torch.func.jacrev(distance))(points)):
            assert found.dtype == dtype
            np.testing.assert_allclose(found.detach(), expected, atol=1e-5)


def test_terms_of_gradients_have_gradients(surface):
    """An eikonal term beside others: its share of the gradient is that of its differences."""
    torch = load("torch")
    from raymap.torch import signed_distance

    mesh, along = raymap.load_mesh("tetrahedron.ply"), torch.tensor((0.3, 0.5, -0.2), dtype=torch.float64)
    points = torch.tensor([(-0.2, -0.2, -0.1), (0.4, -0.5, -0.5)], dtype=torch.float64)

    def term(points, vertices):
        surface = raymap.Surface(vertices.detach().numpy(), mesh.faces, orientation="keep")
        distance = signed_distance(surface, points, vertices=vertices)
        (gradient,) = torch.autograd.grad(distance.sum(), points, create_graph=True)
        return (gradient @ along).square().sum()

    points.requires_grad_()
    vertices = torch.tensor(mesh.vertices, dtype=torch.float64, requires_grad=True)
    (term(points, vertices) + vertices.sum()).backward()
    step, shift = 1e-3, torch.tensor(np.random.default_rng(5).normal(size=points.shape))
    for given, found in ((points, points.grad), (vertices, vertices.grad - 1)):
        assert found.abs().sum() > 0.1
        change = shift if given is points else torch.tensor(np.random.default_rng(6).normal(size=vertices.shape))
        near = [term(*(x.detach().add(sign * step * change if x is given else 0).requires_grad_() for x in (points, vertices)))
                for sign in (1, -1)]  # fmt: skip
        assert ((near[0] - near[1]) / (2 * step)).item() == pytest.approx((found * change).sum().item(), rel=2e-3)


def test_first_derivatives_need_no_projection(surface, monkeypatch):
    """Only derivatives of derivatives and forward mode are those of the projection."""
    torch = load("torch")
    from raymap.torch import signed_distance

    calls = []
    for name in ("follow", "hold", "find_closest"):
        made = getattr(raymap.torch, name)
        monkeypatch.setattr(raymap.torch, name, lambda *a, n=name, f=made: (calls.append((n, *a[4:])), f(*a))[1])
    counted = lambda: [name for name, *_ in calls]  # noqa: E731
    points = torch.tensor([(0.0, 0.1, 1.5), (0.2, 0.1, -0.3)], requires_grad=True)
    vertices = torch.tensor(surface.mesh.vertices, requires_grad=True)
    with torch.no_grad():
        plain = signed_distance(surface, points, vertices=vertices)
    assert calls == [("find_closest", ("distance",))]
    constant = signed_distance(surface, points.detach(), vertices=vertices.detach())
    assert calls == [("find_closest", ("distance",))] * 2 and not constant.requires_grad
    distance = signed_distance(surface, points, vertices=vertices)
    first = torch.autograd.grad(distance.sum(), (points, vertices), retain_graph=True)
    assert calls[2:] == [("find_closest",)] and not first[0].requires_grad
    np.testing.assert_array_equal(distance.detach(), plain)
    again = torch.autograd.grad(distance.sum(), (points, vertices), create_graph=True)
    assert counted()[3:] == ["hold", "follow"] and again[0].requires_grad and again[1].requires_grad
    for one, other in zip(first, again, strict=True):
        np.testing.assert_allclose(one, other.detach(), atol=1e-6)
    (alone,) = torch.autograd.grad(signed_distance(surface, points.detach(), vertices=vertices).sum(), vertices)
    np.testing.assert_array_equal(alone, first[1])
    with torch.autograd.forward_ad.dual_level():
        for inputs in ({"points": points}, {"points": points, "vertices": vertices}):
            calls.clear()
            dual = {**inputs, (name := list(inputs)[-1]): torch.autograd.forward_ad.make_dual(inputs[name], torch.ones_like(inputs[name]))}
            tangent = torch.autograd.forward_ad.unpack_dual(signed_distance(surface, **dual)).tangent
            assert counted() == ["follow"] and tangent.abs().sum() > 0.1


def test_gradients_within_larger_graphs(surface):
    torch = load("torch")
    from raymap.torch import signed_distance

    points = torch.tensor([(0.0, 0.1, 1.5), (0.2, 0.1, -0.3)], dtype=torch.float64, requires_grad=True)
    kept = torch.tensor(surface.mesh.vertices, dtype=torch.float64)
    gradient = torch.autograd.grad(signed_distance(surface, points).sum(), points)[0]
    # A distance that is changed in place leaves its derivatives alone.
    torch.testing.assert_close(torch.autograd.grad(signed_distance(surface, points).neg_().sum(), points)[0], -gradient)
    # Transformations of what surrounds it do, too.
    ones = torch.ones(3, dtype=torch.float64)
    scaled = lambda x: (signed_distance(surface, points) * x.sum()).sum()  # noqa: E731
    assert torch.func.grad(scaled)(ones).tolist() == [scaled(ones / 3).item()] * 3
    torch.testing.assert_close(torch.autograd.grad(torch.vmap(scaled)(ones[:2]).sum(), points)[0], 2 * gradient)
    # So does a step that moves the points afterwards.
    moved = points.detach().clone().requires_grad_()
    distance = signed_distance(surface, moved)
    with torch.no_grad():
        moved.add_(1.0)
    np.testing.assert_array_equal(torch.autograd.grad(distance.sum(), moved)[0], gradient)
    for create_graph in (False, True):  # Vertices that move along with the points
        vertices = kept + (points - points.detach())[1]
        (found,) = torch.autograd.grad(signed_distance(surface, points, vertices=vertices)[1], points, create_graph=create_graph)
        assert found.abs().max() < 1e-6
        rows = torch.autograd.grad(
            signed_distance(surface, points, vertices=kept.requires_grad_()), (points, kept), torch.eye(2, dtype=torch.float64),
            is_grads_batched=True, create_graph=create_graph,
        )  # fmt: skip
        torch.testing.assert_close(rows[0].sum(0).detach(), gradient)
        torch.testing.assert_close(rows[1].sum(1).detach(), -gradient, atol=1e-6, rtol=0)


def test_forward_mode(ball, surface):
    torch = load("torch")
    from raymap.torch import closest_point, sample, signed_distance

    points, change = points_away_from_edges(torch, ball, surface).detach(), torch.ones(3, 4, 3, dtype=torch.float64)
    field = surface.generate(resolution=8)
    for function in (signed_distance, closest_point, sample):
        of = field if function is sample else surface
        inputs = points * 0.5 if function is sample else points
        value, tangent = torch.func.jvp(lambda p, f=function, o=of: f(o, p), (inputs,), (change,))
        jacobian = torch.autograd.functional.jacobian(lambda p, f=function, o=of: f(o, p), inputs)
        np.testing.assert_array_equal(value, function(of, inputs))
        assert tangent.abs().sum() > 0.1
        np.testing.assert_allclose(tangent, (jacobian * change).sum(dim=(-3, -2, -1)), atol=1e-12)
    vertices = torch.tensor(surface.mesh.vertices, dtype=torch.float64)
    moved = torch.func.jvp(lambda v: signed_distance(surface, points, vertices=v), (vertices,), (torch.ones_like(vertices),))[1]
    np.testing.assert_allclose(moved, -torch.func.jvp(lambda p: signed_distance(surface, p), (points,), (change,))[1], atol=1e-6)


@pytest.mark.parametrize("name", ["float16", "bfloat16", "float32", "float64"])
def test_results_have_the_type_of_the_points(surface, name):
    torch = load("torch")
    from raymap.torch import closest_point, sample, signed_distance

    dtype, field = getattr(torch, name), surface.generate(resolution=8)
    points = torch.tensor([(0.0, 0.0, 1.5), (0.0, 0.0, 0.875)], dtype=dtype, requires_grad=True)
    exact = points.detach().double()
    for function, of in ((signed_distance, surface), (closest_point, surface), (sample, field)):
        with torch.autocast("cpu", dtype=torch.bfloat16):
            found = function(of, points)
        assert found.dtype == dtype
        np.testing.assert_allclose(found.detach().double(), function(of, exact), rtol=2 * torch.finfo(dtype).eps, atol=1e-6)
    (gradient,) = torch.autograd.grad(signed_distance(surface, points)[0], points)
    assert gradient.dtype == dtype and gradient[0].tolist() == pytest.approx((0, 0, 1), abs=1e-4)
    with torch.no_grad():
        scene = raymap.Scene({"ball": surface})
        for found in (
            surface.signed_distance(points), surface.signed_distance(points, transform=np.eye(4)),
            surface.closest(points).point, scene.signed_distance(points),
        ):  # fmt: skip
            assert found.dtype == dtype
        single = torch.float32 if name == "float64" else dtype
        for found in (surface.query(points, "winding").winding, field.sample(points), field.gradient(points)):
            assert found.dtype == single
        assert surface.contains(points).dtype == torch.bool and surface.closest(points).triangle.dtype == torch.int64
        np.testing.assert_allclose(surface.signed_distance(points).double(), surface.signed_distance(exact), rtol=1e-2)
    assert signed_distance(surface, torch.tensor((0, 0, 2))).dtype == surface.signed_distance(torch.tensor((0, 0, 2))).dtype


def test_gradients_are_not_dropped(surface):
    """What has no gradient says so, and what follows it."""
    torch = load("torch")
    points, scene, field = torch.tensor([(0.0, 0.0, 1.5)], requires_grad=True), raymap.Scene({"ball": surface}), surface.generate(resolution=4)
    vertices = torch.tensor(surface.mesh.vertices, requires_grad=True)
    pose = torch.eye(4, dtype=torch.float64, requires_grad=True)
    dense = torch.zeros(2, 2, 2, requires_grad=True)
    refused = {
        "points .* use raymap.torch.signed_distance(surface, points), or points.detach()": [
            lambda p: surface.signed_distance(p), lambda p: raymap.signed_distance("ball.ply", p)],
        "points .* use raymap.torch.closest_point(surface, points), or": [lambda p: surface.closest(p)],
        "points .* use raymap.torch.signed_distance(surface, points) or raymap.torch.closest_point(surface, points), or": [
            lambda p: surface.query(p), lambda p: surface.query(p, ("triangle", "direction")), lambda p: surface.query(p, "winding")],
        "points .* use raymap.torch.sample(field, points), or": [lambda p: field.sample(p), lambda p: field.gradient(p)],
        "points .* give points.detach()": [
            lambda p: scene.signed_distance(p), lambda p: scene.query(p, "gradient"),
            lambda p: surface.signed_distance(p, transform=np.eye(4)), lambda p: surface.thickness(p, np.zeros(1, int))],
        "vertices .* use raymap.torch.signed_distance(surface, points, vertices=vertices), or vertices.detach()": [
            lambda p: raymap.Surface(vertices, surface.mesh.faces)],
        "transform .* give transform.detach()": [lambda p: surface.signed_distance(p.detach(), transform=pose)],
        "poses .* give poses.detach()": [lambda p: scene.signed_distance(p.detach(), pose[None, None])],
        "pose .* give pose.detach()": [lambda p: scene.set_pose("ball", pose)],
        "distance .* give distance.detach()": [lambda p: raymap.Field(dense)],
        "winding .* give winding.detach()": [lambda p: raymap.Field(dense.detach(), winding=dense)],
    }  # fmt: skip
    for text, functions in refused.items():
        pattern = re.escape(text).replace(re.escape(" .* "), " require gradients, which this function would drop: ")
        for function in functions:
            with pytest.raises(raymap.UsageError, match=pattern):
                function(points)
            if text.startswith("points"):
                with pytest.raises(raymap.UsageError, match=pattern), torch.autograd.forward_ad.dual_level():
                    function(torch.autograd.forward_ad.make_dual(points.detach(), points.detach()))
            with torch.no_grad():
                function(points)
    with pytest.raises(raymap.UsageError, match="use raymap.torch.signed_distance"):
        torch.func.grad(lambda p: surface.signed_distance(p).sum())(points.detach())
    assert surface.contains(points).tolist() == [False] and surface.query(points, "triangle").triangle.shape == (1,)


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
    np.testing.assert_allclose(torch.stack([single(p) for p in points]), expected, atol=1e-14)
    np.testing.assert_allclose(torch.vmap(single)(points), expected, atol=1e-14)
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
        assert result.ndim == 2 or (points.grad[0].norm() > 0.9 and (points.grad[1] == 0).all())
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




def make_field(mesh: raymap.Mesh, **options) -> tuple[raymap.Surface, raymap.Field]:
    """Returns a surface and its field, of samples none of which lies on the tetrahedron or between its faces."""
    surface = raymap.Surface(mesh)
    return surface, surface.generate(shape=(7, 6, 5), origin=(-0.33, -0.42, -0.57), voxel_size=0.26, **options)


# No sample of `make_field` is closer than 0.015 to a distance at which these clamp.
DENSE = [{}, {"truncation": 0.3}]
BANDS = [{"sparse": True, "band": (inside, 0.22 / 0.26)} for inside in (0.12 / 0.26, math.inf)]


def within(field: raymap.Field, count: int) -> np.ndarray:
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
    with pytest.raises(TypeError, match=r"field must be a raymap.Field, not a Surface"):
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


def test_compiled_training_steps():
    """In a process of its own: the first call of a process is the one that fails."""
    load("torch")
    program = """
import torch, raymap
surface = raymap.Surface("tetrahedron.ply")
field = surface.generate(resolution=8)
net, places = torch.nn.Linear(3, 3), torch.rand(20, 3)
def step(places):
    points = torch.tanh(net(places))
    distance, nearest = raymap.torch.signed_distance(surface, points), raymap.torch.closest_point(surface, points)
    return (distance.square().sum() + nearest.sum() + raymap.torch.sample(field, points / 9 + 0.2).sum()).float()
def gradient(function, **autocast):
    net.zero_grad()
    with torch.autocast("cpu", dtype=torch.bfloat16, **autocast):
        loss = function(places)
    loss.backward()
    return torch.cat([loss.detach().reshape(1), net.weight.grad.reshape(-1)])
for backend in ("eager", "aot_eager"):
    torch._dynamo.reset()
    compiled = torch.compile(step, backend=backend)
    for enabled in (False, True):
        found, expected = (gradient(f, enabled=enabled) for f in (compiled, step))
        assert expected.abs().sum() > 1
        torch.testing.assert_close(found, expected, rtol=0.02 if enabled else 1e-5, atol=0.1 if enabled else 1e-5)
"""
    ran = run(program)
    assert ran.returncode == 0, ran.stderr
    assert "leaked" not in ran.stderr  # The compiler keeps the surface until the end.


def run(program: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)


def test_without_torch():
    for use in ("import raymap.torch", "from raymap import torch", "import raymap; raymap.torch.signed_distance"):
        ran = run(f"import sys; sys.modules['torch'] = None; {use}")
        assert "ImportError: raymap.torch needs PyTorch; install it with: pip install torch" in ran.stderr
    assert "AttributeError: raymap.torch needs PyTorch; install it with: pip install torch" in ran.stderr
    ran = run("import raymap; raymap.toch")
    assert "AttributeError: module 'raymap' has no attribute 'toch'" in ran.stderr
    program = "import sys; sys.modules.update(torch=None, jax=None); import raymap; print(hasattr(raymap, 'torch'), *dir(raymap))"
    found, *names = run(program).stdout.split()
    assert found == "False" and {"Surface", "zarr", "__version__"} <= set(names)
    assert not {"torch", "jax", "Any", "TYPE_CHECKING", "importlib", "_raymap"} & set(names)


def test_it_is_imported_when_it_is_used():
    """With a module in the place of PyTorch, so that the test needs none."""
    program = """
import sys, types
torch = types.ModuleType("torch")
torch.autograd = types.SimpleNamespace(Function=object)
torch.compiler = types.SimpleNamespace(is_compiling=lambda: False)
torch.Tensor = type("Tensor", (), {})
torch.utils = types.SimpleNamespace(data=types.SimpleNamespace(Dataset=object, IterableDataset=object))
sys.modules["torch"] = torch
import raymap
assert "torch" in dir(raymap) and "raymap.torch" not in sys.modules
raymap.torch.signed_distance(None, 3)
"""
    error = "TypeError: points must be a tensor, not int; NumPy: surface.signed_distance(points)\n"
    assert run(program).stderr.endswith(error)
