"""What the files of Zarr stores hold: compressed chunks, and the index of a shard."""

from __future__ import annotations

import importlib
from typing import IO, Any

import numpy as np
import numpy.typing as npt

from .._errors import UsageError

#: Offset and size, in an index, of a chunk that only has the fill value.
NO_CHUNK = 2**64 - 1

#: Number of bytes of a checksum.
CHECKSUM_BYTES = 4

_COMPRESSOR, _LEVEL = "zstd", 3


def zarr_package() -> Any:
    """Returns the package zarr."""
    try:
        zarr: Any = importlib.import_module("zarr")
    except ImportError:
        zarr = None
    if zarr is None or int(zarr.__version__.split(".")[0]) < 3:
        raise UsageError("this needs the package zarr 3 or later: pip install 'raymap[zarr]'")
    return zarr


def _package(name: str) -> Any:
    """Returns a package that zarr brings along."""
    try:
        return importlib.import_module(name)
    except ImportError:
        raise UsageError(f"this needs the package {name.replace('_', '-')}: pip install 'raymap[zarr]'") from None


def compressor() -> Any:
    """Returns the codec of zarr that does what `compressed` does."""
    return zarr_package().codecs.BloscCodec(cname=_COMPRESSOR, clevel=_LEVEL, shuffle="shuffle")


def compressed(chunk: npt.NDArray[Any]) -> bytes:
    """Returns the bytes of a chunk, which is contiguous.

    They are the same whenever they are made, unless the main thread calls this: Blosc then has threads of its own.
    """
    numcodecs = _package("numcodecs")  # What zarr itself calls
    return bytes(numcodecs.Blosc(cname=_COMPRESSOR, clevel=_LEVEL, shuffle=numcodecs.Blosc.SHUFFLE).encode(chunk))


def decompress(content: bytes, chunk: npt.NDArray[Any]) -> None:
    """Fills a chunk with what `compressed` made of one.

    Raises:
        ValueError: The bytes are none of such a chunk.
    """
    numcodecs = _package("numcodecs")
    try:
        numcodecs.Blosc().decode(content, chunk)
    except RuntimeError as error:
        raise ValueError(str(error)) from None


def with_checksum(content: bytes) -> bytes:
    """Returns bytes with their checksum, as zarr's codec crc32c appends it."""
    crc = _package("google_crc32c")  # What zarr itself calls
    return content + int(crc.value(content)).to_bytes(CHECKSUM_BYTES, "little")


def without_checksum(content: bytes) -> bytes:
    """Returns what `with_checksum` was given.

    Raises:
        ValueError: The checksum is that of something else.
    """
    inner = content[:-CHECKSUM_BYTES]
    if with_checksum(inner) != content:
        raise ValueError("its checksum is wrong")
    return inner


class ShardWriter:
    """Writes the file of a shard: chunks one after the other, and an index with the offset and the size of each."""

    def __init__(self, file: IO[bytes], counts: tuple[int, ...]) -> None:
        self._file, self._end = file, 0
        self._index = np.full((*counts, 2), NO_CHUNK, "<u8")

    def add(self, place: tuple[int, ...], content: bytes) -> None:
        """Writes the bytes of a chunk."""
        self._index[place] = self._end, len(content)
        self._end += self._file.write(content)

    def finish(self) -> None:
        """Writes the index. Chunks that were not added only have the fill value."""
        self._file.write(with_checksum(self._index.tobytes()))
