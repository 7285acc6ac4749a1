"""Meshes and programs that the tests share. Doctests run in a folder with ball.ply and tetrahedron.ply."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import raymap
from data_set import ENDLESS
from held_mesh import HeldMesh

ROOT = Path(__file__).parents[2]

# A shell starts what runs in the background with Ctrl-C ignored. The tests need it, also in the processes they start.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Dask gives up nothing that is slow, in this process and in those that tests start. But a scheduler asks a worker that was
# killed before it gave its last result for so many seconds, before another worker makes that result again.
os.environ |= {"DASK_DISTRIBUTED__COMM__TIMEOUTS__CONNECT": "60", "DASK_DISTRIBUTED__SCHEDULER__WORKER_TTL": "None"}


def make_ball(subdivisions: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Returns an icosphere of radius 1 about 0 with 20 * 4^subdivisions faces."""
    phi = (1 + 5**0.5) / 2
    points = [(s * 1.0, t * phi, 0.0) for s in (-1, 1) for t in (-1, 1)]
    vertices = np.array([np.roll(p, shift) for shift in range(3) for p in points])
    centres = range(len(vertices))
    near = np.linalg.norm(vertices[:, None] - vertices[None], axis=2) < 2.1
    faces = np.array([(a, b, c) for a in centres for b in centres for c in centres
                      if a < b < c and near[a, b] and near[b, c] and near[a, c]])
    normals = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]], vertices[faces[:, 2]] - vertices[faces[:, 0]])
    inward = np.einsum("ij,ij->i", normals, vertices[faces].sum(axis=1)) < 0
    faces[inward] = faces[inward][:, ::-1]
    for _ in range(subdivisions):
        edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
        edges.sort(axis=1)
        unique, index = np.unique(edges, axis=0, return_inverse=True)
        ab, bc, ca = (index.reshape(-1) + len(vertices)).reshape(3, -1)
        a, b, c = faces.T
        vertices = np.concatenate([vertices, vertices[unique].mean(axis=1)])
        faces = np.concatenate([np.stack(f, axis=1) for f in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
    return vertices / np.linalg.norm(vertices, axis=1, keepdims=True), faces.astype(np.uint32)


@pytest.fixture(scope="session")
def ball() -> raymap.Mesh:
    return raymap.Mesh(*make_ball())


@pytest.fixture(scope="session")
def large_ball() -> raymap.Mesh:
    """A ball of 81,920 faces."""
    return raymap.Mesh(*make_ball(6))


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory, ball: raymap.Mesh) -> Path:
    """A folder with ball.ply and tetrahedron.ply."""
    folder = tmp_path_factory.mktemp("meshes")
    ball.save(folder / "ball.ply")
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], float)
    raymap.Mesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]).save(folder / "tetrahedron.ply")
    return folder


@pytest.fixture
def meshes(tmp_path: Path, own_folder: None) -> Path:
    """A folder with four meshes, one of them in a folder, one open, and a file that is none."""
    folder = tmp_path / "meshes"
    (folder / "deep").mkdir(parents=True)
    shutil.copy("ball.ply", folder)
    shutil.copy("tetrahedron.ply", folder / "deep")
    vertices, faces = make_ball(1)
    raymap.Mesh(vertices, faces[:-7]).save("open.obj")
    shutil.move("open.obj", folder / "open.OBJ")
    raymap.Mesh(vertices, faces).save(folder / "small.ply")
    (folder / "notes.txt").write_text("no mesh")
    return folder


@pytest.fixture
def held(tmp_path: Path, own_folder: None) -> Iterator[HeldMesh]:
    """The mesh held.ply, whose readers wait for the test."""
    mesh = HeldMesh(tmp_path / "held.ply", (tmp_path / "ball.ply").read_bytes())
    yield mesh
    mesh.let_go()


@pytest.fixture
def end_raymap():
    """Runs the command line, RAYMAP_BINARY or that of the build tree, and returns how it ended: with the exit code ``code``."""
    program = os.environ.get("RAYMAP_BINARY", str(ROOT / "build/release/bin/raymap"))
    if "RAYMAP_BINARY" not in os.environ and not Path(program).exists():
        pytest.skip("the command line was not built; name it in RAYMAP_BINARY")

    def run(*arguments, code: int = 0) -> subprocess.CompletedProcess[str]:
        ended = subprocess.run([program, *map(str, arguments)], check=False, capture_output=True, text=True)
        assert ended.returncode == code, (arguments, ended.stderr)
        return ended

    return run


@pytest.fixture
def run_raymap(end_raymap):
    """Runs the command line, and returns its output."""
    return lambda *arguments: end_raymap(*arguments).stdout


@pytest.fixture(autouse=True)
def own_folder(files: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Gives every test a folder of its own with the meshes."""
    for mesh in files.iterdir():
        (tmp_path / mesh.name).write_bytes(mesh.read_bytes())
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("RAYMAP_CACHE", "off")
    # No test depends on how long work takes.
    monkeypatch.setitem(raymap.dataset.generate.__kwdefaults__, "time_limit", ENDLESS)
