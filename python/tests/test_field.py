"""Fields: arrays, sampling, surfaces, files, pictures, pickling. Tests of what holds for both kinds take ``any_field``."""

from __future__ import annotations

import base64
import gc
import pickle
import re
import struct
import warnings
import zlib

import numpy as np
import pytest
import raymap

ALL = ("distance", "winding", "confidence", "triangle")
BOX = ((-1.25, -1.55, -1.85), (1.25, 1.55, 1.85))
LOW_BOX = ((-1.25, -1.55, -1.1), (1.25, 1.55, 1.1))


@pytest.fixture(scope="module")
def field(ball: raymap.Mesh) -> raymap.Field:
    return raymap.generate(ball, bounds=BOX, voxel_size=0.1, arrays=ALL, device="cpu")


@pytest.fixture(scope="module")
def band(ball: raymap.Mesh) -> raymap.Field:
    """A narrow band with tiles, and with leaves that reach beyond the grid."""
    return raymap.generate(ball, bounds=LOW_BOX, voxel_size=0.05, band=3, arrays=ALL, sparse=True)


@pytest.fixture(params=["dense", "narrow"])
def any_field(request: pytest.FixtureRequest, field: raymap.Field, band: raymap.Field) -> raymap.Field:
    return field if request.param == "dense" else band


def dense(field: raymap.Field) -> raymap.Field:
    return field.to_dense() if field.is_narrow else field


def positions(field: raymap.Field) -> np.ndarray:
    return field.origin + field.spacing * np.stack(np.indices(field.shape), axis=-1)


def test_arrays_are_views_with_x_fastest(any_field):
    shape, strides = (25, 31, 37), (4, 100, 3100)
    if any_field.is_narrow:
        shape, strides = (len(any_field.origins), 8, 8, 8), (2048, 4, 32, 256)
    assert any_field.arrays == ALL
    for name in ALL:
        array = getattr(any_field, name)
        assert array.dtype == (np.uint32 if name == "triangle" else np.float32)
        assert (array.shape, array.strides, array.flags.owndata) == (shape, strides, False)
        assert getattr(any_field, name) is array and np.shares_memory(any_field._core.array(name), array)


def test_distances_are_those_of_a_ball_negative_inside(any_field):
    truth = dense(any_field)
    exact = np.linalg.norm(positions(truth), axis=-1) - 1
    most = any_field.clamp_distance or np.inf
    assert np.abs(truth.distance - np.clip(exact, -most, most)).max() < 0.01


def test_leaves_hold_the_samples_at_their_origins(band):
    truth = band.to_dense()
    samples = band.origins[:, None, None, None] + np.stack(np.mgrid[:8, :8, :8], axis=-1)
    on_grid = (samples < band.shape).all(axis=-1)
    for name in ALL:
        np.testing.assert_array_equal(getattr(band, name)[on_grid], getattr(truth, name)[tuple(samples[on_grid].T)])
    assert 0 < (~on_grid).sum() and (band.distance[~on_grid] == np.float32(band.outside)).all()
    assert (band.origins % 8 == 0).all() and (band.tile_origins % band.tile_sides[:, None] == 0).all()
    assert len(band.tile_sides) > 0
    assert (band.distance < 0).sum() + (band.tile_sides**3).sum() == (truth.distance < 0).sum()
    assert truth.shape == band.shape and truth.spacing == band.spacing and (truth.origin == band.origin).all()
    assert truth.clamp_distance == band.clamp_distance == band.outside == band.inside == 3 * band.spacing
    again = truth.to_sparse()
    np.testing.assert_array_equal(again.origins, band.origins)
    np.testing.assert_array_equal(again.triangle, band.triangle)
    with pytest.raises(raymap.UsageError, match="clamped at 3 samples"):
        truth.to_sparse(band=4)
    with pytest.raises(AttributeError, match="the field is dense, and only a narrow band has 'origins'"):
        truth.origins  # noqa: B018


def test_grid(any_field):
    low, step = (LOW_BOX[0], 0.05) if any_field.is_narrow else (BOX[0], 0.1)
    np.testing.assert_allclose(any_field.origin, np.array(low) + step / 2, atol=1e-12)
    assert any_field.origin.shape == (3,) and any_field.origin.dtype == np.float64
    assert any_field.spacing == pytest.approx(step)
    leaves = f"50 x 62 x 44 samples, {len(any_field.origins)} leaves" if any_field.is_narrow else "25 x 31 x 37 samples"
    assert repr(any_field) == f"raymap.Field({leaves}, spacing {step}, arrays {', '.join(ALL)})"
    most = any_field.clamp_distance or np.inf
    assert any_field.active_count == (abs(any_field.distance) < np.float32(most)).sum() > 1000
    assert any_field.nbytes >= 4 * any_field.distance.nbytes


