"""Files that make up a mesh, their names and their hashes."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import struct
from pathlib import Path
from urllib.parse import unquote_to_bytes

_JSON_CHUNK = 0x4E4F534A
_UNPRINTABLE = "[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]"
_NO_FILE = {errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.ENAMETOOLONG, errno.ELOOP}


def readable(path: str | os.PathLike[str]) -> str:
    """Returns a path as text. Bytes that are not UTF-8 become \\xe9, as in the library's messages."""
    return os.fsencode(path).decode(errors="backslashreplace")


def printable(text: str) -> str:
    """Returns a text in which characters that command a terminal or turn the direction of text are escaped: \\x1b."""

    def escaped(found: re.Match[str]) -> str:
        code = ord(found[0])
        return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}"

    return re.sub(_UNPRINTABLE, escaped, text)


def file_hash(path: str | os.PathLike[str]) -> str:
    """Returns the hash of a file's bytes.

    Raises:
        OSError: The file cannot be read.
    """
    with open(path, "rb") as file:
        found = hashlib.sha256()
        while part := file.read(1 << 18):
            found.update(part)
        return found.hexdigest()


def buffer_hashes(mesh: str, most: int) -> dict[str, str | None]:
    """Returns hashes of the buffers of a .gltf or .glb that are files, by their names as it gives them.

    The hash of a file that does not exist, or that the library refuses to read, is None. No other format refers to files
    with positions or faces. More than `most` bytes of JSON are not read: the process that loads the mesh must not take
    so many either.

    Raises:
        OSError: A file cannot be read.
    """
    if not mesh.lower().endswith((".gltf", ".glb")):
        return {}
    try:
        buffers = json.loads(_json(mesh, most))["buffers"]
        uris = {buffer["uri"] for buffer in buffers if "uri" in buffer and not buffer["uri"].startswith("data:")}
        folder = Path(mesh).parent
        return {uri: _buffer_hash(folder, os.fsdecode(unquote_to_bytes(uri))) for uri in sorted(uris)}
    except (ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return {}  # There are no buffers, or it is malformed: the process that loads the mesh says why.


def _buffer_hash(folder: Path, name: str) -> str | None:
    try:
        path = (folder / name).resolve()
        return file_hash(path) if path.is_relative_to(folder.resolve()) and path.is_file() else None
    except (OSError, ValueError) as error:
        if isinstance(error, OSError) and error.errno not in _NO_FILE:
            raise
        return None  # The process that loads the mesh says why.


def _json(path: str, most: int) -> bytes:
    with open(path, "rb") as file:
        if file.read(4) != b"glTF":
            file.seek(0)
            return file.read(most)
        file.seek(12)
        while len(header := file.read(8)) == 8:
            length, kind = struct.unpack("<II", header)
            if kind == _JSON_CHUNK:
                return file.read(min(length, most))
            file.seek(length, os.SEEK_CUR)
    return b""
