"""Turns the meshes that users have into ours: arrays, files, meshes of other packages."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

from ._arrays import POINTS_HINT, checked_arrays, to_numpy
from ._errors import InputError, UsageError
from ._mesh import Mesh, load_mesh, mesh_of_arrays


def to_mesh(mesh_or_vertices: Any, faces: Any = None, *, allow_empty: bool = False) -> Mesh:
    """Returns the mesh of any accepted argument. It may view given arrays, so it must not outlive the call.

    A file without faces is an error, unless ``allow_empty``.
    """
    given = mesh_or_vertices
    if faces is not None:
        vertices = to_numpy(given)
        if vertices.ndim == 0:
            raise UsageError(f"a mesh and faces: give the mesh alone; {POINTS_HINT}")
        return mesh_of_arrays(*checked_arrays(vertices, faces))
    if isinstance(given, Mesh):
        return given
    if isinstance(given, (str, os.PathLike)):
        return load_mesh(given, allow_empty=allow_empty)
    return mesh_of_arrays(*checked_arrays(*_arrays_of(given)))


def _arrays_of(mesh: Any) -> tuple[Any, Any]:
    """Returns vertices and faces of another package's mesh, which is told by what it has."""

    def has(*names: str) -> bool:
        return all(hasattr(mesh, name) for name in names)

    if has("graph", "geometry", "to_mesh"):  # trimesh.Scene
        mesh = mesh.to_mesh()
    if has("vertices", "faces"):  # trimesh.Trimesh
        return mesh.vertices, mesh.faces
    if has("vertices", "triangles"):  # open3d.geometry.TriangleMesh
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    if has("vertex", "triangle"):  # open3d.t.geometry.TriangleMesh
        return mesh.vertex["positions"].cpu().numpy(), mesh.triangle["indices"].cpu().numpy()
    if has("points", "cells", "cells_dict"):  # meshio.Mesh
        return mesh.points, _meshio_faces(mesh)
    if has("points", "is_all_triangles", "regular_faces"):  # pyvista.PolyData
        surface = mesh if mesh.is_all_triangles else mesh.triangulate()
        return surface.points, surface.regular_faces
    if has("points", "extract_surface"):  # other data sets of pyvista
        raise UsageError(f"no surface but {type(mesh).__name__}; give mesh.extract_surface()")
    if has("to_mesh", "distance", "spacing"):  # raymap.Field
        raise UsageError("a field where a mesh is wanted: give field.to_mesh()")
    if has("__dlpack__") or isinstance(mesh, (np.ndarray, list, tuple)):
        raise UsageError("vertices without faces: give raymap.Mesh(vertices, faces)")
    raise TypeError(
        f"no mesh: {type(mesh).__module__}.{type(mesh).__qualname__}; give a raymap.Mesh, vertices and faces, a path, "
        "or a mesh of trimesh, Open3D, meshio or PyVista"
    )


def _meshio_faces(mesh: Any) -> npt.NDArray[Any]:
    """Returns the triangles of all blocks, in order. Polygons become fans. Points and lines have no area."""
    faces: list[npt.NDArray[Any]] = []
    for block in mesh.cells:
        kind, corners = block.type, np.asarray(block.data)
        if kind in ("triangle", "quad", "polygon"):
            fan = [corners[:, [0, c, c + 1]] for c in range(1, corners.shape[1] - 1)]
            faces.append(np.stack(fan, axis=1).reshape(-1, 3))
        elif kind not in ("vertex", "line"):
            raise UsageError(f"cells of the type {kind!r} are not faces; give the triangles of the surface")
    if not faces:
        raise InputError("the mesh has no faces")
    return np.concatenate(faces)
