"""Distances on lattices that no memory holds, box by box, on any thread of any machine."""

from __future__ import annotations

import hashlib
import os
import socket
import sys
import threading
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple, get_args

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap
from ._arguments import Vector, Whole3, to_length
from ._errors import MemoryLimitError, UsageError
from ._generate import SurfaceFieldOptions, fit_grid
from ._memory import memory_left
from ._mesh import Mesh, core_of
from ._options import core_options
from ._records import Orientation
from ._surface import Surface

_KEPT = 2  # Meshes that a process keeps prepared.


class Lattice(NamedTuple):
    """A lattice of samples, which are the centres of cubic cells."""

    dims: Whole3
    """Number of samples (nx, ny, nz)."""
    origin: Vector
    """Position of sample (0, 0, 0), in the mesh's units."""
    spacing: float
    """Distance between neighbouring samples, in the mesh's units."""

    def coarser(self, factor: int) -> Lattice:
        """Returns the lattice of cells that are so many times as large. They fill the same box from its low corner on."""
        x, y, z = (low + 0.5 * (factor - 1) * self.spacing for low in self.origin)
        nx, ny, nz = (-(-count // factor) for count in self.dims)
        return Lattice((nx, ny, nz), (x, y, z), factor * self.spacing)


@dataclass(frozen=True)
class Source:
    """A mesh and how to prepare it: all that another process needs for its distances. It can be pickled."""

    mesh: Mesh
    sign: bool
    orientation: Orientation
    sha256: str
    """Hash of the mesh's arrays."""
    version: str
    """Version of raymap that this process runs."""

    @property
    def key(self) -> str:
        """Text that differs if distances may differ."""
        return f"{self.sha256}-{self.sign}-{self.orientation}-{self.version}"


def make_source(mesh: Any, sign: bool, orientation: Orientation) -> Source:
    """Returns the source of distances to a mesh. It never changes, whatever becomes of the caller's arrays.

    Raises:
        UsageError: There is no such orientation.
        InputError, FileError: The mesh is not valid, or cannot be read.
    """
    if orientation not in get_args(Orientation):
        raise UsageError(f"orientation must be one of {', '.join(get_args(Orientation))}, not {orientation!r}")
    found = _inputs.to_mesh(mesh)
    if not isinstance(mesh, (Mesh, str, os.PathLike)):
        found = Mesh(found.vertices, found.faces)  # It views arrays.
    vertices, faces = np.asarray(found.vertices, "<f8") + 0.0, np.asarray(found.faces, "<u8")
    digest = hashlib.sha256(f"{vertices.shape} {faces.shape}".encode())
    digest.update(np.ascontiguousarray(vertices).data)
    digest.update(np.ascontiguousarray(faces).data)
    return Source(found, bool(sign), orientation, digest.hexdigest(), _raymap.version())


def make_lattice(
    source: Source, resolution: int, voxel_size: float | None, bounds: npt.ArrayLike | None, padding: float
) -> Lattice:
    """Returns the lattice that arguments of ``raymap.generate`` ask for.

    Raises:
        UsageError: Arguments that make no lattice.
        InputError: The mesh is not valid.
    """
    fit = partial(_raymap.fit_grid, core_of(source.mesh))
    options: SurfaceFieldOptions = {
        "resolution": resolution, "voxel_size": voxel_size, "bounds": bounds, "padding": padding,
    }  # fmt: skip
    grid = fit_grid(fit, options)
    return Lattice(grid.dims, grid.origin, grid.spacing)


def to_band(band: float | None) -> float | None:
    """Returns the number of samples at which distances are clamped."""
    return None if band is None else to_length("band", band)


class Machine(NamedTuple):
    """What a process may use."""

    name: str
    """Name for messages."""
    threads: int
    """Number of boxes that it may compute at a time."""
    memory_limit: int | None
    """Most bytes that it may take; None = what is available when it prepares a mesh."""


def this_machine() -> Machine:
    """Returns what this process may use: a worker of Dask, or any other process."""
    distributed: Any = sys.modules.get("distributed")
    if distributed is not None:
        try:
            worker = distributed.get_worker()
        except ValueError:  # This is no worker.
            worker = None
        if worker is not None:
            name = f"the worker {worker.address} on {socket.gethostname()}"
            return Machine(name, worker.state.nthreads, worker.memory_manager.memory_limit)
    return Machine("this machine", len(os.sched_getaffinity(0)), None)


class Prepared(NamedTuple):
    """A surface, and what was found out while it was made."""

    surface: Surface
    available: int
    """Bytes of memory that were available before it was made."""


_prepared: dict[str, Prepared] = {}
_lock = threading.Lock()


def prepare(source: Source, machine: Machine, bytes_per_thread: int) -> Prepared:
    """Returns the prepared mesh. All threads of the process share it, and the next calls get it again.

    Args:
        source: The mesh.
        machine: What this process may use.
        bytes_per_thread: Memory that each thread needs beside the surface.

    Raises:
        UsageError: This process runs another version of raymap than the one that made the source.
        MemoryLimitError: The surface and what the threads need exceed the limit of the machine.
    """
    if source.version != _raymap.version():
        raise UsageError(
            f"{machine.name} has raymap {_raymap.version()}, but the program that asks it has {source.version}; "
            "install the same version on all machines"
        )
    with _lock:
        found = _prepared.pop(source.key, None) or _prepare(source, machine)
        _prepared[source.key] = found
        while len(_prepared) > _KEPT:
            del _prepared[next(iter(_prepared))]
    surface_bytes, limit = found.surface.stats["bytes"], machine.memory_limit or found.available
    if surface_bytes + machine.threads * bytes_per_thread > limit:
        raise MemoryLimitError(
            f"{machine.name}: the prepared mesh takes {surface_bytes:,} bytes and each of {machine.threads} threads "
            f"{bytes_per_thread:,}, which is more than the limit of {limit:,}; "
            "use smaller chunks or shards, fewer threads, or more memory"
        )
    return found


def _prepare(source: Source, machine: Machine) -> Prepared:
    available = memory_left()
    surface = Surface(
        source.mesh,
        sign=source.sign,
        orientation=source.orientation,
        threads=machine.threads,
        memory_limit=machine.memory_limit,
    )
    return Prepared(surface, available)


def thread_bytes(dims: Whole3) -> int:
    """Returns the most bytes that a call of `distances` takes for a box of so many samples, with its result."""
    return _raymap.region_bytes(dims, core_options(threads=1))


def distances(
    prepared: Prepared,
    lattice: Lattice,
    low: Whole3,
    dims: Whole3,
    band: float | None,
    stop: threading.Event | None = None,
) -> npt.NDArray[np.float32]:
    """Returns the distances of a box of the lattice, (nx, ny, nz) with x fastest in memory.

    Each is that of `Surface.query` at its position, rounded to float32, whatever the box. Only one thread works.

    Args:
        prepared: The surface.
        lattice: The whole lattice.
        low: First sample of the box.
        dims: Number of its samples (nx, ny, nz).
        band: Number of samples at which distances are clamped; None = not clamped.
        stop: What another thread sets to cancel the work.

    Raises:
        Cancelled: ``stop`` was set.
    """
    region = prepared.surface.generate_region(
        low,
        dims,
        **_given(lattice),
        band=band,
        threads=1,
        progress=None if stop is None else lambda stage, share: not stop.is_set(),
    )
    return region.distance


def is_far_outside(prepared: Prepared, lattice: Lattice, low: Whole3, dims: Whole3, band: float) -> bool:
    """Returns whether a box lies outside and beyond the band, as far as a few queries tell."""
    distance = prepared.surface.far_distance(low, dims, **_given(lattice), band=band)
    return distance is not None and distance > 0


def _given(lattice: Lattice) -> dict[str, Any]:
    """Returns a lattice as the methods of a surface take it."""
    return {"origin": lattice.origin, "spacing": lattice.spacing, "dims": lattice.dims}

