"""Files that appear whole or not at all, as the C++ library writes them."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ._errors import Error, FileError

_TEMPORARY = re.compile(r"\..+\.tmp\d+-\d+(-\d+)?", re.DOTALL)


@contextmanager
def file_errors() -> Iterator[None]:
    """Turns the system's errors about files into FileError."""
    try:
        yield
    except OSError as error:
        if isinstance(error, Error):
            raise
        raise FileError(f"{error.filename or 'a file'}: cannot write: {error.strerror}") from error


def write_whole(path: str | os.PathLike[str], content: bytes | str) -> None:
    """Writes a file beside its target, flushes it to the disk and renames it. Text is UTF-8.

    Raises:
        OSError: The file cannot be written. An existing one is untouched.
    """
    target = Path(path)
    data = content.encode() if isinstance(content, str) else content
    temporary = target.with_name(f"{_temporary_stem(target)}{os.getpid()}-{time.time_ns()}")
    try:
        with open(temporary, "xb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(target)
    except BaseException:
        with suppress(OSError):
            temporary.unlink()
        raise


def remove_leftovers(folder: str | os.PathLike[str]) -> None:
    """Removes the temporaries that killed programs left in a folder and below, those of the C++ library included."""
    for place, _, names in os.walk(folder):
        for name in names:
            if _TEMPORARY.fullmatch(name):
                with suppress(FileNotFoundError):
                    os.unlink(os.path.join(place, name))


def _temporary_stem(target: Path) -> str:
    name = os.fsencode(target.name)[:180]  # As in src/base/atomic_file.cpp
    return f".{os.fsdecode(name)}.tmp"
