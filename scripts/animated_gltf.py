"""Writes animated glTF files with nothing but Python, for the gallery and for tests."""

import json
import struct

FLOAT, UINT16, UINT8 = 5126, 5123, 5121
FORMATS = {FLOAT: "f", UINT16: "H", UINT8: "B"}
KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


def write_animated(path, positions, triangles, joints, weights, nodes, skeleton, channels):
    """Writes a .glb of a mesh whose vertices follow joints.

    positions, triangles: three numbers each, per vertex and per triangle.
    joints, weights: four numbers per vertex, the joints as indices of the skeleton.
    nodes: glTF's nodes, of which the mesh becomes one more; roots are those that are nobody's child.
    skeleton: (node, translation from rest to the node's coordinates), one per joint.
    channels: (node, "rotation" or "translation" or "scale", times, values), between which poses are interpolated."""
    data, views, accessors = b"", [], []

    def add(rows, component):
        nonlocal data
        rows = [row if isinstance(row, (tuple, list)) else (row,) for row in rows]
        packed = b"".join(struct.pack(f"<{len(row)}{FORMATS[component]}", *row) for row in rows)
        accessors.append({"bufferView": len(views), "componentType": component, "count": len(rows),
                          "type": KINDS[len(rows[0])]})
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": len(packed)})
        data += packed + b"\0" * (-len(packed) % 4)
        return len(accessors) - 1

    binds = [(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, *shift, 1) for _, shift in skeleton]
    primitive = {"attributes": {"POSITION": add(positions, FLOAT), "JOINTS_0": add(joints, UINT8),
                                "WEIGHTS_0": add(weights, FLOAT)},
                 "indices": add([corner for triangle in triangles for corner in triangle], UINT16)}
    children = {child for node in nodes for child in node.get("children", ())}
    animation = {"name": "move", "channels": [], "samplers": []}
    for node, kind, times, values in channels:
        animation["channels"].append({"sampler": len(animation["samplers"]), "target": {"node": node, "path": kind}})
        animation["samplers"].append({"input": add(times, FLOAT), "output": add(values, FLOAT)})
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0,
        "scenes": [{"nodes": [n for n in range(len(nodes) + 1) if n not in children]}],
        "nodes": [*nodes, {"mesh": 0, "skin": 0}], "meshes": [{"primitives": [primitive]}],
        "skins": [{"joints": [node for node, _ in skeleton], "inverseBindMatrices": add(binds, FLOAT)}],
        "animations": [animation], "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data)}]}).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    with open(path, "wb") as file:
        file.write(b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks)
