"""Options of calls, as the extension module takes them. docs/options.md lists all."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from . import _raymap
from ._arguments import to_box, to_float, to_length, to_names, to_plane, to_text, to_threads, to_vector, to_whole, to_wholes
from ._arrays import to_numpy
from ._devices import tested
from ._errors import UsageError
from ._records import FieldArray

_KINDS = _raymap.option_kinds()
_TAKE_NONE = _raymap.options_that_take_none()


def core_options(given: Mapping[str, Any] | None = None, **more: Any) -> _raymap.Options:
    """Returns options by name. None stands for none, where an option has that. The library checks the values.

    Raises:
        TypeError: A value of another type.
        UsageError: A value that makes no sense for its option.
    """
    options = _raymap.Options()
    for name, value in ({**given, **more} if given else more).items():
        if value is None and name in _TAKE_NONE:
            continue
        form = _FORMS.get(name) or _BY_KIND[_KINDS[name]]
        options.set(name, form(name, value))
    return options


def check_names(function: str, given: Mapping[str, Any], known: type) -> None:
    """Refuses unknown names of arguments."""
    if unknown := given.keys() - known.__annotations__.keys():
        raise TypeError(f"{function}() got an unexpected keyword argument {sorted(unknown)[0]!r}")


def array_options(arrays: Iterable[str]) -> dict[str, bool]:
    """Returns the options that ask for arrays besides the distance."""
    names = to_names(arrays, get_args(FieldArray))
    return dict.fromkeys(names - {"distance"}, True)


def _to_offsets(name: str, offsets: npt.ArrayLike) -> list[float]:
    array = to_numpy(name, offsets)
    if array.ndim != 2 or array.shape[1] != 3 or array.shape[0] == 0 or array.dtype.kind not in "iu":
        raise UsageError(f"offsets must be (n, 3) whole numbers, not {array.dtype} of the shape {array.shape}")
    if np.abs(array.astype(np.float64)).max() >= 2**31:
        raise UsageError("offsets must be whole numbers of 32 bits")
    return np.ravel(array).astype(np.float64).tolist()


def _to_plane(name: str, plane: Any) -> list[float]:
    normal, offset = to_plane(name, plane)
    return [*normal, offset]


def _flat(name: str, numbers: Any) -> list[float]:
    return [to_float(name, number) for number in np.ravel(numbers)]


# Checks of the types of values by their kind, in the order of raymap::OptionKind. The library checks ranges.
_BY_KIND: tuple[Callable[[str, Any], Any], ...] = (
    lambda name, value: bool(value),
    lambda name, value: to_whole(name, value, least=-(2**63), most=2**64 - 1),
    to_float,
    to_text,
    to_text,
    _flat,
)

# Values that Python writes in another way, or where None takes the place of 0.
_FORMS: dict[str, Callable[[str, Any], Any]] = {
    **dict.fromkeys(("down", "direction", "up", "eye"), to_vector),
    **dict.fromkeys(("bounds", "frame"), lambda name, value: np.ravel(to_box(name, value)).tolist()),
    **dict.fromkeys(("cut_plane", "slice_plane"), _to_plane),
    **dict.fromkeys(("voxel_size", "thickness", "step"), to_length),
    "shape": lambda name, value: to_wholes(name, value, least=1),
    "offsets": _to_offsets,
    "triangles": lambda name, value: to_whole(name, value, least=1),
    "device": lambda name, value: tested(to_text(name, value)),
    "threads": lambda name, value: to_threads(value),
    "memory_limit": lambda name, value: to_whole(name, value, least=1, most=2**64 - 1),
}
