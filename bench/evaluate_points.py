"""Compares the points that `raymap query` answers with libigl's exact numbers, on all meshes of a folder.

    evaluate_points.py RAYMAP FOLDER OUT [--points N] [--only TEXT]

RAYMAP is the program. FOLDER holds meshes and MESHES.tsv. OUT gets the table points.md. Each mesh gets N points in the
box padded by 10 %, and N within 0.1 % of the diagonal from the surface. The truth is in double precision: libigl's exact
generalized winding number of the faces as given, and the distance by its tree of boxes.
"""

import argparse
import pathlib
import subprocess

import igl
import numpy as np
from evaluate import read_mesh
from mesh_table import mesh_rows, tabulate

NEAR = 1e-3  # Share of the diagonal.
THRESHOLD = 0.5
# Points near thousands of rims that may be on the wrong side, as docs/points.md says: so close to the surface, in
# diagonals.
CLOSE_TO_SURFACE = 5e-8


def read_surface(args, path, folder):
    """Returns the copy that `read_mesh` leaves, the vertices that triangles use, and the triangles."""
    vertices, triangles = read_mesh(args, path, folder)
    used, triangles = np.unique(triangles, return_inverse=True)
    return folder / "as_read.ply", vertices[used], triangles.reshape(-1, 3)


def uniform_points(vertices, count, random):
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    margin = 0.1 * (high - low).max()
    return random.uniform(low - margin, high + margin, (count, 3))


def near_points(vertices, triangles, count, random):
    corners = vertices[triangles]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    faces = random.choice(len(triangles), count, p=areas / areas.sum())
    weights = random.dirichlet((1, 1, 1), count)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    diagonal = np.linalg.norm(np.ptp(vertices, axis=0))
    return np.einsum("pc,pcx->px", weights, corners[faces]) + NEAR * diagonal * random.random((count, 1)) * directions


def compare(raymap, mesh, vertices, triangles, points, folder):
    """Returns the number of wrong signs, how many of them are to be expected, and the largest error of a distance or of
    a closest point, in diagonals."""
    np.save(folder / "points.npy", points)
    arrays = ("distance", "closest", "triangle", "barycentric")
    subprocess.run(
        [raymap, "query", mesh, folder / "points.npy", "-o", folder / "answers.npz", "--overwrite"]
        + ["--arrays", ",".join(arrays), "--orientation", "keep"],
        check=True, capture_output=True, text=True)  # fmt: skip
    answers = np.load(folder / "answers.npz")
    diagonal = np.linalg.norm(np.ptp(vertices, axis=0))
    distance = np.sqrt(igl.point_mesh_squared_distance(points, vertices, triangles)[0])
    corners = vertices[triangles[answers["triangle"]]]
    closest = np.einsum("pc,pcx->px", answers["barycentric"], corners)
    errors = np.concatenate(
        [np.abs(np.abs(answers["distance"]) - distance), np.linalg.norm(closest - answers["closest"], axis=1)]
        + [np.abs(np.linalg.norm(answers["closest"] - points, axis=1) - distance)]
    )
    winding = np.abs(igl.winding_number(vertices, triangles, points))
    wrong = (winding > THRESHOLD) != (answers["distance"] < 0)
    excused = distance <= CLOSE_TO_SURFACE * diagonal
    return wrong.sum(), (wrong & excused).sum(), errors.max() / diagonal


def measure(args, row, folder):
    """Returns the cells of a mesh."""
    random = np.random.default_rng(1)
    mesh, vertices, triangles = read_surface(args, args.folder / row["file"], folder)
    kinds = uniform_points(vertices, args.points, random), near_points(vertices, triangles, args.points, random)
    uniform, near = (compare(args.raymap, mesh, vertices, triangles, kind, folder) for kind in kinds)
    expected, largest = uniform[1] + near[1], max(uniform[2], near[2])
    return row["file"], len(triangles), row["balanced"], uniform[0], near[0], expected, f"{largest:.1e}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raymap")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--only", default="", help="files whose name contains this")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    rows = [row for row in mesh_rows(args.folder) if args.only in row["file"]]
    titles = ("mesh", "triangles", "balanced", "wrong, uniform", "wrong, near", "to be expected", "largest error / diagonal")
    tabulate(args.out / "points.md", titles, rows, lambda row, folder: measure(args, row, folder))


if __name__ == "__main__":
    main()
