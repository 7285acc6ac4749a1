"""NumPy sees array[i, j, k] of every .npy and .npz without a copy, and Raymap reads what NumPy writes.

numpy_test.py RAYMAP; exits with 77 where NumPy is missing.
numpy_test.py RAYMAP --large: with arrays above 4 GiB. Exits with 77 unless RAYMAP_LARGE_FILES is set, for it takes 5 GiB of
memory and 9 GiB of disk."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit(77)

BOX = """v 0 0 0
v 3 0 0
v 0 2 0
v 3 2 0
v 0 0 1
v 3 0 1
v 0 2 1
v 3 2 1
f 1 3 4 2
f 5 6 8 7
f 1 2 6 5
f 3 7 8 4
f 1 5 7 3
f 2 4 8 6
"""


def box_distance(p):
    """Signed distance to the box above, for positions in the last axis."""
    centre, half = np.array([1.5, 1.0, 0.5]), np.array([1.5, 1.0, 0.5])
    q = np.abs(p - centre) - half
    return np.linalg.norm(np.maximum(q, 0), axis=-1) + np.minimum(q.max(axis=-1), 0)


def run(*arguments):
    subprocess.run([sys.argv[1], *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def exchange_a_large_field():
    """A field of more than 4 GiB goes from NumPy to Raymap and back, with what lies behind it in the file."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shape, place = (1024, 1024, 1025), (1023, 1022, 1024)
        field = np.lib.format.open_memmap(folder / "sparse.npy", "w+", np.float32, shape, fortran_order=True)
        field[place] = -2.5
        np.savez(folder / "from.npz", distance=field, origin=np.array([1.0, 2.0, 3.0]), spacing=0.5)
        run("convert", folder / "from.npz", folder / "to.npz")
        with np.load(folder / "to.npz") as again:
            assert again["origin"].tolist() == [1, 2, 3]
            distance = again["distance"]
        assert distance.nbytes > 1 << 32 and distance.shape == shape, distance.shape
        assert distance[place] == -2.5 and np.count_nonzero(distance) == 1


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)

        (folder / "box.obj").write_text(BOX)
        run("generate", folder / "box.obj", "-o", folder / "box.npz", "--winding", folder / "w.npy",
            "--voxel-size", 0.25, "--bounds", "-.61", -0.31, -0.82, 4, 2.5, 1.3)
        field = np.load(folder / "box.npz")
        distance, spacing = field["distance"], field["spacing"]
        assert distance.dtype == np.float32 and distance.flags.f_contiguous, distance.flags
        assert distance.shape == (19, 12, 9), distance.shape
        index = np.stack(np.meshgrid(*map(np.arange, distance.shape), indexing="ij"), axis=-1)
        truth = box_distance(field["origin"] + spacing * index)
        np.testing.assert_allclose(distance, truth, atol=1e-6)

        # Mapped into memory, so that nothing is copied.
        winding = np.load(folder / "w.npy", mmap_mode="r")
        assert winding.shape == distance.shape
        np.testing.assert_allclose(winding, truth < 0, atol=1e-6)

        # In NumPy's own order, too.
        for order in "CF":
            np.save(folder / "from.npy", np.array(truth, dtype=np.float32, order=order))
            run("convert", folder / "from.npy", folder / "to.npy")
            np.testing.assert_array_equal(np.load(folder / "to.npy"), truth.astype(np.float32))
            np.savez_compressed(folder / "from.npz", distance=np.array(distance, order=order), origin=field["origin"],
                                spacing=spacing)
            run("convert", folder / "from.npz", folder / "to.npz")
            again = np.load(folder / "to.npz")
            np.testing.assert_array_equal(again["distance"], distance)
            np.testing.assert_array_equal(again["origin"], field["origin"])

        # Queries take points in any shape and order, and give them back in C order.
        points = np.random.default_rng(1).uniform(-1, 4, (5, 4, 3))
        flat = points.reshape(-1, 3)
        for given in (points, flat, np.asfortranarray(flat), flat.astype(np.float32)):
            np.save(folder / "points.npy", given)
            run("query", folder / "box.obj", folder / "points.npy", "-o", folder / "found.npz",
                "--arrays", "distance,closest,triangle,barycentric,direction,winding,confidence")
            found = np.load(folder / "found.npz")
            np.testing.assert_allclose(found["distance"], box_distance(flat), atol=1e-5)
            for name, shape, kind in (("closest", (20, 3), "f8"), ("triangle", (20,), "u4"), ("barycentric", (20, 3), "f8"),
                                      ("direction", (20, 3), "f8"), ("winding", (20,), "f4"), ("confidence", (20,), "f4")):
                assert found[name].shape == shape and found[name].dtype == kind, name
            away = np.linalg.norm(found["closest"] - flat, axis=-1)
            np.testing.assert_allclose(away, np.abs(found["distance"]), atol=1e-5)
        run("query", folder / "box.obj", folder / "points.npy", "-o", folder / "d.npy")
        np.testing.assert_array_equal(np.load(folder / "d.npy"), found["distance"])


if sys.argv[2:] != ["--large"]:
    main()
elif os.environ.get("RAYMAP_LARGE_FILES"):
    exchange_a_large_field()
else:
    sys.exit(77)
