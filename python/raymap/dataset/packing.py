"""Data sets in few large files."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol, TypeAlias, get_args

from .._arguments import to_whole
from .._errors import InputError, UsageError
from .._whole_file import only_writer, remove_leftovers
from . import stacks, tars
from .results import Result, finished_results
from .stacks import Stacks
from .storage import LocalFolder, Storage, storage_of
from .tars import Tars

#: Formats of shards.
PackFormat: TypeAlias = Literal["tar", "zarr"]


class Packed(NamedTuple):
    """Shards of a data set."""

    shards: int
    """Number of shards."""
    new: int
    """Number of shards that this call has written. The others were there."""
    meshes: list[str]
    """Names of the meshes whose results are in the shards, in their order."""


class Shards(Protocol):
    """Shards of one format: files with some results each, and an index of all."""

    def prepare(self, found: dict[str, Any] | None) -> None:
        """Writes what is there before the first shard. Refuses an earlier index of shards that cannot stay."""
        ...

    def identity(self, results: list[Result]) -> str:
        """Returns the hash of all that a shard depends on."""
        ...

    def write(self, number: int, results: list[Result]) -> dict[str, Any]:
        """Writes a shard. Returns its entry of the index."""
        ...

    def files(self, shard: dict[str, Any]) -> dict[str, int]:
        """Returns the files of a shard and their sizes."""
        ...

    def index(self, shards: list[dict[str, Any]], is_complete: bool) -> dict[str, Any]:
        """Returns the index of shards."""
        ...

    def write_index(self, index: dict[str, Any]) -> None:
        """Writes the index."""
        ...


def pack(
    folder: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    what: str = "field",
    samples: int = 1000,
    format: PackFormat = "tar",
) -> Packed:
    """Packs the results of ``raymap.dataset.generate`` into shards of many samples: tars as WebDataset reads them, or Zarr.

    A tar, such as ``shard-000000.tar``, has results in the order of their names: for each ``KEY.npz`` (or its format)
    and its marker as ``KEY.json``. The key is the name of the mesh; what is no letter, digit, ``-`` or ``_`` in its last
    part is ``_``. The file ``index.json`` says where each sample lies, so ``raymap.torch.ResultDataset`` reads any of
    them at once.

    Zarr is a Zarr 3 group. Each array of the results, such as ``distance``, ``spacing`` or ``centre``, is one array there,
    with the mesh as its first axis: (meshes, nx, ny, nz). So all results must have arrays of the same shapes, as fields
    with ``cube=True`` or ``shape``. A chunk is one mesh; arrays of at most 256 bytes a mesh have a chunk for each shard.
    The attribute ``raymap`` holds the options, the version of raymap, the sign inside, the names of the meshes of each
    shard, and by ``complete`` whether all shards are there. What is not yet there reads as NaN, or 0 for whole numbers.

    It may be stopped and run again: a second run writes the shards that are missing or have changed. The shards are the
    same, bit for bit, whenever they are written and for any number of threads. A file appears whole or not at all.
    Quarantined meshes are left out.

    Args:
        folder: Folder of the results.
        out: Folder of the shards, or its URL as fsspec knows it, such as ``s3://bucket/fields``.
        what: What is packed: ``"field"`` or ``"points"``.
        samples: Number of results in a shard.
        format: Format of the shards: ``"tar"`` or ``"zarr"``, which needs the package zarr.

    Raises:
        UsageError: There is no such result, results are of several options, two have one key, their shapes differ, or
            ``out`` holds shards of another format, or Zarr arrays of other shapes.
        InputError: A result has changed since it was finished.
        FileError: A file cannot be read or written, or a run writes into ``folder``.

    >>> summary = raymap.dataset.generate(["ball.ply", "tetrahedron.ply"], "fields", resolution=16, cube=True)
    >>> raymap.dataset.pack("fields", "shards", samples=1).new
    2
    >>> raymap.dataset.pack("fields", "shards", samples=1).new
    0
    >>> raymap.dataset.pack("fields", "fields.zarr", format="zarr").shards
    1
    >>> import zarr
    >>> zarr.open_array("fields.zarr/distance", mode="r").shape
    (2, 16, 16, 16)
    """
    samples = to_whole("samples", samples, least=1)
    if format not in get_args(PackFormat):
        raise UsageError(f"format must be 'tar' or 'zarr', not {format!r}")
    storage = storage_of(out)
    with only_writer(Path(folder)):
        results = finished_results(folder, what)
        shards = Tars(storage, results, what) if format == "tar" else Stacks(storage, results, what, samples)
        found = _earlier(storage, format)
        shards.prepare(found)
        if isinstance(storage, LocalFolder):
            remove_leftovers(storage.url)
        parts = [results[first : first + samples] for first in range(0, len(results), samples)]
        entries, new = _write_shards(storage, shards, parts, found)
    return Packed(len(entries), new, [result.name for result in results])


def _write_shards(
    storage: Storage, shards: Shards, parts: list[list[Result]], found: dict[str, Any] | None
) -> tuple[list[dict[str, Any]], int]:
    """Writes the shards that are not there, and removes those of an earlier index that are left over.

    Returns the entries of the index, and the number of new ones.
    """
    old = [] if found is None else found["shards"]
    entries: list[dict[str, Any]] = []
    new = 0
    for number, part in enumerate(parts):
        identity = shards.identity(part)
        entry = old[number] if number < len(old) and old[number]["identity"] == identity else None
        if entry is None or any(storage.size(name) != size for name, size in shards.files(entry).items()):
            entry = {"identity": identity, **shards.write(number, part)}
            new += 1
            shards.write_index(shards.index([*entries, entry, *old[number + 1 :]], False))
        entries.append(entry)
    if new or shards.index(entries, True) != found:
        shards.write_index(shards.index(entries, True))
    for shard in old[len(entries) :]:
        for name in shards.files(shard):
            storage.remove(name)
    return entries, new


def _earlier(storage: Storage, format: PackFormat) -> dict[str, Any] | None:
    """Returns the index of shards that are there.

    Raises:
        UsageError: They have another format.
        InputError: It is torn, or of something else.
    """
    found = read_index(storage)
    if found is not None and found[0] != format:
        raise UsageError(f"{storage.url} holds shards of the format {found[0]}; choose another folder, or remove it")
    return None if found is None else found[1]


_INDICES: dict[PackFormat, tuple[str, Callable[[bytes], dict[str, Any]]]] = {
    "tar": (tars.INDEX, tars.parse_index),
    "zarr": (stacks.INDEX, stacks.parse_index),
}


def read_index(storage: Storage) -> tuple[PackFormat, dict[str, Any]] | None:
    """Returns the format of a folder of shards, and their index; None if there is none.

    Raises:
        InputError: It is torn, or of something else.
    """
    for format, (name, parse) in _INDICES.items():
        content = storage.read(name)
        if content is not None:
            try:
                return format, parse(content)
            except (ValueError, LookupError, TypeError, AttributeError):
                raise InputError(f"{storage.url}/{name}: no index of shards; remove it, and pack again") from None
    return None
