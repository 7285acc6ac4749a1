"""A real Dask cluster on this machine: a scheduler and workers that are processes of their own and talk over TCP."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from types import TracebackType
from typing import NamedTuple

from held_mesh import wait_for


class Cluster:
    """A scheduler and workers with one thread each. They end with the `with` statement, and so do their children."""

    def __init__(self, folder: Path, workers: int, memory_limit: str = "auto") -> None:
        folder.mkdir(parents=True)
        self._folder = folder
        self.scheduler = self._start("scheduler", "--port", "0", "--host", "tcp://127.0.0.1")
        options = ("--no-nanny", "--nthreads", "1", "--memory-limit", memory_limit)
        self.workers = [self._start("worker", *options, "--name", f"w{k}") for k in range(workers)]

    def _start(self, what: str, *options: str) -> subprocess.Popen[bytes]:
        file = self._folder / "scheduler.json"
        if what == "worker":
            wait_for(lambda: self._address)
            options = (*options, "--local-directory", str(self._folder))
        with open(self._folder / "log.txt", "ab") as log:
            return subprocess.Popen(
                [sys.executable, "-m", f"distributed.cli.dask_{what}", "--scheduler-file", str(file), "--no-dashboard",
                 *options],
                stdout=log,
                stderr=log,
                start_new_session=True,
                cwd=self._folder,  # Workers find no file by the name that the caller gives it.
            )

    @property
    def _address(self) -> str | None:
        """Address of the scheduler, or None if it has not written it yet."""
        try:
            return str(json.loads((self._folder / "scheduler.json").read_text())["address"])
        except (OSError, ValueError):
            return None

    @property
    def address(self) -> str:
        """Address of the scheduler, tcp://..."""
        wait_for(lambda: self._address)
        assert self._address
        return self._address

    def __enter__(self) -> Cluster:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in *self.workers, self.scheduler:
            process.kill()
            process.wait()
        sessions = {process.pid for process in self.workers}
        wait_for(lambda: not any(is_running(pid) and _status(pid).session in sessions for pid in _processes()))


class _Status(NamedTuple):
    """State (a letter), parent and session of a process."""

    state: str
    parent: int
    session: int


def _status(pid: int) -> _Status:
    """Returns the status of a process. One that has ended and that nobody waits for has no parent."""
    try:
        state, parent, _, session = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[:4]
    except OSError:
        return _Status("Z", 0, 0)
    return _Status(state, int(parent), int(session))


def _processes() -> list[int]:
    return [int(folder.name) for folder in Path("/proc").glob("[0-9]*")]


def is_running(pid: int) -> bool:
    return _status(pid).state not in "ZX"


def parent_of(pid: int) -> int:
    return _status(pid).parent
