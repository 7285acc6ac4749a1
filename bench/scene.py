"""Compares a raymap.Scene with python-fcl and Open3D: an arm of capsules in many configurations, and points around it.

scene.py [--links 20] [--points 200] [--configurations 1000] [--peer-configurations 20] [--triangles 2000]

Each answers the signed distance of the union of all links; FCL's distance has no sign inside a mesh. Open3D gets the points
of all configurations in the coordinates of one link after the other. FCL gets each point as a sphere of radius 0, with a
tree of bounds over the links. The peers answer the first configurations only. Prints a table in markdown: CPU time per
configuration with its points, and the largest difference from Raymap (FCL: outside). Needs numpy, open3d, python-fcl and raymap.
"""

import argparse

import numpy as np

import peers
import raymap


def capsule(radius, length, triangles):
    """Returns a capsule from (0, 0, 0) along z, around which the surface goes in steps of equal angle."""
    around = max(8, int(np.sqrt(triangles)))
    rows = max(3, triangles // (4 * around))
    angles = np.linspace(-np.pi / 2, np.pi / 2, 2 * rows)
    heights = radius * np.sin(angles) + np.where(angles > 0, length, 0)
    turns = np.arange(around) * 2 * np.pi / around
    rings = np.stack([np.outer(np.cos(angles), np.cos(turns)), np.outer(np.cos(angles), np.sin(turns))], axis=-1) * radius
    rings = np.concatenate([rings, np.broadcast_to(heights[:, None, None], (*rings.shape[:2], 1))], axis=-1)[1:-1]
    vertices = np.concatenate([rings.reshape(-1, 3), [(0, 0, -radius), (0, 0, length + radius)]])
    ring, step = np.meshgrid(np.arange(len(rings) - 1), np.arange(around), indexing="ij")
    a, b = ring * around + step, ring * around + (step + 1) % around
    sides = np.stack([np.stack([a, b, b + around], axis=-1), np.stack([a, b + around, a + around], axis=-1)]).reshape(-1, 3)
    first, last = np.arange(around), np.arange(around) + (len(rings) - 1) * around
    bottom = np.stack([np.roll(first, -1), first, np.full(around, len(vertices) - 2)], axis=-1)
    top = np.stack([last, np.roll(last, -1), np.full(around, len(vertices) - 1)], axis=-1)
    return vertices, np.concatenate([sides, bottom, top])


def chain_poses(random, configurations, links, length):
    """Returns (configurations, links, 4, 4): each link begins where the one before ends, turned about two axes."""
    poses = np.empty((configurations, links, 4, 4))
    pose = np.tile(np.eye(4), (configurations, 1, 1))
    for link in range(links):
        a, b = random.uniform(-0.6, 0.6, (2, configurations))
        turn = np.tile(np.eye(4), (configurations, 1, 1))
        turn[:, 0, 0], turn[:, 0, 2], turn[:, 2, 0], turn[:, 2, 2] = np.cos(a), np.sin(a), -np.sin(a), np.cos(a)
        other = np.tile(np.eye(4), (configurations, 1, 1))
        other[:, 1, 1], other[:, 1, 2], other[:, 2, 1], other[:, 2, 2] = np.cos(b), -np.sin(b), np.sin(b), np.cos(b)
        poses[:, link] = pose = pose @ turn @ other
        along = np.tile(np.eye(4), (configurations, 1, 1))
        along[:, 2, 3] = length
        pose = pose @ along
    return poses


def by_raymap(meshes, poses, points):
    scene = raymap.Scene({str(link): raymap.Surface(*mesh) for link, mesh in enumerate(meshes)})
    return lambda: scene.signed_distance(points, poses)


def by_raymap_each_body(meshes, poses, points):
    """Answers without a broad phase."""
    scene = raymap.Scene({str(link): raymap.Surface(*mesh) for link, mesh in enumerate(meshes)})
    return lambda: scene.query(points, "distances", poses=poses).distances.min(axis=-1)


def by_open3d(meshes, poses, points):
    import open3d

    scenes = []
    for vertices, faces in meshes:
        scenes.append(open3d.t.geometry.RaycastingScene())
        scenes[-1].add_triangles(open3d.core.Tensor(vertices.astype(np.float32)), open3d.core.Tensor(faces.astype(np.uint32)))
        scenes[-1].compute_distance(open3d.core.Tensor(np.zeros((1, 3), np.float32)))  # Builds the tree.

    def query():
        least = np.full((len(poses), len(points)), np.inf, np.float32)
        for link, scene in enumerate(scenes):
            offsets = points[None] - poses[:, link, None, :3, 3]
            inside = np.ascontiguousarray(np.einsum("cni,cij->cnj", offsets, poses[:, link, :3, :3]), np.float32)
            np.minimum(least, scene.compute_signed_distance(open3d.core.Tensor(inside), nsamples=1).numpy(), out=least)
        return least

    return query


def by_fcl(meshes, poses, points):
    import fcl

    links = []
    for vertices, faces in meshes:
        model = fcl.BVHModel()
        model.beginModel(len(vertices), len(faces))
        model.addSubModel(vertices, faces)
        model.endModel()
        links.append(fcl.CollisionObject(model))
    balls = [fcl.CollisionObject(fcl.Sphere(0.0), fcl.Transform(p)) for p in points]
    manager = fcl.DynamicAABBTreeCollisionManager()
    manager.registerObjects(links)
    manager.setup()

    def query():
        found = np.empty((len(poses), len(points)))
        for c, configuration in enumerate(poses):
            for link, pose in zip(links, configuration, strict=True):
                link.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
            manager.update()
            for k, ball in enumerate(balls):
                data = fcl.DistanceData()
                manager.distance(ball, data, fcl.defaultDistanceCallback)
                found[c, k] = data.result.min_distance
        return found

    return query


METHODS = {"Raymap": by_raymap, "Raymap, every body": by_raymap_each_body, "Open3D": by_open3d, "FCL": by_fcl}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("links", 20), ("points", 200), ("configurations", 1000), ("peer-configurations", 20),
                          ("triangles", 2000)):  # fmt: skip
        parser.add_argument(f"--{name}", type=int, default=default)
    given = parser.parse_args()
    random = np.random.default_rng(1)
    meshes = [capsule(0.06 + 0.04 * random.random(), 0.25, given.triangles) for _ in range(given.links)]
    poses = chain_poses(random, given.configurations, given.links, 0.25)
    points = random.uniform(-2.5, 2.5, (given.points, 3)) + (0, 0, 2)
    print("| method | configurations | CPU ms each | wall ms each | times ours | largest difference |\n|---|---|---|---|---|---|")
    ours = None
    for name, method in METHODS.items():
        count = given.configurations if name.startswith("Raymap") else min(given.peer_configurations, given.configurations)
        query = method(meshes, poses[:count], points)
        before = peers.usage()
        found = query()
        after = peers.usage()
        wall, cpu = (1000 * (after[k] - before[k]) / count for k in range(2))
        ours = ours or (cpu, found)
        truth = ours[1][:count]
        difference = np.abs(found - truth)[truth > 0].max() if name == "FCL" else np.abs(found - truth).max()
        print(f"| {name} | {count} | {cpu:.3f} | {wall:.3f} | {cpu / ours[0]:.1f} | {difference:.0e} |")


if __name__ == "__main__":
    main()
