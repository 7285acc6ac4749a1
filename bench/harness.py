"""What the tables of bench/run.py share: their list and options, meshes, exact numbers, measured processes, Markdown."""

import argparse
import csv
import inspect
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

TABLES = {}
BUILD = pathlib.Path(os.environ.get("RAYMAP_BENCH_BUILD", pathlib.Path(__file__).parents[1] / "build/bench"))
RAYMAP = BUILD / "bin/raymap"


def table(function):
    """Lists a table. The function's parameters are its command line: without a default a path, else an option."""
    TABLES[function.__name__] = function
    return function


def add_option(parser, name, value):
    flag = "--" + name.replace("_", "-")
    if isinstance(value, bool):
        parser.add_argument(flag, action="store_true")
    elif isinstance(value, tuple):
        parser.add_argument(flag, type=type(value[0]) if value else str, nargs="+", default=value)
    else:
        parser.add_argument(flag, type=type(value), default=value, metavar="VALUE", help=f"default {value}")


def main():
    parser = argparse.ArgumentParser(description="Measures, and prints one of these tables as Markdown.")
    tables = parser.add_subparsers(dest="table", metavar="TABLE", required=True)
    for name, function in TABLES.items():
        about = inspect.getdoc(function)
        one = tables.add_parser(name, help=about.split("\n")[0].replace("%", "%%"), description=about.replace("%", "%%"),
                                formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
        for key, parameter in inspect.signature(function).parameters.items():
            if parameter.default is parameter.empty:
                one.add_argument(key, type=lambda text: pathlib.Path(text).resolve())
            else:
                add_option(one, key, parameter.default)
    given = vars(parser.parse_args())
    TABLES[given.pop("table")](**given)


# Tables.


def line(*cells):
    print("| " + " | ".join(map(str, cells)) + " |", flush=True)


def head(*titles):
    line(*titles)
    print("|" + "---|" * len(titles), flush=True)


def is_wanted(name, only):
    return any(text in name for text in only)


def mesh_rows(folder, only=("",), kind=None):
    """Returns the rows of the folder's MESHES.tsv that can be read, by column: names that contain one of `only`."""
    with open(folder / "MESHES.tsv", newline="") as file:
        rows = list(csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE))
    return [row for row in rows if (row["kind"] == kind if kind else row["kind"] != "malformed") and is_wanted(row["file"], only)]


def tabulate(rows, titles, measure, *arguments):
    """Prints a line for each mesh: `measure(row, *arguments)` returns the cells behind the name. Says why it failed."""
    head(*titles)
    for row in rows:
        try:
            line(row["file"], *measure(row, *arguments))
        except Exception as error:  # A mesh that cannot be measured does not end the table.
            line(row["file"], *[""] * (len(titles) - 2), (str(error).strip() or type(error).__name__).splitlines()[-1])


# Meshes as (vertices, faces), and fields.


def load(path):
    """Returns the mesh as the program reads it, without vertices that no face uses."""
    import raymap

    mesh = raymap.load_mesh(path)
    used, faces = np.unique(mesh.faces, return_inverse=True)
    return np.asarray(mesh.vertices, float)[used], faces.reshape(-1, 3).astype(np.int64)


def field(mesh, resolution, sign="harmonic", **options):
    """Returns a field made on the CPU, with its winding numbers."""
    import raymap

    options = {"orientation": "keep", "arrays": ("distance", "winding"), "device": "cpu", **options}
    return raymap.generate(*mesh, resolution=resolution, sign=sign, **options)


def positions(grid, index=None):
    """Returns the positions of all samples of a field, z fastest, or of those with the given indices (n, 3)."""
    index = np.indices(grid.shape).reshape(3, -1).T if index is None else index
    return np.asarray(grid.origin) + grid.spacing * index


def some_samples(grid, faces, budget, least=2000, seed=0):
    """Returns indices (n, 3) of random samples, so many that exact numbers visit `budget` triangles."""
    total = int(np.prod(grid.shape))
    count = min(total, max(least, int(budget / faces)))
    chosen = np.random.default_rng(seed).permutation(total)[:count] if count < total else np.arange(total)
    return np.stack(np.unravel_index(chosen, grid.shape), axis=1)


def at(values, index):
    return values[tuple(index.T)]


def inside(winding):
    return np.abs(winding) > 0.5


def exact_winding(mesh, points):
    import igl

    return igl.winding_number(*mesh, np.ascontiguousarray(points))


def exact_distance(mesh, points):
    import igl

    return np.sqrt(igl.point_mesh_squared_distance(np.ascontiguousarray(points), *mesh)[0])


def uniform_points(vertices, count, random, padding=0.1):
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    margin = padding * (high - low).max()
    return random.uniform(low - margin, high + margin, (count, 3))


def spread(mesh, count, random):
    """Returns points at random over the faces."""
    vertices, faces = mesh
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    which = random.choice(len(faces), count, p=areas / areas.sum())
    weights = random.dirichlet((1, 1, 1), count)
    return np.einsum("pc,pcx->px", weights, np.stack([a, b, c], axis=1)[which])


def near_points(mesh, count, random, share=1e-3):
    """Returns points at most this share of the diagonal from the surface."""
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    reach = share * np.linalg.norm(np.ptp(mesh[0], axis=0))
    return spread(mesh, count, random) + reach * random.random((count, 1)) * directions


# Costs.


def usage():
    """Returns wall seconds, CPU seconds and the peak in MB of this process."""
    own = resource.getrusage(resource.RUSAGE_SELF)
    # Not ru_maxrss, which includes the peak of the parent process.
    peak = re.search(r"VmHWM:\s*(\d+)", pathlib.Path("/proc/self/status").read_text())
    return time.monotonic(), own.ru_utime + own.ru_stime, int(peak[1]) / 1024


def measured(work):
    """Returns what a function returns and its cost: wall and CPU seconds, and the growth of the peak in MB."""
    pathlib.Path("/proc/self/clear_refs").write_text("5")  # Resets the peak.
    before = usage()
    values = work()
    after = usage()
    return values, {name: after[k] - before[k] for k, name in enumerate(("wall", "cpu", "megabytes"))}


def in_process(function, case, threads, limit=None):
    """Runs `function` of module `module:function` in a process of its own, which has no warm memory. It gets the arrays of
    the .npz `case` as keywords and returns arrays by name and the cost. Returns both, or raises RuntimeError."""
    environment = os.environ | {"OMP_NUM_THREADS": str(threads), "IGL_NUM_THREADS": str(threads)}
    with tempfile.NamedTemporaryFile(suffix=".npz") as result:
        command = [sys.executable, __file__, function, str(case), result.name, str(threads)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=limit, env=environment)
        except subprocess.TimeoutExpired:
            raise RuntimeError(f"not finished after {limit} s") from None
        if done.returncode != 0:
            raise RuntimeError((done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1])
        return dict(np.load(result.name)), json.loads(done.stdout.strip().splitlines()[-1])


def run_in_process(function, case, result, threads):
    """The other side of `in_process`."""
    module, _, name = function.partition(":")
    values, cost = getattr(__import__(module), name)(int(threads), **np.load(case))
    np.savez(result, **values)
    print(json.dumps(cost))


if __name__ == "__main__":
    run_in_process(*sys.argv[1:])
