"""Fields straight to files."""

from __future__ import annotations

import os
from typing import Any

from . import _raymap
from ._arguments import to_path, to_text
from ._generate import FileFieldOptions, to_core, to_mesh
from ._options import check_names
from ._progress import reporting
from ._records import FileReport
from ._typing import Unpack


def generate_file(
    mesh: Any,
    path: str | os.PathLike[str],
    *,
    triangle: str | os.PathLike[str] | None = None,
    winding: str | os.PathLike[str] | None = None,
    confidence: str | os.PathLike[str] | None = None,
    grid_name: str = "",
    half: bool = False,
    full_inside: bool = False,
    **options: Unpack[FileFieldOptions],
) -> FileReport:
    """Writes the signed distance field of a mesh, negative inside, into a .nrrd, .npy, .vti, .vdb, .nvdb or .npz.

    The field need not fit into memory. Then it is made in pieces, which are written one after another: in slabs of planes
    as .nrrd, .npy or .vti; near the surface alone as .vdb or .nvdb with a ``band``. Pieces need exact distances, the sign
    ``"harmonic"`` and the CPU, without ``close_holes``, ``invert`` and ``thickness``. A sample of a piece has the distance
    of ``raymap.Surface.query`` at its position.

    The file appears whole or not at all. A call that was stopped leaves finished slabs in ``path`` + ``.part``, and the
    same call goes on from there.

    Args:
        mesh: A mesh or path as for ``raymap.generate``. Arrays: ``raymap.Mesh(vertices, faces)``.
        path: File to write. A .npz, .vti, .vdb or .nvdb also holds the other ``arrays``.
        triangle: File for the indices of the closest triangles.
        winding: File for the winding numbers.
        confidence: File for the confidence in the sign.
        grid_name: Name of the grid in a .vdb or .nvdb.
        half: Whether numbers take 16 bits, in a .npy, .npz, .vdb or .nvdb.
        full_inside: Whether only distances outside are clamped to the ``band``, in a .vdb or .nvdb.
        **options: Options of ``raymap.generate`` but ``sparse`` and ``normalize``. Errors are those of
            ``raymap.generate``, too.

    Returns:
        How the field was made, as ``"plan"``, and what that cost, as ``"stats"``.

    Raises:
        UsageError: A file cannot hold what is asked for.
        FileError: A file cannot be written, or the disk is too small for it.

    >>> report = raymap.generate_file("ball.ply", "ball.nrrd", resolution=32)
    >>> report["plan"]["form"], raymap.load_field("ball.nrrd").shape
    ('whole', (32, 32, 32))
    """
    check_names("generate_file", options, FileFieldOptions)
    files = _raymap.FieldFiles()
    files.distance, files.half, files.full_inside = to_path(path), bool(half), bool(full_inside)
    files.grid_name = to_text("grid_name", grid_name)
    for name, own in (("triangle", triangle), ("winding", winding), ("confidence", confidence)):
        if own is not None:
            setattr(files, name, to_path(own))
    core, grid, core_options = to_core(to_mesh(mesh, None, options), options)
    with reporting(options.get("progress")) as report:
        return _raymap.generate_file(core, grid, core_options, files, report)  # type: ignore[return-value]
