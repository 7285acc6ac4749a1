"""Points with distances for training networks."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap, _views
from ._arguments import FINITE, to_number, to_vector, to_whole
from ._devices import to_machine
from ._progress import Progress, reporting
from ._surface import Surface, core_of_surface

_Doubles = npt.NDArray[np.float64]


@_views.shown
class Samples(NamedTuple):
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
        return _raymap.sample_rows(self.points, self.distance, False)  # type: ignore[return-value]

    @property
    def neg(self) -> npt.NDArray[Any]:
        """Points inside, (k, 4): x, y, z, distance, of the type of ``pos``."""
        return _raymap.sample_rows(self.points, self.distance, True)  # type: ignore[return-value]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes .npz, .csv or .ply by extension. The file appears whole or not at all.

        A .npz has ``pos`` and ``neg``, as DeepSDF reads them, and ``centre`` and ``scale``. A .csv and the vertices of a
        .ply have all points in their order, with their distances and gradients.

        Raises:
            UsageError: Another extension.
            FileError: The file cannot be written.

        >>> raymap.sample_points("ball.ply", 1000, normalize=True).save("ball.npz")
        >>> np.load("ball.npz")["neg"].shape[1]
        4
        """
        _save(self, path, "")


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
        seed: Whole number from 0 to 2^64 - 1. Another one gives other points.
        normalize: Whether to move and scale all results so that the bounding sphere is the unit sphere about 0.
            ``Samples.centre`` and ``Samples.scale`` say how.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.
        progress: A callable that receives a stage and its share, 0 to 1; True to show it.

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
    options = to_sample_options(n, near, sigma, surface, seed)
    options.normalize = bool(normalize)
    prepared = mesh if isinstance(mesh, Surface) else Surface(_inputs.to_mesh(mesh), threads=threads, progress=progress)
    with reporting(progress) as report:
        points, distance, gradient, centre, scale = _raymap.sample_points(
            core_of_surface(prepared), options, to_machine("cpu", threads), report
        )
    return Samples(points, distance, gradient, np.array(centre), scale)


def save_as_npz(samples: Samples, path: str | os.PathLike[str]) -> None:
    """Writes a .npz, whatever the path ends with."""
    _save(samples, path, ".npz")


def _save(samples: Samples, path: str | os.PathLike[str], extension: str) -> None:
    arrays = (samples.points, samples.distance, samples.gradient)
    _raymap.save_samples(os.fspath(path), *arrays, to_vector("centre", samples.centre), samples.scale, extension)


def to_sample_options(
    n: int, near: float, sigma: float | Iterable[float], surface: float, seed: int
) -> _raymap.SamplePointsOptions:
    """Returns the options as the extension module takes them. Checks them."""
    options = _raymap.SamplePointsOptions()
    options.count, options.seed = (to_whole(name, number, most=2**64 - 1) for name, number in (("n", n), ("seed", seed)))
    options.near, options.surface = to_number("near", near, least=0.0, most=1.0), to_number("surface", surface, least=0.0, most=1.0)
    options.sigmas = [to_number("sigma", s, least=0.0, most=FINITE) for s in (sigma if isinstance(sigma, Iterable) else (sigma,))]
    _raymap.sample_point_counts(options)
    return options
