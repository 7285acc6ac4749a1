"""Points for training: their distribution, distances, reproducibility, files."""

from __future__ import annotations

import hashlib
import os
import resource
import signal
import subprocess
import sys

import numpy as np
import pytest
import raymap

COUNT = 20_000


@pytest.fixture(scope="module")
def surface(ball) -> raymap.Surface:
    return raymap.Surface(ball)


@pytest.fixture(scope="module")
def samples(surface) -> raymap.Samples:
    return raymap.sample_points(surface, COUNT)


def test_distances_and_gradients_are_those_of_the_surface(surface, samples):
    assert samples.points.shape == samples.gradient.shape == (COUNT, 3) and samples.points.dtype == np.float64
    np.testing.assert_array_equal(samples.distance, surface.signed_distance(samples.points))
    near = np.abs(samples.distance) < 0.01
    outwards = samples.points[near] / np.linalg.norm(samples.points[near], axis=1, keepdims=True)
    assert np.einsum("ij,ij->i", samples.gradient[near], outwards).min() > 0.9
    assert (samples.centre == 0).all() and samples.scale == 1


def test_counts(surface):
    samples = raymap.sample_points(surface, 11, near=0.5, surface=0.3, sigma=(0.1, 0.2, 0.3))
    assert samples.points.shape == (11, 3) and (samples.distance == 0).sum() == 3
    empty = raymap.sample_points(surface, 0)
    assert empty.points.shape == (0, 3) and empty.pos.shape == (0, 4) and empty.neg.shape == (0, 4)


def test_the_same_seed_gives_the_same_bits(ball, surface, samples):
    exact = raymap.sample_points("tetrahedron.ply", 1000, surface=0.01).points
    assert hashlib.sha256(exact.tobytes()).hexdigest() == "97f54c7534005b7032bd8e06a6f882d1d2bc7c21f4192634db438888c5a566f7"
    options = {"near": 0.5, "surface": 0.2, "sigma": (0.1, 0.01), "seed": 2**63 + 5, "normalize": True}
    moved = raymap.sample_points("tetrahedron.ply", 1000, **options).points
    assert hashlib.sha256(moved.tobytes()).hexdigest() == "6fbff74869bb3b07656aa4c8f6cc305c0963f57c23e2ce1d9c8b085c629d3c9b"
    for other in (raymap.sample_points(ball, COUNT, threads=1), raymap.sample_points(surface, COUNT, seed=0)):
        for name in ("points", "distance", "gradient"):
            np.testing.assert_array_equal(getattr(other, name), getattr(samples, name))
    assert (raymap.sample_points(surface, COUNT, seed=1).points != samples.points).any(axis=1).all()


def test_normalized(ball):
    """A mesh that is neither of size 1 nor about 0."""
    moved = raymap.Mesh(ball.vertices * 3 + (10, -20, 30), ball.faces)
    scaled = raymap.sample_points(moved, 500, normalize=True)
    np.testing.assert_allclose(scaled.centre, (10, -20, 30), atol=1e-5)
    assert scaled.scale == pytest.approx(1 / 3, rel=1e-6)
    exact = raymap.signed_distance(moved, scaled.points / scaled.scale + scaled.centre)
    np.testing.assert_allclose(scaled.distance, exact * scaled.scale, atol=1e-12)


def test_files(samples):
    samples.save("points.csv")
    table = np.loadtxt("points.csv", delimiter=",", skiprows=1)
    np.testing.assert_array_equal(table, np.column_stack([samples.points, samples.distance, samples.gradient]))
    samples.save("points.npz")
    stored = np.load("points.npz")
    assert sorted(stored.files) == ["centre", "neg", "pos", "scale"]
    np.testing.assert_array_equal(stored["centre"], samples.centre)
    assert stored["scale"] == samples.scale and stored["scale"].shape == ()
    for name in ("pos", "neg"):
        np.testing.assert_array_equal(stored[name], getattr(samples, name))
        assert stored[name].dtype == np.float32 and stored[name].shape[1] == 4
    assert (stored["neg"][:, 3] < 0).all() and (stored["pos"][:, 3] >= 0).all()
    assert len(stored["neg"]) + len(stored["pos"]) == COUNT
    with pytest.raises(raymap.UsageError, match="points.txt: '.txt' is not a format for points with distances; use one of .npz"):
        samples.save("points.txt")
    with pytest.raises(raymap.FileError, match="^gone/points.npz: cannot write: No such file"):
        samples.save("gone/points.npz")


