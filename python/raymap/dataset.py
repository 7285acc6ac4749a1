"""Fields of many meshes, on this machine or on a cluster."""

from __future__ import annotations

import importlib
import inspect
import operator
import os
import time
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor, as_completed
from contextlib import closing, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, TypeAlias, Unpack
from uuid import uuid4

import numpy as np

from . import _samples
from ._dataset_children import Children
from ._dataset_pages import parquet_path, write_pages
from ._dataset_work import Job, Outcome, work
from ._errors import Cancelled, Error, FileError, MemoryLimitError, UsageError
from ._generate import FieldOptions, signed_distance
from ._mesh import Mesh
from ._progress import reporting
from ._whole_file import file_errors, remove_leftovers

What: TypeAlias = Literal["field", "points"]
Format: TypeAlias = Literal["npz", "npy", "nrrd", "vti", "vdb"]
PathLike: TypeAlias = str | os.PathLike[str]

#: Formats of fields. The files are the same, bit for bit, whenever they are written, but for OpenVDB's.
FORMATS = ("npz", "npy", "nrrd", "vti", "vdb")

#: Endings of the files that are meshes, in lower case.
MESH_ENDINGS = (".obj", ".ply", ".stl", ".off", ".gltf", ".glb", ".3mf", ".fbx", ".dae")


class Options(FieldOptions, total=False):
    """Keyword arguments of ``raymap.signed_distance`` and ``raymap.sample_points``, which document them."""

    n: int
    near: float
    sigma: float | Iterable[float]
    surface: float
    seed: int
    normalize: bool


@dataclass(frozen=True)
class Summary:
    """States of the meshes of a data set after a run. Names are paths below the folder of the meshes."""

    done: list[str]
    """Names of the meshes that have a result."""
    quarantined: list[str]
    """Names of the meshes that failed."""
    unfinished: list[str]
    """Names of the meshes whose workers were killed again and again. The next run tries them again."""
    new: list[str]
    """Names of the meshes that this call has made or quarantined. The others were finished before."""
    seconds: float
    """Time that the call took, by the clock."""

    def __repr__(self) -> str:
        return (
            f"raymap.dataset.Summary({len(self.done)} done, {len(self.quarantined)} quarantined, "
            f"{len(self.unfinished)} unfinished; {len(self.new)} of them new, in {self.seconds:.1f} s)"
        )


def generate(
    paths_or_folder: PathLike | Iterable[PathLike],
    out: PathLike,
    *,
    what: What = "field",
    format: Format = "npz",
    table: PathLike | None = None,
    workers: int | None = None,
    time_limit: float = 600.0,
    client: Any = None,
    **options: Unpack[Options],
) -> Summary:
    """Makes the signed distance fields of many meshes, negative inside, or points with their distances.

    It may be stopped and run again at any time.

    A mesh MESH becomes ``out/MESH.npz``, with a thumbnail ``.png`` and a marker ``.json`` beside it. ``out`` also gets
    ``table.csv``, with figures of all meshes, and the page ``index.html``. Each mesh is made in a process apart. If it
    fails there, crashes, or exceeds a limit, ``out/quarantine/MESH`` says why, and the run goes on.

    A second run makes what is missing, and what differs in the mesh's files, the options or raymap's version. Results
    are the same, bit for bit, for any number of workers, and whatever was killed meanwhile.

    Args:
        paths_or_folder: Folder whose meshes are made, with all folders in it; or paths of meshes with different names.
        out: Folder of the results. It is made if it does not exist. With ``client``, all workers must reach it.
        what: What is made: ``"field"``, or ``"points"``, as ``raymap.sample_points`` makes them. A .npz of points holds
            ``pos`` and ``neg``, as DeepSDF reads them, with ``centre`` and ``scale``.
        format: Format of fields: ``"npz"``, ``"npy"``, ``"nrrd"``, ``"vti"`` or ``"vdb"``; see ``raymap.Field.save``.
            OpenVDB's files hold the same numbers, but not the same bytes, whenever they are written.
        table: A .parquet to which the table is written as well, with types. It needs pyarrow.
        workers: Number of meshes at a time on this machine; None = as many as processors. With ``client``, that has
            its own.
        time_limit: Most seconds that a mesh may take.
        client: A ``dask.distributed.Client``, whose cluster does the work; None = this machine.
        **options: Options of ``raymap.signed_distance``, or of ``raymap.sample_points`` with the number of points,
            ``n``. Some have other defaults: ``device="cpu"``, and for each mesh ``threads=1`` and
            ``memory_limit=4 << 30``, which counts all that its process takes for it.

    Raises:
        UsageError: Arguments that make no sense, or two meshes with one name.
        FileError: A folder cannot be read, or a result cannot be written.
        Cancelled: ``progress`` returned False.
        Error: The scheduler of Dask was lost. The finished meshes stay finished.

    >>> summary = raymap.dataset.generate(["ball.ply", "tetrahedron.ply"], "fields", resolution=16)
    >>> summary.done, summary.quarantined, len(summary.new)
    (['ball.ply', 'tetrahedron.ply'], [], 2)
    >>> raymap.load_field("fields/ball.ply.npz")
    raymap.Field(16 x 16 x 16 samples, spacing 0.15, arrays distance)
    >>> raymap.dataset.generate(["ball.ply", "tetrahedron.ply"], "fields", resolution=16).new
    []
    """
    start = time.monotonic()
    folder = Path(out).resolve()
    jobs = _jobs(paths_or_folder, folder, what, format, time_limit, options)
    parquet = None if table is None else parquet_path(table)
    workers = _worker_count(workers)
    with file_errors():
        folder.mkdir(parents=True, exist_ok=True)
    before = [_identity(job) for job in jobs]
    with reporting(options.get("progress")) as report:
        running = closing(_dask_outcomes(jobs, client)) if client is not None else _on_this_machine(jobs, workers)
        with running as outcomes:
            results = _collect(outcomes, len(jobs), report)
    with file_errors():
        write_pages(jobs, folder, parquet)
        remove_leftovers(folder)
    new = [job.name for job, identity in zip(jobs, before, strict=True) if _identity(job) != identity]
    return _summary(results, new, time.monotonic() - start)


