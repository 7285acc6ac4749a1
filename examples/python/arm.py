"""An arm that keeps away from an obstacle by the gradient of its distance: python examples/python/arm.py [FOLDER]

Three capsules turn about their joints in a plane. A straight path of the joints' angles leads the arm through a ball. Each
step asks a `raymap.Scene` of the links for the distance of the ball's centre to the arm in all configurations of the path at
once, and turns the joints so that it grows where it is too small (CHOMP: Ratliff et al. 2009). It writes FOLDER/arm.png, and
needs matplotlib: pip install . matplotlib
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import raymap

LENGTHS, RADIUS, MARGIN = (1.0, 1.0, 0.8), 0.08, 0.12
CENTRE, BALL = np.array([[1.85, 0.0, 1.85]]), 0.2
START, END = (-0.2, 0.7, 0.3), (1.3, 0.7, 0.3)


def make_capsule(length, radius, around=24, rows=12):
    """Returns the vertices and faces of a capsule around a line from (0, 0, 0) along z."""
    angles, turns = np.linspace(-np.pi / 2, np.pi / 2, 2 * rows), np.arange(around) * 2 * np.pi / around
    a, t = np.meshgrid(angles, turns, indexing="ij")
    vertices = radius * np.stack([np.cos(a) * np.cos(t), np.cos(a) * np.sin(t), np.sin(a)], axis=-1)
    vertices[rows:, :, 2] += length
    i, j = np.indices((2 * rows - 1, around))
    corners = [k * around + m % around for k, m in ((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j))]
    faces = [np.stack([corners[c] for c in triangle], axis=-1).reshape(-1, 3) for triangle in ((0, 1, 2), (0, 2, 3))]
    return vertices.reshape(-1, 3), np.concatenate(faces)


def place(angles):
    """Returns the poses of the links, (configurations, links, 4, 4), and the positions of their ends."""
    poses, ends = np.zeros((*angles.shape, 4, 4)), np.zeros((len(angles), len(LENGTHS) + 1, 3))
    for link, angle in enumerate(np.cumsum(angles, axis=1).T):
        cos, sin = np.cos(angle), np.sin(angle)
        pose = poses[:, link]
        pose[:, 0, 0], pose[:, 0, 2], pose[:, 2, 0], pose[:, 2, 2] = cos, sin, -sin, cos
        pose[:, 1, 1] = pose[:, 3, 3] = 1
        pose[:, :3, 3] = ends[:, link]
        ends[:, link + 1] = ends[:, link] + LENGTHS[link] * pose[:, :3, 2]
    return poses, ends


def ask(scene, points, angles):
    """Returns the distances of the points, and their derivatives by the angles: (configurations, points[, joints])."""
    poses, ends = place(angles)
    found = scene.query(points, ("distance", "body", "gradient"), poses=poses)
    # A joint moves the point of the arm that is closest to a point, which changes the distance against the gradient.
    arms = points - found.distance[..., None] * found.gradient
    moves = np.cross((0.0, 1.0, 0.0), arms[:, :, None] - ends[:, None, :-1])
    joints = np.arange(len(LENGTHS)) <= found.body[..., None]
    return found.distance, -(moves * found.gradient[:, :, None]).sum(axis=-1) * joints


def between(path, steps=20):
    """Returns the path with configurations between those of each step."""
    times = np.linspace(0, len(path) - 1, steps * (len(path) - 1) + 1)
    return np.stack([np.interp(times, np.arange(len(path)), joint) for joint in path.T], axis=-1)


def draw(axes, angles, title):
    axes.add_patch(plt.Circle(CENTRE[0, [0, 2]], BALL, color="firebrick"))
    for share, ends in zip(np.linspace(0.2, 1.0, len(angles)), place(angles)[1], strict=True):
        axes.plot(ends[:, 0], ends[:, 2], color=plt.cm.viridis(1 - share), linewidth=4, solid_capstyle="round")
    axes.set(title=title, aspect="equal", xlim=(-1.2, 3), ylim=(-1, 3))


links = [raymap.Surface(*make_capsule(length, RADIUS)) for length in LENGTHS]
scene = raymap.Scene({f"link {number}": link for number, link in enumerate(links)})
path = straight = np.linspace(START, END, 60)

# Steps are smoothed along the path, whose ends stay.
stiffness = 2 * np.eye(len(path) - 2) - np.eye(len(path) - 2, k=1) - np.eye(len(path) - 2, k=-1)
smooth = np.linalg.inv(stiffness)
smooth /= smooth.max()
for _ in range(300):
    distance, change = ask(scene, CENTRE, path)
    wanted = np.maximum(BALL + MARGIN - distance, 0)
    if wanted.max() < 0.001:
        break
    path = path.copy()
    path[1:-1] += 0.3 * smooth @ (wanted[..., None] * change).sum(axis=1)[1:-1]

folder = Path("arm" if len(sys.argv) < 2 else sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
figure, both = plt.subplots(1, 2, figsize=(10, 5))
for axes, angles, title in zip(both, (straight, path), ("straight path", "away from the ball"), strict=True):
    least = ask(scene, CENTRE, between(angles))[0].min() - BALL
    print(f"{title}: least distance {least:.3f}")
    draw(axes, angles[::3], f"{title}: least distance {least:.3f}")
figure.savefig(folder / "arm.png", dpi=100, bbox_inches="tight")
