"""Defects of meshes, and watertight solids in their place."""

from __future__ import annotations

import operator
from typing import Any, Literal, NamedTuple, TypedDict, overload

from . import _inputs, _raymap
from ._arrays import to_vector
from ._errors import UsageError
from ._field import Field, Stats
from ._generate import Orientation, set_machine
from ._mesh import Mesh, core_of, mesh_of_core
from ._progress import Progress, reporting


MeshKind = Literal[
    "no_surface",
    "double_sided",
    "soup",
    "sheet",
    "open_solid",
    "turned_faces",
    "overlapping_solids",
    "crossing_solid",
    "flawed_solid",
    "inside_out",
    "several_solids",
    "clean_solid",
]


class Hole(TypedDict):
    """A boundary loop. Lengths are in the mesh's units."""

    edges: int
    length: float
    area: float
    """Least area of a surface that closes it."""
    centre: list[float]
    """Mean of the edges' ends."""
    diameter: float
    """Twice the distance from the centre to the farthest vertex."""


class SelfIntersections(TypedDict):
    """Faces that cross others."""

    pairs: int
    faces: int
    complete: bool
    """False if the search stopped early: there are at least so many pairs."""


class NotCounted(TypedDict):
    """Stands for a count that was not made."""

    counted: Literal[False]


class Verdict(TypedDict):
    """Kind of thing that a mesh is, and the remedy that makes a clean solid of it."""

    kind: MeshKind
    remedy: Literal["none", "repair", "thicken"]
    sought: float
    """Parts thinner than this were looked for; 0 if the thickness was not measured."""
    thinnest: float | None
    """Thickness of the thinnest part. None if no part is thinner than ``sought``."""
    voxel_size: float | None
    """Largest distance between samples that keeps that part."""


class FastDiagnostics(TypedDict):
    """Size, topology and defects of a mesh, measured after welding vertices at exactly equal positions."""

    vertices: int
    vertices_welded: int
    triangles: int
    watertight: bool
    """Whether every edge has exactly two faces."""
    consistently_oriented: bool
    """Whether neighbours agree across every edge with two faces."""
    balanced: bool
    """Whether every edge is used equally often both ways: the inside is definite."""
    components: int
    open_components: int
    """Components with boundary edges. Of a double-sided mesh, those of one side; so are the next three."""
    inward_components: int
    """Closed components with a negative volume: cavities, or turned inside out."""
    sheets: int
    """Open components whose holes make up 30 % of their area or more, once closed."""
    sheet_share: float
    """Share of the area that is in sheets."""
    boundary_edges: int
    hole_count: int
    holes: list[Hole]
    """The longest first."""
    nonmanifold_edges: int
    flipped_edges: int
    flipped_faces: int
    degenerate_faces: int
    duplicate_faces: int
    double_sided_faces: int
    signed_volume: float
    """In the mesh's units cubed; positive if faces point outwards."""
    area: float
    bbox_min: list[float]
    bbox_max: list[float]


class Diagnostics(FastDiagnostics):
    """The same with the faces that cross others."""

    self_intersections: SelfIntersections


class Info(Diagnostics):
    """Diagnostics of a mesh, and a verdict."""

    verdict: Verdict


class FastInfo(FastDiagnostics):
    """Result of ``raymap.info`` with ``fast=True``."""

    self_intersections: NotCounted
    verdict: Verdict


@overload
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: Literal[False] = False, progress: Progress = None) -> Info: ...
@overload
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: Literal[True], progress: Progress = None) -> FastInfo: ...
@overload
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: bool, progress: Progress = None) -> Info | FastInfo: ...
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: bool = False, progress: Progress = None) -> Info | FastInfo:
    """Returns size, topology and defects of a mesh: what ``raymap info --json`` prints.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        fast: Whether not to count faces that cross others, nor to measure the thickness. Takes less than half of the time.
            ``self_intersections`` is then ``{"counted": False}``.
        progress: A callable that receives a stage and its share, 0 to 1; True for a line on stderr.

    Raises:
        InputError: The mesh has no face, a vertex number out of range or a position that is not finite.
        FileError: The file cannot be read.

    >>> found = raymap.info("ball.ply")
    >>> found["triangles"], found["watertight"], found["boundary_edges"]
    (1280, True, 0)
    >>> found["verdict"]["kind"], found["verdict"]["remedy"]
    ('clean_solid', 'none')
    """
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    with reporting(progress) as report:
        return _raymap.info(mesh, bool(fast), report)  # type: ignore[return-value]


class Deviation(TypedDict):
    """How far points of one surface lie from where they should, in the mesh's units."""

    max: float
    mean: float
    p99: float
    points: int


