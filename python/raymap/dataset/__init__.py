"""Fields of many meshes, on this machine or on a cluster."""

from __future__ import annotations

import operator
import os
import time
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias

from .._errors import FileError, UsageError, warn
from .._progress import reporting
from .._typing import Unpack
from .._whole_file import file_errors, only_writer, remove_leftovers
from .jobs import Options, PathLike, make_jobs
from .packing import Packed, PackFormat, pack
from .pages import page_paths, parquet_path, write_pages
from .run import run_jobs
from .work import FORMATS, Job, Outcome, left, other_results, planned

__all__ = ["FORMATS", "Format", "Options", "PackFormat", "Packed", "Summary", "What", "generate", "pack"]

What: TypeAlias = Literal["field", "points"]
Format: TypeAlias = Literal["npz", "npy", "nrrd", "vti", "vdb", "nvdb"]


class Summary(NamedTuple):
    """States of the meshes of a data set after a run. Names are paths below the folder of the meshes."""

    done: list[str]
    """Names of the meshes that have a result."""
    quarantined: list[str]
    """Names of the meshes that failed."""
    unfinished: list[str]
    """Names of the meshes that the machine kept from being made: a file could not be read, a process was killed, a GPU's
    memory was full. The next run tries them again. The results of earlier runs stay."""
    new: list[str]
    """Names of the meshes that this call has made or quarantined. The others were finished before."""
    others: list[str]
    """Paths below ``out`` of results that are of other options, formats or meshes than this call's."""
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
    retry: bool = False,
    pages: bool = False,
    dry_run: bool = False,
    client: Any = None,
    **options: Unpack[Options],
) -> Summary:
    """Makes the signed distance fields of many meshes, negative inside, or points with their distances.

    It may be stopped and run again at any time.

    A mesh MESH becomes ``out/MESH.npz``, with a thumbnail ``.png`` and a marker ``.json`` beside it. ``out`` also gets
    ``table.csv``, with figures of all meshes, and the page ``index.html``. Names of points have ``.points`` before
    their endings: ``out/MESH.points.npz``. Each mesh is made in a process apart. If it fails there, crashes, or exceeds
    a limit, ``out/quarantine/MESH`` says why, and the run goes on.

    A second run makes what is missing, and what differs in the mesh's files, the options or raymap's version. Results
    are the same, bit for bit, for any number of workers, and whatever was killed meanwhile. An earlier result stays
    until the new one is whole. If the mesh fails instead, it moves into ``out/quarantine/MESH``. A warning
    (``RaymapWarning``) counts the results in ``out`` that are of other options, formats or meshes.

    Args:
        paths_or_folder: Folder whose meshes are made, with all folders in it; or paths of meshes with different names.
            Each may be an URL that fsspec knows, such as ``s3://bucket/meshes``: every run then copies each mesh to this
            machine, one at a time for each worker.
        out: Folder of the results. It is made if it does not exist. With ``client``, all workers must reach it.
        what: What is made: ``"field"``, or ``"points"``, as ``raymap.sample_points`` makes them. A .npz of points holds
            ``pos`` and ``neg``, as DeepSDF reads them, with ``centre`` and ``scale``. With ``recipe``, points and files
            are those of ``raymap.recipes.save``.
        format: Format of fields: ``"npz"``, ``"npy"``, ``"nrrd"``, ``"vti"``, ``"vdb"`` or ``"nvdb"``; see
            ``raymap.Field.save``. A .vdb of all samples holds the same numbers, but not the same bytes, whenever it is
            written.
        table: A .parquet to which the table is written as well, with types. Its folder is made if it does not exist.
            It needs pyarrow.
        workers: Number of meshes at a time on this machine; None = as many as processors. With ``client``, that has
            its own.
        time_limit: Most seconds that a mesh may take.
        retry: Whether to try quarantined meshes again although nothing has changed.
        pages: Whether to write a page beside each field, ``out/MESH.html``, as ``raymap.Field.to_html`` does, with the
            mesh's defects. ``index.html`` links to them. A finished mesh that lacks its page is made again.
        dry_run: Whether to write nothing, and only to find out what there is to do: ``Summary.new`` has the names of
            the meshes that a run would make.
        client: A ``dask.distributed.Client``, whose cluster does the work; None = this machine.
        **options: Options of ``raymap.generate``, or of ``raymap.sample_points`` with the number of points,
            ``n``. Some have other defaults: ``device="cpu"``, and for each mesh ``threads=1`` and
            ``memory_limit=4 << 30``, which limits all that its process takes for it. ``bounds`` may be a dict with a
            box for each mesh, by its path below the folder. Fields also take ``pyramid``, the number of coarser levels,
            each of half the resolution, as ``raymap.generate_pyramid`` makes them; a .npz holds all of them, and
            ``raymap.load_pyramid`` reads it. With ``sparse=True`` they are narrow bands, as ``"vdb"`` or ``"nvdb"``, which
            ``raymap.load_field(path, sparse=True)`` reads. The ``centre`` and ``scale`` of ``normalize`` are in the
            table, the markers, and in each .npz.

    Raises:
        UsageError: Arguments that make no sense, or two meshes with one name.
        FileError: A folder cannot be read, a result cannot be written, or another run writes into ``out``.
        UnsupportedError, DeviceLostError: The device cannot be used. That is no fault of the meshes.
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
    jobs = make_jobs(paths_or_folder, folder, what, format, time_limit, retry, bool(pages), options)
    parquet = None if table is None else parquet_path(table)
    workers = _worker_count(workers)
    if dry_run:
        plan = [planned(job) for job in jobs]
        others = other_results(jobs, plan, folder, what)
        return _summary(plan, [outcome.name for outcome in plan if outcome.is_new], others, time.monotonic() - start)
    with only_writer(folder):
        if parquet is not None:
            with file_errors():
                parquet.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(folder)
        before = [_identity(job) for job in jobs]
        outcomes: list[Outcome] = []
        try:
            with reporting(options.get("progress")) as report:
                run_jobs(jobs, workers, client, report, outcomes)
        except BaseException:
            if _new(jobs, before):
                with suppress(FileError):  # The error that stopped the run says more.
                    _finish(jobs, outcomes, folder, what, parquet)
            raise
        others = _finish(jobs, outcomes, folder, what, parquet)
    return _summary(outcomes, _new(jobs, before), others, time.monotonic() - start)


def _finish(jobs: list[Job], outcomes: list[Outcome], folder: Path, what: str, parquet: Path | None) -> list[str]:
    """Writes the table and the page. Warns of results that are not of these jobs, and returns them.

    Appends the outcomes that a run lacks if it was stopped.
    """
    known = {outcome.name for outcome in outcomes}
    outcomes += [left(job) for job in jobs if job.name not in known]
    others = other_results(jobs, outcomes, folder, what)
    table, page = page_paths(folder, what)
    write_pages(jobs, outcomes, others, (table, page), parquet)
    remove_leftovers(folder)
    if others:
        results = f"{len(others)} results" if len(others) > 1 else "a result"
        text = f"{folder} also holds {results} of other options, formats or meshes; {page.name} lists them"
        warn("other_results", text, {"file": str(folder), "count": len(others)})
    return others


def _new(jobs: list[Job], before: list[tuple[int, int] | None]) -> list[str]:
    """Returns the names of the jobs whose markers are not as they were before."""
    return [job.name for job, identity in zip(jobs, before, strict=True) if _identity(job) != identity]


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


def _summary(outcomes: list[Outcome], new: list[str], others: list[str], seconds: float) -> Summary:
    def names(state: str) -> list[str]:
        return sorted(outcome.name for outcome in outcomes if outcome.state == state)

    return Summary(names("done"), names("quarantined"), names("unfinished"), new, others, seconds)
