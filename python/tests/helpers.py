"""Functions and classes that several tests use."""

from __future__ import annotations

import importlib
import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from types import ModuleType

import numpy as np
import pytest


def load(name: str) -> ModuleType:
    """Imports a package. Skips the test without it, unless RAYMAP_REQUIRE_PYTHON_PACKAGES is set."""
    if os.environ.get("RAYMAP_REQUIRE_PYTHON_PACKAGES"):
        return importlib.import_module(name)
    return pytest.importorskip(name, exc_type=ImportError)


class Exporter:
    """An array that only knows DLPack."""

    def __init__(self, array: np.ndarray) -> None:
        self.array, self.shape = array, array.shape

    def __dlpack__(self, **options) -> object:
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self) -> tuple[int, int]:
        return self.array.__dlpack_device__()


def right_in_threads(check: Callable[[int], bool]) -> bool:
    """Calls a function five times in each of four threads at once, with the number of the thread."""
    with ThreadPoolExecutor(4) as pool:
        return all(pool.map(lambda k: all(check(k) for _ in range(5)), range(4)))


@contextmanager
def interrupted() -> Iterator[Callable[[str, float], None]]:
    """Expects KeyboardInterrupt. Yields a progress callable that interrupts the work at its first report."""
    reports: list[str] = []

    def progress(stage: str, done: float) -> None:
        reports.append(stage)
        signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        yield progress
    assert len(reports) == 1
