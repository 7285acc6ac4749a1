"""Fields that can be stacked: shapes, normalized meshes, truncation, pyramids."""

from __future__ import annotations

import csv
import hashlib
import pickle
import warnings
from pathlib import Path

import numpy as np
import pytest
import raymap
from conftest import make_ball
from data_set import run_module
from helpers import load
from raymap import _frames
from raymap.dataset.read import Results


@pytest.fixture(scope="module")
def long_mesh() -> raymap.Mesh:
    """A ball of the sizes 4, 2 and 1, far from 0."""
    vertices, faces = make_ball(2)
    return raymap.Mesh(vertices * (2, 1, 0.5) + (10, -20, 30), faces)


def positions(field: raymap.Field) -> np.ndarray:
    return field.origin + field.spacing * np.moveaxis(np.indices(field.shape), 0, -1)


def assert_exact(field: raymap.Field, mesh: raymap.Mesh, scale: float = 1.0, centre=(0, 0, 0), limit: float = np.inf) -> None:
    """Compares all samples with distances to the mesh itself."""
    truth = raymap.signed_distance(mesh, positions(field) / scale + np.array(centre)) * scale
    np.testing.assert_allclose(field.distance, np.clip(truth, -limit, limit), atol=5e-6)


def test_a_cube_has_as_many_samples_along_every_side(long_mesh: raymap.Mesh) -> None:
    field = raymap.generate(long_mesh, resolution=16, cube=True, device="cpu")
    assert field.shape == (16, 16, 16) and field.spacing == pytest.approx(4 * 1.2 / 16)
    np.testing.assert_allclose(positions(field).mean(axis=(0, 1, 2)), (10, -20, 30), atol=1e-5)
    assert_exact(field, long_mesh)
    assert raymap.Surface(long_mesh).generate(resolution=16, cube=True, device="cpu").spacing == field.spacing
    assert raymap.generate(long_mesh, resolution=16, cube=True, sparse=True).shape == (16, 16, 16)


def test_a_shape_holds_the_box_with_the_smallest_cells(long_mesh: raymap.Mesh) -> None:
    field = raymap.generate(long_mesh, shape=(32, 8, 8), padding=0.25, device="cpu")
    assert field.shape == (32, 8, 8) and field.spacing == pytest.approx((2 + 2) / 8)  # y needs the largest cells.
    boxed = raymap.generate(long_mesh, shape=np.array((6, 6, 4)), bounds=((8, -21, 29), (12, -19, 31)), device="cpu")
    assert boxed.spacing == pytest.approx(4 / 6) and boxed.shape == (6, 6, 4)
    np.testing.assert_allclose(boxed.origin, (10 - 2.5 * 4 / 6, -20 - 2.5 * 4 / 6, 30 - 1.5 * 4 / 6))
    cut = raymap.generate(long_mesh, shape=(4, 4, 4), voxel_size=0.125, device="cpu")
    np.testing.assert_allclose(cut.origin, (10 - 0.1875, -20 - 0.1875, 30 - 0.1875), atol=1e-5)
    assert (cut.distance < 0).all()
    wall = raymap.generate(long_mesh, shape=(24, 24, 24), padding=0, thickness=0.5, device="cpu")
    assert wall.spacing == pytest.approx(4.5 / 24)


def test_a_shape_of_the_command_line_gives_the_same_field(long_mesh: raymap.Mesh, run_raymap) -> None:
    long_mesh.save("long.ply")
    bounds = ((9, -21, 29), (11.5, -19, 30.75))
    for arguments, options in (
        (("--shape", 12, 12, 12), dict(resolution=12, cube=True)),
        (("--shape", 13, 7, 5, "--padding", 0.3), dict(shape=(13, 7, 5), padding=0.3)),
        (("--shape", 13, 7, 5, "--voxel-size", 0.3, "--thickness", 0.1), dict(shape=(13, 7, 5), voxel_size=0.3, thickness=0.1)),
        (("--shape", 9, 7, 5, "--bounds", *np.ravel(bounds)), dict(shape=(9, 7, 5), bounds=bounds)),
    ):  # fmt: skip
        run_raymap("generate", "long.ply", "-o", "long.npz", "--device", "cpu", *arguments)
        made, field = raymap.load_field("long.npz"), raymap.generate("long.ply", device="cpu", **options)
        assert made.spacing == field.spacing and made.origin.tolist() == field.origin.tolist()
        np.testing.assert_array_equal(made.distance, field.distance)
    run_raymap("generate", "long.ply", "-o", "long.vdb", "--shape", 40, 41, 42, "--band", 3, "--full-inside")
    raymap.generate("long.ply", shape=(40, 41, 42), sparse=True, band=(np.inf, 3)).save("band.vdb")
    assert Path("long.vdb").read_bytes() == Path("band.vdb").read_bytes()


