"""One shard of a store: what a thread of this machine or a worker of Dask does."""

from __future__ import annotations

import io
import threading

import numpy as np
import numpy.typing as npt

from .._lattice import Machine, Source, distances, is_far_outside, prepare, this_machine, thread_bytes
from .._raymap import write_whole
from .._whole_file import file_errors
from .codecs import ShardWriter, compressed, zarr_package
from .store import Level, Store, check_worker


def shard_bytes(store: Store) -> int:
    """Returns the most bytes that a shard takes while it is made: its samples, its compressed chunks, and the file."""
    return thread_bytes((store.shards,) * 3) + 2 * 4 * store.shards**3


def try_shard(store: Store, source: Source) -> None:
    """Prepares the mesh on a worker, for shards to come. Raises the errors of that."""
    zarr_package()
    prepare(source, this_machine(), shard_bytes(store))


def make_shard(
    name: str, source: Source, store: Store, machine: Machine | None = None, stop: threading.Event | None = None
) -> bool:
    """Writes a shard. It appears whole or not at all. Returns whether all of it lies outside: then there is no file.

    Args:
        name: Name of the shard.
        source: The mesh.
        store: The store.
        machine: What this process may use; None = as Dask says.
        stop: What another thread sets to cancel the work.

    Raises:
        Cancelled: ``stop`` was set.
        Error: The shard cannot be made here, or not be written.
    """
    machine = machine or this_machine()
    check_worker(store, machine.name)
    prepared = prepare(source, machine, shard_bytes(store))
    level, low, dims = store.box(name)
    if level.band is not None and is_far_outside(prepared, level.lattice, low, dims, level.band):
        return True
    values = distances(prepared, level.lattice, low, dims, level.band, stop)
    if (values == level.outside).all():
        return True
    content = _encoded(store, level, values)
    path = store.folder / name
    check_worker(store, machine.name)
    with file_errors():
        path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, content)
    return False


def _encoded(store: Store, level: Level, values: npt.NDArray[np.float32]) -> bytes:
    """Returns the file of a shard: its compressed chunks, and an index with the offset and the size of each.

    zarr would do the same with threads of its own, of which this process may not use as many.
    """
    count, side = store.shards // store.chunks, store.chunks
    content = io.BytesIO()
    shard = ShardWriter(content, (count,) * 3)
    for place in np.ndindex(count, count, count):
        chunk = values.T[tuple(slice(side * k, side * (k + 1)) for k in place)]
        if not (chunk == level.outside).all():  # One beyond the lattice has no samples.
            shard.add(place, compressed(_filled(chunk, side, level.outside)))
    shard.finish()
    return content.getvalue()


def _filled(chunk: npt.NDArray[np.float32], side: int, fill: float) -> npt.NDArray[np.float32]:
    """Returns a chunk of all its samples, contiguous. Those beyond the lattice get the fill value."""
    if chunk.shape == (side,) * 3:
        return np.ascontiguousarray(chunk)
    whole = np.full((side,) * 3, fill, np.float32)
    whole[tuple(map(slice, chunk.shape))] = chunk
    return whole
