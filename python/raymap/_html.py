"""Objects as notebooks show them."""

from __future__ import annotations

import base64
import importlib
import os
import struct
import sys
import tempfile
import webbrowser
import zlib
from html import escape
from pathlib import Path

import numpy as np
import numpy.typing as npt


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


def describe(caption: str, rows: dict[str, str], alt: str, picture: npt.NDArray[np.uint8]) -> str:
    """Returns a table of texts beside a picture."""
    table = "".join(f"<tr><th style='text-align:left'>{name}</th><td>{text}</td></tr>" for name, text in rows.items())
    content = base64.b64encode(png(picture)).decode()
    return (
        "<div style='display:flex;gap:1em;align-items:flex-start'>"
        f"<img alt='{alt}' src='data:image/png;base64,{content}'>"
        f"<table><caption>{caption}</caption>{table}</table></div>"
    )


def in_notebook() -> bool:
    """Returns whether this runs in the kernel of a notebook. Nothing is imported to find out."""
    if (ipython := sys.modules.get("IPython")) is None:
        return False
    return hasattr(ipython.get_ipython(), "kernel")


def show(page: str, height: int) -> None:
    """Shows a page in the notebook's cell, or else in a browser."""
    if in_notebook():
        frame = f"<iframe srcdoc='{escape(page)}' sandbox='allow-scripts' style='width:100%;height:{height}px;border:0'></iframe>"
        importlib.import_module("IPython.display").display({"text/html": frame, "text/plain": "a page"}, raw=True)
        return
    descriptor, name = tempfile.mkstemp(".html", "raymap-")
    with os.fdopen(descriptor, "w", encoding="utf-8") as file:
        file.write(page)
    if not webbrowser.open(Path(name).as_uri()):
        print(f"no browser could be opened; the page is {name}")
