"""Fields of a mesh at several resolutions."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from . import _inputs
from ._arguments import to_path, to_whole
from ._errors import FileError, InputError, UsageError
from ._field import Field, save_as
from ._generate import FieldOptions, Generator
from ._typing import Unpack
from ._whole_file import npz_arrays


def generate_pyramid(
    mesh_or_vertices: Any, faces: Any = None, *, levels: int, **options: Unpack[FieldOptions]
) -> list[Field]:
    """Returns fields of a mesh at several resolutions, the finest first, negative inside.

    Each has half the samples of the one before along every side, rounded up, at twice the spacing, and fills the same box
    from its low corner on. All are measured at their own samples, none is averaged. A ``band`` counts samples of the
    finest level: all levels are clamped at the same distance.

    Args:
        mesh_or_vertices: A mesh or positions, as for ``raymap.generate``.
        faces: Three vertex numbers per triangle, (m, 3), if positions are given.
        levels: Number of fields.
        **options: Options of ``raymap.generate``; they say which samples the finest level has. Errors are those of
            ``raymap.generate``, too.

    >>> [field.shape for field in raymap.generate_pyramid("ball.ply", levels=3, shape=(32, 32, 32))]
    [(32, 32, 32), (16, 16, 16), (8, 8, 8)]
    """
    count = to_whole("levels", levels, least=1)
    mesh = _inputs.to_mesh(mesh_or_vertices, faces, allow_empty=True)
    fields = [Generator().generate(mesh, **options)]
    while len(fields) < count:
        last = fields[-1]
        coarser: FieldOptions = {
            **options,
            "cube": False,
            "shape": [-(-samples // 2) for samples in last.shape],
            "origin": last.origin + last.spacing / 2,
            "voxel_size": 2 * last.spacing,
        }
        if last.clamp_distance > 0:
            coarser["truncation"], coarser["band"] = last.clamp_distance, None
        fields.append(Generator().generate(mesh, **coarser))
    return fields


def save_pyramid(levels: Sequence[Field], path: str | os.PathLike[str]) -> None:
    """Writes the fields of ``raymap.generate_pyramid`` into one .npz. The file appears whole or not at all.

    The arrays of the finest level have their usual names, so ``raymap.load_field`` reads that, and warns of the others.
    Those of the next are ``distance_1``, ``origin_1``, ``spacing_1`` and so on.

    Args:
        levels: The fields, the finest first.
        path: File to write.

    Raises:
        UsageError: There is no field, they were not normalized alike, or the path is no .npz.
        FileError: The file cannot be written.
    """
    text, fields = to_path(path), list(levels)
    if not text.lower().endswith(".npz"):
        raise UsageError(f"{text}: a pyramid is saved as .npz")
    if not fields:
        raise UsageError("levels: there is none")
    for number, field in enumerate(fields):
        if (field.scale, *field.centre) != (fields[0].scale, *fields[0].centre):
            raise UsageError(f"levels: number {number} has another centre or scale than number 0")
    save_as(fields[0], text, ".npz", coarser_arrays(fields))


def coarser_arrays(levels: Sequence[Field]) -> dict[str, Any]:
    """Returns the arrays that a .npz of the finest level also holds: those of the others, by name."""
    return {
        f"{name}_{number}": value
        for number, field in enumerate(levels[1:], 1)
        for name, value in _arrays_of(field).items()
    }


def _arrays_of(field: Field) -> dict[str, Any]:
    """Returns what the .npz of a field holds, but for the frame."""
    bounds = field.surface_bounds
    return {
        **{name: getattr(field, name) for name in field.arrays},
        "origin": field.origin,
        "spacing": np.float64(field.spacing),
        "clamp_distance": np.float64(field.clamp_distance),
        **({} if bounds is None else {"surface_bounds": bounds.ravel()}),
    }


def load_pyramid(path: str | os.PathLike[str]) -> list[Field]:
    """Reads what ``save_pyramid`` wrote, and each .npz of a data set with ``pyramid``: the finest field first.

    A .npz of one field is a pyramid of one level.

    Raises:
        FileError: The file cannot be read.
        InputError: Its content is not valid.

    >>> levels = raymap.generate_pyramid("ball.ply", levels=2, resolution=16)
    >>> raymap.save_pyramid(levels, "ball.npz")
    >>> [level.shape for level in raymap.load_pyramid("ball.npz")]
    [(16, 16, 16), (8, 8, 8)]
    """
    try:
        content = Path(to_path(path)).read_bytes()
    except OSError as error:
        raise FileError(f"{path}: cannot read: {error.strerror}") from error
    try:
        arrays = npz_arrays(content)
    except ValueError as error:
        raise InputError(f"{path}: no whole .npz: {error}") from None
    count = 1 + sum(re.fullmatch(r"distance_\d+", name) is not None for name in arrays)
    frame: dict[str, Any] = {name: arrays[name] for name in ("centre", "scale") if name in arrays}
    try:
        return [_level(arrays, f"_{number}" if number else "", frame) for number in range(count)]
    except KeyError as error:
        raise InputError(f"{path}: there is no array {error.args[0]!r}") from None
    except (UsageError, TypeError, ValueError) as error:
        raise InputError(f"{path}: {error}") from None


def _level(arrays: dict[str, Any], ending: str, frame: dict[str, Any]) -> Field:
    """Returns the field whose arrays have an ending.

    Raises:
        KeyError: There is no such array.
    """
    optional = ("winding", "confidence", "triangle", "clamp_distance", "surface_bounds")
    further = {name: arrays[name + ending] for name in optional if name + ending in arrays}
    if "surface_bounds" in further:
        further["surface_bounds"] = further["surface_bounds"].reshape(2, 3)
    distance, origin, spacing = (arrays[name + ending] for name in ("distance", "origin", "spacing"))
    return Field(distance, origin, spacing, **further, **frame)
