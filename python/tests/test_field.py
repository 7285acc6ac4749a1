"""Fields: arrays, sampling, surfaces, files, pictures, pickling."""

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


@pytest.fixture(scope="module")
def field(ball: raymap.Mesh) -> raymap.Field:
    box = ((-1.25, -1.55, -1.85), (1.25, 1.55, 1.85))
    return raymap.generate(ball, bounds=box, voxel_size=0.1, arrays=ALL, device="cpu")


def positions(field: raymap.Field) -> np.ndarray:
    return field.origin + field.spacing * np.stack(np.indices(field.shape), axis=-1)


def test_arrays_are_views_with_x_fastest(field):
    assert field.shape == (25, 31, 37)
    for name in ALL:
        array = getattr(field, name)
        assert array.shape == (25, 31, 37)
        assert array.dtype == (np.uint32 if name == "triangle" else np.float32)
        assert array.strides == (4, 100, 3100)
        assert not array.flags.owndata
        assert getattr(field, name) is array
    assert np.shares_memory(field._core.array("distance"), field.distance)
    assert field.arrays == ALL


def test_distances_are_those_of_a_ball_negative_inside(field):
    exact = np.linalg.norm(positions(field), axis=-1) - 1
    assert np.abs(field.distance - exact).max() < 0.01
    assert field.distance[12, 15, 18] == pytest.approx(-1, abs=0.01)
    assert field.distance[24, 15, 18] == pytest.approx(0.2, abs=0.01)
    assert ((field.winding > 0.5) == np.signbit(field.distance)).all()
    assert field.confidence.min() >= 0 and field.confidence.max() <= 1


def test_triangles_are_the_closest(field, ball):
    centre = ball.vertices[ball.faces].mean(axis=1)
    for index in [(0, 0, 0), (24, 15, 18), (12, 30, 18), (12, 15, 36)]:
        way = positions(field)[index]
        best = np.argmax(centre @ way)
        assert np.linalg.norm(centre[field.triangle[index]] - centre[best]) < 0.2


def test_grid(field):
    np.testing.assert_allclose(field.origin, (-1.2, -1.5, -1.8), atol=1e-12)
    assert field.origin.shape == (3,) and field.origin.dtype == np.float64
    assert field.spacing == pytest.approx(0.1)
    assert field.clamp_distance == 0
    arrays = "distance, winding, confidence, triangle"
    assert repr(field) == f"raymap.Field(25 x 31 x 37 samples, spacing 0.1, arrays {arrays})"


def test_views_outlive_the_field(ball):
    distance = raymap.generate(ball, resolution=16, device="cpu").distance
    gc.collect()
    assert distance[8, 8, 8] == pytest.approx(-1, abs=0.2)


def test_writing_into_a_view_changes_the_field(ball):
    field = raymap.generate(ball, resolution=16, padding=0.3, device="cpu")
    field.distance[...] -= 0.25
    assert field.to_mesh().bounds[1] == pytest.approx(np.full(3, 1.25), abs=0.02)


def test_missing_arrays_say_how_to_get_them(ball):
    field = raymap.generate(ball, resolution=8, device="cpu")
    for name in ALL[1:]:
        assert not hasattr(field, name)
        with pytest.raises(AttributeError, match=f"ask for it, as in arrays=\\('distance', '{name}'\\)"):
            getattr(field, name)
    with pytest.raises(AttributeError):
        field.distance = np.zeros((8, 8, 8))


def trilinear(field: raymap.Field, points: np.ndarray) -> np.ndarray:
    s = (points - field.origin) / field.spacing
    low = np.minimum(np.floor(s).astype(int), np.array(field.shape) - 2)
    t = s - low
    sum_ = np.zeros(points.shape[:-1])
    for corner in np.ndindex(2, 2, 2):
        weight = np.prod(np.where(corner, t, 1 - t), axis=-1)
        sum_ += weight * field.distance[tuple(np.moveaxis(low + corner, -1, 0))]
    return sum_


def test_sample_is_trilinear_for_any_shape_of_points(field):
    points = np.random.default_rng(1).uniform((-1.2, -1.5, -1.8), (1.2, 1.5, 1.8), (4, 50, 3))
    sampled = field.sample(points)
    assert sampled.shape == (4, 50) and sampled.dtype == np.float32
    np.testing.assert_allclose(sampled, trilinear(field, points), atol=1e-6)
    np.testing.assert_array_equal(field.sample(points[2, 7]), sampled[2, 7])
    np.testing.assert_array_equal(field.sample(points, threads=1), sampled)
    np.testing.assert_array_equal(field.sample(points[:, ::2]), sampled[:, ::2])
    assert field.sample(np.empty((0, 3))).shape == (0,)
    assert np.isnan(field.sample((np.nan, 0, 0)))


