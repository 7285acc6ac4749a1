"""One mesh of a data set: what a thread of this machine or a worker of Dask does."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias, TypedDict

from ._dataset_children import Children, Failure
from ._dataset_files import buffer_hashes, file_hash
from ._raymap import version
from ._whole_file import file_errors, write_whole

State: TypeAlias = Literal["done", "quarantined", "unfinished"]


class Hashes(TypedDict):
    """Hashes of the files of a mesh; None for one that cannot be read."""

    mesh_sha256: str | None
    buffers: dict[str, str | None]
    """Hashes of the files to which the mesh refers, by name."""


@dataclass(frozen=True)
class Job:
    """A mesh and what to make of it. All of it can be pickled."""

    mesh: str
    name: str
    """Path of the results below `out`, without what is appended."""
    out: str
    what: str
    format: str
    options: dict[str, Any]
    """All options on which the result depends, in JSON's types."""
    threads: int
    memory_limit: int
    time_limit: float

    def path(self, ending: str) -> Path:
        """Returns the path of one of the mesh's files."""
        return Path(self.out, self.name + ending)

    @property
    def result(self) -> Path:
        """Path of the result."""
        return self.path("." + self.format)

    @property
    def thumbnail(self) -> Path:
        """Path of the picture."""
        return self.path(".png")

    @property
    def marker(self) -> Path:
        """Path of the marker, which says that the mesh is finished."""
        return self.path(".json")

    @property
    def quarantine(self) -> Path:
        """Folder with the reason and the log."""
        return Path(self.out, "quarantine", self.name)

    @property
    def limits(self) -> dict[str, float]:
        """Limits that may decide whether there is a result, but not which."""
        return {"memory_limit": self.memory_limit, "time_limit": self.time_limit}


class Outcome(NamedTuple):
    """State of a mesh after the work."""

    name: str
    state: State
    is_new: bool
    """Whether it was made now, not found."""


_children = Children()  # Of this process, for as long as it runs.


def work(job: Job, children: Children | None = None) -> Outcome:
    """Makes the result of a mesh, unless it is there; or quarantines the mesh.

    Raises:
        Error: No process can be started, or a file cannot be written. This says nothing of the mesh.
    """
    hashes: Hashes = {"mesh_sha256": file_hash(job.mesh), "buffers": buffer_hashes(job.mesh, job.memory_limit)}
    key = _key(hashes, job)
    if (state := _finished(job, key)) is not None:
        return Outcome(job.name, state, False)
    with file_errors():
        _clear(job)
    answer = _make(job, children or _children)
    with file_errors():
        marker = _marker(job, key, hashes, answer)
        write_whole(job.marker, json.dumps(marker, indent=1, sort_keys=True) + "\n")
    return Outcome(job.name, marker["state"], True)


def _key(hashes: Hashes, job: Job) -> str:
    """Returns the hash of all that the result depends on."""
    all_of_it = [hashes, job.what, job.format, job.options, version()]
    return hashlib.sha256(json.dumps(all_of_it, sort_keys=True).encode()).hexdigest()


def read_marker(path: str | os.PathLike[str]) -> dict[str, Any] | None:
    """Returns what a marker says, or None if there is none."""
    try:
        marker = json.loads(Path(path).read_bytes())
    except (OSError, ValueError):
        return None
    return marker if isinstance(marker, dict) and "key" in marker else None


def _finished(job: Job, key: str) -> State | None:
    """Returns how the mesh was finished before, or None if there is something to do."""
    marker = read_marker(job.marker)
    if marker is None or marker["key"] != key:
        return None
    if marker["state"] == "done":
        return "done" if _size(job.result) == marker["bytes"] and job.thumbnail.exists() else None
    is_kept = marker["mesh_sha256"] and marker["limits"] == job.limits and (job.quarantine / "reason.txt").exists()
    return "quarantined" if is_kept else None


def _size(path: Path) -> int | None:
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return None


def _clear(job: Job) -> None:
    """Removes what an earlier run made, the marker first: it would vouch for the rest."""
    for path in job.marker, job.result, job.thumbnail:
        path.unlink(missing_ok=True)
    with suppress(FileNotFoundError):
        shutil.rmtree(job.quarantine)
    job.marker.parent.mkdir(parents=True, exist_ok=True)


def _make(job: Job, children: Children) -> dict[str, Any] | Failure:
    request = {
        "mesh": job.mesh,
        "what": job.what,
        "options": job.options,
        "threads": job.threads,
        "memory_limit": job.memory_limit,
        "result": str(job.result),
        "thumbnail": str(job.thumbnail),
    }
    return children.do(request, job.time_limit)


def _marker(job: Job, key: str, hashes: Hashes, answer: dict[str, Any] | Failure) -> dict[str, Any]:
    """Returns what the marker says. Quarantines the mesh if it failed."""
    marker: dict[str, Any] = {
        "key": key,
        **hashes,
        "what": job.what,
        "options": job.options,
        "raymap": version(),
    }
    if not isinstance(answer, Failure):
        return {**marker, "state": "done", "bytes": _size(job.result), **answer}
    for path in job.result, job.thumbnail:  # Made before the process ended
        path.unlink(missing_ok=True)
    job.quarantine.mkdir(parents=True, exist_ok=True)
    write_whole(job.quarantine / "log.txt", answer.log)
    write_whole(job.quarantine / "reason.txt", answer.reason + "\n")
    return {**marker, "state": "quarantined", "reason": answer.reason, "limits": job.limits}
