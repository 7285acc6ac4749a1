"""Distances and closest points that JAX can differentiate, negative inside.

>>> import raymap, jax  # doctest: +SKIP
>>> surface = raymap.Surface("ball.ply")  # doctest: +SKIP
>>> jax.grad(lambda point: raymap.jax.signed_distance(surface, point))(jax.numpy.array((0.0, 0.0, 1.5)))  # doctest: +SKIP
Array([0., 0., 1.], dtype=float32)
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from ._nearest import Nearest, check_vertices, find_nearest, project
from ._surface import Surface

try:
    jax: Any = importlib.import_module("jax")  # Any, so that types are the same with JAX and without.
except ImportError as error:
    raise ImportError("raymap.jax needs JAX; install it with: pip install jax") from error


def signed_distance(surface: Surface, points: Any, *, vertices: Any = None, threads: int | None = None) -> Any:
    """Returns distances at points, (...) for points (..., 3), negative inside, for ``grad``, ``jvp``, ``vmap`` and ``jit``.

    The derivatives are those of ``raymap.torch.signed_distance``: a point's is the unit vector along which its distance
    grows, a vertex's the opposite one times its barycentric weight. They are 0 on the surface, jump where another point
    of the surface becomes the closest, and hold no derivatives of their own: second derivatives are 0.

    Args:
        surface: A surface; without a sign, distances are not negative.
        points: Positions in the mesh's units, (..., 3). The work is done on the CPU, by a callback.
        vertices: The vertices of the surface's mesh, (n, 3), to differentiate with respect to them. After they have moved,
            prepare a new surface of them.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError: Points of another shape, or vertices that are not those of the surface. Under ``jit``, JAX wraps the
            second in an error of its own.
        MemoryLimitError: The results do not fit into memory.
    """
    points = _to_points(points)

    @jax.custom_jvp  # type: ignore[untyped-decorator]
    def distance(points: Any, vertices: Any) -> Any:
        return _nearest(surface, points, vertices, threads).distance

    @distance.defjvp  # type: ignore[untyped-decorator]
    def _(values: tuple[Any, Any], changes: tuple[Any, Any]) -> tuple[Any, Any]:
        found = _nearest(surface, *values, threads)
        moved = changes[0]
        if values[1] is not None:
            corners = changes[1][found.corners].astype(moved.dtype)
            moved = moved - (found.weights[..., None] * corners).sum(-2)
        return found.distance, (found.gradient * moved).sum(-1)

    return distance(points, vertices)


def closest_point(surface: Surface, points: Any, *, vertices: Any = None, threads: int | None = None) -> Any:
    """Returns the closest points of a surface, (..., 3) for points (..., 3), differentiable any number of times.

    The derivative is that of the projection onto the face, the edge or the vertex that holds the closest point. It jumps
    where another one takes over.

    Args:
        surface: A surface, with a sign or without.
        points: Positions, as for ``signed_distance``.
        vertices: The vertices of the surface's mesh, (n, 3), to differentiate with respect to them; None = as the surface
            keeps them.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError, MemoryLimitError: As for ``signed_distance``.
    """
    points = _to_points(points)
    vertices = jax.numpy.asarray(surface.mesh.vertices if vertices is None else vertices)
    found = _nearest(surface, jax.lax.stop_gradient(points), jax.lax.stop_gradient(vertices), threads)
    return project(jax.numpy.where, points, vertices.astype(points.dtype)[found.corners], found.weights)


def _to_points(points: Any) -> Any:
    """Returns points as an array of floating-point numbers."""
    given = jax.numpy.asarray(points)
    return given if jax.numpy.issubdtype(given.dtype, jax.numpy.floating) else given.astype(float)


def _nearest(surface: Surface, points: Any, vertices: Any, threads: int | None) -> Nearest:
    def find(points: Any, vertices: Any) -> Nearest:
        if vertices is not None:
            check_vertices(surface, vertices.reshape(vertices.shape[-2:]) if vertices.size == size else vertices)
        distance, gradient, corners, weights = find_nearest(surface, np.asarray(points), threads)
        return Nearest(distance, gradient, corners.astype(np.int32), weights)

    size = None if vertices is None else vertices.size  # vmap adds an axis of length 1.
    shape = jax.ShapeDtypeStruct
    result = Nearest(
        shape(points.shape[:-1], points.dtype),
        shape(points.shape, points.dtype),
        shape(points.shape, np.int32),
        shape(points.shape, points.dtype),
    )
    return jax.pure_callback(find, result, points, vertices, vmap_method="expand_dims")  # type: ignore[no-any-return]
