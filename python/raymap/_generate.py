"""Fields from meshes."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any, Literal, TypedDict, TypeVar, Unpack, overload

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap
from ._arguments import FINITE, set_arrays, to_box, to_length, to_number, to_text, to_vector, to_whole, to_wholes
from ._arrays import to_numpy
from ._devices import to_machine
from ._errors import InputError, UsageError
from ._field import Field, field_of_core
from ._frames import Normalization, frame_of, moved, to_normalization
from ._mesh import Mesh, core_of
from ._progress import Progress, reporting
from ._records import DistanceMode, FieldArray, Orientation, Sampling, SignMode
from ._sparse import Band, SparseField, sparse_of_core, sparse_options


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


class FieldOptions(SurfaceFieldOptions, total=False):
    """Keyword arguments of ``raymap.generate``, which documents them."""

    orientation: Orientation
    allow_empty: bool
    normalize: bool | Normalization


@overload
def generate(
    mesh_or_vertices: Any, faces: Any = None, *, sparse: Literal[False] = False, **options: Unpack[FieldOptions]
) -> Field: ...
@overload
def generate(
    mesh_or_vertices: Any, faces: Any = None, *, sparse: Literal[True], **options: Unpack[FieldOptions]
) -> SparseField: ...
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
    sampling: Sampling = "raymap",
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
) -> Field | SparseField:
    """Returns the signed distance field of a triangle mesh, negative inside.

    Any mesh will do: with holes, overlaps, missing parts, or faces that point the wrong way. Nothing is scaled or
    moved unless ``normalize`` asks for it: all lengths are in the mesh's units. The same mesh and arguments give the same field, bit for bit, on the
    same device, for any number of threads. Ctrl-C stops the call.

    Args:
        mesh_or_vertices: A mesh (``raymap.Mesh``, or of trimesh, Open3D, meshio or PyVista), the path of a file, or
            positions, (n, 3): NumPy, or any array with ``__dlpack__``.
        faces: Three vertex numbers per triangle, (m, 3), counter-clockwise seen from outside, if positions are given.
        resolution: Number of samples along the longest side of the grid. Without effect if ``voxel_size`` is given.
        voxel_size: Distance between samples, in the mesh's units.
        bounds: Box to cover, ((x0, y0, z0), (x1, y1, z1)), in the mesh's units; None = the mesh's bounds, padded. Cubic
            cells fill it; samples are their centres, so the first lies half a spacing inside. Sides that are no
            multiple of the spacing grow at both ends.
        padding: Padding of the mesh's bounds on every side, as a share of their longest side. Without effect if
            ``bounds`` is given.
        shape: Number of samples (nx, ny, nz), for fields that can be stacked. Cubic cells about the centre of the box
            are as small as hold it; with ``voxel_size`` they have this size, and may cut the box. Without effect then:
            ``resolution``.
        cube: Whether the grid has ``resolution`` samples along every side: ``shape=(resolution,) * 3``.
        origin: Position of sample (0, 0, 0). It needs ``shape`` and ``voxel_size``, and with them says which samples
            there are, whatever ``bounds`` and ``padding`` say.
        align: Whether sample (0, 0, 0) lies on multiples of 8 times the spacing, as OpenVDB's leaves do. Samples of all
            such fields of one ``voxel_size`` coincide, so level sets of them can be combined. The grid then begins up
            to 8 samples before the box. Not with ``shape`` or ``cube``.
        normalize: Whether the mesh is first moved to 0 and scaled, by the centre of its bounds, so that all meshes have
            one size. ``"sphere"`` (or True): the ball about 0 that holds it has radius 1. ``"cube"``: its longest side
            reaches from -1 to 1. ``"unit"``: from -0.5 to 0.5. Lengths of the field and of all other arguments are then
            those of the scaled mesh. ``field.centre`` and ``field.scale`` say what was done, and
            ``field.denormalized()`` undoes it.
        distance: Source of the magnitude: ``"exact"``, or the faster approximations ``"neighbours"``, ``"cell"`` and
            ``"raster"``.
        sign: Method that decides inside and outside: ``"harmonic"``, ``"exact"``, ``"paths"``, ``"evolution"``,
            ``"rays"``, ``"ray"``, or ``"none"`` for an unsigned field.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, if the field then fits clearly
            better; ``"keep"``, never; ``"repair"``, whenever it fits no worse.
        passes: Number of passes of ``sign="paths"``, or of steps of ``"evolution"``.
        sampling: Offset points of ``"paths"`` and ``"evolution"``: ``"raymap"``, or ``"paper"`` for those of the paper.
        offsets: Offset points in place of those of ``sampling``, (n, 3) whole numbers of samples, used in turn.
        threshold: A sample is inside if the magnitude of its winding number exceeds this.
        invert: Whether inside is positive instead of negative.
        close_holes: Whether distances count the surface that is missing in holes.
        thickness: Thickness of a wall around the surface, in the mesh's units, in place of the sign: for sheets that
            enclose nothing. Half of it pads the mesh's bounds besides.
        band: Number of samples at which distances are clamped; None = not clamped. With ``sparse=True`` also two
            numbers (inside, outside), of which the first may be infinite: all distances inside are then kept.
        truncation: Distance at which distances are clamped, in place of ``band``. ``field.tsdf()`` divides by it.
        arrays: Names of the arrays to make: ``"winding"``, ``"confidence"`` and ``"triangle"`` beside ``"distance"``,
            which every field has.
        allow_empty: Whether the mesh may have no faces. Its field on the grid of ``bounds`` is far everywhere: at the
            ``band``, or at the largest float32.
        device: Device that computes: ``"cpu"``, ``"vulkan"``, ``"vulkan:K"``, or ``"auto"``, a GPU if there is a real
            one, else the CPU; see ``raymap.devices``.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        memory_limit: Most bytes that the work and the field may take; None = what is available.
        progress: A callable that receives the name of a stage and the share of it that is done, 0 to 1, about ten
            times a second. It cancels by returning False or by raising. True shows a bar in a notebook,
            a moving line on a terminal, else a line a minute on stderr; ``"plain"`` does the last anywhere, and ``"json"``
            writes an object a line.
        sparse: Whether to make the samples within the ``band`` alone, 3 samples if it is None: a ``raymap.SparseField``,
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
    options = FieldOptions(
        resolution=resolution,
        voxel_size=voxel_size,
        bounds=bounds,
        padding=padding,
        shape=shape,
        cube=cube,
        origin=origin,
        align=align,
        normalize=normalize,
        distance=distance,
        sign=sign,
        orientation=orientation,
        passes=passes,
        sampling=sampling,
        offsets=offsets,
        threshold=threshold,
        invert=invert,
        close_holes=close_holes,
        thickness=thickness,
        band=band,
        truncation=truncation,
        arrays=arrays,
        allow_empty=allow_empty,
        device=device,
        threads=threads,
        memory_limit=memory_limit,
        progress=progress,
    )
    if sparse:
        return _generate_sparse(_inputs.to_mesh(mesh_or_vertices, faces), options)
    return Generator().generate(mesh_or_vertices, faces, **options)


