"""Wrong arguments: the error has the documented class and names the argument."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import raymap
from conftest import make_ball

NAN, INF = float("nan"), float("inf")
MESH = make_ball(1)

#: Values out of range, and values of another type, for arguments of raymap.generate.
OUT_OF_RANGE: dict[str, list[Any]] = {
    "resolution": [0, -1, 2**40],
    "voxel_size": [0, -1, NAN, INF],
    "padding": [-1, NAN, INF],
    "passes": [-1, 2**40],
    "threshold": [-1, NAN, INF],
    "band": [0, -1, NAN, INF],
    "thickness": [0, -1, NAN, INF],
    "threads": [0, -1, 2**64],
    "memory_limit": [0, -1, 2**64],
    "bounds": [1, [(0, 0, 0), (NAN, 1, 1)], [(0, 0, 0), (INF, 1, 1)], [(1, 1, 1), (0, 0, 0)]],
}
OTHER_TYPES: dict[str, list[Any]] = {
    "resolution": ["a", 1.5, None],
    "voxel_size": ["1", [1, 2]],
    "padding": ["1", None],
    "passes": ["1", 1.5],
    "threshold": ["1", None],
    "band": ["1"],
    "thickness": ["1"],
    "threads": ["1", 1.5],
    "memory_limit": ["1G", 1.5],
    "bounds": ["x"],
    "device": [1, None],
    "sign": [1, None],
    "distance": [1],
    "orientation": [1],
    "sampling": [1],
}


@pytest.mark.parametrize("name", OUT_OF_RANGE)
def test_what_is_out_of_range_is_a_usage_error(name: str) -> None:
    for value in OUT_OF_RANGE[name]:
        with pytest.raises(raymap.UsageError, match=f"^{name}"):
            raymap.generate(*MESH, **{"resolution": 8, name: value})


@pytest.mark.parametrize("name", OTHER_TYPES)
def test_another_type_is_a_type_error(name: str) -> None:
    for value in OTHER_TYPES[name]:
        with pytest.raises(TypeError, match=f"^{name} must be "):
            raymap.generate(*MESH, **{"resolution": 8, name: value})


def test_limits_themselves_are_taken() -> None:
    field = raymap.generate(*MESH, resolution=1, padding=0, passes=1, threshold=0, threads=1, device="cpu")
    assert field.shape == (1, 1, 1)


def test_long_values_are_not_repeated() -> None:
    with pytest.raises(TypeError, match="^padding must be a number, not a list$"):
        raymap.generate(*MESH, padding=[1.0] * 100)


@pytest.mark.parametrize(
    ("name", "values"),
    [("spacing", [0, -1, NAN, INF]), ("clamp_distance", [-1, NAN, INF]), ("origin", [(0, 0), (NAN, 0, 0)])],
)
def test_fields_check_their_grid(name: str, values: list[Any]) -> None:
    for value in values:
        with pytest.raises(raymap.UsageError, match=f"^{name}"):
            raymap.Field(np.zeros((2, 2, 2)), **{name: value})
    with pytest.raises(TypeError, match=f"^{name} must be "):
        raymap.Field(np.zeros((2, 2, 2)), **{name: "x"})


def test_other_functions_check_theirs() -> None:
    mesh = raymap.Mesh(*MESH)
    field = raymap.generate(mesh, resolution=8, device="cpu")
    for error, name, call in [
        (raymap.UsageError, "n", lambda: raymap.sample_points(mesh, -1)),
        (raymap.UsageError, "seed", lambda: raymap.sample_points(mesh, 1, seed=2**64)),
        (raymap.UsageError, "sigma", lambda: raymap.sample_points(mesh, 1, sigma=-1)),
        (raymap.UsageError, "near", lambda: raymap.sample_points(mesh, 1, near=NAN)),
        (TypeError, "n", lambda: raymap.sample_points(mesh, 1.5)),
        (raymap.UsageError, "step", lambda: raymap.sample_faces(mesh, step=0)),
        (raymap.UsageError, "tolerance", lambda: raymap.simplify(mesh, tolerance=-1)),
        (raymap.UsageError, "step", lambda: raymap.simplify(mesh, tolerance=1, step=0)),
        (raymap.UsageError, "shell", lambda: raymap.repair(mesh, shell=-1)),
        (TypeError, "offset", lambda: raymap.repair(mesh, offset="1")),
        (raymap.UsageError, "drain_holes", lambda: raymap.repair(mesh, drain_holes=-1)),
        (raymap.UsageError, "down", lambda: raymap.repair(mesh, down=(0, 1))),
        (raymap.UsageError, "iso", lambda: field.render(iso=NAN)),
        (TypeError, "eye", lambda: field.render(eye="here")),
        (raymap.UsageError, "eye", lambda: field.render(eye=(0, 1))),
        (raymap.UsageError, "cut_plane", lambda: field.render(cut_plane=(0, 0, 1))),
        (raymap.UsageError, "slice_plane", lambda: field.render(slice_plane=(0, 0, 1, NAN))),
        (raymap.UsageError, "frame", lambda: field.render(frame=(0, 1))),
        (TypeError, "iso", lambda: field.to_mesh("0")),
        (raymap.UsageError, "iso", lambda: field.to_mesh(NAN)),
        (raymap.UsageError, "threads", lambda: field.sample((0, 0, 0), threads=0)),
        (TypeError, "width", lambda: field.slice("z", width=1.5)),
        (raymap.UsageError, "threads", lambda: raymap.set_threads(0)),
        (raymap.UsageError, "max_distance", lambda: raymap.Surface(mesh).query([(0, 0, 0)], max_distance=-1)),
    ]:
        with pytest.raises(error, match=f"^{name} must be "):
            call()


def test_too_many_points_are_a_memory_error() -> None:
    with pytest.raises(raymap.MemoryLimitError, match="use a larger step"):
        raymap.sample_faces(raymap.Mesh(*make_ball(3)), step=1e-9)


def test_a_folder_is_called_one(tmp_path: Path) -> None:
    for read in raymap.load_mesh, raymap.info, raymap.generate, raymap.Surface:
        with pytest.raises(raymap.FileError, match="it is a folder"):
            read(tmp_path)


def test_a_field_is_no_mesh() -> None:
    field = raymap.generate(*MESH, resolution=8, device="cpu")
    for function in raymap.generate, raymap.info, raymap.repair:
        with pytest.raises(raymap.UsageError, match=r"give field\.to_mesh\(\)"):
            function(field)
