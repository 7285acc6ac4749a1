"""Distances between surfaces: least, Hausdorff, and of the bodies of a scene."""

from __future__ import annotations

import numpy as np
import pytest
import raymap


def shifted(x: float) -> np.ndarray:
    made = np.eye(4)
    made[0, 3] = x
    return made


def test_least_distance_is_that_of_the_shapes(ball):
    surface = raymap.Surface(ball)
    found = surface.distance_to(surface, shifted(5))
    assert found.distance == found.bound == pytest.approx(3, abs=0.02)
    assert np.linalg.norm(found.point - found.other_point) == pytest.approx(found.distance, abs=1e-12)
    assert isinstance(found.triangle, int) and found.triangle < len(surface.mesh.faces)
    assert surface.distance_to(surface).distance == 0
    far = surface.distance_to(surface, shifted(5), max_distance=1)
    assert (far.distance, far.triangle) == (1, raymap.NO_TRIANGLE) and np.isnan(far.point).all()
    with pytest.raises(raymap.UsageError, match="no scaled rigid motion"):
        surface.distance_to(surface, np.diag([2, 1, 1, 1]))


def test_hausdorff_distance_lies_within_its_bound(ball):
    surface = raymap.Surface(ball)
    found = surface.hausdorff(surface, shifted(0.5), tolerance=1e-4)
    sampled = surface.signed_distance(surface.mesh.vertices - [0.5, 0, 0])
    assert abs(sampled).max() <= found.bound <= found.distance + 1e-4
    assert abs(surface.signed_distance(found.point - [0.5, 0, 0])) == pytest.approx(found.distance, abs=1e-9)
    cap = raymap.Surface(ball.vertices, ball.faces[ball.vertices[ball.faces].mean(1)[:, 2] > 0.5])
    assert cap.hausdorff(surface, both_ways=False).distance < 1e-6
    assert cap.hausdorff(surface).distance > 1
    with pytest.raises(raymap.UsageError, match="tolerance"):
        surface.hausdorff(surface, tolerance=0)


def test_bodies_of_a_scene_are_as_two_surfaces(ball):
    surface = raymap.Surface(ball)
    scene = raymap.Scene([surface, surface, surface])
    poses = np.tile(np.eye(4), (2, 3, 1, 1))
    poses[0, :, 0, 3], poses[1, :, 1, 3] = (0, 3, 7), (7, 4, 0)
    found = scene.distances_between(poses=poses)
    assert found.distance.shape == (2, 3) and found.point.shape == (2, 3, 3)
    assert found.distance == pytest.approx(np.array([[1, 5, 2], [1, 5, 2]]), abs=0.02)
    alone = surface.distance_to(surface, shifted(4))
    chosen = scene.distances_between([("1", "2")], poses[0], threads=1)
    assert chosen.distance == pytest.approx([alone.distance], abs=1e-12)
    assert chosen.point[0] == pytest.approx(alone.point + [3, 0, 0], abs=1e-9)
    assert scene.distances_between([]).distance.shape == (0,)
    with pytest.raises(raymap.UsageError, match="no body"):
        scene.distances_between([("0", "9")])
