"""Distances and closest points that JAX differentiates."""

from __future__ import annotations

import math
import subprocess
import sys
from functools import partial

import numpy as np
import pytest
import raymap
from helpers import load


@pytest.fixture(scope="module")
def surface(ball) -> raymap.Surface:
    return raymap.Surface(ball)


@pytest.fixture(scope="module")
def points(surface: raymap.Surface) -> np.ndarray:
    candidates = np.random.default_rng(3).uniform(-1.5, 1.5, (2000, 3)).astype(np.float32)
    found = surface.closest(candidates)
    return candidates[(np.abs(found.distance) > 0.05) & (found.barycentric.min(axis=1) > 0.2)][:6]


def test_values_and_gradients(surface, points):
    jax = load("jax")

    def distance(p):
        return raymap.jax.signed_distance(surface, p)

    np.testing.assert_array_equal(distance(points), surface.signed_distance(points))
    found = surface.query(points, ("distance", "direction"))
    expected = -np.sign(found.distance)[:, None] * found.direction
    for transform in (jax.vmap, lambda f: jax.jit(jax.vmap(f))):
        np.testing.assert_allclose(transform(jax.grad(distance))(points), expected, atol=1e-6)
    change = np.ones((6, 3), np.float32)
    np.testing.assert_allclose(jax.jvp(distance, (points,), (change,))[1], expected.sum(axis=1), atol=1e-6)
    assert distance([0, 0, 2]).dtype == np.float32


def test_gradients_of_vertices(surface, points):
    jax = load("jax")
    vertices = jax.numpy.asarray(surface.mesh.vertices, np.float32)

    def total(p, v):
        return raymap.jax.signed_distance(surface, p, vertices=v).sum()

    to_points, to_vertices = jax.grad(total, argnums=(0, 1))(points, vertices)
    found = surface.query(points, ("triangle", "barycentric"))
    expected = np.zeros(vertices.shape)
    for k, triangle in enumerate(found.triangle):
        for corner, weight in zip(surface.mesh.faces[triangle], found.barycentric[k], strict=True):
            expected[corner] -= weight * np.asarray(to_points[k])
    np.testing.assert_allclose(to_vertices, expected, atol=1e-5)
    alone = jax.jit(jax.vmap(jax.grad(total, argnums=1), (0, None)))(points, vertices)
    np.testing.assert_allclose(alone.sum(axis=0), to_vertices, atol=1e-5)


def test_closest_points(surface, points):
    jax = load("jax")

    def closest(p):
        return raymap.jax.closest_point(surface, p)

    np.testing.assert_allclose(closest(points), surface.closest(points).point, atol=1e-5)
    for jacobian, point in zip(jax.jit(jax.vmap(jax.jacobian(closest)))(points), points, strict=True):
        direction = surface.query(point, "direction").direction
        np.testing.assert_allclose(jacobian, np.eye(3) - np.outer(direction, direction), atol=1e-4)


def test_samples_of_fields(surface, points):
    jax = load("jax")
    field = surface.generate(shape=(9, 9, 9), origin=(-1.63, -1.57, -1.61), voxel_size=0.4)
    vertices = jax.numpy.asarray(surface.mesh.vertices, np.float32)

    def sample(p, v):
        return raymap.jax.sample(field, p, surface=surface, vertices=v)

    np.testing.assert_allclose(jax.jit(lambda p: raymap.jax.sample(field, p))(points), field.sample(points), atol=1e-6)
    places = np.concatenate([points, np.float32([(0, 0, 9), (np.nan, 0, 0)])])
    both = jax.jit(jax.vmap(jax.value_and_grad(sample, argnums=(0, 1)), (0, None)))
    values, (to_points, to_vertices) = both(places, vertices)
    np.testing.assert_allclose(values, field.sample(places, outside="nan"), atol=1e-6)
    assert (to_points[6:] == 0).all() and (to_vertices[6:] == 0).all()
    place = (points - field.origin) / field.spacing
    low, corners = np.floor(place).astype(int), np.array(list(np.ndindex(2, 2, 2)))
    at, within = field.origin + field.spacing * (low[:, None] + corners), (place - low)[:, None]
    share = np.where(corners, within, 1 - within).prod(axis=-1)
    expected = jax.jit(jax.grad(lambda v: (raymap.jax.signed_distance(surface, at, vertices=v) * share).sum()))(vertices)
    np.testing.assert_allclose(to_vertices.sum(axis=0), expected, atol=1e-5)
    for k, (i, (_, y, z)) in enumerate(zip(low, within[:, 0], strict=True)):
        lines = field.distance[tuple(slice(n, n + 2) for n in i)]
        slope = (-1, 1) @ np.einsum("ijk,j,k->i", lines, (1 - y, y), (1 - z, z)) / field.spacing
        assert float(to_points[k, 0]) == pytest.approx(slope, abs=1e-5)


