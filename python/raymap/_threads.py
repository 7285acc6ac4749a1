"""Number of CPU threads of calls that do not say one."""

from __future__ import annotations

from . import _raymap
from ._arguments import to_threads


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
    _raymap.set_threads(to_threads(threads))


def get_threads() -> int | None:
    """Returns the number that ``set_threads`` set last, else that of the environment variable ``RAYMAP_THREADS``.

    None = all.

    Raises:
        UsageError: The variable holds something else than a number.
    """
    return _raymap.get_threads() or None
