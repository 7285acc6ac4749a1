"""Shards of a data set that are those of Zarr arrays: one array for each of a result's, with the mesh as first axis."""

from __future__ import annotations

import hashlib
import json
import math
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from contextlib import ExitStack
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from .._errors import UsageError
from .._threads import get_threads
from ..zarr.codecs import (
    CHECKSUM_BYTES,
    NO_CHUNK,
    ShardWriter,
    compressed,
    compressor,
    decompress,
    with_checksum,
    without_checksum,
    zarr_package,
)
from .results import Arrays, Result, common_options, lacks_array, missing, read_arrays, torn
from .storage import LocalFolder, Storage, file_for

#: Name of the file with the metadata of the group, and the index of the shards.
INDEX = "zarr.json"

#: Arrays of at most so many bytes share a chunk with those of all results of their shard.
_SMALL = 256

_MOST_BYTES = 2**31 - 2**16  # Of a chunk, which Blosc compresses


class StackedArray:
    """An array of all results, and how it lies in files."""

    def __init__(self, name: str, dtype: str, shape: list[int], samples: int) -> None:
        self.name, self.dtype, self.shape, self.samples = name, np.dtype(dtype), tuple(shape), samples
        self.per_chunk = samples if self.dtype.itemsize * math.prod(shape) <= _SMALL else 1
        """Number of results in a chunk."""
        self.chunk_count = samples // self.per_chunk
        """Number of chunks in a shard."""
        self.fill_value = self.dtype.type(np.nan if self.dtype.kind == "f" else 0)
        """Value of what was not written."""

    def file(self, number: int) -> str:
        """Returns the name of the file of a shard."""
        return "/".join([self.name, "c", str(number), *("0" for _ in self.shape)])

    def empty_chunk(self) -> npt.NDArray[Any]:
        """Returns a chunk that only has the fill value."""
        return np.full((self.per_chunk, *self.shape), self.fill_value, self.dtype)

    def create(self, memory: Any, count: int) -> None:
        """Writes the metadata of the array of so many results."""
        zarr = zarr_package()
        is_grid = len(self.shape) == 3
        zarr.create_array(
            store=memory,
            name=self.name,
            shape=(count, *self.shape),
            chunks=(self.per_chunk, *self.shape),
            shards=(self.samples, *self.shape),
            dtype=self.dtype,
            fill_value=self.fill_value,
            compressors=[compressor(), zarr.codecs.Crc32cCodec()],
            dimension_names=["mesh", *("xyz" if is_grid else [None] * len(self.shape))],
        )


def _stacked_arrays(layout: dict[str, Any], samples: int) -> dict[str, StackedArray]:
    return {name: StackedArray(name, each["dtype"], each["shape"], samples) for name, each in layout.items()}


