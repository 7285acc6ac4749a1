"""Points with distances for training networks."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, TypeAlias, TypedDict, get_args

import numpy as np
import numpy.typing as npt

from . import _inputs, _raymap, _views
from ._arguments import FINITE, to_names, to_number, to_path, to_threads, to_vector, to_whole
from ._errors import UsageError
from ._frames import Frame, Normalization, frame_of, to_normalization
from ._options import core_options
from ._progress import Progress, reporting
from ._surface import Surface, core_of_surface

_Doubles = npt.NDArray[np.float64]

#: Where the points lie that are chosen evenly in space.
Region: TypeAlias = Literal["sphere", "cube"]

#: Name of what a ``raymap.Sampler`` gives for each point.
SampleArray: TypeAlias = Literal[
    "distance", "occupancy", "gradient", "closest", "winding", "confidence", "kind", "weight"
]


@dataclass(frozen=True)
class Mixture:
    """Which points to choose, of any mesh and in any number."""

    near: float = 0.94
    sigmas: tuple[float, ...] = (0.0025, 0.00025)
    surface: float = 0.0
    region: Region = "sphere"
    padding: float = 0.0
    normalization: Normalization | None = None
    margin: float = 1.0
    """Factor by which the normalized mesh is smaller than ``normalization`` says."""

    def options(self, count: int, seed: int) -> dict[str, Any]:
        """Returns the options of a mesh whose lengths do not matter."""
        return {
            "count": count,
            "seed": seed,
            "near_share": self.near,
            "surface_share": self.surface,
            "sigmas": self.sigmas,
            "normalize": self.normalization == "sphere",
            "in_cube": self.region == "cube",
        }

    def counts(self, count: int) -> list[int]:
        """Returns the number of points on the surface, near it with each deviation, and all around.

        Raises:
            UsageError: Shares that make no sense.
        """
        return _raymap.sample_point_counts(core_options(self.options(count, 0)))

    def lengths(self, surface: Surface) -> tuple[float, float]:
        """Returns the length of the mesh that becomes 1, and that from the centre to the region's end; 0 = the default."""
        is_box = self.normalization in ("cube", "unit") or (self.normalization is None and self.region == "cube")
        unit, radius = 0.0, 0.0
        if self.normalization in ("cube", "unit") or self.margin != 1.0:
            unit = self.margin / frame_of(surface.mesh, self.normalization).scale
        if is_box or self.padding > 0.0 or self.margin != 1.0:
            half = 1.0 / frame_of(surface.mesh, "cube" if is_box else "sphere").scale
            radius = half * self.margin * (1.0 + 2.0 * self.padding)
        return unit, radius


def to_mixture(
    near: float,
    sigma: float | Iterable[float],
    surface: float,
    region: Region,
    padding: float,
    normalize: bool | Normalization,
) -> Mixture:
    """Returns the mixture that arguments ask for. Checks them."""
    if region not in get_args(Region):
        raise UsageError(f"region must be 'sphere' or 'cube', not {region!r}")
    mixture = Mixture(
        to_number("near", near, least=0.0, most=1.0),
        tuple(to_number("sigma", s, least=0.0, most=FINITE) for s in (sigma if isinstance(sigma, Iterable) else (sigma,))),
        to_number("surface", surface, least=0.0, most=1.0),
        region,
        to_number("padding", padding, least=0.0, most=FINITE),
        to_normalization(normalize),
    )
    mixture.counts(1000)
    return mixture


def to_count(n: int) -> int:
    """Returns a number of points."""
    return to_whole("n", n, most=2**64 - 1)


