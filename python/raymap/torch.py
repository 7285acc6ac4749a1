"""Distances, closest points and samples of fields that PyTorch can differentiate, and data sets for it.

>>> import raymap, torch  # doctest: +SKIP
>>> surface = raymap.Surface("ball.ply")  # doctest: +SKIP
>>> points = torch.tensor([(0.0, 0.0, 1.5)], requires_grad=True)  # doctest: +SKIP
>>> raymap.torch.signed_distance(surface, points).sum().backward()  # doctest: +SKIP
>>> points.grad  # doctest: +SKIP
tensor([[0., 0., 1.]])
"""

from __future__ import annotations

import ctypes
import importlib
import os
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from functools import partial, wraps
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from . import _inputs
from ._arguments import to_whole
from ._arrays import to_numpy
from ._errors import MemoryLimitError, UsageError
from ._field import Field
from ._nearest import Nearest, find_closest, find_nearest, follow, hold, project, shares, slope
from ._samples import Sampler, SamplerOptions, to_seed
from ._surface import Query, Surface
from ._trilinear import Cells, check_field, find_cells, interpolate
from ._typing import Unpack
from .dataset.read import Results

try:
    torch: Any = importlib.import_module("torch")  # Any, so that types are the same with PyTorch and without.
except ImportError as error:
    raise ImportError("raymap.torch needs PyTorch; install it with: pip install torch") from error


_Function = TypeVar("_Function", bound=Callable[..., Any])

_POINT_BYTES = 320  # Most that a sampler takes for a point of a block while it makes it, whatever its arrays.


class _Find(torch.autograd.Function):  # type: ignore[misc]
    """What ``find`` returns of points and vertices, as constants."""

    @staticmethod
    def forward(points: Any, vertices: Any, find: Callable[..., Nearest | Cells]) -> Any:
        found = find(*_arrays(points, vertices))
        return tuple(torch.from_numpy(np.asarray(array)).to(points.device) for array in found if array is not None)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: tuple[Any, ...]) -> None:
        ctx.mark_non_differentiable(*output)

    @staticmethod
    def backward(ctx: Any, *_: Any) -> tuple[None, ...]:
        return None, None, None

    @staticmethod
    def vmap(
        info: Any, in_dims: tuple[Any, ...], points: Any, vertices: Any, find: Callable[..., Nearest | Cells]
    ) -> tuple[Any, Any]:
        if in_dims[1] is not None:
            raise UsageError("vertices must be the same for all points; a surface is prepared of one mesh")
        found = _Find.apply(points.movedim(in_dims[0], 0), vertices, find)
        return found, (0,) * len(found)


def _arrays(points: Any, vertices: Any) -> tuple[npt.NDArray[Any], npt.NDArray[Any] | None]:
    return to_numpy("points", points.detach()), None if vertices is None else to_numpy("vertices", vertices.detach())


def _find(find: Callable[..., Nearest | Cells], points: Any, vertices: Any) -> Any:
    return _Find.apply(points.detach(), None if vertices is None else vertices.detach(), find)


def _eager(function: _Function) -> _Function:
    """Returns a function that ``torch.compile`` does not compile, but calls. The first such call imports its compiler."""

    @wraps(function)
    def call(*args: Any, **options: Any) -> Any:
        return (torch.compiler.disable(function) if torch.compiler.is_compiling() else function)(*args, **options)

    return call  # type: ignore[return-value]


class _Distance(torch.autograd.Function):  # type: ignore[misc]
    """Distances whose projection is differentiated only where gradients of gradients are wanted."""

    generate_vmap_rule = True

    @staticmethod
    def forward(points: Any, vertices: Any, surface: Surface, found: Query[Any, Any, Any]) -> Any:
        return torch.tensor(found.distance, device=points.device)

    @staticmethod
    def setup_context(ctx: Any, inputs: tuple[Any, ...], output: Any) -> None:
        points, vertices, ctx.surface, ctx.found = inputs
        ctx.save_for_backward(points, vertices)
        ctx.none = torch.zeros_like(vertices) if ctx.needs_input_grad[1] else None

    @staticmethod
    def backward(ctx: Any, upstream: Any) -> tuple[Any, ...]:
        if torch.is_grad_enabled():
            return *_differentiable(ctx, upstream), None, None
        of_points = upstream[..., None] * torch.from_numpy(slope(ctx.found)).to(upstream)
        if not ctx.needs_input_grad[1]:
            return of_points, None, None, None
        corners, weights = (torch.from_numpy(array).to(upstream.device) for array in shares(ctx.surface, ctx.found))
        of_corners = (-of_points[..., None, :] * weights[..., None]).reshape(-1, 3).to(ctx.none)
        return of_points, ctx.none.index_add(0, corners.reshape(-1).to(ctx.none.device), of_corners), None, None


