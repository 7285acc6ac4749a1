"""Writes glTF files of a square tube whose upper half a joint moves."""

import json
import struct

import numpy as np

FLOAT, UINT16, UINT8 = 5126, 5123, 5121


def tube():
    """Returns positions, triangles, and how much of each vertex follows the upper joint."""
    rings, corners = 9, ((-.3, -.2), (.3, -.2), (.3, .2), (-.3, .2))
    positions = [(x, y, 0.25 * ring) for ring in range(rings) for x, y in corners]
    triangles = [(0, 2, 1), (0, 3, 2), (32, 33, 34), (32, 34, 35)]
    for ring in range(rings - 1):
        for k in range(4):
            a, b = 4 * ring + k, 4 * ring + (k + 1) % 4
            triangles += [(a, b, b + 4), (a, b + 4, a + 4)]
    positions = np.array(positions, np.float32)
    return positions, np.array(triangles, np.uint16), np.clip(positions[:, 2] - 0.5, 0, 1)


def write_tube(path, keys, moves="upper"):
    """Writes a tube. `keys` are (seconds, quaternion, translation); `moves` is the joint that follows them: "upper", so
    that the tube bends, or "all"."""
    positions, triangles, share = tube()
    joints = np.zeros((len(positions), 4), np.uint8)
    joints[:, 1] = 1
    weights = np.zeros((len(positions), 4), np.float32)
    weights[:, 0], weights[:, 1] = 1 - share, share
    bind = np.stack([np.eye(4, dtype=np.float32)] * 2)
    bind[1, 3, 2] = -1
    times, turns, places = (np.array(each, np.float32) for each in zip(*keys))
    if moves == "upper":
        places = places + np.float32([0, 0, 1])  # The upper joint rests there.
    data, views, accessors = b"", [], []
    for values, component, kind in ((positions, FLOAT, "VEC3"), (triangles.reshape(-1), UINT16, "SCALAR"),
                                    (joints, UINT8, "VEC4"), (weights, FLOAT, "VEC4"), (bind, FLOAT, "MAT4"),
                                    (times, FLOAT, "SCALAR"), (turns, FLOAT, "VEC4"), (places, FLOAT, "VEC3")):
        accessors.append({"bufferView": len(views), "componentType": component, "count": len(values), "type": kind})
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": values.nbytes})
        data += values.tobytes() + b"\0" * (-values.nbytes % 4)
    node = 2 if moves == "upper" else 1
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
        "nodes": [{"mesh": 0, "skin": 0}, {"children": [2]}, {"translation": [0, 0, 1]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "JOINTS_0": 2, "WEIGHTS_0": 3}, "indices": 1}]}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": 4}],
        "animations": [{"name": "move", "channels": [{"sampler": 0, "target": {"node": node, "path": "rotation"}},
                                                     {"sampler": 1, "target": {"node": node, "path": "translation"}}],
                        "samplers": [{"input": 5, "output": 6}, {"input": 5, "output": 7}]}],
        "accessors": accessors, "bufferViews": views, "buffers": [{"byteLength": len(data)}]}).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    path.write_bytes(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)


def bend(path):
    """Writes a tube that bends to one side and back in two seconds."""
    half = 0.5 ** 0.5
    write_tube(path, [(0, (0, 0, 0, 1), (0, 0, 0)), (1, (half, 0, 0, half), (0, 0, 0)), (2, (0, 0, 0, 1), (0, 0, 0))])


def tumble(path):
    """Writes a tube that turns and moves as a whole for a second, and then stands still for another."""
    turned = np.array([0.3, 0.2, 0.5, 0.8]) / np.linalg.norm([0.3, 0.2, 0.5, 0.8])
    write_tube(path, [(0, (0, 0, 0, 1), (0, 0, 0)), (1, turned, (0.4, -0.3, 0.2)), (2, turned, (0.4, -0.3, 0.2))], "all")
