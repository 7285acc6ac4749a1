"""Functions that several tests of data sets use."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path

import raymap

#: Seconds, for what must not depend on how long work takes.
ENDLESS = 1e9

#: Names of the meshes of the fixture `meshes`.
NAMES = ["ball.ply", "deep/tetrahedron.ply", "open.OBJ", "small.ply"]


def generate(meshes: object, out: str = "out", **options) -> raymap.dataset.Summary:
    return raymap.dataset.generate(meshes, out, **{"resolution": 16, "workers": 2, **options})


def contents(folder: str | Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(Path(folder).rglob("*")) if p.is_file()}


def identities(folder: str | Path) -> dict[str, tuple[int, int]]:
    """Returns what changes when a result is written again, even with the same content."""
    return {
        str(p.relative_to(folder)): (p.stat().st_ino, p.stat().st_mtime_ns)
        for p in Path(folder).rglob("*")
        if p.is_file() and not p.name.startswith(("table.", "index."))
    }


def table(out: str | Path = "out", name: str = "table.csv") -> dict[str, dict[str, str]]:
    with open(Path(out, name), newline="") as file:
        return {row["mesh"]: row for row in csv.DictReader(file)}


def start_module(*arguments: object, **options) -> subprocess.Popen[str]:
    """Starts `python -m raymap`, without a time limit for a mesh unless the arguments have one."""
    name, *rest = map(str, arguments)
    endless = ["--time-limit", str(ENDLESS)] if name == "dataset" else []
    command = [sys.executable, "-m", "raymap", name, *endless, *rest]
    return subprocess.Popen(command, **{"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **options})


def run_module(*arguments: object, **options) -> subprocess.CompletedProcess[str]:
    """Runs `python -m raymap`."""
    process = start_module(*arguments, **options)
    out, error = process.communicate()
    return subprocess.CompletedProcess(process.args, process.returncode, out, error)


def sample_memory(what: str, mesh: str | Path, count: int, limit: int, copies: int = 1) -> tuple[int, str]:
    """Returns the peak memory of a process in bytes, and what came of its samples. bench/sample_memory.py documents it."""
    options = ["--limit", str(limit), "--copies", str(copies), "--only", what]
    command = [sys.executable, str(Path(__file__).parents[2] / "bench/sample_memory.py"), str(mesh), str(count), *options]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    peak, result = json.loads(ran.stdout)
    return peak, result
