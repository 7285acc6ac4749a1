"""A walk through the Python package, with pictures: python examples/python/walk.py [FOLDER]

Each `# %%` begins a cell: VS Code, Spyder, and Jupyter with jupytext show this file as a notebook. As a script it writes
its pictures to FOLDER. It needs matplotlib: pip install . matplotlib
"""

# %% The packages, and the folder of the pictures
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import raymap

in_notebook = "ipykernel" in sys.modules  # whose arguments are not ours
folder = Path("walk" if in_notebook or len(sys.argv) < 2 else sys.argv[1])
(folder / "meshes").mkdir(parents=True, exist_ok=True)


def save(name):
    plt.savefig(folder / f"{name}.png", dpi=100, bbox_inches="tight")


def draw_mesh(axes, mesh):
    axes.plot_trisurf(*mesh.vertices.T, triangles=mesh.faces, linewidth=0, color="steelblue")
    axes.set_box_aspect(np.ptp(mesh.vertices, axis=0), zoom=1.4)
    axes.view_init(elev=50, azim=-60)
    axes.set_axis_off()


# %% A mesh: the tube around a knot
# raymap.load_mesh("scan.ply") reads one instead. Faces are counter-clockwise seen from outside.
def make_knot(around=240, across=24, radius=0.45):
    t, s = np.meshgrid(*(np.arange(n) * 2 * np.pi / n for n in (around, across)), indexing="ij")
    outward = np.stack([np.cos(3 * t) * np.cos(2 * t), np.cos(3 * t) * np.sin(2 * t), -np.sin(3 * t)], axis=-1)
    curve = outward + 2 * np.stack([np.cos(2 * t), np.sin(2 * t), np.zeros_like(t)], axis=-1)
    sideways = np.cross(np.roll(curve, -1, axis=0) - np.roll(curve, 1, axis=0), outward)
    sideways /= np.linalg.norm(sideways, axis=-1, keepdims=True)
    vertices = curve + radius * (np.cos(s)[..., None] * outward + np.sin(s)[..., None] * sideways)
    i, j = np.indices((around, across))
    a, b = i * across + j, i * across + (j + 1) % across
    c, d = (i + 1) % around * across + (j + 1) % across, (i + 1) % around * across + j
    faces = np.concatenate([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)])
    return raymap.Mesh(vertices.reshape(-1, 3), faces.reshape(-1, 3))


knot = make_knot()
found = raymap.info(knot)
print(f"{knot}: watertight {found['watertight']}, volume {found['signed_volume']:.3f}")

# %% Its field: distances on a regular grid, negative inside
# Without bounds, the grid is as large as the mesh and a tenth more.
box = ((-4, -4, -2), (4, 4, 2))
field = raymap.generate(knot, bounds=box, resolution=96)
print(f"{field}: {(field.distance < 0).mean():.1%} of the samples are inside")

# %% Slices with contour lines
# field.distance[i, j, k] lies at origin + spacing * (i, j, k). Pictures have y along the rows, hence the transposition.
x, y, z = (field.origin[axis] + field.spacing * np.arange(field.shape[axis]) for axis in range(3))
figure, panels = plt.subplots(1, 2, figsize=(12, 4.5), layout="constrained")
middle = field.shape[2] // 2
for axes, k in zip(panels, (middle, middle + 12), strict=True):
    distance = field.distance[:, :, k].T
    filled = axes.contourf(x, y, distance, levels=np.linspace(-1, 1, 41), cmap="RdBu_r", extend="both")
    axes.contour(x, y, distance, levels=np.arange(0.25, 1.5, 0.25), colors="black", linewidths=0.5)
    axes.contour(x, y, distance, levels=[0], colors="black", linewidths=2)
    axes.set(title=f"z = {z[k]:.2f}", aspect="equal", xlabel="x", ylabel="y")
figure.colorbar(filled, ax=panels, label="distance, negative inside")
save("slices")

# %% The gradient: it points away from the surface, and its length is 1
grid = np.stack(np.meshgrid(x[4:-4:6], y[4:-4:6], [z[middle]], indexing="ij"), axis=-1)[:, :, 0]
gradient = field.gradient(grid)
print(f"median length of the gradient: {np.median(np.linalg.norm(gradient, axis=-1)):.3f}")
figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
axes.contour(x, y, field.distance[:, :, middle].T, levels=[0], colors="black", linewidths=2)
axes.quiver(*np.moveaxis(grid, -1, 0)[:2], *np.moveaxis(gradient, -1, 0)[:2], color="steelblue")
axes.set(title=f"gradient at z = {z[middle]:.2f}, seen from above", aspect="equal")
save("gradient")

