"""Makes scene.fbx (binary, centimetres, z up) and scene.glb (metres, y up) of one scene: a box; its child, a wedge, turned
and scaled; the wedge's mesh once more, mirrored and alone. The faces are triangles and quads.

python make_scene.py, with PyPI's bpy 5.0.1"""

import math
from pathlib import Path

import bpy

bpy.ops.wm.read_factory_settings(use_empty=True)


def make_mesh(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    return mesh


def add(name, mesh, parent, location, degrees, scale):
    node = bpy.data.objects.new(name, mesh)
    node.parent, node.location, node.scale = parent, location, scale
    node.rotation_euler = [math.radians(angle) for angle in degrees]
    bpy.context.scene.collection.objects.link(node)
    return node


box = make_mesh("box", [(x, y, z) for z in (0, 1) for y in (0, 2) for x in (0, 3)],
                [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)])
wedge = make_mesh("wedge", [(0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1), (2, 0, 1), (0, 1, 1)],
                  [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)])
parent = add("Box", box, None, (1, 2, 3), (0, 0, 30), (1, 1, 0.5))
add("Wedge", wedge, parent, (0, 0, 2), (20, 0, 45), (1.5, 0.5, 1))
add("Again", wedge, None, (-4, 1, 0), (0, 90, 0), (-1, 1, 2))

folder = str(Path(__file__).resolve().parent)
bpy.ops.export_scene.fbx(filepath=folder + "/scene.fbx", axis_forward="Y", axis_up="Z", bake_anim=False)
bpy.ops.export_scene.gltf(filepath=folder + "/scene.glb", export_format="GLB")
