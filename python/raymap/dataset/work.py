"""One mesh of a data set: what a thread of this machine or a worker of Dask does."""

from __future__ import annotations

import hashlib
import json
import math
import os
import shutil
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias, TypedDict

from .._raymap import version, write_whole
from .._whole_file import file_errors, folder_beside
from .children import Children, Failure
from .files import buffer_hashes, file_hash, readable
from .storage import MeshUnreadable, mesh_here, unreadable

State: TypeAlias = Literal["done", "quarantined", "unfinished"]

#: Formats of fields. The files are the same, bit for bit, whenever they are written, but for OpenVDB's.
FORMATS = ("npz", "npy", "nrrd", "vti", "vdb", "nvdb")

#: Those of narrow bands.
BAND_FORMATS = ("vdb", "nvdb")

#: Endings of all results, those of points included.
_ENDINGS = tuple(f".{format}" for format in (*FORMATS, "xyz"))

#: What stands before the endings of all files of a kind: fields and points of a mesh may lie side by side.
KINDS = {"field": "", "points": ".points"}


class Hashes(TypedDict):
    """Hashes of the files of a mesh."""

    mesh_sha256: str
    buffers: dict[str, str | None]
    """Hashes of the files to which the mesh refers, by name; None for one that does not exist."""


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
    retry: bool
    """Whether a quarantined mesh is tried again."""
    pages: bool = False
    """Whether a page that shows the field is made, too."""

    def path(self, ending: str) -> Path:
        """Returns the path of one of the mesh's files."""
        return Path(self.out, self.name + KINDS[self.what] + ending)

    @property
    def result(self) -> Path:
        """Path of the result."""
        return self.path("." + self.format)

    @property
    def thumbnail(self) -> Path:
        """Path of the picture."""
        return self.path(".png")

    @property
    def page(self) -> Path:
        """Path of the page for a browser."""
        return self.path(".html")

    @property
    def marker(self) -> Path:
        """Path of the marker, which says that the mesh is finished."""
        return self.path(".json")

    @property
    def quarantine(self) -> Path:
        """Folder with the reason and the log."""
        return Path(self.out, "quarantine", self.name + KINDS[self.what])

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
    reason: str = ""
    """Why it is unfinished."""


_children = Children()  # Children of this process, for as long as it runs.


def work(job: Job, children: Children | None = None) -> Outcome:
    """Makes the result of a mesh, unless it is there; or quarantines the mesh.

    Nothing that an earlier run made is touched before the new result is whole, or the mesh has failed.

    Raises:
        Error: No process can be started, a file cannot be written, or the device cannot be used. This says nothing of
            the mesh.
    """
    try:
        with mesh_here(job.mesh, job.memory_limit) as mesh:
            return _work(replace(job, mesh=mesh), children or _children)
    except MeshUnreadable as error:
        return Outcome(job.name, "unfinished", False, str(error))


def _work(job: Job, children: Children) -> Outcome:
    """Does the work for a mesh that is on this machine."""
    hashes, state = _found(job)
    if state is not None:
        return Outcome(job.name, state, False)
    key = _key(hashes, job)
    with file_errors():
        job.marker.parent.mkdir(parents=True, exist_ok=True)
        with folder_beside(job.result) as folder:
            answer = _without_folder(children.do(_request(job, folder), job.time_limit), job)
            inputs = {"key": key, **hashes, "what": job.what, "format": job.format, "options": job.options}
            marker = {**inputs, "raymap": version()}
            if not isinstance(answer, Failure):
                _publish(job, folder, {**marker, **answer})
                return Outcome(job.name, "done", True)
            if answer.is_machine and None not in hashes["buffers"].values():
                return Outcome(job.name, "unfinished", False, answer.reason)
            _quarantine(job, answer, marker)
            return Outcome(job.name, "quarantined", True)


def _without_folder(answer: dict[str, Any] | Failure, job: Job) -> dict[str, Any] | Failure:
    """Returns an answer whose texts name the mesh's files by their paths below its folder: pages may be published."""
    above = job.mesh.removesuffix(job.name)
    folder = readable(above if above.endswith("/") else os.path.join(os.path.dirname(job.mesh), ""))
    if isinstance(answer, Failure):
        return Failure(answer.reason.replace(folder, ""), answer.log.replace(folder, ""), answer.is_machine)
    warnings = [{**warning, "message": warning["message"].replace(folder, "")} for warning in answer["warnings"]]
    return {**answer, "warnings": warnings}


def _found(job: Job) -> tuple[Hashes, State | None]:
    """Returns the hashes of a mesh, and how it was finished before.

    Raises:
        MeshUnreadable: The mesh cannot be read.
    """
    with unreadable():
        hashes: Hashes = {"mesh_sha256": file_hash(job.mesh), "buffers": buffer_hashes(job.mesh, job.memory_limit)}
    return hashes, _finished(job, _key(hashes, job))


