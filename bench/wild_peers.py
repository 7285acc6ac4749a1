"""Peers of scripts/wild.py. Each function imports a package, and returns a function that makes fields or repairs meshes.

A field: of vertices, faces and the grid's samples, z fastest, distances that are negative inside. NaN: not measured.
A repair: vertices and faces, and, where the package says so, which share of the area it lost. It raises what it refuses."""

import os
import subprocess
import tempfile
import warnings

import numpy as np
from harness import positions
from wild_meshes import welded


def samples(grid):
    return np.ascontiguousarray(positions(grid))


def fields_raymap():
    import raymap

    def run(vertices, faces, grid):
        warnings.simplefilter("ignore")
        made = raymap.generate(vertices, faces, shape=grid.shape, voxel_size=grid.spacing, origin=tuple(grid.origin), device="cpu")
        return made.distance.ravel()  # In the order of the indices, whatever the memory's.

    return run


def fields_libigl():
    import igl

    kind = igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    return lambda vertices, faces, grid: igl.signed_distance(samples(grid), vertices, faces, kind)[0]


def fields_open3d():
    import open3d
    from speed import open3d_scene

    def run(vertices, faces, grid):
        where = open3d.core.Tensor(samples(grid).astype(np.float32))
        return open3d_scene(vertices, faces).compute_signed_distance(where).numpy()

    return run


def fields_trimesh(stride=64):
    import trimesh

    def run(vertices, faces, grid):
        where = samples(grid)
        values = np.full(len(where), np.nan)
        values[::stride] = -trimesh.proximity.signed_distance(trimesh.Trimesh(vertices, faces), where[::stride])
        return values

    return run


def fields_pysdf():
    import pysdf

    def run(vertices, faces, grid):
        return -pysdf.SDF(vertices.astype(np.float32), faces.astype(np.uint32))(samples(grid).astype(np.float32))

    return run


def fields_mesh2sdf(fix=False):
    import mesh2sdf

    def run(vertices, faces, grid):
        scale, size = 2 / (grid.shape[0] * grid.spacing), grid.shape[0]
        values = mesh2sdf.compute((vertices - grid.origin) * scale - 1, faces, size, fix=fix, level=2 / size)
        return (values + fix * 2 / size).ravel() / scale  # With `fix` the surface lies a level farther out.

    return run


def fields_mesh2sdf_fix():
    return fields_mesh2sdf(True)


def fields_point_cloud_utils():
    import point_cloud_utils

    return lambda vertices, faces, grid: point_cloud_utils.signed_distance_to_mesh(samples(grid), vertices, faces)[0]


def fields_warp():
    import warp as wp

    wp.config.quiet = True

    @wp.kernel
    def measure(mesh: wp.uint64, where: wp.array(dtype=wp.vec3), far: float, values: wp.array(dtype=float)):
        k = wp.tid()
        found = wp.mesh_query_point_sign_winding_number(mesh, where[k], far)
        nearest = wp.mesh_eval_position(mesh, found.face, found.u, found.v)
        values[k] = found.sign * wp.length(where[k] - nearest)

    wp.load_module(device="cpu")

    def run(vertices, faces, grid):
        arrays = wp.array(vertices, dtype=wp.vec3, device="cpu"), wp.array(faces.ravel(), dtype=int, device="cpu")
        mesh, where = wp.Mesh(*arrays, support_winding_number=True), wp.array(samples(grid), dtype=wp.vec3, device="cpu")
        values = wp.empty(len(where), dtype=float, device="cpu")
        wp.launch(measure, len(where), [mesh.id, where, 1e6, values], device="cpu")
        return values.numpy()

    return run


def fields_meshlib(mode=None):
    from meshlib import mrmeshnumpy, mrmeshpy

    def run(vertices, faces, grid):
        mesh, options = mrmeshnumpy.meshFromFacesVerts(faces, vertices), mrmeshpy.MeshToDistanceVolumeParams()
        options.vol.dimensions = mrmeshpy.Vector3i(*grid.shape)
        options.vol.voxelSize = mrmeshpy.Vector3f(*[grid.spacing] * 3)
        options.vol.origin = mrmeshpy.Vector3f(*(np.asarray(grid.origin) - grid.spacing / 2))  # Its samples are centres of cells.
        if mode:
            options.dist.signMode = getattr(mrmeshpy.SignDetectionMode, mode)
        made = mrmeshpy.meshToDistanceVolume(mesh, options)
        return mrmeshnumpy.getNumpy3Darray(made).ravel()

    return run