@pytest.mark.parametrize("place", [(0, 0, 0), (3, -40, 100), (5e5, 4.5e6, 0)])
@pytest.mark.parametrize("normalize", [False, True])
def test_stored_points_have_the_sign_of_their_place(ball, place, normalize):
    surface = raymap.Surface(ball.vertices + place, ball.faces)
    samples = raymap.sample_points(surface, COUNT, normalize=normalize)
    samples.save("points.npz")
    stored = np.load("points.npz")
    for name, is_inside in (("pos", False), ("neg", True)):
        rows = stored[name].astype(np.float64)
        distance = surface.signed_distance(rows[:, :3] / samples.scale + samples.centre)
        np.testing.assert_array_equal(distance < 0, is_inside)
        np.testing.assert_allclose(rows[:, 3], distance * samples.scale, rtol=1e-6, atol=1e-12)
        is_far = max(place) > 1e6 and not normalize
        assert stored[name].dtype == (np.float64 if is_far else np.float32)


def test_rows_are_float32_where_its_steps_are_short(ball):
    """Steps are at most a sixteenth of the least deviation, up to the end of the bounding sphere."""
    exact = 2.0**-19  # A sixteenth of 2^-15. Steps of float32 have this length from 16 to 32.
    for far, sigma, dtype in (
        (30.9, 16 * exact, np.float32), (31.1, 16 * exact, np.float64), (30.9, 15.9 * exact, np.float64),
        (0.0, 0.0, np.float64), (30.9, (1.0, 16 * exact), np.float32), (30.9, (1.0, 15.9 * exact), np.float64),
    ):  # fmt: skip
        mesh = raymap.Mesh(ball.vertices + (0, -far, 0), ball.faces)
        samples = raymap.sample_points(mesh, 100, sigma=sigma)
        assert samples.pos.dtype == samples.neg.dtype == dtype
        np.testing.assert_array_equal(samples.pos[:, :3], samples.points[samples.distance >= 0])
    assert raymap.sample_points(ball, 0).pos.dtype == np.float32


def test_a_killed_program_leaves_nothing_but_what_the_next_save_removes():
    """The system ends the program while it writes, as its file grows too large."""
    program = (
        "import raymap, resource, signal; samples = raymap.sample_points('ball.ply', 1000)\n"
        "resource.setrlimit(resource.RLIMIT_CORE, (0, 0)); resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))\n"
        "signal.signal(signal.SIGXFSZ, signal.SIG_DFL); samples.save('out/b.npz')"
    )
    os.mkdir("out")
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == -signal.SIGXFSZ
    raymap.sample_points("ball.ply", 10).save("out/b.npz")
    assert os.listdir("out") == ["b.npz"]


def test_a_file_that_cannot_be_written_leaves_the_old_one(samples):
    samples.save("points.npz")
    before = open("points.npz", "rb").read()
    files = os.listdir()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100, limits[1]))
    try:
        with pytest.raises(raymap.FileError, match="^points.npz: cannot write: File too large"):
            samples.save("points.npz")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert open("points.npz", "rb").read() == before and os.listdir() == files


@pytest.mark.parametrize("arguments, error, text", [
    (dict(n=-1), raymap.UsageError, "n must be 0 or more, not -1"),
    (dict(n=1.5), TypeError, None),
    (dict(near=1.1), raymap.UsageError, "near must be from 0 to 1, not 1.1"),
    (dict(near=float("nan")), raymap.UsageError, "near must be from 0 to 1"),
    (dict(surface=-0.1), raymap.UsageError, "surface must be from 0 to 1, not -0.1"),
    (dict(near=0.8, surface=0.3), raymap.UsageError, "at most 1 together, not 0.8 and 0.3"),
    (dict(sigma=-1.0), raymap.UsageError, "sigma must be 0 or more, not -1"),
    (dict(sigma=()), raymap.UsageError, "sigma must be numbers"),
    (dict(sigma=(0.1, float("inf"))), raymap.UsageError, "sigma must be finite"),
    (dict(seed=-1), raymap.UsageError, "seed must be 0 or more, not -1"),
    (dict(seed=2**64), raymap.UsageError, "seed must be 18446744073709551615 or less, not 18446744073709551616"),
    (dict(seed=0.5), TypeError, None),
])
def test_arguments_that_make_no_sense(surface, arguments, error, text):
    with pytest.raises(error, match=text):
        raymap.sample_points(surface, **{"n": 10, **arguments})


def test_meshes_without_points(ball):
    with pytest.raises(raymap.UsageError, match="without a sign, so its points have no sign"):
        raymap.sample_points(raymap.Surface(ball, sign=False), 10)
    with pytest.raises(raymap.InputError, match="the mesh has no area"):
        raymap.sample_points(raymap.Mesh([(0, 0, 0), (1, 0, 0), (2, 0, 0)], [(0, 1, 2)]), 10)
