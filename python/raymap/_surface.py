"""Meshes prepared for queries at any points."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Generic, Literal, TypeAlias, TypedDict, TypeVar, get_args, overload

import numpy as np
import numpy.typing as npt

from . import _arrays, _inputs, _raymap, _views
from ._arguments import Vector, Whole3, to_length, to_names, to_number, to_vector, to_wholes
from ._arrays import Doubles, Indices, Points, Singles
from ._errors import InputError, UsageError
from ._field import Field, field_of_core
from ._generate import SurfaceFieldOptions, fit_grid, to_options, with_band
from ._mesh import Mesh, core_of, mesh_of_arrays
from ._options import array_options, check_names, core_options
from ._progress import Progress, reporting
from ._records import FieldArray, Orientation, Part, Stats, ThicknessSummary
from ._typing import NamedTuple, Unpack

#: Name of what ``Surface.query`` can compute.
QueryArray: TypeAlias = Literal[
    "distance", "closest", "triangle", "barycentric", "direction", "winding", "confidence"
]
_Asked: TypeAlias = QueryArray | Iterable[QueryArray]


#: Arrays of numbers, and of indices.
_Numbers = TypeVar("_Numbers")
_Wholes = TypeVar("_Wholes")
_Floats = TypeVar("_Floats")


@_views.shown
class Closest(NamedTuple, Generic[_Numbers, _Wholes]):
    """Result of ``Surface.closest``: one value per point, in the shape of the points."""

    point: _Numbers
    """Closest points of the surface, (..., 3), in the mesh's units."""
    distance: _Numbers
    """Distances to them, (...), negative inside; not negative for a surface without a sign."""
    triangle: _Wholes
    """Indices of triangles that hold them, (...); ``raymap.NO_TRIANGLE`` for a point that is not finite."""
    barycentric: _Numbers
    """Weights of the triangles' corners, (..., 3), 0 to 1; their sum is 1."""


@_views.shown
class Query(NamedTuple, Generic[_Numbers, _Wholes, _Floats]):
    """Result of ``Surface.query``: one value per point, in the shape of the points. None for what was not asked for."""

    distance: _Numbers
    """Distances, (...), in the mesh's units, negative inside; not negative for a surface without a sign."""
    closest: _Numbers
    """Closest points of the surface, (..., 3), in the mesh's units."""
    triangle: _Wholes
    """Indices of triangles that hold them, (...); ``raymap.NO_TRIANGLE`` if there is none."""
    barycentric: _Numbers
    """Weights of the triangles' corners, (..., 3), 0 to 1; their sum is 1."""
    direction: _Numbers
    """Unit vectors from the points to the closest ones, (..., 3); 0 on the surface."""
    winding: _Floats
    """Winding numbers, (...) float32, +1 inside a closed surface that faces outwards."""
    confidence: _Floats
    """Confidences in the sign, (...) float32, 0 to 1."""


@_views.shown
class SurfacePair(NamedTuple):
    """Result of ``Surface.distance_to``, ``Surface.hausdorff`` and ``Scene.distances_between``: a point of each of two surfaces.

    Members of a scene's result are arrays over the pairs, or (configurations, pairs).
    """

    distance: Any
    """Distance of the two points."""
    bound: Any
    """Upper bound on the measured distance: ``distance`` itself of a least distance."""
    point: Any
    """Point of the one surface, (3,); NaN if they are too far apart."""
    other_point: Any
    """Point of the other."""
    triangle: Any
    """Triangle that holds ``point``; ``raymap.NO_TRIANGLE`` if there is none."""
    other_triangle: Any
    """Triangle that holds ``other_point``."""


class CallOptions(TypedDict, total=False):
    """Keyword arguments of what asks a surface at points."""

    threads: int | None
    progress: Progress


class QueryOptions(CallOptions, total=False):
    """Keyword arguments of ``Surface.query``."""

    max_distance: float | None


class OnceOptions(CallOptions, total=False):
    """Keyword arguments of ``raymap.signed_distance``."""

    sign: bool
    orientation: Orientation
    memory_limit: int | None


