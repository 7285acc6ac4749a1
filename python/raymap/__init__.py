"""Signed distance fields from any triangle mesh, negative inside.

>>> field = raymap.generate("ball.ply", resolution=64)
>>> field.distance.shape
(64, 64, 64)
>>> field.sample([(0, 0, 0.5), (0, 0, 1.1)]).round(2)
array([-0.5,  0.1], dtype=float32)
"""

import atexit
import importlib.util
import sys
from typing import TYPE_CHECKING, Any

from . import _raymap, dataset, recipes, zarr
from ._devices import devices, test_device
from ._errors import (
    Cancelled,
    DeviceLostError,
    DeviceMemoryError,
    Error,
    FileError,
    InputError,
    MemoryLimitError,
    RaymapWarning,
    UnsupportedError,
    UsageError,
)
from ._field import NO_TRIANGLE, Field, load_field
from ._generate import FieldOptions, Generator, generate
from ._generate_file import generate_file
from ._memory import limit_memory, memory_left
from ._mesh import Animation, Mesh, load_animation, load_mesh
from ._pyramid import generate_pyramid, load_pyramid, save_pyramid
from ._records import (
    Comparison,
    DeviceInfo,
    DeviceTest,
    FileReport,
    RepairReport,
    SimplifyReport,
    Stats,
    ThicknessSummary,
)
from ._repair import (
    FastInfo,
    Info,
    Repaired,
    Simplified,
    info,
    isosurface,
    render_defects,
    repair,
    simplify,
)
from ._samples import Sampler, Samples, sample_points
from ._scene import NO_BODY, Scene, SceneQuery
from ._surface import (
    Closest,
    FacePoints,
    Query,
    Surface,
    SurfacePair,
    Thickness,
    sample_faces,
    signed_distance,
    split_parts,
)
from ._threads import get_threads, set_threads

_OPTIONAL = ("dask", "jax", "torch")  # Modules that need the packages of these names.

if TYPE_CHECKING:
    from . import dask as dask
    from . import jax as jax
    from . import torch as torch
else:

    def __getattr__(name: str) -> Any:
        """Imports a module that needs another package when it is first used. Without the package, there is no such name."""
        if name not in _OPTIONAL:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        try:
            return importlib.import_module(f".{name}", __name__)
        except ImportError as error:
            raise AttributeError(str(error)) from error


def __dir__() -> list[str]:
    """Returns the names that users may use."""
    return [*__all__, *filter(_is_installed, _OPTIONAL), *(name for name in globals() if name.startswith("__"))]


def _is_installed(package: str) -> bool:
    return (sys.modules[package] if package in sys.modules else importlib.util.find_spec(package)) is not None


@atexit.register
def _end() -> None:
    if "torch._dynamo" in sys.modules:  # It keeps what compiled functions use until the end, which is no leak.
        _raymap.set_leak_warnings(False)


__version__ = _raymap.version()

__all__ = [
    "NO_BODY",
    "NO_TRIANGLE",
    "Animation",
    "Cancelled",
    "Closest",
    "Comparison",
    "DeviceInfo",
    "DeviceLostError",
    "DeviceMemoryError",
    "DeviceTest",
    "Error",
    "FacePoints",
    "FastInfo",
    "Field",
    "FieldOptions",
    "FileError",
    "FileReport",
    "Generator",
    "Info",
    "InputError",
    "MemoryLimitError",
    "Mesh",
    "Query",
    "RaymapWarning",
    "RepairReport",
    "Repaired",
    "Sampler",
    "Samples",
    "Scene",
    "SceneQuery",
    "Simplified",
    "SimplifyReport",
    "Stats",
    "Surface",
    "SurfacePair",
    "Thickness",
    "ThicknessSummary",
    "UnsupportedError",
    "UsageError",
    "dataset",
    "devices",
    "generate",
    "generate_file",
    "generate_pyramid",
    "get_threads",
    "info",
    "isosurface",
    "limit_memory",
    "load_animation",
    "load_field",
    "load_mesh",
    "load_pyramid",
    "memory_left",
    "recipes",
    "render_defects",
    "repair",
    "sample_faces",
    "sample_points",
    "save_pyramid",
    "set_threads",
    "signed_distance",
    "simplify",
    "split_parts",
    "test_device",
    "zarr",
]

for _name in __all__:  # Messages name classes as users import them.
    if isinstance(_value := globals()[_name], type):
        _value.__module__ = __name__
del _name, _value
