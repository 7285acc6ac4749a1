"""Tables of costs beside other software: fields, threads and stages."""

import json
import math
import pathlib
import statistics
import subprocess
import tempfile

import harness
import numpy as np
from harness import BUILD, head, in_process, inside, is_wanted, line, measured, table

PEERS = BUILD / "bin/peers"  # Embree and OpenVDB, and Raymap in C++.


def peer(method, **case):
    """Runs a method of the program `peers` on a case and returns what it printed."""
    done = subprocess.run([PEERS, json.dumps({"method": method, **case}, default=str)], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip()[-300:])
    return json.loads(done.stdout)


def write_raw(mesh, name):
    np.ascontiguousarray(mesh[0], np.float64).tofile(f"{name}.vertices")
    np.ascontiguousarray(mesh[1], np.uint32).tofile(f"{name}.triangles")


def read_raw(name):
    vertices, faces = np.fromfile(f"{name}.vertices", np.float64), np.fromfile(f"{name}.triangles", np.uint32)
    return vertices.reshape(-1, 3), faces.reshape(-1, 3).astype(np.int64)


def openvdb_field(mesh, grid, band=3):
    """Returns OpenVDB's values of all samples of a grid."""
    with tempfile.TemporaryDirectory() as folder:
        write_raw(mesh, f"{folder}/mesh")
        peer("openvdb", mesh=f"{folder}/mesh", dims=list(map(int, grid.shape)), origin=list(map(float, grid.origin)),
             spacing=float(grid.spacing), band=band, output=f"{folder}/samples")  # fmt: skip
        return np.fromfile(f"{folder}/samples", np.float32).reshape(grid.shape, order="F")


# Fields: each method gets the raw mesh `name` and the grid, or points. These run in processes of their own.


def samples(dims, origin, spacing):
    """Returns the positions of all samples, x fastest."""
    z, y, x = np.meshgrid(*(origin[a] + spacing * np.arange(dims[a]) for a in (2, 1, 0)), indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1)


def open3d_scene(vertices, faces):
    import open3d

    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(open3d.core.Tensor(vertices.astype(np.float32)), open3d.core.Tensor(faces.astype(np.uint32)))
    return scene


def open3d(threads, name, **grid):
    import open3d as library

    mesh, where = read_raw(name), library.core.Tensor(samples(**grid).astype(np.float32))
    values, cost = measured(lambda: open3d_scene(*mesh).compute_signed_distance(where, nthreads=threads).numpy())
    return {"values": values}, cost


def igl_signed_distance(threads, name, **grid):
    import igl

    mesh, where = read_raw(name), samples(**grid)
    kind = igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    values, cost = measured(lambda: igl.signed_distance(where, *mesh, kind)[0])
    return {"values": values}, cost


def igl_winding(threads, name, **grid):
    import igl

    mesh, where = read_raw(name), samples(**grid)
    values, cost = measured(lambda: igl.fast_winding_number(*mesh, where))
    return {"values": values}, cost


def mesh2sdf(threads, name, dims, origin, spacing):
    """Its grid is always a cube of size^3 samples, from -1 in steps of 2 / size."""
    import mesh2sdf.core as library

    vertices, faces = read_raw(name)
    size = max(dims)
    scale = 2.0 / (size * spacing)
    vertices, faces = ((vertices - origin) * scale - 1).astype(np.float32), faces.astype(np.int32)
    values, cost = measured(lambda: library.compute(vertices, faces, size) / scale)
    return {"values": values.transpose(2, 1, 0)[: dims[2], : dims[1], : dims[0]].ravel()}, cost


def can_import(*packages):
    found = [subprocess.run([harness.sys.executable, "-c", f"import {name}"], capture_output=True).returncode == 0 for name in packages]
    return [name for name, is_there in zip(packages, found, strict=True) if is_there]


# Mesh, resolution, band, our method, {peer: ratio of CPU times that is wanted, or None}.
FIELDS = [
    (mesh, n, 0, "raymap", {"embree": 8 if n == 50 else 15, "openvdb": None} | (
        {"igl_signed_distance": None, "open3d": None, "mesh2sdf": None} if mesh == "scan" and n < 256 else {}))
    for mesh in ("scan", "million") for n in (50, 128, 256)
] + [(mesh, 256, 3, "raymap", {"openvdb": 2}) for mesh in ("scan", "million")] + [
    ("holes", n, 0, "raymap_winding", {"igl_winding": None if n < 256 else 10}) for n in (128, 256)
]  # fmt: skip
PACKAGE_OF = {"igl_signed_distance": "igl", "igl_winding": "igl", "open3d": "open3d", "mesh2sdf": "mesh2sdf"}


def run_field(method, mesh, n, band, threads, folder, spacing=None):
    """Returns a run's samples, and its cost with what `peers` says about the mesh and the grid."""
    if method not in PACKAGE_OF:
        cost = peer(method, mesh=mesh, resolution=n, band=band, threads=threads, output=folder / "samples")
        return np.fromfile(folder / "samples", np.float32), cost
    known = peer("export", mesh=mesh, resolution=n, output=folder / mesh)
    np.savez(folder / "case.npz", name=str(folder / mesh), dims=known["dims"], origin=known["origin"], spacing=known["spacing"])
    values, cost = in_process(f"speed:{method}", folder / "case.npz", threads)
    return values["values"], cost


def median(costs, key="cpu"):
    return statistics.median(cost[key] for cost in costs)


