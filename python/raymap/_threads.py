"""Number of CPU threads of calls that do not say one."""

from __future__ import annotations

import operator

from . import _raymap
from ._errors import UsageError


def set_threads(threads: int | None) -> None:
    """Sets how many CPU threads all calls of this process use whose ``threads`` is None.

    For one process of many, such as a worker of a data loader.

    Args:
        threads: Number of CPU threads; None = all.

    Raises:
        UsageError: The number is below 1.

    >>> raymap.set_threads(1)
    >>> raymap.get_threads()
    1
    >>> raymap.set_threads(None)
    """
    if threads is not None and operator.index(threads) < 1:
        raise UsageError(f"threads must be 1 or more, or None for all, not {threads}")
    _raymap.set_threads(0 if threads is None else operator.index(threads))


def get_threads() -> int | None:
    """Returns the number that ``set_threads`` set last, else that of the environment variable ``RAYMAP_THREADS``.

    None = all.

    Raises:
        UsageError: The variable holds something else than a number.
    """
    return _raymap.get_threads() or None