@pytest.mark.parametrize("sparse", [False, True])
def test_writing_into_a_view_changes_the_field(ball, sparse):
    field = raymap.generate(ball, resolution=24, padding=0.3, sparse=sparse)
    values = field.distance
    values[...] -= 0.1
    assert field.to_mesh().bounds[1] == pytest.approx(np.full(3, 1.1), abs=0.02)
    with pytest.raises(AttributeError):
        field.distance = values
    for name in ALL[1:]:
        with pytest.raises(AttributeError, match=f"ask for it, as in arrays=\\('distance', '{name}'\\)"):
            getattr(field, name)
    del field
    gc.collect()
    assert np.isfinite(values).all()  # They keep the memory.


def trilinear(field: raymap.Field, points: np.ndarray) -> np.ndarray:
    s = (points - field.origin) / field.spacing
    low = np.minimum(np.floor(s).astype(int), np.array(field.shape) - 2)
    t = s - low
    sum_ = np.zeros(points.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, t, 1 - t), axis=-1)
        sum_ += weight * field.distance[tuple(np.moveaxis(low + corner, -1, 0))]
    return sum_


def test_samples_are_trilinear_for_any_shape_of_points(any_field):
    truth = dense(any_field)
    inner = np.random.default_rng(1).uniform(1, np.array(any_field.shape) - 2, (4, 50, 3))
    points = any_field.origin + any_field.spacing * inner
    sampled, gradient = any_field.sample(points), any_field.gradient(points)
    assert sampled.shape == (4, 50) and gradient.shape == (4, 50, 3) and sampled.dtype == gradient.dtype == np.float32
    np.testing.assert_allclose(sampled, trilinear(truth, points), atol=1e-6)
    steps = np.eye(3) * any_field.spacing
    differences = [trilinear(truth, points + step) - trilinear(truth, points - step) for step in steps]
    np.testing.assert_allclose(gradient, np.stack(differences, axis=-1) / (2 * any_field.spacing), atol=1e-5)
    np.testing.assert_array_equal(any_field.sample(points[2, 7]), sampled[2, 7])
    np.testing.assert_array_equal(any_field.sample(points, threads=1), sampled)
    np.testing.assert_array_equal(any_field.sample(points[:, ::2]), sampled[:, ::2])
    assert any_field.sample(np.empty((0, 3))).shape == (0,) and any_field.gradient((0.5, 0, 0)).shape == (3,)
    assert np.isnan(any_field.sample((np.nan, 0, 0)))


def test_samples_outside_of_the_box_are_lower_bounds(ball, any_field):
    np.testing.assert_allclose(any_field.surface_bounds, ball.bounds, atol=1e-6)
    points = np.array([(0, 0, 9), (3, 0, 0), (0, 0, 0)])
    np.testing.assert_allclose(any_field.sample(points[:2]), (8, 2), atol=1e-2)
    for name in "sample", "gradient":
        found, bounds = getattr(any_field, name)(points, outside="nan"), getattr(any_field, name)(points)
        assert np.isnan(found[:2]).all() and (found[2] == bounds[2]).all()
    truth = dense(any_field)
    unknown = raymap.Field(truth.distance, truth.origin, truth.spacing)
    assert unknown.surface_bounds is None and (unknown.sample(points)[:2] < any_field.sample(points)[:2]).all()
    known = raymap.Field(truth.distance, truth.origin, truth.spacing, surface_bounds=truth.surface_bounds)
    np.testing.assert_array_equal(known.sample(points), any_field.sample(points))
    with pytest.raises(raymap.UsageError, match="outside must be 'bound' or 'nan', not 'zero'"):
        any_field.sample((0, 0, 0), outside="zero")
    for wrong in (((1, 2, 3), (1, 1, 4)), (1, 2, 3)):
        with pytest.raises(raymap.UsageError, match="surface_bounds"):
            raymap.Field(truth.distance, surface_bounds=wrong)


@pytest.mark.parametrize("points", [np.zeros((2, 2)), np.zeros(()), np.zeros((3, 4)), 1.0])
def test_points_of_another_shape_are_refused(field, points):
    with pytest.raises(raymap.InputError, match=r"points must be \(\.\.\., 3\)"):
        field.sample(points)