def _differentiable(ctx: Any, upstream: Any) -> tuple[Any, Any]:
    """Returns the gradients of ``_Distance`` for points and vertices, which can be differentiated themselves."""
    points, wanted = ctx.saved_tensors[0], ctx.needs_input_grad[:2]
    # Vertices may depend on the points, or these on them: views part what each contributes.
    own = [None if each is None else each.view_as(each) for each in ctx.saved_tensors]
    held = hold(ctx.surface, to_numpy("points", points.detach()), ctx.found)
    found = Nearest(*(torch.from_numpy(np.asarray(array)).to(points.device) for array in held))
    inputs = [each for each, is_wanted in zip(own, wanted, strict=True) if is_wanted]
    made = iter(torch.autograd.grad(_followed(found, *own), inputs, upstream, create_graph=True))
    of_points, of_vertices = (next(made) if is_wanted else None for is_wanted in wanted)
    return of_points, of_vertices


def _is_transformed(*tensors: Any) -> bool:
    """Returns whether ``torch.func`` or forward mode follows what is computed."""
    given = [each for each in tensors if each is not None]
    made = [each.detach() for each in given]  # ``torch.func`` wraps what is made within it of other tensors, too.
    unpack, unwrap = torch.autograd.forward_ad.unpack_dual, torch.func.debug_unwrap
    return any(unwrap(each) is not each for each in made) or any(unpack(each).tangent is not None for each in given)


@_eager
def signed_distance(surface: Surface, points: Any, *, vertices: Any = None, threads: int | None = None) -> Any:
    """Returns distances at points, (...) for points (..., 3), negative inside, differentiable any number of times.

    The gradient for a point is the unit vector along which its distance grows: away from the closest point of the
    surface outside, towards it inside. It is 0 for a point on the surface, and where several points of the surface are
    equally close, it belongs to one of them: there the derivative jumps. Points that are not finite get NaN.

    The gradient for a vertex is the sum, over the points whose closest point lies on one of its faces, of the opposite
    vector times the vertex's barycentric weight there.

    Further derivatives are those of the distance to the face, the edge or the vertex that holds the closest point: the
    second one with respect to the points is 0 within the region of a face. ``torch.func`` takes the function, with all
    its derivatives, and with ``vmap`` over points. ``torch.compile`` calls it without compiling it.

    Args:
        surface: A surface; without a sign, distances are not negative.
        points: A tensor of positions in the mesh's units, (..., 3), on any device. The work is done on the CPU, in float32
            for float16 and bfloat16. The result has the tensor's type and is on its device.
        vertices: The vertices of the surface's mesh, (n, 3), to differentiate with respect to them. After they have moved,
            prepare a new surface of them.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError: Points of another shape, or vertices that are not those of the surface.
        UsageError: ``vmap`` over vertices.
        MemoryLimitError: The results do not fit into memory.
    """
    _check_tensor("points", points, "surface.signed_distance(points)")
    if vertices is not None:
        _check_tensor("vertices", vertices, "surface.signed_distance(points)")
    wide = _wide(points)
    if _is_transformed(wide, vertices):
        found = Nearest(*_find(partial(find_nearest, surface, threads=threads), wide, vertices))
        distance = _followed(found, wide, vertices)
    elif torch.is_grad_enabled() and (wide.requires_grad or (vertices is not None and vertices.requires_grad)):
        distance = _Distance.apply(wide, vertices, surface, find_closest(surface, *_arrays(wide, vertices), threads))
    else:
        plain = find_closest(surface, *_arrays(wide, vertices), threads, ("distance",)).distance
        distance = torch.from_numpy(np.asarray(plain)).to(points.device)
    return _typed(distance, points)


@_eager
def closest_point(surface: Surface, points: Any, *, vertices: Any = None, threads: int | None = None) -> Any:
    """Returns the closest points of a surface, (..., 3) for points (..., 3), which can be differentiated any number of times.

    The derivative is that of the projection onto the face, the edge or the vertex that holds the closest point. It jumps
    where another one takes over.

    Args:
        surface: A surface, with a sign or without.
        points: A tensor of positions, as for ``signed_distance``. The result has its type and is on its device.
        vertices: The vertices of the surface's mesh, (n, 3), to differentiate with respect to them; None = as the surface
            keeps them.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError, UsageError, MemoryLimitError: As for ``signed_distance``.
    """
    _check_tensor("points", points, "surface.closest(points)")
    if vertices is not None:
        _check_tensor("vertices", vertices, "surface.closest(points)")
    wide = _wide(points)
    found = Nearest(*_find(partial(find_nearest, surface, threads=threads), wide, vertices))
    nearest = project(torch.where, _change(wide), found.places + _moved(found, vertices), found.weights)
    return _typed(wide.detach() + nearest, points)


