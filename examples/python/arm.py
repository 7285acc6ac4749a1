"""An arm that keeps away from a scanned shelf by the gradient of its distance: python examples/python/arm.py [FOLDER] [MESH]

Three links turn about their joints in a plane. The straight path of the joints' angles leads the arm through the boards of a
shelf. The scan of the shelf is broken: no backs, missing, double and reversed faces, noise. A `raymap.Scene` still tells
inside from outside. It measures many bent paths at once. The best of them is pushed away by the gradient until the arm keeps
its distance (CHOMP: Ratliff et al. 2009). A MESH, z up, takes the place of the shelf. The example writes FOLDER/arm.png, and
needs matplotlib: pip install . matplotlib
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import raymap

LENGTHS, RADIUS, MARGIN = (1.0, 0.9, 0.7), 0.06, 0.1
REACH_IN = (0.27, 0.57, 0.2), (0.18, 1.15, 0.24)  # From above the top board to below it.
PASS_BY = (-0.2, 0.7, 0.3), (1.3, 0.7, 0.3)
TIMES = np.linspace(0, 1, 60)


def scan_plate(low, high, random, step=0.05, noise=0.003):
    """Returns the vertices and faces of a box as a scanner sees it: without its back, that is the side of the largest x."""
    vertices, faces = [], []
    for axis, side in ((0, 0), (1, 0), (1, 1), (2, 0), (2, 1)):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        a, b = (np.linspace(low[k], high[k], max(round((high[k] - low[k]) / step), 1) + 1) for k in (u, v))
        corners = np.empty((len(a), len(b), 3))
        corners[..., axis], corners[..., u], corners[..., v] = (low, high)[side][axis], a[:, None], b
        i, j = np.indices((len(a) - 1, len(b) - 1))
        p, q, r, s = (sum(map(len, vertices)) + m * len(b) + n for m, n in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
        both = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((p, q, r), (p, r, s))])
        vertices.append(corners.reshape(-1, 3))
        faces.append(both if side else both[:, ::-1])
    points, found = np.concatenate(vertices), np.concatenate(faces)
    return points + random.normal(0, noise, points.shape), found


def scan_shelf():
    """Returns a broken mesh of three boards between two sides; its front is at x = 0."""
    random, parts, count = np.random.default_rng(0), [], 0
    boards = [((0, -0.5, z), (0.8, 0.5, z + 0.08)) for z in (0, 0.7, 1.4)]
    sides = [((0, y, -0.1), (0.8, y + 0.08, 1.5)) for y in (-0.58, 0.5)]
    for low, high in boards + sides:
        vertices, faces = scan_plate(low, high, random)
        parts.append((vertices, faces + count))
        count += len(vertices)
    vertices, faces = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    faces = faces[random.random(len(faces)) > 0.04]
    is_reversed = random.random(len(faces)) < 0.03
    faces[is_reversed] = faces[is_reversed, ::-1]
    double = faces[random.random(len(faces)) < 0.1]
    return raymap.Mesh(vertices, np.concatenate([faces, double[:, ::-1]]))


def place(angles):
    """Returns the positions of the joints and of the arm's end, (..., 4, 3)."""
    total = np.cumsum(angles, axis=-1)
    links = np.array(LENGTHS)[:, None] * np.stack([np.sin(total), 0 * total, np.cos(total)], axis=-1)
    return np.concatenate([np.zeros_like(links[..., :1, :]), np.cumsum(links, axis=-2)], axis=-2)


def ask(angles, samples=12):
    """Returns the distances of points of the arm, and their derivatives by the angles: (..., points[, joints])."""
    joints = place(angles)
    shares = np.linspace(0, 1, samples)[:, None]
    points = joints[..., :-1, None, :] + shares * np.diff(joints, axis=-2)[..., None, :]
    points = points.reshape(*angles.shape[:-1], -1, 3)
    found = scene.query(points, ("distance", "gradient"))
    moves = np.cross((0.0, 1.0, 0.0), points[..., None, :] - joints[..., None, :-1, :])
    is_moved = np.arange(len(LENGTHS)) <= np.repeat(np.arange(len(LENGTHS)), samples)[:, None]
    return found.distance - RADIUS, (moves * found.gradient[..., None, :]).sum(axis=-1) * is_moved


