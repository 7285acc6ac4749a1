#!/usr/bin/env python3
"""Checks the warnings of repairs by doing what they advise, and prints a table as Markdown.

Usage: bench/check_warnings.py RAYMAP FOLDER [--work FOLDER] [--samples 60000000]

Takes the warnings and the statistics that bench/evaluate_repair.py left in the work folder. Needs numpy, scipy and
trimesh."""
import argparse
import json
import math
import pathlib
import re
import subprocess

from evaluate_repair import part_volumes


class Trial:
    """Repairs one mesh again, with other options."""

    def __init__(self, raymap, mesh, work, found):
        self.raymap, self.mesh, self.work, self.found = raymap, mesh, work, found
        self.result = work / "warning.stl"

    def run(self, *options):
        """Returns the statistics of the repair."""
        stats = self.result.with_suffix(".json")
        grid = [] if "--voxel-size" in options else ["--resolution", max(self.found["grid"]["dims"])]
        command = [self.raymap, "repair", self.mesh, "-o", self.result, "--stats", stats, "--overwrite", "--device", "cpu",
                   "--remesh", *grid, *options]
        subprocess.run([str(word) for word in command], check=True, capture_output=True)
        return json.loads(stats.read_text())

    def samples(self, voxel_size):
        """Returns about how many samples a grid has."""
        return math.prod(n * self.found["grid"]["spacing"] / voxel_size for n in self.found["grid"]["dims"])


def share(value):
    return f"{100 * value:.3g} %"


def check_voxel_size(trial, most, size, kept="100"):
    """Compares the loss with what the size should keep, in %. Finer samples may find other losses: they get 5 % more."""
    if trial.samples(float(size)) > most:
        return None, f"not tried: {trial.samples(float(size)):.2g} samples"
    now = trial.run("--voxel-size", size)["loss"]["solid_share"]
    return now <= (1.05 - float(kept) / 100) * trial.found["loss"]["solid_share"], f"lost: {share(now)}"


def check_dropped(trial, count, largest):
    stats = trial.run("--drop-smaller", "0", "--tolerance", "0")
    volumes = [v for v in part_volumes(trial.result) if 0 < v < trial.found["drop_smaller"]]
    text = f"{len(volumes)} parts, the largest of {max(volumes):.3g}; {stats['dropped']['count']} dropped now"
    return len(volumes) == int(count) and math.isclose(max(volumes), float(largest), rel_tol=0.01), text


def check_filled(trial, count, largest):
    trial.run("--keep-cavities", "--tolerance", "0")
    cavities = [-v for v in part_volumes(trial.result) if v < 0]
    is_true = len(cavities) == int(count) and math.isclose(max(cavities), float(largest), rel_tol=0.01)
    return is_true, f"{len(cavities)} cavities, the largest of {max(cavities):.3g}"


def check_sheets(trial):
    thickness = 2.5 * trial.found["grid"]["spacing"]
    now = trial.run("--min-thickness", f"{thickness:.4g}")["loss"]["open_share"]
    return now < 0.1 * trial.found["loss"]["open_share"], f"with {thickness:.3g}: {share(now)} lost"


def check_unit(trial):
    now, before = trial.run("--unit", "mm"), trial.found["after"]
    (low, high), (low_before, high_before) = now["after"]["bounds"], before["bounds"]
    ratio = (high[0] - low[0]) / (high_before[0] - low_before[0])
    return math.isclose(ratio, 1000, rel_tol=0.01), f"{ratio:.4g} times as large"


def checks(most):
    """Returns a pattern and a check for each kind of warning."""
    number = r"([\d.e+-]+)"
    return (
        (rf"a voxel size of {number} keeps them", lambda t, size: check_voxel_size(t, most, size)),
        (rf"keeps all, {number} keeps {number} %", lambda t, *size: check_voxel_size(t, most, *size)),
        (r"fits into memory keeps them", lambda t: (None, "nothing is advised")),
        (rf"dropped ([\d,]+) parts?, the largest of volume {number}", check_dropped),
        (rf"filled (\d+) sealed cavit(?:y|ies), the largest of volume {number}", check_filled),
        (r"sheets and open surface are lost", check_sheets),
        (r"--unit mm converts them", check_unit),
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("raymap")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path("out/evaluation/repair"))
    parser.add_argument("--samples", type=float, default=6e7, help="largest grid to try")
    arguments = parser.parse_args()
    print("| mesh | warning | as advised | true |\n|---|---|---|---|")
    counts = {True: 0, False: 0, None: 0}
    for file in sorted(arguments.work.glob("*.evaluation.json")):
        name, evaluation = file.name.removesuffix(".evaluation.json"), json.loads(file.read_text())
        warnings = evaluation["warnings"]
        if "error" in evaluation or not warnings:
            continue
        found = json.loads((arguments.work / (name + ".stats.json")).read_text())
        trial = Trial(arguments.raymap, arguments.folder / name, arguments.work, found)
        for text in warnings:
            is_true, result = None, "no check"
            for pattern, check in checks(arguments.samples):
                if match := re.search(pattern, text):
                    is_true, result = check(trial, *(group.replace(",", "") for group in match.groups()))
                    break
            counts[is_true] += 1
            print(f"| {name} | {text} | {result} | {'–' if is_true is None else 'yes' if is_true else 'NO'} |", flush=True)
    print(f"\n{counts[True]} warnings are true, {counts[False]} are not, {counts[None]} were not tried.")


if __name__ == "__main__":
    main()
