"""Measures the peak memory of what samples points of a mesh, for numbers of points and limits.

    python3 bench/sample_memory.py MESH [COUNT ...] [--limit BYTES ...] [--copies N]

Each row is a process of its own: its peak memory, less that of a process that samples one point of a tetrahedron.
"dataset" is the process of raymap.dataset.generate(what="points", n=COUNT), whose result is written whole. "stream" is
raymap.torch.SurfaceSamples with blocks of 2^14 points; it has the mesh so many times. Needs the packages raymap and
torch. The tests use it.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path


def dataset_peak(mesh: str, count: int, limit: int, copies: int) -> tuple[int, str]:
    """Returns the peak of the process that made the points, in bytes, and what came of it."""
    import raymap

    with tempfile.TemporaryDirectory() as folder:
        summary = raymap.dataset.generate(
            [mesh], folder, what="points", n=count, memory_limit=limit, time_limit=1e9, workers=1, threads=1
        )
        reasons = [path.read_text().strip() for path in Path(folder, "quarantine").rglob("reason.txt")]
    assert bool(summary.done) == (not reasons)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024, (reasons or ["written"])[0]


def stream_peak(mesh: str, count: int, limit: int, copies: int) -> tuple[int, str]:
    """Returns the peak of this process, in bytes, and what came of a stream of so many points of each copy."""
    import raymap.torch

    block = min(count, 1 << 14)
    result = "streamed"
    try:
        points = 0
        blocks = -(-count // block)
        for item in raymap.torch.SurfaceSamples([mesh] * copies, blocks=blocks, block=block, memory_limit=limit):
            points += len(item["points"])
        assert points == copies * blocks * block
    except raymap.MemoryLimitError as error:
        result = str(error)
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM:")), result


PEAKS = {"dataset": dataset_peak, "stream": stream_peak}


def measured(what: str, mesh: str, count: int, limit: int, copies: int = 1) -> tuple[int, str]:
    """Returns what a function of `PEAKS` returns in a fresh process."""
    command = [sys.executable, __file__, mesh, str(count), "--limit", str(limit), "--copies", str(copies), "--only", what]
    peak, result = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    return peak, result


def own_memory(what: str) -> int:
    """Returns the peak of a process that samples one point of a tetrahedron, in bytes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "tetrahedron.obj")
        path.write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        peak, result = measured(what, str(path), 1, 10**9)
        assert result in ("written", "streamed"), result
    return peak


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("mesh")
    parser.add_argument("counts", nargs="*", type=int, default=[10**4, 10**6, 10**7, 10**8])
    parser.add_argument("--limit", nargs="+", type=int, default=[500_000_000, 2_000_000_000])
    parser.add_argument("--copies", type=int, default=1)
    parser.add_argument("--only", choices=PEAKS, help="one row, in this process")
    given = parser.parse_args()
    if given.only:
        print(json.dumps(PEAKS[given.only](given.mesh, given.counts[0], given.limit[0], given.copies)))
        return
    print("| what | points | limit, MB | peak, MB | result |\n|---|---|---|---|---|")
    for what in PEAKS:
        own = own_memory(what)
        for limit in given.limit:
            for count in given.counts:
                peak, result = measured(what, given.mesh, count, limit, given.copies)
                print(f"| {what} | {count} | {limit / 1e6:.0f} | {(peak - own) / 1e6:.0f} | {result} |", flush=True)


if __name__ == "__main__":
    main()
