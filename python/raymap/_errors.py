"""The exceptions and the warning of the package. The C++ library words their messages."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path


class Error(Exception):
    """Base of all errors that the library raises. Its text says what is wrong, where, and what to do."""


class UsageError(Error, ValueError):
    """An argument makes no sense, or contradicts another."""


class InputError(Error, ValueError):
    """A file or array was read, but its content is not valid. The text names the element and its value."""


class FileError(Error, OSError):
    """A file cannot be opened, read or written."""


class MemoryLimitError(Error, MemoryError):
    """The work needs more memory than ``memory_limit``, or than the machine has."""


class Cancelled(Error):
    """The progress callable returned False."""


class UnsupportedError(Error):
    """Valid, but beyond what this build or this machine can do."""


class DeviceLostError(Error):
    """The GPU stopped answering while it worked."""


class RaymapWarning(UserWarning):
    """Something odd that does not stop a call, for example that a GPU was not used."""


_BY_CODE: dict[str, type[Error]] = {
    "usage": UsageError,
    "input": InputError,
    "file": FileError,
    "memory": MemoryLimitError,
    "cancelled": Cancelled,
    "unsupported": UnsupportedError,
    "device_lost": DeviceLostError,
}


def make_error(code: str, message: str) -> Error:
    """Returns the exception for a code of raymap::ErrorCode. The extension module calls it."""
    return _BY_CODE[code](message)


def code_of(error: Error) -> str:
    """Returns the code for which `make_error` makes such an exception."""
    return next(code for code, kind in _BY_CODE.items() if isinstance(error, kind))


def warn(message: str) -> None:
    """Warns at the line outside of this package that called it. The extension module calls it."""
    package = str(Path(__file__).parent)
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_code.co_filename.startswith(package):
        level, frame = level + 1, frame.f_back
    warnings.warn(message, RaymapWarning, stacklevel=level)
