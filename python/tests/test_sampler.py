"""Streams of samples, and samples in the files of known networks."""

from __future__ import annotations

import hashlib
import pickle
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import raymap

ARRAYS = ("distance", "occupancy", "gradient", "closest", "winding", "confidence", "kind", "weight")


@pytest.fixture(scope="module")
def surface(ball) -> raymap.Surface:
    """A ball of the sizes 4, 2 and 1, far from 0."""
    return raymap.Surface(ball.vertices * (2, 1, 0.5) + (1, -2, 3), ball.faces)


def digest(block: dict[str, np.ndarray]) -> str:
    return hashlib.sha256(b"".join(name.encode() + array.tobytes() for name, array in sorted(block.items()))).hexdigest()


@pytest.mark.parametrize("dtype", ["float16", "float32", "float64"])
def test_blocks_say_of_their_points_what_the_surface_says(surface: raymap.Surface, dtype: str) -> None:
    options: dict = dict(near=0.5, sigma=(0.1, 0.01), surface=0.2, normalize="cube", dtype=dtype)
    block = raymap.Sampler(surface, 1000, arrays=ARRAYS, block=1000, **options)[0]
    sampler = raymap.Sampler(surface, 0, **options)
    assert sampler.scale == pytest.approx(0.5) and sampler.centre == pytest.approx((1, -2, 3), abs=1e-6)
    assert {name: array.dtype.name for name, array in block.items()} == {
        **dict.fromkeys(("points", "distance", "gradient", "closest", "winding", "confidence", "weight"), dtype),
        "occupancy": "bool", "kind": "uint8",
    }  # fmt: skip
    assert np.bincount(block["kind"]).tolist() == [200, 250, 250, 300]
    places = block["points"].astype(np.float64) / sampler.scale + sampler.centre
    truth = surface.query(places, ("distance", "closest", "direction", "winding", "confidence"))
    off, near = block["kind"] > 0, dict(atol=2e-3 if dtype == "float16" else 1e-6)
    np.testing.assert_allclose(block["distance"][off], truth.distance[off] * sampler.scale, **near)
    assert (block["distance"][~off] == 0).all() and not block["occupancy"][~off].any()
    np.testing.assert_array_equal(block["occupancy"][off], truth.distance[off] < 0)
    assert 0 < block["occupancy"].sum() < 800
    np.testing.assert_allclose(block["closest"], (truth.closest - sampler.centre) * sampler.scale, **near)
    np.testing.assert_allclose(block["winding"], truth.winding, **near)
    np.testing.assert_allclose(block["confidence"], truth.confidence, **near)
    outwards = np.where(truth.distance[:, None] < 0, truth.direction, -truth.direction)
    np.testing.assert_allclose(block["gradient"][off], outwards[off], **near)
    np.testing.assert_allclose(np.linalg.norm(block["gradient"][~off].astype(float), axis=1), 1, atol=1e-3)
    sums = [block["weight"][block["kind"] == kind].astype(float).sum() for kind in range(4)]
    np.testing.assert_allclose(sums, 250, rtol=1e-3)


def test_a_stream_is_the_same_whoever_makes_it(surface: raymap.Surface) -> None:
    def stream(**changed) -> raymap.Sampler:
        return raymap.Sampler(surface, 2500, **{"arrays": ARRAYS, "block": 1000, "seed": 5, **changed})

    sampler = stream()
    hashes = [digest(block) for block in sampler]
    assert len(hashes) == len(sampler) == 3 and len(set(hashes)) == 3
    assert [len(block["points"]) for block in sampler] == [1000, 1000, 500]
    assert [digest(sampler[k]) for k in (2, 1, 0, -1)] == [hashes[k] for k in (2, 1, 0, 2)]
    assert digest(stream(threads=1)[1]) == digest(pickle.loads(pickle.dumps(sampler))[1]) == hashes[1]
    assert digest(stream(seed=6)[1]) != hashes[1]
    assert digest(raymap.Sampler(surface, 10**15, arrays=ARRAYS, block=1000, seed=5)[1]) == hashes[1]
    ordered = stream(shuffle=False)[0]
    assert (np.diff(ordered["kind"].astype(int)) >= 0).all() and (np.diff(sampler[0]["kind"].astype(int)) < 0).any()
    order, shuffled = (np.lexsort(block["points"].T) for block in (ordered, sampler[0]))
    for name in ordered:
        np.testing.assert_array_equal(ordered[name][order], sampler[0][name][shuffled])
    assert len(raymap.Sampler(surface, 0)) == 0
    with pytest.raises(IndexError, match="there are 3 blocks"):
        sampler[3]


