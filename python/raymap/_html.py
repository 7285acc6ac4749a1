"""Fields as notebooks show them."""

from __future__ import annotations

import base64
import struct
import zlib
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from ._field import Field


def png(picture: npt.NDArray[np.uint8]) -> bytes:
    """Returns a picture (h, w, 3) as a PNG file."""
    height, width, _ = picture.shape

    def chunk(name: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    rows = np.zeros((height, 1 + 3 * width), np.uint8)  # Each row begins with its filter, 0.
    rows[:, 1:] = picture.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows.tobytes())) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def describe(field: Field) -> str:
    """Returns a table of the field's figures beside its middle slice across z."""
    rows: dict[str, Any] = {
        "samples": " × ".join(str(n) for n in field.shape),
        "spacing": f"{field.spacing:.6g}",
        "origin": ", ".join(f"{v:.6g}" for v in field.origin),
        "arrays": ", ".join(field.arrays),
    }
    if "distance" in field.arrays:
        rows["distance"] = f"{field.distance.min():.6g} to {field.distance.max():.6g}, negative inside"
    if field.band > 0:
        rows["band"] = f"{field.band:.6g}"
    if field.stats.device:
        rows["made"] = f"in {field.stats.milliseconds:.0f} ms on {field.stats.device}"
    table = "".join(f"<tr><th style='text-align:left'>{name}</th><td>{text}</td></tr>" for name, text in rows.items())
    shown: Any = field.arrays[0]
    picture = base64.b64encode(png(field.slice("z", array=shown, width=256))).decode()
    return (
        "<div style='display:flex;gap:1em;align-items:flex-start'>"
        f"<img alt='slice across z' src='data:image/png;base64,{picture}'>"
        f"<table><caption>raymap.Field</caption>{table}</table></div>"
    )
