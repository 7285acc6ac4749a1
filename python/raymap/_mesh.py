"""Triangle meshes."""

from __future__ import annotations

import os
from functools import cached_property
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from . import _raymap
from ._arguments import FINITE, to_number, to_path, to_whole
from ._errors import Error, UnsupportedError
from ._faces import checked_arrays

_Origin: TypeAlias = tuple[float, float, float] | None  # Of the library's own meshes, whose vertices are about it.


class Mesh:
    """A triangle mesh that never changes, whatever becomes of the arrays that it was made from: it copies them.

    Every function of this package that takes a mesh also takes arrays, the path of a file, and meshes of trimesh,
    Open3D, meshio and PyVista. What returns a mesh returns one of these. Other packages take its two arrays:
    ``trimesh.Trimesh(mesh.vertices, mesh.faces)``. They are read-only; copy them for what wants to write into them.

    Args:
        vertices: Positions, (n, 3), in any unit.
        faces: Three vertex numbers per triangle, (m, 3), counter-clockwise seen from outside.

    Raises:
        InputError: An array has another shape or type. Positions that are not finite and numbers out of range are
            found by the functions that use the mesh.

    >>> corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    >>> mesh = raymap.Mesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
    >>> mesh
    raymap.Mesh(4 vertices, 4 faces)
    >>> mesh.bounds
    array([[0., 0., 0.],
           [1., 1., 1.]])
    """

    def __init__(self, vertices: Any, faces: Any) -> None:
        positions, corners = checked_arrays(vertices, faces)
        self._set(_frozen(positions.copy()), _frozen(corners.copy()), None)

    def _set(self, vertices: npt.NDArray[Any], faces: npt.NDArray[Any], origin: _Origin) -> None:
        self._core = _raymap.Mesh(vertices, faces, origin or (0.0, 0.0, 0.0))
        self._vertices, self._faces, self._origin = _read_only(vertices), _read_only(faces), origin

    @cached_property
    def vertices(self) -> npt.NDArray[Any]:
        """Positions, (n, 3) float64 (float32 if it was made from such), read-only."""
        return self._vertices if self._origin is None else _frozen(self._vertices + np.array(self._origin))

    @property
    def faces(self) -> npt.NDArray[Any]:
        """Three vertex numbers per triangle, (m, 3) uint32 (uint64 if it was made from 64-bit numbers), read-only."""
        return self._faces

    @property
    def bounds(self) -> npt.NDArray[np.float64]:
        """Lowest and highest corner of the vertices that faces use, (2, 3).

        Raises:
            InputError: There is no face, a vertex number out of range, or a position that is not finite.
        """
        return np.array(self._core.bounds())

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes .ply (binary), .obj, .stl (binary), .glb or .3mf (in millimetres) by extension.

        The file appears whole or not at all. A warning (``RaymapWarning``) says if the single precision of a .stl moves
        vertices by more than 1e-5 of the mesh's size, as it does far from 0.

        Raises:
            UsageError: Another extension.
            InputError: The mesh is not valid.
            FileError: The file cannot be written.
        """
        self._core.save(to_path(path))

    def __repr__(self) -> str:
        return f"raymap.Mesh({len(self.vertices)} vertices, {len(self.faces)} faces)"

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (self._vertices, self._faces, self._origin)


def _read_only(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    view = array.view()
    view.flags.writeable = False
    return view


def _frozen(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Makes an array of our own read-only. Returns a view, whose users cannot undo that."""
    array.flags.writeable = False
    return array.view()


def core_of(mesh: Mesh) -> _raymap.Mesh:
    """Returns the mesh as the extension module takes it."""
    return mesh._core


def mesh_of_core(core: _raymap.Mesh) -> Mesh:
    """Returns the mesh that the extension module has made."""
    mesh = Mesh.__new__(Mesh)
    mesh._core, mesh._vertices, mesh._faces, mesh._origin = core, core.vertices(), core.faces(), core.origin
    return mesh


def mesh_of_arrays(vertices: npt.NDArray[Any], faces: npt.NDArray[Any], origin: _Origin = None) -> Mesh:
    """Makes a mesh that views arrays."""
    mesh = Mesh.__new__(Mesh)
    mesh._set(vertices, faces, origin)
    return mesh


def _unpickled(vertices: npt.NDArray[Any], faces: npt.NDArray[Any], origin: _Origin) -> Mesh:
    return mesh_of_arrays(_frozen(vertices.copy()), _frozen(faces.copy()), origin)  # They may view the pickle's buffers.


