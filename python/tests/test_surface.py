"""Surfaces: distances, closest points and signs at points; shapes, types, pickling, threads."""

from __future__ import annotations

import copy
import inspect
import pickle

import numpy as np
import pytest
import raymap
from helpers import Exporter, interrupted, right_in_threads


@pytest.fixture(scope="module")
def surface(ball) -> raymap.Surface:
    return raymap.Surface(ball)


def random_points(count: int, size: float = 1.5) -> np.ndarray:
    return np.random.default_rng(7).uniform(-size, size, (count, 3))


def test_distances_are_negative_inside(surface):
    points = random_points(200)
    distance = surface.signed_distance(points)
    np.testing.assert_allclose(distance, np.linalg.norm(points, axis=1) - 1, atol=0.02)
    np.testing.assert_array_equal(surface.contains(points), distance < 0)
    assert 0 < (distance < 0).sum() < 200


def test_closest_points_triangles_and_barycentric_coordinates_agree(ball, surface):
    points = random_points(500).reshape(5, 100, 3)
    found = surface.closest(points)
    assert isinstance(found, raymap.Closest)
    shapes = [array.shape for array in found]
    assert shapes == [(5, 100, 3), (5, 100), (5, 100), (5, 100, 3)]
    assert [array.dtype for array in found] == [np.float64, np.float64, np.uint32, np.float64]
    np.testing.assert_array_equal(found.distance, surface.signed_distance(points))
    np.testing.assert_allclose(np.linalg.norm(points - found.point, axis=-1), np.abs(found.distance), atol=4e-6)
    corners = ball.vertices[ball.faces[found.triangle]]
    np.testing.assert_allclose(np.einsum("...i,...ij->...j", found.barycentric, corners), found.point, atol=4e-6)
    np.testing.assert_allclose(found.barycentric.sum(axis=-1), 1, atol=1e-12)
    assert found.barycentric.min() >= 0


def test_query_gives_what_is_asked_for(surface):
    points = random_points(50)
    names = raymap.Query._fields
    everything = surface.query(points, names)
    assert isinstance(everything, raymap.Query)
    assert [array.dtype for array in everything] == [np.float64] * 2 + [np.uint32] + [np.float64] * 2 + [np.float32] * 2
    for name in names:
        for arrays in (name, [name], {name}):
            found = surface.query(points, arrays)
            assert [n for n in names if getattr(found, n) is not None] == [name]
            np.testing.assert_array_equal(getattr(found, name), getattr(everything, name))
    assert surface.query(points)[1:] == (None,) * 6
    assert surface.query(points, ()) == (None,) * 7
    np.testing.assert_array_equal(surface.query(points).distance, everything.distance)
    towards = everything.closest - points
    lengths = np.linalg.norm(towards, axis=1, keepdims=True)
    np.testing.assert_allclose(everything.direction, towards / lengths, atol=1e-9)
    np.testing.assert_allclose(everything.winding, everything.distance < 0, atol=1e-3)
    assert (everything.confidence > 0.9).all() and (everything.confidence <= 1).all()


def test_the_largest_distance(surface):
    points = [(0, 0, 0), (0, 0, 1.25), (0, 0, 4)]
    found = surface.query(points, raymap.Query._fields, max_distance=0.5)
    np.testing.assert_allclose(found.distance, [-0.5, 0.25, 0.5], atol=1e-6)
    np.testing.assert_array_equal(found.triangle == raymap.NO_TRIANGLE, [True, False, True])
    for array in (found.closest, found.barycentric, found.direction):
        np.testing.assert_array_equal(np.isnan(array), [[True] * 3, [False] * 3, [True] * 3])
    assert not np.isnan(found.winding).any()


@pytest.mark.parametrize("shape", [(3,), (0, 3), (1, 3), (7, 3), (2, 3, 3), (2, 0, 3), (1, 2, 3, 3)])
@pytest.mark.parametrize("given, taken", [(np.float32, np.float32), (np.float64, np.float64), (np.int32, np.float64),
                                          (np.float16, np.float64), (">f8", np.float64)])
def test_shapes_and_types(surface, shape, given, taken):
    points = (4 * np.random.default_rng(1).uniform(-1, 1, shape)).astype(given)
    found = surface.query(points, raymap.Query._fields)
    for name, array in found._asdict().items():
        assert array.shape == (shape if name in ("closest", "barycentric", "direction") else shape[:-1])
        expected = {"triangle": np.uint32, "winding": np.float32, "confidence": np.float32}.get(name, taken)
        assert array.dtype == expected
    assert np.shape(surface.contains(points)) == shape[:-1] and np.asarray(surface.contains(points)).dtype == bool
    exact = surface.query(points.astype(np.float64), raymap.Query._fields)
    for array, expected in zip(found, exact):
        np.testing.assert_array_equal(array, expected.astype(array.dtype))


