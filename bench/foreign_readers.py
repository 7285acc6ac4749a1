#!/usr/bin/env python3
"""Opens files of one field with programs of other people, and compares all samples.

    foreign_readers.py write MESH OUT [--resolution N] [--band B]
    foreign_readers.py read OUT

`write` needs the packages raymap and zarr. It makes the same field as a narrow band, a dense field and an OME-Zarr store,
writes it in all formats, and the samples and their lattice by NumPy alone, for the comparison. `read` takes the readers
that its Python has, and may run again with another Python, as Debian's for python3-openvdb. The packages of the others
are vtk, pynrrd, zarr, ome-zarr, ngff-zarr and warp-lang. nanovdb_convert (libnanovdb-tools) makes the .nvdb.

Prints a row for each reader and file: how many samples differ from those written, how far the lattice is off, in samples,
and what is said of the file. Fails if a sample differs."""

import argparse
import importlib.metadata
import json
import pathlib
import shutil
import subprocess
import sys

import numpy as np


def write(arguments):
    import raymap

    out = arguments.out
    out.mkdir()
    options = {"resolution": arguments.resolution, "band": arguments.band}
    band = raymap.generate(arguments.mesh, sparse=True, **options)
    field = band.to_dense()
    band.save(out / "band.vdb")
    for name in ("dense.vdb", "dense.vti", "dense.nrrd", "dense.npy"):
        field.save(out / name)
    raymap.zarr.generate(arguments.mesh, out / "store.zarr", pyramid=1, unit="millimeter", **options)
    subprocess.run(["nanovdb_convert", out / "band.vdb", out / "band.nvdb"], check=True)
    lattice = {"origin": list(field.origin), "spacing": field.spacing, "active": band.active_count}
    (out / "lattice.json").write_text(json.dumps(lattice))
    np.save(out / "expected.npy", np.ascontiguousarray(field.distance))


def openvdb(path, shape):
    import pyopenvdb

    grid = pyopenvdb.read(str(path), "distance")
    values = np.empty(shape, np.float32)
    grid.copyToArray(values)
    said = f"{grid.gridClass}, background {grid.background:.6g}, {grid.activeVoxelCount()} active"
    return values, grid.transform.indexToWorld((0, 0, 0)), grid.transform.voxelSize(), said


def vtk(path, shape):
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader

    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    values = vtk_to_numpy(image.GetPointData().GetArray("distance")).reshape(image.GetDimensions(), order="F")
    return values, image.GetOrigin(), image.GetSpacing(), "point data distance"


def nrrd(path, shape):
    import nrrd

    values, header = nrrd.read(str(path), index_order="F")
    return values, header["space origin"], np.diag(header["space directions"]), f"{header['encoding']}, {header['type']}"


def numpy(path, shape):
    return np.load(path), None, None, "no lattice"


def zarr(path, shape):
    import zarr

    group = zarr.open_group(path, mode="r")
    steps = group.attrs["ome"]["multiscales"][0]["datasets"][0]["coordinateTransformations"]
    scale, move = (step[step["type"]] for step in steps)
    array = group["0"]
    return array[:].T, move[::-1], scale[::-1], f"shards {array.shards}, chunks {array.chunks}"


def ome_zarr(path, shape):
    from ome_zarr.io import parse_url
    from ome_zarr.reader import Reader

    node = next(iter(Reader(parse_url(str(path)))()))
    steps = node.metadata["coordinateTransformations"][0]
    scale, move = (step[step["type"]] for step in steps)
    axes = ", ".join(f"{axis['name']} in {axis['unit']}" for axis in node.metadata["axes"])
    return np.asarray(node.data[0]).T, move[::-1], scale[::-1], f"{len(node.data)} levels; {axes}"


def ngff_zarr(path, shape):
    from ngff_zarr import from_ngff_zarr

    images = from_ngff_zarr(str(path), version="0.5", validate=True).images
    image = images[0]
    origin, spacing = ([each[name] for name in "xyz"] for each in (image.translation, image.scale))
    return np.asarray(image.data).T, origin, spacing, f"{len(images)} levels, validated; {image.axes_units}"


