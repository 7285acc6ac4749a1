"""Huge fields on a Dask cluster whose processes are killed. Nothing here depends on how long work takes."""

from __future__ import annotations

from pathlib import Path

import distributed
import numpy as np
import raymap
from dask_cluster import Cluster
from data_set import ENDLESS, start_module
from held_mesh import wait_for
from raymap._lattice import this_machine
from test_zarr import without_lock

SIZES = {"resolution": 80, "band": 2.0, "shards": 16, "chunks": 8}
LOST = "raymap: error: the scheduler of Dask was lost; run again with a new one: what is finished stays"


def shard_count(folder: str = "cluster.zarr") -> int:
    return len(list(Path(folder).rglob("c/*/*/*")))


def test_clusters_whose_processes_are_killed_make_what_one_process_makes(tmp_path: Path) -> None:
    field = raymap.dask.field("ball.ply", resolution=20, chunks=8, band=2)
    array = field.distance.compute(scheduler="synchronous")
    raymap.zarr.generate("ball.ply", "alone.zarr", **SIZES)
    options = [text for name, value in SIZES.items() for text in (f"--{name}", value)]
    with Cluster(tmp_path / "dask", 2) as cluster:
        with distributed.Client(cluster.address, timeout=ENDLESS) as client:
            np.testing.assert_array_equal(field.distance.compute(), array)
            name, threads, limit = client.submit(this_machine).result()
            assert name.startswith("the worker tcp://127.0.0.1:") and threads == 1 and limit > 0
            small = {**SIZES, "resolution": 40, "client": client}
            assert raymap.zarr.generate("ball.ply", "small.zarr", **small).new == 3**3
            assert raymap.zarr.generate("ball.ply", "small.zarr", **small).new == 0
        run = start_module("field", "ball.ply", "-o", "cluster.zarr", *options, "--scheduler", cluster.address)
        wait_for(lambda: shard_count() >= 3)
        cluster.workers[0].kill()
        wait_for(lambda: shard_count() >= 10)
        cluster.scheduler.kill()
        out, error = run.communicate()
    lines = [line for line in error.splitlines() if line.startswith("raymap: ")]
    assert (out, run.returncode, lines[-1]) == ("", 9, LOST)
    assert lines[0].startswith("raymap: dashboard: http://127.0.0.1:")
    left = shard_count("alone.zarr") - shard_count()
    assert 0 < left < shard_count("alone.zarr") - 9
    assert left <= raymap.zarr.generate("ball.ply", "cluster.zarr", **SIZES).new < 5**3
    assert without_lock("cluster.zarr") == without_lock("alone.zarr")