def test_points_that_are_no_numbers_are_refused(field):
    with pytest.raises(raymap.InputError, match="points must be numbers"):
        field.gradient([("a", "b", "c")])


def test_to_mesh_lies_at_the_distance(any_field):
    for iso in (0.0, 0.1, -0.1):
        mesh = any_field.to_mesh(iso)
        np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1 + iso, atol=0.02)
    with pytest.raises(raymap.UsageError):
        any_field.to_mesh(-9.0)


def test_a_surface_that_reaches_the_box_warns(field):
    with pytest.warns(raymap.RaymapWarning, match="reaches the grid's box"):
        field.to_mesh(0.5)


@pytest.mark.parametrize("extension", ["vdb", "nvdb", "nrrd", "npz", "npy", "vti"])
def test_files_give_back_the_same_bits(field, extension):
    path = f"field.{extension}"
    field.save(path)
    read = raymap.load_field(path)
    np.testing.assert_array_equal(read.distance, field.distance)
    if extension != "npy":
        np.testing.assert_array_equal(read.surface_bounds, field.surface_bounds)
        np.testing.assert_allclose(read.origin, field.origin)
        assert read.spacing == pytest.approx(field.spacing)
    assert read.stats["device"] == "" and read.stats["stages"] == []


@pytest.mark.parametrize("extension", ["vdb", "nvdb"])
def test_files_give_back_narrow_bands(band, extension, tmp_path):
    path = tmp_path / f"ball.{extension}"
    band.save(path)
    for again in raymap.load_field(path, sparse=True), raymap.load_field(str(path), grid="distance", sparse=True):
        assert again.arrays == band.arrays and again.outside == band.outside and again.inside == band.inside
        for name in "distance", "origins", "triangle", "winding", "confidence", "tile_origins", "tile_sides", "origin":
            np.testing.assert_array_equal(getattr(again, name), getattr(band, name))
    assert raymap.load_field(path, grid="winding").arrays == ("winding",)
    for sparse in (False, True):
        with pytest.raises(raymap.UsageError, match="it has no grid 'surface'; its grids are 'confidence', 'distance'"):
            raymap.load_field(path, grid="surface", sparse=sparse)
    with pytest.raises(TypeError, match="grid must be a text"):
        raymap.load_field(path, grid=3)  # type: ignore[arg-type]


def test_a_named_array_can_be_saved(field):
    field.save("winding.nrrd", "winding")
    read = raymap.load_field("winding.nrrd")
    assert read.arrays == ("winding",)
    np.testing.assert_array_equal(read.winding, field.winding)
    field.save("all.npz")
    assert raymap.load_field("all.npz").arrays == ALL


def test_arrays_that_are_left_out_are_told(field):
    np.savez("more.npz", distance=field.distance, heat=[1.0], density=[2.0])
    with pytest.warns(raymap.RaymapWarning, match="more.npz: it also holds 'heat' and 'density', which") as warned:
        np.testing.assert_array_equal(raymap.load_field("more.npz").distance, field.distance)
    assert warned[0].message.code == "file_content"


def test_errors_of_files(field, band):
    with pytest.raises(raymap.UsageError):
        field.save("field.txt")
    with pytest.raises(ValueError):
        field.save("field.nrrd", "colour")
    with pytest.raises(raymap.FileError):
        field.save("missing/field.nrrd")
    with pytest.raises(raymap.UsageError, match="npz"):
        band.save("ball.npz")
    with pytest.raises(OSError, match="gone.nrrd"):
        raymap.load_field("gone.nrrd")
    with open("bad.nrrd", "w") as file:
        file.write("nonsense")
    with pytest.raises(raymap.InputError, match="bad.nrrd"):
        raymap.load_field("bad.nrrd")


def test_slice(field):
    middle = field.slice("z", width=100)
    assert middle.shape == (124, 100, 3) and middle.dtype == np.uint8
    np.testing.assert_array_equal(field.slice(2, 18, width=100), middle)
    np.testing.assert_array_equal(field.slice(2, -19, width=100), middle)
    first = field.slice("z", 0, width=100)
    assert (first != middle).any()
    np.testing.assert_array_equal(field.slice("z", -37, width=100), first)
    assert field.slice("x", width=62).shape == (74, 62, 3)
    assert (field.slice("z", array="winding", width=100) != middle).any()


@pytest.mark.parametrize("axis, index", [("w", None), (3, None), (0, 50), ("x", -51)])
def test_slices_that_do_not_exist_are_refused(any_field, axis, index):
    with pytest.raises(raymap.UsageError):
        any_field.slice(axis, index)


