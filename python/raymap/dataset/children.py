"""Child processes that make the results of a data set: one mesh at a time, many meshes one after the other."""

from __future__ import annotations

import json
import math
import os
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

from .._errors import Cancelled, Error, make_error

_LONGEST_WAIT = 1e6  # Seconds; more does not fit into what the system call takes.
_LONGEST_LOG = 1 << 16  # Bytes


class Failure(NamedTuple):
    """Why a mesh has no result."""

    reason: str
    log: str
    is_machine: bool
    """Whether the machine is at fault, so that another run may succeed."""


class _Ended(Exception):
    """The process ended, or was ended, before it answered."""


class _Child:
    """A process of raymap/dataset/child.py for a device. It sees the same packages as this one."""

    def __init__(self, device: str) -> None:
        self._log = tempfile.TemporaryFile("a+b")
        path = os.pathsep.join([str(Path(__file__).parents[2]), *filter(None, sys.path)])
        self._process = subprocess.Popen(
            [sys.executable, "-m", "raymap.dataset.child", device],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._log,
            start_new_session=True,  # Ctrl-C does not reach it; importers that it starts end with it.
            env={**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"},  # Its threads would only take memory.
        )
        self.device = device
        self.is_fresh = True

    def wait_until_ready(self) -> dict[str, Any]:
        """Returns what is wrong with the device; nothing if it works. Raises _Ended."""
        return self._receive(math.inf)

    def do(self, job: dict[str, Any], time_limit: float) -> dict[str, Any]:
        """Returns the answer to a job. Raises _Ended or TimeoutError."""
        self._log.truncate(0)
        try:
            assert self._process.stdin
            self._process.stdin.write(json.dumps(job).encode() + b"\n")
            self._process.stdin.flush()
        except OSError:
            raise _Ended from None
        answer = self._receive(time_limit)
        self.is_fresh = False
        return answer

    def _receive(self, seconds: float) -> dict[str, Any]:
        assert self._process.stdout
        replies = self._process.stdout.fileno()
        poll = select.poll()
        poll.register(replies, select.POLLIN)
        deadline = time.monotonic() + seconds
        line = b""
        while not line.endswith(b"\n"):
            if not poll.poll(min(max(0.0, deadline - time.monotonic()), _LONGEST_WAIT) * 1000):
                raise TimeoutError
            part = os.read(replies, 1 << 16)
            if not part:
                raise _Ended
            line += part
        answer: dict[str, Any] = json.loads(line)
        return answer

    def kill(self) -> None:
        """Ends the process and all that it has started."""
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, signal.SIGKILL)

    def end(self) -> int:
        """Waits until the process has ended. Returns its status, below 0 the signal that ended it."""
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(1.0)  # Its output is closed; a crash may still be writing the log.
        self.kill()
        status = self._process.wait()
        for pipe in self._process.stdin, self._process.stdout:
            with suppress(OSError):
                assert pipe
                pipe.close()
        return status

    def log(self) -> str:
        """Returns the end of what the process has printed since its last job began."""
        size = self._log.seek(0, os.SEEK_END)
        self._log.seek(max(0, size - _LONGEST_LOG))
        return self._log.read().decode(errors="replace")


class Children:
    """Processes for any number of threads. Each does one job at a time and is used again."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._idle: list[_Child] = []
        self._busy: set[_Child] = set()
        self._is_closed = False

    def do(self, job: dict[str, Any], time_limit: float) -> dict[str, Any] | Failure:
        """Returns the figures of a job, or why there are none.

        A process that did other jobs may hold memory of them, or end because it had nothing to do. So what ends it, or
        lacks memory, is tried again in a fresh process. Only that matters: the result does not depend on other jobs.

        Raises:
            Error: No process can be started, the result cannot be written, or the device cannot be used.
            Cancelled: `close` was called.
        """
        device = job["options"].get("device", "cpu")
        child = self._take(device)
        was_fresh = child.is_fresh
        answer, is_final = self._ask(child, job, time_limit)
        if not is_final and not was_fresh:
            answer, _ = self._ask(self._start(device), job, time_limit)
        if self._is_closed:
            raise Cancelled("stopped")
        return answer

    def _ask(self, child: _Child, job: dict[str, Any], time_limit: float) -> tuple[dict[str, Any] | Failure, bool]:
        """Returns the answer, and whether a fresh process would give the same."""
        try:
            answer = child.do(job, time_limit)
        except TimeoutError:
            child.kill()
            self._end(child)
            return Failure(f"takes longer than {time_limit:g} s; raise time_limit", child.log(), False), True
        except _Ended:
            status = self._end(child)
            return Failure(_death(status), child.log(), status == -signal.SIGKILL), False
        failure = Failure(answer.get("reason", ""), child.log(), answer.get("is_machine", False))
        if answer.get("again"):  # The memory that it holds would be missing for the next mesh.
            child.kill()
            self._end(child)
            return failure, False
        self._give_back(child)
        if "trouble" in answer:
            raise make_error(answer["trouble"], answer["reason"])
        return (failure if "reason" in answer else answer["figures"]), True

    def _take(self, device: str) -> _Child:
        with self._lock:
            for child in self._idle:
                if child.device == device:
                    self._idle.remove(child)
                    self._busy.add(child)
                    return child
        return self._start(device)

    def _start(self, device: str) -> _Child:
        try:
            child = _Child(device)
        except OSError as error:
            raise Error(f"cannot start a process: {error}") from error
        with self._lock:
            self._busy.add(child)
            if self._is_closed:
                child.kill()
        try:
            answer = child.wait_until_ready()
        except _Ended:
            status = self._end(child)
            text = f"cannot start a process of {sys.executable} for the device {device}: {_death(status)}"
            raise Error(f"{text}\n{child.log()}") from None
        if answer:
            self._end(child)
            raise make_error(answer["trouble"], answer["reason"])
        return child

    def _give_back(self, child: _Child) -> None:
        with self._lock:
            self._busy.discard(child)
            self._idle.append(child)
            if self._is_closed:
                child.kill()

    def _end(self, child: _Child) -> int:
        with self._lock:
            self._busy.discard(child)
        return child.end()

    def close(self) -> None:
        """Ends all processes. Jobs that are under way raise Cancelled."""
        with self._lock:
            self._is_closed = True
            for child in self._busy:
                child.kill()
            idle, self._idle = self._idle, []
        for child in idle:
            child.kill()
            child.end()


def _death(status: int) -> str:
    if status >= 0:
        return f"its process ended with the status {status}"
    name = signal.Signals(-status).name
    if name == "SIGKILL":
        return "its process was killed; perhaps the machine ran out of memory"
    return f"its process crashed: {name}, {signal.strsignal(-status)}"
