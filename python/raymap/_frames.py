"""Where meshes lie once their size is made one: the same for all meshes of a data set."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Literal, NamedTuple, TypeAlias, get_args

import numpy as np
import numpy.typing as npt

from ._errors import InputError, UsageError
from ._mesh import Mesh

#: Shape that a mesh fills once it is normalized: the ball of radius 1, the cube from -1 to 1, or that from -0.5 to 0.5.
Normalization: TypeAlias = Literal["sphere", "cube", "unit"]


class Frame(NamedTuple):
    """A frame in which a mesh lies about 0: a position p of the mesh is at ``(p - centre) * scale``."""

    centre: npt.NDArray[np.float64]
    scale: float

    @property
    def is_identity(self) -> bool:
        """Whether nothing moves."""
        return self.scale == 1.0 and not self.centre.any()

    def into(self, positions: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        """Returns positions of the mesh in this frame."""
        return (positions - self.centre) * self.scale

    def back(self, positions: npt.NDArray[Any]) -> npt.NDArray[np.float64]:
        """Returns positions of this frame in the mesh."""
        return positions / self.scale + self.centre


IDENTITY = Frame(np.zeros(3), 1.0)


def to_normalization(normalize: bool | Normalization) -> Normalization | None:
    """Returns how to normalize; None = not at all. True is "sphere".

    Raises:
        UsageError: Something else.
    """
    if isinstance(normalize, (bool, np.bool_)):
        return "sphere" if normalize else None
    if normalize not in get_args(Normalization):
        raise UsageError(f"normalize must be True, False, {', '.join(map(repr, get_args(Normalization)))}, not {normalize!r}")
    return normalize


def frame_of(mesh: Mesh, normalization: Normalization | None) -> Frame:
    """Returns the frame in which a mesh is normalized, about the centre of its bounds.

    Raises:
        InputError: The mesh is not valid, or all of it is one point.
    """
    if normalization is None:
        return IDENTITY
    low, high = mesh.bounds
    centre = (low + high) / 2
    if normalization == "sphere":
        size = float(np.linalg.norm(mesh.vertices[np.unique(mesh.faces)] - centre, axis=1).max())
    else:
        size = float((high - low).max()) / (2 if normalization == "cube" else 1)
    if size == 0.0:
        raise InputError("normalize: all faces of the mesh lie in one point, so it has no size")
    return Frame(centre, 1.0 / size)


def moved(mesh: Mesh, frame: Frame) -> Mesh:
    """Returns a mesh as it lies in a frame."""
    return mesh if frame.is_identity else Mesh(frame.into(mesh.vertices), mesh.faces)


def frame_arrays(frame: Frame) -> dict[str, Any]:
    """Returns the arrays that hold a frame in a .npz."""
    return {"centre": frame.centre, "scale": np.float64(frame.scale)}


def read_frame(path: Path) -> Frame:
    """Returns the frame that a .npz holds; that of the mesh if it holds none."""
    with np.load(path) as arrays:
        if "scale" not in arrays or "centre" not in arrays:
            return IDENTITY
        try:
            centre, scale = (np.asarray(arrays[name], np.float64) for name in ("centre", "scale"))
        except (ValueError, TypeError) as error:
            raise InputError(f"{path}: its centre or scale is no array of numbers: {error}") from None
    return to_frame(centre, scale.item() if scale.size == 1 else scale, f"{path}: ")


def to_frame(centre: npt.ArrayLike, scale: Any, where: str = "") -> Frame:
    """Returns the frame that someone gave.

    Raises:
        InputError: The centre or the scale is none.
    """
    place = np.asarray(centre, np.float64)
    if place.shape != (3,) or not np.isfinite(place).all():
        raise InputError(f"{where}centre must be three finite numbers, not {place.tolist()}")
    if not (np.ndim(scale) == 0 and 0.0 < scale < np.inf):
        raise InputError(f"{where}scale must be a finite number above 0, not {scale}")
    return Frame(place, float(scale))
