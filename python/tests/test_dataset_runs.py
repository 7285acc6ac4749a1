"""Runs of data sets that are held, stopped, killed or limited. Nothing here depends on how long work takes."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import raymap
from dask_cluster import is_running
from data_set import contents, generate, identities, run_module, start_module, table
from held_mesh import HeldMesh, wait_for

@pytest.fixture
def begin():
    """Begins a run in a thread of its own."""
    with ThreadPoolExecutor(2) as pool:

        def submit(*arguments, **options) -> Future[raymap.dataset.Summary]:
            return pool.submit(generate, *arguments, **options)

        yield submit


def test_a_held_mesh_gives_the_result_of_a_file(held: HeldMesh, begin) -> None:
    run = begin([held.path])
    held.give()
    assert held.give() != os.getpid()
    assert run.result().new == run.result().done == ["held.ply"]
    generate(["ball.ply"], "direct")
    assert Path("out/held.ply.npz").read_bytes() == Path("direct/ball.ply.npz").read_bytes()


def test_the_time_limit(held: HeldMesh, begin) -> None:
    run = begin([held.path], time_limit=0.01)
    held.give()
    assert run.result().quarantined == ["held.ply"]
    assert table()["held.ply"]["reason"] == "takes longer than 0.01 s; raise time_limit"
    run = begin([held.path], time_limit=0.01)
    held.give()
    assert run.result().new == []
    run = begin([held.path])
    held.give()
    held.give()
    assert run.result().done == ["held.ply"]
    assert not Path("out/quarantine/held.ply").exists()


def test_a_crash_is_quarantined(held: HeldMesh, begin) -> None:
    shutil.copy("ball.ply", "small.ply")
    run = begin([held.path, "small.ply"], workers=1)
    held.give()
    os.kill(held.wait_for_reader(), signal.SIGSEGV)
    assert (run.result().done, run.result().quarantined) == (["small.ply"], ["held.ply"])
    assert table()["held.ply"]["reason"] == "its process crashed: SIGSEGV, Segmentation fault"
    assert "Segmentation fault" in Path("out/quarantine/held.ply/log.txt").read_text()


def test_a_mesh_whose_process_is_killed_is_unfinished(held: HeldMesh, begin) -> None:
    """The kernel kills a process if the machine runs out of memory. That says nothing of the mesh."""
    shutil.copy("ball.ply", "small.ply")
    run = begin([held.path, "small.ply"], workers=1)
    held.give()
    os.kill(held.wait_for_reader(), signal.SIGKILL)
    summary = run.result()
    assert (summary.done, summary.quarantined, summary.unfinished) == (["small.ply"], [], ["held.ply"])
    assert table()["held.ply"]["reason"] == "its process was killed; perhaps the machine ran out of memory"
    held.let_go()
    assert generate([held.path, "small.ply"]).new == ["held.ply"]


def test_a_crash_counts_in_a_fresh_process_only(held: HeldMesh, begin) -> None:
    run = begin(["ball.ply", held.path], workers=1)
    held.give()
    used = held.wait_for_reader()
    os.kill(used, signal.SIGKILL)
    assert held.wait_for_reader(other_than=used) != used
    held.give()
    assert run.result().done == ["ball.ply", "held.ply"]


def test_children_end_with_their_parent(held: HeldMesh) -> None:
    program = f"import raymap; raymap.dataset.generate([{str(held.path)!r}], 'out', resolution=16)"
    parent = subprocess.Popen([sys.executable, "-c", program])
    assert held.give() == parent.pid
    child = held.wait_for_reader()
    parent.kill()
    parent.wait()
    wait_for(lambda: not is_running(child))
    assert not Path("out/held.ply.json").exists()


def test_an_earlier_result_stays_until_the_next_one_is_whole(tmp_path: Path, begin) -> None:
    shutil.copy("ball.ply", "held.ply")
    generate(["held.ply"])
    before = contents("out")
    Path("held.ply").unlink()
    held = HeldMesh(tmp_path / "held.ply", Path("tetrahedron.ply").read_bytes())
    run = begin([held.path], format="nrrd")
    held.give()
    held.wait_for_reader()
    assert contents("out") == before
    held.give()
    assert run.result().new == ["held.ply"]
    names = [".lock", "held.ply.json", "held.ply.nrrd", "held.ply.png", "index.html", "table.csv"]
    assert sorted(contents("out")) == names
    direct = raymap.generate("tetrahedron.ply", resolution=16, device="cpu")
    np.testing.assert_array_equal(raymap.load_field("out/held.ply.nrrd").distance, direct.distance)


def test_ctrl_c_ends_in_one_line_and_leaves_what_was_there(tmp_path: Path) -> None:
    shutil.copy("ball.ply", "held.ply")
    generate(["held.ply"])
    before = identities("out")
    Path("held.ply").unlink()
    held = HeldMesh(tmp_path / "held.ply", Path("tetrahedron.ply").read_bytes())
    process = start_module("dataset", held.path, "-o", "out", "--resolution", 16)
    held.give()
    child = held.wait_for_reader()
    process.send_signal(signal.SIGINT)
    assert process.communicate() == ("", "raymap: stopped; run it again to go on\n")
    assert process.returncode == 130
    assert not is_running(child)
    assert identities("out") == before


def test_a_killed_run_leaves_what_the_next_one_removes(held: HeldMesh, begin) -> None:
    command = ("dataset", held.path, "-o", "out", "--resolution", 16)
    process = start_module(*command)
    held.give()
    child = held.wait_for_reader()
    process.kill()
    process.wait()
    wait_for(lambda: not is_running(child))
    assert len(left := list(Path("out").glob(".held.*"))) == 1
    again = begin([held.path])
    assert held.wait_for_reader() == os.getpid()
    assert not left[0].exists()  # Before anything is made
    held.give()
    held.give()
    assert again.result().done == ["held.ply"]
    assert sorted(os.listdir("out")) == [".lock", "held.ply.json", "held.ply.npz", "held.ply.png", "index.html", "table.csv"]


def test_a_stopped_run_tells_which_results_are_of_other_options(tmp_path: Path) -> None:
    """It also knows what earlier runs have finished, but it has not looked at."""
    paths = [tmp_path / name for name in ("a.ply", "held.ply", "z.ply")]
    for path in paths:
        shutil.copy("ball.ply", path)
    generate(paths)
    generate(paths[2:], resolution=17)
    paths[1].unlink()
    held = HeldMesh(paths[1], Path("ball.ply").read_bytes())

    def stop(text: str, done: float) -> bool:
        held.give()
        held.wait_for_reader()
        return False

    with pytest.warns(raymap.RaymapWarning, match="out also holds a result of other options"):
        with pytest.raises(raymap.Cancelled):
            generate(paths, resolution=17, workers=1, progress=stop)
    assert {name: row["state"] for name, row in table().items()} == {"a.ply": "done", "held.ply": "unfinished", "z.ply": "done"}
    page = Path("out/index.html").read_text()
    assert "2 of 3 meshes done" in page and '<a href="held.ply.npz">held.ply.npz</a>' in page
    os.unlink("out/table.csv")
    with pytest.raises(raymap.Cancelled):
        generate(paths, resolution=17, workers=1, progress=stop)
    assert not Path("out/table.csv").exists()  # Nothing was made.


def test_a_second_run_is_kept_out(held: HeldMesh, begin) -> None:
    shutil.copy("ball.ply", "small.ply")
    run = begin([held.path])
    held.give()
    with pytest.raises(raymap.FileError, match="out: another run writes into this folder; wait for its end, or choose"):
        generate(["small.ply"])
    ran = run_module("dataset", "small.ply", "-o", "out")
    assert ran.returncode == 4 and ran.stderr.count("\n") == 1
    assert generate(["small.ply"], "other").done == ["small.ply"]
    assert contents("out").keys() == {".lock"}
    held.give()
    assert run.result().done == ["held.ply"]
    assert generate(["small.ply"]).done == ["small.ply"]
