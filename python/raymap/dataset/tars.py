"""Shards of a data set that are tars, as WebDataset reads them."""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import tarfile
from collections.abc import Iterable
from typing import Any

from .._errors import UsageError
from .results import Arrays, Result, arrays_of, missing, torn
from .storage import Storage, file_for

#: Name of the file that says what is in the tars.
INDEX = "index.json"


class Tars:
    """Tars of some results each."""

    def __init__(self, storage: Storage, results: list[Result], what: str) -> None:
        self._storage, self._what = storage, what
        self._keys = dict(zip([result.name for result in results], _keys(results), strict=True))

    def prepare(self, found: dict[str, Any] | None) -> None:
        """Does nothing: a tar needs no other file, and may take the place of any."""

    def identity(self, results: list[Result]) -> str:
        """Returns the hash of all that a shard depends on."""
        content = [[self._keys[result.name], result.name, result.marker["key"]] for result in results]
        return hashlib.sha256(json.dumps(content).encode()).hexdigest()

    def write(self, number: int, results: list[Result]) -> dict[str, Any]:
        """Writes a shard. Returns its entry of the index."""
        name, format = f"shard-{number:06d}.tar", results[0].marker["format"]
        samples: list[dict[str, Any]] = []
        with file_for(self._storage, name) as path:
            with tarfile.open(path, "w", format=tarfile.PAX_FORMAT) as archive:
                for result in results:
                    key, content = self._keys[result.name], result.path.read_bytes()
                    start = _add(archive, f"{key}.{format}", content)
                    _add(archive, f"{key}.json", json.dumps(result.marker, sort_keys=True).encode())
                    samples.append({"name": result.name, "key": key, "start": start, "bytes": len(content)})
            size = path.stat().st_size
        return {"name": name, "bytes": size, "format": format, "samples": samples}

    def files(self, shard: dict[str, Any]) -> dict[str, int]:
        """Returns the files of a shard and their sizes."""
        return {shard["name"]: shard["bytes"]}

    def index(self, shards: list[dict[str, Any]], is_complete: bool) -> dict[str, Any]:
        """Returns the index of shards."""
        return {"what": self._what, "shards": shards}

    def write_index(self, index: dict[str, Any]) -> None:
        """Writes the index."""
        self._storage.write(INDEX, f"{json.dumps(index, indent=1, sort_keys=True)}\n".encode())


def _keys(results: list[Result]) -> list[str]:
    """Returns names without the dots at which WebDataset ends a name."""
    names: dict[str, str] = {}
    for result in results:
        place, name = os.path.split(result.name)
        key = os.path.join(place, re.sub(r"[^\w-]", "_", name, flags=re.ASCII))
        if key in names:
            raise UsageError(f"{names[key]} and {result.name} would both be {key} in a shard; rename one of the meshes")
        names[key] = result.name
    return list(names)


def _add(archive: tarfile.TarFile, name: str, content: bytes) -> int:
    """Adds a file without a time or an owner. Returns where its content begins."""
    info = tarfile.TarInfo(name)
    info.size = len(content)
    archive.addfile(info, io.BytesIO(content))
    return archive.offset - -(-len(content) // tarfile.BLOCKSIZE) * tarfile.BLOCKSIZE


def parse_index(content: bytes) -> dict[str, Any]:
    """Returns an index of tars.

    Raises:
        ValueError, LookupError, TypeError, AttributeError: It is none.
    """
    index: dict[str, Any] = json.loads(content)
    for shard in index["shards"]:
        file, identity, format, end = (shard[name] for name in ("name", "identity", "format", "bytes"))
        ends = [sample["start"] + sample["bytes"] for sample in shard["samples"] if sample["name"] and sample["key"]]
        starts = [sample["start"] for sample in shard["samples"]]
        if not (file and identity and format and max(ends) <= end and min(starts) >= tarfile.BLOCKSIZE):
            raise ValueError(file)
    return index


class TarReader:
    """Results in tars, by their numbers."""

    def __init__(self, storage: Storage, index: dict[str, Any]) -> None:
        self._storage = storage
        self.groups = [len(shard["samples"]) for shard in index["shards"]]
        samples = [(shard, sample) for shard in index["shards"] for sample in shard["samples"]]
        self.names: list[str] = [sample["name"] for _, sample in samples]
        self.formats = {shard["format"] for shard in index["shards"]}
        self._places = [
            (shard["name"], f"{sample['key']}.{shard['format']}", sample["start"], sample["bytes"]) for shard, sample in samples
        ]

    def read(self, number: int, names: Iterable[str] | None) -> Arrays:
        """Returns arrays of a result."""
        (file, member, start, count), mesh = self._places[number], self.names[number]
        content = self._storage.read(file, start - tarfile.BLOCKSIZE, tarfile.BLOCKSIZE + count)
        if content is None:
            raise missing(self._storage, file, mesh)
        if not _is_header(content[: tarfile.BLOCKSIZE], member, count):
            raise torn(self._storage, file, mesh, f"{member} is not where {INDEX} says")
        return arrays_of(content[tarfile.BLOCKSIZE :], self._storage, file, mesh, names)


def _is_header(block: bytes, member: str, size: int) -> bool:
    """Returns whether a block of a tar is the header of a member. What is long or not ASCII of its name is in another."""
    try:
        header = tarfile.TarInfo.frombuf(block, "ascii", "replace")
    except tarfile.HeaderError:
        return False
    return header.size == size and header.name.encode("ascii", "replace") == member.encode("ascii", "replace")[:100]
