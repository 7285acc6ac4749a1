"""Scenes: the union of moved bodies against each body alone; poses, shapes, types, errors, pickling, threads."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
import raymap
from helpers import Exporter, right_in_threads


def pose(axis: tuple[float, float, float], angle: float, shift: tuple[float, float, float]) -> np.ndarray:
    """Returns the rotation about an axis (Rodrigues), then the translation."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    made = np.eye(4)
    made[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    made[:3, 3] = shift
    return made


def random_poses(*shape: int) -> np.ndarray:
    random = np.random.default_rng(3)
    made = [
        pose(random.normal(size=3), random.uniform(-3, 3), random.uniform(-2, 2, 3)) for _ in range(int(np.prod(shape)))
    ]
    return np.array(made).reshape(*shape, 4, 4)


def random_points(*shape: int) -> np.ndarray:
    return np.random.default_rng(4).uniform(-4, 4, (*shape, 3))


def in_body(points: np.ndarray, made: np.ndarray) -> np.ndarray:
    return (points - made[:3, 3]) @ made[:3, :3]


@pytest.fixture(scope="module")
def ball_surface(ball) -> raymap.Surface:
    return raymap.Surface(ball)


@pytest.fixture
def scene(ball, ball_surface) -> raymap.Scene:
    small = raymap.Surface(ball.vertices * (0.3, 0.6, 0.9), ball.faces)
    made = raymap.Scene({"ball": ball_surface, "egg": small})
    made.add("again", small)
    made.poses = random_poses(3)
    return made


def test_the_union_is_that_of_the_bodies(scene):
    points = random_points(500)
    found = scene.query(points, ("distance", "body", "closest", "gradient", "distances"))
    alone = [scene.bodies[n].query(in_body(points, p), ("distance", "closest", "direction"))
             for n, p in zip(scene.names, scene.poses, strict=True)]  # fmt: skip
    distances = np.stack([a.distance for a in alone], axis=-1)
    np.testing.assert_allclose(found.distances, distances, atol=1e-12)
    np.testing.assert_allclose(found.distance, distances.min(axis=-1), atol=1e-12)
    np.testing.assert_array_equal(found.body, distances.argmin(axis=-1))
    assert set(found.body) == {0, 1, 2} and found.body.dtype == np.uint32 and (found.distance < 0).any()
    for b, made in enumerate(scene.poses):
        mine = found.body == b
        closest = alone[b].closest[mine] @ made[:3, :3].T + made[:3, 3]
        np.testing.assert_allclose(found.closest[mine], closest, atol=1e-12)
        gradient = -np.sign(alone[b].distance[mine, None]) * alone[b].direction[mine] @ made[:3, :3].T
        np.testing.assert_allclose(found.gradient[mine], gradient, atol=1e-9)


@pytest.mark.parametrize("own", [False, True])
def test_configurations_are_as_one_by_one(scene, own):
    poses, points = random_poses(4, 3), random_points(4, 50)
    names = ("distance", "body", "closest", "gradient", "distances")
    found = scene.query(points if own else points[0], names, poses=poses)
    assert found.distance.shape == (4, 50) and found.closest.shape == (4, 50, 3) and found.distances.shape == (4, 50, 3)
    for c in range(4):
        scene.poses = poses[c]
        one = scene.query(points[c if own else 0], names)
        for name in names:
            np.testing.assert_array_equal(getattr(found, name)[c], getattr(one, name))


def test_shapes_types_and_frameworks(scene):
    assert scene.signed_distance((0, 0, 0)).shape == ()
    assert scene.signed_distance(random_points(2, 5)).shape == (2, 5)
    assert scene.signed_distance(np.zeros((0, 3))).shape == (0,)
    single = random_points(7).astype(np.float32)
    found = scene.query(Exporter(single), ("distance", "gradient", "body"))
    assert found.distance.dtype == found.gradient.dtype == np.float32 and found.closest is None
    np.testing.assert_array_equal(found.distance, scene.signed_distance(single.astype(float)).astype(np.float32))
    assert scene.signed_distance(single, scene.poses[None].astype(np.float32)).shape == (1, 7)


def test_a_moved_surface(ball_surface):
    made, points = pose((1, 2, 3), 0.7, (4, 5, 6)), random_points(2, 50) + 4
    distance = ball_surface.signed_distance(points, transform=made)
    np.testing.assert_allclose(distance, ball_surface.signed_distance(in_body(points, made)), atol=1e-12)
    assert ball_surface.signed_distance(points.astype(np.float32), transform=made).dtype == np.float32
    with pytest.raises(raymap.UsageError, match="scales unevenly: its x axis has the length 2"):
        ball_surface.signed_distance(points, transform=np.diag([2, 1, 1, 1]))
    with pytest.raises(raymap.InputError, match=r"transform must be \(4, 4\) numbers, not of the shape \(3, 4\)"):
        ball_surface.signed_distance(points, transform=np.eye(4)[:3])


def test_fields_and_narrow_bands_are_bodies(ball):
    field = raymap.generate(ball, resolution=32)
    made = pose((0, 1, 1), 1.0, (1, 0, 0))
    points = np.random.default_rng(1).uniform(-1, 1, (100, 3)) + (1, 0, 0)
    for body in (field, field.to_sparse()):
        scene = raymap.Scene()
        scene.add("field", body, made)
        np.testing.assert_allclose(scene.signed_distance(points), body.sample(in_body(points, made)), atol=1e-6)
        del body
        assert scene.query(points, "gradient").gradient.shape == (100, 3)


def test_bodies_come_and_go(scene, ball_surface):
    scene.remove("ball")
    assert scene.names == ["egg", "again"] and len(scene) == 2 and scene.poses.shape == (2, 4, 4)
    scene.add("ball", ball_surface, np.eye(4))
    assert scene.query((0, 0, 0), "distances").distances.shape == (3,)
    assert repr(scene) == "raymap.Scene(3 bodies: egg, again, ball)"
    with pytest.raises(raymap.UsageError, match="the scene has no body 'arm'; it has 'egg', 'again', 'ball'"):
        scene.set_pose("arm", np.eye(4))
    with pytest.raises(raymap.UsageError, match="the scene has a body 'ball'"):
        scene.add("ball", ball_surface)
    for body in (3, None):
        with pytest.raises(TypeError, match="a body is a raymap.Surface or Field, or a mesh, not a"):
            scene.add("file", body)
    assert scene.names == ["egg", "again", "ball"]


def test_lists_and_meshes_are_bodies(ball, ball_surface):
    points = random_points(20)
    expected = raymap.Scene({"0": ball_surface, "1": ball_surface})
    for bodies in ([ball_surface, ball], (ball, "ball.ply"), [ball_surface, (ball.vertices, ball.faces)]):
        made = raymap.Scene(bodies)
        assert made.names == ["0", "1"] and all(isinstance(body, raymap.Surface) for body in made.bodies.values())
        np.testing.assert_array_equal(made.signed_distance(points), expected.signed_distance(points))
    assert raymap.Scene({"file": "ball.ply"}).names == ["file"] and len(raymap.Scene([])) == len(raymap.Scene()) == 0
    with pytest.raises(TypeError, match="bodies must be a dict or a list of bodies, not a Surface"):
        raymap.Scene(ball_surface)
    with pytest.raises(raymap.FileError, match="gone.ply"):
        raymap.Scene(["gone.ply"])


def test_one_configuration(scene):
    """Poses without an axis of configurations give results in the shape of the points."""
    poses = random_poses(4, 3)[2]
    for shape in ((), (5,), (2, 5)):
        points = random_points(*shape)
        found = scene.query(points, ("distance", "closest"), poses)
        assert found.distance.shape == shape and found.closest.shape == (*shape, 3)
        np.testing.assert_array_equal(found.distance, scene.signed_distance(points, poses))
        np.testing.assert_array_equal(scene.signed_distance(points.reshape(-1, 3), poses[None])[0], found.distance.ravel())
    before = scene.signed_distance(points)
    scene.poses = poses
    np.testing.assert_array_equal(scene.signed_distance(points), found.distance)
    assert (before != found.distance).all()


def test_triangles_of_bodies(scene):
    points = random_points(50)
    found = scene.query(points, ("body", "triangle"))
    assert found.triangle.dtype == np.uint32 and found.distance is None
    for point, body, triangle in zip(points, found.body, found.triangle, strict=True):
        alone = scene.bodies[scene.names[body]]
        assert alone.query(in_body(point, scene.poses[body]), "triangle").triangle == triangle


def test_bodies_are_left_out(scene):
    points = random_points(200)
    whole = scene.query(points, ("distance", "distances"))
    found = scene.query(points, ("distance", "body", "distances"), without="ball")
    assert np.isnan(found.distances[:, 0]).all() and set(found.body) == {1, 2}
    np.testing.assert_array_equal(found.distance, whole.distances[:, 1:].min(axis=1))
    alone = scene.signed_distance(points, without=["again", "ball"])
    np.testing.assert_array_equal(alone, whole.distances[:, 1])
    np.testing.assert_array_equal(scene.signed_distance(points, scene.poses[None], without=["again", "ball"])[0], alone)
    assert np.isinf(scene.signed_distance(points, without=scene.names)).all()
    with pytest.raises(raymap.UsageError, match="the scene has no body 'arm'; it has 'ball', 'egg', 'again'"):
        scene.signed_distance(points, without=["ball", "arm"])


def test_distances_up_to_a_limit(scene):
    points = random_points(400)
    whole = scene.signed_distance(points)
    found = scene.query(points, ("distance", "body", "triangle"), max_distance=0.25)
    np.testing.assert_array_equal(found.distance, np.clip(whole, -0.25, 0.25))
    np.testing.assert_array_equal(scene.signed_distance(points, max_distance=0.25), found.distance)
    is_far = whole >= 0.25
    assert (found.body[is_far] == raymap.NO_BODY).all() and (found.triangle[is_far] == raymap.NO_TRIANGLE).all()
    for limit in (0, -1, np.nan):
        with pytest.raises(raymap.UsageError, match="max_distance must be above 0"):
            scene.query(points, max_distance=limit)


def test_an_empty_scene_is_far_everywhere():
    scene = raymap.Scene()
    found = scene.query([(0, 0, 0), (np.nan, 0, 0)], ("distance", "body", "closest"))
    np.testing.assert_array_equal(found.distance, [np.inf, np.nan])
    assert (found.body == raymap.NO_BODY).all() and np.isnan(found.closest).all()
    assert scene.signed_distance(np.zeros((2, 3)), np.zeros((5, 0, 4, 4))).shape == (5, 2)


def test_wrong_poses_are_named(scene):
    poses = random_poses(4, 3)
    poses[2, 1, 0, 3] = np.nan
    with pytest.raises(raymap.UsageError, match="the pose of body 'egg' in configuration 2 is no scaled rigid motion: it has a "
                       "number that is not finite in row 0, column 3"):  # fmt: skip
        scene.signed_distance((np.zeros((1, 3))), poses)
    before = scene.poses
    with pytest.raises(raymap.UsageError, match="the pose of body 'again' is no scaled rigid motion: it mirrors"):
        scene.poses = [np.eye(4), np.eye(4), np.diag([1, 1, -1, 1])]
    with pytest.raises(raymap.UsageError, match="the translation belongs into the last column"):
        scene.set_pose("egg", pose((1, 0, 0), 0, (1, 2, 3)).T)
    np.testing.assert_array_equal(scene.poses, before)
    for shape in ((4, 2, 4, 4), (2, 4, 4), (3, 4), ()):
        with pytest.raises(raymap.InputError, match=r"poses must be \(3, 4, 4\) or \(configurations, 3, 4, 4\) numbers, not of"):
            scene.signed_distance(np.zeros((1, 3)), np.zeros(shape))
    for shape in ((3,), (2, 5, 3)):
        with pytest.raises(raymap.InputError, match=r"points must be \(n, 3\) or \(4, n, 3\), not of the shape"):
            scene.signed_distance(np.zeros(shape), random_poses(4, 3))
    with pytest.raises(raymap.UsageError, match="arrays: nothing is named 'normal'; there are distance, body"):
        scene.query((0, 0, 0), "normal")


def test_a_copy_is_the_same(scene):
    copied = pickle.loads(pickle.dumps(scene))
    points = random_points(100)
    assert copied.names == scene.names
    np.testing.assert_array_equal(copied.signed_distance(points), scene.signed_distance(points))


def test_threads_share_a_scene(scene):
    points = random_points(4, 100)
    expected = scene.signed_distance(points)
    assert right_in_threads(lambda k: np.array_equal(scene.signed_distance(points[k]), expected[k]))


def test_progress_cancels(scene):
    with pytest.raises(raymap.Cancelled):
        scene.signed_distance(random_points(50_000), random_poses(5, 3), progress=lambda stage, done: False)


def test_poses_may_scale(ball_surface):
    made = pose((1, 2, 3), 0.7, (4, 5, 6))
    made[:3, :3] *= 2
    points = random_points(100) + 4
    alone = 2 * ball_surface.signed_distance((points - made[:3, 3]) @ made[:3, :3] / 4)
    np.testing.assert_allclose(ball_surface.signed_distance(points, transform=made), alone, atol=1e-12)


def test_fields_are_those_of_the_union(scene):
    field = scene.generate(resolution=24, padding=0.2)
    positions = np.stack(np.indices(field.distance.shape), -1) * field.spacing + field.origin
    np.testing.assert_array_equal(field.distance, scene.signed_distance(positions).astype(np.float32))
    band = scene.generate(voxel_size=field.spacing, bounds=scene.bounds, band=2, sparse=True)
    assert band.is_narrow and band.active_count > 0
    assert abs(scene.generate(resolution=8, band=1).distance).max() <= scene.generate(resolution=8).spacing * 1.001
    with pytest.raises(raymap.UsageError, match="band"):
        scene.generate(band=-1)