def test_an_origin_says_all_samples(long_mesh: raymap.Mesh) -> None:
    field = raymap.generate(long_mesh, shape=(5, 6, 7), origin=(9, -21, 29), voxel_size=0.375, device="cpu")
    assert field.shape == (5, 6, 7) and field.spacing == 0.375 and field.origin.tolist() == [9, -21, 29]
    assert_exact(field, long_mesh)


@pytest.mark.parametrize("normalize, size", [("cube", 4 / 2), ("unit", 4.0), ("sphere", 2.0), (True, 2.0)])
def test_normalized(long_mesh: raymap.Mesh, normalize, size: float) -> None:
    field = raymap.generate(long_mesh, shape=(12, 10, 8), normalize=normalize, device="cpu", arrays="triangle")
    np.testing.assert_allclose(field.centre, (10, -20, 30), atol=1e-5)
    assert field.scale == pytest.approx(1 / size, rel=1e-6)
    assert_exact(field, long_mesh, field.scale, field.centre)
    back = field.denormalized()
    assert back.scale == 1 and not back.centre.any() and back.shape == field.shape
    assert_exact(back, long_mesh)
    np.testing.assert_array_equal(back.triangle, field.triangle)
    np.testing.assert_allclose(back.surface_bounds, long_mesh.bounds, atol=1e-4)
    assert back.stats is field.stats


@pytest.mark.parametrize("band", [2, (np.inf, 3)])
def test_normalized_narrow_bands(long_mesh: raymap.Mesh, band) -> None:
    options: dict = dict(resolution=40, cube=True, normalize="unit", arrays="triangle")
    sparse = raymap.generate(long_mesh, sparse=True, band=band, **options)
    assert sparse.shape == (40, 40, 40) and sparse.scale == pytest.approx(1 / 4)
    np.testing.assert_allclose(sparse.centre, (10, -20, 30), atol=1e-5)
    dense = sparse.to_dense()
    assert dense.scale == sparse.scale and dense.centre.tolist() == sparse.centre.tolist()
    truth = raymap.signed_distance(long_mesh, positions(dense) / dense.scale + dense.centre) * dense.scale
    np.testing.assert_allclose(dense.distance, np.clip(truth, -sparse.inside, sparse.outside), atol=5e-6)
    back, copy = sparse.denormalized(), pickle.loads(pickle.dumps(sparse))
    assert back.scale == 1 and not back.centre.any() and back.inside == pytest.approx(sparse.inside * 4)
    assert copy.scale == sparse.scale and copy.centre.tolist() == sparse.centre.tolist()
    np.testing.assert_allclose(back.to_dense().distance, dense.denormalized().distance)
    np.testing.assert_allclose(back.origin, dense.denormalized().origin)
    np.testing.assert_array_equal(back.triangle, sparse.triangle)
    np.testing.assert_allclose(back.surface_bounds, long_mesh.bounds, atol=1e-4)
    np.testing.assert_array_equal(dense.to_sparse(band=1).scale, dense.scale)
    with pytest.raises(raymap.UsageError, match="a.vdb: no file holds the centre and scale of a normalized narrow band; save"):
        sparse.save("a.vdb")
    back.save("a.vdb")
    assert raymap.load_field("a.vdb", sparse=True).outside == back.outside


