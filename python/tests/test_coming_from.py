"""Runs the blocks of docs/coming_from.md with the real packages, and compares their results with ours."""

from __future__ import annotations

import os
import re
import runpy
from pathlib import Path

import numpy as np
import pytest
import raymap
from conftest import ROOT, make_ball
from helpers import load

PAGE = (ROOT / "docs/coming_from.md").read_text()
CODE = "".join(re.findall(r"^```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL))
BLOCKS = dict(re.findall(r"^# (\S+)\n(.*?)(?=^# |\Z)", CODE, re.MULTILINE | re.DOTALL))
EXACT, APPROXIMATE = 2e-6, 0.01
AGREEMENT = {
    "trimesh": EXACT,
    "Open3D": EXACT,
    "libigl": APPROXIMATE,
    "point-cloud-utils": APPROXIMATE,
    "pysdf": EXACT,
    "mesh_to_sdf": APPROXIMATE,
    "MeshLib": EXACT,
    "trueform": EXACT,
    "Warp": EXACT,
    "PhysicsNeMo": EXACT,
    "mesh_to_voxels": APPROXIMATE,  # of mesh_to_sdf
    "mesh2sdf": APPROXIMATE,
    "tinyvdb": 0.02,
    "CGAL": APPROXIMATE,
}


ROWS = dict(re.findall(r"^\| (\S+) \| [0-9.]+ \| [^|]* \| (inside|outside)\b", PAGE, re.MULTILINE))


def run(package, monkeypatch, vertices, faces, points):
    """Runs the block of a package, as a file, which Warp's kernels need. Returns the package's results and ours."""
    monkeypatch.setitem(os.environ, "PYOPENGL_PLATFORM", "egl")  # mesh_to_sdf: no display
    for name in re.findall(r"^(?:import|from) (\w+)", BLOCKS[package], re.MULTILINE):
        load(name)
    load("rtree" if package == "trimesh" else "numpy")
    names = dict(np=np, raymap=raymap, vertices=vertices, faces=faces.astype(np.int32), points=points)
    Path("block.py").write_text(BLOCKS[package])
    found = runpy.run_path("block.py", names)
    return np.asarray(found["theirs"]), np.asarray(found["ours"])


def test_every_package_has_a_block_and_a_row():
    assert list(BLOCKS) == list(AGREEMENT)
    assert list(ROWS) == [package for package in AGREEMENT if package != "mesh_to_voxels"]


@pytest.mark.parametrize("package", BLOCKS)
def test_results_agree(package, monkeypatch):
    vertices, faces = make_ball()
    points = np.random.default_rng(0).uniform(-4, 4, (500, 3)) + (1, 2, 3)
    theirs, ours = run(package, monkeypatch, vertices * 3 + (1, 2, 3), faces, points)
    assert theirs.shape == ours.shape
    np.testing.assert_allclose(theirs, ours, atol=AGREEMENT[package], rtol=0)
    is_scaled = package in ("mesh_to_voxels", "mesh2sdf")
    assert ours.min() < (-0.75 if is_scaled else -1)
    assert ours.max() > (0.7 if is_scaled else 1)


def test_the_sampler_of_mesh_to_sdf(monkeypatch):
    """The page names our call: as many points, in the same ball, with distances of the same sign."""
    monkeypatch.setitem(os.environ, "PYOPENGL_PLATFORM", "egl")
    vertices, faces = make_ball()
    mesh = load("trimesh").Trimesh(vertices * 3 + (1, 2, 3), faces)
    options = dict(surface_point_method="sample", sign_method="normal", sample_point_count=50000)
    points, theirs = load("mesh_to_sdf").sample_sdf_near_surface(mesh, 1000, **options)
    ours = raymap.sample_points(mesh, 1000, normalize=True)
    assert points.shape == ours.points.shape and theirs.shape == ours.distance.shape
    for at, found in ((points, theirs), (ours.points, ours.distance)):
        np.testing.assert_allclose(found, np.linalg.norm(at, axis=1) - 1, atol=0.05)
        assert 0.4 < (found < 0).mean() < 0.65 and 40 <= (np.abs(found) > 0.05).sum() <= 60


@pytest.mark.parametrize("text, first, last", [
    ("mesh_to_voxels", -1, 1),
    ("Occupancy Networks", -0.55 + 1.1 / 64, 0.55 - 1.1 / 64),
    ("SDFusion", -1.3 + 1.3 / 64, 1.3 - 1.3 / 64),
])  # fmt: skip
def test_grids_of_networks_lie_where_the_page_says(text, first, last):
    options = re.search(rf"^\| .*{text}.* \| `(.*)` \|$", PAGE.split("## Grids of networks")[1], re.MULTILINE)[1]
    vertices, faces = make_ball(1)
    names = dict(raymap=raymap, vertices=vertices * (3, 2, 1) + 5, faces=faces, n=32)
    field = eval(f"raymap.generate(vertices, faces, device='cpu', {options})", names)
    n = field.shape[0]
    assert field.shape == (n, n, n) and n in (32, 64)
    np.testing.assert_allclose(field.origin, [first] * 3, atol=1e-9)
    assert field.spacing == pytest.approx((last - first) / (n - 1))


@pytest.mark.parametrize("package", ROWS)
def test_overlaps_have_the_sign_that_the_page_says(package, monkeypatch):
    ball, faces = make_ball()
    vertices = np.concatenate((ball * 3, ball * 2)) + (1, 2, 3)  # The smaller ball overlaps the larger one.
    faces = np.concatenate((faces, faces + len(ball)))
    points = np.random.default_rng(0).uniform(-0.5, 0.5, (50, 3)) + (1, 2, 3)
    theirs, ours = run(package, monkeypatch, vertices, faces, points)
    middle = np.s_[:] if theirs.ndim == 1 else tuple(np.s_[n // 2 - 1 : n // 2 + 2] for n in theirs.shape)
    assert (ours[middle] < 0).all()
    assert ((theirs[middle] < 0) == (ROWS[package] == "inside")).all()
