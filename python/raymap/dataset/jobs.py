"""Meshes of a data set, and what to make of each."""

from __future__ import annotations

import inspect
import operator
import os
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeAlias, get_args, get_type_hints

import numpy as np

from .. import _raymap, recipes
from .._arguments import to_box, to_whole
from .._errors import Cancelled, FileError, MemoryLimitError, UsageError
from .._frames import to_normalization
from .._generate import FieldOptions, generate
from .._mesh import tetrahedron
from .._samples import Region, sample_points, to_count, to_mixture, to_seed
from ..recipes import RecipeName, recipe_of
from .storage import RemoteFolder, is_url
from .work import BAND_FORMATS, FORMATS, Job

PathLike: TypeAlias = str | os.PathLike[str]


class Options(FieldOptions, total=False):
    """Keyword arguments of ``raymap.generate``, ``raymap.sample_points`` and ``raymap.recipes.save``, which document them.

    ``raymap.dataset.generate`` documents ``pyramid`` and ``sparse``.
    """

    n: int
    near: float
    sigma: float | Iterable[float]
    surface: float
    region: Region
    seed: int
    recipe: RecipeName | None
    pyramid: int
    sparse: bool


def make_jobs(
    given: PathLike | Iterable[PathLike],
    out: Path,
    what: str,
    format: str,
    time_limit: float,
    retry: bool,
    pages: bool,
    options: Options,
) -> list[Job]:
    """Returns the jobs of `raymap.dataset.generate`, in the order of their names. Checks all arguments."""
    if what not in ("field", "points"):
        raise UsageError(f"what must be 'field' or 'points', not {what!r}")
    if what == "points" and format != "npz":
        raise UsageError(f"points are written as npz, or as their recipe says, not as {format!r}")
    if what == "points" and pages:
        raise UsageError("pages show fields; leave them out for points")
    if format not in FORMATS:
        raise UsageError(f"format must be one of {', '.join(FORMATS)}, not {format!r}")
    if not time_limit > 0:
        raise UsageError(f"time_limit must be above 0 seconds, not {time_limit}")
    threads = operator.index(options.get("threads") or 1)
    memory_limit = operator.index(options.get("memory_limit") or 4 << 30)
    if not memory_limit > 0:
        raise UsageError(f"memory_limit must be above 0 bytes, not {memory_limit}")
    meshes = _meshes(given, out)
    boxes = _boxes(options, meshes)
    result_options = _field_options(options, format, pages) if what == "field" else _point_options(options)
    if recipe := result_options.get("recipe"):
        format = recipe_of(recipe).format
    return [
        Job(
            mesh, name, str(out), what, format, {**result_options, **boxes.get(name, {})}, threads, memory_limit,
            time_limit, retry, pages,
        )
        for name, mesh in sorted(meshes.items())
    ]  # fmt: skip


def _boxes(options: Options, meshes: dict[str, str]) -> dict[str, dict[str, Any]]:
    """Takes boxes of single meshes out of the options, and returns them as options by name."""
    if not isinstance(bounds := options.get("bounds"), Mapping):
        return {}
    options["bounds"] = None
    boxes = {name: {"bounds": [list(corner) for corner in to_box(f"bounds of {name}", box)]} for name, box in bounds.items()}
    for name in sorted(meshes.keys() ^ boxes.keys()):
        where = "lacks" if name in meshes else "has a box of no mesh:"
        raise UsageError(f"bounds {where} {name}; it needs a box for each mesh, by its path below the folder")
    return boxes


def _meshes(given: PathLike | Iterable[PathLike], out: Path) -> dict[str, str]:
    """Returns paths and URLs of meshes by name."""
    if isinstance(given, (str, os.PathLike)):
        if is_url(given):
            return _meshes_behind(os.fspath(given))
        if Path(given).is_dir():
            return _meshes_below(Path(given).resolve(), out)
        given = [given]
    meshes: dict[str, str] = {}
    for each in given:
        path = Path(each)
        if not is_url(each) and not path.exists():
            raise FileError(f"{path}: no such file or folder")
        if path.is_dir():
            raise UsageError(f"{path}: a folder among paths; give one folder alone, or meshes")
        if path.name in meshes:
            raise UsageError(f"{meshes[path.name]} and {each}: both results would be {path.name}; give their folder")
        meshes[path.name] = os.fspath(each) if is_url(each) else str(path.resolve())
    return meshes


def _meshes_behind(url: str) -> dict[str, str]:
    """Returns the URL of a mesh, or those of all meshes in a folder behind an URL."""
    endings = tuple(_raymap.mesh_extensions())
    if url.lower().endswith(endings):
        return {url.rsplit("/", 1)[1]: url}
    folder = RemoteFolder(url)
    meshes = {name: f"{folder.url}/{name}" for name in folder.names() if name.lower().endswith(endings)}
    if not meshes:
        raise UsageError(f"{url}: no meshes here; their names end with {', '.join(endings)}")
    return meshes


