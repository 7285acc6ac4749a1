"""Fields from meshes."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Literal, TypedDict, TypeVar, overload

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap
from ._arguments import to_box, to_length, to_text, to_vector, to_whole, to_wholes
from ._errors import InputError, UsageError
from ._field import Band, Field, band_options, field_of_core
from ._frames import Normalization, frame_of, moved, to_normalization
from ._mesh import Mesh, core_of
from ._options import array_options, check_names, core_options
from ._progress import Progress, reporting
from ._records import DistanceMode, FieldArray, Orientation, Sampling, SignMode
from ._typing import Unpack


class SurfaceFieldOptions(TypedDict, total=False):
    """Keyword arguments of ``raymap.Surface.generate``; ``raymap.generate`` documents them."""

    resolution: int
    voxel_size: float | None
    bounds: npt.ArrayLike | None
    padding: float
    shape: Iterable[int] | None
    cube: bool
    origin: npt.ArrayLike | None
    align: bool
    distance: DistanceMode
    sign: SignMode
    passes: int
    sampling: Sampling
    offsets: npt.ArrayLike | None
    threshold: float
    invert: bool
    close_holes: bool
    thickness: float | None
    band: Band
    truncation: float | None
    arrays: FieldArray | Iterable[FieldArray]
    device: str
    threads: int | None
    memory_limit: int | None
    progress: Progress


class FileFieldOptions(SurfaceFieldOptions, total=False):
    """Keyword arguments of ``raymap.generate_file``; ``raymap.generate`` documents them."""

    orientation: Orientation
    allow_empty: bool


class FieldOptions(FileFieldOptions, total=False):
    """Keyword arguments of ``raymap.generate``, which documents them."""

    normalize: bool | Normalization


def generate(
    mesh_or_vertices: Any,
    faces: Any = None,
    *,
    resolution: int = 128,
    voxel_size: float | None = None,
    bounds: npt.ArrayLike | None = None,
    padding: float = 0.1,
    shape: Iterable[int] | None = None,
    cube: bool = False,
    origin: npt.ArrayLike | None = None,
    align: bool = False,
    normalize: bool | Normalization = False,
    distance: DistanceMode = "exact",
    sign: SignMode = "harmonic",
    orientation: Orientation = "auto",
    passes: int = 5,
    sampling: Sampling = "spread",
    offsets: npt.ArrayLike | None = None,
    threshold: float = 0.5,
    invert: bool = False,
    close_holes: bool = False,
    thickness: float | None = None,
    band: Band = None,
    truncation: float | None = None,
    arrays: FieldArray | Iterable[FieldArray] = ("distance",),
    allow_empty: bool = False,
    device: str = "auto",
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
    sparse: bool = False,
) -> Field:
    """Returns the signed distance field of a triangle mesh, negative inside.

    Any mesh will do: with holes, overlaps, missing parts, or faces that point the wrong way. Nothing is scaled or
    moved unless ``normalize`` asks for it: all lengths are in the mesh's units. The same mesh and arguments give the same field, bit for bit, on the
    same device, for any number of threads. Ctrl-C stops the call.

    Args:
        mesh_or_vertices: A mesh (``raymap.Mesh``, or of trimesh, Open3D, meshio or PyVista), the path of a file, or
            positions, (n, 3): NumPy, or any array with ``__dlpack__``.
        faces: Three vertex numbers per triangle, (m, 3), counter-clockwise seen from outside, if positions are given.
        resolution: Number of samples along the longest side of the grid. Without effect if ``voxel_size`` is given.
        voxel_size: Distance between samples, in the mesh's units; None = from the resolution or ``shape``.
        bounds: Box to cover, ((x0, y0, z0), (x1, y1, z1)), in the mesh's units; None = the mesh's bounds, padded. Cubic
            cells fill it; samples are their centres, so the first lies half a spacing inside. Sides that are no
            multiple of the spacing grow at both ends.
        padding: Padding of the bounds on every side, as a share of their longest side; ignored with ``bounds``.
        shape: Number of samples (nx, ny, nz), for fields that can be stacked. Cubic cells about the centre of the box
            are as small as hold it; with ``voxel_size`` they have this size, and may cut the box. Without effect then:
            ``resolution``.
        cube: Whether the grid has ``resolution`` samples along every side: ``shape=(resolution,) * 3``.
        origin: Position of sample (0, 0, 0). It needs ``shape`` and ``voxel_size``, and with them says which samples
            there are, whatever ``bounds`` and ``padding`` say.
        align: Whether sample (0, 0, 0) lies on multiples of 8 spacings, as OpenVDB's leaves do. Samples of all such
            grids of one spacing then coincide, and their level sets can be combined. Excludes ``shape``.
        normalize: Whether the mesh is first moved to 0 and scaled, by the centre of its bounds, so that all meshes have
            one size. ``"sphere"`` (or True): the ball about 0 that holds it has radius 1. ``"cube"``: its longest side
            reaches from -1 to 1. ``"unit"``: from -0.5 to 0.5. Lengths of the field and of all other arguments are then
            those of the scaled mesh. ``field.centre`` and ``field.scale`` say what was done, and
            ``field.denormalized()`` undoes it.
        distance: Distance to the closest triangle: ``"exact"``, or the faster approximations ``"neighbours"``,
            ``"cell"`` and ``"raster"``.
        sign: Method that decides inside and outside: ``"harmonic"``, by one ray and the edges of holes, or by the
            smoothest field that fits all rays; ``"exact"``, ``"paths"``, ``"evolution"``, ``"rays"``, ``"ray"``, or
            ``"none"`` for distances without a sign.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, if the field then fits clearly
            better; ``"keep"``, never; ``"repair"``, whenever it fits no worse.
        passes: Number of passes of the sign ``"paths"``, or of steps of ``"evolution"``.
        sampling: Offset points of the signs ``"paths"`` and ``"evolution"``: ``"spread"`` over a box around the sample,
            or ``"paper"`` for those of the paper.
        offsets: Offset points of ``"paths"`` and ``"evolution"`` in samples, used in turn, in place of those of
            ``sampling``.
        threshold: A point is inside if |winding number| exceeds this.
        invert: Whether to make inside positive and outside negative.
        close_holes: Whether to measure distances to the surface that is missing in holes, too. Without it, holes are
            closed in steps as large as samples.
        thickness: Thickness of a wall around the surface, in the mesh's units, in place of the sign: for sheets that
            enclose nothing. Half of it pads the mesh's bounds besides.
        band: Number of samples at which distances are clamped; None = not clamped. With ``sparse=True`` also two
            numbers (inside, outside), of which the first may be infinite: all distances inside are then kept.
        truncation: Distance at which distances are clamped, in place of ``band``. ``field.tsdf()`` divides by it.
        arrays: Names of the arrays to make: ``"winding"``, ``"confidence"`` and ``"triangle"`` beside ``"distance"``,
            which every field has.
        allow_empty: Whether to accept a mesh without triangles. All samples are then outside and as far as numbers go:
            at the ``band``, or at the largest float without one. They have no triangle, winding number 0 and confidence
            1.
        device: Device that computes: ``"cpu"``; ``"vulkan:K"``, the Kth Vulkan device; ``"vulkan"``, the best of them,
            which may be a software rasterizer; ``"auto"``, a real GPU if one is usable, else the CPU.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        memory_limit: Most bytes that the call and its result may hold; None = what is available.
        progress: A callable that receives the name of a stage and the share of it that is done, 0 to 1, about ten
            times a second. It cancels by returning False or by raising. True shows a bar in a notebook,
            a moving line on a terminal, else a line a minute on stderr; ``"plain"`` does the last anywhere, and ``"json"``
            writes an object a line.
        sparse: Whether to make the samples within the ``band`` alone, 3 samples if it is None: a narrow band,
            on the CPU. The magnitude must be ``"exact"`` and the sign ``"harmonic"`` or ``"none"``.

    Raises:
        InputError: The mesh has no face, a vertex number out of range or a position that is not finite.
        UsageError: Arguments that make no sense or contradict each other.
        MemoryLimitError: The field needs more memory than allowed.
        FileError: The file cannot be read.
        Cancelled: ``progress`` returned False.
        UnsupportedError: There is no such device.
        DeviceLostError: The GPU stopped answering.

    >>> field = raymap.generate("ball.ply", resolution=32)
    >>> field.distance.shape, field.distance.dtype
    ((32, 32, 32), dtype('float32'))
    >>> bool(field.distance[16, 16, 16] < 0 < field.distance[0, 0, 0])
    True
    >>> field.origin.round(2), round(field.spacing, 4)
    (array([-1.16, -1.16, -1.16]), 0.075)
    >>> raymap.generate("tetrahedron.ply", resolution=32, cube=True, normalize="cube").shape
    (32, 32, 32)
    """
    given = locals()
    options: FieldOptions = {name: given[name] for name in FieldOptions.__annotations__}  # type: ignore[assignment]
    if sparse:
        return _generate_sparse(_inputs.to_mesh(mesh_or_vertices, faces), options)
    return Generator().generate(mesh_or_vertices, faces, **options)


def _generate_sparse(mesh: Mesh, options: FieldOptions) -> Field:
    frame = frame_of(mesh, to_normalization(options.get("normalize", False)))
    core = core_of(moved(mesh, frame))
    grid = fit_grid(partial(_raymap.fit_grid, core), options)
    options = with_band(options, grid)
    core_options = to_options(options, options.get("orientation", "auto"), sparse=True)
    core_options.set("compact", _raymap.is_compact_better(grid, len(mesh.faces)))
    with reporting(options.get("progress")) as report:
        surface = _raymap.Surface(core, core_options, report)
        return field_of_core(surface.generate_sparse(grid, core_options, report), frame)


class Generator:
    """Makes fields and keeps its memory and its device between calls, for meshes that change.

    Several threads may share one; they wait for each other. Fields stay valid as long as they are referred to. The
    memory of one that is no longer referred to is used again.

    >>> generator = raymap.Generator()
    >>> ball = raymap.load_mesh("ball.ply")
    >>> for size in 1.0, 2.0:
    ...     field = generator.generate(ball.vertices * size, ball.faces, resolution=16)
    ...     print(field.spacing.__round__(3))
    0.15
    0.3
    """

    def __init__(self) -> None:
        self._core = _raymap.Generator()

    def generate(self, mesh_or_vertices: Any, faces: Any = None, **options: Unpack[FieldOptions]) -> Field:
        """Returns the signed distance field of a mesh, negative inside.

        Arguments and errors are those of ``raymap.generate``.
        """
        check_names("generate", options, FieldOptions)
        given = to_mesh(mesh_or_vertices, faces, options)
        frame = frame_of(given, to_normalization(options.get("normalize", False)))
        mesh, grid, core_options = to_core(moved(given, frame), options)
        with reporting(options.get("progress")) as report:
            return field_of_core(self._core.generate(mesh, grid, core_options, report), frame)


def to_core(given: Mesh, options: FileFieldOptions) -> tuple[_raymap.Mesh, _raymap.Grid, _raymap.Options]:
    """Returns a mesh, the grid and the options as the extension module takes them."""
    mesh = core_of(given)
    grid = fit_grid(partial(_raymap.fit_grid, mesh), options)
    return mesh, grid, to_options(with_band(options, grid), options.get("orientation", "auto"), sparse=False)


def to_mesh(mesh_or_vertices: Any, faces: Any, options: FileFieldOptions) -> Mesh:
    """Returns the mesh. One without faces must be allowed, and needs a box."""
    mesh = _inputs.to_mesh(mesh_or_vertices, faces, allow_empty=True)
    if len(mesh.faces) == 0:
        name = f"{mesh_or_vertices}: " if isinstance(mesh_or_vertices, (str, os.PathLike)) else ""
        if not options.get("allow_empty", False):
            raise InputError(f"{name}the mesh has no faces; with allow_empty=True its field is far everywhere")
        if options.get("bounds") is None:
            raise UsageError(f"{name}the mesh has no faces, so it has no bounds; give bounds")
    return mesh


def fit_grid(fit: Callable[..., _raymap.Grid], options: SurfaceFieldOptions) -> _raymap.Grid:
    """Returns the grid that the options ask for, fitted by a function of the extension module."""
    shape = _to_shape(options, to_whole("resolution", options.get("resolution", 128), least=1))
    names = ("resolution", "voxel_size", "bounds", "padding", "thickness", "align")
    core = core_options({name: value for name, value in options.items() if name in names}, shape=shape)
    if (bounds := options.get("bounds")) is not None and any(low == high for low, high in zip(*to_box("bounds", bounds))):
        raise UsageError("bounds: each of x0, y0, z0 must be less than its x1, y1, z1")
    if (origin := options.get("origin")) is not None:
        if shape is None or (voxel_size := options.get("voxel_size")) is None:
            raise UsageError("origin needs shape and voxel_size beside it; or say the box by bounds")
        return _raymap.Grid(shape, to_vector("origin", origin), voxel_size)
    if options.get("align") and shape is not None:
        raise UsageError("align says where samples lie, as shape and cube do; leave one of them out")
    return fit(core)


def _to_shape(options: SurfaceFieldOptions, resolution: int) -> tuple[int, int, int] | None:
    """Returns the number of samples if it does not depend on the mesh."""
    shape, cube = options.get("shape"), options.get("cube", False)
    if shape is not None:
        if cube:
            raise UsageError("shape and cube both say how many samples there are; leave one of them out")
        return to_wholes("shape", shape, least=1)
    if not cube:
        return None
    if options.get("voxel_size") is not None:
        raise UsageError("a cube has resolution samples along each side; with voxel_size, give shape in place of cube")
    return (resolution,) * 3


_Options = TypeVar("_Options", bound=SurfaceFieldOptions)


def with_band(options: _Options, grid: _raymap.Grid) -> _Options:
    """Returns options in which a truncation is the band that it is on the grid."""
    if (truncation := options.get("truncation")) is None:
        return options
    if options.get("band") is not None:
        raise UsageError("truncation takes the place of band; leave one of them out")
    return {**options, "band": to_length("truncation", truncation) / grid.spacing, "truncation": None}  # type: ignore[return-value]


def to_options(given: SurfaceFieldOptions, orientation: Orientation, *, sparse: bool) -> _raymap.Options:
    """Returns the options of a field, or of a narrow band, as the extension module takes them."""
    options: dict[str, Any] = {name: value for name, value in given.items() if name not in _OWN}
    sign, band = to_text("sign", given.get("sign", "harmonic")), given.get("band")
    if given.get("thickness") is not None:
        if sign not in ("harmonic", "none"):
            raise UsageError("thickness takes the place of sign; leave one of them out")
        sign = "none"
    if sparse:
        options |= band_options(given, sign) | {"device": "cpu"}
    elif band is not None:
        if np.ndim(band) > 0:
            raise UsageError("band must be one number; with sparse=True, it may be two: (inside, outside)")
        options["band"] = to_length("band", band)
    options |= {"sign": sign, "orientation": orientation} | array_options(given.get("arrays", ("distance",)))
    if sign == "none" and options.keys() & {"winding", "confidence"}:
        raise UsageError("winding and confidence need a sign; leave out sign='none' and thickness")
    return core_options({"device": "auto"} | options)


# Arguments that have another form in the library, or none.
_OWN = {"arrays", "band", "cube", "normalize", "origin", "progress", "shape", "truncation"}
