"""Runs one Python peer on one case and prints what it cost as one line of JSON, as the program `peers` does.

The case comes from `peers export`: NAME.vertices, NAME.triangles and the line it printed.
"""

import argparse
import json
import os
import pathlib
import re
import resource
import sys
import time


def usage():
    u = resource.getrusage(resource.RUSAGE_SELF)
    # Not ru_maxrss, which includes the peak of the parent process.
    peak = re.search(r"VmHWM:\s*(\d+)", pathlib.Path("/proc/self/status").read_text())
    return time.monotonic(), u.ru_utime + u.ru_stime, int(peak[1]) / 1024


def measured(run):
    """Returns what a function returns, and what it cost: seconds, seconds of CPU time, and megabytes at most."""
    pathlib.Path("/proc/self/clear_refs").write_text("5")  # Resets the peak.
    before = usage()
    values = run()
    after = usage()
    return values, {name: after[k] - before[k] for k, name in enumerate(("wall", "cpu", "megabytes"))}


def read_mesh(name):
    """Reads the files that `exportMesh` wrote."""
    import numpy as np

    vertices = np.fromfile(name + ".vertices", np.float64).reshape(-1, 3)
    return vertices, np.fromfile(name + ".triangles", np.uint32).reshape(-1, 3).astype(np.int64)


def sample_positions(case, dtype):
    """Returns the positions of all samples, x fastest; not part of any peer's time."""
    import numpy as np

    axes = [case["origin"][a] + case["spacing"] * np.arange(case["dims"][a]) for a in range(3)]
    z, y, x = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
    return np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(dtype)


def igl_signed_distance(vertices, triangles, case, threads):
    import igl

    samples = sample_positions(case, "float64")
    kind = igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    return lambda: igl.signed_distance(samples, vertices, triangles, kind)[0]


def igl_winding(vertices, triangles, case, threads):
    import igl

    samples = sample_positions(case, "float64")
    return lambda: igl.fast_winding_number(vertices, triangles, samples)


def open3d(vertices, triangles, case, threads):
    import numpy as np
    import open3d

    samples = open3d.core.Tensor(sample_positions(case, "float32"))
    vertices = open3d.core.Tensor(vertices.astype(np.float32))
    triangles = open3d.core.Tensor(triangles.astype(np.uint32))

    def run():
        scene = open3d.t.geometry.RaycastingScene(nthreads=threads)
        scene.add_triangles(vertices, triangles)
        return scene.compute_signed_distance(samples, nthreads=threads).numpy()

    return run


def mesh2sdf(vertices, triangles, case, threads):
    """Prepares mesh2sdf, whose grid is always a cube of size^3 samples, from -1 in steps of 2 / size."""
    import mesh2sdf.core
    import numpy as np

    nx, ny, nz = case["dims"]
    size = max(nx, ny, nz)
    scale = 2.0 / (size * case["spacing"])
    vertices = ((vertices - np.array(case["origin"])) * scale - 1.0).astype(np.float32)
    triangles = triangles.astype(np.int32)
    return lambda: (mesh2sdf.core.compute(vertices, triangles, size) / scale).transpose(2, 1, 0)[:nz, :ny, :nx]


METHODS = {f.__name__: f for f in (igl_signed_distance, igl_winding, open3d, mesh2sdf)}


def available(name):
    try:
        __import__({"open3d": "open3d", "mesh2sdf": "mesh2sdf"}.get(name, "igl"))
        return True
    except Exception:  # An installed wheel may still fail to load.
        return False


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("method", choices=[*METHODS, "list"])
    parser.add_argument("--mesh", help="NAME of the exported files")
    parser.add_argument("--case", type=json.loads, help="the line that `peers export` printed")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--output", help="where to write the samples as raw floats")
    arguments = parser.parse_args()
    if arguments.method == "list":
        print("\n".join(name for name in METHODS if available(name)))
        return
    os.environ["IGL_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = str(arguments.threads)

    import numpy as np

    vertices, triangles = read_mesh(arguments.mesh)
    run = METHODS[arguments.method](vertices, triangles, arguments.case, arguments.threads)
    values, cost = measured(run)
    if arguments.output:
        np.ascontiguousarray(values, np.float32).tofile(arguments.output)
    print(json.dumps({**arguments.case, **cost}))


if __name__ == "__main__":
    sys.exit(main())