class Simplified(TypedDict):
    """How the isosurface was simplified. Lengths are in the mesh's units."""

    tolerance: float
    """0: not simplified."""
    triangles_before: int
    triangles_after: int
    deviation: float
    """Largest distance measured, from points of either mesh to the other."""


class Loss(TypedDict):
    """Parts of the mesh that a repair loses: those of its solid that are too thin for the samples, and
    surface that bounds no solid."""

    solid_share: float
    """Share of the mesh's area that is lost and bounds such a part."""
    bbox_min: list[float]
    """Bounds of this area; 0 if there are none."""
    bbox_max: list[float]
    thinnest: float
    """Thickness at its thinnest point, with the offset."""
    median_thickness: float
    """Median thickness over this area; 0 if it is not known."""
    voxel_size: float
    """Largest distance between samples that keeps the parts; if none does, the one that keeps most."""
    is_kept: bool
    """Whether ``voxel_size`` keeps them: all but 0.5 % of the area."""
    kept_share: float
    """Share of the lost area that ``voxel_size`` keeps."""
    kept_thickness: float
    """Median thickness of the parts that ``voxel_size`` does not keep."""
    dropped_share: float
    """Share of the mesh's area that is lost with the small parts that were dropped."""
    open_share: float
    """Share of the mesh's area that is lost and bounds nothing: sheets, open surface."""
    open_bbox_min: list[float]
    """Bounds of this area; 0 if there is none."""
    open_bbox_max: list[float]


class Removed(TypedDict):
    """Parts or cavities that a result lacks. Volumes are what their surfaces enclose, in the mesh's units cubed."""

    count: int
    volume: float
    """Sum of the volumes."""
    largest: float


class HolePlace(TypedDict):
    """A drain hole: where its axis leaves the solid, and its direction of length 1 there."""

    position: list[float]
    direction: list[float]


class RepairReport(TypedDict):
    """Changes that a repair made, and how far the result is from the mesh."""

    before: Diagnostics
    after: Diagnostics
    result_from_mesh: Deviation
    """From points of the result to the given surface, moved by the offset."""
    mesh_from_result: Deviation
    """From points of the given mesh, moved by the offset, to the result; not from the buried ones."""
    kept_from_result: Deviation
    """The same without the lost points."""
    buried_share: float
    """Share of the mesh's area more than a sample inside the result. A tolerance above the default allows as much more,
    here and in ``lost_share``."""
    lost_share: float
    """Share of it more than a sample outside: parts thinner than the samples, or open."""
    trimmed_share: float
    """Share of the mesh's area that the offset removes. All other shares are relative to what remains."""
    loss: Loss
    hollows: int
    filled_hollows: int
    """Number of hollows that a drain hole does not fit into; they are solid."""
    drain_holes: int
    drain_hole_places: list[HolePlace]
    """Where they are, hollow by hollow."""
    solids: int
    """Number of parts of the result; those in cavities count, too."""
    cavities: int
    """Number of sealed cavities of the result: those of the shell count, too."""
    drop_smaller: float
    """Volume below which parts were dropped."""
    dropped: Removed
    """Parts that were too small."""
    filled: Removed
    """Sealed cavities that were filled."""
    buried: Removed
    """Parts in cavities that were filled."""
    parts_overlap: bool
    """Whether parts of a mesh with no other defect overlap or face the wrong way."""
    kept: bool
    """Whether the mesh's own faces were kept, because nothing was wrong with it, or only holes."""
    closed_holes: int
    """Number of holes that were closed beside the faces that were kept."""
    closing_faces: int
    """Number of faces that close them."""
    thickened_share: float
    """Share of the mesh's area that was thinner than ``min_thickness``."""
    simplified: Simplified


class Repaired(NamedTuple):
    """A repaired mesh, and what was done."""

    mesh: Mesh
    report: RepairReport
    stats: Stats
    """Cost of the field, then of the stages after it."""