def test_render(any_field):
    def draw(**options):
        return any_field.render(width=80, height=60, device="cpu", **options)

    picture = draw()
    assert picture.shape == (60, 80, 3) and picture.dtype == np.uint8
    assert (picture[30, 40] != picture[0, 0]).any()
    stages = []
    np.testing.assert_array_equal(draw(threads=1, progress=lambda stage, done: stages.append(stage)), picture)
    assert set(stages) == {"render"}
    looks = (dict(direction=(1, 0, 0)), dict(cut=True), dict(cut=True, shell=0.1), dict(field_of_view=60), dict(up=(1, 0, 0)),
             dict(eye=(0.2, 0.1, 6)), dict(frame=((0, 0, 0), (0.2, 0.2, 0.2))), dict(cut_plane=(0, 0, 1, 0.3)), dict(iso=0.1),
             dict(slice_plane=(0, 0, 1, 0.7)))  # fmt: skip
    pictures = [picture, *(draw(**look) for look in looks)]
    assert len({each.tobytes() for each in pictures}) == len(pictures)
    np.testing.assert_array_equal(draw(cut_plane=(0, 0, 0.5, 0)), draw(cut=True))
    np.testing.assert_array_equal(draw(slice_plane=(0, 0, 2, 1.4)), draw(slice_plane=(0, 0, 1, 0.7)))
    for wrong in ({"width": 0}, {"field_of_view": 0}, {"eye": (1, 2)}, {"device": "gpu"}):
        with pytest.raises(raymap.UsageError):
            any_field.render(**wrong)


def test_html_shows_the_middle_slice(field):
    html = field._repr_html_()
    assert "25 × 31 × 37" in html and "negative inside" in html
    data = base64.b64decode(re.search(r"base64,([^']+)", html)[1])
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    width, height = struct.unpack(">II", data[16:24])
    length = struct.unpack(">I", data[33:37])[0]
    rows = np.frombuffer(zlib.decompress(data[41:41 + length]), np.uint8).reshape(height, 1 + 3 * width)
    assert (rows[:, 0] == 0).all()
    np.testing.assert_array_equal(rows[:, 1:].reshape(height, width, 3), field.slice("z", width=256))
    at = 8
    while at < len(data):  # The check of every chunk.
        size = struct.unpack(">I", data[at:at + 4])[0]
        assert zlib.crc32(data[at + 4:at + 8 + size]) == struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0]
        at += 12 + size


def test_html_of_a_narrow_band_counts_its_samples(band):
    assert f">{band.active_count}<" in band._repr_html_()
    with pytest.raises(TypeError, match="make it dense by to_dense"):
        np.asarray(band)


def test_pickling_keeps_everything(any_field):
    copy = pickle.loads(pickle.dumps(any_field))
    names = (*ALL, "origins", "tile_origins", "tile_sides") if any_field.is_narrow else ALL
    for name in names:
        np.testing.assert_array_equal(getattr(copy, name), getattr(any_field, name))
        assert getattr(copy, name).strides == getattr(any_field, name).strides
    assert repr(copy) == repr(any_field) and (copy.origin == any_field.origin).all()
    assert copy.spacing == any_field.spacing and copy.clamp_distance == any_field.clamp_distance
    assert copy.stats["device"] == "cpu" and copy.stats["stages"] == any_field.stats["stages"]
    np.testing.assert_array_equal(copy.surface_bounds, any_field.surface_bounds)


def test_pickles_that_make_no_sense_are_refused(field, band):
    clamped = raymap.Field(np.zeros((2, 2, 2)), clamp_distance=1.5)
    assert pickle.loads(pickle.dumps(clamped)).clamp_distance == 1.5
    assert pickle.loads(pickle.dumps(clamped)).surface_bounds is None
    restore, state = field.__reduce__()
    wrong = {0: [(400, 400, 400), (16, 16, -16), (0, 0, 0)], 1: [(0, float("nan"), 0), (1e308, 0, 0)], 2: [float("nan"), 0.0, 1e-320],
             3: [-1.0, float("inf")], 6: [{}, {"winding": np.zeros((1, 1, 1))}, {"distance": np.zeros((1, 1, 1))}]}  # fmt: skip
    for place, values in wrong.items():
        for value in values:
            with pytest.raises(raymap.UsageError):
                restore(*state[:place], value, *state[place + 1 :])
    restore, state = band.__reduce__()
    outside, inside, origins, *tiles = state[5]
    for wrong, message in (origins[::-1], "ordered along a Morton curve"), (origins[:-1], "leaves of 512 samples"):
        with pytest.raises(raymap.UsageError, match=message):
            restore(*state[:5], (outside, inside, wrong, *tiles), *state[6:])


