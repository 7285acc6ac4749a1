"""Files of which a mesh consists, and their hashes."""

from __future__ import annotations

import hashlib
import json
import os
import struct
from pathlib import Path
from urllib.parse import unquote_to_bytes

_JSON_CHUNK = 0x4E4F534A


def file_hash(path: str | os.PathLike[str]) -> str | None:
    """Returns the hash of a file's bytes, or None if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except (OSError, ValueError):
        return None  # The process that loads the mesh says why.


def buffer_hashes(mesh: str, most: int) -> dict[str, str | None]:
    """Returns hashes of the buffers of a .gltf or .glb that are files, by their names as it gives them.

    No other format refers to files with positions or faces. More than `most` bytes of JSON are not read: the process
    that loads the mesh must not take so many either.
    """
    if not mesh.lower().endswith((".gltf", ".glb")):
        return {}
    try:
        buffers = json.loads(_json(mesh, most))["buffers"]
        uris = {buffer["uri"] for buffer in buffers if "uri" in buffer and not buffer["uri"].startswith("data:")}
        return {uri: file_hash(Path(mesh).parent / os.fsdecode(unquote_to_bytes(uri))) for uri in sorted(uris)}
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError):
        return {}  # There are no buffers, or it is malformed: the process that loads the mesh says why.


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