def warp(path, shape):
    import warp as wp

    with open(path, "rb") as file:
        volume = wp.Volume.load_from_nvdb(file, device="cpu")
    values = wp.zeros(shape, dtype=wp.float32, device="cpu")
    wp.launch(_warp_kernel(wp), shape, [volume.id], [values], device="cpu")
    info = volume.get_grid_info()
    return values.numpy(), info.translation, volume.get_voxel_size(), f"{volume.get_voxel_count()} voxels in leaves"


def _warp_kernel(wp):
    def look_up(volume: wp.uint64, values: wp.array3d(dtype=wp.float32)):
        i, j, k = wp.tid()
        values[i, j, k] = wp.volume_lookup_f(volume, i, j, k)

    return wp.Kernel(look_up)


READERS = [
    ("OpenVDB", "pyopenvdb", openvdb, ["band.vdb", "dense.vdb"]),
    ("VTK", "vtk", vtk, ["dense.vti"]),
    ("pynrrd", "nrrd", nrrd, ["dense.nrrd"]),
    ("NumPy", "numpy", numpy, ["dense.npy"]),
    ("zarr-python", "zarr", zarr, ["store.zarr"]),
    ("ome-zarr", "ome_zarr", ome_zarr, ["store.zarr"]),
    ("ngff-zarr", "ngff_zarr", ngff_zarr, ["store.zarr"]),
    ("Warp", "warp", warp, ["band.nvdb"]),
]
TOOLS = [["vdb_print", "-l", "band.vdb"], ["vdb_print", "-l", "dense.vdb"], ["nanovdb_validate", "-v", "band.nvdb"]]


def version_of(package):
    """Returns the version of a package, or None if this Python lacks it."""
    try:
        module = importlib.import_module(package)
    except ImportError:
        return None
    if package == "pyopenvdb":
        return ".".join(map(str, module.LIBRARY_VERSION))
    if package == "vtk":
        return module.vtkVersion.GetVTKVersion()
    return importlib.metadata.version({"nrrd": "pynrrd", "warp": "warp-lang"}.get(package, package.replace("_", "-")))


def compare(out, reader, name, expected, lattice):
    """Returns the number of samples that differ, and the rest of the row."""
    values, origin, spacing, said = reader(out / name, expected.shape)
    if values.shape != expected.shape:
        return expected.size, f"| shape {values.shape} | {said} |"
    wrong = int((values != expected).sum())
    if origin is None:
        return wrong, f"| | {said} |"
    ends = np.array([[0] * 3, np.array(expected.shape) - 1])
    found, true = np.array(origin) + np.array(spacing) * ends, np.array(lattice["origin"]) + lattice["spacing"] * ends
    return wrong, f"| {abs(found - true).max() / lattice['spacing']:.1e} | {said} |"


def read(arguments):
    out = arguments.out
    expected, lattice = np.load(out / "expected.npy"), json.loads((out / "lattice.json").read_text())
    print(f"{' x '.join(map(str, expected.shape))} samples, {lattice['active']} active\n")
    print("| reader | file | samples that differ | lattice off by, samples | what it says |\n|---|---|---|---|---|")
    all_wrong = 0
    for title, package, reader, names in READERS:
        if (version := version_of(package)) is None:
            print(f"{title} is not installed here", file=sys.stderr)
            continue
        for name in names:
            wrong, rest = compare(out, reader, name, expected, lattice)
            print(f"| {title} {version} | {name} | {wrong} {rest}", flush=True)
            all_wrong += wrong
    for command in TOOLS:
        if shutil.which(command[0]) is None:
            print(f"{command[0]} is not installed here", file=sys.stderr)
            continue
        told = subprocess.run(command, cwd=out, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        print(f"\n{' '.join(command)} ends with {told.returncode}:\n{told.stdout}", flush=True)
    return 1 if all_wrong else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(required=True)
    writing, reading = commands.add_parser("write"), commands.add_parser("read")
    writing.add_argument("mesh")
    for command in writing, reading:
        command.add_argument("out", type=pathlib.Path)
    writing.add_argument("--resolution", type=int, default=256)
    writing.add_argument("--band", type=float, default=3.0)
    writing.set_defaults(function=write)
    reading.set_defaults(function=read)
    arguments = parser.parse_args()
    return arguments.function(arguments)


if __name__ == "__main__":
    sys.exit(main())
