"""Types of the library's results, dicts with the keys of the command line's JSON, and names of the values of its enums.

scripts/records.py writes this file from include/raymap/records.h.
"""

from __future__ import annotations

from typing import Literal, TypedDict

import numpy as np
import numpy.typing as npt

Arrangement = Literal[
    "unknown",
    "separate",
    "nested",
    "misnested",
    "touching",
    "overlapping",
]

DeviceTestState = Literal[
    "untested",
    "running",
    "passed",
    "failed",
    "unfinished",
]

DeviceType = Literal[
    "discrete",
    "integrated",
    "virtual",
    "other",
    "software",
    "cpu",
]

DistanceMode = Literal[
    "exact",
    "neighbours",
    "cell",
    "raster",
]

FieldArray = Literal[
    "distance",
    "winding",
    "confidence",
    "triangle",
]

FieldForm = Literal[
    "whole",
    "narrow_band",
    "slabs",
]

FieldReason = Literal[
    "none",
    "asked",
    "open",
    "sheet",
    "crossing",
]

MeshKind = Literal[
    "no_surface",
    "double_sided",
    "soup",
    "sheet",
    "open_solid",
    "turned_faces",
    "overlapping_solids",
    "touching_solids",
    "misnested_solids",
    "crossing_solid",
    "flawed_solid",
    "inside_out",
    "several_solids",
    "clean_solid",
]

Orientation = Literal[
    "auto",
    "keep",
    "repair",
]

Part = Literal[
    "wall",
    "edge",
    "corner",
    "solid",
    "sheet",
    "buried",
]

Remedy = Literal[
    "none",
    "repair",
    "thicken",
]

RepairDepth = Literal[
    "as_given",
    "mended",
    "field",
]

Sampling = Literal[
    "spread",
    "paper",
]

SignMode = Literal[
    "harmonic",
    "exact",
    "paths",
    "evolution",
    "rays",
    "ray",
    "none",
]

WarningCode = Literal[
    "file_content",
    "rounding",
    "device_refused",
    "device_failed",
    "orientation_misfit",
    "parts_inside_out",
    "box_reached",
    "solid_lost",
    "surface_lost",
    "parts_dropped",
    "parts_kept",
    "parts_buried",
    "cavities_filled",
    "hollows_filled",
    "no_hollow",
    "drain_holes_missing",
    "triangles_missed",
    "nothing_inside",
    "sheet",
    "bounds_left",
    "parts_thickened",
    "loose_bodies",
    "far_vertices",
    "attributes_lost",
    "part_file",
]


class Hole(TypedDict):
    """A boundary loop: a closed chain of edges with one face. Lengths are in the mesh's units."""

    edges: int
    """Number of edges."""
    length: float
    """Length of the loop."""
    area: float
    """Least area of a surface that closes it: that of its vector area."""
    centre: list[float]
    """Mean of the edges' ends."""
    diameter: float
    """Twice the distance from the centre to the farthest vertex."""


class Diagnostics(TypedDict):
    """Size, topology and defects of a mesh, measured after welding vertices at exactly equal positions."""

    vertices: int
    """Number of vertices as stored."""
    welded_vertices: int
    """Number of distinct positions, used by a face or not."""
    triangles: int
    """Number of triangles."""
    watertight: bool
    """Whether every edge has exactly two faces."""
    consistently_oriented: bool
    """Whether neighbours agree across every edge with two faces."""
    balanced: bool
    """Whether every edge is used equally often both ways: winding numbers are whole."""
    components: int
    """Number of parts connected through shared vertices."""
    open_components: int
    """Number of components with boundary edges. A double-sided mesh counts one side only, as in the next three."""
    inward_components: int
    """Number of closed components with a negative volume: cavities, or inside out."""
    sheets: int
    """Number of open components whose holes make up 30 % of their area or more, once closed."""
    sheet_share: float
    """Share of the area that is in sheets."""
    boundary_edges: int
    """Number of edges with one face."""
    hole_count: int
    """Number of boundary loops."""
    holes: list[Hole]
    """Boundary loops, the longest first."""
    non_manifold_edges: int
    """Number of edges with more than two faces."""
    flipped_edges: int
    """Number of edges that two faces use in the same direction."""
    flipped_faces: int
    """Least number of faces to reverse so that neighbours agree; not which side is out."""
    degenerate_faces: int
    """Number of faces with a repeated corner, or lower than 1e-6 of their longest edge."""
    far_vertices: int
    """Number of vertices of faces that lie 10^9 sizes of the others away, or more."""
    duplicate_faces: int
    """Number of further faces on the same three corners, either orientation."""
    double_sided_faces: int
    """Number of faces in groups on the same three corners, as many in one winding order as in the other."""
    signed_volume: float
    """Signed volume, in the mesh's units cubed; positive if faces point outwards."""
    area: float
    """Area of all triangles, in the mesh's units squared."""
    bounds: list[list[float]]
    """Bounds of the vertices that faces use."""


