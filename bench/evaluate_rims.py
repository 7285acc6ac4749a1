"""Compares the signs of grids of open meshes with the exact winding number, which a `Surface` gives at points.

    evaluate_rims.py FOLDER OUT [--resolution N] [--rims N]

FOLDER holds meshes and MESHES.tsv. OUT gets the table rims.md: of each mesh whose faces do not close, the samples with a
winding number within 0.45 of the threshold, and how many of them have the wrong sign. Needs the package raymap. A number
within 1e-5 of the threshold counts as either side.
"""

import argparse
import pathlib

import numpy as np
import raymap
from mesh_table import mesh_rows, tabulate

THRESHOLD, NEAR, TIE = 0.5, 0.45, 1e-5
AT_A_TIME = 500_000  # Points; bounds the memory.


def rim_count(mesh):
    """Returns how often the faces pass edges in one direction more than in the other."""
    edges = np.concatenate([mesh.faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])]).astype(np.int64)
    points = np.unique(mesh.vertices, axis=0, return_inverse=True)[1].reshape(-1)[edges]
    way = np.where(points[:, 0] < points[:, 1], 1, -1)
    unique, index = np.unique(np.sort(points, axis=1), axis=0, return_inverse=True)
    sums = np.bincount(index.reshape(-1), way, len(unique))
    return int(np.abs(sums[unique[:, 0] != unique[:, 1]]).sum())


def measure(path, resolution, most_rims):
    mesh = raymap.load_mesh(path)
    rims = rim_count(mesh)
    if rims > most_rims:
        raise ValueError(f"{rims} rims")
    field = raymap.generate(mesh, resolution=resolution, orientation="keep", arrays=("winding",), device="cpu")
    surface = raymap.Surface(mesh, orientation="keep")
    near = np.argwhere(np.abs(field.winding - THRESHOLD) < NEAR)
    wrong, errors = 0, [np.zeros(1)]
    for begin in range(0, len(near), AT_A_TIME):
        samples = near[begin:begin + AT_A_TIME]
        exact = surface.query(field.origin + samples * field.spacing, ("winding",)).winding
        at = tuple(samples.T)
        differs = (exact > THRESHOLD) != (field.distance[at] < 0)
        wrong += int((differs & (np.abs(exact - THRESHOLD) > TIE)).sum())
        errors.append(np.abs(exact - field.winding[at]))
    errors = np.concatenate(errors)
    return [rims, len(near), wrong, f"{errors.sum() / max(len(near), 1):.5f}", f"{errors.max():.3f}"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--resolution", type=int, default=256)
    parser.add_argument("--rims", type=int, default=2000, help="meshes with more are left out")
    args = parser.parse_args()
    rows = [row for row in mesh_rows(args.folder) if row["balanced"] == "no" and row["parse"] == "ok"]
    titles = ["mesh", "triangles", "rims", "samples near the threshold", "wrong signs", "mean error of w", "largest"]
    cells = lambda row, _: [row["file"], row["triangles"], *measure(args.folder / row["file"], args.resolution, args.rims)]
    args.out.mkdir(parents=True, exist_ok=True)
    tabulate(args.out / "rims.md", titles, rows, cells)


if __name__ == "__main__":
    main()