def test_samples_outside_of_the_box_are_lower_bounds(ball):
    rng = np.random.default_rng(3)
    for bounds in (None, ((-0.5, -2, -2), (0.7, 1, 0.2)), ((0.2, 0.2, 0.2), (0.4, 0.5, 0.6)), ((1, 1, 1), (2, 3, 2))):
        field = raymap.generate(ball, resolution=12, bounds=bounds, device="cpu")
        np.testing.assert_allclose(field.surface_bounds, ball.bounds, atol=1e-6)
        last = field.origin + field.spacing * (np.array(field.shape) - 1)
        points = rng.uniform(-3, 3, (2000, 3))
        points = points[((points < field.origin) | (points > last)).any(axis=1)]
        truth = raymap.Surface(ball).signed_distance(points)
        assert (field.sample(points) <= truth + 1e-5).all()
        assert np.isnan(field.sample(points, outside="nan")).all()
        assert np.isnan(field.gradient(points, outside="nan")).all()
        middle = (field.origin + last) / 2
        assert field.sample(middle, outside="nan") == field.sample(middle)
        unknown = raymap.Field(field.distance, field.origin, field.spacing)
        assert unknown.surface_bounds is None
        assert (unknown.sample(points) <= field.sample(points)).all()
        known = raymap.Field(field.distance, field.origin, field.spacing, surface_bounds=field.surface_bounds)
        np.testing.assert_array_equal(known.sample(points), field.sample(points))
    assert raymap.generate(ball, resolution=12, device="cpu").sample((0, 0, 9)) == pytest.approx(8, abs=1e-6)
    with pytest.raises(raymap.UsageError, match="outside must be 'bound' or 'nan', not 'zero'"):
        field.sample((0, 0, 0), outside="zero")
    for wrong in (((1, 2, 3), (1, 1, 4)), (1, 2, 3)):
        with pytest.raises(raymap.UsageError, match="surface_bounds"):
            raymap.Field(field.distance, surface_bounds=wrong)


@pytest.mark.parametrize("ending", [".nrrd", ".npz", ".vti", ".vdb", ".nvdb"])
def test_files_keep_the_bounds_of_the_surface(field, ending):
    field.save("kept" + ending)
    np.testing.assert_array_equal(raymap.load_field("kept" + ending).surface_bounds, field.surface_bounds)


def test_gradient_is_a_central_difference(field):
    points = np.random.default_rng(2).uniform(-0.9, 0.9, (60, 3))
    gradient = field.gradient(points)
    assert gradient.shape == (60, 3) and gradient.dtype == np.float32
    h = field.spacing
    for axis in range(3):
        step = np.eye(3)[axis] * h
        expected = (trilinear(field, points + step) - trilinear(field, points - step)) / (2 * h)
        np.testing.assert_allclose(gradient[:, axis], expected, atol=1e-5)
    assert field.gradient((0.5, 0, 0)).shape == (3,)


@pytest.mark.parametrize("points", [np.zeros((2, 2)), np.zeros(()), np.zeros((3, 4)), 1.0])
def test_points_of_another_shape_are_refused(field, points):
    with pytest.raises(raymap.InputError, match=r"points must be \(\.\.\., 3\)"):
        field.sample(points)


def test_points_that_are_no_numbers_are_refused(field):
    with pytest.raises(raymap.InputError, match="points must be numbers"):
        field.gradient([("a", "b", "c")])


def test_to_mesh_is_closed_and_at_the_distance(field):
    for iso in (0.0, 0.15, -0.3):
        mesh = field.to_mesh(iso)
        found = raymap.info(mesh)
        assert found["watertight"] and found["signed_volume"] > 0
        np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1 + iso, atol=0.02)
    with pytest.raises(raymap.UsageError):
        field.to_mesh(-9.0)
    with pytest.warns(raymap.RaymapWarning, match="reaches the grid's box"):
        field.to_mesh(0.5)


@pytest.mark.parametrize("extension", ["vdb", "nvdb", "nrrd", "npz", "npy", "vti"])
def test_files_give_back_the_same_bits(field, extension):
    path = f"field.{extension}"
    field.save(path)
    read = raymap.load_field(path)
    np.testing.assert_array_equal(read.distance, field.distance)
    if extension != "npy":
        np.testing.assert_allclose(read.origin, field.origin)
        assert read.spacing == pytest.approx(field.spacing)
    assert read.stats["device"] == "" and read.stats["stages"] == []


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


