"""What a store holds beside the samples: levels, metadata, and the key that says what it is made of."""

from __future__ import annotations

import hashlib
import json
import math
import os
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .._arguments import Whole3
from .._errors import FileError, UsageError
from .._lattice import Lattice, Source
from .._raymap import write_whole
from .._whole_file import file_errors
from .codecs import CHECKSUM_BYTES, NO_CHUNK, compressor, zarr_package

#: Units of length of OME-Zarr.
UNITS = (
    "angstrom attometer centimeter decimeter exameter femtometer foot gigameter hectometer inch kilometer megameter meter "
    "micrometer mile millimeter nanometer parsec petameter picometer terameter yard yoctometer yottameter zeptometer "
    "zettameter"
).split()

_MOST_SHARDS = 1 << 22
_LOCK = ".lock"
_LOG = ".outside"


class Level(NamedTuple):
    """A level of the pyramid."""

    lattice: Lattice
    band: float | None
    """Number of its samples at which distances are clamped; None = not clamped."""

    @property
    def outside(self) -> float:
        """Value of samples far outside, which files need not hold; NaN if there is none."""
        return math.nan if self.band is None else float(np.float32(self.band * self.lattice.spacing))


@dataclass(frozen=True)
class Store:
    """A store and how it is laid out. It can be pickled."""

    out: str
    levels: tuple[Level, ...]
    chunks: int
    shards: int
    inputs: dict[str, Any]
    """All that the samples depend on, in JSON's types."""

    @property
    def key(self) -> str:
        """Hash of the inputs."""
        return hashlib.sha256(json.dumps(self.inputs, sort_keys=True).encode()).hexdigest()

    @property
    def folder(self) -> Path:
        """Folder of the store."""
        return Path(self.out)

    @property
    def own_folder(self) -> Path:
        """Folder with the lock and the log. Readers of Zarr would warn of them in the folder of the store."""
        return self.folder / "0"

    def shard_names(self) -> Iterator[str]:
        """Yields the names of all shards, which are their paths."""
        for number, level in enumerate(self.levels):
            for place in np.ndindex(*self._shard_counts(level)):
                yield "/".join([str(number), "c", *map(str, place)])

    def shard_count(self) -> int:
        """Returns the number of all shards."""
        return sum(math.prod(self._shard_counts(level)) for level in self.levels)

    def _shard_counts(self, level: Level) -> Whole3:
        nz, ny, nx = (-(-count // self.shards) for count in reversed(level.lattice.dims))
        return nz, ny, nx

    def box(self, name: str) -> tuple[Level, Whole3, Whole3]:
        """Returns the level, the first sample (x, y, z) and the number of samples (nx, ny, nz) of a shard."""
        number, _, *place = name.split("/")
        level = self.levels[int(number)]
        x, y, z = (self.shards * int(k) for k in reversed(place))
        nx, ny, nz = (min(self.shards, count - low) for count, low in zip(level.lattice.dims, (x, y, z), strict=True))
        return level, (x, y, z), (nx, ny, nz)

    def zarr_files(self, is_complete: bool) -> dict[str, bytes]:
        """Returns the metadata, by path. That of the store itself comes first."""
        files: dict[str, Any] = {}
        zarr = zarr_package()
        memory = zarr.storage.MemoryStore(files)
        own = {"key": self.key, "complete": is_complete, "inside": "negative", **self.inputs}
        zarr.create_group(store=memory, zarr_format=3, attributes={"ome": self._ome(), "raymap": own})
        for number, level in enumerate(self.levels):
            _create_array(self, level, memory, str(number), tuple(reversed(level.lattice.dims)))
        return {name: content.to_bytes() for name, content in files.items()}

    def _ome(self) -> dict[str, Any]:
        unit = {"unit": self.inputs["unit"]} if self.inputs["unit"] else {}
        datasets = [
            {
                "path": str(number),
                "coordinateTransformations": [
                    {"type": "scale", "scale": [level.lattice.spacing] * 3},
                    {"type": "translation", "translation": list(reversed(level.lattice.origin))},
                ],
            }
            for number, level in enumerate(self.levels)
        ]
        axes = [{"name": name, "type": "space", **unit} for name in "zyx"]
        return {"version": "0.5", "multiscales": [{"name": "distance", "axes": axes, "datasets": datasets}]}


def make_store(
    out: Path, source: Source, levels: list[Level], chunks: int, shards: int, unit: str | None
) -> Store:
    """Returns how a store is laid out. Checks the sides of chunks and shards."""
    if shards % chunks != 0:
        raise UsageError(f"shards must be a multiple of chunks, {chunks}, not {shards}")
    if unit is not None and unit not in UNITS:
        raise UsageError(f"unit must be one of OME-Zarr's, such as meter or millimeter, not {unit!r}")
    lattice = levels[0].lattice
    inputs = {
        "mesh_sha256": source.sha256,
        "raymap": source.version,
        "sign": source.sign,
        "orientation": source.orientation,
        "band": levels[0].band,
        "samples": list(lattice.dims),
        "origin": list(lattice.origin),
        "spacing": lattice.spacing,
        "pyramid": len(levels) - 1,
        "chunks": chunks,
        "shards": shards,
        "unit": unit,
    }
    store = Store(str(out), tuple(levels), chunks, shards, inputs)
    if (count := store.shard_count()) > _MOST_SHARDS:
        raise UsageError(
            f"{' x '.join(map(str, lattice.dims))} samples make {count:,} shards, but a store holds at most "
            f"{_MOST_SHARDS:,}; use larger shards, a lower resolution or a smaller box"
        )
    return store


def _create_array(store: Store, level: Level, memory: Any, name: str, shape: tuple[int, ...]) -> None:
    """Writes the metadata of the array of a level."""
    zarr = zarr_package()
    zarr.create_array(
        store=memory,
        name=name,
        shape=shape,
        chunks=(store.chunks,) * 3,
        shards=(store.shards,) * 3,
        dtype=np.float32,
        fill_value=level.outside,
        compressors=compressor(),
        dimension_names=["z", "y", "x"],
    )


def is_finished(store: Store, overwrite: bool) -> bool:
    """Returns whether the folder holds this store, and all of it.

    Raises:
        UsageError: The folder holds something else, and is not to be overwritten. Only stores ever are.
    """
    folder, own = store.folder, store.own_folder
    earlier = read_attributes(store)
    if earlier is None:
        begun = (own, own / _LOCK)  # By a run that was killed before it wrote more
        if any(path not in begun and not path.name.startswith(".zarr.json.tmp") for path in folder.rglob("*")):
            raise UsageError(f"{folder} holds something else than a store; choose another folder")
        return False
    if earlier.get("key") == store.key:
        return bool(earlier.get("complete"))
    if not overwrite:
        differences = _differences(earlier, store.inputs)
        raise UsageError(
            f"{folder} holds another field ({differences}); choose another folder, or overwrite it with "
            "overwrite=True or --overwrite"
        )
    return False


def begin(store: Store) -> None:
    """Writes the metadata. Removes a store of something else."""
    earlier = read_attributes(store)
    if earlier is not None and earlier.get("key") != store.key:
        _clear(store)
    _write(store, store.zarr_files(is_complete=False))


def finish(store: Store) -> None:
    """Marks the store as complete."""
    _write(store, store.zarr_files(is_complete=True))


def _write(store: Store, files: dict[str, bytes]) -> None:
    for name, content in files.items():
        with file_errors():
            (store.folder / name).parent.mkdir(parents=True, exist_ok=True)
        write_whole(store.folder / name, content)


def read_attributes(store: Store) -> dict[str, Any] | None:
    """Returns what a store says of itself, {} for one that is not of raymap, or None if there is none."""
    try:
        found = json.loads((store.folder / "zarr.json").read_bytes())
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as error:
        raise FileError(f"{store.folder / 'zarr.json'}: cannot read: {error}") from error
    attributes = found.get("attributes", {}) if isinstance(found, dict) else {}
    own = attributes.get("raymap") if isinstance(attributes, dict) else None
    return own if isinstance(own, dict) else {}


def check_worker(store: Store, machine: str) -> None:
    """Raises an error if a worker does not see the store, or if another run has overwritten it."""
    found = read_attributes(store)
    if found is None:
        raise FileError(f"{store.folder}: {machine} sees no store there; all workers must reach it by the same path")
    if found.get("key") != store.key:
        raise FileError(f"{store.folder}: another run has overwritten the store")


def _differences(earlier: dict[str, Any], inputs: dict[str, Any]) -> str:
    if "key" not in earlier:
        return "not of raymap, or partly removed"
    names = {"mesh_sha256": "another mesh"}
    return "; ".join(
        names.get(name, f"{name} {earlier.get(name)} there, {value} now")
        for name, value in inputs.items()
        if earlier.get(name) != value
    )


def _clear(store: Store) -> None:
    """Removes all but the lock. A store that is partly removed belongs to nobody."""
    empty: dict[str, Any] = {}
    zarr = zarr_package()
    zarr.create_group(store=zarr.storage.MemoryStore(empty), zarr_format=3, attributes={"raymap": {}})
    _write(store, {name: content.to_bytes() for name, content in empty.items()})
    with file_errors():
        kept = {store.folder / "zarr.json", store.own_folder, store.own_folder / _LOCK}
        for path in {*store.folder.iterdir(), *store.own_folder.iterdir()} - kept:
            if path.is_dir():
                shutil.rmtree(path)
            else:
                path.unlink()


def _is_whole(store: Store, name: str) -> bool:
    """Returns whether the file of a shard exists. Checks by its index that it has the size that it was written with."""
    path = store.folder / name
    index_bytes = 16 * (store.shards // store.chunks) ** 3
    with file_errors():
        try:
            with open(path, "rb") as file:
                size = file.seek(0, os.SEEK_END)
                file.seek(max(0, size - index_bytes - CHECKSUM_BYTES))
                content = file.read(index_bytes)
        except FileNotFoundError:
            return False
    index = np.frombuffer(content[: len(content) // 16 * 16], "<u8").reshape(-1, 2)
    ends = index.sum(axis=1)[index[:, 0] != NO_CHUNK]
    if ends.max(initial=0) + index_bytes + CHECKSUM_BYTES != size or len(ends) == 0:
        raise FileError(f"{path}: not the whole shard that was written there; remove it, and run again")
    return True


class Finished:
    """Names of the shards that are finished. Those that lie wholly outside are no files, but lines of a log.

    A line that was cut off when a run was killed is no name, so that shard is made again.

    Raises:
        FileError: A file is not a whole shard. Runs leave none, so another program or a crash of the system did.
    """

    def __init__(self, store: Store) -> None:
        self._path = store.own_folder / _LOG
        with file_errors():
            text = self._path.read_text() if self._path.exists() else ""
            outside = {line.removesuffix("\n") for line in text.splitlines(keepends=True) if line.endswith("\n")}
        names = list(store.shard_names())
        self.outside = outside.intersection(names)
        self.left = [name for name in names if name not in self.outside and not _is_whole(store, name)]
        if text and not text.endswith("\n"):
            self._append("\n")

    def add(self, name: str, is_outside: bool) -> None:
        """Adds a shard."""
        if is_outside:
            self.outside.add(name)
            self._append(f"{name}\n")

    def _append(self, text: str) -> None:
        with file_errors(), open(self._path, "a", encoding="utf-8") as file:
            file.write(text)
