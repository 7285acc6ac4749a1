"""Peers of scripts/wild.py, by the names of their functions. Each gets its modules, which are imported before it is measured.

A field: of vertices, faces and a grid, the distances of its samples, z fastest, negative inside. NaN: not measured.
A repair: vertices and faces, and, where the package says so, which share of the area it lost. It raises what it refuses."""

import functools
import importlib
import shutil
import subprocess
import tempfile
import warnings

import numpy as np
from harness import positions
from speed import open3d_scene
from wild_meshes import welded

PEERS = {"fields": {}, "repairs": {}}


def peer(*modules, **variants):
    """Lists a function. `variants` are further peers: names, each with another value of the function's last parameter."""

    def add(function):
        kind, _, name = function.__name__.partition("_")
        for each, last in {name: [], **{other: [value] for other, value in variants.items()}}.items():
            PEERS[kind][each] = lambda last=last: functools.partial(call, function, [importlib.import_module(m) for m in modules], last)
        return function

    return add


def call(function, modules, last, vertices, faces, *grid):
    return function(*modules, vertices, faces, *grid, *last)


def samples(grid):
    return np.ascontiguousarray(positions(grid))


@peer("raymap")
def fields_raymap(raymap, vertices, faces, grid):
    warnings.simplefilter("ignore")
    made = raymap.generate(vertices, faces, shape=grid.shape, voxel_size=grid.spacing, origin=tuple(grid.origin), device="cpu")
    return made.distance.ravel()  # In the order of the indices, whatever the memory's.


@peer("igl")
def fields_libigl(igl, vertices, faces, grid):
    return igl.signed_distance(samples(grid), vertices, faces, igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER)[0]


@peer("open3d")
def fields_open3d(open3d, vertices, faces, grid):
    where = open3d.core.Tensor(samples(grid).astype(np.float32))
    return open3d_scene(vertices, faces).compute_signed_distance(where).numpy()


@peer("trimesh")
def fields_trimesh(trimesh, vertices, faces, grid, stride=64):
    where = samples(grid)
    values = np.full(len(where), np.nan)
    values[::stride] = -trimesh.proximity.signed_distance(trimesh.Trimesh(vertices, faces), where[::stride])
    return values


@peer("pysdf")
def fields_pysdf(pysdf, vertices, faces, grid):
    return -pysdf.SDF(vertices.astype(np.float32), faces.astype(np.uint32))(samples(grid).astype(np.float32))


@peer("mesh2sdf", mesh2sdf_fix=True)
def fields_mesh2sdf(mesh2sdf, vertices, faces, grid, fix=False):
    scale, size = 2 / (grid.shape[0] * grid.spacing), grid.shape[0]
    values = mesh2sdf.compute((vertices - grid.origin) * scale - 1, faces, size, fix=fix, level=2 / size)
    return (values + fix * 2 / size).ravel() / scale  # With `fix` the surface lies a level farther out.


@peer("point_cloud_utils")
def fields_point_cloud_utils(point_cloud_utils, vertices, faces, grid):
    return point_cloud_utils.signed_distance_to_mesh(samples(grid), vertices, faces)[0]


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


PEERS["fields"]["warp"] = fields_warp


@peer("meshlib.mrmeshnumpy", "meshlib.mrmeshpy", meshlib_winding="HoleWindingRule")
def fields_meshlib(mrmeshnumpy, mrmeshpy, vertices, faces, grid, mode=None):
    mesh, options = mrmeshnumpy.meshFromFacesVerts(faces, vertices), mrmeshpy.MeshToDistanceVolumeParams()
    options.vol.dimensions, options.vol.voxelSize = mrmeshpy.Vector3i(*grid.shape), mrmeshpy.Vector3f(*[grid.spacing] * 3)
    options.vol.origin = mrmeshpy.Vector3f(*(np.asarray(grid.origin) - grid.spacing / 2))  # Its samples are centres of cells.
    if mode:
        options.dist.signMode = getattr(mrmeshpy.SignDetectionMode, mode)
    return mrmeshnumpy.getNumpy3Darray(mrmeshpy.meshToDistanceVolume(mesh, options)).ravel()


