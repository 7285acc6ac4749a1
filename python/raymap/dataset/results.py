"""Finished results of a data set in their folder."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

import numpy.typing as npt

from .._errors import FileError, InputError, UsageError
from .._whole_file import npz_arrays
from .storage import LocalFolder, Storage
from .work import KINDS, read_marker

#: Arrays of a result by their names.
Arrays: TypeAlias = dict[str, npt.NDArray[Any]]


class Result(NamedTuple):
    """A finished result of a data set."""

    name: str
    path: Path
    marker: dict[str, Any]


def finished_results(folder: str | os.PathLike[str], what: str) -> list[Result]:
    """Returns the finished results of a folder by their names.

    Raises:
        UsageError: There is none, or they are of several options.
        InputError: One is not as it was when it was finished.
    """
    if what not in KINDS:
        raise UsageError(f"what must be 'field' or 'points', not {what!r}")
    results: list[Result] = []
    ending = f"{KINDS[what]}.json"
    for place, folders, names in os.walk(folder):
        if Path(place) == Path(folder):
            folders[:] = [name for name in folders if name != "quarantine"]
        for name in names:
            marker = read_marker(Path(place, name)) if name.endswith(ending) else None
            if marker is not None and marker["what"] == what and marker["state"] == "done":
                path = Path(place, name.removesuffix(".json") + "." + marker["format"])
                results.append(Result(str(Path(place, name.removesuffix(ending)).relative_to(folder)), path, marker))
    if not results:
        raise UsageError(f"{folder}: no finished {what} here; raymap.dataset.generate makes them")
    results.sort()
    _check_same(results)
    return results


def _check_same(results: list[Result]) -> None:
    def kind(marker: dict[str, Any]) -> Any:
        return common_options(marker), marker["format"], marker["raymap"]

    for result in results:
        if kind(result.marker) != kind(results[0].marker):
            names = f"{results[0].name} and {result.name}"
            raise UsageError(f"{names} are results of different options; run the data set again, or remove the old ones")
        if not result.path.exists() or result.path.stat().st_size != result.marker["bytes"]:
            raise InputError(f"{result.path}: not as it was when it was finished; run the data set again")


def common_options(marker: dict[str, Any]) -> dict[str, Any]:
    """Returns the options that all results of a data set have."""
    return {**marker["options"], "bounds": None}


def read_arrays(storage: Storage, file: str, mesh: str, names: Iterable[str] | None) -> Arrays:
    """Returns arrays of the .npz of a mesh.

    Raises:
        FileError: There is no such file, or it cannot be read.
        UsageError, InputError: As for `arrays_of`.
    """
    content = storage.read(file)
    if content is None:
        raise missing(storage, file, mesh)
    return arrays_of(content, storage, file, mesh, names)


def arrays_of(content: bytes, storage: Storage, file: str, mesh: str, names: Iterable[str] | None) -> Arrays:
    """Returns arrays of the bytes of a .npz.

    Args:
        content: The bytes.
        storage: Folder from which they come, for errors.
        file: Name of the file from which they come.
        mesh: Name of the mesh.
        names: Names of the arrays; None = all.

    Raises:
        UsageError: It has no such array.
        InputError: It is torn.
    """
    try:
        return npz_arrays(content, names)
    except KeyError as error:
        raise lacks_array(storage, file, mesh, error.args[0]) from None
    except ValueError as error:
        raise torn(storage, file, mesh, error) from None


def lacks_array(storage: Storage, file: str, mesh: str, array: str) -> UsageError:
    """Returns the error about an array that a result does not have."""
    return UsageError(f"{storage.url}/{file}: the result of {mesh} has no array {array!r}")


def torn(storage: Storage, file: str, mesh: str, reason: object) -> InputError:
    """Returns the error about a damaged result."""
    return InputError(f"{storage.url}/{file}: the result of {mesh} is torn ({reason}); write it again")


def missing(storage: Storage, file: str, mesh: str) -> FileError:
    """Returns the error about a file that is not there."""
    return FileError(f"{storage.url}/{file}: no such file, so there is no result of {mesh}; write it again")


class FolderReader:
    """Results in their folder, by their numbers."""

    def __init__(self, storage: LocalFolder, what: str) -> None:
        results = finished_results(storage.url, what)
        self._storage = storage
        self.groups = [1] * len(results)
        self.names = [result.name for result in results]
        self.formats = {result.marker["format"] for result in results}
        self._files = [os.path.relpath(result.path, storage.url) for result in results]

    def read(self, number: int, names: Iterable[str] | None) -> Arrays:
        """Returns arrays of a result."""
        return read_arrays(self._storage, self._files[number], self.names[number], names)