def _meshes_below(folder: Path, out: Path) -> dict[str, str]:
    endings = tuple(_raymap.mesh_extensions())
    meshes: dict[str, str] = {}

    def fail(error: OSError) -> None:
        raise FileError(f"{error.filename}: cannot read: {error.strerror}")

    for place, folders, names in os.walk(folder, onerror=fail):
        folders[:] = [name for name in folders if Path(place, name) != out]
        for name in names:
            if name.lower().endswith(endings) and Path(place, name).is_file():
                meshes[str(Path(place, name).relative_to(folder))] = str(Path(place, name))
    if not meshes:
        raise UsageError(f"{folder}: no meshes here; their names end with {', '.join(endings)}")
    return meshes


_APART = {"threads", "memory_limit", "progress"}  # Results do not depend on them.


def _field_options(options: Options, format: str, pages: bool) -> dict[str, Any]:
    """Returns all options on which fields depend, the defaults included, in JSON's types. Checks them."""
    others = {name: value for name, value in options.items() if name not in ("pyramid", "sparse")}
    given: FieldOptions = {"device": "cpu", **others}  # type: ignore[typeddict-item]
    result = _with_defaults(given, generate, "fields")
    result["sparse"] = bool(options.get("sparse", False))
    if result["sparse"] and format not in BAND_FORMATS:
        raise UsageError(f"sparse=True makes narrow bands, which are written as {' or '.join(BAND_FORMATS)}, not as {format!r}")
    if result["sparse"] and pages:
        raise UsageError("pages show fields of all samples; leave out pages or sparse=True")
    _check(given, result["sparse"])
    if isinstance(result["band"], tuple):
        result["band"] = list(result["band"])
    arrays = result["arrays"]
    result["arrays"] = sorted({"distance", *([arrays] if isinstance(arrays, str) else arrays)})
    if result["bounds"] is not None:
        result["bounds"] = np.asarray(result["bounds"], np.float64).tolist()
    for name in "offsets", "shape", "origin":
        if result[name] is not None:
            result[name] = np.asarray(result[name]).tolist()
    result["normalize"] = to_normalization(result["normalize"]) or False
    result["pyramid"] = to_whole("pyramid", options.get("pyramid", 0), most=30)
    if result["pyramid"] and format != "npz":
        raise UsageError(f"pyramid needs files of several grids, so the format npz, not {format!r}")
    return result


def _point_options(options: Options) -> dict[str, Any]:
    """Returns all options on which points depend, as `_field_options` does."""
    if (recipe := options.get("recipe")) is not None:
        result = _with_defaults(options, recipes.save, f"the recipe {recipe}")
        count = recipe_of(recipe).count if result["n"] is None else result["n"]
        return {"recipe": recipe, "n": to_count(count), "seed": to_seed(result["seed"])}
    if "n" not in options:
        raise UsageError("what='points' needs n, the number of points of each mesh, or a recipe")
    result = _with_defaults({name: value for name, value in options.items() if name != "recipe"}, sample_points, "points")
    result["sigma"] = np.atleast_1d(np.asarray(result["sigma"], np.float64)).tolist()
    result["normalize"] = to_normalization(result["normalize"]) or False
    result["n"], result["seed"] = to_count(result["n"]), to_seed(result["seed"])
    to_mixture(*(result[name] for name in ("near", "sigma", "surface", "region", "padding", "normalize")))
    return result


def _with_defaults(options: Mapping[str, object], function: Callable[..., Any], what: str) -> dict[str, Any]:
    """Returns the keyword arguments of a function on which its result depends."""
    parameters = inspect.signature(function).parameters
    known = {k: p for k, p in parameters.items() if p.kind is p.KEYWORD_ONLY or k in ("n", "recipe")}
    for name in sorted(options.keys() - known.keys() - _APART):
        if name in Options.__annotations__:
            raise UsageError(f"{name} is no option of {what}")
        raise TypeError(f"generate() got an unexpected keyword argument {name!r}")
    values = {name: options.get(name, known[name].default) for name in known.keys() - _APART - {"recipe"}}
    hints = get_type_hints(function)
    return {name: _plain(value, float in (hints[name], *get_args(hints[name]))) for name, value in values.items()}


def _plain(value: Any, is_real: bool) -> Any:
    """Returns a number as one of Python; 4 as 4.0 where both say the same."""
    plain = value.item() if isinstance(value, np.generic) else value
    return float(plain) if is_real and isinstance(plain, int) else plain


def _check(options: FieldOptions, sparse: bool) -> None:
    """Raises errors that no mesh can change, such as an unknown option: begins a field of a tetrahedron."""
    mesh = tetrahedron(10 * (options.get("voxel_size") or 1))
    # The device may be one that only the workers have.
    with suppress(Cancelled, MemoryLimitError):
        checked: FieldOptions = {**options, "device": "cpu", "progress": lambda stage, done: False}
        generate(mesh, sparse=sparse, **checked)