def least(path, between=10):
    """Returns the least distance of the arm on its way, also between the configurations of the path."""
    times = np.linspace(0, 1, between * (len(path) - 1) + 1)
    return ask(np.stack([np.interp(times, TIMES, joint) for joint in path.T], axis=-1))[0].min()


def bend(straight):
    """Returns the best of many paths that leave the straight one and come back: neither near the obstacle nor long."""
    offsets = np.stack(np.meshgrid(*[np.linspace(-1.5, 1.5, 7)] * 3), axis=-1).reshape(-1, 1, 3)
    paths = straight + np.sin(np.pi * TIMES)[:, None] * offsets
    near = np.maximum(MARGIN / 4 - ask(paths)[0], 0).sum(axis=(1, 2))
    return paths[np.argmin(near + 0.01 * np.square(offsets).sum(axis=(1, 2)))]


def push_away(path):
    """Returns a path with the margin, if it is found. Steps are smoothed along the path, whose ends stay."""
    stiffness = 2 * np.eye(len(path) - 2) - np.eye(len(path) - 2, k=1) - np.eye(len(path) - 2, k=-1)
    smooth = np.linalg.inv(stiffness)
    smooth /= smooth.max()
    for _ in range(300):
        distance, change = ask(path)
        wanted = np.maximum(MARGIN - distance, 0)[1:-1]
        if wanted.max() < 0.001:
            break
        path = path.copy()
        path[1:-1] += 0.1 * smooth @ (wanted[..., None] * change[1:-1]).sum(axis=1)
    return path


def draw(axes, path, title):
    x, z = np.meshgrid(np.linspace(-1.2, 2.6, 381), np.linspace(-0.6, 2.4, 301))
    distance = scene.signed_distance(np.stack([x, 0 * x, z], axis=-1))
    axes.contourf(x, z, distance, levels=[-9, 0, *np.arange(0.1, 1.5, 0.1)], cmap="Greys_r", vmin=-0.5, vmax=0.6)
    for time, joints in zip(TIMES[::3], place(path[::3]), strict=True):
        axes.plot(joints[:, 0], joints[:, 2], color=plt.cm.viridis(time), linewidth=3, solid_capstyle="round")
    axes.plot(*place(path)[:, -1, [0, 2]].T, color="firebrick", linewidth=1)
    axes.set(title=f"{title}: least distance {least(path):.3f}", aspect="equal", xlim=(-1.2, 2.6), ylim=(-0.6, 2.4))


folder = Path("arm" if len(sys.argv) < 2 else sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
pose = np.eye(4)
if len(sys.argv) < 3:
    mesh, ends = scan_shelf(), REACH_IN
    pose[:3, 3] = 1.3, 0, 0.1
else:
    given, ends = raymap.load_mesh(sys.argv[2]), PASS_BY
    mesh = raymap.Mesh((given.vertices - given.bounds.mean(axis=0)) / np.ptp(given.bounds, axis=0).max(), given.faces)
    pose[:3, 3] = 1.85, 0, 1.6
scene = raymap.Scene()
scene.add("obstacle", raymap.Surface(mesh), pose)
straight = np.linspace(*ends, len(TIMES))
bent = bend(straight)
path = push_away(bent)

figure, (left, middle, right) = plt.subplots(1, 3, figsize=(16, 5), layout="constrained")
left.imshow(raymap.render_defects(mesh, width=480, height=400, direction=(0.8, 0.5, -0.4), up=(0, 0, 1)))
left.set_title("the mesh, with its defects")
left.axis("off")
paths = {"straight path": straight, "bent path": bent, "path that keeps away": path}
for title, angles in paths.items():
    print(f"{title}: least distance {least(angles):.3f}")
draw(middle, straight, "straight path")
draw(right, path, "path that keeps away")
figure.savefig(folder / "arm.png", dpi=80)
