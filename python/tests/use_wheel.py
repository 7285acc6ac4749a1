"""Runs in a bare system, by scripts/check_wheel.sh: the programs and libraries of the wheel must be found there."""

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import raymap
from pages import run_page


def run_program(*arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs the program that pip has put beside Python."""
    program = Path(sys.executable).with_name("raymap")
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=False)


field = raymap.generate("tetrahedron.dae", resolution=32)  # Read by the child process, which needs Assimp.
field.save("field.vdb")  # Written by OpenVDB, and read by the child process.
again = raymap.load_field("field.vdb")
np.testing.assert_array_equal(again.distance, field.distance)
assert field.distance.min() < 0 < field.distance.max()
assert raymap.info(field.to_mesh())["watertight"]
assert raymap.devices()[0]["id"] == "cpu"

# The program, which finds its importer, too.
for arguments in ("--help", "example -o globe.ply", "generate tetrahedron.dae -o program.vdb --resolution 32",
                  "convert program.vdb program.npz"):
    ended = run_program(*arguments.split())
    assert ended.returncode == 0, ended.stderr
assert raymap.info("globe.ply", fast=True)["watertight"]
np.testing.assert_array_equal(raymap.load_field("program.npz").distance, field.distance)
ended = run_program("devices", "--test")
assert ended.returncode == 7 and "there is no GPU to test" in ended.stderr, ended

# The lines that new users copy.
field.to_mesh().save("scan.ply")
raymap.load_mesh("tetrahedron.dae").save("tetrahedron.ply")
for page in "docs/python.md", "README.md", "python/README.md", "docs/datasets.md":  # The first one makes ball.ply.
    run_page(Path(page).read_text(), page)
Path("FOLDER").mkdir()
shutil.copy("ball.ply", "FOLDER")
command = re.search("^python (-m raymap dataset .*)", Path("docs/datasets.md").read_text(), re.MULTILINE)[1]
subprocess.run([sys.executable, *shlex.split(command)], check=True)
assert raymap.load_field("OUT/ball.ply.npz").distance.min() < 0

print(f"raymap {raymap.__version__} works with Python {sys.version.split()[0]} and NumPy {np.__version__}: {again}")