@_eager
def sample(
    field: Field,
    points: Any,
    *,
    surface: Surface | None = None,
    vertices: Any = None,
    threads: int | None = None,
) -> Any:
    """Returns a field's distances at points, (...) for points (..., 3), trilinear between its samples, negative inside.

    The gradient for a point is that of the trilinear function. It jumps where the point enters another cell of the grid.
    Its own derivatives are computed, too: within a cell, second derivatives along one axis are 0.

    The gradient for a vertex sums up what the eight samples around each point change by: a sample's distance changes as
    that of ``signed_distance`` at its place, times the sample's weight. It jumps where a sample gets another closest
    point, and is 0 for samples on the surface and for clamped ones. A narrow band clamps at ``inside`` and ``outside``.

    Points outside of the box of the samples, and those that are not finite, get NaN and the gradient 0. ``torch.func``
    takes the function, with all its derivatives, and with ``vmap`` over points.

    Args:
        field: A dense field or a narrow band.
        points: A tensor of positions in the mesh's units, (..., 3), on any device. The work is done on the CPU, in float32
            for float16 and bfloat16. The result has the tensor's type and is on its device.
        surface: To differentiate with respect to vertices: a surface of them that the field agrees with, as one that its
            ``generate`` made does. Only the samples around the points are asked for.
        vertices: The vertices of the surface's mesh, (n, 3). After they have moved, prepare a new surface of them, and
            make a new field of it.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError: Points of another shape, vertices that are not those of the surface, or a sample that is not its
            distance.
        UsageError: A surface without vertices, vertices without a surface, or ``vmap`` over vertices.
        TypeError: The field is no ``raymap.Field``, or the points are no tensor.
    """
    check_field(field, surface, vertices)
    _check_tensor("points", points, "field.sample(points)")
    if vertices is not None:
        _check_tensor("vertices", vertices, "field.sample(points)")
    wide = _wide(points)
    found = Cells(*_find(partial(find_cells, field, surface, threads=threads), wide, vertices))
    distance = found.distance
    if vertices is not None:
        distance = follow(torch.where, torch.detach, found.nearest, 0.0, _moved(found.nearest, vertices))
    return _typed(interpolate(torch.where, found, distance, _change(wide) / field.spacing), points)


def _wide(points: Any) -> Any:
    """Returns points in the type in which the work is done: of real numbers, float64, or float32 for shorter ones."""
    if points.is_complex() or points.dtype in (torch.float32, torch.float64):
        return points
    return points.to(torch.float32 if points.is_floating_point() else torch.float64)


def _typed(result: Any, points: Any) -> Any:
    """Returns a result in the type of the points, if that is one of real numbers."""
    return result.to(points.dtype) if points.is_floating_point() else result


def _change(values: Any) -> Any:
    """Returns 0 with the derivatives of the values."""
    return values - values.detach()


def _moved(found: Nearest, vertices: Any) -> Any:
    """Returns what the corners move by, (..., 3, 3): 0, with the derivatives of the vertices."""
    return 0.0 if vertices is None else _change(vertices).to(found.weights)[found.corners]


def _followed(found: Nearest, points: Any, vertices: Any) -> Any:
    """Returns distances with all their derivatives."""
    return follow(torch.where, torch.detach, found, _change(points), _moved(found, vertices))


def _check_tensor(name: str, given: Any, instead: str) -> None:
    if not isinstance(given, torch.Tensor):
        raise TypeError(f"{name} must be a tensor, not {type(given).__name__}; NumPy: {instead}")


def _tensors(arrays: dict[str, Any]) -> dict[str, Any]:
    """Returns a dict whose arrays are tensors. PyTorch collates no uint32, so such numbers become int64."""
    return {
        name: torch.from_numpy(value.astype(np.int64) if value.dtype == np.uint32 else value)
        if isinstance(value, np.ndarray)
        else value
        for name, value in arrays.items()
    }


def _trim() -> None:
    """Gives memory back to the system that was freed. The GNU C library may keep that of a dropped surface."""
    with suppress(AttributeError):
        ctypes.CDLL(None).malloc_trim(0)


