"""Files that appear whole or not at all, as the C++ library writes them, and folders that one run writes into."""

from __future__ import annotations

import errno
import fcntl
import os
import re
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any

from ._errors import Error, FileError

_TEMPORARY = re.compile(r"\..+\.tmp\d+-\d+(-\d+)?", re.DOTALL)
_NO_LOCKS = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}


@contextmanager
def file_errors() -> Iterator[None]:
    """Turns the system's errors about files into FileError."""
    try:
        yield
    except OSError as error:
        if isinstance(error, Error):
            raise
        raise FileError(f"{error.filename or 'a file'}: cannot write: {error.strerror}") from error


@contextmanager
def successor(target: Path) -> Iterator[Path]:
    """Yields a hidden path beside a file, for its next content. At the end removes what was not renamed.

    Raises:
        OSError: An error of the system, which names the target.
    """
    name = os.fsdecode(os.fsencode(target.name)[:180])  # As in src/base/atomic_file.cpp
    temporary = target.with_name(f".{name}.tmp{os.getpid()}-{time.time_ns()}")
    try:
        yield temporary
    except OSError as error:
        if not isinstance(error, Error):
            error.filename = str(target)
        raise
    finally:
        with suppress(OSError):
            temporary.unlink()


def write_whole(path: str | os.PathLike[str], content: bytes | str | Callable[[IO[bytes]], Any]) -> None:
    """Writes a file beside its target, flushes it to the disk and renames it. Text is UTF-8.

    Raises:
        OSError: The file cannot be written. An existing one is untouched.
    """
    target = Path(path)
    data = content.encode() if isinstance(content, str) else content
    with successor(target) as temporary:
        with open(temporary, "xb") as file:
            if callable(data):
                data(file)
            else:
                file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(target)


def remove_leftovers(folder: str | os.PathLike[str]) -> None:
    """Removes the temporaries that killed programs left in a folder and below, those of the C++ library included."""
    for place, _, names in os.walk(folder):
        for name in names:
            if _TEMPORARY.fullmatch(name):
                with suppress(FileNotFoundError):
                    os.unlink(os.path.join(place, name))


@contextmanager
def only_writer(folder: Path) -> Iterator[None]:
    """Makes a folder and keeps other runs out of it. The lock ends with this process, however that ends.

    On a file system without locks there is none.

    Raises:
        FileError: Another run writes into the folder, or it cannot be written.
    """
    with ExitStack() as held:
        with file_errors():
            folder.mkdir(parents=True, exist_ok=True)
            _lock(held.enter_context(open(folder / ".lock", "ab")), folder)
        yield


def _lock(file: IO[bytes], folder: Path) -> None:
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        text = f"{folder}: another run writes into this folder; wait for its end, or choose another folder"
        raise FileError(text) from None
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
