"""Distances and closest points that JAX differentiates."""

from __future__ import annotations

import subprocess
import sys

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


def test_vertices_of_another_mesh(surface, points):
    jax = load("jax")
    with pytest.raises(Exception, match="those of the surface, not"):
        jax.block_until_ready(raymap.jax.signed_distance(surface, points, vertices=np.zeros((2, 3), np.float32)))


def test_without_jax():
    ran = subprocess.run(
        [sys.executable, "-c", "import sys; sys.modules['jax'] = None; import raymap; raymap.jax"],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert "ImportError: raymap.jax needs JAX; install it with: pip install jax" in ran.stderr