def tetrahedron(size: float = 1.0) -> Mesh:
    """Returns a mesh to try options and devices with."""
    corners = [(0, 0, 0), (size, 0, 0), (0, size, 0), (0, 0, size)]
    return Mesh(corners, [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


class Animation:
    """A mesh that moves: the skins and one animation of a glTF file. ``raymap.load_animation`` reads it."""

    def __init__(self, core: _raymap.Animation) -> None:
        self._core = core

    @property
    def duration(self) -> float:
        """Time at which the last motion ends, in seconds; 0 if the mesh stands still."""
        return self._core.duration

    def mesh(self, time: float) -> Mesh:
        """Returns the mesh at a time in seconds.

        It has the same faces at any time. Before 0 and after ``duration`` it keeps its first and its last pose.

        Raises:
            UsageError: The time is not finite.
        """
        return mesh_of_core(self._core.mesh(to_number("time", time, least=-FINITE, most=FINITE)))

    def __repr__(self) -> str:
        return f"raymap.Animation({self.duration:.6g} s)"


def load_animation(path: str | os.PathLike[str], index: int = 0) -> Animation:
    """Reads a glTF or GLB file with its skins and one of its animations.

    Morph targets move its vertices, too. The four joints of a vertex that have the largest weights are used. A file
    without any animation gives a mesh that stands still, and a warning (``RaymapWarning``).

    Args:
        path: File to read.
        index: Number of the animation in the file.

    Raises:
        UsageError: There is no such animation.
        FileError: The file cannot be read.
        InputError: Its content is not valid; the text names the element and the value.
        UnsupportedError: Another format.
    """
    return Animation(_raymap.load_animation(to_path(path), to_whole("index", index)))


def load_mesh(path: Any, *, allow_empty: bool = False) -> Mesh:
    """Reads OBJ, PLY, STL, OFF, glTF/GLB, 3MF, FBX or DAE by extension.

    Positions are those of the file, in its units (of a 3MF, in millimetres), with the transforms of its nodes. Polygons
    are cut into triangles; all meshes of the file are joined. Odd things in the file are warnings (``RaymapWarning``).

    Args:
        path: File to read, or one that is open, such as ``io.BytesIO``. The content tells the format of one without a name.
        allow_empty: Whether the mesh may have no faces.

    Raises:
        FileError: The file cannot be read.
        InputError: Its content is not valid; the text names the element and the value.
        UnsupportedError: The format is unknown.

    >>> mesh = raymap.load_mesh("tetrahedron.ply")
    >>> mesh.vertices.shape, mesh.faces.shape
    ((4, 3), (4, 3))
    """
    return _load_open(path, allow_empty) if is_file(path) else mesh_of_core(_raymap.load_mesh(to_path(path), allow_empty))


def is_file(given: Any) -> bool:
    """Returns whether this is an open file, or something like one."""
    return hasattr(given, "read") and hasattr(given, "seek")


def _load_open(file: Any, allow_empty: bool) -> Mesh:
    """Reads an open file from where it stands, by a copy of it: the library reads files by their names."""
    name = file.name if isinstance(getattr(file, "name", None), str) else ""
    content = file.read()
    content = content.encode() if isinstance(content, str) else bytes(content)
    extension = Path(name).suffix or _extension_of(content)
    if not extension:
        raise UnsupportedError("an open file without a name: its content is of no format of meshes that is known")
    with TemporaryDirectory(prefix="raymap-") as folder:
        copy = Path(folder, Path(name).name or f"mesh{extension}")
        copy.write_bytes(content)
        try:
            return mesh_of_core(_raymap.load_mesh(str(copy), allow_empty))
        except Error as error:
            raise type(error)(str(error).replace(str(copy), name or "the open file")) from None


def _extension_of(content: bytes) -> str:
    """Returns the extension of files that begin so; empty if they are unknown."""
    begins = {b"ply": ".ply", b"glTF": ".glb", b"PK": ".3mf", b"Kaydara FBX": ".fbx", b"; FBX": ".fbx", b"OFF": ".off",
              b"COFF": ".off", b"NOFF": ".off", b"{": ".gltf", b"solid": ".stl"}  # fmt: skip
    if len(content) >= 84 and len(content) == 84 + 50 * int.from_bytes(content[80:84], "little"):
        return ".stl"
    if found := next((extension for begin, extension in begins.items() if content.lstrip().startswith(begin)), ""):
        return found
    if content.lstrip().startswith(b"<") and b"<COLLADA" in content:
        return ".dae"
    return ".obj" if any(line.startswith(b"v ") for line in content.splitlines()) else ""
