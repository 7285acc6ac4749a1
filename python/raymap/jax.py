"""Distances, closest points and samples of fields that JAX can differentiate, negative inside.

>>> import raymap, jax  # doctest: +SKIP
>>> surface = raymap.Surface("ball.ply")  # doctest: +SKIP
>>> jax.grad(lambda point: raymap.jax.signed_distance(surface, point))(jax.numpy.array((0.0, 0.0, 1.5)))  # doctest: +SKIP
Array([0., 0., 1.], dtype=float32)
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ._errors import InputError
from ._field import Field
from ._nearest import Nearest, find_nearest, follow, project
from ._surface import Surface
from ._trilinear import Cells, check_field, find_cells, interpolate

try:
    jax: Any = importlib.import_module("jax")  # Any, so that types are the same with JAX and without.
except ImportError as error:
    raise ImportError("raymap.jax needs JAX; install it with: pip install jax") from error


def signed_distance(surface: Surface, points: Any, *, vertices: Any = None, threads: int | None = None) -> Any:
    """Returns distances at points, (...) for points (..., 3), negative inside, for ``grad``, ``jvp``, ``vmap`` and ``jit``.

    The derivatives are those of ``raymap.torch.signed_distance``: a point's is the unit vector along which its distance
    grows, a vertex's the opposite one times its barycentric weight. They are 0 on the surface, and jump where another
    point of the surface becomes the closest. Derivatives of any order are computed: those of the distance to the face,
    the edge or the vertex that holds the closest point.

    Args:
        surface: A surface; without a sign, distances are not negative.
        points: Positions in the mesh's units, (..., 3). The result has their type. The work is done on the CPU, by a
            callback.
        vertices: The vertices of the surface's mesh, (n, 3), to differentiate with respect to them. After they have moved,
            prepare a new surface of them.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError: Points of another shape, or vertices that are not those of the surface. JAX wraps the second in an
            error of its own.
        MemoryLimitError: The results do not fit into memory.
    """
    points, kind = _to_points(points)
    found = Nearest(*_find(partial(find_nearest, surface, threads=threads), _kinds(points), points, vertices))
    return _followed(found, _change(points), vertices).astype(kind)


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
    points, kind = _to_points(points)
    found = Nearest(*_find(partial(find_nearest, surface, threads=threads), _kinds(points), points, vertices))
    nearest = project(jax.numpy.where, _change(points), found.places + _moved(found, vertices), found.weights)
    return (jax.lax.stop_gradient(points) + nearest).astype(kind)


def sample(
    field: Field,
    points: Any,
    *,
    surface: Surface | None = None,
    vertices: Any = None,
    threads: int | None = None,
) -> Any:
    """Returns a field's distances at points, (...) for points (..., 3), trilinear between its samples, negative inside.

    The derivatives are those of ``raymap.torch.sample``. They jump where a point enters another cell of the grid, and
    where one of the samples around it gets another closest point. Points outside of the box of the samples, and those
    that are not finite, get NaN and the derivative 0.

    Args:
        field: A dense field or a narrow band.
        points: Positions, as for ``signed_distance``.
        surface: To differentiate with respect to vertices: a surface of them that the field agrees with, as one that its
            ``generate`` made does.
        vertices: The vertices of the surface's mesh, (n, 3). After they have moved, prepare a new surface of them, and
            make a new field of it.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError: Points of another shape, vertices that are not those of the surface, or a sample that is not its
            distance. JAX wraps the last two in an error of its own.
        UsageError: A surface without vertices, or vertices without a surface.
        TypeError: The field is no ``raymap.Field``.
    """
    check_field(field, surface, vertices)
    points, kind = _to_points(points)
    distance, *nearest = _kinds(points, 8)
    cells = jax.ShapeDtypeStruct(points.shape, points.dtype), jax.ShapeDtypeStruct(points.shape[:-1], bool)
    kinds = (distance, *cells, *(nearest if surface is not None else ()))
    found = Cells(*_find(partial(find_cells, field, surface, threads=threads), kinds, points, vertices))
    samples = found.distance if surface is None else _followed(found.nearest, 0.0, vertices)
    return interpolate(jax.numpy.where, found, samples, _change(points) / field.spacing).astype(kind)


def _to_points(points: Any) -> tuple[Any, Any]:
    """Returns points in the type in which the work is done, float32 or float64, and the type of the results.

    Raises:
        InputError: Points of another shape than (..., 3), or no real numbers.
    """
    given = jax.numpy.asarray(points)
    if given.ndim == 0 or given.shape[-1] != 3:
        raise InputError(f"points must be (..., 3) coordinates, not of the shape {given.shape}")
    if jax.numpy.issubdtype(given.dtype, jax.numpy.complexfloating):
        raise InputError(f"points must be numbers, not {given.dtype}")
    if not jax.numpy.issubdtype(given.dtype, jax.numpy.floating):
        given = given.astype(float)
    return given.astype(np.float32) if given.dtype.itemsize < 4 else given, given.dtype


def _kinds(points: Any, *samples: int) -> tuple[Any, ...]:
    """Returns the shapes and types of a ``Nearest``, for points or for so many samples around each."""
    kind, leading = jax.ShapeDtypeStruct, points.shape[:-1] + samples
    return (
        kind(leading, points.dtype),
        kind((*leading, 3), points.dtype),
        kind((*leading, 3), np.int32),
        kind((*leading, 3), points.dtype),
        kind((*leading, 3, 3), points.dtype),
    )


def _find(find: Callable[..., Any], kinds: tuple[Any, ...], points: Any, vertices: Any) -> Any:
    """Returns what ``find`` returns of points and vertices, by a callback, as constants of these kinds."""
    size = None if vertices is None else vertices.size  # vmap adds an axis of length 1.

    def call(points: Any, vertices: Any) -> tuple[Any, ...]:
        if vertices is not None:
            vertices = np.asarray(vertices)
            vertices = vertices.reshape(vertices.shape[-2:]) if vertices.size == size else vertices
        found = find(np.asarray(points), vertices)
        made = (array for array in found if array is not None)
        return tuple(np.asarray(array, kind.dtype) for array, kind in zip(made, kinds, strict=True))

    still = jax.lax.stop_gradient((points, vertices))
    return jax.pure_callback(call, kinds, *still, vmap_method="expand_dims")


def _change(values: Any) -> Any:
    """Returns 0 with the derivatives of the values."""
    return values - jax.lax.stop_gradient(values)


def _moved(found: Nearest, vertices: Any) -> Any:
    """Returns what the corners move by, (..., 3, 3): 0, with the derivatives of the vertices."""
    return 0.0 if vertices is None else _change(jax.numpy.asarray(vertices))[found.corners].astype(found.weights.dtype)


def _followed(found: Nearest, change: Any, vertices: Any) -> Any:
    return follow(jax.numpy.where, jax.lax.stop_gradient, found, change, _moved(found, vertices))
