"""Points with distances for training networks."""

from __future__ import annotations

import io
import operator
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap
from ._errors import InputError, UsageError
from ._progress import Progress
from ._surface import Query, Surface, has_sign

_Doubles = npt.NDArray[np.float64]

#: Length of the steps to both sides of a face, as a share of the bounding sphere's radius. The mesh is rounded by less,
#: and thinner solids do not matter.
_BESIDE = 2e-6


@dataclass(frozen=True, eq=False)
class Samples:
    """Points near a surface and around it, with signed distances, negative inside. ``raymap.sample_points`` makes them."""

    points: _Doubles
    """Positions, (n, 3) float64: those on the surface, then those near it, then the uniform ones. They are numbers of
    float32 wherever those lie close enough."""
    distance: _Doubles
    """Signed distances of ``points``, (n,) float64, negative inside, in the units of the points."""
    gradient: _Doubles
    """Gradients of the distance, (n, 3) float64: unit vectors that point outwards."""
    centre: _Doubles
    """Point of the mesh that lies at 0 in ``points``, (3,)."""
    scale: float
    """Length in ``points`` of one unit of the mesh: points = (mesh's positions - centre) * scale."""

    @property
    def pos(self) -> npt.NDArray[Any]:
        """Points that are not inside, (k, 4): x, y, z, distance. Float32 if all of ``points`` are, else float64."""
        return self._rows(self.distance >= 0)

    @property
    def neg(self) -> npt.NDArray[Any]:
        """Points inside, (k, 4): x, y, z, distance, of the type of ``pos``."""
        return self._rows(self.distance < 0)

    def _rows(self, chosen: npt.NDArray[np.bool_]) -> npt.NDArray[Any]:
        is_single = bool((self.points == _single(self.points)).all())
        rows = np.column_stack([self.points, self.distance])[chosen]
        return rows.astype(np.float32) if is_single else rows

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a .npz as DeepSDF reads it: ``pos`` and ``neg``. The file appears whole or not at all.

        Raises:
            UsageError: Another extension.
            FileError: The file cannot be written.

        >>> raymap.sample_points("ball.ply", 1000, normalize=True).save("ball.npz")
        >>> np.load("ball.npz")["neg"].shape[1]
        4
        """
        target = Path(path)
        if target.suffix.lower() != ".npz":
            raise UsageError(f"{target}: samples are written as .npz, not {target.suffix!r}")
        _raymap.write_whole(target, npz_content(self))


def sample_points(
    mesh: Any,
    n: int,
    *,
    near: float = 0.94,
    sigma: float | Iterable[float] = (0.0025, 0.00025),
    surface: float = 0.0,
    seed: int = 0,
    normalize: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Samples:
    """Returns points near a mesh with their signed distances, negative inside, as for training DeepSDF.

    Points near the surface are points of the surface, chosen evenly by area, plus normally distributed offsets along
    x, y and z. The others lie evenly in the mesh's bounding sphere. Defaults are those of mesh_to_sdf: of 50 points, 47
    are near the surface, half of them with each ``sigma``.

    The bounding sphere is about the centre of the mesh's bounds and reaches its farthest vertex. Nothing is scaled
    unless ``normalize`` asks for it.

    Points are rounded to float32 before their distances are measured, so that files have the right signs. Where steps
    of float32 exceed a sixteenth of the least ``sigma``, far from 0, points and files keep float64. ``normalize`` or
    smaller coordinates avoid that.

    Points of the same mesh and arguments are the same, bit for bit, on any machine and for any number of threads.
    Distances are, on the same kind of processor.

    Args:
        mesh: A ``raymap.Surface``, or a mesh or path as for ``raymap.Surface``. Arrays: ``raymap.Mesh(vertices, faces)``.
        n: Number of points.
        near: Share of the points that are near the surface, 0 to 1.
        sigma: Standard deviations of the offsets, as shares of the bounding sphere's radius. Each gets as many points.
        surface: Share of the points that are on the surface, 0 to 1. They have the distance 0, and the normal as their
            gradient. It points to the outside, however the face is wound. If both sides are inside or both outside, it
            points to that whose winding number is closer to 0. The face decides where both numbers are equally close,
            as beside a sheet.
        seed: Whole number from 0 on. Another one gives other points.
        normalize: Whether to move and scale all results so that the bounding sphere is the unit sphere about 0.
            ``Samples.centre`` and ``Samples.scale`` say how.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        progress: A callable that receives a stage and its share, 0 to 1; True for a line on stderr.

    Raises:
        InputError: The mesh is not valid, or has no area.
        UsageError: Shares that make no sense, or a surface without a sign.
        MemoryLimitError: The points do not fit into memory.
        FileError: The file cannot be read.
        Cancelled: ``progress`` returned False.

    >>> samples = raymap.sample_points("ball.ply", 1000)
    >>> samples.points.shape, samples.distance.shape, samples.gradient.shape
    ((1000, 3), (1000,), (1000, 3))
    >>> samples.pos.shape[0] + samples.neg.shape[0]
    1000
    """
    counts, deviations = point_counts(operator.index(n), float(near), float(surface), sigma)
    prepared = mesh if isinstance(mesh, Surface) else Surface(_inputs.to_mesh(mesh), threads=threads, progress=progress)
    if not has_sign(prepared):
        raise UsageError("the surface was made with sign=False, so its points have no sign")
    kept = prepared.mesh
    centre, radius = _sphere(kept.vertices, kept.faces)
    random = _Random(operator.index(seed))
    areas = _Areas(kept.vertices, kept.faces, prepared.stats["left_out_faces"])
    on_surface, triangles = areas.points(counts[0], random)
    parts = [on_surface]
    for count, deviation in zip(counts[1:-1], deviations, strict=True):
        parts.append(areas.points(count, random)[0] + random.normal((count, 3)) * (deviation * radius))
    parts.append(centre + random.in_ball(counts[-1]) * radius)
    origin, unit = (centre, radius) if normalize else (np.zeros(3), 1.0)
    stored = (np.concatenate(parts) - origin) / unit
    if _is_single_enough((np.abs(centre - origin).max() + radius) / unit, deviations.min() * radius / unit):
        stored = _single(stored)
    found = prepared.query(stored * unit + origin, ("distance", "direction"), threads=threads, progress=progress)
    distance, gradient = found.distance, np.where(found.distance[:, None] < 0, found.direction, -found.direction)
    distance[: counts[0]] = 0.0
    normals = areas.normals(triangles, prepared.stats["turned_faces"])
    ask = partial(prepared.query, threads=threads, progress=progress)
    gradient[: counts[0]] = _outward(normals, on_surface, _BESIDE * radius, ask)
    return Samples(stored, distance / unit, gradient + 0.0, origin, 1.0 / unit)


def npz_content(samples: Samples, **more: Any) -> bytes:
    """Returns a .npz as DeepSDF reads it, with more arrays."""
    content = io.BytesIO()
    np.savez(content, pos=samples.pos, neg=samples.neg, **more)
    return content.getvalue()


def _is_single_enough(reach: float, deviation: float) -> bool:
    """Returns whether the steps of float32 are short beside a deviation, up to a distance from 0."""
    with np.errstate(over="ignore"):
        return bool(np.spacing(np.float32(reach)) <= deviation / 16)


def _single(points: _Doubles) -> _Doubles:
    with np.errstate(over="ignore"):
        return points.astype(np.float32).astype(np.float64)


def _outward(normals: _Doubles, points: _Doubles, step: float, ask: Callable[..., Query]) -> _Doubles:
    """Returns normals at points of a surface, reversed where they point to the inside, as `sample_points` says."""
    sides = np.concatenate([points + step * normals, points - step * normals]).reshape(2, -1, 3)
    is_above_inside, is_below_inside = ask(sides).distance < 0
    is_inward = is_above_inside & ~is_below_inside
    unsure = np.flatnonzero(is_above_inside == is_below_inside)
    above, below = np.abs(ask(sides[:, unsure], "winding").winding)
    is_inward[unsure] = above - below > 0.5  # Across a face the number changes by 1, else by much less.
    return np.where(is_inward[:, None], -normals, normals)


def point_counts(n: int, near: float, surface: float, sigma: float | Iterable[float]) -> tuple[list[int], _Doubles]:
    """Returns numbers of points: on the surface, near it for each deviation, uniform. And the deviations."""
    if n < 0:
        raise UsageError(f"n must not be negative, not {n}")
    deviations = np.atleast_1d(np.asarray(sigma if isinstance(sigma, float) else list(_iterable(sigma)), np.float64))
    if deviations.ndim != 1 or deviations.size == 0 or not (deviations >= 0).all() or not np.isfinite(deviations).all():
        raise UsageError(f"sigma must be numbers from 0 on, not {sigma}")
    for name, share in (("near", near), ("surface", surface)):
        if not 0 <= share <= 1:
            raise UsageError(f"{name} must be a share from 0 to 1, not {share}")
    on_surface = round(n * surface)
    close = round(n * near)
    if on_surface + close > n:
        raise UsageError(f"near and surface must be at most 1 together, not {near} and {surface}")
    kinds = deviations.size
    each = [close // kinds + (k < close % kinds) for k in range(kinds)]
    return [on_surface, *each, n - on_surface - close], deviations


def _iterable(sigma: Any) -> Iterable[float]:
    return sigma if isinstance(sigma, Iterable) else (sigma,)


def _sphere(vertices: _Doubles, faces: npt.NDArray[Any]) -> tuple[_Doubles, float]:
    """Returns centre and radius of the sphere about the bounds' centre around all vertices that faces use."""
    used = vertices[np.unique(faces)]
    centre = (used.min(axis=0) + used.max(axis=0)) / 2
    return centre, float(_lengths(used - centre).max())


