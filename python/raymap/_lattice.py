"""Distances on lattices that no memory holds, box by box, on any thread of any machine."""

from __future__ import annotations

import hashlib
import math
import os
import socket
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap
from ._arguments import Vector, to_length
from ._errors import MemoryLimitError, UsageError
from ._generate import fit_grid
from ._mesh import Mesh, core_of
from ._records import Orientation
from ._repair import info
from ._surface import Surface

Whole3 = tuple[int, int, int]
_Samples = npt.NDArray[np.int64]

_SMALLEST = 4  # Side of the smallest cubes, in samples.
_POINTS_AT_A_TIME = 1 << 17
_BYTES_PER_POINT = 192  # Of a query: position, place, result, and what NumPy needs between them.
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

    def positions(self, samples: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        """Returns the positions of samples, (n, 3), which need not be whole."""
        return np.array(self.origin) + self.spacing * samples


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
    """Returns the source of distances to a mesh. It never changes, whatever becomes of the caller's arrays."""
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
    grid = fit_grid(
        fit, {"resolution": resolution, "voxel_size": voxel_size, "bounds": bounds, "padding": padding}
    )
    return Lattice(grid.dims, grid.origin, grid.spacing)


def to_width(lattice: Lattice, band: float | None) -> float:
    """Returns the distance at which samples are clamped, in the mesh's units."""
    return math.inf if band is None else to_length("band", band) * lattice.spacing


class Machine(NamedTuple):
    """What a process may use."""

    name: str
    """Name for messages."""
    threads: int
    """Number of boxes that it may compute at a time."""
    memory_limit: int
    """Most bytes that it may take."""


def this_machine() -> Machine:
    """Returns what this process may use: a worker of Dask, or any other process."""
    distributed: Any = sys.modules.get("distributed")
    if distributed is not None:
        try:
            worker = distributed.get_worker()
        except ValueError:  # This is no worker.
            worker = None
        if worker is not None:
            limit = worker.memory_manager.memory_limit or _available_memory()
            return Machine(f"the worker {worker.address} on {socket.gethostname()}", worker.state.nthreads, int(limit))
    return Machine("this machine", len(os.sched_getaffinity(0)), _available_memory())


def _available_memory() -> int:
    lines = Path("/proc/meminfo").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:"))


class Prepared(NamedTuple):
    """A surface, its size, and whether its sign changes at the surface alone."""

    surface: Surface
    diagonal: float
    is_whole: bool


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
    needed = found.surface.stats["bytes"] + machine.threads * bytes_per_thread
    if needed > machine.memory_limit:
        raise MemoryLimitError(
            f"{machine.name}: the prepared mesh takes {found.surface.stats['bytes']:,} bytes and each of "
            f"{machine.threads} threads {bytes_per_thread:,}, which is more than the limit of {machine.memory_limit:,}; "
            "use smaller chunks or shards, fewer threads, or more memory"
        )
    return found


def _prepare(source: Source, machine: Machine) -> Prepared:
    surface = Surface(
        source.mesh, sign=source.sign, orientation=source.orientation, memory_limit=machine.memory_limit
    )
    low, high = surface.mesh.bounds
    return Prepared(surface, float(np.linalg.norm(high - low)), not source.sign or _is_balanced(surface))


def _is_balanced(surface: Surface) -> bool:
    """Returns whether winding numbers are whole: whether the faces, as the sign takes them, use each edge equally often
    both ways."""
    faces = surface.mesh.faces.copy()
    turned = surface.stats["turned_faces"]
    faces[turned] = faces[turned, ::-1]
    faces = np.delete(faces, surface.stats["left_out_faces"], axis=0)
    return info(surface.mesh.vertices, faces, fast=True)["balanced"]


def box_bytes(dims: Whole3) -> int:
    """Returns the most bytes that `distances` takes for a box of so many samples, with its result."""
    return 4 * math.prod(dims) + _POINTS_AT_A_TIME * _BYTES_PER_POINT


def distances(prepared: Prepared, lattice: Lattice, low: Whole3, dims: Whole3, width: float) -> npt.NDArray[np.float32]:
    """Returns the distances of a box of the lattice, (nx, ny, nz) with x fastest in memory.

    Each is that of `Surface.query` with the width as `max_distance`, rounded to float32, whatever the box. Only one
    thread works. With a width, the time grows with the surface in the box, unless the mesh is open: then the sign may
    change far from the surface, and each sample is queried.

    Args:
        prepared: The surface.
        lattice: The whole lattice.
        low: First sample of the box.
        dims: Number of its samples (nx, ny, nz).
        width: Distance at which samples are clamped, in the mesh's units; infinite for none.
    """
    values = np.empty(dims, np.float32, order="F")
    first = np.array(low)
    if not math.isfinite(width) or not prepared.is_whole:
        flat = values.reshape(-1, order="F")
        for begin in range(0, flat.size, _POINTS_AT_A_TIME):
            places = np.arange(begin, min(begin + _POINTS_AT_A_TIME, flat.size))
            samples = np.stack(np.unravel_index(places, dims, order="F"), axis=1)
            flat[places] = _query(prepared.surface, lattice.positions(first + samples), width)
        return values
    values.fill(width)
    near = _fill_far(values, prepared, lattice, first, width)
    inner = np.stack(np.unravel_index(np.arange(_SMALLEST**3), (_SMALLEST,) * 3, order="F"), axis=1)
    for cubes in _batches(near, _POINTS_AT_A_TIME // _SMALLEST**3):
        samples = (cubes[:, None] + inner).reshape(-1, 3)
        samples = samples[(samples < dims).all(axis=1)]
        x, y, z = samples.T
        values[x, y, z] = _query(prepared.surface, lattice.positions(first + samples), width)
    return values


def _query(surface: Surface, positions: npt.NDArray[np.float64], most: float) -> npt.NDArray[np.float64]:
    found: npt.NDArray[np.float64] = surface.query(positions, max_distance=most, threads=1).distance
    return found


def _batches(rows: _Samples, count: int) -> Iterator[_Samples]:
    return (rows[begin : begin + count] for begin in range(0, len(rows), count))


def _fill_far(
    values: npt.NDArray[np.float32], prepared: Prepared, lattice: Lattice, first: _Samples, width: float
) -> _Samples:
    """Writes the far samples that lie inside. Returns the first samples of the smallest cubes that may be near.

    The distance of a cube's centre tells of most cubes that all of their samples lie beyond the width on one side. The
    others are halved.
    """
    side = max(_SMALLEST, 1 << (max(values.shape) - 1).bit_length())
    near = np.zeros((1, 3), np.int64)
    while True:
        kept = []
        for cubes in _batches(near, _POINTS_AT_A_TIME):
            found, is_far = _look(prepared, lattice, first + cubes, side, width)
            for x, y, z in cubes[is_far & (found < 0)].tolist():
                values[x : x + side, y : y + side, z : z + side] = -width
            kept.append(cubes[~is_far])
        near = np.concatenate(kept)
        if side == _SMALLEST or len(near) == 0:
            return near
        side //= 2
        near = (near[:, None] + side * np.stack(np.unravel_index(np.arange(8), (2, 2, 2)), axis=1)).reshape(-1, 3)
        near = near[(near < values.shape).all(axis=1)]


def _look(
    prepared: Prepared, lattice: Lattice, cubes: _Samples, side: int, width: float
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
    """Returns the distances of the centres of cubes, and whether all samples of a cube lie beyond the width.

    Distances are right within a millionth of the mesh's diagonal, or of the distance if that is larger.
    """
    radius = 0.5 * math.sqrt(3.0) * (side - 1) * lattice.spacing
    reach = radius + width + 4e-6 * (radius + width + prepared.diagonal)
    found = _query(prepared.surface, lattice.positions(cubes + 0.5 * (side - 1)), reach)
    return found, np.abs(found) >= reach