@_views.shown
class FacePoints(NamedTuple):
    """Result of ``raymap.sample_faces``: one value per point."""

    position: npt.NDArray[np.float64]
    """Positions on the faces, (n, 3), in the mesh's units."""
    triangle: npt.NDArray[np.uint32]
    """Indices of the faces, (n,)."""
    area: npt.NDArray[np.float64]
    """Areas that the points stand for, (n,), in the mesh's units squared."""


@_views.shown
class Thickness(NamedTuple):
    """Result of ``Surface.thickness``: one value per point."""

    part: npt.NDArray[np.str_]
    """Kinds of the parts that the points bound, (n,): ``"wall"``; ``"edge"`` and ``"corner"``, where the other side is too
    oblique; ``"solid"``, whose other side is farther than ``max_thickness``; ``"sheet"``, outside on both sides; ``"buried"``,
    inside on both sides."""
    diameter: npt.NDArray[np.float32]
    """Diameters of the balls inside that touch the point and the side opposite, (n,), in the mesh's units. 0 for a sheet;
    infinite where no side lies opposite."""
    inward: npt.NDArray[np.float32]
    """Unit vectors into the solid, (n, 3); 0 for sheets and buried faces."""


class Surface:
    """A mesh prepared once for queries at any points: signed distances, negative inside, and closest points.

    Distances are those to the mesh itself, within a millionth of its diagonal. (Farther from the mesh than its size,
    they are within a millionth of the distance.) Signs follow the winding number, as those of
    ``raymap.generate``: the mesh may have holes, overlaps, or faces that point the wrong way. The result of a
    point depends neither on the other points, nor on the number of threads.

    Points have any shape (..., 3): NumPy, lists, or any array with ``__dlpack__``. Results are float32 for float32
    points and float64 for all others. PyTorch, JAX and CuPy get arrays of their own back, on the same device, float16
    and bfloat16 for such points. Points whose gradient PyTorch or JAX follows are an error: ``raymap.torch`` and ``raymap.jax``
    have functions that follow it.

    A surface never changes, whatever becomes of the arrays that it was made from. Several threads may use it at the
    same time. It can be pickled; the copy prepares the mesh again, and gives the same bits.

    Args:
        mesh_or_vertices: A mesh (``raymap.Mesh``, or of trimesh, Open3D, meshio or PyVista), the path of a file, or
            positions, (n, 3): NumPy, or any array with ``__dlpack__``.
        faces: Three vertex numbers per triangle, (m, 3), counter-clockwise seen from outside, if positions are given.
        sign: Whether to tell inside from outside. Without, preparing takes less time and memory.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, if the mesh then fits clearly
            better; ``"keep"``, never; ``"repair"``, whenever it fits no worse.
        compact: Whether to take 68 to 74 bytes per triangle less. The results are the same. Scattered points then take
            up to half more time, and narrow bands up to a tenth.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        memory_limit: Most bytes that the call and its result may hold; None = what is available.
        progress: A callable that receives the name of a stage and the share of it that is done, 0 to 1, about ten
            times a second. It cancels by returning False or by raising. True shows a bar in a notebook,
            a moving line on a terminal, else a line a minute on stderr; ``"plain"`` does the last anywhere, and ``"json"``
            writes an object a line.

    Raises:
        InputError: The mesh has no face, a vertex number out of range or a position that is not finite.
        UsageError: Arguments that make no sense.
        MemoryLimitError: The surface needs more memory than allowed.
        FileError: The file cannot be read.
        Cancelled: ``progress`` returned False.

    >>> surface = raymap.Surface("ball.ply")
    >>> surface
    raymap.Surface(642 vertices, 1280 faces)
    >>> surface.signed_distance([(0, 0, 0.5), (0, 0, 1.5)]).round(2)
    array([-0.5,  0.5])
    """

    def __init__(
        self,
        mesh_or_vertices: Any,
        faces: Any = None,
        *,
        sign: bool = True,
        orientation: Orientation = "auto",
        compact: bool = False,
        threads: int | None = None,
        memory_limit: int | None = None,
        progress: Progress = None,
    ) -> None:
        _arrays.check_gradient("vertices", mesh_or_vertices, "signed_distance(surface, points, vertices=vertices)")
        mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
        self._sign, self._orientation, self._compact = bool(sign), orientation, bool(compact)
        options = core_options(
            sign="harmonic" if sign else "none",
            orientation=orientation,
            compact=compact,
            threads=threads,
            memory_limit=memory_limit,
        )
        self._threads, self._memory_limit = threads, memory_limit
        with reporting(progress) as report:
            self._core = _raymap.Surface(mesh, options, report)
        self._stats: Stats = self._core.stats()  # type: ignore[assignment]
        self._scene: _raymap.Scene | None = None  # Of this surface alone, for ``signed_distance``.

    @overload
    def signed_distance(
        self, points: Singles, *, transform: npt.ArrayLike | None = None, **options: Unpack[CallOptions]
    ) -> Singles: ...
    @overload
    def signed_distance(
        self, points: Points, *, transform: npt.ArrayLike | None = None, **options: Unpack[CallOptions]
    ) -> Doubles: ...
    @overload
    def signed_distance(
        self, points: Any, *, transform: npt.ArrayLike | None = None, **options: Unpack[CallOptions]
    ) -> Any: ...
    def signed_distance(
        self,
        points: Any,
        *,
        transform: npt.ArrayLike | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Any:
        """Returns distances at points, (...) for points (..., 3), negative inside, in the mesh's units.

        A surface without a sign returns distances that are not negative. Points that are not finite get NaN.

        Args:
            points: Positions in the mesh's units, (..., 3).
            transform: Pose of the mesh, (4, 4): a rotation and a translation that take the mesh's coordinates to those
                of the points. None = they are the same. ``raymap.Scene`` has many bodies with poses.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: ``transform`` is no scaled rigid motion.
            InputError: Points or a transform of another shape.
            MemoryLimitError: The results do not fit into memory.
            Cancelled: ``progress`` returned False.

        >>> surface = raymap.Surface("tetrahedron.ply")
        >>> surface.signed_distance(np.array([(0.25, 0.25, 0.125), (0.25, 0.25, -1)], np.float32))
        array([-0.125,  1.   ], dtype=float32)
        """
        if transform is None:
            found = self._query(points, {"distance"}, None, threads, progress, "signed_distance(surface, points)")
            return _arrays.like(found["distance"], points)
        rows, (flat, shape) = _arrays.to_poses("transform", transform, (4, 4))[None], _arrays.to_points(points)
        if self._scene is None:
            scene = _raymap.Scene()
            scene.add("surface", self._core, np.eye(4).reshape(1, 4, 4))
            self._scene = scene
        options = core_options(threads=threads)
        with reporting(progress) as report:
            found = self._scene.query_many(flat, rows, 1, False, {"distance"}, [], options, report)
        return _arrays.like(_arrays.as_precise(found["distance"], points).reshape(shape[:-1]), points)

    @overload
    def contains(self, points: Points, **options: Unpack[CallOptions]) -> npt.NDArray[np.bool_]: ...
    @overload
    def contains(self, points: Any, **options: Unpack[CallOptions]) -> Any: ...
    def contains(self, points: Any, *, threads: int | None = None, progress: Progress = None) -> Any:
        """Returns whether points are inside, (...) bool for points (..., 3).

        Points on the surface and points that are not finite are not inside. Arguments are those of
        ``signed_distance``.

        Raises:
            UsageError: The surface has no sign.
            InputError: Points of another shape.
            MemoryLimitError: The results do not fit into memory.
            Cancelled: ``progress`` returned False.

        >>> raymap.Surface("ball.ply").contains([(0, 0, 0.5), (0, 0, 1.5)])
        array([ True, False])
        """
        if not self._sign:
            raise UsageError("the surface was made with sign=False, so it does not know what is inside")
        found = self._query(_arrays.still(points), {"distance"}, None, threads, progress)
        return _arrays.like(np.asarray(found["distance"] < 0), points)

    @overload
    def closest(self, points: Singles, **options: Unpack[CallOptions]) -> Closest[Singles, Indices]: ...
    @overload
    def closest(self, points: Points, **options: Unpack[CallOptions]) -> Closest[Doubles, Indices]: ...
    @overload
    def closest(self, points: Any, **options: Unpack[CallOptions]) -> Closest[Any, Any]: ...
    def closest(self, points: Any, *, threads: int | None = None, progress: Progress = None) -> Closest[Any, Any]:
        """Returns closest points of the surface, distances, triangles and barycentric coordinates.

        Where several points are equally close, it is one of them, always the same. Arguments and errors are those of
        ``signed_distance``.

        >>> surface = raymap.Surface("tetrahedron.ply")
        >>> point, distance, triangle, barycentric = surface.closest((0.25, 0.25, -1))
        >>> point, float(distance)
        (array([0.25, 0.25, 0.  ]), 1.0)
        >>> corners = surface.mesh.vertices[surface.mesh.faces[triangle]]
        >>> barycentric @ corners
        array([0.25, 0.25, 0.  ])
        """
        names = {"closest", "distance", "triangle", "barycentric"}
        found = self._query(points, names, None, threads, progress, "closest_point(surface, points)")
        return Closest(*(_arrays.like(found[{"point": "closest"}.get(name, name)], points) for name in Closest._fields))

    @overload
    def query(
        self, points: Singles, arrays: _Asked = ..., **options: Unpack[QueryOptions]
    ) -> Query[Singles, Indices, Singles]: ...
    @overload
    def query(
        self, points: Points, arrays: _Asked = ..., **options: Unpack[QueryOptions]
    ) -> Query[Doubles, Indices, Singles]: ...
    @overload
    def query(self, points: Any, arrays: _Asked = ..., **options: Unpack[QueryOptions]) -> Query[Any, Any, Any]: ...
    def query(
        self,
        points: Any,
        arrays: _Asked = ("distance",),
        *,
        max_distance: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Query[Any, Any, Any]:
        """Returns what is asked for at points: the fields of ``raymap.Query``.

        Args:
            points: Positions in the mesh's units, (..., 3).
            arrays: Names of what to compute: ``"distance"``, ``"closest"``, ``"triangle"``, ``"barycentric"``,
                ``"direction"``, ``"winding"``, ``"confidence"``.
            max_distance: Farther points get this distance, with their sign, ``raymap.NO_TRIANGLE``, and NaN for what
                else depends on the closest point. Smaller is faster. In the mesh's units; None = no limit.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: An unknown name, ``"winding"`` or ``"confidence"`` of a surface without a sign, or a
                ``max_distance`` that is not above 0.
            InputError: Points of another shape.
            MemoryLimitError: The results do not fit into memory.
            Cancelled: ``progress`` returned False.

        >>> found = raymap.Surface("ball.ply").query([(0, 0, 0), (0, 0, 3)], ("distance", "winding"), max_distance=1.5)
        >>> found.distance.round(2), found.winding.round(3), found.closest
        (array([-0.99,  1.5 ]), array([1., 0.], dtype=float32), None)
        """
        names = to_names(arrays, Query._fields)
        given = _arrays.still(points) if names == {"triangle"} else points
        by = "signed_distance(surface, points) or raymap.torch.closest_point(surface, points)"
        found = self._query(given, names, max_distance, threads, progress, by)
        return Query(*(_arrays.like(found[name], points) if name in names else None for name in Query._fields))

    def _query(
        self,
        points: Any,
        names: set[str],
        max_distance: float | None,
        threads: int | None,
        progress: Progress,
        instead: str = "",
    ) -> dict[str, Any]:
        """Returns NumPy arrays by name, in the shape of the points. ``instead`` is the function that follows gradients."""
        options = core_options(max_distance=max_distance, threads=threads)
        flat, shape = _arrays.to_points(points, instead, keep_single=True)
        with reporting(progress) as report:
            found = self._core.query(flat, names, options, report)
        for name, array in found.items():
            with np.errstate(over="ignore"):  # Far points may have distances beyond float32, which become infinite.
                converted = array.astype(flat.dtype, copy=False) if array.dtype == np.float64 else array
            found[name] = converted.reshape(shape if array.ndim == 2 else shape[:-1])
        return found

    def distance_to(
        self,
        other: Surface,
        transform: npt.ArrayLike | None = None,
        *,
        max_distance: float | None = None,
        progress: Progress = None,
    ) -> SurfacePair:
        """Returns the points of this surface and of another that are least apart, in this one's coordinates.

        Surfaces whose faces cross are 0 apart. Only the faces count. Exact in float64.

        Args:
            other: The other surface.
            transform: Its pose, (4, 4), which takes its coordinates to those of this one. A change costs nothing. None =
                they are the same.
            max_distance: Surfaces as far or farther get this distance, ``raymap.NO_TRIANGLE``, and NaN for the points.
                Smaller is faster. None = no limit.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: ``transform`` is no scaled rigid motion, or ``max_distance`` is not above 0.
            InputError: A transform of another shape.
            Cancelled: ``progress`` returned False.

        >>> ball = raymap.Surface("ball.ply")
        >>> found = ball.distance_to(ball, [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        >>> round(found.distance, 2), found.point.round(2), found.other_point.round(2)
        (3.0, array([1., 0., 0.]), array([4., 0., 0.]))
        """
        options = core_options(max_distance=max_distance)
        with reporting(progress) as report:
            return _pair_of(self._core.distance_to(other._core, _to_rows(transform), options, report))

    def hausdorff(
        self,
        other: Surface,
        transform: npt.ArrayLike | None = None,
        *,
        tolerance: float | None = None,
        both_ways: bool = True,
        threads: int | None = None,
        progress: Progress = None,
    ) -> SurfacePair:
        """Returns the point that is farthest from the other surface, and that one's closest point: the Hausdorff distance.

        No other point of the faces is farther than ``bound``. The points are in this surface's coordinates.

        Args:
            other: The other surface.
            transform: Its pose, as for ``distance_to``.
            tolerance: Most that ``bound`` exceeds the distance. None = 1e-4 of the diagonal of this surface's bounds.
            both_ways: Whether the farthest point may lie on either surface, or only on this one.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: ``transform`` is no scaled rigid motion, or ``tolerance`` is not above 0.
            InputError: A transform of another shape.
            MemoryLimitError: The search does not fit into memory.
            Cancelled: ``progress`` returned False.

        >>> ball = raymap.Surface("ball.ply")
        >>> found = ball.hausdorff(ball, [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        >>> round(found.distance, 2), bool(found.distance <= found.bound <= found.distance + 1e-3)
        (0.5, True)
        """
        most = 0.0 if tolerance is None else to_number("tolerance", tolerance, above=0.0)
        options = core_options(threads=threads)
        with reporting(progress) as report:
            found = self._core.hausdorff(other._core, _to_rows(transform), most, bool(both_ways), options, report)
        return _pair_of(found)

    def generate(self, *, sparse: bool = False, **options: Unpack[SurfaceFieldOptions]) -> Field:
        """Returns a field of the mesh, negative inside, which agrees with what the surface says at points.

        Arguments and errors are those of ``raymap.generate``, without ``orientation``: faces are turned as the
        surface found best. A surface without a sign gives a field without one, unless ``sign`` asks for it. With
        ``sparse=True``, ``sign`` and ``threshold`` are those of the surface.

        >>> surface = raymap.Surface("ball.ply")
        >>> field = surface.generate(resolution=32)
        >>> position = field.origin + field.spacing * np.array((16, 16, 16))
        >>> bool(np.isclose(field.distance[16, 16, 16], surface.signed_distance(position)))
        True
        """
        check_names("generate", options, SurfaceFieldOptions)
        if not self._sign:
            options = {"sign": "none", **options}
        grid = fit_grid(self._core.fit_grid, options)
        options = with_band(options, grid)
        core = to_options(options, self._orientation, sparse=sparse)
        is_signed = options.get("sign", "harmonic") != "none"
        if sparse and (is_signed != self._sign or options.get("threshold", 0.5) != 0.5):
            raise UsageError("sparse=True takes the sign and the threshold of the surface; leave them out")
        with reporting(options.get("progress")) as report:
            make = self._core.generate_sparse if sparse else self._core.generate
            return field_of_core(make(grid, core, report))

    def generate_region(
        self,
        low: Iterable[int],
        size: Iterable[int],
        *,
        origin: npt.ArrayLike,
        spacing: float,
        dims: Iterable[int],
        band: float | None = None,
        arrays: FieldArray | Iterable[FieldArray] = ("distance",),
        threads: int | None = None,
        memory_limit: int | None = None,
        progress: Progress = None,
    ) -> Field:
        """Returns the field of a region of a lattice, which may have more samples than any memory holds.

        A sample's values are those of ``query`` at its position on the lattice, ``origin + spacing * (i, j, k)``, rounded
        to float32, however the lattice is cut into regions, and for any number of threads. The ``origin`` of the field is
        the position of ``low``, so positions that are computed from it may differ from those on the lattice in the last
        bits.

        Args:
            low: First sample of the region, (i, j, k).
            size: Number of samples of the region along x, y and z.
            origin: Position of sample (0, 0, 0) of the lattice, in the mesh's units.
            spacing: Distance between samples, in the mesh's units.
            dims: Number of samples of the lattice along x, y and z, up to 2**24 each.
            band: Number of samples at which distances are clamped; smaller is faster. None = not clamped.
            arrays: Names of the arrays to make: ``"winding"``, ``"confidence"`` and ``"triangle"`` beside ``"distance"``,
                which every field has.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            memory_limit: Most bytes that the surface and the field may take; None = what is available.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: A region that does not lie on the lattice, an unknown name, ``"winding"`` or ``"confidence"`` of a
                surface without a sign, or numbers that make no sense.
            MemoryLimitError: The region needs more memory than allowed.
            Cancelled: ``progress`` returned False.

        >>> surface = raymap.Surface("ball.ply")
        >>> lattice = dict(origin=(-2, -2, -2), spacing=4 / 100_000, dims=(100_001,) * 3)
        >>> part = surface.generate_region((50_000, 50_000, 25_000), (2, 2, 3), **lattice)
        >>> part.distance.shape, part.origin, bool(abs(part.distance).max() < 0.01)
        ((2, 2, 3), array([ 0.,  0., -1.]), True)
        """
        given = array_options(arrays) | {"threads": threads, "memory_limit": memory_limit}
        options = core_options(given, band=None if band is None else to_length("band", band))
        with reporting(progress) as report:
            region = _to_box(low, size, origin, spacing, dims)
            return field_of_core(self._core.generate_region(*region, options, report))

    def far_distance(
        self,
        low: Iterable[int],
        size: Iterable[int],
        *,
        origin: npt.ArrayLike,
        spacing: float,
        dims: Iterable[int],
        band: float,
    ) -> float | None:
        """Returns the distance that all samples of a region have if they lie beyond a band on one side.

        It is what ``generate_region`` gives each of them: ``band * spacing``, or minus that inside. Takes a few queries at
        most, so that most of a huge lattice can be passed over quickly. Releases the lock of Python.

        Args:
            low: First sample of the region, (i, j, k).
            size: Number of samples of the region along x, y and z.
            origin: Position of sample (0, 0, 0) of the lattice, in the mesh's units.
            spacing: Distance between samples, in the mesh's units.
            dims: Number of samples of the lattice along x, y and z, up to 2**24 each.
            band: Number of samples at which distances are clamped.

        Returns:
            The distance in the mesh's units. None: some samples may lie in the band or on the other side.

        Raises:
            UsageError: A region that does not lie on the lattice, or numbers that make no sense.

        >>> surface = raymap.Surface("ball.ply")
        >>> lattice = dict(origin=(-2, -2, -2), spacing=0.25, dims=(17, 17, 17))
        >>> surface.far_distance((0, 0, 0), (2, 2, 2), band=2, **lattice), surface.far_distance((0, 0, 0), (9, 9, 9), band=2, **lattice)
        (0.5, None)
        """
        options = core_options(band=to_length("band", band))
        return self._core.far_distance(*_to_box(low, size, origin, spacing, dims), options)

    def thickness(
        self,
        points: Any,
        triangles: Any,
        *,
        max_thickness: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> Thickness:
        """Returns the local thickness of the mesh at points of its faces.

        A side lies opposite a point if its normal and the reversed normal of the point are at most 40 degrees apart. So
        blunt edges are not thin, and a cube is as thick near its edges as in the middle.

        Args:
            points: Positions on the faces in the mesh's units, (n, 3), as of ``raymap.sample_faces`` or ``closest``.
            triangles: Indices of the faces that hold them, (n,).
            max_thickness: Largest thickness to find, in the mesh's units; thicker parts are taken as infinitely thick. The smaller,
                the faster. None = no limit.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: The surface has no sign, there is no such face, or ``max_thickness`` is not above 0.
            InputError: Arrays of other shapes.
            Cancelled: ``progress`` returned False.

        >>> ball = raymap.load_mesh("ball.ply")
        >>> points = raymap.sample_faces(ball, step=0.5)
        >>> found = raymap.Surface(ball).thickness(points.position, points.triangle)
        >>> found.part[0], bool((abs(found.diameter - 2) < 0.05).all())
        (np.str_('wall'), True)
        """
        (positions, _), numbers = _arrays.to_points(points), _arrays.to_numpy("triangles", triangles)
        if numbers.shape != (len(positions),) or (numbers.size > 0 and numbers.dtype.kind not in "iu"):
            raise InputError(f"triangles must be ({len(positions)},) whole numbers, one for each point, not "
                             f"{numbers.dtype} of the shape {numbers.shape}")  # fmt: skip
        if numbers.size > 0 and not (0 <= numbers.min() and numbers.max() < 2**32):
            raise UsageError("triangles must be indices of faces, from 0 on")
        options = core_options(max_thickness=max_thickness, threads=threads)
        with reporting(progress) as report:
            parts, diameter, inward = _raymap.thickness(
                self._core, positions, numbers.astype(np.uint32), options, report
            )
        return Thickness(np.array(get_args(Part))[parts], diameter, inward)

    def thickness_summary(
        self, *, max_thickness: float | None = None, threads: int | None = None, progress: Progress = None
    ) -> ThicknessSummary:
        """Returns a summary of the thickness at 100,000 points that are spread evenly over the area of the mesh.

        Lengths are NaN where there is nothing to measure. Arguments and errors are those of ``thickness``.

        >>> found = raymap.Surface("ball.ply").thickness_summary()
        >>> round(found["median"], 1), found["sheet_share"]
        (2.0, 0.0)
        """
        options = core_options(max_thickness=max_thickness, threads=threads)
        with reporting(progress) as report:
            return _raymap.summarize_thickness(self._core, options, report)  # type: ignore[return-value]

    @property
    def mesh(self) -> Mesh:
        """The mesh as the surface keeps it: the given faces; positions in single precision about an origin."""
        return mesh_of_arrays(self._core.vertices(), self._core.faces(), self._core.origin)

    @property
    def nbytes(self) -> int:
        """Memory that the surface holds, in bytes."""
        return self._core.bytes

    @property
    def stats(self) -> Stats:
        """Cost of the preparation, and findings about the mesh."""
        return self._stats

    def __repr__(self) -> str:
        counts = f"{len(self._core.vertices())} vertices, {len(self._core.faces())} faces"
        return f"raymap.Surface({counts}{'' if self._sign else ', no sign'})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _prepare, (
            self.mesh,
            self._sign,
            self._orientation,
            self._compact,
            self._threads,
            self._memory_limit,
        )


@overload
def signed_distance(mesh: Any, points: Singles, **options: Unpack[OnceOptions]) -> Singles: ...
@overload
def signed_distance(mesh: Any, points: Points, **options: Unpack[OnceOptions]) -> Doubles: ...
@overload
def signed_distance(mesh: Any, points: Any, **options: Unpack[OnceOptions]) -> Any: ...
def signed_distance(
    mesh: Any,
    points: Any,
    *,
    sign: bool = True,
    orientation: Orientation = "auto",
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Any:
    """Returns distances of a mesh at points, (...) for points (..., 3), negative inside, in the mesh's units.

    They are those of ``raymap.Surface(mesh).signed_distance(points)``: float32 for float32 points, float64 for all
    others. Each call prepares the mesh. To ask for more than once, make a ``raymap.Surface``. For distances on a grid,
    use ``raymap.generate``.

    Args:
        mesh: A mesh or path as for ``raymap.Surface``. Arrays: ``raymap.Mesh(vertices, faces)``.
        points: Positions in the mesh's units, (..., 3).
        sign: Whether to tell inside from outside; without, distances are not negative.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, ``"keep"`` or ``"repair"``.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        memory_limit: Most bytes that the prepared mesh may take; None = what is available.
        progress: A callable that receives a stage and its share, 0 to 1; True to show it.

    Raises:
        InputError: The mesh is not valid, or points of another shape.
        UsageError: Arguments that make no sense.
        MemoryLimitError: The mesh needs more memory than allowed.
        FileError: The file cannot be read.
        Cancelled: ``progress`` returned False.

    >>> raymap.signed_distance("ball.ply", [(0, 0, 0.5), (0, 0, 1.5)]).round(2)
    array([-0.5,  0.5])
    """
    surface = Surface(
        mesh, sign=sign, orientation=orientation, threads=threads, memory_limit=memory_limit, progress=progress
    )
    return surface.signed_distance(points, threads=threads, progress=progress)


def sample_faces(mesh_or_vertices: Any, faces: Any = None, *, step: float) -> FacePoints:
    """Returns the middles of parts of the faces of a mesh, in the order of the faces.

    A face is halved until no side of a part is longer than ``step``, but at most 22 times.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.Surface``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        step: Longest side of a part, in the mesh's units.

    Raises:
        InputError: The mesh is not valid.
        UsageError: ``step`` is not above 0.
        MemoryLimitError: The points do not fit into memory.
        FileError: The file cannot be read.

    >>> points = raymap.sample_faces("tetrahedron.ply", step=2)
    >>> points.triangle, float(points.area[0])
    (array([0, 1, 2, 3], dtype=uint32), 0.5)
    """
    return FacePoints(*_raymap.sample_faces(core_of(_inputs.to_mesh(mesh_or_vertices, faces)), to_number("step", step, above=0.0)))


def split_parts(mesh_or_vertices: Any, faces: Any = None) -> list[Mesh]:
    """Returns each part of a mesh that is apart, with the sealed cavities in it, in the order of their first faces.

    A part is connected through vertices at exactly equal positions.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.Surface``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.

    Raises:
        InputError: The mesh is not valid.
        FileError: The file cannot be read.

    >>> ball = raymap.load_mesh("ball.ply")
    >>> both = raymap.Mesh(np.concatenate([ball.vertices, ball.vertices + 5]), np.concatenate([ball.faces, ball.faces + len(ball.vertices)]))
    >>> [len(part.faces) for part in raymap.split_parts(both)]
    [1280, 1280]
    """
    mesh = _inputs.to_mesh(mesh_or_vertices, faces)
    parts = []
    for chosen in _raymap.split_parts(core_of(mesh)):
        used, numbers = np.unique(mesh.faces[chosen], return_inverse=True)
        parts.append(Mesh(mesh.vertices[used], numbers.reshape(-1, 3)))
    return parts


def _to_box(
    low: Iterable[int], size: Iterable[int], origin: npt.ArrayLike, spacing: float, dims: Iterable[int]
) -> tuple[Vector, float, Whole3, Whole3, Whole3]:
    """Returns a lattice and a region of it as the extension module takes them."""
    return (
        to_vector("origin", origin),
        to_length("spacing", spacing),
        to_wholes("dims", dims, least=1),
        to_wholes("low", low),
        to_wholes("size", size, least=1),
    )


def _to_rows(transform: npt.ArrayLike | None) -> npt.NDArray[np.float64]:
    """Returns a pose as the extension module takes it."""
    return _arrays.to_poses("transform", np.eye(4) if transform is None else transform, (4, 4))[None]


def _pair_of(found: dict[str, Any]) -> SurfacePair:
    """Returns the only one of some pairs."""
    return SurfacePair(**{name: array[0] if array.ndim > 1 else array[0].item() for name, array in found.items()})


def core_of_surface(surface: Surface) -> _raymap.Surface:
    """Returns the surface as the extension module takes it."""
    return surface._core


def corners_of_surface(
    surface: Surface, triangles: npt.NDArray[Any], points: npt.NDArray[Any]
) -> tuple[npt.NDArray[np.int64], npt.NDArray[Any]]:
    """Returns vertex numbers of triangles (...), (..., 3), and the places of these vertices from points, (..., 3, 3)."""
    corners = surface._core.faces()[triangles].astype(np.int64)
    from_origin = points.astype(np.float64) - surface._core.origin
    with np.errstate(over="ignore"):
        return corners, (surface._core.vertices()[corners] - from_origin[..., None, :]).astype(points.dtype)


def _prepare(
    mesh: Mesh,
    sign: bool,
    orientation: Orientation,
    compact: bool,
    threads: int | None,
    memory_limit: int | None,
) -> Surface:
    """Makes a surface of what was pickled."""
    return Surface(
        mesh, sign=sign, orientation=orientation, compact=compact, threads=threads, memory_limit=memory_limit
    )
