"""What pictures of fields and meshes show."""

from __future__ import annotations

from typing import TypedDict

from ._arguments import Vector


class ViewOptions(TypedDict, total=False):
    """Keyword arguments of pictures and pages; ``Field.render`` documents them."""

    width: int
    height: int
    direction: Vector
    up: Vector
    field_of_view: float
    cut: bool
    shell: float