def test_points_in_any_layout(surface):
    points = random_points(40)
    expected = surface.signed_distance(points)
    wide = np.zeros((40, 5))
    wide[:, 1:4] = points
    for given in (np.asfortranarray(points), wide[:, 1:4], points.tolist(), tuple(map(tuple, points))):
        np.testing.assert_array_equal(surface.signed_distance(given), expected)
    np.testing.assert_array_equal(surface.signed_distance(points[::-2]), expected[::-2])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_points_that_are_not_finite(surface, bad):
    points = [(0, 0, 0.5), (0, bad, 0)]
    found = surface.query(points, raymap.Query._fields)
    for name, array in found._asdict().items():
        if name == "triangle":
            assert array[1] == raymap.NO_TRIANGLE and array[0] != raymap.NO_TRIANGLE
        else:
            assert np.isnan(array[1]).all() and np.isfinite(array[0]).all(), name
    np.testing.assert_array_equal(surface.contains(points), [True, False])
    assert np.isnan(surface.signed_distance((bad, 0, 0)))


def test_points_on_the_surface_are_not_inside():
    surface = raymap.Surface("tetrahedron.ply")
    assert surface.signed_distance((0.25, 0.25, 0)) == 0
    assert not surface.contains((0.25, 0.25, 0))
    assert surface.contains((0.25, 0.25, 1e-5)) and not surface.contains((0.25, 0.25, -1e-5))


def broken(ball: raymap.Mesh) -> raymap.Mesh:
    return raymap.Mesh(ball.vertices, np.concatenate([ball.faces[40:200, ::-1], ball.faces[260:]]))


@pytest.mark.parametrize("options", [
    {}, dict(voxel_size=0.17), dict(bounds=((-1, -2, -1.5), (1, 1, 2))), dict(distance="cell"), dict(sign="rays"),
    dict(sign="none"), dict(close_holes=True), dict(thickness=0.5), dict(band=2.5),
])  # fmt: skip
def test_fields_are_those_of_generate(ball, options):
    """In a mesh in double precision far from 0, which the surface rounds."""
    far = raymap.Mesh(broken(ball).vertices / 3 + (1e5, 0, -7e4), broken(ball).faces)
    options = {"resolution": 24, "device": "cpu", **options}
    if "bounds" in options:
        options["bounds"] = np.array(options["bounds"]) / 3 + (1e5, 0, -7e4)
    expected = raymap.generate(far, orientation="keep", **options)
    surface = raymap.Surface(far, orientation="keep")
    for made in (surface, pickle.loads(pickle.dumps(surface))):
        field = made.generate(**options)
        np.testing.assert_array_equal(field.origin, expected.origin)
        assert (field.spacing, field.clamp_distance) == (expected.spacing, expected.clamp_distance)
        np.testing.assert_array_equal(field.distance, expected.distance)


def test_fields_know_what_the_surface_turned(ball):
    flipped = raymap.Mesh(ball.vertices, np.concatenate([ball.faces[:40, ::-1], ball.faces[40:]]))
    surface = raymap.Surface(flipped, orientation="repair")
    field = surface.generate(resolution=16, arrays=("winding", "confidence", "triangle"), device="cpu", threads=1)
    np.testing.assert_array_equal(surface.stats["turned_faces"], np.arange(40))
    np.testing.assert_array_equal(field.stats["turned_faces"], np.arange(40))
    assert field.triangle.shape == (16, 16, 16)
    assert raymap.Surface(flipped, orientation="keep").stats["turned_faces"].size == 0


def test_progress_and_unknown_arguments_of_generate(surface):
    stages = []
    surface.generate(resolution=8, device="cpu", progress=lambda stage, done: stages.append(stage))
    assert "exact_distance" in stages
    with pytest.raises(TypeError, match="generate.. got an unexpected keyword argument 'orientation'"):
        surface.generate(orientation="keep")
    with pytest.raises(raymap.MemoryLimitError):
        surface.generate(resolution=64, memory_limit=1000)
    with pytest.raises(raymap.UsageError, match="voxel_size"):
        surface.generate(voxel_size=-1)