def _worker_count(workers: int | None) -> int:
    if workers is None:
        return len(os.sched_getaffinity(0))
    if operator.index(workers) < 1:
        raise UsageError(f"workers must be at least 1, not {workers}")
    return workers


def _identity(job: Job) -> tuple[int, int] | None:
    """Returns what changes when a marker is written. Workers do not know: Dask may repeat a task that has ended."""
    try:
        status = job.marker.stat()
    except OSError:
        return None
    return status.st_ino, status.st_mtime_ns


def _summary(outcomes: list[Outcome], new: list[str], seconds: float) -> Summary:
    def names(state: str) -> list[str]:
        return sorted(outcome.name for outcome in outcomes if outcome.state == state)

    return Summary(names("done"), names("quarantined"), names("unfinished"), new, seconds)


# Which meshes, and what to make of them.


def _jobs(
    given: PathLike | Iterable[PathLike], out: Path, what: str, format: str, time_limit: float, options: Options
) -> list[Job]:
    if what not in ("field", "points"):
        raise UsageError(f"what must be 'field' or 'points', not {what!r}")
    if what == "points" and format != "npz":
        raise UsageError(f"points are written as npz only, not {format!r}")
    if format not in FORMATS:
        raise UsageError(f"format must be one of {', '.join(FORMATS)}, not {format!r}")
    if not time_limit > 0:
        raise UsageError(f"time_limit must be above 0 seconds, not {time_limit}")
    threads = operator.index(options.get("threads") or 1)
    memory_limit = operator.index(options.get("memory_limit") or 4 << 30)
    if not memory_limit > 0:
        raise UsageError(f"memory_limit must be above 0 bytes, not {memory_limit}")
    result_options = _field_options(options) if what == "field" else _point_options(options)
    return [
        Job(str(mesh), name, str(out), what, format, result_options, threads, memory_limit, time_limit)
        for name, mesh in sorted(_meshes(given, out).items())
    ]


def _meshes(given: PathLike | Iterable[PathLike], out: Path) -> dict[str, Path]:
    """Returns meshes by name."""
    if isinstance(given, (str, os.PathLike)):
        if Path(given).is_dir():
            return _meshes_below(Path(given).resolve(), out)
        given = [given]
    meshes: dict[str, Path] = {}
    for path in map(Path, given):
        if not path.exists():
            raise FileError(f"{path}: no such file or folder")
        if path.is_dir():
            raise UsageError(f"{path}: a folder among paths; give one folder alone, or meshes")
        if path.name in meshes:
            raise UsageError(f"{meshes[path.name]} and {path}: both results would be {path.name}; give their folder")
        meshes[path.name] = path.resolve()
    return meshes


def _meshes_below(folder: Path, out: Path) -> dict[str, Path]:
    meshes: dict[str, Path] = {}

    def fail(error: OSError) -> None:
        raise FileError(f"{error.filename}: cannot read: {error.strerror}")

    for place, folders, names in os.walk(folder, onerror=fail):
        folders[:] = [name for name in folders if Path(place, name) != out]
        for name in names:
            if name.lower().endswith(MESH_ENDINGS) and Path(place, name).is_file():
                meshes[str(Path(place, name).relative_to(folder))] = Path(place, name)
    if not meshes:
        raise UsageError(f"{folder}: no meshes here; their names end with {', '.join(MESH_ENDINGS)}")
    return meshes


