#!/usr/bin/env python3
"""Breaks closed meshes in known ways, and measures what Raymap and other packages make of them: docs/wild.md.

The truth is that of the closed mesh. Every case runs in a process of its own. Results lie in --out, a file for each package:
a run that was stopped goes on there."""

import argparse
import collections
import concurrent.futures
import importlib.metadata
import json
import multiprocessing
import os
import pathlib
import re
import resource
import signal
import statistics
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.append(str(ROOT / "bench"))
os.environ |= {name: "1" for name in ("OMP_NUM_THREADS", "IGL_NUM_THREADS", "RAYMAP_THREADS")}
import wild_meshes  # noqa: E402
import wild_peers  # noqa: E402
from harness import exact_distance, exact_winding, measured, positions, spread  # noqa: E402

PACKAGES = ("libigl", "open3d-cpu", "trimesh", "pysdf", "mesh2sdf", "point-cloud-utils", "warp-lang", "meshlib", "trueform", "pymeshfix",
            "manifold3d", "numpy")  # fmt: skip
SECONDS, CHUNK = 30, 11  # Limit of CPU time of a case; cases until results are saved.
SLOW = {("repairs", "meshlib_rebuild"): 3}  # It gets a third of the cases.
TOLERANCE = 0.002  # Of the diagonal: farther from the result, a point of the surface is lost.
# Largest shares of wrong signs near the surface in a case of --quick. With "nested" the file says that the cavity is solid,
# and with "missing" it does not say where the surface was.
WORST_SIGN, AMBIGUOUS = 0.05, {"nested": 0.15, "missing": 0.15}
QUICK = ("ball", "ring", "drop", "shells")  # Meshes of --quick, whose repairs are cheap.
Grid = collections.namedtuple("Grid", "shape spacing origin")


def isolated(work, seconds=None):
    """Returns "ok" and what a function returns in a forked process, or "refused", "crash" or "hang" and a text.

    Limits the CPU time, and the time by the clock to ten times as much."""

    def answer():
        try:
            if seconds:
                resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 5))
            theirs.send(("ok", work()))
        except BaseException as error:  # Also SystemExit.
            theirs.send(("refused", f"{type(error).__name__}: {error}"[:300]))
        os._exit(0)

    ours, theirs = multiprocessing.Pipe(False)
    child = multiprocessing.get_context("fork").Process(target=answer)
    child.start()
    theirs.close()
    try:
        if ours.poll(10 * seconds if seconds else None):
            return ours.recv()
        child.kill()
    except EOFError:
        child.join()
        if child.exitcode != -signal.SIGXCPU:
            return "crash", f"signal {-child.exitcode}"
    finally:
        child.join()
    return "hang", f"over {seconds} s"


class Case:
    """A mesh, the way to break it, and a seed. The truth is that of the closed mesh, with a cavity if that breaks."""

    closed, hollow = {}, {}

    def __init__(self, mesh, way, seed):
        self.mesh, self.way, self.seed, self.key = mesh, way, seed, (mesh, way == "nested")

    def truth(self):
        if self.key not in self.closed:
            self.closed[self.key], self.hollow[self.mesh] = wild_meshes.with_cavity(self.closed[self.mesh, False])
        return self.closed[self.key]

    def broken(self):
        mesh = self.truth()
        if self.way == "unbroken":
            return *mesh, np.ones(len(mesh[1]), bool), 0.0
        return wild_meshes.broken(mesh, self.way, self.seed, self.hollow.get(self.mesh))


def field_truth(case, resolution, known={}):  # noqa: B006
    """Returns the grid of a closed mesh, the distances of its samples and which are inside."""
    import igl

    if case.key not in known:
        vertices, faces = case.truth()
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        spacing = 1.2 * (high - low).max() / resolution
        grid = Grid((resolution,) * 3, spacing, (low + high) / 2 - spacing * (resolution - 1) / 2)
        where = np.ascontiguousarray(positions(grid))
        distance = exact_distance((vertices, faces), where)
        inside, near = igl.fast_winding_number(vertices, faces, where) > 0.5, distance < 2 * spacing
        inside[near] = exact_winding((vertices, faces), where[near]) > 0.5  # Farther away the fast one is exact enough.
        known[case.key] = grid, distance, inside
    return known[case.key]


