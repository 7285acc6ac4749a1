"""Signed distance fields."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _arrays, _html, _raymap
from ._arguments import FINITE, to_box, to_length, to_number, to_path, to_text, to_vector
from ._errors import InputError, UsageError
from ._frames import IDENTITY, Frame, frame_arrays, read_frame, to_frame
from ._grid_field import GridField
from ._records import FieldArray, Stats
from ._whole_file import save_with_arrays

#: Value of ``Field.triangle`` where the distance is clamped, and where surface that closes a hole is closer.
NO_TRIANGLE = 0xFFFFFFFF


class Field(GridField):
    """A signed distance field, negative inside: distances on a regular grid.

    ``raymap.generate`` and ``raymap.load_field`` return fields. To make one of an array of your own, give it to
    this class, which copies it.

    Sample (i, j, k) lies at ``origin + spacing * (i, j, k)``. Arrays have the shape (nx, ny, nz), i along x. In memory
    x is fastest (NumPy's Fortran order). They are views of the library's memory without a copy; what is written into
    them changes the field, but not ``surface_bounds``: if it moves the surface, make a new field of the array.

    Args:
        distance: Distances, (nx, ny, nz), negative inside.
        origin: Position of sample (0, 0, 0).
        spacing: Distance between neighbouring samples, in the mesh's units.
        clamp_distance: Distance at which the distances are clamped, in the mesh's units; 0 = not clamped.
        surface_bounds: Box that holds the whole surface, ((x0, y0, z0), (x1, y1, z1)); None = not known. ``sample``
            uses it outside of the grid.
        winding: Winding numbers, of the same shape.
        confidence: Confidences in the sign, of the same shape.
        triangle: Indices of closest triangles, of the same shape.
        centre: Point of the mesh that lies at 0 in this field.
        scale: Length in this field of one unit of the mesh.

    Raises:
        UsageError: The arrays are not of one shape with three dimensions, or the grid makes no sense.
        InputError: The centre or the scale makes no sense, or an array has other numbers.

    >>> x, y, z = np.mgrid[-2:3, -2:3, -2:3]
    >>> ball = raymap.Field(np.sqrt(x**2 + y**2 + z**2) - 1.5, origin=(-2, -2, -2))
    >>> ball
    raymap.Field(5 x 5 x 5 samples, spacing 1, arrays distance)
    >>> float(ball.distance[2, 2, 2])
    -1.5
    """

    _core: _raymap.Field

    def __init__(
        self,
        distance: npt.ArrayLike,
        origin: npt.ArrayLike = (0.0, 0.0, 0.0),
        spacing: float = 1.0,
        *,
        clamp_distance: float = 0.0,
        surface_bounds: npt.ArrayLike | None = None,
        winding: npt.ArrayLike | None = None,
        confidence: npt.ArrayLike | None = None,
        triangle: npt.ArrayLike | None = None,
        centre: npt.ArrayLike = (0.0, 0.0, 0.0),
        scale: float = 1.0,
    ) -> None:
        arrays = {"distance": distance, "winding": winding, "confidence": confidence, "triangle": triangle}
        shape = np.shape(_arrays.to_numpy("distance", distance))
        if len(shape) != 3 or 0 in shape:
            raise UsageError(f"distance must be (nx, ny, nz), not of the shape {shape}")
        box = None if surface_bounds is None else to_box("surface_bounds", surface_bounds)
        clamp = to_number("clamp_distance", clamp_distance, least=0.0, most=FINITE)
        core = _raymap.Field(shape, to_vector("origin", origin), to_length("spacing", spacing), clamp, box)
        self._take(core, to_frame(centre, scale))
        for name, array in arrays.items():
            if array is not None:
                given = _arrays.to_numpy(name, array)
                if given.shape != shape:
                    raise UsageError(f"{name} must have the shape of distance, {shape}, not {given.shape}")
                self._set(name, _ordered(name, given))
        core.validate()

    def _take(self, core: _raymap.Field, frame: Frame, stats: Stats | None = None) -> None:
        self._hold(core, frame)
        self._stats: Stats = stats or core.stats()  # type: ignore[assignment]

    @property
    def distance(self) -> npt.NDArray[np.float32]:
        """Distances in the mesh's units, (nx, ny, nz) float32, negative inside, positive outside."""
        return self._array("distance")

    @property
    def stats(self) -> Stats:
        """Cost of the field, and findings about the mesh: 0 for a field from a file or an array."""
        return self._stats

    @property
    def clamp_distance(self) -> float:
        """Distance at which distances are clamped, in the mesh's units; 0 = not clamped."""
        return self._core.clamp_distance

    def denormalized(self) -> Field:
        """Returns the field in the mesh's units and place: undoes ``normalize``.

        Positions and distances become float32 and float64 again as far as these can hold them: a sample's position is
        ``position / scale + centre``, its distance ``distance / scale``. All other arrays stay as they are.

        >>> field = raymap.generate("ball.ply", resolution=16, normalize="unit")
        >>> field.scale.__round__(3), field.spacing.__round__(3), field.denormalized().spacing.__round__(3)
        (0.5, 0.075, 0.15)
        """
        bounds, scale = self.surface_bounds, self.scale
        others: dict[str, Any] = {name: self._array(name) for name in self.arrays if name != "distance"}
        made = Field(
            self.distance / np.float32(scale),
            self._frame.back(self.origin),
            self.spacing / scale,
            clamp_distance=self.clamp_distance / scale,
            surface_bounds=None if bounds is None else self._frame.back(bounds),
            **others,
        )
        made._stats = self._stats
        return made

    def tsdf(self) -> npt.NDArray[np.float32]:
        """Returns the truncated distances divided by the truncation, (nx, ny, nz) float32 from -1 to 1, negative inside.

        Raises:
            UsageError: The distances are not clamped.

        >>> field = raymap.generate("ball.ply", resolution=16, truncation=0.3)
        >>> field.tsdf().min(), field.tsdf().max()
        (np.float32(-1.0), np.float32(1.0))
        """
        if self.clamp_distance == 0:
            raise UsageError("tsdf() needs clamped distances; make the field with truncation= or band=")
        divided: npt.NDArray[np.float32] = self.distance / np.float32(self.clamp_distance)
        return divided.clip(-1, 1)

    def save(self, path: str | os.PathLike[str], array: FieldArray = "distance") -> None:
        """Writes .vdb, .nvdb, .nrrd, .npz, .npy or .vti by extension. The file appears whole or not at all.

        Args:
            path: File to write. A .npz, .vti, .vdb or .nvdb holds every array; a .npy holds no grid. The .npz of a field that
                ``normalize`` made also holds ``centre`` and ``scale``. Other files have no place for them.
            array: Array to write into the other formats.

        Raises:
            UsageError: Another extension, an array that the field does not have, or a normalized field in another file
                than a .npz.
            FileError: The file cannot be written.

        >>> field = raymap.generate("ball.ply", resolution=16)
        >>> field.save("ball.npz")
        >>> bool((raymap.load_field("ball.npz").distance == field.distance).all())
        True
        """
        text = to_path(path)
        if self._frame.is_identity:
            self._core.save(text, array)
        elif text.lower().endswith(".npz"):
            save_as(self, text, ".npz")
        else:
            what = "save a .npz, or field.denormalized()"
            raise UsageError(f"{text}: only a .npz holds the centre and scale of a normalized field; {what}")

    def __array__(self, dtype: npt.DTypeLike | None = None, copy: bool | None = None) -> npt.NDArray[Any]:
        """Returns the distances: ``np.asarray(field)`` is ``field.distance``."""
        return np.array(self.distance, dtype=dtype, copy=copy)  # NumPy 1 takes None for False.

    def _repr_html_(self) -> str:
        rows = self._rows()
        if "distance" in self.arrays:
            rows["distance"] = f"{self.distance.min():.6g} to {self.distance.max():.6g}, negative inside"
        if self.clamp_distance > 0:
            rows["clamped at"] = f"{self.clamp_distance:.6g}"
        if device := self.stats["device"]:
            rows["made"] = f"in {self.stats['milliseconds']:.0f} ms on {device}"
        shown: Any = self.arrays[0]
        return _html.describe("raymap.Field", rows, "slice across z", self.slice("z", array=shown, width=256))

    def __reduce__(self) -> tuple[Any, ...]:
        arrays = {name: self._array(name) for name in self.arrays}
        placement = self.shape, self.origin, self.spacing, self.clamp_distance, self._core.surface_bounds
        return _restore, (*placement, arrays, self.stats, self._frame)


def _ordered(name: str, array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns an array in the type and the order in memory of the library.

    Raises:
        InputError: It has no real numbers, or for triangles no whole ones.
    """
    is_whole = name == "triangle"
    if array.dtype.kind not in ("iu" if is_whole else "fiu"):
        hint = "; a mask has no distances, a field has" if array.dtype.kind == "b" else ""
        raise InputError(f"{name} must be {'whole' if is_whole else 'real'} numbers, not {array.dtype}{hint}")
    with np.errstate(over="ignore"):  # Distances beyond float32 become infinite.
        return np.asfortranarray(array, np.uint32 if is_whole else np.float32)


def core_of_field(field: Field) -> _raymap.Field:
    """Returns the field as the extension module takes it."""
    return field._core


def field_of_core(core: _raymap.Field, frame: Frame = IDENTITY) -> Field:
    """Returns the field that the extension module has made."""
    made = Field.__new__(Field)
    made._take(core, frame)
    return made


def save_as(field: Field, path: str, extension: str, more: Mapping[str, Any] | None = None) -> None:
    """Writes a field in the format of an extension, whatever the path ends with.

    A .npz holds its frame, if it has one, and further arrays. Other formats have no place for them.
    """

    def save(to: str) -> None:
        field._core.save(to, "distance", extension)

    added = {**(more or {}), **({} if field._frame.is_identity else frame_arrays(field._frame))}
    if extension == ".npz" and added:
        save_with_arrays(save, path, added)
    else:
        save(path)


def _restore(
    shape: tuple[int, int, int],
    origin: npt.NDArray[np.float64],
    spacing: float,
    clamp_distance: float,
    surface_bounds: tuple[tuple[float, float, float], tuple[float, float, float]] | None,
    arrays: dict[str, npt.NDArray[Any]],
    stats: Stats,
    frame: Frame,
) -> Field:
    """Makes a field of what was pickled."""
    box = None if surface_bounds is None else to_box("surface_bounds", surface_bounds)
    clamp = to_number("clamp_distance", clamp_distance, least=0.0, most=FINITE)
    core = _raymap.Field(shape, to_vector("origin", origin), to_length("spacing", spacing), clamp, box)
    restored = Field.__new__(Field)
    restored._take(core, frame, stats)
    for name, array in arrays.items():
        restored._set(name, _ordered(name, array))
    if "distance" in arrays or not arrays:  # The shapes of all arrays have been compared.
        core.validate()
    return restored


def load_field(path: str | os.PathLike[str], grid: str | None = None) -> Field:
    """Reads a field, negative inside: .vdb, .nvdb, .nrrd, .npz, .npy or .vti by extension.

    A .npy has no grid: the result has the origin 0 and the spacing 1. A warning (``RaymapWarning``) names arrays of the
    file that a field has no place for. ``SparseField.load`` reads the leaves of a .vdb or .nvdb alone.

    Args:
        path: The file.
        grid: Name of the grid in a .vdb or .nvdb; None = the first level set.

    Raises:
        UsageError: Another extension, or no grid has that name; the message lists those of the file.
        FileError: The file cannot be read.
        InputError: Its content is not valid.
        UnsupportedError: For example a rotated grid.

    >>> raymap.generate("ball.ply", resolution=16).save("ball.vdb")
    >>> raymap.load_field("ball.vdb")
    raymap.Field(16 x 16 x 16 samples, spacing 0.15, arrays distance)
    """
    core = _raymap.load_field(to_path(path), to_text("grid", "" if grid is None else grid))
    return field_of_core(core, read_frame(Path(to_path(path))) if to_path(path).lower().endswith(".npz") else IDENTITY)
