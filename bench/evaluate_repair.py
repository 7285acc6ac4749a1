#!/usr/bin/env python3
"""Repairs every mesh of a folder and prints, as Markdown, how far results lie from their meshes.

Usage: bench/evaluate_repair.py RAYMAP FOLDER [--resolution 256] [--work FOLDER]

The folder has a table MESHES.tsv with the columns file and kind. Meshes of the kind malformed are left out. The work
folder gets each mesh's statistics as .json."""
import argparse
import csv
import json
import pathlib
import resource
import subprocess
import sys


def repair(raymap, mesh, work, resolution):
    """Returns the statistics, or None and the reason."""
    file = work / (mesh.name + ".json")
    before = cpu_seconds()
    run = subprocess.run([raymap, "repair", mesh, "-o", work / "result.stl", "--resolution", str(resolution), "--device", "cpu",
                          "--remesh", "--stats", file], capture_output=True, text=True)
    if run.returncode != 0:
        return None, run.stderr.strip().removeprefix("raymap: error: ")
    return {**json.loads(file.read_text()), "cpu": cpu_seconds() - before}, ""


def cpu_seconds():
    """Returns the CPU time of all programs that ended."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def percentile(values, share):
    values = sorted(values)
    return values[round(share * (len(values) - 1))]


def print_distribution(rows):
    print("| largest distance of a mesh, in samples | median | 75 % | 90 % | largest |\n|---|---|---|---|---|")
    for name, key in (("of the result's points from the mesh", "result_from_mesh"),
                      ("of the mesh's points from the result", "mesh_from_result")):
        for part, label in (("max", "farthest point"), ("p99", "99 % of the points"), ("mean", "mean")):
            values = [stats[key][part] / stats["grid"]["spacing"] for _, stats in rows]
            cells = " | ".join(f"{percentile(values, share):.2g}" for share in (0.5, 0.75, 0.9, 1.0))
            print(f"| {name}: {label} | {cells} |")


def is_sound(stats):
    after = stats["after"]
    return after["watertight"] and after["consistently_oriented"] and after["signed_volume"] > 0


def print_crossing(rows):
    pairs = {name: stats["after"]["self_intersections"]["pairs"] for name, stats in rows}
    crossing = [f"{name} ({count})" for name, count in pairs.items() if count]
    print(f"Results with pairs of faces that cross: {len(crossing)}" + "".join(f"\n- {line}" for line in crossing) + "\n")


def print_far(rows):
    """Prints meshes whose result is more than a sample away somewhere, or loses a hundredth of the mesh."""
    print("\n| mesh | wrong with it | result from mesh: largest, samples | mesh from result: largest | inside | outside |")
    print("|---|---|---|---|---|---|")
    for name, stats in rows:
        spacing, before = stats["grid"]["spacing"], stats["before"]
        far, lost = (stats[key]["max"] / spacing for key in ("result_from_mesh", "mesh_from_result"))
        if far <= 1 and stats["lost_share"] < 0.01:
            continue
        wrong = ", ".join(f"{before[key]} {label}" for key, label in (
            ("boundary_edges", "boundary"), ("nonmanifold_edges", "non-manifold"), ("flipped_edges", "flipped")) if before[key])
        print(f"| {name} | {wrong or 'nothing'} | {far:.2g} | {lost:.2g} | {100 * stats['buried_share']:.2g} % "
              f"| {100 * stats['lost_share']:.2g} % |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("raymap")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--resolution", type=int, default=256)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/evaluation/repair"))
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    with open(arguments.folder / "MESHES.tsv", newline="") as table:
        names = [row["file"] for row in csv.DictReader(table, delimiter="\t", quoting=csv.QUOTE_NONE)
                 if row["kind"] != "malformed"]
    rows, failures = [], []
    for name in names:
        stats, error = repair(arguments.raymap, arguments.folder / name, arguments.work, arguments.resolution)
        if stats is None:
            failures.append((name, error))
        else:
            rows.append((name, stats))
        print(f"{len(rows) + len(failures)} of {len(names)}: {name}", file=sys.stderr)
    sound = [name for name, stats in rows if is_sound(stats)]
    print(f"{len(names)} meshes: {len(sound)} results watertight and facing outwards, {len(rows) - len(sound)} not, "
          f"{len(failures)} without a result.")
    seconds = [stats["cpu"] for _, stats in rows]
    print(f"CPU seconds of the program, files included: median {percentile(seconds, 0.5):.2g}, largest {max(seconds):.2g}.\n")
    for name, stats in rows:
        if not is_sound(stats):
            print(f"- {name}: not watertight")
    for name, error in failures:
        print(f"- {name}: {error}")
    print()
    print_crossing(rows)
    print_distribution(rows)
    print_far(rows)


if __name__ == "__main__":
    main()