def prepare_field(case, resolution):
    """Keeps the broken mesh, and which samples are as far from it as from the closed one."""
    grid, distance, _ = field_truth(case, resolution)
    case.given = case.broken()
    case.same = np.abs(exact_distance(case.given[:2], positions(grid)) - distance) < 1e-3 * grid.spacing


def measure_field(case, run, resolution):
    """Returns the shares of wrong signs, errors of distance in voxels and the cost.

    Signs count farther from the closed surface than the break moved it, and 0.05 voxels. Errors count where the broken
    surface is as far away as the closed one."""
    grid, distance, inside = field_truth(case, resolution)
    vertices, faces, _, moved = case.given
    values, cost = measured(lambda: run(vertices, faces, grid))
    is_known = np.isfinite(values)
    is_clear = is_known & (distance > max(2 * moved, 0.05 * grid.spacing))
    wrong, near, same = (values < 0) != inside, is_clear & (distance < 2 * grid.spacing), is_known & case.same
    errors = np.abs(np.abs(values[same]) - distance[same]) / grid.spacing
    return {"wrong": wrong[is_clear].mean(), "near": wrong[near].mean() if near.any() else None, "cpu": cost["cpu"],
            "megabytes": cost["megabytes"], **({"mean": errors.mean(), "max": errors.max()} if len(errors) else {})}  # fmt: skip


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] - vertices.mean(axis=0) for k in range(3))
    return np.einsum("fi,fi->", a, np.cross(b, c)) / 6


def is_watertight(faces):
    """Returns whether each edge has two faces, which pass it in opposite directions."""
    edges = np.concatenate([faces[:, [k, (k + 1) % 3]] for k in range(3)])
    ways = np.unique(edges, axis=0)
    return len(ways) == len(edges) and np.array_equal(ways, np.unique(edges[:, ::-1], axis=0))


def face_keys(triangles):
    """Returns the single precision bits of each face, as bytes that begin with its least corner."""
    corners = (triangles + 0.0).astype(np.float32)
    return [np.roll(face, -min(range(3), key=lambda k: tuple(face[k])), axis=0).tobytes() for face in corners]  # noqa: B023


def judge_repair(case, vertices, faces, said):
    """Returns what a repaired mesh is worth beside the closed one."""
    truth, (given, given_faces, sound, moved) = case.truth(), case.broken()
    faces, vertices = np.asarray(faces, np.int64).reshape(-1, 3), np.asarray(vertices, float)
    if not len(faces):
        return {"empty": True}
    diagonal = np.linalg.norm(np.ptp(truth[0], axis=0))
    points = spread(truth, 2000, np.random.default_rng(case.seed))
    is_given = exact_distance((given, given_faces), points) <= 1e-4 * diagonal + moved
    lost = np.mean(is_given & (exact_distance((vertices, faces), points) > TOLERANCE * diagonal + moved))
    whole, tight = face_keys(truth[0][truth[1]][sound]), is_watertight(faces)
    return {"empty": False, "watertight": tight, "lost": lost, "unsaid": None if said is None else max(0, lost - said),
            "kept": len(set(whole) & set(face_keys(vertices[faces]))) / len(whole) if whole else None,
            "volume": abs(volume(vertices, faces) / volume(*truth) - 1) if tight else None}  # fmt: skip


def measure_repair(case, run, _):
    vertices, faces, *_ = case.broken()
    (*result, said), cost = measured(lambda: run(vertices, faces))
    programs = resource.getrusage(resource.RUSAGE_CHILDREN)
    return judge_repair(case, *result, said) | cost | {"cpu": cost["cpu"] + programs.ru_utime + programs.ru_stime}


def measure_cases(kind, name, cases, resolution):
    """Imports a peer, and returns a row for each case."""
    run, measure, rows = wild_peers.peers(kind)[name](), measure_field if kind == "fields" else measure_repair, []
    for case in cases:
        state, found = isolated(lambda: measure(case, run, resolution), SECONDS)  # noqa: B023
        row = {"mesh": case.mesh, "way": case.way, "seed": case.seed, "state": state}
        rows.append(row | ({k: v if v is None else float(v) for k, v in found.items()} if state == "ok" else {"text": found}))
    return rows


def all_cases(kind, seed, count):
    """Fields: each mesh as it is, and broken in each way. Repairs: so many breakages; each pair of mesh and way in turn."""
    names, ways = [name for name, is_hollow in Case.closed if not is_hollow], list(wild_meshes.WAYS)
    if kind == "fields":
        return [Case(name, way, seed) for name in names for way in ("unbroken", *ways)]
    pairs = [(name, way) for name in names for way in ways]
    order = np.random.default_rng(seed).permutation(len(pairs))
    return [Case(*pairs[order[k % len(pairs)]], 10**6 * seed + k) for k in range(count)]


