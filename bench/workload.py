"""What learners ask of each mesh, signed distances of points and a grid: Raymap beside other packages."""

import tempfile

import numpy as np
from harness import (exact_distance, exact_winding, head, in_process, inside, line, load, measured, mesh_rows, spread, table,
                     uniform_points)  # fmt: skip
from speed import open3d_scene


def lattice(count):
    """Returns the positions of a grid's samples in the box from -1, z fastest."""
    axis = -1 + 2 * np.arange(count) / count
    return np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)


def ask_raymap_grid(vertices, faces, points, count, threads):
    import raymap

    return None, raymap.generate(vertices, faces, shape=(count,) * 3, origin=(-1, -1, -1), voxel_size=2 / count, device="cpu",
                                 threads=threads).distance  # fmt: skip


def ask_raymap(vertices, faces, points, count, threads):
    import raymap

    surface = raymap.Surface(vertices, faces, threads=threads)
    return surface.signed_distance(points, threads=threads), ask_raymap_grid(vertices, faces, points, count, threads)[1]


def ask_mesh2sdf(vertices, faces, points, count, threads):
    """It makes the grid alone."""
    import mesh2sdf as library

    return None, library.compute(vertices, faces, size=count)


def both(answer):
    """Returns a method that asks `answer(vertices, faces, positions)` for points and samples in one call."""

    def method(vertices, faces, points, count, threads):
        values = np.asarray(answer(vertices, faces, np.concatenate([points, lattice(count)])))
        return values[: len(points)], values[len(points) :]

    return method


@both
def ask_open3d(vertices, faces, where):
    return open3d_scene(vertices, faces).compute_signed_distance(where.astype(np.float32)).numpy()


@both
def ask_libigl(vertices, faces, where):
    import igl

    return igl.signed_distance(where, vertices, faces, igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER)[0]


@both
def ask_point_cloud_utils(vertices, faces, where):
    import point_cloud_utils

    return point_cloud_utils.signed_distance_to_mesh(where, vertices, faces)[0]


@both
def ask_pysdf(vertices, faces, where):
    import pysdf

    return -pysdf.SDF(vertices, faces)(where)


@both
def ask_trimesh(vertices, faces, where):
    import trimesh

    return -trimesh.proximity.signed_distance(trimesh.Trimesh(vertices, faces), where)


@both
def ask_mesh_to_sdf(vertices, faces, where):
    """Without a graphics card its scans do not run, so its points on the surface are sampled from the faces."""
    import mesh_to_sdf
    import trimesh

    return mesh_to_sdf.mesh_to_sdf(trimesh.Trimesh(vertices, faces), where, surface_point_method="sample", sign_method="normal")


def ask(threads, vertices, faces, points, count, method):
    """Answers a case, after one of a tetrahedron that imports what the method needs and starts its threads."""
    method, count = globals()[f"ask_{method}"], int(count)
    small = np.float64([(0, 0, 0), (0.5, 0, 0), (0, 0.5, 0), (0, 0, 0.5)]), np.array([(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
    method(*small, points[:9], 8, threads)
    (at_points, grid), cost = measured(lambda: method(vertices, faces, points, count, threads))
    return {"grid": np.ravel(grid)} | ({} if at_points is None else {"points": np.ravel(at_points)}), cost


def ask_all(row, methods, points, samples, limit, threads, folder):
    """Returns a record of each method on one mesh: its cost, and the shares of wrong signs and of distances that are off by 0.01."""
    vertices, faces = load(folder / row["file"])
    vertices = (vertices - (vertices.min(axis=0) + vertices.max(axis=0)) / 2) * (1.6 / np.ptp(vertices, axis=0).max())
    random, mesh = np.random.default_rng(1), (vertices, faces)
    near = spread(mesh, points // 2, random) + random.normal(scale=0.01, size=(points // 2, 3))
    where = {"points": np.concatenate([uniform_points(vertices, points - len(near), random), near]), "grid": lattice(samples)}
    checked = {kind: random.choice(len(asked), 1000) for kind, asked in where.items()}
    truth = {kind: (inside(exact_winding(mesh, where[kind][c])), exact_distance(mesh, where[kind][c])) for kind, c in checked.items()}
    records = {}
    with tempfile.TemporaryDirectory() as place:
        for method in methods:
            np.savez(f"{place}/case.npz", vertices=vertices, faces=faces, points=where["points"], count=samples, method=method)
            try:
                answers, records[method] = in_process("workload:ask", f"{place}/case.npz", threads, limit)
            except RuntimeError as error:
                records[method] = {"error": str(error)}
                continue
            for kind, values in answers.items():
                is_in, distance = truth[kind]
                found = values[checked[kind]]
                records[method][kind] = np.mean((found < 0) != is_in), np.mean(np.abs(np.abs(found) - distance) > 0.01)
    return {"balanced": row["balanced"] == "yes", "runs": records}


@table
def workload(folder, points=250_000, samples=64, limit=120, threads=2, every=1, only=("",),
             methods=("raymap", "raymap_grid", "open3d", "pysdf", "point_cloud_utils", "libigl", "mesh2sdf", "mesh_to_sdf", "trimesh")):  # fmt: skip
    """Costs and errors of what learners ask of each mesh, signed distances of points and a grid: docs/performance.md.

    Half of the points are uniform in the box, half lie near the surface. The longest side reaches from -0.8 to 0.8, as
    mesh2sdf wants it. The truth is libigl's exact winding number at 1,000 of the points and of the samples each."""
    meshes = []
    for row in mesh_rows(folder, only)[::every]:
        try:
            meshes.append(ask_all(row, methods, points, samples, limit, threads, folder))
        except Exception as error:
            print(f"{row['file']} is left out: {str(error).splitlines()[0]}")
    head("method", "meshes", "CPU s", "times ours", "MB, at most", "wrong signs in %, closed: points", "grid", "others: points", "grid",
         "off, %")  # fmt: skip
    for name in methods:
        finished = [mesh for mesh in meshes if not any("error" in mesh["runs"][k] for k in (name, "raymap"))]
        cpu, ours = (sum(mesh["runs"][k]["cpu"] for mesh in finished) for k in (name, "raymap"))
        runs = [(mesh["balanced"], mesh["runs"][name]) for mesh in finished]
        mean = lambda values: f"{100 * np.mean(values):.2f}" if values else ""  # noqa: E731
        wrong = [mean([run[kind][0] for balanced, run in runs if balanced == is_closed and kind in run])
                 for is_closed in (True, False) for kind in ("points", "grid")]  # fmt: skip
        line(name, f"{len(finished)} of {len(meshes)}", f"{cpu:.1f}", f"{cpu / max(ours, 1e-9):.1f}",
             f"{max((run['megabytes'] for _, run in runs), default=0):.0f}", *wrong,
             mean([run[kind][1] for _, run in runs for kind in ("points", "grid") if kind in run]))  # fmt: skip
