"""Compares Raymap with other Python packages on what learners ask of each mesh: signed distances of points, and a grid.

workload.py FOLDER OUT [--points 250000] [--samples 64] [--only TEXT] [--methods raymap,pysdf] [--limit 120] [--threads 2]
            [--every 1]

FOLDER holds meshes and MESHES.tsv; `--every 3` takes each third. Half of the points are uniform in the box, half lie near the
surface. Every package gets the triangles as Raymap reads them, scaled as mesh2sdf wants them: the longest side of the bounds
reaches from -0.8 to 0.8, and sample i of the grid lies at -1 + 2 i / samples. Each run is a process of its own, which is stopped
after `--limit` seconds. CPU time counts from arrays in memory to arrays in memory.

The truth is libigl's exact winding number of the faces as given, in double precision, at 1,000 of the points and of the samples
each. Its magnitude is above 0.5 inside. Prints tables in markdown, and OUT gets workload.json with a record of each run.
Needs raymap, libigl and the peers: mesh-to-sdf, mesh2sdf, open3d, point-cloud-utils, pysdf, trimesh.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy as np
from evaluate_points import uniform_points
from mesh_table import mesh_rows

import peers

NEAR = 0.01  # Standard deviation of the points near the surface; the box is 2 wide.
CHECKED = 1000  # Points, and samples of the grid, that are compared with the truth.
OFF = 0.01  # A distance is off if it errs by this much.


def lattice(samples):
    """Returns the positions of the grid's samples, z fastest."""
    axis = -1 + 2 * np.arange(samples) / samples
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)


def by_raymap_grid(vertices, faces, points, samples, threads):
    import raymap

    field = raymap.generate(vertices, faces, shape=(samples,) * 3, origin=(-1, -1, -1), voxel_size=2 / samples,
                            device="cpu", threads=threads)  # fmt: skip
    return None, field.distance


def by_raymap(vertices, faces, points, samples, threads):
    import raymap

    surface = raymap.Surface(vertices, faces, threads=threads)
    return surface.signed_distance(points, threads=threads), by_raymap_grid(vertices, faces, points, samples, threads)[1]


def both(answer):
    """Returns a method that asks `answer(vertices, faces, positions)` for points and samples in one call."""

    def method(vertices, faces, points, samples, threads):
        values = np.asarray(answer(vertices, faces, np.concatenate([points, lattice(samples)])))
        return values[: len(points)], values[len(points) :]

    return method


def ask_open3d(vertices, faces, positions):
    import open3d

    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(vertices.astype(np.float32), faces.astype(np.uint32))
    return scene.compute_signed_distance(positions.astype(np.float32)).numpy()


def ask_libigl(vertices, faces, positions):
    import igl

    kind = igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    return igl.signed_distance(positions, vertices, faces, kind)[0]


def ask_point_cloud_utils(vertices, faces, positions):
    import point_cloud_utils

    return point_cloud_utils.signed_distance_to_mesh(positions, vertices, faces)[0]


def ask_pysdf(vertices, faces, positions):
    import pysdf

    return -pysdf.SDF(vertices, faces)(positions)


def ask_trimesh(vertices, faces, positions):
    import trimesh

    return -trimesh.proximity.signed_distance(trimesh.Trimesh(vertices, faces), positions)


def ask_mesh_to_sdf(vertices, faces, positions):
    """Without a graphics card its scans do not run, so its points on the surface are sampled from the faces."""
    import mesh_to_sdf
    import trimesh

    mesh = trimesh.Trimesh(vertices, faces)
    return mesh_to_sdf.mesh_to_sdf(mesh, positions, surface_point_method="sample", sign_method="normal")


def by_mesh2sdf(vertices, faces, points, samples, threads):
    """It makes the grid alone."""
    import mesh2sdf

    return None, mesh2sdf.compute(vertices, faces, size=samples)


METHODS = {
    "raymap": by_raymap,
    "raymap_grid": by_raymap_grid,
    "open3d": both(ask_open3d),
    "pysdf": both(ask_pysdf),
    "point_cloud_utils": both(ask_point_cloud_utils),
    "libigl": both(ask_libigl),
    "mesh2sdf": by_mesh2sdf,
    "mesh_to_sdf": both(ask_mesh_to_sdf),
    "trimesh": both(ask_trimesh),
}


def run_here(name, case, threads):
    """Answers the case in this process, which ends then."""
    given = np.load(case)
    arguments = given["vertices"], given["faces"], given["points"], int(given["samples"]), threads
    tetrahedron = np.float64([(0, 0, 0), (0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.5)]), np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
    METHODS[name](*tetrahedron, given["points"][:9], 8, threads)  # Imports what it needs, and starts its threads.
    (points, grid), cost = peers.measured(lambda: METHODS[name](*arguments))
    parts = {"grid": np.ravel(grid)} | ({} if points is None else {"points": np.ravel(points)})
    np.savez(case.with_suffix(f".{name}.npz"), **parts)
    print(json.dumps(cost))