def test_a_process_of_its_own_makes_the_same_points() -> None:
    program = (
        "import raymap, hashlib; s = raymap.Sampler('ball.ply', 10**12, normalize=True, region='cube', block=500)\n"
        "print(hashlib.sha256(s[10**9]['points'].tobytes()).hexdigest())"
    )
    ran = subprocess.run([sys.executable, "-c", program], check=True, capture_output=True, text=True)
    assert ran.stdout.strip() == "98b2be62544276215d3e7b0f4ea2e0f5bb44139d1b0144919d5ef0d6232fe521"


@pytest.mark.parametrize("options, centre, reach, is_cube", [
    (dict(region="cube"), (1, -2, 3), 2, True),
    (dict(region="cube", padding=0.25), (1, -2, 3), 3, True),
    (dict(region="sphere", padding=0.5), (1, -2, 3), 4, False),
    (dict(region="cube", normalize="unit", padding=0.05), (0, 0, 0), 0.55, True),
    (dict(region="cube", normalize="cube"), (0, 0, 0), 1, True),
    (dict(region="cube", normalize=True), (0, 0, 0), 1, True),
    (dict(region="sphere", normalize="cube"), (0, 0, 0), 1, False),
])  # fmt: skip
def test_regions(surface: raymap.Surface, options: dict, centre, reach: float, is_cube: bool) -> None:
    """Points fill them evenly: a share of 1/8 lies within half of the reach."""
    samples = raymap.sample_points(surface, 4000, near=0, **options)
    away = samples.points - centre
    size = np.abs(away).max(axis=1) if is_cube else np.linalg.norm(away, axis=1)
    assert 0.99 * reach < size.max() <= reach * (1 + 1e-6)
    assert np.mean(size < reach / 2) == pytest.approx(1 / 8, abs=0.02)
    assert np.abs(away.mean(axis=0)).max() < 0.05 * reach
    places = samples.points / samples.scale + samples.centre
    np.testing.assert_allclose(samples.distance, surface.signed_distance(places) * samples.scale, atol=1e-6)


def load(name: str, path: str, mesh, **options) -> dict[str, np.ndarray]:
    raymap.recipes.save(name, mesh, path, n=4000, **options)  # type: ignore[arg-type]
    before = Path(path).read_bytes()
    raymap.recipes.save(name, mesh, path, n=4000, threads=1, **options)  # type: ignore[arg-type]
    assert Path(path).read_bytes() == before
    if path.endswith(".npz"):
        return dict(np.load(path))
    return {"rows": np.load(path) if path.endswith(".npy") else np.genfromtxt(path)}


def test_deepsdf(surface: raymap.Surface) -> None:
    found = load("deepsdf", "a.npz", surface)
    rows = np.concatenate([found["pos"], found["neg"]]).astype(float)
    assert rows.shape == (4000, 4) and found["pos"].dtype == np.float32
    assert found["scale"] == pytest.approx(1 / 2.06, rel=1e-3)  # The ball holds the mesh, with 3 % to spare.
    truth = surface.signed_distance(rows[:, :3] / found["scale"] + found["centre"]) * found["scale"]
    np.testing.assert_allclose(rows[:, 3], truth, atol=1e-6)
    assert (found["neg"][:, 3] < 0).all() and (found["pos"][:, 3] >= 0).all()
    # A flat surface moves points by a share of the deviation along its normal alone.
    assert 0.02 < np.median(np.abs(rows[:, 3])) < 0.05


def test_occupancy_networks(surface: raymap.Surface) -> None:
    found = load("occupancy_networks", "a.npz", surface)
    assert sorted(found) == ["loc", "occupancies", "points", "scale"]
    assert found["scale"] == pytest.approx(4) and found["loc"] == pytest.approx((1, -2, 3), abs=1e-6)
    assert 0.54 < np.abs(found["points"]).max() <= 0.55 and found["points"].dtype == np.float32
    inside = np.unpackbits(found["occupancies"])[:4000].astype(bool)
    np.testing.assert_array_equal(inside, surface.contains(found["points"].astype(float) * found["scale"] + found["loc"]))
    cloud = load("occupancy_networks_pointcloud", "b.npz", surface)
    assert sorted(cloud) == ["loc", "normals", "points", "scale"]
    away = surface.signed_distance(cloud["points"].astype(float) * cloud["scale"] + cloud["loc"])
    assert np.abs(away).max() < 1e-6 and (cloud["normals"] * cloud["points"]).sum(axis=1).min() > 0


