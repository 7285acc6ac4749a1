"""Folders that one run writes into, and what killed programs leave in them."""

from __future__ import annotations

import errno
import fcntl
import io
import os
import re
import shutil
import tempfile
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import IO, Any

import numpy as np
import numpy.typing as npt

from ._errors import Error, FileError

#: Names of hidden files and folders of this user, those of src/base/temporary_file.cpp included.
_HIDDEN = re.compile(rf"\..+\.tmp{os.geteuid()}-\w+", re.DOTALL)
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
def folder_beside(target: Path) -> Iterator[Path]:
    """Yields a hidden folder beside a file, for its next content. It is locked, and removed at the end.

    Raises:
        OSError: The folder cannot be made.
    """
    name = os.fsdecode(os.fsencode(target.name)[:180])  # As in src/base/temporary_file.cpp
    prefix = f".{name}.tmp{os.geteuid()}-"
    with tempfile.TemporaryDirectory(prefix=prefix, dir=target.parent, ignore_cleanup_errors=True) as folder:
        with _opened(folder, os.O_RDONLY) as descriptor:
            with suppress(OSError):  # There are no locks here, so nobody removes it.
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield Path(folder)


def npz_bytes(arrays: Mapping[str, Any]) -> bytes:
    """Returns the bytes of a .npz. Those of the same arrays are always the same: it holds no time."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        add_arrays(archive, arrays)
    return content.getvalue()


def add_arrays(archive: zipfile.ZipFile, arrays: Mapping[str, Any]) -> None:
    """Adds arrays to a .npz."""
    for name, value in arrays.items():
        with archive.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as file:
            np.lib.format.write_array(file, np.asarray(value), allow_pickle=False)


def npz_arrays(content: bytes, names: Iterable[str] | None = None) -> dict[str, npt.NDArray[Any]]:
    """Returns arrays of the bytes of a .npz: those of these names, or all.

    Raises:
        KeyError: It has no array of such a name, which is the error's argument.
        ValueError: It is torn.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            stored = [name.removesuffix(".npy") for name in archive.namelist()]
            wanted = stored if names is None else list(names)
            missing = [name for name in wanted if name not in stored]
            found = {} if missing else {name: _array(archive.read(f"{name}.npy")) for name in wanted}
    except (ValueError, OSError, EOFError, KeyError, RuntimeError, zlib.error, zipfile.BadZipFile) as error:
        raise ValueError(str(error)) from None
    if missing:
        raise KeyError(missing[0])
    return found


def _array(content: bytes) -> npt.NDArray[Any]:
    array: npt.NDArray[Any] = np.lib.format.read_array(io.BytesIO(content), allow_pickle=False)
    return array


def save_with_arrays(save: Callable[[str], object], path: str, arrays: Mapping[str, Any]) -> None:
    """Writes a .npz by a function, and adds arrays to it. The file appears whole or not at all."""
    target = Path(path)
    with file_errors(), folder_beside(target) as folder:
        save(str(folder / "whole"))
        with zipfile.ZipFile(folder / "whole", "a") as archive:
            add_arrays(archive, arrays)
        (folder / "whole").replace(target)


def remove_leftovers(folder: str | os.PathLike[str]) -> None:
    """Removes what killed programs left in a folder and below, the temporaries of the C++ library included.

    Whoever still writes something holds a lock on it. So nothing is removed on a file system without locks.
    """
    for place, folders, names in os.walk(folder):
        for name in filter(_HIDDEN.fullmatch, folders):
            _remove(os.path.join(place, name), os.O_RDONLY, shutil.rmtree)
        for name in filter(_HIDDEN.fullmatch, names):
            _remove(os.path.join(place, name), os.O_WRONLY, os.unlink)


def _remove(path: str, access: int, remove: Callable[[str], object]) -> None:
    with suppress(OSError), _opened(path, access | os.O_NOFOLLOW | os.O_NONBLOCK) as descriptor:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.path.samestat(os.fstat(descriptor), os.lstat(path)):  # Its name can change hands until it is locked.
            remove(path)


@contextmanager
def _opened(path: str, flags: int) -> Iterator[int]:
    descriptor = os.open(path, flags)
    try:
        yield descriptor
    finally:
        os.close(descriptor)


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
