"""A mesh whose readers wait for the test, so that no test depends on how long work takes."""

from __future__ import annotations

import os
import time
from collections.abc import Callable
from pathlib import Path

PAUSE = 0.01  # Seconds between two looks


class HeldMesh:
    """A named pipe in the place of a mesh. Who opens it waits until the test gives the content.

    A data set reads a mesh twice: first for its hash, then in the process that makes the result.
    """

    def __init__(self, path: Path, content: bytes) -> None:
        self.path, self._content = path, content
        self._writing: int | None = None
        os.mkfifo(path)

    def wait_for_reader(self, other_than: int = 0) -> int:
        """Waits until another process has opened the file. Returns it. It waits for the content from now on."""
        if self._writing is None:
            self._writing = os.open(self.path, os.O_WRONLY)  # Waits for a reader, which may not be in /proc yet.
        while not (found := self._readers() - {other_than}):
            time.sleep(PAUSE)
        return found.pop()

    def give(self) -> int:
        """Waits for a reader, and gives it the content. Returns its process once it has closed the file."""
        reader = self.wait_for_reader()
        assert self._writing is not None
        left = memoryview(self._content)
        while left:
            left = left[os.write(self._writing, left) :]
        os.close(self._writing)
        self._writing = None
        wait_for(lambda: not self._readers())
        return reader

    def let_go(self) -> None:
        """Puts an ordinary file in the place of the pipe. Whoever waits for the pipe finds it empty."""
        pipe = os.open(self.path, os.O_RDWR)  # Waits for nobody.
        beside = self.path.with_name(f"{self.path.name}.new")
        beside.write_bytes(self._content)
        beside.replace(self.path)
        os.close(pipe)
        if self._writing is not None:
            os.close(self._writing)
            self._writing = None

    def _readers(self) -> set[int]:
        """Returns the processes that have the pipe open for reading."""
        descriptors = (place for process in Path("/proc").glob("[0-9]*") for place in entries(process / "fd"))
        return {int(place.parts[2]) for place in descriptors if self._is_read_by(place)}

    def _is_read_by(self, descriptor: Path) -> bool:
        try:
            if os.readlink(descriptor) != str(self.path):
                return False
            flags = (descriptor.parents[1] / "fdinfo" / descriptor.name).read_text().split("flags:")[1].split()[0]
        except OSError:  # It was closed meanwhile.
            return False
        return int(flags, 8) & os.O_ACCMODE == os.O_RDONLY


def entries(folder: Path) -> list[Path]:
    """Returns what is in a folder; nothing if it is gone."""
    try:
        return list(folder.iterdir())
    except OSError:
        return []


def wait_for(condition: Callable[[], object]) -> None:
    """Waits without a limit: how long a machine takes says nothing. ctest ends what hangs."""
    while not condition():
        time.sleep(PAUSE)
