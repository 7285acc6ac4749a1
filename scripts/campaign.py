#!/usr/bin/env python3
"""Runs every command of `raymap` that reads files on damaged files of every format, and prints tables of the results.

campaign.py RAYMAP [--runs N] [--first RUN] [--seed S]: the program, of any build. A run depends on S and its number alone:
`--first 17 --runs 1` repeats one, shows it, and leaves its files in out/campaign. A run fails if the command
- ends by a signal or a sanitizer, or with a code that no file causes;
- takes more than `SECONDS` of processor time, or needs more than `MEMORY`;
- ends with an error and does not print one line that says why, or the reverse;
- prints control characters, text that turns direction, bytes that are no UTF-8, or much of the file;
- leaves or changes a file although it fails, or another file than its outputs, or an output that cannot be read."""

import argparse
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unicodedata
from collections import defaultdict
from pathlib import Path

from damaged_files import SECRET, damaged

ROOT = Path(__file__).resolve().parents[1]
SECONDS, MEMORY = 60, 4 << 30
CODES = {0, 2, 3, 4, 5, 7}  # Exit codes of docs/cli.md that a file can cause. Lengths of a file decide which options make sense.
LONGEST_QUOTE = 80  # Characters of a name; messages quote 20 of other content.
BOX = "o box\n" + "".join(f"v {x} {y} {z}\n" for z in (0, 1) for y in (0, 1.5) for x in (0, 2))
FACES = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
TEXT_FBX = b"""; FBX 7.3.0 project file
FBXHeaderExtension: { FBXHeaderVersion: 1003
FBXVersion: 7300 }
Objects: { Geometry: 10, "Geometry::", "Mesh" { Vertices: *12 { a: 0,0,0,1,0,0,0,1,0,0,0,1 }
PolygonVertexIndex: *12 { a: 0,2,-2,0,1,-4,1,2,-4,2,0,-4 } }
Model: 20, "Model::t", "Mesh" { Version: 232 } }
Connections: { C: "OO",10,20
C: "OO",20,0 }
"""
MESHES, FIELDS = ["ply", "obj", "stl", "glb", "3mf"], ["nrrd", "npy", "npz", "vti", "vdb", "nvdb"]
CHOICES = {"field": FIELDS, "mesh": MESHES, "results": ["csv", "npz", "ply"], "n": [8, 16, 24], "band": [0, 2],
           "sign": ["harmonic", "exact", "paths", "evolution", "rays", "ray", "none"], "steps": ["paths", "evolution"],
           "distance": ["exact", "neighbours", "cell", "raster"]}
GRID = "--device cpu --resolution {n}"
ARRAYS = "--arrays distance,closest,triangle,barycentric,direction,winding,confidence"
# Commands for each kind of damaged file, in.EXT. Outputs have names of one letter; @ begins the name of a whole file.
COMMANDS = {
    "mesh": [
        "info {file} --picture o.png --size 64 48", "info {file} --json", "check {file}", "check {file} @mesh.ply --json",
        "generate {file} -o o.{field} --winding w.{field} --confidence c.nrrd --triangle-ids t.npz --stats s.json --report r.json "
        "--report-picture r.png " + GRID,
        "generate {file} -o o.{field} --sign {sign} --distance {distance} --band {band} " + GRID,
        "generate {file} -o o.vdb --voxel-size 0.05 --device cpu --memory-limit 200MB --band 3",
        "generate {file} -o o.npy --frames 0:0 " + GRID,
        "render {file} -o o.png --size 64 48 " + GRID, "render {file} -o o.html --max-size 12 " + GRID,
        "mesh {file} -o o.{mesh} " + GRID, "mesh {file} -o o.{mesh} --thickness 0.1 " + GRID,
        "repair {file} -o o.{mesh} --stats s.json " + GRID, "repair {file} -o o.{mesh} --shell 0.1 --remesh " + GRID,
        "simplify {file} -o o.{mesh} --triangles {n}", "simplify {file} -o o.{mesh} --tolerance 0.01",
        "convert {file} -o o.{mesh}", "convert {file} -o o.{mesh} --to in --up y --recenter",
        "query {file} @points.csv -o o.{results} " + ARRAYS, "sample {file} -o o.{results} -n 99 --normalize"],
    "field": [
        "info {file} --picture o.png --size 64 48", "info {file} --json", "convert {file} -o o.{field}",
        "convert {file} @field.vdb -o o.vdb", "convert {file} -o o.npz --half --scale 2", "mesh {file} -o o.{mesh}",
        "render {file} -o o.png --size 64 48 --device cpu", "render {file} -o o.png --slice x",
        "render {file} -o o.html --max-size 12", "query {file} @points.csv -o o.{results} --arrays distance,gradient",
        "compare {file} @field.npz -o o.png", "compare @field.npz {file} --json"],
    "points": ["query @mesh.ply {file} -o o.{results} " + ARRAYS, "query @mesh.ply {file} -o o.ply --colour",
               "query @field.npz {file} -o o.{results} --stats s.json"],
    "offsets": ["generate @mesh.ply -o o.npz --sign {steps} --offsets {file} " + GRID],
    "part": ["generate @mesh.ply -o o.npy --device cpu --resolution 160 --memory-limit 70MB"],
}


