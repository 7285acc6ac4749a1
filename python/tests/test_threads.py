"""Number of threads of calls that do not say one."""

from __future__ import annotations

import multiprocessing
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import raymap


@pytest.fixture(autouse=True)
def restored() -> Iterator[None]:
    yield
    raymap.set_threads(None)


def run(code: str, threads: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", code], env={**os.environ, "RAYMAP_THREADS": threads}, capture_output=True, text=True, check=False
    )


def test_the_number_is_the_last_one_set():
    assert raymap.get_threads() is None
    for threads in (2, 100000, 1):
        raymap.set_threads(threads)
        assert raymap.get_threads() == threads
    for wrong, error in ((0, raymap.UsageError), (-1, raymap.UsageError), (1.5, TypeError), (2**31, TypeError)):
        with pytest.raises(error):
            raymap.set_threads(wrong)
    assert raymap.get_threads() == 1
    raymap.set_threads(None)
    assert raymap.get_threads() is None


def test_the_variable_counts_until_a_number_is_set():
    code = "import raymap; print(raymap.get_threads()); raymap.set_threads(None); print(raymap.get_threads())"
    assert run(code, "3").stdout == "3\nNone\n"
    assert run(code, "0").stdout == run(code, "").stdout == "None\nNone\n"


def test_nonsense_in_the_variable_is_an_error_of_the_call():
    code = (
        "import raymap\n"
        "for call in (raymap.get_threads, lambda: raymap.isosurface([[[-1.0] * 3] * 3] * 3)):\n"
        "    try: call()\n"
        "    except raymap.UsageError as error: print(error)\n"
    )
    wrong = "the environment variable RAYMAP_THREADS is 'all'; it must be a number of threads, or 0 for all\n"
    assert run(code, "all").stdout == 2 * wrong


def test_no_call_starts_more_threads(ball: raymap.Mesh, tmp_path: Path):
    raymap.Mesh(ball.vertices, ball.faces[20:]).save(tmp_path / "open.ply")
    code = f"""
import os, raymap
def count(): return len(os.listdir("/proc/self/task"))
before = count()
mesh = raymap.load_mesh({str(tmp_path / "open.ply")!r})
field = raymap.generate(mesh, resolution=40, device="cpu", close_holes=True)
field.sample(mesh.vertices)
field.to_mesh()
field.render(device="cpu", width=60, height=40)
raymap.info(mesh)
raymap.Surface(mesh).query(mesh.vertices)
raymap.repair(mesh, resolution=40, device="cpu", remesh=True)
raymap.sample_points(mesh, 1000)
mesh.save({str(tmp_path / "copy.stl")!r})
field.save({str(tmp_path / "field.vdb")!r})
print(count() - before)
"""
    ran = run(code, "1")
    assert (ran.stdout, ran.stderr) == ("0\n", "")


def limited_field(mesh: raymap.Mesh) -> tuple[int | None, np.ndarray]:
    return raymap.get_threads(), raymap.generate(mesh, resolution=32, device="cpu").distance


@pytest.mark.parametrize("start", ["fork", "spawn", "forkserver"])
def test_workers_of_a_pool_have_their_own_number(ball: raymap.Mesh, start: str):
    with multiprocessing.get_context(start).Pool(2, raymap.set_threads, (1,)) as pool:
        answers = pool.map(limited_field, [ball] * 4)
    # Not before: a thread that has just worked may hold a lock of TBB's, which a fork would copy (docs/python.md).
    expected = raymap.generate(ball, resolution=32, device="cpu").distance
    for threads, distance in answers:
        assert threads == 1
        np.testing.assert_array_equal(distance, expected)
    assert raymap.get_threads() is None