def test_the_farthest_vertex_decides_the_sphere() -> None:
    """A tetrahedron, whose ball about the centre of its bounds is larger than half of its longest side."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (50, 0, 0)]  # No face uses the last one.
    mesh = raymap.Mesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    frame = _frames.frame_of(mesh, "sphere")
    assert frame.scale == pytest.approx(1 / np.sqrt(0.75)) and frame.centre.tolist() == [0.5, 0.5, 0.5]
    assert _frames.frame_of(mesh, "cube").scale == 2 and _frames.frame_of(mesh, "unit").scale == 1


def test_a_file_keeps_the_frame(long_mesh: raymap.Mesh) -> None:
    field = raymap.generate(long_mesh, resolution=8, cube=True, normalize="unit", truncation=0.2, device="cpu")
    hashes = []
    for _ in range(2):
        field.save("whole.npz")
        hashes.append(hashlib.sha256(Path("whole.npz").read_bytes()).hexdigest())
    assert hashes[0] == hashes[1]
    with np.load("whole.npz") as stored:
        assert stored["scale"] == field.scale and stored["centre"].tolist() == field.centre.tolist()
    for again in (raymap.load_field("whole.npz"), pickle.loads(pickle.dumps(field))):
        assert again.scale == field.scale and again.centre.tolist() == field.centre.tolist()
        np.testing.assert_array_equal(again.distance, field.distance)
        assert again.clamp_distance == field.clamp_distance
    assert [path.name for path in Path().glob("*.npz")] == ["whole.npz"] and not list(Path().glob(".*"))
    with pytest.raises(raymap.UsageError, match=r"whole.vdb: only a .npz holds the centre and scale of a normalized field"):
        field.save("whole.vdb")
    field.denormalized().save("whole.nrrd")
    made = raymap.Field(field.distance, field.origin, field.spacing, centre=field.centre, scale=field.scale)
    assert made.denormalized().spacing == field.denormalized().spacing
    with pytest.raises(raymap.FileError, match=r"gone.+cannot write: No such file"):
        field.save("gone/whole.npz")
    np.savez("odd.npz", distance=field.distance, scale=np.float64(-1), centre=np.zeros(3))
    with pytest.raises(raymap.InputError, match="odd.npz: scale must be a finite number above 0, not -1"):
        raymap.load_field("odd.npz")
    np.savez("odd.npz", distance=field.distance, scale=np.array("a"), centre=np.zeros(3))
    with pytest.raises(raymap.InputError, match="odd.npz: its centre or scale is no array of numbers"):
        raymap.load_field("odd.npz")


def test_truncated_distances(long_mesh: raymap.Mesh) -> None:
    field = raymap.generate(long_mesh, resolution=16, cube=True, truncation=0.3, device="cpu")
    assert field.clamp_distance == pytest.approx(0.3)
    assert_exact(field, long_mesh, limit=0.3)
    tsdf = field.tsdf()
    assert tsdf.dtype == np.float32 and tsdf.min() == -1 and tsdf.max() == 1
    np.testing.assert_allclose(tsdf * 0.3, field.distance, atol=1e-6)
    band = raymap.generate(long_mesh, resolution=16, truncation=0.6, sparse=True)
    assert band.outside == pytest.approx(0.6)
    with pytest.raises(raymap.UsageError, match="tsdf.. needs clamped distances"):
        raymap.generate(long_mesh, resolution=8, device="cpu").tsdf()


def test_levels_of_a_pyramid_fill_one_box(long_mesh: raymap.Mesh) -> None:
    options: dict = dict(shape=(16, 9, 8), band=1.5, normalize="cube", device="cpu")
    with pytest.warns(raymap.RaymapWarning, match="no sample is inside"):  # on the coarsest level
        levels = raymap.generate_pyramid(long_mesh, levels=3, **options)
    assert [level.shape for level in levels] == [(16, 9, 8), (8, 5, 4), (4, 3, 2)]
    low = levels[0].origin - levels[0].spacing / 2
    for k, level in enumerate(levels):
        assert level.spacing == pytest.approx(levels[0].spacing * 2**k)
        assert level.scale == levels[0].scale
        np.testing.assert_allclose(level.origin - level.spacing / 2, low, atol=1e-12)
        assert_exact(level, long_mesh, level.scale, level.centre, limit=1.5 * levels[0].spacing)


@pytest.mark.parametrize(
    "options",
    [
        dict(band=2, normalize="unit", arrays=("winding", "confidence", "triangle")),
        dict(bounds=((8, -22, 28), (12, -18, 32))),
    ],
)
def test_a_pyramid_comes_back_from_its_file(long_mesh: raymap.Mesh, options: dict) -> None:
    levels = raymap.generate_pyramid(long_mesh, levels=3, resolution=12, device="cpu", **options)
    raymap.save_pyramid(levels, "levels.npz")
    loaded = raymap.load_pyramid("levels.npz")
    assert len(loaded) == 3
    for given, found in zip(levels, loaded):
        assert (found.spacing, found.clamp_distance, found.scale) == (given.spacing, given.clamp_distance, given.scale)
        assert found.arrays == given.arrays and found.origin.tolist() == given.origin.tolist()
        assert found.centre.tolist() == given.centre.tolist()
        np.testing.assert_array_equal(found.surface_bounds, given.surface_bounds)
        for name in given.arrays:
            np.testing.assert_array_equal(getattr(found, name), getattr(given, name))
    with pytest.warns(raymap.RaymapWarning, match="it also holds 'distance_1'"):
        finest = raymap.load_field("levels.npz")
    np.testing.assert_array_equal(finest.distance, levels[0].distance)
    levels[1].save("one.npz")  # A field alone is a pyramid, too.
    assert [level.shape for level in raymap.load_pyramid("one.npz")] == [levels[1].shape]


def test_wrong_pyramids(long_mesh: raymap.Mesh) -> None:
    one, other = (raymap.generate(long_mesh, resolution=6, normalize=normalize, device="cpu") for normalize in (True, False))
    with pytest.raises(raymap.UsageError, match="levels.vdb: a pyramid is saved as .npz"):
        raymap.save_pyramid([one], "levels.vdb")
    with pytest.raises(raymap.UsageError, match="levels: there is none"):
        raymap.save_pyramid([], "levels.npz")
    with pytest.raises(raymap.UsageError, match="levels: number 1 has another centre or scale than number 0"):
        raymap.save_pyramid([one, other], "levels.npz")
    raymap.save_pyramid([one, one], "levels.npz")
    arrays = dict(np.load("levels.npz"))
    for change, text in (
        ({"spacing_1": None}, "there is no array 'spacing_1'"),
        ({"distance": None}, "there is no array 'distance'"),
        ({"spacing_1": np.float64(0)}, "spacing must be above 0"),
        ({"origin": np.zeros(2)}, "origin must be"),
        ({"surface_bounds_1": np.zeros(5)}, "cannot reshape"),
        ({"scale": np.float64(-1)}, "scale must be"),
    ):
        np.savez("bad.npz", **{name: array for name, array in {**arrays, **change}.items() if array is not None})
        with pytest.raises(raymap.InputError, match=f"bad.npz: {text}"):
            raymap.load_pyramid("bad.npz")
    Path("bad.npz").write_bytes(Path("levels.npz").read_bytes()[:500])
    with pytest.raises(raymap.InputError, match="bad.npz: no whole .npz"):
        raymap.load_pyramid("bad.npz")
    with pytest.raises(raymap.FileError, match="none.npz: cannot read"):
        raymap.load_pyramid("none.npz")


def test_data_sets_of_pyramids(meshes: Path) -> None:
    options: dict = dict(resolution=9, cube=True, band=4, normalize="cube")
    (meshes / "open.OBJ").unlink(), (meshes / "small.ply").unlink()
    names = raymap.dataset.generate(meshes, "out", pyramid=1, **options).done
    assert names == ["ball.ply", "deep/tetrahedron.ply"]
    load("zarr")
    raymap.dataset.pack("out", "tars")
    raymap.dataset.pack("out", "arrays", format="zarr")
    readers = [Results(place) for place in ("out", "tars", "arrays")]
    for k, name in enumerate(names):
        levels = raymap.generate_pyramid(meshes / name, levels=2, device="cpu", **options)
        for level, found in zip(levels, raymap.load_pyramid(f"out/{name}.npz"), strict=True):
            np.testing.assert_array_equal(found.distance, level.distance)
        for reader in readers:
            item = reader[k]
            np.testing.assert_array_equal(item["distance"], levels[0].distance)
            np.testing.assert_array_equal(item["distance_1"], levels[1].distance)
            assert float(item["spacing_1"]) == levels[1].spacing
    assert raymap.dataset.generate(meshes, "out", pyramid=1, **{**options, "band": 4.0}).new == []
    assert raymap.dataset.generate(meshes, "out", dry_run=True, **options).new == names
    for given, text in (
        (dict(pyramid=1, format="vdb"), "pyramid needs files of several grids, so the format npz, not 'vdb'"),
        (dict(pyramid=-1), "pyramid must be 0 or more, not -1"),
        (dict(pyramid=1, what="points", n=9), "pyramid is no option of points"),
    ):
        with pytest.raises(raymap.UsageError, match=text):
            raymap.dataset.generate(meshes, "out", **given)


def test_data_sets_can_be_stacked(meshes: Path) -> None:
    raymap.dataset.generate(meshes, "out", workers=2, resolution=12, cube=True, normalize="cube", truncation=0.2)
    rows = {row["mesh"]: row for row in csv.DictReader(open("out/table.csv"))}
    names = sorted(rows)
    fields = [raymap.load_field(f"out/{name}.npz") for name in names]
    stack = np.stack([field.distance for field in fields])
    assert stack.shape == (4, 12, 12, 12) and np.abs(stack).max() == pytest.approx(0.2)
    for name, field in zip(names, fields):
        assert field.origin == pytest.approx(fields[0].origin) and field.spacing == pytest.approx(0.2)
        assert_exact(field, raymap.load_mesh(meshes / name), field.scale, field.centre, limit=0.2)
        assert float(rows[name]["scale"]) == field.scale and float(rows[name]["centre_x"]) == field.centre[0]
    assert raymap.dataset.generate(meshes, "out", resolution=12, cube=True, normalize="cube", truncation=0.2).new == []
    ran = run_module(
        "dataset", meshes, "-o", "out", "--resolution", 12, "--cube", "--normalize", "cube", "--truncation", 0.2, "--pyramid", 0
    )
    assert ran.returncode == 0 and "0 of them new" in ran.stdout, ran.stdout + ran.stderr


def test_every_mesh_may_have_a_box(meshes: Path) -> None:
    paths = [meshes / "ball.ply", meshes / "small.ply"]
    boxes = {"ball.ply": ((-2, -2, -2), (2, 2, 2)), "small.ply": ((0, 0, 0), (1, 1, 1))}
    raymap.dataset.generate(paths, "out", shape=(8, 8, 8), bounds=boxes)
    for name, (low, high) in boxes.items():
        field = raymap.load_field(f"out/{name}.npz")
        assert field.spacing == (high[0] - low[0]) / 8 and field.origin[0] == low[0] + field.spacing / 2
    with pytest.raises(raymap.UsageError, match="bounds lacks small.ply; it needs a box for each mesh"):
        raymap.dataset.generate(paths, "out", bounds={"ball.ply": boxes["ball.ply"]})
    with pytest.raises(raymap.UsageError, match="bounds has a box of no mesh: large.ply"):
        raymap.dataset.generate(paths, "out", bounds={**boxes, "large.ply": boxes["ball.ply"]})
    with pytest.raises(raymap.UsageError, match="bounds of small.ply: each of x0"):
        raymap.dataset.generate(paths, "out", bounds={**boxes, "small.ply": ((1, 1, 1), (0, 0, 0))})


@pytest.mark.parametrize("options, text", [
    (dict(shape=(8, 8)), "shape must be whole numbers"),
    (dict(shape=(8, 8, 0)), "shape must be 1 or more, not 0"),
    (dict(shape=(8, 8, 8), cube=True), "shape and cube both"),
    (dict(cube=True, voxel_size=0.1), "a cube has resolution samples along each side"),
    (dict(origin=(0, 0, 0)), "origin needs shape and voxel_size"),
    (dict(origin=(0, 0, 0), shape=(8, 8, 8)), "origin needs shape and voxel_size"),
    (dict(normalize="ball"), "normalize must be True, False, 'sphere', 'cube', 'unit', not 'ball'"),
    (dict(truncation=0.1, band=3), "truncation takes the place of band"),
    (dict(truncation=0), "truncation must be above 0"),
])  # fmt: skip
def test_arguments_that_make_no_sense(options: dict, text: str) -> None:
    with pytest.raises(raymap.UsageError, match=text):
        raymap.generate("ball.ply", **options)


def test_a_mesh_without_a_size_cannot_be_normalized() -> None:
    point = raymap.Mesh([(1, 1, 1)] * 3, [(0, 1, 2)])
    with pytest.raises(raymap.InputError, match="all faces of the mesh lie in one point"):
        raymap.generate(point, normalize=True)


def test_a_frame_that_is_read_is_not_told_as_left_out(long_mesh: raymap.Mesh) -> None:
    raymap.generate(long_mesh, resolution=8, normalize="unit", device="cpu").save("unit.npz")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert raymap.load_field("unit.npz").scale == 0.25
