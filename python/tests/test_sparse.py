"""Narrow bands: their arrays against queries of the surface, all else against the dense field of the same samples."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import raymap

ALL = ("distance", "triangle", "winding", "confidence")


@pytest.fixture(scope="module")
def band(ball) -> raymap.Field:
    return raymap.generate(ball, resolution=40, band=3, arrays=ALL, sparse=True)


def samples_of(field: raymap.Field) -> np.ndarray:
    """Returns the sample of each value, (n, 8, 8, 8, 3)."""
    return field.origins[:, None, None, None] + np.stack(np.mgrid[:8, :8, :8], axis=-1)


def test_values_are_those_of_the_surface(ball, band):
    samples = samples_of(band)
    assert samples.shape == (*band.distance.shape, 3) and band.distance.dtype == np.float32
    on_grid = (samples < band.shape).all(axis=-1)
    assert 0 < on_grid.mean() <= 1
    points = band.origin + band.spacing * samples[on_grid]
    found = raymap.Surface(ball).query(points, ALL)
    width = 3 * band.spacing
    assert band.outside == band.inside == width
    expected = np.clip(found.distance, -width, width).astype(np.float32)
    np.testing.assert_array_equal(band.distance[on_grid], expected)
    active = np.abs(expected) < np.float32(width)
    assert band.active_count == active.sum() > 1000
    np.testing.assert_array_equal(band.triangle[on_grid], np.where(active, found.triangle, raymap.NO_TRIANGLE))
    np.testing.assert_array_equal(band.winding[on_grid], found.winding)
    np.testing.assert_array_equal(band.confidence[on_grid], found.confidence)
    assert (band.distance[~on_grid] == np.float32(width)).all()
    # Elsewhere, samples are far outside, but for those in tiles.
    assert all((band.origins % 8 == 0).ravel()) and set(band.tile_sides) <= {8, 16, 32}
    assert (band.tile_origins % band.tile_sides[:, None] == 0).all()
    assert (band.distance < 0).sum() + (band.tile_sides**3).sum() == (band.to_dense().distance < 0).sum()


def test_arrays_are_views(ball):
    band = raymap.generate(ball, resolution=30, sparse=True)
    assert band.distance.strides == (4 * 512, 4, 32, 256) and not band.distance.flags.owndata
    assert np.shares_memory(band.distance, band.distance)
    before = band.to_dense().distance
    band.distance[:] *= 0.5
    origin = tuple(band.origins[4])
    assert band.to_dense().distance[origin] == band.distance[4, 0, 0, 0] == 0.5 * before[origin]
    values = band.distance
    del band
    assert np.isfinite(values).all()  # They keep the memory.
    with pytest.raises(AttributeError, match="'winding'; ask for it"):
        _ = raymap.generate(ball, resolution=30, sparse=True).winding


def test_bands_are_compared_as_their_dense_fields(ball, band):
    other = raymap.generate(ball, resolution=40, band=(2, 4), arrays=ALL, sparse=True)
    moved = band.to_dense().to_sparse()
    moved.distance[:] += 0.5 * band.spacing
    for each in other, moved:
        found, wanted = band.compare(each), band.to_dense().compare(each.to_dense())
        assert found.keys() == wanted.keys() and found["samples"] == np.prod(band.shape)
        for name, value in found.items():
            np.testing.assert_allclose(value, wanted[name], rtol=1e-9)
        picture = band.to_dense().render_comparison(each.to_dense(), width=90)
        np.testing.assert_array_equal(band.render_comparison(each, width=90), picture)
    assert band.compare(moved)["sign_differences"] > 100
    assert band.compare(other, "winding")["differences"] == 0
    with pytest.raises(raymap.UsageError, match="a narrow band cannot be compared with a dense field; make it dense"):
        band.compare(band.to_dense())
    with pytest.raises(raymap.UsageError, match="has no winding numbers"):
        band.compare(raymap.generate(ball, resolution=40, band=3, sparse=True), "winding")


def test_slices_are_those_of_the_dense_field(band):
    dense = band.to_dense()
    for array in ALL:
        for axis, index in (("x", None), (1, 7), ("z", -9)):
            expected = dense.slice(axis, index, array=array, width=60)
            np.testing.assert_array_equal(band.slice(axis, index, array=array, width=60), expected)
    with pytest.raises(raymap.UsageError, match="index 40 is out of range"):
        band.slice("x", 40)
    with pytest.raises(raymap.UsageError, match="has no winding numbers"):
        raymap.Field(dense.distance).to_sparse().slice("x", array="winding")


def test_pictures_are_those_of_the_dense_field(band):
    dense, width = band.to_dense(), band.outside
    looks = (
        {},
        {"cut": True, "shell": 0.5 * width},
        {"iso": 0.5 * width, "cut_plane": (0, 0, 1, 0.4)},
        {"eye": (0, 0, 4), "direction": (0, 0, -1), "up": (1, 0, 0), "field_of_view": 50},
        {"slice_plane": (1, 0, 0, 0.2), "frame": ((-2, -2, -2), (2, 2, 2))},
    )
    pictures = [band.render(width=60, height=50, device="cpu", **look) for look in looks]
    for look, picture in zip(looks, pictures, strict=True):
        expected = dense.render(width=60, height=50, device="cpu", **look)
        assert picture.shape == (50, 60, 3) and picture.dtype == np.uint8
        assert np.abs(picture.astype(int) - expected).mean() < 0.5
    assert all((pictures[0] != picture).any() for picture in pictures[1:])
    seen = []
    band.render(width=20, height=20, threads=1, progress=lambda stage, done: seen.append((stage, done)))
    assert seen[-1] == ("render", 1.0)
    np.testing.assert_array_equal(band.render(width=60, height=50, device="cpu", threads=1), pictures[0])
    for wrong in ({"iso": width}, {"shell": width}, {"field_of_view": 0}, {"width": 0}, {"eye": (1, 2)}, {"device": "gpu"}):
        with pytest.raises(raymap.UsageError):
            band.render(**wrong)


def test_it_is_as_its_dense_field(band):
    dense = band.to_dense()
    assert dense.shape == band.shape and dense.spacing == band.spacing and (dense.origin == band.origin).all()
    assert dense.clamp_distance == band.outside and (dense.surface_bounds == band.surface_bounds).all()
    assert dense.arrays == band.arrays == ("distance", "winding", "confidence", "triangle")
    for leaf in (0, 7, len(band.origins) - 1):
        x, y, z = band.origins[leaf]
        part = dense.distance[x : x + 8, y : y + 8, z : z + 8]
        np.testing.assert_array_equal(part, band.distance[leaf][tuple(slice(n) for n in part.shape)])
    points = np.random.default_rng(3).uniform(-2, 2, (2, 500, 3))
    for outside in ("bound", "nan"):
        for name in ("sample", "gradient"):
            expected, got = (getattr(f, name)(points, outside=outside) for f in (dense, band))
            assert got.dtype == np.float32
            np.testing.assert_array_equal(got, expected)
    for iso in (0.0, 0.05):
        expected, got = dense.to_mesh(iso), band.to_mesh(iso)
        np.testing.assert_array_equal(got.vertices, expected.vertices)
        np.testing.assert_array_equal(got.faces, expected.faces)


def test_it_comes_from_a_dense_field(ball, band):
    dense = raymap.generate(ball, resolution=40, arrays=("winding",))
    made = dense.to_sparse(band=2)
    assert made.arrays == ("distance", "winding")
    np.testing.assert_array_equal(made.to_dense().distance, np.clip(dense.distance, -made.inside, made.outside))
    again = band.to_dense().to_sparse()
    np.testing.assert_array_equal(again.origins, band.origins)
    np.testing.assert_array_equal(again.triangle, band.triangle)
    with pytest.raises(raymap.UsageError, match="clamped at 3 samples"):
        band.to_dense().to_sparse(band=4)


def test_its_sides_have_widths_of_their_own(ball):
    surface, dense = raymap.Surface(ball), raymap.generate(ball, resolution=40)
    for inside, outside in ((4, 2), (1.5, 3), (np.inf, 2)):
        made = raymap.generate(ball, resolution=40, band=(inside, outside), sparse=True)
        assert made.inside == inside * made.spacing and made.outside == outside * made.spacing
        assert (np.abs(made.distance) < made.outside).any() and (made.distance > -np.float32(made.inside)).any()
        samples = samples_of(made)
        on_grid = (samples < made.shape).all(axis=-1)
        found = surface.query(made.origin + made.spacing * samples[on_grid], "distance").distance
        expected = np.clip(found, -made.inside, made.outside).astype(np.float32)
        np.testing.assert_array_equal(made.distance[on_grid], expected)
        assert repr(pickle.loads(pickle.dumps(made))) == repr(made)
        for same in (
            surface.generate(resolution=40, band=[inside, outside], sparse=True),
            dense.to_sparse(np.array([inside, outside])),
        ):
            np.testing.assert_array_equal(same.origins, made.origins)
            np.testing.assert_allclose(same.distance, made.distance, atol=1e-6)
            assert (same.inside, same.outside) == (made.inside, made.outside)
    assert len(made.tile_origins) == 0 and made.active_count > (dense.distance < 0).sum()
    with pytest.raises(raymap.UsageError, match="one number; with sparse=True"):
        raymap.generate(ball, resolution=16, band=(2, 3))


def test_it_is_pickled(band):
    again = pickle.loads(pickle.dumps(band))
    for name in ("distance", "triangle", "winding", "confidence", "origins", "tile_origins", "tile_sides"):
        np.testing.assert_array_equal(getattr(again, name), getattr(band, name))
    assert repr(again) == repr(band) and again.spacing == band.spacing and again.outside == band.outside
    assert (again.surface_bounds == band.surface_bounds).all() and (again.origin == band.origin).all()
    function, state = band.__reduce__()
    outside, inside, origins, *tiles = state[5]
    for wrong, message in (origins[::-1], "ordered along a Morton curve"), (origins[:-1], "leaves of 512 samples"):
        with pytest.raises(raymap.UsageError, match=message):
            function(*state[:5], (outside, inside, wrong, *tiles), *state[6:])


def test_it_is_shown(band):
    text = f"raymap.Field(40 x 40 x 40 samples, {len(band.origins)} leaves, spacing 0.06, arrays distance"
    assert repr(band).startswith(text)
    assert f">{band.active_count}<" in band._repr_html_() and 0 < band.nbytes < 2**23
    with pytest.raises(AttributeError, match="the field is dense, and only a narrow band has 'origins'"):
        band.to_dense().origins  # noqa: B018
    dense = band.to_dense()
    assert not dense.is_narrow and band.is_narrow and dense.nbytes >= 16 * 40**3
    assert dense.active_count == (abs(dense.distance) < np.float32(dense.clamp_distance)).sum() == band.active_count
    with pytest.raises(TypeError, match="make it dense by to_dense"):
        np.asarray(band)


def test_a_surface_makes_the_same(ball, band):
    surface = raymap.Surface(ball)
    made = surface.generate(resolution=40, band=3, sparse=True)
    np.testing.assert_array_equal(made.distance, band.distance)
    unsigned = raymap.Surface(ball, sign=False).generate(resolution=40, sparse=True)
    np.testing.assert_array_equal(unsigned.origins, band.origins)
    np.testing.assert_array_equal(unsigned.distance, np.abs(band.distance))
    assert len(unsigned.tile_sides) == 0
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


def test_it_may_be_empty(ball):
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


def test_it_is_written(band, tmp_path):
    band.save(tmp_path / "ball.vdb")
    read = raymap.load_field(tmp_path / "ball.vdb")
    point = (0.3, 0.2, 0.9)
    np.testing.assert_allclose(read.sample(point), band.sample(point), atol=1e-6)
    with pytest.raises(raymap.UsageError, match="npz"):
        band.save(tmp_path / "ball.npz")


@pytest.mark.parametrize("extension", ["vdb", "nvdb"])
def test_it_is_read(band, tmp_path, extension):
    path = tmp_path / f"ball.{extension}"
    band.save(path)
    for again in raymap.load_field(path, sparse=True), raymap.load_field(str(path), grid="distance", sparse=True):
        assert again.arrays == band.arrays and again.outside == band.outside and again.inside == band.inside
        for name in "distance", "origins", "triangle", "winding", "confidence", "tile_origins", "tile_sides", "origin":
            np.testing.assert_array_equal(getattr(again, name), getattr(band, name))
    with pytest.raises(raymap.UsageError, match="its grids are 'confidence', 'distance', 'triangle', 'winding'"):
        raymap.load_field(path, grid="surface", sparse=True)
    winding = raymap.load_field(path, grid="winding")
    assert winding.arrays == ("winding",)
    np.testing.assert_array_equal(winding.winding, raymap.load_field(path).winding)
    with pytest.raises(raymap.UsageError, match="it has no grid 'surface'; its grids are"):
        raymap.load_field(path, grid="surface")
    with pytest.raises(TypeError, match="grid must be a text"):
        raymap.load_field(path, grid=3)
    with pytest.raises(raymap.FileError):
        raymap.load_field(tmp_path / "missing.vdb", sparse=True)
