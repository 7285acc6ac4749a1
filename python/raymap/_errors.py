"""The exceptions and the warning of the package. The C++ library words their messages, this module the remedies."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import Any


class Error(Exception):
    """Base of all errors that the library raises. Its text says what is wrong, where, and what to do."""

    def __reduce__(self) -> str | tuple[Any, ...]:
        return super().__reduce__()  # Without one of our own, tblib, which Dask uses, unpickles no MemoryError.


class UsageError(Error, ValueError):
    """An argument makes no sense, or contradicts another."""


class InputError(Error, ValueError):
    """A file or array was read, but its content is not valid. The text names the element and its value."""


class FileError(Error, OSError):
    """A file cannot be opened, read or written."""


class MemoryLimitError(Error, MemoryError):
    """The work needs more memory than ``memory_limit``, or than the machine has."""


class DeviceMemoryError(MemoryLimitError):
    """The GPU has no memory left, whatever is allowed."""


class Cancelled(Error):
    """The progress callable returned False."""


class UnsupportedError(Error):
    """Valid, but beyond what this build or this machine can do."""


class DeviceLostError(Error):
    """The GPU stopped answering while it worked."""


class RaymapWarning(UserWarning):
    """Something odd that does not stop a call, for example that a GPU was not used.

    ``code`` is the kind of the warning, as docs/report.md lists them. ``fields`` has the values that the text names.
    """

    def __init__(self, message: str, code: str = "", fields: dict[str, Any] | None = None) -> None:
        super().__init__(message)
        self.code = code
        self.fields = fields or {}


_BY_CODE: dict[str, type[Error]] = {
    "usage": UsageError,
    "input": InputError,
    "file": FileError,
    "memory": MemoryLimitError,
    "cancelled": Cancelled,
    "unsupported": UnsupportedError,
    "device_lost": DeviceLostError,
    "device_memory": DeviceMemoryError,
}


def make_error(code: str, message: str) -> Error:
    """Returns the exception for a code of raymap::ErrorCode. The extension module calls it."""
    return _BY_CODE[code](message)


def code_of(error: Error) -> str:
    """Returns the code for which `make_error` makes such an exception; "" if there is none."""
    return next((code for code, kind in _BY_CODE.items() if type(error) is kind), "")


# Arguments and functions that help against what a warning tells of. Braces hold names of its fields.
_REMEDIES = {
    "device_refused": "raymap.test_device({device!r})",
    "device_failed": "device='cpu' leaves the GPU out",
    "orientation_misfit": "raymap.info",
    "parts_inside_out": "orientation='keep'",
    "solid_lost": "voxel_size={voxel_size:g}",
    "parts_thickened": "voxel_size={voxel_size:g}",
    "sheet": "base, or thickness={length:g} of raymap.generate",
    "bounds_left": "min_thickness",
    "loose_bodies": "keep_cavities=False",
    "surface_lost": "min_thickness",
    "parts_dropped": "drop_smaller=0",
    "parts_kept": "drop_smaller",
    "parts_buried": "keep_cavities=True",
    "cavities_filled": "keep_cavities=True",
    "hollows_filled": "drain_hole",
    "no_hollow": "shell",
    "nothing_inside": "voxel_size={voxel_size:g}",
}


def worded(code: str, message: str, fields: dict[str, Any]) -> str:
    """Returns the message of a warning with the argument or the function that helps, if there is one."""
    remedy = _REMEDIES.get(code, "")
    if "voxel_size" in remedy and not fields["voxel_size"]:
        remedy = "thickness={length:g}" if code == "nothing_inside" and fields["length"] else ""
    return f"{message} ({remedy.format(**fields)})" if remedy else message


def warn(code: str, message: str, fields: dict[str, Any]) -> None:
    """Warns at the line outside of this package that called it. The extension module calls it."""
    package = str(Path(__file__).parent)
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(package):
        level, frame = level + 1, frame.f_back
    warnings.warn(RaymapWarning(worded(code, message, fields), code, fields), stacklevel=level)