def test_errors_of_files(field):
    with pytest.raises(raymap.UsageError):
        field.save("field.txt")
    with pytest.raises(ValueError):
        field.save("field.nrrd", "colour")
    with pytest.raises(raymap.FileError):
        field.save("missing/field.nrrd")
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
    centre, corner = middle[62, 50].astype(int), middle[3, 3].astype(int)
    assert centre[2] > centre[0] and corner[0] > corner[2]  # Cool inside, warm outside.


@pytest.mark.parametrize("axis, index", [("w", None), (3, None), (0, 25), ("x", -26)])
def test_slices_that_do_not_exist_are_refused(field, axis, index):
    with pytest.raises(raymap.UsageError):
        field.slice(axis, index)


def test_render(field):
    picture = field.render(width=80, height=60, device="cpu")
    assert picture.shape == (60, 80, 3) and picture.dtype == np.uint8
    assert (picture[30, 40] != picture[0, 0]).any()
    stages = []
    np.testing.assert_array_equal(
        field.render(width=80, height=60, device="cpu", threads=1, progress=lambda s, d: stages.append(s)), picture)
    assert stages
    for changed in (dict(direction=(1, 0, 0)), dict(cut=True), dict(field_of_view=60), dict(up=(1, 0, 0))):
        assert (field.render(width=80, height=60, device="cpu", **changed) != picture).any()
    with pytest.raises(raymap.UsageError):
        field.render(width=0)


def test_render_from_a_place_what_a_plane_leaves(field):
    def draw(of=field, **options):
        return of.render(width=80, height=60, device="cpu", frame=((-1.2, -1.5, -1.8), (1.2, 1.5, 1.8)), **options).astype(int)

    whole = draw()
    near = field.render(width=80, height=60, device="cpu", frame=((0, 0, 0), (0.2, 0.2, 0.2)))
    assert (near[:30] != whole[:30]).any(axis=2).mean() > 0.5  # A smaller frame is closer.
    far, farther = (draw(eye=(0.2, 0.1, z), direction=(0, 0, -1)) for z in (6, 12))
    sizes = [(picture[:, :, 0] - picture[:, :, 2] > 20).mean() for picture in (far, farther)]  # Of clay.
    assert 3 < sizes[0] / sizes[1] < 6

    middle = draw(cut=True)
    assert (draw(cut_plane=(0, 0, 1, 0)) == middle).all() and (middle != whole).any()
    assert (draw(cut_plane=(0, 0, 0.5, 0)) == middle).all()
    assert (draw(cut_plane=(0, 0, 1, 0.3)) != middle).any()
    sliced = draw(slice_plane=(0, 0, 1, 0.7))
    assert (draw(slice_plane=(0, 0, 2, 1.4)) == sliced).all()
    assert (sliced != whole).any() and (sliced != draw(slice_plane=(0, 1, 0, 0.7))).any()

    grown = raymap.Field(field.distance - np.float32(0.25), origin=field.origin, spacing=field.spacing)
    found = draw(iso=0.25)
    assert np.abs(found - draw(grown)).mean() < 0.1 * np.abs(found - whole).mean()


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


def test_pickling_keeps_everything(field):
    copy = pickle.loads(pickle.dumps(field))
    assert copy.arrays == ALL and copy.spacing == field.spacing and (copy.origin == field.origin).all()
    for name in ALL:
        np.testing.assert_array_equal(getattr(copy, name), getattr(field, name))
        assert getattr(copy, name).strides == (4, 100, 3100)
    assert copy.stats["device"] == "cpu" and copy.stats["stages"] == field.stats["stages"]
    np.testing.assert_array_equal(copy.surface_bounds, field.surface_bounds)
    clamped = raymap.Field(np.zeros((2, 2, 2)), clamp_distance=1.5)
    assert pickle.loads(pickle.dumps(clamped)).clamp_distance == 1.5
    restore, state = field.__reduce__()
    wrong = {0: [(400, 400, 400), (16, 16, -16), (0, 0, 0)], 1: [(0, float("nan"), 0), (1e308, 0, 0)], 2: [float("nan"), 0.0, 1e-320],
             3: [-1.0, float("inf")], 6: [{}, {"winding": np.zeros((1, 1, 1))}, {"distance": np.zeros((1, 1, 1))}]}  # fmt: skip
    for place, values in wrong.items():
        for value in values:
            with pytest.raises(raymap.UsageError):
                restore(*state[:place], value, *state[place + 1 :])
    assert pickle.loads(pickle.dumps(clamped)).surface_bounds is None


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
        np.testing.assert_array_equal(made.to_mesh().vertices, field.to_mesh().vertices)


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
