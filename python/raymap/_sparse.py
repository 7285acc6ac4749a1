"""Signed distance fields near the surface alone."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from . import _arrays, _raymap, _views
from ._arguments import to_length, to_number, to_text, to_threads, to_vector
from ._devices import to_machine
from ._errors import UsageError
from ._field import Field, core_of_field, field_of_core
from ._mesh import Mesh, mesh_of_core
from ._pictures import slice_of, to_scene, to_view
from ._progress import Progress, reporting
from ._records import FieldArray

#: Samples at which the band ends, unless the caller says.
DEFAULT_BAND = 3.0

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


class SparseField:
    """A signed distance field near a surface alone: a narrow band of samples, negative inside.

    ``raymap.generate(..., sparse=True)``, ``SparseField.load`` and ``from_dense`` return such fields. Their memory grows with the
    surface, so the grid may have more samples than any memory holds, up to 2^24 along each axis.

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
        """Reads a level set of a .vdb, of raymap or any other program, negative inside.

        Time and memory grow with its leaves. What ``save`` wrote comes back bit for bit. The grid of another program's
        file begins and ends with whole leaves of 8 samples. A warning (``RaymapWarning``) names grids that are not read.

        Args:
            path: The file.
            grid: Name of the grid; None = the first level set.

        Raises:
            UsageError: Another extension, or no grid has that name.
            FileError: The file cannot be read.
            InputError: Its content is not valid.
            UnsupportedError: For example a rotated grid, or one that is no level set.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).save("band.vdb")
        >>> raymap.SparseField.load("band.vdb")
        raymap.SparseField(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
        """
        return sparse_of_core(_raymap.load_band(os.fspath(path), to_text("grid", "" if grid is None else grid)))

    @classmethod
    def from_dense(
        cls, field: Field, band: float = DEFAULT_BAND, *, threads: int | None = None, memory_limit: int | None = None
    ) -> SparseField:
        """Returns the samples of a dense field near its surface, with all its arrays.

        Args:
            field: The dense field.
            band: Number of samples at which distances are clamped.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            memory_limit: Most bytes that the narrow band may take; None = what is available.

        Raises:
            UsageError: The distances are clamped at less than ``band``.
            InputError: A distance is NaN.
            MemoryLimitError: The narrow band does not fit into memory.

        >>> raymap.SparseField.from_dense(raymap.generate("ball.ply", resolution=64), band=3)
        raymap.SparseField(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
        """
        options = _raymap.FieldOptions()
        options.band = to_length("band", band)
        options.triangle, options.winding, options.confidence = (
            name in field.arrays for name in ("triangle", "winding", "confidence")
        )
        machine = to_machine("cpu", threads, memory_limit)
        return sparse_of_core(_raymap.to_sparse(core_of_field(field), options, machine))

    def _array(self, name: str) -> npt.NDArray[Any]:
        array: Any = self._core.array(name)
        if array is None:
            raise AttributeError(f"the field has no {name!r}; ask for it, as in arrays=('distance', {name!r})")
        return np.asarray(array)

    @property
    def origins(self) -> npt.NDArray[np.int32]:
        """First sample of each leaf, (n, 3) int32: x, y, z, multiples of 8, along a Morton curve. Read-only."""
        return self._core.origins()

    @property
    def values(self) -> npt.NDArray[np.float32]:
        """Distances in the mesh's units, (n, 8, 8, 8) float32, by leaf, x, y and z. Beyond the grid: far outside."""
        return self._array("distance")

    @property
    def winding(self) -> npt.NDArray[np.float32]:
        """Winding numbers, (n, 8, 8, 8) float32, +1 inside a closed surface that faces outwards.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("winding")

    @property
    def confidence(self) -> npt.NDArray[np.float32]:
        """Confidences in the sign, (n, 8, 8, 8) float32, 0 to 1.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("confidence")

    @property
    def triangle(self) -> npt.NDArray[np.uint32]:
        """Indices of closest triangles, (n, 8, 8, 8) uint32; ``raymap.NO_TRIANGLE`` where the distance is clamped.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("triangle")

    @property
    def tile_origins(self) -> npt.NDArray[np.int32]:
        """First sample of each cube inside without leaves, (m, 3) int32. Read-only."""
        return self._core.tile_origins()

    @property
    def tile_sides(self) -> npt.NDArray[np.int32]:
        """Number of samples along the side of each of these cubes, (m,) int32: 8 times a power of two. Read-only."""
        return self._core.tile_sides()

    @property
    def arrays(self) -> tuple[str, ...]:
        """Names of the arrays that the field has: ``"distance"`` is ``values``."""
        return tuple(self._core.arrays)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of samples of the grid (nx, ny, nz)."""
        return self._core.dims

    @property
    def origin(self) -> npt.NDArray[np.float64]:
        """Position of sample (0, 0, 0), (3,)."""
        return np.array(self._core.origin)

    @property
    def spacing(self) -> float:
        """Distance between neighbouring samples, in the mesh's units; the same along x, y and z."""
        return self._core.spacing

    @property
    def outside(self) -> float:
        """Distance at which distances outside are clamped, in the mesh's units."""
        return self._core.outside

    @property
    def inside(self) -> float:
        """The same inside, above 0."""
        return self._core.inside

    @property
    def surface_bounds(self) -> npt.NDArray[np.float64] | None:
        """Bounds of the surface that distances lead to, (2, 3); None if they are not known."""
        bounds = self._core.surface_bounds
        return None if bounds is None else np.array(bounds)

    @property
    def active_count(self) -> int:
        """Number of samples whose distance is not clamped."""
        return self._core.active_count

    @property
    def nbytes(self) -> int:
        """Bytes that the field holds."""
        return self._core.nbytes

    def sample(self, points: Any, *, outside: Literal["bound", "nan"] = "bound", threads: int | None = None) -> Any:
        """Returns distances at any points, negative inside: (...) float32 for points (..., 3).

        Arguments, results and errors are those of ``Field.sample`` of the dense field, bit for bit.

        >>> ball = raymap.generate("ball.ply", resolution=64, sparse=True)
        >>> ball.sample([(0, 0, 0), (0, 0, 1), (0, 0, 9)]).round(2) + 0.0
        array([-0.11,  0.  ,  8.  ], dtype=float32)
        """
        return self._sample(points, False, outside, threads)

    def gradient(self, points: Any, *, outside: Literal["bound", "nan"] = "bound", threads: int | None = None) -> Any:
        """Returns gradients of the distance at any points, (..., 3) float32. They point outwards.

        Arguments, results and errors are those of ``Field.gradient`` of the dense field, bit for bit.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).gradient((0, 0, 1)).round(1) + 0.0
        array([0., 0., 1.], dtype=float32)
        """
        return self._sample(points, True, outside, threads)

    def _sample(self, points: Any, gradients: bool, outside: str, threads: int | None) -> Any:
        return _arrays.sampled(self._core, points, gradients, outside, to_threads(threads))

    def to_mesh(self, iso: float = 0.0, *, threads: int | None = None, progress: Progress = None) -> Mesh:
        """Returns the surface at distance ``iso`` as a closed mesh whose faces point outwards.

        It is the mesh of the dense field, bit for bit. Time and memory grow with the surface alone. Beyond 16384 samples
        along a side of the grid, the float32 of the vertices is too coarse.

        Args:
            iso: Distance of the surface in the mesh's units, between ``-inside`` and ``outside``.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: There is no surface at ``iso``.
            InputError: A value is not finite.
            MemoryLimitError: The mesh does not fit into memory.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).to_mesh().bounds.round(1)
        array([[-1., -1., -1.],
               [ 1.,  1.,  1.]])
        """
        with reporting(progress) as report:
            return mesh_of_core(_raymap.isosurface(self._core, to_number("iso", iso), to_threads(threads), report))

    def slice(
        self,
        axis: int | Literal["x", "y", "z"],
        index: int | None = None,
        *,
        array: FieldArray = "distance",
        width: int = 512,
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of a slice, (h, w, 3) uint8, rows from the top.

        Arguments, results and errors are those of ``Field.slice`` of the dense field, bit for bit. Where a sample is in
        no leaf, winding numbers and confidences are not known and violet, and triangles light grey.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).slice("z", width=100).shape
        (100, 100, 3)
        """
        return slice_of(self._core, axis, index, array, width)

    def render(
        self,
        *,
        width: int = 1024,
        height: int = 768,
        direction: tuple[float, float, float] = (-0.6, -0.45, -1.0),
        up: tuple[float, float, float] = (0.0, 1.0, 0.0),
        field_of_view: float = 30.0,
        cut: bool = False,
        shell: float = 0.0,
        eye: tuple[float, float, float] | None = None,
        iso: float = 0.0,
        cut_plane: tuple[float, float, float, float] | None = None,
        slice_plane: tuple[float, float, float, float] | None = None,
        frame: npt.ArrayLike | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of the surface by sphere tracing, (h, w, 3) uint8, rows from the top.

        Rays pass cubes of samples without leaves at once. Distances beyond the band are not known, so ``iso`` lies
        between ``-inside`` and ``outside``, and ``shell`` is less than ``inside``. All other arguments are those of
        ``Field.render``. The CPU draws.

        Raises:
            UsageError: Arguments that make no picture.
            InputError: A value is not finite.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).render(width=64, height=48).shape
        (48, 64, 3)
        """
        options = to_scene(
            to_view(width, height, direction, up, field_of_view),
            cut=cut,
            shell=shell,
            eye=eye,
            iso=iso,
            cut_plane=cut_plane,
            slice_plane=slice_plane,
            frame=frame,
        )
        with reporting(progress) as report:
            return _raymap.render_field(self._core, options, to_machine("cpu", threads), report)

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
        return field_of_core(self._core.to_dense(to_machine("cpu", threads, memory_limit)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes all arrays as .vdb, whose size grows with the surface. The file appears whole or not at all.

        ``SparseField.load`` reads it, and ``raymap.load_field`` as a dense field.

        Raises:
            UsageError: Another extension.
            FileError: The file cannot be written.
            UnsupportedError: This build cannot write .vdb.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).save("band.vdb")
        """
        self._core.save(os.fspath(path))

    def __repr__(self) -> str:
        nx, ny, nz = self.shape
        return (
            f"raymap.SparseField({nx} x {ny} x {nz} samples, {len(self.origins)} leaves, "
            f"spacing {self.spacing:.6g}, arrays {', '.join(self.arrays)})"
        )

    def _repr_html_(self) -> str:
        rows: dict[str, Any] = {
            "samples": " × ".join(str(n) for n in self.shape),
            "active samples": self.active_count,
            "leaves": f"{len(self.origins)} of 8 × 8 × 8 samples",
            "spacing": self.spacing,
            "origin": ", ".join(f"{v:.6g}" for v in self.origin),
            "arrays": ", ".join(self.arrays),
            "clamped at": f"-{self.inside:.6g} and {self.outside:.6g}, negative inside",
            "memory": f"{self.nbytes / 2**20:.4g} MiB",
        }
        return _views.html_table("raymap.SparseField", rows)

    def __reduce__(self) -> tuple[Any, ...]:
        arrays = {name: self._array(name) for name in self.arrays}
        placement = self.shape, self.origin, self.spacing, self.outside, self.inside, self._core.surface_bounds
        return _restore, (*placement, self.origins, self.tile_origins, self.tile_sides, arrays)


def sparse_of_core(core: _raymap.SparseField) -> SparseField:
    """Returns the field that the extension module has made."""
    made = SparseField.__new__(SparseField)
    made._core = core
    return made


def sparse_options(given: Mapping[str, Any], options: _raymap.FieldOptions) -> _raymap.FieldOptions:
    """Returns the options of a field as those of a narrow band. Refuses what it cannot honour."""
    for name, default in _DENSE_ONLY.items():
        value = given.get(name)
        if value is not None and (default is None or value != default):
            raise UsageError(f"sparse=True makes a narrow band, which has no {name}; leave out one of the two")
    if options.sign not in ("harmonic", "none"):
        raise UsageError(f"sparse=True needs the sign 'harmonic' or 'none', not {options.sign!r}")
    if given.get("device", "auto") not in ("auto", "cpu"):
        raise UsageError(f"sparse=True makes the field on the CPU, not on {given.get('device')!r}")
    if given.get("band") is None:
        options.band = DEFAULT_BAND
    return options


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
) -> SparseField:
    """Makes a field of what was pickled."""
    whole = [np.ascontiguousarray(array, np.int32) for array in (origins, tile_origins, tile_sides)]
    core = _raymap.SparseField(shape, to_vector("origin", origin), spacing, outside, inside, surface_bounds, *whole)
    for name, array in arrays.items():
        ordered = np.ascontiguousarray(array.transpose(0, 3, 2, 1))  # x fastest
        (core.set_wholes if name == "triangle" else core.set_floats)(name, ordered)
    core.validate()
    return sparse_of_core(core)
