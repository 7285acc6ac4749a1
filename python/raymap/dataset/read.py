"""Results of a data set, in its folder or in shards, by their numbers."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, Protocol

from .._errors import FileError, UsageError
from .packing import read_index
from .results import Arrays, FolderReader
from .stacks import StackReader
from .storage import LocalFolder, storage_of
from .tars import TarReader


class _Reader(Protocol):
    """Results by their numbers."""

    names: list[str]
    """Names of the meshes."""
    groups: list[int]
    """Number of results in each file that readers should read in one go."""
    formats: set[str]
    """Formats of the results."""

    def read(self, number: int, names: Iterable[str] | None) -> Arrays:
        """Returns arrays of a result; those of these names, or all."""
        ...


class Results:
    """The arrays of the .npz files of a data set. It can be pickled, and holds no open file.

    Args:
        place: Folder of ``raymap.dataset.generate``, or of ``raymap.dataset.pack``, or an URL of the latter.
        arrays: Names of the arrays to read; None = all.
        what: What is read of a folder of ``raymap.dataset.generate``: ``"field"`` or ``"points"``.

    Raises:
        UsageError: There is no result, or results are no .npz.
        InputError, FileError: A file cannot be read.
    """

    def __init__(self, place: str | os.PathLike[str], arrays: Iterable[str] | None = None, what: str = "field") -> None:
        self._arrays = None if arrays is None else [arrays] if isinstance(arrays, str) else list(arrays)
        self._reader = _reader_of(place, what)
        if self._reader.formats != {"npz"}:
            raise UsageError(f"{place}: results are .{self._reader.formats.pop()}, and only .npz can be read here")

    @property
    def groups(self) -> list[int]:
        """Number of results in each file that readers should read in one go."""
        return self._reader.groups

    def __len__(self) -> int:
        return len(self._reader.names)

    def __getitem__(self, index: int) -> dict[str, Any]:
        """Returns the name of a mesh and the arrays of its result."""
        return {"name": self._reader.names[index], **self._reader.read(index, self._arrays)}


def _reader_of(place: str | os.PathLike[str], what: str) -> _Reader:
    storage = storage_of(place)
    found = read_index(storage)
    if found is not None:
        format, index = found
        return TarReader(storage, index) if format == "tar" else StackReader(storage, index)
    if isinstance(storage, LocalFolder):
        return FolderReader(storage, what)
    raise FileError(f"{storage.url}: there are no shards here; raymap.dataset.pack writes them")
