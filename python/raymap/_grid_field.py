"""What dense fields and narrow bands have in common: arrays over the samples of a grid, and values between them."""

from __future__ import annotations

import os
from typing import Any, Literal, Self, Unpack, overload

import numpy as np
import numpy.typing as npt

from . import _arrays, _html, _inputs, _raymap
from ._arguments import to_path, to_text, to_threads, to_whole
from ._arrays import Points, SampleOptions, Singles
from ._errors import UsageError
from ._frames import Frame
from ._mesh import Mesh, core_of, mesh_of_core
from ._options import check_names, core_options
from ._pictures import ViewOptions
from ._progress import Progress, reporting
from ._records import Comparison, FieldArray


class PageOptions(ViewOptions, total=False):
    """Keyword arguments of ``to_html`` and ``show``."""

    title: str
    mesh: Any
    other: GridField
    other_title: str
    array: FieldArray
    max_size: int
    device: str
    threads: int | None
    progress: Progress


class GridField:
    """A signed distance field on a regular grid, negative inside: a ``raymap.Field`` or a ``raymap.SparseField``."""

    _core: _raymap.Field | _raymap.SparseField

    _views: dict[str, npt.NDArray[Any]]

    _frame: Frame

    def _hold(self, core: Any, frame: Frame) -> None:
        self._core, self._views, self._frame = core, {}, frame

    def _array(self, name: str) -> npt.NDArray[Any]:
        if name in self._views:
            return self._views[name]
        array: Any = self._core.array(name)
        if array is None:
            raise AttributeError(f"the field has no {name!r}; ask for it, as in arrays=('distance', {name!r})")
        return self._views.setdefault(name, array)

    def _set(self, name: str, ordered: npt.NDArray[Any]) -> None:
        """Copies an array that has the types and the order in memory of the library."""
        (self._core.set_wholes if name == "triangle" else self._core.set_floats)(name, ordered)

    @property
    def winding(self) -> npt.NDArray[np.float32]:
        """Winding numbers, float32, +1 inside a closed surface that faces outwards. Their shape is that of the distances.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("winding")

    @property
    def confidence(self) -> npt.NDArray[np.float32]:
        """Confidences in the sign, float32, 0 to 1. Their shape is that of the distances.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("confidence")

    @property
    def triangle(self) -> npt.NDArray[np.uint32]:
        """Indices of closest triangles, uint32; ``raymap.NO_TRIANGLE`` where the distance is clamped.

        Their shape is that of the distances.

        Raises:
            AttributeError: The field does not have them.
        """
        return self._array("triangle")

    @property
    def arrays(self) -> tuple[str, ...]:
        """Names of the arrays that the field has. ``"distance"`` are the ``values`` of a narrow band."""
        return tuple(self._core.arrays)

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of samples of the grid (nx, ny, nz)."""
        return self._core.dims

    @property
    def origin(self) -> npt.NDArray[np.float64]:
        """Position of sample (0, 0, 0), (3,)."""
        return np.array(self._core.origin)

    @property
    def spacing(self) -> float:
        """Distance between neighbouring samples, in the mesh's units; the same along x, y and z."""
        return self._core.spacing

    @property
    def centre(self) -> npt.NDArray[np.float64]:
        """Point of the mesh that lies at 0 in this field, (3,); 0 unless ``normalize`` moved the mesh."""
        return self._frame.centre.copy()

    @property
    def scale(self) -> float:
        """Length in this field of one unit of the mesh: field's positions = (mesh's positions - centre) * scale."""
        return self._frame.scale

    @property
    def surface_bounds(self) -> npt.NDArray[np.float64] | None:
        """Bounds of the surface that distances lead to, (2, 3); None if they are not known."""
        bounds = self._core.surface_bounds
        return None if bounds is None else np.array(bounds)

    @overload
    def sample(self, points: Points, **options: Unpack[SampleOptions]) -> Singles: ...
    @overload
    def sample(self, points: Any, **options: Unpack[SampleOptions]) -> Any: ...
    def sample(self, points: Any, *, outside: Literal["bound", "nan"] = "bound", threads: int | None = None) -> Any:
        """Returns distances at any points, negative inside: (...) float32 for points (..., 3).

        Within the box of the samples the distance is trilinear between the eight samples around a point. It is NaN for
        points that are NaN. A narrow band gives, bit for bit, what its dense field does.

        Outside of the box, it is a lower bound of the signed distance, also where the box cuts the mesh: the largest
        distance of a sample around the closest point of the box, less the way from there. Outside of
        ``surface_bounds`` it is at least the distance to them. If the box holds them, it is nearly the distance. If
        they are not known, or reach there, it falls below 0 farther out: the mesh may be there. Across the holes of an
        open mesh the sign jumps, and the bound may be too large.

        Args:
            points: Positions in the mesh's units: NumPy, or any array with ``__dlpack__``. PyTorch, JAX and CuPy get
                arrays of their own back, on the same device.
            outside: Result outside of the box: ``"bound"``, or ``"nan"``.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.

        Raises:
            InputError: Points of another shape.
            UsageError: ``outside`` is something else.

        >>> ball = raymap.generate("ball.ply", resolution=32)
        >>> ball.sample([(0, 0, 0), (0, 0, 1.1), (0, 0, 9)]).round(2)
        array([-0.93,  0.1 ,  8.  ], dtype=float32)
        >>> ball.sample((0, 0, 9), outside="nan")
        array(nan, dtype=float32)
        """
        return self._sample(points, False, outside, threads)

    @overload
    def gradient(self, points: Points, **options: Unpack[SampleOptions]) -> Singles: ...
    @overload
    def gradient(self, points: Any, **options: Unpack[SampleOptions]) -> Any: ...
    def gradient(self, points: Any, *, outside: Literal["bound", "nan"] = "bound", threads: int | None = None) -> Any:
        """Returns gradients of the distance at any points, (..., 3) float32. They point outwards.

        A gradient is the central difference of the distance over one spacing to either side. Its length is close to 1,
        but less where surfaces are equally near, and 0 where distances are clamped. Outside of the box of the samples it
        leads away from the box.

        Args:
            points: Positions in the mesh's units, (..., 3), as for ``sample``.
            outside: ``"nan"`` for NaN outside of the box.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.

        Raises:
            InputError: Points of another shape.

        >>> ball = raymap.generate("ball.ply", resolution=32)
        >>> ball.gradient((0, 0, 1)).round(1) + 0.0
        array([0., 0., 1.], dtype=float32)
        """
        return self._sample(points, True, outside, threads)

    def _sample(self, points: Any, gradients: bool, outside: str, threads: int | None) -> Any:
        if outside not in ("bound", "nan"):
            raise UsageError(f"outside must be 'bound' or 'nan', not {outside!r}")
        flat, shape = _arrays.to_points(points, "sample(field, points)")
        result = self._core.sample(flat, gradients, outside == "nan", to_threads(threads))
        return _arrays.like(result.reshape(shape if gradients else shape[:-1]), points)

    def to_mesh(self, iso: float = 0.0, *, threads: int | None = None, progress: Progress = None) -> Mesh:
        """Returns the surface at distance ``iso`` as a closed mesh whose faces point outwards.

        Every edge has exactly two faces. Corners and sharp edges are kept (dual contouring). A narrow band gives, bit for
        bit, the mesh of its dense field, but time and memory grow with the surface alone. Beyond 16384 samples along a
        side of the grid, the float32 of the vertices is too coarse.

        Args:
            iso: Distance of the surface in the mesh's units; above 0 outside of the shape. In a narrow band, between
                ``-inside`` and ``outside``.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: There is no surface at ``iso``.
            InputError: A sample is not finite.
            MemoryLimitError: The mesh does not fit into memory.

        >>> raymap.generate("ball.ply", resolution=16).to_mesh(iso=0.1).bounds.round(1)
        array([[-1.1, -1.1, -1.1],
               [ 1.1,  1.1,  1.1]])
        """
        with reporting(progress) as report:
            return mesh_of_core(_raymap.isosurface(self._core, core_options(iso=iso, threads=threads), report))

    def slice(
        self,
        axis: int | Literal["x", "y", "z"],
        index: int | None = None,
        *,
        array: FieldArray = "distance",
        width: int = 512,
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of a slice, (h, w, 3) uint8, rows from the top.

        Outside is warm, inside cool; thin lines mark round distances, a thick line zero. Across x, y points right and
        z up; across y, x right and z up; across z, x right and y up.

        A narrow band gives, bit for bit, the slice of its dense field. Where a sample is in no leaf, winding numbers and
        confidences are not known and violet, and triangles light grey.

        Args:
            axis: Axis that the slice crosses: 0, 1, 2 or "x", "y", "z".
            index: Sample along this axis; negative ones count from the end; None = the middle.
            array: Array to draw.
            width: Width in pixels.

        Raises:
            UsageError: No such axis, sample or array.

        >>> raymap.generate("ball.ply", resolution=16).slice("z", width=100).shape
        (100, 100, 3)
        >>> raymap.generate("ball.ply", resolution=64, sparse=True).slice("z", width=100).shape
        (100, 100, 3)
        """
        if axis not in (0, 1, 2, "x", "y", "z"):
            raise UsageError(f"axis must be 0, 1, 2, 'x', 'y' or 'z', not {axis!r}")
        number = "xyz".index(axis) if isinstance(axis, str) else int(axis)
        count = self.shape[number]
        if index is not None and not -count <= index < count:
            raise UsageError(f"index {index} is out of range: the field has {count} samples along {'xyz'[number]}")
        chosen = -1 if index is None else index % count
        return _raymap.render_slice(self._core, number, chosen, to_whole("width", width), to_text("array", array))

    def render(
        self,
        *,
        width: int = 1024,
        height: int = 768,
        direction: tuple[float, float, float] = (-0.6, -0.45, -1.0),
        up: tuple[float, float, float] = (0.0, 1.0, 0.0),
        field_of_view: float = 30.0,
        cut: bool = False,
        shell: float = 0.0,
        eye: tuple[float, float, float] | None = None,
        iso: float = 0.0,
        cut_plane: tuple[float, float, float, float] | None = None,
        slice_plane: tuple[float, float, float, float] | None = None,
        frame: npt.ArrayLike | None = None,
        device: str = "auto",
        threads: int | None = None,
        progress: Progress = None,
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of the surface by sphere tracing, (h, w, 3) uint8, rows from the top.

        Rays pass cubes without leaves of a narrow band at once. Distances beyond the band are not known, so ``iso`` lies
        between ``-inside`` and ``outside``, and ``shell`` is less than ``inside``.

        Args:
            width: Width of the picture, in pixels.
            height: Height of the picture, in pixels.
            direction: Direction from the camera to the centre of the shape.
            up: Direction up in the picture; the floor is perpendicular to it.
            field_of_view: Angle from the bottom to the top of the picture, in degrees.
            cut: Whether to remove the half before the middle plane, as in the paper's figure 1. The cut face shows the
                distance inside.
            shell: Thickness of the outer wall of a hollow shape, in the mesh's units; 0 = not hollow.
            eye: Place of the camera, in the mesh's units, instead of one from which the shape fills the picture.
            iso: Distance at which the surface lies, in the mesh's units.
            cut_plane: Plane of a cut, instead of the middle one, as (nx, ny, nz, offset): all points p with dot(n, p) =
                offset. What lies on the side of the normal is removed.
            slice_plane: Plane on which distances are drawn in the colours and with the lines of ``slice``.
            frame: Box that the camera frames instead of the shape, ((x0, y0, z0), (x1, y1, z1)). Pictures of a moving
                shape share one, so that the camera stands still.
            device: Device that computes: ``"cpu"``; ``"vulkan:K"``, the Kth Vulkan device; ``"vulkan"``, the best of
                them, which may be a software rasterizer; ``"auto"``, a real GPU if one is usable, else the CPU.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: Arguments that make no picture.
            InputError: A sample is not finite.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.render(width=64, height=48).shape
        (48, 64, 3)
        >>> raymap.generate("ball.ply", resolution=64, sparse=True).render(width=64, height=48).shape
        (48, 64, 3)
        >>> field.render(width=64, height=48, eye=(3, 1, 2), direction=(-3, -1, -2), cut_plane=(0, 0, 1, 0.4)).shape
        (48, 64, 3)
        """
        given = {name: value for name, value in locals().items() if name not in ("self", "progress")}
        with reporting(progress) as report:
            return _raymap.render_field(self._core, core_options(given), report)

    @overload
    def to_html(self, path: None = None, **options: Unpack[PageOptions]) -> str: ...
    @overload
    def to_html(self, path: str | os.PathLike[str], **options: Unpack[PageOptions]) -> None: ...
    def to_html(self, path: str | os.PathLike[str] | None = None, **options: Unpack[PageOptions]) -> str | None:
        """Returns a page that shows the field in a browser with WebGL 2, or writes it: one file, without a network.

        One can turn the shape, move closer, cut it open, hollow it out, move an iso value and a slice, and read off
        positions and values. Slices and cuts show winding numbers and confidences, if the field has them.

        A narrow band is shown without the memory of its dense field: on the page's grid, the page has the distances to
        the surface of ``to_mesh``, exact and not clamped, and no other arrays. Where the band's box cuts the solid off,
        the solid is taken to go straight on.

        Args:
            path: File to write, which appears whole or not at all; None = the page is returned.
            title: Heading; by default the name of the file.
            mesh: Mesh of the field, as for ``raymap.generate``, or a pair of vertices and faces. The page lists its
                defects: a click leads there.
            other: Field or narrow band to compare with. One switches between both, and sees their difference in
                colour. It is sampled on the page's grid.
            other_title: Name of the other field.
            array: Array in whose colours the page begins: ``"distance"``, ``"winding"`` or ``"confidence"``. That of a
                narrow band is ``"distance"``.
            max_size: Most samples along a side, 256 by default. A larger field is shown on a coarser grid.
            width, height, direction, up, field_of_view, cut, shell: View that it begins with, as for ``render``.
            device: Device that draws the picture for browsers without WebGL, and makes the distances to a band's
                surface; see ``raymap.devices``.
            threads: Number of CPU threads; None = ``raymap.get_threads()``.
            progress: A callable that receives a stage and its share, 0 to 1; True to show it.

        Raises:
            UsageError: Arguments that make no page, an array that the field does not have, or a narrow band without a
                sample inside.
            InputError: A sample is not finite, or the mesh is not valid.
            FileError: The file cannot be written.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.to_html("ball.html", mesh="ball.ply", cut=True)
        >>> field.to_html()[:15]
        '<!DOCTYPE html>'
        >>> raymap.generate("ball.ply", resolution=64, sparse=True).to_html("band.html", max_size=32, other=field)
        """
        name = "Field" if path is None else os.path.splitext(os.path.basename(os.fspath(path)))[0]
        page = self._page(name, **options)
        if path is None:
            return page
        _raymap.write_whole(to_path(path), page.encode())
        return None

    def show(self, frame_height: int = 600, **options: Unpack[PageOptions]) -> None:
        """Shows the page of ``to_html``: in the cell of a notebook, or else in a browser.

        Outside of a notebook, the page is a file in the folder of temporary files, and stays there. If no browser can
        be opened, a line says where it is.

        Args:
            frame_height: Height in the notebook, in pixels.
            **options: Those of ``to_html``.
        """
        _html.show(self._page("Field", **options), to_whole("frame_height", frame_height, least=1))

    def _page(
        self,
        name: str,
        *,
        title: str | None = None,
        mesh: Any = None,
        other: GridField | None = None,
        other_title: str = "Other field",
        array: FieldArray = "distance",
        max_size: int = 256,
        device: str = "auto",
        threads: int | None = None,
        progress: Progress = None,
        **view: Unpack[ViewOptions],
    ) -> str:
        check_names("to_html", view, ViewOptions)
        faulty = None
        if mesh is not None:
            faulty = core_of(_inputs.to_mesh(*mesh) if isinstance(mesh, tuple) else _inputs.to_mesh(mesh))
        page = {"title": name if title is None else title, "other_title": other_title, "array": array, "max_size": max_size}
        compared = None if other is None else _core_of(other)
        dense = compared if isinstance(compared, _raymap.Field) else None
        band = compared if isinstance(compared, _raymap.SparseField) else None
        with reporting(progress) as report:
            options = core_options({**view, **page, "device": device, "threads": threads})
            return _raymap.make_page(self._core, options, faulty, dense, band, report)

    def __repr__(self) -> str:
        return self._text()

    def _text(self, *more: str) -> str:
        """Returns the field in one line. ``more`` follows the number of samples."""
        samples, arrays = " x ".join(map(str, self.shape)), ", ".join(self.arrays)
        parts = (f"{samples} samples", *more, f"spacing {self.spacing:.6g}", f"arrays {arrays}")
        return f"raymap.{type(self).__name__}({', '.join(parts)})"

    def _rows(self) -> dict[str, Any]:
        """Returns the rows of the table that a notebook shows."""
        rows = {
            "samples": " × ".join(map(str, self.shape)),
            "spacing": f"{self.spacing:.6g}",
            "origin": ", ".join(f"{v:.6g}" for v in self.origin),
            "arrays": ", ".join(self.arrays),
        }
        if not self._frame.is_identity:
            rows["normalized"] = f"centre {', '.join(f'{v:.6g}' for v in self.centre)}; scale {self.scale:.6g}"
        return rows

    def compare(self, other: Self, array: FieldArray = "distance") -> Comparison:
        """Returns where an array of this field differs from that of another field on the same grid.

        Errors of distances are in samples (distance over spacing), those of winding numbers and confidences as they
        are, those of triangles 0. If either field is clamped to a band, distances are compared within the narrower one.

        Two narrow bands are compared as their dense fields, without the memory of these. Winding numbers and
        confidences are known in leaves alone: other samples count as not finite.

        Args:
            other: Field on the same grid, of the same class.
            array: Array to compare.

        Raises:
            UsageError: The grids differ by more than rounding, a field lacks the array, or the other is of another
                class.

        >>> exact, rough = (raymap.generate("ball.ply", resolution=16, distance=name) for name in ("exact", "raster"))
        >>> found = exact.compare(rough)
        >>> found["samples"], found["sign_differences"], found["max_error"] < 1
        (4096, 0, True)
        """
        return _raymap.compare(*self._with(other), array)  # type: ignore[return-value]

    def render_comparison(
        self, other: Self, array: FieldArray = "distance", *, width: int = 512
    ) -> npt.NDArray[np.uint8]:
        """Returns a picture of the slice in which two fields differ most, (h, w, 3) uint8, rows from the top.

        It is the slice with the most differences of sign, across any axis. Samples on which both agree are light grey
        outside and grey inside. Inside by this field only is red, by the other only green, not finite violet. Black and
        blue lines are the zero contours. If no sign differs, it is the slice across z of the largest error, from white
        (equal) to dark red. Arguments and errors are those of ``compare``.

        Args:
            other: Field on the same grid, of the same class.
            array: Array to compare.
            width: Width in pixels.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.render_comparison(field, width=100).shape
        (100, 100, 3)
        """
        return _raymap.render_comparison(*self._with(other), to_whole("width", width), to_text("array", array))

    def _with(self, other: Self) -> tuple[Any, Any]:
        """Returns the core of this field and that of another one of its class."""
        if not isinstance(other, GridField) or type(other._core) is not type(self._core):
            raise UsageError(f"other is a {type(other).__name__}; compare two fields, or two narrow bands (see to_dense)")
        return self._core, other._core


def _core_of(other: GridField) -> _raymap.Field | _raymap.SparseField:
    if not isinstance(other, GridField):
        raise UsageError(f"other must be a field or a narrow band, not a {type(other).__name__}")
    return other._core