class SelfIntersections(TypedDict):
    """Faces that cross others, so that inner points of the two coincide, and faces that overlap others in one plane.
    Faces that only touch or share an edge do neither. The test is exact for corners rounded to a lattice of at least
    2^29 steps along the longest side."""

    pairs: int
    """Number of crossing pairs."""
    faces: int
    """Number of faces in them."""
    complete: bool
    """False if the search stopped early: there are at least so many pairs."""
    coplanar_pairs: int
    """Number of pairs that overlap in one plane. Faces on the same three corners are duplicates instead."""
    coplanar_faces: int
    """Number of faces in these pairs."""


class Inspection(Diagnostics):
    """Diagnostics of a mesh with the faces that cross."""

    self_intersections: SelfIntersections
    """Faces that cross others."""


class Verdict(TypedDict):
    """Kind of thing that a mesh is, and what makes a clean solid of it."""

    kind: MeshKind
    """Kind of the mesh."""
    remedy: Remedy
    """Command that makes a clean solid of it."""
    arrangement: Arrangement
    """How its closed parts lie to each other."""
    sought: float
    """Thickness up to which thin parts were looked for; 0 = it was not measured."""
    thinnest: float | None
    """Thickness of the thinnest part, in the mesh's units. Nothing if no part is thinner than ``sought``."""
    voxel_size: float | None
    """Largest distance between samples that keeps that part: half of it, rounded down to two digits."""
    thickness: float
    """Thickness that suits a sheet: a fiftieth of its longest side, in one digit. 0 = it is none."""


class Stage(TypedDict):
    """A stage of the work."""

    name: str
    """Name of the stage."""
    milliseconds: float
    """Time that it took; on a GPU, by its own clock."""


class Stats(TypedDict):
    """Costs of a run, and its findings about the mesh."""

    device: str
    """Device that computed: "cpu" or "vulkan:K"; empty if none did."""
    stages: list[Stage]
    """Stages in the order in which they ran."""
    milliseconds: float
    """Time from triangles in memory to the finished field."""
    bytes: int
    """Most bytes that the generator and the field held together."""
    doubtful_share: float
    """Share of samples whose six rays disagree; 0 on a consistent mesh."""
    turned_faces: npt.NDArray[np.uint32]
    """Indices of the faces that were reversed, ascending."""
    left_out_faces: npt.NDArray[np.uint32]
    """Indices of the faces that the sign left out, ascending. Each has the corners of another one. It repeats that one
    in the same winding order, or is the other side of a double-sided face that bounds a solid."""
    inverted_parts: npt.NDArray[np.uint32]
    """Lowest face of each part that was reversed because it is inside out and crosses others, ascending."""
    misfit_given: float
    """Misfit of the given mesh, 0 to 1: how badly the crossings of rays contradict each other. 0 if one field explains
    them all, or if it was not examined."""
    misfit: float
    """The same with ``turned_faces`` reversed and without ``left_out_faces``."""
    orientation_fits: bool
    """False if the faces were examined, but no choice has a misfit of at most 0.5."""
    patch_triangles: int
    """Number of triangles of the surface that closes holes."""
    patch_area: float
    """Its area, in the mesh's units squared."""


class FieldPlan(TypedDict):
    """How a field is made: in one piece or in many."""

    form: FieldForm
    """Pieces in which it is made."""
    planes: int
    """Number of planes along z that are made at a time."""
    bytes: int
    """Most bytes that its samples take at a time, in slabs with the work on them; 0 for a narrow band, whose bytes grow
    with the surface."""


class FileReport(TypedDict):
    """Report of ``generateFile``."""

    plan: FieldPlan
    """How the field was made."""
    stats: Stats
    """Costs, and findings about the mesh."""


class Deviation(TypedDict):
    """How far points of one surface lie from where they should, in the mesh's units."""

    max: float
    """Largest distance."""
    mean: float
    """Mean distance over the area of the surface."""
    p99: float
    """Distance that 99 % of the area do not exceed."""
    points: int
    """Number of points measured."""


class DrainHolePlace(TypedDict):
    """Place of a drain hole."""

    position: list[float]
    """Point where its axis leaves the solid, in the mesh's units."""
    direction: list[float]
    """Its direction there, of length 1."""


class Removed(TypedDict):
    """Parts or cavities that the result lacks. Volumes are what their surfaces enclose, in the mesh's units cubed."""

    count: int
    """Number of them."""
    volume: float
    """Sum of the volumes."""
    largest: float
    """Volume of the largest one."""


