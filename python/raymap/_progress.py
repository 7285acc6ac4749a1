"""Progress of long calls."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TypeAlias

#: A callable that receives the stage and the share of it that is done, 0 to 1. ``True``: a line on stderr.
Progress: TypeAlias = Callable[[str, float], object] | bool | None

_QUIET_SECONDS = 1.0


class _Line:
    """A line on stderr that appears after a second."""

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._shown = False

    def __call__(self, stage: str, done: float) -> None:
        if time.monotonic() - self._start >= _QUIET_SECONDS:
            sys.stderr.write(f"\r\033[K  {stage} {100 * done:3.0f} %")
            sys.stderr.flush()
            self._shown = True

    def clear(self) -> None:
        if self._shown:
            sys.stderr.write("\r\033[K")
            sys.stderr.flush()


@contextmanager
def reporting(progress: Progress) -> Iterator[Callable[[str, float], object] | None]:
    """Yields what the extension module calls: the callable, a line on a terminal, or None."""
    if progress is None or progress is False:
        yield None
    elif progress is not True:
        if not callable(progress):
            raise TypeError(f"progress must be a callable, True or None, not {type(progress).__name__}")
        yield progress
    elif not sys.stderr.isatty():
        yield None
    else:
        line = _Line()
        try:
            yield line
        finally:
            line.clear()