@pytest.mark.parametrize("name, path", [("igr", "a.npy"), ("siren", "a.xyz")])
def test_points_with_normals(surface: raymap.Surface, name: str, path: str) -> None:
    rows = load(name, path, surface)["rows"]
    assert rows.shape == (4000, 6) and rows.dtype == np.float64
    samples = raymap.sample_points(surface, 4000, near=0, surface=1, normalize=True)
    np.testing.assert_allclose(rows, np.column_stack([samples.points, samples.gradient]), atol=1e-8)


def test_nglod(surface: raymap.Surface) -> None:
    found = load("nglod", "a.npz", surface)
    assert found["pts"].shape == (4000, 3) and found["d"].shape == (4000, 1)
    away = np.abs(found["d"][:, 0])
    assert (away[:1600] == 0).all() and away[1600:3200].mean() == pytest.approx(0.01 * np.sqrt(2 / np.pi), rel=0.1)
    assert 0.99 < np.abs(found["pts"][3200:]).max() <= 1
    truth = surface.signed_distance(found["pts"].astype(float) / found["scale"] + found["centre"]) * found["scale"]
    np.testing.assert_allclose(found["d"][:, 0], truth, atol=1e-6)


def test_instant_ngp(surface: raymap.Surface) -> None:
    found = load("instant_ngp", "a.npz", surface)
    assert (found["distances"][:2000] == 0).all() and (np.abs(found["distances"][2000:3500]) < 0.005).all()
    assert 0 <= found["positions"].min() < 0.01 and 0.99 < found["positions"].max() <= 1
    places = found["positions"].astype(float) / found["scale"] + found["centre"]
    np.testing.assert_allclose(found["distances"], surface.signed_distance(places) * found["scale"], atol=2e-7)


def test_data_sets_follow_recipes(meshes: Path) -> None:
    options: dict = dict(what="points", recipe="siren", n=300, seed=3)
    assert len(raymap.dataset.generate(meshes, "out", workers=2, **options).new) == 4
    raymap.recipes.save("siren", meshes / "ball.ply", "one.xyz", n=300, seed=3)
    assert Path("out/ball.ply.points.xyz").read_bytes() == Path("one.xyz").read_bytes()
    assert raymap.dataset.generate(meshes, "out", **options).new == []
    with pytest.raises(raymap.UsageError, match="near is no option of the recipe siren"):
        raymap.dataset.generate(meshes, "out", near=0.5, **options)
    with pytest.raises(raymap.UsageError, match="there is no recipe 'nerf'; there are deepsdf, occ"):
        raymap.dataset.generate(meshes, "out", what="points", recipe="nerf")  # type: ignore[arg-type]
    with pytest.raises(raymap.UsageError, match="needs n, the number of points of each mesh, or a recipe"):
        raymap.dataset.generate(meshes, "out", what="points")


@pytest.mark.parametrize("options, text", [
    (dict(arrays="normal"), "nothing is named 'normal'; there are distance, occupancy"),
    (dict(dtype="int32"), "dtype must be float16, float32 or float64, not int32"),
    (dict(region="box"), "region must be 'sphere' or 'cube', not 'box'"),
    (dict(block=0), "block must be 1 or more, not 0"),
    (dict(padding=-0.1), "padding must be 0 or more, not -0.1"),
    (dict(normalize="ball"), "normalize must be True"),
    (dict(near=0.7, surface=0.7), "at most 1 together"),
    (dict(n=-1), "n must be 0 or more"),
])  # fmt: skip
def test_arguments_that_make_no_sense(surface: raymap.Surface, options: dict, text: str) -> None:
    with pytest.raises(raymap.UsageError, match=text):
        raymap.Sampler(surface, **{"n": 100, **options})


def test_a_recipe_has_its_own_extension(surface: raymap.Surface) -> None:
    with pytest.raises(raymap.UsageError, match="a.npz: the recipe igr is written as .npy"):
        raymap.recipes.save("igr", surface, "a.npz")
