"""One shard of a store: what a thread of this machine or a worker of Dask does."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import numpy.typing as npt

from .._lattice import Machine, Source, box_bytes, distances, prepare, this_machine
from .._raymap import write_whole
from .._whole_file import file_errors
from .store import Level, Store, check_worker, create_array, zarr_package


def shard_bytes(store: Store) -> int:
    """Returns the most bytes that a shard takes while it is made: its samples, its compressed chunks, and the file."""
    return box_bytes((store.shards,) * 3) + 4 * 4 * store.shards**3


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
    """Returns the file of a shard."""
    files: dict[str, Any] = {}
    array = create_array(store, level, zarr_package().storage.MemoryStore(files), None, (store.shards,) * 3)
    nx, ny, nz = values.shape
    array[:nz, :ny, :nx] = values.T
    return bytes(files["c/0/0/0"].to_bytes())
