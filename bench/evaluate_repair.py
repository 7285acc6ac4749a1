#!/usr/bin/env python3
"""Repairs every mesh of a folder, checks each result by other software, and prints tables as Markdown.

Usage: bench/evaluate_repair.py RAYMAP FOLDER [--resolution 256] [--work FOLDER] [--only NAME...] [--points 50000]

The folder has a table MESHES.tsv with the columns file and kind. Meshes of the kind malformed are left out. The work
folder gets each mesh's result, its statistics, and what was measured (NAME.evaluation.json). A run that was stopped goes
on there: what the same program made with the same arguments is not made again.

Checks by other software: admesh (in the PATH) and trimesh count faults; distances are Open3D's, from points spread at
random over both surfaces. Needs numpy, scipy, trimesh and open3d."""
import argparse
import hashlib
import json
import pathlib
import re
import resource
import shutil
import statistics
import subprocess
import sys

from mesh_table import mesh_rows

# Faults that admesh must not find in a result. It prints a count of each.
ADMESH_FAULTS = ("Edges fixed", "Facets removed", "Facets added", "Facets reversed", "Backwards edges", "Degenerate facets",
                 "Total disconnected facets")


def cpu_seconds():
    """Returns the CPU time of all programs that ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run(command):
    """Returns the finished program and the CPU time that it took."""
    before = cpu_seconds()
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, errors="replace")
    return done, cpu_seconds() - before


def knows_tolerance(raymap):
    return "--tolerance" in subprocess.run([raymap, "repair", "--help"], capture_output=True, text=True).stdout


def repair(raymap, mesh, result, arguments, tolerance=None):
    """Returns the statistics with the warnings and the CPU time, or the reason why there is no result."""
    file = result.with_suffix(".stats.json")
    options = ["--resolution", arguments.resolution, "--device", "cpu", "--remesh"]
    options += [] if tolerance is None else ["--tolerance", tolerance]
    done, cpu = run([raymap, "repair", mesh, "-o", result, "--stats", file, *options])
    warnings = [line.removeprefix("raymap: warning: ") for line in done.stderr.splitlines() if "warning:" in line]
    if done.returncode != 0:
        return {"error": done.stderr.strip().splitlines()[-1].removeprefix("raymap: error: "), "warnings": warnings}
    return {**json.loads(file.read_text()), "cpu": cpu, "warnings": warnings}


def check_by_admesh(result):
    """Returns the faults that admesh finds in a binary or text STL, by name."""
    done, _ = run(["admesh", result])
    if done.returncode != 0:
        return {"not readable": 1}
    faults = {}
    for name in ADMESH_FAULTS:
        # "Total disconnected facets : 0   0" has the count before admesh's own repair first.
        found = re.search(rf"{name}\s*:\s*(\d+)", done.stdout)
        if found is None:
            return {f"no line '{name}'": 1}
        if int(found[1]):
            faults[name.lower()] = int(found[1])
    return faults


def parts_of(mesh):
    """Returns the signed volumes of a mesh's connected parts."""
    import numpy as np
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    links, count = mesh.face_adjacency, len(mesh.faces)
    graph = coo_matrix((np.ones(len(links)), (links[:, 0], links[:, 1])), shape=(count, count))
    parts, part_of = connected_components(graph, directed=False)
    corners = mesh.triangles - mesh.bounds.mean(axis=0)
    return np.bincount(part_of, np.einsum("fi,fi->f", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6, parts)


def part_volumes(file):
    import trimesh

    return parts_of(trimesh.load(file, force="mesh", process=True))


def check_by_trimesh(result):
    """Returns what trimesh says of a result, and how many closed parts face outwards and inwards."""
    import trimesh

    mesh = trimesh.load(result, force="mesh", process=True)
    volumes = parts_of(mesh)
    return {"watertight": bool(mesh.is_watertight), "oriented": bool(mesh.is_winding_consistent), "faces": len(mesh.faces),
            "volume": float(mesh.volume), "solids": int((volumes > 0).sum()), "cavities": int((volumes < 0).sum())}


def spread(vertices, faces, count, seed):
    """Returns points at random over the faces of positive area."""
    import numpy as np

    a, b, c = (vertices[faces[:, k]].astype(np.float64) for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    random = np.random.default_rng(seed)
    which = random.choice(len(faces), count, p=areas / areas.sum())
    u, v = random.random((2, count, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a[which] + u * (b - a)[which] + v * (c - a)[which]


def summary(distances):
    import numpy as np

    if len(distances) == 0:
        return {"max": 0.0, "p99": 0.0, "mean": 0.0}
    return {"max": float(distances.max()), "p99": float(np.percentile(distances, 99)), "mean": float(distances.mean())}


def measure_distances(raymap, mesh, result, count, spacing):
    """Returns both distances in samples, by Open3D. Points of the mesh more than a sample inside the result, where parts
    overlap, are a share of their own."""
    import numpy as np
    import open3d
    import trimesh

    copy = result.with_suffix(".mesh.ply")
    done, _ = run([raymap, "convert", mesh, copy])
    if done.returncode != 0:
        raise RuntimeError(done.stderr)
    given, made = (trimesh.load(file, force="mesh", process=False) for file in (copy, result))
    copy.unlink()
    centre, scale = made.bounds.mean(axis=0), 1 / spacing  # Open3D computes in single precision: in samples about 0.

    def prepared(surface):
        vertices = (surface.vertices - centre) * scale
        scene = open3d.t.geometry.RaycastingScene()
        scene.add_triangles(open3d.core.Tensor(vertices.astype(np.float32)), open3d.core.Tensor(surface.faces.astype(np.uint32)))
        return vertices, np.asarray(surface.faces), scene

    given_vertices, given_faces, given_scene = prepared(given)
    made_vertices, made_faces, made_scene = prepared(made)
    of_result = given_scene.compute_distance(
        open3d.core.Tensor(spread(made_vertices, made_faces, count, 1).astype(np.float32))).numpy()
    points = open3d.core.Tensor(spread(given_vertices, given_faces, count, 2).astype(np.float32))
    of_mesh = made_scene.compute_distance(points).numpy()
    is_inside = made_scene.compute_occupancy(points, nsamples=5).numpy() > 0.5
    is_buried = is_inside & (of_mesh > 1)
    return {"result_from_mesh": summary(of_result), "mesh_from_result": summary(of_mesh[~is_buried]),
            "buried_share": float(is_buried.mean()), "lost_share": float((~is_inside & (of_mesh > 1)).mean())}


def evaluate(raymap, mesh, arguments, has_tolerance):
    """Repairs a mesh and returns all that is known about it, without what the tables do not use."""
    result = arguments.work / (mesh.name + ".stl")
    stats = repair(raymap, mesh, result, arguments)
    if "error" in stats:
        return stats
    found = {key: stats[key] for key in ("before", "after", "grid", "options", "cpu", "warnings", "result_from_mesh",
                                         "mesh_from_result", "buried_share", "lost_share", "loss", "stats")}
    for side in ("before", "after"):
        found[side]["holes"] = []
    if has_tolerance:
        whole = result.with_suffix(".whole.stl")
        found["cpu_whole"] = repair(raymap, mesh, whole, arguments, 0).get("cpu")
        whole.unlink(missing_ok=True)
    found["bytes"] = [mesh.stat().st_size, result.stat().st_size]
    found["admesh"] = check_by_admesh(result)
    found["trimesh"] = check_by_trimesh(result)
    found["open3d"] = measure_distances(raymap, mesh, result, arguments.points, stats["grid"]["spacing"])
    return found


def evaluate_or_recall(raymap, mesh, arguments, has_tolerance, key):
    file = arguments.work / (mesh.name + ".evaluation.json")
    if file.exists():
        known = json.loads(file.read_text())
        if known["key"] == key:
            return known
    found = {"key": key, **evaluate(raymap, mesh, arguments, has_tolerance)}
    part = file.with_suffix(".part")
    part.write_text(json.dumps(found))
    part.rename(file)
    return found


def percentile(values, share):
    values = sorted(values)
    return values[round(share * (len(values) - 1))]


def faults_of(found):
    """Returns what is wrong with a result, by three programs."""
    after, by_trimesh = found["after"], found["trimesh"]
    faults = [f"admesh: {count} {name}" for name, count in found["admesh"].items()]
    faults += [f"trimesh: not {what}" for what in ("watertight", "oriented") if not by_trimesh[what]]
    if by_trimesh["volume"] <= 0:
        faults.append("trimesh: no volume")
    if not (after["watertight"] and after["consistently_oriented"] and after["signed_volume"] > 0):
        faults.append("raymap: not sound")
    if after["self_intersections"]["pairs"]:
        faults.append(f"raymap: {after['self_intersections']['pairs']} crossing pairs")
    return faults


def limit_of(found):
    """Returns the largest distance of a result that needs no warning, in samples: what it was simplified by, and one."""
    return 1 + (found["options"].get("tolerance") or 0) / found["grid"]["spacing"]


def reasons_of_distance(found):
    """Returns what the report says of each largest distance, in samples by Open3D, that exceeds the limit."""
    loss, closed, limit = found["loss"], found["stats"]["patch_triangles"], limit_of(found)
    lost = [f"{100 * share:.2g} % of the mesh {text}" for share, text in (
        (loss["solid_share"], "is lost with its solid"), (loss["open_share"], "is lost and bounds no solid"),
        (loss["dropped_share"], "is lost with small parts that were dropped")) if share > 0]
    reasons = {"result_from_mesh": ["closed holes"] if closed else [], "mesh_from_result": lost}
    distances = {key: found["open3d"][key]["max"] for key in reasons}
    return [f"{key} {distances[key]:.2g} samples: {', '.join(reasons[key]) or 'NOTHING IS SAID'}"
            for key in reasons if distances[key] > limit]


def print_summary(rows, failures):
    faulty = {name: faults_of(found) for name, found in rows.items() if faults_of(found)}
    print(f"{len(rows) + len(failures)} meshes: {len(rows) - len(faulty)} results without a fault, {len(faulty)} with one, "
          f"{len(failures)} without a result.\n")
    for name, faults in faulty.items():
        print(f"- {name}: {'; '.join(faults)}")
    for name, found in failures.items():
        print(f"- {name}: {found['error']}")
    seconds = [found["cpu"] for found in rows.values()]
    print(f"\nCPU seconds of the program, files included: median {percentile(seconds, 0.5):.2g}, largest {max(seconds):.2g}.")
    ratios = [found["cpu"] / found["cpu_whole"] for found in rows.values() if found.get("cpu_whole")]
    if ratios:
        print(f"Over the same with `--tolerance 0`: median {statistics.median(ratios):.2f}, 90 % of the meshes at most "
              f"{percentile(ratios, 0.9):.2f}, largest {max(ratios):.2f}.")


def print_distribution(rows):
    print("\n| distances by Open3D, in samples | median | 75 % | 90 % | largest |\n|---|---|---|---|---|")
    for label, key in (("of the result's points from the mesh", "result_from_mesh"),
                       ("of the mesh's points from the result", "mesh_from_result")):
        for part, name in (("max", "farthest point"), ("p99", "99 % of the points"), ("mean", "mean")):
            values = [found["open3d"][key][part] for found in rows.values()]
            cells = " | ".join(f"{percentile(values, share):.2g}" for share in (0.5, 0.75, 0.9, 1.0))
            print(f"| {label}: {name} | {cells} |")


def print_agreement(rows):
    """Prints how far the program's own largest distances lie below those of Open3D, which sees other points."""
    for key in ("result_from_mesh", "mesh_from_result"):
        excess = {name: found["open3d"][key]["max"] - found[key]["max"] / found["grid"]["spacing"] for name, found in rows.items()}
        worst = max(excess, key=excess.get)
        print(f"\nOpen3D's largest `{key}` exceeds the program's by {max(excess[worst], 0):.2g} samples at most ({worst}).")


def change_of_volume(found):
    before = found["before"]
    if not before["balanced"] or before["self_intersections"]["pairs"] or before["signed_volume"] == 0:
        return "–"  # The volume of the mesh is not that of a solid.
    return f"{100 * (found['after']['signed_volume'] / abs(before['signed_volume']) - 1):+.2g} %"


def print_meshes(rows):
    print("\n| mesh | faces before | after | bytes before | after | result from mesh: largest, samples | mesh from result | "
          "inside | outside | volume | solids | cavities | warnings |")
    print("|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    for name, found in rows.items():
        distances = found["open3d"]
        print(f"| {name} | {found['before']['triangles']} | {found['after']['triangles']} | {found['bytes'][0]} | {found['bytes'][1]} "
              f"| {distances['result_from_mesh']['max']:.2g} | {distances['mesh_from_result']['max']:.2g} "
              f"| {100 * distances['buried_share']:.2g} % | {100 * distances['lost_share']:.2g} % | {change_of_volume(found)} "
              f"| {found['trimesh']['solids']} | {found['trimesh']['cavities']} | {len(found['warnings'])} |")


def print_judgements(rows):
    """Prints the warnings, which a person checks, and the results without one whose report must say why they are far off."""
    print("\nWarnings, to be checked by eye:\n")
    for name, found in rows.items():
        for text in found["warnings"]:
            print(f"- {name}: {text}")
    print("\nResults without a warning, but farther off than their tolerance and a sample, and what their reports say:\n")
    for name, found in rows.items():
        if not found["warnings"] and reasons_of_distance(found):
            print(f"- {name}: {'; '.join(reasons_of_distance(found))}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raymap")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--resolution", type=int, default=256)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/evaluation/repair"))
    parser.add_argument("--only", nargs="+", help="names of meshes")
    parser.add_argument("--points", type=int, default=50000, help="points on each surface")
    arguments = parser.parse_args()
    if shutil.which("admesh") is None:
        sys.exit("admesh is not installed; scripts/install.sh --bench installs it")
    arguments.work.mkdir(parents=True, exist_ok=True)
    names = [row["file"] for row in mesh_rows(arguments.folder)
             if row["kind"] != "malformed" and (arguments.only is None or row["file"] in arguments.only)]
    program = hashlib.sha256(pathlib.Path(arguments.raymap).read_bytes() + pathlib.Path(__file__).read_bytes()).hexdigest()
    key = f"{program} {arguments.resolution} {arguments.points}"
    has_tolerance = knows_tolerance(arguments.raymap)
    rows, failures = {}, {}
    for name in names:
        found = evaluate_or_recall(arguments.raymap, arguments.folder / name, arguments, has_tolerance, key)
        (failures if "error" in found else rows)[name] = found
        print(f"{len(rows) + len(failures)} of {len(names)}: {name}", file=sys.stderr)
    print_summary(rows, failures)
    print_distribution(rows)
    print_agreement(rows)
    print_meshes(rows)
    print_judgements(rows)


if __name__ == "__main__":
    main()