# %% Isosurfaces: a closed mesh at any distance
# plot_trisurf suits small meshes. field.render() traces the field itself, at any resolution.
figure = plt.figure(figsize=(13, 4.2), layout="constrained")
for panel, iso in enumerate((-0.25, 0.25)):
    moved = field.to_mesh(iso)
    title = f"to_mesh({iso}): {len(moved.faces)} faces"
    draw_mesh(figure.add_subplot(1, 3, panel + 1, projection="3d", title=title), moved)
axes = figure.add_subplot(1, 3, 3, title="render(cut=True)")
axes.imshow(field.render(width=640, height=480, cut=True))
axes.set_axis_off()
save("isosurfaces")

# %% Points of our own: exact, without a grid
surface = raymap.Surface(knot)
points = np.random.default_rng(1).uniform((-3.2, -3.2, 0), (3.2, 3.2, 0), (60, 3))
answer = surface.query(points, ("distance", "closest"))
error = np.median(np.abs(field.sample(points) - answer.distance)) / field.spacing
print(f"{(answer.distance < 0).sum()} of {len(points)} points are inside; the field differs by {error:.3f} samples")
figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
axes.contour(x, y, field.distance[:, :, np.abs(z).argmin()].T, levels=[0], colors="black", linewidths=1)
axes.plot(*np.stack([points, answer.closest])[..., :2].transpose(2, 0, 1), color="grey", linewidth=0.7)
shown = axes.scatter(*points[:, :2].T, c=answer.distance, cmap="RdBu_r", vmin=-1, vmax=1, edgecolors="black", zorder=2)
axes.set(title="closest points of points at z = 0", aspect="equal")
figure.colorbar(shown, ax=axes, label="distance")
save("points")

# %% Points to train a network with, as DeepSDF takes them
samples = raymap.sample_points(surface, 20_000, sigma=(0.05, 0.02), seed=1, normalize=True)
samples.save(folder / "knot.npz")
print(f"{len(samples.pos)} points outside, {len(samples.neg)} inside")
figure, axes = plt.subplots(figsize=(6, 5), layout="constrained")
thin = np.abs(samples.points[:, 2]) < 0.05
shown = axes.scatter(*samples.points[thin, :2].T, c=samples.distance[thin], s=4, cmap="RdBu_r", vmin=-0.1, vmax=0.1)
axes.set(title="samples with |z| < 0.05, in the unit sphere", aspect="equal")
figure.colorbar(shown, ax=axes, label="distance")
save("samples")

# %% A broken mesh: with a hole and reversed faces
# A field needs no repair. A 3D printer needs a watertight mesh.
top = knot.vertices[knot.vertices[:, 2].argmax()]
kept = knot.faces[np.linalg.norm(knot.vertices[knot.faces].mean(axis=1) - top, axis=1) > 0.5]
kept[::7] = kept[::7, ::-1]
broken = raymap.Mesh(knot.vertices, kept)
again = raymap.generate(broken, bounds=box, resolution=96)
print(f"{((again.distance < 0) != (field.distance < 0)).mean():.3%} of the signs differ")
solid, report = raymap.repair(broken, resolution=96)
for time in ("before", "after"):
    print(time, {fact: report[time][fact] for fact in ("watertight", "hole_count", "flipped_faces")})
figure = plt.figure(figsize=(10, 4.5), layout="constrained")
for panel, (title, mesh) in enumerate((("broken", broken), ("repaired", solid))):
    draw_mesh(figure.add_subplot(1, 2, panel + 1, projection="3d", title=title), mesh)
save("repair")

# %% A data set: the fields of many meshes, each made in a process apart
# A second run makes what is missing or has changed. docs/datasets.md takes it to a cluster.
knot.save(folder / "meshes" / "knot.ply")
broken.save(folder / "meshes" / "broken.obj")
summary = raymap.dataset.generate(folder / "meshes", folder / "fields", resolution=48)
print(f"{', '.join(summary.done)} done; see {folder / 'fields' / 'index.html'}")
figure, panels = plt.subplots(1, len(summary.done), figsize=(8, 4), layout="constrained")
for axes, name in zip(panels, summary.done, strict=True):
    axes.imshow(plt.imread(folder / "fields" / f"{name}.png"))
    axes.set(title=f"{name}: {raymap.load_field(folder / 'fields' / f'{name}.npz').shape}")
    axes.set_axis_off()
save("dataset")
print(f"The pictures are in {folder}")