def to_seed(seed: int) -> int:
    """Returns a seed."""
    return to_whole("seed", seed, most=2**64 - 1)


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
    region: Region = "sphere",
    padding: float = 0.0,
    seed: int = 0,
    normalize: bool | Normalization = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Samples:
    """Returns points near a mesh with their signed distances, negative inside, as for training DeepSDF.

    Points near the surface are points of the surface, chosen evenly by area, plus normally distributed offsets along
    x, y and z. The others lie evenly in the mesh's bounding sphere, or in another ``region``. Defaults are those of mesh_to_sdf: of 50 points, 47
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
        region: Where the other points lie evenly, about the centre of the mesh's bounds: ``"sphere"``, a ball, or
            ``"cube"``. It is the one that ``normalize`` scales to -1 to 1, or -0.5 to 0.5. Without ``normalize``, the
            ball is the bounding sphere, and the side of the cube is the longest side of the bounds.
        padding: Padding of the region on every side, as a share of its width.
        seed: Whole number from 0 to 2^64 - 1. Another one gives other points.
        normalize: Whether to move and scale all results, so that the bounding sphere is the unit sphere about 0
            (``"sphere"``, or True), or the longest side of the bounds reaches from -1 to 1 (``"cube"``) or from -0.5 to
            0.5 (``"unit"``). ``Samples.centre`` and ``Samples.scale`` say how.
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
    mixture = to_mixture(near, sigma, surface, region, padding, normalize)
    count, checked_seed = to_count(n), to_seed(seed)
    prepared = to_surface(mesh, threads, progress)
    return choose(prepared, mixture, mixture.lengths(prepared), count, checked_seed, threads, progress)


def to_surface(mesh: Any, threads: int | None = None, progress: Progress = None) -> Surface:
    """Returns a surface as it is, and one of any other mesh."""
    if isinstance(mesh, Surface):
        return mesh
    return Surface(_inputs.to_mesh(mesh), threads=threads, progress=progress)


def choose(
    surface: Surface,
    mixture: Mixture,
    lengths: tuple[float, float],
    count: int,
    seed: int,
    threads: int | None,
    progress: Progress = None,
) -> Samples:
    """Chooses points. ``lengths`` are those of the mixture and the surface."""
    unit, radius = lengths
    options = core_options(mixture.options(count, seed), unit=unit, radius=radius, threads=threads)
    with reporting(progress) as report:
        points, distance, gradient, centre, scale = _raymap.sample_points(core_of_surface(surface), options, report)
    return Samples(points, distance, gradient, np.array(centre), scale)


class SamplerOptions(TypedDict, total=False):
    """Keyword arguments of ``raymap.Sampler`` but its seed."""

    arrays: SampleArray | Iterable[SampleArray]
    near: float
    sigma: float | Iterable[float]
    surface: float
    region: Region
    padding: float
    normalize: bool | Normalization
    dtype: npt.DTypeLike
    shuffle: bool
    block: int
    threads: int | None


class Sampler(Sequence[dict[str, npt.NDArray[Any]]]):
    """A stream of points with what networks learn of them, negative inside: a sequence of blocks, made when asked for.

    A block is a dict of arrays, ``points`` among them. It depends on the mesh, the arguments and its number alone: not
    on other blocks, threads, processes or the order. So workers may share a stream without a word: worker w of W takes
    the blocks w, w + W, w + 2 W and so on. Memory holds one block, however large ``n`` is. A sampler can be pickled.

    Arrays:
        - ``points``: positions, (k, 3); rounded before anything is measured, so that signs are right for them.
        - ``distance``: signed distances, (k,), negative inside, in the units of the points; 0 on the surface.
        - ``occupancy``: whether a point is inside, (k,) bool; False on the surface.
        - ``gradient``: gradients of the distance, (k, 3): unit vectors that point outwards, on the surface its normals.
        - ``closest``: closest points of the surface, (k, 3).
        - ``winding``, ``confidence``: as those of ``raymap.Surface.query``, (k,).
        - ``kind``: 0 for points on the surface, 1, 2, … for those near it with each ``sigma``, then those all around;
          (k,) uint8.
        - ``weight``: weights with which each kind of a block counts the same, (k,); their mean is 1.

    Args:
        mesh: A ``raymap.Surface``, or a mesh or path as for ``raymap.Surface``.
        n: Number of points of all blocks together.
        arrays: Names of the arrays beside ``points``.
        near: Share of the points of a block that are near the surface, 0 to 1.
        sigma: Standard deviations of their offsets, as shares of the bounding sphere's radius.
        surface: Share of the points that are on the surface, 0 to 1.
        region: Where the other points lie, as for ``raymap.sample_points``.
        padding: Padding of the region on every side, as a share of its width.
        normalize: Whether to move and scale the mesh, as for ``raymap.sample_points``.
        dtype: Type of all numbers: ``"float16"``, ``"float32"`` or ``"float64"``.
        shuffle: Whether the points of a block are in random order; else in that of their kinds.
        block: Number of points of a block; the last one may have fewer.
        seed: Whole number from 0 to 2^64 - 1. Another one gives other points.
        threads: Number of CPU threads of a block; None = ``raymap.get_threads()``.

    Raises:
        InputError: The mesh is not valid, or has no area.
        UsageError: Arguments that make no sense, or a surface without a sign.
        FileError: The file cannot be read.

    >>> sampler = raymap.Sampler("ball.ply", 10**9, arrays=("distance", "occupancy"), block=1000, dtype="float16")
    >>> len(sampler)
    1000000
    >>> last = sampler[-1]
    >>> last["points"].shape, last["points"].dtype, last["occupancy"].dtype
    ((1000, 3), dtype('float16'), dtype('bool'))
    """

    def __init__(
        self,
        mesh: Any,
        n: int,
        *,
        arrays: SampleArray | Iterable[SampleArray] = ("distance",),
        near: float = 0.94,
        sigma: float | Iterable[float] = (0.0025, 0.00025),
        surface: float = 0.0,
        region: Region = "sphere",
        padding: float = 0.0,
        normalize: bool | Normalization = False,
        dtype: npt.DTypeLike = "float32",
        shuffle: bool = True,
        block: int = 1 << 16,
        seed: int = 0,
        threads: int | None = None,
    ) -> None:
        self._mixture = to_mixture(near, sigma, surface, region, padding, normalize)
        self._names = _array_names(arrays)
        self._dtype = np.dtype(dtype)
        if self._dtype not in (np.float16, np.float32, np.float64):
            raise UsageError(f"dtype must be float16, float32 or float64, not {self._dtype}")
        self._n, self._block, self._seed = to_count(n), to_whole("block", block, least=1), to_seed(seed)
        self._shuffle = bool(shuffle)
        to_threads(threads)
        self._threads = threads
        self._surface = to_surface(mesh, threads)
        self._lengths = self._mixture.lengths(self._surface)
        none = choose(self._surface, self._mixture, self._lengths, 0, 0, threads)
        self._frame = Frame(none.centre, none.scale)

    @property
    def centre(self) -> _Doubles:
        """Point of the mesh that lies at 0 in ``points``, (3,)."""
        return self._frame.centre.copy()

    @property
    def scale(self) -> float:
        """Length in ``points`` of one unit of the mesh: points = (mesh's positions - centre) * scale."""
        return self._frame.scale

    def __len__(self) -> int:
        return -(-self._n // self._block)

    def __getitem__(self, index: int) -> dict[str, npt.NDArray[Any]]:  # type: ignore[override]
        """Returns a block."""
        k = to_whole("the number of a block", index, least=-len(self), most=2**63 - 1) if len(self) else 0
        if k >= len(self):
            raise IndexError(f"there are {len(self)} blocks, and so none has the number {k}")
        k %= len(self)
        count = min(self._block, self._n - k * self._block)
        seed = int.from_bytes(hashlib.sha256(f"{self._seed} {k}".encode()).digest()[:8], "little")
        made = self._made(count, seed)
        if self._shuffle:
            order = np.argsort(np.random.Philox(key=seed).random_raw(count), kind="stable")
            made = {name: array[order] for name, array in made.items()}
        return made

    def _made(self, count: int, seed: int) -> dict[str, npt.NDArray[Any]]:
        """Returns a block in the order of its kinds."""
        counts = self._mixture.counts(count)
        samples = choose(self._surface, self._mixture, self._lengths, count, seed, self._threads)
        points = samples.points.astype(self._dtype)
        asked = {"closest", "winding", "confidence"} & set(self._names)
        if (points != samples.points).any():  # They were rounded after they were measured.
            samples = self._measured(samples, points, counts[0])
        found: dict[str, npt.NDArray[Any]] = {"distance": samples.distance, "gradient": samples.gradient}
        found["occupancy"] = samples.distance < 0
        if asked:
            query = self._surface.query(self._frame.back(points.astype(np.float64)), sorted(asked), threads=self._threads)  # type: ignore[arg-type]
            found |= {name: getattr(query, name) for name in asked}
        if "closest" in found:
            found["closest"] = self._frame.into(found["closest"])
        found["kind"] = np.repeat(np.arange(len(counts), dtype=np.uint8), counts)
        kinds = sum(number > 0 for number in counts)
        found["weight"] = np.repeat([count / (kinds * number) if number else 0.0 for number in counts], counts)
        kept = {name: found[name] for name in self._names}
        return {"points": points} | {
            name: array.astype(self._dtype) if array.dtype.kind == "f" else array for name, array in kept.items()
        }

    def _measured(self, samples: Samples, points: npt.NDArray[Any], on_surface: int) -> Samples:
        """Measures points again where they were rounded to. Those on the surface keep their distance and normal."""
        distance, gradient = samples.distance.copy(), samples.gradient.copy()
        places = self._frame.back(points[on_surface:].astype(np.float64))
        query = self._surface.query(places, ("distance", "direction"), threads=self._threads)
        distance[on_surface:] = query.distance * self._frame.scale
        gradient[on_surface:] = np.where(query.distance[:, None] < 0, query.direction, -query.direction) + 0.0
        return samples._replace(distance=distance, gradient=gradient)

    def __repr__(self) -> str:
        return f"raymap.Sampler({self._n} points, {len(self)} blocks, arrays {', '.join(('points', *self._names))})"


def _array_names(arrays: Iterable[str]) -> tuple[str, ...]:
    known = get_args(SampleArray)
    names = to_names(arrays if isinstance(arrays, str) else set(arrays) - {"points"}, known)
    return tuple(name for name in known if name in names)


def save_as_npz(samples: Samples, path: str | os.PathLike[str]) -> None:
    """Writes a .npz, whatever the path ends with."""
    _save(samples, path, ".npz")


def _save(samples: Samples, path: str | os.PathLike[str], extension: str) -> None:
    arrays = (samples.points, samples.distance, samples.gradient)
    _raymap.save_samples(to_path(path), *arrays, to_vector("centre", samples.centre), samples.scale, extension)