class Stacks:
    """Zarr arrays with a shard for some results each.

    Raises:
        UsageError: Results cannot be stacked, or a package is missing.
    """

    def __init__(self, storage: Storage, results: list[Result], what: str, samples: int) -> None:
        zarr_package()
        self._storage, self._results, self._what, self._samples = storage, results, what, samples
        first = results[0]
        if first.marker["format"] != "npz":
            raise UsageError(f"Zarr arrays are made of .npz, not of .{first.marker['format']}; pack tars")
        for result in results:  # Before any work, as it takes long to read all of them
            shape, other = (each.marker.get("field", {}).get("samples") for each in (first, result))
            if shape != other:
                raise _not_alike(first, f"distance {shape}", result, f"{other}")
        self._layout = _layout_of(first, _read(first))
        self._arrays = _stacked_arrays(self._layout, samples)

    def prepare(self, found: dict[str, Any] | None) -> None:
        """Writes the metadata of the arrays where they are not as they should be.

        Raises:
            UsageError: There are shards with other arrays.
        """
        if found is not None and (found["arrays"], found["samples"]) != (self._layout, self._samples):
            raise UsageError(
                f"{self._storage.url} holds shards of other arrays, or of {found['samples']} samples each, not "
                f"{self._samples}; choose another folder, or remove it"
            )
        files: dict[str, Any] = {}
        memory = zarr_package().storage.MemoryStore(files)
        for array in self._arrays.values():
            array.create(memory, len(self._results))
        for name, content in files.items():
            if name != INDEX and self._storage.read(name) != content.to_bytes():
                self._storage.write(name, content.to_bytes())

    def identity(self, results: list[Result]) -> str:
        """Returns the hash of all that a shard depends on."""
        content = [[result.name, result.marker["key"]] for result in results]
        return hashlib.sha256(json.dumps(content).encode()).hexdigest()

    def write(self, number: int, results: list[Result]) -> dict[str, Any]:
        """Writes a shard of each array. Returns their entry of the index."""
        with ExitStack() as opened:
            files = {
                name: opened.enter_context(file_for(self._storage, each.file(number)))
                for name, each in self._arrays.items()
            }
            with ExitStack() as written:
                shards = {
                    name: ShardWriter(written.enter_context(open(files[name], "wb")), (each.chunk_count,))
                    for name, each in self._arrays.items()
                }
                for name, chunk, content in self._chunks(results):
                    shards[name].add((chunk,), with_checksum(content))
                for shard in shards.values():
                    shard.finish()
            sizes = {each.file(number): files[name].stat().st_size for name, each in self._arrays.items()}
        return {"meshes": [result.name for result in results], "files": sizes}

    def _chunks(self, results: list[Result]) -> Iterator[tuple[str, int, bytes]]:
        """Yields the arrays and the numbers of chunks in a shard, and their bytes, in one order for any number of threads.

        The main thread compresses nothing: Blosc would use threads of its own there, which write blocks in any order.
        """
        shared = {name: each.empty_chunk() for name, each in self._arrays.items() if each.per_chunk > 1}
        threads = get_threads() or len(os.sched_getaffinity(0))
        with ThreadPoolExecutor(threads) as pool:
            for k, encoded in enumerate(_in_order(pool, self._encoded, results, 2 * threads)):
                for name, found in encoded.items():
                    if isinstance(found, bytes):
                        yield name, k, found
                    else:
                        shared[name][k] = found
            for name, chunk in shared.items():
                yield name, 0, pool.submit(compressed, chunk).result()

    def _encoded(self, result: Result) -> dict[str, Any]:
        """Returns the arrays of a result: those that share a chunk, and the bytes of the chunks of the others."""
        arrays = _read(result)
        if (layout := _layout_of(result, arrays)) != self._layout:
            name = next(name for name in {**self._layout, **layout} if layout.get(name) != self._layout.get(name))
            raise _not_alike(self._results[0], _shown(name, self._layout), result, _shown(name, layout))
        return {
            name: compressed(np.ascontiguousarray(array[None])) if self._arrays[name].per_chunk == 1 else array
            for name, array in arrays.items()
        }

    def files(self, shard: dict[str, Any]) -> dict[str, int]:
        """Returns the files of a shard and their sizes."""
        sizes: dict[str, int] = shard["files"]
        return sizes

    def index(self, shards: list[dict[str, Any]], is_complete: bool) -> dict[str, Any]:
        """Returns the index of shards."""
        options = common_options(self._results[0].marker)
        return {
            "what": self._what,
            "raymap": self._results[0].marker["raymap"],
            "inside": "positive" if options.get("invert") else "negative",
            "options": options,
            "complete": is_complete,
            "samples": self._samples,
            "arrays": self._layout,
            "shards": shards,
        }

    def write_index(self, index: dict[str, Any]) -> None:
        """Writes the index."""
        files: dict[str, Any] = {}
        zarr = zarr_package()
        zarr.create_group(store=zarr.storage.MemoryStore(files), zarr_format=3, attributes={"raymap": index})
        self._storage.write(INDEX, files[INDEX].to_bytes())


_Item = TypeVar("_Item")
_Made = TypeVar("_Made")


def _in_order(pool: Executor, function: Callable[[_Item], _Made], items: Iterable[_Item], ahead: int) -> Iterator[_Made]:
    """Yields the results of a function in the order of the items. Threads are at most so many items ahead."""
    pending: deque[Future[_Made]] = deque()
    for item in items:
        pending.append(pool.submit(function, item))
        if len(pending) > ahead:
            yield pending.popleft().result()
    for future in pending:
        yield future.result()


def _read(result: Result) -> Arrays:
    return read_arrays(LocalFolder(result.path.parent), result.path.name, result.name, None)


def _layout_of(result: Result, arrays: Arrays) -> dict[str, Any]:
    """Returns types and shapes of arrays, in JSON's types."""
    for name, array in arrays.items():
        if array.dtype.kind not in "biuf" or not 0 < array.nbytes <= _MOST_BYTES:
            what = f"{array.dtype} of the shape {array.shape}"
            raise UsageError(f"{result.path}: a Zarr array cannot hold {name}, {what}; leave it out, or pack tars")
    return {name: {"dtype": array.dtype.str, "shape": list(array.shape)} for name, array in arrays.items()}


