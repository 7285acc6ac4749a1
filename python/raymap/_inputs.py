"""Turns the meshes that users have into ours: arrays, files, meshes of other packages."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._arrays import still, to_numpy
from ._errors import InputError, UsageError
from ._faces import POINTS_HINT, checked_arrays, cut, unpadded
from ._mesh import Mesh, is_file, load_mesh, mesh_of_arrays


def to_mesh(mesh_or_vertices: Any, faces: Any = None, *, allow_empty: bool = False) -> Mesh:
    """Returns the mesh of any accepted argument. It may view given arrays, so it must not outlive the call.

    A file without faces is an error, unless ``allow_empty``.
    """
    given = mesh_or_vertices
    if faces is not None:
        vertices = to_numpy("vertices", still(given))
        if vertices.ndim == 0:
            raise UsageError(f"a mesh and faces: give the mesh alone; {POINTS_HINT}")
        return mesh_of_arrays(*checked_arrays(vertices, faces))
    if isinstance(given, Mesh):
        return given
    if isinstance(given, (str, bytes, os.PathLike)) or is_file(given):
        return load_mesh(given, allow_empty=allow_empty)
    return mesh_of_arrays(*checked_arrays(*_arrays_of(given)))


def _pair_of(given: Any) -> tuple[Any, Any] | None:
    """Returns vertices and faces of arrays that are given as one argument: a tuple of both, or triangles (n, 3, 3)."""
    shapes = [_shape_of(part) for part in given] if isinstance(given, (list, tuple)) and len(given) == 2 else []
    if len(shapes) == 2 and len(shapes[0]) == 2 and (isinstance(given, tuple) or shapes[0] != shapes[1]):
        return given[0], given[1]
    if len(_shape_of(given)) != 3:
        return None
    corners = to_numpy("triangles", still(given))
    if corners.shape[1:] != (3, 3):
        raise InputError(f"triangles must be (n, 3, 3) positions, not of the shape {corners.shape}")
    return corners.reshape(-1, 3), np.arange(3 * len(corners)).reshape(-1, 3)


def _shape_of(array: Any) -> tuple[int, ...]:
    """Returns the shape of an array; (0,) of ragged lists."""
    try:
        return tuple(np.shape(still(array)))
    except ValueError:
        return (0,)


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
    if has("points", "is_all_triangles", "strips"):  # pyvista.PolyData
        return mesh.points, _pyvista_faces(mesh)
    if has("points", "extract_surface"):  # other data sets of pyvista
        raise UsageError(f"no surface but {type(mesh).__name__}; give mesh.extract_surface()")
    if has("to_mesh", "distance", "spacing"):  # raymap.Field
        raise UsageError("a field where a mesh is wanted: give field.to_mesh()")
    if isinstance(mesh, Mapping) and {"vertices", "faces"} <= set(mesh):
        return mesh["vertices"], mesh["faces"]
    if has("__dlpack__") or isinstance(mesh, (np.ndarray, list, tuple)):
        if (pair := _pair_of(mesh)) is not None:
            return pair
        raise UsageError("vertices without faces: give raymap.Mesh(vertices, faces)")
    if has("generate", "signed_distance"):  # raymap.Surface
        raise UsageError("a surface where a mesh is wanted: give surface.mesh, or call surface.generate()")
    raise TypeError(
        f"no mesh: {type(mesh).__module__}.{type(mesh).__qualname__}; give a raymap.Mesh, vertices and faces, a path, "
        "an open file, or a mesh of trimesh, Open3D, meshio or PyVista"
    )


def _meshio_faces(mesh: Any) -> npt.NDArray[Any]:
    """Returns the triangles of all blocks, in order. Points and lines have no area."""
    blocks: list[npt.NDArray[Any]] = []
    for block in mesh.cells:
        if block.type in ("triangle", "quad", "polygon"):
            blocks.append(np.asarray(block.data))
        elif block.type not in ("vertex", "line"):
            raise UsageError(f"cells of the type {block.type!r} are not faces; give the triangles of the surface")
    if not blocks:
        raise InputError("the mesh has no faces")
    if all(corners.shape[1] == 3 for corners in blocks):
        return np.concatenate(blocks)
    sizes = np.concatenate([np.full(len(corners), corners.shape[1]) for corners in blocks])
    return cut(mesh.points, np.concatenate([corners.ravel() for corners in blocks]), sizes)


def _pyvista_faces(mesh: Any) -> npt.NDArray[Any]:
    """Returns the triangles of a surface's polygons, then those of its strips."""
    if mesh.is_all_triangles and len(mesh.strips) == 0:
        return np.asarray(mesh.regular_faces)
    strips = [strip[k : k + 3][:: 1 - k % 2 * 2] for strip in unpadded(mesh.strips, 1) for k in range(len(strip) - 2)]
    polygons = unpadded(mesh.faces, 1)
    corners = np.concatenate([*polygons, *strips, np.empty(0, int)])
    return cut(mesh.points, corners, np.array([len(face) for face in (*polygons, *strips)], int))
