"""Data sets on a Dask cluster whose processes are killed. Nothing here depends on how long work takes."""

from __future__ import annotations

import shutil
import signal
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import distributed
import pytest
import raymap
from conftest import make_ball
from dask_cluster import Cluster, is_running, parent_of
from data_set import ENDLESS, contents, generate, run_module, start_module, table
from held_mesh import HeldMesh, wait_for

LOST = "the scheduler of Dask was lost; run again with a new one: what is finished stays"


@pytest.fixture
def many(meshes: Path, held: HeldMesh) -> list[Path]:
    """Paths of the held mesh, an open one, a malformed one and twelve balls."""
    vertices, faces = make_ball(3)
    for k in range(12):
        raymap.Mesh(vertices * (1 + 0.1 * k), faces).save(meshes / f"ball_{k:02}.ply")
    (meshes / "bad.ply").write_text("ply\n")
    return [held.path, meshes / "open.OBJ", meshes / "bad.ply", *sorted(meshes.glob("ball_*.ply"))]


@pytest.fixture
def serial(many: list[Path], held: HeldMesh) -> dict[str, bytes]:
    """Contents of the results that a run on this machine makes."""
    folder = Path("serial meshes")
    folder.mkdir()
    for path in many:
        shutil.copy("ball.ply" if path == held.path else path, folder / path.name)
    generate([folder / path.name for path in many], "serial", workers=1)
    return without_logs("serial")


def without_logs(folder: str) -> dict[str, bytes]:
    """Returns all contents but those that name the malformed mesh's folder."""
    return {name: data for name, data in contents(folder).items() if b"bad.ply" not in data and "bad.ply/" not in name}


@pytest.fixture
def begin(many: list[Path]) -> Iterator:
    """Begins a run on a cluster in a thread of its own."""
    with ThreadPoolExecutor(1) as pool:

        def run(address: str, paths: list[Path]) -> raymap.dataset.Summary:
            with distributed.Client(address, timeout=ENDLESS) as client:
                return generate(paths, "cluster", client=client)

        def submit(cluster: Cluster, paths: list[Path] = many) -> Future[raymap.dataset.Summary]:
            return pool.submit(run, cluster.address, paths)

        yield submit


def markers(out: str) -> dict[str, tuple[int, int]]:
    """Returns what changes when a mesh is made again. Other files may vanish while a cluster works."""
    found = {path.name: path.stat() for path in Path(out).glob("*.json")}
    return {name: (status.st_ino, status.st_mtime_ns) for name, status in found.items()}


def own_lines(text: str) -> list[str]:
    """Returns the lines of the command line. Dask may add others when it likes."""
    return [line for line in text.splitlines() if line.startswith("raymap: ")]


def wait_until_held(held: HeldMesh, cluster: Cluster) -> tuple[int, int]:
    """Returns the number of the worker that makes the held mesh, and the process in which it does."""
    worker = held.give()
    child = held.wait_for_reader()
    assert parent_of(child) == worker
    return [process.pid for process in cluster.workers].index(worker), child


def test_a_cluster_loses_nothing_when_a_worker_is_killed(
    many: list[Path], held: HeldMesh, serial: dict[str, bytes], begin, tmp_path: Path
) -> None:
    with Cluster(tmp_path / "dask", 2) as cluster:
        run = begin(cluster)
        worker, child = wait_until_held(held, cluster)
        wait_for(lambda: len(markers("cluster")) >= 3)
        before = markers("cluster")
        cluster.workers[worker].kill()
        wait_for(lambda: not is_running(child))
        assert wait_until_held(held, cluster)[0] != worker
        held.give()
        summary = run.result()
    assert (len(summary.done), summary.quarantined, summary.unfinished) == (14, ["bad.ply"], [])
    assert before.items() <= markers("cluster").items()  # Nothing twice
    assert without_logs("cluster") == serial


def test_a_lost_scheduler_is_an_error_and_the_next_run_goes_on(
    many: list[Path], held: HeldMesh, serial: dict[str, bytes], begin, tmp_path: Path
) -> None:
    with Cluster(tmp_path / "first", 2) as cluster:
        run = begin(cluster)
        _, child = wait_until_held(held, cluster)
        wait_for(lambda: len(markers("cluster")) >= 3)
        cluster.scheduler.kill()
        with pytest.raises(raymap.Error, match=LOST):
            run.result()
    wait_for(lambda: not is_running(child))
    before = markers("cluster")
    assert 3 <= len(before) < 15
    held.let_go()
    with Cluster(tmp_path / "second", 2) as cluster:
        assert len(begin(cluster).result().new) == 15 - len(before)
        ran = run_module("dataset", *many, "-o", "cluster", "--resolution", 16, "--scheduler", cluster.address)
        assert ran.stdout.startswith("14 done, 1 quarantined, 0 unfinished; 0 of them new")
        assert own_lines(ran.stderr) == []
    assert before.items() <= markers("cluster").items()
    assert without_logs("cluster") == serial


@pytest.mark.parametrize("end, code, text", [
    (lambda run, cluster: cluster.scheduler.kill(), 9, f"raymap: error: {LOST}"),
    (lambda run, cluster: run.send_signal(signal.SIGINT), 130, "raymap: stopped; run it again to go on"),
], ids=["lost scheduler", "Ctrl-C"])  # fmt: skip
def test_the_command_line_ends_in_one_line(held: HeldMesh, tmp_path: Path, end, code: int, text: str) -> None:
    with Cluster(tmp_path / "dask", 1) as cluster:
        run = start_module("dataset", held.path, "-o", "out", "--scheduler", cluster.address)
        _, child = wait_until_held(held, cluster)
        end(run, cluster)
        out, error = run.communicate()
        assert (out, own_lines(error), run.returncode) == ("", [text], code)
    wait_for(lambda: not is_running(child))


def test_a_mesh_whose_workers_are_all_killed_is_unfinished(held: HeldMesh, begin, tmp_path: Path) -> None:
    """Dask gives up a task that four workers died with. That says nothing about the mesh."""
    shutil.copy("ball.ply", "done.ply")
    generate(["done.ply"], "cluster")
    with Cluster(tmp_path / "dask", 4) as cluster:
        run = begin(cluster, [held.path])
        for _ in range(4):
            worker, child = wait_until_held(held, cluster)
            cluster.workers[worker].kill()
            cluster.workers[worker].wait()
            wait_for(lambda: not is_running(child))
        summary = run.result()
    assert (summary.done, summary.quarantined, summary.new, summary.unfinished) == ([], [], [], ["held.ply"])
    row = table("cluster")["held.ply"]
    assert (row["state"], row["reason"]) == ("unfinished", "its workers were killed again and again")
    assert summary.others == ["done.ply.npz"]


def test_a_device_that_a_worker_lacks_stops_the_run(meshes: Path, tmp_path: Path) -> None:
    with Cluster(tmp_path / "dask", 1) as cluster, distributed.Client(cluster.address, timeout=ENDLESS) as client:
        with pytest.raises(raymap.UnsupportedError, match=r"\(on the machine .+\)$"):
            generate(meshes, client=client, device="vulkan:99")
        assert contents("out").keys() == {".lock"}
        assert len(generate(meshes, client=client).done) == 4