@pytest.mark.parametrize("options", [{}, {"sign": False}, {"orientation": "keep"}, {"threads": 1}])
def test_signed_distance_is_that_of_a_surface(ball, options):
    mesh = broken(ball)
    expected = raymap.Surface(mesh, **options)
    for points in (random_points(100), random_points(6).reshape(2, 3, 3), random_points(9).astype(np.float32)):
        distance = raymap.signed_distance(mesh, points, **options)
        assert (distance.dtype, distance.shape) == (points.dtype, points.shape[:-1])
        np.testing.assert_array_equal(distance, expected.signed_distance(points))


def test_arguments_of_signed_distance(ball):
    function, surface = (inspect.signature(callable).parameters for callable in (raymap.signed_distance, raymap.Surface))
    kept = [parameter for name, parameter in surface.items() if name != "compact"]  # This surface is not kept.
    assert list(function.values())[2:] == kept[2:]
    stages = []
    raymap.signed_distance(ball, (0, 0, 0), progress=lambda stage, done: stages.append(stage))
    assert len(set(stages)) > 1
    with pytest.raises(raymap.MemoryLimitError):
        raymap.signed_distance(ball, (0, 0, 0), memory_limit=1000)
    with pytest.raises(raymap.UsageError, match=r"vertices without faces: give raymap.Mesh\(vertices, faces\)"):
        raymap.signed_distance(ball.vertices, ball.faces)


def test_without_a_sign(ball, surface):
    unsigned = raymap.Surface(ball, sign=False)
    points = random_points(200)
    np.testing.assert_array_equal(unsigned.signed_distance(points), np.abs(surface.signed_distance(points)))
    for make in (unsigned, pickle.loads(pickle.dumps(unsigned))):
        with pytest.raises(raymap.UsageError, match="sign=False, so it does not know what is inside"):
            make.contains(points)
        for array in ("winding", "confidence"):
            with pytest.raises(raymap.UsageError, match="made without a sign"):
                make.query(points, array)
        assert make.generate(resolution=12, device="cpu").distance.min() >= 0
        assert make.generate(resolution=12, device="cpu", sign="harmonic").distance.min() < 0
    assert repr(unsigned) == "raymap.Surface(642 vertices, 1280 faces, no sign)"


def test_pickled_surfaces_give_the_same_bits(ball):
    points = random_points(300) / 3 + (1e5, 0, -7e4)
    for orientation in ("keep", "repair"):
        mesh = raymap.Mesh(broken(ball).vertices / 3 + (1e5, 0, -7e4), broken(ball).faces)
        surface = raymap.Surface(mesh, orientation=orientation, threads=2)
        expected = surface.query(points, raymap.Query._fields)
        again = pickle.loads(pickle.dumps(surface))
        for made in (again, pickle.loads(pickle.dumps(again)), copy.deepcopy(surface)):
            for array, other in zip(made.query(points, raymap.Query._fields), expected):
                np.testing.assert_array_equal(array, other)
            assert repr(made) == repr(surface)
            np.testing.assert_array_equal(made.mesh.vertices, surface.mesh.vertices)
            np.testing.assert_array_equal(made.stats["turned_faces"], surface.stats["turned_faces"])


def test_compact_surfaces_take_less_memory_and_give_the_same_bits(ball):
    mesh = raymap.Mesh(broken(ball).vertices, broken(ball).faces)
    surface, compact = raymap.Surface(mesh), raymap.Surface(mesh, compact=True)
    assert compact.stats["bytes"] < surface.stats["bytes"]
    points = random_points(300)
    for made in (compact, pickle.loads(pickle.dumps(compact))):
        assert made.stats["bytes"] == compact.stats["bytes"]
        for array, other in zip(made.query(points, raymap.Query._fields), surface.query(points, raymap.Query._fields)):
            np.testing.assert_array_equal(array, other)


def test_the_given_arrays_may_change(ball):
    vertices, faces = ball.vertices.copy(), ball.faces.copy()
    surface = raymap.Surface(vertices, faces)
    points = random_points(50)
    expected = surface.signed_distance(points)
    vertices[:], faces[:] = 0, 0
    np.testing.assert_array_equal(surface.signed_distance(points), expected)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(surface)).signed_distance(points), expected)
    mesh = surface.mesh
    del surface
    np.testing.assert_allclose(mesh.vertices, ball.vertices, atol=1e-7)
    np.testing.assert_array_equal(mesh.faces, ball.faces)
    assert not mesh.vertices.flags.writeable and not mesh.faces.flags.writeable