_APART = {"threads", "memory_limit", "progress"}  # Results do not depend on them.


def _field_options(options: Options) -> dict[str, Any]:
    """Returns all options on which fields depend, the defaults included, in JSON's types. Checks them."""
    given: FieldOptions = {"device": "cpu", **options}  # type: ignore[typeddict-unknown-key]
    result = _with_defaults(given, signed_distance)
    _check(given)
    arrays = result["arrays"]
    result["arrays"] = sorted({"distance", *([arrays] if isinstance(arrays, str) else arrays)})
    if result["bounds"] is not None:
        result["bounds"] = np.asarray(result["bounds"], np.float64).tolist()
    return result


def _point_options(options: Options) -> dict[str, Any]:
    """Returns all options on which points depend, as `_field_options` does."""
    if "n" not in options:
        raise UsageError("what='points' needs n, the number of points of each mesh")
    result = _with_defaults(options, _samples.sample_points)
    result["sigma"] = np.atleast_1d(np.asarray(result["sigma"], np.float64)).tolist()
    _samples._plan(result["n"], result["near"], result["surface"], result["sigma"])
    return result


def _with_defaults(options: Mapping[str, object], function: Callable[..., Any]) -> dict[str, Any]:
    """Returns the keyword arguments of a function on which its result depends."""
    known = {k: p for k, p in inspect.signature(function).parameters.items() if p.kind is p.KEYWORD_ONLY or k == "n"}
    if unknown := options.keys() - known.keys() - _APART:
        raise TypeError(f"generate() got an unexpected keyword argument {sorted(unknown)[0]!r}")
    values = {name: options.get(name, known[name].default) for name in known.keys() - _APART}
    return {name: value.item() if isinstance(value, np.generic) else value for name, value in values.items()}


def _check(options: FieldOptions) -> None:
    """Raises what no mesh can change, for example that there is no such option: begins a field of a tetrahedron."""
    size = 10 * (options.get("voxel_size") or 1)
    corners = [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)]
    tetrahedron = Mesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    # The device may be one that only the workers have.
    with suppress(Cancelled, MemoryLimitError):
        checked: FieldOptions = {**options, "device": "cpu", "progress": lambda stage, done: False}
        signed_distance(tetrahedron, **checked)


# Who works.


@contextmanager
def _on_this_machine(jobs: list[Job], workers: int) -> Iterator[Iterator[Outcome]]:
    children = Children()
    with ThreadPoolExecutor(workers) as pool:
        try:
            futures = as_completed([pool.submit(work, job, children) for job in jobs])
            yield (future.result() for future in futures)
        finally:
            pool.shutdown(wait=False, cancel_futures=True)
            children.close()


def _dask_outcomes(jobs: list[Job], client: Any) -> Generator[Outcome]:
    distributed = importlib.import_module("distributed")  # The type checker must not need it.
    run = uuid4().hex
    names = {f"raymap-{run}-{job.name}": job.name for job in jobs}
    # Nothing else refers to the futures. So Dask forgets each as soon as it is taken, and the rest if this is closed.
    for future in distributed.as_completed(client.map(work, jobs, key=list(names), pure=False)):
        try:
            yield future.result()
        except distributed.KilledWorker:
            yield Outcome(names[future.key], "unfinished", False)
        except (CancelledError, OSError) as error:
            if isinstance(error, Error):  # of work()
                raise
            raise Error("the scheduler of Dask was lost; run again with a new one: what is finished stays") from error


# Progress.


def _collect(
    outcomes: Iterator[Outcome], count: int, report: Callable[[str, float], object] | None
) -> list[Outcome]:
    results: list[Outcome] = []
    start = time.monotonic()
    for outcome in outcomes:
        results.append(outcome)
        if report is not None and report(_progress_text(results, count, start), len(results) / count) is False:
            raise Cancelled("cancelled by progress")
    return results


def _progress_text(results: list[Outcome], count: int, start: float) -> str:
    """Returns the state of a run. Meshes that were finished before say nothing about its rate."""
    new = sum(outcome.is_new for outcome in results)
    failed = sum(outcome.state == "quarantined" for outcome in results)
    text = f"{len(results)} of {count} meshes" + (f", {failed} quarantined" if failed else "")
    if new:
        rate = new / max(time.monotonic() - start, 1e-9)
        text += f", {rate:.2g} per second, {_duration((count - len(results)) / rate)} left,"
    return text


def _duration(seconds: float) -> str:
    if seconds < 60:
        return f"{seconds:.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"