def make_case(file, path, given):
    """Writes what all methods get. Returns the positions and the indices that are compared with the truth."""
    import raymap

    mesh = raymap.load_mesh(file)
    used, faces = np.unique(mesh.faces, return_inverse=True)
    vertices, faces = mesh.vertices[used].astype(np.float64), faces.reshape(-1, 3).astype(np.int64)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    vertices = (vertices - (low + high) / 2) * (1.6 / (high - low).max())
    random = np.random.default_rng(1)
    near = raymap.sample_points(raymap.Mesh(vertices, faces), given.points // 2, near=0, surface=1).points
    near = near + random.normal(scale=NEAR, size=near.shape)
    points = np.concatenate([uniform_points(vertices, given.points - len(near), random), near])
    np.savez(path, vertices=vertices, faces=faces, points=points, samples=given.samples)
    checked = {"points": random.choice(len(points), CHECKED), "grid": random.choice(given.samples**3, CHECKED)}
    return vertices, faces, {"points": points, "grid": lattice(given.samples)}, checked


def truth(vertices, faces, positions, checked):
    """Returns for each kind of positions which are inside, and the distances."""
    import igl

    exact = {}
    for kind, chosen in checked.items():
        asked = positions[kind][chosen]
        inside = np.abs(igl.winding_number(vertices, faces, asked)) > 0.5
        exact[kind] = inside, np.sqrt(igl.point_mesh_squared_distance(asked, vertices, faces)[0])
    return exact


def run_method(name, case, checked, exact, given):
    """Returns the record of one run."""
    threads = str(given.threads)
    command = [sys.executable, __file__, "--run", name, "--threads", threads, str(case), str(given.out)]
    environment = os.environ | {"OMP_NUM_THREADS": threads, "IGL_NUM_THREADS": threads}
    try:
        finished = subprocess.run(command, capture_output=True, text=True, timeout=given.limit, env=environment)
    except subprocess.TimeoutExpired:
        return {"error": f"not finished after {given.limit} s"}
    if finished.returncode != 0:
        said = finished.stderr.strip().splitlines() or [f"exit code {finished.returncode}"]
        return {"error": said[-1]}
    record = json.loads(finished.stdout.strip().splitlines()[-1])
    answers = np.load(case.with_suffix(f".{name}.npz"))
    for kind in answers.files:
        values, (inside, distance) = answers[kind][checked[kind]], exact[kind]
        record[kind] = {"wrong": float(np.mean((values < 0) != inside)), "off": float(np.mean(np.abs(np.abs(values) - distance) > OFF))}
    return record


def run_mesh(row, folder, given):
    """Returns the records of one mesh by method, or why it was left out."""
    import raymap

    case = folder / "case.npz"
    try:
        vertices, faces, positions, checked = make_case(given.folder / row["file"], case, given)
    except (raymap.Error, ValueError) as error:
        return {"left out": str(error).splitlines()[0]}
    exact = truth(vertices, faces, positions, checked)
    runs = {name: run_method(name, case, checked, exact, given) for name in given.methods}
    return {"balanced": row["balanced"] == "yes", "triangles": len(faces), "runs": runs}


def table_row(name, meshes):
    """Summarises a method: costs on the meshes that it finished, beside ours on the same."""
    tried = [mesh for mesh in meshes.values() if "runs" in mesh]
    finished = [mesh for mesh in tried if "error" not in mesh["runs"][name] and "error" not in mesh["runs"]["raymap"]]
    cpu, ours = (sum(mesh["runs"][k]["cpu"] for mesh in finished) for k in (name, "raymap"))
    cells = [name, f"{len(finished)} of {len(tried)}", f"{cpu:.1f}", f"{cpu / max(ours, 1e-9):.1f}"]
    cells.append(f"{max((mesh['runs'][name]['megabytes'] for mesh in finished), default=0):.0f}")
    for balanced in (True, False):
        for kind in ("points", "grid"):
            shares = [mesh["runs"][name].get(kind) for mesh in finished if mesh["balanced"] == balanced]
            shares = [share["wrong"] for share in shares if share]
            cells.append(f"{100 * np.mean(shares):.2f}" if shares else "")
    off = [run[kind]["off"] for run in (mesh["runs"][name] for mesh in finished) for kind in ("points", "grid") if kind in run]
    return "| " + " | ".join([*cells, f"{100 * np.mean(off):.2f}" if off else ""]) + " |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    for name, default in (("points", 250_000), ("samples", 64), ("limit", 120), ("threads", 2), ("every", 1)):
        parser.add_argument(f"--{name}", type=int, default=default)
    parser.add_argument("--only", default="", help="files whose name contains this")
    parser.add_argument("--methods", type=lambda text: text.split(","), default=list(METHODS), help="raymap among them")
    parser.add_argument("--run", choices=METHODS, help=argparse.SUPPRESS)  # Runs this method here; FOLDER is the case.
    given = parser.parse_args()
    if given.run:
        run_here(given.run, given.folder, given.threads)
        return
    unknown = [name for name in given.methods if name not in METHODS]
    if unknown or "raymap" not in given.methods:
        parser.error(f"--methods takes raymap and others of {', '.join(METHODS)}")
    given.out.mkdir(parents=True, exist_ok=True)
    meshes = {}
    for number, row in enumerate(mesh_rows(given.folder)):
        if given.only in row["file"] and number % given.every == 0:
            with tempfile.TemporaryDirectory() as folder:
                meshes[row["file"]] = run_mesh(row, pathlib.Path(folder), given)
            print(row["file"], json.dumps(meshes[row["file"]]), file=sys.stderr, flush=True)
    (given.out / "workload.json").write_text(json.dumps(meshes, indent=1) + "\n")
    print("| method | meshes | CPU s | times ours | MB, at most | wrong signs in %, closed: points | grid | others: points | grid | off, % |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    print(*(table_row(name, meshes) for name in given.methods), sep="\n")


if __name__ == "__main__":
    main()