def test_any_form_of_a_mesh(ball, files):
    points = random_points(50)
    expected = raymap.Surface(files / "ball.ply").signed_distance(points)
    loaded = raymap.load_mesh(files / "ball.ply")
    for form in ((str(files / "ball.ply"),), (loaded,), (loaded.vertices, loaded.faces),
                 (loaded.vertices.tolist(), loaded.faces.tolist())):
        np.testing.assert_array_equal(raymap.Surface(*form).signed_distance(points), expected)


def test_stats(ball):
    stages = []
    surface = raymap.Surface(ball, progress=lambda stage, done: stages.append(stage))
    assert set(surface.stats) == set(raymap.Stats.__annotations__) and surface.stats["device"] == "cpu"
    names = [stage["name"] for stage in surface.stats["stages"]]
    assert names[-1] == "tree" and set(stages) <= set(names) and stages
    assert surface.stats["bytes"] > ball.vertices.size * 4 and surface.stats["milliseconds"] > 0


@pytest.mark.parametrize("options, error, text", [
    (dict(orientation="up"), raymap.UsageError, "'up'; use auto, keep or repair"),
    (dict(threads=-1), raymap.UsageError, "threads"),
    (dict(threads=1.5), TypeError, None),
    (dict(memory_limit=0), raymap.UsageError, "memory_limit must be 1 or more, not 0"),
    (dict(memory_limit=1000), MemoryError, None),
    (dict(memory_limit=1.5), TypeError, None),
    (dict(progress=3), TypeError, "progress must be a callable"),
    (dict(progress=lambda stage, done: False), raymap.Cancelled, "cancelled during"),
])
def test_arguments_that_make_no_sense(ball, options, error, text):
    with pytest.raises(error, match=text):
        raymap.Surface(ball, **options)


@pytest.mark.parametrize("points, options, error, text", [
    ([(0, 0)], {}, raymap.InputError, r"points must be \(..., 3\) coordinates, not of the shape \(1, 2\)"),
    (0.0, {}, raymap.InputError, "not of the shape"),
    ([("a", "b", "c")], {}, raymap.InputError, "points must be numbers"),
    ([(0, 0, 0)], dict(arrays="colour"), raymap.UsageError, "nothing is named 'colour'; there are distance, closest"),
    ([(0, 0, 0)], dict(max_distance=0), raymap.UsageError, "max_distance must be above 0"),
    ([(0, 0, 0)], dict(max_distance=float("nan")), raymap.UsageError, "max_distance must be above 0"),
    ([(0, 0, 0)], dict(threads=-1), raymap.UsageError, "threads"),
    ([(0, 0, 0)], dict(progress="yes"), TypeError, "progress must be a callable"),
])
def test_queries_that_make_no_sense(surface, points, options, error, text):
    with pytest.raises(error, match=text):
        surface.query(points, **options)


def test_meshes_that_are_not_valid():
    corners = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0.0)])
    with pytest.raises(raymap.InputError, match="3"):
        raymap.Surface(corners, [(0, 1, 3)])
    with pytest.raises(raymap.InputError):
        raymap.Surface(corners, np.empty((0, 3), int))
    with pytest.raises(raymap.FileError, match="gone.ply"):
        raymap.Surface("gone.ply")
    corners[1, 2] = np.nan
    with pytest.raises(raymap.InputError, match="1"):
        raymap.Surface(corners, [(0, 1, 2)])


def test_threads_may_share_one(surface):
    points = random_points(2000)
    expected = surface.signed_distance(points)
    assert right_in_threads(lambda k: (surface.signed_distance(points[k:]) == expected[k:]).all())


@pytest.mark.parametrize("call", ["surface", "query", "field", "samples"])
def test_ctrl_c_stops_the_work(ball, surface, call):
    with interrupted() as progress:
        if call == "surface":
            raymap.Surface(ball, progress=progress)
        elif call == "query":
            surface.signed_distance(random_points(1000), progress=progress)
        elif call == "field":
            surface.generate(resolution=16, device="cpu", progress=progress)
        else:
            raymap.sample_points(surface, 1000, progress=progress)
    np.testing.assert_allclose(surface.signed_distance((0, 0, 2)), 1, atol=1e-6)


def test_arrays_that_only_know_dlpack(surface):
    points = random_points(10).astype(np.float32)
    found = surface.signed_distance(Exporter(points))
    assert found.dtype == np.float32
    np.testing.assert_array_equal(found, surface.signed_distance(points))


@pytest.mark.parametrize("points", [np.empty((2, 0, 3))[0], np.empty((0, 3), np.float32), [], ()])
def test_no_points_are_an_empty_answer(ball, points):
    surface = raymap.Surface(ball)
    assert surface.signed_distance(points).shape == surface.contains(points).shape == (0,)
    assert surface.closest(points).point.shape == (0, 3)
    assert surface.thickness(points, []).inward.shape == (0, 3)
    field = raymap.generate(ball, resolution=8, device="cpu")
    assert field.sample(points).shape == (0,) and field.gradient(points).shape == (0, 3)