def fields_meshlib_winding():
    return fields_meshlib("HoleWindingRule")


def fields_trueform():
    import trueform

    def run(vertices, faces, grid):
        return trueform.signed_distance(trueform.Mesh(faces.astype(np.int32), vertices), samples(grid))

    return run


# Repairs.


def repairs_raymap():
    import raymap

    def run(vertices, faces):
        with warnings.catch_warnings(record=True):
            warnings.simplefilter("always")
            solid, report = raymap.repair(vertices, faces, device="cpu")
        said = report["lost_share"] + report["buried_share"]
        gone = report["dropped"]["count"] + report["filled"]["count"] + report["buried"]["count"]
        return solid.vertices, solid.faces, 1.0 if gone else said

    return run


def repairs_pymeshfix():
    import pymeshfix

    def run(vertices, faces):
        vertices, faces = welded(vertices[faces])
        made = pymeshfix.MeshFix(vertices, faces.astype(np.int32))
        made.repair()
        return made.points, made.faces, None

    return run


def repairs_meshlib():
    from meshlib import mrmeshnumpy, mrmeshpy

    def run(vertices, faces):
        mesh = mrmeshnumpy.meshFromFacesVerts(faces, vertices)
        mrmeshpy.uniteCloseVertices(mesh, 1e-6 * mesh.computeBoundingBox().diagonal())
        mrmeshpy.fillHoles(mesh, mesh.topology.findHoleRepresentiveEdges())
        mrmeshpy.fixMeshDegeneracies(mesh, mrmeshpy.FixMeshDegeneraciesParams())
        mesh.pack()
        return mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology), None

    return run


def repairs_meshlib_rebuild():
    from meshlib import mrmeshnumpy, mrmeshpy

    def run(vertices, faces, samples=128):
        mesh, options = mrmeshnumpy.meshFromFacesVerts(faces, vertices), mrmeshpy.RebuildMeshSettings()
        options.voxelSize = float(np.ptp(vertices, axis=0).max() / samples)
        made = mrmeshpy.rebuildMesh(mrmeshpy.MeshPart(mesh), options)
        return mrmeshnumpy.getNumpyVerts(made), mrmeshnumpy.getNumpyFaces(made.topology), None

    return run


def repairs_manifold3d():
    import manifold3d

    def run(vertices, faces):
        mesh = manifold3d.Mesh64(vertices, faces.astype(np.uint64))
        mesh.merge()
        made = manifold3d.Manifold(mesh)
        if made.status() != manifold3d.Error.NoError:
            raise RuntimeError(str(made.status()))
        found = made.to_mesh64()
        return found.vert_properties[:, :3], found.tri_verts.astype(np.int64), None

    return run


def repairs_admesh():
    import trimesh

    subprocess.run(["admesh", "--version"], check=True, capture_output=True)

    def run(vertices, faces):
        with tempfile.TemporaryDirectory() as folder:
            given, made = (os.path.join(folder, name) for name in ("given.stl", "made.stl"))
            trimesh.Trimesh(vertices, faces, process=False).export(given)
            subprocess.run(["admesh", given, "-b", made], check=True, capture_output=True)
            mesh = trimesh.load(made, process=True)
            return np.asarray(mesh.vertices), np.asarray(mesh.faces), None

    return run


def repairs_trimesh():
    import trimesh

    def run(vertices, faces):
        mesh = trimesh.Trimesh(vertices, faces, process=True, validate=True)
        trimesh.repair.fill_holes(mesh)
        trimesh.repair.fix_normals(mesh)
        return np.asarray(mesh.vertices), np.asarray(mesh.faces), None

    return run


def repairs_trueform():
    import trueform

    def run(vertices, faces):
        faces, vertices = trueform.cleaned((faces.astype(np.int32), vertices))
        made = trueform.outer_shell(trueform.Mesh(faces, vertices))
        return np.asarray(made.points), np.asarray(made.faces), None

    return run


def peers(kind):
    """Returns the functions whose names begin with the kind, by the peer's name."""
    return {name.removeprefix(kind + "_"): f for name, f in globals().items() if name.startswith(kind + "_")}
