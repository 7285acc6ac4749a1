"""Turns what users have into what the extension module takes: meshes of other packages, arrays of other frameworks."""

from __future__ import annotations

import os
import sys
from typing import Any

import numpy as np
import numpy.typing as npt

from ._errors import InputError, UsageError
from ._mesh import Mesh, load_mesh


def to_mesh(mesh_or_vertices: Any, faces: Any = None) -> Mesh:
    """Returns the mesh of any accepted argument. Arrays with a suitable layout are not copied."""
    given = mesh_or_vertices
    if faces is not None:
        return Mesh(given, faces)
    if isinstance(given, Mesh):
        return given
    if isinstance(given, (str, os.PathLike)):
        return load_mesh(given)
    return Mesh(*_arrays_of(given))


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
    if has("__dlpack__") or isinstance(mesh, (np.ndarray, list, tuple)):
        raise UsageError("vertices without faces: give both, as in signed_distance(vertices, faces)")
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
            raise UsageError(f"cells of the type {kind!r} are no faces; give the triangles of the surface")
    if not faces:
        raise InputError("the mesh has no faces")
    return np.concatenate(faces)


def to_numpy(array: Any) -> npt.NDArray[Any]:
    """Returns any array as NumPy's, in host memory, without a copy where possible."""
    if isinstance(array, np.ndarray) or not hasattr(array, "__dlpack__"):
        return np.asarray(array)
    if hasattr(array, "detach"):  # PyTorch exports nothing that is part of a graph.
        array = array.detach()
    if hasattr(array, "cpu"):  # PyTorch and Open3D
        array = array.cpu()
    elif hasattr(array, "get"):  # CuPy
        array = array.get()
    if hasattr(array, "numpy"):
        return np.asarray(array.numpy())
    return np.asarray(array) if hasattr(array, "__array__") else np.from_dlpack(array)


def like(result: npt.NDArray[Any], example: Any) -> Any:
    """Returns the result in the framework of the example and on its device; as NumPy's array for anything else.

    PyTorch gets indices as int64: it indexes with no unsigned numbers.
    """
    if isinstance(example, np.ndarray) or not hasattr(example, "__dlpack__"):
        return result
    torch: Any = sys.modules.get("torch")
    if torch is not None and isinstance(example, torch.Tensor):
        return torch.from_numpy(result.astype(np.int64) if result.dtype == np.uint32 else result).to(example.device)
    if hasattr(example, "__array_namespace__"):
        return example.__array_namespace__().asarray(result, device=example.device)
    return result


def checked_arrays(vertices: Any, faces: Any) -> tuple[npt.NDArray[Any], npt.NDArray[Any]]:
    """Returns vertices as float32 or float64 and faces as uint32 or uint64, laid out as the extension reads them."""
    positions, corners = to_numpy(vertices), to_numpy(faces)
    _check_rows("vertices", "positions", positions)
    _check_rows("faces", "vertex numbers", corners)
    if positions.dtype not in (np.float32, np.float64) or not positions.dtype.isnative:
        if positions.dtype.kind not in "fiub":
            raise InputError(f"vertices must be numbers, not {positions.dtype}")
        positions = positions.astype(np.float64)
    if corners.dtype.kind not in "iu":
        raise InputError(f"faces must be whole numbers, not {corners.dtype}")
    if corners.dtype.kind == "i" and corners.size > 0 and corners.min() < 0:
        face = int(np.argmax((corners < 0).any(axis=1)))
        raise InputError(f"face {face} has a negative vertex number: {corners[face].tolist()}")
    size = 8 if corners.dtype.itemsize == 8 else 4
    if corners.dtype.itemsize == size and corners.dtype.isnative:
        corners = corners.view(f"u{size}")
    else:
        corners = corners.astype(f"u{size}")
    return _with_whole_rows(positions), _with_whole_rows(corners)


def _check_rows(name: str, content: str, array: npt.NDArray[Any]) -> None:
    if array.ndim != 2 or array.shape[1] != 3:
        raise InputError(f"{name} must be (n, 3) {content}, not of the shape {array.shape}")


def _with_whole_rows(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Returns an array whose rows ascend in memory without overlap, and have no gaps in them. Copies if need be."""
    item = array.dtype.itemsize
    if array.strides[1] == item and array.strides[0] >= 3 * item and array.strides[0] % item == 0:
        return array
    return np.ascontiguousarray(array)


def to_points(points: Any, *, keep_single: bool = False) -> npt.NDArray[Any]:
    """Returns points of any shape (..., 3) as (n, 3) float64, or on request float32 as float32."""
    array = to_numpy(points)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise InputError(f"points must be (..., 3) coordinates, not of the shape {array.shape}")
    if array.dtype.kind not in "fiub":
        raise InputError(f"points must be numbers, not {array.dtype}")
    dtype = np.float32 if keep_single and array.dtype == np.float32 else np.float64
    return np.ascontiguousarray(array.reshape(-1, 3), dtype=dtype)
