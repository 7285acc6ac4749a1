"""What scripts/check_wheel.sh runs in a bare system: the programs and libraries of the wheel must be found there."""

import sys

import numpy as np
import raymap

field = raymap.signed_distance("tetrahedron.3mf", resolution=32)  # Read by the child process, which needs Assimp.
field.save("field.vdb")  # Written by OpenVDB, and read by the child process.
again = raymap.load_field("field.vdb")
np.testing.assert_array_equal(again.distance, field.distance)
assert field.distance.min() < 0 < field.distance.max()
assert raymap.info(field.to_mesh())["watertight"]
assert raymap.devices()[0]["id"] == "cpu"
print(f"raymap {raymap.__version__} works with Python {sys.version.split()[0]} and NumPy {np.__version__}: {again}")
