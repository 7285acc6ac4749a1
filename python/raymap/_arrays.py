"""Turns arrays of any framework into what the extension module takes, and results back into arrays of the framework."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import Any, Literal, TypeAlias, TypedDict

import numpy as np
import numpy.typing as npt

from ._errors import InputError

#: Points that get NumPy's arrays back. Arrays of other frameworks get their own.
Points: TypeAlias = npt.NDArray[Any] | Sequence[Any]
Singles: TypeAlias = npt.NDArray[np.float32]
Doubles: TypeAlias = npt.NDArray[np.float64]
Indices: TypeAlias = npt.NDArray[np.uint32]


class SampleOptions(TypedDict, total=False):
    """Keyword arguments of what samples a field."""

    outside: Literal["bound", "nan"]
    threads: int | None


#: What to do for those who give points in place of faces.
POINTS_HINT = "for distances at points, use raymap.signed_distance(mesh, points), or raymap.Surface for several calls"


def to_numpy(array: Any) -> npt.NDArray[Any]:
    """Returns any array as NumPy's, in host memory, without a copy where possible."""
    if isinstance(array, np.ndarray) or not hasattr(array, "__dlpack__"):
        return np.asarray(array)
    if hasattr(array, "detach"):  # PyTorch exports nothing that is part of a graph.
        array = array.detach()
    if hasattr(array, "cpu"):  # PyTorch and Open3D
        array = array.cpu()
    elif hasattr(array, "get"):  # CuPy
        array = array.get()
    if hasattr(array, "numpy"):
        return np.asarray(array.numpy())
    return np.asarray(array) if hasattr(array, "__array__") else np.from_dlpack(array)


def like(result: npt.NDArray[Any], example: Any) -> Any:
    """Returns the result in the framework of the example and on its device; as NumPy's array for anything else.

    PyTorch gets indices as int64: it indexes with no unsigned numbers.
    """
    if isinstance(example, np.ndarray) or not hasattr(example, "__dlpack__"):
        return result
    torch: Any = sys.modules.get("torch")
    if torch is not None and isinstance(example, torch.Tensor):
        return torch.from_numpy(result.astype(np.int64) if result.dtype == np.uint32 else result).to(example.device)
    if hasattr(example, "__array_namespace__"):
        return example.__array_namespace__().asarray(result, device=example.device)
    return result


def checked_arrays(vertices: Any, faces: Any) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Returns vertices as float32 or float64 and faces as uint32 or uint64, laid out as the extension reads them."""
    positions, corners = to_numpy(vertices), to_numpy(faces)
    _check_rows("vertices", "positions", positions)
    _check_rows("faces", "vertex numbers", corners)
    if positions.dtype not in (np.float32, np.float64) or not positions.dtype.isnative:
        if positions.dtype.kind not in "fiub":
            raise InputError(f"vertices must be numbers, not {positions.dtype}")
        positions = positions.astype(np.float64)
    if corners.dtype.kind not in "iu":
        hint = f"; {POINTS_HINT}" if corners.dtype.kind == "f" else ""
        raise InputError(f"faces must be whole numbers, not {corners.dtype}{hint}")
    if corners.dtype.kind == "i" and corners.size > 0 and corners.min() < 0:
        face = int(np.argmax((corners < 0).any(axis=1)))
        raise InputError(f"face {face} has a negative vertex number: {corners[face].tolist()}")
    size = 8 if corners.dtype.itemsize == 8 else 4
    if corners.dtype.itemsize == size and corners.dtype.isnative:
        corners = corners.view(f"u{size}")
    else:
        corners = corners.astype(f"u{size}")
    return _with_whole_rows(positions), _with_whole_rows(corners)


def _check_rows(name: str, content: str, array: npt.NDArray[Any]) -> None:
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{name} must be (n, 3) {content}, not of the shape {array.shape}")


def _with_whole_rows(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns an array whose rows ascend in memory without overlap, and have no gaps in them. Copies if need be."""
    item = array.dtype.itemsize
    if array.strides[1] == item and array.strides[0] >= 3 * item and array.strides[0] % item == 0:
        return array
    return np.ascontiguousarray(array)


def to_points(points: Any, *, keep_single: bool = False) -> tuple[npt.NDArray[Any], tuple[int, ...]]:
    """Returns points of any shape (..., 3) as (n, 3) float64, or on request float32 as float32; and their shape.

    An empty list has the shape (0, 3).
    """
    array = to_numpy(points)
    if array.shape == (0,):
        array = array.reshape(0, 3)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise InputError(f"points must be (..., 3) coordinates, not of the shape {array.shape}")
    if array.dtype.kind not in "fiub":
        raise InputError(f"points must be numbers, not {array.dtype}")
    dtype = np.float32 if keep_single and array.dtype == np.float32 else np.float64
    return np.ascontiguousarray(array.reshape(-1, 3), dtype=dtype), array.shape


def as_precise(result: Any, points: Any) -> npt.NDArray[Any]:
    """Returns a result of float64 as float32 if the points are float32, else as it is."""
    single = result.dtype == np.float64 and to_numpy(points).dtype == np.float32
    return np.asarray(result, np.float32 if single else None)


def to_poses(name: str, poses: Any, shape: tuple[int, ...]) -> npt.NDArray[np.float64]:
    """Returns poses as (n, 4, 4) float64. ``shape`` is what they must have; -1 is any number of configurations.

    Raises:
        InputError: Poses of another shape, or no numbers.
    """
    array = to_numpy(poses)
    free = shape[0] < 0 and array.ndim == len(shape)
    if array.shape != (array.shape[:1] + shape[1:] if free else shape):
        text = ", ".join("configurations" if length < 0 else str(length) for length in shape)
        raise InputError(f"{name} must be ({text}) numbers, not of the shape {array.shape}")
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} must be numbers, not {array.dtype}")
    return np.ascontiguousarray(array, np.float64).reshape(-1, 4, 4)
