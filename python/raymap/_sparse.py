"""Signed distance fields near the surface alone."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _raymap, _views
from ._arguments import to_box, to_length, to_number, to_path, to_text, to_vector
from ._errors import UsageError
from ._field import Field, core_of_field, field_of_core
from ._frames import IDENTITY, Frame
from ._grid_field import GridField
from ._options import array_options, core_options
from ._records import FieldArray

#: Width of a band in samples: on both sides of the surface, or inside and outside; None = 3.
Band = float | tuple[float, float] | None

# Options that a narrow band cannot honour, and their defaults.
_DENSE_ONLY: dict[str, Any] = {
    "distance": "exact",
    "passes": 5,
    "sampling": "raymap",
    "offsets": None,
    "invert": False,
    "close_holes": False,
    "thickness": None,
    "allow_empty": False,
}


class SparseField(GridField):
    """A signed distance field near a surface alone: a narrow band of samples, negative inside.

    ``raymap.generate(..., sparse=True)``, ``SparseField.load`` and ``from_dense`` return such fields. Their memory grows
    with the surface, so the grid may have more samples than any memory holds, up to 2^24 along each axis.

    Values are held in leaves of 8 x 8 x 8 samples. Value ``values[n, i, j, k]`` is that of the sample
    ``origins[n] + (i, j, k)``, which lies at ``origin + spacing * (origins[n] + (i, j, k))``. Samples in no leaf lie
    outside, at ``outside`` or farther, unless a tile holds them: tiles are cubes whose samples all lie inside, at
    ``inside`` or deeper. Leaves may reach beyond the grid; the samples there count as outside.

    Arrays are views of the library's memory without a copy. In memory x is fastest, as in ``raymap.Field``. What is
    written into ``values`` changes the field.

    >>> ball = raymap.generate("ball.ply", resolution=64, band=3, sparse=True)
    >>> ball
    raymap.SparseField(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
    >>> ball.values.shape, ball.origins.shape
    ((304, 8, 8, 8), (304, 3))
    >>> ball.sample([(0, 0, 0.95), (0, 0, 1.05)]).round(2)
    array([-0.05,  0.05], dtype=float32)
    """

    _core: _raymap.SparseField

    def __init__(self) -> None:
        raise TypeError(
            "raymap.generate(..., sparse=True), SparseField.load and SparseField.from_dense make narrow bands"
        )

    @classmethod
    def load(cls, path: str | os.PathLike[str], grid: str | None = None) -> SparseField:
        """Reads a level set of a .vdb or .nvdb, of raymap or any other program, negative inside.

        Time and memory grow with its leaves. What ``save`` wrote comes back bit for bit. The grid of another program's
        file begins and ends with whole leaves of 8 samples. Without ``grid``, a warning (``RaymapWarning``)
        names grids that are not read.

        Args:
            path: The file.
            grid: Name of the grid; None = the first level set.

        Raises:
            UsageError: Another extension, or no grid has that name; the message lists those of the file.
            FileError: The file cannot be read.
            InputError: Its content is not valid.
            UnsupportedError: For example a rotated grid, or one that is no level set.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).save("band.vdb")
        >>> raymap.SparseField.load("band.vdb")
        raymap.SparseField(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
        """
        return sparse_of_core(_raymap.load_band(to_path(path), to_text("grid", "" if grid is None else grid)))

    @classmethod
    def from_dense(
        cls, field: Field, band: Band = None, *, threads: int | None = None, memory_limit: int | None = None
    ) -> SparseField:
        """Returns the samples of a dense field near its surface, with all its arrays.

        Args:
            field: The dense field.
            band: Number of samples at which distances are clamped, or two numbers (inside, outside), of which the
                first may be infinite; None = 3.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            memory_limit: Most bytes that the narrow band may take; None = what is available.

        Raises:
            UsageError: The distances are clamped at less than ``band``, or numbers that make no sense.
            InputError: A distance is NaN.
            MemoryLimitError: The narrow band does not fit into memory.

        >>> raymap.SparseField.from_dense(raymap.generate("ball.ply", resolution=64), band=3)
        raymap.SparseField(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
        """
        options = core_options(
            _widths(band), **array_options(field.arrays), threads=threads, memory_limit=memory_limit
        )
        core = _raymap.to_sparse(core_of_field(field), options)
        return sparse_of_core(core, Frame(field.centre, field.scale))

    @property
    def origins(self) -> npt.NDArray[np.int32]:
        """First sample of each leaf, (n, 3) int32: x, y, z, multiples of 8, along a Morton curve. Read-only."""
        return self._core.origins()

    @property
    def values(self) -> npt.NDArray[np.float32]:
        """Distances in the mesh's units, (n, 8, 8, 8) float32, by leaf, x, y and z. Beyond the grid: far outside."""
        return self._array("distance")

    @property
    def tile_origins(self) -> npt.NDArray[np.int32]:
        """First sample of each cube inside without leaves, (m, 3) int32. Read-only."""
        return self._core.tile_origins()

    @property
    def tile_sides(self) -> npt.NDArray[np.int32]:
        """Number of samples along the side of each of these cubes, (m,) int32: 8 times a power of two. Read-only."""
        return self._core.tile_sides()

    @property
    def outside(self) -> float:
        """Distance at which distances outside are clamped, in the mesh's units."""
        return self._core.outside

    @property
    def inside(self) -> float:
        """The same inside, above 0; infinite if no distance inside is clamped."""
        return self._core.inside

    @property
    def active_count(self) -> int:
        """Number of samples whose distance is not clamped."""
        return self._core.active_count

    @property
    def nbytes(self) -> int:
        """Bytes that the field holds."""
        return self._core.nbytes

    def to_dense(self, *, threads: int | None = None, memory_limit: int | None = None) -> Field:
        """Returns the field of all samples.

        Samples in no leaf have the distance ``outside``, or ``-inside`` in a tile. They have ``raymap.NO_TRIANGLE`` for a
        triangle, and NaN for a winding number and a confidence.

        Args:
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            memory_limit: Most bytes that the field may take; None = what is available.

        Raises:
            MemoryLimitError: The field does not fit. The message says how many bytes it needs.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).to_dense()
        raymap.Field(64 x 64 x 64 samples, spacing 0.0375, arrays distance)
        """
        return field_of_core(self._core.to_dense(core_options(threads=threads, memory_limit=memory_limit)), self._frame)

    def denormalized(self) -> SparseField:
        """Returns the narrow band in the mesh's units and place: undoes ``normalize``, as ``Field.denormalized`` does.

        >>> band = raymap.generate("ball.ply", resolution=64, sparse=True, normalize="unit")
        >>> round(band.scale, 3), round(band.spacing, 5), round(band.denormalized().spacing, 5)
        (0.5, 0.01875, 0.0375)
        """
        bounds, single = self.surface_bounds, np.float32(self.scale)
        return _restore(
            self.shape,
            self._frame.back(self.origin),
            self.spacing / self.scale,
            float(np.float32(self.outside) / single),
            float(np.float32(self.inside) / single),
            None if bounds is None else to_box("surface_bounds", self._frame.back(bounds)),
            self.origins,
            self.tile_origins,
            self.tile_sides,
            {**self._named_arrays(), "distance": self.values / single},
        )

    def _named_arrays(self) -> dict[Any, npt.NDArray[Any]]:
        return {name: self._array(name) for name in self._core.arrays}

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes all arrays as .vdb or .nvdb, which grow with the surface. The file appears whole or not at all.

        ``SparseField.load`` reads it, and ``raymap.load_field`` as a dense field.

        Raises:
            UsageError: Another extension, or a normalized band: the files have no place for its centre and scale.
            FileError: The file cannot be written.
            UnsupportedError: This build cannot write .vdb and .nvdb.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).save("band.vdb")
        """
        if not self._frame.is_identity:
            text = "no file holds the centre and scale of a normalized narrow band; save band.denormalized()"
            raise UsageError(f"{to_path(path)}: {text}")
        self._core.save(to_path(path))

    def __repr__(self) -> str:
        return self._text(f"{len(self.origins)} leaves")

    def _repr_html_(self) -> str:
        rows = self._rows() | {
            "active samples": self.active_count,
            "leaves": f"{len(self.origins)} of 8 × 8 × 8 samples",
            "clamped at": f"-{self.inside:.6g} and {self.outside:.6g}, negative inside",
            "memory": f"{self.nbytes / 2**20:.4g} MiB",
        }
        return _views.html_table("raymap.SparseField", rows)

    def __reduce__(self) -> tuple[Any, ...]:
        placement = self.shape, self.origin, self.spacing, self.outside, self.inside, self._core.surface_bounds
        leaves = self.origins, self.tile_origins, self.tile_sides, self._named_arrays()
        return _restore, (*placement, *leaves, self._frame)


def core_of_sparse(field: SparseField) -> _raymap.SparseField:
    """Returns the narrow band as the extension module takes it."""
    return field._core


def sparse_of_core(core: _raymap.SparseField, frame: Frame = IDENTITY) -> SparseField:
    """Returns the field that the extension module has made."""
    made = SparseField.__new__(SparseField)
    made._hold(core, frame)
    return made


def band_options(given: Mapping[str, Any], sign: str) -> dict[str, float]:
    """Returns the widths of a narrow band. Refuses what it cannot honour of the arguments of ``raymap.generate``."""
    for name, default in _DENSE_ONLY.items():
        value = given.get(name)
        if value is not None and (default is None or value != default):
            raise UsageError(f"sparse=True makes a narrow band, which has no {name}; leave out one of the two")
    if sign not in ("harmonic", "none"):
        raise UsageError(f"sparse=True needs the sign 'harmonic' or 'none', not {sign!r}")
    if given.get("device", "auto") not in ("auto", "cpu"):
        raise UsageError(f"sparse=True makes the field on the CPU, not on {given.get('device')!r}")
    return _widths(given.get("band"))


def _widths(band: Any) -> dict[str, float]:
    if band is None:
        return {}
    if not (isinstance(band, (tuple, list)) or np.ndim(band) > 0):
        return dict.fromkeys(("inside", "outside"), to_length("band", band))
    if len(band) != 2:
        raise UsageError(f"band must be a number, or two numbers (inside, outside), not {len(band)} numbers")
    inside = to_number("band: the number inside", band[0], above=0.0)
    return {"inside": inside, "outside": to_length("band: the number outside", band[1])}


def _restore(
    shape: tuple[int, int, int],
    origin: npt.NDArray[np.float64],
    spacing: float,
    outside: float,
    inside: float,
    surface_bounds: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    origins: npt.NDArray[np.int32],
    tile_origins: npt.NDArray[np.int32],
    tile_sides: npt.NDArray[np.int32],
    arrays: dict[FieldArray, npt.NDArray[Any]],
    frame: Frame = IDENTITY,
) -> SparseField:
    """Makes a field of all that it holds."""
    whole = [np.ascontiguousarray(array, np.int32) for array in (origins, tile_origins, tile_sides)]
    core = _raymap.SparseField(shape, to_vector("origin", origin), spacing, outside, inside, surface_bounds, *whole)
    restored = SparseField.__new__(SparseField)
    restored._hold(core, frame)
    for name, array in arrays.items():
        restored._set(name, np.ascontiguousarray(array.transpose(0, 3, 2, 1)))  # x fastest
    core.validate()
    return restored
