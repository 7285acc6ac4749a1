"""Results of a data set, in its folder or in shards, by their numbers."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Iterable
from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import FileError, InputError, UsageError
from .packing import finished_results, read_index
from .storage import LocalFolder, storage_of


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
        self._storage = storage_of(place)
        index = read_index(self._storage)
        self.groups: list[int] = []
        """Number of results in each file that readers should read in one go."""
        self._entries: list[tuple[str, str, int, int | None]] = []  # Name, file, first byte, number of bytes
        formats = set()
        if index is not None:
            for shard in index["shards"]:
                self.groups.append(len(shard["samples"]))
                formats.add(shard["format"])
                self._entries += [(s["name"], shard["name"], s["start"], s["bytes"]) for s in shard["samples"]]
        elif isinstance(self._storage, LocalFolder):
            for result in finished_results(self._storage.url, what):
                self.groups.append(1)
                formats.add(result.marker["format"])
                file = os.path.relpath(result.path, self._storage.url)
                self._entries.append((result.name, file, 0, None))
        else:
            raise FileError(f"{self._storage.url}: there are no shards here; raymap.dataset.pack writes them")
        if formats != {"npz"}:
            raise UsageError(f"{self._storage.url}: results are .{formats.pop()}, and only .npz can be read here")

    def __len__(self) -> int:
        return len(self._entries)

    def __getitem__(self, index: int) -> dict[str, Any]:
        """Returns the name of a mesh and the arrays of its result."""
        name, file, start, count = self._entries[index]
        content = self._storage.read(file, start, count)
        if content is None:
            raise FileError(f"{self._storage.url}/{file}: no such file")
        try:
            with np.load(io.BytesIO(content), allow_pickle=False) as stored:
                names = stored.files if self._arrays is None else self._arrays
                if missing := [each for each in names if each not in stored.files]:
                    raise UsageError(f"{self._storage.url}/{file}: the result of {name} has no array {missing[0]!r}")
                found: dict[str, npt.NDArray[Any]] = {each: stored[each] for each in names}
        except UsageError:
            raise
        except (ValueError, OSError, EOFError, zipfile.BadZipFile) as error:
            raise InputError(f"{self._storage.url}/{file}: the result of {name} is torn ({error}); write it again") from None
        return {"name": name, **found}
