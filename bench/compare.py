"""Runs our methods and the peers in turn on the same samples and prints markdown tables.

Every run is a process of its own (see peers.cpp, peers.py). The table gives medians of several rounds. In each round all
methods of a case run once, ours last.
"""

import argparse
import json
import math
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

import numpy as np

# Title, our method, mesh, resolution, band, {peer: required ratio or None}
CASES = [
    ("distance and sign", "raymap", mesh, resolution, 0,
     {"embree": 8 if resolution == 50 else 15, "openvdb": None,
      **({"igl_signed_distance": None, "open3d": None, "mesh2sdf": None} if mesh == "bunny" and resolution < 256 else {})})
    for mesh in ("bunny", "million") for resolution in (50, 128, 256)
] + [
    ("band of 3 samples", "raymap", "bunny", 256, 3, {"openvdb": 2}),
    ("band of 3 samples", "raymap", "million", 256, 3, {"openvdb": 2}),
    ("winding number alone", "raymap_winding", "holes", 128, 0, {"igl_winding": None}),
    ("winding number alone", "raymap_winding", "holes", 256, 0, {"igl_winding": 10}),
]
THREAD_CASES = [("bunny", 128), ("bunny", 256), ("million", 256)]
WALL_SHARE = 0.6


class Runner:
    def __init__(self, program, folder):
        self.program = program
        self.folder = pathlib.Path(folder)
        self.script = pathlib.Path(__file__).with_name("peers.py")
        self.programs = {}  # Method -> command that starts it.
        self.missing = set()
        for start in ([program], [sys.executable, str(self.script)]):
            listed = subprocess.run([*start, "list"], capture_output=True, text=True, check=True)
            self.programs.update({method: start for method in listed.stdout.split()})

    def run(self, method, mesh, resolution, threads, band=0):
        """Returns the cost of a run and its samples, read from the file that it wrote."""
        output = self.folder / "samples"
        command = [*self.programs[method], method, "--threads", str(threads), "--output", str(output)]
        if self.programs[method][0] == self.program:
            command += ["--mesh", mesh, "--resolution", str(resolution), "--band", str(band)]
        else:
            command += ["--mesh", str(self.folder / mesh), "--case", self.export(mesh, resolution)]
        finished = subprocess.run(command, capture_output=True, text=True)
        if finished.returncode != 0:
            raise RuntimeError(f"{method} on {mesh}: {finished.stderr.strip()[-300:]}")
        return json.loads(finished.stdout), np.fromfile(output, np.float32)

    def export(self, mesh, resolution):
        command = [self.program, "export", "--mesh", mesh, "--resolution", str(resolution)]
        exported = subprocess.run([*command, "--output", str(self.folder / mesh)], capture_output=True, text=True, check=True)
        return exported.stdout.strip()


def difference(kind, ours, theirs, spacing):
    """Returns the largest difference (distances without their sign, in samples) and the share of other signs."""
    if kind == "raymap_winding":
        return abs(ours - theirs).max(), ((abs(ours) > 0.5) != (abs(theirs) > 0.5)).mean()
    return abs(abs(ours) - abs(theirs)).max() / spacing, ((ours < 0) != (theirs < 0)).mean()


def run_case(runner, case, threads, rounds):
    title, our_method, mesh, resolution, band, peers = case
    report, ours = runner.run(our_method, mesh, resolution, threads, band)
    # Band that OpenVDB needs to reach the farthest sample.
    wide = band or math.ceil(abs(ours).max() / report["spacing"]) + 1
    costs = {our_method: []}
    differences = {}
    for _ in range(rounds):
        for peer in peers:
            if peer not in runner.programs:
                runner.missing.add(peer)
                continue
            cost, theirs = runner.run(peer, mesh, resolution, threads, wide)
            costs.setdefault(peer, []).append(cost)
            differences[peer] = difference(our_method, ours, theirs, report["spacing"])
        costs[our_method].append(runner.run(our_method, mesh, resolution, threads, band)[0])
    print_case(title, mesh, report, our_method, peers, costs, differences)


def median(costs, key):
    return statistics.median(cost[key] for cost in costs)


def print_case(title, mesh, report, our_method, peers, costs, differences):
    ours = median(costs[our_method], "cpu")
    grid = "x".join(map(str, report["dims"]))
    for method, runs in costs.items():
        cpu = median(runs, "cpu")
        cells = [title, f"{mesh}, {report['triangles']}", grid, method, f"{cpu:.3f}", f"{median(runs, 'wall'):.3f}",
                 f"{median(runs, 'megabytes'):.0f}"]
        if method == our_method:
            cells += ["", "", "", ""]
        else:
            required = peers[method]
            verdict = f"{required} {'met' if cpu >= required * ours else 'MISSED'}" if required else ""
            largest, signs = differences[method]
            cells += [f"{cpu / ours:.1f}", verdict, f"{largest:.2g}", f"{100 * signs:.3f} %"]
        print("| " + " | ".join(cells) + " |", flush=True)


def run_threads(runner, rounds):
    print("\n| mesh | resolution | wall 1 thread | wall 2 threads | share | at most |\n|---|---|---|---|---|---|")
    for mesh, resolution in THREAD_CASES:
        costs = {1: [], 2: []}
        for _ in range(rounds):
            for threads, runs in costs.items():
                runs.append(runner.run("raymap", mesh, resolution, threads)[0])
        one, two = (median(costs[threads], "wall") for threads in (1, 2))
        verdict = "met" if two <= WALL_SHARE * one else "MISSED"
        print(f"| {mesh} | {resolution} | {one:.3f} | {two:.3f} | {two / one:.2f} | {WALL_SHARE} {verdict} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("program", help="the built program `peers`")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--only", default="", help="only cases whose mesh, method or resolution contains this")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=os.path.dirname(os.path.abspath(arguments.program))) as folder:
        runner = Runner(arguments.program, folder)
        print(f"CPU and wall in seconds, medians of {arguments.rounds}, {arguments.threads} threads; MB is what the peak "
              "grew by; |d| is the largest difference to ours in samples (of the winding number itself in its rows).\n")
        print("| what | mesh, triangles | samples | method | CPU | wall | MB | CPU / ours | required | \\|d\\| | other sign |")
        print("|---|---|---|---|---|---|---|---|---|---|---|")
        for case in CASES:
            if any(arguments.only in str(part) for part in case[:4]):
                run_case(runner, case, arguments.threads, arguments.rounds)
        run_threads(runner, arguments.rounds)
        if runner.missing:
            print("\nNot installed, so left out: " + ", ".join(sorted(runner.missing)))


if __name__ == "__main__":
    main()