def make_seeds(run, folder):
    """Makes whole files. Returns the bytes of those to damage: {kind: {extension: [bytes]}}."""
    seeds = defaultdict(lambda: defaultdict(list))

    def add(kind, *paths):
        for path in paths:
            seeds[kind][path.suffix[1:]].append(path.read_bytes())

    for path in [*ROOT.glob("fuzz/seeds/read_*/*"), *ROOT.glob("tests/io/data/*.*b*"), ROOT / "tests/consumer/tetrahedron.dae"]:
        add("field" if path.suffix[1:] in FIELDS else "points" if path.suffix in (".csv", ".xyz") else "mesh", path)
    seeds["mesh"]["fbx"].append(TEXT_FBX)
    (folder / "box.obj").write_text(BOX + FACES)
    for extension in MESHES:
        run(f"convert box.obj -o mesh.{extension}")
        run(f"mesh box.obj -o surface.{extension} --resolution 10 --tolerance 0 --device cpu")
    for extension in FIELDS:
        run(f"generate box.obj -o field.{extension} --winding w.{extension} --triangle-ids t.{extension} --resolution 12 --device cpu")
        run(f"generate box.obj -o band.{extension} --resolution 20 --band 2 --device cpu")
    run("sample mesh.ply -o points.csv -n 40")
    for extension in ("npy", "ply"):
        run(f"query mesh.ply points.csv -o points.{extension} --arrays closest")
    (folder / "points.txt").write_text("# x y z\n" + "0.5 1 nan\n1e3 -2 .25\n" * 5)
    add("points", *folder.glob("points.*"))
    add("mesh", *folder.glob("mesh.*"), *folder.glob("surface.*"))
    add("field", *(path for name in ("field", "band", "w", "t") for path in folder.glob(name + ".*")))
    seeds["offsets"]["txt"].append(b"# x y z\n1 2 3\n-4 5 -6\n\n7 -8 9 # last\n")
    seeds["part"]["done"].append(b"raymap-part 1234567890 16 262144\n")
    for extensions in seeds.values():
        for files in extensions.values():
            files.sort()
    return seeds


def limit():
    resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS + 5))
    if "asan" not in PROGRAM:  # A sanitizer reserves terabytes.
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


def execute(words, folder):
    """Runs the program. Returns its exit code (negative: a signal), stdout and stderr, seconds and peak memory."""
    environment = {**os.environ, "TMPDIR": str(folder / "tmp"), "RAYMAP_CACHE": "off", "RAYMAP_THREADS": "1",
                   "ASAN_OPTIONS": "exitcode=99:hard_rss_limit_mb=8000", "UBSAN_OPTIONS": "exitcode=99"}
    with open(folder / "out", "w+b") as out, open(folder / "err", "w+b") as err:
        child = subprocess.Popen([PROGRAM, *words], cwd=folder / "work", env=environment, preexec_fn=limit,
                                 stdin=subprocess.DEVNULL, stdout=out, stderr=err)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
    return (child.returncode, (folder / "out").read_bytes(), (folder / "err").read_bytes(), usage.ru_utime + usage.ru_stime,
            usage.ru_maxrss << 10)


def text_faults(text):
    turns = ("RLO", "LRO", "RLE", "LRE", "RLI", "FSI", "LRI", "PDI", "PDF")
    odd = {c for c in text if c != "\n" and (unicodedata.category(c) in ("Cc", "Zl", "Zp") or unicodedata.bidirectional(c) in turns)}
    odd |= {c for c in text if 0xdc80 <= ord(c) <= 0xdcff}  # No UTF-8.
    quoted = any(text[k:k + LONGEST_QUOTE + 1] in SECRET for k in range(len(text) - LONGEST_QUOTE))
    return [f"prints {sorted(odd)}"] * bool(odd) + ["prints much of the file"] * quoted


def output_faults(words, code, before, after, folder):
    """Returns what is wrong with the files that a run leaves."""
    outputs = {word for word in words if re.fullmatch(r"[a-z]\.[a-z0-9]+", word)}
    if code not in (0, 11):
        changed = [name for name in after | before if after.get(name) != before.get(name)]
        return [f"leaves or changes {changed}"] * bool(changed)
    faults = [f"leaves {sorted(after.keys() - before.keys() - outputs)}"] * bool(after.keys() - before.keys() - outputs)
    for name in outputs:
        if after.get(name, b"") in (b"", b"old"):
            faults.append(f"does not write {name}")
        elif name[0] == "o" and name.split(".")[1] in MESHES + FIELDS and words[0] not in ("query", "sample"):
            again = execute(["info", "--fast", name], folder)
            faults += [f"writes {name}, but {again[2][:200]}"] * (again[0] != 0 and b"it has no triangles" not in again[2])
    return faults