@table
def fields(rounds=3, threads=2, only=("",)):
    """CPU and wall seconds, and growth of the peak in MB, of fields beside peers': docs/performance.md.

    Medians of the rounds; in each all methods run once, ours last. |d| is the largest difference to ours, in samples."""
    print(f"Peers at hand: {', '.join(['embree', 'openvdb', *can_import(*sorted(set(PACKAGE_OF.values())))])}.\n")
    head("mesh, triangles", "samples", "method", "CPU", "wall", "MB", "CPU / ours", "wanted", "\\|d\\|", "other sign")
    for mesh, n, band, own, peers in FIELDS:
        if not is_wanted(f"{mesh} {n}", only):
            continue
        with tempfile.TemporaryDirectory(dir=BUILD) as name:
            folder = pathlib.Path(name)
            ours, known = run_field(own, mesh, n, band, threads, folder)
            costs, other = {method: [] for method in (*peers, own)}, {}
            wide = band or math.ceil(np.abs(ours).max() / known["spacing"]) + 1  # What OpenVDB needs to reach all samples.
            for _ in range(rounds):
                for method, runs in costs.items():
                    try:
                        values, cost = run_field(method, mesh, n, band if method == own else wide, threads, folder)
                    except RuntimeError as error:
                        other[method] = str(error)
                        continue
                    runs.append(cost)
                    if own == "raymap":
                        largest = np.abs(np.abs(ours) - np.abs(values)).max() / known["spacing"]
                        other[method] = largest, np.mean((ours < 0) != (values < 0))
                    else:
                        other[method] = np.abs(ours - values).max(), np.mean(inside(ours) != inside(values))
            for method, runs in costs.items():
                cells = [f"{mesh}, {known['triangles']}", "x".join(map(str, known["dims"])), method]
                if not runs:
                    line(*cells, other[method], *[""] * 6)
                    continue
                ratio, least = median(runs) / median(costs[own]), peers.get(method)
                cells += [f"{median(runs):.3f}", f"{median(runs, 'wall'):.3f}", f"{median(runs, 'megabytes'):.0f}", f"{ratio:.1f}"]
                wanted = f"{least} {'met' if ratio >= least else 'MISSED'}" if least else ""
                line(*cells, wanted, f"{other[method][0]:.2g}", f"{100 * other[method][1]:.3f} %")


@table
def threads(rounds=3):
    """Wall time of fields on two threads over that on one: docs/performance.md."""
    head("mesh", "resolution", "wall 1 thread", "wall 2 threads", "share", "at most")
    for mesh, n in (("scan", 128), ("scan", 256), ("million", 256)):
        one, two = (median([peer("raymap", mesh=mesh, resolution=n, threads=count) for _ in range(rounds)], "wall")
                    for count in (1, 2))  # fmt: skip
        line(mesh, n, f"{one:.3f}", f"{two:.3f}", f"{two / one:.2f}", f"0.6 {'met' if two <= 0.6 * one else 'MISSED'}")


# Least bytes that a stage moves, with input read once and output written once: per sample and per triangle.
TRAFFIC = {"exact_distance": (4, 36), "voxel_grid": (0, 40), "cell_distance": (0, 40), "distance_transform": (48, 0), "refine": (8, 36),
           "raster_distance": (4, 36), "crossings": (0, 36), "winding": (4, 0), "orientation": (4, 36), "winding_dipoles": (4, 0),
           "sign": (12, 0)}  # fmt: skip
STAGES = [{}, {"band": 3, "sign": "none"}, *({"distance": mode, "sign": "rays"} for mode in ("cell", "neighbours", "raster")),
          {"sign": "paths"}, {"sign": "evolution"}]  # fmt: skip


@table
def stages(meshes=("scan", "holes", "million"), resolutions=(50, 128, 256), rounds=5):
    """Milliseconds of each stage with warm memory, over the time for the bytes that it must move: docs/dev/measurements.md."""
    import raymap

    source, target = np.ones(2**25), np.ones(2**25)
    copies = [measured(lambda: np.copyto(target, source))[1]["wall"] for _ in range(5)]
    rate = 2 * source.nbytes / min(copies)
    print(f"One thread copies {1e-9 * rate:.1f} GB/s.\n")
    head("options", "stage", "mesh", "MB at least", "floor ms", "ms at " + ", ".join(map(str, resolutions)), "ms / floor")
    for name in meshes:
        with tempfile.TemporaryDirectory() as folder:
            peer("export", mesh=name, output=f"{folder}/mesh")
            mesh = read_raw(f"{folder}/mesh")
        for options in STAGES:
            times = {}
            for n in resolutions:
                generator = raymap.Generator()
                for _ in range(rounds):
                    made = generator.generate(*mesh, resolution=n, device="cpu", **options)
                    for stage in made.stats["stages"]:
                        times.setdefault(stage["name"], {}).setdefault(n, []).append(stage["milliseconds"])
            for stage, found in times.items():
                moved = np.dot(TRAFFIC.get(stage, (0, 0)), (np.prod(made.shape), len(mesh[1])))
                floor, ms = 1e3 * moved / rate, [statistics.median(found[n]) for n in resolutions]
                cells = [" ".join(map(str, options.values())) or "default", stage, name]
                limit = (f"{1e-6 * moved:.1f}", f"{floor:.2f}") if moved else ("–", "–")
                line(*cells, *limit, ", ".join(f"{t:.2f}" for t in ms), f"{ms[-1] / floor:.1f}" if moved else "–")