def run_all(options, kinds=("fields", "repairs"), peers=None):
    """Runs what no file of results has yet. Returns the rows by kind, seed and peer."""
    jobs = []
    Case.closed = {(name, False): mesh for name, mesh in wild_meshes.closed_meshes(options.meshes).items()}
    for kind, seed in ((kind, seed) for kind in kinds for seed in options.seeds):
        cases = all_cases(kind, seed, options.repairs)
        for case in cases:
            case.truth() if kind == "repairs" else prepare_field(case, options.resolution)
        jobs += [(kind, seed, name, cases) for name in wild_peers.peers(kind) if name in (peers or [name])]

    def work(job):
        kind, seed, name, cases = job
        cases = cases[: len(cases) // SLOW.get((kind, name), 1)]
        file = options.out / f"{kind}_{options.resolution if kind == 'fields' else 'all'}_{seed}_{name}.json" if options.out else None
        rows = json.loads(file.read_text()) if file and file.exists() else []
        for begin in range(len(rows), len(cases), CHUNK):
            state, more = isolated(lambda: measure_cases(kind, name, cases[begin : begin + CHUNK], options.resolution))  # noqa: B023
            if state != "ok":
                return [{"state": "missing", "text": more}]
            rows += more
            if file:
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(json.dumps(rows))
        print(f"{kind} {seed} {name}: {collections.Counter(row['state'] for row in rows)}", file=sys.stderr, flush=True)
        return rows[: len(cases)]

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        return {job[:3]: rows for job, rows in zip(jobs, pool.map(work, jobs), strict=True)}


def faults(kind, row, worst_sign=1.0):
    """Returns what must not happen to Raymap in a case."""
    if row["state"] != "ok":
        return [f"{row['state']}: {row['text']}"] * (kind == "fields" or row["state"] != "refused")
    if kind == "fields":
        return [f"{100 * row['near']:.1f} % wrong signs near the surface"] * bool((row["near"] or 0) > worst_sign)
    if row["empty"]:
        return ["empty"]
    return ["not watertight"] * (not row["watertight"]) + [f"lost {100 * row['unsaid']:.1f} % unsaid"] * bool(row["unsaid"] > 0.01)


def quick(options):
    """Measures Raymap on few cases. Returns the number of faults."""
    rows = [(kind, row) for (kind, *_), rows in run_all(options, peers=("raymap",)).items() for row in rows]
    near = [row["near"] for _, row in rows if row.get("near") is not None and row["way"] not in AMBIGUOUS]
    problems = [f"{kind}: {row['mesh']}, {row['way']}, {row['seed']}: {text}" for kind, row in rows
                for text in faults(kind, row, AMBIGUOUS.get(row["way"], WORST_SIGN))]  # fmt: skip
    print(*problems, sep="\n")
    print(f"{len(rows)} cases, {len(problems)} faults; {100 * statistics.mean(near):.3f} % wrong signs near the surface")
    return len(problems)


def fold(key, form, how=statistics.mean):
    """Returns a function that gives the mean of what rows have under a key, or what `how` makes of it, as text."""

    def cell(rows):
        values = [row[key] for row in rows if row.get(key) is not None]
        return form.format(how(values)).rstrip("%") if values else "–"

    return cell


def share(test):
    return lambda rows: f"{100 * sum(bool(test(row)) for row in rows) / len(rows):.1f}"


def count(test):
    return lambda rows: sum(bool(test(row)) for row in rows)


def unsaid(row):
    """Returns the lost area that the report does not name. Without a report nothing is said."""
    return row.get("lost") or 0 if row.get("unsaid") is None else row["unsaid"]


COLUMNS = {
    "fields": {
        "wrong signs, %": fold("wrong", "{:.3%}"), "near, %": fold("near", "{:.2%}"), "worst case, %": fold("near", "{:.1%}", max),
        "error, voxels": fold("mean", "{:.1g}"), "largest": fold("max", "{:.1g}", max), "CPU s": fold("cpu", "{:.3f}"),
        "MB, most": fold("megabytes", "{:.0f}", max), "no result": count(lambda row: row["state"] != "ok")},
    "repairs": {
        "cases": len, "watertight, %": share(lambda row: row.get("watertight")), "refused, %": share(lambda row: row["state"] == "refused"),
        "crash, hang": count(lambda row: row["state"] in ("crash", "hang")), "empty": count(lambda row: row.get("empty")),
        "area lost, %": fold("lost", "{:.2%}"), "over 1 % lost": count(lambda row: (row.get("lost") or 0) > 0.01),
        "unsaid": count(lambda row: unsaid(row) > 0.01), "volume off, median %": fold("volume", "{:.3%}", statistics.median),
        "mean %": fold("volume", "{:.1%}"), "sound faces kept, %": fold("kept", "{:.1%}"), "CPU s": fold("cpu", "{:.2f}")},
}  # fmt: skip


def table(titles, rows):
    return "\n".join("| " + " | ".join(map(str, row)) + " |" for row in (titles, ["---"] * len(titles), *rows))


def tables(found, options):
    """Yields the name and the text of each table. A cell has the value of each seed; by break, that of all seeds."""
    for kind, columns in COLUMNS.items():
        runs = {name: [found[kind, seed, name] for seed in options.seeds] for name in wild_peers.peers(kind)
                if found.get((kind, options.seeds[0], name), [{"state": "missing"}])[0]["state"] != "missing"}  # fmt: skip
        rows = [[name, *(", ".join(str(cell(each)) for each in seeds) for cell in columns.values())] for name, seeds in runs.items()]
        yield kind, table(["package", *columns], rows)
        if kind == "fields":
            near, every = fold("near", "{:.2%}"), {name: [row for rows in seeds for row in rows] for name, seeds in runs.items()}
            rows = [[way, *(near([row for row in rows if row["way"] == way]) for rows in every.values())]
                    for way in ("unbroken", *wild_meshes.WAYS)]  # fmt: skip
            yield "fields by break", table(["break", *runs], rows)
    meshes = ", ".join(f"{name} ({len(mesh[1]):,})" for (name, is_hollow), mesh in Case.closed.items() if not is_hollow)
    cpu = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())[1]
    seeds, number = " ".join(map(str, options.seeds)), len(found["fields", options.seeds[0], "raymap"])
    versions = {each.metadata["Name"]: each.version for each in importlib.metadata.distributions()}
    yield "setting", table(["command", f"`scripts/wild.py --seeds {seeds} --resolution {options.resolution} --repairs {options.repairs}`: {number} fields "
                            f"of {options.resolution}³ samples and {options.repairs} repairs for each seed"],
                           [["meshes, faces", meshes], ["machine", f"{os.cpu_count()} cores, {cpu}; Python {sys.version.split()[0]}"],
                            ["versions", ", ".join(f"{name} {versions.get(name, 'missing')}" for name in PACKAGES)]])  # fmt: skip