def run_one(number, seed, seeds, folder):
    """Returns the extension, the command, its results (code, stdout, stderr, seconds, memory), the size and the faults."""
    at, work = random.Random(f"{seed}/{number}"), folder / "work"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir()
    kind, extension, data = damaged(seeds, at)
    name = "o.npy.part.done" if kind == "part" else f"in.{extension}"
    (work / name).write_bytes(data)
    if kind == "part":
        (work / "o.npy.part").write_bytes(bytes(at.choice([0, 300_000])))
    line = at.choice(COMMANDS[kind]).format(file=name, **{key: at.choice(values) for key, values in CHOICES.items()})
    words = line.replace("@", "../whole/").split()
    if at.random() < 0.5:
        for output in re.findall(r"\b[a-z]\.[a-z0-9]+\b(?!\.)", line):
            (work / output).write_bytes(b"old")

    def files():
        return {p.name: p.read_bytes() for p in work.iterdir() if ".part" not in p.name}
    before = files()
    result = code, out, err, seconds, peak = execute(words, folder)
    texts = (out + err).decode(errors="surrogateescape")
    faults = text_faults(texts) + output_faults(words, code, before, files(), folder)
    errors = len(re.findall(r"^raymap: error: ", texts, re.MULTILINE))
    if code in (-signal.SIGXCPU, 152):
        faults.append("hangs")
    elif code < 0 or code not in CODES | ({11} if words[0] == "check" else set()):
        faults.append(f"ends with {code}")
    if words[0] != "check" and errors != (code != 0) or (code != 0 and not err and code != 11):
        faults.append(f"prints {errors} errors and ends with {code}")
    if "runtime error" in texts or "Sanitizer" in texts:
        faults.append("sanitizer")
    return extension, line, result, len(data), faults + ["leaves files in TMPDIR"] * any((folder / "tmp").iterdir())


def print_table(title, groups):
    print(f"\n| {title} | runs | done | refused | signals | hangs | other faults | most memory, MB | most time, s |\n|---|" + "---|" * 8)
    for name, runs in [*sorted(groups.items()), ("all", [run for runs in groups.values() for run in runs])]:
        codes, faults = [result[0] for result, _ in runs], [faults for _, faults in runs]
        signals, hangs = sum(code < 0 and code != -signal.SIGXCPU for code in codes), sum("hangs" in each for each in faults)
        print(f"| {name} | {len(runs)} | {sum(c in (0, 11) for c in codes)} | {sum(c not in (0, 11) and c >= 0 for c in codes)} "
              f"| {signals} | {hangs} | {sum(map(bool, faults)) - signals - hangs} | {max(r[4] for r, _ in runs) >> 20} "
              f"| {max(r[3] for r, _ in runs):.1f} |")


parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("raymap", type=lambda path: str(Path(path).resolve()))
for option, default in ("--runs", 5000), ("--first", 0), ("--seed", 1):
    parser.add_argument(option, type=int, default=default)
options = parser.parse_args()
PROGRAM = options.raymap
with tempfile.TemporaryDirectory() as name:
    folder = Path(name)
    for part in ("tmp", "whole"):
        (folder / part).mkdir()
    seeds = make_seeds(lambda line: subprocess.run([PROGRAM, *line.split()], cwd=folder / "whole", check=True, stdout=subprocess.DEVNULL),
                       folder / "whole")
    formats, commands, largest, faulty = defaultdict(list), defaultdict(list), [], 0
    for number in range(options.first, options.first + options.runs):
        extension, line, result, size, faults = run_one(number, options.seed, seeds, folder)
        formats[extension].append((result, faults))
        commands[line.split()[0]].append((result, faults))
        summary = f"{number}: {line} ({size} bytes): {result[0]}, {result[3]:.2f} s, {result[4] >> 20} MB"
        largest.append((result[4], summary))
        faulty += bool(faults)
        if faults or options.runs == 1:
            print(f"{summary}: {'; '.join(faults)}\n    {result[2][-500:]}", flush=True)
    if options.runs == 1:
        shutil.copytree(folder / "work", ROOT / "out/campaign", dirs_exist_ok=True)
    print_table("format", formats)
    print_table("command", commands)
    print("\nMost memory:", *(summary for _, summary in sorted(largest, reverse=True)[:5]), sep="\n- ")
    print(f"\n{options.runs} runs, {faulty} with faults")
sys.exit(faulty > 0)