def test_pickling_a_field_without_distances(field):
    field.save("triangle.nrrd", "triangle")
    read = raymap.load_field("triangle.nrrd")
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(read)).triangle, field.triangle)
    assert "arrays</th><td>triangle" in read._repr_html_()


def test_fields_of_arrays(field):
    for distance in (field.distance, np.ascontiguousarray(field.distance), field.distance.astype(np.float64)):
        made = raymap.Field(distance, field.origin, field.spacing, triangle=field.triangle)
        assert made.arrays == ("distance", "triangle")
        np.testing.assert_array_equal(made.distance, field.distance)
        assert not np.shares_memory(made.distance, distance)


def test_arrays_of_other_shapes_are_refused(field):
    with pytest.raises(raymap.UsageError, match=r"distance must be \(nx, ny, nz\)"):
        raymap.Field(np.zeros((3, 3)))
    with pytest.raises(raymap.UsageError, match="winding must have the shape of distance"):
        raymap.Field(np.zeros((3, 3, 3)), winding=np.zeros((3, 3, 2)))


def test_isosurface_of_an_array(field):
    mesh = raymap.isosurface(field.distance, 0.1, origin=field.origin, spacing=field.spacing)
    same = field.to_mesh(0.1)
    np.testing.assert_array_equal(mesh.vertices, same.vertices)
    np.testing.assert_array_equal(mesh.faces, same.faces)
    with pytest.raises(raymap.UsageError):
        raymap.isosurface(np.ones((4, 4, 4)))
    with pytest.raises(raymap.InputError):
        raymap.isosurface(np.full((4, 4, 4), np.nan))


def test_arrays_of_other_numbers():
    mask = np.zeros((2, 2, 2), bool)
    for array, text in (
        (mask, "distance must be real numbers, not bool; a mask has no distances, a field has"),
        (mask.astype(complex), "distance must be real numbers, not complex128$"),
        (np.full((2, 2, 2), "1"), "distance must be real numbers, not <U1$"),
    ):
        with pytest.raises(raymap.InputError, match=text):
            raymap.Field(array)
    for name in ("winding", "confidence", "triangle"):
        for kind in (complex, bool):
            with pytest.raises(raymap.InputError, match=f"{name} must be (real|whole) numbers, not {kind.__name__}"):
                raymap.Field(np.zeros((2, 2, 2)), **{name: mask.astype(kind)})
    with pytest.raises(raymap.InputError, match="triangle must be whole numbers, not float64$"):
        raymap.Field(np.zeros((2, 2, 2)), triangle=np.zeros((2, 2, 2)))
    for kind in (np.int8, np.uint64, np.float16, object):
        assert raymap.Field(np.ones((2, 2, 2), kind)).distance[1, 1, 1] == 1