class ResultDataset(torch.utils.data.Dataset):  # type: ignore[misc]
    """Results of ``raymap.dataset.generate`` or ``raymap.dataset.pack`` as a dataset of PyTorch.

    An item is a dict: the ``name`` of the mesh, and tensors with the arrays of its .npz, such as ``distance``
    (nx, ny, nz), negative inside. Fields of one shape can be collated.

    Args:
        place: Folder of results or of shards, or an URL of shards that fsspec knows.
        arrays: Names of the arrays to read; None = all.
        what: What is read of a folder of results: ``"field"`` or ``"points"``.

    Raises:
        UsageError: There is no result, results are no .npz, or lack an array.
        InputError: A file is torn.
        FileError: A file cannot be read.
    """

    def __init__(self, place: str | os.PathLike[str], arrays: Iterable[str] | None = None, what: str = "field") -> None:
        self._results = Results(place, arrays, what)

    def __len__(self) -> int:
        return len(self._results)

    def __getitem__(self, index: int) -> dict[str, Any]:
        return _tensors(self._results[index])


class _Stream(torch.utils.data.IterableDataset):  # type: ignore[misc]
    """Items by their numbers. A loader with ``batch_size=None`` gives them in one order for any number of workers."""

    def __init__(self, seed: int, rank: int, ranks: int) -> None:
        self._seed = to_seed(seed)
        self._ranks = to_whole("ranks", ranks, least=1)
        self._rank = to_whole("rank", rank, most=self._ranks - 1)
        self._epoch = 0

    def set_epoch(self, epoch: int) -> None:
        """Chooses the order and the points of the next epoch. Call it before a loader begins one, as its workers start.

        Workers that live longer (``persistent_workers=True``) do not hear of it.
        """
        self._epoch = to_whole("epoch", epoch)

    def _permutation(self, count: int, *of: int) -> npt.NDArray[np.int64]:
        """Returns an order that depends on the seed, the epoch and ``of`` alone."""
        key = np.random.SeedSequence((self._seed, self._epoch, *of)).generate_state(2, np.uint64)
        return np.argsort(np.random.Philox(key=key).random_raw(count), kind="stable")

    def _own(self, count: int) -> range:
        """Returns the numbers of those of so many items that this worker of this rank yields."""
        worker = torch.utils.data.get_worker_info()
        number, workers = (0, 1) if worker is None else (worker.id, worker.num_workers)
        return range(self._rank + self._ranks * number, count, self._ranks * workers)


class ResultStream(_Stream):
    """Results as ``ResultDataset`` reads them, as a stream in a random order.

    The order is one of the shards, and within each of its samples. It is the same for any number of workers, if the
    loader does not batch (``batch_size=None``), and with one worker or none in any case.

    Args:
        place: Folder of results or of shards, or an URL of shards that fsspec knows.
        arrays: Names of the arrays to read; None = all.
        what: What is read of a folder of results: ``"field"`` or ``"points"``.
        seed: Whole number from 0 to 2^64 - 1. Another one gives another order.
        rank: Number of this process among those that train together. Each gets other results.
        ranks: Number of these processes.

    Raises:
        UsageError, InputError, FileError: As for ``ResultDataset``.
    """

    def __init__(
        self,
        place: str | os.PathLike[str],
        arrays: Iterable[str] | None = None,
        what: str = "field",
        *,
        seed: int = 0,
        rank: int = 0,
        ranks: int = 1,
    ) -> None:
        super().__init__(seed, rank, ranks)
        self._results = Results(place, arrays, what)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        firsts = np.cumsum([0, *self._results.groups])
        shards = self._permutation(len(self._results.groups))
        order = [firsts[k] + self._permutation(self._results.groups[k], int(k)) for k in shards]
        numbers = np.concatenate(order)
        for k in self._own(len(numbers)):
            yield _tensors(self._results[int(numbers[k])])


