"""What trilinear samples of fields depend on, for frameworks that differentiate them."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._arrays import to_points
from ._errors import InputError, UsageError
from ._field import Field
from ._nearest import Nearest, find_nearest
from ._surface import Surface

_CORNERS = np.stack(np.unravel_index(np.arange(8), (2, 2, 2), order="F"), axis=-1)  # x is fastest.
_ROUNDING = 1e-5  # Of distances, as a share of them and of the mesh's diagonal.


class Cells(NamedTuple):
    """Samples of a field around points (..., 3). What follows ``is_inside`` is that of a ``Nearest`` at the samples."""

    distance: Any
    """Distances of the eight samples, (..., 8), x fastest."""
    fraction: Any
    """Places of the points between the first sample and the last, (..., 3), 0 to 1."""
    is_inside: Any
    """Whether points lie in the box of the field's samples, (...)."""
    gradient: Any = None
    """Directions in which the distances grow, (..., 8, 3). None without a surface, as all that follows."""
    corners: Any = None
    """Vertex numbers of the faces that hold their closest points, (..., 8, 3)."""
    weights: Any = None
    """Weights of these vertices, (..., 8, 3); all 0 for a sample that does not change with them."""
    places: Any = None
    """Places of these vertices from the samples, (..., 8, 3, 3)."""

    @property
    def nearest(self) -> Nearest:
        return Nearest(self.distance, self.gradient, self.corners, self.weights, self.places)


def check_field(field: Any, surface: Surface | None, vertices: Any) -> None:
    """Raises an error unless there is a field, with a surface and vertices or without both."""
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
    around = np.minimum(low[:, None] + _CORNERS, last).reshape(-1, 3)
    used, which = _unique(around, field.shape)
    distance, *nearest = (array[which.reshape(-1, 8)] for array in _find_samples(field, surface, used, vertices, threads))
    if nearest:
        nearest[2] = np.where(is_inside[:, None, None], nearest[2], 0)
    arrays = [distance, place - low, is_inside, *nearest]
    kept = (array.astype(points.dtype) if array.dtype.kind == "f" else array for array in arrays)
    return Cells(*(array.reshape(shape[:-1] + array.shape[1:]) for array in kept))


def _unique(
    indices: npt.NDArray[np.int64], shape: tuple[int, int, int]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Returns each of the samples with indices (n, 3) once, (k, 3), and which of these each row is, (n,)."""
    column = indices[:, 0] * shape[1] + indices[:, 1]
    if math.prod(shape) >= 2**63:  # A narrow band may have more samples than an int64 counts, up to 2^72.
        _, column = np.unique(column, return_inverse=True)
    numbers, which = np.unique(column * shape[2] + indices[:, 2], return_inverse=True)
    row = np.empty(len(numbers), np.int64)
    row[which] = np.arange(len(which))
    return indices[row], which


def _find_samples(
    field: Field,
    surface: Surface | None,
    indices: npt.NDArray[np.int64],
    vertices: npt.NDArray[Any] | None,
    threads: int | None,
) -> tuple[npt.NDArray[Any], ...]:
    """Returns distances of samples (n, 3), and if there is a surface what follows them in a ``Nearest``."""
    distance = _distances(field, indices, threads)
    if surface is None:
        return (distance,)
    found = find_nearest(surface, field.origin + field.spacing * indices, vertices, threads)
    inside, outside = _clamp_distances(field)
    low, high = surface.mesh.bounds
    slack = _ROUNDING * (np.linalg.norm(high - low) + np.abs(distance))
    is_same = np.abs(np.clip(found.distance, -inside, outside) - distance) <= slack
    if not is_same.all():
        first = int(np.argmin(is_same))
        raise InputError(
            f"field: sample {tuple(indices[first].tolist())} is {distance[first]:.6g}, but the surface's distance there is "
            f"{found.distance[first]:.6g}; make the field by the generate of this surface"
        )
    is_clamped = (found.distance <= -inside) | (found.distance >= outside)
    return distance, found.gradient, found.corners, np.where(is_clamped[:, None], 0, found.weights), found.places


def _distances(
    field: Field, indices: npt.NDArray[np.int64], threads: int | None
) -> npt.NDArray[np.float32]:
    """Returns the distances of samples (n, 3)."""
    if not field.is_narrow:
        return np.asarray(field.distance[tuple(indices.T)])
    # A position that rounding moves out of the box would get a bound instead of the last sample's distance.
    last = np.array(field.shape) - 1
    rounding = 4 * np.spacing(np.abs(field.origin) + field.spacing * last) / field.spacing
    return field.sample(field.origin + field.spacing * np.minimum(indices, np.maximum(last - rounding, 0)), threads=threads)


def _clamp_distances(field: Field) -> tuple[float, float]:
    """Returns the distances at which a field is clamped inside and outside, both above 0; infinite if it is not."""
    if field.is_narrow:
        return field.inside, field.outside
    return field.clamp_distance or np.inf, field.clamp_distance or np.inf


def interpolate(where: Any, found: Cells, distance: Any, change: Any) -> Any:
    """Returns trilinear samples by operations of PyTorch or JAX.

    ``distance`` are those of the samples, with the derivatives of the vertices. ``change`` is what the points move by, in
    units of the spacing, (..., 3): 0, with the derivatives of the points.
    """
    at = where(found.is_inside[..., None], found.fraction + change, 0.0)
    line = distance
    for axis in range(3):
        low, high = line[..., 0::2], line[..., 1::2]
        line = low + at[..., axis : axis + 1] * (high - low)
    return where(found.is_inside, line[..., 0], float("nan"))
