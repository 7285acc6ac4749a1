"""Checks arguments, and names them where they are wrong."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import UsageError

Vector = tuple[float, float, float]
Whole3 = tuple[int, int, int]

#: Largest finite number.
FINITE = float(np.finfo(np.float64).max)
_MOST = 2**31 - 1


def to_float(name: str, value: Any) -> float:
    """Returns any number.

    Raises:
        TypeError: The value is no number.
    """
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError  # float() would read them.
        return float(value)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be a number, not {_shown(value)}") from None


def to_number(name: str, value: Any, *, least: float = -math.inf, above: float = -math.inf, most: float = math.inf) -> float:
    """Returns a number from ``least`` to ``most`` and above ``above``.

    Raises:
        TypeError: The value is no number.
        UsageError: It is out of range, or NaN.
    """
    number = to_float(name, value)
    if least <= number <= most and number > above:
        return number
    if most < FINITE:
        limit = f"from {least:g} to {most:g}"
    elif number > above and number >= least or max(least, above) <= -FINITE:
        limit = "finite" if most == FINITE else "a number"
    else:
        limit = f"above {above:g}" if above > -math.inf else f"{least:g} or more"
    raise UsageError(f"{name} must be {limit}, not {number:g}")


def to_length(name: str, value: Any) -> float:
    """Returns a finite number above 0."""
    return to_number(name, value, above=0.0, most=FINITE)


def to_whole(name: str, value: Any, *, least: int = 0, most: int = _MOST) -> int:
    """Returns a whole number from ``least`` to ``most``.

    Raises:
        TypeError: The value is no whole number.
        UsageError: It is out of range.
    """
    try:
        number = operator.index(value)
    except TypeError:
        raise TypeError(f"{name} must be a whole number, not {_shown(value)}") from None
    if number < least:
        raise UsageError(f"{name} must be {least} or more, not {number}")
    if number > most:
        raise UsageError(f"{name} must be {most} or less, not {number}")
    return number


def to_text(name: str, value: Any) -> str:
    """Returns a text.

    Raises:
        TypeError: The value is something else.
    """
    if not isinstance(value, str):
        raise TypeError(f"{name} must be a text, not {_shown(value)}")
    return value


def to_path(path: Any) -> str:
    """Returns the name of a file; ``~`` at its begin is the home of the user, as in a shell.

    Raises:
        TypeError: The value is no path.
    """
    return os.path.expanduser(os.fsdecode(path))


def to_threads(threads: Any) -> int:
    """Returns a number of threads as the extension module takes it: 0 for None."""
    return 0 if threads is None else to_whole("threads", threads, least=1, most=2**63 - 1)


def to_vector(name: str, vector: Any) -> Vector:
    """Returns three finite numbers."""
    x, y, z = _numbers(name, vector, (3,), "(x, y, z)").tolist()
    return x, y, z


def to_wholes(name: str, numbers: Any, *, least: int = 0) -> Whole3:
    """Returns three whole numbers from ``least`` on.

    Raises:
        TypeError: They are no whole numbers.
        UsageError: One is out of range, or there are not three.
    """
    try:
        given = list(numbers)
    except TypeError:
        raise TypeError(f"{name} must be whole numbers (x, y, z), not {_shown(numbers)}") from None
    if len(given) != 3:
        raise UsageError(f"{name} must be whole numbers (x, y, z), not {len(given)} numbers")
    x, y, z = (to_whole(name, number, least=least) for number in given)
    return x, y, z


def to_plane(name: str, plane: Any) -> tuple[Vector, float]:
    """Returns the normal and the offset of a plane."""
    x, y, z, offset = _numbers(name, plane, (4,), "(nx, ny, nz, offset)").tolist()
    return (x, y, z), offset


def to_box(name: str, corners: npt.ArrayLike) -> tuple[Vector, Vector]:
    """Returns a box, whose sides may be 0."""
    low, high = _numbers(name, corners, (2, 3), "((x0, y0, z0), (x1, y1, z1))")
    if not (low <= high).all():
        raise UsageError(f"{name}: each of x0, y0, z0 must be less than its x1, y1, z1")
    return to_vector(name, low), to_vector(name, high)


def to_names(arrays: Iterable[str], known: Iterable[str]) -> set[str]:
    """Returns names of arrays: one text, or several.

    Raises:
        UsageError: One is not known.
    """
    names = {arrays} if isinstance(arrays, str) else set(arrays)
    if unknown := names - set(known):
        raise UsageError(f"arrays: nothing is named {sorted(unknown)[0]!r}; there are {', '.join(known)}")
    return names


def _numbers(name: str, given: Any, shape: tuple[int, ...], wanted: str) -> npt.NDArray[np.float64]:
    try:
        array = np.asarray(given, np.float64)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be numbers {wanted}, not {_shown(given)}") from None
    if array.shape != shape:
        raise UsageError(f"{name} must be {wanted}, not of the shape {array.shape}")
    if not np.isfinite(array).all():
        raise UsageError(f"{name} must be finite, not {array.tolist()}")
    return array


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 40 else f"a {type(value).__name__}"
