"""Meshes broken on purpose, the same everywhere: those of src/testing/broken_meshes.h and shapes.h."""

import numpy as np


def words(seed, count):
    """Returns the first numbers of std::mt19937."""
    return np.random.RandomState(seed).randint(0, 2**32, count, dtype=np.uint32)


def units(seed, count):
    """Returns what std::uniform_real_distribution<double> makes of them."""
    low, high = words(seed, 2 * count).astype(float).reshape(-1, 2).T
    return (low + high * 2.0**32) / 2.0**64


def torus(n=60, m=30):
    i, j = np.divmod(np.arange(n * m), m)
    u, v = 2 * np.pi * i / n, 2 * np.pi * j / m
    vertices = np.stack([(1 + 0.4 * np.cos(v)) * np.cos(u), (1 + 0.4 * np.cos(v)) * np.sin(u), 0.4 * np.sin(v)], axis=1)
    corner = lambda a, b: ((i + a) % n) * m + (j + b) % m  # noqa: E731
    faces = [(corner(0, 0), corner(1, 0), corner(1, 1)), (corner(0, 0), corner(1, 1), corner(0, 1))]
    return vertices, np.stack([np.stack(face, axis=1) for face in faces], axis=1).reshape(-1, 3)


def with_holes(mesh, count, seed, radius=0.06):
    vertices, faces = mesh
    centres = vertices[words(seed, count) % len(vertices)]
    middles = vertices[faces].mean(axis=1)
    away = np.linalg.norm(middles[:, None] - centres[None], axis=2).min(axis=1)
    return vertices, faces[away >= radius * np.linalg.norm(np.ptp(vertices[faces].reshape(-1, 3), axis=0))]


def with_missing_faces(mesh, share, seed):
    return mesh[0], mesh[1][units(seed, len(mesh[1])) >= share]


def with_flipped_faces(mesh, share, seed):
    flipped = units(seed, len(mesh[1])) < share
    return mesh[0], np.where(flipped[:, None], mesh[1][:, [0, 2, 1]], mesh[1])


def with_doubled_faces(mesh, share, seed):
    return mesh[0], np.concatenate([mesh[1], mesh[1][units(seed, len(mesh[1])) < share][:, ::-1]])


def with_moved_corners(mesh, share, seed):
    """Gives every face corners of its own, moved by up to a share of the longest side."""
    vertices, faces = mesh
    corners = vertices[faces].reshape(-1, 3)
    moves = 2 * units(seed, 9 * len(corners)).reshape(-1, 3)[:, ::-1] - 1  # The compiler draws z first.
    moves = moves[np.linalg.norm(moves, axis=1) <= 1][: len(corners)]
    return corners + share * np.ptp(corners, axis=0).max() * moves, np.arange(len(corners)).reshape(-1, 3)


def overlapping_pair(mesh):
    vertices, faces = mesh
    moved = vertices + np.ptp(vertices, axis=0) * (0.3, 0.2, 0.1)
    return np.concatenate([vertices, moved]), np.concatenate([faces, faces + len(vertices)])


def broken(name, mesh):
    return {f"{name}, one hole": with_holes(mesh, 1, 1), f"{name}, five holes": with_holes(mesh, 5, 2),
            f"{name}, 20 % of faces missing": with_missing_faces(mesh, 0.2, 3),
            f"{name}, all corners moved 1.5 %": with_moved_corners(mesh, 0.015, 4)}  # fmt: skip
