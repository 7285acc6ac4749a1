"""Costs of queries at points beside other software: of one surface, and of bodies that move."""

import pathlib
import statistics
import tempfile

import numpy as np
from harness import BUILD, head, in_process, is_wanted, line, measured, near_points, table, uniform_points, usage
from speed import median, open3d_scene, peer, read_raw


def prepared_query(prepare, query):
    """Returns the answers of a query after a preparation, and the cost of both."""
    ready, first = measured(prepare)
    values, second = measured(lambda: query(ready))
    return {"values": values}, {"prepare": first["cpu"], "query": second["cpu"], "wall": first["wall"] + second["wall"],
                                "megabytes": first["megabytes"] + second["megabytes"]}  # fmt: skip


def raymap_points(threads, name, points, sign=True):
    import raymap

    mesh = read_raw(name)
    return prepared_query(lambda: raymap.Surface(*mesh, sign=sign, threads=threads), lambda s: s.signed_distance(points, threads=threads))


def raymap_unsigned_points(threads, name, points):
    return raymap_points(threads, name, points, sign=False)


def open3d_points(threads, name, points):
    """Its sign comes from one ray."""
    import open3d as library

    mesh, where = read_raw(name), library.core.Tensor(points.astype(np.float32))

    def prepare():
        scene = open3d_scene(*mesh)
        scene.compute_distance(where[:1])  # Builds the tree.
        return scene

    return prepared_query(prepare, lambda scene: scene.compute_signed_distance(where, nthreads=threads, nsamples=1).numpy())


def igl_points(threads, name, points):
    """It prepares and answers in one call, so everything counts as the query."""
    import igl

    mesh, kind = read_raw(name), igl.SignedDistanceType.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
    return prepared_query(lambda: None, lambda _: igl.signed_distance(points.astype(float), *mesh, kind)[0])


def curve_order(points, bits=21):
    """Returns the order of points along a Morton curve."""
    low = points.min(axis=0)
    places = ((points - low) * ((2**bits - 1) / np.ptp(points, axis=0).max())).astype(np.uint64)
    codes = np.zeros(len(points), np.uint64)
    for bit in range(bits):
        for axis in range(3):
            codes |= (places[:, axis] >> np.uint64(bit) & np.uint64(1)) << np.uint64(3 * bit + axis)
    return np.argsort(codes, kind="stable")


def embree_points(folder, name, points, threads):
    """It gets the points sorted along a curve, for free."""
    order = curve_order(points)
    np.ascontiguousarray(points[order], np.float32).tofile(folder / "points")
    cost = peer("embree_points", mesh=name, points=folder / "points", threads=threads, output=folder / "samples")
    values = np.empty(len(points), np.float32)
    values[order] = np.fromfile(folder / "samples", np.float32)
    return values, cost


POINT_PEERS = {"raymap": {}, "raymap_unsigned": {}, "embree": {"uniform": 3, "near": 3}, "open3d": {"uniform": 10, "near": 4},
               "igl": {"uniform": 10}}  # fmt: skip


def small_call(mesh, points, threads, count=1000, calls=201):
    """Returns the median milliseconds of a call of few points."""
    import raymap

    surface, times = raymap.Surface(*mesh, threads=threads), []
    for call in range(calls):
        begin = call * count % (len(points) - count)
        times.append(measured(lambda: surface.signed_distance(points[begin : begin + count], threads=threads))[1]["wall"])
    return 1e3 * statistics.median(times)