class Loss(TypedDict):
    """Parts of the mesh that a repair loses: those of its solid that are too thin for the samples, and surface that
    bounds no solid."""

    solid_share: float
    """Share of the mesh's area that is lost and bounds such a part."""
    bounds: list[list[float]]
    """Bounds of this area, moved by the offset. Empty if there are none."""
    thinnest: float
    """Thickness at its thinnest point, with the offset."""
    median_thickness: float
    """Median thickness over this area; 0 if it is not known."""
    voxel_size: float
    """Largest distance between samples that was found to keep the parts, in the mesh's units. If none does, the one
    that keeps most of them; 0 = none keeps any."""
    kept: bool
    """Whether ``voxel_size`` keeps the parts: all but 0.5 % of the area."""
    kept_share: float
    """Share of the lost area that ``voxel_size`` keeps."""
    kept_thickness: float
    """Median thickness of the parts that it does not keep."""
    dropped_share: float
    """Share of the mesh's area that is lost with parts below ``drop_smaller``."""
    dropped_bounds: list[list[float]]
    """Bounds of this area. Empty if there is none."""
    open_share: float
    """Share of the mesh's area that is lost and bounds nothing: sheets, open surface."""
    open_bounds: list[list[float]]
    """Bounds of this area. Empty if there is none."""


class SimplifyReport(TypedDict):
    """How a mesh was simplified; by a repair the isosurface, or the faces that were kept."""

    tolerance: float
    """Tolerance in force, in the mesh's units; 0 = not simplified."""
    triangles_before: int
    """Number of triangles before."""
    triangles_after: int
    """Number of triangles of the result."""
    deviation: float
    """Largest distance measured, from points of either mesh to the other."""


class WarningFields(TypedDict):
    """Values that a warning names. Its code says which it has; the others are empty or 0."""

    file: str
    """Path of the file that was read or written."""
    device: str
    """Device that was not used, such as "vulkan:0"."""
    count: int
    """Number of parts, cavities, hollows or holes."""
    share: float
    """Share of the whole, 0 to 1, or a misfit (``misfit``)."""
    length: float
    """Length in the mesh's units."""
    volume: float
    """Volume in the mesh's units cubed."""
    voxel_size: float
    """Distance between samples that helps, in the mesh's units."""


class Warning(WarningFields):
    """Something odd that does not stop a call."""

    code: WarningCode
    """Kind of the warning."""
    message: str
    """One sentence: what is odd, where, and what helps."""


class RepairReport(TypedDict):
    """Changes that a repair made, and how far the result is from the mesh."""

    before: Inspection
    """Diagnostics of the given mesh."""
    after: Inspection
    """Diagnostics of the result."""
    arrangement_before: Arrangement
    """How the closed parts of the given mesh lie to each other."""
    arrangement_after: Arrangement
    """The same of the result."""
    result_from_mesh: Deviation
    """From points of the result to the given surface, moved by the offset, or to the hollow's surface. Drain holes are
    left out."""
    mesh_from_result: Deviation
    """From points of the given mesh, moved by the offset, to the result. Includes lost points; excludes buried ones."""
    kept_from_result: Deviation
    """The same without the lost points."""
    buried_share: float
    """Share of the mesh's area more than a sample inside the result; where parts were united, all inside it. A
    tolerance above the default allows as much more, here and in ``lost_share``."""
    lost_share: float
    """Share of it more than a sample outside: thinner than the samples, or open."""
    trimmed_share: float
    """Share of the mesh's area that the offset removes, where other parts are closer. All other shares are relative to
    what remains."""
    loss: Loss
    """Parts of the lost share, and what would keep them."""
    hollows: int
    """Number of hollows that the shell left."""
    filled_hollows: int
    """Number of hollows that a drain hole does not fit into; they are solid."""
    drain_holes: int
    """Number of drain holes."""
    drain_hole_places: list[DrainHolePlace]
    """Places of the drain holes, hollow by hollow."""
    solids: int
    """Number of parts of the result; those in cavities, too."""
    cavities: int
    """Number of sealed cavities of the result: those of the shell, too."""
    drop_smaller: float
    """Volume below which parts were dropped."""
    dropped: Removed
    """Parts that were too small."""
    filled: Removed
    """Sealed cavities that were filled."""
    buried: Removed
    """Parts in cavities that were filled."""
    parts_overlap: bool
    """Whether parts overlap, touch or nest wrongly, and all else is right."""
    depth: RepairDepth
    """How much was changed. Faces that stay may also be simplified. ``stats.turnedFaces`` has those that were
    reversed."""
    field_reason: FieldReason
    """Why the faces are those of a field."""
    cleaned_faces: int
    """Number of degenerate and repeated faces that were removed, or replaced together with a neighbour, so that the
    other faces could be kept."""
    united_faces: int
    """Number of faces that were cut where they cross, overlap or touch others, so that the faces that bound the union
    could be kept. 0 also if no face was, but parts in others went."""
    sewn_vertices: int
    """Number of vertices that were joined to others across cracks."""
    moved_vertices: int
    """Number of vertices that were moved, by at most 1.3e-4 of the mesh's size, so that no faces cross once they are
    rounded."""
    kept_faces: int
    """Number of faces of parts that keep them, mended where that was needed, while the rest of the mesh became a field.
    The deviations are those of the rest."""
    closed_holes: int
    """Number of holes that faces were added to close, before anything else."""
    closing_faces: int
    """Number of these faces, with the walls to a base."""
    least_thickness: float
    """Thickness of the plates in place of thinner parts; 0 = none made."""
    thickened_share: float
    """Share of the mesh's area that was thinner, and is on plates."""
    simplified: SimplifyReport
    """All 0 if faces were kept as they were."""
    warnings: list[Warning]
    """Warnings, in the order in which they were found."""
    stats: Stats
    """Cost of the field, then of the stages after it."""