def _generate_sparse(mesh: Mesh, options: FieldOptions) -> SparseField:
    frame = frame_of(mesh, to_normalization(options.get("normalize", False)))
    core = core_of(moved(mesh, frame))
    grid = fit_grid(partial(_raymap.fit_grid, core), options)
    options = with_band(options, grid)
    core_options = to_options(options, options.get("orientation", "auto"), sparse=True)
    band_options = sparse_options(options, core_options)
    surface_options = _raymap.SurfaceOptions()
    surface_options.sign, surface_options.threshold = core_options.sign != "none", core_options.threshold
    surface_options.compact = _raymap.is_compact_better(grid, len(mesh.faces))
    machine = to_machine("cpu", options.get("threads"), options.get("memory_limit"))
    with reporting(options.get("progress")) as report:
        surface = _raymap.Surface(core, surface_options, core_options.orientation, machine, report)
        return sparse_of_core(surface.generate_sparse(grid, band_options, machine, report), frame)


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
        given = _to_mesh(mesh_or_vertices, faces, options)
        frame = frame_of(given, to_normalization(options.get("normalize", False)))
        mesh = core_of(moved(given, frame))
        grid = fit_grid(partial(_raymap.fit_grid, mesh), options)
        options = with_band(options, grid)
        core_options = to_options(options, options.get("orientation", "auto"), sparse=False)
        core_options.allow_empty = bool(options.get("allow_empty", False))
        machine = to_machine(options.get("device", "auto"), options.get("threads"), options.get("memory_limit"))
        with reporting(options.get("progress")) as report:
            return field_of_core(self._core.generate(mesh, grid, core_options, machine, report), frame)


