"""Fields straight to files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import raymap


def test_whole_fields_are_those_of_generate(tmp_path: Path) -> None:
    report = raymap.generate_file(
        "ball.ply", tmp_path / "f.npz", winding=tmp_path / "w.npy", arrays="confidence", resolution=20, device="cpu"
    )
    assert report["plan"] == {"form": "whole", "planes": 20, "bytes": 3 * 4 * 20**3}
    assert report["stats"]["device"] == "cpu"
    field = raymap.generate("ball.ply", resolution=20, arrays=("winding", "confidence"), device="cpu")
    loaded = raymap.load_field(tmp_path / "f.npz")
    for name in "distance", "winding", "confidence":
        assert (getattr(loaded, name) == getattr(field, name)).all()
    assert (np.load(tmp_path / "w.npy") == field.winding).all()


def test_fields_beyond_memory_become_slabs(tmp_path: Path) -> None:
    path = tmp_path / "f.npy"
    limits = {"device": "cpu", "threads": 1, "memory_limit": 15 << 20}
    stages: list[str] = []
    report = raymap.generate_file(
        raymap.load_mesh("ball.ply"), path, resolution=160, band=3, progress=lambda stage, done: stages.append(stage), **limits
    )
    assert report["plan"]["form"] == "slabs" and 0 < report["plan"]["planes"] < 160
    assert "region" in stages
    field = raymap.generate("ball.ply", resolution=160, band=3, device="cpu")
    assert np.abs(np.load(path) - field.distance).max() < 1e-5
    with pytest.raises(raymap.MemoryLimitError):
        raymap.generate_file("ball.ply", tmp_path / "f.npz", resolution=160, band=3, **limits)


def test_bad_arguments(tmp_path: Path) -> None:
    path = tmp_path / "f.npy"
    with pytest.raises(TypeError, match="unexpected keyword argument 'normalize'"):
        raymap.generate_file("ball.ply", path, normalize=True)  # type: ignore[call-arg]
    with pytest.raises(raymap.UsageError, match="write the winding numbers into another file"):
        raymap.generate_file("ball.ply", path, arrays="winding")
    with pytest.raises(raymap.UsageError, match="the whole inside"):
        raymap.generate_file("ball.ply", path, band=3, full_inside=True)
    with pytest.raises(raymap.FileError):
        raymap.generate_file("ball.ply", tmp_path / "nowhere" / "f.npy", resolution=8)
    assert not path.exists()


def test_files_are_those_of_the_command_line(run_raymap, tmp_path: Path) -> None:
    run_raymap("generate", "ball.ply", "-o", "whole.nrrd", "--resolution", 20, "--device", "cpu")
    raymap.generate_file("ball.ply", "own.nrrd", resolution=20, device="cpu")
    assert Path("own.nrrd").read_bytes() == Path("whole.nrrd").read_bytes()
    run_raymap("generate", "ball.ply", "-o", "band.nvdb", "--resolution", 20, "--band", 2, "--full-inside", "--device", "cpu")
    report = raymap.generate_file("ball.ply", "own.nvdb", resolution=20, band=2, full_inside=True, device="cpu")
    assert report["plan"] == {"form": "narrow_band", "planes": 20, "bytes": 0}
    assert Path("own.nvdb").read_bytes() == Path("band.nvdb").read_bytes()
