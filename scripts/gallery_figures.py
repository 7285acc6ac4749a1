#!/usr/bin/env python3
"""Writes the figures of docs/gallery.md that no command of raymap makes.

gallery_figures.py FOLDER: writes walker.glb, a jointed figure that takes two steps a second, bowl.obj, a surface without
a thickness, and duck.obj, a toy with many defects."""

import math
import sys
from pathlib import Path

from animated_gltf import write_animated

SIDES, ROUNDS = 16, 6  # Corners around a limb, and rings of each of its round ends.
STEPS = 24  # Keys of a second.

# Parts of the walker: name, the part that it hangs on, the place of its joint there, the end of its limb from the joint,
# its radius.
PARTS = [
    ("hips", None, (0, 0.95, 0), (0, 0.08, 0), 0.13),
    ("chest", "hips", (0, 0.16, 0), (0, 0.3, 0), 0.16),
    ("head", "chest", (0, 0.56, 0.01), (0, 0.1, 0.02), 0.12),
    *((f"{side} {name}", on and on.replace("*", side), (x * place[0], *place[1:]), end, radius)
      for side, x in (("left", 1), ("right", -1))
      for name, on, place, end, radius in (
          ("arm", "chest", (0.23, 0.3, 0), (0, -0.26, 0), 0.06),
          ("hand", "* arm", (0, -0.28, 0), (0, -0.26, 0), 0.05),
          ("thigh", "hips", (0.09, -0.05, 0), (0, -0.38, 0), 0.085),
          ("shin", "* thigh", (0, -0.42, 0), (0, -0.36, 0), 0.065),
          ("foot", "* shin", (0, -0.4, 0.01), (0, -0.01, 0.15), 0.05)))]

# Defects of the duck: the number of the part, the kind, the centre and the radius.
PATCHES = [(0, "hole", (0.55, -0.05, 0.75), 0.29), (0, "hole", (-0.55, 0.66, 0.2), 0.27), (1, "hole", (0.6, 1.2, 0.4), 0.2),
           (0, "reversed", (0.0, 0.15, 0.8), 0.33), (0, "reversed", (0.75, -0.5, 0.3), 0.25), (2, "reversed", (1.2, 0.86, 0), 1),
           (0, "twice", (-0.6, -0.1, 0.75), 0.28)]


def capsule(end, radius, first):
    """Returns the vertices and triangles of a limb with round ends, from the origin to `end`."""
    length = math.dist((0, 0, 0), end)
    along = [part / length for part in end]
    helper = (0, 0, 1) if abs(along[2]) < 0.7 else (1, 0, 0)
    side = [along[(a + 1) % 3] * helper[(a + 2) % 3] - along[(a + 2) % 3] * helper[(a + 1) % 3] for a in range(3)]
    side = [part / math.dist((0, 0, 0), side) for part in side]
    other = [along[(a + 1) % 3] * side[(a + 2) % 3] - along[(a + 2) % 3] * side[(a + 1) % 3] for a in range(3)]
    rings = [(-radius * math.cos(k * math.pi / 2 / ROUNDS), radius * math.sin(k * math.pi / 2 / ROUNDS))
             for k in range(1, ROUNDS + 1)]
    rings += [(length - at, wide) for at, wide in reversed(rings)]
    points = [[-radius * part for part in along]]
    for at, wide in rings:
        for s in range(SIDES):
            c, d = wide * math.cos(2 * math.pi * s / SIDES), wide * math.sin(2 * math.pi * s / SIDES)
            points.append([at * along[a] + c * side[a] + d * other[a] for a in range(3)])
    points.append([(length + radius) * part for part in along])
    last, faces = len(points) - 1, []
    for s in range(SIDES):
        t = (s + 1) % SIDES
        faces += [(0, 1 + t, 1 + s), (last, last - SIDES + s, last - SIDES + t)]
        for ring in range(len(rings) - 1):
            a = 1 + SIDES * ring
            faces += [(a + s, a + t, a + SIDES + t), (a + s, a + SIDES + t, a + SIDES + s)]
    return points, [[first + corner for corner in face] for face in faces]


def turn(degrees, axis):
    half = math.radians(degrees) / 2
    return (*(math.sin(half) * (a == axis) for a in range(3)), math.cos(half))


def angle(name, phase):
    """Returns how far a part turns forward (around x), in degrees."""
    side = 0 if name.startswith("left") else math.pi
    swing = math.sin(phase + side)
    if name.endswith("thigh"):
        return -28 * swing - 4
    if name.endswith("shin"):
        return 5 + 27 * (1 - math.cos(phase + side + 2.2))
    if name.endswith("foot"):
        return -6 - 12 * math.sin(phase + side + 2.6)
    if name.endswith("arm"):
        return 26 * swing
    if name.endswith("hand"):
        return -24 + 12 * swing
    return 4 if name == "chest" else 0