@table
def queries(rounds=3, threads=2, count=1_000_000, only=("",)):
    """CPU seconds of signed distances at points beside peers': docs/performance.md."""
    head("mesh, points", "method", "CPU", "to prepare", "to query", "CPU / ours", "aim", "other sign", "MB, at most")
    calls = []
    for name, place in ((mesh, place) for mesh in ("scan", "million") for place in ("uniform", "near")):
        if not is_wanted(f"{name} {place}", only):
            continue
        with tempfile.TemporaryDirectory(dir=BUILD) as text:
            folder, random = pathlib.Path(text), np.random.default_rng(1)
            peer("export", mesh=name, output=folder / "mesh")
            mesh = read_raw(folder / "mesh")
            points = uniform_points(mesh[0], count, random) if place == "uniform" else near_points(mesh, count, random, 2.5e-3)
            points = points.astype(np.float32)
            np.savez(folder / "case.npz", name=str(folder / "mesh"), points=points)
            costs, answers = {}, {}
            for method in [method for _ in range(rounds) for method in POINT_PEERS]:
                try:
                    if method == "embree":
                        answers[method], cost = embree_points(folder, folder / "mesh", points, threads)
                    else:
                        values, cost = in_process(f"queries:{method}_points", folder / "case.npz", threads)
                        answers[method] = values["values"]
                except RuntimeError as error:
                    print(f"{method}: {error}")
                    continue
                costs.setdefault(method, []).append({**cost, "cpu": cost["prepare"] + cost["query"]})
            for method, runs in costs.items():
                ratio, aim = median(runs) / median(costs["raymap"]), POINT_PEERS[method].get(place)
                limit = 1e-6 * (100 * count + 200 * len(mesh[1]))
                line(f"{name}, {place}", method, *(f"{median(runs, key):.3f}" for key in ("cpu", "prepare", "query")), f"{ratio:.1f}",
                     f"{aim}, {'met' if ratio >= aim else 'missed'}" if aim else "",
                     f"{100 * np.mean((answers[method] < 0) != (answers['raymap'] < 0)):.3f} %",
                     f"{1.048576 * median(runs, 'megabytes'):.0f}" + (f" of {limit:.0f}" if method == "raymap" else ""))  # fmt: skip
            calls.append((f"{name}, {place}", small_call(mesh, points, threads)))
    print()
    head("one call of 1000 points", "wall ms", "at most 1")
    for case, wall in calls:
        line(case, f"{wall:.2f}", "met" if wall <= 1 else "missed")


# Bodies that move.


