"""Memory of the process."""

from __future__ import annotations

from . import _raymap
from ._arguments import to_whole


def limit_memory(bytes: int | None, *, strict: bool = False) -> None:
    """Bounds what this process may hold: Python itself, meshes, fields, and all that Raymap makes of them.

    Work that would exceed the bound raises ``MemoryLimitError`` before it begins. ``memory_limit`` bounds a single call
    in addition.

    Args:
        bytes: Most bytes; None = no bound.
        strict: Also make every allocation beyond the bound fail, those of other packages too. Holds until a GPU's
            driver is loaded, as drivers map far more than they use.

    Raises:
        UsageError: The bound is below 1.

    >>> raymap.limit_memory(4 << 30)
    >>> raymap.limit_memory(None)
    """
    _raymap.limit_memory(0 if bytes is None else to_whole("bytes", bytes, least=1, most=2**63 - 1), bool(strict))


def memory_left() -> int:
    """Returns the number of bytes that this process can still get without swapping.

    This is the least of the system's available memory and of what ``limit_memory``, the control groups and ulimit leave.
    """
    return _raymap.memory_left()
