"""Compares narrow bands with the truth, and with OpenVDB's, on all meshes of a folder.

    evaluate_bands.py PEERS FOLDER OUT [--resolution N] [--points N] [--all] [--only TEXT ...] [--openvdb-resolution N]

PEERS is the benchmark program of that name. FOLDER holds meshes and MESHES.tsv. OUT gets the table bands.md. Each mesh
gets a band of 3 samples on both sides, of the faces as given. Of it N active samples are compared, or all of them with
--all, and N samples beyond it, which must be farther away than the band. The truth is in double precision: libigl's
distance by its tree of boxes, and its exact generalized winding number, of at most N samples. OpenVDB makes its band on
the same lattice, with its own resolution: its file of all samples must fit into memory.

The Python package and `peers` are those of a release build with RAYMAP_PYTHON and RAYMAP_BUILD_BENCH:

    PYTHONPATH=build/release/python python3 bench/evaluate_bands.py build/release/bin/peers FOLDER OUT
"""

import argparse
import pathlib
import subprocess

import igl
import numpy as np
from mesh_table import mesh_rows, tabulate

import raymap

BAND = 3
THRESHOLD = 0.5
TIE = 1e-5  # Numbers closer to the threshold than this count as either side,
ON_SURFACE = 1e-5  # and so do samples closer to the surface than this, in samples.


def active_samples(band, leaves):
    """Returns the numbers of the active samples of some leaves, (n, 3), and their distances."""
    values = band.values[leaves]
    leaf, *at = np.nonzero((values < np.float32(band.outside)) & (values > np.float32(-band.inside)))
    return band.origins[leaves[leaf]] + np.stack(at, axis=1), values[(leaf, *at)]


def some_active(band, count, random):
    """Returns some active samples, from leaves anywhere."""
    samples, values = active_samples(band, random.permutation(len(band.origins))[:count])
    some = random.permutation(len(samples))[:count]
    return samples[some], values[some]


def samples_beyond(band, count, random):
    """Returns samples of the lattice beyond the band: half of them from tiles, which lie inside, if there are any."""
    shape = np.array(band.shape)
    anywhere = random.integers(0, shape, (4 * count, 3))
    if len(band.tile_origins):
        sides = band.tile_sides.astype(float)
        tiles = random.choice(len(sides), 2 * count, p=sides**3 / (sides**3).sum())
        inside = band.tile_origins[tiles] + random.integers(0, band.tile_sides[tiles, None], (2 * count, 3))
        anywhere[: 2 * count] = np.minimum(inside, shape - 1)
    points = band.origin + band.spacing * anywhere
    beyond = np.abs(band.sample(points, outside="bound")) >= np.float32(band.outside)
    return random.permutation(anywhere[beyond])[:count]


def wrong_signs(winding, values, spacing):
    is_clear = (np.abs(winding - THRESHOLD) > TIE) & (np.abs(values) > ON_SURFACE * spacing)
    return int((is_clear & ((winding > THRESHOLD) != (values < 0))).sum())


def of_openvdb(args, mesh, band, folder):
    """Returns OpenVDB's values of all samples of the band's lattice, (x, y, z)."""
    raw = folder / "openvdb.raw"
    subprocess.run(
        [args.peers, "openvdb", "--mesh", mesh, "--resolution", str(max(band.shape)), "--band", str(BAND)]
        + ["--output", raw],
        check=True, capture_output=True, text=True)  # fmt: skip
    return np.fromfile(raw, np.float32).reshape(band.shape, order="F")


def measure(args, row, folder):
    """Returns the cells of a mesh."""
    path = args.folder / row["file"]
    random = np.random.default_rng(1)
    mesh = raymap.load_mesh(path)
    vertices, triangles = np.asarray(mesh.vertices, float), np.asarray(mesh.faces, np.int64)
    numbers = lambda points: np.abs(igl.winding_number(vertices, triangles, points))  # noqa: E731
    make = lambda n: raymap.generate(mesh, resolution=n, band=BAND, sparse=True, orientation="keep")  # noqa: E731
    band = make(args.resolution)
    position = lambda band, samples: band.origin + band.spacing * samples  # noqa: E731
    if args.all:
        active, values = active_samples(band, np.arange(len(band.origins)))
        few = random.permutation(len(active))[: args.points]
    else:
        active, values = some_active(band, args.points, random)
        few = np.arange(len(active))
    beyond = samples_beyond(band, args.points, random)
    distances = lambda points: np.sqrt(igl.point_mesh_squared_distance(points, vertices, triangles)[0])  # noqa: E731
    error = np.abs(np.abs(values) - distances(position(band, active))).max(initial=0) / band.spacing
    error = max(error, BAND - distances(position(band, beyond)).min(initial=np.inf) / band.spacing)
    wrong = wrong_signs(numbers(position(band, active[few])), values[few], band.spacing)
    wrong_beyond = wrong_signs(numbers(position(band, beyond)), band.sample(position(band, beyond)), band.spacing)
    cells = [row["file"], row["triangles"], row["balanced"], len(active), f"{error:.1e}"]
    cells += [f"{wrong} of {len(few)}", f"{wrong_beyond} of {len(beyond)}"]
    coarse = make(args.openvdb_resolution)
    active, beyond = some_active(coarse, args.points, random)[0], samples_beyond(coarse, args.points, random)
    peer = of_openvdb(args, path, coarse, folder)
    for samples in (active, beyond):
        cells.append(wrong_signs(numbers(position(coarse, samples)), peer[tuple(samples.T)], coarse.spacing))
    return cells


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("peers")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--resolution", type=int, default=512)
    parser.add_argument("--openvdb-resolution", type=int, default=256)
    parser.add_argument("--points", type=int, default=2000)
    parser.add_argument("--all", action="store_true", help="compare the distances of all active samples")
    parser.add_argument("--only", nargs="*", default=[""], help="files whose names contain one of these")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    rows = [row for row in mesh_rows(args.folder) if any(text in row["file"] for text in args.only)]
    titles = ("mesh", "triangles", "balanced", "active samples", "largest error, samples", "wrong signs, active", "beyond",
              "OpenVDB: active", "beyond")  # fmt: skip
    tabulate(args.out / "bands.md", titles, rows, lambda row, folder: measure(args, row, folder), (raymap.Error,))


if __name__ == "__main__":
    main()