LATTICE = {"origin": (-2.0, -1.9, -1.8), "spacing": 0.0731, "dims": (60, 55, 50)}


def test_regions_have_what_queries_give(surface):
    low, size = (5, 17, 20), (40, 11, 9)
    names = ("distance", "winding", "confidence", "triangle")
    field = surface.generate_region(low, size, arrays=names, **LATTICE)
    samples = np.stack(np.indices(size), axis=-1) + low
    positions = np.array(LATTICE["origin"]) + LATTICE["spacing"] * samples
    found = surface.query(positions, names)
    for name in names:
        array = getattr(field, name)
        np.testing.assert_array_equal(array, getattr(found, name).astype(array.dtype))
    np.testing.assert_array_equal(field.origin, positions[0, 0, 0])
    assert field.spacing == LATTICE["spacing"] and field.clamp_distance == 0
    assert surface.generate_region(low, size, band=2, **LATTICE).clamp_distance == 2 * LATTICE["spacing"]
    assert right_in_threads(lambda k: np.array_equal(surface.generate_region(low, size, **LATTICE).distance, field.distance))


def test_far_regions_have_one_distance(surface):
    found = {surface.far_distance(low, (8, 8, 8), band=1, **LATTICE) for low in ((0, 0, 0), (24, 24, 24), (24, 24, 34))}
    assert found == {LATTICE["spacing"], -LATTICE["spacing"], None}
    for changes in {"band": 0}, {"dims": (9, 4, 9)}, {"spacing": -1}:
        with pytest.raises(raymap.UsageError):
            surface.far_distance((1, 1, 1), (4, 4, 4), **{"band": 1, **LATTICE, **changes})


def test_regions_refuse_what_makes_no_sense(surface):
    def refuses(error, match, **changes):
        arguments = {"low": (0, 0, 0), "size": (2, 2, 2), **LATTICE, **changes}
        with pytest.raises(error, match=match):
            surface.generate_region(**arguments)

    refuses(raymap.UsageError, "60 samples from 1 on along x, but the lattice has 60", low=(1, 0, 0), size=(60, 2, 2))
    refuses(raymap.UsageError, "low must be 0 or more", low=(-1, 0, 0))
    refuses(raymap.UsageError, "size must be 1 or more", size=(0, 1, 1))
    refuses(raymap.UsageError, "dims must be whole numbers", dims=(1, 2))
    refuses(TypeError, "low must be whole numbers", low=3)
    refuses(TypeError, "low must be a whole number", low=(0.5, 0, 0))
    refuses(raymap.UsageError, "spacing must be above 0", spacing=0)
    refuses(raymap.UsageError, "band must be above 0", band=0)
    refuses(raymap.UsageError, "nothing is named 'colour'", arrays=("colour",))
    refuses(raymap.MemoryLimitError, "the field needs", memory_limit=1000)
    refuses(raymap.Cancelled, None, progress=lambda stage, share: False)
    with pytest.raises(raymap.UsageError, match="made without a sign"):
        raymap.Surface(surface.mesh, sign=False).generate_region((0, 0, 0), (2, 2, 2), arrays="winding", **LATTICE)


@pytest.mark.parametrize("count", [1, 1000, 1001])
def test_short_calls(surface, count):
    """The calling thread answers up to 1000 points. Values, errors and warnings are those of a thread of its own."""
    points = np.random.default_rng(8).uniform(-1.5, 1.5, (count, 3))
    stages: list[str] = []
    found = surface.query(points, raymap.Query._fields)
    shown = surface.query(points, raymap.Query._fields, progress=lambda stage, done: stages.append(stage))
    for one, other in zip(found, shown, strict=True):
        np.testing.assert_array_equal(one, other)
    assert set(stages) == {"query"}
    scene = raymap.Scene([surface])
    np.testing.assert_array_equal(scene.signed_distance(points), found.distance)
    many = scene.signed_distance(points, np.tile(np.eye(4), (3, 1, 1, 1)))
    np.testing.assert_array_equal(many, np.tile(found.distance, (3, 1)))
    unsigned = raymap.Surface("ball.ply", sign=False)
    for progress in (None, lambda stage, done: None):
        with pytest.raises(raymap.UsageError, match="winding"):
            unsigned.query(points, "winding", progress=progress)
