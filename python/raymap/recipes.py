"""Samples as known networks read them: the same mixture of points, in the same files.

>>> raymap.recipes.save("occupancy_networks", "ball.ply", "points.npz", n=1000)
>>> sorted(np.load("points.npz").files)
['loc', 'occupancies', 'points', 'scale']
"""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ._arguments import to_path
from ._errors import UsageError
from ._raymap import write_whole
from ._samples import Mixture, Samples, choose, save_as_npz, to_count, to_seed, to_surface
from ._whole_file import npz_bytes

__all__ = ["RecipeName", "save"]

#: Name of a recipe; docs/samples.md describes them.
RecipeName: TypeAlias = Literal[
    "deepsdf", "occupancy_networks", "occupancy_networks_pointcloud", "igr", "siren", "nglod", "instant_ngp"
]


@dataclass(frozen=True)
class Recipe:
    """How a network's samples are chosen and written."""

    format: str
    """Extension of the file."""
    count: int
    """Number of points that the network's own tool makes."""
    mixture: Mixture
    write: Callable[[Samples, str], None]
    """Writes the file, which appears whole or not at all, whatever its path ends with."""


def recipe_of(name: str) -> Recipe:
    """Returns a recipe.

    Raises:
        UsageError: There is none of this name.
    """
    if name not in _RECIPES:
        raise UsageError(f"there is no recipe {name!r}; there are {', '.join(get_args(RecipeName))}")
    return _RECIPES[name]


def save(
    recipe: RecipeName,
    mesh: Any,
    path: str | os.PathLike[str],
    *,
    n: int | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> None:
    """Writes the samples of a mesh as a network reads them. The file appears whole or not at all.

    docs/samples.md says of each recipe which points there are, in which units, and what the file holds. The same mesh
    and arguments give the same bytes, for any number of threads.

    Args:
        recipe: Name of the network.
        mesh: A ``raymap.Surface``, or a mesh or path as for ``raymap.Surface``.
        path: File to write, with the extension of the recipe.
        n: Number of points; None = as many as the network's own tool makes.
        seed: Whole number from 0 to 2^64 - 1. Another one gives other points.
        threads: Number of CPU threads; None = ``raymap.get_threads()``.

    Raises:
        InputError: The mesh is not valid, or has no area.
        UsageError: Another recipe or extension, or a surface without a sign.
        MemoryLimitError: The points do not fit into memory.
        FileError: A file cannot be read or written.
    """
    chosen, text = recipe_of(recipe), to_path(path)
    if not text.lower().endswith(f".{chosen.format}"):
        raise UsageError(f"{text}: the recipe {recipe} is written as .{chosen.format}")
    chosen.write(samples_of(chosen, mesh, n, seed, threads), text)


def samples_of(recipe: Recipe, mesh: Any, n: int | None, seed: int, threads: int | None) -> Samples:
    """Returns the points of a recipe."""
    count = recipe.count if n is None else to_count(n)
    checked_seed, surface = to_seed(seed), to_surface(mesh, threads)
    return choose(surface, recipe.mixture, recipe.mixture.lengths(surface), count, checked_seed, threads)


def _whole(content: Callable[[Samples], bytes]) -> Callable[[Samples, str], None]:
    """Returns a function that writes what another one returns."""
    return lambda samples, path: write_whole(path, content(samples))


def _occupancies(samples: Samples) -> bytes:
    packed = np.packbits(samples.distance < 0)
    return npz_bytes({"points": samples.points.astype(np.float32), "occupancies": packed, **_placement(samples)})


def _point_cloud(samples: Samples) -> bytes:
    points, normals = samples.points.astype(np.float32), samples.gradient.astype(np.float32)
    return npz_bytes({"points": points, "normals": normals, **_placement(samples)})


def _placement(samples: Samples) -> dict[str, Any]:
    """Returns the place of the mesh as Occupancy Networks name it: mesh's positions = points * scale + loc."""
    return {"loc": samples.centre, "scale": np.float64(1 / samples.scale)}


def _rows_with_normals(samples: Samples) -> bytes:
    content = io.BytesIO()
    np.save(content, np.column_stack([samples.points, samples.gradient]))
    return content.getvalue()


def _text_with_normals(samples: Samples) -> bytes:
    content = io.BytesIO()
    np.savetxt(content, np.column_stack([samples.points, samples.gradient]), "%.9g")
    return content.getvalue()


def _nglod(samples: Samples) -> bytes:
    points, distance = samples.points.astype(np.float32), samples.distance.astype(np.float32)
    return npz_bytes({"pts": points, "d": distance[:, None], "centre": samples.centre, "scale": np.float64(samples.scale)})


def _instant_ngp(samples: Samples) -> bytes:
    """Returns points in the unit cube, from 0 to 1."""
    points, distance = (samples.points + 0.5).astype(np.float32), samples.distance.astype(np.float32)
    centre = samples.centre - 0.5 / samples.scale
    return npz_bytes({"positions": points, "distances": distance, "centre": centre, "scale": np.float64(samples.scale)})


# Deviations of a mixture are shares of the bounding sphere's radius.
_RECIPES: dict[str, Recipe] = {
    "deepsdf": Recipe(
        "npz",
        500_000,
        Mixture(
            47 / 50, (math.sqrt(0.005) * 1.03, math.sqrt(0.0005) * 1.03), region="cube", normalization="sphere", margin=1.03
        ),
        save_as_npz,
    ),
    "occupancy_networks": Recipe(
        "npz", 100_000, Mixture(0.0, region="cube", padding=0.05, normalization="unit"), _whole(_occupancies)
    ),
    "occupancy_networks_pointcloud": Recipe(
        "npz", 100_000, Mixture(0.0, surface=1.0, normalization="unit"), _whole(_point_cloud)
    ),
    "igr": Recipe("npy", 250_000, Mixture(0.0, surface=1.0, normalization="sphere"), _whole(_rows_with_normals)),
    "siren": Recipe("xyz", 250_000, Mixture(0.0, surface=1.0, normalization="sphere"), _whole(_text_with_normals)),
    "nglod": Recipe(
        "npz", 500_000, Mixture(0.4, (0.01,), surface=0.4, region="cube", normalization="sphere"), _whole(_nglod)
    ),
    "instant_ngp": Recipe(
        "npz", 1 << 18, Mixture(0.375, (1 / 1024,), surface=0.5, region="cube", normalization="unit"), _whole(_instant_ngp)
    ),
}
