"""A real Dask cluster on this machine: a scheduler and workers that are processes of their own and talk over TCP."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from types import TracebackType

from held_mesh import wait_for


class Cluster:
    """A scheduler and workers with one thread each. They end with the `with` statement."""

    def __init__(self, folder: Path, workers: int) -> None:
        folder.mkdir(parents=True)
        self._folder = folder
        self.scheduler = self._start("scheduler", "--port", "0", "--host", "tcp://127.0.0.1")
        options = ("--no-nanny", "--nthreads", "1")
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
                env={**os.environ, "DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "5"},
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


def _state_and_parent(pid: int) -> tuple[str, int]:
    """Returns a letter and the parent's number. A process that has ended and that nobody waits for has none."""
    try:
        state, parent = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[:2]
    except OSError:
        return "Z", 0
    return state, int(parent)


def is_running(pid: int) -> bool:
    return _state_and_parent(pid)[0] not in "ZX"


def parent_of(pid: int) -> int:
    return _state_and_parent(pid)[1]