def repair(
    mesh_or_vertices: Any,
    faces: Any = None,
    *,
    resolution: int = _raymap.repair_resolution,
    voxel_size: float | None = None,
    orientation: Orientation = "auto",
    close_holes: bool = True,
    offset: float = 0.0,
    shell: float = 0.0,
    drain_hole: float = 0.0,
    drain_holes: int = 1,
    min_thickness: float = 0.0,
    down: tuple[float, float, float] = (0.0, 0.0, -1.0),
    drop_smaller: float | None = None,
    keep_cavities: bool = False,
    remesh: bool = False,
    tolerance: float | None = None,
    device: str = "auto",
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Repaired:
    """Returns a watertight solid in place of any mesh, for example to print it.

    A mesh that has nothing wrong and needs no change is returned with its own faces. So is one with small holes, which
    get faces. Else the result is the surface of the mesh's field, so details smaller than a sample are lost. The deviation is measured.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        resolution: Number of samples along the longest side. Without effect if ``voxel_size`` is given.
        voxel_size: Distance between samples, in the mesh's units.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, ``"keep"`` or ``"repair"``.
        close_holes: Whether distances count the surface that closes holes. Without it, holes are closed in steps.
        offset: Distance to move the surface outwards, in the mesh's units; negative: inwards.
        shell: Thickness of the walls of a hollow solid, in the mesh's units; 0 = not hollow.
        drain_hole: Diameter of the drain holes; 0 = none.
        drain_holes: Number of drain holes of each hollow: down from its lowest point, then as a vent up from its
            highest one, then down from level floors as far from the others as there are.
        min_thickness: Thickness of the plates that take the place of thinner walls, fins and sheets, in the mesh's
            units; 0 = none. At least two samples.
        down: Direction of the drain holes.
        drop_smaller: Volume in the mesh's units cubed. Parts of the result that enclose less are dropped. None: a
            thousandth of what the largest part encloses.
        keep_cavities: Whether sealed cavities stay; else they are filled, with all parts in them.
        remesh: Whether to make a mesh anew whose faces could be kept.
        tolerance: Largest deviation of the result from the isosurface, in the mesh's units, to have fewer
            triangles; None = a tenth of the distance between samples; 0 = all triangles.
        device: Device that computes; see ``raymap.devices``.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        memory_limit: Most bytes that the field may take; None = what is available.
        progress: A callable that receives a stage and its share, 0 to 1; True for a line on stderr.

    Raises:
        InputError: The mesh is not valid, or encloses nothing.
        UsageError: Arguments that make no sense, for example walls thinner than two samples.
        MemoryLimitError: The field needs more memory than allowed.

    >>> mesh, report, stats = raymap.repair("ball.ply", resolution=32)
    >>> report["after"]["watertight"], report["after"]["boundary_edges"]
    (True, 0)
    """
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    if voxel_size is not None and not voxel_size > 0:
        raise UsageError(f"voxel_size must be above 0, not {voxel_size}")
    options = _raymap.Options()
    options.orientation = orientation
    set_machine(options, device, threads, memory_limit)
    how = _raymap.RepairOptions()
    how.close_holes = bool(close_holes)
    how.offset, how.shell, how.drain_hole, how.down = float(offset), float(shell), float(drain_hole), to_vector(down)
    how.drain_holes = operator.index(drain_holes)
    how.drop_smaller = None if drop_smaller is None else float(drop_smaller)
    how.keep_cavities, how.remesh = bool(keep_cavities), bool(remesh)
    how.min_thickness = float(min_thickness)
    if tolerance is not None:
        how.tolerance = float(tolerance)
    with reporting(progress) as report:
        result, found, stats = _raymap.repair(
            mesh, operator.index(resolution), voxel_size or 0.0, options, how, report
        )
    return Repaired(mesh_of_core(result), found, Stats(**stats))  # type: ignore[arg-type]


def isosurface(
    distance: Any,
    iso: float = 0.0,
    *,
    origin: Any = (0.0, 0.0, 0.0),
    spacing: float = 1.0,
    threads: int | None = None,
    progress: Progress = None,
) -> Mesh:
    """Returns the surface of an array of distances, negative inside, as a closed mesh.

    ``Field.to_mesh`` does the same for a field.

    Args:
        distance: Distances, (nx, ny, nz), i along x: NumPy, or any array with ``__dlpack__``.
        iso: Distance of the surface; above 0 outside of the shape.
        origin: Position of sample (0, 0, 0).
        spacing: Distance between samples.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        progress: A callable that receives a stage and its share, 0 to 1; True for a line on stderr.

    Raises:
        UsageError: There is no surface at ``iso``, or the array is not (nx, ny, nz).
        InputError: A sample is not finite.

    >>> x, y, z = np.mgrid[-2:3, -2:3, -2:3]
    >>> mesh = raymap.isosurface(np.maximum(np.maximum(abs(x), abs(y)), abs(z)) - 1.5, origin=(-2, -2, -2))
    >>> mesh.bounds.round(1)
    array([[-1.5, -1.5, -1.5],
           [ 1.5,  1.5,  1.5]])
    """
    return Field(distance, origin, spacing).to_mesh(iso, threads=threads, progress=progress)
