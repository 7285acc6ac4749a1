"""What pictures of fields and meshes show."""

from __future__ import annotations

from typing import TypedDict

from . import _raymap
from ._arguments import Vector, to_number, to_vector, to_whole


class ViewOptions(TypedDict, total=False):
    """Keyword arguments of pictures and pages; ``Field.render`` documents them."""

    width: int
    height: int
    direction: Vector
    up: Vector
    field_of_view: float
    cut: bool
    shell: float


def to_view(
    width: int = 1024,
    height: int = 768,
    direction: Vector = (-0.6, -0.45, -1.0),
    up: Vector = (0.0, 1.0, 0.0),
    field_of_view: float = 30.0,
    cut: bool = False,
    shell: float = 0.0,
) -> _raymap.RenderOptions:
    """Returns options of a picture as the extension module takes them."""
    view = _raymap.RenderOptions()
    view.width, view.height = to_whole("width", width), to_whole("height", height)
    view.field_of_view = to_number("field_of_view", field_of_view)
    view.direction, view.up = to_vector("direction", direction), to_vector("up", up)
    view.cut, view.shell = bool(cut), to_number("shell", shell, least=0.0)
    return view
