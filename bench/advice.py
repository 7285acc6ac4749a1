"""Warnings of repairs, what repairs lose by what the program advises, and pictures of them."""

import json
import math
import pathlib
import re
import shlex
import subprocess
import time

import numpy as np
from harness import RAYMAP, head, line, load, mesh_rows, table
from repairs import WORK, part_volumes, program_key, remembered, repaired, run

# Warnings, by doing what they advise.


class Trial:
    """Repairs one mesh again, with other options."""

    def __init__(self, mesh, work, found):
        self.mesh, self.found, self.result = mesh, found, work / "warning.stl"

    def run(self, *options):
        grid = [] if "--voxel-size" in options else ["--resolution", max(self.found["grid"]["dims"])]
        return repaired(self.mesh, self.result, *grid, *options)


def share(value):
    return f"{100 * value:.3g} %"


def check_voxel_size(trial, most, size, kept="100"):
    """Compares the loss with what the size should keep, in %. Finer samples may find other losses: they get 5 % more."""
    samples = math.prod(n * trial.found["grid"]["spacing"] / float(size) for n in trial.found["grid"]["dims"])
    if samples > most:
        return None, f"not tried: {samples:.2g} samples"
    now = trial.run("--voxel-size", size)["loss"]["solid_share"]
    return now <= (1.05 - float(kept) / 100) * trial.found["loss"]["solid_share"], f"lost: {share(now)}"


def check_dropped(trial, count, largest):
    trial.run("--drop-smaller", "0", "--tolerance", "0")
    volumes = [v for v in part_volumes(trial.result)[1] if 0 < v < trial.found["drop_smaller"]]
    return len(volumes) == int(count) and math.isclose(max(volumes), float(largest), rel_tol=0.01), f"{len(volumes)} parts"


def check_filled(trial, count, largest):
    trial.run("--keep-cavities", "--tolerance", "0")
    cavities = [-v for v in part_volumes(trial.result)[1] if v < 0]
    return len(cavities) == int(count) and math.isclose(max(cavities), float(largest), rel_tol=0.01), f"{len(cavities)} cavities"


def check_sheets(trial):
    thickness = 2.5 * trial.found["grid"]["spacing"]
    now = trial.run("--min-thickness", f"{thickness:.4g}")["loss"]["open_share"]
    return now < 0.1 * trial.found["loss"]["open_share"], f"with {thickness:.3g}: {share(now)} lost"


def check_unit(trial):
    (low, high), (low_before, high_before) = trial.run("--unit", "mm")["after"]["bounds"], trial.found["after"]["bounds"]
    ratio = (high[0] - low[0]) / (high_before[0] - low_before[0])
    return math.isclose(ratio, 1000, rel_tol=0.01), f"{ratio:.4g} times as large"


def warning_checks(most):
    """Returns a pattern and a check for each kind of warning."""
    number = r"([\d.e+-]+)"
    return (
        (rf"a voxel size of {number} keeps them", lambda t, size: check_voxel_size(t, most, size)),
        (rf"keeps all, {number} keeps {number} %", lambda t, *size: check_voxel_size(t, most, *size)),
        (rf"dropped ([\d,]+) parts?, the largest of volume {number}", check_dropped),
        (rf"filled (\d+) sealed cavit(?:y|ies), the largest of volume {number}", check_filled),
        (r"sheets and open surface are lost", check_sheets),
        (r"--unit mm converts them", check_unit),
    )


@table
def repair_warnings(folder, work=WORK, samples=6e7):
    """Warnings of repairs, checked by doing what they advise, on grids of at most so many samples. Reads what `repair` left."""
    work, counts = pathlib.Path(work), {True: 0, False: 0, None: 0}
    head("mesh", "warning", "as advised", "true")
    for file in sorted(work.glob("*.evaluation.json")):
        name, evaluation = file.name.removesuffix(".evaluation.json"), json.loads(file.read_text())
        for text in () if "error" in evaluation else evaluation["warnings"]:
            trial = Trial(folder / name, work, json.loads((work / (name + ".stats.json")).read_text()))
            tried = ((check, match) for pattern, check in warning_checks(samples) if (match := re.search(pattern, text)))
            check, match = next(tried, (None, None))
            is_true, result = check(trial, *(group.replace(",", "") for group in match.groups())) if check else (None, "no check")
            counts[is_true] += 1
            line(name, text, result, "–" if is_true is None else "yes" if is_true else "NO")
    print(f"\n{counts[True]} warnings are true, {counts[False]} are not, {counts[None]} were not tried.")


# Losses, by defaults and by what `raymap info` prints.


def lost_share(mesh, result, threads):
    """Returns the share of a mesh's area that is outside of a result and farther off than two samples of a grid of 256."""
    import raymap

    given = raymap.Mesh(*load(mesh))
    sample = float(np.ptp(given.vertices, axis=0).max()) / 256
    points = raymap.sample_faces(given, step=2 * sample)
    away = raymap.Surface(str(result), sign=False, threads=threads).signed_distance(points.position, threads=threads)
    is_far = away > 2 * sample
    if not is_far.any():
        return 0.0
    signed = raymap.Surface(str(result), threads=threads).signed_distance(points.position[is_far], threads=threads)
    return float(points.area[is_far][signed > 0].sum() / points.area.sum())


