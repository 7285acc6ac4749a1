"""What trilinear samples of fields depend on, for frameworks that differentiate them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._arrays import to_points
from ._errors import InputError, UsageError
from ._field import Field
from ._nearest import find_nearest
from ._surface import Surface

_CORNERS = np.stack(np.unravel_index(np.arange(8), (2, 2, 2), order="F"), axis=-1)  # x is fastest.
_ROUNDING = 1e-5  # Of distances, as a share of them and of the mesh's diagonal.


class Cells(NamedTuple):
    """Samples of a field around points (..., 3). The first four members are those of a ``Nearest`` at the samples."""

    distance: Any
    """Distances of the eight samples, (..., 8), x fastest."""
    gradient: Any
    """Directions in which they grow, (..., 8, 3); 0 unless asked for."""
    corners: Any
    """Vertex numbers of the faces that hold their closest points, (..., 8, 3)."""
    weights: Any
    """Weights of these vertices, (..., 8, 3); all 0 for a sample that does not change with them."""
    fraction: Any
    """Places of the points between the first sample and the last, (..., 3), 0 to 1."""
    is_inside: Any
    """Whether points lie in the box of the field's samples, (...)."""


def check_field(field: Any, surface: Surface | None, vertices: Any) -> None:
    """Raises an error unless there is a dense field, with a surface and vertices or without both."""
    if not isinstance(field, Field):
        raise TypeError(f"field must be a raymap.Field, not a {type(field).__name__}")
    if (surface is None) != (vertices is None):
        raise UsageError("surface and vertices belong together; give both, or leave both out")


def find_cells(
    field: Field,
    surface: Surface | None,
    points: npt.NDArray[Any],
    vertices: npt.NDArray[Any] | None = None,
    threads: int | None = None,
) -> Cells:
    """Returns the samples around points, and what they change with if there is a surface.

    Raises:
        InputError: Points of another shape, vertices that are not those of the surface, or a sample that is not its
            distance.
    """
    flat, shape = to_points(points)
    last = np.array(field.shape) - 1
    place = (flat - field.origin) / field.spacing
    is_inside = np.asarray(((place >= 0) & (place <= last)).all(axis=1))
    place = np.where(is_inside[:, None], place, 0)
    low = np.minimum(place.astype(np.int64), np.maximum(last - 1, 0))
    around = np.minimum(low[:, None] + _CORNERS, last)
    used, which = np.unique(np.ravel_multi_index(tuple(np.moveaxis(around, -1, 0)), field.shape), return_inverse=True)
    samples = _find_samples(field, surface, np.stack(np.unravel_index(used, field.shape), axis=-1), vertices, threads)
    gathered = [array[which.reshape(-1, 8)] for array in samples]
    gathered[3] = np.where(is_inside[:, None, None], gathered[3], 0)
    arrays = [*gathered, place - low, is_inside]
    kept = (array.astype(points.dtype) if array.dtype.kind == "f" else array for array in arrays)
    return Cells(*(array.reshape(shape[:-1] + array.shape[1:]) for array in kept))


def _find_samples(
    field: Field,
    surface: Surface | None,
    indices: npt.NDArray[np.int64],
    vertices: npt.NDArray[Any] | None,
    threads: int | None,
) -> tuple[npt.NDArray[Any], ...]:
    """Returns distances of samples (n, 3), and what follows them in a ``Nearest``."""
    distance = field.distance[tuple(indices.T)]
    if surface is None:
        return distance, np.zeros(indices.shape), np.zeros(indices.shape, np.int64), np.zeros(indices.shape)
    found = find_nearest(surface, field.origin + field.spacing * indices, vertices, threads)
    limit = field.clamp_distance or np.inf
    low, high = surface.mesh.bounds
    slack = _ROUNDING * (np.linalg.norm(high - low) + np.abs(distance))
    is_same = np.abs(np.clip(found.distance, -limit, limit) - distance) <= slack
    if not is_same.all():
        first = int(np.argmin(is_same))
        raise InputError(
            f"field: sample {tuple(indices[first].tolist())} is {distance[first]:.6g}, but the surface's distance there is "
            f"{found.distance[first]:.6g}; make the field by the generate of this surface"
        )
    is_clamped = np.abs(found.distance) >= limit
    return distance, found.gradient, found.corners, np.where(is_clamped[:, None], 0, found.weights)


def interpolate(where: Any, found: Cells, change: Any) -> Any:
    """Returns trilinear samples by operations of NumPy, PyTorch or JAX.

    ``change`` is what the points move by, in units of the spacing, (..., 3): 0, with the derivatives of the points.
    """
    at = where(found.is_inside[..., None], found.fraction + change, 0.0)
    line = found.distance
    for axis in range(3):
        low, high = line[..., 0::2], line[..., 1::2]
        line = low + at[..., axis : axis + 1] * (high - low)
    return where(found.is_inside, line[..., 0], float("nan"))
