"""Bodies that move, and the signed distance to their union."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import Any, Literal, NamedTuple, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _arrays, _raymap, _views
from ._arguments import to_length, to_names, to_text
from ._errors import InputError
from ._field import Field, core_of_field, field_of_core
from ._generate import SurfaceFieldOptions, fit_grid
from ._options import core_options
from ._progress import Progress, reporting
from ._surface import Surface, SurfacePair, core_of_surface

#: Name of what ``Scene.query`` can compute.
SceneArray: TypeAlias = Literal["distance", "body", "closest", "gradient", "distances", "triangle"]

_Body: TypeAlias = Surface | Field

#: Number of the body where there is none.
NO_BODY = 2**32 - 1


@_views.shown
class SceneQuery(NamedTuple):
    """Result of ``Scene.query``: one value per point. None for what was not asked for.

    The first axes are those of the points; with poses of many configurations, (configurations, points).
    """

    distance: Any
    """Signed distances of the union, (...): the least of the distances to the bodies."""
    body: Any
    """Numbers of the bodies that have them, (...) uint32, in the order of ``Scene.names``; of several, the lowest.
    ``raymap.NO_BODY`` for a point that is not finite, and without bodies."""
    closest: Any
    """Closest points of those bodies, (..., 3), in the world."""
    gradient: Any
    """Gradients of the distances, (..., 3), in the world: unit vectors that lead away from the solid; 0 on the surface."""
    distances: Any
    """Distances to each body, (..., bodies); NaN for those that were left out."""
    triangle: Any
    """Triangles of those bodies that hold the closest points, (...) uint32; ``raymap.NO_TRIANGLE`` of a field."""


class Scene:
    """Bodies with poses, and the signed distance of points of the world to their union, negative inside.

    A body is a ``Surface`` or a ``Field``, which the scene shares with its owner, or a mesh or the path
    of one, of which it makes a ``Surface``. Its pose takes the body's coordinates to those of the world. Poses change at no cost. Bodies are numbered in the order in which they
    were added; removing one moves those after it down by one.

    A pose is a 4x4 matrix with a rotation, which may be scaled evenly, a translation in its last column, and the last
    row 0 0 0 1. Distances are those in the world. Inner products of its axes may differ from those of a rotation by 1e-5, as those of float32 do; distances may be wrong by the same
    share.

    Distances to a surface are those of ``Surface.query``, bit for bit, computed in float64. A surface without a sign has
    no inside: its distances are not negative. Distances to a field are those of ``Field.sample``: they are approximate,
    and lower bounds outside its box. So is the closest point of a field, which lies at this distance along the gradient;
    it is NaN where the gradient is 0. A point that is not finite gets NaN, and so does one at which a field has NaN.
    Without bodies, distances are infinite.

    Several threads may query a scene at the same time, while none changes it. The result of a point depends neither on
    the other points and configurations, nor on the number of threads. A scene can be pickled.

    Args:
        bodies: Bodies by name, or a list of bodies, whose names are "0", "1" and so on. They get the pose of the world.

    Raises:
        TypeError: A body is something else.
        UsageError: As of ``add``.
        InputError, FileError: A mesh is not valid, or cannot be read.

    >>> scene = raymap.Scene({"ball": raymap.Surface("ball.ply")})
    >>> scene.set_pose("ball", [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    >>> scene.signed_distance([(5, 0, 0.5), (5, 0, 2)]).round(2)
    array([-0.5,  1. ])
    """

    def __init__(self, bodies: Mapping[str, Any] | Sequence[Any] | None = None) -> None:
        self._core, self._bodies = _raymap.Scene(), dict[str, _Body]()
        for name, body in _named(bodies):
            self.add(name, body)

    def add(self, name: str, body: Any, pose: npt.ArrayLike | None = None) -> None:
        """Adds a body after all others.

        Args:
            name: Its name, which no other body has.
            body: A surface, a sampled field, or a mesh as for ``raymap.Surface``.
            pose: Its pose, (4, 4); None = the pose of the world.

        Raises:
            TypeError: The body is something else.
            UsageError: The name is empty or taken, the field has no distances, or the pose is no scaled rigid motion.
            InputError, FileError: The mesh is not valid, or cannot be read.

        >>> scene = raymap.Scene()
        >>> scene.add("ball", raymap.Surface("ball.ply"), np.eye(4))
        >>> scene
        raymap.Scene(1 body: ball)
        """
        rows, made = _arrays.to_poses("pose", np.eye(4) if pose is None else pose, (4, 4)), _to_body(body)
        self._core.add(to_text("name", name), _core_of(made), rows[None])
        self._bodies[name] = made

    def remove(self, name: str) -> None:
        """Removes a body.

        Raises:
            UsageError: There is none of this name.
        """
        self._core.remove(to_text("name", name))
        del self._bodies[name]

    def set_pose(self, name: str, pose: npt.ArrayLike) -> None:
        """Sets the pose of a body, (4, 4), which costs nothing.

        Raises:
            UsageError: There is no body of this name, or the pose is no scaled rigid motion.
        """
        self._core.set_pose(to_text("name", name), _arrays.to_poses("pose", pose, (4, 4))[None])

    @property
    def names(self) -> list[str]:
        """Names of the bodies, in their order."""
        return list(self._bodies)

    @property
    def bodies(self) -> dict[str, _Body]:
        """Bodies by name, in their order. A copy."""
        return dict(self._bodies)

    @property
    def poses(self) -> npt.NDArray[np.float64]:
        """Poses of all bodies, (bodies, 4, 4), in their order. A copy; setting it sets all of them.

        Raises:
            UsageError: On setting: more or fewer poses, or one that is no scaled rigid motion. None is set then.
        """
        return np.asarray(self._core.poses())

    @poses.setter
    def poses(self, poses: npt.ArrayLike) -> None:
        self._core.set_poses(_arrays.to_poses("poses", poses, (len(self), 4, 4)))

    def signed_distance(
        self,
        points: Any,
        poses: Any = None,
        *,
        max_distance: float | None = None,
        without: str | Iterable[str] = (),
        threads: int | None = None,
        progress: Progress = None,
    ) -> Any:
        """Returns signed distances of the union, negative inside. Arguments and errors are those of ``query``.

        >>> scene = raymap.Scene({"ball": raymap.Surface("ball.ply")})
        >>> poses = np.tile(np.eye(4), (3, 1, 1, 1))
        >>> poses[:, 0, 0, 3] = 0, 1, 2
        >>> scene.signed_distance([(4, 0, 0), (5, 0, 0)], poses).round(2)
        array([[3., 4.],
               [2., 3.],
               [1., 2.]])
        """
        found = self.query(
            points, ("distance",), poses, max_distance=max_distance, without=without, threads=threads, progress=progress
        )
        return found.distance

    def query(
        self,
        points: Any,
        arrays: SceneArray | Iterable[SceneArray] = ("distance",),
        poses: Any = None,
        *,
        max_distance: float | None = None,
        without: str | Iterable[str] = (),
        threads: int | None = None,
        progress: Progress = None,
    ) -> SceneQuery:
        """Returns what is asked for at points of the world: the fields of ``raymap.SceneQuery``.

        Results are float32 for float32 points and float64 for all others, and in the framework of the points.

        Args:
            points: Positions in the world, (..., 3). With ``poses``: (n, 3) for all configurations, or
                (configurations, n, 3).
            arrays: Names of what to compute: ``"distance"``, ``"body"``, ``"closest"``, ``"gradient"``, ``"triangle"`` and
                ``"distances"``, which queries all bodies.
            poses: Poses of all bodies in place of the scene's own, (bodies, 4, 4), or in many configurations,
                (configurations, bodies, 4, 4). Results of these are (configurations, n).
            max_distance: Points as far or farther get this distance, with their sign, ``raymap.NO_TRIANGLE``, and NaN for
                what else depends on the closest point; outside, ``raymap.NO_BODY`` as well. Smaller is faster. None = no
                limit.
            without: Names of bodies to leave out, such as the one whose own points these are.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: An unknown name, a pose that is no scaled rigid motion (the message names body and configuration), or a
                ``max_distance`` that is not above 0.
            InputError: Points or poses of another shape.
            MemoryLimitError: The results do not fit into memory.
            Cancelled: ``progress`` returned False.

        >>> ball = raymap.Surface("ball.ply")
        >>> scene = raymap.Scene({"left": ball, "right": ball})
        >>> scene.set_pose("right", [[1, 0, 0, 9], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        >>> found = scene.query([(3, 0, 0), (9, 0, 2)], ("distance", "body", "gradient"))
        >>> found.distance.round(2), found.body, abs(found.gradient).round(2)
        (array([2., 1.]), array([0, 1], dtype=uint32), array([[1., 0., 0.],
               [0., 0., 1.]]))
        """
        names = to_names(arrays, SceneQuery._fields)
        options = core_options(max_distance=max_distance, threads=threads)
        numbers = [self._core.number(name) for name in ([without] if isinstance(without, str) else without)]
        flat, shape = _arrays.to_points(_arrays.still(points) if names <= {"body", "triangle"} else points)
        if poses is None:
            with reporting(progress) as report:
                found = self._core.query(flat, names, numbers, options, report)
            leading = shape[:-1]
        else:
            rows, own, leading = self._configurations(poses, shape)
            with reporting(progress) as report:
                found = self._core.query_many(flat, rows.reshape(-1, 4, 4), len(rows), own, names, numbers, options, report)

        def result(name: str) -> Any:
            array = _arrays.as_precise(found[name], points)
            return _arrays.like(array.reshape(leading + array.shape[1:]), points)

        return SceneQuery(*(result(name) if name in names else None for name in SceneQuery._fields))

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """Lowest and highest corner of a box of the world that holds the bounds of all bodies, (2, 3)."""
        return np.array(self._core.bounds())

    def generate(
        self,
        *,
        resolution: int = 128,
        voxel_size: float | None = None,
        bounds: npt.ArrayLike | None = None,
        padding: float | None = None,
        band: float | None = None,
        sparse: bool = False,
        threads: int | None = None,
        memory_limit: int | None = None,
        progress: Progress = None,
    ) -> Field:
        """Returns a field of the union of the bodies: the distances of ``query`` at its samples, as float32.

        Args:
            resolution: Number of samples along the longest side.
            voxel_size: Distance between samples in place of it, in the world's units.
            bounds: Box that the field covers, (2, 3); None = that of the scene, with the padding.
            padding: Space around the scene, as a share of its diagonal; None = 0.1.
            band: Number of samples at which distances are clamped; of a narrow band, its width on both sides, 3 if None.
            sparse: Whether to make a narrow band.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            memory_limit: Most bytes that the field may take; None = what is available.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: Arguments that make no sense.
            MemoryLimitError: The field needs more memory than allowed.
            Cancelled: ``progress`` returned False.

        >>> scene = raymap.Scene({"ball": raymap.Surface("ball.ply")})
        >>> field = scene.generate(resolution=32)
        >>> position = field.origin + field.spacing * np.array((16, 16, 16))
        >>> bool(np.isclose(field.distance[16, 16, 16], scene.signed_distance(position)))
        True
        """
        given: SurfaceFieldOptions = {"resolution": resolution}
        if voxel_size is not None:
            given["voxel_size"] = voxel_size
        if bounds is not None:
            given["bounds"] = bounds
        if padding is not None:
            given["padding"] = padding
        grid = fit_grid(self._core.fit_grid, given)
        width = None if band is None else to_length("band", band)
        widths = {"outside": width, "inside": width} if sparse else {"band": width}
        options = core_options(widths, threads=threads, memory_limit=memory_limit)
        with reporting(progress) as report:
            return field_of_core(self._core.generate(grid, bool(sparse), options, report))

    def distances_between(
        self,
        pairs: Iterable[tuple[str, str]] | None = None,
        poses: Any = None,
        *,
        max_distance: float | None = None,
        threads: int | None = None,
        progress: Progress = None,
    ) -> SurfacePair:
        """Returns the least distances of bodies that are surfaces: 0 where they cross. Points are in the world.

        Args:
            pairs: Names of the two bodies of each pair; None = each body with each other.
            poses: Poses of all bodies in place of the scene's own, (bodies, 4, 4), or in many configurations,
                (configurations, bodies, 4, 4). Results of these are (configurations, pairs).
            max_distance: Bodies as far or farther get this distance, ``raymap.NO_TRIANGLE``, and NaN for the points.
                Smaller is faster. None = no limit.
            threads: Number of CPU threads, which the pairs share; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: A body is a field or does not exist, a pose is no scaled rigid motion, or ``max_distance`` is not above 0.
            InputError: Poses of another shape.
            Cancelled: ``progress`` returned False.

        >>> ball = raymap.Surface("ball.ply")
        >>> scene = raymap.Scene({"left": ball, "right": ball})
        >>> scene.set_pose("right", [[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        >>> scene.distances_between([("left", "right")]).distance.round(2)
        array([3.])
        """
        named = combinations(self.names, 2) if pairs is None else pairs
        numbers = [(self._core.number(first), self._core.number(second)) for first, second in named]
        rows = _arrays.to_poses("poses", self.poses if poses is None else poses, (len(self), 4, 4), many=True)
        shape = (*rows.shape[:-3], len(numbers))
        count = len(rows) if rows.ndim == 4 else 1
        options = core_options(max_distance=max_distance, threads=threads)
        with reporting(progress) as report:
            found = self._core.distances_between(numbers, rows.reshape(-1, 4, 4), count, options, report)
        return SurfacePair(**{name: array.reshape(shape + array.shape[1:]) for name, array in found.items()})

    def _configurations(
        self, poses: Any, shape: tuple[int, ...]
    ) -> tuple[npt.NDArray[np.float64], bool, tuple[int, ...]]:
        """Returns poses by configuration, whether each of these has points of its own, and the shape of the results."""
        rows = _arrays.to_poses("poses", poses, (len(self), 4, 4), many=True)
        if rows.ndim == 3:
            return rows[None], False, shape[:-1]
        count = len(rows)
        if len(shape) not in (2, 3) or (len(shape) == 3 and shape[0] != count):
            raise InputError(f"with poses of {count} configurations, points must be (n, 3) or ({count}, n, 3), "
                             f"not of the shape {shape}")  # fmt: skip
        return rows, len(shape) == 3, (count, shape[-2])

    def __len__(self) -> int:
        return len(self._bodies)

    def __repr__(self) -> str:
        count = len(self)
        return f"raymap.Scene({count} {'body' if count == 1 else 'bodies'}{': ' if count else ''}{', '.join(self.names)})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self._bodies, self.poses)


def _named(bodies: Mapping[str, Any] | Sequence[Any] | None) -> Iterable[tuple[str, Any]]:
    """Returns the names of bodies and these."""
    if isinstance(bodies, Mapping):
        return bodies.items()
    if isinstance(bodies, (list, tuple)):
        return [(str(number), body) for number, body in enumerate(bodies)]
    if bodies is None:
        return ()
    raise TypeError(f"bodies must be a dict or a list of bodies, not a {type(bodies).__name__}")


def _to_body(given: Any) -> _Body:
    """Returns a body; a surface of a mesh."""
    if isinstance(given, (Surface, Field)):
        return given
    try:
        return Surface(given)
    except TypeError:
        raise TypeError(
            f"a body is a raymap.Surface or Field, or a mesh, not a {type(given).__name__}"
        ) from None


def _core_of(body: _Body) -> Any:
    return core_of_surface(body) if isinstance(body, Surface) else core_of_field(body)


def _restore(bodies: dict[str, _Body], poses: npt.NDArray[np.float64]) -> Scene:
    scene = Scene(bodies)
    scene.poses = poses
    return scene