def commands_for(mesh):
    """Returns the words of the commands to run: a repair by defaults, and what `raymap info` prints beside it."""
    said = run(RAYMAP, "info", mesh).stdout
    commands = {"defaults": ["repair", str(mesh), "-o", mesh.stem + ".solid.ply"]}
    if size := re.search(r"so does --voxel-size (\S+?)\.?$", said, re.MULTILINE):
        commands["voxel size"] = [*commands["defaults"], "--voxel-size", size[1]]
    if command := re.search(r": raymap ((repair|mesh) .*)", said):
        commands["defaults" if command[2] == "repair" else "thickened"] = shlex.split(command[1])
    return commands


def try_command(words, mesh, work, threads, limit):
    result, began = work / words[words.index("-o") + 1], time.monotonic()
    try:
        done = run(RAYMAP, *words, "--overwrite", "--threads", threads, cwd=work, timeout=limit)
    except subprocess.TimeoutExpired:
        return {"seconds": limit, "warnings": 0, "error": f"does not end within {limit:g} s"}
    found = {"seconds": time.monotonic() - began, "warnings": done.stderr.count("warning:")}
    if done.returncode != 0:
        return {**found, "error": done.stderr.strip().splitlines()[-1]}
    found |= {"faces": len(load(result)[1]), "lost": lost_share(mesh, result, threads or None)}
    result.unlink()
    return found


@table
def losses(folder, work="out/evaluation/losses", only=("",), most_faces=10**9, threads=0, limit=900.0):
    """What repairs lose by defaults, and by what `raymap info` prints: docs/evaluation.md."""
    work = pathlib.Path(work).resolve()
    work.mkdir(parents=True, exist_ok=True)
    rows = {}
    for name in (row["file"] for row in mesh_rows(folder, only) if int(row["triangles"]) <= most_faces):
        tried = lambda name=name: {which: try_command(words, folder / name, work, threads, limit)  # noqa: E731
                                   for which, words in commands_for(folder / name).items()}  # fmt: skip
        rows[name] = remembered(work / (name + ".losses.json"), program_key(), tried)
        del rows[name]["key"]
    runs = [(name, which, found) for name, kinds in rows.items() for which, found in kinds.items()]
    head("mesh", "command", "lost", "warnings", "seconds", "faces")
    for name, which, found in sorted(runs, key=lambda row: -row[2].get("lost", 2)):
        line(name, which, share(found["lost"]) if "lost" in found else found["error"], found["warnings"], f"{found['seconds']:.2g}",
             found.get("faces", "–"))  # fmt: skip
    for kind in ("defaults", "voxel size", "thickened"):
        found = {name: one for name, which, one in runs if which == kind}
        lost = {name: one["lost"] for name, one in found.items() if "lost" in one}
        unsaid = [name for name, amount in lost.items() if amount > 0.001 and not found[name]["warnings"]]
        print(f"\n{kind}: {len(found)} runs, {len(found) - len(lost)} without a result; more than 0.1 % lost without a warning: "
              f"{unsaid}; more than 1 % lost: {[name for name in lost if lost[name] > 0.01]}.")  # fmt: skip


# Pictures. A file, what is wrong with it, and further options of the picture.
SHOWN = (
    ("draco__bun_zipper.ply", "scan with holes, seen from below", ("--direction", "-0.4", "0.9", "-0.6")),
    ("odedstein__demosthenes-low-res.obj", "bust, open below", ("--direction", "-0.5", "0.6", "-0.8")),
    ("common3d__teapot.obj", "open parts that cross", ()),
    ("meshlab__elephant.ply", "parts that cross, holes", ()),
    ("assimp__Wuson.stl", "loose sheets, crossing faces", ("--up", "0", "1", "0")),
    ("vtkdata__footbones.ply", "26 solids that overlap", ()),
    ("admesh__hourglass.stl", "turned faces", ()),
    ("meshlab__conrod.stl", "turned faces", ("--up", "0", "0", "1", "--direction", "-0.6", "1", "-0.7")),
    ("libigl__truck.obj", "open and turned parts", ()),
    ("trimesh__cycloidal.ply", "100 parts that cross", ()),
)


@table
def repair_pictures(folder, work=WORK, picture="out/evaluation/repair.png", resolution=256):
    """Ten meshes before and after, two pairs in a row, as `raymap info --picture` shows triangles and defects."""
    from PIL import Image, ImageDraw

    width, height, title, work = 360, 270, 18, pathlib.Path(work)
    work.mkdir(parents=True, exist_ok=True)
    sheet = Image.new("RGB", (4 * width, (len(SHOWN) + 1) // 2 * (height + title)), "white")
    for place, (name, wrong, options) in enumerate(SHOWN):
        result = work / (name + ".stl")
        if not result.exists():
            repaired(folder / name, result, "--resolution", resolution)
        left, top = place % 2 * 2 * width, place // 2 * (height + title)
        ImageDraw.Draw(sheet).text((left + 4, top + 3), f"{name}: {wrong}", fill="black")
        # A result shares the direction up of its mesh: STL alone has z up by default.
        up = () if "--up" in options else ("--up", "0", *(("0", "1") if name.lower().endswith(".stl") else ("1", "0")))
        for column, mesh in enumerate((folder / name, result)):  # Drawn at twice the size, for smooth edges.
            run(RAYMAP, "info", mesh, "--picture", work / "picture.png", "--overwrite", "--size", 2 * width, 2 * height, *up, *options)
            shown = Image.open(work / "picture.png").convert("RGB").resize((width, height), Image.LANCZOS)
            sheet.paste(shown, (left + column * width, top + title))
    sheet.save(picture, optimize=True)
