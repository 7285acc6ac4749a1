"""Folders on this machine or behind an URL that fsspec knows."""

from __future__ import annotations

import importlib
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import unquote_to_bytes

from .._errors import FileError, UsageError
from .._raymap import write_whole
from .._whole_file import file_errors, folder_beside
from .files import buffer_hashes


class Storage(Protocol):
    """A folder whose files are written whole or not at all."""

    url: str

    def read(self, name: str, start: int = 0, count: int | None = None) -> bytes | None:
        """Returns the bytes of a file, or some of them; None if there is no such file."""
        ...

    def size(self, name: str) -> int | None:
        """Returns the length of a file; None if there is none."""
        ...

    def put(self, path: Path, name: str) -> None:
        """Moves or copies a file of this machine into the folder, in the place of an earlier one."""
        ...

    def write(self, name: str, content: bytes) -> None:
        """Writes a small file."""
        ...

    def remove(self, name: str) -> None:
        """Removes a file if it is there."""
        ...


class LocalFolder:
    """A folder of this machine."""

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.url = os.fspath(Path(path).resolve())

    def read(self, name: str, start: int = 0, count: int | None = None) -> bytes | None:
        try:
            with open(os.path.join(self.url, name), "rb") as file:
                file.seek(start)
                return file.read(-1 if count is None else count)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise FileError(f"{self.url}/{name}: cannot read: {error.strerror}") from error

    def size(self, name: str) -> int | None:
        try:
            return os.path.getsize(os.path.join(self.url, name))
        except FileNotFoundError:
            return None

    def put(self, path: Path, name: str) -> None:
        path.replace(os.path.join(self.url, name))

    def write(self, name: str, content: bytes) -> None:
        with file_errors():
            Path(self.url, name).parent.mkdir(parents=True, exist_ok=True)
        write_whole(os.path.join(self.url, name), content)

    def remove(self, name: str) -> None:
        Path(self.url, name).unlink(missing_ok=True)


class RemoteFolder:
    """A folder behind an URL. The file systems of fsspec upload a file at once."""

    def __init__(self, url: str) -> None:
        try:
            fsspec: Any = importlib.import_module("fsspec")
        except ImportError:
            raise UsageError(f"{url}: this needs the package fsspec: pip install fsspec") from None
        self.url = url.rstrip("/")
        with _remote_errors(url):
            self._files, self._path = fsspec.core.url_to_fs(self.url)

    def _name(self, name: str) -> str:
        return f"{self._path}/{name}"

    def read(self, name: str, start: int = 0, count: int | None = None) -> bytes | None:
        with _remote_errors(f"{self.url}/{name}"):
            try:
                end = None if count is None else start + count
                return bytes(self._files.cat_file(self._name(name), start=start, end=end))
            except FileNotFoundError:
                return None

    def size(self, name: str) -> int | None:
        with _remote_errors(f"{self.url}/{name}"):
            try:
                return int(self._files.size(self._name(name)))
            except FileNotFoundError:
                return None

    def names(self) -> list[str]:
        """Returns the paths of all files in the folder and below."""
        with _remote_errors(self.url):
            root = self._path.rstrip("/") + "/"
            return sorted(path.removeprefix(root) for path in self._files.find(self._path))

    def get(self, name: str, path: Path) -> None:
        """Copies a file to this machine."""
        with _remote_errors(f"{self.url}/{name}"):
            self._files.get_file(self._name(name), str(path))

    def put(self, path: Path, name: str) -> None:
        with _remote_errors(f"{self.url}/{name}"):
            self._files.makedirs(self._name(name).rsplit("/", 1)[0], exist_ok=True)
            self._files.put_file(str(path), self._name(name))

    def write(self, name: str, content: bytes) -> None:
        with _remote_errors(f"{self.url}/{name}"):
            self._files.makedirs(self._name(name).rsplit("/", 1)[0], exist_ok=True)
            self._files.pipe_file(self._name(name), content)

    def remove(self, name: str) -> None:
        with _remote_errors(f"{self.url}/{name}"):
            if self._files.exists(self._name(name)):
                self._files.rm_file(self._name(name))


@contextmanager
def _remote_errors(url: str) -> Iterator[None]:
    """Turns errors of file systems, which raise what they like, into FileError."""
    try:
        yield
    except (OSError, ValueError, ImportError) as error:
        raise FileError(f"{url}: {error}") from error


def is_url(place: str | os.PathLike[str]) -> bool:
    """Returns whether a path is an URL."""
    return "://" in os.fspath(place)


class MeshUnreadable(Exception):
    """A mesh cannot be read now, which is no fault of its own."""


@contextmanager
def unreadable() -> Iterator[None]:
    """Turns errors of the system into `MeshUnreadable`."""
    try:
        yield
    except OSError as error:
        raise MeshUnreadable(f"the mesh cannot be read: {error.strerror or error}") from error


@contextmanager
def mesh_here(mesh: str, memory_limit: int) -> Iterator[str]:
    """Yields the path of a mesh on this machine: of one behind an URL, that of a copy, with its buffers beside it.

    Raises:
        MeshUnreadable: The mesh cannot be read.
    """
    if not is_url(mesh):
        yield mesh
        return
    url, name = mesh.rsplit("/", 1)
    with tempfile.TemporaryDirectory(prefix="raymap-") as place:
        copy = os.path.join(place, name)
        with unreadable():
            folder = RemoteFolder(url)
            folder.get(name, Path(copy))
            for buffer in buffer_hashes(copy, memory_limit):
                _get_buffer(folder, Path(place), os.fsdecode(unquote_to_bytes(buffer)))
        yield copy


def _get_buffer(folder: RemoteFolder, place: Path, name: str) -> None:
    """Copies a buffer of a mesh. One that is elsewhere, or missing, is not there for the mesh's process, which says so."""
    path = place / name
    if "\0" in name:
        return
    if path.resolve().is_relative_to(place.resolve()) and folder.size(name) is not None:
        path.parent.mkdir(parents=True, exist_ok=True)
        folder.get(name, path)


def storage_of(place: str | os.PathLike[str]) -> Storage:
    """Returns the folder of a path or an URL."""
    text = os.fspath(place)
    return RemoteFolder(text) if is_url(text) else LocalFolder(text)


@contextmanager
def file_for(storage: Storage, name: str) -> Iterator[Path]:
    """Yields the path of a file to write. It becomes a file of the folder if nothing is raised."""
    target = Path(storage.url, name) if isinstance(storage, LocalFolder) else Path.cwd() / Path(name).name
    with file_errors():
        target.parent.mkdir(parents=True, exist_ok=True)
        with folder_beside(target) as beside:
            yield beside / "whole"
            storage.put(beside / "whole", name)