class DeviceInfo(TypedDict):
    """A device that can compute fields."""

    id: str
    """Value for ``device``: "cpu", "vulkan:0", "vulkan:1", …"""
    name: str
    """Name of the processor or GPU."""
    type: DeviceType
    """Kind of the device."""
    chosen_by_auto: bool
    """Whether the device "auto" is this one. It tests a GPU first."""
    driver: str
    """Name and version of the driver; empty for the CPU."""
    threads: int
    """Number of hardware threads of the CPU; 0 for others."""
    memory: int
    """Bytes of its largest heap; for the CPU, bytes available now."""
    shared_memory: int
    """Bytes of shared memory per work group; 0 for the CPU."""
    problem: str
    """Reason why it cannot be used; empty if it can."""
    vulkan_version: str
    """Version of Vulkan, such as "1.3.230"; empty for the CPU."""
    subgroup_size: int
    """Usual number of invocations per subgroup; 0 for the CPU."""
    min_subgroup_size: int
    """Fewest that a kernel may have."""
    max_subgroup_size: int
    """Most that a kernel may have."""
    fingerprint: str
    """Differs for every device and version of a driver; empty for the CPU."""
    test: DeviceTestState
    """Outcome of the last test of a GPU."""
    test_problem: str
    """First difference, or the check in which the test ended; empty if passed."""


class DeviceCheck(TypedDict):
    """One check of a GPU: a stage, or whole fields."""

    name: str
    """Name of the check."""
    difference: str
    """First difference from the right result; empty if there is none."""
    milliseconds: float
    """Time of the check."""


class DeviceTest(TypedDict):
    """Result of a test of a GPU."""

    device: DeviceInfo
    """The GPU that was tested."""
    checks: list[DeviceCheck]
    """Those that ended, in their order."""
    problem: str
    """The first check that failed, and its difference; empty if none."""
    milliseconds: float
    """Time of the whole test."""
    hangs: bool
    """Whether a check did not end. Its thread still runs and holds the device."""


class Comparison(TypedDict):
    """Differences of an array of two fields on the same grid. Errors of distances are in samples (distance over
    spacing), of winding numbers and confidences as they are, of triangles 0."""

    samples: int
    """Number of all samples."""
    sign_differences: int
    """Number of samples with a distance that is negative in one field only."""
    max_error: float
    """Largest error."""
    worst_sample: list[int]
    """The first sample with the largest error."""
    mean_error: float
    """Mean error."""
    rms_error: float
    """Root mean square of the errors."""
    differences: int
    """Number of samples whose values differ."""
    non_finite: int
    """Number of samples that are NaN or infinite in either; the errors leave them out."""


class ThicknessSummary(TypedDict):
    """Thickness of a whole mesh. Lengths are in the mesh's units and NaN where there is nothing to measure."""

    thinnest: float
    """Thickness of the thinnest wall."""
    thinnest_at: list[float]
    """Point of its surface."""
    sharpest: float
    """Least thickness measured beside an edge or a tip that walls run out to."""
    sharpest_at: list[float]
    """Where."""
    low: float
    """First percentile of the thickness over the area of walls and edges."""
    median: float
    """Median thickness over that area."""
    sheet_share: float
    """Share of the mesh's area that is sheets."""
    buried_share: float
    """Share of it that is buried."""
    points: int
    """Number of points measured."""
