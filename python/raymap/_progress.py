"""Progress of long calls."""

from __future__ import annotations

import importlib
import json
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from typing import Any, Literal, TypeAlias

from ._html import in_notebook

#: A callable that receives the stage and the share of it that is done, 0 to 1. ``True``: a bar in a notebook, a moving
#: line on a terminal, else a line a minute on stderr. ``"plain"``: a line a minute. ``"json"``: an object a line.
Progress: TypeAlias = Callable[[str, float], object] | Literal["plain", "json"] | bool | None

_QUIET_SECONDS = 1.0
_now = time.monotonic


class _Shown:
    """Progress that is shown after a pause, and then after each further pause."""

    def __init__(self, pause: float) -> None:
        self._pause = pause
        self._start = _now()
        self._next = self._start + pause

    def __call__(self, stage: str, done: float) -> None:
        if (now := _now()) >= self._next:
            self._next = now + self._pause
            self.show(stage, done, now - self._start)

    def show(self, stage: str, done: float, seconds: float) -> None:
        """Shows the stage. The seconds count from the start of the call."""
        raise NotImplementedError

    def clear(self) -> None:
        """Removes what is shown, if it can be."""


class _Plain(_Shown):
    """A line a minute."""

    def __init__(self) -> None:
        super().__init__(60.0)

    def show(self, stage: str, done: float, seconds: float) -> None:
        _write(f"raymap: {seconds:.0f} s: {stage} {100 * done:.0f} %\n")


class _Json(_Shown):
    """An object a line, as each stage begins and every second."""

    def __init__(self) -> None:
        super().__init__(1.0)
        self._stage = ""

    def __call__(self, stage: str, done: float) -> None:
        if stage != self._stage:
            self._stage = stage
            self._next = _now()
        super().__call__(stage, done)

    def show(self, stage: str, done: float, seconds: float) -> None:
        _write(json.dumps({"stage": stage.removesuffix(","), "done": round(done, 3), "seconds": round(seconds, 2)}) + "\n")


class _Moving(_Shown):
    """A line that changes."""

    def __init__(self) -> None:
        super().__init__(0.0)
        self._next += _QUIET_SECONDS
        self._shown = False

    def show(self, stage: str, done: float, seconds: float) -> None:
        _write(f"\r\033[K  {stage} {100 * done:3.0f} %")
        self._shown = True

    def clear(self) -> None:
        if self._shown:
            _write("\r\033[K")


class _Bar(_Shown):
    """A bar in a notebook, which IPython displays."""

    def __init__(self, display: Callable[..., Any]) -> None:
        super().__init__(0.0)
        self._next += _QUIET_SECONDS
        self._display = display
        self._handle: Any = None

    def show(self, stage: str, done: float, seconds: float) -> None:
        text = f"{stage} {100 * done:.0f} %"
        self._put({"text/plain": text, "text/html": f"<progress value='{done:.3f}'></progress> {escape(text)}"})

    def clear(self) -> None:
        if self._handle is not None:
            self._put({"text/plain": "", "text/html": ""})

    def _put(self, content: dict[str, str]) -> None:
        if self._handle is None:
            self._handle = self._display(content, raw=True, display_id=True)
        else:
            self._handle.update(content, raw=True)


def pace_text(new: int, left: int, start: float) -> str:
    """Returns how fast a run is that has made ``new`` things since ``start``, and about how long the rest takes."""
    if new == 0:
        return ""
    rate = new / max(_now() - start, 1e-9)
    return f", {rate:.2g} per second, {_duration(left / rate)} left,"


def _duration(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _write(text: str) -> None:
    sys.stderr.write(text)
    sys.stderr.flush()


def _shown(progress: Literal["plain", "json", True]) -> _Shown:
    if progress == "json":
        return _Json()
    if progress == "plain":
        return _Plain()
    if in_notebook():
        return _Bar(importlib.import_module("IPython.display").display)
    return _Moving() if sys.stderr.isatty() else _Plain()


@contextmanager
def reporting(progress: Progress) -> Iterator[Callable[[str, float], object] | None]:
    """Yields what the extension module calls: the callable, what shows the progress, or None."""
    if progress is None or progress is False:
        yield None
    elif progress is True or progress == "plain" or progress == "json":
        shown = _shown(progress)
        try:
            yield shown
        finally:
            shown.clear()
    elif not callable(progress):
        kind = repr(progress) if isinstance(progress, str) else type(progress).__name__
        raise TypeError(f'progress must be a callable, True, "plain", "json" or None, not {kind}')
    else:
        yield progress
