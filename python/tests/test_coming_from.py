"""Runs the blocks of docs/coming_from.md with the real packages, and compares their results with ours."""

from __future__ import annotations

import os
import re

import numpy as np
import pytest
import raymap
from conftest import ROOT, make_ball
from helpers import load

PAGE = (ROOT / "docs/coming_from.md").read_text()
BLOCKS = dict(re.findall(r"^## (\S+)\n\n```python\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL))
EXACT, APPROXIMATE = 2e-6, 0.01
AGREEMENT = {
    "trimesh": EXACT,
    "Open3D": EXACT,
    "libigl": APPROXIMATE,
    "point-cloud-utils": APPROXIMATE,
    "pysdf": EXACT,
    "mesh_to_sdf": APPROXIMATE,
    "mesh2sdf": APPROXIMATE,
}


def test_every_package_has_a_block_and_a_row():
    assert list(BLOCKS) == list(AGREEMENT)
    assert re.findall(r"^\| (\S+) \| [0-9]", PAGE, re.MULTILINE) == list(AGREEMENT)


@pytest.mark.parametrize("package", BLOCKS)
def test_results_agree(package, monkeypatch):
    monkeypatch.setitem(os.environ, "PYOPENGL_PLATFORM", "egl")  # mesh_to_sdf: no display
    for name in re.findall(r"^import (\w+)", BLOCKS[package], re.MULTILINE):
        load(name)
    load("rtree" if package == "trimesh" else "numpy")
    vertices, faces = make_ball()
    vertices = vertices * 3 + (1, 2, 3)
    points = np.random.default_rng(0).uniform(-4, 4, (500, 3)) + (1, 2, 3)
    names = dict(np=np, raymap=raymap, vertices=vertices, faces=faces.astype(np.int32), points=points)
    exec(BLOCKS[package], names)
    theirs, ours = np.asarray(names["theirs"]), names["ours"]
    assert theirs.shape == ours.shape
    np.testing.assert_allclose(theirs, ours, atol=AGREEMENT[package], rtol=0)
    assert ours.min() < -1 and ours.max() > 1