def capsule(radius, length, triangles):
    """Returns a capsule from (0, 0, 0) along z."""
    import trimesh

    count = max(8, int(np.sqrt(triangles)))
    made = trimesh.creation.capsule(height=length, radius=radius, count=[count, max(6, triangles // (2 * count))])
    return np.asarray(made.vertices, float), np.asarray(made.faces)


def chain_poses(random, configurations, links, length):
    """Returns (configurations, links, 4, 4): each link begins where the one before ends, turned about two axes."""
    poses, pose = np.empty((configurations, links, 4, 4)), np.tile(np.eye(4), (configurations, 1, 1))
    along = np.eye(4)
    along[2, 3] = length
    for link in range(links):
        for (i, j), angle in zip(((0, 2), (1, 2)), random.uniform(-0.6, 0.6, (2, configurations))):
            turn = np.tile(np.eye(4), (configurations, 1, 1))
            turn[:, i, i], turn[:, j, j] = np.cos(angle), np.cos(angle)
            turn[:, i, j], turn[:, j, i] = -np.sin(angle), np.sin(angle)
            pose = pose @ turn
        poses[:, link] = pose
        pose = pose @ along
    return poses


def scene_raymap(meshes, poses, points, each_body=False):
    import raymap

    scene = raymap.Scene({str(link): raymap.Surface(*mesh) for link, mesh in enumerate(meshes)})
    if each_body:  # Without a broad phase.
        return lambda: scene.query(points, "distances", poses=poses).distances.min(axis=-1)
    return lambda: scene.signed_distance(points, poses)


def scene_open3d(meshes, poses, points):
    """It gets the points of all configurations in the coordinates of one link after the other."""
    import open3d as library

    scenes = [open3d_scene(*mesh) for mesh in meshes]
    for scene in scenes:
        scene.compute_distance(library.core.Tensor(np.zeros((1, 3), np.float32)))  # Builds the tree.

    def query():
        least = np.full((len(poses), len(points)), np.inf, np.float32)
        for link, scene in enumerate(scenes):
            moved = np.einsum("cni,cij->cnj", points[None] - poses[:, link, None, :3, 3], poses[:, link, :3, :3])
            moved = library.core.Tensor(np.ascontiguousarray(moved, np.float32))
            np.minimum(least, scene.compute_signed_distance(moved, nsamples=1).numpy(), out=least)
        return least

    return query


def scene_fcl(meshes, poses, points):
    """It gets each point as a sphere of radius 0, with a tree of bounds over the links."""
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
            for body, pose in zip(links, configuration, strict=True):
                body.setTransform(fcl.Transform(pose[:3, :3], pose[:3, 3]))
            manager.update()
            for k, sphere in enumerate(balls):
                data = fcl.DistanceData()
                manager.distance(sphere, data, fcl.defaultDistanceCallback)
                found[c, k] = data.result.min_distance
        return found

    return query


@table
def scene(links=20, points=200, configurations=1000, peer_configurations=20, triangles=2000):
    """CPU and wall milliseconds of distances to an arm of capsules, beside Open3D and python-fcl: docs/performance.md.

    The peers answer the first configurations only. FCL's distance has no sign inside a mesh, so it is compared outside."""
    random = np.random.default_rng(1)
    meshes = [capsule(0.06 + 0.04 * random.random(), 0.25, triangles) for _ in range(links)]
    poses, where = chain_poses(random, configurations, links, 0.25), random.uniform(-2.5, 2.5, (points, 3)) + (0, 0, 2)
    head("method", "configurations", "CPU ms each", "wall ms each", "times ours", "largest difference")
    ours = None
    for name, method in {"Raymap": scene_raymap, "Raymap, every body": lambda *case: scene_raymap(*case, each_body=True),
                         "Open3D": scene_open3d, "FCL": scene_fcl}.items():  # fmt: skip
        count = configurations if name.startswith("Raymap") else min(peer_configurations, configurations)
        try:
            query = method(meshes, poses[:count], where)
        except ImportError as error:
            line(name, count, error, *[""] * 3)
            continue
        before, found, after = usage(), query(), usage()
        wall, cpu = (1000 * (after[k] - before[k]) / count for k in range(2))
        ours = ours or (cpu, found)
        truth = ours[1][:count]
        far = np.abs(found - truth)[truth > 0].max() if name == "FCL" else np.abs(found - truth).max()
        line(name, count, f"{cpu:.3f}", f"{wall:.3f}", f"{cpu / ours[0]:.1f}", f"{far:.0e}")


def scattered_poses(random, bodies, reach):
    """Returns random rigid poses with translations of up to `reach` along each axis."""
    poses = np.tile(np.eye(4), (bodies, 1, 1))
    turns = np.linalg.qr(random.normal(size=(bodies, 3, 3)))[0]
    poses[:, :3, :3] = turns * np.sign(np.linalg.det(turns))[:, None, None]
    poses[:, :3, 3] = random.uniform(-reach, reach, (bodies, 3))
    return poses


@table
def bodies(counts=(1, 2, 8, 20, 100, 800), points=100000, triangles=1280, rounds=5):
    """CPU microseconds a point of balls in random poses in a cube, beside one surface of them all: docs/performance.md."""
    import raymap
    import trimesh

    head("bodies", "scene", "one surface")
    for count in counts:
        random, reach = np.random.default_rng(count), 1.2 * count ** (1 / 3)
        levels = round(np.log(triangles / 20) / np.log(4))
        balls = [trimesh.creation.icosphere(levels, radius) for radius in random.uniform(0.5, 1, count)]
        poses, where = scattered_poses(random, count, reach), random.uniform(-reach - 1, reach + 1, (points, 3))
        made = raymap.Scene({str(k): raymap.Surface(ball.vertices, ball.faces) for k, ball in enumerate(balls)})
        merged = trimesh.util.concatenate([ball.copy().apply_transform(pose) for ball, pose in zip(balls, poses, strict=True)])
        surface = raymap.Surface(merged.vertices, merged.faces)
        costs = []
        for query in (lambda: made.signed_distance(where, poses, threads=1), lambda: surface.signed_distance(where, threads=1)):
            costs.append(1e6 * statistics.median(measured(query)[1]["cpu"] for _ in range(rounds)) / points)
        line(count, *(f"{cost:.2f}" for cost in costs))