def _lengths(v: _Doubles) -> _Doubles:
    """Returns lengths by operations that IEEE 754 rounds alike everywhere; NumPy's sums may differ in their order."""
    return np.sqrt(v[:, 0] * v[:, 0] + v[:, 1] * v[:, 1] + v[:, 2] * v[:, 2])


class _Areas:
    """Chooses points of a mesh evenly by area, but none of faces that are left out."""

    def __init__(self, vertices: _Doubles, faces: npt.NDArray[Any], left_out: npt.NDArray[np.uint32]) -> None:
        self._corners = vertices[faces]
        u, v = self._corners[:, 1] - self._corners[:, 0], self._corners[:, 2] - self._corners[:, 0]
        axes = ((1, 2), (2, 0), (0, 1))
        self._normals = np.stack([u[:, a] * v[:, b] - u[:, b] * v[:, a] for a, b in axes], axis=1)
        self._lengths = _lengths(self._normals)
        self._lengths[left_out] = 0.0
        self._sums = np.cumsum(self._lengths)  # One after the other, in this order.
        if not self._sums[-1] > 0:
            raise InputError("the mesh has no area: all of its faces are degenerate")

    def points(self, count: int, random: _Random) -> tuple[_Doubles, npt.NDArray[np.intp]]:
        """Returns points and their triangles."""
        place = random.uniform(count) * self._sums[-1]
        triangles = np.searchsorted(self._sums, place, side="right")
        root, share = np.sqrt(random.uniform(count))[:, None], random.uniform(count)[:, None]
        a, b, c = (self._corners[triangles, k] for k in range(3))
        points: _Doubles = a * (1 - root) + b * (root * (1 - share)) + c * (root * share)
        return points, triangles

    def normals(self, triangles: npt.NDArray[np.intp], reversed_faces: npt.NDArray[np.uint32]) -> _Doubles:
        """Returns unit normals; of reversed faces, those of their other side."""
        signs = np.where(np.isin(triangles, reversed_faces), -1.0, 1.0)
        scaled: _Doubles = self._normals[triangles] * (signs / self._lengths[triangles])[:, None]
        return scaled


