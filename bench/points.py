"""Runs our methods and the peers in turn on the same points and prints a table in markdown.

Every run is a process of its own (see point_peers.cpp, and `peer` below). The table gives medians of several rounds.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np

import peers

MESHES = ("bunny", "million")
PLACES = ("uniform", "near")
# How many times less than the peer ours should take, by place.
REQUIRED = {"open3d": {"uniform": 10, "near": 4}, "igl": {"uniform": 10}, "embree": {"uniform": 3, "near": 3}}
OURS = ("raymap", "raymap_unsigned")
BYTES_PER_POINT, BYTES_PER_TRIANGLE, SMALL_CALL_MILLISECONDS = 100, 200, 1


def open3d(vertices, triangles, points, threads):
    """Returns what prepares the mesh, and what answers then: the sign comes from one ray."""
    import open3d

    vertices = open3d.core.Tensor(vertices.astype(np.float32))
    triangles = open3d.core.Tensor(triangles.astype(np.uint32))
    points = open3d.core.Tensor(points)
    scene = open3d.t.geometry.RaycastingScene(nthreads=threads)

    def prepare():
        scene.add_triangles(vertices, triangles)
        scene.compute_distance(points[:1])  # Builds the tree.

    return prepare, lambda: scene.compute_signed_distance(points, nthreads=threads, nsamples=1).numpy()


def igl(vertices, triangles, points, threads):
    """Does the same. libigl prepares and answers in one call, so everything counts as the query."""
    import igl as library

    points = points.astype(np.float64)
    kind = library.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    return lambda: None, lambda: library.signed_distance(points, vertices, triangles, kind)[0]


PEERS = {f.__name__: f for f in (open3d, igl)}


def run_peer(name, mesh, threads, output):
    """Runs one Python peer in this process, which ends then."""
    os.environ["IGL_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = str(threads)
    vertices, triangles = peers.read_mesh(mesh)
    points = np.fromfile(mesh + ".points", np.float32).reshape(-1, 3)
    prepare, query = PEERS[name](vertices, triangles, points, threads)
    pathlib.Path("/proc/self/clear_refs").write_text("5")  # Resets the peak.
    before = peers.usage()
    prepare()
    between = peers.usage()
    values = query()
    after = peers.usage()
    np.ascontiguousarray(values, np.float64).tofile(output)
    print(json.dumps({"prepare": between[1] - before[1], "query": after[1] - between[1], "wall": after[0] - before[0],
                      "bytes": (after[2] - before[2]) * 2**20}))


class Runner:
    def __init__(self, program, folder, threads):
        self.program, self.folder, self.threads = program, pathlib.Path(folder), str(threads)
        listed = subprocess.run([program, "list"], capture_output=True, text=True, check=True).stdout.split()
        self.methods = [*OURS, *(m for m in listed if m not in OURS), *(p for p in PEERS if peers.available(p))]

    def start(self, *arguments):
        finished = subprocess.run(arguments, capture_output=True, text=True)
        if finished.returncode != 0:
            raise RuntimeError(f"{' '.join(arguments)}: {finished.stderr.strip()[-300:]}")
        return json.loads(finished.stdout.strip().splitlines()[-1])

    def export(self, mesh, place, count):
        self.mesh, self.name = mesh, str(self.folder / mesh)
        return self.start(self.program, "export", "--mesh", mesh, "--place", place, "--count", str(count), "--output", self.name)

    def run(self, method):
        """Returns the cost of a run and its distances."""
        output = str(self.folder / "distances")
        if method in PEERS:
            command = [sys.executable, __file__, self.program, "--peer", method, "--mesh", self.name, "--output", output]
        else:
            command = [self.program, method, "--mesh", self.mesh, "--points", self.name + ".points", "--output", output]
        cost = self.start(*command, "--threads", self.threads)
        return cost, np.fromfile(output, np.float64)

    def small_call(self):
        return self.start(self.program, "small", "--mesh", self.mesh, "--points", self.name + ".points", "--threads", self.threads)


def print_row(method, place, case, runs, ours, other_signs, count, triangles):
    def median(what):
        return statistics.median(run[what] for run in runs)

    cpu = statistics.median(run["prepare"] + run["query"] for run in runs)
    required = REQUIRED.get(method, {}).get(place)
    aim = f"{required}, {'met' if cpu >= required * ours else 'missed'}" if required else ""
    prepare = "" if method == "igl" else f"{median('prepare'):.3f}"
    memory = ""
    if method == "raymap":
        limit = BYTES_PER_POINT * count + BYTES_PER_TRIANGLE * triangles
        memory = f"{median('bytes') / 1e6:.0f} of {limit / 1e6:.0f}"
    elif method == "raymap_unsigned":
        memory = f"{median('bytes') / 1e6:.0f}"
    signs = "" if method in OURS else f"{100 * other_signs:.3f} %"
    cells = [case, method, f"{cpu:.3f}", prepare, f"{median('query'):.3f}", "" if method in OURS else f"{cpu / ours:.1f}",
             aim, signs, memory]
    print("| " + " | ".join(cells) + " |", flush=True)


def run_case(runner, mesh, place, count, rounds):
    triangles = runner.export(mesh, place, count)["triangles"]
    costs = {method: [] for method in runner.methods}
    distances = {}
    for _ in range(rounds):
        for method, runs in costs.items():
            cost, distances[method] = runner.run(method)
            runs.append(cost)
    ours = statistics.median(run["prepare"] + run["query"] for run in costs["raymap"])
    for method, runs in costs.items():
        other_signs = np.mean((distances[method] < 0) != (distances["raymap"] < 0))
        print_row(method, place, f"{mesh}, {place}", runs, ours, other_signs, count, triangles)
    return statistics.median(runner.small_call()["wall"] for _ in range(rounds))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="the built program `point_peers`")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--count", type=int, default=1000000, help="number of points")
    parser.add_argument("--only", default="", help="only cases like `bunny uniform` whose name contains this")
    parser.add_argument("--peer", choices=PEERS, help="runs this peer here instead, on files that the program exported")
    parser.add_argument("--mesh", help="NAME of these files")
    parser.add_argument("--output", help="where the peer writes its distances")
    arguments = parser.parse_args()
    if arguments.peer:
        run_peer(arguments.peer, arguments.mesh, arguments.threads, arguments.output)
        return
    with tempfile.TemporaryDirectory(dir=os.path.dirname(os.path.abspath(arguments.program))) as folder:
        runner = Runner(arguments.program, folder, arguments.threads)
        print(f"CPU seconds for {arguments.count} points, medians of {arguments.rounds} runs on {arguments.threads} threads.\n")
        print("| mesh, points | method | CPU | to prepare | to query | CPU / ours | aim | other sign | MB, at most |")
        print("|---|---|---|---|---|---|---|---|---|")
        calls = []
        for mesh in MESHES:
            for place in PLACES:
                if arguments.only in f"{mesh} {place}":
                    calls.append((mesh, place, run_case(runner, mesh, place, arguments.count, arguments.rounds)))
        print(f"\n| one call of 1000 points | wall ms | at most {SMALL_CALL_MILLISECONDS} |\n|---|---|---|")
        for mesh, place, wall in calls:
            print(f"| {mesh}, {place} | {wall:.2f} | {'met' if wall <= SMALL_CALL_MILLISECONDS else 'missed'} |")
        missing = [p for p in PEERS if p not in runner.methods]
        if missing:
            print("\nNot installed, so left out: " + ", ".join(missing))


if __name__ == "__main__":
    main()