def write_walker(path):
    names = [name for name, *_ in PARTS]
    places, points, faces, joints = {}, [], [], []
    nodes = [{"name": name, "translation": list(place),
              "children": [n for n, part in enumerate(PARTS) if part[1] == name]} for name, _, place, *_ in PARTS]
    for number, (name, on, place, end, radius) in enumerate(PARTS):
        nodes[number] = {key: value for key, value in nodes[number].items() if value != []}
        places[name] = [a + b for a, b in zip(place, places.get(on, (0, 0, 0)))]
        own, triangles = capsule(end, radius, len(points))
        points += [[a + b for a, b in zip(point, places[name])] for point in own]
        faces += triangles
        joints += [(number, 0, 0, 0)] * len(own)
    times = [k / STEPS for k in range(STEPS + 1)]
    phases = [2 * math.pi * time for time in times]
    channels = [(n, "rotation", times, [turn(angle(name, phase), 0) for phase in phases]) for n, name in enumerate(names)]
    channels[0] = (0, "rotation", times, [turn(5 * math.sin(phase), 1) for phase in phases])
    channels.append((0, "translation", times, [(0, 0.95 + 0.025 * math.cos(2 * phase), 0) for phase in phases]))
    write_animated(path, points, faces, joints, [(1, 0, 0, 0)] * len(points), nodes,
                   [(n, [-part for part in places[name]]) for n, name in enumerate(names)], channels)


def write_bowl(path, around=96, rings=24):
    """Writes half a sphere whose rim is a wave."""
    lines = ["v 0 -1 0"]
    for ring in range(1, rings + 1):
        for s in range(around):
            way = 2 * math.pi * s / around
            down = (math.pi / 2 + 0.12 * math.sin(6 * way)) * ring / rings
            lines.append(f"v {math.sin(down) * math.cos(way):.6f} {-math.cos(down):.6f} {math.sin(down) * math.sin(way):.6f}")
    for s in range(around):
        t = (s + 1) % around
        lines.append(f"f 1 {2 + s} {2 + t}")
        for ring in range(rings - 1):
            a = 2 + around * ring
            lines += [f"f {a + s} {a + around + s} {a + around + t}", f"f {a + s} {a + around + t} {a + t}"]
    path.write_text("\n".join(lines) + "\n")


def ball(centre, radii, around=96, lift=0.0):
    """Returns the vertices and triangles of an ellipsoid, whose back is bent up by `lift`."""
    rings, points, faces = around // 2, [], []
    for ring in range(rings + 1):
        up = math.pi * (ring / rings - 0.5)
        for s in range(around):
            way = 2 * math.pi * s / around
            x, y, z = math.cos(up) * math.cos(way), math.sin(up), math.cos(up) * math.sin(way)
            y += lift * max(0.0, -x - 0.3) ** 2
            points.append([c + r * at for c, r, at in zip(centre, radii, (x, y, z))])
    for ring in range(rings):
        for s in range(around):
            a, b = ring * around + s, ring * around + (s + 1) % around
            faces += [(a, a + around, b + around)] * (ring < rings - 1) + [(a, b + around, b)] * (ring > 0)
    return points, faces


def write_duck(path):
    """Writes a duck of five closed parts that cross, one of them inside out, with the defects of PATCHES."""
    parts = [ball((0, 0, 0), (1.15, 0.72, 0.8), lift=1.6), ball((0.68, 0.92, 0), (0.5, 0.5, 0.48)),
             ball((1.2, 0.86, 0), (0.3, 0.1, 0.26), 48),
             *(ball((1.03, 1.1, z), (0.09, 0.09, 0.09), 24) for z in (-0.26, 0.26))]
    lines, first = [], 1
    for number, (points, faces) in enumerate(parts):
        lines += ["v {:.5f} {:.5f} {:.5f}".format(*point) for point in points]
        for face in faces:
            middle = [sum(points[corner][a] for corner in face) / 3 for a in range(3)]
            near = {kind for part, kind, centre, reach in PATCHES if part == number and math.dist(middle, centre) < reach}
            corners = [str(first + corner) for corner in face[::-1 if "reversed" in near else 1]]
            lines += ["f " + " ".join(corners)] * (0 if "hole" in near else 2 if "twice" in near else 1)
        first += len(points)
    path.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    write_walker(folder / "walker.glb")
    write_bowl(folder / "bowl.obj")
    write_duck(folder / "duck.obj")
