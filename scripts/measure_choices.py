#!/usr/bin/env python3
"""Measures the commands of docs/choose.md, and writes the columns behind their formats.

measure_choices.py RAYMAP: the program. The seconds are those of the CPU, medians of three runs."""

import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

PAGE = Path(__file__).resolve().parent.parent / "docs/choose.md"
ROW = re.compile(r"^(\| [^|]* \| `(raymap [^`]*)` \| [^|]* \|).*$", re.MULTILINE)
RUNS = 3


def run(command):
    """Runs a command. Returns its CPU seconds, its most memory in MB, and what it prints."""
    process = subprocess.Popen(command.split(), stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    printed = process.stdout.read()
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit(f"failed: {command}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024 / 1e6, printed


def cells(command):
    """Returns the grid, CPU seconds, MB of memory, MB of the file and the thinnest wall of a command."""
    took, memory, _ = zip(*(run(f"{command} --quiet") for _ in range(RUNS)))
    file = Path(re.search(r"(?:-o|--picture) (\S+)", command)[1])
    measured = f"{statistics.median(took):.2g}", f"{max(memory):.0f}", f"{float(f'{file.stat().st_size / 1e6:.2g}'):g}"
    grid = wall = "–"
    if re.match("raymap (generate|mesh|repair)", command):
        figures = json.loads(run(f"{command} --json --quiet")[2])
        if figures.get("depth", "field") != "field":
            return grid, *measured, wall
        grid = " x ".join(map(str, figures["grid"]["dims"]))
        wall = f"{figures.get('options', {}).get('min_thickness') or 1.75 * figures['grid']['spacing']:.2g}"
    return grid, *measured, wall


def main():
    text = PAGE.read_text()
    os.environ["PATH"] = f"{Path(sys.argv[1]).resolve().parent}:{os.environ['PATH']}"
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(folder)
        run("raymap example -o scan.ply --holes --quiet")
        PAGE.write_text(ROW.sub(lambda row: " | ".join((row[1].removesuffix(" |"), *cells(row[2]))) + " |", text))


if __name__ == "__main__":
    main()
