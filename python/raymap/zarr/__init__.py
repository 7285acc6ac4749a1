"""Fields that no memory holds, in Zarr stores, made on this machine or on a cluster."""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import closing
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias
from uuid import uuid4

import numpy.typing as npt

from .._arguments import to_threads, to_whole
from .._cluster import KILLED, dask_results
from .._errors import Cancelled, Error, UsageError
from .._lattice import Machine, Source, make_lattice, make_source, prepare, this_machine, to_band
from .._progress import Progress, pace_text, reporting
from .._records import Orientation
from .._whole_file import only_writer, remove_leftovers
from .codecs import zarr_package
from .shards import make_shard, shard_bytes, try_shard
from .store import UNITS, Finished, Level, Store, begin, finish, is_finished, make_store

__all__ = ["UNITS", "Summary", "generate"]


class Summary(NamedTuple):
    """What a store holds after a run."""

    shards: int
    """Number of shards of all levels."""
    new: int
    """Number of those that this call has made. The others were finished before."""
    outside: int
    """Number of those that lie wholly outside of the band. They have no file."""
    seconds: float
    """Time that the call took, by the clock."""


def generate(
    mesh: Any,
    out: str | os.PathLike[str],
    *,
    resolution: int = 128,
    voxel_size: float | None = None,
    bounds: npt.ArrayLike | None = None,
    padding: float = 0.1,
    band: float | None = None,
    sign: bool = True,
    orientation: Orientation = "auto",
    chunks: int = 64,
    shards: int = 256,
    pyramid: int = 0,
    unit: str | None = None,
    overwrite: bool = False,
    client: Any = None,
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Summary:
    """Makes the signed distance field of a mesh, negative inside, as an OME-Zarr store of any size.

    ``out`` is a Zarr 3 store with OME-Zarr 0.5 metadata. Its array ``0`` has the axes z, y, x. A sample has the distance
    of ``raymap.Surface.query`` at its position, rounded to float32. With a band, the time grows with the surface.

    It may be stopped and run again at any time: a second run makes the shards that are missing. The store is the same,
    bit for bit, for any number of workers, and whatever was killed meanwhile. A shard appears whole or not at all. One
    that lies wholly outside of the band has no file: its samples are the fill value. Attributes below ``raymap`` hold
    the options, and say by ``complete`` whether all shards are finished.

    Args:
        mesh: A mesh or path as for ``raymap.Surface``. Workers get its arrays, so they need no file.
        out: Folder of the store. With ``client``, all workers must reach it.
        resolution: Number of samples along the longest side of the lattice. Without effect if ``voxel_size`` is given.
        voxel_size: Distance between samples, in the mesh's units.
        bounds: Box to cover, ((x0, y0, z0), (x1, y1, z1)), in the mesh's units; None = the mesh's bounds, padded. Cubic
            cells fill it; samples are their centres.
        padding: Padding of the mesh's bounds on every side, as a share of their longest side.
        band: Number of samples at which distances are clamped, on each level; None = not clamped.
        sign: Whether to tell inside from outside; without, distances are not negative.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, ``"keep"`` or ``"repair"``.
        chunks: Number of samples along the side of a chunk, which readers decode at once.
        shards: Number of samples along the side of a shard, a file of many chunks; a multiple of ``chunks``.
        pyramid: Number of coarser levels, each of half the resolution: arrays ``1``, ``2``, …
        unit: Unit of the mesh's lengths as OME-Zarr names it, such as ``"millimeter"``; None = not known.
        overwrite: Whether to remove a store of other options or another mesh that lies in ``out``.
        client: A ``dask.distributed.Client``, whose cluster does the work; None = this machine.
        threads: Number of shards at a time on this machine; None = as many as processors.
        memory_limit: Most bytes that the work may take on this machine; None = what is available. With ``client``,
            workers have both of their own.
        progress: A callable that receives the name of a stage and the share of it that is done, 0 to 1. It cancels by
            returning False or by raising. True shows it, as do ``"plain"`` and ``"json"``.

    Raises:
        InputError: The mesh is not valid.
        UsageError: Arguments that make no sense, ``out`` holds something else, a worker has another version of raymap,
            or the package zarr is missing.
        FileError: A file cannot be read or written, a shard there is torn, or another run writes into ``out``.
        MemoryLimitError: The prepared mesh and a shard for each thread exceed the memory of this machine or of a worker.
        Cancelled: ``progress`` returned False.
        Error: The scheduler of Dask was lost, or workers were killed again and again. Finished shards stay finished.

    >>> raymap.zarr.generate("ball.ply", "ball.zarr", resolution=48, band=3, chunks=8, shards=16).shards
    27
    >>> raymap.zarr.generate("ball.ply", "ball.zarr", resolution=48, band=3, chunks=8, shards=16).new
    0
    >>> import zarr
    >>> array = zarr.open_array("ball.zarr/0", mode="r")
    >>> array.shape, bool(array[24, 24, 24] == -array.fill_value)
    ((48, 48, 48), True)
    """
    start = time.monotonic()
    if client is not None and (threads, memory_limit) != (None, None):
        raise UsageError("threads and memory_limit are those of this machine; set them where workers of the cluster start")
    zarr_package()
    source = make_source(mesh, sign, orientation)
    lattice = make_lattice(source, resolution, voxel_size, bounds, padding)
    lattices = [lattice.coarser(2**k) for k in range(to_whole("pyramid", pyramid, most=30) + 1)]
    levels = [Level(each, to_band(band)) for each in lattices]
    chunks, shards = (to_whole(name, side, least=1, most=512) for name, side in (("chunks", chunks), ("shards", shards)))
    store = make_store(Path(out).resolve(), source, levels, chunks, shards, unit)
    machine = None if client is not None else _machine(threads, memory_limit)
    if not is_finished(store, overwrite):
        _try_out(source, store, machine, client)  # Its errors come before anything is removed.
    with only_writer(store.own_folder):
        was_finished = is_finished(store, overwrite)
        if not was_finished:
            begin(store)
        remove_leftovers(store.folder)
        finished = Finished(store)
        left = finished.left
        if left:
            run = _on_this_machine(left, source, store, machine) if machine else _on_a_cluster(left, source, store, client)
            with reporting(progress) as report, closing(run) as results:
                _collect(results, len(left), store, finished, report)
        if left or not was_finished:
            finish(store)
    return Summary(store.shard_count(), len(left), len(finished.outside), time.monotonic() - start)


def _machine(threads: int | None, memory_limit: int | None) -> Machine:
    machine = this_machine()
    limit = None if memory_limit is None else to_whole("memory_limit", memory_limit, least=1, most=2**63)
    return Machine(machine.name, to_threads(threads) or machine.threads, limit)


def _try_out(source: Source, store: Store, machine: Machine | None, client: Any) -> None:
    """Prepares the mesh on this machine, or on a worker of the cluster. Raises the errors of that."""
    if machine is not None:
        prepare(source, machine, shard_bytes(store))
    elif KILLED in [found for _, found in dask_results(client, try_shard, [store], [f"raymap-{uuid4().hex}"], source=source)]:
        raise Error(_killed_text(store, "the workers that prepared the mesh"))


_Results: TypeAlias = Generator[tuple[str, bool]]


def _collect(
    results: _Results, count: int, store: Store, finished: Finished, report: Callable[[str, float], object] | None
) -> None:
    """Takes the results of shards as they end."""
    start = time.monotonic()
    for done, (name, is_outside) in enumerate(results, 1):
        finished.add(name, is_outside)
        total = store.shard_count()
        text = f"{total - count + done} of {total} shards{pace_text(done, count - done, start)}"
        if report is not None and report(text, (total - count + done) / total) is False:
            raise Cancelled("cancelled by progress")


def _on_this_machine(names: list[str], source: Source, store: Store, machine: Machine) -> _Results:
    """Makes shards. Yields their names, and whether all of each lies outside."""
    stop = threading.Event()
    with ThreadPoolExecutor(machine.threads) as pool:
        futures = {pool.submit(make_shard, name, source, store, machine, stop): name for name in names}
        try:
            for future in as_completed(futures):
                yield futures[future], future.result()
        finally:
            stop.set()
            pool.shutdown(cancel_futures=True)


def _on_a_cluster(names: list[str], source: Source, store: Store, client: Any) -> _Results:
    """Does the same on a cluster. Each worker gets the mesh once, also one that joins later."""
    run = uuid4().hex
    keys = {f"raymap-{run}-{name}": name for name in names}
    mesh = client.submit(_same, source, key=f"raymap-{run}-mesh", pure=False)
    for key, is_outside in dask_results(client, make_shard, names, list(keys), source=mesh, store=store):
        if is_outside is KILLED:
            raise Error(f"{store.folder / keys[key]}: {_killed_text(store, 'the workers that made this shard')}")
        yield keys[key], is_outside


def _killed_text(store: Store, who: str) -> str:
    return (
        f"{who} were killed again and again; each of their threads needs {shard_bytes(store):,} bytes beside the prepared "
        "mesh"
    )


def _same(source: Source) -> Source:
    return source
