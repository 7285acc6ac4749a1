"""Repairs of every mesh of a folder, checked by other software: faults and distances.

`repair` leaves each result, its statistics and what was measured in --work. A run that was stopped goes on there.
"""

import hashlib
import json
import pathlib
import re
import resource
import shutil
import statistics
import subprocess
import sys

import numpy as np
from harness import RAYMAP, head, line, load, mesh_rows, spread, table

WORK = "out/evaluation/repair"
# Faults that admesh must not find in a result. It prints a count of each.
ADMESH_FAULTS = ("Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards edges", "Degenerate facets",
                 "Total disconnected facets")  # fmt: skip


def run(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, errors="replace", **options)


def cpu_seconds():
    """Returns the CPU time of all programs that ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def repaired(mesh, result, *options):
    """Returns the statistics with the warnings and the CPU time, or the reason why there is no result."""
    file, before = result.with_suffix(".stats.json"), cpu_seconds()
    done = run(RAYMAP, "repair", mesh, "-o", result, "--stats", file, "--overwrite", "--device", "cpu", "--remesh", *options)
    warnings = [text.removeprefix("raymap: warning: ") for text in done.stderr.splitlines() if "warning:" in text]
    if done.returncode != 0:
        return {"error": done.stderr.strip().splitlines()[-1].removeprefix("raymap: error: "), "warnings": warnings}
    return {**json.loads(file.read_text()), "cpu": cpu_seconds() - before, "warnings": warnings}


def check_by_admesh(result):
    """Returns the faults that admesh finds in an STL, by name."""
    done = run("admesh", result)
    if done.returncode != 0:
        return {"not readable": 1}
    # "Total disconnected facets : 0   0" has the count before admesh's own repair first.
    counts = {name: re.search(rf"{name}\s*:\s*(\d+)", done.stdout) for name in ADMESH_FAULTS}
    return {name.lower(): int(found[1]) if found else "no line" for name, found in counts.items() if not found or int(found[1])}


def part_volumes(file):
    """Returns the mesh as trimesh reads it, and the signed volumes of its connected parts."""
    import trimesh
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    mesh = trimesh.load(file, force="mesh", process=True)
    links, count = mesh.face_adjacency, len(mesh.faces)
    graph = coo_matrix((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(count, count))
    parts, part_of = connected_components(graph, directed=False)
    corners = mesh.triangles - mesh.bounds.mean(axis=0)
    return mesh, np.bincount(part_of, np.einsum("fi,fi->f", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6, parts)


def check_by_trimesh(result):
    mesh, volumes = part_volumes(result)
    return {"watertight": bool(mesh.is_watertight), "oriented": bool(mesh.is_winding_consistent), "volume": float(mesh.volume),
            "solids": int((volumes > 0).sum()), "cavities": int((volumes < 0).sum())}  # fmt: skip


def summary(distances):
    d = distances if len(distances) else np.zeros(1)
    return {"max": float(d.max()), "p99": float(np.percentile(d, 99)), "mean": float(d.mean())}


def measure_distances(mesh, result, count, spacing):
    """Returns both distances in samples, by Open3D. Points of the mesh more than a sample inside the result, where parts
    overlap, are a share of their own."""
    import open3d
    from speed import open3d_scene

    given, made = load(mesh), load(result)
    centre = (made[0].min(axis=0) + made[0].max(axis=0)) / 2  # Open3D computes in single precision: in samples about 0.
    given, made = (((vertices - centre) / spacing, faces) for vertices, faces in (given, made))
    points = [open3d.core.Tensor(spread(surface, count, np.random.default_rng(seed)).astype(np.float32))
              for surface, seed in ((made, 1), (given, 2))]  # fmt: skip
    scene = open3d_scene(*made)
    of_result, of_mesh = open3d_scene(*given).compute_distance(points[0]).numpy(), scene.compute_distance(points[1]).numpy()
    is_inside = scene.compute_occupancy(points[1], nsamples=5).numpy() > 0.5
    is_buried = is_inside & (of_mesh > 1)
    return {"result_from_mesh": summary(of_result), "mesh_from_result": summary(of_mesh[~is_buried]),
            "buried_share": float(is_buried.mean()), "lost_share": float((~is_inside & (of_mesh > 1)).mean())}  # fmt: skip


def evaluate(mesh, work, resolution, points):
    """Repairs a mesh and returns all that the tables need."""
    result = work / (mesh.name + ".stl")
    stats = repaired(mesh, result, "--resolution", resolution)
    if "error" in stats:
        return stats
    found = {key: stats[key] for key in ("before", "after", "grid", "options", "cpu", "warnings", "result_from_mesh", "mesh_from_result",
                                         "buried_share", "lost_share", "loss", "stats")}  # fmt: skip
    for side in ("before", "after"):
        found[side]["holes"] = []
    whole = work / "whole.stl"
    found["cpu_whole"] = repaired(mesh, whole, "--resolution", resolution, "--tolerance", 0).get("cpu")
    whole.unlink(missing_ok=True)
    found["bytes"] = [mesh.stat().st_size, result.stat().st_size]
    found["admesh"], found["trimesh"] = check_by_admesh(result), check_by_trimesh(result)
    found["open3d"] = measure_distances(mesh, result, points, stats["grid"]["spacing"])
    return found


def remembered(file, key, work):
    """Returns what a file says that was written under this key, or does the work and writes it."""
    if file.exists() and (known := json.loads(file.read_text()))["key"] == key:
        return known
    found = {"key": key, **work()}
    part = file.with_suffix(".part")
    part.write_text(json.dumps(found))
    part.rename(file)
    return found


def program_key(*more):
    return f"{hashlib.sha256(RAYMAP.read_bytes() + pathlib.Path(__file__).read_bytes()).hexdigest()} {more}"


def percentile(values, share):
    values = sorted(values)
    return values[round(share * (len(values) - 1))]


def faults_of(found):
    """Returns what is wrong with a result, by three programs."""
    after, by_trimesh = found["after"], found["trimesh"]
    faults = [f"admesh: {count} {name}" for name, count in found["admesh"].items()]
    faults += [f"trimesh: not {what}" for what in ("watertight", "oriented") if not by_trimesh[what]]
    faults += ["trimesh: no volume"] * (by_trimesh["volume"] <= 0)
    faults += ["raymap: not sound"] * (not (after["watertight"] and after["consistently_oriented"] and after["signed_volume"] > 0))
    return faults + ["raymap: crossing pairs"] * (after["self_intersections"]["pairs"] > 0)


def reasons_of_distance(found):
    """Returns what the report says of each largest distance by Open3D that exceeds the tolerance and a sample."""
    loss, limit = found["loss"], 1 + (found["options"].get("tolerance") or 0) / found["grid"]["spacing"]
    lost = [f"{100 * loss[key]:.2g} % of the mesh {text}" for key, text in (
        ("solid_share", "is lost with its solid"), ("open_share", "is lost and bounds no solid"),
        ("dropped_share", "is lost with small parts that were dropped")) if loss[key] > 0]  # fmt: skip
    reasons = {"result_from_mesh": ["closed holes"] if found["stats"]["patch_triangles"] else [], "mesh_from_result": lost}
    return [f"{key} {found['open3d'][key]['max']:.2g} samples: {', '.join(reasons[key]) or 'NOTHING IS SAID'}"
            for key in reasons if found["open3d"][key]["max"] > limit]  # fmt: skip


def change_of_volume(found):
    before = found["before"]
    if not before["balanced"] or before["self_intersections"]["pairs"] or before["signed_volume"] == 0:
        return "–"  # The volume of the mesh is not that of a solid.
    return f"{100 * (found['after']['signed_volume'] / abs(before['signed_volume']) - 1):+.2g} %"


def print_summary(rows, failures):
    faulty = {name: faults_of(found) for name, found in rows.items() if faults_of(found)}
    print(f"{len(rows) + len(failures)} meshes: {len(rows) - len(faulty)} results without a fault, {len(faulty)} with one, "
          f"{len(failures)} without a result.\n")  # fmt: skip
    texts = {name: "; ".join(faults) for name, faults in faulty.items()} | {name: found["error"] for name, found in failures.items()}
    for name, text in texts.items():
        print(f"- {name}: {text}")
    seconds = [found["cpu"] for found in rows.values()]
    ratios = [found["cpu"] / found["cpu_whole"] for found in rows.values() if found["cpu_whole"]]
    print(f"\nCPU seconds of the program, files included: median {percentile(seconds, 0.5):.2g}, largest {max(seconds):.2g}. Over the "
          f"same with `--tolerance 0`: median {statistics.median(ratios):.2f}, 90 % of the meshes at most {percentile(ratios, 0.9):.2f}, "
          f"largest {max(ratios):.2f}.\n")  # fmt: skip


def print_distances(rows):
    head("distances by Open3D, in samples", "median", "75 %", "90 %", "largest")
    for label, key in (("of the result's points from the mesh", "result_from_mesh"),
                       ("of the mesh's points from the result", "mesh_from_result")):  # fmt: skip
        for part, name in (("max", "farthest point"), ("p99", "99 % of the points"), ("mean", "mean")):
            values = [found["open3d"][key][part] for found in rows.values()]
            line(f"{label}: {name}", *(f"{percentile(values, share):.2g}" for share in (0.5, 0.75, 0.9, 1)))
    for key in ("result_from_mesh", "mesh_from_result"):
        excess, name = max((f["open3d"][key]["max"] - f[key]["max"] / f["grid"]["spacing"], name) for name, f in rows.items())
        print(f"\nOpen3D's largest `{key}` exceeds the program's by {max(excess, 0):.2g} samples at most ({name}).")


def print_meshes(rows):
    print()
    head("mesh", "faces before", "after", "bytes before", "after", "result from mesh: largest, samples", "mesh from result", "inside",
         "outside", "volume", "solids", "cavities", "warnings")  # fmt: skip
    for name, found in rows.items():
        far = found["open3d"]
        line(name, found["before"]["triangles"], found["after"]["triangles"], *found["bytes"], f"{far['result_from_mesh']['max']:.2g}",
             f"{far['mesh_from_result']['max']:.2g}", *(f"{100 * far[key]:.2g} %" for key in ("buried_share", "lost_share")),
             change_of_volume(found), found["trimesh"]["solids"], found["trimesh"]["cavities"], len(found["warnings"]))  # fmt: skip


@table
def repair(folder, resolution=256, work=WORK, only=("",), points=50000):
    """Faults by admesh and trimesh, distances by Open3D, and warnings, of every repaired mesh: docs/dev/mesh_tables.md."""
    if shutil.which("admesh") is None:
        sys.exit("admesh is not installed; scripts/install.sh --bench installs it")
    work = pathlib.Path(work)
    work.mkdir(parents=True, exist_ok=True)
    rows, failures = {}, {}
    for name in (row["file"] for row in mesh_rows(folder, only)):
        found = remembered(work / (name + ".evaluation.json"), program_key(resolution, points),
                           lambda name=name: evaluate(folder / name, work, resolution, points))  # fmt: skip
        (failures if "error" in found else rows)[name] = found
        print(name, file=sys.stderr)
    print_summary(rows, failures)
    print_distances(rows)
    print_meshes(rows)
    print("\nWarnings, to be checked by eye:\n")
    for name, text in ((name, text) for name, found in rows.items() for text in found["warnings"]):
        print(f"- {name}: {text}")
    print("\nResults without a warning, but farther off than their tolerance and a sample, and what their reports say:\n")
    for name, found in rows.items():
        if not found["warnings"] and reasons_of_distance(found):
            print(f"- {name}: {'; '.join(reasons_of_distance(found))}")
