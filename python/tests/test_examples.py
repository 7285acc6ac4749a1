"""Runs the examples as a new user would."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import raymap
from conftest import ROOT
from helpers import load

PICTURES = ["dataset", "gradient", "isosurfaces", "points", "repair", "samples", "slices"]


def test_walk_without_a_display(tmp_path: Path) -> None:
    image = load("matplotlib.image")
    environment = {k: v for k, v in os.environ.items() if k not in ("DISPLAY", "WAYLAND_DISPLAY", "MPLBACKEND")}
    folder = tmp_path / "walk"
    ended = subprocess.run(
        [sys.executable, ROOT / "examples/python/walk.py", folder], env=environment, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    assert sorted(path.stem for path in folder.glob("*.png")) == PICTURES
    for name in PICTURES:
        assert image.imread(folder / f"{name}.png")[..., :3].std() > 0.02, f"{name}.png is all but empty"
    knot = raymap.load_field(folder / "fields/knot.ply.npz")
    broken = raymap.load_field(folder / "fields/broken.obj.npz")
    assert (np.sign(knot.distance) != np.sign(broken.distance)).mean() < 1e-3
    check_facts(ended.stdout)


@pytest.mark.parametrize("obstacle", ["shelf", "ball.ply"])
def test_an_arm_keeps_away(tmp_path: Path, files: Path, obstacle: str) -> None:
    image = load("matplotlib.image")
    given = [] if obstacle == "shelf" else [files / obstacle]
    environment = os.environ | {"MPLBACKEND": "agg"}
    ended = subprocess.run(
        [sys.executable, ROOT / "examples/python/arm.py", tmp_path, *given], env=environment, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    assert number("straight path: least distance", ended.stdout) < -0.05
    assert number("path that keeps away: least distance", ended.stdout) > 0.09
    if obstacle == "shelf":
        assert number("bent path: least distance", ended.stdout) < 0.09, "the gradient had nothing to do"
    assert image.imread(tmp_path / "arm.png")[..., :3].std() > 0.02


def test_a_mesh_is_fitted_to_a_field(tmp_path: Path) -> None:
    image = load("matplotlib.image")
    load("torch")
    ended = subprocess.run(
        [sys.executable, ROOT / "examples/python/fit.py", tmp_path],
        env=os.environ | {"MPLBACKEND": "agg"}, capture_output=True, text=True,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    assert number("before: mean error", ended.stdout) > 0.1
    assert number("after: mean error", ended.stdout) < 0.03
    before, after = (raymap.load_mesh(tmp_path / f"{name}.ply") for name in ("before", "after"))
    np.testing.assert_array_equal(after.faces, before.faces)
    assert image.imread(tmp_path / "fit.png")[..., :3].std() > 0.02


def test_a_network_learns_a_mesh(tmp_path: Path, files: Path) -> None:
    image = load("matplotlib.image")
    load("torch")
    ended = subprocess.run(
        [sys.executable, ROOT / "examples/python/neural_field.py", tmp_path, files / "ball.ply",
         "--steps", "20", "--resolution", "32"],
        env=os.environ | {"MPLBACKEND": "agg"}, capture_output=True, text=True,
    )  # fmt: skip
    assert ended.returncode == 0, ended.stderr
    assert number("ball: mean error", ended.stdout) < 0.05  # 0.4 at first
    assert abs(raymap.load_mesh(tmp_path / "ball_learnt.ply").bounds - [[-1] * 3, [1] * 3]).max() < 0.1
    assert image.imread(tmp_path / "neural_field.png")[..., :3].std() > 0.02


def check_facts(printed: str) -> None:
    """Checks what the walk says against the shape: a tube around a curve, by Pappus' theorem."""
    t = np.linspace(0, 2 * np.pi, 10_001)
    curve = np.stack([(2 + np.cos(3 * t)) * np.cos(2 * t), (2 + np.cos(3 * t)) * np.sin(2 * t), -np.sin(3 * t)], axis=-1)
    volume = np.pi * 0.45**2 * np.linalg.norm(np.diff(curve, axis=0), axis=1).sum()
    assert "watertight True" in printed
    assert abs(number("volume", printed) / volume - 1) < 0.02
    assert abs(number("arrays distance):", printed) / 100 * 8 * 8 * 4 / volume - 1) < 0.02
    assert abs(number("length of the gradient:", printed) - 1) < 0.02
    assert number("the field differs by", printed) < 0.1
    assert re.search(r"^before \{'watertight': False, 'hole_count': 1, 'flipped_faces': 1\d\d\d}$", printed, re.MULTILINE)
    assert "after {'watertight': True, 'hole_count': 0, 'flipped_faces': 0}" in printed
    assert "broken.obj, knot.ply done" in printed


def number(after: str, text: str) -> float:
    found = re.search(re.escape(after) + r" (-?[0-9.]+)", text)
    assert found, text
    return float(found[1])