@peer("trueform")
def fields_trueform(trueform, vertices, faces, grid):
    return trueform.signed_distance(trueform.Mesh(faces.astype(np.int32), vertices), samples(grid))


@peer("raymap")
def repairs_raymap(raymap, vertices, faces):
    with warnings.catch_warnings(record=True):
        warnings.simplefilter("always")
        solid, report = raymap.repair(vertices, faces, device="cpu")
    gone = any(report[key]["count"] for key in ("dropped", "filled", "buried"))
    return solid.vertices, solid.faces, 1.0 if gone else sum(report[share] for share in ("lost_share", "buried_share", "thickened_share"))


@peer("pymeshfix")
def repairs_pymeshfix(pymeshfix, vertices, faces):
    vertices, faces = welded(vertices[faces])
    made = pymeshfix.MeshFix(vertices, faces.astype(np.int32))
    made.repair()
    return made.points, made.faces, None


@peer("meshlib.mrmeshnumpy", "meshlib.mrmeshpy")
def repairs_meshlib(mrmeshnumpy, mrmeshpy, vertices, faces):
    mesh = mrmeshnumpy.meshFromFacesVerts(faces, vertices)
    mrmeshpy.uniteCloseVertices(mesh, 1e-6 * mesh.computeBoundingBox().diagonal())
    mrmeshpy.fillHoles(mesh, mesh.topology.findHoleRepresentiveEdges())
    mrmeshpy.fixMeshDegeneracies(mesh, mrmeshpy.FixMeshDegeneraciesParams())
    mesh.pack()
    return mrmeshnumpy.getNumpyVerts(mesh), mrmeshnumpy.getNumpyFaces(mesh.topology), None


@peer("meshlib.mrmeshnumpy", "meshlib.mrmeshpy")
def repairs_meshlib_rebuild(mrmeshnumpy, mrmeshpy, vertices, faces, samples=128):
    mesh, options = mrmeshnumpy.meshFromFacesVerts(faces, vertices), mrmeshpy.RebuildMeshSettings()
    options.voxelSize = float(np.ptp(vertices, axis=0).max() / samples)
    made = mrmeshpy.rebuildMesh(mrmeshpy.MeshPart(mesh), options)
    return mrmeshnumpy.getNumpyVerts(made), mrmeshnumpy.getNumpyFaces(made.topology), None


@peer("manifold3d")
def repairs_manifold3d(manifold3d, vertices, faces):
    mesh = manifold3d.Mesh64(vertices, faces.astype(np.uint64))
    mesh.merge()
    made = manifold3d.Manifold(mesh)
    if made.status() != manifold3d.Error.NoError:
        raise RuntimeError(str(made.status()))
    found = made.to_mesh64()
    return found.vert_properties[:, :3], found.tri_verts.astype(np.int64), None


@peer("trimesh")
def repairs_admesh(trimesh, vertices, faces):
    with tempfile.TemporaryDirectory() as folder:
        given, made = f"{folder}/given.stl", f"{folder}/made.stl"
        trimesh.Trimesh(vertices, faces, process=False).export(given)
        subprocess.run(["admesh", given, "-b", made], check=True, capture_output=True)
        mesh = trimesh.load(made, process=True)
        return np.asarray(mesh.vertices), np.asarray(mesh.faces), None


@peer("trimesh")
def repairs_trimesh(trimesh, vertices, faces):
    mesh = trimesh.Trimesh(vertices, faces, process=True, validate=True)
    trimesh.repair.fill_holes(mesh)
    trimesh.repair.fix_normals(mesh)
    return np.asarray(mesh.vertices), np.asarray(mesh.faces), None


@peer("trueform")
def repairs_trueform(trueform, vertices, faces):
    faces, vertices = trueform.cleaned((faces.astype(np.int32), vertices))
    made = trueform.outer_shell(trueform.Mesh(faces, vertices))
    return np.asarray(made.points), np.asarray(made.faces), None


def peers(kind):
    return {name: make for name, make in PEERS[kind].items() if name != "admesh" or shutil.which("admesh")}
