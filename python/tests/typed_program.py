"""A program for the type checker. Each ignored error must be one: mypy --strict refuses an ignore without need."""

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
import raymap

mesh: raymap.Mesh = raymap.load_mesh("ball.ply")
field: raymap.Field = raymap.generate(mesh, resolution=16, sign="rays", arrays=("winding",), device="cpu")
distance: npt.NDArray[np.float32] = field.distance
nx, ny, nz = field.shape
spacing: float = field.spacing
surface: raymap.Mesh = field.to_mesh(iso=0.1, progress=lambda stage, done: print(stage, done))
prepared = raymap.Surface(mesh, orientation="keep")
winding = prepared.query((0, 0, 0), ("winding", "distance"), max_distance=0.5).winding
distances: npt.NDArray[np.float64] = raymap.signed_distance(mesh, [(0, 0, 0)], sign=False)
singles = np.zeros((2, 3), np.float32)
single_distances: npt.NDArray[np.float32] = prepared.signed_distance(singles, threads=1)
double_distances: npt.NDArray[np.float64] = prepared.signed_distance(np.zeros((2, 3)))
is_inside: npt.NDArray[np.bool_] = prepared.contains([(0, 0, 0)])
single_closest: npt.NDArray[np.float32] = prepared.closest(singles).point
triangles: npt.NDArray[np.uint32] = prepared.closest([(0, 0, 0)]).triangle
numbers: npt.NDArray[np.float32] = prepared.query(np.zeros((2, 3)), "winding").winding
directions: npt.NDArray[np.float64] = prepared.query([(0, 0, 0)], ("direction",), max_distance=9.0).direction
between: npt.NDArray[np.float32] = field.sample([(0, 0, 0)], outside="nan") + field.gradient(singles)[:, 0]
with_winding: npt.NDArray[np.float32] = raymap.generate(mesh, resolution=16, arrays="winding").winding
block: dict[str, npt.NDArray[np.float32]] = raymap.Sampler(mesh, 100, arrays="distance")[0]
again_field: raymap.Field = prepared.generate(resolution=16, threads=1)
band: raymap.Field = raymap.generate(mesh, resolution=16, band=(2, 3), sparse=True)
band_picture: npt.NDArray[np.uint8] = band.render(width=32, height=24, cut=True, eye=(3, 1, 2), threads=1)
band_slice: npt.NDArray[np.uint8] = band.slice("z", 3, width=32)
values: npt.NDArray[np.float32] = prepared.generate(resolution=16, sparse=True).distance
generator = raymap.Generator()
again: raymap.Field = generator.generate(mesh.vertices, mesh.faces, voxel_size=0.2, threads=1)
picture: npt.NDArray[np.uint8] = field.slice("z", width=64)
found: raymap.Info = raymap.info(mesh)
holes: int = found["hole_count"] + found["self_intersections"]["pairs"]
uncounted: None = raymap.info(mesh, fast=True)["self_intersections"]
milliseconds: float = field.stats["milliseconds"]
solid, report = raymap.repair(mesh, resolution=16)
file_report: raymap.FileReport = raymap.generate_file(mesh, "typed.npy", resolution=16, winding="w.npy")
form: str = file_report["plan"]["form"]
deviation: float = report["result_from_mesh"]["p99"]
samples: raymap.Samples = raymap.sample_points(prepared, 100, sigma=0.01, seed=3)
pos: npt.NDArray[np.float32] = samples.pos
coarse, simplified = raymap.simplify(solid, tolerance=0.1)
faces_left: int = simplified["triangles_after"]
face_points: raymap.FacePoints = raymap.sample_faces(mesh, step=0.5)
thickness: raymap.Thickness = prepared.thickness(face_points.position, face_points.triangle, max_thickness=0.5)
median: float = prepared.thickness_summary()["median"]
worst: list[int] = field.compare(field)["worst_sample"]
defects: npt.NDArray[np.uint8] = raymap.render_defects(mesh, width=64, height=48)
try:
    raymap.load_field("nowhere.vdb")
except raymap.FileError as error:
    reason: str = str(error)

if TYPE_CHECKING:
    raymap.generate(mesh, distance="near")  # type: ignore[arg-type]
    raymap.generate(mesh, resolutoin=3)  # type: ignore[call-arg]
    generator.generate(mesh, threads="all")  # type: ignore[arg-type]
    raymap.signed_distance(mesh)  # type: ignore[call-overload]
    field.distance = distance  # type: ignore[misc]
    field.slice("w")  # type: ignore[arg-type]
    prepared.query((0, 0, 0), ("colour",))  # type: ignore[arg-type]
    wrong: npt.NDArray[np.float32] = prepared.signed_distance(np.zeros((2, 3)))  # type: ignore[assignment]
    prepared.signed_distance(singles, treads=1)  # type: ignore[call-overload]
    prepared.generate(orientation="keep")  # type: ignore[call-arg]
    found["colour"]  # type: ignore[typeddict-item]
    raymap.info(mesh, fast=True)["self_intersections"]["pairs"]  # type: ignore[index]
