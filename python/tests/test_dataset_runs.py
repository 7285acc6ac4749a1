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

ENDLESS = 1e9  # Seconds


@pytest.fixture
def begin():
    """Begins a run in a thread of its own."""
    with ThreadPoolExecutor(2) as pool:

        def submit(*arguments, **options) -> Future[raymap.dataset.Summary]:
            return pool.submit(generate, *arguments, **{"time_limit": ENDLESS, **options})

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
    process = start_module("dataset", held.path, "-o", "out", "--resolution", 16, "--time-limit", ENDLESS)
    held.give()
    child = held.wait_for_reader()
    process.send_signal(signal.SIGINT)
    assert process.communicate() == ("", "raymap: stopped; run it again to go on\n")
    assert process.returncode == 130
    assert not is_running(child)
    assert identities("out") == before


def test_a_second_run_is_kept_out(held: HeldMesh, begin) -> None:
    shutil.copy("ball.ply", "small.ply")
    run = begin([held.path])
    held.give()
    with pytest.raises(raymap.FileError, match="out: another run writes into this folder; wait for its end, or choose"):
        generate(["small.ply"])
    ran = run_module("dataset", "small.ply", "-o", "out")
    assert ran.returncode == 4 and ran.stderr.count("\n") == 1
    assert generate(["small.ply"], "other").done == ["small.ply"]
    assert sorted(os.listdir("out")) == [".lock"]
    held.give()
    assert run.result().done == ["held.ply"]
    assert generate(["small.ply"]).done == ["small.ply"]
