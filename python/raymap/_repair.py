"""Defects of meshes, and watertight solids in their place."""

from __future__ import annotations

from typing import Any, Literal, NamedTuple, overload

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap, _views
from ._arguments import FINITE, to_length, to_number, to_text, to_vector, to_whole
from ._devices import to_machine
from ._errors import UsageError
from ._field import Field
from ._mesh import Mesh, core_of, mesh_of_core
from ._pictures import to_view
from ._progress import Progress, reporting
from ._records import Diagnostics, Inspection, Orientation, RepairReport, SimplifyReport, Verdict


class Info(Inspection):
    """Diagnostics of a mesh, and a verdict."""

    verdict: Verdict


class FastInfo(Diagnostics):
    """Result of ``raymap.info`` with ``fast=True``."""

    self_intersections: None
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
    return _raymap.render_defects(mesh, to_view(width, height, direction, up, field_of_view))


def _to_most_triangles(triangles: int | None, tolerance: float | None) -> int:
    if triangles is None:
        return 0
    if tolerance == 0:
        raise UsageError("a tolerance of 0 keeps all triangles, so their number cannot be limited; leave one of both out")
    return to_whole("triangles", triangles, least=1)


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
        triangles: Most triangles of the result, with the least tolerance that was found to reach it. A warning
            tells if the shape or ``tolerance`` does not allow so few.
        step: Distance between these points, in the mesh's units; None = ten times the tolerance, or with ``triangles``
            a quarter of the mean edge of so many, at least the mesh's own mean edge. It is enlarged until all points are
            at most about a million, and 32 for each face.
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
    within = 0.0 if tolerance is None else to_number("tolerance", tolerance, least=0.0, most=FINITE)
    most = _to_most_triangles(triangles, tolerance)
    apart = 0.0 if step is None else to_length("step", step)
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    with reporting(progress) as report:
        result, found = _raymap.simplify(mesh, within, apart, most, to_machine("cpu", threads), report)
    return Simplified(mesh_of_core(result), found)  # type: ignore[arg-type]


@_views.shown
class Repaired(NamedTuple):
    """A repaired mesh, and what was done."""

    mesh: Mesh
    report: RepairReport


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
    device: str = "auto",
    threads: int | None = None,
    memory_limit: int | None = None,
    progress: Progress = None,
) -> Repaired:
    """Returns a watertight solid in place of any mesh, for example to print it.

    A mesh that has nothing wrong and needs no change is returned with its own faces. So is one with small holes, which
    get faces, and one with a few turned faces, which are turned back. Holes that a plane closes get faces first. Else the result is the surface of the mesh's field, so details smaller than a sample are lost. The deviation is measured.

    Args:
        mesh_or_vertices: A mesh, the path of a file, or positions, (n, 3), as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        resolution: Number of samples along the longest side. Without effect if ``voxel_size`` is given. If
            neither is: 256, but more where the thinnest part needs more, up to 67 million samples in all.
        voxel_size: Distance between samples, in the mesh's units.
        orientation: Whether faces that point the wrong way are reversed: ``"auto"``, ``"keep"`` or ``"repair"``.
        close_holes: Whether distances count the surface that closes holes. Without it, holes are closed in steps.
        offset: Distance to move the surface outwards, in the mesh's units; negative: inwards.
        shell: Thickness of the walls of a hollow solid, in the mesh's units; 0 = not hollow.
        drain_hole: Diameter of the drain holes; 0 = none.
        drain_holes: Number of drain holes of each hollow: down from its lowest point, then as a vent up from its
            highest one, then down from level floors as far from the others as there are.
        min_thickness: Thickness of the plates that take the place of thinner walls, fins and sheets, in the mesh's
            units; at least two samples. None: 1.75 samples, the thinnest wall that the grid cannot miss. 0: no plates, and
            what the samples miss is lost.
        down: Direction of the drain holes.
        drop_smaller: Volume in the mesh's units cubed. Parts of the result that enclose less are dropped. None: a
            thousandth of what the largest part encloses, but none that shows surface that no other part shows.
        keep_cavities: Whether sealed cavities stay; else they are filled, with all parts in them.
        base: Height against ``down`` of a flat base that walls join the rim of the mesh to, as for a terrain. The mesh
            must not reach below it. None: no base.
        remesh: Whether to make all faces from the field, even if those of the mesh could be kept.
        tolerance: Largest deviation of the result from the isosurface, in the mesh's units, to have fewer
            triangles; None = a tenth of the distance between samples, or what ``triangles`` needs; 0 = all triangles.
            Faces that could be kept are simplified only if it is given.
        triangles: Most triangles of the result, with the least tolerance that was found to reach it. Faces that could be
            kept are simplified, too.
        device: Device that computes; see ``raymap.devices``.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        memory_limit: Most bytes that the field may take; None = what is available.
        progress: A callable that receives a stage and its share, 0 to 1; True to show it.

    Raises:
        InputError: The mesh is not valid, or encloses nothing.
        UsageError: Arguments that make no sense, for example walls thinner than two samples.
        MemoryLimitError: The field needs more memory than allowed.

    >>> mesh, report = raymap.repair("ball.ply", resolution=32)
    >>> report["after"]["watertight"], report["after"]["boundary_edges"]
    (True, 0)
    """
    mesh = core_of(_inputs.to_mesh(mesh_or_vertices, faces))
    size = None if resolution is None else to_whole("resolution", resolution, least=1), 0.0 if voxel_size is None else to_length("voxel_size", voxel_size)
    options = _raymap.FieldOptions()
    options.orientation = to_text("orientation", orientation)
    machine = to_machine(device, threads, memory_limit)
    how = _raymap.RepairOptions()
    how.close_holes = bool(close_holes)
    how.offset = to_number("offset", offset, least=-FINITE, most=FINITE)
    how.shell = to_number("shell", shell, least=0.0, most=FINITE)
    how.drain_hole = to_number("drain_hole", drain_hole, least=0.0, most=FINITE)
    how.drain_holes, how.down = to_whole("drain_holes", drain_holes), to_vector("down", down)
    how.drop_smaller = None if drop_smaller is None else to_number("drop_smaller", drop_smaller, least=0.0)
    how.base = None if base is None else to_number("base", base, least=-FINITE, most=FINITE)
    how.keep_cavities, how.remesh = bool(keep_cavities), bool(remesh)
    if min_thickness is not None:
        how.min_thickness = to_number("min_thickness", min_thickness, least=0.0, most=FINITE)
    if tolerance is not None:
        how.tolerance = to_number("tolerance", tolerance, least=0.0, most=FINITE)
    how.triangles = _to_most_triangles(triangles, tolerance)
    with reporting(progress) as report:
        result, found = _raymap.repair(mesh, *size, options, how, machine, report)
    return Repaired(mesh_of_core(result), found)  # type: ignore[arg-type]


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