def write(page, found, options):
    """Replaces what stands between the page's markers of each table."""
    text = page.read_text()
    for name, content in tables(found, options):
        begin, end = f"<!-- {name} -->", f"<!-- end of {name} -->"
        if begin not in text or end not in text:
            sys.exit(f"{page} lacks the markers of {name}")
        text = text[: text.index(begin) + len(begin)] + "\n\n" + content + "\n" + text[text.index(end) :]
    page.write_text(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", type=pathlib.Path, metavar="PAGE", help="write the tables between the markers of this page")
    parser.add_argument("--quick", action="store_true", help="few cases, and Raymap alone")
    parser.add_argument("--check", action="store_true", help="with --quick: fail at a fault")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out/wild", help="folder of results")
    parser.add_argument("--only", nargs="+", metavar="PEER", help="only these packages")
    parser.add_argument("--kinds", nargs="+", default=["fields", "repairs"], choices=["fields", "repairs"])
    parser.add_argument("--meshes", nargs="+", help="only these")
    parser.add_argument("--seeds", nargs="+", type=int, default=[1, 2])
    for name, value in ("repairs", 1000), ("resolution", 32), ("jobs", 2):
        parser.add_argument(f"--{name}", type=int, default=value, help=f"default {value}")
    options = parser.parse_args()
    if options.quick:
        options.seeds, options.repairs, options.resolution, options.out, options.meshes = [1], 14, 24, None, QUICK
        return 1 if quick(options) and options.check else 0
    found = run_all(options, options.kinds, options.only)
    if options.write:
        write(options.write, found, options)
    return 0


if __name__ == "__main__":
    sys.exit(main())
