"""A real Dask cluster on this machine: a scheduler and workers that are processes of their own and talk over TCP."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType


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
            while not file.exists():
                time.sleep(0.05)
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
    def address(self) -> str:
        """Address of the scheduler, tcp://..."""
        return str(json.loads((self._folder / "scheduler.json").read_text())["address"])

    def __enter__(self) -> Cluster:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for process in *self.workers, self.scheduler:
            process.kill()
            process.wait()


def children_of(pid: int) -> list[int]:
    """Returns the processes that a process has started and that still run."""
    found: list[int] = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                state, parent = (entry / "stat").read_text().rpartition(")")[2].split()[:2]
            except OSError:
                continue
            if int(parent) == pid and state != "Z":
                found.append(int(entry.name))
    return found