class _Random:
    """Random numbers that are the same bits with every version of NumPy and on every machine.

    NumPy promises that for the raw numbers of PCG64, but not for its distributions, nor for its logarithm.
    """

    def __init__(self, seed: int) -> None:
        if seed < 0:
            raise UsageError(f"seed must not be negative, not {seed}")
        self._bits = np.random.PCG64(seed)

    def uniform(self, count: int) -> _Doubles:
        """Returns multiples of 2^-53 in [0, 1)."""
        return (self._bits.random_raw(count) >> np.uint64(11)).astype(np.float64) * 2.0**-53

    def in_ball(self, count: int, dimensions: int = 3) -> _Doubles:
        """Returns points of the unit ball without its centre, by rejection from its cube."""
        found = np.empty((0, dimensions))
        while len(found) < count:
            missing = 2 * (count - len(found)) + 16
            points = 2 * self.uniform(missing * dimensions).reshape(-1, dimensions) - 1
            squares = sum(points[:, k] * points[:, k] for k in range(dimensions))
            found = np.concatenate([found, points[(squares < 1) & (squares > 0)]])
        return found[:count]

    def normal(self, shape: tuple[int, int]) -> _Doubles:
        """Returns numbers of the standard normal distribution, by Marsaglia's polar method."""
        count = shape[0] * shape[1]
        points = self.in_ball((count + 1) // 2, dimensions=2)
        squares = points[:, 0] * points[:, 0] + points[:, 1] * points[:, 1]
        factors = np.sqrt(-2 * _log(squares) / squares)
        return (points * factors[:, None]).reshape(-1)[:count].reshape(shape)


def _log(x: _Doubles) -> _Doubles:
    """Returns natural logarithms within 1e-15, by operations that IEEE 754 rounds alike everywhere."""
    mantissa, exponent = np.frexp(x)
    is_low = mantissa < np.sqrt(0.5)
    mantissa, exponent = np.where(is_low, 2 * mantissa, mantissa), exponent - is_low
    s = (mantissa - 1) / (mantissa + 1)  # At most 0.172: the 11 terms of atanh's series leave 1e-18.
    square, series = s * s, np.zeros_like(s)
    for k in range(21, 0, -2):
        series = series * square + 1 / k
    result: _Doubles = exponent * 0.6931471805599453 + 2 * s * series
    return result
