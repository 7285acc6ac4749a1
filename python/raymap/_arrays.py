"""Turns arrays of any framework into what the extension module takes, and results back into arrays of the framework."""

from __future__ import annotations

import numbers
import sys
from collections.abc import Sequence
from decimal import Decimal
from typing import Any, Literal, TypeAlias, TypedDict

import numpy as np
import numpy.typing as npt

from ._errors import InputError, UsageError

#: Points that get NumPy's arrays back. Arrays of other frameworks get their own.
Points: TypeAlias = npt.NDArray[Any] | Sequence[Any]
Singles: TypeAlias = npt.NDArray[np.float32]
Doubles: TypeAlias = npt.NDArray[np.float64]
Indices: TypeAlias = npt.NDArray[np.uint32]


class SampleOptions(TypedDict, total=False):
    """Keyword arguments of what samples a field."""

    outside: Literal["bound", "nan"]
    threads: int | None


def to_numpy(name: str, array: Any, instead: str = "") -> npt.NDArray[Any]:
    """Returns any array as NumPy's, in host memory, without a copy where possible.

    Args:
        name: What to call it in errors.
        array: An array of any framework, numbers, or lists of them. NumPy's arrays of objects become float64, shorter
            floats of other frameworks float32.
        instead: The function that follows gradients.

    Raises:
        UsageError: A framework follows its gradient, which would be lost.
        InputError: Rows of different lengths, or objects that are no numbers.
    """
    if not isinstance(array, np.ndarray):
        array = _host_array(name, array, instead)
    return _of_numbers(name, array) if array.dtype.kind in "OV" and array.ndim > 0 else array


def _host_array(name: str, array: Any, instead: str) -> npt.NDArray[Any]:
    if not hasattr(array, "__dlpack__"):
        try:
            return np.asarray(array)
        except ValueError as error:  # NumPy's text names no argument.
            if "inhomogeneous" not in str(error):
                raise
            raise InputError(f"{name} must be rows of the same length: {_ragged(array)}") from None
    check_gradient(name, array, instead)
    if hasattr(array, "detach"):  # PyTorch exports nothing that is part of a graph.
        array = array.detach()
    if hasattr(array, "cpu"):  # PyTorch and Open3D
        array = array.cpu()
    elif hasattr(array, "get"):  # CuPy
        array = array.get()
    if hasattr(array, "numpy"):
        if any(name in str(getattr(array, "dtype", "")) for name in ("bfloat16", "float8")):  # NumPy has no such types.
            array = array.float()
        return np.asarray(array.numpy())
    return np.asarray(array) if hasattr(array, "__array__") else np.from_dlpack(array)


def check_gradient(name: str, array: Any, instead: str) -> None:
    """Raises UsageError if the result would have no gradient although PyTorch or JAX follows one."""
    torch, jax = sys.modules.get("torch"), sys.modules.get("jax")
    if torch is not None and isinstance(array, torch.Tensor):
        is_dual = torch.autograd.forward_ad.unpack_dual(array).tangent is not None
        if is_dual or (array.requires_grad and torch.is_grad_enabled()):
            use = f"use raymap.torch.{instead}, or" if instead else "give"
            raise UsageError(f"{name} require gradients, which this function would drop: {use} {name}.detach()")
    elif jax is not None and isinstance(array, jax.core.Tracer):
        use = f"; use raymap.jax.{instead}" if instead else ""
        raise UsageError(f"{name} must be an array, but are traced by a transformation of JAX{use}")


def _ragged(rows: Any) -> str:
    """Says which row of lists has another length than the first."""
    sizes = [np.size(row) for row in rows] if all(np.ndim(row) <= 1 for row in rows) else []
    odd = next((k for k, size in enumerate(sizes) if size != sizes[0]), None)
    return "they are ragged" if odd is None else f"row {odd} has {sizes[odd]} numbers, row 0 has {sizes[0]}"


def _of_numbers(name: str, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns objects and short floats, which are no types of NumPy, as numbers."""
    if array.dtype.kind == "V":
        return array.astype(np.float32) if "float" in array.dtype.name else array
    for index, value in np.ndenumerate(array):
        if not isinstance(value, (numbers.Real, Decimal)):
            at = ", ".join(map(str, index))
            raise InputError(f"{name} must be numbers, but [{at}] is {'None' if value is None else type(value).__name__}")
    return array.astype(np.float64)


def still(array: Any) -> Any:
    """Returns an array without its gradient, for results that have none."""
    return array.detach() if hasattr(array, "detach") else array


def like(result: npt.NDArray[Any], example: Any) -> Any:
    """Returns the result in the framework of the example and on its device; as NumPy's array for anything else.

    Real numbers of other frameworks are no longer than those of the example, if that has real numbers. PyTorch gets
    indices as int64: it indexes with no unsigned numbers.
    """
    if isinstance(example, np.ndarray) or not hasattr(example, "__dlpack__"):
        return result
    torch: Any = sys.modules.get("torch")
    if torch is not None and isinstance(example, torch.Tensor):
        made = torch.from_numpy(result.astype(np.int64) if result.dtype == np.uint32 else result).to(example.device)
        is_long = result.dtype.kind == "f" and example.is_floating_point() and example.itemsize < made.itemsize
        return made.to(example.dtype) if is_long else made
    if hasattr(example, "__array_namespace__"):
        space, kind = example.__array_namespace__(), getattr(example, "dtype", result.dtype)
        made = space.asarray(result, device=example.device)
        is_long = result.dtype.kind == "f" and kind.itemsize < result.dtype.itemsize
        return made.astype(kind) if is_long and space.isdtype(kind, "real floating") else made
    return result


def to_points(points: Any, instead: str = "", *, keep_single: bool = False) -> tuple[npt.NDArray[Any], tuple[int, ...]]:
    """Returns points of any shape (..., 3) as (n, 3) float64, or on request float32 as float32; and their shape.

    An empty list has the shape (0, 3). ``instead`` is the function that follows gradients.
    """
    array = to_numpy("points", points, instead)
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
    single = result.dtype == np.float64 and to_numpy("points", still(points)).dtype == np.float32
    with np.errstate(over="ignore"):
        return np.asarray(result, np.float32 if single else None)


def to_poses(name: str, poses: Any, shape: tuple[int, ...], *, many: bool = False) -> npt.NDArray[np.float64]:
    """Returns poses of this shape as float64; on request also those of many configurations, with an axis before.

    Raises:
        InputError: Poses of another shape, or no numbers.
    """
    array = to_numpy(name, poses)
    if array.shape != shape and not (many and array.ndim == len(shape) + 1 and array.shape[1:] == shape):
        sizes = ", ".join(map(str, shape))
        text = f"({sizes}) or (configurations, {sizes})" if many else f"({sizes})"
        raise InputError(f"{name} must be {text} numbers, not of the shape {array.shape}")
    if array.dtype.kind not in "fiub":
        raise InputError(f"{name} must be numbers, not {array.dtype}")
    return np.ascontiguousarray(array, np.float64)