class SurfaceSamples(_Stream):
    """Points with what networks learn of them, sampled from meshes while one trains: a stream of blocks.

    An item is a block of a ``raymap.Sampler`` with tensors, and the number ``mesh`` of the mesh. An epoch has ``blocks``
    blocks of each mesh, in rounds: in each, every mesh has its turn, in a random order. Another epoch has other points.
    The stream is the same, bit for bit, for any number of workers, forked or spawned, if the loader does not batch
    (``batch_size=None``). If the number of workers divides that of the meshes, each mesh is prepared by one worker alone.

    Each worker holds prepared meshes and a block within ``memory_limit``, however many blocks there are. It prepares
    meshes that do not fit beside others anew at each turn.

    Args:
        meshes: Meshes, or paths of files, as for ``raymap.Surface``. Only their paths go to workers that are spawned.
        blocks: Number of blocks of each mesh in an epoch.
        memory_limit: Most bytes that a worker may take for prepared meshes, a block, and the work for both. Surfaces
            that were given (``raymap.Surface``) are not counted.
        seed: Whole number from 0 to 2^64 - 1. Another one gives other points.
        rank: Number of this process among those that train together. Each gets other blocks.
        ranks: Number of these processes.
        **options: Options of ``raymap.Sampler`` without ``seed``; ``block`` is the number of points of a block. One thread
            samples, unless ``threads`` says otherwise.

    Raises:
        UsageError: Arguments that make no sense, or no mesh.
        MemoryLimitError: A block exceeds the limit; or it does with a mesh: when that has its turn.
        InputError, FileError: A mesh is not valid, or cannot be read: when it has its turn.
    """

    def __init__(
        self,
        meshes: Iterable[Any],
        *,
        blocks: int = 1,
        memory_limit: int = 4 << 30,
        seed: int = 0,
        rank: int = 0,
        ranks: int = 1,
        **options: Unpack[SamplerOptions],
    ) -> None:
        super().__init__(seed, rank, ranks)
        self._meshes = [meshes] if isinstance(meshes, (str, os.PathLike)) else list(meshes)
        if not self._meshes:
            raise UsageError("meshes: there is none")
        self._blocks = to_whole("blocks", blocks, least=1)
        self._memory = to_whole("memory_limit", memory_limit, least=1, most=2**63 - 1)
        self._options: SamplerOptions = {"block": 1 << 14, "threads": 1, **options}
        self._block_bytes = _POINT_BYTES * to_whole("block", self._options["block"], least=1)
        if self._block_bytes >= self._memory:
            raise MemoryLimitError(
                f"a block of {self._options['block']:,} points takes up to {self._block_bytes:,} bytes, but memory_limit "
                f"is {self._memory:,}; use smaller blocks, or a higher limit"
            )
        self._kept: dict[int, Surface] = {}
        self._mesh_bytes: dict[int, int] = {}  # Of meshes that had a turn, without what is prepared.
        self._too_little: dict[int, int] = {}  # Bytes in which a mesh could not be prepared.

    def __iter__(self) -> Iterator[dict[str, Any]]:
        count = len(self._meshes)
        order = self._permutation(count)
        for k in self._own(count * self._blocks):
            mesh = int(order[k % count])
            seed = int(np.random.SeedSequence((self._seed, self._epoch, mesh)).generate_state(1, np.uint64)[0])
            yield _tensors({"mesh": mesh, **self._sample(mesh, seed, k // count)})

    def _sample(self, mesh: int, seed: int, number: int) -> dict[str, npt.NDArray[Any]]:
        """Returns a block of a mesh."""
        points = self._options["block"] * self._blocks
        return Sampler(self._surface(mesh), points, seed=seed, **self._options)[number]

    def _surface(self, mesh: int) -> Surface:
        """Returns a prepared mesh. Drops those that were kept last until it fits: turns go round, so none is better."""
        given = self._meshes[mesh]
        if isinstance(given, Surface):
            return given
        if mesh in self._kept:
            return self._kept[mesh]
        _trim()
        loaded = _inputs.to_mesh(given)
        self._mesh_bytes[mesh] = loaded.vertices.nbytes + loaded.faces.nbytes
        while True:
            room = self._room(mesh)
            try:
                if room <= self._too_little.get(mesh, 0):
                    raise MemoryLimitError
                self._kept[mesh] = Surface(loaded, threads=self._options["threads"], memory_limit=room)
                return self._kept[mesh]
            except MemoryLimitError:
                self._too_little[mesh] = max(room, self._too_little.get(mesh, 0))
            if not self._kept:
                raise MemoryLimitError(
                    f"meshes: number {mesh} and a block of {self._options['block']:,} points do not fit into memory_limit, "
                    f"{self._memory:,} bytes; use a higher limit, or smaller blocks"
                )
            self._kept.popitem()
            _trim()

    def _room(self, mesh: int) -> int:
        """Returns the bytes that are left to prepare a mesh. A block takes less than the bytes of its mesh beside its own."""
        work = max(self._mesh_bytes[each] for each in (mesh, *self._kept))
        # A quarter stays free: freed memory may lie in pieces that are too small, and files are read beside their meshes.
        usable = (self._memory - self._block_bytes) * 3 // 4
        return usable - work - sum(kept.nbytes for kept in self._kept.values())

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_kept": {}, "_mesh_bytes": {}, "_too_little": {}}  # Workers prepare what they need.