@pytest.mark.parametrize("inside", [2.0, math.inf])
def test_samples_of_narrow_bands(surface, points, inside):
    """Where no sample is clamped, values and gradients are those of the dense field."""
    jax = load("jax")
    grid = {"shape": (31, 30, 29), "origin": (-1.53, -1.47, -1.41), "voxel_size": 0.1}
    band, dense = surface.generate(sparse=True, band=(inside, 4), **grid), surface.generate(**grid)
    vertices = jax.numpy.asarray(surface.mesh.vertices, np.float32)
    scales = (1.0, 1.6, 0.85, 0.1)  # Of points near the surface; within the band, beyond it, and inside.
    near = np.concatenate([scale * points / np.linalg.norm(points, axis=1, keepdims=True) for scale in scales])

    def samples(field):
        def sample(p, v):
            return raymap.jax.sample(field, p, surface=surface, vertices=v)

        return jax.jit(jax.vmap(jax.value_and_grad(sample, argnums=(0, 1)), (0, None)))(near, vertices)

    (values, slopes), (whole, whole_slopes) = samples(band), samples(dense)
    np.testing.assert_allclose(values, band.sample(near, outside="nan"), atol=1e-6)
    is_same = np.repeat([True, False, inside > 2, inside > 2], len(points))
    np.testing.assert_allclose(values[is_same], whole[is_same], atol=1e-6)
    for found, expected in zip(slopes, whole_slopes, strict=True):
        np.testing.assert_allclose(found[is_same], expected[is_same], atol=1e-5)
        assert (found[len(points) : 2 * len(points)] == 0).all()
        assert (found[-len(points) :] == 0).all() == (inside == 2)


def test_second_derivatives():
    """Those of the distance to what holds the closest point: a face, the edge along x, the corner at 0."""
    jax = load("jax")
    surface = raymap.Surface("tetrahedron.ply")
    edge, corner = np.array((0, 0.8, -0.6)), np.array((-2, -2, -1)) / 3
    points = np.float32([(0.2, 0.3, -0.5), (0.4, -0.3, -0.4), (-0.2, -0.2, -0.1), (np.nan, 0, 0)])
    found = jax.jit(jax.vmap(jax.hessian(lambda p: raymap.jax.signed_distance(surface, p))))(points)
    none, edges, corners = np.zeros((3, 3)), np.outer(edge, edge) / 0.5, (np.eye(3) - np.outer(corner, corner)) / 0.3
    np.testing.assert_allclose(found, [none, edges, corners, none], atol=1e-5)


@pytest.mark.parametrize("name", ["bfloat16", "float32"])
def test_results_have_the_type_of_the_points(surface, name):
    jax = load("jax")
    dtype, field = jax.numpy.dtype(name), surface.generate(resolution=8)
    points = jax.numpy.asarray([(0.0, 0.0, 1.5), (0.0, 0.0, 0.875)], dtype)
    exact = np.asarray(points, np.float64)
    functions = raymap.jax.signed_distance, raymap.jax.closest_point, raymap.jax.sample
    for function, of in zip(functions, (surface, surface, field), strict=True):
        found = jax.vmap(partial(function, of))(points)
        assert found.dtype == dtype
        np.testing.assert_allclose(np.asarray(found, float), function(of, exact), rtol=0.01, atol=1e-6)
    gradient = jax.grad(lambda p: raymap.jax.signed_distance(surface, p)[0])(points)
    assert gradient.dtype == dtype and gradient[0].tolist() == pytest.approx((0, 0, 1), abs=1e-2)
    for found in (surface.signed_distance(points), surface.closest(points).point, field.sample(points)):
        assert found.dtype == dtype and isinstance(found, jax.Array)


def test_gradients_are_not_dropped(surface, points):
    jax = load("jax")
    field = surface.generate(resolution=4)
    for function, instead in (
        (surface.signed_distance, r"raymap.jax.signed_distance\(surface, points\)"),
        (surface.closest, r"raymap.jax.closest_point\(surface, points\)"),
        (lambda p: surface.closest(p).point, r"raymap.jax.closest_point\(surface, points\)"),
        (field.sample, r"raymap.jax.sample\(field, points\)"),
    ):
        with pytest.raises(raymap.UsageError, match=f"points must be an array, but are traced by .* JAX; use {instead}"):
            jax.grad(lambda p, f=function: f(p).sum())(points)
    with pytest.raises(raymap.UsageError, match="are traced by a transformation of JAX(\n|$)"):
        jax.jit(raymap.Scene({"ball": surface}).signed_distance)(points)


def test_arguments_that_make_no_sense(surface, points):
    jax = load("jax")
    for function, of in ((raymap.jax.signed_distance, surface), (raymap.jax.sample, surface.generate(resolution=4))):
        with pytest.raises(raymap.InputError, match=r"points must be \(..., 3\) coordinates, not of the shape \(2, 2\)"):
            function(of, np.zeros((2, 2)))
        with pytest.raises(raymap.InputError, match="points must be numbers, not complex64"):
            function(of, np.zeros((2, 3), np.complex64))
    with pytest.raises(Exception, match="those of the surface, not"):
        jax.block_until_ready(raymap.jax.signed_distance(surface, points, vertices=np.zeros((2, 3), np.float32)))


def test_without_jax():
    ran = subprocess.run(
        [sys.executable, "-c", "import sys; sys.modules['jax'] = None; import raymap; raymap.jax"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "ImportError: raymap.jax needs JAX; install it with: pip install jax" in ran.stderr
