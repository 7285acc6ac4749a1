"""Turns arrays of vertices and faces into triangles as the extension module takes them."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from . import _raymap
from ._arrays import still, to_numpy
from ._errors import InputError, warn

#: What to do for those who give points in place of faces.
POINTS_HINT = "for distances at points, use raymap.signed_distance(mesh, points), or raymap.Surface for several calls"


def checked_arrays(vertices: Any, faces: Any) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Returns vertices as float32 or float64 and triangles as uint32 or uint64, laid out as the extension reads them.

    Faces are (n, 3) vertex numbers, (n, k) of polygons, or padded as those of VTK: the number of corners before each.
    """
    positions = to_numpy("vertices", still(vertices))
    if positions.ndim != 2 or positions.shape[1] != 3:
        raise InputError(f"vertices must be (n, 3) positions, not of the shape {positions.shape}")
    if positions.dtype not in (np.float32, np.float64) or not positions.dtype.isnative:
        if positions.dtype.kind not in "fiub":
            raise InputError(f"vertices must be numbers, not {positions.dtype}")
        positions = positions.astype(np.float64)
    corners = _to_triangles(positions, _to_wholes(to_numpy("faces", still(faces))))
    if corners.dtype.kind == "i" and corners.size > 0 and corners.min() < 0:
        face = int(np.argmax((corners < 0).any(axis=1)))
        raise InputError(f"face {face} has a negative vertex number: {corners[face].tolist()}")
    size = 8 if corners.dtype.itemsize == 8 else 4
    if corners.dtype.itemsize == size and corners.dtype.isnative:
        corners = corners.view(f"u{size}")
    else:
        corners = corners.astype(f"u{size}")
    return _with_whole_rows(positions), _with_whole_rows(corners)


def _to_wholes(faces: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns vertex numbers as whole numbers. Other packages keep them as floats."""
    if faces.dtype.kind in "iu":
        return faces
    if faces.dtype.kind != "f":
        raise InputError(f"faces must be whole numbers, not {faces.dtype}")
    if faces.size == 0:
        return faces.astype(np.int64)
    is_whole = (faces == np.floor(faces)) & (np.abs(faces) < 2**53)
    if not is_whole.all():
        first = faces[np.unravel_index(int(np.argmin(is_whole)), faces.shape)]
        raise InputError(f"faces must be whole numbers, not {faces.dtype} such as {first:g}; {POINTS_HINT}")
    if faces.ndim == 2 and (faces[:, :1] == faces).all():  # Points at 0
        raise InputError(f"faces must be whole numbers, not {faces.dtype}; {POINTS_HINT}")
    return faces.astype(np.int64)


def _to_triangles(positions: npt.NDArray[Any], faces: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns the triangles of faces, (n, 3)."""
    if faces.ndim == 1 and faces.size > 0:
        parts = unpadded(faces)
        sizes = np.array([len(part) for part in parts])
        if (sizes == 3).all():
            return np.stack(parts)
        return cut(positions, np.concatenate(parts), sizes)
    if faces.ndim != 2 or faces.shape[1] < 3:
        raise InputError(f"faces must be (n, 3) vertex numbers, not of the shape {faces.shape}")
    if faces.shape[1] > 3 and _is_padded(faces, len(positions)):
        faces = faces[:, 1:]
    if faces.shape[1] == 3:
        return faces
    return cut(positions, faces.ravel(), np.full(len(faces), faces.shape[1]))


def _is_padded(faces: npt.NDArray[Any], count: int) -> bool:
    """Returns whether the first number of each row is that of its corners, and not a vertex.

    If it is a vertex of each face, no face has it again.
    """
    corners = faces.shape[1] - 1
    if len(faces) == 0 or (faces[:, 0] != corners).any():
        return False
    if corners >= count or (faces[:, 1:] == corners).any():
        return True
    raise InputError(
        f"faces: each row of {corners + 1} numbers begins with {corners}, which may be the number of its corners or a vertex; "
        f"give faces[:, 1:], or turn the corners of a face"
    )


def unpadded(faces: npt.NDArray[Any], least: int = 3) -> list[npt.NDArray[Any]]:
    """Returns the parts of an array in which the length of each part, at least so much, stands before it."""
    parts, at = [], 0
    while at < len(faces):
        end = at + 1 + int(faces[at])
        if end <= at + least or end > len(faces):
            raise InputError(
                f"faces of the shape {faces.shape} must have the number of its corners before each face, but number {at} is "
                f"{faces[at]}"
            )
        parts.append(faces[at + 1 : end])
        at = end
    return parts


def cut(points: Any, corners: npt.NDArray[Any], sizes: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns the triangles of polygons. Warns of those that cannot be cut."""
    if corners.size > 0 and not 0 <= int(corners.min()) <= int(corners.max()) < len(points):
        raise InputError(f"a face has a vertex number out of range: {corners.min()} to {corners.max()}")
    positions = np.ascontiguousarray(points, np.float64)
    faces, uncut = _raymap.cut_polygons(positions, corners.astype(np.uint32), sizes.astype(np.uint32))
    if uncut > 0:
        text = f"faces that cross themselves, or whose corners lie on a line: {uncut}; their triangles may overlap"
        warn("file_content", text, {"file": ""})
    return faces


def _with_whole_rows(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns an array whose rows ascend in memory without overlap, and have no gaps in them. Copies if need be."""
    item = array.dtype.itemsize
    if array.strides[1] == item and array.strides[0] >= 3 * item and array.strides[0] % item == 0:
        return array
    return np.ascontiguousarray(array)