def _shown(name: str, layout: dict[str, Any]) -> str:
    return f"{name} {layout[name]['shape']} {layout[name]['dtype']}" if name in layout else f"no {name}"


def _not_alike(one: Result, has: str, other: Result, other_has: str) -> UsageError:
    return UsageError(
        f"{one.name} has {has}, {other.name} has {other_has}: Zarr arrays stack results of one shape; make them with "
        "cube=True or shape, or pack tars"
    )


def parse_index(content: bytes) -> dict[str, Any]:
    """Returns an index of Zarr arrays.

    Raises:
        ValueError, LookupError, TypeError, AttributeError: It is none.
    """
    index: dict[str, Any] = json.loads(content)["attributes"]["raymap"]
    if index["samples"] < 1:
        raise ValueError(index["samples"])
    arrays = _stacked_arrays(index["arrays"], index["samples"]).values()
    for number, shard in enumerate(index["shards"]):
        if not (shard["identity"] and 0 < len(shard["meshes"]) <= index["samples"]):
            raise ValueError(number)
        if shard["files"].keys() != {array.file(number) for array in arrays} or min(shard["files"].values()) < 0:
            raise ValueError(number)
    return index


class StackReader:
    """Results in Zarr arrays, by their numbers. It reads the parts of files that it needs, without the package zarr."""

    def __init__(self, storage: Storage, index: dict[str, Any]) -> None:
        self._storage = storage
        self.formats = {"npz"}
        self._arrays = _stacked_arrays(index["arrays"], index["samples"])
        self._shards: list[dict[str, int]] = [shard["files"] for shard in index["shards"]]
        self.groups = [len(shard["meshes"]) for shard in index["shards"]]
        self.names: list[str] = [name for shard in index["shards"] for name in shard["meshes"]]
        self._places = [(number, k) for number, count in enumerate(self.groups) for k in range(count)]
        self._indices: dict[str, npt.NDArray[np.uint64]] = {}  # By file
        self._shared: dict[str, npt.NDArray[Any]] = {}  # Chunks of small arrays, by file

    def read(self, number: int, names: Iterable[str] | None) -> Arrays:
        """Returns arrays of a result."""
        shard, k = self._places[number]
        mesh, found = self.names[number], Arrays()
        for name in self._arrays if names is None else names:
            if name not in self._arrays:
                raise lacks_array(self._storage, INDEX, mesh, name)
            file = self._arrays[name].file(shard)
            try:
                found[name] = self._row(self._arrays[name], shard, k)
            except UsageError:
                raise  # A package is missing.
            except ValueError as error:
                raise torn(self._storage, file, mesh, error) from None
            except FileNotFoundError:
                raise missing(self._storage, file, mesh) from None
        return found

    def _row(self, array: StackedArray, shard: int, k: int) -> npt.NDArray[Any]:
        """Returns the array of a result. Errors are those of `_chunk`."""
        if array.per_chunk == 1:
            return np.asarray(self._chunk(array, shard, k)[0])
        file = array.file(shard)
        if file not in self._shared:
            self._shared[file] = self._chunk(array, shard, 0)
        return np.array(self._shared[file][k])

    def _chunk(self, array: StackedArray, shard: int, place: int) -> npt.NDArray[Any]:
        """Returns a chunk.

        Raises:
            ValueError: It is torn.
            FileNotFoundError: It is missing.
        """
        file = array.file(shard)
        if file not in self._indices:
            count = 16 * array.chunk_count + CHECKSUM_BYTES
            index = without_checksum(self._bytes(file, max(0, self._shards[shard][file] - count), count))
            self._indices[file] = np.frombuffer(index, "<u8").reshape(-1, 2)
        start, count = map(int, self._indices[file][place])
        chunk = array.empty_chunk()
        if start != NO_CHUNK:
            decompress(without_checksum(self._bytes(file, start, count)), chunk)
        return chunk

    def _bytes(self, file: str, start: int, count: int) -> bytes:
        content = self._storage.read(file, start, count)
        if content is None:
            raise FileNotFoundError
        return content

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_indices": {}, "_shared": {}}  # Workers read what they need.