def test_numbers_beyond_float32_are_infinite_without_a_warning(ball):
    """NumPy warns where it rounds them. pytest makes no errors of warnings here, so the test does."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert raymap.Field(np.full((2, 2, 2), 1e300)).distance[0, 0, 0] == np.inf
        surface, far = raymap.Surface(ball), np.full((2, 3), 3e38, np.float32)
        assert (surface.signed_distance(far) == np.inf).all() and (surface.closest(far).distance == np.inf).all()
        assert (raymap.Scene([surface]).signed_distance(far) == np.inf).all()
        assert (surface.signed_distance(far, transform=np.eye(4)) == np.inf).all()
        assert (surface.signed_distance(far.astype(float)) < np.inf).all()


@pytest.mark.parametrize("sparse", [False, True])
def test_fields_are_compared(ball, sparse):
    field, other = (raymap.generate(ball, resolution=24, arrays=("winding",), sparse=sparse) for _ in range(2))
    same = field.compare(other)
    assert same["differences"] == 0 and set(raymap.Comparison.__annotations__) == set(same)
    other.distance[...] += 0.5 * other.spacing
    found = field.compare(other)
    assert found["samples"] == 24**3 and found["sign_differences"] > 100
    assert found["max_error"] == pytest.approx(0.5, abs=1e-5) and len(found["worst_sample"]) == 3
    assert field.compare(other, "winding")["differences"] == 0
    picture = field.render_comparison(other, width=70)
    assert picture.shape == (70, 70, 3)
    assert ((picture[..., 0] > 180) & (picture[..., 1] < 90)).any()  # Inside by the first field only: red.
    with pytest.raises(raymap.UsageError, match="a narrow band cannot be compared with a dense field; make it dense"):
        field.compare(dense(field) if sparse else field.to_sparse())
    with pytest.raises(raymap.UsageError):
        field.compare(other, "confidence")


def test_the_sides_of_a_band_have_widths_of_their_own(ball):
    surface, field = raymap.Surface(ball), raymap.generate(ball, resolution=40)
    for inside, outside in ((4, 2), (np.inf, 2)):
        made = raymap.generate(ball, resolution=40, band=(inside, outside), sparse=True)
        assert made.inside == inside * made.spacing and made.outside == outside * made.spacing
        assert pickle.loads(pickle.dumps(made)).inside == made.inside
        for same in (
            surface.generate(resolution=40, band=[inside, outside], sparse=True),
            field.to_sparse(np.array([inside, outside])),
        ):
            np.testing.assert_array_equal(same.origins, made.origins)
            np.testing.assert_allclose(same.distance, made.distance, atol=1e-6)
            assert (same.inside, same.outside) == (made.inside, made.outside)
    assert field.to_sparse(band=2).outside == 2 * field.spacing
    with pytest.raises(raymap.UsageError, match="one number; with sparse=True"):
        raymap.generate(ball, resolution=16, band=(2, 3))


def test_a_surface_without_a_sign_makes_a_band_without_an_inside(ball):
    surface, unsigned = raymap.Surface(ball), raymap.Surface(ball, sign=False)
    made, positive = (each.generate(resolution=40, sparse=True) for each in (surface, unsigned))
    np.testing.assert_array_equal(positive.distance, np.abs(made.distance))
    assert len(positive.tile_sides) == 0
    for options in ({"sign": "none"}, {"threshold": 0.4}):
        with pytest.raises(raymap.UsageError, match="takes the sign and the threshold"):
            surface.generate(sparse=True, **options)


def test_the_grid_may_be_huge(ball):
    size = 4096.0
    field = raymap.generate(ball, bounds=((-size,) * 3, (size,) * 3), voxel_size=0.1, sparse=True, threads=1)
    assert field.shape == (81920,) * 3 and field.nbytes < 2**26
    np.testing.assert_allclose(field.sample([(0, 0, 1.1), (0, 0.95, 0)]), (0.1, -0.05), atol=0.02)
    with pytest.raises(raymap.MemoryLimitError, match="the field needs 2097152000 MiB"):
        field.to_dense()


def test_a_band_may_be_empty(ball):
    far = raymap.generate(ball, bounds=((5, 5, 5), (9, 9, 9)), resolution=16, sparse=True)
    for field in (far, pickle.loads(pickle.dumps(far))):
        assert field.distance.shape == (0, 8, 8, 8) and field.origins.shape == (0, 3) and field.active_count == 0
        assert field.tile_origins.shape == (0, 3) and field.arrays == ("distance",)
        assert (field.to_dense().distance == np.float32(field.outside)).all()
        with pytest.raises(raymap.UsageError, match="no surface at 0"):
            field.to_mesh()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"distance": "raster"}, "has no distance"),
        ({"passes": 3}, "has no passes"),
        ({"offsets": [(0, 0, 1)]}, "has no offsets"),
        ({"invert": True}, "has no invert"),
        ({"close_holes": True}, "has no close_holes"),
        ({"thickness": 0.1}, "has no thickness"),
        ({"allow_empty": True}, "has no allow_empty"),
        ({"sign": "rays"}, "'harmonic' or 'none', not 'rays'"),
        ({"device": "vulkan"}, "on the CPU, not on 'vulkan'"),
        ({"band": -1}, "band must be"),
        ({"band": (1, 2, 3)}, r"two numbers \(inside, outside\), not 3 numbers"),
        ({"band": (0, 2)}, "the number inside must be above 0, not 0"),
        ({"band": (2, np.inf)}, "the number outside must be finite, not inf"),
        ({"band": np.inf}, "band must be finite"),
        ({"sign": "none", "arrays": ("winding",)}, "need a sign"),
        ({"arrays": ("colour",)}, "nothing is named 'colour'"),
    ],
)
def test_what_a_narrow_band_cannot_do_is_refused(ball, options, message):
    with pytest.raises(raymap.UsageError, match=message):
        raymap.generate(ball, resolution=16, sparse=True, **options)
