"""Fields as lazy arrays of Dask, larger than the memory of any machine.

>>> import raymap.dask  # doctest: +SKIP
>>> field = raymap.dask.field("ball.ply", resolution=8192, band=3)  # doctest: +SKIP
>>> field.distance[4000:4100, 4096, 4096].compute()  # doctest: +SKIP
"""

from __future__ import annotations

import importlib
import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._arguments import Vector, Whole3, to_whole
from ._errors import UsageError
from ._lattice import (
    Lattice,
    Source,
    distances,
    make_lattice,
    make_source,
    prepare,
    this_machine,
    thread_bytes,
    to_band,
)
from ._records import Orientation

try:
    dask: Any = importlib.import_module("dask")  # Any, so that types are the same with Dask and without.
    array: Any = importlib.import_module("dask.array")
except ImportError as error:
    raise ImportError("raymap.dask needs Dask; install it with: pip install 'raymap[dask]'") from error


class LazyField(NamedTuple):
    """Result of ``raymap.dask.field``."""

    distance: Any
    """Lazy ``dask.array`` of distances, (nx, ny, nz) float32, in the mesh's units, negative inside."""
    origin: Vector
    """Position of sample (0, 0, 0), in the mesh's units."""
    spacing: float
    """Distance between neighbouring samples, in the mesh's units."""
    clamp_distance: float
    """Distance at which samples are clamped, in the mesh's units; 0 = not clamped."""


def field(
    mesh: Any,
    *,
    resolution: int = 8192,
    voxel_size: float | None = None,
    bounds: npt.ArrayLike | None = None,
    padding: float = 0.1,
    chunks: int | Whole3 = 256,
    band: float | None = None,
    sign: bool = True,
    orientation: Orientation = "auto",
) -> LazyField:
    """Returns the signed distance field of a mesh as a lazy array of Dask, negative inside.

    Nothing is computed before Dask asks for it, on this machine or on a cluster. Then each process prepares the mesh
    once, and its threads share it. Each chunk is computed by one thread. A sample has the distance of
    ``raymap.Surface.query`` at its position, ``origin + spacing * (i, j, k)``, rounded to float32, whatever the chunks.

    With a band, the time grows with the surface: a chunk that holds none of it costs a few queries.

    Args:
        mesh: A mesh or path as for ``raymap.Surface``. Workers get its arrays, so they need no file.
        resolution: Number of samples along the longest side of the lattice. Without effect if ``voxel_size`` is given.
        voxel_size: Distance between samples, in the mesh's units.
        bounds: Box to cover, ((x0, y0, z0), (x1, y1, z1)), in the mesh's units; None = the mesh's bounds, padded. Cubic
            cells fill it; samples are their centres.
        padding: Padding of the mesh's bounds on every side, as a share of their longest side.
        chunks: Number of samples along the sides of a chunk, one number or (x, y, z).
        band: Number of samples at which distances are clamped; None = not clamped.
        sign: Whether to tell inside from outside; without, distances are not negative.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, ``"keep"`` or ``"repair"``.

    Raises:
        InputError: The mesh is not valid.
        UsageError: Arguments that make no sense. While Dask computes: a worker has another version of raymap.
        FileError: The file cannot be read.
        MemoryLimitError: While Dask computes: the prepared mesh and a chunk for each thread exceed a worker's memory.

    >>> field = raymap.dask.field("ball.ply", resolution=64, chunks=32, band=3)
    >>> field.distance.shape, field.distance.dtype, field.distance.numblocks
    ((64, 64, 64), dtype('float32'), (2, 2, 2))
    >>> bool(field.distance[32, 32, 32].compute() == np.float32(-3 * field.spacing))
    True
    """
    source = make_source(mesh, sign, orientation)
    lattice = make_lattice(source, resolution, voxel_size, bounds, padding)
    samples = to_band(band)
    sides = _sides(chunks)
    name = f"raymap-field-{dask.base.tokenize(source.key, lattice, samples, sides)}"
    made = array.map_blocks(
        _chunk,
        dask.delayed(source, name=f"raymap-mesh-{source.key}", pure=True, traverse=False),
        lattice,
        sides,
        samples,
        chunks=array.core.normalize_chunks(sides, lattice.dims),
        dtype=np.float32,
        meta=np.empty((0, 0, 0), np.float32),
        name=name,
    )
    return LazyField(made, lattice.origin, lattice.spacing, (samples or 0.0) * lattice.spacing)


def _sides(chunks: int | Whole3) -> Whole3:
    sides = (chunks,) * 3 if isinstance(chunks, int) else tuple(chunks)
    if len(sides) != 3:
        raise UsageError(f"chunks must be a number or (x, y, z), not {chunks}")
    x, y, z = (to_whole("chunks", side, least=1) for side in sides)
    if math.prod((x, y, z)) > 2**31:
        raise UsageError(f"a chunk of {x} x {y} x {z} samples is too large; give chunks of 512 or less")
    return x, y, z


def _chunk(
    source: Source, lattice: Lattice, sides: Whole3, band: float | None, block_id: Whole3
) -> npt.NDArray[np.float32]:
    """Returns the distances of a chunk."""
    low = tuple(k * side for k, side in zip(block_id, sides, strict=True))
    dims = tuple(min(side, count - first) for side, count, first in zip(sides, lattice.dims, low, strict=True))
    prepared = prepare(source, this_machine(), thread_bytes(sides))
    return distances(prepared, lattice, low, dims, band)  # type: ignore[arg-type]
