#!/usr/bin/env python3
"""Repairs every mesh of a folder by defaults and by what `raymap info` prints, and prints what is lost as Markdown.

Usage: bench/evaluate_losses.py RAYMAP FOLDER [--work FOLDER] [--only NAME...] [--most-faces N] [--threads 1] [--limit 900]

What is lost is the share of the mesh's area that is outside of the result and farther from it than two samples of a grid of
256. The work folder keeps what was measured (NAME.losses.json). A run that was stopped goes on there. Needs numpy and the
Python package raymap."""
import argparse
import json
import pathlib
import re
import shlex
import subprocess
import time

import numpy as np
import raymap
from mesh_table import mesh_rows

MOST_UNSAID, MOST_LOST = 0.001, 0.01  # Shares of the area: without a warning, and of meshes that are listed.


def lost_share(mesh, result, threads):
    """Returns the share of a mesh's area that a result does not show."""
    given = raymap.load_mesh(mesh)
    vertices, faces = np.asarray(given.vertices), np.asarray(given.faces)
    used = vertices[np.unique(faces)]
    sample = float((used.max(axis=0) - used.min(axis=0)).max()) / 256
    points = raymap.sample_faces(given, step=2 * sample)
    away = raymap.Surface(str(result), sign=False, threads=threads).signed_distance(points.position, threads=threads)
    is_far = away > 2 * sample
    if not is_far.any():
        return 0.0
    signed = raymap.Surface(str(result), threads=threads).signed_distance(points.position[is_far], threads=threads)
    return float(points.area[is_far][signed > 0].sum() / points.area.sum())


def commands_for(raymap_binary, mesh):
    """Returns the words of the commands to run, without the program: a repair by defaults, and what `raymap info` prints
    beside it."""
    done = subprocess.run([raymap_binary, "info", str(mesh)], capture_output=True, text=True, errors="replace")
    defaults = ["repair", str(mesh), "-o", mesh.stem + ".solid.ply"]
    commands = {"defaults": defaults}
    if command := re.search(r": raymap ((repair|mesh) .*)", done.stdout):
        commands["defaults" if command[2] == "repair" else "thickened"] = shlex.split(command[1])
    if size := re.search(r"so does --voxel-size (\S+?)\.?$", done.stdout, re.MULTILINE):
        commands["voxel size"] = [*defaults, "--voxel-size", size[1]]
    return commands


def try_command(raymap_binary, words, mesh, work, threads, limit):
    """Runs a command in the work folder, and returns what is known of it."""
    result = work / words[words.index("-o") + 1]
    began = time.monotonic()
    try:
        done = subprocess.run([raymap_binary, *words, "--overwrite", "--threads", str(threads)], cwd=work, capture_output=True,
                              text=True, errors="replace", timeout=limit)
    except subprocess.TimeoutExpired:
        return {"command": shlex.join(words), "seconds": limit, "warnings": [], "error": f"does not end within {limit:g} s"}
    found = {"command": shlex.join(words), "seconds": time.monotonic() - began,
             "warnings": [line for line in done.stderr.splitlines() if "warning:" in line]}
    if done.returncode != 0:
        return {**found, "error": done.stderr.strip().splitlines()[-1]}
    found |= {"faces": len(raymap.load_mesh(result).faces), "lost": lost_share(mesh, result, threads or None)}
    result.unlink()
    return found


def evaluate(arguments, mesh):
    commands = commands_for(arguments.raymap, mesh)
    return {which: try_command(arguments.raymap, words, mesh, arguments.work, arguments.threads, arguments.limit)
            for which, words in commands.items()}


def evaluate_or_recall(arguments, mesh):
    file = arguments.work / (mesh.name + ".losses.json")
    if not file.exists():
        file.write_text(json.dumps(evaluate(arguments, mesh)))
    return json.loads(file.read_text())


def print_table(rows):
    print("| mesh | command | lost | warnings | seconds | faces |\n|---|---|---|---|---|---|")
    runs = [(name, which, run) for name, found in rows.items() for which, run in found.items()]
    for name, which, run in sorted(runs, key=lambda row: -row[2].get("lost", 2)):
        lost = f"{100 * run['lost']:.3g} %" if "lost" in run else run["error"]
        print(f"| {name} | {which} | {lost} | {len(run['warnings'])} | {run['seconds']:.2g} | {run.get('faces', '–')} |")


def print_summary(rows):
    for which in ("defaults", "voxel size", "thickened"):
        runs = {name: found[which] for name, found in rows.items() if which in found}
        lost = {name: run["lost"] for name, run in runs.items() if "lost" in run}
        unsaid = [name for name, share in lost.items() if share > MOST_UNSAID and not runs[name]["warnings"]]
        print(f"\n{which}: {len(runs)} runs, {len(runs) - len(lost)} without a result; more than {100 * MOST_UNSAID:g} % lost "
              f"without a warning: {unsaid}; more than {100 * MOST_LOST:g} % lost: {[n for n in lost if lost[n] > MOST_LOST]}.")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raymap", type=lambda name: str(pathlib.Path(name).resolve()))
    parser.add_argument("folder", type=lambda name: pathlib.Path(name).resolve())
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/evaluation/losses"))
    parser.add_argument("--only", nargs="+", help="names of meshes")
    parser.add_argument("--most-faces", type=int, help="leave out meshes of more faces")
    parser.add_argument("--threads", type=int, default=0, help="threads of the program; 0 = all")
    parser.add_argument("--limit", type=float, default=900, help="seconds that a command may take")
    arguments = parser.parse_args()
    arguments.work.mkdir(parents=True, exist_ok=True)
    listed = [row for row in mesh_rows(arguments.folder) if row["kind"] != "malformed"]
    names = [row["file"] for row in listed if (arguments.only is None or row["file"] in arguments.only) and
             (arguments.most_faces is None or int(row["triangles"]) <= arguments.most_faces)]
    rows = {name: evaluate_or_recall(arguments, arguments.folder / name) for name in names}
    print_table(rows)
    print_summary(rows)


if __name__ == "__main__":
    main()
