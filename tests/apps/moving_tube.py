"""Writes glTF files of a square tube that bends or tumbles."""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from animated_gltf import write_animated  # noqa: E402

RINGS = 9
STILL = (0, 0, 0, 1)  # A rotation by nothing, as (x, y, z, w).


def write_tube(path, node, channels):
    """Writes a tube whose lower end follows node 0, its upper end node 1, which hangs on it, one unit above."""
    positions = [(x, y, 0.25 * ring) for ring in range(RINGS) for x, y in ((-.3, -.2), (.3, -.2), (.3, .2), (-.3, .2))]
    top = 4 * (RINGS - 1)
    triangles = [(0, 2, 1), (0, 3, 2), (top, top + 1, top + 2), (top, top + 2, top + 3)]
    for ring in range(RINGS - 1):
        for k in range(4):
            a, b = 4 * ring + k, 4 * ring + (k + 1) % 4
            triangles += [(a, b, b + 4), (a, b + 4, a + 4)]
    upper = [min(max(z - 0.5, 0), 1) for _, _, z in positions]
    write_animated(path, positions, triangles, [(0, 1, 0, 0)] * len(positions), [(1 - w, w, 0, 0) for w in upper],
                   [{"children": [1]}, {"translation": [0, 0, 1]}], [(0, (0, 0, 0)), (1, (0, 0, -1))],
                   [(node, *channel) for channel in channels])


def bend(path):
    """Writes a tube that bends to one side and back in two seconds."""
    half = 0.5 ** 0.5
    write_tube(path, 1, [("rotation", (0, 1, 2), (STILL, (half, 0, 0, half), STILL))])


def tumble(path):
    """Writes a tube that turns and moves as a whole for a second, and then stands still for another."""
    turned = tuple(part / 1.02 ** 0.5 for part in (0.3, 0.2, 0.5, 0.8))
    place = (0.4, -0.3, 0.2)
    write_tube(path, 0, [("rotation", (0, 1, 2), (STILL, turned, turned)),
                         ("translation", (0, 1, 2), ((0, 0, 0), place, place))])