def planned(job: Job) -> Outcome:
    """Returns the state of a mesh. It is new if `work` would make it, or try to. Writes nothing."""
    try:
        with mesh_here(job.mesh, job.memory_limit) as mesh:
            state = _found(replace(job, mesh=mesh))[1]
    except MeshUnreadable as error:
        return Outcome(job.name, "unfinished", False, str(error))
    return Outcome(job.name, state or "unfinished", state is None)


def left(job: Job) -> Outcome:
    """Returns the state in which earlier runs left a mesh, as far as the marker tells: without reading the mesh."""
    marker = read_marker(job.marker) or {}
    hashes: Hashes = {"mesh_sha256": marker.get("mesh_sha256", ""), "buffers": marker.get("buffers", {})}
    return Outcome(job.name, _finished(job, _key(hashes, job)) or "unfinished", False)


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
    return marker if isinstance(marker, dict) and {"key", "state", "what", "format"} <= marker.keys() else None


def _finished(job: Job, key: str) -> State | None:
    """Returns how the mesh was finished before, or None if there is something to do."""
    marker = read_marker(job.marker)
    if marker is None or marker["key"] != key:
        return None
    if marker["state"] == "done":
        is_whole = job.thumbnail.exists() and (job.page.exists() or not job.pages)
        return "done" if _size(job.result) == marker["bytes"] and is_whole else None
    is_kept = not job.retry and marker["limits"] == _strict(job.limits) and (job.quarantine / "reason.txt").exists()
    return "quarantined" if is_kept else None


def _size(path: Path) -> int | None:
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return None


def _request(job: Job, folder: Path) -> dict[str, Any]:
    return {
        "mesh": job.mesh,
        "what": job.what,
        "format": job.format,
        "options": job.options,
        "threads": job.threads,
        "memory_limit": job.memory_limit,
        "result": str(folder / "result"),
        "thumbnail": str(folder / "thumbnail"),
        "page": str(folder / "page") if job.pages else None,
    }


def _publish(job: Job, folder: Path, marker: dict[str, Any]) -> None:
    """Puts a whole result in the place of an earlier one.

    The marker is removed first and written last: it vouches for all other files.
    """
    earlier = _take_marker(job)
    (folder / "result").replace(job.result)
    (folder / "thumbnail").replace(job.thumbnail)
    if job.pages:
        (folder / "page").replace(job.page)
    else:
        job.page.unlink(missing_ok=True)  # It would show an earlier result.
    if earlier is not None and earlier != job.result:
        earlier.unlink(missing_ok=True)
    with suppress(FileNotFoundError):
        shutil.rmtree(job.quarantine)
    _write_marker(job, {**marker, "state": "done", "bytes": _size(job.result)})


def _quarantine(job: Job, failure: Failure, marker: dict[str, Any]) -> None:
    """Writes why there is no result. An earlier one, of another mesh or other options, moves beside the reason."""
    job.quarantine.mkdir(parents=True, exist_ok=True)
    if (earlier := _take_marker(job)) is not None:
        for path in earlier, job.thumbnail, job.page:
            with suppress(FileNotFoundError):
                path.replace(job.quarantine / path.name)
    write_whole(job.quarantine / "log.txt", failure.log.encode())
    write_whole(job.quarantine / "reason.txt", f"{failure.reason}\n".encode())
    _write_marker(job, {**marker, "state": "quarantined", "reason": failure.reason, "limits": job.limits})


def _take_marker(job: Job) -> Path | None:
    """Removes the marker. Returns the path of the result for which it vouched."""
    marker = read_marker(job.marker)
    job.marker.unlink(missing_ok=True)
    return job.path("." + marker["format"]) if marker and marker["state"] == "done" else None


def _write_marker(job: Job, marker: dict[str, Any]) -> None:
    text = json.dumps(_strict(marker), indent=1, sort_keys=True, allow_nan=False)
    write_whole(job.marker, f"{text}\n".encode())


def _strict(value: Any) -> Any:
    """Returns a value without infinite numbers, which JSON does not know: null stands for no limit."""
    if isinstance(value, dict):
        return {name: _strict(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_strict(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def other_results(jobs: Iterable[Job], outcomes: Iterable[Outcome], out: Path, what: str) -> list[str]:
    """Returns results that lie in the jobs' folder, but are of other options, formats or meshes.

    Ignores results of another kind. They have a table of their own.
    """
    done = {outcome.name for outcome in outcomes if outcome.state == "done"}
    own = {job.result for job in jobs if job.name in done}
    others: list[str] = []
    for place, folders, names in os.walk(out):
        if Path(place) == out:
            folders[:] = [name for name in folders if name != "quarantine"]
        paths = (Path(place, name) for name in names if name.endswith(_ENDINGS))
        others += [str(path.relative_to(out)) for path in paths if path not in own and _may_be(path, what)]
    return sorted(others)


def _may_be(result: Path, what: str) -> bool:
    """Returns whether a result may be of a kind: unless its marker says otherwise."""
    marker = read_marker(result.with_suffix(".json"))
    return marker is None or marker["what"] == what
