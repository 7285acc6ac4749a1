"""What closest points of a surface depend on, for frameworks that differentiate distances."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._errors import InputError
from ._surface import Surface


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


def find_nearest(
    surface: Surface, points: npt.NDArray[Any], vertices: npt.NDArray[Any] | None = None, threads: int | None = None
) -> Nearest:
    """Returns what distances of points change with, first of all their closest points.

    Raises:
        InputError: Points of another shape, or vertices that are not those of the surface.
    """
    if vertices is not None:
        _check_vertices(surface, vertices)
    found = surface.query(points, ("distance", "direction", "triangle", "barycentric"), threads=threads)
    is_finite = np.isfinite(found.distance)
    corners = surface.mesh.faces[np.where(is_finite, found.triangle, 0)].astype(np.int64)
    weights = np.where(is_finite[..., None], found.barycentric, 0)
    order = np.argsort(weights <= 0, axis=-1, kind="stable")
    return Nearest(
        found.distance,
        np.where((found.distance < 0)[..., None], found.direction, -found.direction),
        np.take_along_axis(corners, order, axis=-1),
        np.take_along_axis(weights, order, axis=-1),
    )


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
