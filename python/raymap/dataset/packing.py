"""Data sets in few large files: tars as WebDataset reads them."""

from __future__ import annotations

import hashlib
import io
import json
import os
import re
import tarfile
from pathlib import Path
from typing import Any, NamedTuple

from .._errors import InputError, UsageError
from .._whole_file import only_writer
from .storage import Storage, file_for, storage_of
from .work import KINDS, read_marker

#: Name of the file that says what is in the shards.
INDEX = "index.json"


class Packed(NamedTuple):
    """Shards of a data set."""

    shards: int
    """Number of shards."""
    new: int
    """Number of shards that this call has written. The others were there."""
    meshes: list[str]
    """Names of the meshes whose results are in the shards, in their order."""


class Result(NamedTuple):
    """A finished result of a data set."""

    name: str
    path: Path
    marker: dict[str, Any]


def pack(folder: str | os.PathLike[str], out: str | os.PathLike[str], *, what: str = "field", samples: int = 1000) -> Packed:
    """Packs the results of ``raymap.dataset.generate`` into tars of many samples, as WebDataset reads them.

    Shard ``shard-000000.tar`` has the first results in the order of their names: for each ``KEY.npz`` (or its format)
    and its marker as ``KEY.json``. The key is the name of the mesh; what is no letter, digit, ``-`` or ``_`` in its last
    part is ``_``. The file ``index.json`` says where each sample lies, so ``raymap.torch.ResultDataset`` reads any of
    them at once.

    It may be stopped and run again: a second run writes the shards that are missing or have changed. The shards are the
    same, bit for bit, whenever they are written. Quarantined meshes are left out.

    Args:
        folder: Folder of the results.
        out: Folder of the shards, or its URL as fsspec knows it, such as ``s3://bucket/fields``.
        what: What is packed: ``"field"`` or ``"points"``.
        samples: Number of results in a shard.

    Raises:
        UsageError: There is no such result, results are of several options, or two have one key.
        InputError: A result has changed since it was finished.
        FileError: A file cannot be read or written, or a run writes into ``folder``.

    >>> summary = raymap.dataset.generate(["ball.ply", "tetrahedron.ply"], "fields", resolution=16)
    >>> raymap.dataset.pack("fields", "shards", samples=1).new
    2
    >>> raymap.dataset.pack("fields", "shards", samples=1).new
    0
    """
    if samples < 1:
        raise UsageError(f"samples must be at least 1, not {samples}")
    storage = storage_of(out)
    with only_writer(Path(folder)):
        results = finished_results(folder, what)
        keys = _keys(results)
        found = read_index(storage)
        old = [] if found is None else found["shards"]
        shards: list[dict[str, Any]] = []
        new = 0
        for first in range(0, len(results), samples):
            part = slice(first, first + samples)
            number = len(shards)
            identity = _identity(results[part], keys[part])
            kept = old[number] if number < len(old) and old[number]["identity"] == identity else None
            if kept is None or storage.size(kept["name"]) != kept["bytes"]:
                kept = _write_shard(storage, f"shard-{number:06d}.tar", results[part], keys[part], identity)
                new += 1
                _write_index(storage, [*shards, kept, *old[number + 1 :]], what)
            shards.append(kept)
        if new or shards != old:
            _write_index(storage, shards, what)
        for shard in old[len(shards) :]:
            storage.remove(shard["name"])
    return Packed(len(shards), new, [result.name for result in results])


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
        return {**marker["options"], "bounds": None}, marker["format"], marker["raymap"]

    for result in results:
        if kind(result.marker) != kind(results[0].marker):
            names = f"{results[0].name} and {result.name}"
            raise UsageError(f"{names} are results of different options; run the data set again, or remove the old ones")
        if not result.path.exists() or result.path.stat().st_size != result.marker["bytes"]:
            raise InputError(f"{result.path}: not as it was when it was finished; run the data set again")


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


def _identity(results: list[Result], keys: list[str]) -> str:
    content = [[key, result.name, result.marker["key"]] for key, result in zip(keys, results, strict=True)]
    return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def _write_shard(storage: Storage, name: str, results: list[Result], keys: list[str], identity: str) -> dict[str, Any]:
    """Writes a shard. Returns its entry of the index."""
    samples: list[dict[str, Any]] = []
    with file_for(storage, name) as path:
        with tarfile.open(path, "w", format=tarfile.PAX_FORMAT) as archive:
            for result, key in zip(results, keys, strict=True):
                content = result.path.read_bytes()
                start = _add(archive, f"{key}.{result.marker['format']}", content)
                _add(archive, f"{key}.json", json.dumps(result.marker, sort_keys=True).encode())
                samples.append({"name": result.name, "key": key, "start": start, "bytes": len(content)})
        size = path.stat().st_size
    return {"name": name, "identity": identity, "bytes": size, "format": results[0].marker["format"], "samples": samples}


def _add(archive: tarfile.TarFile, name: str, content: bytes) -> int:
    """Adds a file without a time or an owner. Returns where its content begins."""
    info = tarfile.TarInfo(name)
    info.size = len(content)
    archive.addfile(info, io.BytesIO(content))
    return archive.offset - -(-len(content) // tarfile.BLOCKSIZE) * tarfile.BLOCKSIZE


def read_index(storage: Storage) -> dict[str, Any] | None:
    """Returns what a folder of shards says of itself; None if it is none.

    Raises:
        InputError: It is torn, or of something else.
    """
    content = storage.read(INDEX)
    if content is None:
        return None
    try:
        index = json.loads(content)
    except ValueError:
        index = None
    if not isinstance(index, dict) or "shards" not in index:
        raise InputError(f"{storage.url}/{INDEX}: no index of shards; remove it, and pack again")
    return index


def _write_index(storage: Storage, shards: list[dict[str, Any]], what: str) -> None:
    text = json.dumps({"what": what, "shards": shards}, indent=1, sort_keys=True)
    storage.write(INDEX, f"{text}\n".encode())
