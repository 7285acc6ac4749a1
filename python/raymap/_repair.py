"""Defects of meshes, and watertight solids in their place."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap, _views
from ._errors import UsageError
from ._field import Field
from ._mesh import Mesh, core_of, mesh_of_core
from ._options import core_options
from ._progress import Progress, reporting
from ._records import Diagnostics, Inspection, Orientation, RepairReport, SimplifyReport, Verdict


class Info(Inspection):
    """Diagnostics of a mesh, and a verdict."""

    verdict: Verdict
    kind_text: str  #: What the mesh is, as the end of "This is", and what else is wrong with it.
    defects_text: str  #: Its defects with their numbers; "nothing" if there is none.
    thickness_text: str  #: How thick its thinnest part is, and what a repair keeps of it; empty if it is no solid.


class FastInfo(Diagnostics):
    """Result of ``raymap.info`` with ``fast=True``."""

    self_intersections: None
    verdict: Verdict
    kind_text: str
    defects_text: str
    thickness_text: str


@overload
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: Literal[False] = False, progress: Progress = None) -> Info: ...
@overload
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: Literal[True], progress: Progress = None) -> FastInfo: ...
@overload
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: bool, progress: Progress = None) -> Info | FastInfo: ...
def info(mesh_or_vertices: Any, faces: Any = None, *, fast: bool = False, progress: Progress = None) -> Info | FastInfo:
    """Returns size, topology and defects of a mesh: what ``raymap info --json`` prints, and its sentences.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        fast: Whether not to count faces that cross others, nor to measure the thickness. Takes less than half of the time.
            ``self_intersections`` is then None.
        progress: A callable that receives a stage and its share, 0 to 1; True to show it.

    Raises:
        InputError: The mesh has no face, a vertex number out of range or a position that is not finite.
        FileError: The file cannot be read.

    >>> found = raymap.info("ball.ply")
    >>> found["triangles"], found["watertight"], found["boundary_edges"]
    (1280, True, 0)
    >>> found["verdict"]["kind"], found["verdict"]["remedy"]
    ('clean_solid', 'none')
    >>> found["kind_text"]
    'a clean solid, with nothing wrong.'
    """
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    with reporting(progress) as report:
        return _raymap.info(mesh, bool(fast), report)  # type: ignore[return-value]


def render_defects(
    mesh_or_vertices: Any,
    faces: Any = None,
    *,
    width: int = 1024,
    height: int = 768,
    direction: tuple[float, float, float] = (-0.6, -0.45, -1.0),
    up: tuple[float, float, float] = (0.0, 1.0, 0.0),
    field_of_view: float = 30.0,
) -> npt.NDArray[np.uint8]:
    """Returns a picture of a mesh with its defects in colour, (h, w, 3) uint8, rows from the top.

    Edges with one face are red, with more than two violet. Faces that cross others are orange, those that point against
    their neighbours blue, double-sided ones green, duplicates yellow, backs darker.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        width: Width in pixels.
        height: Height in pixels.
        direction: Direction from the camera to the mesh.
        up: Direction up in the picture.
        field_of_view: Angle from the bottom to the top of the picture, in degrees.

    Raises:
        InputError: The mesh is not valid.
        UsageError: Arguments that make no picture.
        FileError: The file cannot be read.

    >>> raymap.render_defects("ball.ply", width=64, height=48).shape
    (48, 64, 3)
    """
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    return _raymap.render_defects(mesh, core_options(width=width, height=height, direction=direction, up=up, field_of_view=field_of_view))


def _check_triangles(triangles: int | None, tolerance: float | None) -> None:
    if triangles is not None and tolerance == 0:
        raise UsageError("a tolerance of 0 keeps all triangles, so their number cannot be limited; leave one of both out")


@_views.shown
class Simplified(NamedTuple):
    """A mesh with fewer faces, and how far it is from the given one."""

    mesh: Mesh
    report: SimplifyReport


def simplify(
    mesh_or_vertices: Any,
    faces: Any = None,
    *,
    tolerance: float | None = None,
    triangles: int | None = None,
    step: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> Simplified:
    """Returns a mesh with fewer faces, on some of the vertices of a watertight mesh.

    It stays watertight and consistently oriented, no closed part turns inside out, and no faces cross that did not cross
    before. The same mesh and arguments give the same result for any number of threads.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        tolerance: Largest distance of points of either mesh to the other, in the mesh's units; 0 keeps the mesh.
            None = what ``triangles`` needs. One of the two must be given.
        triangles: Most triangles of the result, None = no limit. The tolerance is then the least that was found to
            reach it. A warning tells if the shape or ``tolerance`` does not allow so few.
        step: Distance between these points; None = ten times the tolerance, or a quarter of the mean edge of
            ``triangles``, at least the mesh's own mean edge. It is enlarged until all points are at most about a
            million, and 32 for each face.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        progress: A callable that receives a stage and its share, 0 to 1; True to show it.

    Raises:
        InputError: The mesh is not a closed manifold whose faces agree; see ``raymap.repair``.
        UsageError: Arguments that make no sense.
        MemoryLimitError: The work does not fit into memory.
        FileError: The file cannot be read.
        Cancelled: ``progress`` returned False.

    >>> mesh, report = raymap.simplify("ball.ply", tolerance=0.05)
    >>> report["triangles_before"], report["triangles_after"] < 640, report["deviation"] <= 0.05
    (1280, True, True)
    """
    if tolerance is None and triangles is None:
        raise UsageError("simplify needs a tolerance, a number of triangles, or both")
    _check_triangles(triangles, tolerance)
    options = core_options(tolerance=tolerance, triangles=triangles, step=step, threads=threads)
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    with reporting(progress) as report:
        result, found = _raymap.simplify(mesh, options, report)
    return Simplified(mesh_of_core(result), found)  # type: ignore[arg-type]


@_views.shown
class _MeshAndReport(NamedTuple):
    mesh: Mesh
    report: RepairReport


class Repaired(_MeshAndReport):
    """A repaired mesh, and what was done: ``mesh, report = raymap.repair(...)``."""

    face_source: npt.NDArray[np.uint32]
    """Given face that each face of the mesh is, or is a part of; ``raymap.NO_TRIANGLE`` for those that were added. Empty if
    all faces were made anew or simplified."""

    def __new__(cls, mesh: Mesh, report: RepairReport, face_source: npt.NDArray[np.uint32]) -> Repaired:
        self = super().__new__(cls, mesh, report)
        self.face_source = face_source
        return self

    def __getnewargs__(self) -> tuple[Any, ...]:
        return (*self, self.face_source)


def repair(
    mesh_or_vertices: Any,
    faces: Any = None,
    *,
    resolution: int | None = None,
    voxel_size: float | None = None,
    orientation: Orientation = "auto",
    close_holes: bool = True,
    offset: float = 0.0,
    shell: float = 0.0,
    drain_hole: float = 0.0,
    drain_holes: int = 1,
    min_thickness: float | None = None,
    down: tuple[float, float, float] = (0.0, 0.0, -1.0),
    drop_smaller: float | None = None,
    keep_cavities: bool = False,
    base: float | None = None,
    remesh: bool = False,
    tolerance: float | None = None,
    triangles: int | None = None,
    cut_plane: tuple[float, float, float, float] | None = None,
    device: str = "auto",
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Repaired:
    """Returns a watertight solid in place of any mesh, for example to print it.

    A mesh that has nothing wrong and needs no change is returned with its own faces. So is one with small holes, which
    get faces, and one with a few turned faces, which are turned back, or degenerate and repeated ones, which are removed. Holes that a plane closes get faces first. Else the result is the surface of the mesh's field, so details smaller than a sample are lost. The deviation is measured.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        resolution: Number of samples along the longest side. Without effect if ``voxel_size`` is given. If
            neither is: 256, but more where the thinnest part needs more, up to 67 million samples in all.
        voxel_size: Distance between samples, in the mesh's units; None = from the resolution or ``shape``.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, ``"keep"`` or ``"repair"``.
        close_holes: Whether to measure distances to the surface that closes holes, too; else holes close in steps.
        offset: Distance to move the surface outwards, in the mesh's units; negative: inwards.
        shell: Thickness of the walls of a hollow solid, in the mesh's units; 0 = not hollow.
        drain_hole: Diameter of the drain holes; 0 = none.
        drain_holes: Number of drain holes of each hollow: down from its lowest point, then as a vent up from its
            highest one, then down from level floors as far from the others as there are.
        min_thickness: Least thickness of walls, fins and sheets: what is thinner in the mesh becomes a plate this
            thick. At least two samples, or 0 = none: what samples miss is lost. None: 1.75 samples, the thinnest wall
            that the grid cannot miss. Material removed by a negative offset is not restored.
        down: Direction of the drain holes and of the walls to a base; any length but 0.
        drop_smaller: Volume in the mesh's units cubed. Parts of the result that enclose less are dropped. None: a
            thousandth of what the largest part encloses. A small part is kept if no other part covers that piece of the
            mesh.
        keep_cavities: Whether to keep sealed cavities; else they are filled, with all parts in them.
        base: Height against ``down`` of a flat base that walls join the rim of the mesh to, as for a terrain. The mesh
            must not reach below it. By default there is none.
        remesh: Whether to make all faces from the field even if some could be kept.
        tolerance: Largest deviation of the result from the isosurface, in the mesh's units, to have fewer faces; 0 =
            all faces. By default a tenth of the distance between samples, or what ``triangles`` needs. Faces that could
            be kept are simplified only if it is given.
        triangles: Most triangles of the result, None = no limit. The tolerance is then the least that was found to
            reach this number, and ``tolerance`` limits it. Faces that could be kept are simplified, too.
        cut_plane: Plane of a cut: what lies on the side of its normal is removed.
        device: Device that computes: ``"cpu"``; ``"vulkan:K"``, the Kth Vulkan device; ``"vulkan"``, the best of them,
            which may be a software rasterizer; ``"auto"``, a real GPU if one is usable, else the CPU.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        memory_limit: Most bytes that the call and its result may hold; None = what is available.
        progress: A callable that receives a stage and its share, 0 to 1; True to show it.

    Raises:
        InputError: The mesh is not valid, or encloses nothing.
        UsageError: Arguments that make no sense, for example walls thinner than two samples.
        MemoryLimitError: The field needs more memory than allowed.

    >>> mesh, report = raymap.repair("ball.ply", resolution=32)
    >>> report["after"]["watertight"], report["after"]["boundary_edges"]
    (True, 0)
    """
    given = {name: value for name, value in locals().items() if name not in ("mesh_or_vertices", "faces", "progress")}
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    _check_triangles(triangles, tolerance)
    options = core_options(given)
    with reporting(progress) as report:
        result, found, sources = _raymap.repair(mesh, options, report)
    return Repaired(mesh_of_core(result), found, sources)


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
        distance: DistanceModes, (nx, ny, nz), i along x: NumPy, or any array with ``__dlpack__``.
        iso: Distance of the surface; above 0 outside of the shape.
        origin: Position of sample (0, 0, 0).
        spacing: Distance between samples.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        progress: A callable that receives a stage and its share, 0 to 1; True to show it.

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
