"""Pictures of dense fields and narrow bands."""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt

from . import _raymap
from ._arguments import FINITE, to_box, to_number, to_plane, to_text, to_vector, to_whole
from ._errors import UsageError
from ._records import FieldArray


def to_view(
    width: int,
    height: int,
    direction: tuple[float, float, float],
    up: tuple[float, float, float],
    field_of_view: float,
) -> _raymap.RenderOptions:
    """Returns options of a picture as the extension module takes them."""
    options = _raymap.RenderOptions()
    options.width, options.height = to_whole("width", width), to_whole("height", height)
    options.field_of_view = to_number("field_of_view", field_of_view)
    options.direction, options.up = to_vector("direction", direction), to_vector("up", up)
    return options


def to_scene(
    view: _raymap.RenderOptions,
    *,
    cut: bool,
    shell: float,
    eye: tuple[float, float, float] | None,
    iso: float,
    cut_plane: tuple[float, float, float, float] | None,
    slice_plane: tuple[float, float, float, float] | None,
    frame: npt.ArrayLike | None,
) -> _raymap.RenderOptions:
    """Adds to a view what it shows."""
    view.cut, view.shell = bool(cut), to_number("shell", shell, least=0.0)
    view.iso = to_number("iso", iso, least=-FINITE, most=FINITE)
    if eye is not None:
        view.stand_at(to_vector("eye", eye))
    if cut_plane is not None:
        view.cut_at(*to_plane("cut_plane", cut_plane))
    if slice_plane is not None:
        view.slice_at(*to_plane("slice_plane", slice_plane))
    if frame is not None:
        view.frame_box(*to_box("frame", frame))
    return view


def slice_of(
    core: _raymap.Field | _raymap.SparseField,
    axis: int | Literal["x", "y", "z"],
    index: int | None,
    array: FieldArray,
    width: int,
) -> npt.NDArray[np.uint8]:
    """Returns a picture of a slice of a field of the extension module."""
    if axis not in (0, 1, 2, "x", "y", "z"):
        raise UsageError(f"axis must be 0, 1, 2, 'x', 'y' or 'z', not {axis!r}")
    number = "xyz".index(axis) if isinstance(axis, str) else int(axis)
    count = core.dims[number]
    if index is not None and not -count <= index < count:
        raise UsageError(f"index {index} is out of range: the field has {count} samples along {'xyz'[number]}")
    chosen = -1 if index is None else index % count
    return _raymap.render_slice(core, number, chosen, to_whole("width", width), to_text("array", array))
