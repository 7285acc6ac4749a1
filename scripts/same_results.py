#!/usr/bin/env python3
"""Proves that two builds of `raymap` give the same results, bit for bit.

same_results.py record PROGRAM FILE   runs some 600 commands and writes hashes of what each prints and writes
same_results.py compare PROGRAM FILE  runs them again, lists each difference, and ends with 1 if there is one

The commands make fields (all signs, distances and backends), bands, slabs, points, repaired and simplified meshes,
pictures, pages and files of all formats, of generated shapes and of small meshes of ../shared/meshes (RAYMAP_MESHES).
Figures of time and memory are left out. The hashes hold for one kind of processor: record and compare on one machine.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

REAL = ("pymesh__tet.obj", "prusaslicer__box.stl", "draco__cube_quads.ply", "trimesh__nested.glb", "trimesh__multibody.stl",
        "geogram__joint.off", "trimesh__wallhole.obj", "bff__triple_vierbein.obj", "geomcentral__moebius.obj",
        "openscad__nonmanifold.stl", "mitsuba-data__bunny_lowres.ply", "trimesh__empty.stl")
FIGURES = {"milliseconds", "peak_memory_bytes", "slowest_step", "bytes", "memory"}  # Of time and memory, in JSON.
AMOUNT = re.compile(rb"[\d.,]+(e[+-]?\d+)? (ms|s|min|h|[kMG]?B)\b|(?<=peak memory ).*|\d+ threads")  # And in text.
SIGNS = ("harmonic", "exact", "paths", "evolution", "rays", "ray")


def shapes(folder):
    """Writes meshes that need no file: a box, one without a lid, two that cross, a fan of three, a sheet and soup."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    turned = [(x * 0.6 + 0.3, y * 0.6 + z * 0.2 + 0.3, z * 0.6 + 0.5) for x, y, z in corners]
    wave = [(x, y, (x * 7 + y * 3) % 5 * 0.2) for y in range(6) for x in range(6)]
    rows = [(y * 6 + x, y * 6 + x + 1, y * 6 + x + 7, y * 6 + x + 6) for y in range(5) for x in range(5)]
    soup = [tuple((k * prime % 101) / 101 for prime in (37, 61, 83)) for k in range(60)]
    for name, points, faces in (
        ("box", corners, sides),
        ("open", corners, sides[:5]),
        ("flipped", corners, sides[:5] + [sides[5][::-1]]),
        ("crossing", corners + turned, sides + [tuple(v + 8 for v in side) for side in sides]),
        ("fan", [(0, 0, 0), (0, 0, 1), (1, 0, 0), (0, 1, 0), (-1, -1, 0)], [(0, 1, 2), (0, 1, 3), (0, 1, 4)]),
        ("sheet", wave, rows),
        ("soup", soup, [(3 * k, 3 * k + 1, 3 * k + 2) for k in range(20)]),
    ):
        lines = ["v %g %g %g" % point for point in points] + ["f " + " ".join(str(v + 1) for v in face) for face in faces]
        (folder / f"{name}.obj").write_text("\n".join(lines) + "\n")
    (folder / "points.csv").write_text("x,y,z\n" + "".join("%g,%g,%g\n" % point for point in soup))