def _to_mesh(mesh_or_vertices: Any, faces: Any, options: FieldOptions) -> Mesh:
    """Returns the mesh. One without faces must be allowed, and needs a box."""
    mesh = _inputs.to_mesh(mesh_or_vertices, faces, allow_empty=True)
    if len(mesh.faces) == 0:
        name = f"{mesh_or_vertices}: " if isinstance(mesh_or_vertices, (str, os.PathLike)) else ""
        if not options.get("allow_empty", False):
            raise InputError(f"{name}the mesh has no faces; with allow_empty=True its field is far everywhere")
        if options.get("bounds") is None:
            raise UsageError(f"{name}the mesh has no faces, so it has no bounds; give bounds")
    return mesh


def check_names(function: str, given: SurfaceFieldOptions, known: type) -> None:
    """Refuses unknown names of arguments."""
    if unknown := given.keys() - known.__annotations__.keys():
        raise TypeError(f"{function}() got an unexpected keyword argument {sorted(unknown)[0]!r}")


def fit_grid(fit: Callable[..., _raymap.Grid], options: SurfaceFieldOptions) -> _raymap.Grid:
    """Returns the grid that the options ask for, fitted by a function of the extension module."""
    voxel_size = options.get("voxel_size")
    size = 0.0 if voxel_size is None else to_length("voxel_size", voxel_size)
    box = None
    if (bounds := options.get("bounds")) is not None:
        box = to_box("bounds", bounds)
        if any(low == high for low, high in zip(*box)):
            raise UsageError("bounds: each of x0, y0, z0 must be less than its x1, y1, z1")
    thickness = options.get("thickness")
    wall = 0.0 if thickness is None else to_length("thickness", thickness)
    padding = to_number("padding", options.get("padding", 0.1), least=0.0, most=FINITE)
    resolution = to_whole("resolution", options.get("resolution", 128), least=1)
    shape = _to_shape(options, resolution)
    if (origin := options.get("origin")) is not None:
        if shape is None or size == 0.0:
            raise UsageError("origin needs shape and voxel_size beside it; or say the box by bounds")
        return _raymap.Grid(shape, to_vector("origin", origin), size)
    align = bool(options.get("align", False))
    if align and shape is not None:
        raise UsageError("align says where samples lie, as shape and cube do; leave one of them out")
    return fit(resolution, size, shape, box, padding, wall, align)


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


def to_options(given: SurfaceFieldOptions, orientation: Orientation, *, sparse: bool) -> _raymap.FieldOptions:
    """Returns the options as the extension module takes them; those of a narrow band without its widths."""
    options = _raymap.FieldOptions()
    options.distance = to_text("distance", given.get("distance", "exact"))
    options.sign = to_text("sign", given.get("sign", "harmonic"))
    options.orientation = to_text("orientation", orientation)
    options.passes = to_whole("passes", given.get("passes", 5))
    options.sampling = to_text("sampling", given.get("sampling", "raymap"))
    options.set_offsets(_to_offsets(given.get("offsets")))
    options.threshold = to_number("threshold", given.get("threshold", 0.5), least=0.0, most=FINITE)
    options.invert = bool(given.get("invert", False))
    options.close_holes = bool(given.get("close_holes", False))
    _set_thickness(options, given.get("thickness"))
    if not sparse and (band := given.get("band")) is not None:
        if np.ndim(band) > 0:
            raise UsageError("band must be one number; with sparse=True, it may be two: (inside, outside)")
        options.band = to_length("band", band)
    set_arrays(options, given.get("arrays", ("distance",)))
    if options.sign == "none" and (options.winding or options.confidence):
        raise UsageError("winding and confidence need a sign; leave out sign='none' and thickness")
    return options


def _to_offsets(offsets: npt.ArrayLike | None) -> list[tuple[int, int, int]]:
    if offsets is None:
        return []
    array = to_numpy("offsets", offsets)
    if array.ndim != 2 or array.shape[1] != 3 or array.shape[0] == 0 or array.dtype.kind not in "iu":
        raise UsageError(f"offsets must be (n, 3) whole numbers, not {array.dtype} of the shape {array.shape}")
    if np.abs(array.astype(np.float64)).max() >= 2**31:
        raise UsageError("offsets must be whole numbers of 32 bits")
    return [(x, y, z) for x, y, z in array.tolist()]


def _set_thickness(options: _raymap.FieldOptions, thickness: float | None) -> None:
    if thickness is None:
        return
    if options.sign not in ("harmonic", "none"):
        raise UsageError("thickness takes the place of sign; leave one of them out")
    options.sign, options.thickness = "none", to_length("thickness", thickness)
