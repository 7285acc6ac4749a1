"""Number of threads of calls that do not say one."""

from __future__ import annotations

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
mesh = raymap.load_mesh({str(tmp_path / "open.ply")!r})
raymap.generate(mesh, resolution=8, device="cpu").save({str(tmp_path / "first.vdb")!r})  # OpenVDB's logger starts some.
before = count()
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


POOL = """
import multiprocessing, sys
import numpy as np
import raymap


def limited_field(arrays):
    mesh = raymap.Mesh(arrays["vertices"], arrays["faces"])
    return raymap.get_threads(), raymap.generate(mesh, resolution=32, device="cpu").distance


if __name__ == "__main__":
    arrays = dict(np.load(sys.argv[2]))
    with multiprocessing.get_context(sys.argv[1]).Pool(2, raymap.set_threads, (1,)) as pool:
        answers = pool.map(limited_field, [arrays] * 4)
    expected = limited_field(arrays)[1]
    print([threads for threads, _ in answers], raymap.get_threads())
    print(all(np.array_equal(distance, expected) for _, distance in answers))
"""


# In a process of its own, which has called nothing before: a fork copies the locks of threads that work (docs/python.md),
# be they TBB's or those of other packages.
@pytest.mark.parametrize("start", ["fork", "spawn", "forkserver"])
def test_workers_of_a_pool_have_their_own_number(ball: raymap.Mesh, tmp_path: Path, start: str):
    np.savez(tmp_path / "ball.npz", vertices=ball.vertices, faces=ball.faces)
    (tmp_path / "pool.py").write_text(POOL)
    ran = subprocess.run([sys.executable, tmp_path / "pool.py", start, tmp_path / "ball.npz"], env={**os.environ, "RAYMAP_THREADS": ""},
                         capture_output=True, text=True, check=False)
    assert (ran.stdout, ran.stderr) == ("[1, 1, 1, 1] None\nTrue\n", "")
