"""What closest points of a surface depend on, for frameworks that differentiate distances."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._errors import InputError
from ._surface import Query, QueryArray, Surface, corners_of_surface


class Nearest(NamedTuple):
    """Distances of points (..., 3), and the corners of the faces that hold their closest points."""

    distance: npt.NDArray[Any]
    """Signed distances, (...), in the type of the points."""
    gradient: npt.NDArray[Any]
    """Direction in which the distance grows, (..., 3)."""
    corners: npt.NDArray[np.int64]
    """Vertex numbers of the face, (..., 3). Those that hold the closest point between them come first."""
    weights: npt.NDArray[Any]
    """Weights of these corners, (..., 3); all 0 for a point that is not finite."""
    places: npt.NDArray[Any]
    """Places of these corners, (..., 3, 3), from the point."""


def find_nearest(
    surface: Surface, points: npt.NDArray[Any], vertices: npt.NDArray[Any] | None = None, threads: int | None = None
) -> Nearest:
    """Returns what distances of points change with, first of all their closest points.

    Raises:
        InputError: Points of another shape, or vertices that are not those of the surface.
    """
    return hold(surface, points, find_closest(surface, points, vertices, threads))


def find_closest(
    surface: Surface,
    points: Any,
    vertices: npt.NDArray[Any] | None,
    threads: int | None,
    arrays: tuple[QueryArray, ...] = ("distance", "direction", "triangle", "barycentric"),
) -> Any:
    """Returns distances, in a ``Query``, and what their derivatives need. Raises InputError as ``find_nearest`` does."""
    if vertices is not None:
        _check_vertices(surface, vertices)
    return surface.query(points, arrays, threads=threads)


def hold(surface: Surface, points: npt.NDArray[Any], found: Query[Any, Any, Any]) -> Nearest:
    """Returns the corners that hold closest points, and where they are."""
    is_finite = np.isfinite(found.distance)
    corners, places = corners_of_surface(surface, np.where(is_finite, found.triangle, 0), points)
    weights = np.where(is_finite[..., None], found.barycentric, 0)
    order = np.argsort(weights <= 0, axis=-1, kind="stable")
    return Nearest(
        found.distance,
        _gradient(found),
        np.take_along_axis(corners, order, axis=-1),
        np.take_along_axis(weights, order, axis=-1),
        np.take_along_axis(places, order[..., None], axis=-2),
    )


def slope(found: Query[Any, Any, Any]) -> npt.NDArray[Any]:
    """Returns the gradient of distances, (..., 3): 0 on the surface, and for a point that is not finite."""
    gradient = _gradient(found)
    is_away = np.isfinite(found.distance) & ((gradient * gradient).sum(-1) > 0.5)
    return np.where(is_away[..., None], gradient, 0)


def shares(surface: Surface, found: Query[Any, Any, Any]) -> tuple[npt.NDArray[np.int64], npt.NDArray[Any]]:
    """Returns the corners of the faces that hold closest points, and their weights, both (..., 3)."""
    is_finite = np.isfinite(found.distance)
    corners = surface.mesh.faces[np.where(is_finite, found.triangle, 0)].astype(np.int64)
    return corners, np.where(is_finite[..., None], found.barycentric, 0)


def _gradient(found: Query[Any, Any, Any]) -> Any:
    return np.where((found.distance < 0)[..., None], found.direction, -found.direction)


def _check_vertices(surface: Surface, given: npt.NDArray[Any]) -> None:
    """Raises InputError unless a surface was prepared of these vertices, (n, 3)."""
    rounding = 2.0**-22  # Surfaces keep positions in single precision about an origin.
    kept = surface.mesh.vertices
    if given.shape != kept.shape:
        raise InputError(f"vertices must be {kept.shape}, those of the surface, not {given.shape}")
    is_same = (np.abs(given - kept) <= rounding * np.abs(kept).max(initial=0.0)).all(axis=1)
    if not is_same.all():
        raise InputError(
            f"vertices: number {np.argmin(is_same)} is not that of the surface; prepare a raymap.Surface of these vertices"
        )


def follow(where: Any, still: Callable[[Any], Any], found: Nearest, change: Any, moved: Any) -> Any:
    """Returns the distances with all their derivatives, by operations of PyTorch or JAX.

    ``still`` returns an array as a constant. ``change`` is what the points move by, (..., 3), and ``moved`` what the corners
    do, (..., 3, 3): 0, with the derivatives of points and vertices.
    """
    distance, gradient = found.distance, found.gradient
    is_away = (distance != 0) & (found.weights[..., 0] > 0) & ((gradient * gradient).sum(-1) > 0.5)
    nearest = project(where, change, found.places + moved, found.weights)
    # The line from the closest point to the point, divided by its length. On the surface there is none.
    line = gradient + (change - nearest + still(nearest)) / where(is_away, distance, 1.0)[..., None]
    length = (where(is_away[..., None], line, 1.0) ** 2).sum(-1) ** 0.5
    return distance + where(is_away, distance * (length - still(length)), 0.0)


def project(where: Any, points: Any, corners: Any, weights: Any) -> Any:
    """Returns the closest points on what the corners (..., 3, 3) with a weight span, by operations of NumPy, PyTorch or JAX.

    This is the closest point of the face while it stays within: its derivatives are those of the closest point.
    """
    held = weights > 0
    first = corners[..., 0, :]
    along = where(held[..., 1:2], corners[..., 1, :] - first, 0.0)
    across = where(held[..., 2:3], corners[..., 2, :] - first, 0.0)
    to_point = where(held[..., :1], points - first, 0.0)
    across = across - _share(where, across, along) * along
    found = first + _share(where, to_point, along) * along + _share(where, to_point, across) * across
    return where(held[..., :1], found, float("nan"))


def _share(where: Any, vector: Any, axis: Any) -> Any:
    """Returns how many times an axis lies in a vector, (..., 1); 0 for an axis without a length."""
    square = (axis * axis).sum(-1)[..., None]
    return (vector * axis).sum(-1)[..., None] / where(square > 0, square, 1.0)