def commands(meshes):
    """Yields (name, arguments): each writes only files that begin with `out`."""
    yield "example", "example -o out.ply"
    yield "example holes", "example -o out.ply --holes"
    small = "--resolution 20 --json"
    for mesh in meshes:
        for device in ("cpu", "vulkan"):
            for sign in SIGNS:
                yield (f"field {mesh} {sign} {device}",
                       f"generate {mesh} -o out.npz --triangle-ids out-ids.npy --winding out-w.npy --confidence out-c.npy "
                       f"--report out-report.json --sign {sign} --device {device} {small}")
        for distance in ("neighbours", "cell", "raster"):
            yield f"field {mesh} {distance}", f"generate {mesh} -o out.npy --distance {distance} --device cpu {small}"
        cpu = f"--device cpu {small}"
        yield f"band {mesh}", f"generate {mesh} -o out.nvdb --band 3 {cpu}"
        yield f"closed {mesh}", f"generate {mesh} -o out.vti --close-holes --orientation repair {cpu}"
        yield f"thick {mesh}", f"generate {mesh} -o out.nrrd --thickness 0.1 --invert {cpu}"
        yield f"info {mesh}", f"info {mesh} --json --picture out.png"
        yield f"info text {mesh}", f"info {mesh} --verbose"
        yield f"query {mesh}", f"query {mesh} points.csv -o out.csv --arrays distance,closest,triangle,winding --json"
        yield f"sample {mesh}", f"sample {mesh} -o out.npz --count 2000 --surface 0.3 --near 0.5 --json"
        yield f"repair {mesh}", f"repair {mesh} -o out.stl --resolution 24 --json"
        yield f"simplify {mesh}", f"simplify {mesh} -o out.ply --triangles 60 --json"
        yield f"mesh {mesh}", f"mesh {mesh} -o out.obj --resolution 20 --json --device cpu"
        yield f"render {mesh}", f"render {mesh} -o out.png --resolution 20 --size 160 120 --cut --device cpu"
    yield "check", f"check {' '.join(meshes)} --json"
    yield "check text", f"check {' '.join(meshes)}"
    made, grid = "out-field", "--resolution 24 --device cpu"
    for end in ("nrrd", "npy", "npz", "vti", "vdb", "nvdb"):
        steps = [f"generate crossing.obj -o {made}.{end} {grid} --band 4", f"info {made}.{end} --json",
                 f"convert {made}.{end} -o out.npz", f"mesh {made}.{end} -o out.ply --json",
                 f"query {made}.{end} points.csv -o out.csv --arrays distance,gradient",
                 f"render {made}.{end} -o out.html", f"render {made}.{end} -o out.png --slice z --size 160 120"]
        yield f"files {end}", steps
    yield "half", [f"generate open.obj -o {made}.npz --half {grid}", f"convert {made}.npz -o out.nrrd"]
    yield "slabs", f"generate crossing.obj -o out.nrrd --resolution 300 --device cpu --sign rays --memory-limit 90MB"
    yield "compare", [f"generate open.obj -o out-a.nrrd {grid}", f"generate open.obj -o out-b.nrrd --sign rays {grid}",
                      "compare out-a.nrrd out-b.nrrd -o out.png --json", "render out-a.nrrd out-b.nrrd -o out.html"]
    for end in ("ply", "obj", "stl", "glb", "3mf"):
        yield f"files {end}", [f"convert crossing.obj -o out.{end} --unit mm", f"info out.{end} --json",
                               f"repair open.obj -o out-repaired.{end} --resolution 24 --shell 0.1 --drain-hole 0.1 --unit mm"]
    yield "devices", "devices --json"
    yield "mistakes", ["generate none.obj -o out.npy", "generate box.obj -o out.npy --resolutoin 3", "info points.csv",
                       "generate box.obj -o out.xyz", "query box.obj box.obj -o out.csv", "repair box.obj"]
    for command in ("", "generate", "repair", "render", "query", "mesh"):
        yield f"help {command}", [f"{command} --help", f"manual {command}"]
    yield "completion", "completion bash"


def without_figures(value):
    if isinstance(value, dict):
        return {key: without_figures(each) for key, each in value.items() if key not in FIGURES}
    return [without_figures(each) for each in value] if isinstance(value, list) else value


def digest(data):
    try:
        data = json.dumps(without_figures(json.loads(data))).encode()
    except ValueError:
        pass
    return hashlib.sha256(data).hexdigest()[:16]


def run(program, steps, folder):
    """What the steps print and write, as hashes."""
    found = {}
    for number, step in enumerate([steps] if isinstance(steps, str) else steps):
        done = subprocess.run([program, *step.split()], cwd=folder, capture_output=True, timeout=300,
                              env={**os.environ, "RAYMAP_THREADS": "2"})
        found[f"exit {number}"] = str(done.returncode)
        found[f"stdout {number}"] = digest(done.stdout if done.stdout[:1] == b"{" else AMOUNT.sub(b"", done.stdout))
        found[f"stderr {number}"] = digest(AMOUNT.sub(b"", done.stderr))
    for path in sorted(folder.glob("out*")):
        data = path.read_bytes()
        if path.suffix == ".vdb":
            data = b""  # OpenVDB gives each file a new identity; the steps convert it.
        found[path.name] = digest(data)
        path.unlink()
    return found


def results(program):
    real = Path(os.environ.get("RAYMAP_MESHES", Path(__file__).resolve().parents[2] / "shared/meshes"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shapes(folder)
        meshes = sorted(path.name for path in folder.glob("*.obj"))
        for mesh in REAL:
            if (real / mesh).exists():
                (folder / mesh).write_bytes((real / mesh).read_bytes())
                meshes.append(mesh)
        return {name: run(program, steps, folder) for name, steps in commands(meshes)}


def main():
    _, what, program, file = sys.argv
    found = results(str(Path(program).resolve()))
    if what == "record":
        Path(file).write_text(json.dumps(found, indent=0))
        return
    before = json.loads(Path(file).read_text())
    differences = [f"{name}: {each}: {before.get(name, {}).get(each)} before, {found.get(name, {}).get(each)} now"
                   for name in sorted({*before, *found})
                   for each in sorted({*before.get(name, {}), *found.get(name, {})})
                   if before.get(name, {}).get(each) != found.get(name, {}).get(each)]
    print("\n".join(differences))
    print(f"{sum(map(len, found.values()))} results of {len(found)} runs, {len(differences)} differences")
    sys.exit(bool(differences))


if __name__ == "__main__":
    main()
