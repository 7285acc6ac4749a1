"""Signed distance fields."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

from . import _arrays, _html, _inputs, _raymap, _views
from ._arguments import FINITE, to_box, to_length, to_number, to_path, to_text, to_threads, to_vector, to_whole
from ._arrays import Points, SampleOptions, Singles
from ._errors import InputError, UsageError
from ._frames import IDENTITY, Frame, frame_arrays, read_frame, to_frame
from ._mesh import Mesh, core_of, mesh_of_core
from ._options import array_options, check_names, core_options
from ._pictures import ViewOptions
from ._progress import Progress, reporting
from ._records import Comparison, FieldArray, Stats
from ._typing import Unpack
from ._whole_file import save_with_arrays

#: Value of ``Field.triangle`` where the distance is clamped, and where surface that closes a hole is closer.
NO_TRIANGLE = 0xFFFFFFFF

#: Width of a band in samples: on both sides of the surface, or inside and outside; None = 3.
Band = float | tuple[float, float] | None

# Options that a narrow band cannot honour, and their defaults.
_DENSE_ONLY: dict[str, Any] = {
    "distance": "exact",
    "passes": 5,
    "sampling": "spread",
    "offsets": None,
    "invert": False,
    "close_holes": False,
    "thickness": None,
    "allow_empty": False,
}


class PageOptions(ViewOptions, total=False):
    """Keyword arguments of ``to_html`` and ``show``."""

    title: str
    mesh: Any
    other: Field
    other_title: str
    array: FieldArray
    max_size: int
    device: str
    threads: int | None
    progress: Progress


class Field:
    """A signed distance field, negative inside: distances on a regular grid.

    ``raymap.generate`` and ``raymap.load_field`` return fields. To make one of an array of your own, give it to
    this class, which copies it. A narrow band is a field of the samples near the surface alone (see ``is_narrow``).

    Sample (i, j, k) lies at ``origin + spacing * (i, j, k)``. Arrays have the shape (nx, ny, nz), i along x. In memory
    x is fastest (NumPy's Fortran order). They are views of the library's memory without a copy; what is written into
    them changes the field, but not ``surface_bounds``: if it moves the surface, make a new field of the array.

    The memory of a narrow band grows with the surface, so its grid may have more samples than any memory holds, up to
    2^24 along each axis. ``raymap.generate(..., sparse=True)``, ``raymap.load_field(..., sparse=True)`` and ``to_sparse``
    make them. Values are held in leaves of 8 x 8 x 8 samples: arrays have the shape (n, 8, 8, 8), and value
    ``distance[n, i, j, k]`` is that of the sample ``origins[n] + (i, j, k)``. Samples in no leaf lie outside, at
    ``outside`` or farther, unless a tile holds them: tiles are cubes whose samples all lie inside, at ``inside`` or
    deeper. Leaves may reach beyond the grid; the samples there are outside.

    Args:
        distance: Distances, (nx, ny, nz), negative inside.
        origin: Position of sample (0, 0, 0).
        spacing: Distance between neighbouring samples, in the mesh's units.
        clamp_distance: Distance at which the distances are clamped, in the mesh's units; 0 = not clamped.
        surface_bounds: Box that holds the whole surface, ((x0, y0, z0), (x1, y1, z1)); None = not known. ``sample``
            uses it outside of the grid.
        winding: Winding numbers, of the same shape.
        confidence: Confidences in the sign, of the same shape.
        triangle: Indices of closest triangles, of the same shape.
        centre: Point of the mesh that lies at 0 in this field.
        scale: Length in this field of one unit of the mesh.

    Raises:
        UsageError: The arrays are not of one shape with three dimensions, or the grid makes no sense.
        InputError: The centre or the scale makes no sense, or an array has other numbers.

    >>> x, y, z = np.mgrid[-2:3, -2:3, -2:3]
    >>> ball = raymap.Field(np.sqrt(x**2 + y**2 + z**2) - 1.5, origin=(-2, -2, -2))
    >>> ball
    raymap.Field(5 x 5 x 5 samples, spacing 1, arrays distance)
    >>> float(ball.distance[2, 2, 2])
    -1.5
    >>> band = raymap.generate("ball.ply", resolution=64, band=3, sparse=True)
    >>> band
    raymap.Field(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
    >>> band.distance.shape, band.origins.shape
    ((304, 8, 8, 8), (304, 3))
    >>> band.sample([(0, 0, 0.95), (0, 0, 1.05)]).round(2)
    array([-0.05,  0.05], dtype=float32)
    """

    def __init__(
        self,
        distance: npt.ArrayLike,
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
        spacing: float = 1.0,
        *,
        clamp_distance: float = 0.0,
        surface_bounds: npt.ArrayLike | None = None,
        winding: npt.ArrayLike | None = None,
        confidence: npt.ArrayLike | None = None,
        triangle: npt.ArrayLike | None = None,
        centre: npt.ArrayLike = (0.0, 0.0, 0.0),
        scale: float = 1.0,
    ) -> None:
        arrays = {"distance": distance, "winding": winding, "confidence": confidence, "triangle": triangle}
        shape = np.shape(_arrays.to_numpy("distance", distance))
        if len(shape) != 3 or 0 in shape:
            raise UsageError(f"distance must be (nx, ny, nz), not of the shape {shape}")
        box = None if surface_bounds is None else to_box("surface_bounds", surface_bounds)
        clamp = to_number("clamp_distance", clamp_distance, least=0.0, most=FINITE)
        core = _raymap.Field(shape, to_vector("origin", origin), to_length("spacing", spacing), clamp, box)
        self._hold(core, to_frame(centre, scale))
        for name, array in arrays.items():
            if array is not None:
                given = _arrays.to_numpy(name, array)
                if given.shape != shape:
                    raise UsageError(f"{name} must have the shape of distance, {shape}, not {given.shape}")
                self._set(name, _ordered(name, given))
        core.validate()

    def _hold(self, core: _raymap.Field, frame: Frame, stats: Stats | None = None) -> None:
        self._core, self._frame = core, frame
        self._views: dict[str, npt.NDArray[Any]] = {}
        self._stats: Stats = stats or core.stats()  # type: ignore[assignment]

    def _array(self, name: str) -> npt.NDArray[Any]:
        if name in self._views:
            return self._views[name]
        array: Any = self._core.array(name)
        if array is None:
            raise AttributeError(f"the field has no {name!r}; ask for it, as in arrays=('distance', {name!r})")
        return self._views.setdefault(name, array)

    def _set(self, name: str, ordered: npt.NDArray[Any]) -> None:
        """Copies an array that has the types and the order in memory of the library."""
        numbers = "wholes" if name == "triangle" else "floats"
        getattr(self._core, f"set_leaf_{numbers}" if self.is_narrow else f"set_{numbers}")(name, ordered)

    @property
    def distance(self) -> npt.NDArray[np.float32]:
        """Distances in the mesh's units, float32, negative inside, positive outside.

        The shape is (nx, ny, nz), or (n, 8, 8, 8) of a narrow band: by leaf, x, y and z. Its samples beyond the grid
        are far outside.
        """
        return self._array("distance")

    @property
    def winding(self) -> npt.NDArray[np.float32]:
        """Winding numbers, float32, +1 inside a closed surface that faces outwards. Their shape is that of the distances.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("winding")

    @property
    def confidence(self) -> npt.NDArray[np.float32]:
        """Confidences in the sign, float32, 0 to 1. Their shape is that of the distances.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("confidence")

    @property
    def triangle(self) -> npt.NDArray[np.uint32]:
        """Indices of closest triangles, uint32; ``raymap.NO_TRIANGLE`` where the distance is clamped.

        Their shape is that of the distances.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("triangle")

    @property
    def stats(self) -> Stats:
        """Cost of the field, and findings about the mesh: 0 for a field from a file or an array."""
        return self._stats

    @property
    def arrays(self) -> tuple[str, ...]:
        """Names of the arrays that the field has."""
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
    def centre(self) -> npt.NDArray[np.float64]:
        """Point of the mesh that lies at 0 in this field, (3,); 0 unless ``normalize`` moved the mesh."""
        return self._frame.centre.copy()

    @property
    def scale(self) -> float:
        """Length in this field of one unit of the mesh: field's positions = (mesh's positions - centre) * scale."""
        return self._frame.scale

    @property
    def surface_bounds(self) -> npt.NDArray[np.float64] | None:
        """Bounds of the surface that distances lead to, (2, 3); None if they are not known."""
        bounds = self._core.surface_bounds
        return None if bounds is None else np.array(bounds)

    @property
    def clamp_distance(self) -> float:
        """Distance at which distances are clamped, in the mesh's units; 0 = not clamped. Of a narrow band that of its
        narrower side.
        """
        return self._core.clamp_distance

    @property
    def active_count(self) -> int:
        """Number of samples with values whose distance is not clamped."""
        return self._core.active_count

    @property
    def nbytes(self) -> int:
        """Bytes that the field holds."""
        return self._core.nbytes

    @property
    def is_narrow(self) -> bool:
        """Whether the field is a narrow band: has values near its surface alone."""
        return self._core.is_narrow

    def _band(self, name: str) -> _raymap.Field:
        """Returns the core of a narrow band, for its property of this name."""
        if not self.is_narrow:
            raise AttributeError(f"the field is dense, and only a narrow band has {name!r}; to_sparse makes one of it")
        return self._core

    @property
    def origins(self) -> npt.NDArray[np.int32]:
        """First sample of each leaf of a narrow band, (n, 3) int32: multiples of 8, along a Morton curve. Read-only."""
        return self._band("origins").origins()

    @property
    def tile_origins(self) -> npt.NDArray[np.int32]:
        """First sample of each cube inside a narrow band without leaves, (m, 3) int32. Read-only."""
        return self._band("tile_origins").tile_origins()

    @property
    def tile_sides(self) -> npt.NDArray[np.int32]:
        """Number of samples along the side of each of these cubes, (m,) int32: 8 times a power of two. Read-only."""
        return self._band("tile_sides").tile_sides()

    @property
    def outside(self) -> float:
        """Distance at which distances outside are clamped in a narrow band, in the mesh's units."""
        return self._band("outside").outside

    @property
    def inside(self) -> float:
        """The same inside, above 0; infinite if no distance inside is clamped."""
        return self._band("inside").inside

    @overload
    def sample(self, points: Points, **options: Unpack[SampleOptions]) -> Singles: ...
    @overload
    def sample(self, points: Any, **options: Unpack[SampleOptions]) -> Any: ...
    def sample(self, points: Any, *, outside: Literal["bound", "nan"] = "bound", threads: int | None = None) -> Any:
        """Returns distances at any points, negative inside: (...) float32 for points (..., 3).

        Within the box of the samples the distance is trilinear between the eight samples around a point. It is NaN for
        points that are NaN. A narrow band gives, bit for bit, what its dense field does.

        Outside of the box, it is a lower bound of the signed distance, also where the box cuts the mesh: the largest
        distance of a sample around the closest point of the box, less the way from there. Outside of
        ``surface_bounds`` it is at least the distance to them. If the box holds them, it is nearly the distance. If
        they are not known, or reach there, it falls below 0 farther out: the mesh may be there. Across the holes of an
        open mesh the sign jumps, and the bound may be too large.

        Args:
            points: Positions in the mesh's units: NumPy, or any array with ``__dlpack__``. PyTorch, JAX and CuPy get
                arrays of their own back, on the same device.
            outside: Result outside of the box: ``"bound"``, or ``"nan"``.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.

        Raises:
            InputError: Points of another shape.
            UsageError: ``outside`` is something else.

        >>> ball = raymap.generate("ball.ply", resolution=32)
        >>> ball.sample([(0, 0, 0), (0, 0, 1.1), (0, 0, 9)]).round(2)
        array([-0.93,  0.1 ,  8.  ], dtype=float32)
        >>> ball.sample((0, 0, 9), outside="nan")
        array(nan, dtype=float32)
        """
        return self._sample(points, False, outside, threads)

    @overload
    def gradient(self, points: Points, **options: Unpack[SampleOptions]) -> Singles: ...
    @overload
    def gradient(self, points: Any, **options: Unpack[SampleOptions]) -> Any: ...
    def gradient(self, points: Any, *, outside: Literal["bound", "nan"] = "bound", threads: int | None = None) -> Any:
        """Returns gradients of the distance at any points, (..., 3) float32. They point outwards.

        A gradient is the central difference of the distance over one spacing to either side. Its length is close to 1,
        but less where surfaces are equally near, and 0 where distances are clamped. Outside of the box of the samples it
        leads away from the box.

        Args:
            points: Positions in the mesh's units, (..., 3), as for ``sample``.
            outside: ``"nan"`` for NaN outside of the box.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.

        Raises:
            InputError: Points of another shape.

        >>> ball = raymap.generate("ball.ply", resolution=32)
        >>> ball.gradient((0, 0, 1)).round(1) + 0.0
        array([0., 0., 1.], dtype=float32)
        """
        return self._sample(points, True, outside, threads)

    def _sample(self, points: Any, gradients: bool, outside: str, threads: int | None) -> Any:
        if outside not in ("bound", "nan"):
            raise UsageError(f"outside must be 'bound' or 'nan', not {outside!r}")
        flat, shape = _arrays.to_points(points, "sample(field, points)")
        result = self._core.sample(flat, gradients, outside == "nan", to_threads(threads))
        return _arrays.like(result.reshape(shape if gradients else shape[:-1]), points)

    def to_mesh(self, iso: float = 0.0, *, threads: int | None = None, progress: Progress = None) -> Mesh:
        """Returns the surface at distance ``iso`` as a closed mesh whose faces point outwards.

        Every edge has exactly two faces. Corners and sharp edges are kept (dual contouring). A narrow band gives, bit for
        bit, the mesh of its dense field, but time and memory grow with the surface alone. Beyond 16384 samples along a
        side of the grid, the float32 of the vertices is too coarse.

        Args:
            iso: Distance of the surface in the mesh's units; above 0 outside of the shape. In a narrow band, between
                ``-inside`` and ``outside``.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: There is no surface at ``iso``.
            InputError: A sample is not finite.
            MemoryLimitError: The mesh does not fit into memory.

        >>> raymap.generate("ball.ply", resolution=16).to_mesh(iso=0.1).bounds.round(1)
        array([[-1.1, -1.1, -1.1],
               [ 1.1,  1.1,  1.1]])
        """
        with reporting(progress) as report:
            return mesh_of_core(_raymap.isosurface(self._core, core_options(iso=iso, threads=threads), report))

    def slice(
        self,
        axis: int | Literal["x", "y", "z"],
        index: int | None = None,
        *,
        array: FieldArray = "distance",
        width: int = 512,
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of a slice, (h, w, 3) uint8, rows from the top.

        Outside is warm, inside cool; thin lines mark round distances, a thick line zero. Across x, y points right and
        z up; across y, x right and z up; across z, x right and y up.

        A narrow band gives, bit for bit, the slice of its dense field. Where a sample is in no leaf, winding numbers and
        confidences are not known and violet, and triangles light grey.

        Args:
            axis: Axis that the slice crosses: 0, 1, 2 or "x", "y", "z".
            index: Sample along this axis; negative ones count from the end; None = the middle.
            array: Array to draw.
            width: Width in pixels.

        Raises:
            UsageError: No such axis, sample or array.

        >>> raymap.generate("ball.ply", resolution=16).slice("z", width=100).shape
        (100, 100, 3)
        >>> raymap.generate("ball.ply", resolution=64, sparse=True).slice("z", width=100).shape
        (100, 100, 3)
        """
        if axis not in (0, 1, 2, "x", "y", "z"):
            raise UsageError(f"axis must be 0, 1, 2, 'x', 'y' or 'z', not {axis!r}")
        number = "xyz".index(axis) if isinstance(axis, str) else int(axis)
        count = self.shape[number]
        if index is not None and not -count <= index < count:
            raise UsageError(f"index {index} is out of range: the field has {count} samples along {'xyz'[number]}")
        chosen = -1 if index is None else index % count
        return _raymap.render_slice(self._core, number, chosen, to_whole("width", width), to_text("array", array))

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
        device: str = "auto",
        threads: int | None = None,
        progress: Progress = None,
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of the surface by sphere tracing, (h, w, 3) uint8, rows from the top.

        Rays pass cubes without leaves of a narrow band at once. Distances beyond the band are not known, so ``iso`` lies
        between ``-inside`` and ``outside``, and ``shell`` is less than ``inside``.

        Args:
            width: Width of the picture, in pixels.
            height: Height of the picture, in pixels.
            direction: Direction from the camera to the centre of the shape.
            up: Direction up in the picture; the floor is perpendicular to it.
            field_of_view: Angle from the bottom to the top of the picture, in degrees.
            cut: Whether to remove the half before the middle plane, as in the paper's figure 1. The cut face shows the
                distance inside.
            shell: Thickness of the outer wall of a hollow shape, in the mesh's units; 0 = not hollow.
            eye: Place of the camera, in the mesh's units, instead of one from which the shape fills the picture.
            iso: Distance at which the surface lies, in the mesh's units.
            cut_plane: Plane of a cut, instead of the middle one, as (nx, ny, nz, offset): all points p with dot(n, p) =
                offset. What lies on the side of the normal is removed.
            slice_plane: Plane on which distances are drawn in the colours and with the lines of ``slice``.
            frame: Box that the camera frames instead of the shape, ((x0, y0, z0), (x1, y1, z1)). Pictures of a moving
                shape share one, so that the camera stands still.
            device: Device that computes: ``"cpu"``; ``"vulkan:K"``, the Kth Vulkan device; ``"vulkan"``, the best of
                them, which may be a software rasterizer; ``"auto"``, a real GPU if one is usable, else the CPU.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: Arguments that make no picture.
            InputError: A sample is not finite.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.render(width=64, height=48).shape
        (48, 64, 3)
        >>> raymap.generate("ball.ply", resolution=64, sparse=True).render(width=64, height=48).shape
        (48, 64, 3)
        >>> field.render(width=64, height=48, eye=(3, 1, 2), direction=(-3, -1, -2), cut_plane=(0, 0, 1, 0.4)).shape
        (48, 64, 3)
        """
        given = {name: value for name, value in locals().items() if name not in ("self", "progress")}
        with reporting(progress) as report:
            return _raymap.render_field(self._core, core_options(given), report)

    def to_sparse(self, band: Band = None, *, threads: int | None = None, memory_limit: int | None = None) -> Field:
        """Returns the samples near the surface as a narrow band, with all arrays.

        Args:
            band: Number of samples at which distances are clamped, or two numbers (inside, outside), of which the
                first may be infinite; None = 3.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            memory_limit: Most bytes that the narrow band may take; None = what is available.

        Raises:
            UsageError: The field is a narrow band, its distances are clamped at less than ``band``, or numbers that make
                no sense.
            InputError: A distance is NaN.
            MemoryLimitError: The narrow band does not fit into memory.

        >>> raymap.generate("ball.ply", resolution=64).to_sparse(band=3)
        raymap.Field(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
        """
        options = core_options(_widths(band), **array_options(self.arrays), threads=threads, memory_limit=memory_limit)
        return field_of_core(self._core.to_sparse(options), self._frame)

    def to_dense(self, *, threads: int | None = None, memory_limit: int | None = None) -> Field:
        """Returns the field of all samples of a narrow band.

        Samples in no leaf have the distance ``outside``, or ``-inside`` in a tile. They have ``raymap.NO_TRIANGLE`` for a
        triangle, and NaN for a winding number and a confidence.

        Args:
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            memory_limit: Most bytes that the field may take; None = what is available.

        Raises:
            UsageError: The field is dense.
            MemoryLimitError: The field does not fit. The message says how many bytes it needs.

        >>> raymap.generate("ball.ply", resolution=64, sparse=True).to_dense()
        raymap.Field(64 x 64 x 64 samples, spacing 0.0375, arrays distance)
        """
        return field_of_core(self._core.to_dense(core_options(threads=threads, memory_limit=memory_limit)), self._frame)

    def denormalized(self) -> Field:
        """Returns the field in the mesh's units and place: undoes ``normalize``.

        Positions and distances become float32 and float64 again as far as these can hold them: a sample's position is
        ``position / scale + centre``, its distance ``distance / scale``. All other arrays stay as they are.

        >>> field = raymap.generate("ball.ply", resolution=16, normalize="unit")
        >>> field.scale.__round__(3), field.spacing.__round__(3), field.denormalized().spacing.__round__(3)
        (0.5, 0.075, 0.15)
        """
        bounds, single = self.surface_bounds, np.float32(self.scale)
        band: tuple[Any, ...] | None = None
        if self.is_narrow:
            widths = (float(np.float32(width) / single) for width in (self.outside, self.inside))
            band = (*widths, self.origins, self.tile_origins, self.tile_sides)
        arrays = {name: self._array(name) for name in self.arrays}
        return _restore(
            self.shape,
            self._frame.back(self.origin),
            self.spacing / self.scale,
            0.0 if band else self.clamp_distance / self.scale,
            None if bounds is None else to_box("surface_bounds", self._frame.back(bounds)),
            band,
            arrays | {"distance": self.distance / single},
            self._stats,
        )

    def tsdf(self) -> npt.NDArray[np.float32]:
        """Returns the truncated distances divided by the truncation, float32 from -1 to 1, negative inside.

        Raises:
            UsageError: The distances are not clamped.

        >>> field = raymap.generate("ball.ply", resolution=16, truncation=0.3)
        >>> field.tsdf().min(), field.tsdf().max()
        (np.float32(-1.0), np.float32(1.0))
        """
        if self.clamp_distance == 0:
            raise UsageError("tsdf() needs clamped distances; make the field with truncation= or band=")
        divided: npt.NDArray[np.float32] = self.distance / np.float32(self.clamp_distance)
        return divided.clip(-1, 1)

    def save(self, path: str | os.PathLike[str], array: FieldArray = "distance") -> None:
        """Writes .vdb, .nvdb, .nrrd, .npz, .npy or .vti by extension. The file appears whole or not at all.

        A narrow band is written with all its arrays as .vdb or .nvdb, which grow with the surface.

        Args:
            path: File to write. A .npz, .vti, .vdb or .nvdb holds every array; a .npy holds no grid. The .npz of a field that
                ``normalize`` made also holds ``centre`` and ``scale``. Other files have no place for them.
            array: Array to write into the other formats.

        Raises:
            UsageError: Another extension, an array that the field does not have, or a normalized field in another file
                than a .npz.
            FileError: The file cannot be written.
            UnsupportedError: This build cannot write .vdb and .nvdb.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.save("ball.npz")
        >>> bool((raymap.load_field("ball.npz").distance == field.distance).all())
        True
        >>> raymap.generate("ball.ply", resolution=64, sparse=True).save("band.vdb")
        """
        text = to_path(path)
        if self._frame.is_identity:
            self._core.save(text, array)
        elif text.lower().endswith(".npz") and not self.is_narrow:
            save_as(self, text, ".npz")
        elif self.is_narrow:
            what = "no file holds the centre and scale of a normalized narrow band; save band.denormalized()"
            raise UsageError(f"{text}: {what}")
        else:
            what = "save a .npz, or field.denormalized()"
            raise UsageError(f"{text}: only a .npz holds the centre and scale of a normalized field; {what}")

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        """Returns the distances of a dense field: ``np.asarray(field)`` is ``field.distance``."""
        if self.is_narrow:
            raise TypeError("a narrow band has no array of all samples; make it dense by to_dense()")
        return np.array(self.distance, dtype=dtype, copy=copy)  # NumPy 1 takes None for False.

    @overload
    def to_html(self, path: None = None, **options: Unpack[PageOptions]) -> str: ...
    @overload
    def to_html(self, path: str | os.PathLike[str], **options: Unpack[PageOptions]) -> None: ...
    def to_html(self, path: str | os.PathLike[str] | None = None, **options: Unpack[PageOptions]) -> str | None:
        """Returns a page that shows the field in a browser with WebGL 2, or writes it: one file, without a network.

        One can turn the shape, move closer, cut it open, hollow it out, move an iso value and a slice, and read off
        positions and values. Slices and cuts show winding numbers and confidences, if the field has them.

        A narrow band is shown without the memory of its dense field: on the page's grid, the page has the distances to
        the surface of ``to_mesh``, exact and not clamped, and no other arrays. Where the band's box cuts the solid off,
        the solid is taken to go straight on.

        Args:
            path: File to write, which appears whole or not at all; None = the page is returned.
            title: Heading; by default the name of the file.
            mesh: Mesh of the field, as for ``raymap.generate``, or a pair of vertices and faces. The page lists its
                defects: a click leads there.
            other: Field or narrow band to compare with. One switches between both, and sees their difference in
                colour. It is sampled on the page's grid.
            other_title: Name of the other field.
            array: Array in whose colours the page begins: ``"distance"``, ``"winding"`` or ``"confidence"``. That of a
                narrow band is ``"distance"``.
            max_size: Most samples along a side, 256 by default. A larger field is shown on a coarser grid.
            width, height, direction, up, field_of_view, cut, shell: View that it begins with, as for ``render``.
            device: Device that draws the picture for browsers without WebGL, and makes the distances to a band's
                surface; see ``raymap.devices``.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: Arguments that make no page, an array that the field does not have, or a narrow band without a
                sample inside.
            InputError: A sample is not finite, or the mesh is not valid.
            FileError: The file cannot be written.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.to_html("ball.html", mesh="ball.ply", cut=True)
        >>> field.to_html()[:15]
        '<!DOCTYPE html>'
        >>> raymap.generate("ball.ply", resolution=64, sparse=True).to_html("band.html", max_size=32, other=field)
        """
        name = "Field" if path is None else os.path.splitext(os.path.basename(os.fspath(path)))[0]
        page = self._page(name, **options)
        if path is None:
            return page
        _raymap.write_whole(to_path(path), page.encode())
        return None

    def show(self, frame_height: int = 600, **options: Unpack[PageOptions]) -> None:
        """Shows the page of ``to_html``: in the cell of a notebook, or else in a browser.

        Outside of a notebook, the page is a file in the folder of temporary files, and stays there. If no browser can
        be opened, a line says where it is.

        Args:
            frame_height: Height in the notebook, in pixels.
            **options: Those of ``to_html``.
        """
        _html.show(self._page("Field", **options), to_whole("frame_height", frame_height, least=1))

    def _page(
        self,
        name: str,
        *,
        title: str | None = None,
        mesh: Any = None,
        other: Field | None = None,
        other_title: str = "Other field",
        array: FieldArray = "distance",
        max_size: int = 256,
        device: str = "auto",
        threads: int | None = None,
        progress: Progress = None,
        **view: Unpack[ViewOptions],
    ) -> str:
        check_names("to_html", view, ViewOptions)
        faulty = None
        if mesh is not None:
            faulty = core_of(_inputs.to_mesh(*mesh) if isinstance(mesh, tuple) else _inputs.to_mesh(mesh))
        page = {"title": name if title is None else title, "other_title": other_title, "array": array, "max_size": max_size}
        compared = None if other is None else _core_of(other)
        with reporting(progress) as report:
            options = core_options({**view, **page, "device": device, "threads": threads})
            return _raymap.make_page(self._core, options, faulty, compared, report)

    def __repr__(self) -> str:
        samples, arrays = " x ".join(map(str, self.shape)), ", ".join(self.arrays)
        leaves = [f"{len(self.origins)} leaves"] if self.is_narrow else []
        return f"raymap.Field({', '.join([f'{samples} samples', *leaves, f'spacing {self.spacing:.6g}', f'arrays {arrays}'])})"

    def _repr_html_(self) -> str:
        rows: dict[str, Any] = {
            "samples": " × ".join(map(str, self.shape)),
            "spacing": f"{self.spacing:.6g}",
            "origin": ", ".join(f"{v:.6g}" for v in self.origin),
            "arrays": ", ".join(self.arrays),
        }
        if not self._frame.is_identity:
            rows["normalized"] = f"centre {', '.join(f'{v:.6g}' for v in self.centre)}; scale {self.scale:.6g}"
        if self.is_narrow:
            rows["active samples"] = self.active_count
            rows["leaves"] = f"{len(self.origins)} of 8 × 8 × 8 samples"
            rows["clamped at"] = f"-{self.inside:.6g} and {self.outside:.6g}, negative inside"
            rows["memory"] = f"{self.nbytes / 2**20:.4g} MiB"
            return _views.html_table("raymap.Field", rows)
        if "distance" in self.arrays:
            rows["distance"] = f"{self.distance.min():.6g} to {self.distance.max():.6g}, negative inside"
        if self.clamp_distance > 0:
            rows["clamped at"] = f"{self.clamp_distance:.6g}"
        if device := self.stats["device"]:
            rows["made"] = f"in {self.stats['milliseconds']:.0f} ms on {device}"
        shown: Any = self.arrays[0]
        return _html.describe("raymap.Field", rows, "slice across z", self.slice("z", array=shown, width=256))

    def __reduce__(self) -> tuple[Any, ...]:
        placement = self.shape, self.origin, self.spacing, self.clamp_distance, self._core.surface_bounds
        band = None
        if self.is_narrow:
            band = self.outside, self.inside, self.origins, self.tile_origins, self.tile_sides
        arrays = {name: self._array(name) for name in self.arrays}
        return _restore, (*placement, band, arrays, self.stats, self._frame)

    def compare(self, other: Field, array: FieldArray = "distance") -> Comparison:
        """Returns where an array of this field differs from that of another field on the same grid.

        Errors of distances are in samples (distance over spacing), those of winding numbers and confidences as they
        are, those of triangles 0. If either field is clamped to a band, distances are compared within the narrower one.

        Two narrow bands are compared as their dense fields, without the memory of these. Winding numbers and
        confidences are known in leaves alone: other samples are taken as not finite.

        Args:
            other: Field on the same grid, of the same kind.
            array: Array to compare.

        Raises:
            UsageError: The grids differ by more than rounding, a field lacks the array, or the other is of another
                kind.

        >>> exact, rough = (raymap.generate("ball.ply", resolution=16, distance=name) for name in ("exact", "raster"))
        >>> found = exact.compare(rough)
        >>> found["samples"], found["sign_differences"], found["max_error"] < 1
        (4096, 0, True)
        """
        return _raymap.compare(*self._with(other), array)  # type: ignore[return-value]

    def render_comparison(
        self, other: Field, array: FieldArray = "distance", *, width: int = 512
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of the slice in which two fields differ most, (h, w, 3) uint8, rows from the top.

        It is the slice with the most differences of sign, across any axis. Samples on which both agree are light grey
        outside and grey inside. Inside by this field only is red, by the other only green, not finite violet. Black and
        blue lines are the zero contours. If no sign differs, it is the slice across z of the largest error, from white
        (equal) to dark red. Arguments and errors are those of ``compare``.

        Args:
            other: Field on the same grid, of the same kind.
            array: Array to compare.
            width: Width in pixels.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.render_comparison(field, width=100).shape
        (100, 100, 3)
        """
        return _raymap.render_comparison(*self._with(other), to_whole("width", width), to_text("array", array))

    def _with(self, other: Field) -> tuple[Any, Any]:
        """Returns the core of this field and that of another one."""
        return self._core, _core_of(other)


def _ordered(name: str, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns an array in the type and the order in memory of the library.

    Raises:
        InputError: It has no real numbers, or for triangles no whole ones.
    """
    is_whole = name == "triangle"
    if array.dtype.kind not in ("iu" if is_whole else "fiu"):
        hint = "; a mask has no distances, a field has" if array.dtype.kind == "b" else ""
        raise InputError(f"{name} must be {'whole' if is_whole else 'real'} numbers, not {array.dtype}{hint}")
    with np.errstate(over="ignore"):  # Distances beyond float32 become infinite.
        typed = np.asarray(array, np.uint32 if is_whole else np.float32)
    # x is fastest; leaves follow each other.
    return np.asfortranarray(typed) if typed.ndim == 3 else np.ascontiguousarray(typed.transpose(0, 3, 2, 1))


def _core_of(other: Field) -> _raymap.Field:
    if not isinstance(other, Field):
        raise UsageError(f"other must be a field, not a {type(other).__name__}")
    return other._core


def core_of_field(field: Field) -> _raymap.Field:
    """Returns the field as the extension module takes it."""
    return field._core


def field_of_core(core: _raymap.Field, frame: Frame = IDENTITY) -> Field:
    """Returns the field that the extension module has made."""
    made = Field.__new__(Field)
    made._hold(core, frame)
    return made


def save_as(field: Field, path: str, extension: str, more: Mapping[str, Any] | None = None) -> None:
    """Writes a field in the format of an extension, whatever the path ends with.

    A .npz holds its frame, if it has one, and further arrays. Other formats have no place for them.
    """

    def save(to: str) -> None:
        field._core.save(to, "distance", extension)

    added = {**(more or {}), **({} if field._frame.is_identity else frame_arrays(field._frame))}
    if extension == ".npz" and added:
        save_with_arrays(save, path, added)
    else:
        save(path)


def _restore(
    shape: tuple[int, int, int],
    origin: npt.NDArray[np.float64],
    spacing: float,
    clamp_distance: float,
    surface_bounds: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    band: tuple[Any, ...] | None,
    arrays: dict[str, npt.NDArray[Any]],
    stats: Stats,
    frame: Frame = IDENTITY,
) -> Field:
    """Makes a field of all that it holds. ``band``: the widths, leaves and tiles of a narrow band."""
    box = None if surface_bounds is None else to_box("surface_bounds", surface_bounds)
    clamp = to_number("clamp_distance", clamp_distance, least=0.0, most=FINITE)
    core = _raymap.Field(shape, to_vector("origin", origin), to_length("spacing", spacing), clamp, box)
    if band is not None:
        outside, inside, *cubes = band
        core.set_band(outside, inside, *(np.ascontiguousarray(array, np.int32) for array in cubes))
    restored = Field.__new__(Field)
    restored._hold(core, frame, stats)
    for name, array in arrays.items():
        restored._set(name, _ordered(name, array))
    if "distance" in arrays or not arrays:  # The shapes of all arrays have been compared.
        core.validate()
    return restored


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


def load_field(path: str | os.PathLike[str], grid: str | None = None, *, sparse: bool = False) -> Field:
    """Reads a field, negative inside: .vdb, .nvdb, .nrrd, .npz, .npy or .vti by extension.

    A .npy has no grid: the result has the origin 0 and the spacing 1. A warning (``RaymapWarning``) names arrays of the
    file that a field has no place for.

    With ``sparse``, the level set of a .vdb or .nvdb, of raymap or any other program, becomes a narrow band: time and
    memory grow with its leaves. What ``Field.save`` wrote of a narrow band comes back bit for bit. The grid of another
    program's file then begins and ends with whole leaves of 8 samples.

    Args:
        path: The file.
        grid: Name of the grid in a .vdb or .nvdb; None = the first level set.
        sparse: Whether to read a narrow band.

    Raises:
        UsageError: Another extension, or no grid has that name; the message lists those of the file.
        FileError: The file cannot be read.
        InputError: Its content is not valid.
        UnsupportedError: For example a rotated grid, or a narrow band of a grid that is no level set.

    >>> raymap.generate("ball.ply", resolution=16).save("ball.vdb")
    >>> raymap.load_field("ball.vdb")
    raymap.Field(16 x 16 x 16 samples, spacing 0.15, arrays distance)
    >>> raymap.generate("ball.ply", resolution=64, sparse=True).save("band.vdb")
    >>> raymap.load_field("band.vdb", sparse=True)
    raymap.Field(64 x 64 x 64 samples, 304 leaves, spacing 0.0375, arrays distance)
    """
    core = _raymap.load_field(to_path(path), to_text("grid", "" if grid is None else grid), sparse)
    return field_of_core(core, read_frame(Path(to_path(path))) if to_path(path).lower().endswith(".npz") else IDENTITY)
