"""Options of calls, as the extension module takes them. docs/options.md lists all."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, get_args

import numpy as np
import numpy.typing as npt

from . import _raymap
from ._arguments import to_box, to_length, to_names, to_plane, to_text, to_threads, to_vector, to_whole, to_wholes
from ._arrays import to_numpy
from ._devices import tested
from ._errors import UsageError
from ._records import FieldArray


_TAKE_NONE = _raymap.options_that_take_none()


def core_options(given: Mapping[str, Any] | None = None, **more: Any) -> _raymap.Options:
    """Returns options by name. None stands for none, where an option has that. The library checks the values.

    Raises:
        TypeError: A value of another type.
        UsageError: A value that makes no sense for its option, or no such option.
    """
    options = _raymap.Options()
    for name, value in ({**given, **more} if given else more).items():
        if value is None and name in _TAKE_NONE:
            continue
        options.set(name, _FORMS[name](name, value) if name in _FORMS and value is not None else value)
    return options


def check_names(function: str, given: Mapping[str, Any], known: type) -> None:
    """Refuses unknown names of arguments."""
    if unknown := given.keys() - known.__annotations__.keys():
        raise TypeError(f"{function}() got an unexpected keyword argument {sorted(unknown)[0]!r}")


def array_options(arrays: Iterable[str]) -> dict[str, bool]:
    """Returns the options that ask for arrays besides the distance."""
    names = to_names(arrays, get_args(FieldArray))
    return dict.fromkeys(names - {"distance"}, True)


def _to_offsets(name: str, offsets: npt.ArrayLike) -> list[list[int]]:
    array = to_numpy(name, offsets)
    if array.ndim != 2 or array.shape[1] != 3 or array.shape[0] == 0 or array.dtype.kind not in "iu":
        raise UsageError(f"offsets must be (n, 3) whole numbers, not {array.dtype} of the shape {array.shape}")
    if np.abs(array.astype(np.float64)).max() >= 2**31:
        raise UsageError("offsets must be whole numbers of 32 bits")
    return array.tolist()  # type: ignore[no-any-return]


# Values that Python writes in another way, or where None takes the place of 0.
_FORMS: dict[str, Callable[[str, Any], Any]] = {
    **dict.fromkeys(("down", "direction", "up", "eye"), to_vector),
    **dict.fromkeys(("bounds", "frame"), to_box),
    **dict.fromkeys(("cut_plane", "slice_plane"), to_plane),
    **dict.fromkeys(("voxel_size", "thickness", "step"), to_length),
    "shape": lambda name, value: to_wholes(name, value, least=1),
    "offsets": _to_offsets,
    "triangles": lambda name, value: to_whole(name, value, least=1),
    "device": lambda name, value: tested(to_text(name, value)),
    "threads": lambda name, value: to_threads(value),
    "memory_limit": lambda name, value: to_whole(name, value, least=1, most=2**64 - 1),
}
